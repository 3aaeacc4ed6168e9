"""Facts on the egg as polynomials in `C = cos(K*theta)`. Paper: section 6."""

from sympy import Expr, Symbol, cos, expand, expand_trig

from symbolic.geometry import speed, turning
from symbolic.symbols import theta
from symbolic.tables import egg

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
