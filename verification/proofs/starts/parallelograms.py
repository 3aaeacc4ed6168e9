"""Enclosures of images of sets of phase points by parallelograms, which follow the rotation and shear of the map.

A rectangle around the image of a rectangle is larger than the image, and much too large after some bounces. A
*parallelogram* here is the set

    c + u*a + v*b + e,    |u| <= 1,  |v| <= 1,  |e_i| <= r_i,

with a midpoint `c`, two sides `a`, `b` and a remainder `r` (`rest` in the code). By the mean-value theorem about `c`
the map `F` takes the parallelogram into

    F(c) + D*(u*a + v*b + e)

with the derivative `D` over a rectangle around the set: the new sides are the midpoints of `D*a` and `D*b`, and the
radii of `D` and the rounding of `F(c)` are added to the remainder. Where landings lie on both sides of a join the map
is continuous but has a kink. There the image has one set for each component: the landings on the component continued
beyond the join by its formulas, which are a smooth function on the whole set, or else a rectangle around the landings
on the component.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.chords import ChordFlights
from verification.rigorous.boxes import Boxes

OUTWARDS = 1 + 2.0**-46  # above the rounding of a sum of six doubles
PAD = 1e-300
WIDER = 1.5  # the largest ratio of its width to a rectangle's at which a parallelogram is kept
FIELDS = "chart", "middle", "sides", "rest"


@dataclass(frozen=True)
class Parallelograms:
    """An array of parallelograms, as in the module docstring; the last axis counts the sets.

    `middle` and `rest` have the shape `(2, n)`, for `theta` and `phi`, and `sides` the shape `(2, 2, n)`, for the
    coordinate and the side. A lost set, of which nothing is proved, has an infinite `rest`.
    """

    chart: Indices
    middle: Array
    sides: Array
    rest: Array

    @classmethod
    def about(cls, boxes: Boxes) -> "Parallelograms":
        """The boxes as parallelograms."""
        ends = [hull(*boxes.x), hull(*boxes.y)]
        middle, half = (np.array([getattr(end, name) for end in ends]) for name in "mr")
        sides = np.zeros((2, 2, boxes.chart.size))
        sides[0, 0], sides[1, 1] = half
        return cls(boxes.chart, middle, sides, np.zeros_like(middle))

    @classmethod
    def joined(cls, parts: Sequence["Parallelograms"]) -> "Parallelograms":
        """The sets of all arrays in a list, as one array."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in FIELDS))

    def __getitem__(self, chosen: Mask | Indices) -> "Parallelograms":
        return Parallelograms(
            self.chart[chosen], self.middle[:, chosen], self.sides[:, :, chosen], self.rest[:, chosen]
        )

    @property
    def known(self) -> Mask:
        """A mask of the sets that are not lost."""
        finite = [np.isfinite(x) for x in (self.middle, self.sides.reshape(4, -1), self.rest)]
        return np.asarray(np.logical_and.reduce(np.concatenate(finite)))

    def replaced(self, at: Indices, others: "Parallelograms") -> "Parallelograms":
        """A copy in which sets at the indices `at` are replaced by `others` where these are narrower."""
        with np.errstate(invalid="ignore"):
            use = others.reach() < self.reach()[at] * WIDER
            use |= others.reach(0.0, 1.0) < self.reach(0.0, 1.0)[at] / WIDER
            use &= np.isfinite(others.reach() + others.reach(0.0, 1.0))
        fields = [getattr(self, name).copy() for name in FIELDS]
        for own, name in zip(fields, FIELDS, strict=True):
            own[..., at[use]] = getattr(others, name)[..., use]
        return Parallelograms(*fields)

    def reach(self, first: float | Array = 1.0, second: float | Array = 0.0) -> Array:
        """Largest deviation of `first*theta + second*phi` from its value at the midpoint, for each parallelogram."""
        along = np.abs(first * self.sides[0] + second * self.sides[1]).sum(axis=0)
        size = (np.abs(first) * np.abs(self.sides[0]) + np.abs(second) * np.abs(self.sides[1])).sum(axis=0)
        with np.errstate(invalid="ignore"):  # NaN marks a lost set, too
            rest = np.abs(first) * self.rest[0] + np.abs(second) * self.rest[1]
        return np.asarray((along + size * 2.0**-48 + rest) * OUTWARDS + PAD)

    def boxes(self) -> Boxes:
        """The smallest rectangle around each set, rounded outwards."""
        ends = []
        for middle, far in zip(self.middle, (self.reach(), self.reach(0.0, 1.0)), strict=True):
            slop = np.abs(middle) * 2.0**-51 + PAD
            ends.append((middle - far - slop, middle + far + slop))
        return Boxes(self.chart, ends[0], ends[1])


def push_forward(map: PinballImages, sets: Parallelograms) -> tuple[Indices, Parallelograms]:
    """Parallelograms that hold the images of sets, and for each of them the index of the mapped set.

    The image of a lost set is lost. A set without an image holds no phase point of the table.
    """
    with np.errstate(all="ignore"):
        whole, again = sets.boxes(), np.zeros(sets.chart.size, dtype=bool)
        part = _on_the_table(map, whole)
        rows = _push_forward(map, sets, whole, np.flatnonzero(~((part.x[0] > part.x[1]) | (part.y[0] > part.y[1]))))
        for on, images in rows:
            again[on[~images.known]] = True
        again &= np.any([*part.x, *part.y] != np.array([*whole.x, *whole.y]), axis=0)
        rows = [(on[keep := ~again[on]], images[keep]) for on, images in rows]
        rows += _push_forward(map, sets, part, np.flatnonzero(again))
    source, images = np.concatenate([on for on, _ in rows]), Parallelograms.joined([images for _, images in rows])
    images.rest[:, ~images.known] = np.inf
    return source, images


Rows = list[tuple[Indices, "Parallelograms"]]


def _push_forward(map: PinballImages, sets: Parallelograms, boxes: Boxes, on: Indices) -> Rows:
    """The images of the sets `on`, from rectangles around them; past a component's end, its formulas are continued."""
    if not on.size:
        return [(on, sets[on])]
    sets, boxes = sets[on], Boxes(boxes.chart[on], *((a[on], b[on]) for a, b in (boxes.x, boxes.y)))
    flights = ChordFlights(map, boxes)
    low, high = flights.arcs()
    if not map.closed:
        ends = map.inner[:, boxes.chart]
        guessed = (low[1] == boxes.x[0]) | (high[1] == boxes.x[1])  # the start itself is an end of the arc
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
    """The intersections of rectangles with phase space."""
    (left, right), (below, above), (first, last) = boxes.x, boxes.y, map.outer[:, boxes.chart]
    x = boxes.x if map.closed else (np.maximum(left, first), np.minimum(right, last))
    return Boxes(boxes.chart, x, (np.maximum(below, -map.top), np.minimum(above, map.top)))


def _image(
    flights: ChordFlights, sets: Parallelograms, on: Indices, chart: Indices, arc: BallArray, smooth: bool
) -> tuple[Parallelograms, Mask]:
    """The images of sets whose landings lie in one arc of one component, and a mask of the sets that have an image.

    Images are parallelograms if the arc holds all landings (`smooth`), else rectangles. Rectangles are cut off at the
    strip of phase space; a set has no image in the arc if nothing of its rectangle remains.
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
