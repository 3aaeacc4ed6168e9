"""Pieces of unstable curves, labelled by cells of a grid, and the labels of their images.

Each chart is cut into columns, and each column into rows. A piece of a curve is the part of the curve over one column,
and its label is the row in which the piece crosses the middle of the column; a piece that ends before the middle is
continued along its tangent. Each label has a range of slopes, its cone, which holds all slopes of its pieces, so the
pieces lie in a sheared cell. Enclosures of the image of the middle, of the stretching and of the slopes of images
determine which columns an image meets, and where it crosses their middles; an image is continued to the middle by
slopes of its own cone or of those of the column. A label is `broken` if its curves may land on a join, or if the image
of the middle is not enclosed; then only the landings of its images are known.

`standard_pairs.pairs` finds labels and cones, starting with images of segments: the slopes of images of a label lie in
the cones of all labels that the images may have. Then `pairs` finds the ranges of bends and densities.
"""

from typing import NamedTuple

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull
from verification.proofs.starts.curves import CurveMap, Landed
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import BLOCK, ranges

Range = tuple[Array, Array]
PAD, SLOP = 1e-7, 1e-12  # in cells; in landings: both above the rounding of float64
MOST = 1 << 19  # the most labels


class Targets(NamedTuple):
    """For each source, and each column that its images may meet: the range of rows that they may meet there."""

    source: Indices
    chart: Indices
    column: Indices
    bottom: Indices
    top: Indices


class Cast(NamedTuple):
    """Images of all labels: rows of `landed`, each with its label and the index of the mapped part of the column."""

    landed: Landed
    label: Indices
    part: Indices
    middle: Landed
    broken: Mask
    rising: Mask
    least: Array
    most: Array
    slopes: Range


class Spread(NamedTuple):
    """The columns that images of unbroken labels meet, in order along each image.

    `leaves` are the earliest and the latest position, from 0 to 1 along the source, at which the image leaves each
    column; `last` marks the last column of a label.
    """

    targets: Targets
    leaves: Range
    last: Mask


def reduced(how: np.ufunc, size: int, at: Indices, values: Array) -> Array:
    """The least (`np.minimum`) or greatest (`np.maximum`) of the `values` at each index below `size`."""
    found = np.full(size, np.inf if how is np.minimum else -np.inf)
    how.at(found, at, values)
    return found


def image_labels(map: CurveMap, boxes: Boxes, slopes: BallArray) -> Landed:
    """The enclosed images of curves in these boxes, computed for a block of boxes at a time."""
    rows = []
    for start in range(0, boxes.chart.size, BLOCK):
        some = slice(start, start + BLOCK)
        landed = map.landed(boxes.chosen(some), slopes[some])
        rows.append(landed._replace(source=landed.source + start))
    source, chart = (np.concatenate([row[i] for row in rows]) for i in (0, 1))
    smooth = np.concatenate([row.smooth for row in rows])
    halves = [[np.concatenate([getattr(row[i], half) for row in rows]) for half in "mr"] for i in range(3, 11)]
    return Landed(source, chart, smooth, *(BallArray(m, r) for m, r in halves))


