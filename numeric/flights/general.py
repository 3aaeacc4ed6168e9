"""Any table: every zero of the flight function on every piece is bracketed, and the first hit is the landing.

A component is cut where its tangent has turned by a quarter of a turn and where the turning changes sign, so on a piece
the tangent is parallel to a flight at most once, and the flight function `F(theta) = v x (z(theta) - z0)` has at most
one extremum and two zeros. The extremum is found first, and then brackets both zeros. State: the component, the
parameter `theta`, and the direction `v`.
"""

import itertools
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends import functions as plane
from numeric.backends.doubled import Double, Doubles, affordable
from numeric.backends.intervals import CentredIntervals, Interval
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import FAR, NEAR, SLAP, Array, Boundary, Family, Landing, Status, grazing, reflected
from numeric.lowering.program import LawIR

UNSURE = 2.0**-49  # how far a line is moved sideways by rounding, as a share of the numbers it is made of
CELLS = 16  # intervals that cover a component at first
MOST_CELLS, MOST_LINES = 1 << 17, 1 << 24  # of them, with all halves; lines of the curve's program that run on these
MOST_CUTS = 128  # of all components into pieces, so that a kernel is written in some ten seconds
FEWER = f"at most {MOST_CUTS} times are accepted"
MOST_TURN = 1.0  # of the tangent on a cell, in radians
STRAIGHT, ROUGH = 2.0**-32, 2.0**-24  # radians, within which a cell is straight; where rounding hides more
HALVES = 4.0  # a range of at most so many roundings does not shrink with its cell
STANDS = 2.0  # in the place of a sign: a cell on which the point stays
ROUNDING = 2.0**-54  # of the size of a point, as far as rounding moves it
OVERLAP = 2.0**-46  # beyond an end that is no corner, lest a zero fall between two roundings of it
NEWTON = 2.0**-27  # of the way to the tangent, beyond which a last step is no rounding
NARROW = 2.0**-8  # of its parameter, below which a piece asks for one more step
LONG = 2.0**20  # a parameter, whose rounding moves the point
TURN = np.pi / 2 + 2.0**-20  # of the tangent on one piece, at most
Stretch = tuple[int, float, float]  # of a component, between two parameters


