"""A boundary as a finite Fourier sum `z = x + i*y = sum_k c_k exp(i*k*theta)`, when it is one."""

from functools import reduce
from math import gcd

from sympy import Dummy, Expr, I, Poly, S, Symbol, cos, exp, expand, sin
from sympy.polys.polyerrors import PolynomialError

from symbolic.tables.symbols import theta
from symbolic.tables.table import Component


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


def in_half_tangent(expression: Expr) -> tuple[Expr, Symbol, Expr] | None:
    """`(p, T, value)`: the sign of a trigonometric polynomial is that of `p(T)`, `T = tan(x/2)`; `value` at `x = pi`.

    Here `x = g*theta` with `g` the common divisor of the frequencies.

    >>> p, T, value = in_half_tangent(2 + cos(3 * theta))
    >>> p.subs(T, 0), value
    (3, 1)
    """
    c = coefficients(expression)
    if c is None:
        return None
    step = reduce(gcd, (abs(k) for k in c), 0) or 1
    n = max((abs(k) for k in c), default=0) // step
    T = Dummy("T", real=True)
    total = S.Zero
    for k, value in c.items():
        power = k // step
        wave = (1 + (1 if power > 0 else -1) * I * T) ** (2 * abs(power))
        total += value * wave * (1 + T**2) ** (n - abs(power))
    at_pi = sum((value * S.NegativeOne ** (k // step) for k, value in c.items()), S.Zero)
    return expand(expand(total).as_real_imag()[0]), T, expand(at_pi)


def _degree(term: Expr, base: Expr) -> int:
    power = term.as_powers_dict().get(1 / base, 0)
    return -int(power) if S(power).is_Integer else 0
