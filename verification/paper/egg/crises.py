"""Judges of claims on the egg's crises, and on its growing attractor and basins of period 3. Paper: section 6.7.

A crisis is computed as a tangency of manifolds, and from particles that escape. It is proved that the period-3 orbits
attract; all else is sampled. The merging crisis is in `merging`.
"""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import mpmath
import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.space import followed
from verification.arithmetic.balls import FLOAT64
from verification.named import crises
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import judges, sampled
from verification.paper.judges.attractors import (
    SHAPE,
    cycles,
    egg,
    proved_at,
    unsettled,
)
from verification.proofs.manifolds.grow import branch
from verification.proofs.manifolds.known import CONTACTS, KnownCrisis, crisis, table
from verification.proofs.manifolds.saddle import local, saddle

EXACT_SHAPE = Rational(2, 25)
SEED, BITS = 1, 160
BELOW = (0.64, 0.65, 0.66, 0.662)  # contractions where the attractor's distance to the basin boundary is measured


@cache
def located(kind: str) -> KnownCrisis:
    """The crisis named `kind`: its parameter to ten digits, as a tangency of manifolds and by a cycle near it."""
    return crisis(kind, EXACT_SHAPE, 10)


@cache
def seen(kind: str) -> crises.Crisis:
    """The crisis named `kind`: its parameter to about 3e-4, from particles that escape (few do close to the crisis)."""
    return crises.crisis(kind, str(EXACT_SHAPE), tolerance=1e-4, budget=10**7)


@judges("egg.boundary_crisis")
def values(claim: Claim) -> Judgement:
    """Compares the parameter of the tangency, by two methods, with that at which particles begin to escape."""
    printed, found, particles = "0.66", located("boundary"), seen("boundary")
    gap, unit = float(found.parameter) - float(printed), 10.0 ** -len(printed.partition(".")[2])
    value = f"{mpmath.nstr(found.parameter, 12)} +- {mpmath.nstr(found.error, 1)}"
    together = found.agrees and abs(particles.lam - float(found.parameter)) <= particles.error
    said = (
        f"homoclinic tangency of the {found.touch.contact.unstable.name} at {value}; the manifolds and the fold of a "
        f"cycle of {found.period} bounces agree to {found.apart:.0e}; particles first leave at {particles.lam:.5f} +- "
        f"{particles.error:.0e}; {printed} differs by {gap:+.1e}"
    )
    return sampled(
        f"{value}: manifolds of the unstable triangle touch there, proved; that the chaotic attractor ends there is "
        "sampled",
        said,
        together and abs(gap) < unit,
    )


@judges("egg.crisis_touch")
def touch(claim: Claim) -> Judgement:
    """The attractor approaches the stable manifold of the unstable triangle, which bounds the basins of period 3."""
    outside, inside = sides(0.66)
    gaps = [distance(lam) for lam in BELOW]
    nears = all(a > b for a, b in pairwise(gaps))
    listed = ", ".join(f"{gap:.4f} at {lam}" for gap, lam in zip(gaps, BELOW, strict=True))
    said = (
        f"at 0.66, of points 1e-5 on either side of the stable manifold of the unstable triangle {outside:.0%} and "
        f"{inside:.0%} go to period 3; the attractor's distance to that manifold falls to 0: {listed}, and it is 0 at "
        f"{mpmath.nstr(located('boundary').parameter, 10)}, where the triangle's own manifolds touch"
    )
    held = nears and outside == 1 and inside == 0
    return sampled("the boundary touched is the stable manifold of the unstable period-3 orbit", said, held)


