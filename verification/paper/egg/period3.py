"""Judges of claims on the egg's period-3 orbits. Paper: sections 6.1 and 6.4."""

from functools import cache

from sympy import (
    Interval,
    Matrix,
    Not,
    Rational,
    S,
    cos,
    pi,
    simplify,
    sin,
    symbols,
    tan,
)

from symbolic.cycles.cycle import egg_triangle, is_elastic, trace_and_determinant
from symbolic.cycles.polygons import (
    COSINE,
    characteristic_on_branch,
    contraction_slope,
    elastic_trace,
    fold_margin,
    half_turn,
    largest_tilt,
    polygon_identities,
    required_tilt,
    saddle_node,
    tilt_tangent,
)
from symbolic.expressions.signs import SignFinding, conjunction, nonnegative, positive
from symbolic.motion.flight import flight, iterate
from symbolic.tables.table import alpha, lam, phi, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, digits, greater, identity, implied, judges, shown, zero
from verification.paper.egg.period2 import FULL, ROUND, SHAPES, at

MOVED = symbols("x", real=True)  # 3*theta - pi at a bounce, 0 at lam = 1
PLACE_RETURNS, ANGLE_RETURNS = symbols("place_returns angle_returns")  # theta_3 = theta_0, phi_3 = phi_0


def exit_sines(at_flat: bool) -> Matrix:
    """The sine of the exit angle on an equilateral triangle, for both directions of travel."""
    out, _ = egg_triangle(at_flat).sliding(0)
    return Matrix([out, -out])


@judges("egg.period3_angle")
def flat_angle(claim: Claim) -> Judgement:
    """The exit angles of the triangle at the flat points are 30 degrees in both directions of travel."""
    return identity(claim, exit_sines(True))


@judges("egg.hyperbolic3_angle")
def vertex_angle(claim: Claim) -> Judgement:
    """The exit angles of the triangle at the vertices are 30 degrees in both directions of travel."""
    return identity(claim, exit_sines(False))


def limit_positive() -> SignFinding:
    """The finding that `0 < lambda_c(alpha) < 1`, since `|rho'/rho|` has a maximum between 0 and `tan(pi/6)`."""
    squared = simplify(largest_tilt() ** 2)
    return conjunction(positive(Rational(1, 3) - squared, {alpha: ROUND}), positive(squared, {alpha: ROUND}))


@judges("egg.period3_created", "egg.period3_cease")
def created(claim: Claim) -> Judgement:
    """Judges the fold's closed form for the equilateral triangles that section 6.4 follows from `lam = 1`."""
    return Judgement(
        by(
            "the equilateral orbits need |rho'/rho| = tan(pi/6*(1-lam)/(1+lam)), which no point reaches for lam < "
            "lambda_c; in the circle lambda_c = 1, and below it every orbit tends to a diameter",
            *polygon_facts(),
            limit_positive(),
            zero("lambda_c(0) = 1", saddle_node().subs(alpha, 0) - 1),
            zero("in the circle phi_3 = lam^3*phi", iterate(3)[1] - lam**3 * phi),
        ),
        "the equilateral orbits, which those of lam = 1 through the flat points and the vertices are, exist for lam >= "
        f"lambda_c alone, lambda_c(alpha) = {saddle_node()}; of others this says nothing (that there are none below "
        "0.378 at alpha = 0.08 is egg.no_period3_caption)",
    )


def third_power(at_flat: bool) -> SignFinding:
    """The finding that the triangle's monodromy matrix has the trace of the cube of one flight's matrix."""
    single = elastic_trace(at_flat)
    return zero(
        "the monodromy is a cube", single**3 - 3 * single - trace_and_determinant(egg_triangle(at_flat), S.One)[0]
    )


@judges("egg.two_period3")
def two_period3(claim: Claim) -> Judgement:
    """The triangle at the flat points can be travelled in two directions, which gives two orbits."""
    return Judgement(
        counterexample(
            "at alpha = 0 every equilateral triangle is an orbit",
            zero("", flight(s, pi / 6)[0] - s - 2 * pi / 3),
            at={alpha: S.Zero},
        ),
        "for 0 < alpha <= 1/10 the triangle of the flat points, run in both directions, with "
        "eigenvalues on the unit circle",
        by("an elastic cycle, run both ways, with |trace| <= 2", *flat_triangle()),
        "At alpha = 0 there is a continuum of period-3 orbits; two need alpha > 0.",
    )


def flat_triangle() -> list[SignFinding]:
    """The findings that the triangle at the flat points obeys the elastic law and has multipliers of modulus 1."""
    single = elastic_trace(True)
    return [
        shown("the law phi = -eta holds", is_elastic(egg_triangle(True))),
        third_power(True),
        nonnegative(4 - single**2, {alpha: SHAPES}),
    ]


@judges("egg.period3_pair")
def pair(claim: Claim) -> Judgement:
    """An elastic orbit travelled backwards is an orbit, too."""
    return Judgement(
        by("an elastic orbit run backwards is an orbit with opposite angles", *flat_triangle()[:1]), "phi -> -phi"
    )


