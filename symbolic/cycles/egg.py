"""Facts on the egg as polynomials in `C = cos(K*theta)`. Paper: section 6."""

from sympy import Expr, Poly, Symbol, cos, expand, expand_trig, sqrt

from symbolic.tables import egg
from symbolic.tables.geometry import speed, turning
from symbolic.tables.symbols import alpha, theta

COSINE = Symbol("C", real=True)


def in_cosine(expression: Expr, K: int = 3) -> Expr:
    """A sum of cosines of multiples of `K*theta`, as a polynomial in `COSINE`.

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
    """`rho**2 + rho'**2`.

    >>> squared_speed_polynomial()
    -8*C**2*alpha**2 + 2*C*alpha + 9*alpha**2 + 1
    """
    return in_cosine(expand(speed(egg(K).components[0]) ** 2), K)


def curvature_slope_polynomial(K: int = 3) -> Expr:
    """A polynomial with the sign of `d(-kappa)/dC`: `-kappa = N/Q**(3/2)` grows with C where `2*Q*N' - 3*Q'*N > 0`."""
    N, Q = turning_polynomial(K), squared_speed_polynomial(K)
    return expand(2 * Q * N.diff(COSINE) - 3 * Q.diff(COSINE) * N)


def _centre_of_curvature() -> tuple[Expr, Expr, Expr]:
    """`(N, |e|**2*N**2, Re(e**3)*N**3)` of the centre of curvature `e = exp(i*theta)*(u + i*w*sin(3*theta))/N`."""
    C, N, Q = COSINE, turning_polynomial(), squared_speed_polynomial()
    u, w, sine = (1 + alpha * C) * (N - Q), -3 * alpha * Q, 1 - C**2
    return N, u**2 + w**2 * sine, C * (u**3 - 3 * u * w**2 * sine) - sine * (3 * u**2 * w - w**3 * sine)


def centre_beyond_boundary() -> Expr:
    """`N*(|e| - rho)` for the centre of curvature `e` and the boundary's `rho` in its direction; `-T0'` has its sign.

    `N`, of the sign of `-kappa`, keeps it finite where the curvature vanishes. It is not defined where `e` is the
    centre of the table (see `centre_far_inside`).

    >>> from sympy import Rational
    >>> flat = centre_beyond_boundary().subs(COSINE, -1)
    >>> [flat.subs(alpha, Rational(1, n)).simplify().is_positive for n in (10, 18, 19)]
    [True, True, False]
    """
    N, modulus, cube = _centre_of_curvature()
    return sqrt(modulus) - N - alpha * N * cube / (modulus * sqrt(modulus))


def centre_far_inside() -> Expr:
    """A polynomial that is positive only where `|e| < 1 - alpha`, inside the table whatever the direction."""
    N, modulus, _ = _centre_of_curvature()
    return expand((1 - alpha) ** 2 * N**2 - modulus)


def slap_critical_cosines(shape: Expr) -> list[Expr]:
    """The values in `-1 < C < 1` at which the slap map of the egg with `alpha = shape` has `T0' = 0`.

    `t*K0 + 1 = 0` says that the centre of curvature `e` lies on the boundary, `|e|**4 = |e|**3 +
    alpha*Re(e**3)`. That is a polynomial in `C`, whose
    roots Sturm counts; squared, it needs `|e|**4 - alpha*Re(e**3) > 0` at a root.
    """
    C = COSINE
    N, modulus, cube = (polynomial.subs(alpha, shape) for polynomial in _centre_of_curvature())
    side = expand(modulus**2 - shape * N * cube)
    roots = Poly(expand(side**2 - modulus**3 * N**2), C).sqf_part().real_roots()
    return [root for root in roots if -1 < root < 1 and side.subs(C, root.eval_rational(n=30)) > 0]


def slap_critical_points(shape: Expr) -> int:
    """How many `theta` have `T0' = 0` in the egg with `alpha = shape`: six for each such cosine.

    >>> from sympy import Rational
    >>> slap_critical_points(Rational(2, 25)), slap_critical_points(Rational(1, 20))
    (6, 0)
    """
    return 6 * len(slap_critical_cosines(shape))
