"""Judges of claims on the cuspless cardioid, and on the domain of the map. Paper: sections 2 and 5.

A double normal of length `L` has the *stability number* `P = (1 + L*kappa)*(1 + L*kappa')`, from the curvatures at its
ends.
"""

from sympy import Expr, Interval, Matrix, Rational, S, Symbol, cos, diff, pi, simplify

from symbolic.cycles.cycle import (
    cardioid_vertical,
    cuspless_horizontal,
    cuspless_vertical,
    frame,
    is_double_normal,
    monodromy,
    multipliers,
    trace_and_determinant,
)
from symbolic.cycles.thresholds import lambda_c, stability_number
from symbolic.expressions.signs import SignFinding, nonnegative, positive
from symbolic.motion.collision import derivative_matrix, exit_angle
from symbolic.tables import cardioid, cuspless
from symbolic.tables.geometry import perimeter, positions, speed, turning, velocity
from symbolic.tables.table import K1, eta, lam, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import (
    by,
    counterexample,
    digits,
    equal,
    greater,
    identity,
    judges,
    on_range,
    shown,
    zero,
)

ARC, WALL = cuspless.components
UPPER_JOIN, LOWER_JOIN = 2 * pi / 3, -2 * pi / 3
C = Symbol("C", real=True)  # cos(theta) on the arc


def wrapped(s: Expr) -> Expr:
    """An arc length reduced to the paper's range, from `-C` to `C`."""
    return s - perimeter(cuspless) if s > perimeter(cuspless) / 2 else s


def on_arc(angle: Expr) -> Expr:
    """The paper's arc length of a point of the arc, from its polar angle."""
    return wrapped(simplify(positions(cuspless)[0].subs(theta, angle)))


def horizontal() -> tuple[Expr, Expr]:
    """Trace and determinant of the horizontal cycle's monodromy matrix."""
    return trace_and_determinant(cuspless_horizontal())


@judges("cuspless.wall_x")
def wall_x(claim: Claim) -> Judgement:
    """Judges the printed abscissa of the wall, by the end points of the arc."""
    return identity(claim, ARC.at(UPPER_JOIN)[0])


@judges("cuspless.wall_y")
def wall_y(claim: Claim) -> Judgement:
    """Judges the printed ends of the wall, by the end points of the arc."""
    return identity(claim, Matrix([ARC.at(LOWER_JOIN)[1], ARC.at(UPPER_JOIN)[1]]))


def arc_turning() -> Expr:
    """`x'y'' - y'x''` on the arc as a function of `C = cos(theta)`."""
    return turning(ARC).subs(cos(theta), C)


def joined_smoothly() -> SignFinding:
    """The finding that the unit tangents agree at both joins."""
    gaps = []
    for angle, end in ((UPPER_JOIN, WALL.start), (LOWER_JOIN, WALL.end)):
        gaps += list(frame(cuspless, 0, angle, {}).tangent - frame(cuspless, 1, end, {}).tangent)
    return zero("the tangents agree at both joins", *gaps)


@judges("cuspless.convex")
def convex(claim: Claim) -> Judgement:
    """The table is convex: the arc turns left, the wall is straight, and the tangents agree at the joins."""
    return Judgement(
        by(
            "the arc turns left, the wall is straight, and the tangent is continuous at the joins",
            positive(arc_turning(), {C: Interval(Rational(-1, 2), 1)}),
            zero("", turning(WALL)),
            joined_smoothly(),
        ),
        "convex: the total turning is 2*pi and never negative",
    )


@judges("cuspless.smooth_except_joins")
def smooth(claim: Claim) -> Judgement:
    """The boundary is smooth except at the joins: each component is analytic with non-zero velocity."""
    squared = (speed(ARC) ** 2).subs(cos(theta), C)
    return Judgement(
        by("the speed does not vanish on the arc", positive(squared, {C: Interval(Rational(-1, 2), 1)})),
        "analytic off the joins",
    )


@judges("cuspless.joins_C1", "cuspless.joins_curvature")
def joins(claim: Claim) -> Judgement:
    """At the joins the tangent is continuous, but the curvature is -3/2 on the arc and 0 on the wall."""
    arc, wall = frame(cuspless, 0, UPPER_JOIN, {}).curvature, frame(cuspless, 1, WALL.start, {}).curvature
    return Judgement(
        by(
            "kappa = -3/2 on the arc's side and 0 on the wall's",
            joined_smoothly(),
            zero("", arc + Rational(3, 2), wall),
        ),
        "C1 with curvature -3/2 and 0",
    )


