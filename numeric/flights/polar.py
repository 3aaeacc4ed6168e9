"""Tables given by their radius `r(theta)`, convex or not: a march along the ray that cannot jump over the first hit.

As a particle flies, the polar angle of its position changes monotonically, from `theta0` towards the direction of `v`,
by less than half a turn; so the first hit is the first zero in `theta`, whatever the table looks like. Let `x` be the
change of the angle, `h = |z0 x v|`, and `S(x)` the sine of the angle from the position to `v`. The ray is at
`1/rho = S/h`, and it is inside the table as long as

    K(x) = S(x)/h - 1/r > 0.

As `S'' + S = 0`, this obeys `K'' + K = -w` with `w = q + q''`, `q = 1/r`, which is `(r*r + 2*r'*r' - r*r'')/r**3`:
negative just where the wall disperses, and the constant `1/(semi-latus rectum)` on a conic about the origin. So, if
`w <= W` on the whole table,

    K(x + y) = K cos y + K' sin y - (integral of sin(y - s)*w(x + s), s from 0 to y)
            >= K cos y + K' sin y - W(1 - cos y)

for `0 <= y <= pi`, where the sine is not negative. The march goes to the first zero of the right-hand side, which is in
closed form with one square root and one division and no angle. Before it `K` is positive: **no zero is jumped over.**
Near a zero the steps agree with Newton's method up to second order, so few are needed, and only one on a conic about
the origin.

A march ends where `K' < 0` and `2*L*K <= HALT*K'*K'` with `|w| + |K| <= L` in a neighbourhood: then a zero lies ahead
by Kantorovich's theorem, and Newton's method converges to it. It takes the last steps, on the flight equation divided
by its known zero (see `Secant`), so that short flights are as exact as long ones. The last residual is that of the
undivided equation, with more digits (see `Doubles`), so that only the rounding of the landing remains. Where the radius
has elementary functions, whose ten further bits are too few for a short flight, such a flight uses the divided equation
to the end.

Rounding makes `K*h*r*r` wrong by some units of `2**-52*r*r`: a flight that misses a bulge of the wall by less than this
may be taken for one that hits it, and the reverse; its direction is within 1e-7 of a tangent. A march that does not end
has met a tangency: its outcome is `Status.GRAZING`. `W` and `L` are proved, not sampled: the program of the radius runs
on intervals that cover the whole turn.
"""

from functools import lru_cache
from typing import Generic, NamedTuple

import numpy as np

from numeric.backends import functions as plane
from numeric.backends.doubled import WORDS, Doubles, affordable
from numeric.backends.intervals import Interval, Intervals, Secant, Secants, unit_vectors
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import SLAP, Boundary, Landing, Status, grazing
from numeric.flights.harmonic import Harmonic

CELLS = 4096  # intervals that cover the turn, at first
MOST_CELLS, NARROWEST = 1 << 19, 2.0**-26  # of them, with all halves; radians
STEEP = 2.0**10  # radius times W beyond which marches are long: then every piece is searched instead
HALT = 2.0**-12
FLOOR = 2.0**-50  # rounding of K*h*r*r, in units of r*r
SHALLOW = 2.0**-20  # departures flatter than its root take care of cancellation
MOST = 400  # steps of a march
SHORT = 2.0**-8  # between two unit vectors: below, ten bits more than doubles say less than the divided equation
HALF = 2.0**-27  # radians: beyond, a last correction is no rounding
GROWTH = 8.0  # from one step to the next, of a flight that begins along the wall


