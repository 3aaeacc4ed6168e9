"""A trapping region as a set of cells, with its transition graph, invariant cones of slopes, and bounds of stretching.

A curve is *unstable* when its tangent lies in the cone of each cell that it is in. Charts are joined end to end, as the
components of a table are; where two charts meet, the map is continuous and its derivative may jump. The image of an
unstable curve is again a connected unstable curve, except for corners at the joins.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.sparse import csr_matrix

from verification.arithmetic.arrays import Array, hull
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.regions import (
    SmoothMap,
    arriving,
    derivatives,
    factors,
    push_slopes,
)
from verification.rigorous.absorbing import cells as cells_of
from verification.rigorous.absorbing import reached
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Cells, Grid, transitions

MOST, ROUNDS, WIDENED, LEAST = 1 << 20, 60, 0.05, 1e-9  # the most cells and rounds; how much cones are widened
CLOSER = 6  # bounces by which cones are tightened


class JoinedMap(SmoothMap, Protocol):
    """A map of charts that are joined end to end."""

    @property
    def joins(self) -> tuple[tuple[int, int], ...]:
        """Pairs of charts such that the end of the first is the start of the second."""

    @property
    def homeomorphism(self) -> bool:
        """True if the map is proved continuous across joins and one-to-one, with nonzero determinant where smooth."""


@dataclass(frozen=True)
class ConeField:
    """A trapping region of cells with invariant cones, and bounds over each cell.

    `inner` is the graph of cells. Derivatives map each cone of `outer` into the interior of the cones to which edges
    lead, and `cones` are narrower invariant cones; `least` and `most` bound the logarithm of the growth of `|dtheta|`
    along vectors of a cone. `sign` is, for each chart, 1 if the map keeps the order of points along curves and -1 if it
    reverses it.
    """

    map: JoinedMap
    grid: Grid
    cells: Cells
    inner: csr_matrix
    cones: tuple[Array, Array]
    outer: tuple[Array, Array]
    least: Array
    most: Array
    sign: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of an array of all cells."""
        return len(self.grid.charts), self.grid.columns, self.grid.rows

    def to_array(self, values: Array, empty: float) -> Array:
        """An array of all cells: `values` at the cells of the region, and `empty` elsewhere."""
        picture = np.full(self.shape, empty)
        picture[self.cells.chart, self.cells.column, self.cells.row] = values
        return picture

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """The width and height of the cells of each chart."""
        size = np.array([[c.x[1] - c.x[0], c.y[1] - c.y[0]] for c in self.grid.charts]).T
        return size[0] / self.grid.columns, size[1] / self.grid.rows

    @cached_property
    def steepest(self) -> tuple[Array, Array]:
        """The least and the greatest slope of all cones, in each chart."""
        low, high = np.full(self.shape[0], np.inf), np.full(self.shape[0], -np.inf)
        np.minimum.at(low, self.cells.chart, self.cones[0])
        np.maximum.at(high, self.cells.chart, self.cones[1])
        return low, high


def cover(map: JoinedMap, columns: int, rows: int, start: Boxes, parts: int = 1) -> ConeField | str:
    """The trapping region grown from the boxes `start`, with its cones; or the reason, in words, why it is not proved.

    Cells are cut into `parts` by `parts` pieces before they are mapped.
    """
    if any(chart.period for chart in map.charts):
        return "a closed curve in one chart has no joins, and unstable curves no ends to be counted from"
    grid = Grid(map.charts, columns, rows)
    numbers = reached(map, grid, start, parts, most=MOST)
    if numbers is None:
        return "no trapping region: images leave the charts, are lost, or fill too many cells"
    cells = cells_of(grid, numbers)
    graph = transitions(map, grid, cells, parts)
    if graph.edges[:-1, -1].nnz:
        return "no trapping region: an image leaves the cells"
    inner = graph.edges[:-1, :-1].tocsr()
    return _with_cones(map, grid, cells, inner, parts)


def _with_cones(map: JoinedMap, grid: Grid, cells: Cells, inner: csr_matrix, parts: int) -> ConeField | str:
    """The region with cones that are mapped into the interior of cones along all edges; or the reason, in words, why
    there are none.

    Cones are grown from horizontal vectors.
    """
    found = derivatives(map, grid, cells, parts)
    count = cells.chart.size
    low, high = np.full(count, -LEAST), np.full(count, LEAST)
    for _ in range(ROUNDS):
        new = arriving(found, inner, cells.chart, (low, high))
        entered = new[0] <= new[1]
        if not np.all(np.isfinite(new[0][entered]) & np.isfinite(new[1][entered])):
            return "no cones: over some cell a vector of its cone may become vertical"
        if np.all(((low < new[0]) & (new[1] < high))[entered]):
            break
        wide = (new[1] - new[0]) * WIDENED + LEAST
        low = np.where(entered, np.minimum(low, new[0] - wide), low)
        high = np.where(entered, np.maximum(high, new[1] + wide), high)
    else:
        return "no cones: they grow without end"
    outer = cones = low, high
    for _ in range(CLOSER):  # images of invariant cones are invariant
        ends = np.maximum(new[0], cones[0]), np.minimum(new[1], cones[1])
        cones = np.where(entered, ends[0], outer[0]), np.where(entered, ends[1], outer[1])
        new = arriving(found, inner, cells.chart, cones)
    with np.errstate(all="ignore"):
        stretch = push_slopes(found.slopes, hull(*cones)[found.source])[0]
        (a, b), (c, d) = matrix(found.slopes)
        size = (a * d - b * c).magnitude()
        if (
            np.any(cones[0] >= cones[1])
            or not np.all(stretch.positive() | stretch.negative())
            or not np.all(np.isfinite(size))
            or np.unique(found.source).size < count
        ):
            return "no cones: over some cell a vector of its cone may become vertical"
    least, most = factors(found, cones, count)
    on = cells.chart[found.source]
    ways = [np.unique(np.sign(stretch.m[on == i])) for i in range(len(map.charts))]
    if any(way.size > 1 for way in ways):
        return "the map keeps the order of points in one part of a chart and turns it in another"
    sign = tuple(int(way[0]) if way.size else 0 for way in ways)
    return ConeField(map, grid, cells, inner, cones, outer, least, most, sign)
