"""The tables of the paper, each defined once, and the means to define one's own.

A definition is the boundary as the paper writes it; curvature, arc length, stability matrices,
thresholds and the code of the numeric maps are all derived from it.
"""

from collections.abc import Iterable

from sympy import Expr, Interval, Rational, S, cos, oo, pi, sin, sqrt

from symbolic.tables.formula import parse
from symbolic.tables.table import Component, Mark, Shape, Table, a, alpha, theta
from symbolic.tables.validity import closed_and_finite, counterclockwise_and_simple, positive_radius, validated

__all__ = ["arc", "cardioid", "circle", "cuspless", "egg", "ellipse", "named", "parametric", "piecewise", "polar"]


def polar(
    rho: Expr | int | str,
    name: str = "polar",
    shapes: Iterable[Shape] = (),
    undefined: Iterable[Mark] = (),
) -> Table:
    """The table bounded by `rho(theta)`, `-pi <= theta < pi`, in polar coordinates.

    Text is read by `symbolic.tables.formula`, which executes nothing.

    >>> polar(1 + cos(5 * theta) / 40).components[0].at(S.Zero)
    (41/40, 0)
    >>> polar("1 + cos(5*theta)/40") == polar(1 + cos(5 * theta) / 40)
    True
    """
    rho, shapes, undefined = _exact(rho), tuple(shapes), tuple(undefined)
    whole = arc(name, rho * cos(theta), rho * sin(theta), -pi, pi)
    table = closed_and_finite(Table(name, (whole,), shapes, undefined))
    simple = not shapes and not undefined and positive_radius(name, rho)
    return table if simple else counterclockwise_and_simple(table)


def parametric(
    x: Expr | str,
    y: Expr | str,
    name: str = "parametric",
    shapes: Iterable[Shape] = (),
    undefined: Iterable[Mark] = (),
) -> Table:
    """The table bounded by the closed curve `(x(theta), y(theta))`, `-pi <= theta < pi`.

    >>> parametric(3 * cos(theta), 2 * sin(theta)).components[0].at(pi / 2)
    (0, 2)
    """
    whole = arc(name, x, y, -pi, pi)
    return validated(Table(name, (whole,), tuple(shapes), tuple(undefined)))


def piecewise(
    *components: Component,
    name: str = "piecewise",
    shapes: Iterable[Shape] = (),
    undefined: Iterable[Mark] = (),
    origin: tuple[int, Expr] = (0, S.Zero),
) -> Table:
    """The table bounded by several components, in counterclockwise order, each starting where the last ends."""
    return validated(Table(name, components, tuple(shapes), tuple(undefined), origin))


def arc(name: str, x: Expr | str, y: Expr | str, start: Expr | str, end: Expr | str) -> Component:
    """A component of a piecewise table: `(x(theta), y(theta))` for `start <= theta <= end`."""
    return Component(name, (_exact(x), _exact(y)), _exact(start), _exact(end))


def _exact(given: Expr | int | str) -> Expr:
    """An expression as it is; text only through the parser that executes nothing."""
    if isinstance(given, bool) or not isinstance(given, str | int | float | Expr):  # floats are refused later
        raise ValueError(f"table: {given!r} is no formula; give an exact expression, an integer, or text")
    return parse(given) if isinstance(given, str) else S(given)


def egg(K: int | Expr = 3) -> Table:
    """The K-pointed egg `rho = 1 + alpha*cos(K*theta)`. Paper: section 6, with K = 3, after [Robnik1983].

    `K` may be a symbol, odd or even, for statements about every such egg.

    >>> egg(3).components[0].at(S.Zero)
    (alpha + 1, 0)
    """
    points = _exact(K)
    if points.is_integer is False or (points - 2).is_negative or points.has(theta):
        raise ValueError(f"egg: K = {K} is no number of points; K must be an integer of at least 2")
    convex = Shape(alpha, Interval(0, 1 / (1 + points**2)), "makes the table non-convex")
    return polar(1 + alpha * cos(points * theta), "egg", [convex])


circle = polar(1, "circle")
ellipse = parametric(
    a * cos(theta), sin(theta), "ellipse", [Shape(a, Interval(1, oo), "makes the y axis the longer one")]
)
cardioid = polar(1 + cos(theta), "cardioid", undefined=[Mark("cusp", 0, pi)])
cuspless = piecewise(
    arc("arc", *cardioid.components[0].point, -2 * pi / 3, 2 * pi / 3),
    arc("wall", -Rational(1, 4), -theta, -sqrt(3) / 4, sqrt(3) / 4),
    name="cuspless",
    origin=(1, S.Zero),
)


def named(name: str, K: int = 3) -> Table:
    """The paper's table called `name`: circle, ellipse, cardioid, cuspless or egg.

    >>> named("egg").name
    'egg'
    """
    if name == "egg":
        return egg(K)
    for table in (circle, ellipse, cardioid, cuspless):
        if table.name == name:
            return table
    raise ValueError(f"no table is called {name}; the paper's are circle, ellipse, cardioid, cuspless, egg")
