"""Claims on the crises of the egg's chaotic attractor: tangencies of manifolds, with balls beside them. Paper: 6.7."""

from functools import cache
from itertools import pairwise

import mpmath
import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from numeric import PinballMap
from verification.arithmetic.balls import FLOAT64
from verification.named import crises
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import judges
from verification.paper.shared.samples import sampled
from verification.proofs.manifolds.grow import branch
from verification.proofs.manifolds.known import CONTACTS, Crisis, crisis, table
from verification.proofs.manifolds.saddle import local, saddle

SHAPE = Rational(2, 25)
SEED = 1
BELOW = (0.64, 0.65, 0.66, 0.662)  # contractions at which the attractor's distance to the boundary is taken


@cache
def located(kind: str) -> Crisis:
    """A crisis to ten digits, by both methods."""
    return crisis(kind, SHAPE, 10)


@cache
def seen(kind: str) -> crises.Crisis:
    """The same by balls that leave, to five digits in a second or two."""
    return crises.crisis(kind, str(SHAPE), tolerance=2e-5, budget=10**7)


@judges("egg.merging_crisis", "egg.boundary_crisis", "egg.crisis_below")
def values(claim: Claim) -> Judgement:
    """Where the manifolds touch, by two methods, and where balls begin to leave."""
    kind, printed = ("merging", "0.4435") if "merging" in claim.id else ("boundary", "0.66")
    found, balls = located(kind), seen(kind)
    gap, unit = float(found.letter) - float(printed), 10.0 ** -len(printed.partition(".")[2])
    value = f"{mpmath.nstr(found.letter, 12)} +- {mpmath.nstr(found.error, 1)}"
    together = found.agrees and abs(balls.lam - float(found.letter)) <= balls.error + 2e-5
    said = (
        f"homoclinic tangency of the {found.touch.contact.unstable.name} at {value}; the manifolds and the fold of a "
        f"cycle of {found.period} bounces agree to {found.apart:.0e}; balls first leave at {balls.lam:.5f} +- "
        f"{balls.error:.0e}; {printed} differs by {gap:+.1e}"
    )
    near = abs(gap) < unit and (claim.id != "egg.crisis_below" or gap > 0)
    return sampled(f"{value}, estimated", said, together and near)


@judges("egg.crisis_touch")
def touch(claim: Claim) -> Judgement:
    """The attractor nears the stable manifold of the unstable triangle, which bounds the basins of period 3."""
    outside, inside = sides(0.66)
    gaps = [distance(lam) for lam in BELOW]
    nears = all(a > b for a, b in pairwise(gaps))
    listed = ", ".join(f"{gap:.4f} at {lam}" for gap, lam in zip(gaps, BELOW, strict=True))
    said = (
        f"at 0.66, of points 1e-5 on either side of the stable manifold of the unstable triangle {outside:.0%} and "
        f"{inside:.0%} go to period 3; the attractor's distance to that manifold falls to 0: {listed}, and it is 0 at "
        f"{mpmath.nstr(located('boundary').letter, 10)}, where the triangle's own manifolds touch"
    )
    held = nears and outside == 1 and inside == 0
    return sampled("the boundary touched is the stable manifold of the unstable period-3 orbit", said, held)


def boundary(lam: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The part of the triangle's stable manifold along which the attractor lies."""
    found = saddle(CONTACTS["boundary"].unstable, table(SHAPE).over(FLOAT64), lam)
    curve = branch(local(found, unstable=False), -1, 1.2, spacing=0.002)
    return curve.x, curve.y


def distance(lam: float) -> float:
    """The least distance in `(theta, phi)`, modulo symmetry, between the attractor and that curve."""
    x, y = boundary(lam)
    rng = np.random.default_rng(SEED)
    map = PinballMap("egg", lam=lam, alpha=str(SHAPE))
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
    """Shares of points just outside and just inside the curve that end on period 3."""
    x, y = boundary(lam)
    map = PinballMap("egg", lam=lam, alpha=str(SHAPE))
    shares = []
    for side in (1, -1):
        theta = np.remainder(x[::20] + np.pi, 2 * np.pi) - np.pi
        end = map.exponents(theta, y[::20] + side * offset, 200, 500)
        shares.append(float(np.mean(end.nu_plus < -0.1)))
    return shares[0], shares[1]
