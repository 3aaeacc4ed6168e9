"""Cycles whose bounces are rotated into one another: regular polygons in a table with rotational symmetry.

Where a turn by `2*pi*p/q` maps the table to itself, a cycle may turn by that angle at each bounce. Its chords make the
angle `gamma = pi/2 - pi*p/q` with the radius, and the normal is tilted from the radius by `delta`,
`tan(delta) = rho'/rho`; so the particle leaves at `gamma - delta` and lands at `gamma + delta` (up to a common sign),
and the law `gamma - delta = lam*(gamma + delta)` holds when

    rho'/rho = tan(gamma*(1 - lam)/(1 + lam)).

The cycles fold where the tilt is largest. Paper: section 6.4, where the fold is read off plots.

The module also has polynomials in `C = cos(K*theta)` for facts about the egg (paper: section 6), and cycles on tables
with straight sides. There the exit angle changes by an affine map, which depends on `turn`, the angle from the normal
of one side to that of the next. So one exponent is `log(lam)`, and the sequence of sides of a cycle determines its
angles. Distances along the sides are stretched by `cos(phi0)/cos(eta1)`, whose product round a cycle is at least one.
So no cycle attracts, and only cycles along the common normal of parallel sides are neutral. A parabolic attractor
beside a chaotic one was found on the square [DelMagnoLopesDiasDuarteGaivaoPinheiro2012], and strange attractors on the
equilateral triangle [ArroyoMarkarianSanders2012].
"""

from collections.abc import Sequence
from functools import cache

from sympy import (
    Expr,
    Function,
    Matrix,
    Poly,
    Rational,
    S,
    Symbol,
    asin,
    atan,
    cos,
    diff,
    expand,
    expand_trig,
    factor,
    log,
    pi,
    simplify,
    sin,
    sqrt,
    symbols,
    tan,
)

from symbolic.cycles.cycle import frame
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import egg
from symbolic.tables.geometry import curvature, speed, tangent, turning
from symbolic.tables.table import Component, alpha, lam, theta
from symbolic.tables.validity import parameter_box


def half_turn(p: int = 1, q: int = 3) -> Expr:
    """`gamma = pi/2 - pi*p/q`, the elastic exit angle of the polygon, in radians.

    >>> half_turn(1, 3)
    pi/6
    """
    if not (q >= 3 and 0 < 2 * p < q):
        raise ValueError(f"polygon: the rotation number {p}/{q} must lie strictly between 0 and 1/2")
    return pi / 2 - pi * Rational(p, q)


def tilt_tangent(K: int | Expr = 3) -> Expr:
    """`-rho'/rho` of the K-pointed egg.

    >>> tilt_tangent().subs(theta, pi / 6)
    3*alpha
    """
    rho = 1 + alpha * cos(K * theta)
    return -diff(rho, theta) / rho


def largest_tilt(K: int | Expr = 3) -> Expr:
    """The maximum of `|rho'/rho|` over the egg, reached where `cos(K*theta) = -alpha`.

    >>> largest_tilt()
    3*alpha/sqrt(1 - alpha**2)
    """
    return K * alpha / sqrt(1 - alpha**2)


def required_tilt(p: int = 1, q: int = 3) -> Expr:
    """`delta(lam) = gamma*(1-lam)/(1+lam)`, the tilt of the normal that a polygon needs."""
    return half_turn(p, q) * (1 - lam) / (1 + lam)


def saddle_node(K: int | Expr = 3, p: int = 1, q: int = 3) -> Expr:
    """`lambda_c(alpha)` in closed form: polygons exist for `lam >= lambda_c` and not below.

    >>> saddle_node().subs(alpha, 0)
    1
    """
    gamma, delta = half_turn(p, q), atan(largest_tilt(K))
    return (gamma - delta) / (gamma + delta)


