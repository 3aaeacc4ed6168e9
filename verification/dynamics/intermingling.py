"""How closely basins are mixed: small squares of phase space, and the fates of a few starts in each.

Three numbers at each size `eps`: the share of squares with more than one fate; the basin entropy, the mean over
all squares of `-sum p log p` over the fates; and the boundary basin entropy, the mean over squares with more
than one fate (Daza and others 2016). A smooth boundary keeps the last one and lets the first fall like
`eps`; basins that are intermingled at every point would keep all three as `eps` goes to 0. The basin of an
attracting cycle is open, so for cycles the first one must vanish in the end: what can be measured is how fast.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from numeric import PinballMap
from verification.dynamics.attractors import wilson
from verification.dynamics.basins import TRANSIENT, Window, labels, random_points, starts_at, whole
from verification.dynamics.kinds import Attractor, Share
from verification.dynamics.places import Array
from verification.dynamics.recognition import Labels

EACH = 25  # starts in a square


class Mixing(NamedTuple):
    """What squares of size `eps` hold; entropies in nats with standard errors, nan where no square is mixed."""

    eps: float
    mixed: Share
    entropy: float
    entropy_error: float
    boundary_entropy: float
    boundary_entropy_error: float


def intermingling(
    map: PinballMap,
    attractors: Sequence[Attractor],
    sizes: Sequence[float],
    squares: int,
    seed: int,
    window: Window | None = None,
    transient: int = TRANSIENT,
) -> list[Mixing]:
    """The mixing at each size, in squares placed at random.

    >>> from verification.dynamics.attractors import find
    >>> map = PinballMap("ellipse", a=2, lam="0.5")  # one attractor only
    >>> intermingling(map, find(map, 50, 1), [0.1], 50, 1)[0].mixed.count
    0
    """
    rng = np.random.default_rng(seed)
    where = whole(map) if window is None else window
    s, height = (x[:, None] for x in random_points(where, squares, rng))
    found = []
    for eps in sizes:
        aside, above = rng.uniform(-eps / 2, eps / 2, (2, squares, EACH))
        label = labels(map, starts_at(map, s + aside, height + above), attractors, transient, sure=True)
        found.append(_of(eps, entropies(label.reshape(squares, EACH), len(attractors))))
    return found


def entropies(label: Labels, count: int) -> Array:
    """The entropy of the labels in each row, in nats.

    >>> entropies(np.array([[0, 0, 1, 1], [0, 0, 0, 0]]), 2).round(6).tolist()
    [0.693147, 0.0]
    """
    shares = np.stack([np.mean(label == i, axis=1) for i in range(-1, count)])
    return np.asarray(np.sum(-shares * np.log(np.where(shares > 0, shares, 1)), axis=0)) + 0.0


def _of(eps: float, entropy: Array) -> Mixing:
    mixed = entropy[entropy > 0]
    error = float(np.std(entropy) / np.sqrt(entropy.size))
    if mixed.size == 0:
        return Mixing(eps, wilson(0, entropy.size), 0.0, error, float("nan"), float("nan"))
    inner = float(np.std(mixed) / np.sqrt(mixed.size))
    return Mixing(eps, wilson(mixed.size, entropy.size), float(np.mean(entropy)), error, float(np.mean(mixed)), inner)
