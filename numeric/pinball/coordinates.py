"""Conversion between a kernel's state and users' coordinates: boundary parameter, angle, arc length, Cartesian point.

`States` translates between the fields of a kernel and `(component, theta, phi)`, in NumPy arrays: once for each call,
not for each bounce. A recorded orbit is translated in tiles.

`located` finds the component and the parameter of a boundary point from its Cartesian coordinates.

`ArcLength` is the arc length on every component, counted counterclockwise from the table's origin, and its inverse.

It has closed forms for the circle and the cardioid, and SciPy's elliptic integral for the ellipse. For other tables a
Fourier or Chebyshev series of the speed is extended until its tail is below rounding, and integrated term by term. The
inverse is found by Newton's method, where the derivative is the speed itself.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.functions import Series
from numeric.flights.family import FORMULA, SLAP, Family, Frame
from numeric.pinball.unit import ONE, Unit

Array = NDArray[np.float64]
TILE = 1 << 13  # points of orbits translated at a time
PLACES = 9  # points on each component, for the size of the table
ORDINARY = 8.0  # distances are measured in units of 1 if half the longer side lies between 1/ORDINARY and this


class States:
    """Translates coordinates for one table and shape, by the methods of its family."""

    def __init__(self, family: Family, unit: Unit = ONE) -> None:
        self.family, self.boundary, self.unit = family, family.boundary, unit
        self.shape, self.ops, self.ends = self.boundary.shape, self.boundary.ops, self.boundary.ends

    @cached_property
    def size(self) -> float:
        """The unit of distances between phase points: 1 if the table's size is about 1, else a power of two near it."""
        at = [(np.full(PLACES, i), np.linspace(low, high, PLACES)) for i, (low, high) in enumerate(self.ends)]
        points = np.concatenate([self.family.cartesian(*place) for place in at], axis=1)
        half = float(np.max(np.ptp(points, axis=1))) / 2
        own = 1.0 if 1 / ORDINARY <= half <= ORDINARY else float(np.ldexp(0.5, int(np.frexp(half)[1])))
        return own * self.unit.length

    # ---- the boundary

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        """Point and tangent, in closed form where the table has one without cancellation."""
        x, y, tx, ty = self.family.frame(component, theta)
        return Frame(*self.unit.point(x, y), tx, ty)

    def point(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The Cartesian point."""
        return self.unit.point(*self.family.cartesian(component, theta))

    def tangent(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The unit tangent."""
        return self.frame(component, theta)[2:]

    def direction(self, component: NDArray[np.int64], theta: Array, phi: Array) -> tuple[Array, Array]:
        """The unit direction of exit angle `phi`."""
        return self.frame(component, theta).direction(self.ops, phi)

    def angle_to_normal(self, component: NDArray[np.int64], theta: Array, vx: Array, vy: Array) -> Array:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return np.asarray(self.frame(component, theta).angle(self.ops, vx, vy))

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        return self.family.speed(component, theta) * self.unit.length

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dp` for the parameter `p` of the family's tangent vectors, `theta` or arc length; and the curvature."""
        rate, curvature = self.family.bending(component, theta)
        return rate * self.unit.length, curvature / self.unit.length

    def curvature(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The paper's signed curvature, negative where the boundary focuses."""
        return self.bending(component, theta)[1]

    # ---- fields of the kernels

    def enter(
        self, component: NDArray[np.int64], theta: Array, phi: Array, law: str, frame: Frame[Array] | None = None
    ) -> list[Array]:
        """The kernel's fields of particles that leave `theta` at exit angle `phi`; `frame` may be given if known."""
        fields = self.family.enter(self.ops, component.astype(float), theta)
        if law != SLAP:
            fields = fields + self.family.exit_fields(self.ops, frame or self.frame(component, theta), phi)
        return [np.array(field, dtype=float) for field in fields]

    def exit_normal_speed(self, own: list[Array], law: str) -> Array:
        """`N0 = speed*cos(phi)` of particles that are about to leave, from their fields."""
        with np.errstate(all="ignore"):
            return np.asarray(self.family.rate(self.ops, self.boundary.numbers, law, own) + np.zeros(own[0].size))

    def place(self, rows: Sequence[Array]) -> tuple[NDArray[np.int64], Array]:
        """Component and parameter of states, given by the kernel's fields."""
        component, theta = self.family.place(self.ops, list(rows[: len(self.family.position)]))
        return np.broadcast_to(np.rint(component).astype(np.int64), theta.shape), theta

    def exit(
        self,
        component: NDArray[np.int64],
        theta: Array,
        rows: Sequence[Array],
        law: str,
        frame: Frame[Array] | None = None,
    ) -> Array:
        """The exit angle, in radians, from the kernel's fields; `frame` is the frame at `theta`, if it is known."""
        if law == SLAP:
            return np.zeros_like(theta)
        return np.asarray(self.family.exit(self.ops, frame or self.frame(component, theta), self.kept(rows)))

    def leaving(self, frame: Frame[Array], phi: Array, rows: Sequence[Array], law: str) -> tuple[Array, Array]:
        """The unit direction of a departing flight, from the kernel's fields if they hold it."""
        if law == SLAP:
            return frame.direction(self.ops, phi)
        return self.family.unit_direction(self.ops, frame, phi, self.kept(rows))

    def kept(self, rows: Sequence[Array]) -> list[Array]:
        """The rows of the kernel's fields that hold the direction; they follow those of the position."""
        begin = len(self.family.position)
        return list(rows[begin : begin + len(self.family.direction)])

    def told(
        self,
        record: Array,
        start: tuple[NDArray[np.int64], Array, Array],
        begun: Frame[Array],
        own: list[Array],
        lam: Array,
        law: str,
    ) -> list[NDArray[Any]]:
        """Component, parameter, exit and incidence angle, and point, at the start and after each recorded bounce.

        One tile of `TILE` points is translated at a time, so that it stays in the processor's cache.
        """
        where, theta, phi = start
        told: list[NDArray[Any]] = [
            np.empty((len(record) + 1, lam.size), dtype=kind) for kind in (np.int64, *[float] * 5)
        ]
        for rows, first in zip(told, (where, theta, phi, np.nan, begun.x, begun.y), strict=True):
            rows[0] = first
        across = min(lam.size, TILE)
        down = TILE // across
        for left in range(0, lam.size, across):
            particle = slice(left, left + across)
            frame = Frame(*(side[particle] for side in begun))
            flight = self.leaving(frame, phi[particle], [field[particle] for field in own], law)
            for top in range(0, len(record), down):
                fields = list(record[top : top + down, :, particle].swapaxes(0, 1))
                component, at = self.place(fields)
                frame = self.frame(component, at)
                exit = self.exit(component, at, fields, law, frame)
                if law != FORMULA:
                    exit = exit * (lam[particle] != 0)  # the normal, whatever atan2 rounds to
                leaving = self.leaving(frame, exit, fields, law)
                vx, vy = (np.concatenate([v[None], later[:-1]]) for v, later in zip(flight, leaving, strict=True))
                flight = leaving[0][-1], leaving[1][-1]
                found = component, at, exit, frame.angle(self.ops, -vx, -vy), frame.x, frame.y
                for rows, part in zip(told, found, strict=True):
                    rows[top + 1 : top + 1 + down, particle] = part
        return told


ON = 1e-9  # a point farther from the boundary than this, in units of the table's size, is not on it
GRID = 2048


def located(states: States, x: Array, y: Array) -> tuple[NDArray[np.int64], Array]:
    """Component and parameter of each point; `ValueError` for a point off the boundary."""
    x, y = np.broadcast_arrays(x, y)
    if x.size == 0:
        raise ValueError("x and y are empty; give at least one point")
    best = np.full(x.shape, np.inf)
    component, theta = np.zeros(x.shape, dtype=np.int64), np.zeros(x.shape)
    size, (_, *centre) = 0.0, states.unit
    for index, (low, high) in enumerate(states.ends):
        grid = np.linspace(low, high, GRID + 1)
        px, py = states.point(np.full(grid.shape, index), grid)
        size = max(size, float(np.max(np.hypot(px - centre[0], py - centre[1]))))
        nearest = np.argmin(np.hypot(x[..., None] - px, y[..., None] - py), axis=-1)
        at = _polished(states, index, grid[nearest], x, y, low, high)
        gap = _gap(states, index, at, x, y)
        better = gap < best
        best, component, theta = (np.where(better, *pair) for pair in ((gap, best), (index, component), (at, theta)))
    off = best > ON * size + 2.0**-50 * np.hypot(centre[0], centre[1])  # a point far away is rounded there
    if np.any(off):
        point = f"({x[off].flat[0]}, {y[off].flat[0]})"
        raise ValueError(f"the point {point} is not on the boundary; it is {best[off].flat[0]:.3g} away from it")
    return component, theta


def _gap(states: States, index: int, theta: Array, x: Array, y: Array) -> Array:
    px, py = states.point(np.full(theta.shape, index), theta)
    return np.asarray(np.hypot(x - px, y - py))


def _polished(states: States, index: int, theta: Array, x: Array, y: Array, low: float, high: float) -> Array:
    """The parameter of the nearest boundary point, by Gauss-Newton steps along the tangent."""
    where = np.full(theta.shape, index)
    for _ in range(8):
        px, py = states.point(where, theta)
        tx, ty = states.tangent(where, theta)
        speed = np.maximum(states.speed(where, theta), 1e-300)
        step = ((x - px) * tx + (y - py) * ty) / speed
        theta = np.clip(theta + np.clip(step, -0.1, 0.1), low, high)
    return np.asarray(theta)


MOST = 1 << 14  # terms; a boundary that needs more is not smooth
SETTLED = 1e-9  # radians: the Newton step after one this short is below rounding
HIGHEST, SHARE = 1 << 10, 1 << 5  # degree of a Chebyshev series; of one on a part of an interval
PARTS = 1 << 10
Length = Callable[[Array], Array]
ROOM, MOST_TOLD = 4, 64  # waves in kernels: their number is a multiple of the first, and at most the second
WHOLE = 1 << 1074  # times any double is an integer
SMALL = 2.0**-55  # of the mean speed: smaller waves change no perimeter
MILD = 0.5  # of the mean speed: up to this sum of moduli the rounding of powers does no harm
ROUNDING = 4e-16  # of the largest speed: a transform of rounded samples gives this for a coefficient of 0


class Waves(NamedTuple):
    """The integral from 0 of a speed with period `2*pi`: `mean*theta` plus waves of a few frequencies.

    >>> Waves.of(lambda theta: 2 + np.cos(3 * theta)).frequencies.tolist()
    [3]
    """

    mean: float
    frequencies: NDArray[np.int64]
    sines: Array  # coefficients of `sin(k*theta)`, and of `1 - cos(k*theta)` in the integral
    rises: Array

    @staticmethod
    def of(speed: Callable[[Array], Array]) -> "Waves | None":
        """The Fourier sum of the arc length, from as many samples as necessary; None if these are more than `MOST`."""
        count = 64
        while True:
            theta = 2 * np.pi * np.arange(count) / count - np.pi
            values = speed(theta)
            c = np.fft.rfft(values) / count * (1 - 2 * (np.arange(count // 2 + 1) % 2))
            if settled(c, values):
                break
            if count >= MOST:
                return None
            count *= 2
        kept = np.flatnonzero(np.abs(c[: count // 3]) > ROUNDING * np.max(values))[1:]
        terms = 2 * c[kept] / kept
        return Waves(c[0].real, kept, terms.real, -terms.imag)

    def __call__(self, theta: Array) -> Array:
        """The integral up to `theta`, smallest waves first."""
        flat = theta.ravel()
        k = self.frequencies[:, None]
        waves = self.sines[:, None] * np.sin(k * flat) + 2 * self.rises[:, None] * np.sin(k * flat / 2) ** 2
        return np.asarray((self.mean * flat + np.sum(waves[::-1], axis=0)).reshape(theta.shape))


def in_powers(sines: Array) -> list[float]:
    """The polynomial in `cos(x)` whose product with `sin(x)` is the sum of `sines[k-1]*sin(k*x)`; one rounding each.

    >>> in_powers(np.array([1.0, 1.0, 1.0]))  # 1 + 2*c + (4*c**2 - 1)
    [0.0, 2.0, 4.0]
    """
    total, before, now = [0] * len(sines), [0] * len(sines), [1] + [0] * (len(sines) - 1)
    for a in sines:
        whole = int(Fraction(float(a)) * WHOLE)
        total = [x + whole * y for x, y in zip(total, now, strict=True)]
        before, now = now, [2 * x - y for x, y in zip([0, *now[:-1]], before, strict=True)]
    return [float(Fraction(x, WHOLE)) for x in total]


def settled(coefficients: Array | NDArray[np.complex128], values: Array) -> bool:
    """Are the coefficients in the last third no larger than the rounding error of the values?"""
    last = coefficients[2 * (len(coefficients) - 1) // 3 :]
    return bool(np.max(np.abs(last)) < ROUNDING * np.max(values))


def chebyshev(speed: Length, low: float, high: float, highest: int = HIGHEST, anyway: bool = False) -> Length | None:
    """The integral of a speed from 0, or from `low` if 0 lies outside, as a Chebyshev series of sufficient degree.

    The degree is doubled until it suffices. The result is None if degree `highest` does not suffice, unless `anyway` is
    set. The coefficients are those of the cosine series in an angle whose cosine is the variable, scaled to [-1, 1].
    """
    from numpy.polynomial import Chebyshev

    degree = 16
    while True:
        x = np.cos(np.pi * np.arange(degree + 1) / degree)
        values = speed(low + (high - low) * (1 + x) / 2)
        c = np.fft.hfft(values)[: degree + 1] / degree  # `values` is half of an even sequence
        c[0] /= 2
        if settled(c, values):
            break
        if degree >= highest:
            if not anyway:
                return None
            break
        degree *= 2
    kept = np.flatnonzero(np.abs(c) > ROUNDING * np.max(values))
    integral = Chebyshev(c[: kept[-1] + 1], [low, high]).integ(lbnd=0.0 if low <= 0.0 <= high else low)
    return lambda theta: np.asarray(integral(theta))


def halved(speed: Length, low: float, high: float) -> Length:
    """The integral of a speed with narrow features, from 0, or from `low` if 0 lies outside, as in `chebyshev`.

    The range is halved until a series suffices on each part, or until there are `PARTS` parts; the error is then
    rounding.
    """
    open, done = [(low, high)], list[tuple[float, float, Length]]()
    while open:
        a, b = open.pop(0)
        known = chebyshev(speed, a, b, SHARE, anyway=len(open) + len(done) > PARTS)
        if known is None:
            open += [(a, 0.5 * (a + b)), (0.5 * (a + b), b)]
        else:
            done.append((a, b, known))
    done.sort(key=lambda piece: piece[0])
    starts = np.array([a for a, *_ in done])
    first = [float(known(np.array(a))) for a, _, known in done]
    sizes = [float(known(np.array(b))) - begin for (_, b, known), begin in zip(done, first, strict=True)]
    reached = np.concatenate([[0.0], np.cumsum(sizes)])

    def length(theta: Array) -> Array:
        theta = np.asarray(theta, dtype=float)
        found, piece = np.empty(theta.shape), np.clip(np.searchsorted(starts, theta, side="right") - 1, 0, None)
        for i in np.unique(piece):
            here = piece == i
            found[here] = done[i][2](theta[here]) - first[i] + reached[i]
        return found

    zero = float(length(np.array(min(max(low, 0.0), high) if low <= 0.0 <= high else low)))
    return lambda theta: length(theta) - zero


class ArcLength:
    """The paper's `s`, not wrapped: `s` grows with `theta` on each component and is 0 at the origin."""

    def __init__(self, states: States) -> None:
        self.states = states
        self.lengths = [self._length(index) for index in range(len(states.ends))]
        self.spans = [
            (float(length(np.array(low))), float(length(np.array(high))))
            for length, (low, high) in zip(self.lengths, states.ends, strict=True)
        ]
        self.ruled: dict[int, tuple[Array, Array]] = {}  # by component: lengths at many parameters, and the parameters
        index, program = states.boundary.ir.origin
        offsets = {}
        zero, (first, last) = float(program(states.ops, *states.boundary.numbers)[0]), states.ends[index]
        reached = -float(self.lengths[index](np.array(min(max(zero, first), last))))  # 0 without another origin
        for turn in range(len(states.ends)):
            at = (index + turn) % len(states.ends)
            if turn:
                reached -= self.spans[at][0]
            offsets[at] = reached
            reached += self.spans[at][1]
        self.offsets = [offsets[i] for i in range(len(states.ends))]

    def s(self, theta: Array, component: NDArray[np.int64] | int = 0) -> Array:
        """Arc length at `theta` on a component."""
        theta, component = np.broadcast_arrays(np.asarray(theta, dtype=float), component)
        out = np.empty(theta.shape)
        for index, (length, offset) in enumerate(zip(self.lengths, self.offsets, strict=True)):
            here = component == index
            out[here] = length(theta[here]) + offset
        return out

    def theta(self, s: Array, component: NDArray[np.int64] | int = 0) -> Array:
        """The parameter at arc length `s` on a component; ends of the component are included."""
        s, component = np.broadcast_arrays(np.asarray(s, dtype=float), component)
        out = np.empty(s.shape)
        for index, (low, high) in enumerate(self.states.ends):
            here = component == index
            if np.any(here):
                out[here] = self._inverse(index, s[here] - self.offsets[index], low, high)
        return out

    @cached_property
    def series(self) -> tuple[Series, list[float]] | None:
        """The series by which kernels compute arc length, and its coefficients; None if it has too many terms."""
        family, index = self.states.family, np.zeros(1, dtype=np.int64)
        if family.arclength(self.states.ops, 0, np.zeros(1)) is not None:
            return (Series(len(self.offsets)), self.offsets) if self.states.unit == ONE else None
        if not self.states.boundary.closed:
            return None
        waves = Waves.of(lambda at: self.states.speed(np.broadcast_to(index, at.shape), at))
        if waves is None:
            return None
        step = int(np.gcd.reduce(waves.frequencies)) or 1
        order = waves.frequencies // step
        told = int(order[np.abs(waves.sines) + np.abs(waves.rises) > SMALL * waves.mean].max(initial=1))
        terms = ROOM * -(-told // ROOM)
        if terms > MOST_TOLD:
            return None
        sines, rises = np.zeros((2, max(terms, int(order.max(initial=1)))))
        sines[order - 1], rises[order - 1] = waves.sines, waves.rises
        sines, rises = sines[:terms], rises[:terms]
        if np.any(np.abs(rises) > ROUNDING * waves.mean):
            return Series(1, step, terms, terms), [float(x) for x in (*self.offsets, waves.mean, *sines, *rises)]
        powers = in_powers(sines)
        mild = bool(np.sum(np.abs(powers)) < MILD * waves.mean)
        numbers = *self.offsets, waves.mean, *(powers if mild else sines)
        return Series(1, step, terms, powers=mild), [float(x) for x in numbers]

    @cached_property
    def perimeter(self) -> float:
        """The length of the whole boundary."""
        return sum(top - bottom for bottom, top in self.spans)

    def _inverse(self, index: int, s: Array, low: float, high: float) -> Array:
        length = self.lengths[index]
        bottom, top = self.spans[index]
        slack = 1e-14 * (top - bottom)
        if np.any((s < bottom - slack) | (s > top + slack)):
            bad = s[(s < bottom - slack) | (s > top + slack)].flat[0] + self.offsets[index]
            name = self.states.boundary.ir.parts[index].name
            first, last = bottom + self.offsets[index], top + self.offsets[index]
            raise ValueError(f"s = {bad} is not on the {name}; there s lies in [{first:.17g}, {last:.17g}]")
        inverse = self.states.family.parameter(index, s / self.states.unit.length)
        if inverse is not None:
            return inverse
        if index not in self.ruled:
            grid = np.linspace(low, high, 1025)
            self.ruled[index] = length(grid), grid
        theta = np.interp(s, *self.ruled[index])
        where = np.full(theta.shape, index)
        for _ in range(6):
            step = (length(theta) - s) / self.states.speed(where, theta)
            theta = np.clip(theta - step, low, high)
            if np.max(np.abs(step), initial=0.0) < SETTLED:
                return theta
        lengths, grid = self.ruled[index]  # on a narrow feature Newton's method may not settle
        after = np.clip(np.searchsorted(lengths, s), 1, grid.size - 1)
        before, beyond = grid[after - 1], grid[after]
        for _ in range(60):
            middle = 0.5 * (before + beyond)
            below = length(middle) < s
            before, beyond = np.where(below, middle, before), np.where(below, beyond, middle)
        return np.where(np.abs(step) < SETTLED, theta, 0.5 * (before + beyond))

    def _length(self, index: int) -> Callable[[Array], Array]:
        family, unit = self.states.family, self.states.unit.length
        if family.arclength(self.states.ops, index, np.zeros(1)) is not None:
            return lambda theta: np.asarray(family.arclength(self.states.ops, index, theta)) * unit
        m = family.elliptic()
        if m is not None:
            from scipy.special import ellipeinc

            return lambda theta: np.asarray(ellipeinc(theta, m)) * unit

        def speed(at: Array) -> Array:
            return self.states.speed(np.full(at.shape, index), at)

        low, high = self.states.ends[index]
        if self.states.boundary.closed:
            waves = Waves.of(speed)
            return halved(speed, low, high) if waves is None else waves.__call__
        return chebyshev(speed, low, high) or halved(speed, low, high)
