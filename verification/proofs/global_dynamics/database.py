"""A database of Morse graphs: one for each box of contractions and values of a shape parameter, and which of them
continue into each other.

Phase space is covered and mapped for all parameters of a box at once, so each statement holds for all of them. Phase
space and Morse sets are taken modulo the table's rotations: a set stands for one set of the table, or for several that
the rotations exchange.

Two boxes of parameters with a common border are compared on the border. At a parameter of the border each chain
recurrent orbit lies in one Morse set of either graph. So two sets without a common cell share no such orbit, and a set
that meets no set of the other graph holds no such orbit at that parameter. If the remaining sets match one to one, with
the same order of walks between them, matched sets have the same recurrent orbits. Such sets continue from box to box,
as does their Conley index where the map is continuous. Boxes that are connected by such borders form a class. (Arai,
Kalies, Kokubu, Mischaikow, Oka and Pilarczyk 2009, A database schema for the analysis of global dynamics of
multiparameter systems.)
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from numeric.sweeps.sweep import Axis, Field, Sweep, SweepPart, map_of, text_of
from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics.parameter_box import ParameterBox, Range, turns_of, varied
from verification.rigorous.graph import Grid, MorseGraph, morse_graph, refined

if TYPE_CHECKING:
    import xarray as xr

Numbers = NDArray[np.int64]
Cells = NDArray[np.int8]
KNOWN = 40  # Morse sets of a box whose order is kept; a box with more has its count alone
TOGETHER = 32  # contractions of a task, which share landings
TAKEN = {"sets", "attracting", "top", "cells", "leads", "row", "column", "from", "to"}  # names of fields and axes


@dataclass(frozen=True)
class Graphs:
    """A task of the sweep: to compute the Morse graphs of some boxes of parameters."""

    scene: str
    parameter: str
    values: tuple[str, ...]
    lams: tuple[str, ...]
    columns: int
    rows: int
    coarsest: int

    def __call__(self, part: SweepPart) -> dict[str, NDArray[Any]]:
        shapes, lams = (part.values[name] for name in (self.parameter, "lam"))
        made = [list(self.boxes(list(_ranges(self.lams, lams)), shape)) for shape in _ranges(self.values, shapes)]
        names = ("sets", "attracting", "top", "cells", "leads")
        return {name: np.array([[box[i] for box in row] for row in made]) for i, name in enumerate(names)}

    def boxes(self, lams: Sequence[Range], shape: Range) -> Iterator[tuple[int, int, float, Cells, Cells]]:
        """For each box of parameters: the numbers of Morse sets and of trapping ones, the height of the strip, the
        index of the Morse set at each cell, and the matrix of the order of the sets.
        """
        first: ParameterBox | None = None
        for lam in lams:
            cells = np.full((self.rows, self.columns), -1, dtype=np.int8)
            leads = np.full((KNOWN, KNOWN), -1, dtype=np.int8)
            try:
                map = first.at(lam) if first else ParameterBox(Scene.parse(self.scene), lam, self.parameter, shape)
                first = map
                graph = morse_graph(refined(map, Grid(map.charts, self.columns, self.rows), self.coarsest))
            except ValueError:  # not proved convex, or too many sets
                yield -1, -1, np.nan, cells, leads
                continue
            attracting = sum(not graph.trapping(index)[-1] for index in graph.attracting)
            if len(graph.sets) <= KNOWN:
                cells = _painted(graph)
                leads[: len(graph.sets), : len(graph.sets)] = graph.below
            yield len(graph.sets), attracting, map.height, cells, leads


def _painted(graph: MorseGraph) -> NDArray[np.int8]:
    """The index of the Morse set at each cell, as an array of rows and columns; -1 for a cell in no Morse set."""
    label = np.full(graph.transitions.count + 1, -1, dtype=np.int64)
    for index, members in enumerate(graph.sets):
        label[members] = index
    leaf = graph.transitions.leaf
    grid = graph.transitions.grid
    painted = grid.to_array(graph.transitions.chosen(np.append(leaf, False)), label[:-1][leaf], -1)
    return np.asarray(np.concatenate(list(painted)).T.astype(np.int8))


def _ranges(borders: Sequence[str], middles: NDArray[np.float64]) -> Iterator[Range]:
    """For each of the `middles`, the interval between successive `borders` that holds it, as a pair of fractions."""
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
    """The sweep over boxes of parameters between the `values` of a shape parameter and between the contractions `lams`.

    Each float stands for its shortest decimal. `columns` of cells lie along the boundary, modulo its rotation, and
    `rows` across the strip of exit angles; the subdivision begins with blocks of `coarsest` cells.

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
        raise ValueError(f"{parameter} is the name of a field of the results; give the parameter another name")
    if not 0 <= min(lams) < max(lams) < 1:
        raise ValueError(f"lam = {min(lams)} to {max(lams)} is no range; accepted: 0 <= LOW < HIGH < 1")
    if min(len(values), len(lams)) < 2:
        raise ValueError(
            "one value bounds no box of parameters; give LOW:HIGH:N with N of at least 2 for both parameters"
        )
    if coarsest & (coarsest - 1) or columns % coarsest or rows % coarsest:  # each box would be left unknown
        raise ValueError(
            f"coarsest = {coarsest}; accepted: a power of 2 that divides {columns} columns and {rows} rows"
        )
    ends = scene.ranges.get(parameter)
    shapes = [Fraction(repr(float(value))) for value in values]
    if ends is not None:
        low, high = (Fraction(str(end)) for end in ends)
        shapes = [min(max(shape, low), high) for shape in shapes]
    contractions = [Fraction(repr(float(value))) for value in lams]
    family = varied(scene, parameter, shapes[0], shapes[-1])
    charts, turns = len(family.components), 1 if scene.law.placed else turns_of(family)
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
        python=True,
    )


def _middles(borders: Sequence[Fraction]) -> NDArray[np.float64]:
    return np.array([float((low + high) / 2) for low, high in pairwise(borders)])


def continued(found: "xr.Dataset") -> Numbers:
    """The class of each box of parameters, 0 for the largest class; -1 where the box's Morse graph is unknown."""
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
    """A matrix that says which sets of two graphs have overlapping cells; the strips' heights differ by a power of 2.

    `here` and `there` have the index of the set of each cell, -1 for none; `counts` are the numbers of sets. Cells that
    share only a border can be ignored, as each point of the border also lies in cells that overlap.

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
    """True if the sets that meet (by the matrix `met`) match one to one, and walks connect them in the same way.

    `here` and `there` are matrices that say which set of a graph leads to which.

    >>> order = np.array([[1, 1], [0, 1]], dtype=np.int8)
    >>> same_order(np.eye(2, dtype=bool), order, order), same_order(np.ones((2, 2), dtype=bool), order, order)
    (True, False)
    """
    if np.any(met.sum(0) > 1) or np.any(met.sum(1) > 1):
        return False
    first, second = np.nonzero(met)
    return bool(np.array_equal(here[np.ix_(first, first)], there[np.ix_(second, second)]))
