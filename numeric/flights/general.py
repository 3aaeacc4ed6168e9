"""Any table: every zero of the flight function on every piece is bracketed, and the first hit wins.

A component is cut where its tangent has turned by a quarter of a turn and where the turning changes
sign, so on a piece the tangent is parallel to a flight at most once, and the flight function
`F(theta) = v x (z(theta) - z0)` has at most one extremum and two zeros. Finding the extremum first
brackets both zeros. State: the component, the parameter `theta`, and the direction `v`.
"""

import itertools
from collections.abc import Callable

import numpy as np

from numeric.backends import elementary
from numeric.backends import functions as plane
from numeric.backends.doubled import Double, Doubles, affordable
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import NEAR, SLAP, Boundary, Family, Landing, Status, grazing, reflected
from numeric.lowering.program import LawIR

UNSURE = 2.0**-49  # how far a line is moved sideways by rounding, as a share of the numbers it is made of
GRID = 4096  # points on which a component's turning is examined
OVERLAP = 2.0**-46  # beyond the end of a closed curve, lest a zero fall between two roundings of its end
NEWTON = 2.0**-27  # of the way to the tangent, beyond which a last step is no rounding
LONG = 2.0**20  # a parameter, whose rounding moves the point
FAR = 2.0**100  # as far as nothing was met
TURN = np.pi / 2  # of the tangent on one piece, at most


