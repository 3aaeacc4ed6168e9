"""Does every orbit come to where stable curves meet an unstable manifold, unless they turn back before?

*Stable slopes.* Each cell of a wide region has a range of inverse slopes `q = dtheta/dphi`, with 0 in it, such that the
inverse of the derivative over a cell takes the ranges of the cells to which edges lead into its own; and none of
these directions is in an unstable cone. With an unstable vector such a vector spans what determinants shrink, at an
angle bounded from below: so it shrinks as long as the walk's determinants, over the growth of unstable vectors, do.

*Stable curves.* Let the map be one-to-one on the region, a compact set taken into its interior, and `x` a point of it.
The vertical line through the image of `x` under `m` bounces, within the image of the region, ends at images of border
points; taken back it is a curve through `x`, from border to border, with stable slopes. In the limit of large `m` it
is a curve along which all bounces contract: all its points have the same limit set.

*Where it turns back.* Taken back across a join where one chart keeps the order of points and the next turns it, the
curve has a corner there, up on one side and down on the other, and turns back wherever that corner is taken to: both
ends may lie on one border. So it is known to run on through a rectangle only up to the first preimage of such a join.

*Blocks.* Let a rectangle in the wide region hold all of the narrow one that lies over an interval, and let a curve
`G` in the unstable manifold of the saddle, or in its closure, cross it within the narrow region. A point of the narrow
region in the block, farther from both sides than the greatest `|q|` times the height, has a stable curve that meets
`G` before it leaves the block, unless it turns back before. If it meets `G`, the limit set of the point lies in the
closure of the unstable manifold. If no closed walk of cells avoids such inner parts of blocks, each orbit has
infinitely many such chances. That one of them is taken by every orbit is not proved.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics import walked
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.regions import derivatives
from verification.proofs.unstable_curves.anchor import Anchor
from verification.proofs.unstable_curves.cover import Cover
from verification.proofs.unstable_curves.spans import Course, Spans, longest

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
ROUNDS, WIDENED, CLOSER = 60, 0.05, 4
WIDTHS = 8, 16, 32, 64  # columns of a block
STEPS, KEPT = 60, 256  # bounces of the unstable manifold, and its parts that are followed


@dataclass(frozen=True)
class Attraction:
    """`covered` are the cells of the narrow region in inner parts of blocks; `proved`: no closed walk avoids them."""

    covered: Mask
    proved: bool


def attraction(narrow: Cover, wide: Cover, at: Anchor) -> Attraction:
    """Do all orbits of the narrow region come again and again to blocks that the saddle's unstable manifold crosses?"""
    count = narrow.cells.chart.size
    none = Attraction(np.zeros(count, dtype=bool), False)
    slopes = stable_slopes(wide)
    if slopes is None or not wide.contracts or narrow.grid != wide.grid:
        return none
    lean = wide.painted(np.maximum(np.abs(slopes[0]), np.abs(slopes[1])), np.inf)
    course, covered = Course(narrow), np.zeros(narrow.shape[:2], dtype=bool)
    first, chart, ends = np.zeros(1, dtype=np.int64), np.array([at.chart]), (np.array([at.bottom]), np.array([at.top]))
    spans = Spans(first, chart, np.array([at.low]), np.array([at.high]), ends, ends)
    blocks = list(_blocks(narrow, course, lean))
    for _ in range(STEPS):
        for block in blocks:
            on, low, high, begin, end = block
            if end > begin and not covered[on, begin:end].all() and spans.crossing(on, low, high).any():
                covered[on, begin:end] = True
        if not (spans := longest(course.step(spans), KEPT)).chart.size:
            break
    within = covered[narrow.cells.chart, narrow.cells.column]
    left = narrow.inner[~within][:, ~within]
    labels = connected_components(walked(left.tocsr()), directed=True, connection="strong")[1]
    closed = bool(np.any(left.diagonal())) or np.unique(labels).size < labels.size
    return Attraction(within, not closed)


def _blocks(narrow: Cover, course: Course, lean: Array) -> list[tuple[int, float, float, int, int]]:
    """Intervals over which the narrow region lies in a rectangle of the wide one; the columns of their inner parts."""
    found = []
    bottom, top = course.rows
    for chart, chart_of in enumerate(narrow.grid.charts):
        wide, start = narrow.sides[0][chart], chart_of.x[0]
        floor = chart_of.y[0]
        tall = narrow.sides[1][chart]
        for width in WIDTHS:
            for first in range(0, narrow.grid.columns - width + 1, width // 4):
                down, up = bottom[chart, first : first + width], top[chart, first : first + width]
                if not np.all(np.isfinite(down)):
                    continue
                rows = (round((y - floor) / tall) for y in (down.min(), up.max()))
                a, b = next(rows), next(rows)
                steepest = float(lean[chart, first : first + width, a:b].max())
                if not np.isfinite(steepest):
                    continue
                margin = int(np.ceil(steepest * (b - a + 1) * tall / wide + 1e-6))
                low = start + first * wide - 1e-11
                found.append((chart, low, low + width * wide + 2e-11, first + margin, first + width - margin))
    return found


def stable_slopes(cover: Cover) -> tuple[Array, Array] | None:
    """For each cell a range of `dtheta/dphi` that the inverse derivative keeps, away from unstable cones; or None."""
    source, chart, slopes = derivatives(cover.map, cover.grid, cover.cells, 1)
    (a, b), (c, d) = matrix(slopes)
    inner, cells = cover.inner, cover.cells
    count, charts = cells.chart.size, len(cover.map.charts)
    owner = np.repeat(np.arange(count), np.diff(inner.indptr)) * charts + cells.chart[inner.indices]
    low, high = np.zeros(count), np.zeros(count)

    def taken_back(low: Array, high: Array) -> tuple[Array, Array]:
        bottom, top = np.full(count * charts, np.inf), np.full(count * charts, -np.inf)
        np.minimum.at(bottom, owner, low[inner.indices])
        np.maximum.at(top, owner, high[inner.indices])
        key = source * charts + chart
        met = bottom[key] <= top[key]
        with np.errstate(all="ignore"):
            q = hull(bottom[key[met]], top[key[met]])
            new = (d[met] * q - b[met]) / (a[met] - c[met] * q)
        ends = np.full(count, np.inf), np.full(count, -np.inf)
        known = np.isfinite(new.r)
        np.minimum.at(ends[0], source[met], np.where(known, new.lower(), -np.inf))
        np.maximum.at(ends[1], source[met], np.where(known, new.upper(), np.inf))
        return ends

    for _ in range(ROUNDS):
        new = taken_back(low, high)
        if not np.all(np.isfinite(new[0]) & np.isfinite(new[1])):
            return None
        if np.all((low <= new[0]) & (new[1] <= high)):
            break
        more = (new[1] - new[0]) * WIDENED
        low, high = np.minimum(low, new[0] - more), np.maximum(high, new[1] + more)
    else:
        return None
    with np.errstate(all="ignore"):  # is no direction in both cones?
        apart = BallArray(1.0) - hull(low, high) * hull(*cover.cones)
    if not np.all(apart.positive()):
        return None
    for _ in range(CLOSER):
        new = taken_back(low, high)
        low, high = np.maximum(low, new[0]), np.minimum(high, new[1])
    return low, high
