"""Arc length: a closed form where the speed allows one, the exact integral otherwise.

Where `speed**2 = p + q*cos(n*theta)` the length is an incomplete elliptic integral of the second
kind; at parameter 1 (the cardioid) it degenerates to a sine.
"""

from sympy import Dummy, Expr, Integral, Rational, S, cos, elliptic_e, expand, simplify, sin, sqrt

from symbolic.tables.fourier import coefficients
from symbolic.tables.geometry import speed
from symbolic.tables.symbols import theta
from symbolic.tables.table import Component, Table


def arc_length(component: Component) -> Expr:
    """Arc length from `theta = 0` to `theta`, negative for negative `theta`.

    Paper: section 4 (cardioid). The closed form of a cusped component holds between its cusps.

    >>> from symbolic.tables import cardioid, ellipse
    >>> arc_length(cardioid.components[0])
    4*sin(theta/2)
    >>> arc_length(ellipse.components[0])
    elliptic_e(theta, 1 - a**2)
    """
    squared = expand(speed(component) ** 2)
    c = coefficients(squared)
    if c is not None and len(c) <= 3 and all(c[-k] == c[k] for k in c):
        p, n = c.get(0, S.Zero), max(c)
        q = 2 * c[n] if n else S.Zero
        if simplify(squared - p - q * cos(n * theta)) == 0:
            return _elliptic(p, q, max(n, 1))
    dummy = Dummy("theta", real=True)
    return Integral(speed(component).subs(theta, dummy), (dummy, 0, theta))


def _elliptic(p: Expr, q: Expr, n: int) -> Expr:
    """The integral of `sqrt(p + q*cos(n*theta))` from 0."""
    half = Rational(n, 2) * theta
    parameter = simplify(2 * q / (p + q))
    if parameter == 0:
        return sqrt(p) * theta
    primitive = sin(half) if parameter == 1 else elliptic_e(half, parameter)
    return sqrt(p + q) * primitive * Rational(2, n)


def positions(table: Table) -> tuple[Expr, ...]:
    """The paper's arc length `s(theta)` on each component, counted counterclockwise from the origin.

    Not wrapped: a paper that draws `s` symmetrically takes it modulo `perimeter(table)`.

    >>> from symbolic.tables import cuspless
    >>> positions(cuspless)
    (4*sin(theta/2) + 9*sqrt(3)/4, theta)
    """
    first, start = table.origin
    count = len(table.components)
    found: dict[int, Expr] = {}
    reached = -arc_length(table.components[first]).subs(theta, start)
    for step in range(count):
        index = (first + step) % count
        component = table.components[index]
        length = arc_length(component)
        if step:
            reached = simplify(reached - length.subs(theta, component.start))
        found[index] = length + reached
        reached = found[index].subs(theta, component.end)
    return tuple(found[index] for index in range(count))


def perimeter(table: Table) -> Expr:
    """The length of the whole boundary.

    >>> from symbolic.tables import cardioid, cuspless
    >>> perimeter(cardioid), perimeter(cuspless)
    (8, 9*sqrt(3)/2)
    """
    total = S.Zero
    for component in table.components:
        length = arc_length(component)
        total += length.subs(theta, component.end) - length.subs(theta, component.start)
    return simplify(total)
