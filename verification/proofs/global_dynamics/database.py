"""A database of Morse graphs: one for each box of contractions and of one shape parameter, and which of them continue.

For all parameters of a box at once phase space is covered and mapped as for one scene, so that what is stated holds
for each of them. On a smooth closed curve the shape parameter is a third coordinate of the mean-value theorem: the
boundary moves by its derivative with respect to it, and so do landing and incidence. A table that a rotation keeps is
looked at up to that rotation, and so are its Morse sets: with `n` turns a set stands for one, or for several that the
turns exchange.

Two boxes with a common border are compared there. At a parameter of the border each chain recurrent orbit lies, box
after box of its walk, in one Morse set of either graph; so sets of the two graphs that have no cell in common hold no
such orbit in common, and a set that meets none of the other graph holds none at all there. Where the other sets match
one to one, and the same lead to the same, what is recurrent within matched sets is the same there: it continues from
box to box, and with it, where the map is continuous, its Conley index. Boxes that are joined by such borders are a
class. (Arai, Kalies, Kokubu, Mischaikow, Oka and Pilarczyk 2009, A database schema for the analysis of global dynamics
of multiparameter systems.)
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from sympy import S

from numeric.lowering.lower import converted
from numeric.lowering.program import Builder, Program
from numeric.sweeps.sweep import Axis, Field, Part, Sweep, map_of, text_of
from symbolic.tables.law import parameters_of_law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table, theta
from verification.cycles.systems import rotations
from verification.maps.first_hit import closes_smoothly, convex
from verification.proofs.global_dynamics.boxes import BallArray, Boxes, Chart, common_part, exactly, hull, spread
from verification.proofs.global_dynamics.graph import Grid, MorseGraph, morse_graph, refined
from verification.proofs.global_dynamics.images import (
    QUARTER,
    Array,
    Flights,
    Indices,
    PinballImages,
    incidence,
    turn_between,
)

if TYPE_CHECKING:
    import xarray as xr

Range = tuple[Fraction, Fraction]
Numbers = NDArray[np.int64]
KNOWN = 40  # Morse sets of a box whose order is kept; a box with more has its count alone
TOGETHER = 8  # contractions of a task
TAKEN = {"sets", "attracting", "top", "cells", "leads", "row", "column", "from", "to"}  # names of fields and axes


class ParameterBox(PinballImages):
    """The map for every contraction of a range and every value of a shape parameter in another, up to rotation.

    >>> box = ParameterBox(Scene("egg", alpha="1/20", lam="1/2"), (Fraction(1, 2), Fraction(33, 64)), "alpha",
    ...     (Fraction(1, 20), Fraction(33, 640)))
    >>> box.turns, box.label
    (3, 'egg, alpha = 1/20 to 33/640, lam = 1/2 to 33/64')
    """

    def __init__(self, scene: Scene, lam: Range, parameter: str, shape: Range) -> None:
        middle = (shape[0] + shape[1]) / 2
        free = "" if parameter in scene.ranges or "table" in scene.document else f":{shape[0]}..{shape[1]}"
        super().__init__(scene.at(**{parameter: f"{middle}{free}"}), lam)
        self.middle = PinballImages(self.scene, lam)
        self.over, self.known = shape, dict(zip(self.map.ir.parts[0].curve.inputs[1:], self.shape, strict=True))
        self.reach = hull(exactly(shape[0] - middle).lower(), exactly(shape[1] - middle).upper())
        self.known[parameter] = hull(exactly(shape[0]).lower(), exactly(shape[1]).upper())
        self.parameter, self.shape = parameter, list(self.known.values())
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in self.map.ir.parts]
        turns, self.rates = _over(self.scene.text, parameter, *map(str, shape))
        self.turns = 1 if self.placed else turns

    def flights(self, boxes: Boxes) -> Flights:
        return ParameterFlights(self, boxes) if self.closed and not self.placed else Flights(self, boxes)

    @property
    def charts(self) -> tuple[Chart, ...]:
        found = []
        for chart in super().charts:
            low, high = chart.x
            found.append(chart._replace(x=(low, low + (high - low) / self.turns), y=(-self.height, self.height)))
        return tuple(found)

    @property
    def height(self) -> float:
        """Half the height of the charts: a quarter turn, halved as often as it still holds all exit angles.

        So the cells of boxes with other contractions are the same, or parts of one another.
        """
        height = QUARTER
        while height / 2 >= self.top:
            height /= 2
        return height

    @property
    def label(self) -> str:
        said = {key: str(value) for key, value in self.scene.shape.items()}
        said |= {name: f"{low} to {high}" for name, (low, high) in ((self.parameter, self.over), ("lam", self.range))}
        return ", ".join([self.scene.name, *(f"{key} = {value}" for key, value in said.items())])


class ParameterFlights(Flights):
    """Flights in a table whose shape parameter is known to lie in a range, and is a third coordinate."""

    map: ParameterBox

    def __init__(self, map: ParameterBox, boxes: Boxes) -> None:
        super().__init__(map, boxes)
        self.middle = Flights(map.middle, boxes)

    def guess(self) -> tuple[Indices, Array, Array, Array]:
        chart, theta, ahead, behind = super().guess()
        with np.errstate(all="ignore"):
            at = BallArray(np.nan_to_num(theta))
            rate, _ = self._by_shape(np.arange(chart.size), chart, at, self.theta)
            more = np.abs(rate.m) * float(self.map.reach.magnitude()) * 1.1
        return chart, theta, ahead + more, behind + more

    def mean_value(
        self, on: Indices, chart: Indices, arc: BallArray, eta: BallArray
    ) -> tuple[BallArray, BallArray, BallArray | None]:
        by_theta, by_phi, here, there, _, _ = self.slopes(on, chart, arc)
        by_shape, turned = self._by_shape(on, chart, arc, self.thetas[on])
        reach = self.reach[0][on], self.reach[1][on], self.map.reach
        middle = self.middle.midpoint(on, chart, arc)
        theta = middle + by_theta * reach[0] + by_phi * reach[1] + by_shape * reach[2]
        turn = turn_between(self.middle.tangent(on, self.theta), self.map.middle.place(chart, middle)[2:4])
        fine = self.phi[on] + turn + (there * by_theta - here) * reach[0] + (there * by_phi + 1) * reach[1]
        fine = fine + (there * by_shape + turned) * reach[2]
        return theta, common_part(eta, incidence(fine)), None

    def _by_shape(self, on: Indices, chart: Indices, arc: BallArray, start: BallArray) -> tuple[BallArray, BallArray]:
        """How the landing moves with the shape parameter, and by how much more the tangent turns there than here."""
        at, (dx, dy, *_), along, slope = self.across(on, chart, arc)
        here, there = (self._rates(place) for place in (start, arc))
        dx0, dy0 = self.map.place(self.chart[on], start)[2:4]
        turn_here = (dx0 * here[3] - dy0 * here[2]) / (dx0 * dx0 + dy0 * dy0)
        turn_there = (dx * there[3] - dy * there[2]) / (dx * dx + dy * dy)
        leaves = at["v"] * (there[1] - here[1]) - at["w"] * (there[0] - here[0]) - turn_here * along
        return -leaves / slope, turn_there - turn_here

    def _rates(self, theta: BallArray) -> list[BallArray]:
        """The derivatives of point and velocity with respect to the shape parameter."""
        values = self.map.rates(self.map.ops, theta, *(self.map.known[name] for name in self.map.rates.inputs[1:]))
        return [spread(value, np.asarray(theta.m)) for value in values]


@lru_cache(maxsize=256)
def _over(text: str, parameter: str, low: str, high: str) -> tuple[int, Program]:
    """The turns that keep a table, over a range of one parameter, and the program of the derivatives by it.

    They are those of point and velocity of the first component. `ValueError` where the table is not proved convex.
    """
    table = _varied(Scene.parse(text), parameter, low, high)
    if convex(table) is not True:
        raise ValueError(f"{table.name}: not proved convex for {parameter} = {low} to {high}; accepted: convex tables")
    symbols = {p.symbol.name: p.symbol for p in table.shapes}
    builder = Builder("theta", *symbols)
    nodes = dict(zip((theta, *symbols.values()), builder.nodes, strict=True))
    point = table.components[0].point
    rates = [each.diff(symbols[parameter]) for each in (*point, *(x.diff(theta) for x in point))]
    program = builder.program(*(converted(builder, rate, nodes) for rate in rates))
    return _turns(table), program


def _varied(scene: Scene, parameter: str, low: Any, high: Any) -> Table:
    """The table with one parameter free; `ValueError` where that moves the cells' borders, or the law beside the table.

    Charts end where components do, at the same places for all boxes; and of a law the numbers are those of one scene.
    """
    table: Table = scene.over(parameter, low, high)
    if any(parameter in map(str, S(end).free_symbols) for part in table.components for end in (part.start, part.end)):
        raise ValueError(f"{table.name}: components end elsewhere for another {parameter}; accepted: ends that stay")
    if scene.law.measured or parameter in parameters_of_law(scene.law.formula):
        raise ValueError(f"law = {scene.law}: it depends on {parameter}; accepted: laws that no shape changes")
    return table


def _turns(table: Table) -> int:
    return rotations(table) if closes_smoothly(table) else 1


@dataclass(frozen=True)
class Graphs:
    """The task: the Morse graphs of some boxes of parameters."""

    scene: str
    parameter: str
    values: tuple[str, ...]
    lams: tuple[str, ...]
    columns: int
    rows: int
    coarsest: int

    def __call__(self, part: Part) -> dict[str, NDArray[Any]]:
        shapes, lams = (part.values[name] for name in (self.parameter, "lam"))
        made = [[self.box(lam, shape) for lam in _ranges(self.lams, lams)] for shape in _ranges(self.values, shapes)]
        names = ("sets", "attracting", "top", "cells", "leads")
        return {name: np.array([[box[i] for box in row] for row in made]) for i, name in enumerate(names)}

    def box(self, lam: Range, shape: Range) -> tuple[int, int, float, NDArray[np.int8], NDArray[np.int8]]:
        """How many Morse sets and how many trapping regions, the strip's height, the cells of sets, and their order."""
        cells = np.full((self.rows, self.columns), -1, dtype=np.int8)
        leads = np.full((KNOWN, KNOWN), -1, dtype=np.int8)
        try:
            map = ParameterBox(Scene.parse(self.scene), lam, self.parameter, shape)
            grid = Grid(map.charts, self.columns, self.rows)
            graph = morse_graph(refined(map, grid, self.coarsest))
        except ValueError:  # not proved convex, or too many sets
            return -1, -1, np.nan, cells, leads
        attracting = sum(not graph.trapping(index)[-1] for index in graph.attracting)
        if len(graph.sets) <= KNOWN:
            cells = _painted(graph)
            leads[: len(graph.sets), : len(graph.sets)] = graph.below
        return len(graph.sets), attracting, map.height, cells, leads


