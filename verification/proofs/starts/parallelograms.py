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

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.chords import Chords

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
OUTWARDS = 1 + 2.0**-46  # more than the roundings of a sum of six doubles
PAD = 1e-300
WIDER = 1.5  # a parallelogram may be so much wider than the rectangle, for what it keeps of directions
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

    @classmethod
    def joined(cls, parts: Sequence["Parallelograms"]) -> "Parallelograms":
        """All sets of a list."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in FIELDS))

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


def carried(map: PinballImages, sets: Parallelograms) -> tuple[Indices, Parallelograms]:
    """Parallelograms about the images, and of which set each is one.

    Of a lost set no image is known: its image is lost. A set without an image holds no phase point of the table.
    """
    with np.errstate(all="ignore"):
        whole, again = sets.boxes(), np.zeros(sets.chart.size, dtype=bool)
        part = _on_the_table(map, whole)
        rows = _carried(map, sets, whole, np.flatnonzero(~((part.x[0] > part.x[1]) | (part.y[0] > part.y[1]))))
        for on, images in rows:
            again[on[~images.known]] = True
        again &= np.any([*part.x, *part.y] != np.array([*whole.x, *whole.y]), axis=0)
        rows = [(on[keep := ~again[on]], images[keep]) for on, images in rows]
        rows += _carried(map, sets, part, np.flatnonzero(again))
    source, images = np.concatenate([on for on, _ in rows]), Parallelograms.joined([images for _, images in rows])
    images.rest[:, ~images.known] = np.inf
    return source, images


Rows = list[tuple[Indices, "Parallelograms"]]


def _carried(map: PinballImages, sets: Parallelograms, boxes: Boxes, on: Indices) -> Rows:
    """The images of some sets, from rectangles about them.

    A set may go on past the end of its component, along the same formulas: its flights are those of a longer curve.
    """
    if not on.size:
        return [(on, sets[on])]
    sets, boxes = sets[on], Boxes(boxes.chart[on], *((a[on], b[on]) for a, b in (boxes.x, boxes.y)))
    flights = Chords(map, boxes)
    low, high = flights.arcs()
    if not map.closed:
        ends = map.inner[:, boxes.chart]
        guessed = (low[1] == boxes.x[0]) | (high[1] == boxes.x[1])  # the start in the place of an end of the arc
        low[1][guessed & ((boxes.x[0] < ends[0]) | (boxes.x[1] > ends[1]))] = np.nan
    rows: Rows = []
    for some, chart, first, last, smooth in flights.split(low, high):
        image, met = _image(flights, sets[some], some, chart, hull(first, last), smooth)
        if not smooth:
            arc, told = flights.beyond(some, chart, first, last)
            longer = _image(flights, sets[some[told]], some[told], chart[told], arc[told], True)[0]
            image = image.replaced(np.flatnonzero(told), longer)
        rows.append((on[some[met]], image[met]))
    return rows


def _on_the_table(map: PinballImages, boxes: Boxes) -> Boxes:
    """What rectangles have in common with phase space."""
    (left, right), (below, above), (first, last) = boxes.x, boxes.y, map.outer[:, boxes.chart]
    x = boxes.x if map.closed else (np.maximum(left, first), np.minimum(right, last))
    return Boxes(boxes.chart, x, (np.maximum(below, -map.top), np.minimum(above, map.top)))


def _image(
    flights: Chords, sets: Parallelograms, on: Indices, chart: Indices, arc: BallArray, smooth: bool
) -> tuple[Parallelograms, NDArray[np.bool_]]:
    """The image of sets whose landings lie in one arc of one component: as parallelograms where that arc is all.

    And which of them have one: where an arc is a part of what may be met, no landing in it may have such an angle.
    """
    known, low, high = flights.exits(on, chart, arc)
    none = known & (high < low)
    whole = Parallelograms.about(Boxes(chart, (arc.lower(), arc.upper()), (np.where(none, np.nan, low), high)))
    if not smooth:
        return whole, ~none
    derivative = matrix(slopes := flights.slopes(on, chart, arc))
    landing = flights.midpoints(on, chart, arc, slopes.bend_there)
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
