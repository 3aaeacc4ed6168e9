"""Judges of claims on the cardioid. Paper: section 4."""

from sympy import Expr, Function, Interval, Matrix, Rational, S, Symbol, cancel, cos, pi, sin, sqrt

from symbolic.cycles.cardioid_slap import (
    LAUNCH_COS2,
    expands_by,
    expansion_infimum,
    fixed_points,
    forward_once,
    infimum_attained,
    parametrised,
    q,
    slope_squared,
    slow_region,
)
from symbolic.cycles.cycle import Cycle, cardioid_vertical, is_double_normal
from symbolic.cycles.thresholds import stability_number
from symbolic.expressions.signs import SignFinding, conjunction, positive
from symbolic.motion.collision import determinant, growth_defects, telescoped
from symbolic.tables import cardioid
from symbolic.tables.curves import trigonometric
from symbolic.tables.geometry import arc_length, centre_of_curvature, curvature, velocity
from symbolic.tables.table import Component, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, equal, identity, judges, zero

BOUNDARY = cardioid.components[0]
C = Symbol("C", real=True)  # cos(theta)


def position(angle: Expr) -> Expr:
    """The paper's arc length at a polar angle."""
    return arc_length(BOUNDARY).subs(theta, angle)


@judges("cardioid.polar")
def radius(claim: Claim) -> Judgement:
    """Judges the printed polar equation, by the distance to the pole in the direction `theta`."""
    x, y = BOUNDARY.point
    return identity(claim, trigonometric(x * cos(theta) + y * sin(theta)))


@judges("cardioid.arc_length")
def length(claim: Claim) -> Judgement:
    """Judges the printed arc length, by the integral of the speed `sqrt(2 + 2*cos(theta))`."""
    return identity(claim, arc_length(BOUNDARY))


@judges("cardioid.flattest_point", "cardioid.minimal_curvature")
def flattest(claim: Claim) -> Judgement:
    """The flattest point is the rightmost: `x = C*(1 + C)` and `kappa**2 = 9/(8*(1 + C))` with `C = cos(theta)`."""
    rest = Interval.Ropen(-1, 1)
    squared = cancel(curvature(BOUNDARY) ** 2).subs(cos(theta), C)
    return Judgement(
        by(
            "for cos(theta) < 1 x is below 2 and kappa^2 above 9/16",
            positive(2 - C * (1 + C), {C: rest}),
            positive(squared - Rational(9, 16), {C: Interval.open(-1, 1)}),
            zero("", position(S.Zero)),
        ),
        "s = 0 is the rightmost point, and |kappa| is least there, 3/4",
    )


@judges("cardioid.cusp_s")
def cusp_position(claim: Claim) -> Judgement:
    """Judges the printed arc lengths of the cusp, by the closed form at both ends."""
    return identity(claim, Matrix([position(-pi), position(pi)]))


@judges("cardioid.vertical_orbit_s")
def vertical_position(claim: Claim) -> Judgement:
    """Judges the printed arc lengths of the bounces of the vertical cycle."""
    return identity(claim, Matrix([position(angle) for _, angle in cardioid_vertical().bounces]))


@judges("cardioid.curvature_polar")
def polar_curvature(claim: Claim) -> Judgement:
    """Judges the printed curvature of the curve `rho(theta)`, for an undetermined function `rho`."""
    rho = Function("rho", real=True)(theta)
    general = curvature(Component("polar", (rho * cos(theta), rho * sin(theta)), -pi, pi))
    orders = {rho.diff(theta, 2): claim.names["rho2"], rho.diff(theta): claim.names["rho1"], rho: claim.names["rho"]}
    for derivative, letter in orders.items():
        general = general.subs(derivative, letter)
    return identity(claim, general)


@judges("cardioid.curvature")
def own_curvature(claim: Claim) -> Judgement:
    """Judges the printed curvature of the cardioid, by the definition of curvature."""
    return identity(claim, curvature(BOUNDARY))


@judges("cardioid.cusp_undefined")
def cusp_undefined(claim: Claim) -> Judgement:
    """The map is undefined at the cusp: the velocity `2*cos(theta/2)*(-sin, cos)(3*theta/2)` vanishes and reverses."""
    half = Symbol("half", real=True)
    moving = velocity(BOUNDARY).subs(theta, 2 * half)
    direction = Matrix([-sin(3 * half), cos(3 * half)])
    ends = [Matrix([-direction[1], direction[0]]).subs(half, end) for end in (pi / 2, -pi / 2)]
    return Judgement(
        by(
            "the normals from the two sides are opposite, (0, 1) and (0, -1)",
            equal(moving, 2 * cos(half) * direction, {}),
            zero("", *(ends[0] + ends[1])),
        ),
        "the normal jumps by pi at the cusp",
    )


@judges("cardioid.lyapunov_sum_area")
def exponent_sum(claim: Claim) -> Judgement:
    """The sum of exponents is the mean of `log|det DT|`, since determinants multiply along an orbit."""
    return Judgement(
        by(
            "the growth rates of both normalising factors of D(T^n) add up to that of |det D(T^n)|, which is the mean "
            "of log|det DT| along the orbit, because determinants multiply",
            zero("", *growth_defects()),
            zero("the sum over a flight", telescoped(1) - 1),
        ),
        f"the mean of log({determinant()})",
    )


