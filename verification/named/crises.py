"""Estimates, by sampling, of the egg's crises: contraction and length of transients. Paper: section 6.7.

`verification.proofs.manifolds` computes the same crises as tangencies of manifolds, to many digits.

Below a crisis no particle leaves the attractor; above it, each bounce has a probability to leave that grows from 0 like
a power of the distance from the crisis. Particles are started on the attractor, and the contractions at which some
leave are bracketed. As a budget of bounces may see none leave just above a crisis, the error reaches up to the
contraction at which ten left.

At some crises the attractor grows, but no particle leaves it for good. They are found by its extent: `extent` gives its
largest exit angle, how far it reaches from either end of the diameter, and its area; `widenings` finds the steps of a
scan in which one of these lengths grows suddenly.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from numeric import Exponents, PinballMap
from numeric.backends import elementary
from numeric.dynamics.phase_points import Array, advanced, phase_points

BALLS, PART, TRANSIENT = 4096, 200, 2000
MANY = 400  # particles that left, from which the mean stay is known to 5 per cent
SURE = 10  # particles that left, to decide whether some do, or ten within the budget
SEED = 1
BLOCKS = 6
ORBITS, LONG, RECORDED = 400, 20_000, 500  # particles, bounces before their orbits count, and bounces that do
CELLS = 500  # cells per radian, by which an area is counted
CHAOTIC = 0.02  # growth from which an orbit counts as chaotic
AT_ONCE = 0.01  # relative growth of an extent in one small step that is more than steady growth
Left = Callable[[Exponents], NDArray[np.bool_]]


@dataclass(frozen=True)
class Scaling:
    """The power law `stay ~ distance**-exponent`, with a jackknife error over blocks, as the points oscillate."""

    exponent: float
    error: float
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Crisis:
    """A crisis at `lam +- error`, and the mean number of bounces before leaving, at some contractions above it."""

    lam: float
    error: float
    stays: tuple[tuple[float, float], ...]
    bounces: int


def changed_axis(ball: Exponents) -> NDArray[np.bool_]:
    """True where the particle is away from the diameter on the x axis, near which it started."""
    return np.asarray(np.round(ball.theta / (np.pi / 3)).astype(int) % 3 != 0)


def settled(ball: Exponents) -> NDArray[np.bool_]:
    """True where the particle's growth exponent is below -0.1, as happens only near a periodic attractor."""
    return np.asarray(ball.nu_plus < -0.1)


KINDS: dict[str, tuple[Left, tuple[float, float]]] = {
    "merging": (changed_axis, (0.4425, 0.4450)),
    "boundary": (settled, (0.6500, 0.6700)),
}


def crisis(kind: str, alpha: str, tolerance: float = 2e-6, budget: int = 10**8) -> Crisis:
    """The egg's `merging` crisis (three pieces become one) or `boundary` crisis (the attractor vanishes).

    >>> found = crisis("merging", "0.08", tolerance=1e-3, budget=10**6)
    >>> abs(found.lam - 0.4434) < 1e-3
    True
    """
    left, (least, high) = KINDS[kind]
    stays: list[tuple[float, float]] = []
    low, top, spent = least, high, budget
    known = np.isfinite(stay(left, alpha, high, budget, SURE))
    while known and high - low > tolerance:
        lam = (low + high) / 2
        mean = stay(left, alpha, lam, budget, SURE)
        spent += budget
        if np.isfinite(mean):
            high = lam
            stays.append((lam, mean))
        else:
            low = lam
    if not known or (low == least and np.isfinite(stay(left, alpha, low, budget, 1))):
        raise ValueError(
            f"{kind} crisis: none found for lam in [{least}, {top}] at alpha = {alpha}; one is known at 0.08"
        )
    return Crisis((low + high) / 2, spread(stays, low, high, budget), tuple(stays), spent)


def stay(left: Left, alpha: str, lam: float, budget: int, enough: int = MANY) -> float:
    """The mean number of bounces on the attractor before a particle leaves; infinite if none leaves.

    All of `budget` is spent, unless `enough` particles have left before.
    """
    map = PinballMap("egg", lam=lam, alpha=alpha)
    rng = np.random.default_rng(SEED)
    starts = phase_points(rng.uniform(-0.05, 0.05, BALLS), rng.uniform(-0.05, 0.05, BALLS))
    there = advanced(map, starts, TRANSIENT).points
    ball = map.exponents(there.theta, there.phi, PART)
    inside = ~left(ball)
    theta, phi = ball.theta[inside], ball.phi[inside]
    gone = spent = 0
    while spent < budget and theta.size > gone:
        ball = map.exponents(theta, phi, PART)
        out = left(ball)
        spent += PART * theta.size
        gone += int(out.sum())
        if out.all() or gone >= enough:
            break
        keep = np.where(out, int(np.argmin(out)), np.arange(theta.size))  # who left is replaced by one who stayed
        theta, phi = ball.theta[keep], ball.phi[keep]
    return spent / gone if gone else float("inf")


def spread(stays: list[tuple[float, float]], low: float, high: float, budget: int) -> float:
    """The error of a crisis: from the middle of its bracket to the least contraction at which ten particles left.

    >>> spread([(0.5, 10.0), (0.4, 1e7)], 0.38, 0.4, 10**7)
    0.11
    """
    seen = [lam for lam, mean in stays if mean * 10 <= budget]
    return round(max((high - low) / 2, min(seen, default=high) - (low + high) / 2), 12)