class General(Family):
    """The flight on any table. Paper: section 2."""

    name, path = "general", "every zero of the flight function on every piece, first hit"
    slow = True
    pairs = (2,)
    position = ("component", "theta")
    direction = ("vx", "vy")
    width = 8  # one register for each value: there are many, and as much text to compile for each piece

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.parts = boundary.ir.parts
        self.closed = boundary.runs_on
        self.ends = boundary.ends
        self.closing = boundary.ends[0]
        self.pieces, self.standing = pieces(boundary)  # constants of the kernels
        self.points = [part.curve.only(0, 1, 2, 3) for part in self.parts]
        self.refines = affordable(*(program.lines for program in self.points))

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        if (cuts := len(pieces(boundary)[0]) - len(boundary.ends)) > MOST_CUTS:
            turns = f"its curvature changes sign, or its tangent turns by a quarter of a turn, {cuts} times"
            raise ValueError(f"{boundary.ir.table}: {turns}; {FEWER}")
        return True

    @property
    def identity(self) -> str:
        return repr((self.pieces, self.standing))

    @property
    def joins(self) -> list[tuple[float, float]]:
        """The parameters of each component's two ends; a smooth end is replaced by a parameter far away."""
        return [] if self.closed else self.boundary.corner_parameters

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        return [component, theta]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        return position[0], position[1]

    def arc(self, ops: Backend[N, M], position: Fields[N], component: N, theta: N, law: LawIR) -> N:
        found = law.length(ops, 0, theta)
        for index in range(1, len(self.parts)):
            found = ops.select(ops.number(index - 0.5) < component, law.length(ops, index, theta), found)
        return found

    def curve(self, ops: Backend[N, M], shape: Fields[N], component: N, theta: N) -> list[N]:
        """Point, velocity and acceleration, chosen lane by lane among the components."""
        values = self.parts[0].curve(ops, theta, *shape)
        for index, part in enumerate(self.parts[1:], start=1):
            here = ops.number(index - 0.5) < component
            values = [
                ops.select(here, new, old) for new, old in zip(part.curve(ops, theta, *shape), values, strict=True)
            ]
        return values

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        component, theta = position
        v = exit[0], exit[1]
        x0, y0, *_ = self.curve(ops, shape, component, theta)
        far = ops.number(FAR)
        best = [far, component, theta]
        number = ops.number
        for index, low, high in self.pieces:
            piece = number(float(index)), number(low), number(high), number(high - low)
            curve = self._curve_of(ops, shape, index)
            beside = self._beside(ops, (index, low, high), component, theta)
            narrow = high - low < NARROW * max(abs(low), abs(high))
            best = self._hits(ops, curve, piece, (component, theta), (x0, y0), v, best, beside, narrow)
        return self._landed(ops, shape, law, best, v, (component, theta, x0, y0))

    def _beside(self, ops: Backend[N, M], piece: tuple[int, float, float], component: N, theta: N) -> list[M | None]:
        """For both ends of a piece: does the particle leave from this point, but on the component joined there?

        None for an end where this cannot be.
        """
        (index, low, high), found = piece, list[M | None]()
        before = self.boundary.following.index(index)
        for end, other in ((0, before), (1, self.boundary.following[index])):
            first = low <= self.ends[index][0] if end == 0 else high >= self.ends[index][1]
            if not first or self.closed or self.boundary.corners[index][end]:
                found.append(None)
                continue
            here = modulus(component - ops.number(float(other))) < ops.number(0.25)
            at, least = self.ends[other][1 - end], OVERLAP * max(map(abs, self.ends[other]))
            found.append(here & (modulus(theta - ops.number(at)) <= ops.number(least)))
        return found

    def _curve_of(self, ops: Backend[N, M], shape: Fields[N], index: int) -> Callable[[N], list[N]]:
        """The function of `theta` that returns point, velocity and acceleration on one component."""
        return lambda at: self.parts[index].curve(ops, at, *shape)

    def _landed(
        self, ops: Backend[N, M], shape: Fields[N], law: str, best: list[N], v: Pair[N], start: tuple[N, N, N, N]
    ) -> Landing[N]:
        """The landing at `best`, the nearest arrival, given by its length, component and parameter.

        Its outcome is `JOIN` where rounding hides on which side of a join the line passes. Rounding moves the line
        sideways by at most `UNSURE` times the sum of the moduli of the numbers that the two ends of the flight are
        added up from. On the component from which a particle leaves, a short flight moves along with its start.
        """
        t, where, at = best
        far = ops.number(FAR)
        x, y, dx, dy, ax, ay = self.curve(ops, shape, where, at)
        if self.refines and ops.doubles:
            step = self._step(ops, shape, law, (start[0], start[1]), v, (where, at), (dx, dy))
            dx, dy, at = dx + step * ax, dy + step * ay, at + step
        if not self.closed:
            at = self._within(ops, where, at)
        across, along = dx * v[0] + dy * v[1], dy * v[0] - dx * v[1]
        nought = ops.number(0.0)
        code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), nought)
        speed = ops.sqrt(dx * dx + dy * dy)
        own = modulus(where - start[0]) < ops.number(0.25)
        size = modulus(start[2]) + modulus(start[3]) + modulus(x) + modulus(y) + modulus(at) * speed
        doubt = ops.number(UNSURE) * size
        straight = ops.select(own, speed, modulus(along))
        for index, low, high in self.standing:
            there = (ops.number(low) <= at) & (at <= ops.number(high))
            there = there & (modulus(where - ops.number(float(index))) < ops.number(0.25))
            code = ops.select(there, ops.number(float(Status.CUSP.code)), code)
        if not ops.doubles:  # with more digits, which leave no such doubt: one distance
            straight, doubt = speed, ops.number(NEAR)
        alike = len(set(self.joins)) == 1
        for index, (low, high) in enumerate(self.joins[:1] if alike else self.joins):
            gap = ops.number(0.0) - ops.maximum(ops.number(low) - at, at - ops.number(high))
            aside = gap * straight
            if not alike:
                elsewhere = ops.number(0.25) < modulus(where - ops.number(float(index)))
                aside = ops.select(elsewhere, far, aside)
            code = ops.select(aside < doubt, ops.number(float(Status.JOIN.code)), code)
        corners = not self.closed and any(map(any, self.boundary.corners))  # between two components
        nowhere = ops.number(float((Status.JOIN if corners else Status.LOST).code))
        code = ops.select(t < far, code, nowhere)
        return Landing([where, at], across, along, code, {"v": v, "d": (dx, dy)}, {"t": t})

    def _within(self, ops: Backend[N, M], component: N, theta: N) -> N:
        """The parameter; one that rounding has put beyond a smooth end of the component is moved to the end."""
        for index, (_, end) in enumerate(self.ends):
            if not self.boundary.corners[index][1]:
                here = (modulus(component - ops.number(float(index))) < ops.number(0.25)) & (ops.number(end) < theta)
                theta = ops.select(here, ops.number(end), theta)
        return theta

    def _step(
        self,
        ops: Backend[N, M],
        shape: Fields[N],
        law: str,
        start: Pair[N],
        v: Pair[N],
        end: Pair[N],
        d: Pair[N],
    ) -> N:
        """One more step of Newton's method, whose residual has more digits: only the rounding of the landing remains.

        The direction at the landing, and that of a flight along the normal, are computed before anything is rounded.
        """
        words = Doubles(ops)
        (x0, y0, dx, dy), (x1, y1, *_) = (self.doubled(words, shape, *place) for place in (start, end))
        along = (-dy, dx) if law == SLAP else (words.of(v[0]), words.of(v[1]))
        across = plane.exact_cross(ops, (along[0].high, along[1].high), d)
        step = -((along[0] * (y1 - y0) - along[1] * (x1 - x0)).high / across)
        known = modulus(step * plane.dot(d, d)) < ops.number(NEWTON) * modulus(across)  # else a tangency, or no landing
        return ops.select(known, step, ops.number(0.0))

    def doubled(self, words: Doubles[N, M], shape: Fields[N], component: N, theta: N) -> list[Double[N, M]]:
        """Point and velocity with more digits, chosen lane by lane among the components."""
        given = [words.of(theta), *(words.of(x) for x in shape)]
        values = self.points[0](words, *given)
        for index, program in enumerate(self.points[1:], start=1):
            here = words.ops.number(index - 0.5) < component
            values = [words.select(here, new, old) for new, old in zip(program(words, *given), values, strict=True)]
        return values

    def _hits(
        self,
        ops: Backend[N, M],
        curve: Callable[[N], list[N]],
        piece: tuple[N, N, N, N],
        start: Pair[N],
        z0: Pair[N],
        v: Pair[N],
        best: list[N],
        beside: Sequence[M | None] = (),
        narrow: bool = False,
    ) -> list[N]:
        """The nearer landing: `best`, or one on the piece given by its component, both ends and length in `theta`."""
        index, a, b, scale = piece
        component, theta = start
        nought = ops.number(0.0)

        def flight(at: N) -> Pair[N]:
            x, y, dx, dy, _, _ = curve(at)
            return plane.cross(v, (x - z0[0], y - z0[1])), plane.cross(v, (dx, dy))

        def slope(at: N) -> Pair[N]:
            _, _, dx, dy, ax, ay = curve(at)
            return plane.cross(v, (dx, dy)), plane.cross(v, (ax, ay))

        def signed(sign: N, function: Callable[[N], Pair[N]]) -> Callable[[N], Pair[N]]:
            return lambda at: plane.scaled(sign, function(at))

        def each(x: N) -> N:
            return x + theta * nought  # one for each particle

        (at_low, after), (at_high, before) = (map(each, slope(end)) for end in (a, b))
        at_low = ops.select(at_low == nought, after, at_low)  # along the tangent, or where the speed is 0
        at_high = ops.select(at_high == nought, -before, at_high)
        turns = at_low * at_high < nought
        sign = ops.times_sign(ops.number(1.0), at_high)
        middle = ops.zero(
            signed(sign, slope), each(ops.number(0.5) * (a + b)), a, b,
            scale, 2, turns,
        )  # fmt: skip
        middle = ops.select(turns, middle, b)
        here = modulus(component - index) < ops.number(0.25)
        own = here & (a <= theta) & (theta <= b)
        for first, last in ((a, middle), (middle, b)):
            f0, f1 = flight(first)[0], flight(last)[0]
            departs = own & (first <= theta) & (theta <= last)
            if self.closed:  # the two ends of the parameter are one point
                (begin, end) = (ops.number(float(x)) for x in self.closing)
                departs = departs | ((theta <= begin) & (end <= last)) | ((end <= theta) & (first <= begin))
            for leaves, reached in zip(beside, (first <= a, b <= last), strict=False):
                departs = departs if leaves is None else departs | (leaves & reached)
            crosses = ops.negated((nought < f0 * f1) | (f0 == f1) | departs) & (first < last)
            up = ops.times_sign(ops.number(1.0), f1 - f0)
            at = ops.zero(
                signed(up, flight), each(ops.number(0.5) * (first + last)),
                each(first), each(last), scale, 3, crosses,
            )  # fmt: skip
            if narrow:  # there a step that is small for a parameter is none for the piece
                value, slant = flight(at)
                moved = at - value / slant
                at = ops.select(crosses & (first <= moved) & (moved <= last), moved, at)
            x, y, *_ = curve(at)
            t = plane.dot(v, (x - z0[0], y - z0[1]))
            better = crosses & (nought < t) & (t < best[0])
            best = [ops.select(better, new, old) for new, old in zip([t, index, at], best, strict=True)]
        return best

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return reflected(self, ops, law, lam, landing)

    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        _, _, dx, dy, _, _ = self.curve(ops, shape, *position)
        return list(plane.normalised(ops, (-dy, dx)))

    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        _, _, dx, dy, _, _ = self.curve(ops, shape, *position)
        return plane.cross((dx, dy), (exit[0], exit[1]))

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return landing.numbers["t"]

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        _, _, dx, dy, ax, ay = self.curve(ops, shape, *landing.position)
        return plane.cross((ax, ay), (dx, dy)), plane.dot((dx, dy), (dx, dy))