def slap_facts() -> tuple[SignFinding, SignFinding]:
    """The findings that the algebraic parametrisation of the slap map is correct and meets each landing point once."""
    return parametrised(), forward_once()


@judges("cardioid.slap_slow", "cardioid.slap_fast")
def slow_and_fast(claim: Claim) -> Judgement:
    """The slap map's slope `T0'` is below 1 on a region between two roots of `T0' = 1`, and above 1 elsewhere."""
    first, last = (edge.n(6) for edge in slow_region())
    return Judgement(
        by(
            f"T0' < 1 exactly for {first} < |s| < {last}; it tends to infinity as s -> 0, where the "
            "normal runs into the cusp",
            *slap_facts(),
            positive(1 - slope_squared(Rational(-3, 5)), {}),
            positive(slope_squared(S.Zero) - 1, {}),
        ),
        f"T0' < 1 for {first} < |s| < {last}, T0' > 1 elsewhere",
    )


@judges("cardioid.slap_slow_caption")
def slow_caption(claim: Claim) -> Judgement:
    """The caption confuses the cusp with the flattest point, which is at the other end of the boundary."""
    first, last = (edge.n(6) for edge in slow_region())
    return Judgement(
        counterexample("s = 0 is the flattest point; the cusp is at s = +-4", zero("", position(pi) - 4)),
        f"|T0'| < 1 for {first} < |s| < {last}, near the flattest point s = 0",
        by("T0' < 1 at the landing point q = -3/5", *slap_facts(), positive(1 - slope_squared(Rational(-3, 5)), {})),
        "The caption's 'near the cusp at s = 0' should read 'near the flattest point s = 0' (the cusp is at s = +-4).",
    )


def expansion() -> SignFinding:
    """The finding that `|(T0**2)'| > 3/2` everywhere for the slap map `T0`, and that the minimum is attained."""
    return by(
        "(T0^2)' > 3/2 at every point whose two flights are defined, and its infimum is attained",
        *slap_facts(),
        expands_by(Rational(3, 2)),
        infimum_attained(),
    )


@judges("cardioid.slap_expanding_caption")
def expanding_caption(claim: Claim) -> Judgement:
    """The caption gives the slope of the slap map `T0` as that of `T0^2`."""
    slow = positive(1 - slope_squared(Rational(-3, 5)), {})
    return Judgement(
        counterexample(
            "T0' < 1 at the landing point q = -3/5",
            *slap_facts(),
            slow,
            at={s: 4 * sqrt(1 - LAUNCH_COS2.subs(q, Rational(-3, 5)))},
        ),
        "|(T0^2)'(s)| > 1 everywhere",
        expansion(),
        "The caption's |T_0'(s)| > 1 should read |(T_0^2)'(s)| > 1; T_0' itself is below 1 in places.",
        value=expansion_infimum(),
    )


@judges("cardioid.slap_expanding", "cardioid.slap_second_derivative")
def expanding(claim: Claim) -> Judgement:
    """The second iterate of the slap map expands, by Sturm's theorem on an algebraic parametrisation."""
    return Judgement(expansion(), "inf (T0^2)' = 1.506262..., on orbits that cross the axis", value=expansion_infimum())


def q_landing(cycle: Cycle) -> Expr:
    """The coordinate `q = sin(t)/sqrt(1 + 7*cos(t)**2)` of the second bounce `theta = 2*t` of a cycle."""
    half = cycle.bounces[1][1] / 2
    return sin(half) / sqrt(1 + 7 * cos(half) ** 2)


def alone(landing: Expr) -> tuple[SignFinding, SignFinding]:
    """The findings that `T0^2` has one pair of fixed points, mirror images, and that they land at `q = landing`."""
    found = fixed_points()
    here = [zero("it is the one that was counted", end - landing) for ends in found for end in ends]
    return answer(len(found) == 1, "Sturm: T0^2 has one mirror pair of fixed points"), conjunction(*here)


@judges("cardioid.vertical_orbit")
def vertical_orbit(claim: Claim) -> Judgement:
    """The vertical orbit is an unstable double normal; it gives the only fixed points of `T0^2`."""
    cycle = cardioid_vertical()
    P = stability_number(cycle)
    return Judgement(
        by(
            f"the chord is normal at both ends and (T0^2)' = P = {P} > 1; T0^2 has no other fixed point",
            answer(is_double_normal(cycle), "normal at both ends"),
            positive(P - 1, {}),
            *slap_facts(),
            *alone(q_landing(cycle)),
        ),
        f"an orbit of period 2 through theta = +-pi/3 with (T0^2)' = {P}",
    )


@judges("cardioid.evolute")
def cardioid_evolute(claim: Claim) -> Judgement:
    """The evolute is a cardioid: the centre of curvature is `2/3 - z(theta + pi)/3`."""
    mirrored = [-coordinate.subs(theta, theta + pi) / 3 for coordinate in BOUNDARY.point]
    return Judgement(
        by(
            "the centre of curvature is (2/3, 0) - z(theta + pi)/3",
            equal(centre_of_curvature(BOUNDARY), Matrix([Rational(2, 3) + mirrored[0], mirrored[1]]), {}),
        ),
        "(2/3, 0) - z(theta + pi)/3",
    )
