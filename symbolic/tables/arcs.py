"""Arcs of a boundary, enclosed between integers: their points, their tangents, and whether two arcs are disjoint.

An arc is given by bounds of its end points and of its velocity. These give bounds of its points in any direction; where
the velocity keeps to one side, the end points alone suffice. All numbers are integers, in units of `2**-BITS`.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product

from sympy import Expr, I, Rational, Symbol, cos, sin

from symbolic.expressions.enclosures import BITS, EVERYTHING, ONE, Bounds, Enclosures
from symbolic.expressions.signs import Outcome, vanishes
from symbolic.tables.curves import Pair, waves
from symbolic.tables.table import Component, theta

FLATTEST = 3  # most derivatives that may vanish where the velocity does
WORK = 2_000_000  # operations in one proof: about five seconds
MANY = 24  # from so many coefficients on, a finite Fourier sum is evaluated by `FourierSum`
CIRCLE = Enclosures((cos(theta), sin(theta)), theta)
FINE = 64  # bits of the direction of a line between two arcs

Vector = tuple[int, int]
Box = tuple[Bounds, Bounds]


# ---- vectors, and boxes of them


def cross(v: Vector, w: Vector) -> int:
    """The cross product of two vectors, positive where `w` is to the left of `v`."""
    return v[0] * w[1] - v[1] * w[0]


def dot(v: Vector, w: Vector) -> int:
    """The scalar product of two vectors."""
    return v[0] * w[0] + v[1] * w[1]


def products(of: Callable[[Vector, Vector], int], v: Box, w: Box) -> Bounds:
    """Bounds of the scalar or the cross product, `of`, over all vectors of two boxes."""
    found = [of(p, q) for p in product(*v) for q in product(*w)]
    return min(found), max(found)


def _along(v: Vector, box: Box) -> Bounds:
    """Bounds of the scalar product of `v` with all vectors of a box."""
    (a, b), (c, d) = box
    x, y = v
    low, high = (x * a, x * b) if x >= 0 else (x * b, x * a)
    return (low + y * c, high + y * d) if y >= 0 else (low + y * d, high + y * c)


def _negative(box: Box) -> Box:
    (a, b), (c, d) = box
    return (-b, -a), (-d, -c)


def _centre(box: Box) -> Vector:
    """The middle of a box as a vector of at most `FINE` bits; only its direction matters."""
    x, y = sum(box[0]), sum(box[1])
    shift = max(0, max(abs(x), abs(y)).bit_length() - FINE)
    return x >> shift, y >> shift


def in_half_plane(*boxes: Box) -> bool:
    """Do all vectors of the boxes lie in one open half plane?

    They do if, for some vertex of a box, all other vertices lie to its left or in the same direction.
    """
    if any(a <= 0 <= b and c <= 0 <= d for (a, b), (c, d) in boxes):
        return False
    vectors = {v for box in boxes for v in product(*box)}
    return any(all((left := cross(v, w)) > 0 or (left == 0 and dot(v, w) > 0) for w in vectors) for v in vectors)


def disjoint(a: Box, b: Box) -> bool:
    """Whether two boxes have no point in common."""
    return a[0][1] < b[0][0] or b[0][1] < a[0][0] or a[1][1] < b[1][0] or b[1][1] < a[1][0]


def hull(a: Box, b: Box) -> Box:
    """The smallest box that holds two boxes."""
    (p, q), (r, s) = ((min(u[0], v[0]), max(u[1], v[1])) for u, v in zip(a, b, strict=True))
    return (p, q), (r, s)


# ---- arcs


def shown(value: int) -> str:
    """A number in units of `2**-BITS`, as text of six digits."""
    return f"{round(value / ONE, 12):.6g}"


class FourierSum:
    """Bounds of one derivative of a finite Fourier sum `x + i*y` over an interval of `theta`, by Taylor's formula.

    Harmonics that turn by more than a radian over the interval are bounded by their moduli, so that it costs little.
    """

    def __init__(self, found: Mapping[int, Pair], order: int) -> None:
        turned = ((u, v) if order % 2 == 0 else (-v, u) for u, v in found.values())
        sign = -1 if order % 4 > 1 else 1
        self._terms = sorted(
            ((k, *(round(sign * c * k**order * ONE) for c in pair)) for k, pair in zip(found, turned, strict=True)),
            key=lambda term: abs(term[0]),
        )
        self._sums = [[0] * 3]  # partial sums of the moduli of coefficients, times powers 0, 1, 2 of their frequencies
        for k, u, v in self._terms:
            size = abs(u) + abs(v) + 2
            self._sums.append([total + size * abs(k) ** power for power, total in enumerate(self._sums[-1])])

    def __call__(self, over: Bounds) -> tuple[Bounds, Bounds, int]:
        """The bounds of both coordinates, and the number of products that were computed."""
        middle, radius = sum(over) // 2, (over[1] - over[0]) // 2 + 1
        count = bisect_right(self._terms, ONE // radius, key=lambda term: abs(term[0]))
        x = y = dx = dy = 0
        last, wave, wrong, worst = 0, (ONE, 0), 1, 1
        step, error = _circle(middle)
        for k, u, v in self._terms[:count]:
            n = abs(k)
            if n == last + 1:
                (c, s), (p, q) = wave, step
                wave, wrong = (c * p - s * q >> BITS, c * q + s * p >> BITS), wrong + error + 4
            elif n != last:
                wave, wrong = _circle(n * middle)
            last, worst = n, max(worst, wrong)
            c, s = wave if k > 0 else (wave[0], -wave[1])
            p, q = u * c - v * s >> BITS, u * s + v * c >> BITS
            x, y, dx, dy = x + p, y + q, dx - k * q, dy + k * p
        sums = self._sums[count]
        rest = self._sums[-1][0] - sums[0] - (-sums[2] * radius**2 >> 2 * BITS + 1)
        rest += ((sums[0] + (sums[1] * radius >> BITS)) * worst >> BITS) + 8 * (count + 1)  # the rounding errors
        reach = [(abs(slope) * radius >> BITS) + rest for slope in (dx, dy)]
        return (x - reach[0], x + reach[0]), (y - reach[1], y + reach[1]), 4 * count + 1

    def sign(self, low: Rational, high: Rational) -> Outcome:
        """Is the real part positive from `low` to `high`?"""
        todo, left = [(_floor(low), _floor(high) + 1)], WORK
        while todo and left > 0:
            over = todo.pop()
            (lower, upper), _, work = self(over)
            left -= work
            if upper <= 0:
                return Outcome.REFUTED
            if lower <= 0:
                middle = sum(over) // 2
                todo += [(over[0], middle), (middle, over[1])]
        return Outcome.UNKNOWN if todo else Outcome.PROVED


def _floor(value: Rational) -> int:
    return int((value.p << BITS) // value.q)


def _scaled(c: Pair, factor: Expr) -> Pair:
    return c[0] * Fraction(factor.p, factor.q), c[1] * Fraction(factor.p, factor.q)


def _circle(angle: int) -> tuple[Vector, int]:
    """The point of the unit circle at an angle, and a bound of its error, all in units of `2**-BITS`."""
    (a, b), (c, d) = CIRCLE((angle, angle))
    return ((a + b) // 2, (c + d) // 2), b - a + d - c + 2


class Formulas:
    """Bounds of a component's points and derivatives, scaled on each axis; the cost is subtracted from `budget`."""

    def __init__(
        self, component: Component, factors: tuple[Expr, Expr], letters: tuple[Symbol, ...], budget: list[int]
    ) -> None:
        self.component, self.letters, self._budget = component, letters, budget
        self.expressions = [
            tuple(coordinate * factor for coordinate, factor in zip(component.point, factors, strict=True))
        ]
        x, y = component.point
        found = None if letters or factors[0] != factors[1] else waves(x + I * y)
        self._sum = {} if found is None or len(found) < MANY else {k: _scaled(c, factors[0]) for k, c in found.items()}
        self._enclosures: dict[int, Enclosures] = {}
        self._sums: dict[int, FourierSum] = {}

    def derivative(self, order: int) -> tuple[Expr, ...]:
        """The exact derivatives of this order of both scaled coordinates."""
        while len(self.expressions) <= order:
            self.expressions.append(tuple(each.diff(theta) for each in self.expressions[-1]))
        return self.expressions[order]

    def __call__(self, order: int, over: Bounds, letters: tuple[Bounds, ...]) -> Box:
        """Bounds of the derivatives of this order, for `theta` and the parameters `letters` in these intervals."""
        if self._sum:
            if order not in self._sums:
                self._sums[order] = FourierSum(self._sum, order)
            x, y, work = self._sums[order](over)
            self._budget[0] -= work
            return x, y
        if order not in self._enclosures:
            self._enclosures[order] = Enclosures(self.derivative(order), theta, *self.letters)
        self._budget[0] -= self._enclosures[order].work
        x, y = self._enclosures[order](over, *letters)
        return x, y

    def order(self, at: Expr, letters: tuple[Bounds, ...]) -> int:
        """The number of derivatives, from the first on, that vanish at a point for all parameters within `letters`."""
        (here,) = Enclosures([at], *self.letters)(*letters)
        for order in range(1, FLATTEST + 2):
            (a, b), (c, d) = self(order, here, letters)
            if not (a <= 0 <= b and c <= 0 <= d):
                return order - 1
            if not all(vanishes(each.subs(theta, at)) for each in self.derivative(order)):
                return order - 1
        return FLATTEST