@judges("cuspless.rightmost_s")
def rightmost(claim: Claim) -> Judgement:
    """The rightmost point is at `theta = 0`, half a perimeter from the centre of the wall."""
    half = perimeter(cuspless) / 2
    return Judgement(
        by(
            "x <= 2 on the arc, and s(0) is half the perimeter",
            nonnegative(2 - C * (1 + C), {C: Interval(Rational(-1, 2), 1)}),
            zero("", positions(cuspless)[0].subs(theta, 0) - half),
        ),
        f"s = +-{half}",
    )


@judges("cuspless.C")
def half_perimeter(claim: Claim) -> Judgement:
    """Both printed forms of `C` are equal to half the perimeter."""
    half = perimeter(cuspless) / 2
    return identity(claim, Matrix([half, half]))


@judges("cuspless.joins_s")
def joins_positions(claim: Claim) -> Judgement:
    """Judges the printed arc lengths of the joins."""
    return identity(claim, Matrix([on_arc(UPPER_JOIN), on_arc(LOWER_JOIN)]))


@judges("cuspless.upper_join_s")
def upper_join(claim: Claim) -> Judgement:
    """Judges the printed arc length of the upper join; counterclockwise, it comes before the wall's centre."""
    return identity(claim, on_arc(UPPER_JOIN))


@judges("cuspless.no_unfolding")
def no_unfolding(claim: Claim) -> Judgement:
    """Unfolding fails, since it replaces a bounce by a straight passage, which requires `phi = -eta`."""
    gap = (exit_angle() + eta) / eta
    return Judgement(
        by(
            "a mirror image is passed straight only if phi = -eta; here phi + eta = (1 - lam)*eta",
            on_range(claim, lambda box: positive(gap.simplify(), box), "").printed,
        ),
        "phi + eta = (1 - lam)*eta",
    )


@judges("cuspless.vertical_orbit")
def vertical(claim: Claim) -> Judgement:
    """The vertical orbit is the same as in the cardioid, with the same stability number above 1."""
    P = stability_number(cuspless_vertical())
    return Judgement(
        by(
            f"P = {P} > 1 at the same two points as in the cardioid",
            shown("normal at both ends", is_double_normal(cuspless_vertical())),
            zero("", P - stability_number(cardioid_vertical())),
            positive(P - 1, {}),
        ),
        f"unstable for every lam, P = {P}",
    )


@judges("cuspless.lambda_c_caption", "cuspless.lambda_c_digits")
def lambda_c_digits(claim: Claim) -> Judgement:
    """Judges the printed digits of `lambda_c`, by its closed form."""
    return digits(claim, lambda_c())


@judges("cuspless.horizontal_orbit", "cuspless.opposite_point")
def horizontal_orbit(claim: Claim) -> Judgement:
    """The horizontal chord is a double normal, so it is an orbit for every contraction."""
    cycle = cuspless_horizontal()
    return Judgement(
        by(
            "the chord along y = 0 is normal at both ends, at s = 0 and s = C",
            shown("", is_double_normal(cycle)),
            zero("", positions(cuspless)[0].subs(theta, 0) - perimeter(cuspless) / 2),
        ),
        "T_lam(0, 0) = (C, 0) and T_lam(C, 0) = (0, 0)",
    )


@judges("cuspless.monodromy")
def horizontal_monodromy(claim: Claim) -> Judgement:
    """The printed matrix is the monodromy matrix at the other base point of the orbit."""
    here, there = (monodromy(cuspless_horizontal(), base) for base in (0, 1))
    return Judgement(
        equal(claim.formula, here, claim.box),
        f"at (0, 0): {here.tolist()}",
        equal(claim.formula, there, claim.box),
        "The printed matrix is D T^2 at the other base point, (C, 0); at x = (0, 0) the off-diagonal entries are "
        f"{here[0, 1]} and {here[1, 0]}. Trace, determinant and eigenvalues are not affected.",
    )


@judges("cuspless.mu")
def horizontal_multipliers(claim: Claim) -> Judgement:
    """Judges the printed multipliers, by the characteristic polynomial."""
    return identity(claim, Matrix(multipliers(*horizontal())))


def real_multipliers() -> SignFinding:
    """The finding that the discriminant of the horizontal orbit is positive on the closed range."""
    trace, det = horizontal()
    return positive(trace**2 - 4 * det, {lam: Interval(0, 1)})


@judges("cuspless.mu_real")
def mu_real(claim: Claim) -> Judgement:
    """The multipliers are real, since the discriminant is positive."""
    return Judgement(real_multipliers(), "real and distinct")