def _painted(graph: MorseGraph) -> NDArray[np.int8]:
    """The number of the Morse set at each cell of the first chart's rows and columns, -1 where there is none."""
    label = np.full(graph.transitions.count + 1, -1, dtype=np.int64)
    for index, members in enumerate(graph.sets):
        label[members] = index
    leaf = graph.transitions.leaf
    grid = graph.transitions.grid
    painted = grid.painted(graph.transitions.chosen(np.append(leaf, False)), label[:-1][leaf], -1)
    return np.asarray(np.concatenate(list(painted)).T.astype(np.int8))


def _ranges(borders: Sequence[str], middles: NDArray[np.float64]) -> Iterator[Range]:
    """The boxes of one parameter about some middles."""
    ends = [Fraction(text) for text in borders]
    for middle in middles:
        index = int(np.searchsorted([float(end) for end in ends], middle)) - 1
        yield ends[index], ends[index + 1]


def database(
    scene: Scene,
    parameter: str,
    values: Sequence[float],
    lams: Sequence[float],
    columns: int = 96,
    rows: int = 128,
    coarsest: int = 8,
) -> Sweep:
    """The sweep over boxes of parameters, whose borders are `values` of a shape parameter and the contractions `lams`.

    Borders are the decimals that the numbers show. `columns` of cells lie along the boundary, up to its rotation, and
    `rows` across the strip of exit angles; a box begins with blocks of `coarsest` cells.

    >>> sweep = database(Scene("egg", alpha="1/20"), "alpha", [0.05, 0.06], [0.1, 0.2], 24, 16, 4)
    >>> found = sweep.task(sweep.part((0,) * 6))
    >>> found["sets"].tolist(), found["cells"].shape
    ([[1]], (1, 1, 16, 24))
    """
    if parameter not in scene.shape:
        raise ValueError(
            f"{parameter} is no shape parameter of {scene.name}; accepted: one of {', '.join(scene.shape)}"
        )
    if parameter in TAKEN:
        raise ValueError(f"{parameter} is what a field of the results is called; give the parameter another name")
    if not 0 <= min(lams) < max(lams) < 1:
        raise ValueError(f"lam = {min(lams)} to {max(lams)} is no range; accepted: 0 <= LOW < HIGH < 1")
    if min(len(values), len(lams)) < 2:
        raise ValueError("a box has two ends; give LOW:HIGH:N with N of at least 2 for either parameter")
    if coarsest & (coarsest - 1) or columns % coarsest or rows % coarsest:  # each box would be left unknown
        raise ValueError(f"blocks of {coarsest} are no power of 2 that divides {columns} columns and {rows} rows")
    ends = scene.ranges.get(parameter)
    shapes = [Fraction(repr(float(value))) for value in values]
    if ends is not None:
        low, high = (Fraction(str(end)) for end in ends)
        shapes = [min(max(shape, low), high) for shape in shapes]
    contractions = [Fraction(repr(float(value))) for value in lams]
    family = _varied(scene, parameter, shapes[0], shapes[-1])
    charts, turns = len(family.components), 1 if scene.law.placed else _turns(family)
    start, end = float(scene.table.components[0].start), float(scene.table.components[-1].end)
    task = Graphs(
        text_of(scene), parameter, tuple(map(str, shapes)), tuple(map(str, contractions)), columns, rows, coarsest
    )
    box = (parameter, "lam")
    return Sweep(
        name="morse graphs",
        about=f"Morse graphs over boxes of {parameter} and lam",
        axes=(
            Axis(parameter, _middles(shapes), "1", "middle of a box of the shape parameter", 1),
            Axis("lam", _middles(contractions), "1", "middle of a box of contractions", min(TOGETHER, len(lams) - 1)),
            Axis("row", np.arange(rows), "1", "cell of exit angles"),
            Axis("column", np.arange(charts * columns), "1", "cell along the boundary, up to rotation"),
            Axis("from", np.arange(KNOWN), "1", "Morse set"),
            Axis("to", np.arange(KNOWN), "1", "Morse set"),
        ),
        fields=(
            Field("sets", box, "int16", "1", "Morse sets, the outside among them; -1 where nothing is proved"),
            Field("attracting", box, "int16", "1", "disjoint trapping regions, up to rotation"),
            Field("top", box, "float64", "rad", "half the height of the cells' strip of exit angles"),
            Field("cells", (*box, "row", "column"), "int8", "1", "Morse set of each cell, -1 for none"),
            Field("leads", (*box, "from", "to"), "int8", "1", "1 where a walk leads from set to set"),
        ),
        task=task,
        seed=0,
        scene=text_of(scene),
        settings={
            "parameter": parameter,
            "values": list(task.values),
            "lams": list(task.lams),
            "columns": columns,
            "rows": rows,
            "coarsest": coarsest,
            "turns": turns,
            "theta": [start, start + (end - start) / turns],
        },
        collisions=(len(values) - 1) * (len(lams) - 1) * columns * rows * charts,
        map=partial(map_of, text_of(scene.at(**{parameter: str(shapes[0])})), 0.5),
    )