@dataclass(frozen=True)
class Piece:
    """A part of a component between two neighbouring ends or marked points, for parameters within the bounds `letters`.

    `stops` has the numbers of derivatives that vanish at the start and at the end; `cusp` is true if the curve turns
    back at the end.
    """

    formulas: Formulas
    ends: tuple[Expr, Expr]
    stops: tuple[int, int]
    cusp: bool = False  # at its end
    letters: tuple[Bounds, ...] = ()
    parameters: tuple[Bounds, ...] = ()

    def at(self, letters: tuple[Bounds, ...]) -> "Piece":
        """The same piece for other bounds of the parameters."""
        return replace(self, letters=letters, parameters=Enclosures(self.ends, *self.formulas.letters)(*letters))

    def parameter(self, share: int, depth: int) -> Bounds:
        """Bounds of `theta` at the fraction `share / 2**depth` of the piece's range."""
        low, high = ((((1 << depth) - share) * a + share * b) for a, b in zip(*self.parameters, strict=True))
        return low >> depth, -(-high >> depth)

    def derivative(self, order: int, over: Bounds) -> Box:
        return self.formulas(order, over, self.letters)

    def leaves(self, end: int) -> tuple[Expr, ...]:
        """The exact direction in which the piece leaves its start (`end` 0), or, run backwards, its end (`end` 1)."""
        order = self.stops[end] + 1
        sign = -1 if end and order % 2 else 1
        return tuple(sign * each.subs(theta, self.ends[end]) for each in self.formulas.derivative(order))

    def leaving(self, end: int) -> Box:
        """Bounds of the vector that `leaves` gives."""
        order = self.stops[end] + 1
        found = self.derivative(order, self.parameter(end, 0))
        return _negative(found) if end and order % 2 else found

    @property
    def whole(self) -> "Arc":
        start, end = (self.derivative(0, self.parameter(share, 0)) for share in (0, 1))
        return Arc(self, 0, 0, start, end)


