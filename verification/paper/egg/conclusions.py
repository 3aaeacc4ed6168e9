"""Judges of the claims in the paper's conclusions. Paper: section 7.

The judges use results proved elsewhere. A summary with one sampled part is supported, not confirmed.
"""

from functools import cache

import numpy as np
from flint import arb
from sympy import Matrix, Rational, S, Symbol, pi, simplify

from numeric.dynamics.attractors import Attractor
from symbolic import tables
from symbolic.cycles.almost_every import two_rates
from symbolic.cycles.defocusing import expands, least_exponent
from symbolic.cycles.splitting import least_rate
from symbolic.cycles.thresholds import even_stability_numbers
from symbolic.expressions.signs import Outcome, SignFinding
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.geometry import curvature
from symbolic.tables.table import K1, alpha, lam, theta
from verification.named.attractors import certificate
from verification.named.cascades import Cascade, cascade
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled, zero
from verification.paper.judges.attractors import (
    SHAPE,
    STARTS,
    chaotic,
    cycles,
    egg,
    found,
    proved_at,
    rotating,
    unsettled,
)
from verification.paper.judges.cuspless_chaos import ONE_PIECE, attracted, one_set
from verification.paper.judges.ellipse import LIMIT, lyapunov
from verification.paper.judges.hyperbolicity import PROVED_TO, born, chaos, corner
from verification.proofs.manifolds.known import CONTACTS
from verification.proofs.periodic.bifurcation import doubling_curve

MIXED = ("0.1", "0.43", "0.5", "0.6", "0.7", "0.83")  # contractions of the egg at alpha = 0.08
DIFFERENT = (("0.36", 4, 5e-3), ("0.3716", 12, 2e-4), ("0.4915", 9, 1e-3))  # contraction, period, step of a cascade
WEAK = "0.99"
NEAR_ELASTIC = ("0.97", "0.99")
EVEN, ODD = (4, 6), (5, 7)


@judges("map.mixture")
def mixture(claim: Claim) -> Judgement:
    """Only cycles attract in ellipses and none in the cardioid (proved); both kinds coexist in two tables (sampled)."""
    periodic = by(LIMIT, *lyapunov())
    kinds = {x: (bool(chaotic(egg(x))), bool(cycles(egg(x)))) for x in MIXED}
    cuspless = found("cuspless", "0.09")
    both = [x for x, (wild, calm) in kinds.items() if wild and calm]
    said = (
        "proved: in the ellipse with a > 1 every orbit tends to one of two periodic ones, and in the cardioid every "
        "orbit off the cusp has a positive exponent for lam < 1, so that no cycle attracts; sampled: both kinds "
        f"coexist in the egg at alpha = {SHAPE}, lam = {', '.join(both)} out of {', '.join(MIXED)}, and in the "
        "cuspless cardioid at 0.09"
    )
    mixed = len(both) >= 3 and bool(chaotic(cuspless)) and bool(cycles(cuspless))
    return sampled(
        "only periodic in ellipses, none periodic in the cardioid; a mixture over ranges of lam in the other two",
        said,
        bool(periodic) and bool(expands()) and mixed,
    )


@judges("map.sudden_creation")
def sudden_creation(claim: Claim) -> Judgement:
    """A chaotic attractor is born at the orbit through both joins, where the contraction passes `lambda-star`."""
    return Judgement(
        by(
            "an orbit joins the two jumps of the curvature at lam = lambda*, and a chaotic attractor is next to it "
            "from there on",
            corner("exists", "the orbit through both joins"),
            chaos(),
        ),
        "a border collision at lambda* = 0.0712172...; a chaotic attractor next to the orbit from there to 0.1",
    )


