"""Tables of straight sides and arcs of conics: every piece in closed form, first hit.

A piece is `O + p*A + q*B`: an arc of an ellipse for `(p, q)` on the unit circle, a straight side for `q = -1` and
`B = 0`; `d = p*B - q*A` is a tangent of both. A line along `v` through `z0` meets a piece where `p*a + q*b = m`, with

    a = v x A,    b = v x B,    m = v x (z0 - O),

and of the two points of an ellipse a particle from inside arrives at the one where `v x d = sqrt(a*a + b*b - m*m)` is
positive, whichever way the arc bends. On the arc from which it leaves the root is that of the departure, which no
subtraction spoils.

Whether a side is met is decided by which side of the line its two ends lie on; two pieces that share a corner compare
the same number there, so nothing passes between them. Round a convex curve that sign changes once from minus to plus:
there the piece is chosen first, by halving if there are many, and one equation solved.

State: the piece, `p`, `q`, and the direction `v`.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from numeric.backends import functions as plane
from numeric.flights.family import NEAR, Boundary, Family, Landing, Status, grazing, reflected
from numeric.flights.general import refuse_long
from numeric.flights.spline import halved

FAR = 2.0**100  # as far as nothing was met
LINE, CIRCLE, ELLIPSE = "line", "circle", "ellipse"
MANY = 24  # pieces of a convex curve, from which on it pays to find one by halving, with numbers from memory
TURNS = 1e-12  # sine of the largest angle by which a corner of a convex curve may bend the wrong way, by rounding
Masks = Any
Pair = tuple[Any, Any]
Row = Sequence[Any]


class Piece(NamedTuple):
    """The numbers of a piece in some arithmetic."""

    kind: str
    origin: Pair
    A: Pair
    B: Pair
    start: Pair  # its first corner
    D: Any  # A x B: positive where the arc focuses
    radius: Any
    middle: Pair  # (p, q) in the middle of an arc; the ends of the parameter of a side
    half: Pair  # sine and cosine of half the angle of an arc


class Pieces(Family):
    """Several curves, each of several pieces: a table of corners, of smooth joins, with holes."""

    name, path = "pieces", "closed form on every side and arc, first hit"
    pairs = (3,)
    position = ("component", "p", "q")
    direction = ("vx", "vy")

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        refuse_long(boundary)
        ir = boundary.ir
        names = [name.split() for name, _ in ir.programs]
        self.kinds = [kind for kind, _ in names]
        self.programs = [program for _, program in ir.programs]
        self.halving: list[list[float]] | None = None
        known = self.pieces(boundary.ops, boundary.shape)
        self.following = following(boundary, known)
        self.closed = [
            after == at and kind != LINE
            for at, (after, kind) in enumerate(zip(self.following, self.kinds, strict=True))
        ]
        self.wide = [kind != LINE and bool(piece.half[1] < 0) for kind, piece in zip(self.kinds, known, strict=True)]
        first = loops(self.following)[0]
        self.outer = first if convex(boundary, known, first, self.following) else []
        whole = len(self.outer) == len(known) > MANY and not boundary.shape
        self.halving = [[float(x) for x in program(boundary.ops)] for program in self.programs] if whole else None

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        names = [name.split() for name, _ in boundary.ir.programs]
        return bool(names) and all(name[0] in (LINE, CIRCLE, ELLIPSE) for name in names)

    @property
    def identity(self) -> str:
        return repr((self.kinds, self.following, self.closed, self.wide, self.outer, self.halving))

    def pieces(self, ops: Any, shape: Row) -> list[Piece]:
        """All pieces in the arithmetic of `ops`."""
        found = []
        for j, (kind, program) in enumerate(zip(self.kinds, self.programs, strict=True)):
            if self.halving and not hasattr(ops, "context"):
                x = [ops.number(value) for value in self.halving[j]]  # constants, which are looked up
            else:
                x = program(ops, *shape)
            found.append(
                Piece(
                    kind,
                    (x[0], x[1]),
                    (x[2], x[3]),
                    (x[4], x[5]),
                    (x[6], x[7]),
                    x[8],
                    x[9],
                    (x[10], x[11]),
                    (x[12], x[13]),
                )
            )
        return found

    @cached_property
    def arcs(self) -> list[int]:
        """The pieces that are no straight sides."""
        return [i for i, kind in enumerate(self.kinds) if kind != LINE]

    # ---- between people's coordinates and fields

    def enter(self, ops: Any, component: Any, theta: Any) -> list[Any]:
        straight = chosen(ops, component, [ops.number(float(kind == LINE)) for kind in self.kinds])
        line = ops.number(0.5) < straight
        minus = ops.number(-1.0) + ops.number(0.0) * theta
        return [component, ops.select(line, theta, ops.cos(theta)), ops.select(line, minus, ops.sin(theta))]

    def place(self, ops: Any, position: Row) -> tuple[Any, Any]:
        component, p, q = position
        shape = [ops.number(float(x)) for x in self.boundary.shape]
        pieces = self.pieces(ops, shape)
        ends = [part.ends(ops, *shape) for part in self.boundary.ir.parts]
        line = ops.number(0.5) < chosen(ops, component, [ops.number(float(kind == LINE)) for kind in self.kinds])
        middle = chosen(ops, component, [(low + high) * ops.number(0.5) for low, high in ends])
        M = self._pair(ops, component, [piece.middle for piece in pieces])
        return component, ops.select(line, p, middle + ops.atan2(plane.cross(M, (p, q)), plane.dot(M, (p, q))))

    # ---- a bounce

    def _pair(self, ops: Any, component: Any, pairs: list[Pair]) -> Pair:
        return chosen(ops, component, [x for x, _ in pairs]), chosen(ops, component, [y for _, y in pairs])

    def tangent(self, ops: Any, shape: Row, position: Row) -> Pair:
        """The velocity `d` at a boundary point."""
        component, p, q = position
        pieces = self.pieces(ops, shape)
        A, B = (self._pair(ops, component, column(pieces, i)) for i in (2, 3))
        return p * B[0] - q * A[0], p * B[1] - q * A[1]

    def point(self, ops: Any, pieces: list[Piece], position: Row) -> Pair:
        """The Cartesian point."""
        component, p, q = position
        origin, A, B = (self._pair(ops, component, column(pieces, i)) for i in (1, 2, 3))
        return p * A[0] + q * B[0] + origin[0], p * A[1] + q * B[1] + origin[1]

    def fly(self, ops: Any, shape: Row, law: str, position: Row, exit: Row) -> Landing[Any]:
        component, p, q = position
        pieces, v, nought = self.pieces(ops, shape), (exit[0], exit[1]), ops.number(0.0)
        z0 = self.point(ops, pieces, position)
        d0 = self.tangent(ops, shape, position)
        flight = Flight(ops, component, z0, v, plane.cross(d0, v))
        corners = [piece.start for piece in pieces]
        best: list[Any] | None = None
        if self.halving:

            def side(at: Any) -> Any:
                x, y = (ops.look_up([corner[i] for corner in corners], at) for i in (0, 1))
                return plane.cross(v, (x - z0[0], y - z0[1]))

            first, last, where, *_ = halved(ops, component, len(pieces), side)
            where = ops.select((first < nought) & (nought <= last), where, component)
            best = [*self._met(flight, self._gathered(ops, where, pieces), where), where]
            t, p, q, along, _, where = best
            return self._landed(ops, pieces, law, [where, p, q], v, along, t)
        sides = [plane.cross(v, (corner[0] - z0[0], corner[1] - z0[1])) for corner in corners]
        if self.outer:
            where = component
            for j in self.outer:
                other = ops.number(0.25) < abs(component - ops.number(float(j)))
                meets = other & (sides[j] <= nought) & (nought < sides[self.following[j]])
                where = ops.select(meets, ops.number(float(j)), where)
            best = [*self._met(flight, self._gathered(ops, where, pieces), where), where]
        for j, piece in enumerate(pieces):
            if j in self.outer:
                continue
            here = ops.number(float(j))
            t, p, q, along, real = self._met(flight, piece, here)
            crosses = (sides[j] <= nought) & (nought < sides[self.following[j]])
            if piece.kind != LINE:
                own = abs(component - here) < ops.number(0.25)
                turns = real if self.closed[j] else real & (nought < self._inside(ops, piece, (p, q), self.wide[j]))
                same = ops.negated((nought < sides[j]) & (sides[self.following[j]] <= nought))
                crosses = crosses | (same & (own | turns))
            meets = crosses & (nought < t)
            if best is None:
                best = [ops.select(meets, t, ops.number(FAR)), p, q, along, real, here + nought * component]
            else:
                nearer = meets & (t < best[0])
                new = t, p, q, along, best[4], here
                best = [x if x is y else ops.select(nearer, x, y) for x, y in zip(new, best, strict=True)]
        assert best is not None
        t, p, q, along, _, where = best
        return self._landed(ops, pieces, law, [where, p, q], v, along, t)

    def _gathered(self, ops: Any, where: Any, pieces: list[Piece]) -> Piece:
        """The piece of every particle; its kind is `line`, `circle`, `ellipse`, or empty where there are several."""
        several = len({self.kinds[j] for j in self.outer}) > 1
        origin, A, B = (self._pair(ops, where, column(pieces, i)) for i in (1, 2, 3))
        D, radius = (chosen(ops, where, column(pieces, i)) for i in (5, 6))
        kind = "" if several else self.kinds[self.outer[0]]
        return Piece(kind, origin, A, B, origin, D, radius, origin, origin)

    def _met(self, flight: "Flight", piece: Piece, where: Any) -> tuple[Any, Any, Any, Any, Masks]:
        """Length, `p`, `q` and `v x d` of the arrival on a piece, and where an arc has one."""
        ops, v = flight.ops, flight.v
        w = flight.z0[0] - piece.origin[0], flight.z0[1] - piece.origin[1]
        a, b, m = plane.cross(v, piece.A), plane.cross(v, piece.B), plane.cross(v, w)
        one = ops.number(1.0)
        if piece.kind == LINE:
            inverse = one / a
            return plane.cross(piece.A, w) * inverse, m * inverse, ops.number(-1.0), a, None
        kinds = {kind for kind in self.kinds if kind != LINE} if not piece.kind else {piece.kind}
        if kinds == {CIRCLE}:
            square = piece.radius * piece.radius
            left = (piece.radius - m) * (piece.radius + m)
        else:
            square = a * a + b * b
            left = plane.dot((a, b), (a, b)) - m * m
        nought = ops.number(0.0)
        own = abs(flight.component - where) < ops.number(0.25)
        s = ops.select(own, flight.rate, ops.sqrt(ops.maximum(left, nought)))
        line = None
        if not piece.kind:
            line = chosen_mask(ops, where, [kind == LINE for kind in self.kinds])
            square = ops.select(line, one, square)
        inverse = one / square
        p, q = plane.unit(ops, ((m * a + s * b) * inverse, (m * b - s * a) * inverse))
        along = s
        if line is not None:
            p, q = ops.select(line, m / a, p), ops.select(line, ops.number(-1.0), q)
            along = ops.select(line, a, s)
        x, y = p * piece.A[0] + q * piece.B[0] - w[0], p * piece.A[1] + q * piece.B[1] - w[1]
        chord = (s + s) * piece.D * inverse
        t = ops.select(own, chord, v[0] * x + v[1] * y)
        return t, p, q, along, nought < left

    def _inside(self, ops: Any, piece: Piece, u: Pair, wide: bool) -> Any:
        """The sine of the angle from the nearer end of an arc, negative beyond it."""
        c, s = plane.dot(piece.middle, u), abs(plane.cross(piece.middle, u))
        gap = piece.half[0] * c - piece.half[1] * s
        return ops.select(ops.number(0.0) < c, ops.number(1.0), gap) if wide else gap

    def _landed(
        self, ops: Any, pieces: list[Piece], law: str, position: Row, v: Pair, along: Any, t: Any
    ) -> Landing[Any]:
        where, p, q = position
        nought, one = ops.number(0.0), ops.number(1.0)
        A, B = (self._pair(ops, where, column(pieces, i)) for i in (2, 3))
        d = p * B[0] - q * A[0], p * B[1] - q * A[1]
        across = plane.dot(d, v)
        gaps = []
        if len(self.arcs) < len(self.kinds):
            low, high = self._pair(ops, where, [piece.middle for piece in pieces])
            gaps.append(-ops.maximum(low - p, p - high))
        if self.arcs:
            M, half = (self._pair(ops, where, column(pieces, i)) for i in (7, 8))
            gap = self._inside(ops, pieces[0]._replace(middle=M, half=half), (p, q), False)
            if any(self.wide):
                ahead = chosen_mask(ops, where, self.wide) & (nought < plane.dot(M, (p, q)))
                gap = ops.select(ahead, one, gap)
            if any(self.closed):
                gap = ops.select(chosen_mask(ops, where, self.closed), one, gap)
            gaps.append(gap)
        gap = gaps[0] if len(gaps) == 1 else ops.select(chosen_mask(ops, where, [k == LINE for k in self.kinds]), *gaps)
        code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), nought)
        # |d|*gap against NEAR, without a root: the gap's sign is kept
        lands = ops.number(NEAR * NEAR) <= gap * abs(gap) * plane.dot(d, d)
        if not self.outer:
            lands = lands & (t < ops.number(FAR))  # what passes between two pieces is at a join
        code = ops.select(lands, code, ops.number(float(Status.JOIN.code)))
        D = chosen(ops, where, [piece.D for piece in pieces])
        return Landing(list(position), across, along, code, {"v": v, "d": d}, {"t": t, "D": D})

    def leave(self, ops: Any, shape: Row, law: str, lam: Any, landing: Landing[Any]) -> list[Any]:
        return reflected(self, ops, law, lam, landing)

    def slapped(self, ops: Any, shape: Row, position: Row) -> list[Any]:
        dx, dy = self.tangent(ops, shape, position)
        return list(plane.normalised(ops, (-dy, dx)))

    def departure(self, ops: Any, shape: Row, position: Row, exit: Row) -> Any:
        return plane.cross(self.tangent(ops, shape, position), (exit[0], exit[1]))

    def leaving_rate(self, ops: Any, shape: Row, landing: Landing[Any], leaving: Row) -> Any:
        d = landing.vectors["d"]
        return plane.cross(d, (leaving[0], leaving[1])) if leaving else ops.sqrt(plane.dot(d, d))

    def length(self, ops: Any, shape: Row, n0: Any, start: Row, end: Row, landing: Landing[Any]) -> Any:
        return landing.numbers["t"]

    def bend(self, ops: Any, shape: Row, landing: Landing[Any]) -> Pair:
        d = landing.vectors["d"]
        return -landing.numbers["D"], plane.dot(d, d)


class Flight(NamedTuple):
    """The line along which a particle leaves: its piece, point and direction, and `d x v` there."""

    ops: Any
    component: Any
    z0: Pair
    v: Pair
    rate: Any


def column(pieces: list[Piece], i: int) -> list[Any]:
    """One entry of every piece."""
    return [piece[i] for piece in pieces]


def chosen(ops: Any, component: Any, values: list[Any]) -> Any:
    """The value of the particle's piece; neighbours that are equal cost nothing."""
    if len(values) > MANY and all(getattr(value, "value", 0.0) is not None for value in values):
        return values[0] if all(same(value, values[0]) for value in values) else ops.look_up(values, component)
    found = values[0]
    for i in range(1, len(values)):
        if not same(values[i], values[i - 1]):
            found = ops.select(ops.number(i - 0.5) < component, values[i], found)
    return found