def near_flat(K: int | Expr = 3, p: int = 1, q: int = 3) -> Expr:
    """The polar angle of one bounce of the polygon, for `lambda_c <= lam <= 1`; it is the flat point `pi/K` at
    `lam = 1`.

    The polygon needs the slope `rho'/rho = T = tan(required_tilt(p, q))`, which means
    `sin(K*theta + psi) = -T/(alpha*sqrt(K**2 + T**2))` with `tan(psi) = T/K`. As `lam` falls, the polygon turns
    counterclockwise, which is also the sense in which the particle runs; for the mirror image both are clockwise.

    >>> near_flat().subs(lam, 1)
    pi/3
    """
    T = tan(required_tilt(p, q))
    return (pi + asin(T / (alpha * sqrt(K**2 + T**2))) - atan(T / K)) / K


@cache
def turn_trace_and_determinant(K0: Expr, t: Expr, exit_angle: Expr, incidence: Expr) -> tuple[Expr, Expr]:
    """Trace and determinant of one bounce of a polygon, in the frame that turns with it."""
    matrix = derivative_matrix(K0, K0, t, cos(exit_angle), cos(incidence))
    return factor(matrix.trace()), factor(matrix.det())


def polygon_identities() -> dict[str, Expr]:
    """Expressions that vanish identically for every polygon in a polar curve `rho(theta)`; each key says what it
    proves.

    Here `tan(delta) = rho'/rho`, and each bounce turns by `pi - 2*gamma`. The last expression shows on which side of
    the fold a bounce lies: `1 - trace + det` is the product `(1 - mu_1)*(1 - mu_2)` of the multipliers' distances from
    1.

    >>> from symbolic.expressions.signs import vanishes
    >>> [vanishes(difference) for difference in polygon_identities().values()]
    [True, True, True, True]
    """
    gamma, delta = symbols("gamma delta", real=True)
    radius = Symbol("rho", positive=True)
    slope, bend = symbols("rho1 rho2", real=True)  # rho' and rho'' at the bounce
    rho = Function("rho", positive=True)(theta)
    curve = Component("polar", (rho * cos(theta), rho * sin(theta)), -pi, pi)
    here, unit, kappa = (
        value.subs(diff(rho, theta, 2), bend).subs(diff(rho, theta), slope).subs(rho, radius)
        for value in (Matrix(curve.point), tangent(curve), curvature(curve))
    )
    turn = Matrix([[-cos(2 * gamma), -sin(2 * gamma)], [sin(2 * gamma), -cos(2 * gamma)]])
    leaving, arriving = turn * here - here, here - turn.T * here
    length, speed = 2 * radius * cos(gamma), sqrt(radius**2 + slope**2)
    trace, det = turn_trace_and_determinant(kappa, length, gamma - delta, gamma + delta)
    at_one = (1 - trace + det) * cos(gamma + delta)
    sided = 2 * (1 + lam) * radius * cos(gamma) * (radius * bend - slope**2) / speed**3
    tilted = {cos(delta): radius / speed, sin(delta): slope / speed}
    facts = {
        "a chord is 2*rho*cos(gamma) long": leaving.dot(leaving) - length**2,
        "it leaves at gamma - delta": leaving.dot(unit) - length * sin(gamma - delta),
        "it lands at gamma + delta": arriving.dot(unit) - length * sin(gamma + delta),
        "(1 - trace + det)*cos(eta) = 2*(1 + lam)*cos(gamma)*rho*(rho*rho'' - rho'^2)/(rho^2 + rho'^2)^(3/2)": at_one
        - sided,
    }
    return {fact: expand_trig(expand(difference)).subs(tilted) for fact, difference in facts.items()}


def fold_margin(K: int | Expr = 3) -> Expr:
    """`rho*rho'' - rho'**2` of the K-pointed egg, which changes sign where the tilt is largest.

    >>> simplify(fold_margin() + 9 * alpha * (cos(3 * theta) + alpha))
    0
    """
    rho = 1 + alpha * cos(K * theta)
    return rho * diff(rho, theta, 2) - diff(rho, theta) ** 2