class Polar(Harmonic):
    """The first hit on `r(theta)` by a safe march in the polar angle; the state is that of `Harmonic`."""

    name, path = "polar", "safe march in the polar angle, first hit"
    width = 16

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        program = boundary.ir.program("radius")
        self.alone, self.radius, self.bent = program.only(0), program.only(0, 1), program.only(0, 1, 2)
        self.doubled = {word for word, *_ in self.radius.lines} <= set(WORDS)  # do all its words have twice the digits?
        self.refines = affordable(self.radius.lines)
        self.bounds = bounds(boundary)

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.has("radius") and np.isfinite(bounds(boundary).highest)

    @property
    def identity(self) -> str:
        return repr(self.bounds)

    # ---- the curve, from the radius

    def point(self, ops: Backend[N, M], *values: N) -> list[N]:
        """The Cartesian point."""
        (r, _), (c, s) = self.radius(ops, *values), values[:2]
        return [r * c, r * s]

    def velocity(self, ops: Backend[N, M], *values: N) -> list[N]:
        """Derivative of the boundary point by `theta`."""
        r, slope = self.radius(ops, *values)
        return [*plane.times((slope, r), (values[0], values[1]))]

    def acceleration(self, ops: Backend[N, M], *values: N) -> list[N]:
        """Second derivative of the boundary point by `theta`."""
        r, slope, bent = self.bent(ops, *values)
        return [*plane.times((bent - r, slope + slope), (values[0], values[1]))]

    # ---- a bounce

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        flight = March(self, ops, shape, (position[0], position[1]), (exit[0], exit[1]))
        x, y, left, reach = flight.marched()
        u, d = flight.refined(flight.sharpened((x, y), reach), law == SLAP)
        landing = self.landed(ops, shape, law, u, flight.v, d)
        tangent = ops.number(float(Status.GRAZING.code))
        lost = grazing(ops, landing.across, landing.along) | (ops.number(0.5) < left) | flight.goes_back(u)
        landing.code = ops.select(lost, tangent, ops.number(0.0))
        return landing