def boundary(lam: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The part of the triangle's stable manifold near the attractor, as arrays of `theta` and `phi`."""
    found = saddle(CONTACTS["boundary"].unstable, table(EXACT_SHAPE).over(FLOAT64), lam)
    curve = branch(local(found, unstable=False), -1, 1.2, spacing=0.002)
    return curve.x, curve.y


def distance(lam: float) -> float:
    """The least distance in `(theta, phi)`, modulo symmetry, between the attractor and `boundary(lam)`."""
    x, y = boundary(lam)
    rng = np.random.default_rng(SEED)
    map = PinballMap("egg", lam=lam, alpha=str(EXACT_SHAPE))
    start = rng.uniform(-0.05, 0.05, (2, 200))
    ball = map.exponents(start[0], start[1], 100, 2000)
    orbit = map.orbit(ball.theta[ball.nu_plus > 0], ball.phi[ball.nu_plus > 0], 400)
    third = 2 * np.pi / 3
    theta, phi = orbit.theta.ravel(), orbit.phi.ravel()
    low = float(np.min(x))
    cell = [low + np.remainder(s * theta - low, third) for s in (1, -1)]
    both = np.concatenate(cell), np.concatenate([phi, -phi])
    above = both[1] > np.interp(both[0], x[::-1], y[::-1]) - 0.05
    return float(np.min(np.hypot(both[0][above, None] - x, both[1][above, None] - y)))


def sides(lam: float, offset: float = 1e-5) -> tuple[float, float]:
    """The fractions of points that end on period 3, just outside `boundary(lam)` and just inside it."""
    x, y = boundary(lam)
    map = PinballMap("egg", lam=lam, alpha=str(EXACT_SHAPE))
    shares = []
    for side in (1, -1):
        theta = np.remainder(x[::20] + np.pi, 2 * np.pi) - np.pi
        end = map.exponents(theta, y[::20] + side * offset, 200, 500)
        shares.append(float(np.mean(end.nu_plus < -0.1)))
    return shares[0], shares[1]


ONE = ("0.445", "0.48", "0.52", "0.56", "0.6", "0.63", "0.655")  # contractions with one attractor, outside of windows
CELLS = 300  # along each side of phase space, in (theta, sin(phi))
STARTS, MANY = 200, 4000
LEFT = "0.7"


@dataclass(frozen=True)
class AttractorExtent:
    """The largest `|sin(phi)|` on the chaotic attractors, and the fraction of phase space cells that they meet."""

    height: float
    share: float


@cache
def extent(lam: str) -> AttractorExtent:
    """The extent of all chaotic attractors together, from 200 orbits of 2000 bounces and their symmetric images."""
    map = PinballMap("egg", lam=lam, alpha=SHAPE)
    start = np.random.default_rng(SEED).uniform(-0.05, 0.05, (2, STARTS))
    settled = map.exponents(start[0], start[1], 500, 2000)
    on = settled.nu_plus > 0
    orbit = map.orbit(settled.theta[on], settled.phi[on], 2000)
    height = np.sin(orbit.phi).ravel()
    column = (np.remainder(orbit.theta.ravel(), 2 * np.pi) / (2 * np.pi) * CELLS).astype(int) % CELLS
    row = np.minimum(((height + 1) / 2 * CELLS).astype(int), CELLS - 1)
    met = np.zeros((CELLS, CELLS), dtype=bool)
    met[row, column] = True
    met |= met[::-1, ::-1]  # the mirror image, cell by cell; rotations are treated likewise
    met |= np.roll(met, CELLS // 3, axis=1) | np.roll(met, -CELLS // 3, axis=1)
    return AttractorExtent(float(np.max(np.abs(height))), float(np.mean(met)))


@cache
def period_3(lam: str) -> float:
    """The fraction of 4000 random starts that the two period-3 orbits attract."""
    map = PinballMap("egg", lam=lam, alpha=SHAPE)
    start = interior_starts(map, MANY, SEED)
    found = followed(map, start, (200, 1000))
    count = np.sum((found.period == 3) & (np.abs(found.starts.phi) > 0.15))
    if found.going.size:
        end = map.exponents(found.growth.theta, found.growth.phi, 200)
        count += np.sum((end.nu_plus < -0.02) & (np.abs(end.phi) > 0.15))
    return float(count) / MANY


def grows(lams: tuple[str, ...]) -> bool:
    """True if the height and the share of the attractors grow from each contraction in the list to the next."""
    found = [extent(lam) for lam in lams]
    return all(a.height < b.height and a.share < b.share for a, b in pairwise(found))


def listed(lams: tuple[str, ...]) -> str:
    """The extents at the given contractions, as text."""
    return "; ".join(f"{extent(x).height:.3f}, {extent(x).share:.2%} at {x}" for x in lams)


@judges("egg.both_grow")
def both_grow(claim: Claim) -> Judgement:
    """Samples show that the attractor's extent and the fraction of starts that period 3 attracts both grow."""
    shares = [period_3(lam) for lam in ONE]
    error = 3 * np.sqrt(0.25 / MANY)
    rises = shares[-1] - shares[0] > error and all(b > a - error for a, b in pairwise(shares))
    told = ", ".join(f"{share:.1%} at {lam}" for share, lam in zip(shares, ONE, strict=True))
    return sampled(
        "both do, and the basin of the chaotic attractor shrinks",
        f"of {MANY} random starts period 3 attracts {told} (+- {error / 3:.1%}); the attractor meets {listed(ONE)}",
        grows(ONE) and bool(rises),
    )


@judges("egg.transient")
def transient(claim: Claim) -> Judgement:
    """Just beyond the crisis, orbits stay for long near the former attractor, and then leave it one by one."""
    beyond, before = "0.67", "0.66"
    map = PinballMap("egg", lam=beyond, alpha=SHAPE)
    start = np.random.default_rng(SEED).uniform(-0.05, 0.05, (2, STARTS))
    early, later, last = (map.exponents(start[0], start[1], 300, after) for after in (200, 1000, 3000))
    counts = [int(np.sum(end.nu_plus > 0)) for end in (early, later, last)]
    orbit = map.orbit(early.theta, early.phi, 200)
    still = map.exponents(orbit.theta[-1], orbit.phi[-1], 300, 0).nu_plus > 0  # still chaotic after the bounces counted
    heights = float(np.quantile(np.abs(np.sin(orbit.phi[:, still])), 0.95))
    known = PinballMap("egg", lam=before, alpha=SHAPE)
    settled = known.exponents(start[0], start[1], 500, 500)
    old = float(np.quantile(np.abs(np.sin(known.orbit(settled.theta, settled.phi, 200).phi)), 0.95))
    return sampled(
        "a transient at angles up to a quarter larger than on the attractor at 0.66, which orbits leave one by one",
        f"of {STARTS} orbits at lam = {beyond} the growth over 300 bounces is positive for {counts[0]}, {counts[1]} "
        f"and {counts[2]} after 200, 1000 and 3000; 95% of the angles of those that stay have |sin(phi)| < "
        f"{heights:.3f}, on the attractor at {before} {old:.3f}",
        counts[0] > counts[1] > counts[2] and abs(heights - old) < 0.3 * old,
    )


@judges("egg.just_two", "egg.region_taken_over")
def just_two(claim: Claim) -> Judgement:
    """Both orbits of period 3 are proved to attract; in a sample, every start reaches one of them."""
    found = egg(LEFT)
    threes = cycles(found, 3)
    alone = len(found) == len(threes) == 2 and unsettled(found) == 0
    counts = [a.share.count for a in threes if a.share]
    return sampled(
        "two orbits of period 3 attract, proved; nothing else was reached",
        f"at lam = {LEFT} {' and '.join(map(str, counts))} of {STARTS} random starts reach the two orbits, which are "
        f"proved to attract; a share below {3 / STARTS:.1%} of others is not excluded",
        alone and bool(proved_at(LEFT, 3)),
    )
