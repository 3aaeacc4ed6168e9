"""A boundary as a finite Fourier sum `z = x + i*y = sum_k c_k exp(i*k*theta)`, when it is one."""

from sympy import Dummy, Expr, I, Poly, S, cos, exp, expand, sin
from sympy.polys.polyerrors import PolynomialError

from symbolic.symbols import theta
from symbolic.table import Component


def coefficients(expression: Expr) -> dict[int, Expr] | None:
    """The nonzero `c_k` of a trigonometric polynomial in `theta`, by `k`; None when it is not one.

    >>> coefficients(2 * cos(theta) ** 2)
    {-2: 1/2, 0: 1, 2: 1/2}
    >>> coefficients(1 / (2 + cos(theta))) is None
    True
    """
    u = Dummy("u")
    text = S(expression).rewrite(exp) if S(expression).has(cos, sin) else S(expression)
    rational = expand(expand(text).replace(exp, lambda power: u ** expand(power / (I * theta))))
    if rational.has(theta):
        return None
    lowest = min([0, *(-_degree(term, 1 / u) for term in rational.as_ordered_terms())])
    try:
        poly = Poly(expand(rational * u**-lowest), u)
    except PolynomialError:
        return None
    if poly.has(u) and any(c.has(u) for c in poly.coeffs()):
        return None
    terms = {power[0] + lowest: c for power, c in poly.terms() if c != 0}
    return dict(sorted(terms.items()))


def boundary_coefficients(component: Component) -> dict[int, Expr] | None:
    """The `c_k` of `z = x + i*y` on a component.

    >>> from symbolic.tables import cardioid
    >>> boundary_coefficients(cardioid.components[0])
    {0: 1/2, 1: 1, 2: 1/2}
    """
    x, y = component.point
    return coefficients(x + I * y)


def _degree(term: Expr, base: Expr) -> int:
    power = term.as_powers_dict().get(1 / base, 0)
    return -int(power) if S(power).is_integer else 0
