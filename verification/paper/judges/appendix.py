"""Judges of claims on the numerical methods. Paper: appendix."""

from sympy import (
    Integer,
    Interval,
    Matrix,
    Poly,
    Rational,
    S,
    Symbol,
    cos,
    expand,
    oo,
    pi,
    sin,
    sqrt,
    symbols,
    together,
)

from symbolic.cycles.cycle import contracting_norm
from symbolic.expressions.signs import positive
from symbolic.motion.collision import determinant, exit_angle, growth_defects
from symbolic.motion.flight import flight, iterate, limit_position
from symbolic.tables import ellipse
from symbolic.tables.table import a, eta, lam, phi, s
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, equal, greater, judges, zero
from verification.paper.judges.ellipse import settles

omega = Symbol("omega", real=True)  # the direction of the flight
C = Symbol("C", real=True)  # cos(omega)


@judges("appendix.ellipse_quadratic")
def quadratic(claim: Claim) -> Judgement:
    """The flight equation in the ellipse is quadratic: a ray is inserted into `x**2/a**2 + y**2 = 1`."""
    t = Symbol("t")
    x, y = ellipse.components[0].point
    met = Poly(expand(((x + t * cos(omega)) / a) ** 2 + (y + t * sin(omega)) ** 2 - 1), t)
    constant = met.all_coeffs()[-1]
    return Judgement(
        by(
            "a quadratic in the flight length whose constant term vanishes on the boundary",
            zero("", constant),
            zero("degree 2", Integer(met.degree() - 2)),
            positive(
                met.LC().subs(sin(omega), sqrt(1 - C**2)).subs(cos(omega), C), {C: Interval(-1, 1), a: Interval(1, oo)}
            ),
        ),
        "t = -2*<A q, v>/<A v, v>",
    )


@judges("appendix.cardioid_cubic")
def cubic(claim: Claim) -> Judgement:
    """The flight equation in the cardioid, in `U = exp(i*theta)`, is `U - u` times a cubic; `u` is the start."""
    u, U, v = symbols("u U v")  # v = exp(i*omega)
    imaginary = (U - u) * (2 + u + U) / v - (1 / U - 1 / u) * (2 + 1 / u + 1 / U) * v
    rest = u**2 * U**2 * (2 + u + U) + v**2 * (2 * u * U + U + u)
    return Judgement(
        by(
            "the flight equation is (U - u) times a cubic in U = exp(i*theta1)",
            zero("", together(imaginary - (U - u) * rest / (v * u**2 * U**2))),
            zero("degree 3, with the leading coefficient u^2", Poly(rest, U).coeff_monomial(U**3) - u**2),
            zero("no higher degree", Integer(Poly(rest, U).degree() - 3)),
        ),
        str(expand(rest)),
    )


@judges("appendix.cuspless_plane")
def plane(claim: Claim) -> Judgement:
    """A counterexample: a vertical ray left of the pole passes the dent and never meets the line of the wall."""
    cosines = [(-1 + sign * sqrt(1 + 4 * Rational(-1, 8))) / 2 for sign in (1, -1)]  # x = c*(1 + c) = -1/8
    kept, removed = cosines
    return Judgement(
        counterexample(
            "the vertical ray down x = -1/8 from the arc meets a removed part of the cardioid first, "
            "and is parallel to the wall",
            zero("", *(c * (1 + c) + Rational(1, 8) for c in cosines)),
            greater(kept, Rational(-1, 2)),
            greater(Rational(-1, 2), removed),
        ),
        "a ray whose first root lies in the removed part hits the wall or, having passed the dent, "
        "the arc again: the sign at the join decides",
        by("its other end (x, -y) lies on the arc", greater(kept, Rational(-1, 2))),
        "A root in the removed part does not imply the wall: rays that pass left of the pole can "
        "cross the dent and hit the other half of the arc.",
    )


@judges("appendix.incoming_angle")
def incoming(claim: Claim) -> Judgement:
    """Judges the sign in the angle of incidence: `<v, n> = -cos(eta)` for the inward normal `n`."""
    v = Matrix([sin(eta), -cos(eta)])
    n = Matrix([0, 1])
    return Judgement(
        counterexample(
            "with the inward normal that eq. v' = n*cos(phi) + ... needs, v.n = -cos(eta), so acos(v.n) = pi - eta",
            zero("", v.dot(n) + cos(eta)),
            greater(pi - 1, S.One),
            at={eta: S.One},
        ),
        "eta = acos(-v.n) with the inward normal n",
        by("-v.n = cos(eta)", zero("", -v.dot(n) - cos(eta))),
        "A sign is missing: eta = arccos(-v.n) for the inward normal used in the formula for v'.",
    )


@judges("appendix.outgoing_angle")
def outgoing_angle(claim: Claim) -> Judgement:
    """The printed exit angle is correct up to its sign, which the appendix omits."""
    return Judgement(by("|phi| = lam*|eta|", equal(claim.formula**2, exit_angle() ** 2, {})), "|phi| = lam*|eta|")


@judges("appendix.outgoing_velocity", "appendix.tangential_sign")
def outgoing_velocity(claim: Claim) -> Judgement:
    """Judges the exit velocity: a unit vector at the angle `phi` from the normal, on the incoming side."""
    side, t, n = Symbol("d", real=True), Matrix([1, 0]), Matrix([0, 1])
    arriving = Matrix([side * sin(eta), -cos(eta)])  # eta in [0, pi/2), on either side
    leaving = n * cos(lam * eta) + t * side * sin(lam * eta)
    squares = {side**2: 1}
    return Judgement(
        by(
            "v' has length 1 and makes the angle lam*eta with n; its tangential part has the sign d of v.t, since both "
            "are d times the sine of an angle in [0, pi/2]",
            zero(
                "", leaving.dot(leaving).expand().subs(squares) - 1, arriving.dot(arriving).expand().subs(squares) - 1
            ),
            zero("", leaving.dot(n) - cos(lam * eta), arriving.dot(n) + cos(eta)),
            zero("", leaving.dot(t) - side * sin(lam * eta), arriving.dot(t) - side * sin(eta)),
        ),
        "v' = n*cos(lam*eta) + d*t*sin(lam*eta), d = sign(v.t)",
    )