@lru_cache(maxsize=4)  # a table is asked by more than one map
def pieces(boundary: Boundary) -> tuple[list[Stretch], list[Stretch]]:
    """The pieces of components on which the tangent turns one way, by at most a quarter turn; and pieces that are
    points.

    This is proved: the curve's program runs on intervals that cover each component (see `cells`). Raises `ValueError`
    if there are too many intervals.
    """
    refuse_long(boundary)
    if boundary.ir.has("cubic 0"):
        return _cubic_pieces(boundary), []
    found: list[Stretch] = []
    standing: list[Stretch] = []
    for index in range(len(boundary.ends)):
        cuts, still = _cuts(boundary, index)
        found += [(index, low, high) for low, high in itertools.pairwise(cuts) if low < high]
        standing += [(index, low, high) for low, high in still]
    return found, standing


def _cubic_pieces(boundary: Boundary) -> list[Stretch]:
    """The pieces of a boundary of cubics, on which the turning is a quadratic and less than a whole turn in all."""
    count = len(boundary.ends)
    programs = (boundary.ir.program(f"cubic {index}")(boundary.ops, *boundary.numbers) for index in range(count))
    c = np.array([[float(x) for x in row] for row in programs]).reshape(count, 2, 4).transpose(1, 2, 0)
    x, y = c * np.array([0.0, 1.0, 2.0, 3.0])[:, None]  # coefficients of the velocity, from the second on

    def tangent(theta: Array) -> Pair[Array]:
        return (x[3] * theta + x[2]) * theta + x[1], (y[3] * theta + y[2]) * theta + y[1]

    p, q, r = (
        plane.cross((x[i], x[j]), (y[i], y[j])) for i, j in ((2, 3), (1, 3), (1, 2))
    )  # p*theta^2 + 2*q*theta + r
    low, high = np.array(boundary.ends).T
    with np.errstate(all="ignore"):
        root = -(q + np.copysign(np.sqrt(q * q - p * r), q))
        zeros = np.sort([root / p, r / root], axis=0)
    cuts = [low, *(np.where((low < zero) & (zero < high), zero, low) for zero in zeros), high]
    cuts = list(np.sort(cuts, axis=0))
    found = []
    for one, other in itertools.pairwise(cuts):
        middle = 0.5 * (one + other)
        way = np.copysign(1.0, (p * middle + 2 * q) * middle + r)
        for _ in range(4):  # by less than a whole turn
            found.append(one)
            one = _quarter(tangent, way, one, other)
    edges = np.array([*found, high + OVERLAP * boundary.runs_on]).T.tolist()
    return [(j, a, b) for j, row in enumerate(edges) for a, b in itertools.pairwise(row) if a < b]


