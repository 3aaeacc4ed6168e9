"""Enclosures of unstable curves by their two ends, and of the images of such curves.

A *span* stands for every unstable curve in a region that lies over `low <= theta <= high` in one chart, with its two
ends in given ranges of height. The image of such a curve is again an unstable curve, from the image of one end to that
of the other. Where the image passes a join it is cut, and each part is represented by a span again. Since ends are
known only up to a box, the span is the interval that the curve certainly covers. Heights (values of `phi`) are
restricted to the cells of the region.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from numeric.backends import elementary
from verification.arithmetic.arrays import Array, Indices, Mask
from verification.proofs.unstable_curves.cover import ConeField
from verification.rigorous.boxes import Boxes

PAD = 1e-12  # above the rounding of places along the charts
WIDEST = 1e300


class Spans(NamedTuple):
    """An array of spans: for each its cell of `origin`, its chart, its ends in `theta`, and ranges of `phi` there."""

    origin: Indices
    chart: Indices
    low: Array
    high: Array
    first: tuple[Array, Array]
    last: tuple[Array, Array]

    def chosen(self, which: Indices | Mask) -> "Spans":
        """The spans selected by indices or a mask."""
        ends = ((bottom[which], top[which]) for bottom, top in (self.first, self.last))
        return Spans(self.origin[which], self.chart[which], self.low[which], self.high[which], *ends)

    def crossing(self, chart: int, low: float, high: float) -> Mask:
        """A mask of the spans that cover the whole interval from `low` to `high`."""
        found: Mask = (self.chart == chart) & (self.low <= low) & (self.high >= high)
        return found


@dataclass(frozen=True)
class SpanMap:
    """The map of spans; the charts are laid out in one row, one after another."""

    cover: ConeField

    @cached_property
    def starts(self) -> Array:
        """The positions in the row at which each chart begins, and the position at which the last one ends."""
        lengths = [chart.x[1] - chart.x[0] for chart in self.cover.grid.charts]
        return np.concatenate([[0.0], np.cumsum(lengths)])

    @cached_property
    def around(self) -> bool:
        """True if the last chart ends where the first one starts."""
        return (len(self.starts) - 2, 0) in self.cover.map.joins

    @cached_property
    def lows(self) -> Array:
        """The first parameter of each chart."""
        return np.array([chart.x[0] for chart in self.cover.grid.charts])

    @cached_property
    def slopes(self) -> tuple[float, float]:
        """The least and the greatest slope of the cones of all cells."""
        return float(self.cover.cones[0].min()), float(self.cover.cones[1].max())

    @cached_property
    def rows(self) -> tuple[Array, Array]:
        """The lowest and the highest `phi` of the region in each column of each chart; infinite in an empty one."""
        boxes = self.cover.grid.boxes(self.cover.cells)
        bottom = np.full(self.cover.shape[:2], np.inf)
        top = np.full(self.cover.shape[:2], -np.inf)
        at = self.cover.cells.chart, self.cover.cells.column
        np.minimum.at(bottom, at, boxes.y[0])
        np.maximum.at(top, at, boxes.y[1])
        return bottom, top

    def heights(self, chart: Indices, theta: Array) -> tuple[Array, Array]:
        """The range of `phi` of the region at parameters `theta`; very wide where the region has no cell."""
        width = self.cover.sides[0][chart]
        place = (theta - self.lows[chart]) / width
        last = self.cover.grid.columns - 1
        found = []
        for values, choose, none in zip(self.rows, (np.minimum, np.maximum), (-WIDEST, WIDEST), strict=True):
            sides = [values[chart, np.clip(np.floor(place + e).astype(int), 0, last)] for e in (-1e-6, 1e-6)]
            height = choose(*sides)
            found.append(np.where(np.isfinite(height), height, none))
        return found[0], found[1]

    def columns(self) -> Spans:
        """For each cell, a span for the curves that cross its column and whose left end lies in the cell."""
        boxes, chart = self.cover.grid.boxes(self.cover.cells), self.cover.cells.chart
        low, high = boxes.x[0] + PAD, boxes.x[1] - PAD
        ends = []
        for at in (low, high):
            run = at - boxes.x[0] + PAD
            ends.append(self._within(chart, at, boxes.y[0] + self._fall(run), boxes.y[1] + self._rise(run)))
        return Spans(np.arange(chart.size), chart, low, high, *ends)

    def _fall(self, run: Array) -> Array:
        return np.minimum(self.slopes[0] * run, 0.0) - PAD

    def _rise(self, run: Array) -> Array:
        return np.maximum(self.slopes[1] * run, 0.0) + PAD

    def _within(self, chart: Indices, theta: Array, low: Array, high: Array) -> tuple[Array, Array]:
        bottom, top = self.heights(chart, theta)
        found = np.maximum(low, bottom), np.minimum(high, top)
        empty = found[0] > found[1]  # no such curve: any range is correct
        return np.where(empty, bottom, found[0]), np.where(empty, top, found[1])

    def ends(self, spans: Spans, last: bool) -> tuple[Array, Array, Array, Array]:
        """The images of the first or the last ends of spans: low and high position in the row of charts, low and high
        `phi`.

        Entries are NaN where an image is not enclosed.
        """
        theta, (bottom, top) = (spans.high, spans.last) if last else (spans.low, spans.first)
        images = self.cover.map.images(Boxes(spans.chart, (theta, theta), (bottom, top)))
        count, turn = theta.size, self.starts[-1]
        source, boxes = images.source, images.boxes
        places = [self.starts[boxes.chart] + (x - self.lows[boxes.chart]) for x in boxes.x]
        base = np.full(count, np.nan)
        base[source] = places[0]
        if self.around:  # positions of two landings at one join must not differ by a turn
            shift = np.round((places[0] - base[source]) / turn) * turn
            places = [place - shift for place in places]
        low, high, down, up = (np.full(count, end) for end in (np.inf, -np.inf, np.inf, -np.inf))
        for into, values, choose in (
            (low, places[0], np.minimum),
            (high, places[1], np.maximum),
            (down, boxes.y[0], np.minimum),
            (up, boxes.y[1], np.maximum),
        ):
            choose.at(into, source, values)
        bad = ~np.isfinite(base)
        bad[images.lost] = True
        for some in (low, high, down, up):
            some[bad] = np.nan
        return low - PAD, high + PAD, down, up

    def step(self, spans: Spans) -> Spans:
        """The spans of the images of spans, split at joins; images without a proved span are omitted."""
        here, there = self.ends(spans, False), self.ends(spans, True)
        turned = np.array(self.cover.sign)[spans.chart] < 0
        left = [np.where(turned, b, a) for a, b in zip(here, there, strict=True)]
        right = [np.where(turned, a, b) for a, b in zip(here, there, strict=True)]
        turn = self.starts[-1]
        if self.around:  # a short curve does not go once around
            on = np.floor(left[1] / turn) * turn
            left[0], left[1] = left[0] - on, left[1] - on
            on = np.round(((right[0] + right[1]) / 2 - (left[0] + left[1]) / 2) / turn) * turn
            right[0], right[1] = right[0] - on, right[1] - on
            short = (spans.high - spans.low) * float(elementary.exp(np.array([self.cover.most.max()]))[0]) * (
                1 + 1e-9
            ) < turn / 2
            short &= (left[1] - left[0] < turn / 16) & (right[1] - right[0] < turn / 16)
        else:
            short = np.ones(turned.shape, dtype=bool)
        good = short & (right[0] - left[1] > 0) & np.isfinite(left[2]) & np.isfinite(right[2])
        return self._cut(spans.origin[good], [x[good] for x in left], [x[good] for x in right])

    def _cut(self, origin: Indices, left: list[Array], right: list[Array]) -> Spans:
        """The spans of curves between two enclosed ends, cut at the borders of charts."""
        run = left[1] - left[0], right[1] - right[0]
        low, high = left[1], right[0]
        down, up = left[2] + self._fall(run[0]), left[3] + self._rise(run[0])
        back = right[2] - self._rise(run[1]), right[3] - self._fall(run[1])
        found = list[Spans]()
        for turn in (0, 1) if self.around else (0,):
            for chart in range(len(self.starts) - 1):
                start, stop = (self.starts[i] + turn * self.starts[-1] for i in (chart, chart + 1))
                a, b = np.maximum(low, start) + PAD, np.minimum(high, stop) - PAD
                on = np.flatnonzero(b - a > 4 * PAD)
                a, b = a[on], b[on]
                where, ends = np.full(on.size, chart), list[tuple[Array, Array]]()
                for at in (a, b):
                    ahead, behind = at - low[on] + PAD, high[on] - at + PAD
                    bottom = np.maximum(down[on] + self._fall(ahead), back[0][on] - self._rise(behind))
                    top = np.minimum(up[on] + self._rise(ahead), back[1][on] - self._fall(behind))
                    ends.append(self._within(where, at - start + self.lows[chart], bottom, top))
                theta = [at - start + self.lows[chart] for at in (a, b)]
                found.append(Spans(origin[on], where, theta[0], theta[1], *ends))
        first, last = (
            (np.concatenate([end[0] for end in ends]), np.concatenate([end[1] for end in ends]))
            for ends in ([span.first for span in found], [span.last for span in found])
        )
        origin, where = (np.concatenate([span[i] for span in found]) for i in (0, 1))
        a, b = (np.concatenate([span[i] for span in found]) for i in (2, 3))
        return Spans(origin, where, a, b, first, last)


def longest(spans: Spans, kept: int) -> Spans:
    """The `kept` longest spans among those of each origin."""
    order = np.lexsort((spans.low - spans.high, spans.origin))
    origin = spans.origin[order]
    rank = np.arange(origin.size) - np.searchsorted(origin, origin)
    return spans.chosen(order[rank < kept])