def elastic_trace(at_flat: bool, K: int = 3, p: int = 1, q: int = 3) -> Expr:
    """The trace of one elastic bounce of the polygon at the flat points, or at the vertices; the determinant is 1.

    >>> elastic_trace(True)
    2*(19*alpha - 1)/(alpha - 1)
    """
    bounce, gamma = pi / K if at_flat else S.Zero, half_turn(p, q)
    length = 2 * (1 + alpha * cos(K * bounce)) * cos(gamma)
    kappa = frame(egg(K), 0, bounce, parameter_box(egg(K))).curvature
    trace, _ = turn_trace_and_determinant(kappa, length, gamma, gamma)
    return factor(simplify(trace.subs(lam, 1)))


def contraction_slope(p: int = 1, q: int = 3) -> Expr:
    """`d(log det)/d lam` of one bounce at `lam = 1`: positive where weak dissipation contracts areas.

    >>> contraction_slope()
    -sqrt(3)*pi/18 + 1
    """
    gamma, delta = half_turn(p, q), required_tilt(p, q)
    _, det = turn_trace_and_determinant(Symbol("K0"), Symbol("t"), gamma - delta, gamma + delta)
    return simplify(diff(log(det), lam).subs(lam, 1))


def characteristic_on_branch(x: Expr, at: Expr, K: int = 3, p: int = 1, q: int = 3) -> Expr:
    """The characteristic polynomial of one bounce of a polygon of the egg at `at`, `at**2 - trace*at + det`, times
    `cos(eta)`.

    The bounce has `cos(K*theta) = -cos(x)`. The branch starts at a flat point, `x = 0`, where `lam = 1`, and folds at
    `cos(x) = alpha`; on it `lam = (gamma - delta)/(gamma + delta)` with `tan(delta) = K*alpha*sin(x)/rho`.
    """
    C = -cos(x)
    rho = 1 + alpha * C
    delta, gamma = atan(K * alpha * sin(x) / rho), half_turn(p, q)
    out, back = gamma - delta, gamma + delta
    contraction = out / back
    squared = rho**2 + (K * alpha * sin(x)) ** 2
    curvature = -(rho**2 + 2 * (squared - rho**2) + rho * K**2 * alpha * C) / (squared * sqrt(squared))
    tK = 2 * rho * cos(gamma) * curvature
    trace = -((tK + cos(out)) + contraction * (tK + cos(back)))
    return at**2 * cos(back) - trace * at + contraction * cos(out)


COSINE = Symbol("C", real=True)


def in_cosine(expression: Expr, K: int = 3) -> Expr:
    """A sum of cosines of multiples of `K*theta`, as a polynomial in `C = cos(K*theta)`.

    >>> in_cosine(cos(6 * theta))
    2*C**2 - 1
    """
    return expand(expand_trig(expression.subs(theta, theta / K)).subs(cos(theta), COSINE))


def turning_polynomial(K: int = 3) -> Expr:
    """`rho**2 + 2*rho'**2 - rho*rho''`, which has the sign of `-kappa`.

    >>> turning_polynomial()
    -8*C**2*alpha**2 + 11*C*alpha + 18*alpha**2 + 1
    """
    return in_cosine(turning(egg(K).components[0]), K)


def squared_speed_polynomial(K: int = 3) -> Expr:
    """`rho**2 + rho'**2` of the egg, the square of its speed, as a polynomial in `COSINE`.

    >>> squared_speed_polynomial()
    -8*C**2*alpha**2 + 2*C*alpha + 9*alpha**2 + 1
    """
    return in_cosine(expand(speed(egg(K).components[0]) ** 2), K)


def curvature_slope_polynomial(K: int = 3) -> Expr:
    """A polynomial with the sign of `d(-kappa)/dC`: `-kappa = N/Q**(3/2)` grows with `C` where `2*Q*N' > 3*Q'*N`.

    `N` is the `turning_polynomial`, `Q` the `squared_speed_polynomial`.
    """
    N, Q = turning_polynomial(K), squared_speed_polynomial(K)
    return expand(2 * Q * N.diff(COSINE) - 3 * Q.diff(COSINE) * N)