def corners() -> SignFinding:
    """The finding that the attractor born at `lambda-star` contains curves with a corner at each join."""
    saddle, slope = all(step.saddle for step in born().steps), Symbol("slope")
    along, across = derivative_matrix() * Matrix([1, slope])
    arc, wall = (curvature(component) for component in tables.cuspless.components)
    return by(
        f"for lambda* < lam <= {PROVED_TO} an unstable cycle lies in the region that is thrown into itself, so "
        "the attractor holds its unstable manifold. A smooth arc of that grows, along the boundary, by a factor above "
        "1 at each half return until it crosses a join, since the region is bounded, and not tangent to it; there the "
        "slope dphi/ds jumps by lam times the jump of the curvature. The cycle is its own mirror image: both joins "
        "are "
        "met",
        chaos(),
        answer(saddle, "a cycle of period 4 that meets the arc next to the joins lies in the region"),
        zero("", simplify((across / along).diff(K1) - lam)),
        zero("the curvature jumps by 3/2 at a join", arc.subs(theta, 2 * pi / 3) + Rational(3, 2), wall),
    )


@judges("map.kink_structure")
def kink_structure(claim: Claim) -> Judgement:
    """Curves of the attractor cross the joins, where their slope jumps by `lam` times the jump of curvature."""
    return Judgement(
        corners(),
        "curves with corners at s = +-sqrt(3)/4, where dphi/ds jumps by 3*lam/2: proved of the attractor "
        f"born at lambda*, all that stays in the region for ever, for lambda* < lam <= {PROVED_TO}",
    )


@judges("map.cascades_of_different_periods")
def different_periods(claim: Claim) -> Judgement:
    """The first two doublings of cycles of three different periods are certified."""
    cascades = doublings()
    told = "; ".join(f"{', '.join(map(str, c.periods))} at {', '.join(f'{x:.6f}' for x in c.lams)}" for c in cascades)
    return sampled(
        "cascades from periods 4, 12 and 9 at alpha = 0.08: two or three doublings of each are proved, supercritical",
        f"doublings of the periods {told}, each certified; that infinitely many follow is extrapolated",
        all(c.proved for c in cascades),
    )


@cache
def doublings() -> list[Cascade]:
    """For each cycle in `DIFFERENT`, the first two doublings of the cascade that starts there."""
    return [cascade(Rational(SHAPE), Rational(at), period, step, 2) for at, period, step in DIFFERENT]


@judges("map.collapse_in_crises")
def collapse(claim: Claim) -> Judgement:
    """Attractors end at the boundary of another basin, or by merging with others."""
    ends = [name for name in CONTACTS if any(kind in name for kind in ("family-end", "window-end", "boundary"))]
    before, after = egg("0.65"), egg("0.67")
    gone = bool(chaotic(before)) and not chaotic(after) and unsettled(after) < 0.1 * STARTS
    return sampled(
        "at the boundary crisis, 0.6621, the attractor meets the edge of the basins of period 3; the smaller ones end "
        "likewise on the stable manifold of the saddle of their fold",
        f"chaotic at lam = 0.65, none at 0.67 among {STARTS} random starts; `pinball locate` proves the tangency of "
        f"manifolds at {len(ends)} such ends and estimates that they are the ends",
        gone,
    )


@judges("map.uniform_contraction")
def uniform_contraction(claim: Claim) -> Judgement:
    """A counterexample: attracting invariant circles exist under the paper's own law."""
    circles, at = rotating()
    return Judgement(
        counterexample("with the paper's own law there are some", circles, at=at),
        "uniform contraction of the angle does not exclude them: it is no contraction of areas at each point, so "
        "multipliers can be complex of modulus 1 at lam < 1, and an attracting circle is born there",
        circles,
        "A uniform contraction of the angle does not exclude such behaviour: with it the egg has attracting invariant "
        "circles with an irrational rotation, next to alpha = 0.06873034, lambda = 0.96378998.",
    )