@dataclass(frozen=True, eq=False)
class Arc:
    """Part `number` of a piece that is cut into `2**depth` equal parts in `theta`, with bounds of its end points."""

    piece: Piece
    number: int
    depth: int
    start: Box
    end: Box

    @property
    def first(self) -> bool:
        return self.number == 0

    @property
    def last(self) -> bool:
        return self.number + 1 == 1 << self.depth

    @cached_property
    def over(self) -> Bounds:
        """The bounds of `theta` on the arc."""
        low, high = (self.piece.parameter(self.number + k, self.depth) for k in (0, 1))
        return low[0], high[1]

    @cached_property
    def velocity(self) -> Box:
        return self.piece.derivative(1, self.over)

    @cached_property
    def directions(self) -> Box:
        """A box of vectors such that every velocity on the arc is a nonnegative multiple of one of them.

        If derivatives vanish at an end, the velocity is a mean of the first nonvanishing one, times a power of the
        distance.
        """
        before, after = self.piece.stops[0] * self.first, self.piece.stops[1] * self.last
        if not (before or after):
            return self.velocity
        if before and after:
            return EVERYTHING, EVERYTHING
        found = self.piece.derivative(1 + before + after, self.over)
        return _negative(found) if after % 2 else found

    @cached_property
    def direction(self) -> Vector:
        """A vector in the middle of `directions`."""
        return _centre(self.directions)

    @cached_property
    def box(self) -> Box:
        return self.span((1, 0)), self.span((0, 1))

    @cached_property
    def extent(self) -> int:
        return max(b - a for a, b in self.box)

    def span(self, across: Vector) -> Bounds:
        """Bounds of the scalar product of the arc's points with the vector `across`."""
        (a, b), (c, d) = (_along(across, end) for end in (self.start, self.end))
        low, high = _along(across, self.directions)
        if low >= 0 or high <= 0:
            return min(a, c), max(b, d)
        low, high = _along(across, self.velocity)
        length = self.over[1] - self.over[0]
        up, down = -(-length * max(high, 0) >> BITS), -(length * min(low, 0) >> BITS)
        return max(a - down, c - up), min(b + up, d + down)

    @property
    def place(self) -> str:
        return f"{self.piece.formulas.component.name} at theta = {shown(sum(self.over) // 2)}"

    def halves(self) -> "tuple[Arc, Arc]":
        number, depth = 2 * self.number, self.depth + 1
        middle = self.piece.derivative(0, self.piece.parameter(number + 1, depth))
        return Arc(self.piece, number, depth, self.start, middle), Arc(self.piece, number + 1, depth, middle, self.end)