def _centre_of_curvature() -> tuple[Expr, Expr, Expr]:
    """Polynomials in `C` of the egg with `K = 3`: `(N, |e|**2*N**2, Re(e**3)*N**3)`, for the centre of curvature `e`.

    `N` is the `turning_polynomial`; `e = exp(i*theta)*(u + i*w*sin(3*theta))/N`, with polynomials `u` and `w`.
    """
    C, N, Q = COSINE, turning_polynomial(), squared_speed_polynomial()
    u, w, sine = (1 + alpha * C) * (N - Q), -3 * alpha * Q, 1 - C**2
    return N, u**2 + w**2 * sine, C * (u**3 - 3 * u * w**2 * sine) - sine * (3 * u**2 * w - w**3 * sine)


def centre_beyond_boundary() -> Expr:
    """`N*(|e| - rho)`, which has the sign of `-T0'`, for the centre of curvature `e` and the radius `rho` in its
    direction.

    The factor `N` (`turning_polynomial`), which has the sign of `-kappa`, keeps the value finite where the curvature
    vanishes. The value is not defined where `e` is the centre of the table (see `centre_far_inside`).

    >>> from sympy import Rational
    >>> flat = centre_beyond_boundary().subs(COSINE, -1)
    >>> [flat.subs(alpha, Rational(1, n)).simplify().is_positive for n in (10, 18, 19)]
    [True, True, False]
    """
    N, modulus, cube = _centre_of_curvature()
    return sqrt(modulus) - N - alpha * N * cube / (modulus * sqrt(modulus))


def centre_far_inside() -> Expr:
    """A polynomial that is positive only where `|e| < 1 - alpha`, so that `e` is inside the table in any direction."""
    N, modulus, _ = _centre_of_curvature()
    return expand((1 - alpha) ** 2 * N**2 - modulus)


def slap_critical_cosines(shape: Expr) -> list[Expr]:
    """The values in `-1 < C < 1` at which the slap map of the egg with `alpha = shape` has `T0' = 0`.

    There the centre of curvature `e` lies on the boundary, `|e|**4 = |e|**3 + alpha*Re(e**3)`. Sturm's theorem counts
    the roots of the squared equation, a polynomial in `C`; a root counts if `|e|**4 - alpha*Re(e**3) > 0` there.
    """
    C = COSINE
    N, modulus, cube = (polynomial.subs(alpha, shape) for polynomial in _centre_of_curvature())
    side = expand(modulus**2 - shape * N * cube)
    roots = Poly(expand(side**2 - modulus**3 * N**2), C).sqf_part().real_roots()
    return [root for root in roots if -1 < root < 1 and side.subs(C, root.eval_rational(n=30)) > 0]


def slap_critical_points(shape: Expr) -> int:
    """The number of `theta` with `T0' = 0`, for the slap map `T0` of the egg with `alpha = shape`: six per cosine.

    >>> from sympy import Rational
    >>> slap_critical_points(Rational(2, 25)), slap_critical_points(Rational(1, 20))
    (6, 0)
    """
    return 6 * len(slap_critical_cosines(shape))


def next_exit_angle(turn: Expr, exit_angle: Expr) -> Expr:
    """The exit angle after a flight from one straight side to another whose normal is turned by `turn`, in (0, 2*pi).

    >>> next_exit_angle(2 * pi / 3, S.Zero)
    pi*lam/3
    """
    return lam * (pi - turn - exit_angle)


def straight_multipliers(angles: Sequence[Expr]) -> tuple[Expr, Expr]:
    """The multipliers of a cycle between straight sides: of the angle, and of the position, at least 1 in modulus.

    Between sides the derivative matrix is triangular, with `-cos(phi0)/cos(eta1)` and `-lam`. An exit angle is `lam`
    times an angle of incidence, whose cosine is smaller unless both vanish.

    >>> straight_multipliers([S.Zero, S.Zero])
    (lam**2, 1)
    """
    sign = S.NegativeOne ** len(angles)
    place = S.One
    for angle in angles:
        place *= cos(angle) / cos(angle / lam)
    return sign * lam ** len(angles), sign * place