def _middles(borders: Sequence[Fraction]) -> NDArray[np.float64]:
    return np.array([float((low + high) / 2) for low, high in pairwise(borders)])


def continued(found: "xr.Dataset") -> Numbers:
    """The class of each box of parameters, the largest class first; -1 where its Morse graph is not known."""
    sets, tops = found.sets.values.astype(np.int64), found.top.values
    cells, leads = found.cells.values, found.leads.values
    known = (sets >= 0) & (sets <= KNOWN)
    number = np.arange(sets.size).reshape(sets.shape)
    pairs: list[tuple[int, int]] = []
    for step in ((1, 0), (0, 1)):
        for i, j in np.ndindex(sets.shape[0] - step[0], sets.shape[1] - step[1]):
            here, there = (i, j), (i + step[0], j + step[1])
            if known[here] and known[there]:
                counts = int(sets[here]), int(sets[there])
                met = common(cells[here], cells[there], tops[here], tops[there], counts)
                if same_order(met, leads[here], leads[there]):
                    pairs.append((int(number[here]), int(number[there])))
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    edges = coo_array((np.ones(first.size, dtype=bool), (first, second)), shape=(sets.size, sets.size))
    label = connected_components(edges, directed=False)[1]
    label = np.where(known.ravel(), label, -1)
    names, count = np.unique(label[label >= 0], return_counts=True)
    rank = np.full(int(label.max(initial=0)) + 2, -1)
    rank[names[np.argsort(-count, kind="stable")]] = np.arange(names.size)
    return np.asarray(rank[label].reshape(sets.shape))


