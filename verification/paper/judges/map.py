"""Judges of claims on the pinball billiard map in general. Paper: abstract and sections 1, 2."""

from sympy import Expr, Function, Integer, Interval, Matrix, Rational, S, acos, cancel, cos, oo, pi, sqrt

from symbolic import tables
from symbolic.cycles.polygons import COSINE, in_cosine
from symbolic.expressions.signs import SignFinding, nonnegative, positive
from symbolic.motion.collision import birkhoff_matrix, derivative_matrix, determinant, exit_angle, slap_derivative
from symbolic.motion.flight import flight, iterate
from symbolic.tables.geometry import turning
from symbolic.tables.table import K1, a, alpha, cos_eta1, cos_phi0, eta, lam, phi, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, equal, greater, identity, judges, zero

ALL = (tables.circle, tables.ellipse, tables.cardioid, tables.cuspless, tables.egg(3))
ARCS = tables.cuspless.component("arc").point, tables.cardioid.components[0].point
MIRROR = "the exit angle is -lam*eta"


@judges("map.dissipative")
def dissipative(claim: Claim) -> Judgement:
    """Phase space as a whole shrinks, but a flight in the ellipse a = 2 from (2, 0) to (0, 1) expands areas."""
    cos_out, cos_in, contraction = 2 / sqrt(5), 1 / sqrt(Integer(5)), Rational(9, 10)
    here = {cos_phi0: cos_out, cos_eta1: cos_in, lam: contraction}
    area = determinant().subs(here)
    birkhoff = birkhoff_matrix(derivative_matrix(), cos_phi0, cos(contraction * acos(cos_in))).det().subs(here)
    return Judgement(
        by(
            "|phi1| = lam*|eta1| <= lam*pi/2, a strip of lam times the area; both areas grow on one flight",
            zero(MIRROR, exit_angle() + lam * eta),
            greater(area, S.One),
            greater(birkhoff, S.One),
        ),
        "T maps phase space into |phi| <= lam*pi/2, a part of lam times the area. That is so of phase space as a whole "
        "and not at every point, where det DT = lam*cos(phi0)/cos(eta1): from (2, 0) to (0, 1) in the ellipse a = 2 at "
        "lam = 9/10 areas grow, in (s, phi) and in (s, sin phi)",
    )


@judges("map.focusing_beam")
def focusing_beam(claim: Claim) -> Judgement:
    """Parallel rays leave in directions that turn by `-(1+lam)*K1` per arc length; `K1` is the curvature at landing."""
    landing_rate = -K1  # d eta1/ds1 = psi1' for a fixed direction
    outgoing_rate = -K1 - exit_angle().coeff(eta) * landing_rate  # d(psi1 + pi/2 - phi1)/ds1
    focusing = positive(outgoing_rate.subs(K1, -S.One), {lam: Interval(0, 1)})
    turn = equal(outgoing_rate, -(1 + lam) * K1, {})
    return Judgement(
        by("neighbouring rays turn towards each other, at the rate -(1 + lam)*K1 > 0 for K1 < 0", turn, focusing),
        "the outgoing direction turns by -(1 + lam)*K1 per unit of arc length",
    )


@judges("map.birkhoff", "map.elastic_measure")
def elastic_area(claim: Claim) -> Judgement:
    """The elastic map preserves area: at `lam = 1` the Jacobian in `(s, sin phi)`, `lam*cos(phi1)/cos(eta1)`, is 1."""
    jacobian = birkhoff_matrix(derivative_matrix(), cos_phi0, cos_eta1).det().subs(lam, 1)
    return Judgement(
        by("at lam = 1, |phi1| = |eta1| and d(sin phi) ds = cos(phi) ds dphi", zero("Jacobian 1", jacobian - 1)),
        "det D(s1, sin phi1)/D(s0, sin phi0) = lam*cos(phi1)/cos(eta1)",
    )


@judges("map.reflection_rule")
def reflection_rule(claim: Claim) -> Judgement:
    """The printed reflection rule is a case of `phi = -eta + f(eta)`, with `f(eta) = (1 - lam)*eta`."""
    return identity(claim, exit_angle())


@judges("map.derivative_matrix")
def whole_matrix(claim: Claim) -> Judgement:
    """Judges the printed derivative matrix, by implicit differentiation of the flight equation and the law."""
    return identity(claim, derivative_matrix())


@judges("map.A")
def entry_A(claim: Claim) -> Judgement:
    """The printed A is minus the upper left entry of the derivative matrix."""
    return identity(claim, -derivative_matrix()[0, 0])


@judges("map.B")
def entry_B(claim: Claim) -> Judgement:
    """The printed B is minus the upper right entry of the derivative matrix."""
    return identity(claim, -derivative_matrix()[0, 1])


@judges("map.stability_product")
def stability_product(claim: Claim) -> Judgement:
    """Judges the chain rule for `D(T^n)`, on two flights in the circle, where the map is explicit."""
    twice = iterate(2)
    jacobian = Matrix(twice).jacobian([s, phi])
    single = Matrix(flight(s, phi)).jacobian([s, phi])
    return Judgement(
        by("the chain rule", equal(jacobian, single * single, {}), equal(single, circle_matrix(), {})),
        "D(T^n) is the product of DT along the orbit, the last factor on the left",
    )


def circle_matrix() -> Expr:
    """The derivative matrix for a flight in the unit circle."""
    return derivative_matrix(K0=-1, K1=-1, t=2 * cos(phi), cos_phi0=cos(phi), cos_eta1=cos(phi))


