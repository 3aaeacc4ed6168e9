"""What is proved of a set of boxes: it is a trapping region, and its orbits have an exponent above a bound.

A trapping region is a set of boxes that the map takes into its interior. What proves it is short: the outer image of
each of its boxes meets no cell outside it. So every orbit that enters it stays, and what such orbits come near again
and again, their limit sets, lies inside; regions without a common point hold different attractors. On a table with
joins this speaks of orbits that never land on one.

The larger exponent of every orbit in a set of boxes is bounded below by cones and the least mean over walks. Each box
has a range of slopes `dphi/dtheta`, its cone. If over each box the derivative takes the cone into those of all boxes
where the image may lie, then vectors of the cones stay in them along every orbit. In the length `|dtheta|` each box
has a least factor by which they grow, so over `n` bounces the logarithm grows by at least the least sum over all
walks of `n` steps, and over any number of bounces by that mean per bounce. One bounce may shrink vectors as long as
no long walk does. The greatest factors bound it from above: a cone with an inside holds two vectors that span the
plane, so the derivative of `n` bounces grows no faster than the greatest sum over walks. The boundary parameter takes
the place of arc length: that multiplies lengths by bounded factors, which no mean over a long time sees.

With `p = bend0 - slope0` the derivative takes a slope to `-sigma*(bend1 - p/(by_theta + by_phi*slope0))`, the mirror
equation of a law with the slope `-sigma`, which is `-lam` for the paper's; a law of the place adds its drift.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from numeric.backends import elementary
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull, paired, spread, unpaired
from verification.proofs.global_dynamics.boxes import Boxes, BoxMap, Images
from verification.proofs.global_dynamics.flights import Piece, Slopes
from verification.proofs.global_dynamics.graph import (
    BLOCK,
    LARGEST,
    Cells,
    Grid,
    Indices,
    Mask,
    MorseGraph,
    Transitions,
    inside,
    mapped,
)
from verification.proofs.global_dynamics.images import PinballImages

KIND, SCHEMA = "trapping region", 1
Checked = tuple[str, dict[str, bool | None]]
SEED, STARTS, LONG = 1, 2000, 2000
MOST_PARTS, MOST_BOXES = 16, 1 << 24


@dataclass(frozen=True)
class Region:
    """A union of blocks of cells in the strip `|phi| <= HIGH*pi/2`, said to be trapping for every `lam` of a range.

    `parts` by `parts` is how finely each box is cut before it is mapped.
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    columns: int
    rows: int
    parts: int
    cells: Cells

    @cached_property
    def map(self) -> PinballImages:
        """The map, over all of the range at once; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, self.lam)

    @property
    def name(self) -> str:
        """What is stated."""
        count = self.cells.chart.size
        boxes = f"{count} box{'es'[: 2 * (count > 1)]} on a grid of {self.columns} by {self.rows}"
        return f"trapping region of {self.map.label}: {boxes}"

    @property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        grid = Grid(self.map.charts, self.columns, self.rows)
        met, lost = mapped(self.map, grid, self.cells, self.parts)
        trapped = inside(grid, self.cells, met, lost)
        return {
            "convex_table": True,
            "images_enclosed": _proved(not lost.any()),
            "images_inside": _proved(trapped.all()),
        }

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document; blocks above one another are one run."""
        low, high = self.lam
        said = {"schema": SCHEMA, "name": self.name, "kind": KIND, "scene": self.scene.document}
        numbers = {"lam": [str(low), str(high)], "columns": self.columns, "rows": self.rows, "parts": self.parts}
        return said | numbers | {"runs": list(_runs(self.cells))}

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> "Region":
        """The region of a document; `ValueError` names what is wrong with it."""
        try:
            scene, lam = stated(given, KIND, SCHEMA)
            columns, rows, parts = (whole(name, given[name], LARGEST) for name in ("columns", "rows", "parts"))
            if parts > MOST_PARTS:
                raise ValueError(f"certificate: parts = {parts} is out of range; accepted: 1 to {MOST_PARTS}")
            charts = len(scene.table.components)
            return cls(scene, lam, columns, rows, parts, _unrolled(given["runs"], charts, columns, rows))
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def stated(given: Mapping[str, Any], kind: str, schema: int) -> tuple[Scene, tuple[Fraction, Fraction]]:
    """The scene and the contractions of a document of that kind; `ValueError` names what is wrong with them."""
    if (given["kind"], given["schema"]) != (kind, schema):
        raise ValueError(f"certificate: {given['kind']!r} of schema {given['schema']!r} is no {kind}")
    try:
        low, high = (Fraction(str(end)) for end in given["lam"])
    except (ValueError, ZeroDivisionError):
        raise ValueError(f"certificate: lam = {given['lam']!r}; accepted: two ends, as fractions") from None
    return Scene.of(given["scene"]), (low, high)


class Statement(Protocol):
    """What a document about boxes states."""

    @property
    def name(self) -> str:
        """In words."""

    @property
    def checks(self) -> dict[str, bool | None]:
        """What is proved of it, item by item."""