def chosen_mask(ops: Any, component: Any, values: list[bool]) -> Masks:
    """Where the particle's piece is one of those marked."""
    return ops.number(0.5) < chosen(ops, component, [ops.number(float(value)) for value in values])


def same(x: Any, y: Any) -> bool:
    """Are two values of an arithmetic known to be equal?"""
    if x is y:
        return True
    if hasattr(x, "factors"):  # a vector of LLVM
        return bool(x.value == y.value if None not in (x.value, y.value) else x.value is y.value and x.text == y.text)
    return bool(np.all(x == y))


def following(boundary: Boundary, pieces: list[Piece]) -> list[int]:
    """The piece that begins where each one ends: the next one, or the first of a closed curve."""
    found, first, count = [], 0, len(pieces)
    size = max(abs(x) for piece in pieces for x in piece.start) + 1.0
    for j in range(count):
        x, y, *_ = boundary.curve(np.array([j]), np.array([boundary.ends[j][1]]))[:, 0]
        after = (j + 1) % count
        back = np.hypot(x - pieces[first].start[0], y - pieces[first].start[1]) <= 1e-9 * size
        if back and (j > first or pieces[j].kind != LINE):
            found.append(first)
            first = j + 1
        else:
            found.append(after)
    return found


def loops(after: list[int]) -> list[list[int]]:
    """The closed curves, each as the pieces in order."""
    found, first = [], 0
    for j, following in enumerate(after):
        if following <= j:
            found.append(list(range(first, j + 1)))
            first = j + 1
    return found