@judges("cuspless.mu_nonpositive")
def mu_nonpositive(claim: Claim) -> Judgement:
    """The multipliers are real, with a negative sum and a non-negative product."""
    trace, det = horizontal()
    box = {lam: Interval(0, 1)}
    return Judgement(
        by("real, with trace < 0 and det >= 0", real_multipliers(), positive(-trace, box), nonnegative(det, box)),
        "mu <= 0",
    )


@judges("cuspless.mu_above_minus_one")
def mu_above_minus_one(claim: Claim) -> Judgement:
    """The multipliers exceed -1 below `lambda_c`, where the characteristic polynomial has the root -1."""
    return Judgement(attracting_below(), "-1 < mu for 0 <= lam < lambda_c")


def attracting_below() -> SignFinding:
    """The finding that the horizontal orbit attracts below `lambda_c`, as its multipliers lie between -1 and 0."""
    trace, det = horizontal()
    factored = Rational(5, 16) * (lam - lambda_c()) * (lam - 1 / lambda_c())
    return by(
        "the characteristic polynomial at -1 is 5/16*(lam - lambda_c)*(lam - 1/lambda_c) > 0 "
        "below lambda_c, and det < 1",
        real_multipliers(),
        equal(1 + trace + det, factored, {}),
        greater(1 / lambda_c(), lambda_c()),
    )


@judges("cuspless.lambda_c")
def period_doubling(claim: Claim) -> Judgement:
    """Judges the printed `lambda_c`, the root of `P = -((1 - lam)/(1 + lam))**2` for `P = -11/16`."""
    judgement = identity(claim, lambda_c())
    return Judgement(judgement.printed, judgement.derived, value=lambda_c())


@judges("cuspless.mu_minus_at_lambda_c")
def mu_at_lambda_c(claim: Claim) -> Judgement:
    """At `lambda_c` the smaller multiplier is -1, since the product of both is `lambda_c**2 < 1`."""
    trace, det = (x.subs(lam, lambda_c()) for x in horizontal())
    root = zero("", 1 + trace + det)
    return Judgement(
        by("-1 is a multiplier and the other is -lambda_c^2", root, equal(claim.formula, -S.One, {})), "-1"
    )


@judges("cuspless.map_nondifferentiable")
def map_nondifferentiable(claim: Claim) -> Judgement:
    """The derivative of the map depends on the curvature at the start, which jumps at the joins."""
    jump = simplify(diff(derivative_matrix(), K1))
    leaves = derivative_matrix(lam=0)[0, 0]
    return Judgement(
        by(
            "DT depends on K0 with slope -t/cos(eta1), and K0 jumps from -3/2 to 0 at a join",
            zero("", leaves.diff(Symbol("K0", real=True)) - derivative_matrix()[0, 1]),
            joins(claim).printed,
        ),
        f"dDT/dK1 = {jump.tolist()}",
    )


@judges("map.noncompact_domain")
def noncompact(claim: Claim) -> Judgement:
    """The cardioid's phase space is not closed: only the normal at the rightmost point hits the cusp."""
    arc = cardioid.components[0]
    start, cusp = arc.at(0), arc.at(pi)
    return Judgement(
        by(
            "in the cardioid the point s = 0, phi = 0 is removed, since its trajectory along y = 0 lands on the cusp; "
            "from the same place no other direction leads there, so points as near to it as wanted are not removed, "
            "and the domain is not closed",
            zero("the cusp is at the pole, on the normal of s = 0", start[1], velocity(arc).subs(theta, 0)[0], *cusp),
            greater(start[0], S.Zero),
        ),
        "not compact where a trajectory can reach a corner",
    )


@judges("cuspless.noncompact")
def cuspless_noncompact(claim: Claim) -> Judgement:
    """Phase space has no gaps at the joins, where the normal is unique; only the derivative is undefined there."""
    return Judgement(
        counterexample(
            "the normal is unique at every point, joins included, so by the definition of section 2 no point is "
            "removed: phase space, the boundary times [-pi/2, pi/2], is compact",
            joined_smoothly(),
            at={lam: S.Half},
        ),
        "after one bounce every ball is in the compact set |phi| <= lam*pi/2, where the map is defined and continuous "
        "for lam < 1; what is not compact is the set where it has a derivative",
        by(
            "a convex table with a continuous tangent: exits off the tangent cross it and land transversally, so the "
            "landing depends continuously on the start",
            joined_smoothly(),
            convex(claim).printed,
        ),
        "The phase space of the cuspless cardioid is compact and the map is continuous on |phi| <= lambda*pi/2, into "
        "which it maps everything; it is the set of points with a derivative that is not compact, without those that "
        "land on a join.",
    )
