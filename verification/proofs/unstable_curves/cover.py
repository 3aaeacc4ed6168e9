"""A trapping region in cells, with its transition graph, cones of slopes, and what they stretch and areas shrink by.

A curve is *unstable* when its tangent lies in the cone of each cell that it is in. Charts are joined end to end, as
the components of a table are; where two meet the map is continuous and its derivative jumps. The image of an unstable
curve is one again, but for corners at the joins, and never cut.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from numeric.backends import elementary
from verification.arithmetic.arrays import hull
from verification.proofs.global_dynamics import Boxes, Cells, Grid
from verification.proofs.global_dynamics.apart import cells as cells_of
from verification.proofs.global_dynamics.apart import reached
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.graph import transitions
from verification.proofs.global_dynamics.regions import (
    SmoothMap,
    arriving,
    carried,
    derivatives,
    factors,
    least_mean,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
MOST, ROUNDS, WIDENED, LEAST = 1 << 20, 60, 0.05, 1e-9  # of cones: how much wider than what they are taken into
CLOSER = 6  # bounces after which vectors are looked at


class JoinedMap(SmoothMap, Protocol):
    """A map of charts that are joined end to end."""

    @property
    def joins(self) -> tuple[tuple[int, int], ...]:
        """Pairs of charts: the end of the first is the start of the second."""

    @property
    def homeomorphism(self) -> bool:
        """Is it proved continuous across joins and one-to-one, with a determinant not 0 where it is smooth?"""


@dataclass(frozen=True)
class Cover:
    """Cells that the map takes into themselves, and what is known over each of them.

    `inner` is the graph of cells; `outer` cones are taken into `cones`, which lie inside; `least` and `most` are bounds
    for the logarithm of the factor by which `|dtheta|` grows along vectors of a cone, `area` for that of the
    determinant from above, and `sign` says for each chart whether it keeps the order of points on it.
    """

    map: JoinedMap
    grid: Grid
    cells: Cells
    inner: csr_matrix
    cones: tuple[Array, Array]
    outer: tuple[Array, Array]
    least: Array
    most: Array
    area: Array
    sign: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of an array of all cells."""
        return len(self.grid.charts), self.grid.columns, self.grid.rows

    def painted(self, values: Array, empty: float) -> Array:
        """An array of all cells with values of those of the region."""
        picture = np.full(self.shape, empty)
        picture[self.cells.chart, self.cells.column, self.cells.row] = values
        return picture

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """How wide and how high a cell of each chart is."""
        size = np.array([[c.x[1] - c.x[0], c.y[1] - c.y[0]] for c in self.grid.charts]).T
        return size[0] / self.grid.columns, size[1] / self.grid.rows

    @cached_property
    def steepest(self) -> tuple[Array, Array]:
        """The least and the greatest slope of a cone, in each chart."""
        low, high = np.full(self.shape[0], np.inf), np.full(self.shape[0], -np.inf)
        np.minimum.at(low, self.cells.chart, self.cones[0])
        np.maximum.at(high, self.cells.chart, self.cones[1])
        return low, high

    @cached_property
    def contracts(self) -> bool:
        """Do vectors that stay outside of the outer cones shrink to nothing?

        With a vector of an inner cone they span what the determinant shrinks, at an angle bounded from below; so over
        `n` bounces they shrink by a constant times the product of determinants over that of the cones' growth.
        """
        return least_mean(self.least - self.area, self.inner, 50) - 1e-12 > 0


def cover(map: JoinedMap, columns: int, rows: int, start: Boxes, parts: int = 1, around: int = 0) -> Cover | str:
    """The cells that boxes and their images meet, with their cones; or what is missing, in words.

    With `around`, cells that stand that many columns and rows beside one of them belong to it too.
    """
    if any(chart.period for chart in map.charts):
        return "a closed curve in one chart has no joins, and unstable curves no ends to be counted from"
    grid = Grid(map.charts, columns, rows)
    numbers = reached(map, grid, start, parts, most=MOST)
    if numbers is not None and around:
        wide = _widened(grid, numbers, around)
        numbers = reached(map, grid, grid.boxes(cells_of(grid, wide)), parts, most=MOST)
    if numbers is None:
        return "no trapping region: images leave the charts, are lost, or fill too many cells"
    cells = cells_of(grid, numbers)
    graph = transitions(map, grid, cells, parts)
    if graph.edges[:-1, -1].nnz:
        return "no trapping region: an image leaves the cells"
    inner = graph.edges[:-1, :-1].tocsr()
    return _with_cones(map, grid, cells, inner, parts)


def _widened(grid: Grid, numbers: Indices, around: int) -> Indices:
    """Cells in rectangles about cells; nothing crosses to another chart."""
    member = np.zeros((len(grid.charts), grid.columns, grid.rows), dtype=bool)
    member.ravel()[numbers] = True
    for axis in (1, 2):
        turned = np.moveaxis(member, axis, 0)
        wide = turned.copy()
        for step in range(1, around + 1):
            wide[step:] |= turned[:-step]
            wide[:-step] |= turned[step:]
        member = np.moveaxis(wide, 0, axis)
    return np.flatnonzero(member.ravel())


def _with_cones(map: JoinedMap, grid: Grid, cells: Cells, inner: csr_matrix, parts: int) -> Cover | str:
    """Cones that are taken into the inside of those of all cells to which edges lead, grown from horizontal vectors."""
    found = derivatives(map, grid, cells, parts)
    count = cells.chart.size
    low, high = np.full(count, -LEAST), np.full(count, LEAST)
    for _ in range(ROUNDS):
        new = arriving(map, found, inner, cells, (low, high))
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
    for _ in range(CLOSER):  # images of invariant cones are invariant; what rounding adds to them is left out
        ends = np.maximum(new[0], cones[0]), np.minimum(new[1], cones[1])
        cones = np.where(entered, ends[0], outer[0]), np.where(entered, ends[1], outer[1])
        new = arriving(map, found, inner, cells, cones)
    with np.errstate(all="ignore"):
        stretch = carried(found.slopes, hull(*cones)[found.source])[0]
        (a, b), (c, d) = matrix(found.slopes)
        size = (a * d - b * c).magnitude()
        if (
            np.any(cones[0] >= cones[1])
            or not np.all(stretch.positive() | stretch.negative())
            or not np.all(np.isfinite(size))
            or np.unique(found.source).size < count
        ):
            return "no cones: over some cell a vector of its cone may become vertical"
        area = np.full(count, -np.inf)
        np.maximum.at(area, found.source, elementary.log(np.maximum(size, 1e-300)))
    least, most = factors(found, cones, count)
    on = cells.chart[found.source]
    ways = [np.unique(np.sign(stretch.m[on == i])) for i in range(len(map.charts))]
    if any(way.size > 1 for way in ways):
        return "the map keeps the order of points in one part of a chart and turns it in another"
    sign = tuple(int(way[0]) if way.size else 0 for way in ways)
    return Cover(map, grid, cells, inner, cones, outer, least, most, area, sign)
