"""Convexity as a proved condition on the shape.

A closed simple boundary is convex where it never turns right. On a trigonometric boundary the
turning `x'y'' - y'x''` is a polynomial in `tan(x/2)`, with `x` the common multiple of `theta` that it
depends on, so its sign over all of the boundary and the whole shape range can be proved.
"""

from sympy import Expr, Interval, oo

from symbolic.proofs.signs import Box, Finding, Outcome, conjunction, nonnegative, positive
from symbolic.tables.fourier import in_half_tangent
from symbolic.tables.geometry import turning
from symbolic.tables.ranges import parameter_box
from symbolic.tables.symbols import theta
from symbolic.tables.table import Table


def convexity(table: Table, box: Box | None = None, strictly: bool = False) -> Finding:
    """Is the table convex for every shape in `box` (by default its own range, ends included)?

    `strictly` asks for negative curvature everywhere. A piecewise table is judged component by
    component, each on its whole period, which is enough but not needed.

    >>> from symbolic.tables import egg
    >>> convexity(egg(3)).outcome.name, convexity(egg(3), strictly=True).outcome.name
    ('PROVED', 'REFUTED')
    """
    ranges = dict(box or parameter_box(table))
    return conjunction(*(_turns_left(turning(component), ranges, strictly) for component in table.components))


def _turns_left(expression: Expr, box: Box, strictly: bool) -> Finding:
    judge = positive if strictly else nonnegative
    if not expression.has(theta):
        return judge(expression, {x: r for x, r in box.items() if x in expression.free_symbols})
    half = in_half_tangent(expression)
    if half is None:
        return Finding(Outcome.UNKNOWN, f"{expression} is no trigonometric polynomial")
    polynomial, T, at_pi = half
    used = {x: r for x, r in box.items() if x in polynomial.free_symbols}
    far = judge(at_pi, {x: r for x, r in box.items() if x in at_pi.free_symbols})
    sides = [judge(polynomial.subs(T, sign * T), {**used, T: Interval(0, oo)}) for sign in (1, -1)]
    return conjunction(*sides, far)