@judges("map.weak_shows_elliptic")
def weak_shows_elliptic(claim: Claim) -> Judgement:
    """Each cycle that attracts at weak dissipation is close to an elliptic cycle of the elastic map."""
    near = [cycle for cycle in cycles(egg(WEAK)) if cycle.share and cycle.share.count]
    families = {cycle.family: cycle for cycle in near}.values()
    turned = [elastic(cycle) for cycle in families]
    periods = ", ".join(str(cycle.period) for cycle in families)
    return Judgement(
        by(
            f"at alpha = {SHAPE} random starts at lam = {WEAK} reach cycles of period {periods}, and within 0.2 of "
            "each lies a cycle at lam = 1, proved to exist, with |trace| < 2",
            answer(bool(turned) and all(turned), f"{len(turned)} elliptic cycles"),
            proved_at(WEAK, 3),
        ),
        f"at alpha = {SHAPE}, lam = {WEAK} the cycles that random starts reach lie next to elliptic ones of the "
        "elastic map; not every island is shown so, since elliptic orbits may become repelling "
        "(egg.weak_dissipation_attracts)",
    )


def elastic(cycle: Attractor) -> bool:
    """True if a cycle of the elastic map is proved to exist near an attracting cycle, and to be elliptic."""
    proof = certificate(tables.egg(3).at(alpha=SHAPE), S.One, cycle.points, 20)
    apart = max(abs(near(theta, x)) for theta, x in zip(proof.theta, cycle.points.theta, strict=True))
    return proof.is_cycle and bool(abs(proof.trace) < 2) and apart < 0.2


def near(theta: arb, x: float) -> float:
    """The difference between the midpoint of an angle `theta` and `x`, modulo full turns."""
    return float(np.remainder(float(theta.mid()) - x + np.pi, 2 * np.pi) - np.pi)


@judges("map.weak_chaos")
def weak_chaos(claim: Claim) -> Judgement:
    """No cycle is an attracting set; on any attracting set, orbits that miss cusp and joins are unstable."""
    return Judgement(
        by(
            "in the cardioid, for every lam < 1, every orbit that misses the cusp stretches in one direction and "
            "shrinks "
            "in another, and almost every orbit converges to no cycle",
            attracted(),
            two_rates(),
        ),
        "cardioid, lam < 1, and cuspless cardioid, 1/10 <= lam < 1: no cycle off the joins attracts, and every orbit "
        "off "
        f"cusp and joins is unstable, near lam = 1 at a rate of at least {least_exponent()} and {least_rate()}; "
        f"{ONE_PIECE}; {one_set(NEAR_ELASTIC)}",
    )


@judges("map.other_K")
def other_K(claim: Claim) -> Judgement:
    """In the eggs with K = 4, 6 vertices no diameter doubles its period; with K = 5, 7 they do, supercritically."""
    even = [even_stability_numbers(K) for K in EVEN]
    squares = [
        zero("", P - root**2)
        for (vertex, flat), K in zip(even, EVEN, strict=True)
        for P, root in (
            (vertex, ((2 * K**2 + 1) * alpha + 1) / (1 + alpha)),
            (flat, ((2 * K**2 + 1) * alpha - 1) / (1 - alpha)),
        )
    ]
    odd = [doubling_curve(K) for K in ODD]
    never = by(
        "K = 4 and 6: a vertex faces a vertex and a flat point a flat point, the stability number is a square, so "
        "1 + trace + det = (1 + lam)^2*P + (1 - lam)^2 > 0 for lam < 1 and no diameter ever doubles its period: the "
        "first event of the portrait for K = 3 is missing",
        *squares,
    )
    doubles = answer(
        all(sign.proved for sign in odd) or None, "K = 5 and 7: a supercritical doubling for every 0 <= lam < 1"
    )
    return Judgement(
        SignFinding(Outcome.UNKNOWN, f"a question, answered in part: {by('proved', never, doubles).reason}"),
        "for odd K the portrait begins as for K = 3: the diameters double, supercritically for every lam < 1 (proved "
        "for K = 5 and 7), and a tongue follows, sampled; for even K it does not: they never double (proved for K = 4 "
        "and 6), and no tongue was found. Section 'Other numbers of points' of the page on bifurcations follows it "
        "further",
    )
