"""A rectangle around a saddle point in which every unstable curve that crosses it meets the saddle's stable set.

Let `Q` be the rectangle over an interval of `theta` that holds the part of the region there, and let `F` be the map of
a whole round of the saddle's cycle. In `(u, v) = (dtheta, dphi)` the derivative of `F` over `Q` has the rows `a, b` and
`c, d`, in balls; so `F(x) - F(y)` is such a matrix times `x - y` for `x`, `y` in `Q`. With a slope `s` above that of
all unstable curves, let

    |a| - s*|b| > 1,    |c|/s + |d| < 1,    |a|*r - |b|*h > w,

where the fixed points of `F` in `Q` are at least `r` and at most `w` away from both ends of the interval, and no point
of `Q` is more than `h` above or below them. By the first two `|c| + s*|d| < s < s*(|a| - s*|b|)`. Then:

- an interval Newton step gives exactly one fixed point `p` of `F` in `Q`;
- an unstable curve that crosses `Q` has an image under `F` that crosses `Q` (the last inequality, for an end of the
  curve and `p`: the ends leave `Q` on either side), so it holds a point `x` all of whose images under `F` are in `Q`;
- all images of `x - p` have `|u| <= |v|/s`, since otherwise `|u|` would grow without bound (by the first inequality and
  their consequence); so `|v|` shrinks (by the second), and `x` lies on the stable set of the cycle;
- images of the curve that cross `Q` converge to the piece of the unstable manifold `W^u(p)` that crosses `Q`: for a
  point of the image above a point of `W^u(p)`, the preimages in `Q` differ by `|u| <= |v|/s`, so differences shrink.

The last statement is the inclination lemma; here the map must be smooth only on the boxes of the cycle.
"""

from dataclasses import dataclass

import numpy as np

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.flights import Matrix, matrix
from verification.proofs.unstable_curves.cover import ConeField
from verification.proofs.unstable_curves.spans import SpanMap
from verification.rigorous.boxes import Boxes
from verification.rigorous.norms import times

CUTS = 6  # a box is cut into CUTS by CUTS parts before it is mapped


@dataclass(frozen=True)
class SaddleRectangle:
    """A rectangle around a saddle that holds the part of a region over `low <= theta <= high` in one chart."""

    chart: int
    low: float
    high: float
    bottom: float
    top: float


def anchor(cover: ConeField, point: tuple[int, float, float], period: int, half: float) -> SaddleRectangle | None:
    """The rectangle around an approximate point of a cycle, `half` wide on each side; None if it is not proved."""
    chart, theta, phi = point
    bottom, top = _span(cover, chart, theta - half, theta + half)
    if not bottom < phi < top:  # the interval Newton step needs a point of the rectangle
        return None
    box = (theta - half, theta + half), (bottom, top)
    whole = _followed(cover, chart, box, period)
    if whole is None or whole[0] != chart:
        return None
    fixed = _fixed(whole[2], (theta, phi), cover, chart, period)
    if fixed is None or not _inside(fixed, box) or not _held(cover, chart, fixed):
        return None
    low, high = float(fixed[0].lower()), float(fixed[0].upper())
    least, most = min(low - box[0][0], box[0][1] - high), max(high - box[0][0], box[0][1] - low)
    height = max(top - float(fixed[1].lower()), float(fixed[1].upper()) - bottom) * (1 + 1e-12)
    slopes = cover.steepest
    steep = max(abs(float(slopes[0][chart])), abs(float(slopes[1][chart])))
    proved = _hyperbolic(whole[2], _slope(whole[2], steep), least, most, height)
    return SaddleRectangle(chart, *box[0], bottom, top) if proved else None


def _span(cover: ConeField, chart: int, low: float, high: float) -> tuple[float, float]:
    """Range of `phi` of the region over an interval and one column beside each end; 0, 0 if these leave the chart."""
    wide = cover.sides[0][chart]
    start = cover.grid.charts[chart].x[0]
    first, last = (int(np.floor((x - start) / wide)) for x in (low, high))
    rows = SpanMap(cover).rows
    if first < 1 or last + 2 > cover.grid.columns:
        return 0.0, 0.0
    return float(rows[0][chart, first - 1 : last + 2].min()), float(rows[1][chart, first - 1 : last + 2].max())


Box = tuple[tuple[float, float], tuple[float, float]]