class Labels:
    """The labels in use, with their cones, and the ranges of bends and densities of their pieces."""

    def __init__(self, map: CurveMap, columns: int, rows: int, parts: int = 4) -> None:
        if parts % 2:
            raise ValueError(f"parts = {parts} is odd, so no parts meet in the middle of a column; give an even number")
        self.map, self.rows, self.parts = map, rows, parts
        size = np.array([chart.x[1] - chart.x[0] for chart in map.charts])
        self.columns = np.maximum(np.ceil(columns * size / size.max()).astype(int), 4)
        self.left, self.bottom = (np.array([getattr(c, s)[0] for c in map.charts]) for s in ("x", "y"))
        self.wide = size / self.columns
        self.high = np.array([c.y[1] - c.y[0] for c in map.charts]) / rows
        self.kept = np.array([c.kept for c in map.charts])
        self.shape = size.size, int(self.columns.max()), rows
        self.known, self.number = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)  # sorted cell numbers
        self.chart, self.column, self.row = (np.zeros(0, dtype=np.int64) for _ in range(3))
        self.low, self.top = np.zeros(0), np.zeros(0)

    @property
    def count(self) -> int:
        return int(self.chart.size)

    def add(self, chart: Indices, column: Indices, row: Indices) -> int:
        """Adds labels at the given cells, and returns the number of new ones."""
        flat = np.unique(np.ravel_multi_index((chart, column, row), self.shape))
        flat = np.setdiff1d(flat, self.known, assume_unique=True)
        if self.count + flat.size > MOST:
            raise ValueError(f"more than {MOST} labels; give fewer columns or rows")
        known = np.append(self.known, flat)
        number = np.append(self.number, self.count + np.arange(flat.size))
        order = np.argsort(known)
        self.known, self.number = known[order], number[order]
        for name, new in zip(("chart", "column", "row"), np.unravel_index(flat, self.shape), strict=True):
            setattr(self, name, np.append(getattr(self, name), new))
        none = np.full(flat.size, np.inf)
        self.low, self.top = np.append(self.low, none), np.append(self.top, -none)
        return int(flat.size)

    def middles(self, chart: Indices, column: Indices) -> Array:
        found: Array = self.left[chart] + (column + 0.5) * self.wide[chart]
        return found

    def cells(self) -> tuple[Boxes, Indices, Indices]:
        """The sheared cells, cut into parts along the column, with the label and the index of each part."""
        label = np.repeat(np.arange(self.count), self.parts)
        part = np.tile(np.arange(self.parts), self.count)
        chart, ends, sides = self.chart[label], [], []
        for share in (part / self.parts, (part + 1) / self.parts):
            ends.append(self.left[chart] + (self.column[label] + share) * self.wide[chart])
            sides += [cone[label] * (share - 0.5) * self.wide[chart] for cone in (self.low, self.top)]
        foot, shift = self.bottom[chart] + self.row[label] * self.high[chart], np.stack(sides)
        slop = 1e-15 * (np.abs(ends[0]) + np.abs(ends[1]))
        y = foot + shift.min(0) - SLOP, foot + self.high[chart] + shift.max(0) + SLOP
        return Boxes(chart, (ends[0] - slop, ends[1] + slop), y), label, part

    def cast(self) -> Cast:
        """The images of all labels; `ValueError` where a stretching is not bounded away from 0, or changes sign."""
        boxes, label, part = self.cells()
        landed = image_labels(self.map, boxes, hull(self.low, self.top)[label])
        own, count = label[landed.source], self.count
        r = landed.stretch
        known = [np.isfinite(x.r) for x in landed[3:]]
        if not np.all(known) or not np.all(r.positive() | r.negative()):
            raise ValueError("a curve's stretching is not bounded away from 0: cells too coarse, or no cone exists")
        x, foot = self.middles(self.chart, self.column), self.bottom[self.chart] + self.row * self.high[self.chart]
        line = Boxes(self.chart, (x - 1e-15, x + 1e-15), (foot - SLOP, foot + self.high[self.chart] + SLOP))
        middle = image_labels(self.map, line, BallArray(np.zeros(count)))
        broken = np.bincount(middle.source, minlength=count) != 1
        lost = ~(np.isfinite(middle.theta.r) & np.isfinite(middle.phi.r))  # NaN differs between processors
        broken[middle.source[~middle.smooth | lost]] = True
        broken[own[~landed.smooth]] = True
        broken[label[np.bincount(landed.source, minlength=label.size) != 1]] = True
        charts = [reduced(how, count, own, landed.chart.astype(float)) for how in (np.minimum, np.maximum)]
        broken |= charts[0] != charts[1]
        up, down = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        up[own[r.m > 0]] = True
        down[own[r.m < 0]] = True
        if np.any(up & down):
            raise ValueError("the map may keep or reverse the direction of curves of one label; give finer cells")
        size = np.abs(r.m)
        least = reduced(np.minimum, count, own, (size - r.r) * (1 - 1e-14))
        most = reduced(np.maximum, count, own, (size + r.r) * (1 + 1e-14))
        slopes = (
            reduced(np.minimum, count, own, landed.slope.lower()),
            reduced(np.maximum, count, own, landed.slope.upper()),
        )
        return Cast(landed, own, part[landed.source], middle, broken, up, least, most, slopes)

    def hulls(self) -> Range:
        """The hull of all cones in each column."""
        found = []
        for how, cone in ((np.minimum, self.low), (np.maximum, self.top)):
            whole = np.full(self.shape[:2], np.inf if how is np.minimum else -np.inf)
            how.at(whole, (self.chart, self.column), cone)
            found.append(whole)
        return found[0], found[1]

    def across(self, chart: Indices, theta: Range) -> tuple[Indices, Indices, Indices]:
        """All columns in which landings may lie, as landing, chart and column, counted on after a full turn."""
        first, last = ((end - self.left[chart]) / self.wide[chart] for end in theta)
        low, high = np.floor(first - PAD).astype(np.int64), np.floor(last + PAD).astype(np.int64)
        if not self.map.closed:
            low, high = (np.clip(end, 0, self.columns[chart] - 1) for end in (low, high))
        source = np.repeat(np.arange(chart.size), high - low + 1)
        return source, chart[source], ranges(low, high + 1)

    def crossed(
        self, source: Indices, chart: Indices, column: Indices, phi: Range, way: Range, slopes: Range, hulls: Range
    ) -> Targets:
        """Rows in which curves cross the middles of columns, from their `phi` at the distances `way` from there."""
        column = column % self.columns[chart]
        low = np.minimum(hulls[0][chart, column], slopes[0])
        high = np.maximum(hulls[1][chart, column], slopes[1])
        mean, half = (low + high) / 2, (high - low) / 2 * (1 + SLOP)
        far = np.maximum(np.abs(way[0]), np.abs(way[1])) + self.wide[chart]
        shift = np.stack([mean * way[0], mean * way[1]])
        ends = phi[0] + shift.min(0) - half * far - SLOP, phi[1] + shift.max(0) + half * far + SLOP
        foot, head = ((end - self.bottom[chart]) / self.high[chart] for end in ends)
        bottom, top = np.floor(foot - PAD).astype(np.int64), np.floor(head + PAD).astype(np.int64)
        if np.any((bottom < 0) | (top >= self.rows)):
            raise ValueError("a curve may leave its chart, as the region comes too near to the border of the chart")
        return Targets(source, chart, column, bottom, top)

    def cut_off(self, chart: Indices, phi: BallArray) -> Range:
        """Ranges of exit angles, cut off at the ends of charts that the map stays in."""
        low, high = self.bottom[chart], self.bottom[chart] + self.rows * self.high[chart]
        kept = self.kept[chart]
        return (
            np.where(kept, np.maximum(phi.lower(), low), phi.lower()),
            np.where(kept, np.minimum(phi.upper(), high), phi.upper()),
        )

    def scattered(self, landed: Landed, which: Indices, source: Indices, hulls: Range) -> Targets:
        """The labels of images for which only the landings are known."""
        chart, phi = landed.chart[which], self.cut_off(landed.chart[which], landed.phi[which])
        row, charts, column = self.across(chart, (landed.theta.lower()[which], landed.theta.upper()[which]))
        half, slopes = self.wide[charts] / 2 * (1 + PAD), landed.slope[which]
        return self.crossed(
            source[row], charts, column, (phi[0][row], phi[1][row]), (-half, half),
            (slopes.lower()[row], slopes.upper()[row]), hulls,
        )  # fmt: skip

    def spread(self, cast: Cast, hulls: Range) -> Spread:
        """The columns that the images of unbroken labels meet, in order along each image."""
        whole = np.flatnonzero(~cast.broken)
        order = np.zeros((self.count, self.parts), dtype=np.int64)
        order[cast.label, cast.part] = np.arange(cast.label.size)
        r = cast.landed.stretch
        size, turned = np.abs(r.m)[order[whole]], ~cast.rising[whole]
        slow, fast = (size - r.r[order[whole]]) * (1 - 1e-14), (size + r.r[order[whole]]) * (1 + 1e-14)
        slow, fast = (np.where(turned[:, None], rate[:, ::-1], rate) for rate in (slow, fast))
        ways = []
        for rate in (slow, fast):
            way = np.concatenate([np.zeros((whole.size, 1)), np.cumsum(rate, 1)], 1)
            ways.append((way - way[:, [self.parts // 2]]) * (self.wide[self.chart[whole]] / self.parts)[:, None])
        at = np.zeros(self.count, dtype=np.int64)
        at[cast.middle.source] = np.arange(cast.middle.source.size)
        at = at[whole]
        chart = cast.middle.chart[at]
        centre = cast.middle.theta.lower()[at], cast.middle.theta.upper()[at]
        phi = self.cut_off(chart, cast.middle.phi[at])
        early = centre[0][:, None] + np.minimum(*ways) - SLOP
        late = centre[1][:, None] + np.maximum(*ways) + SLOP
        row, charts, column = self.across(chart, (early[:, 0], late[:, -1]))
        there = self.left[charts] + (column + 0.5) * self.wide[charts]
        targets = self.crossed(
            whole[row], charts, column, (phi[0][row], phi[1][row]), (there - centre[1][row], there - centre[0][row]),
            (cast.slopes[0][whole][row], cast.slopes[1][whole][row]), hulls,
        )  # fmt: skip
        border = self.left[charts] + (column + 1) * self.wide[charts]
        leaves = []
        for nodes in (late, early):
            share = np.zeros(row.size)
            for k in range(self.parts):
                low, high = nodes[row, k], nodes[row, k + 1]
                share += np.clip((border - low) / (high - low), 0, 1) / self.parts
            leaves.append(share)
        last = np.append(row[1:] != row[:-1], np.ones(min(1, row.size), dtype=bool))
        return Spread(targets, (leaves[0] - SLOP, leaves[1] + SLOP), last)

    def named(self, targets: Targets) -> tuple[Indices, Indices]:
        """Pairs of a target's index and a label in the target; the label is -1 for a cell that is not in use."""
        entry = np.repeat(np.arange(targets.source.size), targets.top - targets.bottom + 1)
        row = ranges(targets.bottom, targets.top + 1)
        cell = np.ravel_multi_index((targets.chart[entry], targets.column[entry], row), self.shape)
        at = np.minimum(np.searchsorted(self.known, cell), max(0, self.count - 1))
        return entry, np.where(self.known[at] == cell, self.number[at], -1)

    def begun(self, targets: Targets) -> int:
        entry = np.repeat(np.arange(targets.source.size), targets.top - targets.bottom + 1)
        return self.add(targets.chart[entry], targets.column[entry], ranges(targets.bottom, targets.top + 1))
