"""Judges of claims on the egg's shape, map and figures with captions. Paper: sections 6, 6.1 and 6.4 to 6.7."""

from functools import cache
from itertools import islice

import numpy as np
from sympy import (
    Interval,
    Matrix,
    Rational,
    S,
    Symbol,
    cos,
    diff,
    expand,
    expand_trig,
    pi,
    sin,
)

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.space import followed
from symbolic import tables
from symbolic.cycles.cycle import egg_diameter
from symbolic.cycles.polygons import (
    COSINE,
    curvature_slope_polynomial,
    required_tilt,
    squared_speed_polynomial,
    turning_polynomial,
)
from symbolic.expressions.signs import SignFinding, positive
from symbolic.motion.chords import convexity
from symbolic.motion.flight import flight
from symbolic.tables import egg
from symbolic.tables.curves import trigonometric
from symbolic.tables.table import alpha, lam, phi, theta
from verification.cycles.cascade import doublings
from verification.named.crises import changed_axis, stay
from verification.named.locate import proof_near
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, equal, identity, judges, sampled, zero
from verification.paper.egg.period2 import FULL, ROUND, SHAPES
from verification.proofs.periodic.cycle_in_box import UniqueCycle

BOUNDARY = egg(3).components[0]


@judges("egg.polar")
def radius(claim: Claim) -> Judgement:
    """Judges the printed polar equation by the distance to the centre in the direction `theta`."""
    x, y = BOUNDARY.point
    return identity(claim, trigonometric(x * cos(theta) + y * sin(theta)))


@judges("egg.circle")
def circle(claim: Claim) -> Judgement:
    """The table is a circle at `alpha = 0`."""
    x, y = (coordinate.subs(alpha, 0) for coordinate in BOUNDARY.point)
    return Judgement(by("rho = 1", zero("", x**2 + y**2 - 1)), "x^2 + y^2 = 1")


@judges("egg.symmetry")
def symmetry(claim: Claim) -> Judgement:
    """The rotation by a third of a turn maps the boundary to itself."""
    third = 2 * pi / 3
    turn = Matrix([[cos(third), -sin(third)], [sin(third), cos(third)]])
    moved = Matrix(BOUNDARY.point).subs(theta, theta + third)
    gap = (moved - turn * Matrix(BOUNDARY.point)).applyfunc(lambda e: expand(expand_trig(e)))
    return Judgement(by("z(theta + 2*pi/3) is z(theta) turned by 2*pi/3", zero("", *gap)), "3-fold")


@judges("egg.nonconvex")
def nonconvex(claim: Claim) -> Judgement:
    """For `1/10 < alpha < 1` the boundary turns right at the flat points, as `(1 - alpha)*(1 - 10*alpha) < 0`."""
    flat = turning_polynomial().subs(COSINE, -1)
    return Judgement(
        by(
            "the boundary turns right at the flat points for 1/10 < alpha < 1; from alpha = 1 on it is no simple curve",
            equal(flat, (1 - alpha) * (1 - 10 * alpha), {}),
            positive(-flat, {alpha: Interval.open(Rational(1, 10), 1)}),
        ),
        "x'y'' - y'x'' = (1 - alpha)*(1 - 10*alpha) at theta = pi/3",
    )


@judges("egg.convex")
def convex(claim: Claim) -> Judgement:
    """The egg is convex on the closed range of `alpha`, but strictly focusing only without the end point 1/10."""
    flat_end = turning_polynomial().subs({COSINE: -1, alpha: Rational(1, 10)})
    focusing = convexity(egg(3), {alpha: Interval.Ropen(0, Rational(1, 10))}, strictly=True)
    return Judgement(
        counterexample(
            "at alpha = 1/10 the curvature of the flat points is 0, and a focusing component has none",
            zero("", flat_end),
            at={alpha: Rational(1, 10)},
        ),
        "convex for alpha in [0, 1/10], focusing for alpha in [0, 1/10)",
        by("x'y'' - y'x'' > 0 below 1/10 and >= 0 at it", focusing, convexity(egg(3))),
        "At alpha = 1/10 the table is still convex but no longer focusing: the curvature vanishes at three points.",
    )