def separated(a: Arc, b: Arc) -> bool:
    """Are two arcs separated by a line that is parallel to an axis or to one of the arcs?"""
    if disjoint(a.box, b.box):
        return True
    for x, y in (a.direction, b.direction):
        (p, q), (r, s) = a.span((-y, x)), b.span((-y, x))
        if q < r or s < p:
            return True
    return False


def turn(a: Arc, b: Arc) -> list[Vector] | None:
    """The directions that the curve passes if it turns back between neighbouring arcs; None if the arcs may meet again.

    The list has one direction if a cusp lies between the arcs, otherwise it is empty.
    """
    if a.piece.cusp and a.last and b.first:
        return _turn_back(a, b)
    return [] if in_half_plane(a.directions, b.directions) else None


def _turn_back(a: Arc, b: Arc) -> list[Vector] | None:
    """The result of `turn` at a cusp: the side to which the curve turns back, if one arc is proved to be left of the
    other.

    Both arcs leave the cusp along the common tangent. Consider their heights over this tangent as functions of the
    distance along it. Then either their slopes differ in sign, or their second derivatives differ everywhere.
    """
    along, (m, n) = b.piece.leaving(0), (a.piece.stops[1], b.piece.stops[0])
    if products(dot, along, b.directions)[0] <= 0 or products(dot, along, a.directions)[1] >= 0:
        return None
    if m or n:
        here, there = (products(cross, along, arc.piece.derivative(k + 2, arc.over)) for arc, k in ((a, m), (b, n)))
        here = (-here[1], -here[0]) if m % 2 else here
        left, right = _sign(here[1]) < _sign(there[0]), _sign(there[1]) < _sign(here[0])
    else:
        (low, high), (lower, upper) = (_second_derivative(along, arc) for arc in (a, b))
        left, right = high < lower, upper < low
    x, y = _centre(along)
    if left:
        return [(-y, x)]
    return [(y, -x)] if right else None


def _sign(value: int) -> int:
    return (value > 0) - (value < 0)


def _second_derivative(along: Box, arc: Arc) -> tuple[Fraction, Fraction]:
    """Bounds of the second derivative of an arc's height over the line `along`, up to a factor."""
    turning = products(cross, arc.velocity, arc.piece.derivative(2, arc.over))
    found = [Fraction(x, y**3) for x, y in product(turning, products(dot, along, arc.velocity))]
    return min(found), max(found)