@judges("appendix.elastic_cartesian")
def elastic_cartesian(claim: Claim) -> Judgement:
    """Judges the elastic reflection `v' = v - 2*(v.n)*n`."""
    v, n = Matrix([sin(eta), -cos(eta)]), Matrix([0, 1])
    mirrored = v - 2 * v.dot(n) * n
    return Judgement(
        by("v - 2*(v.n)*n leaves at the angle of incidence", equal(mirrored, Matrix([sin(eta), cos(eta)]), {})),
        "v' = v - 2*(v.n)*n",
    )


@judges("appendix.trigonometry_unavoidable")
def trigonometry(claim: Claim) -> Judgement:
    """Trigonometric functions can be avoided if `lam` is rational, by half-angle formulas or algebraic equations."""
    half = cos(eta / 2) ** 2 - (1 + cos(eta)) / 2
    order = Symbol("n", real=True)
    next_one = cos((order + 1) * eta) - 2 * cos(eta) * cos(order * eta) + cos((order - 1) * eta)
    return Judgement(
        counterexample(
            "at lam = 1/2, cos(phi) = sqrt((1 + cos(eta))/2)", zero("", half.subs(eta, 2 * eta)), at={lam: S.Half}
        ),
        "for rational lam = p/q, cos(phi) is algebraic: T_q(cos(phi)) = T_p(cos(eta)) with Chebyshev polynomials",
        by(
            "T_q(cos(p*x)) = cos(p*q*x) = T_p(cos(q*x)), since cos(n*x) obeys the recurrence of T_n(cos(x)) in n",
            zero("", half.subs(eta, 2 * eta), next_one),
        ),
        "Avoidable for rational lambda (square roots do it at lambda = 1/2); for other lambda nothing is shown here.",
    )


@judges("appendix.exponents_growth")
def growth(claim: Claim) -> Judgement:
    """The exponents are growth rates of normalising factors, which are the diagonal entries of QR factors."""
    return Judgement(
        by(
            "the first factors multiply to |D(T^n) v| and all of them to |det D(T^n)|; where Oseledets' theorem gives "
            "exponents, the first rate is nu_+ unless v is contracted, when it is nu_-, and both rates add up to "
            "nu_+ + nu_-",
            zero("", *growth_defects()),
        ),
        "nu_i = lim (1/n) sum log R_ii",
    )


@judges("appendix.exponents_sum")
def exponents_sum(claim: Claim) -> Judgement:
    """The sum of exponents is the mean of a logarithm, and not the logarithm of a mean as printed."""
    rates = (S.Half, S(2))
    gap = (sum(rates) / 2) ** 2 - rates[0] * rates[1]
    return Judgement(
        counterexample(
            "rates 1/2 and 2 in turn: the logarithm of their mean is log(5/4), the mean of their logarithms is 0",
            positive(gap, {}),
        ),
        f"nu_1 + nu_2 is the mean of log({determinant()}), the logarithm of the geometric mean",
        by("determinants multiply, so their logarithms add along the orbit", zero("", *growth_defects())),
        "The sum is the mean of the logarithm of the contraction rate (the log of its geometric "
        "mean), not the logarithm of its mean.",
    )


@judges("appendix.elastic_start")
def elastic_start(claim: Claim) -> Judgement:
    """An elastic first bounce makes every exit angle in (-pi/2, pi/2) possible; a bounce with `-lam*eta` does not."""
    return Judgement(
        by(
            "phi = -eta runs over all exit angles, -lam*eta over a fraction lam of them",
            zero("", exit_angle().subs(lam, 1) + eta),
            positive(1 - lam, {lam: Interval.Ropen(0, 1)}),
        ),
        "phi = -eta",
    )


@judges("appendix.periodic_sign")
def periodic_sign(claim: Claim) -> Judgement:
    """A counterexample: in the circle an exponent is 0, but no diameter attracts its neighbours."""
    matrix = Matrix(flight(s, phi)).jacobian([s, phi])
    along = matrix * Matrix([1, 0]) - Matrix([1, 0])
    position, angle = (expression.subs(lam, 1) for expression in iterate(3))
    return Judgement(
        counterexample(
            "in the circle at lam = 1/2, as at every lam < 1, each orbit has the exponents 0 and log(lam), and its "
            "limit, a diameter, is no attractor: orbits that start beside it tend to other diameters. In the elastic "
            "circle both exponents are 0, and s advances by pi - 2*phi, not commensurable with 2*pi in general",
            zero("DT keeps (1, 0) and has the determinant lam", *along, matrix.det() - lam),
            zero("the limit moves with s", limit_position().diff(s) - 1),
            settles(),
            zero("", position - s - 3 * pi + 6 * phi, angle - phi),
            at={lam: S.Half},
        ),
        "an orbit that converges to an attracting cycle has a negative maximal exponent; 0 occurs without one, and "
        "that a negative one leads to a cycle is not judged here",
        by("near an attracting cycle every vector shrinks exponentially", contracting_norm()),
        "A vanishing exponent does not lead to a periodic attractor: in the circle every orbit has it, and no diameter "
        "attracts its neighbours; the criterion needs 'negative'.",
    )
