"""Theorems on a set of boxes: it is a trapping region, and the larger Lyapunov exponent of its orbits is bounded.

A trapping region is a set of boxes that the map takes into its interior: the enclosed image of each box meets no cell
outside of the set. Every orbit that enters the region stays in it, with its limit set, and disjoint regions hold
different attractors. On a table with joins this concerns only orbits that never land on a join.

The larger exponent of every orbit in a set of boxes is bounded below by cones and the least mean over walks. Each box
has a range of slopes `dphi/dtheta`, its cone. If over each box the derivative takes the cone into those of all boxes
where the image may lie, then vectors of the cones stay in them along every orbit. Each box has a least factor by which
`|dtheta|` grows along these vectors. So over `n` bounces the logarithm grows by at least the least sum over all walks
of `n` steps, and in the long run by the corresponding mean per bounce. One bounce may shrink vectors as long as no long
walk does. The greatest factors give an upper bound in the same way: a cone with interior holds two vectors that span
the plane, so the derivative of `n` bounces grows no faster than the greatest sum over walks. The boundary parameter
replaces arc length, which changes lengths by bounded factors and no long-time mean.

With `p = bend0 - slope0` the derivative takes a slope to `-sigma*(bend1 - p/(by_theta + by_phi*slope0))`, the mirror
equation of a law with the slope `-sigma`, which is `-lam` for the paper's; a law that depends on the place adds its
drift.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from numeric.backends import elementary
from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull, paired, spread, unpaired
from verification.proofs.global_dynamics.flights import LandingArcs, Slopes
from verification.proofs.global_dynamics.images import PinballImages, RangeTheorem
from verification.rigorous.boxes import Boxes, BoxMap, Images
from verification.rigorous.certificate import Certified, entry, whole, whole_number
from verification.rigorous.graph import (
    BLOCK,
    LARGEST,
    Cells,
    Grid,
    MorseGraph,
    Rectangles,
    Transitions,
    inside,
    mapped,
)
from verification.rigorous.theorem import hypothesis

SEED, STARTS, LONG = 1, 2000, 2000
MOST_PARTS, MOST_BOXES = 16, 1 << 24


def _runs(cells: Cells) -> Iterator[list[int]]:
    """The cells as entries `[chart, size, column, row, count]`, one for each stack of `count` blocks in a column."""
    order = np.lexsort((cells.row, cells.column, cells.size, cells.chart))
    chart, column, row, size = (values[order].tolist() for values in cells)
    run: list[int] = []
    for block in zip(chart, size, column, row, strict=True):
        if run and list(block) == [*run[:3], run[3] + run[1] * run[4]]:
            run[4] += 1
        else:
            if run:
                yield run
            run = [*block, 1]
    if run:
        yield run


def _unrolled(runs: Any, region: Mapping[str, Any]) -> Cells:
    """The cells of entries `[chart, size, column, row, count]`; `ValueError` if one does not fit the `region`."""
    charts, columns, rows = len(region["scene"].table.components), region["columns"], region["rows"]
    given = [[whole_number("a run", x, LARGEST, 0) for x in run] for run in runs]
    if {len(run) for run in given} != {5} or not 1 <= sum(run[4] for run in given) <= MOST_BOXES:
        raise ValueError(
            f"certificate: runs must be a list of [chart, size, column, row, how many], 1 to {MOST_BOXES} in all"
        )
    found = np.array(given, dtype=np.int64)
    chart, size, column, row, count = found.T
    good = (chart < charts) & (size >= 1) & (count >= 1) & (column + size <= columns) & (row + size * count <= rows)
    if not np.all(good):
        raise ValueError(f"certificate: the run {found[~good][0].tolist()} is not within {columns} by {rows} cells")
    own = np.repeat(np.arange(chart.size), count)
    step = np.arange(own.size) - np.repeat(np.cumsum(count) - count, count)
    return Cells(chart[own], column[own], row[own] + step * size[own], size[own])


@dataclass(frozen=True, eq=False, repr=False)
class Region(RangeTheorem, Certified):
    """A union of blocks of cells in the strip `|phi| <= HIGH*pi/2` is trapping for every `lam` of a range `LOW:HIGH`.

    Each box is cut into `parts` by `parts` before it is mapped. In the document adjacent blocks of a column are joined
    to a single entry.
    """

    kind = "trapping region"
    columns: int = field(metadata=whole("columns", LARGEST))
    rows: int = field(metadata=whole("rows", LARGEST))
    parts: int = field(metadata=whole("parts", MOST_PARTS))
    cells: Cells = field(metadata=entry(_unrolled, lambda cells: list(_runs(cells)), "runs"))

    @property
    def name(self) -> str:
        """The statement in one line."""
        count = self.cells.chart.size
        boxes = f"{count} box{'es'[: 2 * (count > 1)]} on a grid of {self.columns} by {self.rows}"
        return f"trapping region of {self.map.label}: {boxes}"

    @cached_property
    def mapped(self) -> tuple[Grid, Rectangles, Mask]:
        """The grid, the cells that the images meet, and a mask of the blocks whose images are not enclosed."""
        grid = Grid(self.map.charts, self.columns, self.rows)
        return grid, *mapped(self.map, grid, self.cells, self.parts)

    @hypothesis
    def convex_table(self) -> bool:
        """The table is convex."""
        return bool(self.map.charts)  # the map raises ValueError for other tables

    @hypothesis
    def images_enclosed(self) -> bool:
        """The image of each box is enclosed."""
        return not self.mapped[2].any()

    @hypothesis
    def images_inside(self) -> bool:
        """The image of each box is disjoint from all closed cells outside of the region."""
        grid, met, lost = self.mapped
        return bool(inside(grid, self.cells, met, lost).all())


def region(map: PinballImages, graph: MorseGraph, index: int, parts: int = 1) -> Region | None:
    """The trapping region of the Morse set `index`, whose boxes are cut into `parts` by `parts` before mapping; or
    None.

    None is returned when walks from the set lead outside.
    """
    block = graph.trapping(index)
    if block[-1]:
        return None
    grid = graph.transitions.grid
    return Region(map.scene, map.range, grid.columns, grid.rows, parts, graph.transitions.chosen(block))


def shares(graph: MorseGraph, index: int) -> tuple[float, float]:
    """A lower and an upper bound of the share of phase space (by area) whose orbits end in a trapping region.

    The lower bound is the area of the boxes from which every walk ends in the region, the upper bound that of the boxes
    from which some walk does.
    """
    block = graph.trapping(index)
    cells, grid = graph.transitions.cells, graph.transitions.grid
    width = np.array([(c.x[1] - c.x[0]) * (c.y[1] - c.y[0]) for c in grid.charts])
    area = cells.size.astype(float) ** 2 * width[cells.chart] * graph.transitions.leaf
    sure, maybe = graph.basin(block)[:-1], graph.transitions.reached(block, backward=True)[:-1]
    slack = 1e-9  # above the relative rounding error of a sum of up to 2**28 positive doubles
    low, high = (float(area[some].sum() / area.sum()) for some in (sure, maybe))
    return max(0.0, low - slack), min(1.0, high + slack)


def sampled_share(map: PinballImages, graph: MorseGraph, index: int) -> tuple[float, float] | None:
    """The share of random starts (by area) in a trapping region after `LONG` bounces, and its standard error.

    The share is sampled, for comparison with the bounds of `shares`; None for a range of contractions.
    """
    if map.range[0] != map.range[1]:
        return None
    rng, grid = np.random.default_rng(SEED), graph.transitions.grid
    areas = np.array([(c.x[1] - c.x[0]) * (c.y[1] - c.y[0]) for c in grid.charts])
    chart = rng.choice(areas.size, STARTS, p=areas / areas.sum())
    place = [np.array([getattr(c, side) for c in grid.charts])[chart].T for side in ("x", "y")]
    theta, phi = (low + (high - low) * rng.random(STARTS) for low, high in place)
    end = map.map.exponents(theta, phi, 1, LONG, chart)
    known = np.isfinite(end.theta) & np.isfinite(end.phi)
    last = Boxes(end.component[known], *((x[known], x[known]) for x in (end.theta, end.phi)))
    met = grid.met(Images.exact(last))
    block = graph.transitions.chosen(graph.trapping(index))
    member = grid.to_array(block, np.ones(block.chart.size, dtype=bool))
    share = float(member[met.chart, met.left % grid.columns, met.bottom].sum()) / STARTS
    return share, float(np.sqrt(max(share * (1 - share), 1 / STARTS) / STARTS))


SLACK = 1e-12  # for each step: above the rounding of logarithms below a hundred, and of their sums
ROUNDS = 40  # the most rounds in which cones grow
WIDENED = 1.02  # by which a cone that grows is widened, so that fewer rounds are needed


class Derivatives(NamedTuple):
    """Derivatives over boxes, as rows of box, chart of the landing, and slopes; a box may have several rows."""

    source: Indices
    chart: Indices
    slopes: Slopes


@dataclass(frozen=True)
class ExponentBounds:
    """Bounds `low <= nu_plus <= high` for every orbit that stays in a set of boxes; infinite if no cones were found.

    `cones` are the ranges of slopes for each box; `steps` is the length of the walks.
    """

    low: float
    high: float
    steps: int
    cones: tuple[Array, Array]


class SmoothMap(BoxMap, Protocol):
    """A map of charts with enclosed images and derivatives."""

    def derivatives(self, boxes: Boxes) -> list[tuple[LandingArcs, Slopes]]:
        """The derivatives over whole boxes, for each chart in which they land."""


def derivatives(map: SmoothMap, grid: Grid, cells: Cells, parts: int) -> Derivatives:
    """The derivatives over blocks of cells, each block cut into `parts` by `parts`."""
    rows: list[list[NDArray[Any]]] = []
    step = max(1, BLOCK // parts**2)
    for start in range(0, cells.chart.size, step):
        boxes, source = grid.boxes(Cells(*(field[start : start + step] for field in cells))).parts(parts, parts)
        for piece, slopes in map.derivatives(boxes):
            values = unpaired(spread(value, piece.low) for value in slopes)
            rows.append([start + source[piece.on], piece.chart, *values])
    source, chart, *found = (np.concatenate(column) for column in zip(*rows, strict=True))
    return Derivatives(source, chart, Slopes(*paired(found)))


def push_slopes(found: Slopes, slope: BallArray) -> tuple[BallArray, BallArray]:
    """Factor by which `dtheta` grows along vectors of a given slope `dphi/dtheta`, and the slope of their images."""
    stretch = found.by_theta + found.by_phi * slope
    return stretch, found.drift - found.law * (found.bend_there - (found.bend_here - slope) / stretch)


def expansion(
    map: PinballImages, graph: Transitions, members: Mask, steps: int = 100, parts: int = 2
) -> ExponentBounds:
    """Bounds for the larger exponent `nu_plus` of every orbit that stays in the leaves `members`.

    Walks have `steps` bounces, and derivatives are enclosed over `parts` by `parts` pieces of each box. Cones begin as
    the images of horizontal vectors, and grow until each holds the images of all cones from which an edge leads to it.
    """
    chosen = members[:-1] & graph.leaf
    cells = graph.chosen(members)
    inner = graph.edges[:-1, :-1][chosen][:, chosen].tocsr()
    if cells.chart.size == 0 or np.any(np.diff(inner.indptr) == 0):
        raise ValueError("expansion: a box has no edge within the set; give a trapping region or a Morse set")
    if not graph.complete(members):  # an orbit may use edges of a refined block
        none = np.full(cells.chart.size, np.inf)
        return ExponentBounds(-np.inf, np.inf, steps, (none, -none))
    found = derivatives(map, graph.grid, cells, parts)
    cones, entered = grown_cones(found, inner, cells.chart)
    if entered is None:
        return ExponentBounds(-np.inf, np.inf, steps, cones)
    least, most = factors(found, cones, cells.chart.size)
    ends = least_mean(least, inner, steps) - SLACK, -least_mean(-most, inner, steps) + SLACK
    return ExponentBounds(ends[0], ends[1] if np.all((cones[0] < cones[1])[entered]) else np.inf, steps, cones)


def grown_cones(found: Derivatives, inner: csr_matrix, chart: Indices) -> tuple[tuple[Array, Array], Mask | None]:
    """Cones of slopes that the derivative maps into each other; and a mask of the sets to which edges lead, or None.

    The cones begin as the images of horizontal vectors and grow. The mask is None if some cone does not hold all images
    that reach it. `chart` has the chart of each set; `inner` is the adjacency matrix of the sets.
    """
    low, high = np.full(chart.size, np.inf), np.full(chart.size, -np.inf)
    first = arriving(found, inner, chart, (np.zeros(chart.size), np.zeros(chart.size)))
    for _ in range(ROUNDS):
        low, high = np.minimum(low, first[0]), np.maximum(high, first[1])
        entered = low <= high  # edges lead to these
        if not np.all(np.isfinite(low[entered]) & np.isfinite(high[entered])):
            break
        bottom, top = np.where(entered, low, 0.0), np.where(entered, high, 0.0)
        more = (top - bottom) * (WIDENED - 1)
        cones = bottom - more, top + more
        first = arriving(found, inner, chart, cones)
        if np.all((cones[0] <= first[0]) & (first[1] <= cones[1])):
            return cones, entered
    return (low, high), None


def arriving(found: Derivatives, inner: csr_matrix, chart: Indices, cones: tuple[Array, Array]) -> tuple[Array, Array]:
    """The range of slopes of the images that reach each set along edges; infinite if a slope is not enclosed."""
    count, charts = chart.size, int(max(chart.max(), found.chart.max(initial=0))) + 1
    slope = hull(*cones)[found.source]
    with np.errstate(all="ignore"):
        _, new = push_slopes(found.slopes, slope)
        known = np.isfinite(new.r)
        ends = np.where(known, new.lower(), -np.inf), np.where(known, new.upper(), np.inf)
    low, high = np.full(count * charts, np.inf), np.full(count * charts, -np.inf)
    np.minimum.at(low, found.source * charts + found.chart, ends[0])
    np.maximum.at(high, found.source * charts + found.chart, ends[1])
    source = np.repeat(np.arange(count), np.diff(inner.indptr))
    leaving = source * charts + chart[inner.indices]
    reached = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(reached[0], inner.indices, low[leaving])
    np.maximum.at(reached[1], inner.indices, high[leaving])
    return reached


def factors(found: Derivatives, cones: tuple[Array, Array], count: int) -> tuple[Array, Array]:
    """For each box, the logarithms of the least and the greatest factor by which vectors in its cone grow."""
    with np.errstate(all="ignore"):
        stretch, _ = push_slopes(found.slopes, hull(*cones)[found.source])
        known, middle = np.isfinite(stretch.r), np.abs(stretch.m)
        low = np.where(known, np.maximum((middle - stretch.r) * (1 - 1e-14), 0.0), 0.0)
        high = np.where(known, (middle + stretch.r) * (1 + 1e-14), np.inf)
        least, most = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(least, found.source, elementary.log(low))
        np.maximum.at(most, found.source, elementary.log(high))
    return least, most


def least_mean(weights: Array, inner: csr_matrix, steps: int) -> float:
    """The least mean weight over all walks of `steps` steps; weights belong to vertices."""
    low, starts = np.zeros(weights.size), inner.indptr[:-1]
    for _ in range(steps):  # the least sums of walks one step longer
        low = weights + np.minimum.reduceat(low[inner.indices], starts)
    return float(low.min()) / steps