@judges("map.elastic")
def elastic(claim: Claim) -> Judgement:
    """At `lam = 1` the law is the elastic one, `phi = -eta`."""
    return Judgement(by("the law at lam = 1", zero("phi = -eta", exit_angle().subs(lam, 1) + eta)), "phi = -eta")


@judges("map.slap_normal")
def slap_normal(claim: Claim) -> Judgement:
    """At `lam = 0` every exit is along the normal: the exit angle and its derivatives vanish."""
    row = derivative_matrix(lam=0)[1, :]
    return Judgement(
        by("phi1 = 0 whatever the landing, so s alone is mapped", zero("", exit_angle().subs(lam, 0), *row)),
        "phi = 0 at every bounce",
    )


@judges("map.slap_derivative")
def slap(claim: Claim) -> Judgement:
    """Judges the printed slap derivative, the upper left entry at `phi0 = 0`, `lam = 0`."""
    return identity(claim, slap_derivative())


@judges("map.slap_circle_map")
def slap_circle_map(claim: Claim) -> Judgement:
    """The slap map is a circle map, since the boundary of each table is one closed curve."""
    gaps = []
    for table in ALL:
        chain = table.components
        for before, after in zip(chain, chain[1:] + chain[:1], strict=True):
            gaps += [p - q for p, q in zip(before.at(before.end), after.at(after.start), strict=True)]
    return Judgement(
        by("the boundary of each of the five tables closes up, so s is periodic", zero("", *gaps)),
        "s is taken modulo the perimeter; the map has a jump, or no value, where a normal runs into a join or the cusp",
    )


def turnings() -> list[SignFinding]:
    """The findings that each component has `turning >= 0`, which means `kappa <= 0`."""
    egg = in_cosine(turning(tables.egg(3).components[0]))
    cosine = {alpha: Interval(0, Rational(1, 10)), COSINE: Interval(-1, 1)}
    return [
        positive(turning(tables.circle.components[0]), {}),
        positive(turning(tables.ellipse.components[0]), {a: Interval(1, oo)}),
        nonnegative(turning(tables.cardioid.components[0]).subs(cos(theta), COSINE), {COSINE: Interval(-1, 1)}),
        zero("the cuspless arc is the cardioid's", *(p - q for p, q in zip(*ARCS, strict=True))),
        zero("the wall is straight", turning(tables.cuspless.component("wall"))),
        nonnegative(egg, cosine),
    ]


@judges("map.curvature_nonpositive")
def curvature_nonpositive(claim: Claim) -> Judgement:
    """The curvature is non-positive, since each component turns left or is straight."""
    return Judgement(by("x'y'' - y'x'' >= 0 on each component", *turnings()), "kappa <= 0 on every component")


@judges("map.zero_curvature_excluded", "map.focusing_and_flat")
def zero_curvature(claim: Claim) -> Judgement:
    """A counterexample: at the last shape in the range, the egg's flat points have curvature 0."""
    flat = in_cosine(turning(tables.egg(3).components[0]))
    end = {COSINE: -1, alpha: Rational(1, 10)}
    inside = {alpha: Interval.Ropen(0, Rational(1, 10)), COSINE: Interval(-1, 1)}
    return Judgement(
        counterexample(
            "the egg with alpha = 1/10 at theta = pi/3",
            zero("kappa = 0 there", flat.subs(end)),
            at={alpha: Rational(1, 10), theta: pi / 3},
        ),
        "every component is strictly focusing or flat when the egg has alpha < 1/10",
        by("the egg turns strictly for alpha < 1/10", positive(flat, inside)),
        "The range alpha in [0, 1/10] must end before 1/10: there the egg's curvature vanishes at three points.",
    )


@judges("map.slap_evolute")
def slap_evolute(claim: Claim) -> Judgement:
    """Flights of the slap map touch the evolute, since on any curve the centre of curvature moves along the normal."""
    x, y = (Function(name, real=True)(theta) for name in "xy")
    velocity = Matrix([x, y]).diff(theta)
    bend = velocity[0] * y.diff(theta, 2) - velocity[1] * x.diff(theta, 2)
    centre = Matrix([x, y]) + velocity.dot(velocity) / bend * Matrix([-velocity[1], velocity[0]])
    wall = turning(tables.cuspless.component("wall"))
    return Judgement(
        by(
            "each normal touches the evolute at the centre of curvature, on any curve whose curvature is not 0; each "
            "curved component of the five tables has that, but for three points of the egg with alpha = 1/10",
            zero("", cancel(centre.diff(theta).dot(velocity))),
            zero("phi = 0 at lam = 0", exit_angle().subs(lam, 0)),
            zero("the wall's normals are parallel: it has no evolute", wall),
            *curved(),
        ),
        "d(evolute)/d theta is parallel to the normal; the point of contact is at the distance 1/|K|, beyond the "
        "landing where t*|K| < 1. The wall of the cuspless cardioid has no evolute",
    )


def curved() -> list[SignFinding]:
    """The findings that each component except the wall has `turning > 0`, away from the cusp and for `alpha < 1/10`."""
    egg = in_cosine(turning(tables.egg(3).components[0]))
    rounds = turning(tables.cardioid.components[0]).subs(cos(theta), COSINE)
    return [
        positive(turning(tables.circle.components[0]), {}),
        positive(turning(tables.ellipse.components[0]), {a: Interval(1, oo)}),
        positive(rounds, {COSINE: Interval.Lopen(-1, 1)}),
        zero("the arc is the cardioid's", *(p - q for p, q in zip(*ARCS, strict=True))),
        positive(egg, {COSINE: Interval(-1, 1), alpha: Interval.Ropen(0, Rational(1, 10))}),
    ]
