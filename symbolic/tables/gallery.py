"""Tables by name, each defined once: those of the paper, polygons, stadium, mushroom, tables with holes.

The functions that define a table of one's own are here too: `polar`, `parametric`, `piecewise`. A definition is the
boundary as the paper writes it; curvature, arc length, stability matrices, thresholds and the code of the numeric maps
are all derived from it.

Every table of straight sides and arcs is exact, closed and counterclockwise by construction; a hole runs clockwise, so
that the inside of the table lies to the left of every component.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from inspect import signature
from itertools import pairwise
from typing import TypeAlias

from sympy import Expr, Interval, Rational, S, Symbol, cos, oo, pi, sin, sqrt

from symbolic.tables.families import NAMES
from symbolic.tables.formula import NAMES as NAMES_OF_FORMULAS
from symbolic.tables.formula import parse
from symbolic.tables.table import Component, Mark, Shape, Table, a, alpha, exact_number, theta
from symbolic.tables.validity import (
    closed_and_finite,
    counterclockwise_and_simple,
    positive_radius,
    prove_table,
    radius_over,
    validated,
)


def polar(
    rho: Expr | int | str,
    name: str = "polar",
    shapes: Iterable[Shape] = (),
    undefined: Iterable[Mark] = (),
    **letters: str,
) -> Table:
    """The table bounded by `rho(theta)`, `-pi <= theta < pi`, in polar coordinates.

    Text is parsed by `symbolic.tables.formula`, which executes nothing. Each parameter of the formula is a keyword (one
    of `letters`) with its range, `LOW:HIGH`; a letter that is not in the formula is refused. The boundary is proved
    simple for all values in the range; `Table.at` gives the parameter a value.

    >>> polar("1 + b*cos(2*theta)", b="0:1/5").shapes[0].range
    Interval(0, 1/5)

    >>> polar(1 + cos(5 * theta) / 40).components[0].at(S.Zero)
    (41/40, 0)
    >>> polar("1 + cos(5*theta)/40") == polar(1 + cos(5 * theta) / 40)
    True
    """
    shapes, undefined = (*shapes, *_ranges(name, letters)), tuple(undefined)
    rho = _exact(rho, shapes)
    _in_use(name, letters, rho)
    whole = arc(name, rho * cos(theta), rho * sin(theta), -pi, pi)
    table = closed_and_finite(Table(name, (whole,), shapes, undefined))
    simple = not shapes and not undefined and positive_radius(name, rho)
    found = table if simple else counterclockwise_and_simple(table)
    return _over_ranges(found) if letters else found


def parametric(
    x: Expr | str,
    y: Expr | str,
    name: str = "parametric",
    shapes: Iterable[Shape] = (),
    undefined: Iterable[Mark] = (),
    **letters: str,
) -> Table:
    """The table bounded by the closed curve `(x(theta), y(theta))`, `-pi <= theta < pi`; `letters` as in `polar`.

    >>> parametric(3 * cos(theta), 2 * sin(theta)).components[0].at(pi / 2)
    (0, 2)
    """
    shapes = (*shapes, *_ranges(name, letters))
    whole = Component(name, (_exact(x, shapes), _exact(y, shapes)), -pi, pi)
    _in_use(name, letters, *whole.point)
    found = validated(Table(name, (whole,), shapes, tuple(undefined)))
    return _over_ranges(found) if letters else found


def support(h: Expr | str, name: str = "support", **letters: str) -> Table:
    """The table that the lines `x*cos(theta) + y*sin(theta) = h(theta)` touch; `letters` as in `polar`.

    It is convex where `h + h'' >= 0`; elsewhere the curve turns back, and is refused.

    >>> from symbolic import area
    >>> area(support("1 + cos(3*theta)/10"))  # of the width 2 in all directions: h(theta) + h(theta + pi)
    24*pi/25
    """
    ranges = _ranges(name, letters)
    h = _exact(h, ranges)
    _in_use(name, letters, h)
    x, y = supported(h)
    found = parametric(x, y, name, ranges)
    return _over_ranges(found) if letters else found


def supported(h: Expr) -> tuple[Expr, Expr]:
    """The point where a line of the support function `h` touches: `h*N + h'*T`, with unit normal `N` and tangent."""
    slope = h.diff(theta)
    return h * cos(theta) - slope * sin(theta), h * sin(theta) + slope * cos(theta)


def _ranges(name: str, letters: Mapping[str, str]) -> list[Shape]:
    """The shape parameters with their ranges, from keywords whose values are texts `LOW:HIGH`."""
    found = []
    for letter, text in letters.items():
        low, colon, high = str(text).partition(":")
        if not colon:
            raise ValueError(f"{name}: {letter} = {text} is no range; accepted: LOW:HIGH such as {letter}='0:1/5'")
        ends = exact_number(f"{name}: {letter}", low.strip()), exact_number(f"{name}: {letter}", high.strip())
        if not ends[0] < ends[1]:
            raise ValueError(f"{name}: {letter} = {text} is no range; accepted: LOW:HIGH with LOW < HIGH")
        found.append(Shape(Symbol(letter, real=True), Interval(*ends), "is outside of the range that was given"))
    return found


def _in_use(name: str, letters: Iterable[str], *formulas: Expr) -> None:
    """`ValueError` for a letter that is in none of the formulas."""
    used = {symbol.name for formula in formulas for symbol in formula.free_symbols}
    for letter in letters:
        if letter not in used:
            raise ValueError(
                f"{name}: the formula has no letter {letter}; it has: {', '.join(sorted(used - {'theta'})) or 'none'}"
            )


def _over_ranges(table: Table) -> Table:
    """`table`, if it is proved to be a table for all parameters in their ranges; otherwise raises `ValueError`."""
    if not radius_over(table):
        prove_table(table)
    return table


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


def _exact(given: Expr | int | str, shapes: Iterable[Shape] = ()) -> Expr:
    """An expression unchanged, or the expression that text denotes; the text may contain the symbols of `shapes`."""
    if isinstance(given, bool) or not isinstance(given, str | int | float | Expr):  # floats are refused later
        raise ValueError(f"table: {given!r} is no formula; give an exact expression, an integer, or text")
    own = {shape.symbol.name: shape.symbol for shape in shapes}
    return parse(given, {**NAMES_OF_FORMULAS, **own}) if isinstance(given, str) else S(given)


def egg(K: int | Expr = 3) -> Table:
    """The K-pointed egg `rho = 1 + alpha*cos(K*theta)`. Paper: section 6, with K = 3, after [Robnik1983].

    `K` may be a symbol, odd or even, for statements about every such egg.

    >>> egg(3).components[0].at(S.Zero)
    (alpha + 1, 0)
    """
    points = _exact(K)
    if points.is_integer is False or (points - 2).is_negative or points.has(theta):
        raise ValueError(f"egg: K = {K} is no number of points; K must be an integer of at least 2")
    return _egg(points)


@lru_cache(maxsize=64)
def _egg(points: Expr) -> Table:
    """The egg with a number of points that `egg` has checked.

    Its radius is at least `1 - alpha > 0`, so that it runs counterclockwise and does not cross itself.
    """
    convex = Shape(alpha, Interval(0, 1 / (1 + points**2)), "makes the table non-convex")
    rho = 1 + alpha * cos(points * theta)
    whole = arc("egg", rho * cos(theta), rho * sin(theta), -pi, pi)
    return closed_and_finite(Table("egg", (whole,), (convex,)))


# `validated` is not run on the paper's tables at each import: a test proves once what it would prove.
circle = Table("circle", (arc("circle", cos(theta), sin(theta), -pi, pi),))
ellipse = Table(
    "ellipse",
    (arc("ellipse", a * cos(theta), sin(theta), -pi, pi),),
    (Shape(a, Interval(1, oo), "makes the y axis the longer one"),),
)
cardioid = Table(
    "cardioid",
    (arc("cardioid", (1 + cos(theta)) * cos(theta), (1 + cos(theta)) * sin(theta), -pi, pi),),
    undefined=(Mark("cusp", 0, pi),),
)
cuspless = Table(
    "cuspless",
    (
        arc("arc", *cardioid.components[0].point, -2 * pi / 3, 2 * pi / 3),
        arc("wall", -Rational(1, 4), -theta, -sqrt(3) / 4, sqrt(3) / 4),
    ),
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


Number: TypeAlias = Expr | int | str
Length: TypeAlias = Number | Shape  # a `Shape` stays free, so that the length may vary
HALF = Rational(1, 2)


def polygon(*corners: tuple[Number, Number], name: str = "polygon", shapes: Iterable[Shape] = ()) -> Table:
    """The table with these corners, in counterclockwise order; the first may be repeated at the end.

    >>> [side.name for side in polygon((0, 0), (1, 0), (0, 1)).components]
    ['side1', 'side2', 'side3']
    >>> polygon((0, 0), (1, 0), (0, 1), (0, 0)) == polygon((0, 0), (1, 0), (0, 1))
    True
    """
    exact = [(exact_number("corner", x), exact_number("corner", y)) for x, y in corners]
    if len(exact) > 1 and exact[0] == exact[-1]:
        exact.pop()
    if len(exact) < 3:
        raise ValueError(f"{name}: {len(exact)} corners make no polygon; give at least 3")
    for i, ((x, y), after) in enumerate(pairwise(exact), 1):
        if (x, y) == after:
            raise ValueError(f"{name}: corners {i} and {i + 1} are both ({x}, {y}); leave one of them out")
    return piecewise(*_sides(exact), name=name, shapes=shapes)


def regular(n: int, radius: Number = 1) -> Table:
    """The regular polygon with `n` corners on a circle about the origin, a side at the bottom.

    >>> regular(4, "2").components[0].at(S.Zero)
    (-sqrt(2), -sqrt(2))
    """
    if n < 3:
        raise ValueError(f"regular: n = {n!r} is no number of sides; accepted: integers from 3")
    r = positive("regular: radius", radius)
    angles = [-pi / 2 - pi / n + 2 * pi * k / n for k in range(n)]
    corners = [(r * cos(a), r * sin(a)) for a in angles]
    return Table(f"regular{n}", tuple(_sides(corners)))  # convex, so that no proof is needed


def square(side: Length = 1) -> Table:
    """The square with a corner at the origin.

    >>> square().components[2].at(S.Zero)
    (1, 1)
    """
    a = positive("square: side", side)
    return polygon((0, 0), (a, 0), (a, a), (0, a), name="square", shapes=free(side))


def triangle(side: Length = 1) -> Table:
    """The equilateral triangle on the x axis.

    >>> triangle(2).components[2].at(S.Zero)
    (1, sqrt(3))
    """
    a = positive("triangle: side", side)
    return polygon((0, 0), (a, 0), (a / 2, a * sqrt(3) / 2), name="triangle", shapes=free(side))


def stadium(straight: Length = 2, radius: Length = 1) -> Table:
    """Two half circles joined by straight sides of length `straight`. [Bunimovich1979]

    >>> stadium().components[0].at(S.Zero)
    (2, 0)
    """
    half, r = positive("stadium: straight", straight) / 2, positive("stadium: radius", radius)
    return piecewise(
        round_arc("right", (half, 0), r, -pi / 2, pi / 2),
        arc("top", -theta, r, -half, half),
        arc("left", -half - r * cos(theta), -r * sin(theta), -pi / 2, pi / 2),
        arc("bottom", theta, -r, -half, half),
        name="stadium",
        shapes=free(straight, radius),
    )


def reuleaux(radius: Length = 1) -> Table:
    """The Reuleaux triangle: three arcs of this radius, each about the corner opposite to it.

    >>> reuleaux().components[0].at(S.Zero)
    (1, 0)
    """
    r = positive("reuleaux: radius", radius)
    corners = [(S.Zero, S.Zero), (r, S.Zero), (r / 2, r * sqrt(3) / 2)]
    starts = [S.Zero, 2 * pi / 3, -2 * pi / 3]
    arcs = [round_arc(f"arc{i}", corners[i - 1], r, starts[i - 1], starts[i - 1] + pi / 3) for i in (1, 2, 3)]
    return piecewise(*arcs, name="reuleaux", shapes=free(radius))


def lemon(half_angle: Length = "1/3") -> Table:
    """Two arcs of the unit circle with two corners; each arc subtends `2*pi*half_angle`, less than a half turn.

    >>> lemon("1/3").components[0].at(S.Zero)
    (1/2, 0)
    """
    share, low, high = _within("lemon: half_angle", half_angle)
    if not 0 < low <= high < HALF:
        raise ValueError(f"lemon: half_angle = {half_angle} is out of range; accepted: numbers between 0 and 1/2")
    angle, shift = share * pi, cos(share * pi)
    return piecewise(
        round_arc("right", (-shift, 0), S.One, -angle, angle),
        arc("left", shift - cos(theta), -sin(theta), -angle, angle),
        name="lemon",
        shapes=free(half_angle),
    )


def semi_ellipse(a: Length = 2) -> Table:
    """The upper half of the ellipse with half axes `a` and 1.

    >>> semi_ellipse().components[0].at(pi / 2)
    (0, 1)
    """
    half = positive("semi_ellipse: a", a)
    top = arc("top", half * cos(theta), sin(theta), S.Zero, pi)
    return piecewise(top, arc("base", theta, S.Zero, -half, half), name="semi_ellipse", shapes=free(a))


def mushroom(stem: Length = "1/2", foot: Length = 1) -> Table:
    """A half disc of radius 1 on a stem of half width `stem` and length `foot`.

    >>> mushroom().components[3].at(S.Zero)
    (0, -1)
    """
    w, h = positive("mushroom: stem", stem), positive("mushroom: foot", foot)
    if not _within("mushroom: stem", stem)[2] < 1:
        raise ValueError(f"mushroom: stem = {stem} is wider than the cap; accepted: numbers between 0 and 1")
    return piecewise(
        round_arc("cap", (0, 0), S.One, 0, pi),
        arc("left brim", theta, 0, -1, -w),
        arc("left side", -w, -theta, 0, h),
        arc("foot", theta, -h, -w, w),
        arc("right side", w, theta, -h, 0),
        arc("right brim", theta, 0, w, 1),
        name="mushroom",
        shapes=free(stem, foot),
    )


def sinai(radius: Length = "1/4") -> Table:
    """The unit square about the origin with a disc of this radius in its middle.

    >>> [part.name for part in sinai().components]
    ['side1', 'side2', 'side3', 'side4', 'disc']
    """
    r = positive("sinai: radius", radius)
    if not _within("sinai: radius", radius)[2] < HALF:
        raise ValueError(f"sinai: radius = {radius} is too large for the cell; accepted: numbers between 0 and 1/2")
    sides = _sides([(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)])
    return piecewise(*sides, disc("disc", (0, 0), r), name="sinai", shapes=free(radius))


def diamond() -> Table:
    """The table between four dispersing quarter circles of radius 1 about the points (+-1, +-1), with four cusps.

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
    """A focusing arc of a circle, counterclockwise.

    >>> round_arc("cap", (0, 1), 2, 0, pi).at(S.Zero)
    (2, 1)
    """
    x, y = (exact_number(f"{name}: centre", value) for value in centre)
    r = exact_number(f"{name}: radius", radius)
    return arc(name, x + r * cos(theta), y + r * sin(theta), start, end)


