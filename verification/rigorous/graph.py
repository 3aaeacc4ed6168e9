"""A grid on phase space, the transition graph of its cells, and what the graph proves of every orbit.

Each chart is cut into equal cells. The vertices of the graph are *leaves*: square blocks of cells, smaller where orbits
may return. A leaf has an edge to every leaf that its enclosed image meets, so every orbit follows a walk in the graph:

- An infinite walk stays, from some step on, in one strongly connected component with an edge inside. Such components
  are the Morse sets; from some bounce on, every infinite orbit stays in one of them.
- Leaves from which no edge leads away are a trapping region, also called an attractor block: the map takes them into
  their interior.
- A leaf from which every walk ends in a trapping region lies in its basin.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components

from numeric.pinball.states import equal, many
from verification.arithmetic.arrays import Indices, Mask
from verification.rigorous.boxes import Boxes, BoxMap, Chart, Images

BLOCK = 1 << 14  # boxes mapped in one call: their arrays fit in the cache
PAD = 1e-7  # in cells: more than the rounding of an index, up to LARGEST columns or rows
TURNED, FAR = 2.0**-44, 2.0**50  # many turns away: the relative rounding of an index, and where one is not known
LARGEST = 1 << 20
CELLS = 1 << 24  # the most cells in all charts together: their counts take 300 MB
Told = Callable[[float], None]  # called with the finished share of a long computation
EDGES = 1 << 28  # the most edges: their indices take up to two gigabytes


class Cells(NamedTuple):
    """Square blocks of `size` by `size` cells: the chart, and the first column and row of each."""

    chart: Indices
    column: Indices
    row: Indices
    size: Indices


class Rectangles(NamedTuple):
    """Ranges of cells that images meet; columns `left` to `right` may exceed the last column by up to a full turn."""

    source: Indices
    chart: Indices
    left: Indices
    right: Indices
    bottom: Indices
    top: Indices
    out: Mask  # true where the image leaves the chart


@dataclass(frozen=True)
class Grid:
    """A grid of `columns` by `rows` cells in each chart.

    `ValueError` with more than `most` cells in all, and for a chart without inner points or with an end that is no
    double.

    >>> from verification.rigorous.boxes import Chart
    >>> grid = Grid((Chart("plane", (0, 1), (0, 1)),), 4, 2)
    >>> [round(float(end[0]), 9) + 0.0 for end in grid.boxes(grid.whole(2)).x]
    [0.0, 0.5]
    """

    charts: tuple[Chart, ...]
    columns: int
    rows: int
    most: int = CELLS

    def __post_init__(self) -> None:
        if not (1 <= self.columns <= LARGEST and 1 <= self.rows <= LARGEST):
            raise ValueError(f"grid: {self.columns} by {self.rows} cells; accepted: 1 to {LARGEST} each way")
        if self.columns * self.rows * len(self.charts) > self.most:
            raise ValueError(f"grid: {self.columns} by {self.rows} cells in each chart; accepted: {self.most} in all")
        for chart in self.charts:
            for low, high in (chart.x, chart.y):
                if not (float(low) == low and float(high) == high and 1e-300 < high - low < 1e300):
                    raise ValueError(f"grid: {chart}; accepted: ends that are doubles, the low one below the high one")

    def whole(self, size: int = 1) -> Cells:
        """Blocks of `size` by `size` cells that cover all charts."""
        if self.columns % size or self.rows % size:
            raise ValueError(
                f"grid: {self.columns} by {self.rows} cells cannot be divided into blocks of {size} by {size}"
            )
        shape = len(self.charts), self.columns // size, self.rows // size
        chart, column, row = (index.ravel() for index in np.indices(shape))
        return Cells(chart, column * size, row * size, np.full(chart.size, size))

    def boxes(self, cells: Cells) -> Boxes:
        """The blocks as boxes of phase space, rounded outwards."""
        ends = []
        for side, first, count in (("x", cells.column, self.columns), ("y", cells.row, self.rows)):
            low, high = (np.array([getattr(chart, side)[i] for chart in self.charts])[cells.chart] for i in (0, 1))
            step = (high - low) / count
            slop = 1e-15 * (np.abs(low) + np.abs(high))
            ends.append((low + first * step - slop, low + (first + cells.size) * step + slop))
        return Boxes(cells.chart, *ends)

    def met(self, images: Images) -> Rectangles:
        """The ranges of cells that closed rectangles meet, including cells that share only a border point with one.

        A rectangle whose low end is above its high end, or whose ends are not finite, counts as leaving the chart.
        """
        boxes, found = images.boxes, []
        unknown = ~np.logical_and.reduce([(-np.inf < a) & (a <= b) & (b < np.inf) for a, b in (boxes.x, boxes.y)])
        out = unknown.copy()
        kept, turning = (np.array([getattr(c, name) for c in self.charts])[boxes.chart] for name in ("kept", "period"))
        for side, ends, count in (("x", boxes.x, self.columns), ("y", boxes.y, self.rows)):
            low, high = (np.array([getattr(chart, side)[i] for chart in self.charts])[boxes.chart] for i in (0, 1))
            scale = count / (high - low)
            first, last = (np.clip((np.where(unknown, low, end) - low) * scale, -2 * FAR, 2 * FAR) for end in ends)
            first = np.floor(first - np.maximum(PAD, np.abs(first) * TURNED))
            last = np.floor(last + np.maximum(PAD, np.abs(last) * TURNED))
            bounded = ~turning if side == "x" else np.ones(out.shape, dtype=bool)
            out |= bounded & ~kept & ((first < 0) | (last >= count))
            first, last = (np.where(bounded, np.clip(i, 0, count - 1), i) for i in (first, last))
            if side == "x":
                far = turning & (np.abs(first) > FAR)
                first, last = np.where(far, 0, first), np.where(far, count, last)
                last = np.where(turning, np.minimum(last, first + count - 1), last)
                first, last = (i - np.where(turning, np.floor(first / count) * count, 0) for i in (first, last))
            found += [first.astype(np.int64), last.astype(np.int64)]
        left, right, bottom, top = found
        return Rectangles(images.source, boxes.chart, left, right, bottom, top, out)

    def to_array(self, cells: Cells, values: Indices | Mask, empty: int = 0) -> NDArray[np.int32]:
        """An array over all cells, of shape `(charts, columns, rows)`, with the value of each block at its cells."""
        picture = np.full((len(self.charts), self.columns, self.rows), empty, dtype=np.int32)
        for size in np.unique(cells.size):
            on = np.flatnonzero(cells.size == size)
            chart, column, row, value = cells.chart[on], cells.column[on], cells.row[on], values[on]
            if on.size < size * size:
                for k, a, b, each in zip(chart, column, row, value, strict=True):
                    picture[k, a : a + size, b : b + size] = each
            else:
                for i, j in np.ndindex(size, size):
                    picture[chart, column + i, row + j] = value
        return picture


def halved(cells: Cells) -> Cells:
    """Each block cut into four blocks of half the size."""
    size = cells.size // 2
    parts = [(i, j) for i in (0, 1) for j in (0, 1)]
    column = np.concatenate([cells.column + i * size for i, _ in parts])
    row = np.concatenate([cells.row + j * size for _, j in parts])
    return Cells(np.tile(cells.chart, 4), column, row, np.tile(size, 4))


def mapped(map: BoxMap, grid: Grid, cells: Cells, parts: int = 1, told: Told | None = None) -> tuple[Rectangles, Mask]:
    """Cells that images of blocks meet, with blocks cut into `parts` by `parts`; and a mask of blocks not enclosed.

    A block is not enclosed if the map calls one of its pieces lost, or returns no image of one.
    """
    found, lost = [], np.zeros(cells.chart.size, dtype=bool)
    step = max(1, BLOCK // parts**2)
    for start in range(0, cells.chart.size, step):
        some = Cells(*(field[start : start + step] for field in cells))
        boxes, source = grid.boxes(some).parts(parts, parts)
        images = map.images(boxes)
        met = grid.met(images)
        unknown = np.ones(source.size, dtype=bool)
        unknown[images.source] = False
        unknown[images.lost] = True
        lost[start + source[unknown]] = True
        found.append(met._replace(source=start + source[met.source]))
        if told is not None:
            told(min(1.0, (start + step) / cells.chart.size))
    if not found:
        raise ValueError("no boxes to map; give a grid with at least one")
    return Rectangles(*(np.concatenate(column) for column in zip(*found, strict=True))), lost


def inside(grid: Grid, cells: Cells, met: Rectangles, lost: Mask) -> Mask:
    """True for each block whose image the union of the blocks covers; cells are counted, and no edges are built."""
    member = grid.to_array(cells, np.ones(cells.chart.size, dtype=bool))
    doubled = np.concatenate([member, member], axis=1).cumsum(1, dtype=np.int64).cumsum(2, dtype=np.int64)
    total = np.pad(doubled, ((0, 0), (1, 0), (1, 0)))
    a, b, c, d = met.left, met.right + 1, met.bottom, met.top + 1
    held = total[met.chart, b, d] - total[met.chart, a, d] - total[met.chart, b, c] + total[met.chart, a, c]
    good = (held == (b - a) * (d - c)) & ~met.out
    result = ~lost
    result[met.source[~good]] = False
    return result


@dataclass(frozen=True)
class Transitions:
    """A transition graph: one vertex for each block of `cells`, and a last vertex for the outside.

    A block that was refined is no longer a `leaf`; it has edges to its four parts, as other blocks may still have edges
    to it. A leaf without a proved image, or whose image leaves the charts, has an edge to the outside, which in turn
    has an edge to every block, as an orbit may do anything outside.
    """

    grid: Grid
    cells: Cells
    leaf: Mask
    edges: csr_matrix

    @property
    def count(self) -> int:
        """The number of blocks, leaves or not."""
        return int(self.leaf.size)

    def chosen(self, vertices: Mask) -> Cells:
        """The leaves in a mask of vertices, as cells."""
        return Cells(*(field[vertices[:-1] & self.leaf] for field in self.cells))

    @cached_property
    def components(self) -> Indices:
        """The strongly connected component of each vertex."""
        found = connected_components(self.edges, directed=True, connection="strong")
        return np.asarray(found[1], dtype=np.int64)

    @cached_property
    def recurrent(self) -> Mask:
        """The vertices that lie on a closed walk."""
        sizes = np.bincount(self.components)
        return np.asarray((sizes[self.components] > 1) | self.edges.diagonal())

    def complete(self, members: Mask) -> bool:
        """True if all edges on closed walks through the `members` join two leaves.

        A walk through a refined block would be missed by code that reads the edges between leaves only. If the
        enclosures of the parts lie in that of the block, which is not guaranteed, the answer is always True.
        """
        cut = np.append(~self.leaf, False) & self.recurrent
        return not np.any(np.isin(self.components[cut], self.components[members & np.append(self.leaf, False)]))

    @cached_property
    def condensed(self) -> tuple[csr_matrix, csr_matrix]:
        """The graph of strongly connected components, and the same graph with reversed edges."""
        labels, size = self.components, int(self.components.max()) + 1
        labels = labels.astype(np.int32)
        source, target = np.repeat(labels, np.diff(self.edges.indptr)), labels[self.edges.indices]
        between = source != target
        graph = sparse(source[between], target[between], size).astype(np.float64)  # as SciPy's search takes it
        return graph, graph.T.tocsr()

    def connected(self, start: Mask) -> Mask:
        """Leaves on walks from `start` back to it; if all of them are in `start`, orbits that leave it never return."""
        found: Mask = self.reached(start) & self.reached(start, backward=True) & np.append(self.leaf, True)
        return found

    def reached(self, start: Mask, backward: bool = False) -> Mask:
        """The vertices of walks from `start`, itself included; or if `backward`, the vertices of walks to `start`."""
        graph = self.condensed[1 if backward else 0]
        size = graph.shape[0]
        first = np.unique(self.components[start])
        indptr = np.append(graph.indptr, graph.indptr[-1] + first.size)  # a new vertex, with edges to the starts
        indices = np.append(graph.indices, first.astype(graph.indices.dtype))
        whole = csr_matrix((np.ones(indices.size), indices, indptr), shape=(size + 1, size + 1))
        met = np.zeros(size + 1, dtype=bool)
        met[breadth_first_order(whole, size, return_predecessors=False)] = True
        return met[self.components]


Arrows = tuple[NDArray[np.int32], NDArray[np.int32]]  # sources and targets; OUTSIDE stands for the outside
OUTSIDE = -1


def transitions(map: BoxMap, grid: Grid, cells: Cells, parts: int = 1, told: Told | None = None) -> Transitions:
    """The transition graph of blocks that cover phase space or a part of it; the uncovered part counts as outside.

    `ValueError` unless each block is one of `grid.whole(size)`, for its own `size`.
    """
    ends = ((cells.column, grid.columns), (cells.row, grid.rows))
    if any(np.any((count % cells.size != 0) | (at % cells.size != 0) | (at < 0) | (at >= count)) for at, count in ends):
        raise ValueError("grid: a block overlaps blocks of Grid.whole of its size; accepted: blocks of Grid.whole")
    everywhere = np.arange(cells.chart.size)
    return joined(grid, cells, everywhere >= 0, arrows(map, grid, cells, everywhere, everywhere, parts, told))


def arrows(
    map: BoxMap,
    grid: Grid,
    cells: Cells,
    new: Indices,
    leaves: Indices,
    parts: int,
    told: Callable[[float], None] | None,
) -> Arrows:
    """Edges from the blocks `new` (cut into `parts` by `parts`) to the blocks `leaves`, as indices in `cells`."""
    some = Cells(*(field[new] for field in cells))
    if not new.size:
        return np.zeros(0, dtype=np.int32), np.zeros(0, dtype=np.int32)
    met, lost = mapped(map, grid, some, parts, told)
    unit = int(some.size.min())  # the size of the smallest leaves, in which images are counted
    columns, rows = grid.columns // unit, grid.rows // unit
    coarse = Cells(cells.chart[leaves], *(field[leaves] // unit for field in cells[1:]))
    named = lookup(Grid(grid.charts, columns, rows, grid.most), coarse, leaves)
    left, right, bottom, top = (side // unit for side in met[2:6])
    across, high = right - left + 1, top - bottom + 1
    if int((across * high).sum()) > EDGES:
        raise ValueError(f"grid: {int((across * high).sum())} edges, at most {EDGES} fit; use fewer or smaller boxes")
    away = np.union1d(np.flatnonzero(lost), met.source[met.out])
    numbers = new.astype(np.int32)
    sources, targets = [numbers[away]], [np.full(away.size, OUTSIDE, dtype=np.int32)]
    for start in range(0, met.source.size, BLOCK):
        piece = slice(start, start + BLOCK)
        owner = np.repeat(np.arange(start, start + across[piece].size), across[piece])
        column = met.chart[owner] * columns + ranges(left[piece], right[piece] + 1) % columns
        first = column * rows + bottom[owner]
        target = named(ranges(first, first + high[owner]))
        begin = np.cumsum(across[piece] * high[piece]) - across[piece] * high[piece]
        fresh = np.append(True, target[1:] != target[:-1])  # a block of several cells may be met more than once
        fresh[begin] = True
        sources.append(np.repeat(numbers[met.source[piece]], np.add.reduceat(fresh, begin, dtype=np.int64)))
        targets.append(target[fresh])
    return np.concatenate(sources), np.concatenate(targets)


def lookup(grid: Grid, blocks: Cells, names: Indices) -> Callable[[Indices], NDArray[np.int32]]:
    """A function from cell numbers to the `names` of the blocks that hold them, or to `OUTSIDE` if no block does.

    The function reads an array of all cells or, if these are too many, the sorted numbers of the blocks of each size.
    """
    if grid.columns * grid.rows * len(grid.charts) <= CELLS:
        picture = grid.to_array(blocks, names, OUTSIDE).ravel()
        return lambda cells: picture[cells]
    tables = []
    for size in np.unique(blocks.size):
        on = np.flatnonzero(blocks.size == size)
        column, row = (blocks.chart[on] * grid.columns + blocks.column[on]) // size, blocks.row[on] // size
        keys = column * (grid.rows // size) + row
        order = np.argsort(keys)
        tables.append((size, keys[order], names[on][order]))

    def named(cells: Indices) -> NDArray[np.int32]:
        found = np.full(cells.shape, OUTSIDE, dtype=np.int32)
        for size, keys, values in tables:
            key = cells // grid.rows // size * (grid.rows // size) + cells % grid.rows // size
            at = np.minimum(np.searchsorted(keys, key), keys.size - 1)
            found = np.where(keys[at] == key, values[at], found).astype(np.int32)
        return found

    return named


def joined(grid: Grid, cells: Cells, leaf: Mask, edges: Arrows) -> Transitions:
    """The transition graph with the given edges, to which the edges of the outside are added."""
    count = leaf.size
    source = np.concatenate([edges[0], np.full(count + 1, count, dtype=np.int32)])
    target = np.concatenate([edges[1], np.arange(count + 1, dtype=np.int32)])
    target = np.where(target == OUTSIDE, np.int32(count), target)
    return Transitions(grid, cells, leaf, sparse(source, target, count + 1))


def sparse(source: NDArray[np.int32], target: NDArray[np.int32], size: int) -> csr_matrix:
    """The adjacency matrix of a graph of `size` vertices in compressed rows, with each edge once.

    With repeated edges, SciPy's `connected_components` may not end.

    >>> sparse(np.array([0, 0, 1]), np.array([1, 1, 0]), 2).nnz
    2
    """
    return csr_matrix((np.ones(target.size, dtype=bool), (source, target)), shape=(size, size))


def ranges(first: Indices, last: Indices) -> Indices:
    """The integers from `first` up to `last - 1` for each pair of entries, concatenated.

    >>> ranges(np.array([3, 10]), np.array([5, 13]))
    array([ 3,  4, 10, 11, 12])
    """
    lengths = np.asarray(last - first, dtype=np.int64)
    starts = np.cumsum(lengths) - lengths
    return np.arange(lengths.sum()) - np.repeat(starts - first, lengths)


@dataclass(frozen=True, eq=False, repr=False)
class MorseGraph:
    """The Morse sets of a transition graph, largest first, and their order.

    `below[i, j]` is True where a walk leads from set `i` to set `j`. One attractor and its neighbourhood may be
    spread over several sets; a set may hold no orbit at all.
    """

    transitions: Transitions
    sets: tuple[Indices, ...]
    below: Mask

    def __repr__(self) -> str:
        return f"MorseGraph({many(len(self.sets), 'Morse set')}, {len(self.attracting)} attracting)"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MorseGraph):
            return False
        one, two = ((each.transitions.cells, each.transitions.grid, each.sets, each.below) for each in (self, other))
        return equal(one, two)

    __hash__ = None  # type: ignore[assignment]

    @property
    def attracting(self) -> tuple[int, ...]:
        """The indices of the sets from which no walk leads to another set."""
        return tuple(i for i in range(len(self.sets)) if not np.any(np.delete(self.below[i], i)))

    def trapping(self, index: int) -> Mask:
        """The leaves that walks from a Morse set reach, a trapping region unless the outside is among them."""
        return self.transitions.reached(self._set(index))

    def basin(self, block: Mask) -> Mask:
        """The leaves from which every walk ends in the trapping region `block`."""
        other = self.transitions.recurrent & ~block
        return ~self.transitions.reached(other, backward=True)

    def _set(self, index: int) -> Mask:
        start = np.zeros(self.transitions.count + 1, dtype=bool)
        start[self.sets[index]] = True
        return start


MOST = 400  # the most Morse sets whose order is computed


def morse_graph(transitions: Transitions) -> MorseGraph:
    """The Morse graph of a transition graph; the outside counts as a Morse set if a walk reaches it."""
    labels, recurrent = transitions.components, transitions.recurrent.copy()
    recurrent[-1] = np.any(transitions.edges.indices[: transitions.edges.indptr[-2]] == transitions.count)
    vertices = np.flatnonzero(recurrent)
    vertices = vertices[np.argsort(labels[vertices], kind="stable")]
    cuts = np.flatnonzero(np.diff(labels[vertices])) + 1
    sets = sorted(np.split(vertices, cuts), key=lambda some: (-some.size, some[0])) if vertices.size else []
    if len(sets) > MOST:
        raise ValueError(f"{len(sets)} Morse sets, at most {MOST} are ordered; use smaller boxes or another lam")
    graph, first = transitions.condensed[0], [labels[members[0]] for members in sets]
    below = np.zeros((len(sets), len(sets)), dtype=bool)
    for i, label in enumerate(first):
        below[i] = np.isin(first, breadth_first_order(graph, label, return_predecessors=False))
    return MorseGraph(transitions, tuple(sets), below)


def refined(
    map: BoxMap,
    grid: Grid,
    coarsest: int,
    parts: int = 1,
    told: Told | None = None,
    absorbed: Callable[[Boxes], Mask] | None = None,
    joint: Callable[[Boxes], Mask] | None = None,
) -> Transitions:
    """The transition graph that starts with blocks of `coarsest` cells and halves them where orbits may return.

    Blocks are cut into `parts` by `parts` pieces before they are mapped. Boxes for which `absorbed` is True have no
    edges, as orbits that enter them are not followed. A walk from one of the `joint` boxes to another counts as
    returning. `ValueError` unless `coarsest` is a power of 2.
    """
    if coarsest & (coarsest - 1):
        raise ValueError(f"grid: blocks of {coarsest} cells cannot be halved down to one; use a power of 2")
    cells = grid.whole(coarsest)
    leaf = np.ones(cells.chart.size, dtype=bool)
    first, found, halves = 0, list[Arrows](), list[Arrows]()
    while True:
        new = np.arange(first, leaf.size)
        going = new
        if absorbed is not None:
            going = new[~absorbed(grid.boxes(Cells(*(field[new] for field in cells))))]
        found.append(arrows(map, grid, cells, going, np.flatnonzero(leaf), parts, told))
        cut = new[cells.size[new] > 1]
        if cut.size:  # orbits return only among these: a block without return has no part with one
            source, target = (ends[(found[-1][1] >= first) | (found[-1][1] == OUTSIDE)] for ends in found[-1])
            inner = source - np.int32(first), np.maximum(target - np.int32(first), OUTSIDE)
            graph = joined(grid, Cells(*(field[new] for field in cells)), leaf[new], inner)
            returning = graph.recurrent
            if joint is not None:
                returning = returning | graph.connected(np.append(joint(grid.boxes(graph.cells)), False))
            cut = cut[returning[:-1]]
        if not cut.size:
            break
        first = leaf.size
        fine = halved(Cells(*(field[cut] for field in cells)))
        cells = Cells(*(np.concatenate(pair) for pair in zip(cells, fine, strict=True)))
        leaf = np.concatenate([leaf, np.ones(4 * cut.size, dtype=bool)])
        leaf[cut] = False
        halves.append((np.tile(cut, 4).astype(np.int32), np.arange(first, leaf.size, dtype=np.int32)))
    kept = [(source[leaf[source]], target[leaf[source]]) for source, target in found]
    source, target = (np.concatenate(ends) for ends in zip(*kept, *halves, strict=True))
    return joined(grid, cells, leaf, (source, target))
