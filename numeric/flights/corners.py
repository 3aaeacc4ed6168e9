"""Chains of sides and arcs: their numbers, coordinates and order, and the corners that a flight may pass."""

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends import functions as plane
from numeric.backends.doubled import Double, Doubles, Sum, Two, short_of
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import Array, Boundary, Family, Landing
from numeric.flights.general import NEWTON, UNSURE
from numeric.lowering.program import Program

LINE, CIRCLE, ELLIPSE = "line", "circle", "ellipse"
FOCAL = "focal"  # an arc of an ellipse by its radius about a focus
MANY = 24  # pieces of a convex curve, from which on it pays to find one by halving, with numbers from memory
STEEP = 8.0


Axes = list[Two[N, M]]  # `C`, `A` and `B` of a piece with twice the digits, `C + p*A + q*B` being its points


class PieceNumbers(NamedTuple, Generic[N]):
    """The numbers that describe a piece of the boundary, in the arithmetic of some backend."""

    kind: str
    origin: Pair[N]
    A: Pair[N]
    B: Pair[N]
    start: Pair[N]  # its first corner
    D: N  # A x B: positive where the arc focuses
    radius: N  # of a focal arc, one minus the eccentricity
    middle: Pair[N]  # (p, q) in the middle of an arc; the ends of the parameter of a side
    half: Pair[N]  # sine and cosine of half the angle of an arc


def piece_of(kind: str, x: Fields[N]) -> PieceNumbers[N]:
    """The piece of the boundary that the fourteen numbers of its program describe."""
    pairs = [(x[i], x[i + 1]) for i in (0, 2, 4, 6, 10, 12)]
    return PieceNumbers(kind, pairs[0], pairs[1], pairs[2], pairs[3], x[8], x[9], pairs[4], pairs[5])


def span(piece: PieceNumbers[N]) -> Pair[N]:
    """`(base, slope)` of a bound, `base + slope*|p|`, of the sum of the moduli of the terms of a point of the piece."""
    x, y, ax, ay, bx, by = (modulus(z) for pair in (piece.origin, piece.A, piece.B) for z in pair)
    if piece.kind == FOCAL:
        return ax + ay + ax + ay + bx + by, x - x
    return (x + y, ax + ay) if piece.kind == LINE else (x + y + ax + ay + bx + by, x - x)


def from_focus(ops: Backend[N, M], gap: N, u: Pair[N]) -> N:
    """`p - e` with all its digits, where `e` is the eccentricity and `gap` is `1 - e`."""
    one, (p, q) = ops.number(1.0), u
    return gap - ops.select(ops.number(0.0) < p, q * q / (one + p), one - p)


def chosen(ops: Backend[N, M], component: N, values: list[N]) -> N:
    """The entry of `values` for the particle's piece; `values` has one entry for each piece."""
    if len(values) > MANY and all(map(ops.constant, values)):
        return values[0] if all(ops.same(value, values[0]) for value in values) else ops.look_up(values, component)
    found = values[0]
    for i in range(1, len(values)):
        if not ops.same(values[i], values[i - 1]):
            found = ops.select(ops.number(i - 0.5) < component, values[i], found)
    return found


def chosen_mask(ops: Backend[N, M], component: N, values: list[bool]) -> M:
    """The mask of particles on whose piece the entry of `values` is True; `values` has one entry for each piece."""
    marked: M = ops.number(0.5) < chosen(ops, component, [ops.number(float(value)) for value in values])
    return marked


def loops(after: list[int]) -> list[list[int]]:
    """The closed curves of the boundary, each as the list of its pieces in order."""
    found, first = [], 0
    for j, following in enumerate(after):
        if following <= j:
            found.append(list(range(first, j + 1)))
            first = j + 1
    return found