def _followed(cover: ConeField, chart: int, box: Box, period: int) -> tuple[int, Box, Matrix] | None:
    """The chart and image of a box after `period` bounces, and the derivative over the box; None if not proved."""
    product: Matrix = [[BallArray(1.0), BallArray(0.0)], [BallArray(0.0), BallArray(1.0)]]
    for _ in range(period):
        parts = Boxes.one(*box, chart=chart).parts(CUTS, CUTS)[0]
        images, found = cover.map.images(parts), cover.map.derivatives(parts)
        charts = np.unique(images.boxes.chart)
        if images.lost.size or charts.size != 1 or len(found) != 1 or found[0][0].on.size != parts.chart.size:
            return None
        entries = [[_hulled(x, parts.chart.size) for x in row] for row in matrix(found[0][1])]
        if not all(np.isfinite(x.r) for row in entries for x in row):
            return None
        product = times(entries, product)
        chart = int(charts[0])
        ends = [(float(low.min()), float(high.max())) for low, high in (images.boxes.x, images.boxes.y)]
        box = ends[0], ends[1]
    return chart, box, product


def _hulled(some: BallArray, count: int) -> BallArray:
    """One ball that holds all balls of an array."""
    low, high = (np.broadcast_to(end, count) for end in (some.lower(), some.upper()))
    return hull(float(low.min()), float(high.max()))


def _fixed(
    whole: Matrix, guess: tuple[float, float], cover: ConeField, chart: int, period: int
) -> tuple[BallArray, BallArray] | None:
    """The interval Newton image for `F(x) = x` over the rectangle, which holds all fixed points in it; or None."""
    at = _followed(cover, chart, ((guess[0], guess[0]), (guess[1], guess[1])), period)
    if at is None or at[0] != chart:
        return None
    gap = [hull(*ends) - BallArray(x) for ends, x in zip(at[1], guess, strict=True)]
    (a, b), (c, d) = [[x - (1.0 if i == j else 0.0) for j, x in enumerate(row)] for i, row in enumerate(whole)]
    size = a * d - b * c
    if not (size.positive() or size.negative()):
        return None
    return BallArray(guess[0]) - (d * gap[0] - b * gap[1]) / size, BallArray(guess[1]) - (
        a * gap[1] - c * gap[0]
    ) / size


def _inside(fixed: tuple[BallArray, BallArray], box: Box) -> bool:
    """True if the balls lie in the interior of the box."""
    return all(a < x.lower() and x.upper() < b for x, (a, b) in zip(fixed, box, strict=True))


def _held(cover: ConeField, chart: int, fixed: tuple[BallArray, BallArray]) -> bool:
    """True if the cells of the region cover the given balls."""
    member = cover.to_array(np.ones(cover.cells.chart.size), 0.0)[chart]
    spans = []
    for x, ends, count in zip(fixed, ("x", "y"), (cover.grid.columns, cover.grid.rows), strict=True):
        low, high = getattr(cover.grid.charts[chart], ends)
        cells = [(float(end) - low) / (high - low) * count for end in (x.lower(), x.upper())]
        spans.append(slice(max(0, int(np.floor(cells[0] - 1e-6))), int(np.floor(cells[1] + 1e-6)) + 1))
    return bool(np.all(member[spans[0], spans[1]] > 0))


def _slope(entries: Matrix, steep: float) -> float:
    """A slope `s` midway between the bounds set by the first two inequalities and by the slopes of unstable curves."""
    b, c, d = (float(x.magnitude()) for x in (entries[0][1], *entries[1]))
    first = entries[0][0]
    low = max(steep * (1 + 1e-9), c / (1 - d)) if d < 1 else np.inf
    return (low + max(low, (abs(float(first.m)) - float(first.r) - 1) / max(b, 1e-300))) / 2


def _hyperbolic(entries: Matrix, s: float, least: float, most: float, height: float) -> bool:
    """True if the three inequalities of the module docstring hold."""
    b, c, d = (float(x.magnitude()) for x in (entries[0][1], *entries[1]))
    first = entries[0][0]
    low = (abs(float(first.m)) - float(first.r)) * (1 - 1e-12)
    grown = low - s * b * (1 + 1e-12)
    return bool(grown > 1 and (c / s + d) * (1 + 1e-12) < 1 and low * least - b * height > most * (1 + 1e-9))