def regular() -> SignFinding:
    """The finding that the parametrisation has non-zero speed everywhere."""
    return by("rho^2 + rho'^2 > 0", positive(squared_speed_polynomial(), {COSINE: FULL, alpha: SHAPES}))


@judges("egg.analytic")
def analytic(claim: Claim) -> Judgement:
    """The boundary is a trigonometric polynomial with non-vanishing velocity."""
    return Judgement(regular(), "a regular analytic closed curve")


@judges("egg.compact_domain")
def compact_domain(claim: Claim) -> Judgement:
    """The domain of the map is a circle times a closed interval of angles."""
    N = convexity(egg(3))
    return Judgement(
        by(
            "no corner and no tangency on the way (the table is convex), so the domain is boundary x [-pi/2, pi/2]",
            regular(),
            N,
        ),
        "boundary x [-pi/2, pi/2]",
    )


@judges("egg.curvature_min_location", "egg.curvature_max_location")
def extrema(claim: Claim) -> Judgement:
    """The curvature is extremal at the vertices and flat points: `|kappa|` grows strictly with `cos(3*theta)`."""
    slope = curvature_slope_polynomial()
    return Judgement(
        counterexample(
            "at alpha = 0 the table is a circle and every point is extremal",
            zero("", slope.subs(alpha, 0)),
            at={alpha: S.Zero},
        ),
        "|kappa| grows strictly with cos(3*theta): least at pi/3, pi, -pi/3, largest at 0, 2*pi/3, "
        "-2*pi/3, for alpha in (0, 1/10]",
        by("d|kappa|/d cos(3*theta) > 0", positive(slope, {COSINE: FULL, alpha: ROUND})),
        "At alpha = 0 every point is extremal; the statement needs alpha > 0.",
    )


@judges("egg.curvature_min")
def flat_curvature(claim: Claim) -> Judgement:
    """Judges the printed curvature at a flat point, which is one end of a diameter."""
    return identity(claim, egg_diameter().frames[1].curvature)


@judges("egg.curvature_max")
def vertex_curvature(claim: Claim) -> Judgement:
    """Judges the printed curvature at a vertex, which is the other end of a diameter."""
    return identity(claim, egg_diameter().frames[0].curvature)


@judges("egg.integrable_at_zero")
def integrable(claim: Claim) -> Judgement:
    """In the circle with elastic collisions, `phi` is a constant of motion."""
    return Judgement(
        by("at alpha = 0, lam = 1 the map keeps phi", zero("", flight()[1].subs(lam, 1) - phi)), "phi1 = phi"
    )


@judges("egg.slap_limit")
def slap_limit(claim: Claim) -> Judgement:
    """The limit as `alpha -> 0` is the circle's slap map; it is continuous because all landings are transversal."""
    return identity(claim, flight(theta, S.Zero)[0])


@judges("egg.map_smooth")
def map_smooth(claim: Claim) -> Judgement:
    """The map is analytic: the flight equation has slope `cos(eta1) > 0` at the landing point."""
    return Judgement(
        by(
            "the flight equation is analytic with slope cos(eta1) != 0 for |phi0| < pi/2 in a convex "
            "table: implicit function theorem",
            regular(),
            convexity(egg(3)),
        ),
        "analytic for |phi| < pi/2",
    )


@judges("egg.persistence")
def persistence(claim: Claim) -> Judgement:
    """Attracting and hyperbolic cycles persist, since no multiplier is 1."""
    trace, det, mu = Symbol("trace"), Symbol("det"), Symbol("mu")
    gap = (mu**2 - trace * mu + det).subs(mu, 1) - (1 - trace + det)
    return Judgement(
        by(
            "attracting and hyperbolic cycles have det(D(T^n) - 1) = 1 - trace + det != 0: implicit function theorem",
            zero("", gap),
        ),
        "persists while no multiplier is 1",
    )


