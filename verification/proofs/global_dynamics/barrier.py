"""Barriers: closed curves around phase space that the map takes strictly below themselves.

On a smooth closed convex curve with an invertible law the map is a homeomorphism of the strip `|phi| <= lam*pi/2` onto
its image. It preserves orientation and has degree 1 in `theta`, so points below a closed curve around the strip go
below the image of the curve. If the map takes the curve `phi = height(theta)` below itself, then points below the curve
stay below it for ever. So the proof needs only the images of boxes along the curve.

The curve is a staircase with one step to each column of a grid. It starts as `phi = 0`, and a step is raised as long as
the image of another step may reach it; the result is the least such staircase, or a failure. If the map commutes with
the mirror image `(theta, phi) -> (-theta, -phi)`, the mirrored curve is a barrier from above, and the region between
the two curves is trapping.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import Array, Mask
from verification.cycles.systems import rotations
from verification.proofs.global_dynamics.crisis import enters
from verification.proofs.global_dynamics.images import PinballImages
from verification.rigorous.absorbing import AbsorbingSet, grown
from verification.rigorous.boxes import Boxes, Images
from verification.rigorous.graph import BLOCK, Cells, Grid
from verification.rigorous.theorem import Theorem, hypothesis

ROUNDS = 200  # the most rounds in which steps are raised, by sample points and then by boxes
ABOVE, THICK, BORDER = 1e-7, 1e-7, 1e-12  # radians: margin of a step, half a box's height, half a border's width
COLUMNS = 8192


@dataclass(frozen=True)
class Barrier:
    """The least staircase above `phi = 0`, with `columns` steps in the part of the boundary that rotations repeat.

    It is a barrier for every contraction in the range `lam`; `heights` is None if no barrier is proved.

    >>> found = Barrier(Scene("egg", alpha="0.05"), (Fraction(1, 2), Fraction(1, 2)), 256)
    >>> bool(found.below(point(1.0, 0.0))), bool(found.above(point(1.0, 0.5)))
    (True, True)
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    columns: int = COLUMNS

    @cached_property
    def map(self) -> PinballImages:
        """The map on boxes; `ValueError` unless it is proved to be a homeomorphism of the strip onto its image."""
        map = PinballImages(self.scene, self.lam)
        if not (map.closed and map.law is None and self.lam[0] > 0):
            raise ValueError(
                f"barrier: {map.label} does not fit; accepted: one smooth closed curve, the paper's law, lam > 0"
            )
        return map

    @cached_property
    def turns(self) -> int:
        """The order of the table's rotation symmetry."""
        return rotations(self.map.map.table)

    @property
    def mirrored(self) -> bool:
        """True if the map commutes with `(theta, phi) -> (-theta, -phi)`."""
        return self.map.mirrored

    @cached_property
    def grid(self) -> Grid:
        """The columns around the whole boundary, as a grid with one row."""
        return Grid(self.map.charts, self.columns * self.turns, 1)

    @cached_property
    def heights(self) -> Array | None:
        """The heights of the `columns` steps; None where no barrier is proved."""
        heights = np.zeros(self.columns)
        for proved in (False, True):
            changed = np.ones(self.columns, dtype=bool)
            for _ in range(ROUNDS):
                raised = self._raised(heights, changed, proved)
                if raised is None or np.max(raised) >= self.map.top:
                    return None
                changed, heights = raised > heights, raised
                if not changed.any():
                    break
            else:
                return None
        return heights

    def _raised(self, heights: Array, changed: Mask, proved: bool) -> Array | None:
        """The staircase, raised to at least `ABOVE` over the images of `changed` steps; None if one is not enclosed."""
        boxes, raised = self._pieces(heights, changed | np.roll(changed, 1)), heights.copy()
        for start in range(0, boxes.chart.size, BLOCK):
            some = boxes.chosen(slice(start, start + BLOCK))
            images = self.map.images(some) if proved else self._sampled(some)
            met, top = self.grid.met(images), images.boxes.y[1] + ABOVE
            if images.lost.size:
                return None
            for step in range(int(np.max(met.right - met.left)) + 1):
                on = met.left + step <= met.right
                np.maximum.at(raised, (met.left[on] + step) % self.columns, top[on])
        return raised

    def _pieces(self, heights: Array, wanted: Mask) -> Boxes:
        """Boxes around the steps `wanted` and the vertical borders at their left, at most two column widths high."""
        column = np.flatnonzero(wanted)
        zero, one = np.zeros_like(column), np.ones_like(column)
        left, right = self.grid.boxes(Cells(zero, column, zero, one)).x
        ends = heights[column], np.roll(heights, 1)[column]
        low, high = np.minimum(*ends), np.maximum(*ends)
        cuts = np.maximum(1, np.ceil((high - low) / (2 * (right - left)))).astype(np.int64)
        own = np.repeat(np.arange(column.size), cuts)
        each = ((high - low) / cuts)[own]
        bottom = low[own] + (np.arange(own.size) - np.repeat(np.cumsum(cuts) - cuts, cuts)) * each
        x = np.append(left, left[own] - BORDER), np.append(right, left[own] + BORDER)
        y = np.append(ends[0], bottom) - THICK, np.append(ends[0], bottom + each) + THICK
        return Boxes(np.zeros(x[0].size, dtype=np.int64), x, y)

    def _sampled(self, boxes: Boxes) -> Images:
        """The images of the midpoints of boxes, in float64."""
        step = self.map.map.step(sum(boxes.x) / 2, sum(boxes.y) / 2, boxes.chart)
        lost = np.flatnonzero(step.code != 0)
        found = Boxes(boxes.chart, (step.theta, step.theta), (step.phi, step.phi))
        return Images(np.arange(boxes.chart.size), found, lost)

    def below(self, boxes: Boxes) -> Mask:
        """A mask of the boxes that are proved to lie strictly below the staircase."""
        return self._sides(boxes, np.minimum, np.inf, lambda height: boxes.y[1] < height)

    def above(self, boxes: Boxes) -> Mask:
        """A mask of the boxes that are proved to lie strictly above the staircase."""
        return self._sides(boxes, np.maximum, -np.inf, lambda height: boxes.y[0] > height)

    def _sides(self, boxes: Boxes, end: np.ufunc, first: float, holds: Callable[[Array], Mask]) -> Mask:
        if self.heights is None:
            return np.zeros(boxes.chart.size, dtype=bool)
        met = self.grid.met(Images.exact(boxes))
        height = np.full(boxes.chart.size, first)
        for step in range(int(np.max(met.right - met.left)) + 1):
            on = met.left + step <= met.right
            height[on] = end(height[on], self.heights[(met.left[on] + step) % self.columns])
        return holds(height)

    def between(self, boxes: Boxes) -> Mask:
        """Mask of the boxes proved to lie in the trapping region below the staircase and above its mirror image."""
        return self.below(boxes) & self.below(boxes.mirrored()) & self.mirrored


