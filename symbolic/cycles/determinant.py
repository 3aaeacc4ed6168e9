"""The determinant of a cycle's monodromy matrix, and when it can be 1: what forbids Neimark-Sacker bifurcations.

Around a cycle the cosines of exit angles do not telescope against those of incidence: with `phi = -lam*eta`

    det M = prod lam*cos(lam*eta)/cos(eta) = prod f(lam*eta)/f(eta),    f(x) = x*cos(x),

which is `lam**p` only when every bounce is along the normal, and larger otherwise. Since `f` grows up to the root
of `x*tan(x) = 1`, some 0.8603 or 49.3 degrees, a cycle whose incidence angles stay below it contracts areas for
every `lam < 1`: no Neimark-Sacker bifurcation. Beyond it factors exceed 1, and so may the product.

A polygon that turns by `2*pi*p/q` leaves at `gamma - delta` and lands at `gamma + delta`
(`symbolic.cycles.polygons`), with
`gamma = pi/2 - pi*p/q`; near `lam = 1` it contracts exactly when `gamma*tan(gamma) < 1`: the triangle (30 degrees) and
the square (45) do, the pentagon (54) and all beyond do not, and are born expanding.
"""

from sympy import Expr, cos, prod, simplify, sin

from symbolic.cycles.polygons import half_turn
from symbolic.motion.contraction import area_factor
from symbolic.tables.symbols import eta


def flux(x: Expr) -> Expr:
    """`f(x) = x*cos(x)`, whose ratio over a reflection is the factor of area.

    >>> from symbolic.tables.symbols import lam
    >>> simplify(flux(lam * eta) / flux(eta) - area_factor())
    0
    """
    return x * cos(x)


def flux_slope(x: Expr) -> Expr:
    """`f'(x) = cos(x) - x*sin(x)`: positive where contraction is certain, zero where `x*tan(x) = 1`."""
    return cos(x) - x * sin(x)


def cycle_determinant(angles: list[Expr]) -> Expr:
    """`det M` of a cycle with these incidence angles.

    >>> from sympy import S
    >>> cycle_determinant([S.Zero, S.Zero])
    lam**2
    """
    return simplify(prod(area_factor().subs(eta, angle) for angle in angles))


def polygon_slope(p: int, q: int) -> Expr:
    """`f'(gamma)` of the polygon: positive when it contracts near `lam = 1`, negative when it expands.

    >>> bool(polygon_slope(1, 4) > 0), bool(polygon_slope(1, 5) < 0), bool(polygon_slope(2, 5) > 0)
    (True, True, True)
    """
    return flux_slope(half_turn(p, q))


def polygon_factor(delta: Expr, p: int, q: int) -> Expr:
    """`det M` of one bounce of a polygon whose normal is tilted by `delta`: `f(gamma - delta)/f(gamma + delta)`.

    >>> from sympy import S
    >>> polygon_factor(S.Zero, 1, 5)
    1
    """
    gamma = half_turn(p, q)
    return flux(gamma - delta) / flux(gamma + delta)