SHAPE = Rational(2, 25)
SEED = 1
SIDE = {12: (0.3725, (-1.544175, -0.015589)), 8: (0.379, (-2.258379, -0.040530))}  # lam, and (theta, phi)
MEMBERS, STARTS = 2, 8000
SOON, EARLY = 250, 1000  # bounces after which many, and most, orbits have reached a cycle and are dropped


@judges("egg.period3_direction")
def period3_direction(claim: Claim) -> Judgement:
    """The bounces of the two triangles move in opposite directions, as a derivative along the branch shows."""
    c = Symbol("c", real=True)
    rho = 1 + alpha * cos(3 * theta)
    return Judgement(
        by(
            "from the flat point, c = -1, to the fold, c = -alpha, the bounce of the triangle that the ball runs "
            "anti-clockwise grows with T, and T grows as lam falls; the other triangle is its mirror image",
            zero("", rho * diff(rho, theta, 2) - diff(rho, theta) ** 2 + 9 * alpha * (cos(3 * theta) + alpha)),
            positive(-SHAPE - c, {c: Interval.Ropen(-1, -SHAPE)}),
            positive(-diff(required_tilt(), lam), {lam: Interval(0, 1)}),
        ),
        "one of the two turns anti-clockwise, the other clockwise",
    )


@judges("egg.stays_long")
def stays_long(claim: Claim) -> Judgement:
    """Measures the mean number of bounces of an orbit before it changes to another diameter."""
    mean = stay(changed_axis, str(SHAPE), 0.45, 10**6)
    said = f"an orbit at lam = 0.45 makes {mean:.0f} bounces on average near one diameter, over 10^6 bounces"
    return sampled(f"{mean:.0f} bounces", said, mean > 100)


@cache
def side_cascade(period: int) -> tuple[UniqueCycle, ...]:
    """The first doublings of a cascade that is not the paper's; each is certified."""
    table, (lam_at, (theta, phi)) = tables.egg(3).at(alpha=SHAPE), SIDE[period]
    settled = PinballMap("egg", lam=lam_at, alpha=str(SHAPE)).orbit(theta, phi, 4000)
    found = doublings(table, settled.theta[-period:].tolist(), lam_at, 2e-4)
    return tuple(proof_near(each.problem, each.start, 10) for each in islice(found, MEMBERS))


@judges("egg.noise")
def noise(claim: Claim) -> Judgement:
    """For two cascades of other cycles, the first doublings are proved; chaos and its end are sampled."""
    sentences, holds = [], True
    for period, chaotic, gone in ((12, "0.375", "0.3765"), (8, "0.382", "0.3835")):
        proofs = side_cascade(period)
        holds = holds and all(proof.proved and proof.supercritical for proof in proofs)
        flips = " and ".join(f"{float(proof.value.mid()):.7f}" for proof in proofs)
        inside, outside = chaotic_share(chaotic), chaotic_share(gone)
        holds = holds and inside > 0 and outside == 0
        sentences.append(
            f"period {period} doubles and doubles again at lam = {flips} (certified, supercritical); sampled at "
            f"{chaotic}, {inside:.1%} of {STARTS} random starts are chaotic, and {outside:.1%} at {gone}"
        )
    return sampled("; ".join(sentences), "; ".join(sentences), holds)


def chaotic_share(lam_text: str) -> float:
    """The fraction of random starts with a positive exponent after a long time."""
    map = PinballMap("egg", lam=lam_text, alpha=str(SHAPE))
    starts = interior_starts(map, STARTS, SEED)
    rest = followed(map, starts, (SOON, EARLY))
    if not rest.going.size:
        return 0.0
    late = map.exponents(rest.growth.theta, rest.growth.phi, 500, 4000 - EARLY)
    return float(np.sum(late.nu_plus > 0.02)) / STARTS
