"""Standard pairs of a trapping region: curves whose bounds of slope, bend and density the map preserves.

A label is a class of pieces of curves: those over one column of a grid that cross its middle in one row (`labels`).
Short segments with slopes near 0 are followed for some bounces through the boxes of the region; their images are given
labels. `pairs` finds all labels of later images, with cones that hold their slopes. Then it finds ranges for bends, the
second derivatives of `phi` by `theta`, and for `d = (log rho)'`, where `rho` is the density by `theta` (`curves`).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices, hull
from verification.proofs.starts.curves import CurveMap, Landed
from verification.proofs.starts.labels import Cast, Labels, Range, Spread, Targets, reduced
from verification.rigorous.boxes import Boxes, Images
from verification.rigorous.graph import Cells, Grid, ranges

ROUNDS, WIDER = 80, 0.01
LARGEST = 1e6  # the largest bends and logarithmic derivatives of densities
BOUNCES = 8  # before labels are given
TILT = 1e-6  # the largest slope of the first segments


class First(NamedTuple):
    """Images of short segments in a trapping region after some bounces, with ranges of bends and densities."""

    landed: Landed
    bend: BallArray
    density: BallArray


def first(map: CurveMap, grid: Grid, cells: Cells, bounces: int = BOUNCES) -> First:
    """The images of segments with small slopes in the boxes of a trapping region, after some bounces."""
    boxes, count = grid.boxes(cells), cells.chart.size
    names = grid.to_array(cells, np.arange(count), -1)
    zero = np.zeros(count)
    slopes, bends, density = hull(zero - TILT, zero + TILT), hull(zero, zero), hull(zero, zero)
    for bounce in range(bounces):
        landed = map.landed(boxes, slopes)
        on, k = landed.source, landed.k0 + landed.k1 * bends[landed.source]
        bend, dense = landed.bend + landed.by_bend * bends[on], (density[on] - k) / landed.stretch
        if not np.all([np.isfinite(x.r) for x in (*landed[3:], bend, dense)]):
            raise ValueError("segments may be folded before they are stretched; give finer boxes")
        if bounce == bounces - 1:
            break
        ends = ((end.lower(), end.upper()) for end in (landed.theta, landed.phi))
        places = Boxes(landed.chart, *ends)
        met = grid.met(Images.exact(places))
        wide = np.repeat(np.arange(on.size), met.right - met.left + 1)
        column = ranges(met.left, met.right + 1) % grid.columns
        entry = np.repeat(np.arange(wide.size), (met.top - met.bottom + 1)[wide])
        source = wide[entry]
        to = names.astype(np.int64)[landed.chart[source], column[entry], ranges(met.bottom[wide], met.top[wide] + 1)]
        if np.any(to < 0) or np.any(met.out):
            raise ValueError("the boxes are not proved to be a trapping region")
        slopes, bends, density = (pushed(x, source, to, count) for x in (landed.slope, bend, dense))
    return First(landed, bend, dense)


def pushed(value: BallArray, source: Indices, to: Indices, count: int) -> BallArray:
    """For each box the hull of the values at all boxes `source` from which an edge leads to it; 0 if there are none."""
    low = reduced(np.minimum, count, to, value.lower()[source])
    high = reduced(np.maximum, count, to, value.upper()[source])
    return hull(np.where(low > high, 0.0, low), np.where(low > high, 0.0, high))


def kept(start: Range, step: Callable[[Range], Range]) -> Range:
    """Ranges that hold `start` and that `step` maps into themselves; `ValueError` if they grow without end."""
    low, high = start
    for _ in range(5 * ROUNDS):
        more = (high - low) * WIDER / 5 + 1e-9
        wide = low - more, high + more
        new = step(wide)
        if np.all(new[0] >= wide[0]) and np.all(new[1] <= wide[1]):
            return wide
        low, high = np.minimum(low, new[0]), np.maximum(high, new[1])
        if not np.all((low > -LARGEST) & (high < LARGEST)):
            break
    raise ValueError("bends or densities of curves are not proved bounded: curves are not stretched often enough")


class Pairs(NamedTuple):
    """Labels and their images, edges from each label to those of its images, and a bound of `abs(d)` for each label.

    `spread` has the images in their order along the curves; `scattered` has those of broken labels, without an order.
    """

    labels: Labels
    cast: Cast
    spread: Spread
    scattered: Targets
    edges: tuple[Indices, Indices]
    density: Array


def pairs(map: CurveMap, grid: Grid, cells: Cells, columns: int, rows: int, parts: int = 4) -> Pairs:
    """Standard pairs to which segments in a trapping region are mapped; `ValueError` names what cannot be proved."""
    start, labels = first(map, grid, cells), Labels(map, columns, rows, parts)
    everything, charts = np.arange(start.landed.source.size), len(map.charts)
    none = np.full((charts, int(labels.columns.max())), np.inf)
    cast: Cast | None = None
    for _ in range(ROUNDS):
        count, base = labels.count, (labels.low, labels.top)
        hulls = none, -none
        if count:
            more = (labels.top - labels.low) * WIDER
            labels.low, labels.top = labels.low - more, labels.top + more
            hulls, cast = labels.hulls(), labels.cast()
        given = [(labels.scattered(start.landed, everything, everything, hulls), start.landed.slope.lower(),
                  start.landed.slope.upper())]  # fmt: skip
        if cast is not None:
            broken = np.flatnonzero(cast.broken[cast.label])
            spread = labels.spread(cast, hulls)
            scattered = labels.scattered(cast.landed, broken, cast.label[broken], hulls)
            given += [(targets, *cast.slopes) for targets in (spread.targets, scattered)]
        new = sum(labels.begun(targets) for targets, _, _ in given)
        edges, low, top = [], labels.low.copy(), labels.top.copy()
        low[:count], top[:count] = base
        for targets, least, most in given:
            entry, to = labels.named(targets)
            source = targets.source[entry]
            np.minimum.at(low, to, least[source])
            np.maximum.at(top, to, most[source])
            edges.append((source, to))
        if cast is not None and not new and np.all(low >= labels.low) and np.all(top <= labels.top):
            source, to = (np.concatenate([edge[i] for edge in edges[1:]]) for i in (0, 1))
            order = np.argsort(source, kind="stable")
            edge = source[order], to[order]
            return Pairs(labels, cast, spread, scattered, edge, densities(start, edges[0], cast, edge, labels.count))
        labels.low, labels.top = low, top
    raise ValueError("cones grow at each step and are not proved bounded; give finer cells")


def densities(
    start: First, begun: tuple[Indices, Indices], cast: Cast, edges: tuple[Indices, Indices], count: int
) -> Array:
    """Bounds of `abs((log rho)')` on the pieces of each label; the ranges of bends must have been computed before."""
    landed, own = cast.landed, cast.label

    def ends(value: BallArray, at: Indices, edge: tuple[Indices, Indices], size: int) -> Range:
        low = reduced(np.minimum, size, at, value.lower())[edge[0]]
        high = reduced(np.maximum, size, at, value.upper())[edge[0]]
        zero = np.zeros(count)
        np.minimum.at(zero, edge[1], low)
        other = np.zeros(count)
        np.maximum.at(other, edge[1], high)
        return zero, other

    def found(of_start: BallArray, image: Callable[[BallArray], BallArray]) -> Range:
        everything = np.arange(of_start.m.size)
        begin = ends(of_start, everything, begun, everything.size)
        return kept(begin, lambda some: ends(image(hull(*some)[own]), own, edges, count))

    bends = found(start.bend, lambda bend: landed.bend + landed.by_bend * bend)
    k = landed.k0 + landed.k1 * hull(*bends)[own]
    low, high = found(start.density, lambda density: (density - k) / landed.stretch)
    bound: Array = np.maximum(-low, high)
    return bound
