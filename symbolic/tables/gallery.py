"""Tables of straight sides and circular or elliptic arcs, by name: polygons, stadium, mushroom, tables with holes.

Every one is exact, closed and counterclockwise by construction; a hole runs clockwise, so that the inside of the
table lies to the left of every component.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType
from typing import TypeAlias

from sympy import Expr, Rational, S, cos, pi, sin, sqrt

from symbolic.tables.paper import arc, piecewise
from symbolic.tables.table import Component, Table, exact_number, theta

Number: TypeAlias = Expr | int | str
HALF = Rational(1, 2)


def polygon(*corners: tuple[Number, Number], name: str = "polygon") -> Table:
    """The table with these corners, in counterclockwise order.

    >>> [side.name for side in polygon((0, 0), (1, 0), (0, 1)).components]
    ['side1', 'side2', 'side3']
    """
    if len(corners) < 3:
        raise ValueError(f"{name}: {len(corners)} corners make no polygon; give at least 3")
    return piecewise(*_sides(corners), name=name)


def regular(n: int, radius: Number = 1) -> Table:
    """The regular polygon with `n` corners on a circle about the origin, a side at the bottom.

    >>> regular(4, "2").components[0].at(S.Zero)
    (-sqrt(2), -sqrt(2))
    """
    if n < 3:
        raise ValueError(f"regular: n = {n!r} is no number of sides; accepted: integers from 3")
    r = _positive("regular: radius", radius)
    angles = [-pi / 2 - pi / n + 2 * pi * k / n for k in range(n)]
    return polygon(*((r * cos(a), r * sin(a)) for a in angles), name=f"regular{n}")


def square(side: Number = 1) -> Table:
    """The square with a corner at the origin.

    >>> square().components[2].at(S.Zero)
    (1, 1)
    """
    a = _positive("square: side", side)
    return polygon((0, 0), (a, 0), (a, a), (0, a), name="square")


def triangle(side: Number = 1) -> Table:
    """The equilateral triangle on the x axis.

    >>> triangle(2).components[2].at(S.Zero)
    (1, sqrt(3))
    """
    a = _positive("triangle: side", side)
    return polygon((0, 0), (a, 0), (a / 2, a * sqrt(3) / 2), name="triangle")


def stadium(straight: Number = 2, radius: Number = 1) -> Table:
    """Two half circles joined by straight sides of length `straight`. [Bunimovich1979]

    >>> stadium().components[0].at(S.Zero)
    (2, 0)
    """
    half, r = _positive("stadium: straight", straight) / 2, _positive("stadium: radius", radius)
    return piecewise(
        round_arc("right", (half, 0), r, -pi / 2, pi / 2),
        arc("top", -theta, r, -half, half),
        arc("left", -half - r * cos(theta), -r * sin(theta), -pi / 2, pi / 2),
        arc("bottom", theta, -r, -half, half),
        name="stadium",
    )


def reuleaux(radius: Number = 1) -> Table:
    """The Reuleaux triangle: three arcs of this radius, each about the corner opposite to it.

    >>> reuleaux().components[0].at(S.Zero)
    (1, 0)
    """
    r = _positive("reuleaux: radius", radius)
    corners = [(S.Zero, S.Zero), (r, S.Zero), (r / 2, r * sqrt(3) / 2)]
    starts = [S.Zero, 2 * pi / 3, -2 * pi / 3]
    arcs = [round_arc(f"arc{i}", corners[i - 1], r, starts[i - 1], starts[i - 1] + pi / 3) for i in (1, 2, 3)]
    return piecewise(*arcs, name="reuleaux")


def lemon(half_angle: Number = "1/3") -> Table:
    """Two arcs of the unit circle with two corners; each arc subtends `2*pi*half_angle`, less than a half turn.

    >>> lemon("1/3").components[0].at(S.Zero)
    (1/2, 0)
    """
    share = exact_number("lemon: half_angle", half_angle)
    if not 0 < share < HALF:
        raise ValueError(f"lemon: half_angle = {half_angle} is out of range; accepted: numbers between 0 and 1/2")
    angle, shift = share * pi, cos(share * pi)
    return piecewise(
        round_arc("right", (-shift, 0), S.One, -angle, angle),
        arc("left", shift - cos(theta), -sin(theta), -angle, angle),
        name="lemon",
    )


def semi_ellipse(a: Number = 2) -> Table:
    """The upper half of the ellipse with half axes `a` and 1.

    >>> semi_ellipse().components[0].at(pi / 2)
    (0, 1)
    """
    half = _positive("semi_ellipse: a", a)
    top = arc("top", half * cos(theta), sin(theta), S.Zero, pi)
    return piecewise(top, arc("base", theta, S.Zero, -half, half), name="semi_ellipse")


def mushroom(stem: Number = "1/2", foot: Number = 1) -> Table:
    """A half disc of radius 1 on a stem of half width `stem` and length `foot`.

    >>> mushroom().components[3].at(S.Zero)
    (0, -1)
    """
    w, h = _positive("mushroom: stem", stem), _positive("mushroom: foot", foot)
    if not w < 1:
        raise ValueError(f"mushroom: stem = {stem} is wider than the cap; accepted: numbers between 0 and 1")
    return piecewise(
        round_arc("cap", (0, 0), S.One, 0, pi),
        arc("left brim", theta, 0, -1, -w),
        arc("left side", -w, -theta, 0, h),
        arc("foot", theta, -h, -w, w),
        arc("right side", w, theta, -h, 0),
        arc("right brim", theta, 0, w, 1),
        name="mushroom",
    )


def sinai(radius: Number = "1/4") -> Table:
    """The unit square about the origin with a disc of this radius in its middle.

    >>> [part.name for part in sinai().components]
    ['side1', 'side2', 'side3', 'side4', 'disc']
    """
    r = _positive("sinai: radius", radius)
    sides = _sides([(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)])
    return piecewise(*sides, disc("disc", (0, 0), r), name="sinai")


def diamond() -> Table:
    """Between four dispersing quarter circles about the corners of a square of half side 1: four cusps.

    >>> diamond().components[0].at(pi / 2)
    (1, 0)
    """
    centres = [(1, 1, pi / 2), (-1, 1, S.Zero), (-1, -1, -pi / 2), (1, -1, -pi)]
    arcs = [
        arc(f"arc{i}", x + cos(theta), y - sin(theta), start, start + pi / 2)
        for i, (x, y, start) in enumerate(centres, 1)
    ]
    return piecewise(*arcs, name="diamond")


def round_arc(name: str, centre: tuple[Number, Number], radius: Number, start: Number, end: Number) -> Component:
    """A focusing arc of a circle, run through counterclockwise.

    >>> round_arc("cap", (0, 1), 2, 0, pi).at(S.Zero)
    (2, 1)
    """
    x, y = (exact_number(f"{name}: centre", value) for value in centre)
    r = exact_number(f"{name}: radius", radius)
    return arc(name, x + r * cos(theta), y + r * sin(theta), start, end)


def disc(name: str, centre: tuple[Number, Number], radius: Number) -> Component:
    """A circular hole: a whole circle, run through clockwise.

    >>> disc("pillar", (1, 0), "1/4").at(pi / 2)
    (1, -1/4)
    """
    x, y = (exact_number(f"{name}: centre", value) for value in centre)
    r = exact_number(f"{name}: radius", radius)
    return arc(name, x + r * cos(theta), y - r * sin(theta), -pi, pi)


def _sides(corners: Sequence[tuple[Number, Number]]) -> list[Component]:
    exact = [(exact_number("corner", x), exact_number("corner", y)) for x, y in corners]
    ring = pairwise([*exact, exact[0]])
    return [
        arc(f"side{i}", x + theta * (X - x), y + theta * (Y - y), 0, 1) for i, ((x, y), (X, Y)) in enumerate(ring, 1)
    ]


def _positive(label: str, given: Number) -> Expr:
    value = exact_number(label, given)
    if not value.is_positive:
        raise ValueError(f"{label} = {given} is no length; accepted: positive numbers")
    return value


GALLERY: Mapping[str, Callable[..., Table]] = MappingProxyType(
    {
        make.__name__: make
        for make in (square, triangle, stadium, reuleaux, lemon, semi_ellipse, mushroom, sinai, diamond)
    }
)
