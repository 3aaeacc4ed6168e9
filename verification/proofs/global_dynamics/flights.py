"""Flights from boxes of phase points: arcs that hold the landings, enclosures of the landings, and derivatives.

The signs of two cross products prove the arc, as `images` explains. Within the arc the mean-value theorem encloses
landing and incidence. `z0` is a start, `(v, w)` the direction of a flight, and a *bend* the rate at which the tangent
turns.
"""

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from sympy import Rational, simplify

from symbolic.tables.geometry import velocity
from symbolic.tables.table import Table, theta
from verification.arithmetic.arrays import (
    ROUNDING,
    Array,
    ArrayOps,
    BallArray,
    Compiled,
    Indices,
    common_part,
    direction,
    hull,
    turned,
)
from verification.rigorous.boxes import Boxes, centred

if TYPE_CHECKING:
    from verification.proofs.global_dynamics.images import PinballImages

TRIES = 7  # the most widenings of a guessed arc
SIDES = "x", "y", "v", "w", "cos", "speed", "bend"  # what the side of a flight depends on
CENTRE = 1e-10  # half the length, in the parameter, of the arc guessed around one landing
PLACES, CLOSE = (Rational(1, 7), Rational(1, 5)), 1e-9  # places and a tolerance for the test whether a bend is constant
OPS = ArrayOps()
CURVE = "x", "y", "dx", "dy", "ddx", "ddy"  # position, velocity and acceleration of a boundary point


class LandingArcs(NamedTuple):
    """The part of the arc of landings that lies on one component, for some boxes; `smooth` if it is the whole arc."""

    on: Indices
    chart: Indices
    low: Array
    high: Array
    smooth: bool


class Slopes(NamedTuple):
    """The landing's derivatives by `theta` and `phi`, the bends at start and landing, and the law's slopes.

    With these derivatives `d eta1 = bend_there*d theta1 - bend_here*d theta0 + d phi0`, and `d phi1 = drift*d theta1 -
    law*d eta1`; `drift` is 0 if the law does not depend on where the particle lands.
    """

    by_theta: BallArray
    by_phi: BallArray
    bend_here: BallArray
    bend_there: BallArray
    law: BallArray
    drift: BallArray = BallArray(0.0)


End = tuple[Indices, Array]  # component and parameter of boundary points
Places = dict[str, BallArray]
Matrix = list[list[BallArray]]
Landing = tuple[
    LandingArcs, BallArray, BallArray, BallArray | None
]  # place, incidence, and exit for a law of the place


