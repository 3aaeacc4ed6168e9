"""Graphs of boxes that are refined, and sets of cells that grow: against every cell and every walk of a small grid."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from verification.proofs.global_dynamics import apart, graph
from verification.proofs.global_dynamics.apart import cells, kept_apart, numbered, reached
from verification.proofs.global_dynamics.boxes import Boxes, Chart, Images, PlaneImages, collected
from verification.proofs.global_dynamics.graph import (
    Cells,
    Grid,
    Transitions,
    joined,
    mapped,
    morse_graph,
    ranges,
    refined,
    sparse,
    transitions,
    walked,
)

SQUARE = Chart("square", (0.0, 1.0), (0.0, 1.0), False, True)


class Drawn:
    """The square is drawn together about a point, upside down; of boxes in one corner nothing is proved."""

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
def test_a_refined_graph_has_every_cell_once_and_an_edge_wherever_an_image_meets_a_leaf_and_no_other(given):
    """Also where all orbits come to the first or the last cell."""
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


def test_boxes_are_mapped_whole_unless_it_is_said_in_how_many_parts(monkeypatch):
    whole = transitions, mapped
    for work in (*(lambda map, grid, f=f: f(map, grid, grid.whole()) for f in whole), lambda *pair: refined(*pair, 1)):
        work(map := Drawn(), Grid((SQUARE,), 8, 8))
        assert map.asked == [64]
    monkeypatch.setattr(graph, "BLOCK", 20)
    told = []
    transitions(map := Drawn(), grid := Grid((SQUARE,), 8, 8), grid.whole(), 3, told.append)
    assert map.asked == [18] * 32  # two boxes at once in nine parts
    assert told == [min(1, (2 * k + 2) / 64) for k in range(32)]
    mapped(map := Drawn(), grid, Cells(*(field[:3] for field in grid.whole())), 5)
    assert map.asked == [25] * 3
    with pytest.raises(ValueError, match="no boxes to map"):
        mapped(map, grid, Cells(*(field[:0] for field in grid.whole())))


@pytest.mark.parametrize(("columns", "rows", "size"), [(8, 4, 8), (4, 8, 8), (8, 4, 3), (9, 4, 4), (8, 6, 4)])
def test_blocks_that_do_not_fill_a_grid_each_way_are_refused(columns, rows, size):
    with pytest.raises(ValueError, match="do not fit"):
        Grid((SQUARE,), columns, rows).whole(size)
    assert Grid((SQUARE,), columns, rows).whole(1).chart.size == columns * rows


def test_edges_are_counted_before_there_are_too_many(monkeypatch):
    map, grid = Drawn(corner=2.0), Grid((SQUARE,), 8, 8)
    met, _ = mapped(map, grid, grid.whole())
    count = int(((met.right - met.left + 1) * (met.top - met.bottom + 1)).sum())
    monkeypatch.setattr(graph, "EDGES", count)
    every = transitions(map, grid, grid.whole())
    assert every.edges.nnz == count + 65  # with those of the outside
    assert every.leaf.all()
    monkeypatch.setattr(graph, "EDGES", count - 1)
    with pytest.raises(ValueError, match="edges, at most"):
        transitions(map, grid, grid.whole())


def linked(seed, outside):
    """Ten boxes with random edges; and the outside, which leads everywhere or is led to by none."""
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
def test_morse_sets_and_their_order_are_those_of_all_walks(seed, outside, monkeypatch):
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
    if sets:
        monkeypatch.setattr(graph, "MOST", len(sets))
        assert len(morse_graph(made).sets) == len(sets)
        monkeypatch.setattr(graph, "MOST", len(sets) - 1)
        with pytest.raises(ValueError, match="Morse sets, at most"):
            morse_graph(made)


@pytest.mark.parametrize("from_", [None, 0, 4, 9])
def test_the_outside_is_a_set_of_its_own_where_any_box_leads_there_also_the_last(from_):
    once = np.zeros((11, 11), dtype=bool)
    once[-1] = once[3, 3] = True
    if from_ is not None:
        once[from_, -1] = True
    grid = Grid((SQUARE,), 10, 1)
    found = morse_graph(Transitions(grid, grid.whole(), np.ones(10, dtype=bool), csr_matrix(once)))
    outside = [] if from_ is None else [[from_, 10]]
    assert [some.tolist() for some in found.sets] == [*outside, [3]]


def test_a_graph_is_made_of_its_edges_whichever_order_they_have_and_however_often_one_is_there():
    random = np.random.default_rng(3)
    source, target = random.integers(0, 6, (2, 40)).astype(np.int32)
    wanted = np.zeros((7, 7), dtype=bool)
    wanted[source, target] = True
    made = sparse(source, target, 7)
    assert made.nnz == 40
    assert np.array_equal(made.toarray() > 0, wanted)
    once = walked(made)
    assert once.nnz == wanted.sum()
    assert np.array_equal(once.toarray() > 0, wanted)
    first = random.integers(0, 9, 7)
    last = first + random.integers(0, 4, 7)
    assert ranges(first, last).tolist() == [k for a, b in zip(first, last, strict=True) for k in range(a, b)]
    grid = Grid((SQUARE,), 6, 1)
    target[:3] = graph.OUTSIDE
    whole = joined(grid, grid.whole(), np.ones(6, dtype=bool), (source, target)).edges.toarray() > 0
    again = np.zeros((7, 7), dtype=bool)
    again[source, target] = True  # -1 is the last, which is the outside
    again[-1] = True
    assert np.array_equal(whole, again)


TURNING = Chart("turning", (-1.0, 1.0), (0.0, 1.0), True, True), Chart("other", (0.0, 3.0), (0.0, 2.0), False, False)


@pytest.mark.parametrize(
    ("left", "right", "columns"),
    [(-0.9, 1.2, 8), (-0.9, 1.1, 8), (-0.9, 0.84, 8), (-0.9, 0.6, 7), (0.6, 1.4, 4), (5.1, 5.2, 1), (-4.9, 8.0, 8)],
)
def test_an_image_that_goes_all_around_meets_every_column_once(left, right, columns):
    grid = Grid(TURNING, 8, 2)
    ends = (np.array([left]), np.array([right])), (np.array([0.1]), np.array([0.2]))
    met = grid.met(Images(np.zeros(1, dtype=int), Boxes(np.zeros(1, dtype=int), *ends), np.zeros(0, dtype=int)))
    assert met.right[0] - met.left[0] + 1 == columns
    assert met.left[0] == int(np.floor((left + 1) * 4)) % 8


def lies(grid, number):
    """A cell as a box of exact ends: chart, left, right, bottom, top, in cells."""
    chart, rest = divmod(int(number), grid.columns * grid.rows)
    column, row = divmod(rest, grid.rows)
    return chart, column, column + 1, row, row + 1


def test_cells_are_numbered_each_once_and_told_again_by_their_numbers():
    grid, random = Grid(TURNING, 8, 6), np.random.default_rng(2)
    every = np.arange(2 * 8 * 6)
    some = cells(grid, every)
    assert np.array_equal((some.chart * 8 + some.column) * 6 + some.row, every)
    assert (some.chart.max(), some.column.max(), some.row.max(), set(some.size)) == (1, 7, 5, {1})
    for _ in range(20):
        chart, left = random.integers(0, 2, 3), random.integers(0, 8, 3)
        right = np.where(chart == 0, left + random.integers(0, 8, 3), np.minimum(left + 2, 7))
        bottom = random.integers(0, 6, 3)
        top = np.minimum(bottom + random.integers(0, 3, 3), 5)
        met = graph.Rectangles(np.arange(3), chart, left, right, bottom, top, np.zeros(3, dtype=bool))
        wanted = {
            (c * 8 + i % 8) * 6 + j
            for c, a, b, d, e in zip(chart, left, right, bottom, top, strict=True)
            for i in range(a, b + 1)
            for j in range(d, e + 1)
        }
        assert numbered(grid, met).tolist() == sorted(wanted)


def test_a_cell_touches_the_turned_ones_that_it_has_a_border_or_a_corner_in_common_with():
    grid = Grid(TURNING, 8, 4)

    def touch(one, other, turn):
        (a, l, _, b, _), (c, m, _, d, _) = lies(grid, one), lies(grid, other)  # noqa: E741
        across = {(l + sign * turn - m) % 8 for sign in (1, -1)}
        return a == c and bool(across & {0, 1, 7}) and abs(b - d) <= 1

    random = np.random.default_rng(6)
    for one, other in random.integers(0, 32, (50, 2)):
        for turn in (2, 3):
            assert apart._touches(grid, np.array([one]), np.array([other]), (turn,)) is touch(one, other, turn)
        both = touch(one, other, 2) or touch(one, other, 3)
        assert apart._touches(grid, np.array([one]), np.array([other]), (2, 3)) is both
        assert not apart._touches(grid, np.array([one]), np.array([other]), ())
    assert apart._touches(grid, np.array([0, 9]), np.array([1, 9, 17]), (2,))


@pytest.mark.parametrize("block", [1, 5, 1 << 14])
def test_what_is_reached_are_all_cells_that_images_meet_again_and_again(monkeypatch, block):
    monkeypatch.setattr(apart, "BLOCK", block)
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


def test_nothing_is_reached_where_of_several_boxes_one_leaves_the_chart():
    leaves = Drawn(1.5, 2.0)
    leaves.charts = (SQUARE._replace(kept=False),)
    ends = (np.array([0.3, 0.9]), np.array([0.31, 0.92])), (np.array([0.7, 0.1]), np.array([0.71, 0.12]))
    assert reached(leaves, Grid(leaves.charts, 12, 12), Boxes(np.zeros(2, dtype=int), *ends), 1) is None


def test_kept_apart_asks_for_thirds_of_the_columns_and_tells_the_middles_of_its_columns(monkeypatch):
    asked = []
    map = SimpleNamespace(charts=(Chart("a", (-3.0, 3.0), (-1.0, 1.0), True, True),), closed=True)
    member = np.array([4, 5, 2 * 4 + 1, 11 * 4])
    monkeypatch.setattr(apart, "reached", lambda *all: asked.append(all) or member)
    start = Boxes(np.zeros(1, dtype=int), (np.zeros(1),) * 2, (np.zeros(1),) * 2)
    assert kept_apart(map, (12, 4, 7), start) == pytest.approx([-3 + 0.5 * k for k in (1.5, 2.5, 11.5)])
    ((_, grid, begun, parts, turns),) = asked
    assert (grid.columns, grid.rows, parts, turns) == (12, 4, 7, (4,))
    assert begun is start
    assert kept_apart(map, (3 << 18, 1 << 20, 1), start) is not None  # more cells than an array of them may have
    assert kept_apart(map, (11, 4, 7), start) is None
    assert kept_apart(map, (12, 4, 7), None) is None


def test_parts_of_boxes_stand_beside_one_another_and_mirror_images_are_turned_over():
    boxes = Boxes(
        np.array([1, 0]), (np.array([0.0, 1.0]), np.array([1.0, 4.0])), (np.array([0.0, 2.0]), np.array([2.0, 8.0]))
    )
    parts, source = boxes.parts(2, 3)
    assert source.tolist() == [0] * 6 + [1] * 6
    assert parts.chart.tolist() == [1] * 6 + [0] * 6
    rows = [(0.5 * i, 0.5 * i + 0.5, 2 * j / 3, 2 * (j + 1) / 3) for i in range(2) for j in range(3)]
    rows += [(1 + 1.5 * i, 2.5 + 1.5 * i, 2 + 2 * j, 4 + 2 * j) for i in range(2) for j in range(3)]
    assert np.allclose(np.transpose([*parts.x, *parts.y]), rows, atol=1e-13)
    again = boxes.mirrored()
    assert np.array_equal([*again.x, *again.y], [[-1, -4], [0, -1], [-2, -8], [0, -2]])
    one = boxes.chosen(np.array([False, True]))
    assert (one.chart.tolist(), one.x[1].tolist(), one.y[0].tolist()) == ([0], [4.0], [2.0])


@pytest.mark.parametrize(("low", "wide"), [(1000.0, 1.0), (1e-6, 1e-6), (-0.7, 1.9)])
def test_parts_hold_all_of_their_box_exactly_and_overlap_by_roundings_alone(low, wide):
    boxes = Boxes(
        np.zeros(1, dtype=int), (np.array([low]), np.array([low + wide])), (np.array([-low]), np.array([wide]))
    )
    parts, _ = boxes.parts(7, 11)
    for (start, end), (left, right), count, step in ((boxes.x, parts.x, 7, 11), (boxes.y, parts.y, 11, 1)):
        start, end = Fraction(float(start[0])), Fraction(float(end[0]))
        slack = Fraction(4, 10**15) * (abs(start) + abs(end))
        for k in range(count):
            exact = [start + (end - start) * (k + more) / count for more in (0, 1)]
            assert max(start, exact[0] - slack) <= Fraction(float(left[k * step])) <= exact[0]
            assert exact[1] <= Fraction(float(right[k * step])) <= min(end, exact[1] + slack)


@pytest.mark.parametrize("bad", [None, 0, 1, 2, 3])
def test_a_box_is_lost_when_any_end_of_any_of_its_rectangles_is_not_finite_or_when_it_has_none(bad):
    """Box 0 has two rectangles, box 1 one, box 2 none, box 3 one."""
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


def test_the_image_of_a_box_of_the_plane_is_enclosed_by_its_middle_and_its_slopes():
    """A linear map, exactly but for rounding: `(2*x - y, x + 3*y)`."""
    map = PlaneImages("shear", SQUARE, lambda x, y: (2 * x - y, x + 3 * y), lambda x, y: ((2.0, -1.0), (1.0, 3.0)))
    boxes = Boxes(np.zeros(1, dtype=int), (np.array([0.25]), np.array([0.5])), (np.array([0.5]), np.array([1.0])))
    found = map.images(boxes).boxes
    assert [float(end[0]) for end in (*found.x, *found.y)] == pytest.approx([-0.5, 0.5, 1.75, 3.5], abs=1e-13)
    assert found.x[0][0] <= -0.5 < 0.5 <= found.x[1][0]
    assert found.y[0][0] <= 1.75 < 3.5 <= found.y[1][0]
