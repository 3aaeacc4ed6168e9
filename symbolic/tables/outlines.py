"""Tables bounded by outlines: straight sides, Bezier curves and arcs of conics, all with rational numbers.

An arc of a conic is `centre + u*cos(theta) + v*sin(theta)` for `theta` from 0 to `quarters*pi/2 + 2*atan(rest)`; with
rational `rest` its ends are rational points too.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from sympy import Expr, S, atan, cos, pi, sin

from symbolic.tables.measured import read
from symbolic.tables.polynomial import Bezier, Piece, Vector, as_component, elevated, separate, signed_area
from symbolic.tables.table import Component, Table, theta

DIGITS = 40  # of an angle in the computation of an area
MOST = 4000  # largest number of pieces
FINEST = 10**40  # denominator of the tangent of an angle
NEARLY = Fraction(1, 4)  # an angle with a smaller sine is nearly half a turn
SHORT = Fraction(1, 8)  # a smaller `rest` of an arc is joined to the quarter turn before it
PARALLEL = Fraction(1, 2**42)  # largest sine between tangents that are equal up to rounding, near the origin
QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # cosine and sine


class ConicArc(NamedTuple):
    """The arc `centre + u*cos(theta) + v*sin(theta)`, `0 <= theta <= quarters*pi/2 + 2*atan(rest)`, `0 <= rest < 1`."""

    centre: Vector
    u: Vector
    v: Vector
    quarters: int
    rest: Fraction = Fraction(0)

    @property
    def start(self) -> Vector:
        """The point at `theta = 0`."""
        return self._at(1, 0)

    @property
    def end(self) -> Vector:
        """The point at the largest `theta`.

        >>> ConicArc((0, 0), (2, 0), (0, 1), 1, Fraction(1, 2)).end
        (Fraction(-8, 5), Fraction(3, 5))
        """
        return self._at(*self._last)

    @property
    def angle(self) -> Expr:
        """The largest `theta`, the angle of the whole arc."""
        return S(self.quarters) * pi / 2 + 2 * atan(S(self.rest))

    def turned(self) -> "ConicArc":
        """The same arc, run from its end to its start."""
        c, s = self._last
        (ux, uy), (vx, vy) = self.u, self.v
        return self._replace(u=(ux * c + vx * s, uy * c + vy * s), v=(ux * s - vx * c, uy * s - vy * c))

    def area(self) -> Fraction:
        """The arc's term in Green's formula for the area, to `DIGITS` digits."""
        (x, y), (p, q) = self.start, self.end
        angle = Fraction(str(self.angle.evalf(DIGITS)))
        swept = (self.u[0] * self.v[1] - self.u[1] * self.v[0]) * angle
        return (swept + self.centre[0] * (q - y) - self.centre[1] * (p - x)) / 2

    def parts(self) -> list[Piece]:
        """The arc as rational Bezier curves, each of about a quarter turn or less: control points with weights."""
        found: list[Piece] = []
        u, v = self.u, self.v
        steps = [Fraction(1)] * self.quarters + ([self.rest] if self.rest else [])
        if self.quarters and 0 < self.rest < SHORT:  # `between` leaves a small rest on arcs of nearly half a turn
            steps[-2:] = [(1 + self.rest) / (1 - self.rest)]
        for h in steps:
            weights = 1 + h * h
            corner, last = [], []
            for c, a, b in zip(self.centre, u, v, strict=True):
                corner.append(c + a + h * b)
                last.append(c * weights + a * (1 - h * h) + 2 * h * b)
            start = (*(c + a for c, a in zip(self.centre, u, strict=True)), Fraction(1))
            found.append((start, (*corner, Fraction(1)), (*last, weights)))
            u, v = v, (-u[0], -u[1])
        return found

    def component(self, name: str) -> Component:
        """The arc as a component; a whole ellipse is one closed curve on [-pi, pi]."""
        x, y = (
            S(c) + S(a) * cos(theta) + S(b) * sin(theta) for c, a, b in zip(self.centre, self.u, self.v, strict=True)
        )
        return Component(name, (x, y), *((-pi, pi) if self.quarters == 4 else (S.Zero, self.angle)))

    @property
    def last_velocity(self) -> Vector:
        """The derivative by `theta` at the end; at the start it is `v`."""
        c, s = self._last
        (ux, uy), (vx, vy) = self.u, self.v
        return vx * c - ux * s, vy * c - uy * s

    def between(self, first: Vector, last: Vector) -> "ConicArc":
        """The arc with the same ends whose velocities there have the directions `first` and `last`.

        These must be the directions of this arc up to rounding. The result is an affine image of this arc. It is
        determined by its ends and by the point where the tangents there meet. For an arc of nearly half a turn, where
        that point is far away, the angle is adapted too.

        >>> ConicArc((0, 0), (1, 0), (0, 1), 1).between((1, 3), (-1, 0)).v
        (Fraction(1, 3), Fraction(1, 1))
        """
        (x0, y0), (x1, y1), (c, s) = self.start, self.end, self._last
        if c < 0 and abs(s) < NEARLY:  # where q is far away
            p, q = ((_cross(way, self.v), _cross(self.u, way)) for way in (first, last))  # as if on the unit circle
            more = Fraction(_cross((-s, c), q)) / _dot((-s, c), q) + Fraction(p[0]) / p[1]
            rest = self.rest + (more * (1 + self.rest**2) / 2).limit_denominator(FINEST)
            carried = rest // 1  # of a quarter of a turn
            rest = (1 + rest) / (1 - rest) if carried < 0 else (rest - 1) / (rest + 1) if carried else rest
            c, s = (self := self._replace(quarters=self.quarters + int(carried), rest=rest))._last
        if c == -1:
            share = Fraction(_dot(self.v, first)) / _dot(first, first)
            vx, vy = share * first[0], share * first[1]
        else:
            ahead = Fraction(_cross((x1 - x0, y1 - y0), last)) / _cross(first, last)  # to q, in units of `first`
            vx, vy = (ahead * d * (1 + c) / s for d in first)
        ux, uy = (Fraction(p - q - v * s) / (c - 1) for p, q, v in ((x1, x0, vx), (y1, y0, vy)))
        return self._replace(centre=(x0 - ux, y0 - uy), u=(ux, uy), v=(vx, vy))

    @property
    def _last(self) -> Vector:
        h = self.rest
        c, s = (1 - h * h) / (1 + h * h), 2 * h / (1 + h * h)
        a, b = QUARTERS[self.quarters % 4]
        return a * c - b * s, b * c + a * s

    def _at(self, c: Any, s: Any) -> Vector:
        x, y = (o + a * c + b * s for o, a, b in zip(self.centre, self.u, self.v, strict=True))
        return x, y


Side = Bezier | ConicArc


def from_path(curves: Iterable[Sequence[Any]], name: str = "outline") -> Table:
    """The table bounded by closed curves of pieces: the largest is the boundary, others are holes.

    A piece is a `ConicArc` or a list of control points, two for a straight side, three or four for a Bezier curve; it
    begins where the piece before it ends. Curves may run either way. `ValueError` for curves that bound no table.

    >>> bow = [[(0, 0), (2, 0)], [(2, 0), (2, 2), (0, 2), (0, 0)]]
    >>> [part.name for part in from_path([bow]).components]
    ['piece1', 'piece2']
    >>> from_path([[ConicArc((0, 0), (2, 0), (0, 1), 4)]]).components[0].point
    (2*cos(theta), sin(theta))
    """
    found: list[list[Side]] = []
    for i, curve in enumerate(curves, 1):
        found.append([p if isinstance(p, ConicArc) else elevated(read(f"{name}: curve {i}", p)) for p in curve])
    if not found:
        raise ValueError(f"{name}: a table needs at least one closed curve, and none is given")
    if sum(map(len, found)) > MOST:
        raise ValueError(f"{name}: {sum(map(len, found))} pieces are given; accepted: up to {MOST}")
    for i, sides in enumerate(found, 1):
        for j, side in enumerate(sides):
            if _ends(sides[j - 1])[1] != _ends(side)[0]:
                x, y = map(float, _ends(side)[0])
                wrong = f"a piece starts at ({x:.12g}, {y:.12g}), where the piece before it does not end"
                raise ValueError(f"{name}: curve {i} is not closed: {wrong}")
    found.sort(key=lambda sides: -abs(area(sides)))
    for i, sides in enumerate(found):
        swept = area(sides)
        if not swept:
            raise ValueError(f"{name}: the boundary encloses area 0" if not i else f"{name}: hole {i} has area 0")
        if (swept > 0) != (i == 0):
            found[i] = [_turned(side) for side in reversed(sides)]
    separate(name, [[part for side in sides for part in _parts(side)] for sides in found])
    every = [side for sides in found for side in sides]
    names = [f"piece{i}" for i in range(1, len(every) + 1)] if len(every) > 1 else [name]
    return Table(name, tuple(map(_component, names, every)))


def aligned_arcs(sides: Sequence[Any], tolerance: Fraction = Fraction(0)) -> list[Any]:
    """A closed curve of straight sides and arcs, with tangents made equal at each join where they are equal up to
    rounding.

    Tangents are also made equal if moving an end of the shorter piece by `tolerance` would make them so. The ends of
    pieces do not move. Where a side and an arc join, the arc changes; where two arcs join, the second one does.

    >>> almost = ConicArc((0, 0), (0, -1), (1, Fraction(1, 10**14)), 2)
    >>> aligned_arcs([almost, [(0, 1), (-1, 1)], [(-1, 1), (-1, -1)], [(-1, -1), (0, -1)]])[0].v
    (Fraction(1, 1), Fraction(0, 1))
    """
    ways = [list(directions(side)) for side in sides]
    ends = [side.start if isinstance(side, ConicArc) else side[0] for side in sides]
    away = max(abs(x) for end in ends for x in end)
    extent = max(max(xs) - min(xs) for xs in zip(*ends, strict=True))
    near = PARALLEL * max(1, away / Fraction(extent)) if extent else PARALLEL  # far away digits are lost
    for i, side in enumerate(sides):
        before, after = ways[i - 1][1], ways[i][0]
        if before == after:
            continue
        allowed = max(near, tolerance / shorter(sides[i - 1], side)) if tolerance else near
        if not _nearly_parallel(before, after, allowed):
            continue
        if isinstance(side, ConicArc):
            ways[i][0] = before
        elif isinstance(sides[i - 1], ConicArc):
            ways[i - 1][1] = after
    moved = []
    for side, (first, last) in zip(sides, ways, strict=True):
        same = not isinstance(side, ConicArc) or side.quarters == 4 or (first, last) == directions(side)
        moved.append(side if same else side.between(first, last))
    return moved


def directions(side: Any) -> tuple[Vector, Vector]:
    """The tangent directions at both ends of a piece, an arc of a conic or a curve given by its control points.

    >>> directions([(0, 0), (2, 0), (2, 2)])
    ((2, 0), (0, 2))
    """
    if isinstance(side, ConicArc):
        return side.v, side.last_velocity
    (x0, y0), (x1, y1) = side[0], next(p for p in side[1:] if p != side[0])
    (x2, y2), (x3, y3) = next(p for p in side[-2::-1] if p != side[-1]), side[-1]
    return (x1 - x0, y1 - y0), (x3 - x2, y3 - y2)


def shorter(*sides: Any) -> Fraction:
    """The smallest extent among the pieces: the larger coordinate difference between a piece's two ends.

    >>> shorter([(0, 0), (3, 1)], [(3, 1), (3, 3)])
    Fraction(2, 1)
    """
    return min(Fraction(max(abs(q[0] - p[0]), abs(q[1] - p[1]))) for p, q in map(_ends, sides))


def _nearly_parallel(v: Vector, w: Vector, near: Fraction) -> bool:
    return bool(_dot(v, w) > 0 and _cross(v, w) ** 2 <= near**2 * _dot(v, v) * _dot(w, w))


def _dot(v: Vector, w: Vector) -> Any:
    return v[0] * w[0] + v[1] * w[1]


def _cross(v: Vector, w: Vector) -> Any:
    return v[0] * w[1] - v[1] * w[0]


def area(sides: Sequence[Side]) -> Fraction:
    """The area by Green's formula, negative for a clockwise curve."""
    return sum((s.area() if isinstance(s, ConicArc) else signed_area([s]) for s in sides), Fraction(0))


def _ends(side: Side) -> tuple[Vector, Vector]:
    return (side.start, side.end) if isinstance(side, ConicArc) else (side[0], side[-1])


def _turned(side: Side) -> Side:
    if isinstance(side, ConicArc):
        return side.turned()
    a, b, c, d = side
    return d, c, b, a


def _parts(side: Side) -> list[Piece]:
    return side.parts() if isinstance(side, ConicArc) else [side]


def _component(name: str, side: Side) -> Component:
    return side.component(name) if isinstance(side, ConicArc) else as_component(name, side)