class March(Generic[N, M]):
    """A ray from a boundary point, and the march along it, in some arithmetic."""

    def __init__(self, family: Polar, ops: Backend[N, M], shape: Fields[N], u0: Pair[N], v: Pair[N]) -> None:
        self.family, self.ops, self.shape, self.u0, self.v = family, ops, shape, u0, v
        self.r0, slope = family.radius(ops, *u0, *shape)
        sine, cosine = plane.exact_cross(ops, u0, v), plane.exact_dot(ops, u0, v)
        self.side = ops.times_sign(ops.number(1.0), sine)  # 1 where the place turns to the left
        self.h = self.r0 * sine
        self.size = modulus(self.h)
        self.rate = slope * sine - self.r0 * cosine  # N0

    def marched(self) -> list[N]:
        """The unit vector where the march stops, a flag that is 1 if it has not converged, and the last step's size."""
        ops, family = self.ops, self.family
        one, nought = ops.number(1.0), ops.number(0.0)
        bound = self.size * self.r0 * ops.number(family.bounds.highest)
        inverse = one / (bound * bound + self.rate * self.rate)
        c = (bound * bound - self.rate * self.rate) * inverse
        s = (bound + bound) * self.rate * inverse
        u = self._turned(self.u0, c, s)
        cube = self.r0 * self.r0 * self.r0
        shallow = self.rate * self.rate < ops.number(SHALLOW * family.bounds.largest) * cube
        flag = ops.select(shallow, nought, one)
        state = ops.repeat(self._going, self._step, [*u, flag, modulus(s)], MOST)

        def careful() -> list[N]:
            start = [*state[:2], ops.select(shallow, one, state[2]), state[3]]
            return list(ops.repeat(self._going, self._careful, start, MOST))

        return list(ops.when(shallow, state, careful))

    def _going(self, state: list[N]) -> M:
        """The mask of particles whose march has not ended."""
        going: M = self.ops.number(0.5) < state[2]
        return going

    def _step(self, state: list[N]) -> list[N]:
        """A step of the march; the third number of the state becomes 0 at the last step."""
        ops, u = self.ops, (state[0], state[1])
        r, slope = self.family.radius(ops, *u, *self.shape)
        S = ops.times_sign(plane.cross(u, self.v), self.side)
        k = r * (r * S - self.size)
        c, s, ends = self._stepped(u, r, slope, k, ops.number(FLOOR), ops.number(self.family.bounds.highest))
        return [*self._turned(u, c, s), ends, modulus(s)]

    def _careful(self, state: list[N]) -> list[N]:
        """A step of the march for flights that begin almost along the wall, which may be almost straight.

        `K` is computed from the divided equation, without cancellation. A step is at most `GROWTH` times the one
        before, so that `w` here and the bound of its slope give a better bound than `W` does.
        """
        ops, u, family = self.ops, (state[0], state[1]), self.family
        r, slope, bent = family.bent(ops, *u, *self.shape)
        value, scale, weight = self._divided(u)
        tau = scale / weight
        k = -ops.times_sign(r * value * tau, self.side)
        farthest = -ops.maximum(-ops.number(GROWTH) * state[3], ops.number(-0.5))
        w = (r * r + ops.number(2.0) * slope * slope - r * bent) / (r * r * r)
        w = w + ops.number(1.25 * family.bounds.slope) * farthest
        high = ops.number(family.bounds.highest)
        bound = -ops.maximum(-ops.maximum(w, ops.number(2.0**-30) * high), -high)
        c, s, ends = self._stepped(u, r, slope, k, ops.number(FLOOR) * modulus(tau), bound)
        far = (c < ops.number(0.5)) | (farthest < s)
        s = ops.select(far, farthest, s)
        c = ops.select(far, ops.sqrt(ops.number(1.0) - farthest * farthest), c)
        ends = ops.select(far, ops.number(1.0), ends)
        return [*self._turned(u, c, s), ends, ops.maximum(modulus(s), ops.number(2.0**-52))]

    def _stepped(self, u: Pair[N], r: N, slope: N, k: N, floor: N, highest: N) -> tuple[N, N, N]:
        """Cosine and sine of a step that jumps over no zero if `w <= highest` (see the module), and a flag.

        The flag is 0 if the step is the last one, else 1.
        """
        ops, one, nought = self.ops, self.ops.number(1.0), self.ops.number(0.0)
        square = r * r
        k1 = self.h * slope - square * plane.dot(u, self.v)
        unit = self.size * square
        bound = unit * highest
        A = k + bound
        root = ops.sqrt(ops.maximum(k1 * k1 + k * (A + bound), nought))
        inverse = one / (A * A + k1 * k1)
        s = (k1 * bound + A * root) * inverse
        c = (A * bound - k1 * root) * inverse
        close = k * (unit * ops.number(self.family.bounds.largest) + k) <= ops.number(HALT) * (k1 * k1)
        ends = (k1 < nought) & (close | (k <= floor * square))
        return c, s, ops.select(ends, nought, one)

    def _turned(self, u: Pair[N], c: N, s: N) -> Pair[N]:
        return plane.unit(self.ops, plane.times(u, (c, self.ops.times_sign(s, self.side))))

    def _divided(self, u: Pair[N]) -> tuple[N, N, N]:
        """`H`, `scale` and `weight` with `v x (z - z0) = H*scale/weight`, all three computed without cancellation.

        If `B` is half the angle between `u0` and `u`, then `u - u0 = tan(B)*i*(u + u0)`. For angles up to a quarter
        turn differences are divided by `tan(B) = scale/weight`, for larger ones by one.
        """
        ops, one, u0, v = self.ops, self.ops.number(1.0), self.u0, self.v
        near = ops.number(0.0) < plane.dot(u0, u)
        f = (
            ops.select(near, -(u0[1] + u[1]), u[0] - u0[0]),
            ops.select(near, u0[0] + u[0], u[1] - u0[1]),
        )
        scale = ops.select(near, plane.exact_cross(ops, u0, u), one)
        weight = ops.select(near, one + plane.dot(u0, u), one)
        step = scale / weight
        inputs = [Secant(ops, a, b, d) for a, b, d in zip(u0, u, f, strict=True)]
        constants = [Secant(ops, x, x, ops.number(0.0)) for x in self.shape]
        (r,) = self.family.alone(Secants(ops, step), *inputs, *constants)
        return self.r0 * plane.exact_cross(ops, v, f) + r.slope * plane.cross(v, u), scale, weight

    def sharpened(self, u: Pair[N], reach: N) -> Pair[N]:
        """The landing, by steps of Newton's method on the divided equation, from the end of the march."""
        ops, one, two = self.ops, self.ops.number(1.0), self.ops.number(2.0)

        def at(x: N) -> Pair[N]:
            s = two * x / (x * x + one)
            return self._turned(u, one - x * s, s)

        def function(x: N) -> Pair[N]:
            here = at(x)
            value, scale, weight = self._divided(here)
            d = self.family.velocity(ops, *here, *self.shape)
            slope = plane.exact_cross(ops, self.v, (d[0], d[1]))
            return ops.times_sign(value * scale, self.side), (slope + slope) * weight

        far = reach + ops.number(2.0**-20)
        nought = ops.number(0.0) * reach
        x = ops.zero(function, nought, -far, far, one, 1)
        return at(x)

    def goes_back(self, u: Pair[N]) -> M:
        """The mask of landings that are not ahead of the departure, which only rounding can produce."""
        nought = self.ops.number(0.0)
        ahead = nought < self.side * plane.exact_cross(self.ops, self.u0, u)
        back: M = self.ops.negated(ahead) & (nought < plane.dot(self.u0, u))
        return back

    def refined(self, u: Pair[N], normal: bool) -> tuple[Pair[N], Pair[N]]:
        """The landing after one more step of Newton's method, whose residual has more digits; and the tangent there.

        Only the rounding of the landing remains. The tangent is computed before the landing is rounded, without
        cancellation among harmonics; so is the direction of a flight along the `normal`.
        """
        ops, family, v = self.ops, self.family, self.v
        r, slope, bent = family.bent(ops, *u, *self.shape)
        if not family.refines or not ops.doubles:  # with more digits there is no need
            return u, plane.times((slope, r), u)
        words = Doubles(ops)
        shape = [words.of(x) for x in self.shape]
        (c0, s0), (c, s) = words.unit(self.u0), words.unit(u)
        start, *slope0 = (family.radius if normal else family.alone)(words, c0, s0, *shape)
        far, rise = family.radius(words, c, s, *shape)
        x, y = far * c - start * c0, far * s - start * s0
        along = words.of(v[0]), words.of(v[1])
        if normal:
            along = -(slope0[0] * s0 + start * c0), slope0[0] * c0 - start * s0
            v = along[0].high, along[1].high
        value = along[0] * y - along[1] * x
        d = (rise * c - far * s).high, (rise * s + far * c).high
        step = -(value.high / plane.exact_cross(ops, v, d))
        known = modulus(step) < ops.number(HALF)  # else a tangency
        if not family.doubled:  # for a short flight the divided equation is better
            gap = u[0] - self.u0[0], u[1] - self.u0[1]
            known = known & (ops.number(SHORT * SHORT) < plane.dot(gap, gap))
        step = ops.select(known, step, ops.number(0.0))
        ax, ay = plane.times((bent - r, slope + slope), u)
        moved = c.high + (c.low - step * s.high), s.high + (s.low + step * c.high)
        return moved, (d[0] + step * ax, d[1] + step * ay)