def point(theta: float, phi: float) -> Boxes:
    """A phase point as an array of one box."""
    return Boxes.one((theta, theta), (phi, phi))


@dataclass(frozen=True)
class BarrierBreaks(Theorem):
    """Between two contractions the last barrier above `phi = 0` and below an attracting cycle breaks.

    The two contractions are that of the barrier and `high`. Boxes grown from `sink`, a point `(theta, phi)` near the
    cycle, are trapping for each contraction in between; at `high` the orbit of `(start, 0)` enters them. The
    contractions with a barrier above `phi = 0` and below these boxes are an open set, so there is a first contraction
    without one. It does not follow that an attractor ends there: it may persist, with a basin that has lost the orbit
    from `(start, 0)`.
    """

    barrier: Barrier
    high: Fraction
    sink: tuple[float, float]
    start: float

    @cached_property
    def boxes(self) -> AbsorbingSet | None:
        """The trapping boxes around the cycle, or None."""
        map = PinballImages(self.barrier.scene, (self.barrier.lam[0], self.high))
        return grown(map, (1024, 512, 1), point(*self.sink))

    @hypothesis(name="barrier")
    def barrier_holds(self) -> bool:
        """There is a barrier at the lower contraction."""
        return self.barrier.heights is not None

    @hypothesis
    def trapping(self) -> bool:
        """The boxes around the cycle are trapping for each contraction of the range."""
        return self.boxes is not None

    @hypothesis
    def apart(self) -> bool:
        """At the lower contraction the boxes around the cycle lie above the barrier."""
        return self.boxes is not None and bool(np.all(self.barrier.above(self.boxes.boxes)))

    @hypothesis
    def crossed(self) -> bool:
        """At the contraction `high` the orbit of `(start, 0)` enters the boxes around the cycle."""
        origin = arb(self.start), arb(0)
        return self.boxes is not None and enters(self.barrier.scene, self.high, origin, self.boxes)