def disc(name: str, centre: tuple[Number, Number], radius: Number) -> Component:
    """A circular hole: a whole circle, clockwise.

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


def _within(label: str, given: Length) -> tuple[Expr, Expr, Expr]:
    """A length and both ends of its range; if it is a number and not a free parameter, all three are this number."""
    if isinstance(given, Shape):
        return given.symbol, given.range.start, given.range.end
    value = exact_number(label, given)
    return value, value, value


def positive(label: str, given: Length) -> Expr:
    """The exact value of a length, or its symbol; `ValueError` unless it is positive."""
    value, low, _ = _within(label, given)
    if not low.is_positive:
        raise ValueError(f"{label} = {low} is no length; accepted: positive numbers")
    return value


def free(*lengths: Length) -> list[Shape]:
    """Those of the lengths that are free, as shape parameters."""
    return [length for length in lengths if isinstance(length, Shape)]


OWN = (square, triangle, stadium, reuleaux, lemon, semi_ellipse, mushroom, sinai, diamond)


class Gallery(Mapping[str, Callable[..., Table]]):
    """Functions that make tables, by name: those of this file and those in the folder `families`."""

    def __getitem__(self, name: str) -> Callable[..., Table]:
        own = {make.__name__: make for make in OWN}
        if name not in own and name in NAMES:
            make: Callable[..., Table] = getattr(import_module(f"symbolic.tables.families.{name}"), name)
            return make
        return own[name]

    def __iter__(self) -> Iterator[str]:
        return iter((*(make.__name__ for make in OWN), *NAMES))

    def __len__(self) -> int:
        return len(OWN) + len(NAMES)


GALLERY = Gallery()


def of_gallery(name: str, lengths: Mapping[str, Number]) -> Table:
    """The table of the gallery with this name, with `lengths` in place of its default ones.

    >>> of_gallery("square", {"side": "1/2"}).components[2].at(S.Zero)
    (1/2, 1/2)
    """
    known = list(signature(GALLERY[name]).parameters)
    for key in lengths:
        if key not in known:
            raise ValueError(f"{name}: {key} is none of its lengths; it has: {', '.join(known) or 'none'}")
    return GALLERY[name](**lengths)
