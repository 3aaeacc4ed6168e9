"""Sets of phase points that are carried along by the map: parallelograms, which turn and shear as the map does.

A rectangle about the image of a rectangle is larger than the image, and after some bounces mostly empty. A
*parallelogram* here is the set

    c + u*a + v*b + e,    |u| <= 1,  |v| <= 1,  |e_i| <= r_i,

with a midpoint `c`, two sides `a`, `b` and a rest `r`. By the mean-value theorem about `c` the map takes it into

    F(c) + D*(u*a + v*b + e)

with the derivative `D` over a rectangle about the set: the sides go to the midpoints of `D*a` and `D*b`, and what `D`
is uncertain by joins the rest, as does the rounding of `F(c)`. Where landings lie on both sides of a join the map is
continuous but has a kink. There one set goes on for each component: the landings on the longer curve that its formulas
give beyond the join, which are a smooth function of all of the set, or else a rectangle about those on the component.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from sympy import Rational, simplify

from symbolic.tables.geometry import velocity
from symbolic.tables.table import Table, theta
from verification.proofs.global_dynamics.boxes import ROUNDING, ArrayOps, BallArray, Boxes, common_part, hull, turned
from verification.proofs.global_dynamics.images import Flights, PinballImages, Slopes, incidence, turn_between

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
OUTWARDS = 1 + 2.0**-46  # more than the roundings of a sum of six doubles
PAD = 1e-300
WIDER = 1.5  # a parallelogram may be so much wider than the rectangle, for what it keeps of directions
Matrix = list[list[BallArray]]
ENDS = 1e-14  # more than the rounding of an end of a component
TRIES = 4  # doublings of what is added to an arc
REACH = 3.0  # about the length of a flight
CURVE = "x", "y", "dx", "dy", "ddx", "ddy"  # of a boundary point
FIELDS = "chart", "middle", "sides", "rest"


@dataclass(frozen=True)
class Parallelograms:
    """Midpoints, sides and rests, as in the module's docstring; the last axis counts the sets.

    `middle` and `rest` have the shape `(2, n)`, for `theta` and `phi`, and `sides` the shape `(2, 2, n)`, for the
    coordinate and the side. A set that is lost, of which nothing is known, has an infinite rest.
    """

    chart: Indices
    middle: Array
    sides: Array
    rest: Array

    @classmethod
    def about(cls, boxes: Boxes) -> "Parallelograms":
        """The boxes themselves: their sides are those of the parallelograms."""
        ends = [hull(*boxes.x), hull(*boxes.y)]
        middle, half = (np.array([getattr(end, name) for end in ends]) for name in "mr")
        sides = np.zeros((2, 2, boxes.chart.size))
        sides[0, 0], sides[1, 1] = half
        return cls(boxes.chart, middle, sides, np.zeros_like(middle))

    def __getitem__(self, chosen: NDArray[np.bool_] | Indices) -> "Parallelograms":
        return Parallelograms(
            self.chart[chosen], self.middle[:, chosen], self.sides[:, :, chosen], self.rest[:, chosen]
        )

    @property
    def known(self) -> Mask:
        """Which sets are not lost."""
        finite = [np.isfinite(x) for x in (self.middle, self.sides.reshape(4, -1), self.rest)]
        return np.asarray(np.logical_and.reduce(np.concatenate(finite)))

    def replaced(self, at: Indices, others: "Parallelograms") -> "Parallelograms":
        """With others in the place of some, where these are narrower."""
        with np.errstate(invalid="ignore"):
            use = others.reach() < self.reach()[at] * WIDER
            use |= others.reach(0.0, 1.0) < self.reach(0.0, 1.0)[at] / WIDER
            use &= np.isfinite(others.reach() + others.reach(0.0, 1.0))
        fields = [getattr(self, name).copy() for name in FIELDS]
        for own, name in zip(fields, FIELDS, strict=True):
            own[..., at[use]] = getattr(others, name)[..., use]
        return Parallelograms(*fields)

    def reach(self, first: float | Array = 1.0, second: float | Array = 0.0) -> Array:
        """How far `first*theta + second*phi` is from its value at the midpoint, at most."""
        along = np.abs(first * self.sides[0] + second * self.sides[1]).sum(axis=0)
        size = (np.abs(first) * np.abs(self.sides[0]) + np.abs(second) * np.abs(self.sides[1])).sum(axis=0)
        with np.errstate(invalid="ignore"):  # of a lost set nothing is known, and nan says so too
            rest = np.abs(first) * self.rest[0] + np.abs(second) * self.rest[1]
        return np.asarray((along + size * 2.0**-48 + rest) * OUTWARDS + PAD)

    def boxes(self) -> Boxes:
        """A rectangle about each set."""
        ends = []
        for middle, far in zip(self.middle, (self.reach(), self.reach(0.0, 1.0)), strict=True):
            slop = np.abs(middle) * 2.0**-51 + PAD
            ends.append((middle - far - slop, middle + far + slop))
        return Boxes(self.chart, ends[0], ends[1])


class Chords(Flights):
    """Flights whose derivative is enclosed closely: from the length of the chord, which hardly varies.

    Along a flight from `z0` to `z1`, with `t` the unit vector along it and `l` its length,

        d theta1/d theta0 = (bend0*l - cos(phi0)*speed0)/(speed1*cos(eta1)),   d theta1/d phi0 = -l/(speed1*cos(eta1)),

    where `bend` is how fast the tangent turns. The length and the speeds are enclosed by the mean-value theorem.
    """

    def slopes(self, on: Indices, chart: Indices, arc: BallArray) -> Slopes:
        """The derivatives over the boxes `on`, whose landings lie in an arc."""
        ops, mid = self.map.ops, BallArray(np.asarray(arc.m))
        beside = BallArray(0.0 * arc.m, arc.r)
        there, start = self.map.place(chart, arc), {name: value[on] for name, value in self.whole.items()}
        here = [start[name] for name in CURVE]
        gap = [there[k] - start[name] for k, name in ((0, "x"), (1, "y"))]
        rough = ops.sqrt(gap[0] * gap[0] + gap[1] * gap[1])
        t = [side / rough for side in gap]
        middle, centre = self.map.place(chart, mid), {name: value[on] for name, value in self.centre.items()}
        first = [middle[k] - centre[name] for k, name in ((0, "x"), (1, "y"))]
        length = ops.sqrt(first[0] * first[0] + first[1] * first[1])
        shorter, longer = (t[0] * place[2] + t[1] * place[3] for place in (here, there))
        length = common_part(length - shorter * self.reach[0][on] + longer * beside, rough)
        given = (start["bend"], self.chart[on]), (turn_rate(there), chart)
        bends = [closer(bend, self.map, where) for bend, where in given]
        speeds = [
            speed(ops, [centre[name] for name in CURVE], here, self.reach[0][on]),
            speed(ops, middle, there, beside),
        ]
        turn = turn_between([centre["dx"], centre["dy"]], middle[2:4])
        eta = self.phi[on] + turn + bends[1] * beside - bends[0] * self.reach[0][on] + self.reach[1][on]
        whole = incidence(self.phis[on] + turn_between(here[2:4], there[2:4]))
        eta = common_part(incidence(eta), whole)
        cosine = turned(eta)[0]
        across = speeds[1] * cosine
        across = BallArray(across.m, np.where(across.positive(), across.r, np.inf))
        by_theta = (bends[0] * length - start["cos"] * speeds[0]) / across
        law, drift = self.map.slopes(eta, arc)
        return Slopes(by_theta, -length / across, bends[0], bends[1], law, drift)

    def beyond(self, on: Indices, chart: Indices, low: Array, high: Array) -> tuple[BallArray, Mask]:
        """Arcs that go on past the join at which a component ends, along the same formulas; and which are told.

        They are so long that every flight of the box crosses the longer component within them; and once, since the
        derivative is known only where flights cross all of the arc from one side to the other. Where a landing lies on
        the component it is that crossing; and the crossing is a smooth function on all of the box.
        """
        first, last = (np.array([float(end[k].m) for end in self.map.ends])[chart] for k in (0, 1))
        up, down = high >= last, low <= first
        step = (self.reach[0].r + REACH * self.reach[1].r)[on]
        where, found = self.chart.copy(), [low.copy(), high.copy()]
        told = ~(up & down) & (low < high)
        for side, moving, sign in ((0, down, -1.0), (1, up, 1.0)):
            open_ = moving & told
            for attempt in range(TRIES):
                at = self.theta.m + 0.0 * self.thetas.m
                where[on], at[on] = chart, found[side] + sign * step * 2.0**attempt
                value = self.sides((where, at))[on]
                good = open_ & (value.positive() if sign > 0 else value.negative())
                found[side] = np.where(good, at[on], found[side])
                open_ &= ~good
            told &= ~open_
        return hull(*found), told

    def exits(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[Mask, Array, Array]:
        """Ends of the exit angles at landings in an arc, within phase space, and where they are known."""
        turn = turn_between(self.tangent(on, self.thetas), self.map.place(chart, arc)[2:4])
        exit, top = self.map.exit(incidence(self.phis[on] + turn), arc), self.map.top
        return np.isfinite(exit.r), np.maximum(exit.lower(), -top), np.minimum(exit.upper(), top)


def matrix(slopes: Slopes) -> Matrix:
    """The derivative in `(theta, phi)`."""
    by_theta, by_phi, here, there, law, drift = slopes
    turn = [there * by_theta - here, there * by_phi + 1]
    return [[by_theta, by_phi], [drift * by_theta - law * turn[0], drift * by_phi - law * turn[1]]]


def times(first: Matrix, second: Matrix) -> Matrix:
    """The product of two matrices of two rows."""
    return [[first[i][0] * second[0][j] + first[i][1] * second[1][j] for j in (0, 1)] for i in (0, 1)]


def turn_rate(place: list[BallArray]) -> BallArray:
    """How fast the tangent turns, by the parameter."""
    _, _, dx, dy, ddx, ddy = place
    return (dx * ddy - dy * ddx) / (dx * dx + dy * dy)


def speed(ops: ArrayOps, middle: list[BallArray], whole: list[BallArray], beside: BallArray) -> BallArray:
    """The speed of the parameter, by the mean-value theorem."""
    rough = ops.sqrt(whole[2] * whole[2] + whole[3] * whole[3])
    at = ops.sqrt(middle[2] * middle[2] + middle[3] * middle[3])
    return common_part(rough, at + (whole[2] * whole[4] + whole[3] * whole[5]) / rough * beside)


def closer(bend: BallArray, map: PinballImages, chart: Indices) -> BallArray:
    """A bend that is known to be constant on the component, or the one that is given."""
    known = np.array([np.nan if x is None else float(x) for x in constant_bends(map.map.table)])[chart]
    held = ~np.isnan(known)
    m, r = np.broadcast_arrays(bend.m, bend.r)
    return BallArray(np.where(held, known, m), np.where(held, np.abs(known) * ROUNDING, r))


@lru_cache(maxsize=16)
def constant_bends(table: Table) -> tuple[Rational | None, ...]:
    """How fast the tangent of each component turns, by its parameter, where SymPy finds that to be a constant.

    >>> from symbolic import tables
    >>> constant_bends(tables.cuspless)
    (3/2, 0)
    """
    found: list[Rational | None] = []
    for component in table.components:
        (dx, dy) = velocity(component)
        bend = simplify((dx * dy.diff(theta) - dy * dx.diff(theta)) / (dx**2 + dy**2))
        found.append(bend if bend.is_Rational else None)
    return tuple(found)


def carried(map: PinballImages, sets: Parallelograms) -> tuple[Indices, Parallelograms]:
    """Parallelograms about the images, and of which set each is one.

    Of a lost set no image is known: its image is lost. A set without an image holds no phase point of the table.
    """
    with np.errstate(all="ignore"):
        whole, part = sets.boxes(), _on_the_table(map, sets)
        held = np.flatnonzero(~((part.x[0] > part.x[1]) | (part.y[0] > part.y[1])))
        rows = _carried(map, sets, whole, held) or [(held, sets[held])]
        lost = np.unique(np.concatenate([on[~images.known] for on, images in rows]))
        rows = [(on[keep := ~np.isin(on, lost)], images[keep]) for on, images in rows] + _carried(map, sets, part, lost)
    source = np.concatenate([on for on, _ in rows])
    fields = ([getattr(images, name) for _, images in rows] for name in FIELDS)
    images = Parallelograms(*(np.concatenate(field, axis=-1) for field in fields))
    images.rest[:, ~images.known] = np.inf
    return source, images


Rows = list[tuple[Indices, "Parallelograms"]]


def _carried(map: PinballImages, sets: Parallelograms, boxes: Boxes, on: Indices) -> Rows:
    """The images of some sets, from rectangles about them.

    A set may go on past the end of its component, along the same formulas: its flights are those of a longer curve.
    """
    if not on.size:
        return []
    sets, boxes = sets[on], Boxes(boxes.chart[on], *((a[on], b[on]) for a, b in (boxes.x, boxes.y)))
    flights = Chords(map, boxes)
    low, high = flights.arcs()
    if not map.closed:
        ends = [np.array([c.x[k] for c in map.charts])[boxes.chart] for k in (0, 1)]
        guessed = (low[1] == boxes.x[0]) | (high[1] == boxes.x[1])  # the start in the place of an end of the arc
        low[1][guessed & ((boxes.x[0] < ends[0]) | (boxes.x[1] > ends[1]))] = np.nan
    rows: Rows = []
    for some, chart, first, last, smooth in flights.pieces(low, high):
        if not some.size:
            continue
        image, met = _image(flights, sets[some], some, chart, hull(first, last), smooth)
        if not smooth:
            arc, told = flights.beyond(some, chart, first, last)
            longer = _image(flights, sets[some[told]], some[told], chart[told], arc[told], True)[0]
            image = image.replaced(np.flatnonzero(told), longer)
        rows.append((on[some[met]], image[met]))
    return rows


def _on_the_table(map: PinballImages, sets: Parallelograms) -> Boxes:
    """What the rectangle about each set has in common with phase space."""
    boxes = sets.boxes()
    sides = [np.array([getattr(c, side) for c in map.charts])[boxes.chart].T for side in ("x", "y")]
    x, y = (
        (np.maximum(low, ends[0] - ENDS), np.minimum(high, ends[1] + ENDS))
        for (low, high), ends in zip((boxes.x, boxes.y), sides, strict=True)
    )
    return Boxes(boxes.chart, boxes.x if map.closed else x, y)


def _image(
    flights: Chords, sets: Parallelograms, on: Indices, chart: Indices, arc: BallArray, smooth: bool
) -> tuple[Parallelograms, NDArray[np.bool_]]:
    """The image of sets whose landings lie in one arc of one component: as parallelograms where that arc is all.

    And which of them have one: where an arc is a part of what may be met, no landing in it may have such an angle.
    """
    map = flights.map
    known, low, high = flights.exits(on, chart, arc)
    none = known & (high < low)
    whole = Parallelograms.about(Boxes(chart, (arc.lower(), arc.upper()), (np.where(none, np.nan, low), high)))
    if not smooth:
        return whole, ~none
    derivative = matrix(flights.slopes(on, chart, arc))
    place = flights.midpoint(on, chart, arc)
    turn = turn_between(flights.tangent(on, flights.theta), map.place(chart, place)[2:4])
    landing = [place, map.exit(incidence(flights.phi[on] + turn), place)]
    middle, sides, rest = np.empty_like(sets.middle), np.empty_like(sets.sides), np.empty_like(sets.rest)
    aside = [np.abs(sets.middle[k] - (flights.theta, flights.phi)[k].m[on]) * OUTWARDS + sets.rest[k] for k in (0, 1)]
    for row, (value, entries) in enumerate(zip(landing, derivative, strict=True)):
        moved = [entries[0] * sets.sides[0, k] + entries[1] * sets.sides[1, k] for k in (0, 1)]
        middle[row] = value.m
        sides[row] = [m.m for m in moved]
        far = entries[0].magnitude() * aside[0] + entries[1].magnitude() * aside[1]
        rest[row] = (value.r + moved[0].r + moved[1].r + far) * OUTWARDS + PAD
    found = Parallelograms(chart, middle, sides, rest)
    better = (found.reach() <= whole.reach() * WIDER) & (found.reach(0.0, 1.0) < np.inf)
    pairs = (middle, whole.middle), (sides, whole.sides), (rest, whole.rest)
    kept = [np.asarray(np.where(better, a, b)) for a, b in pairs]
    return Parallelograms(chart, kept[0], kept[1], kept[2]), np.ones(on.size, dtype=bool)