def scaling(kind: str, alpha: str, at: float, distances: Array, budget: int = 10**9) -> Scaling:
    """The power law of the mean stay above a crisis at `at`, fitted to contractions at `distances` above it."""
    left, _ = KINDS[kind]
    stays = [(float(d), stay(left, alpha, at + float(d), budget)) for d in distances]
    return power(tuple((d, mean) for d, mean in stays if np.isfinite(mean)))


def power(points: tuple[tuple[float, float], ...]) -> Scaling:
    """The least-squares power law through ordered points, with a jackknife over `BLOCKS` blocks of neighbours.

    >>> power(tuple((x, x**-2) for x in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6))).exponent
    2.0
    """
    if len(points) < BLOCKS:
        raise ValueError(f"scaling: {len(points)} finite points are too few; accepted: {BLOCKS} or more")
    x, y = elementary.log(np.array(points)).T
    blocks = np.array_split(np.arange(x.size), BLOCKS)
    slopes = [_slope(np.delete(x, block), np.delete(y, block)) for block in blocks]
    error = np.sqrt((BLOCKS - 1) * np.mean((np.array(slopes) - np.mean(slopes)) ** 2))
    return Scaling(round(-_slope(x, y), 12), float(error), points)


def _slope(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0])


@dataclass(frozen=True)
class OrbitExtent:
    """The extent of the chaotic orbits that start near one end of a diameter, and the number of cells they visit.

    `near` is the largest distance in `theta` from this end at even bounces, `far` that from the other end at odd ones.
    """

    lam: float
    angle: float
    near: float
    far: float
    area: int

    @property
    def lengths(self) -> tuple[float, float, float]:
        """The lengths `angle`, `near` and `far`, without the area, which grows with every fold of the attractor."""
        return self.angle, self.near, self.far


def extent(map: PinballMap) -> OrbitExtent | None:
    """The extent of the chaotic orbits at the map's contraction; None if no orbit is chaotic.

    >>> found = extent(PinballMap("egg", lam="0.42", alpha="0.08"))
    >>> found is None  # inside the window of period 20
    True
    """
    start = np.random.default_rng(SEED).uniform(-0.05, 0.05, (2, ORBITS))
    ball = map.exponents(start[0], start[1], RECORDED, LONG)
    chaotic = ball.nu_plus > CHAOTIC
    if not chaotic.any():
        return None
    orbit = map.orbit(ball.theta[chaotic], ball.phi[chaotic], RECORDED)
    ends = [orbit.theta[0::2].ravel(), np.remainder(orbit.theta[1::2].ravel(), 2 * np.pi) - np.pi]
    angles = [orbit.phi[0::2].ravel(), orbit.phi[1::2].ravel()]
    cells = (np.unique(np.floor(CELLS * np.array(pair)), axis=1).shape[1] for pair in zip(ends, angles, strict=True))
    angle, near, far = (float(np.max(np.abs(values))) for values in (np.concatenate(angles), *ends))
    return OrbitExtent(float(map.lam.flat[0]), angle, near, far, sum(cells))


def widenings(alpha: str, lams: Array) -> list[tuple[OrbitExtent, OrbitExtent]]:
    """The quarter steps of an upward scan in which the attractor suddenly grows: the extents on both sides of each.

    A length is compared with its maximum over all smaller contractions, so that a return to the old size at the end of
    a window does not count. The length must grow by `AT_ONCE/2` in the quarter step; steady growth by `AT_ONCE` in a
    whole step gives `AT_ONCE/4`.
    """
    found: list[tuple[OrbitExtent, OrbitExtent]] = []
    before: OrbitExtent | None = None
    farthest = np.zeros(3)
    map = PinballMap("egg", lam=float(lams[0]), alpha=alpha)
    for lam in lams:
        here = extent(map.at(float(lam)))
        if here is None:
            continue
        if before is not None and _beyond(here, farthest, AT_ONCE):
            low, high = narrowed(alpha, (before, here), (here.lam - before.lam) / 4)
            if _beyond(high, np.maximum(farthest, low.lengths), AT_ONCE / 2):
                found.append((low, high))
        before, farthest = here, np.maximum(farthest, here.lengths)
    return found


def _beyond(here: OrbitExtent, farthest: Array, part: float) -> bool:
    """True if one of the lengths is longer than its maximum before, by more than the fraction `part` of it."""
    return bool(np.any(np.array(here.lengths) > (1 + part) * farthest))


def narrowed(alpha: str, step: tuple[OrbitExtent, OrbitExtent], tolerance: float) -> tuple[OrbitExtent, OrbitExtent]:
    """The extents on both sides of a sudden widening, after bisection of the step around it.

    Just above a crisis the new part of the attractor is visited so seldom that the orbits may miss it; the lower end
    may then be too high.
    """
    low, high = step
    widest = int(np.argmax(np.array(high.lengths) / np.array(low.lengths)))
    level = (low.lengths[widest] + high.lengths[widest]) / 2
    map = PinballMap("egg", lam=low.lam, alpha=alpha)
    while high.lam - low.lam > tolerance:
        middle = (low.lam + high.lam) / 2
        here = extent(map.at(middle))
        if here is None:  # a window: nothing wide is there
            low = replace(low, lam=middle)
        elif here.lengths[widest] > level:
            high = here
        else:
            low = here
    return low, high
