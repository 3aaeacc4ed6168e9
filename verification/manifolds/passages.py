"""How long a ball stays above a homoclinic crisis, at a finite distance: one term for each passage of the saddle.

[GrebogiOttRomeirasYorke1987] find the power that holds in the limit. Their argument, kept at a
finite distance: the unstable manifold reaches beyond the stable one by `e`, the distance above the crisis, over a
length `sqrt(e)`, and what lands there leaves. Followed back for `n` rounds along the saddle that region has become as
high as the attractor is, `e*stable**-n = 1`, and as near to the stable manifold as `unstable**-n`. So a ball must first
have come that near, where the manifolds touch, and then have hit a part `sqrt(e)` of it:

    leaves(e) = sqrt(e) * leaves(unstable**-n),    n = floor(ln(e)/ln(stable)),

and `leaves(e) = sqrt(e)` when no round fits in. Were `n` no whole number, and large, this would be the power law
`ln|stable| / (2*ln|stable*unstable|)`. As it is, the slope of the logarithms is 1/2 and every further passage is a
step: the wave that measured stays show about a power. Which distance counts as one is all that is left to fit.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

TRIED = 1500
Array = NDArray[np.float64]


def log_stay(distance: float, stable: float, unstable: float) -> float:
    """`-ln(leaves)` up to a constant; `distance` in units of the one that counts as one, at most 1.

    >>> round(log_stay(math.exp(-1.0), 0.2, 3.0), 3), log_stay(1.0, 0.2, 3.0)
    (0.5, 0.0)
    """
    depth = math.log(1 / distance)
    rounds = math.floor(depth / -math.log(abs(stable)))
    passed = depth / 2
    return passed + log_stay(abs(unstable) ** -rounds, stable, unstable) if rounds else passed


def exponent(distances: Array, unit: float, stable: float, unstable: float) -> float:
    """The power that a straight line through the logarithms at these distances would show."""
    logs = [log_stay(float(d) / unit, stable, unstable) for d in distances]
    return -float(np.polyfit(np.log(distances), logs, 1)[0])


def unit(points: Sequence[tuple[float, float]], stable: float, unstable: float) -> tuple[float, float]:
    """The distance that counts as one, by least squares, and the root mean square of what is left of `ln(stay)`.

    The steps lie at `unit*stable**n`; units are sought from the largest distance up to 1, all that a contraction has.
    """
    distances, logs = np.array(points)[:, 0], np.log(np.array(points)[:, 1])
    tried = np.geomspace(distances.max(), 1, TRIED)
    left = []
    for one in tried:
        off = logs - np.array([log_stay(float(d) / one, stable, unstable) for d in distances])
        left.append(float(np.std(off)))
    best = int(np.argmin(left))
    return float(tried[best]), left[best]