class Flights:
    """The flights from a block of boxes, with the values that several computations share.

    In its methods `on` are indices of boxes, and `chart` and `arc` the components and balls of parameters where these
    boxes may land.
    """

    def __init__(self, map: "PinballImages", boxes: Boxes) -> None:
        self.map, self.boxes, self.chart = map, boxes, boxes.chart
        (theta, phi), self.reach, (self.thetas, self.phis) = centred(boxes)
        self.theta, self.phi = theta, phi
        self.centre = self._leaving(theta, phi)
        self.whole = self._leaving(self.thetas, self.phis)
        self.landed: tuple[Indices, Array, list[BallArray]]  # of the midpoints in float64, with the boundary there
        self.last: tuple[BallArray, list[BallArray], BallArray] | None = None  # an arc, the boundary, and incidences

    def _leaving(self, theta: BallArray, phi: BallArray) -> dict[str, BallArray]:
        """Values at the start of flights: boundary point, velocity, acceleration, speed, bend, and direction."""
        place = self.map.place(self.chart, theta)
        return dict(zip((*CURVE, "v", "w", "cos", "speed", "bend"), (*place, *departing(*place, phi)), strict=True))

    def among(self, places: Places, names: tuple[str, ...], on: Indices) -> list[BallArray]:
        """The named values at the boxes `on`; they are not copied if these are all boxes."""
        return [places[name] for name in names] if on.size == self.chart.size else [places[name][on] for name in names]

    def sides(self, end: End, on: Indices) -> BallArray:
        """The cross product of flight direction and vector to `end`: positive if `end` is left of the flights."""
        x, y, *_ = self.map.place(end[0], BallArray(end[1]))
        at, all_of = self.among(self.centre, SIDES[:4], on), self.among(self.whole, SIDES, on)
        return aside(x, y, *at, *all_of, self.reach[0][on], self.reach[1][on])[0]

    def arcs(self) -> tuple[End, End]:
        """The two ends of an arc of landings for each box; a parameter is NaN if that end is not proved."""
        chart, theta, *widths = self.guess()
        found = []
        for sign, width in zip((-1, 1), widths, strict=True):
            where, at, on = chart.copy(), np.full(theta.shape, np.nan), np.arange(theta.size)
            for attempt in range(TRIES):
                trial = self._moved(chart[on], theta[on], sign * width[on] * 1.4**attempt)
                side = self.sides(trial, on)
                good = side.negative() if sign < 0 else side.positive()
                where[on[good]], at[on[good]] = trial[0][good], trial[1][good]
                if not (on := on[~good]).size:
                    break
            found.append((where, at))
        if not self.map.closed:  # a landing comes after every start of the box, and before that start comes again
            unknown = [np.isnan(at) for _, at in found]
            for (where, at), mine, other, own in zip(found, unknown, unknown[::-1], self.boxes.x, strict=True):
                use = mine & ~other
                where[use], at[use] = self.chart[use], own[use]
        return found[0], found[1]

    def guess(self) -> tuple[Indices, Array, Array, Array]:
        """The landings of midpoints in float64, and guesses of how far a box's landings extend before and after."""
        ends = self.map.map.states.ends
        low, high = (np.array([end[i] for end in ends])[self.chart] for i in (0, 1))
        theta = self.theta.m if self.map.closed else np.clip(self.theta.m, low, high)
        step = self.map.map.step(theta, self.phi.m, self.chart)
        chart = np.where(step.code == 0, step.component, self.chart)
        landed = np.where(step.code == 0, step.theta, np.nan)
        self.landed = chart, landed, self.map.place(chart, BallArray(np.nan_to_num(landed)))
        x, y, dx, dy, *_ = (value.m for value in self.landed[2])
        with np.errstate(all="ignore"):
            at = {name: value.m for name, value in self.centre.items()}
            along = at["v"] * (x - at["x"]) + at["w"] * (y - at["y"])
            slope = np.abs(at["v"] * dy - at["w"] * dx)
            rate = np.abs(at["cos"] * at["speed"] - at["bend"] * along) * self.reach[0].r
            width = (rate + np.abs(along) * self.reach[1].r) / slope * 1.1 + CENTRE
        if self.map.closed:
            landed = landed + 2 * np.pi * (landed < self.theta.m)
        return chart, landed, width, width

    def _moved(self, chart: Indices, theta: Array, by: Array) -> End:
        """Boundary points with parameters moved by `by`; beyond a join, by the same length on the next component."""
        if self.map.closed:
            return chart, theta + by
        count = len(self.map.ends)
        low, high = self.map.inner
        first, chart, moved = chart, chart.copy(), theta + by
        for edge, step, start in ((high, 1, low), (low, -1, high)):
            over = np.flatnonzero(step * (moved - edge[chart]) > 0)
            if not over.size:
                continue
            after = (chart[over] + step) % count
            ends = (first[over], theta[over]), (after, start[after])
            speed = [np.hypot(*(x.m for x in self.map.place(on, BallArray(at))[2:4])) for on, at in ends]
            moved[over] = start[after] + step * np.abs(moved[over] - edge[chart[over]]) * speed[0] / speed[1]
            chart[over] = after
        return chart, np.clip(moved, low[chart], high[chart])

    def pieces(self, low: End, high: End) -> list[LandingArcs]:
        """The arcs of landings, split at the joins."""
        if self.map.closed:
            return [LandingArcs(np.arange(self.chart.size), self.chart, low[1], high[1], True)]
        count = len(self.map.ends)
        whole = (low[0] == high[0]) & (low[1] < high[1]) & ~np.isnan(low[1])
        found = [LandingArcs(np.flatnonzero(whole), high[0][whole], low[1][whole], high[1][whole], True)]
        joined = np.flatnonzero(~whole)
        steps = (high[0][joined] - low[0][joined]) % count
        steps = np.where(steps == 0, count, steps)  # once around the boundary
        for step in range(int(steps.max(initial=0)) + 1):
            on = joined[steps >= step]
            last = steps[steps >= step] == step
            chart = (low[0][on] + step) % count
            bottom, top = self.map.outer[:, chart]
            a = low[1][on] if step == 0 else bottom
            found.append(LandingArcs(on, chart, a, np.where(last, high[1][on], top), False))
        return found

    def landing(self, piece: LandingArcs) -> Landing:
        """Landing parameter and incidence angle of the boxes of a piece.

        Where the piece is not `smooth`, it may not hold all landings of the box, and the mean-value theorem is not
        used.
        """
        on, chart, low, high, smooth = piece
        arc = hull(low, high)
        eta = self.over(on, chart, arc)[1]
        if not smooth:
            return piece, arc, eta, None
        theta, eta, phi = self.mean_value(on, chart, arc, eta)
        return piece, common_part(arc, theta), eta, phi

    def over(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[list[BallArray], BallArray]:
        """The boundary over an arc, and the incidence angles there; the last result is cached."""
        if self.last is None or self.last[0] is not arc:
            place = self.map.place(chart, arc)
            turn = turn_between(self.tangent(on, self.whole), place[2:4])
            self.last = arc, place, incidence(self.phis[on] + turn)
        return self.last[1:]

    @staticmethod
    def tangent(on: Indices, at: Places) -> list[BallArray]:
        """The velocity of the boundary at the starts of the boxes `on`, taken from the values `at`."""
        return [at["dx"][on], at["dy"][on]]

    def mean_value(
        self, on: Indices, chart: Indices, arc: BallArray, eta: BallArray
    ) -> tuple[BallArray, BallArray, BallArray | None]:
        """Landing, incidence and (for a law that depends on the place) exit angle, by the mean-value theorem."""
        by_theta, by_phi, here, there, law, drift = self.slopes(on, chart, arc)
        reach = self.reach[0][on], self.reach[1][on]
        middle = self.midpoint(on, chart, arc)
        turn = turn_between(self.tangent(on, self.centre), self.map.place(chart, middle)[2:4])
        theta, fine, *by = moved(middle, self.phi[on], turn, by_theta, by_phi, here, there, *reach)
        phi = None
        if self.map.placed:  # place and incidence are correlated
            phi = self.map.exit(incidence(self.phi[on] + turn), middle)
            phi = phi + (drift * by_theta - law * by[0]) * reach[0] + (drift * by_phi - law * by[1]) * reach[1]
        return theta, common_part(eta, incidence(fine)), phi

    @cached_property
    def speed(self) -> BallArray:
        """The speed of the boundary parameter over each box."""
        here = [self.whole[name] for name in CURVE]
        return speed(self.centre["speed"], self.whole["speed"], here, self.reach[0])

    @cached_property
    def bend(self) -> BallArray:
        """The rate at which the tangent turns with the boundary parameter, over each box."""
        return closer(lambda: self.whole["bend"], self.map, self.chart)

    def near(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[BallArray, list[BallArray]]:
        """The double at the middle of each arc, as centre for the mean-value theorem, and the boundary there."""
        return (at := BallArray(np.asarray(arc.m))), self.map.place(chart, at)

    def slopes(self, on: Indices, chart: Indices, arc: BallArray) -> Slopes:
        """The derivatives of the landings over the boxes `on`, whose landings lie in an arc.

        Along a flight from `z0` to `z1`, with its length `l`,

            d theta1/d theta0 = (bend0*l - cos(phi0)*speed0)/(speed1*cos(eta1)),
            d theta1/d phi0 = -l/(speed1*cos(eta1)).

        Length, speeds and incidence are enclosed by the mean-value theorem.
        """
        beyond, (there, rough_eta) = self.reach[0][on], self.over(on, chart, arc)
        at, last = self.near(on, chart, arc)
        here, bend = self.bend[on], closer(lambda: turn_rate(there), self.map, chart)
        start, first = self.among(self.whole, CURVE[:4], on), self.among(self.centre, CURVE[:4], on)
        turn = turn_between(first[2:], last[2:4])
        rates = beyond, self.reach[1][on], here, bend, self.phi[on], turn, rough_eta
        length, fast, eta = flown(*there, *start, *first, *last[:4], arc, at, *rates)
        across = fast * turned(eta)[0]
        across = BallArray(across.m, np.where(across.positive(), across.r, np.inf))
        by_theta = (here * length - self.whole["cos"][on] * self.speed[on]) / across
        return Slopes(by_theta, -length / across, here, bend, *self.map.slopes(eta, arc))

    def across(
        self, on: Indices, chart: Indices, arc: BallArray
    ) -> tuple[Places, list[BallArray], BallArray, BallArray]:
        """Values at the boxes `on`; and, over an arc, boundary velocity, distance, and speed across the flights."""
        at = {name: value[on] for name, value in self.whole.items()}
        (x, y, *velocity), _ = self.over(on, chart, arc)
        along = at["v"] * (x - at["x"]) + at["w"] * (y - at["y"])
        slope = at["v"] * velocity[1] - at["w"] * velocity[0]
        return at, velocity, along, BallArray(slope.m, np.where(slope.positive(), slope.r, np.inf))

    def midpoint(self, on: Indices, chart: Indices, arc: BallArray) -> BallArray:
        """The landings of the midpoints of boxes, enclosed by one interval Newton step within the arc."""
        at = self.among(self.centre, SIDES[:4], on)
        (x, y, v, w), guess = (each.m for each in at), BallArray(np.asarray(arc.m))
        place, (slopes, _) = self.map.place(chart, guess), self.over(on, chart, arc)
        for _ in range(2):  # Newton steps in float64
            value = v * (place[1].m - y) - w * (place[0].m - x)
            guess = BallArray(guess.m - value / (v * place[3].m - w * place[2].m))
            place = self.map.place(chart, guess)
        return newton(guess, arc, *at, *place[:2], *slopes[2:4])[0]


def turn_between(first: list[BallArray], last: list[BallArray]) -> BallArray:
    """The angle from the first tangent to the last, minus half a turn, modulo full turns."""
    return between(*first, *last)[0]


@Compiled
def between(a: BallArray, b: BallArray, c: BallArray, d: BallArray) -> list[BallArray]:
    """The angle from `-(a, b)` to `(c, d)`."""
    along, across = a * c + b * d, a * d - b * c
    return [direction(-along, -across)]


@Compiled
def departing(
    x: BallArray, y: BallArray, dx: BallArray, dy: BallArray, ddx: BallArray, ddy: BallArray, phi: BallArray
) -> list[BallArray]:
    """Direction of flight, cosine of the exit angle, speed and bend, from the boundary curve and the exit angle."""
    square, (c, s) = dx * dx + dy * dy, turned(phi)
    v, w = (s * dx - c * dy) / (speed := OPS.sqrt(square)), (s * dy + c * dx) / speed
    return [v, w, c, speed, (dx * ddy - dy * ddx) / square]


@Compiled
def aside(x: BallArray, y: BallArray, *known: BallArray) -> list[BallArray]:
    """The cross product of `(v, w)` and `(x, y) - z0`, enclosed by the mean-value theorem, for `Flights.sides`.

    `known` has the first four `SIDES` at the midpoints of boxes, all `SIDES` over the boxes, and the balls of the
    differences of `theta` and `phi` from the midpoint.
    """
    (x0, y0, v0, w0), (x1, y1, v, w, cos, speed, bend), (by_theta, by_phi) = known[:4], known[4:11], known[11:]
    value = v0 * (y - y0) - w0 * (x - x0)
    along = v * (x - x1) + w * (y - y1)
    return [value + (cos * speed - bend * along) * by_theta + along * by_phi]


@Compiled
def moved(middle: BallArray, phi: BallArray, turn: BallArray, *slopes: BallArray) -> list[BallArray]:
    """Landing and incidence by the mean-value theorem, and the derivatives of the incidence."""
    by_theta, by_phi, here, there, wide, high = slopes
    by = there * by_theta - here, there * by_phi + 1
    return [middle + by_theta * wide + by_phi * high, phi + turn + by[0] * wide + by[1] * high, *by]


@Compiled
def flown(*known: BallArray) -> list[BallArray]:
    """Length of the flight, speed at the landing, and incidence, by the mean-value theorem; see `Flights.slopes`."""
    there, start, first, last = known[:6], known[6:10], known[10:14], known[14:18]
    arc, at, wide, high, here, bend, phi, turn, rough_eta = known[18:]
    beside, gap = arc - at, [there[0] - start[0], there[1] - start[1]]
    rough, length = norm(OPS, gap), norm(OPS, [last[0] - first[0], last[1] - first[1]])
    shorter = (gap[0] * start[2] + gap[1] * start[3]) / rough
    longer = (gap[0] * there[2] + gap[1] * there[3]) / rough
    length = common_part(length - shorter * wide + longer * beside, rough)
    fast = speed(norm(OPS, last[2:4]), norm(OPS, there[2:4]), there, beside)
    eta = phi + turn + high
    return [length, fast, common_part(incidence(eta + bend * beside - here * wide), rough_eta)]


@Compiled
def newton(guess: BallArray, arc: BallArray, *known: BallArray) -> list[BallArray]:
    """One interval Newton step for a landing; the radius is infinite if the guess lies outside the arc."""
    (x0, y0, v, w), (x, y), (dx, dy) = known[:4], known[4:6], known[6:]
    inside = (guess.m >= arc.m - arc.r) & (guess.m <= arc.m + arc.r)
    found = guess - (v * (y - y0) - w * (x - x0)) / (v * dy - w * dx)
    return [BallArray(found.m, np.where(inside, found.r, np.inf))]


def incidence(eta: BallArray) -> BallArray:
    """Angles of incidence; the radius is infinite where a shift by a full turn cannot be excluded.

    True angles lie within a quarter turn of 0, and an enclosure within three quarters of a turn holds no two angles
    that differ by a full turn.
    """
    return BallArray(eta.m, np.where(eta.magnitude() < 4.7, eta.r, np.inf))


def matrix(slopes: Slopes) -> Matrix:
    """The derivative matrix of the map in `(theta, phi)`, from the slopes of flights."""
    by_theta, by_phi, here, there, law, drift = slopes
    turn = [there * by_theta - here, there * by_phi + 1]
    return [[by_theta, by_phi], [drift * by_theta - law * turn[0], drift * by_phi - law * turn[1]]]


def turn_rate(place: list[BallArray]) -> BallArray:
    """The rate at which the tangent turns with the parameter, from velocity and acceleration."""
    _, _, dx, dy, ddx, ddy = place
    return (dx * ddy - dy * ddx) / (dx * dx + dy * dy)


def norm(ops: ArrayOps, vector: Sequence[BallArray]) -> BallArray:
    """The Euclidean length of vectors."""
    return ops.sqrt(vector[0] * vector[0] + vector[1] * vector[1])


def speed(at: BallArray, rough: BallArray, place: Sequence[BallArray], beside: BallArray) -> BallArray:
    """The speed of the parameter by the mean-value theorem, from its value at one point and a rough enclosure."""
    return common_part(rough, at + (place[2] * place[4] + place[3] * place[5]) / rough * beside)


def closer(rough: Callable[[], BallArray], map: "PinballImages", chart: Indices) -> BallArray:
    """The bend on a component: the exact value if it is known to be constant, else the enclosure `rough()`."""
    known = np.array([np.nan if x is None else float(x) for x in constant_bends(map.map.table)])[chart]
    held, given = ~np.isnan(known), BallArray(known, np.abs(known) * ROUNDING)
    if held.all():
        return given
    bend = rough()
    return BallArray(np.where(held, given.m, bend.m), np.where(held, given.r, bend.r))


@lru_cache(maxsize=16)
def constant_bends(table: Table) -> tuple[Rational | None, ...]:
    """The bend of each component with respect to its parameter if SymPy finds it constant, else None.

    >>> from symbolic import tables
    >>> constant_bends(tables.cuspless)
    (3/2, 0)
    """
    found: list[Rational | None] = []
    for component in table.components:
        (dx, dy) = velocity(component)
        bend = (dx * dy.diff(theta) - dy * dx.diff(theta)) / (dx**2 + dy**2)
        some = [bend.subs(dict.fromkeys(bend.free_symbols, at)).n() for at in PLACES]
        varies = all(x.is_Float for x in some) and abs(some[0] - some[1]) > CLOSE
        bend = bend if varies else simplify(bend)
        found.append(bend if bend.is_Rational else None)
    return tuple(found)