def _quarter(tangent: Callable[[Array], Pair[Array]], way: Array, low: Array, high: Array) -> Array:
    """The parameter at which a tangent has turned by a quarter since `low`; `high` if it turns by less.

    `way` is 1 where the tangent turns to the left, and -1 where it turns to the right.
    """
    inside = 2.0**-20 * (high - low)  # at an end the speed may be 0
    first = tangent(low + inside)

    def beyond(theta: Array) -> NDArray[np.bool_]:
        here = tangent(theta)
        turned = way * elementary.arctan2(plane.cross(first, here), plane.dot(first, here))
        return (turned > TURN) | (turned < -(2.0**-20))  # by more than half a turn

    turns, top = beyond(high - inside), high
    for _ in range(60):
        middle = 0.5 * (low + top)
        far = beyond(middle)
        low, top = np.where(far, low, middle), np.where(far, middle, top)
    return np.where(turns, 0.5 * (low + top), high)


def _cuts(boundary: Boundary, index: int) -> tuple[list[float], list[Pair[float]]]:
    """The parameters at which pieces of a component begin and end; and the pieces that are single points."""
    edges, ways = cells(boundary, index)
    _, _, dx, dy = boundary.curve_on(index, edges, 4)
    here, after = (dx[:-1], dy[:-1]), (dx[1:], dy[1:])
    turns = np.abs(elementary.arctan2(plane.cross(here, after), plane.dot(here, after)))
    cuts, standing, wanted = [float(edges[0])], list[Pair[float]](), list[tuple[int, float, float, float]]()
    turned, way, seen = 0.0, 0.0, cuts[0]  # of the piece so far; the sign of the turning, and up to where it was seen
    for low, high, sign, turn in zip(edges.tolist(), edges[1:].tolist(), ways, turns, strict=False):
        if sign == STANDS:
            joined = bool(standing) and standing[-1][1] == low
            standing = [*standing[:-1], (standing[-1][0], high)] if joined else [*standing, (low, high)]
            cuts = [*cuts[:-1], high] if joined else [*cuts, low, high]
            turned, way = 0.0, 0.0
            continue
        if sign * way < 0:
            wanted.append((len(cuts), seen, low, 0.0))
            cuts.append(low)
            turned = 0.0
        elif turned + turn > TURN:
            wanted.append((len(cuts), low, high, TURN - turned))
            cuts.append(low)
            turned -= TURN
        turned += turn
        if sign:
            way, seen = sign, high
    if wanted:
        places, *rows = zip(*wanted, strict=True)
        for place, cut in zip(places, _passed(boundary, index, *map(np.array, rows)), strict=True):
            cuts[place] = float(cut)
    cuts.append(float(edges[-1]) + OVERLAP * (boundary.runs_on or not boundary.corners[index][1]))
    return cuts, standing