def common(
    here: NDArray[np.int8], there: NDArray[np.int8], top_here: float, top_there: float, counts: tuple[int, int]
) -> NDArray[np.bool_]:
    """Which sets of two graphs have cells that overlap; the height of one strip is a power of 2 times the other's.

    A point on the border of cells lies in cells that overlap in more than a border, too, so these are enough.

    >>> one, other = np.array([[0], [1]], dtype=np.int8), np.array([[0], [-1]], dtype=np.int8)
    >>> common(one, other, 1.0, 1.0, (2, 1)).tolist()
    [[True], [False]]
    """
    rows, ratio = here.shape[0], top_here / top_there
    borders = (np.arange(rows + 1) - rows / 2) * ratio + rows / 2  # of the first strip's cells, in cells of the second
    first, last = np.floor(borders[:-1]).astype(np.int64), np.ceil(borders[1:]).astype(np.int64) - 1
    met = np.zeros((counts[0] + 1, counts[1] + 1), dtype=bool)  # the last for no set
    for by in range(int((last - first).max()) + 1):
        row = first + by
        on = (row <= last) & (row >= 0) & (row < rows)
        met[here[on].astype(np.int64), there[row[on]].astype(np.int64)] = True
    return met[:-1, :-1]


def same_order(met: NDArray[np.bool_], here: NDArray[np.int8], there: NDArray[np.int8]) -> bool:
    """Are the sets of two graphs that meet any matched one to one, so that the same lead to the same?

    >>> order = np.array([[1, 1], [0, 1]], dtype=np.int8)
    >>> same_order(np.eye(2, dtype=bool), order, order), same_order(np.ones((2, 2), dtype=bool), order, order)
    (True, False)
    """
    if np.any(met.sum(0) > 1) or np.any(met.sum(1) > 1):
        return False
    first, second = np.nonzero(met)
    return bool(np.array_equal(here[np.ix_(first, first)], there[np.ix_(second, second)]))
