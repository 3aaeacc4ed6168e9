"""Refined graphs of boxes and growing sets of cells, against all cells and all walks of a small grid."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from verification.rigorous.absorbing import cells, numbered, reached
from verification.rigorous.boxes import Boxes, Chart, Images, collected
from verification.rigorous.graph import Cells, Grid, MorseGraph, Transitions, mapped, morse_graph, refined

SQUARE = Chart("square", (0.0, 1.0), (0.0, 1.0), False, True)


class Drawn:
    """The square is contracted about a point and turned upside down; images of boxes in one corner are lost."""

    charts = (SQUARE,)

    def __init__(self, factor=0.45, corner=0.7, centre=(0.3, 0.7)):
        self.factor, self.corner, self.centre, self.asked = factor, corner, centre, []

    def images(self, boxes):
        self.asked.append(boxes.chart.size)
        away = (boxes.x[0] > self.corner) & (boxes.y[0] > self.corner)
        on = np.flatnonzero(~away)
        x = tuple(self.centre[0] + self.factor * (end[on] - self.centre[0]) for end in boxes.x)
        y = tuple(self.centre[1] - self.factor * (end[on] - self.centre[1]) for end in boxes.y[::-1])
        return Images(on, Boxes(boxes.chart[on], x, y), np.flatnonzero(away))


def blocks(cells, k):
    """The columns and rows of a block, as sets of cells."""
    column, row, size = (int(field[k]) for field in cells[1:])
    return {(i, j) for i in range(column, column + size) for j in range(row, row + size)}


def targets(found, vertex):
    return set(found.edges.indices[found.edges.indptr[vertex] : found.edges.indptr[vertex + 1]].tolist())


@pytest.mark.parametrize(
    "given", [(0.45, 0.7), (0.45, 2.0), (0.9, 2.0), (1.0, 0.5), (0.1, 2.0, (0.01, 0.01)), (0.1, 2.0, (0.99, 0.99))]
)
def test_a_refined_graph_has_every_cell_and_every_edge(given):
    """Also if all orbits end in the first or the last cell."""
    map, grid = Drawn(*given), Grid((SQUARE,), 16, 16)
    found = refined(map, grid, 4)
    leaves, outside = np.flatnonzero(found.leaf), found.count
    counted = [cell for k in leaves for cell in blocks(found.cells, k)]
    met, lost = mapped(map, grid, found.cells)
    image = {
        k: {(i, j) for i in range(a, b + 1) for j in range(c, d + 1)} for k, _, a, b, c, d, _ in zip(*met, strict=True)
    }

    assert sorted(counted) == [(i, j) for i in range(16) for j in range(16)]
    for k in range(found.count):
        there = targets(found, k)
        if not found.leaf[k]:
            assert len(there) == 4
            assert set().union(*(blocks(found.cells, part) for part in there)) == blocks(found.cells, k)
            continue
        assert (outside in there) is bool(lost[k])
        assert all(blocks(found.cells, t) & image[k] for t in there - {outside})
        inner = there - {outside}
        while not all(found.leaf[t] for t in inner):
            inner = {part for t in inner for part in ([t] if found.leaf[t] else targets(found, t))}
        if k in image:
            assert image[k] <= set().union(*(blocks(found.cells, t) for t in inner))
    assert targets(found, outside) == set(range(found.count + 1))
    assert not np.any(found.recurrent[:-1] & found.leaf & (found.cells.size > 1))
    with pytest.raises(ValueError, match="power of 2"):
        refined(map, grid, 3)


@pytest.mark.parametrize("columns", [1024, 8192])
def test_orbits_return_at_the_fixed_point_alone_and_nowhere_when_it_absorbs(columns):
    """On small grids, and on grids beyond one array; adjacent boxes are cut together with all between them."""
    map, grid = Drawn(0.45, 2.0), Grid((SQUARE,), columns, columns, most=1 << 26)

    def about(boxes, reach=0.01):
        ends = zip(map.centre, (boxes.x, boxes.y), strict=True)
        return np.all([(low > c - reach) & (high < c + reach) for c, (low, high) in ends], axis=0)

    def apart(boxes):
        return (boxes.x[0] > 0.98) & (boxes.y[0] > 0.98)

    alone, absorbing, joint = (
        refined(map, grid, columns // 8, **given) for given in ({}, {"absorbed": about}, {"joint": apart})
    )
    low, high = (np.array(ends)[:, alone.leaf & alone.recurrent[:-1]] for ends in grid.boxes(alone.cells)[1:])

    assert low.size
    assert np.all((low[0] < 0.3 + 3 / columns) & (low[1] > 0.3 - 3 / columns))
    assert np.all((high[0] < 0.7 + 3 / columns) & (high[1] > 0.7 - 3 / columns))
    assert not np.any(absorbing.recurrent[:-1])
    assert np.all(joint.cells.size[joint.leaf & apart(grid.boxes(joint.cells))] == 1)
    some = np.append(joint.leaf & apart(grid.boxes(joint.cells)), False)
    assert np.array_equal(joint.connected(some), some)


def linked(seed, outside):
    """Ten boxes with random edges, also from or to the outside; the matrix of edges, and that of walks."""
    random = np.random.default_rng(seed)
    once = random.random((11, 11)) < 0.1
    once[-1], once[:, -1] = outside, once[:, -1] & outside
    grid = Grid((SQUARE,), 10, 1)
    walks = once
    for _ in range(11):
        walks = walks | (walks.astype(int) @ once.astype(int) > 0)
    return Transitions(grid, grid.whole(), np.ones(10, dtype=bool), csr_matrix(once)), once, walks


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("outside", [False, True])
def test_morse_sets_and_their_order_are_those_of_all_walks(seed, outside):
    made, once, walks = linked(seed, outside)
    returning = np.diag(walks).copy()
    returning[-1] = once[:-1, -1].any()
    both = walks & walks.T | np.eye(11, dtype=bool)
    sets = sorted({tuple(np.flatnonzero(both[k] & returning)) for k in np.flatnonzero(returning)})
    sets.sort(key=lambda some: (-len(some), some[0]))
    found = morse_graph(made)

    assert [tuple(some) for some in found.sets] == sets
    order = [[i == j or bool(walks[a[0], b[0]]) for j, b in enumerate(sets)] for i, a in enumerate(sets)]
    assert found.below.tolist() == order
    assert found.attracting == tuple(i for i, row in enumerate(order) if sum(row) == 1)
    for i, some in enumerate(sets):
        onwards = np.any(walks[list(some)], axis=0)
        onwards[list(some)] = True
        assert np.array_equal(found.trapping(i), onwards)
        back = np.any(walks[:, list(some)], axis=1)
        back[list(some)] = True
        start = np.isin(np.arange(11), some)
        assert np.array_equal(made.reached(start, backward=True), back)


def test_what_is_reached_are_all_cells_that_images_meet_again_and_again():
    map, grid = Drawn(0.8, 2.0), Grid((SQUARE,), 12, 12)
    start = Boxes(np.zeros(1, dtype=int), (np.array([0.9]), np.array([0.95])), (np.array([0.1]), np.array([0.12])))
    found = reached(map, grid, start, 1)
    wanted = set(numbered(grid, grid.met(Images(np.zeros(1, dtype=int), start, np.zeros(0, dtype=int)))).tolist())
    while True:
        met, _ = mapped(map, grid, cells(grid, np.array(sorted(wanted))))
        more = wanted | set(numbered(grid, met).tolist())
        if more == wanted:
            break
        wanted = more
    assert found.tolist() == sorted(wanted)
    assert np.array_equal(reached(map, grid, start, 1, most=found.size), found)
    assert reached(map, grid, start, 1, most=found.size - 1) is None
    assert reached(Drawn(0.8, 0.5), grid, start._replace(y=(np.array([0.6]),) * 2), 1) is None  # a box is lost
    leaves = Drawn(1.5, 2.0)
    leaves.charts = (SQUARE._replace(kept=False),)
    assert reached(leaves, Grid(leaves.charts, 12, 12), start, 1) is None  # or leaves the chart


@pytest.mark.parametrize("bad", [None, 0, 1, 2, 3])
def test_a_box_with_an_end_that_is_not_finite_is_lost(bad):
    """Boxes 0 to 3 have two, one, no and one rectangles."""
    ends = [np.array([[0.0, 1, 3], [5, 6, 7]]), np.array([[1.0, 2, 4], [6, 7, 8]])] * 2
    ends = [end.copy() for end in ends]
    if bad is not None:
        ends[bad][0, 0] = (np.inf, -np.inf, np.nan, np.inf)[bad]
    rows = [(np.array([0, 1, 3]), np.array([0, 1, 0]), *(end[0] for end in ends)),
            (np.array([0]), np.array([1]), *(end[1, :1] for end in ends))]  # fmt: skip
    found = collected(rows, 4)
    assert found.lost.tolist() == ([2] if bad is None else [0, 2])
    assert found.source.tolist() == ([0, 1, 3, 0] if bad is None else [1, 3])
    assert found.boxes.chart.tolist() == ([0, 1, 0, 1] if bad is None else [1, 0])
    for k, side in enumerate((*found.boxes.x, *found.boxes.y)):
        assert side.tolist() == ([*ends[k][0], ends[k][1, 0]] if bad is None else [*ends[k][0, 1:]])


def random_graph(seed: int, cut: bool) -> Transitions:
    """A graph of twelve blocks with random edges to each other and to the outside; `cut` blocks are not leaves."""
    rng, count = np.random.default_rng(seed), 12
    edges = rng.random((count + 1, count + 1)) < 0.09
    edges[-1] = False
    leaf = np.ones(count, dtype=bool)
    leaf[:2] = not cut
    cells = Cells(np.zeros(count, int), np.arange(count), np.zeros(count, int), np.ones(count, int))
    grid = Grid((Chart("one", (0.0, 1.0), (0.0, 1.0)),), count, 1)
    return Transitions(grid, cells, leaf, csr_matrix(edges))


def closure(graph: Transitions) -> np.ndarray:
    """The matrix that says whether a walk of at least one step leads from one vertex to another."""
    once = graph.edges.toarray() > 0
    walks = once
    for _ in range(graph.count + 1):
        walks = walks | (walks.astype(int) @ once.astype(int) > 0)
    return walks


@pytest.mark.parametrize("seed", range(12))
def test_a_basin_is_that_from_which_no_walk_leads_to_another_closed_walk(seed):
    graph = random_graph(seed, cut=False)
    walks = closure(graph)
    block = np.zeros(graph.count + 1, dtype=bool)
    block[np.random.default_rng(seed).integers(0, graph.count, 4)] = True
    other = np.diag(walks) & ~block
    wanted = ~(other | np.any(walks[:, other], axis=1))
    assert np.array_equal(graph.recurrent, np.diag(walks))
    assert np.array_equal(MorseGraph(graph, (), np.zeros((0, 0), bool)).basin(block), wanted)


@pytest.mark.parametrize("seed", range(12))
def test_edges_are_complete_where_no_cut_block_is_on_a_closed_walk(seed):
    graph = random_graph(seed, cut=True)
    walks = closure(graph)
    for at in range(2, graph.count):
        members = np.zeros(graph.count + 1, dtype=bool)
        members[at] = True
        met = any(walks[at, k] and walks[k, at] for k in (0, 1))
        assert graph.complete(members) is not met
    outside = np.zeros(graph.count + 1, dtype=bool)
    outside[-1] = True
    assert graph.complete(outside)  # no leaf