def checked(given: Mapping[str, Any], read: Callable[[Mapping[str, Any]], Statement] = Region.from_dict) -> Checked:
    """What a document states, and its checklist worked through anew; a wrong name is refused."""
    stated = read(given)
    if given.get("name") != stated.name:
        said = ascii(given.get("name"))[:80]
        raise ValueError(f"certificate: name = {said} is not what it states, which is {stated.name!r}")
    return stated.name, stated.checks


def region(map: PinballImages, graph: MorseGraph, index: int, parts: int = 1) -> Region | None:
    """The trapping region of a Morse set; None when walks from it lead outside."""
    block = graph.trapping(index)
    if block[-1]:
        return None
    grid = graph.transitions.grid
    return Region(map.scene, map.range, grid.columns, grid.rows, parts, graph.transitions.chosen(block))


def shares(graph: MorseGraph, index: int) -> tuple[float, float]:
    """Bounds for the share of phase space, by area in `theta` and `phi`, whose orbits end in a trapping region.

    Below: the boxes from which every walk ends there. Above: those from which some walk does.
    """
    block = graph.trapping(index)
    cells, grid = graph.transitions.cells, graph.transitions.grid
    width = np.array([(c.x[1] - c.x[0]) * (c.y[1] - c.y[0]) for c in grid.charts])
    area = cells.size.astype(float) ** 2 * width[cells.chart] * graph.transitions.leaf
    sure, maybe = graph.basin(block)[:-1], graph.transitions.reached(block, backward=True)[:-1]
    slack = 1e-9  # far more than a sum of at most 2**28 positive doubles errs by, relatively
    low, high = (float(area[some].sum() / area.sum()) for some in (sure, maybe))
    return max(0.0, low - slack), min(1.0, high + slack)


