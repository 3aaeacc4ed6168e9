"""The dimension of a basin boundary, by the uncertainty exponent.

Two starts at a distance `eps` have different fates with probability `f(eps) ~ eps**a`, and the boundary has
dimension `2 - a` [McDonaldGrebogiOttYorke1985]. The same starts serve all distances, so the error
comes from resampling starts, not from a fit that takes distances for independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.basins import TRANSIENT, Window, labels, random_points, starts_at, whole
from numeric.dynamics.kinds import Attractor
from numeric.dynamics.phase_points import Array
from numeric.dynamics.recognition import UNSETTLED

DISTANCES = tuple(10.0 ** (-k / 2) for k in range(4, 17))  # 1e-2 to 1e-8 in s and sin(phi)
FEWEST = 10  # differing pairs that a distance needs to take part in the fit
RESAMPLED = 400


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Pairs with different fates at each distance, and the fit over the distances from `smallest` to `largest`.

    `curvature` is the change of the local exponent per decade with its error: 0 for a power law.
    """

    distances: Array
    different: NDArray[np.int64]
    pairs: int
    exponent: float
    error: float
    curvature: tuple[float, float]
    largest: float
    smallest: float

    @property
    def dimension(self) -> float:
        """Of the boundary."""
        return 2 - self.exponent


def uncertainty(
    map: PinballMap,
    attractors: Sequence[Attractor],
    count: int,
    seed: int,
    window: Window | None = None,
    distances: Sequence[float] = DISTANCES,
    transient: int = TRANSIENT,
    sure: bool = True,
) -> Uncertainty:
    """The uncertainty exponent of the boundary between all basins in a window.

    A smooth boundary has the exponent 1:

    >>> from numeric.dynamics.attractors import find
    >>> map = PinballMap("egg", alpha="0.08", lam="0.2")
    >>> found = uncertainty(map, find(map, 100, 1), 4000, 1, distances=(0.03, 0.01, 0.003))
    >>> abs(found.exponent - 1) < 3 * found.error < 0.4
    True
    """
    rng = np.random.default_rng(seed)
    where = whole(map) if window is None else window
    s, height = random_points(where, count, rng)
    turn = rng.uniform(0, 2 * np.pi, count)
    centre = labels(map, starts_at(map, s, height), attractors, transient, sure)
    rows = []
    for eps in distances:
        near = starts_at(map, s + eps * np.cos(turn), height + eps * np.sin(turn))
        label = labels(map, near, attractors, transient, sure)
        rows.append((label != centre) & (label != UNSETTLED) & (centre != UNSETTLED))
    return fitted(np.array(distances), np.array(rows), rng)


def fitted(distances: Array, different: NDArray[np.bool_], rng: np.random.Generator) -> Uncertainty:
    """The power law through the shares of differing pairs; distances along the rows.

    >>> rng = np.random.default_rng(0)
    >>> eps = np.array([0.1, 0.01, 0.001])
    >>> found = fitted(eps, rng.uniform(size=20_000) < eps[:, None] ** 0.5, rng)
    >>> abs(found.exponent - 0.5) < 3 * found.error < 0.1
    True
    """
    counts = different.sum(axis=1)
    used = counts >= FEWEST
    if np.sum(used) < 2:
        nothing = float("nan")
        return Uncertainty(
            distances, counts, different.shape[1], nothing, nothing, (nothing, nothing), nothing, nothing
        )
    size, chosen = different.shape[1], different[used]
    x = np.log10(distances[used])
    slope, bend = _power(x, counts[used], size)
    draws = [_power(x, chosen[:, rng.integers(0, size, size)].sum(axis=1), size) for _ in range(RESAMPLED)]
    errors = np.nanstd(np.array(draws), axis=0)
    ends = distances[used]
    return Uncertainty(
        distances, counts, size, slope, float(errors[0]), (bend, float(errors[1])), float(max(ends)), float(min(ends))
    )


def _power(x: Array, counts: NDArray[np.int64], of: int) -> tuple[float, float]:
    """Slope of `log f` against `log eps`, weighted by the binomial errors, and its change per decade."""
    share = np.maximum(counts, 0.5) / of
    weight = 1 / np.sqrt((1 - share) / (share * of))
    slope = float(np.polyfit(x, np.log10(share), 1, w=weight)[0])
    bend = float(2 * np.polyfit(x, np.log10(share), 2, w=weight)[0]) if x.size > 2 else float("nan")
    return slope, bend
