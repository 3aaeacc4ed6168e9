"""Barriers: closed curves around phase space that the map takes strictly below themselves.

On one smooth closed convex curve, with a law that is invertible, the map is a homeomorphism of the strip onto its
image. Its determinant is positive and it turns `theta` once around, so what is below a closed curve around the strip
goes below that curve's image. If it takes a closed curve `phi = height(theta)` below itself, then also *all* that lies
below: what is below the image is below the curve. So no orbit ever comes from below to above; only boxes along the
curve are mapped, and none of the area.

The curve is a staircase, one step to each column of a grid. It starts as `phi = 0`, and a step is raised as long as the
image of another one may reach it: what is found is the least staircase, or none. Where the map commutes with
the mirror image `(theta, phi) -> (-theta, -phi)`, the mirrored curve is a barrier from above, and what lies
between the two is a trapping region.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb
from numpy.typing import NDArray

from symbolic.tables.scene import Scene
from verification.cycles.systems import rotations
from verification.proofs.global_dynamics.boxes import Boxes, Images
from verification.proofs.global_dynamics.crisis import enters, grown, marked_cells
from verification.proofs.global_dynamics.graph import BLOCK, Cells, Grid, Mask
from verification.proofs.global_dynamics.images import PinballImages

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
ROUNDS = 200  # in which steps may be raised, first by points and then by boxes
ABOVE, THICK, BORDER = 1e-7, 1e-7, 1e-12  # radians above an image, half a piece's height, half a border's width
COLUMNS = 8192


@dataclass(frozen=True)
class Barrier:
    """The least staircase of `columns` steps above `phi = 0`, the same after each turn that keeps the table.

    It is a barrier for each contraction of the range `lam`; `heights` are None where none is proved.

    >>> found = Barrier(Scene("egg", alpha="0.05"), (Fraction(1, 2), Fraction(1, 2)), 256)
    >>> bool(found.below(point(1.0, 0.0))), bool(found.above(point(1.0, 0.5)))
    (True, True)
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    columns: int = COLUMNS

    @cached_property
    def map(self) -> PinballImages:
        """The map; `ValueError` unless it is proved to be a homeomorphism of the strip onto its image."""
        map = PinballImages(self.scene, self.lam)
        if not (map.closed and map.law is None and self.lam[0] > 0):
            raise ValueError(f"barrier: {map.label}; accepted: one smooth closed curve, the paper's law and lam > 0")
        return map

    @cached_property
    def turns(self) -> int:
        """How many turns keep the table."""
        return rotations(self.map.map.table)

    @property
    def mirrored(self) -> bool:
        """Is the reflection a symmetry of the map?"""
        return self.map.mirrored

    @cached_property
    def grid(self) -> Grid:
        """The columns, all around."""
        return Grid(self.map.charts, self.columns * self.turns, 1)

    @cached_property
    def heights(self) -> Array | None:
        """Of the steps of one turn's share. Once boxes have raised none, each piece's image is below the staircase."""
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
        """Each step `ABOVE` the images of those that changed and of borders beside them; None where one is lost."""
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
        """Boxes about the steps wanted, and about their left borders in pieces no higher than two columns are wide."""
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
        """The images of the middles of boxes, in float64."""
        step = self.map.map.step(sum(boxes.x) / 2, sum(boxes.y) / 2, boxes.chart)
        lost = np.flatnonzero(step.code != 0)
        found = Boxes(boxes.chart, (step.theta, step.theta), (step.phi, step.phi))
        return Images(np.arange(boxes.chart.size), found, lost)

    def below(self, boxes: Boxes) -> Mask:
        """Which boxes lie below the staircase as a whole, at a distance from it? None does where it is not proved."""
        return self._sides(boxes, np.minimum, np.inf, lambda height: boxes.y[1] < height)

    def above(self, boxes: Boxes) -> Mask:
        """Which boxes lie above it as a whole?"""
        return self._sides(boxes, np.maximum, -np.inf, lambda height: boxes.y[0] > height)

    def _sides(self, boxes: Boxes, end: np.ufunc, first: float, holds: Callable[[Array], Mask]) -> Mask:
        if self.heights is None:
            return np.zeros(boxes.chart.size, dtype=bool)
        met = self.grid.met(Images(np.arange(boxes.chart.size), boxes, np.zeros(0, dtype=np.int64)))
        height = np.full(boxes.chart.size, first)
        for step in range(int(np.max(met.right - met.left)) + 1):
            on = met.left + step <= met.right
            height[on] = end(height[on], self.heights[(met.left[on] + step) % self.columns])
        return holds(height)

    def between(self, boxes: Boxes) -> Mask:
        """Which boxes lie below it and above its mirror image? There is a trapping region in between."""
        return self.below(boxes) & self.below(boxes.mirrored()) & self.mirrored


def point(theta: float, phi: float) -> Boxes:
    """A phase point as a box."""
    x, y = np.array([theta]), np.array([phi])
    return Boxes(np.zeros(1, dtype=np.int64), (x, x), (y, y))


def lost(barrier: Barrier, high: Fraction, sink: tuple[float, float], start: float) -> dict[str, bool | None]:
    """That a barrier above `phi = 0` and below an attracting cycle is lost between its contraction and `high`.

    `taken` are boxes grown from near the cycle, trapping for each contraction from the barrier's to `high`. At the
    first the barrier lies below them, at `high` the orbit of `(start, 0)` enters them: no barrier is in between.
    Contractions with a barrier above `phi = 0` and below `taken` are an open set, so there is a first one without.
    That an attractor ends there does not follow: one may stay, with a basin that has lost the orbit from `(start, 0)`.
    """
    low, grid = barrier.lam[0], (1024, 512, 1)
    taken = grown(PinballImages(barrier.scene, (low, high)), grid, point(*sink))
    found: dict[str, bool | None] = dict.fromkeys(("barrier", "taken", "apart", "crossed"))
    if barrier.heights is None or taken is None:
        return found
    apart = bool(np.all(barrier.above(taken[0].boxes(marked_cells(taken[1])))))
    crossed = enters(barrier.scene, high, (arb(start), arb(0)), taken)
    return {"barrier": True, "taken": True, "apart": apart or None, "crossed": crossed or None}