class Bounds(NamedTuple):
    """Bounds for the module's `w` on a boundary: `w <= highest`, `|w| <= largest`, `|w'| <= slope`."""

    highest: float
    largest: float
    slope: float


@lru_cache(maxsize=4)  # for `matches`, then for the constructor
def bounds(boundary: Boundary) -> Bounds:
    """Proved bounds of a boundary, rounded up to four bits so that similar shapes share a kernel; infinite if unknown.

    Cells whose bounds are above `STEEP` are halved, until the bounds fit or a cell is proved to exceed `STEEP`.
    """
    shape = [Interval.around(np.array(x)) for x in boundary.shape]
    program, none = boundary.ir.program("radius"), Bounds(np.inf, np.inf, np.inf)
    edges = np.linspace(-np.pi, np.pi, CELLS + 1)
    low, high, found, count = edges[:-1], edges[1:], np.zeros(3), 0
    found[0] = -np.inf
    while low.size:
        count += low.size
        if count > MOST_CELLS or np.any(high - low < NARROWEST):
            return none
        with np.errstate(all="ignore"):
            r, r1, r2, r3 = program(Intervals(), *unit_vectors(low, high), *shape)
            square = r.squared()
            two, six = (Interval.around(np.array(x)) for x in (2.0, 6.0))
            w = (square + two * r1.squared() - r * r2) / (square * r)
            slope = (r1 * (six * (r * r2 - r1.squared()) - square) - r3 * square) / square.squared()
            sizes = [np.maximum(np.abs(x.low), np.abs(x.high)) for x in (w, slope)]
            known = (r.low > 0) & np.isfinite(sizes[1]) & (sizes[0] * r.high < STEEP)
            if np.any((r.low > 0) & (np.maximum(w.low, -w.high) * r.low > STEEP)) or np.any(r.high < 0):
                return none
        here = np.array([w.high, *sizes])[:, known]
        found = np.maximum(found, np.max(here, axis=1, initial=-np.inf))
        low, high = low[~known], high[~known]
        middle = 0.5 * (low + high)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return Bounds(*map(rounded_up, found.tolist()))


def rounded_up(x: float) -> float:
    """A positive number with four bits, at least `x`.

    >>> rounded_up(1.01)
    1.0625
    """
    unit = np.ldexp(1.0, np.frexp(x)[1] - 5)
    return float(np.ceil(x / unit) * unit)