def cells(boundary: Boundary, index: int) -> tuple[Array, Array]:
    """The edges of cells that cover a component, and how the tangent turns on each cell.

    A value of 1 (left) or -1 (right) is proved: the tangent turns that way at every point of the cell, by less than
    `MOST_TURN` in all. The value 0 means that it turns by at most `STRAIGHT` (`ROUGH` where rounding hides how it
    turns), so that a line which crosses the cell twice is within this angle of a tangent. `STANDS` means that the cell
    is one point up to rounding. Cells are halved until one of these holds.
    """
    part, (start, end) = boundary.ir.parts[index], boundary.ends[index]
    if part.curve.constant(4) == 0 == part.curve.constant(5):  # a straight side
        return np.array([start, end]), np.zeros(1)
    shape = [Interval.around(np.array(x)) for x in boundary.shape]
    edges = np.linspace(start, end, CELLS + 1)
    size = float(np.max(np.abs(boundary.curve_on(index, edges, 2))))
    slopes = part.curve.only(2, 3, 4, 5)
    limit = min(MOST_CELLS, MOST_LINES // len(slopes.lines))
    low, high, done, count = edges[:-1], edges[1:], [np.empty((2, 0))], 0
    while low.size:
        count += low.size
        middle = 0.5 * (low + high)
        if count > limit or np.any((middle <= low) | (high <= middle)):
            place = f"near theta = {float(low[low.size // 2]):.9g} of {part.name}"
            raise ValueError(
                f"{boundary.ir.table}: which way its boundary turns {place} is not proved with {limit} intervals, so "
                "that a first hit could be missed; accepted: a boundary with wider features and a speed that is not 0"
            )
        with np.errstate(all="ignore"):
            ops = CentredIntervals(low, high)
            dx, dy, ax, ay = slopes(ops, ops.variable, *map(ops.constant, shape))
            turned, square = dx * ay - dy * ax, (dx * dx + dy * dy).whole
            turning, rounding = turned.whole, turned.middle.high - turned.middle.low
            most = (high - low) * np.maximum(np.abs(turning.low), np.abs(turning.high)) / square.low
            stands = (high - low) * np.sqrt(square.high) <= ROUNDING * size
            way = np.where(turning.low > 0, 1.0, np.where(turning.high < 0, -1.0, 0.0))
            straight = np.where(turning.high - turning.low <= HALVES * rounding, ROUGH, STRAIGHT)
            known = (square.low > 0) & (most <= np.where(way != 0, MOST_TURN, straight))
        done.append(np.array([low, np.where(known, way, STANDS)])[:, known | stands])
        seen = np.concatenate([row[:, row[1] != 0] for row in done], axis=1)
        signs = seen[1, np.argsort(seen[0])]
        if np.count_nonzero(signs[1:] * signs[:-1] == -1) > MOST_CUTS:
            raise ValueError(f"{boundary.ir.table}: the curvature of {part.name} changes sign too often; {FEWER}")
        open = ~(known | stands)
        low, middle, high = low[open], middle[open], high[open]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    covered = np.concatenate(done, axis=1)
    covered = covered[:, np.argsort(covered[0])]
    return np.append(covered[0], end), covered[1]


def refuse_long(boundary: Boundary) -> None:
    """Raises `ValueError` if a parameter runs so far that its rounding moves the point."""
    for part, (low, high) in zip(boundary.ir.parts, boundary.ends, strict=True):
        if max(abs(low), abs(high)) > LONG:
            runs = f"the parameter of {part.name} runs to {max(abs(low), abs(high)):.6g}"
            raise ValueError(f"{boundary.ir.table}: {runs}, where rounding moves the point; accepted: up to {LONG:.6g}")


def _passed(boundary: Boundary, index: int, low: Array, high: Array, turn: Array) -> Array:
    """The parameter at which the tangent has turned by `turn` since `low`; if `turn` is 0, where its turning changes
    sign.

    All intervals are bisected at once.
    """

    def turning(theta: Array) -> tuple[Pair[Array], Array]:
        _, _, dx, dy, ax, ay = boundary.curve_on(index, theta)
        return (dx, dy), dx * ay - dy * ax

    first, way = turning(low)
    for _ in range(60):
        middle = 0.5 * (low + high)
        here, now = turning(middle)
        turned = np.abs(elementary.arctan2(plane.cross(first, here), plane.dot(first, here)))
        before = np.where(turn > 0, turned < turn, np.sign(now) == np.sign(way))
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)