def convex(boundary: Boundary, pieces: list[Piece], loop: list[int], after: list[int]) -> bool:
    """Does every arc of the curve focus, and every corner bend inwards?"""
    if any(pieces[j].kind != LINE and not pieces[j].D > 0 for j in loop):
        return False
    turning = 0.0
    for j in loop:
        arriving, leaving = _direction(boundary, j, 1), _direction(boundary, after[j], 0)
        sine = float(plane.cross(arriving, leaving))
        if sine < -TURNS or (abs(sine) <= TURNS and plane.dot(arriving, leaving) < 0):
            return False
        turning += float(np.arctan2(sine, plane.dot(arriving, leaving)))
        low, high = boundary.ends[j]
        turning += high - low if pieces[j].kind == CIRCLE else _turned(boundary, j)
    return abs(turning - 2 * np.pi) < 1e-6


def _direction(boundary: Boundary, j: int, end: int) -> Pair:
    """The unit tangent at an end of a piece."""
    _, _, dx, dy, _, _ = boundary.curve(np.array([j]), np.array([boundary.ends[j][end]]))[:, 0]
    size = np.hypot(dx, dy)
    return dx / size, dy / size


def _turned(boundary: Boundary, j: int) -> float:
    """The angle by which the tangent of a piece turns."""
    low, high = boundary.ends[j]
    theta = np.linspace(low, high, 257)
    _, _, dx, dy, _, _ = boundary.curve(np.full(theta.shape, j), theta)
    return float(np.ptp(np.unwrap(np.arctan2(dy, dx))))
