"""A lower bound for the larger exponent of every orbit in a set of boxes, by cones and the least mean over walks.

Each box has a range of slopes `dphi/dtheta`, its cone. If over each box the derivative takes the cone into those of all
boxes where the image may lie, then vectors of the cones stay in them along every orbit. In the length `|dtheta|` each
box has a least factor by which they grow, so over `n` bounces the logarithm grows by at least the least sum over all
walks of `n` steps, and over any number of bounces by that mean per bounce. One bounce may shrink vectors as long as no
long walk does. The boundary parameter takes the place of arc length: that multiplies lengths by bounded factors, which
no mean over a long time sees.

With `p = bend0 - slope0` the derivative takes a slope to `-lam*(bend1 - p/(by_theta + by_phi*slope0))`, the mirror
equation of this law.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from verification.proofs.global_dynamics.arrays import BallArray, hull
from verification.proofs.global_dynamics.graph import BLOCK, Cells, Grid, Indices, Mask, Transitions
from verification.proofs.global_dynamics.images import PinballImages

Array = NDArray[np.float64]
SLACK = 1e-12  # for each step: the logarithms and their sums in float64, of numbers below a hundred
ROUNDS = 40  # in which cones may grow
WIDENED = 1.02  # a cone that has grown, so that the next rounds find it large enough


class Derivatives(NamedTuple):
    """Rows, several for a box: which box, the chart where it lands, and what the derivative is made of."""

    source: Indices
    chart: Indices
    by_theta: BallArray
    by_phi: BallArray
    bend_here: BallArray
    bend_there: BallArray


@dataclass(frozen=True)
class Expansion:
    """`nu_plus >= low` for every orbit that stays in a set for ever; minus infinity says that no cones were found.

    `cones` are ranges of slopes, one for each box; `steps` the length of the walks.
    """

    low: float
    steps: int
    cones: tuple[Array, Array]


def derivatives(map: PinballImages, grid: Grid, cells: Cells, parts: int) -> Derivatives:
    """The derivative over each block, cut into `parts` by `parts`."""
    rows: list[list[NDArray[Any]]] = []
    step = max(1, BLOCK // parts**2)
    for start in range(0, cells.chart.size, step):
        boxes, source = grid.boxes(Cells(*(field[start : start + step] for field in cells))).parts(parts, parts)
        for piece, slopes in map.derivatives(boxes):
            spread = [np.broadcast_arrays(value.m, value.r, piece.low)[:2] for value in slopes]
            rows.append([start + source[piece.on], piece.chart, *(half for pair in spread for half in pair)])
    source, chart, *halves = (np.concatenate(column) for column in zip(*rows, strict=True))
    balls = [BallArray(halves[i], halves[i + 1]) for i in range(0, len(halves), 2)]
    return Derivatives(source, chart, *balls)


def expansion(map: PinballImages, graph: Transitions, members: Mask, steps: int = 100, parts: int = 2) -> Expansion:
    """A lower bound for `nu_plus` of every orbit that stays in the leaves of a set for ever.

    Cones begin as what horizontal vectors become, and grow until each holds the images of those that lead to it.
    """
    chosen = members[:-1] & graph.leaf
    cells = graph.chosen(members)
    inner = graph.edges[:-1, :-1][chosen][:, chosen].tocsr()
    if cells.chart.size == 0 or np.any(np.diff(inner.indptr) == 0):
        raise ValueError("expansion: a box has no edge within the set; give a trapping region or a Morse set")
    found = derivatives(map, graph.grid, cells, parts)
    count = cells.chart.size
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    first = _arriving(map, found, inner, cells, (np.zeros(count), np.zeros(count)))
    for _ in range(ROUNDS):
        low, high = np.minimum(low, first[0]), np.maximum(high, first[1])
        entered = low <= high  # no edge leads to the others
        if not np.all(np.isfinite(low[entered]) & np.isfinite(high[entered])):
            break
        bottom, top = np.where(entered, low, 0.0), np.where(entered, high, 0.0)
        more = (top - bottom) * (WIDENED - 1)
        cones = bottom - more, top + more
        first = _arriving(map, found, inner, cells, cones)
        if np.all((cones[0] <= first[0]) & (first[1] <= cones[1])):
            return Expansion(_least_mean(_factors(found, cones, count), inner, steps) - SLACK, steps, cones)
    return Expansion(-np.inf, steps, (low, high))


def _arriving(
    map: PinballImages, found: Derivatives, inner: csr_matrix, cells: Cells, cones: tuple[Array, Array]
) -> tuple[Array, Array]:
    """The range of slopes that reach each box from all boxes with an edge to it; infinite where it is not known."""
    count, charts = cells.chart.size, len(map.charts)
    slope = hull(*cones)[found.source]
    with np.errstate(all="ignore"):
        stretch = found.by_theta + found.by_phi * slope
        new = -(map.lam * (found.bend_there - (found.bend_here - slope) / stretch))
        known = np.isfinite(new.r)
        ends = np.where(known, new.lower(), -np.inf), np.where(known, new.upper(), np.inf)
    low, high = np.full(count * charts, np.inf), np.full(count * charts, -np.inf)
    np.minimum.at(low, found.source * charts + found.chart, ends[0])
    np.maximum.at(high, found.source * charts + found.chart, ends[1])
    source = np.repeat(np.arange(count), np.diff(inner.indptr))
    leaving = source * charts + cells.chart[inner.indices]
    reached = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(reached[0], inner.indices, low[leaving])
    np.maximum.at(reached[1], inner.indices, high[leaving])
    return reached


def _factors(found: Derivatives, cones: tuple[Array, Array], count: int) -> Array:
    """The logarithm of the least factor by which vectors of its cone grow, for each box."""
    with np.errstate(all="ignore"):
        stretch = found.by_theta + found.by_phi * hull(*cones)[found.source]
        size = (np.abs(stretch.m) - stretch.r) * (1 - 1e-14)
        size = np.where(np.isfinite(stretch.r) & (size > 0), size, 0.0)
        least = np.full(count, np.inf)
        np.minimum.at(least, found.source, np.log(size))
    return least


def _least_mean(weights: Array, inner: csr_matrix, steps: int) -> float:
    """The least mean weight of a walk of `steps` steps."""
    low, starts = np.zeros(weights.size), inner.indptr[:-1]
    for _ in range(steps):  # of walks one step longer, over all that begin at each box
        low = weights + np.minimum.reduceat(low[inner.indices], starts)
    return float(low.min()) / steps