def sampled_share(map: PinballImages, graph: MorseGraph, index: int) -> tuple[float, float] | None:
    """The share of random starts, by area, that are in a trapping region after `LONG` bounces; with its standard error.

    A sample, to set beside the bounds of `shares`. None for a range of contractions.
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
    met = grid.met(Images(np.arange(int(known.sum())), last, np.zeros(0, dtype=np.int64)))
    block = graph.transitions.chosen(graph.trapping(index))
    member = grid.painted(block, np.ones(block.chart.size, dtype=bool))
    share = float(member[met.chart, met.left % grid.columns, met.bottom].sum()) / STARTS
    return share, float(np.sqrt(max(share * (1 - share), 1 / STARTS) / STARTS))


def _proved(held: Any) -> bool | None:
    return True if held else None  # an image that juts out may be the fault of its enclosure: nothing is refuted


def _runs(cells: Cells) -> Iterator[list[int]]:
    """`[chart, size, column, row, how many]` for blocks that stand on one another."""
    order = np.lexsort((cells.row, cells.column, cells.size, cells.chart))
    chart, column, row, size = (field[order].tolist() for field in cells)
    run: list[int] = []
    for entry in zip(chart, size, column, row, strict=True):
        if run and list(entry) == [*run[:3], run[3] + run[1] * run[4]]:
            run[4] += 1
        else:
            if run:
                yield run
            run = [*entry, 1]
    if run:
        yield run


def _unrolled(runs: Any, charts: int, columns: int, rows: int) -> Cells:
    """The blocks of runs; none may jut out of the grid."""
    given = [[whole("a run", x, LARGEST, 0) for x in run] for run in runs]
    if {len(run) for run in given} != {5} or not 1 <= sum(run[4] for run in given) <= MOST_BOXES:
        raise ValueError("certificate: runs is no list of [chart, size, column, row, how many]")
    found = np.array(given, dtype=np.int64)
    chart, size, column, row, count = found.T
    good = (chart < charts) & (size >= 1) & (count >= 1) & (column + size <= columns) & (row + size * count <= rows)
    if not np.all(good):
        raise ValueError(f"certificate: the run {found[~good][0].tolist()} juts out of {columns} by {rows} cells")
    own = np.repeat(np.arange(chart.size), count)
    step = np.arange(own.size) - np.repeat(np.cumsum(count) - count, count)
    return Cells(chart[own], column[own], row[own] + step * size[own], size[own])


def whole(name: str, given: Any, most: int, least: int = 1) -> int:
    """A whole number of a document; `ValueError` where it is none, or out of range."""
    if isinstance(given, bool) or not isinstance(given, int) or not least <= given <= most:
        raise ValueError(f"certificate: {name} holds {given!r}; accepted: whole numbers from {least} to {most}")
    return given


Array = NDArray[np.float64]
SLACK = 1e-12  # for each step: the logarithms and their sums in float64, of numbers below a hundred
ROUNDS = 40  # in which cones may grow
WIDENED = 1.02  # a cone that has grown, so that the next rounds find it large enough


class Derivatives(NamedTuple):
    """Rows, several for a box: which box, the chart where it lands, and what the derivative is made of."""

    source: Indices
    chart: Indices
    slopes: Slopes


@dataclass(frozen=True)
class Expansion:
    """`low <= nu_plus <= high` for every orbit that stays in a set for ever; infinite where no cones were found.

    `cones` are ranges of slopes, one for each box; `steps` the length of the walks.
    """

    low: float
    high: float
    steps: int
    cones: tuple[Array, Array]


class SmoothMap(BoxMap, Protocol):
    """A map of charts with its derivatives."""

    def derivatives(self, boxes: Boxes) -> list[tuple[Piece, Slopes]]:
        """The derivative over whole boxes, for each chart in which they land."""


def derivatives(map: SmoothMap, grid: Grid, cells: Cells, parts: int) -> Derivatives:
    """The derivative over each block, cut into `parts` by `parts`."""
    rows: list[list[NDArray[Any]]] = []
    step = max(1, BLOCK // parts**2)
    for start in range(0, cells.chart.size, step):
        boxes, source = grid.boxes(Cells(*(field[start : start + step] for field in cells))).parts(parts, parts)
        for piece, slopes in map.derivatives(boxes):
            values = unpaired(spread(value, piece.low) for value in slopes)
            rows.append([start + source[piece.on], piece.chart, *values])
    source, chart, *found = (np.concatenate(column) for column in zip(*rows, strict=True))
    return Derivatives(source, chart, Slopes(*paired(found)))


def carried(found: Slopes, slope: BallArray) -> tuple[BallArray, BallArray]:
    """By what the first component of vectors of a slope is multiplied, and the slope of their images."""
    stretch = found.by_theta + found.by_phi * slope
    return stretch, found.drift - found.law * (found.bend_there - (found.bend_here - slope) / stretch)


def expansion(map: PinballImages, graph: Transitions, members: Mask, steps: int = 100, parts: int = 2) -> Expansion:
    """Bounds for `nu_plus` of every orbit that stays in the leaves of a set for ever.

    Cones begin as what horizontal vectors become, and grow until each holds the images of those that lead to it.
    """
    chosen = members[:-1] & graph.leaf
    cells = graph.chosen(members)
    inner = graph.edges[:-1, :-1][chosen][:, chosen].tocsr()
    if cells.chart.size == 0 or np.any(np.diff(inner.indptr) == 0):
        raise ValueError("expansion: a box has no edge within the set; give a trapping region or a Morse set")
    if not graph.complete(members):  # orbits may walk where these edges do not show it
        none = np.full(cells.chart.size, np.inf)
        return Expansion(-np.inf, np.inf, steps, (none, -none))
    found = derivatives(map, graph.grid, cells, parts)
    count = cells.chart.size
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    first = arriving(map, found, inner, cells, (np.zeros(count), np.zeros(count)))
    for _ in range(ROUNDS):
        low, high = np.minimum(low, first[0]), np.maximum(high, first[1])
        entered = low <= high  # no edge leads to the others
        if not np.all(np.isfinite(low[entered]) & np.isfinite(high[entered])):
            break
        bottom, top = np.where(entered, low, 0.0), np.where(entered, high, 0.0)
        more = (top - bottom) * (WIDENED - 1)
        cones = bottom - more, top + more
        first = arriving(map, found, inner, cells, cones)
        if np.all((cones[0] <= first[0]) & (first[1] <= cones[1])):
            least, most = factors(found, cones, count)
            wide = np.all((cones[0] < cones[1])[entered])
            ends = least_mean(least, inner, steps) - SLACK, -least_mean(-most, inner, steps) + SLACK
            return Expansion(ends[0], ends[1] if wide else np.inf, steps, cones)
    return Expansion(-np.inf, np.inf, steps, (low, high))


def arriving(
    map: BoxMap, found: Derivatives, inner: csr_matrix, cells: Cells, cones: tuple[Array, Array]
) -> tuple[Array, Array]:
    """The range of slopes that reach each box from all boxes with an edge to it; infinite where it is not known."""
    count, charts = cells.chart.size, len(map.charts)
    slope = hull(*cones)[found.source]
    with np.errstate(all="ignore"):
        _, new = carried(found.slopes, slope)
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


def factors(found: Derivatives, cones: tuple[Array, Array], count: int) -> tuple[Array, Array]:
    """The logarithms of the least and the greatest factor by which vectors of its cone grow, for each box."""
    with np.errstate(all="ignore"):
        stretch, _ = carried(found.slopes, hull(*cones)[found.source])
        known, middle = np.isfinite(stretch.r), np.abs(stretch.m)
        low = np.where(known, np.maximum((middle - stretch.r) * (1 - 1e-14), 0.0), 0.0)
        high = np.where(known, (middle + stretch.r) * (1 + 1e-14), np.inf)
        least, most = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(least, found.source, elementary.log(low))
        np.maximum.at(most, found.source, elementary.log(high))
    return least, most


def least_mean(weights: Array, inner: csr_matrix, steps: int) -> float:
    """The least mean weight of a walk of `steps` steps."""
    low, starts = np.zeros(weights.size), inner.indptr[:-1]
    for _ in range(steps):  # of walks one step longer, over all that begin at each box
        low = weights + np.minimum.reduceat(low[inner.indices], starts)
    return float(low.min()) / steps