class General(Family):
    """Paper: section 2, the definition of the map, as it stands."""

    name, path = "general", "every zero of the flight function on every piece, first hit"
    pairs = (2,)
    position = ("component", "theta")
    direction = ("vx", "vy")
    width = 8  # one register for each value: there are many, and as much text to compile for each piece

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.parts = boundary.ir.parts
        self.closed = len(self.parts) == 1
        self.ends = boundary.ends
        self.closing = boundary.ends[0]
        self.pieces = pieces(boundary)  # constants of the kernels
        self.points = [part.curve.only(0, 1, 2, 3) for part in self.parts]
        self.refines = affordable(*(program.lines for program in self.points))

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return True

    @property
    def identity(self) -> str:
        return repr(self.pieces)

    @property
    def joins(self) -> list[tuple[float, float]]:
        """The ends of the components, where they meet others."""
        return [] if self.closed else self.ends

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
            best = self._hits(ops, curve, piece, (component, theta), (x0, y0), v, best)
        return self._landed(ops, shape, law, best, v, (component, theta, x0, y0))

    def _curve_of(self, ops: Backend[N, M], shape: Fields[N], index: int) -> Callable[[N], list[N]]:
        """Point, velocity and acceleration on one component."""
        return lambda at: self.parts[index].curve(ops, at, *shape)

    def _landed(
        self, ops: Backend[N, M], shape: Fields[N], law: str, best: list[N], v: Pair[N], start: tuple[N, N, N, N]
    ) -> Landing[N]:
        """The landing at the nearest of all arrivals: length, component and parameter.

        It is at a join where rounding hides on which side of it the line passes. The line is moved sideways by at most
        `UNSURE` times the sum of the moduli of the numbers that go into its ends; on the component from which a
        particle leaves, a short flight moves along with its start.
        """
        t, where, at = best
        far = ops.number(FAR)
        x, y, dx, dy, ax, ay = self.curve(ops, shape, where, at)
        if self.refines and ops.doubles:
            step = self._step(ops, shape, law, (start[0], start[1]), v, (where, at), (dx, dy))
            dx, dy, at = dx + step * ax, dy + step * ay, at + step
        across, along = dx * v[0] + dy * v[1], dy * v[0] - dx * v[1]
        nought = ops.number(0.0)
        code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), nought)
        speed = ops.sqrt(dx * dx + dy * dy)
        own = modulus(where - start[0]) < ops.number(0.25)
        size = modulus(start[2]) + modulus(start[3]) + modulus(x) + modulus(y) + modulus(at) * speed
        doubt = ops.number(UNSURE) * size
        straight = ops.select(own, speed, modulus(along))
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
        nowhere = ops.number(
            float((Status.LOST if self.closed else Status.JOIN).code)
        )  # what is lost between two components is at a join
        code = ops.select(t < far, code, nowhere)
        return Landing([where, at], across, along, code, {"v": v, "d": (dx, dy)}, {"t": t})

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
        """One more step of Newton's method, whose residual has more digits: what is left is the rounding of a landing.

        Its direction, and that of a flight along the normal, are those before anything is rounded.
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
    ) -> list[N]:
        """The nearest of `best` and the landings on one piece: its component, its ends and its length in `theta`."""
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

        at_low, at_high = each(slope(a)[0]), each(slope(b)[0])
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
            crosses = ops.negated((nought < f0 * f1) | (f0 == f1) | departs) & (first < last)
            up = ops.times_sign(ops.number(1.0), f1 - f0)
            at = ops.zero(
                signed(up, flight), each(ops.number(0.5) * (first + last)),
                each(first), each(last), scale, 3, crosses,
            )  # fmt: skip
            x, y, *_ = curve(at)
            t = plane.dot(v, (x - z0[0], y - z0[1]))
            better = crosses & (nought < t) & (t < best[0])
            best = [ops.select(better, new, old) for new, old in zip([t, index, at], best, strict=True)]
        return best

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return reflected(self, ops, law, lam, landing)

    def slapped(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        _, _, dx, dy, _, _ = self.curve(ops, shape, *position)
        return list(plane.normalised(ops, (-dy, dx)))

    def departure(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        _, _, dx, dy, _, _ = self.curve(ops, shape, *position)
        return plane.cross((dx, dy), (exit[0], exit[1]))

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return landing.numbers["t"]

    def bend(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        _, _, dx, dy, ax, ay = self.curve(ops, shape, *landing.position)
        return plane.cross((ax, ay), (dx, dy)), plane.dot((dx, dy), (dx, dy))


def pieces(boundary: Boundary) -> list[tuple[int, float, float]]:
    """Component and ends of the pieces on which the tangent turns by a quarter of a turn at most, and one way."""
    found: list[tuple[int, float, float]] = []
    refuse_long(boundary)
    for index, (low, high) in enumerate(boundary.ends):
        theta = np.linspace(low, high, GRID + 1)
        _, _, dx, dy, ax, ay = boundary.curve(np.full(theta.shape, index), theta)
        turning = dx * ay - dy * ax
        angle = np.unwrap(elementary.arctan2(dy, dx))
        cuts, start = [low], angle[0]
        for i in range(1, GRID):
            flips = turning[i - 1] * turning[i] < 0
            if flips or abs(angle[i + 1] - start) > TURN:
                cuts.append(_inflection(boundary, index, theta[i - 1], theta[i]) if flips else float(theta[i]))
                start = angle[i]
        cuts.append(high + OVERLAP if len(boundary.ends) == 1 else high)
        found += [(index, a, b) for a, b in itertools.pairwise(cuts)]
    return found


def refuse_long(boundary: Boundary) -> None:
    """`ValueError` where a parameter runs so far that its rounding moves the point."""
    for part, (low, high) in zip(boundary.ir.parts, boundary.ends, strict=True):
        if max(abs(low), abs(high)) > LONG:
            runs = f"the parameter of {part.name} runs to {max(abs(low), abs(high)):.6g}"
            raise ValueError(f"{boundary.ir.table}: {runs}, where its rounding shows; start it within {LONG:.6g}")


def _inflection(boundary: Boundary, index: int, low: float, high: float) -> float:
    """Where the turning changes sign, by bisection."""

    def turning(theta: float) -> float:
        _, _, dx, dy, ax, ay = boundary.curve(np.array([index]), np.array([theta]))
        return float((dx * ay - dy * ax)[0])

    sign = np.sign(turning(low))
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(turning(middle)) == sign else (low, middle)
    return 0.5 * (low + high)