@judges("egg.period3_equilateral")
def equilateral(claim: Claim) -> Judgement:
    """The three chords of the triangle are equal."""
    cycle = egg_triangle(True)
    return Judgement(
        by("the three chords are equal", zero("", *(cycle.length(i) - cycle.length(0) for i in (1, 2)))),
        f"side {cycle.length(0)}",
    )


@judges("egg.period3_elliptic")
def period3_elliptic(claim: Claim) -> Judgement:
    """The triangle is elliptic: `|trace| <= 2` on the closed range, with equality only at the ends."""
    single = elastic_trace(True)
    return Judgement(
        by(
            "one flight has determinant 1 and trace (2 - 38*alpha)/(1 - alpha), of modulus at most 2; "
            "it is 2 and -2 at the ends "
            "alpha = 0, 1/10, and the cube is -1 and 1 at alpha = 1/37, 1/13",
            *flat_triangle(),
            zero("", single - (2 - 38 * alpha) / (1 - alpha)),
        ),
        "eigenvalues on the unit circle for every alpha in [0, 1/10], real (1 or -1) at alpha = 0, 1/37, 1/13, 1/10",
    )


def polygon_facts() -> list[SignFinding]:
    """The findings on rotating triangles: the angle from radius to normal, its maximum, and that the law holds."""
    slope = simplify(tilt_tangent() * (1 + alpha * cos(3 * theta)) / (3 * alpha)) - sin(3 * theta)
    squared = 9 * alpha**2 * (1 - COSINE**2) / (1 + alpha * COSINE) ** 2
    best = 9 * alpha**2 * (COSINE + alpha) ** 2 / ((1 - alpha**2) * (1 + alpha * COSINE) ** 2)
    gamma, delta = half_turn(), required_tilt()
    return [
        zero("tan(delta) = 3*alpha*sin(3*theta)/(1 + alpha*cos(3*theta))", slope),
        zero(
            "its square falls short of 9*alpha^2/(1 - alpha^2) by a square, zero where cos(3*theta) = -alpha",
            simplify(largest_tilt() ** 2) - squared - best,
        ),
        zero("the law gamma - delta = lam*(gamma + delta)", gamma - delta - lam * (gamma + delta)),
    ]


@judges("egg.period3_attracting")
def attracting(claim: Claim) -> Judgement:
    """The triangle attracts near `lam = 1`: its multipliers are complex with modulus `det**(1/2) < 1`.

    At `alpha = 1/10` and `lam = 1` both multipliers of a bounce are -1, so second-order terms decide. The circle has no
    triangle for `lam < 1`.
    """
    gamma, single = half_turn(), elastic_trace(True)
    margin = characteristic_on_branch(MOVED, -S.One).subs(alpha, Rational(1, 10))  # (1 + trace + det)*cos(eta)
    first, second = margin.diff(MOVED).subs(MOVED, 0), margin.diff(MOVED, 2).subs(MOVED, 0)
    return Judgement(
        counterexample(
            "in the circle phi_3 = lam^3*phi: below lam = 1 only orbits with phi = 0 come back, which have period 2",
            zero("", iterate(3)[1] - lam**3 * phi),
            at={alpha: S.Zero, lam: S.Half},
        ),
        "attracting for lam slightly below 1, for every alpha with 0 < alpha <= 1/10",
        by(
            "at lam = 1 one bounce has the determinant 1 and a trace of modulus below 2, so near lam = 1 its "
            "multipliers are complex, of modulus det^(1/2), and det grows up to lam = 1; at alpha = 1/10 the trace is "
            "-2 there, and 1 + trace + det > 0 next to it by its second order along the branch",
            *polygon_facts(),
            positive(4 - single**2, {alpha: Interval.open(0, Rational(1, 10))}),
            third_power(True),
            zero("d(log det)/d lam = 1 - gamma*tan(gamma) at lam = 1", contraction_slope() - 1 + gamma * tan(gamma)),
            greater(contraction_slope(), S.Zero),
            zero("1 + trace + det vanishes to first order", margin.subs(MOVED, 0), first),
            greater(second, S.Zero),
            *side_of_fold(),
        ),
        "At alpha = 0 (the circle) no triangle is left below lambda = 1; the statement needs alpha > 0.",
    )


@judges("egg.period3_stay_equilateral")
def stay(claim: Claim) -> Judgement:
    """The triangles stay equilateral as `lam` falls, since one equation in `theta` determines all three bounces."""
    return Judgement(
        by(
            "a triangle turned by 2*pi/3 at each bounce solves the one equation |rho'/rho| = tan(delta(lam))",
            *polygon_facts(),
            limit_positive(),
        ),
        "equilateral for lambda_c(alpha) <= lam <= 1",
    )