def convex(boundary: Boundary, pieces: list[PieceNumbers[float]], loop: list[int]) -> bool:
    """Is the closed curve convex: does every arc focus, and does every corner turn inwards?"""
    if any(pieces[j].kind != LINE and not pieces[j].D > 0 for j in loop):
        return False
    turning = 0.0
    for j in loop:
        if not inwards(boundary, j):
            return False
        arriving, leaving = _direction(boundary, j, 1), _direction(boundary, boundary.following[j], 0)
        turning += float(elementary.arctan2(plane.cross(arriving, leaving), plane.dot(arriving, leaving)))
        low, high = boundary.ends[j]
        turning += high - low if pieces[j].kind == CIRCLE else _turned(boundary, j, pieces[j])
    return abs(turning - 2 * np.pi) < 1e-6


def inwards(boundary: Boundary, j: int) -> bool:
    """Does the boundary turn into the table where component `j` ends, or go on smoothly?

    The answer is no at a cusp, whose tangents do not show to which side it points. Where the sign of the corner's angle
    is not the same for all parameters, its value at this shape decides.
    """
    after, contact, bend = boundary.ir.joins[j]
    if contact != "CORNER":
        return contact != "CUSP"
    return bend > 0 or (bend == 0 and bool(plane.cross(_direction(boundary, j, 1), _direction(boundary, after, 0)) > 0))


def _direction(boundary: Boundary, j: int, end: int) -> Pair[float]:
    """The unit tangent at an end of a piece."""
    _, _, dx, dy, _, _ = boundary.curve(np.array([j]), np.array([boundary.ends[j][end]]))[:, 0]
    size = np.hypot(dx, dy)
    return dx / size, dy / size


def _turned(boundary: Boundary, j: int, piece: PieceNumbers[float]) -> float:
    """The angle by which the tangent of a piece turns."""
    low, high = boundary.ends[j]
    theta = np.linspace(low, high, 257)
    if piece.kind == FOCAL:  # its tangent may turn all at once
        half = elementary.arctan2(piece.half[0], piece.half[1]) % (2 * np.pi)
        E = elementary.arctan2(piece.middle[1], piece.middle[0]) + np.linspace(-half, half, 257)
        dx, dy = (np.cos(E) * b - np.sin(E) * a for a, b in zip(piece.A, piece.B, strict=True))
    else:
        _, _, dx, dy, _, _ = boundary.curve(np.full(theta.shape, j), theta)
    return float(np.ptp(np.unwrap(elementary.arctan2(dy, dx))))


