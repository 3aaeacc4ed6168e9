"""Outer images of boxes: rectangles that hold every point to which the map takes a point of the box.

In a convex table the line of a flight cuts the boundary in two arcs. Counterclockwise from the start, boundary points
lie to the right of the line before the landing and to its left after it. So two points, guessed in float64, enclose
the landings of a whole box as soon as one is proved to lie to the right of every flight of the box and the other to
the left: two signs of a cross product, and no equation is solved. Within that arc the mean-value theorem encloses the
image more closely. The exit angle needs no more than the angles `tau` of the tangents,

    phi1 = -lam*eta1,    eta1 = phi0 + tau(theta1) - tau(theta0) - pi,

or another law of `eta`, `lam` and the landing's `theta`, of period `2*pi` on a closed curve.

Where the arc holds a join, the image is given for both sides of it. Paper: section 2.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.lowering.lower import lower_law
from symbolic.tables.curves import is_periodic
from symbolic.tables.scene import Scene
from verification.maps.first_hit import closes_smoothly, convex
from verification.proofs.global_dynamics.boxes import (
    ArrayOps,
    BallArray,
    Boxes,
    Chart,
    Images,
    Row,
    centred,
    collected,
    common_part,
    direction,
    exactly,
    hull,
    spread,
    turned,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
TRIES = 7  # widenings of a guessed arc
STEPS, PLACES = 1 << 12, 1 << 6  # pieces of the incidence angles, and of each component under a law of the place
QUARTER = 1.5707963267948966  # below pi/2
CENTRE = 1e-10  # half the length of the arc guessed about one landing, in the parameter


class Piece(NamedTuple):
    """Boxes, and for each a part of its arc of landings, on one component; `smooth` if it is all of the arc."""

    on: Indices
    chart: Indices
    low: Array
    high: Array
    smooth: bool


class Slopes(NamedTuple):
    """The landing's derivatives by `theta` and `phi`, how fast the tangent turns at start and landing, the law's slope.

    With them `d eta1 = bend_there*d theta1 - bend_here*d theta0 + d phi0`, and `d phi1 = drift*d theta1 - law*d eta1`;
    `drift` is 0 for a law that is the same everywhere.
    """

    by_theta: BallArray
    by_phi: BallArray
    bend_here: BallArray
    bend_there: BallArray
    law: BallArray
    drift: BallArray = BallArray(0.0)


class PinballImages:
    """The map of a scene whose table is proved convex, for every contraction from `lam[0]` to `lam[1]`.

    Phase space is the strip `|phi| <= top`, in which every particle is after one bounce: `lam*pi/2` for the paper's
    law, a bound in balls for others. A landing on a join has no next bounce; its images are those of both sides.

    >>> egg = PinballImages(Scene("egg", alpha="0.08", lam="1/2"))
    >>> egg.label
    'egg, alpha = 2/25, lam = 1/2'
    """

    def __init__(self, scene: Scene, lam: tuple[Fraction, Fraction] | None = None) -> None:
        self.scene = scene
        self.range = low, high = lam or (Fraction(str(scene.lam)),) * 2
        if not 0 <= low <= high < 1 or high == 0:
            raise ValueError(f"lam = {low}:{high} is no range; accepted: 0 <= LOW <= HIGH, with 0 < HIGH < 1")
        self.map = PinballMap(scene, lam=high)
        if convex(self.map.table) is not True:
            raise ValueError(f"{scene.name}: the table is not proved convex; accepted: convex tables")
        self.ops = ArrayOps()
        self.shape = [exactly(Fraction(x)) for x in self.map.exact_shape]
        self.closed = len(self.map.ir.parts) == 1
        if self.closed and not closes_smoothly(self.map.table):
            raise ValueError(f"{scene.name}: the boundary is not proved smooth where it closes; write it in components")
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in self.map.ir.parts]
        if (law := scene.law.on(self.map.table)).measured or law.along is not None:
            raise ValueError(f"law = {law}: boxes know theta, and s where it is a formula on one closed curve alone")
        self.law, self.placed = None if law.uniform else lower_law(law, lambda: self.map.table), law.placed
        if self.placed and self.closed and not is_periodic(law.phi):
            raise ValueError(f"law = {law}: a whole turn of theta is not seen to change nothing, as boxes need it")
        self.contract()

    def contract(self) -> None:
        """What depends on the range of contractions."""
        self.lam = hull(exactly(self.range[0]).lower(), exactly(self.range[1]).upper())
        self.top = float((self.lam * self.ops.pi / 2).upper()) if self.law is None else self._steepest()

    def _steepest(self) -> float:
        """A bound below a quarter turn for the exit angles of the law, over all incidence angles and contractions."""
        law = self.scene.law
        law.check(self.range, *law.places(self.map.table))
        size = max(float(np.max(self.exit(*some).magnitude())) for some in self.incidences())
        if size < QUARTER:
            return size
        raise ValueError(f"law = {law}: |phi| is not proved to stay below pi/2 by a margin, as boxes need it")

    def incidences(self) -> Iterator[tuple[BallArray, BallArray]]:
        """All incidence angles in pieces, on each piece of the boundary that the law tells apart."""
        angles = np.linspace(-1, 1, STEPS + 1) * float((self.ops.pi / 2).upper())
        ends, cuts = (self.ends, PLACES) if self.placed else (self.ends[:1], 1)
        for start, end in ends:
            for near, far in pairwise(np.linspace(float(start.lower()), float(end.upper()), cuts + 1)):
                yield hull(angles[:-1], angles[1:]), hull(near, far)

    def exit(self, eta: BallArray, theta: BallArray) -> BallArray:
        """The exit angles, by the mean-value theorem about the middles of incidence angles and places."""
        if self.law is None:
            return -(self.lam * eta)
        with np.errstate(all="ignore"):
            middle, place = BallArray(np.asarray(eta.m)), BallArray(np.asarray(theta.m) if self.placed else 0.0)
            at = spread(self.law.exit(self.ops, middle, self.lam, place)[0], middle.m)
            slope, drift = self.slopes(eta, theta)
            found = at - slope * (eta - middle)
            return found + drift * (theta - place) if self.placed else found

    def slopes(self, eta: BallArray, theta: BallArray) -> tuple[BallArray, BallArray]:
        """`-d phi/d eta` and `d phi/d theta` over incidence angles and places."""
        if self.law is None:
            return self.lam, BallArray(0.0)
        slope, drift = self.law.slopes(self.ops, eta, self.lam, theta if self.placed else BallArray(0.0))
        return spread(slope, np.asarray(eta.m)), spread(drift, np.asarray(eta.m)) if self.placed else BallArray(0.0)

    @property
    def charts(self) -> tuple[Chart, ...]:
        parts = self.map.ir.parts
        return tuple(
            Chart(part.name, (float(low.m), float(high.m)), (-self.top, self.top), self.closed, True)
            for part, (low, high) in zip(parts, self.ends, strict=True)
        )

    @property
    def label(self) -> str:
        shape, (low, high) = "".join(f", {name} = {value}" for name, value in self.scene.shape.items()), self.range
        law = "" if self.law is None else f", phi = {self.scene.law}"
        return f"{self.scene.name}{shape}{law}, lam = {low}" + ("" if low == high else f" to {high}")

    def place(self, chart: Indices, theta: BallArray) -> list[BallArray]:
        """Point, velocity and acceleration at parameters of components."""
        if self.closed:
            return [spread(value, theta.m) for value in self.map.ir.parts[0].curve(self.ops, theta, *self.shape)]
        m, r = np.broadcast_arrays(theta.m, theta.r)
        made = [BallArray(np.zeros(m.shape), np.zeros(m.shape)) for _ in range(6)]
        for index, part in enumerate(self.map.ir.parts):
            on = chart == index
            for whole, value in zip(made, part.curve(self.ops, BallArray(m[on], r[on]), *self.shape), strict=True):
                whole.m[on], whole.r[on] = value.m, value.r
        return made

    def flights(self, boxes: Boxes) -> "Flights":
        """The flights that leave a block of boxes."""
        return Flights(self, boxes)

    def images(self, boxes: Boxes) -> Images:
        with np.errstate(all="ignore"):  # what overflows or is no number counts as not known
            flights = self.flights(boxes)
            rows = [self.row(*flights.landing(piece)) for piece in flights.pieces(*flights.arcs())]
        return collected(rows, np.arange(boxes.chart.size))

    def row(self, piece: Piece, theta: BallArray, eta: BallArray, phi: BallArray | None) -> Row:
        """One rectangle for each box of a piece."""
        on, chart, low, high, smooth = piece
        exit, top = self.exit(eta, theta), self.top
        phi = exit if phi is None else common_part(phi, exit)
        low_y, high_y = np.maximum(phi.lower(), -top), np.minimum(phi.upper(), top)
        known = np.isfinite(phi.r) & (low_y <= high_y)
        none = np.isfinite(phi.r) & (low_y > high_y) & (not smooth)  # no landing has such an angle
        low_y, high_y = np.where(known, low_y, -top), np.where(known, high_y, top)
        bad = np.isnan(low) | np.isnan(high)
        left, right = np.where(bad, np.nan, theta.lower()), np.where(bad, np.nan, theta.upper())
        return on[~none], chart[~none], left[~none], right[~none], low_y[~none], high_y[~none]

    def derivatives(self, boxes: Boxes) -> list[tuple[Piece, Slopes]]:
        """The derivative over whole boxes, for each piece of their arcs; entries of infinite radius are not known."""
        with np.errstate(all="ignore"):
            pieces = (flights := self.flights(boxes)).pieces(*flights.arcs())
            return [(p, flights.slopes(p.on, p.chart, hull(p.low, p.high))) for p in pieces if p.on.size]


End = tuple[Indices, Array]  # component and parameter of boundary points
Places = dict[str, BallArray]
Landing = tuple[Piece, BallArray, BallArray, BallArray | None]  # where, the incidence, the exit if place and law mix


class Flights:
    """What a block of boxes needs more than once."""

    def __init__(self, map: PinballImages, boxes: Boxes) -> None:
        self.map, self.boxes, self.chart = map, boxes, boxes.chart
        (theta, phi), self.reach, (self.thetas, self.phis) = centred(boxes)
        self.theta, self.phi = theta, phi
        self.centre = self._leaving(theta, phi)
        self.whole = self._leaving(self.thetas, self.phis)

    def _leaving(self, theta: BallArray, phi: BallArray) -> dict[str, BallArray]:
        """Start, velocity and acceleration of the boundary, its speed and bend, and the direction of flight."""
        x, y, dx, dy, ddx, ddy = self.map.place(self.chart, theta)
        square, (c, s) = dx * dx + dy * dy, turned(phi)
        v, w = (s * dx - c * dy) / (speed := self.map.ops.sqrt(square)), (s * dy + c * dx) / speed
        found = {"x": x, "y": y, "dx": dx, "dy": dy, "ddx": ddx, "ddy": ddy, "v": v, "w": w, "cos": c, "speed": speed}
        return found | {"bend": (dx * ddy - dy * ddx) / square}

    def sides(self, end: End) -> BallArray:
        """`v x (z - z0)` for the flights of each box and one boundary point: positive to the left of every flight."""
        x, y, *_ = self.map.place(end[0], BallArray(end[1]))
        at, all_of = self.centre, self.whole
        value = at["v"] * (y - at["y"]) - at["w"] * (x - at["x"])
        along = all_of["v"] * (x - all_of["x"]) + all_of["w"] * (y - all_of["y"])
        by_theta = all_of["cos"] * all_of["speed"] - all_of["bend"] * along
        return value + by_theta * self.reach[0] + along * self.reach[1]

    def arcs(self) -> tuple[End, End]:
        """An arc for each box that holds its landings; parameters are nan where none is proved."""
        chart, theta, ahead, behind = self.guess()
        found = []
        for sign in (-1, 1):
            where, at = chart.copy(), np.full(theta.shape, np.nan)
            width, open_ = np.where(sign < 0, ahead, behind), np.ones(theta.shape, dtype=bool)
            for attempt in range(TRIES):
                trial = self._moved(chart, theta, sign * width * 1.4**attempt)
                side = self.sides(trial)
                good = open_ & (side.negative() if sign < 0 else side.positive())
                where[good], at[good] = trial[0][good], trial[1][good]
                open_ &= ~good
                if not np.any(open_):
                    break
            found.append((where, at))
        if not self.map.closed:  # a landing comes after every start of the box, and before that start comes again
            unknown = [np.isnan(at) for _, at in found]
            for (where, at), mine, other, own in zip(found, unknown, unknown[::-1], self.boxes.x, strict=True):
                use = mine & ~other
                where[use], at[use] = self.chart[use], own[use]
        return found[0], found[1]

    def guess(self) -> tuple[Indices, Array, Array, Array]:
        """Landings of the midpoints, and how far the box's landings may lie before and after, in float64."""
        ends = self.map.map.states.ends
        low, high = (np.array([end[i] for end in ends])[self.chart] for i in (0, 1))
        theta = self.theta.m if self.map.closed else np.clip(self.theta.m, low, high)
        step = self.map.map.step(theta, self.phi.m, self.chart)
        chart = np.where(step.code == 0, step.component, self.chart)
        landed = np.where(step.code == 0, step.theta, np.nan)
        x, y, dx, dy, *_ = (value.m for value in self.map.place(chart, BallArray(np.nan_to_num(landed))))
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
        """Boundary points moved along by a parameter; past a join onto the next component, by the same length."""
        if self.map.closed:
            return chart, theta + by
        count = len(self.map.ends)
        low = np.array([float(end[0].upper()) for end in self.map.ends])
        high = np.array([float(end[1].lower()) for end in self.map.ends])
        place = [value.m for value in self.map.place(chart, BallArray(np.nan_to_num(theta)))]
        speed = np.hypot(place[2], place[3])
        chart, moved = chart.copy(), theta + by
        for edge, step, start in ((high, 1, low), (low, -1, high)):
            over = moved > edge[chart] if step > 0 else moved < edge[chart]
            length = np.abs(moved - edge[chart]) * speed
            following = np.where(over, (chart + step) % count, chart)
            place = [value.m for value in self.map.place(following, BallArray(start[following]))]
            moved = np.where(over, start[following] + step * length / np.hypot(place[2], place[3]), moved)
            chart = following
        return chart, np.clip(moved, low[chart], high[chart])

    def pieces(self, low: End, high: End) -> list[Piece]:
        """The arcs of landings, cut where components meet."""
        if self.map.closed:
            return [Piece(np.arange(self.chart.size), self.chart, low[1], high[1], True)]
        count = len(self.map.ends)
        ends = [(float(a.lower()), float(b.upper())) for a, b in self.map.ends]
        whole = (low[0] == high[0]) & (low[1] < high[1]) & ~np.isnan(low[1])
        found = [Piece(np.flatnonzero(whole), high[0][whole], low[1][whole], high[1][whole], True)]
        joined = np.flatnonzero(~whole)
        steps = (high[0][joined] - low[0][joined]) % count
        steps = np.where(steps == 0, count, steps)  # around all of the boundary
        for step in range(int(steps.max(initial=0)) + 1):
            on = joined[steps >= step]
            last = steps[steps >= step] == step
            chart = (low[0][on] + step) % count
            bottom, top = (np.array([end[i] for end in ends])[chart] for i in (0, 1))
            a = low[1][on] if step == 0 else bottom
            found.append(Piece(on, chart, a, np.where(last, high[1][on], top), False))
        return found

    def landing(self, piece: Piece) -> Landing:
        """For each box of a piece, whose landings lie on one component between two parameters.

        Without `smooth` the arc may not hold all landings of the box, and the mean-value theorem is not used.
        """
        on, chart, low, high, smooth = piece
        arc = hull(low, high)
        eta = incidence(self.phis[on] + turn_between(self.tangent(on, self.thetas), self.map.place(chart, arc)[2:4]))
        if not smooth:
            return piece, arc, eta, None
        theta, eta, phi = self.mean_value(on, chart, arc, eta)
        return piece, common_part(arc, theta), eta, phi

    def tangent(self, on: Indices, theta: BallArray) -> list[BallArray]:
        return self.map.place(self.chart[on], theta[on])[2:4]

    def mean_value(
        self, on: Indices, chart: Indices, arc: BallArray, eta: BallArray
    ) -> tuple[BallArray, BallArray, BallArray | None]:
        """Landing, incidence and, under a law of the place, exit, by the mean-value theorem about the midpoint's."""
        by_theta, by_phi, here, there, law, drift = self.slopes(on, chart, arc)
        reach = self.reach[0][on], self.reach[1][on]
        middle = self.midpoint(on, chart, arc)
        theta = middle + by_theta * reach[0] + by_phi * reach[1]
        turn = turn_between(self.tangent(on, self.theta), self.map.place(chart, middle)[2:4])
        by = there * by_theta - here, there * by_phi + 1
        fine = self.phi[on] + turn + by[0] * reach[0] + by[1] * reach[1]
        phi = None
        if self.map.placed:  # place and incidence move together
            phi = self.map.exit(incidence(self.phi[on] + turn), middle)
            phi = phi + (drift * by_theta - law * by[0]) * reach[0] + (drift * by_phi - law * by[1]) * reach[1]
        return theta, common_part(eta, incidence(fine)), phi

    def slopes(self, on: Indices, chart: Indices, arc: BallArray) -> Slopes:
        """The derivatives over the boxes `on`, whose landings lie in an arc."""
        at, (dx, dy, ddx, ddy), along, slope = self.across(on, chart, arc)
        by_theta = (at["bend"] * along - at["cos"] * at["speed"]) / slope
        law, drift = self.map.lam, BallArray(0.0)
        if self.map.law is not None:
            turn = self.phis[on] + turn_between(self.tangent(on, self.thetas), [dx, dy])
            law, drift = self.map.slopes(incidence(turn), arc)
        return Slopes(by_theta, -along / slope, at["bend"], (dx * ddy - dy * ddx) / (dx * dx + dy * dy), law, drift)

    def across(
        self, on: Indices, chart: Indices, arc: BallArray
    ) -> tuple[Places, list[BallArray], BallArray, BallArray]:
        """The boxes `on`; velocity and acceleration over an arc; how far it is, and how fast it leaves the lines."""
        at = {name: value[on] for name, value in self.whole.items()}
        x, y, *velocity = self.map.place(chart, arc)
        along = at["v"] * (x - at["x"]) + at["w"] * (y - at["y"])
        slope = at["v"] * velocity[1] - at["w"] * velocity[0]
        return at, velocity, along, BallArray(slope.m, np.where(slope.positive(), slope.r, np.inf))

    def midpoint(self, on: Indices, chart: Indices, arc: BallArray) -> BallArray:
        """Where the midpoints of boxes land, within the arc: one step of interval Newton there."""
        at = {name: value[on] for name, value in self.centre.items()}
        guess = BallArray(np.asarray(arc.m))
        place, slopes = self.map.place(chart, guess), self.map.place(chart, arc)
        for _ in range(2):  # of Newton's method, in float64
            value = at["v"].m * (place[1].m - at["y"].m) - at["w"].m * (place[0].m - at["x"].m)
            guess = BallArray(guess.m - value / (at["v"].m * place[3].m - at["w"].m * place[2].m))
            place = self.map.place(chart, guess)
        value = at["v"] * (place[1] - at["y"]) - at["w"] * (place[0] - at["x"])
        slope = at["v"] * slopes[3] - at["w"] * slopes[2]
        inside = (guess.m >= arc.m - arc.r) & (guess.m <= arc.m + arc.r)
        found = guess - value / slope
        return BallArray(found.m, np.where(inside, found.r, np.inf))


def turn_between(first: list[BallArray], last: list[BallArray]) -> BallArray:
    """The angle from one tangent to another, less half a turn, up to whole turns."""
    c, s = first[0] * last[0] + first[1] * last[1], first[0] * last[1] - first[1] * last[0]
    return direction(-c, -s)


def incidence(eta: BallArray) -> BallArray:
    """Angles of incidence known up to whole turns, as they are: they lie within a quarter turn.

    An enclosure within three quarters of a turn holds no number a whole turn away from one; a wider one is not kept.
    """
    return BallArray(eta.m, np.where(eta.magnitude() < 4.7, eta.r, np.inf))