@judges("egg.period3_rotate")
def rotate(claim: Claim) -> Judgement:
    """The triangles rotate: for `lam < 1` their normals are not radial, so `sin(3*theta) != 0`."""
    return Judgement(
        by(
            "delta = pi/6*(1-lam)/(1+lam) > 0 needs sin(3*theta) != 0",
            *polygon_facts(),
            positive(required_tilt().subs(pi, 3), {lam: Interval.Ropen(0, 1)}),
        ),
        "tan(delta) = |rho'/rho|",
    )


@judges("egg.period3_lambda_c")
def fold_digits(claim: Claim) -> Judgement:
    """Judges the printed digits of `lambda_c`, from the closed form at `alpha = 0.08`."""
    return digits(claim, saddle_node().subs(alpha, at("0.08")), ("0.39", "0.378"))


@judges("egg.projection_argument")
def projection(claim: Claim) -> Judgement:
    """A cycle of period 3 returns to its position after three bounces; if no position returns, none exists."""
    return Judgement(
        implied(
            "T^3(theta, phi) = (theta, phi) says that the place returns and that the angle does; so where no place "
            "returns there is no such point, and no cycle of period 3",
            Not(PLACE_RETURNS) >> Not(PLACE_RETURNS & ANGLE_RETURNS),
        ),
        "a necessary condition",
    )


@judges("egg.projection_converse")
def converse(claim: Claim) -> Judgement:
    """A counterexample to the converse: in the circle, `T^3` can return to a position, with another angle."""
    angle = flight(*flight(*flight()))
    back = angle[0] - s - 2 * pi
    returning = pi / (2 * (1 + lam + lam**2))
    return Judgement(
        by(
            "in the circle theta_3 = theta_0 at an angle phi = pi/(2*(1 + lam + lam^2)) that is not "
            "kept, phi_3 = lam^3*phi",
            zero("", back.subs(phi, returning), angle[1] - lam**3 * phi),
        ),
        "position alone does not close an orbit",
    )


@judges("egg.saddle_node")
def fold(claim: Claim) -> Judgement:
    """The branches from flat points and vertices meet where `|rho'/rho|` is largest; a multiplier is 1 there."""
    return Judgement(
        by(
            "for each lam in (lambda_c, 1) the equation for the tilt has one root on the side of the "
            "flat points, cos(3*theta) < -alpha, and one on "
            "the side of the vertices; they meet at cos(3*theta) = -alpha where d(rho'/rho)/d theta = "
            "0, a simple maximum",
            *polygon_facts(),
            *side_of_fold(),
        ),
        f"lambda_c(alpha) = {saddle_node()}",
        value=saddle_node().subs(alpha, at("0.08")),
    )


@judges("egg.period3_exponent")
def multiplier_at_fold(claim: Claim) -> Judgement:
    """The multiplier at the fold is 1, since `1 - trace + det` of one bounce vanishes there."""
    return Judgement(
        by("one multiplier of a bounce tends to 1 as cos(3*theta) -> -alpha", *side_of_fold()),
        "multiplier 1 at lambda_c",
    )


@cache
def side_of_fold() -> tuple[SignFinding, ...]:
    """The findings that `1 - trace + det` of one bounce has the sign of `-(cos(3*theta) + alpha)` on both branches."""
    ring = 1 + alpha * COSINE
    return (
        *(zero(fact, difference) for fact, difference in polygon_identities().items()),
        zero(
            "rho*rho'' - rho'^2 = -9*alpha*(cos(3*theta) + alpha)",
            fold_margin() + 9 * alpha * (cos(3 * theta) + alpha),
        ),
        positive(ring, {COSINE: FULL, alpha: SHAPES}),
        greater(cos(half_turn()), S.Zero),
        by(
            "cos(eta) > 0, as gamma = pi/6 and tan(delta)^2 < 1/3",
            positive(Rational(1, 3) - simplify(largest_tilt() ** 2), {alpha: SHAPES}),
        ),
    )


@judges("egg.vertex_period3")
def vertex_period3(claim: Claim) -> Judgement:
    """The triangle of the vertices obeys the elastic law."""
    return Judgement(
        shown("the triangle of the vertices obeys phi = -eta", is_elastic(egg_triangle(False))),
        "theta = 0, 2*pi/3, -2*pi/3 at lam = 1",
    )


@judges("egg.vertex_period3_unstable")
def vertex_unstable(claim: Claim) -> Judgement:
    """The triangle of the vertices has a multiplier above 1 along its branch, except at `alpha = 0`."""
    at_one = elastic_trace(False)
    return Judgement(
        counterexample(
            "at alpha = 0 the triangle is parabolic",
            zero("", at_one.subs(alpha, 0) - 2),
            at={alpha: S.Zero, lam: S.One},
        ),
        "unstable for alpha in (0, 1/10] and lambda_c(alpha) < lam <= 1",
        by(
            "1 - trace + det < 0 on the vertices' side of the fold, so one multiplier exceeds 1",
            *polygon_facts(),
            *side_of_fold(),
            positive(at_one - 2, {alpha: ROUND}),
        ),
        "At alpha = 0 (the circle) the triangles are parabolic, not unstable; the statement needs alpha > 0.",
    )