class Coordinates(Family):
    """Conversion between users' coordinates and the state, on tables of sides and arcs.

    On an arc about a focus `theta` is the polar angle, and the state has the eccentric parameter.
    """

    kinds: list[str]
    extent: float  # a power of two above all numbers of pieces
    programs: list[Program]

    @abstractmethod
    def pieces(self, ops: Backend[N, M], shape: Fields[N]) -> list[PieceNumbers[N]]:
        """All pieces in the arithmetic of `ops`."""

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        line = chosen_mask(ops, component, [kind == LINE for kind in self.kinds])
        minus = ops.number(-1.0) + ops.number(0.0) * theta
        u = ops.cos(theta), ops.sin(theta)
        for j, ahead, ratio in self._foci(ops):
            x, y = plane.half(ops, plane.dot(ahead, u), plane.exact_cross(ops, ahead, u))
            E = plane.unit(ops, plane.squared(plane.normalised(ops, (ratio * x, y))))
            u = self._there(ops, component, j, E, u)
        return [component, ops.select(line, theta, u[0]), ops.select(line, minus, u[1])]

    def _foci(self, ops: Backend[N, M]) -> Iterator[tuple[int, Pair[N], N]]:
        """For every arc about a focus: its index, the direction of `A`, and the ratio `sqrt((1 + e)/(1 - e))`."""
        for j, (kind, program) in enumerate(zip(self.kinds, self.programs, strict=True)):
            if kind == FOCAL:
                *_, x, y, ratio = program(ops, *(ops.number(float(a)) for a in self.boundary.shape))
                yield j, (x, y), ratio

    def _there(self, ops: Backend[N, M], component: N, j: int, new: Pair[N], old: Pair[N]) -> Pair[N]:
        """`new` for the particles on piece `j`, and `old` for all others."""
        here = modulus(component - ops.number(float(j))) < ops.number(0.25)
        return ops.select(here, new[0], old[0]), ops.select(here, new[1], old[1])

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        component, p, q = position
        shape = [ops.number(float(x)) for x in self.boundary.shape]
        pieces = self.pieces(ops, shape)
        ends = [part.ends(ops, *shape) for part in self.boundary.ir.parts]
        line = ops.number(0.5) < chosen(ops, component, [ops.number(float(kind == LINE)) for kind in self.kinds])
        middle = chosen(ops, component, [(low + high) * ops.number(0.5) for low, high in ends])
        M = self._pair(ops, component, [piece.middle for piece in pieces])
        u = p, q
        for j, ahead, ratio in self._foci(ops):
            x, y = plane.half(ops, p, q)
            at = plane.times(ahead, plane.squared(plane.normalised(ops, (x, ratio * y))))
            M = self._there(ops, component, j, (ops.cos(middle), ops.sin(middle)), M)
            u = self._there(ops, component, j, at, u)
        return component, ops.select(line, p, middle + ops.atan2(plane.cross(M, u), plane.dot(M, u)))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        rate, curvature = super().bending(component, theta)
        focal = np.array([kind == FOCAL for kind in self.kinds])[component]
        if not np.any(focal):
            return rate, curvature
        ops, shape = self.boundary.ops, self.boundary.numbers
        at = self.enter(ops, component.astype(float), theta)
        speed = np.hypot(*self.tangent(ops, shape, at))
        D = self._turning(ops, self.pieces(ops, shape), at[0])
        return np.where(focal, speed, rate), np.where(focal, -D / (speed * speed * speed), curvature)

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        component, p, _ = landing.position
        one, rate = ops.number(1.0), ops.number(1.0)
        for j, _, ratio in self._foci(ops):  # dtheta/dE
            square = ratio * ratio
            new = (ratio + ratio) / ((square + one) - (square - one) * p)
            rate, _ = self._there(ops, component, j, (new, new), (rate, rate))
        return drift * below * rate if FOCAL in self.kinds else drift * below

    def _pair(self, ops: Backend[N, M], component: N, pairs: list[Pair[N]]) -> Pair[N]:
        return chosen(ops, component, [x for x, _ in pairs]), chosen(ops, component, [y for _, y in pairs])

    @cached_property
    def exactly(self) -> list[Axes[NDArray[np.float64], NDArray[np.bool_]]]:
        """The axes of every piece with twice the digits, for a table without parameters."""
        words = Doubles(self.boundary.ops)
        return [exact_axes(made(words), kind, words) for made, kind in zip(self.programs, self.kinds, strict=True)]

    def exact_axes_at(self, ops: Backend[N, M], shape: Fields[N], component: N) -> Axes[N, M]:
        """The axes of the particle's piece, with twice the digits."""
        words = Doubles(ops)
        if self.boundary.shape:
            letters = [words.of(x) for x in shape]
            made = [
                exact_axes(p(words, *letters), kind, words) for p, kind in zip(self.programs, self.kinds, strict=True)
            ]
        else:
            made = [[(words.known(x), words.known(y)) for x, y in axes] for axes in self.exactly]

        def one(vector: int, i: int) -> Double[N, M]:
            columns = ([axes[vector][i].high for axes in made], [axes[vector][i].low for axes in made])
            return Double(ops, *(chosen(ops, component, column) for column in columns))

        return [(one(k, 0), one(k, 1)) for k in range(3)]

    def _axes(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N) -> list[Pair[N]]:
        """The vectors `A` and `B` of the particle's piece, whose points are `C + p*A + q*B`."""
        return [
            self._pair(ops, component, [piece.A for piece in pieces]),
            self._pair(ops, component, [piece.B for piece in pieces]),
        ]

    def _turning(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N) -> N:
        """The cross product `A x B` of the vectors `A` and `B` of the particle's piece."""
        return chosen(ops, component, [piece.D for piece in pieces])

    def tangent(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        """The tangent `d` at a boundary point: the derivative of the point by the piece's parameter."""
        component, p, q = position
        A, B = self._axes(ops, self.pieces(ops, shape), component)
        return p * B[0] - q * A[0], p * B[1] - q * A[1]

    @cached_property
    def steep(self) -> float:
        """The threshold of `(|d|/(v x d))**2` above which a landing is refined; 0 if all landings are.

        Here `v` is the direction of flight and `d` the tangent at the landing.
        """
        if self.boundary.shape or any(kind != LINE for kind in self.kinds):
            return 0.0
        corners = [[float(x.high) for x in axes[0] + axes[1]] for axes in self.exactly]
        longest = max(sum(map(abs, numbers)) / np.hypot(numbers[2], numbers[3]) for numbers in corners)
        return STEEP * STEEP if longest <= STEEP else 0.0

    def refined(self, flight: "Ray[N, M]", shape: Fields[N], best: Fields[N], d: Pair[N]) -> list[N]:
        """`p` and `q` of a landing after a last step of Newton's method, and the tangent there from unrounded `p` and
        `q`.
        """
        ops, (_, p, q, along, _) = flight.ops, best
        if not self.steep:
            return self._moved(flight, shape, best, d)
        far = plane.dot(d, d) < ops.number(self.steep) * along * along
        old = [p, q, *d]

        def moved() -> list[N]:
            return [ops.select(far, x, y) for x, y in zip(old, self._moved(flight, shape, best, d), strict=True)]

        return list(ops.when(ops.negated(far), old, moved))

    def _moved(self, flight: "Ray[N, M]", shape: Fields[N], best: Fields[N], d: Pair[N]) -> list[N]:
        ops, (_, p, q, along, where) = flight.ops, best
        start, end = (self.exact_axes_at(ops, shape, at) for at in (flight.component, where))
        short = (nought := ops.number(0.0)), nought
        arcs = [kind != LINE for kind in self.kinds]
        lines = [chosen_mask(ops, at, [not arc for arc in arcs]) for at in (flight.component, where)]
        if any(arcs):
            lacks = short_of(ops, (flight.p, flight.q)), short_of(ops, (p, q))
            short = ops.select(lines[0], nought, lacks[0]), ops.select(lines[1], nought, lacks[1])
        step = last_step(flight, start, end, (p, q, along), short, self.extent)
        known = modulus(step * plane.dot(d, d)) < ops.number(NEWTON) * along
        step = ops.select(known, step, ops.number(0.0))
        (ax, ay), (bx, by) = ((pair[0].high, pair[1].high) for pair in end[1:])
        d = p * bx - q * ax, p * by - q * ay  # of a side to its own last bits
        turned = step * p, step * q
        change = turned[0] * ax + turned[1] * bx, turned[0] * ay + turned[1] * by
        change = ops.select(lines[1], nought, change[0]), ops.select(lines[1], nought, change[1])
        return [p - turned[1], ops.select(lines[1], q, q + turned[0]), d[0] - change[0], d[1] - change[1]]


class Ray(NamedTuple, Generic[N, M]):
    """The line along which a particle leaves: piece, point `z0`, direction `v`, and `rate = d x v` with the tangent
    `d`.
    """

    ops: Backend[N, M]
    component: N
    z0: Pair[N]
    v: Pair[N]
    rate: N
    p: N  # of the point
    q: N
    normal: bool = False  # does every particle leave along the normal?


def exact_axes(piece: Sequence[Double[N, M]], kind: str, words: Doubles[N, M]) -> Axes[N, M]:
    """The centre and the vectors `A` and `B` of a piece, from the numbers of its program; also for an arc about a
    focus.
    """
    centre, A, B = ((piece[i], piece[i + 1]) for i in (0, 2, 4))
    if kind == FOCAL:
        e = words.q(1, 1) - piece[9]
        centre = centre[0] - e * A[0], centre[1] - e * A[1]
    return [centre, A, B]


def last_step(
    flight: Ray[N, M], start: Axes[N, M], end: Axes[N, M], landing: Sequence[N], short: Pair[N], size: float
) -> N:
    """One more step of Newton's method, whose residual has twice the digits, from a landing `(p, q, v x d)`.

    `start` and `end` are the axes of the pieces of departure and landing. `short` has, for both vectors `(p, q)`, 1
    minus the length, and `size` is the size of the terms. A flight along the normal uses the normal before it is
    rounded.
    """
    ops, (p, q, along), sums = flight.ops, landing, []
    ends = (end, (p, q), short[1]), (start, (-flight.p, -flight.q), short[0])
    for i in (0, 1):
        found, beside = Sum(ops, size), ops.number(0.0)
        for (_, A, B), (x, y), lack in ends:
            found.add_product(x, A[i].high)
            found.add_product(y, B[i].high)
            beside = beside + (x * A[i].low + y * B[i].low) + lack * (x * A[i].high + y * B[i].high)
        found.add(end[0][i])
        found.add(-start[0][i])
        w = found.value()
        sums.append((w.high, w.low + beside))
    (x, x_low), (y, y_low) = sums
    v, low = flight.v, (ops.number(0.0), ops.number(0.0))
    if flight.normal:
        P, Q = (Double(ops, each, short[0] * each) for each in (flight.p, flight.q))
        d = [P * start[2][i] - Q * start[1][i] for i in (0, 1)]
        v, low = (-d[1].high, d[0].high), (-d[1].low, d[0].low)
        across = p * end[2][0].high - q * end[1][0].high, p * end[2][1].high - q * end[1][1].high
        along = plane.exact_cross(ops, v, across)
    value, rest = plane.cross_and_error(ops, v, (x, y))
    rest = rest + (plane.cross(v, (x_low, y_low)) + plane.cross(low, (x, y)))
    return -(value + rest) / along


def passing(flight: Ray[N, M], corner: Pair[N], side: N, start: N, t: N) -> M:
    """Does a flight of length `t` pass a corner so closely that rounding decides on which side?"""
    ops, (x, y) = flight.ops, corner
    slack = ops.number(UNSURE) * (start + modulus(x) + modulus(y))
    ahead = plane.dot(flight.v, (x - flight.z0[0], y - flight.z0[1]))
    comes: M = (modulus(side) <= slack) & (slack < ahead) & (ahead < t)
    return comes


def halved(ops: Backend[N, M], component: N, count: int, side: Callable[[N], N]) -> list[N]:
    """The piece of a closed curve that a line from `component` hits: its first corner lies to the right, its last not.

    `side(k)` tells on which side the first corner of piece `k` lies; it is negative to the right. Returns five numbers:
    the sides of the first corner after the departure and of the last one, the piece, and the sides of its two corners.
    """
    one, many = ops.number(1.0), ops.number(float(count))

    def which(k: N) -> N:
        at = component + k
        return ops.select(at < many, at, at - many)

    low, high = one + ops.number(0.0) * component, many + ops.number(0.0) * component
    first, last = side(which(one)), side(component)
    below, above = first, last
    for _ in range(max(1, (count - 2).bit_length())):
        middle = ops.rounded(ops.number(0.5) * (low + high) - ops.number(0.25))
        value = side(which(middle))
        right = value < ops.number(0.0)
        low, high = ops.select(right, middle, low), ops.select(right, high, middle)
        below, above = ops.select(right, value, below), ops.select(right, above, value)
    return [first, last, which(low), below, above]
