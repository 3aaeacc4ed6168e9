"""Stable slopes, and blocks that stable curves run through and the unstable manifold crosses."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.flights import Slopes
from verification.proofs.global_dynamics.graph import Cells
from verification.proofs.unstable_curves import attraction as attractions
from verification.proofs.unstable_curves.anchor import (
    Anchor,
)
from verification.proofs.unstable_curves.attraction import _blocks, attraction, stable_slopes
from verification.proofs.unstable_curves.spans import Course, Spans

CHARTS = Chart("a", (0.0, 2.0), (-1.0, 1.0)), Chart("b", (4.0, 8.0), (-1.0, 1.0))


@pytest.fixture
def strips(by_hand):
    """Two charts of 25 columns and 16 rows of which some are in the region, but for one column."""
    map = SimpleNamespace(charts=(CHARTS[0], Chart("b", (4.0, 8.0), (-2.0, 2.0))), joins=())
    cells = by_hand(map, columns=25, rows=16).cells
    rng = np.random.default_rng(0)
    first, last = rng.integers(4, 8, (2, 25)), rng.integers(8, 13, (2, 25))
    last[1, 17] = 16
    kept = (cells.row >= first[cells.chart, cells.column]) & (cells.row < last[cells.chart, cells.column])
    kept &= (cells.chart == 1) | (cells.column != 9)
    return by_hand(map, columns=25, rows=16, cells=Cells(*(field[kept] for field in cells)))


def test_blocks_are_all_stretches_of_columns_whose_rectangle_lies_in_the_wide_region(strips):
    """Their inner parts are as far from both sides as the rectangle, a row more, is high times the greatest slope."""
    rng = np.random.default_rng(1)
    lean = rng.integers(1, 9, (2, 25, 16)) / 64 + (rng.random((2, 25, 16)) < 0.02) * 0.4
    lean[1, 20, 7:9] = np.inf
    lean[1, 2, 13:] = np.inf  # of no matter: above all of the region
    lean[0, 2, :4] = np.inf  # below
    course, wanted = Course(strips), []
    for chart, start, wide, tall in ((0, 0.0, 2 / 25, 1 / 8), (1, 4.0, 4 / 25, 1 / 4)):
        for width, step in ((8, 2), (16, 4)):
            for first in range(0, 26 - width, step):
                on = range(first, first + width)
                rows = [
                    strips.cells.row[(strips.cells.chart == chart) & (strips.cells.column == i)].tolist() for i in on
                ]
                if not all(rows):
                    continue
                a, b = min(map(min, rows)), max(map(max, rows)) + 1
                steep = max(lean[chart, i, j] for i in on for j in range(a, b))
                if steep == np.inf:
                    continue
                margin = int(np.ceil(steep * (b - a + 1) * tall / wide))
                low, high = start + first * wide, start + (first + width) * wide
                wanted.append((chart, low, high, first + margin, first + width - margin))
    found, lows, wides = _blocks(strips, course, lean), (0.0, 4.0), (2 / 25, 4 / 25)
    assert [block[::2] for block in found] != []
    assert [(b[0], *b[3:]) for b in found] == [(b[0], *b[3:]) for b in wanted]
    assert [b[1:3] for b in found] == [pytest.approx(b[1:3], abs=3e-11) for b in wanted]
    assert all(b[1] < w[1] - 5e-12 and w[2] + 5e-12 < b[2] for b, w in zip(found, wanted, strict=True))
    assert {b[0] for b in found} == {0, 1}
    assert len({b[3] - round((b[1] - lows[b[0]]) / wides[b[0]]) for b in found}) > 3  # margins


def test_a_margin_of_just_so_many_columns_is_one_more(by_hand):
    """All 16 rows, and one: 4/51 times 17/8 is two columns of 1/12."""
    region = by_hand(SimpleNamespace(charts=CHARTS[:1], joins=()), columns=24, rows=16)
    found = _blocks(region, Course(region), np.full((1, 24, 16), 4 / 51))
    assert {(b[3] - round(b[1] * 12), round(b[2] * 12) - b[4]) for b in found} == {(3, 3)}
    assert [round((b[2] - b[1]) * 12) for b in found] == [8] * 9 + [16] * 3


def test_stable_slopes_are_kept_by_the_inverse_derivative_and_are_those_of_the_formula(bent):
    """The inverse takes `(q, 1)` to `(1, s - b*q)*16` up to sign: `q` to `-1/(s - b*q)`."""
    low, high = stable_slopes(bent)
    edges, slope = bent.inner.tocoo(), np.array([1.5, -1.75])[bent.cells.chart]
    ends = [-1 / (slope[edges.row] - q[edges.col] / 16) for q in (low, high)]
    assert np.all(low[edges.row] <= np.minimum(*ends))
    assert np.all(np.maximum(*ends) <= high[edges.row])
    bottom, top = np.full(low.size, np.inf), np.full(low.size, -np.inf)
    np.minimum.at(bottom, edges.row, np.minimum(*ends))
    np.maximum.at(top, edges.row, np.maximum(*ends))
    assert low == pytest.approx(bottom, rel=0.02)
    assert high == pytest.approx(top, rel=0.02)
    assert np.all(low < high)


@pytest.mark.parametrize(("chart", "sign"), [(0, -1), (1, 1)])  # of stable slopes there
def test_stable_slopes_that_may_be_unstable_ones_are_none(bent, chart, sign):
    """A cone that reaches a stable direction of one chart is enough; the other side is free."""
    low, high = stable_slopes(bent)
    on = bent.cells.chart == chart
    steep = 1 / np.abs([low, high])[:, on].max()

    def known(bottom, top):
        cones = np.where(on, bottom * steep, 0.0), np.where(on, top * steep, 0.0)
        return stable_slopes(replace(bent, cones=cones)) is not None

    ends = sorted((0.0, sign * 1.1))
    assert not known(*ends)
    assert known(*sorted((0.0, -sign * 1.1)))
    assert known(-0.5, 0.5)


def test_a_cell_from_which_no_edge_leads_has_no_stable_slopes(bent):
    edges = bent.inner.tolil()
    edges[5] = 0
    assert stable_slopes(replace(bent, inner=edges.tocsr())) is None


@pytest.mark.parametrize(("slope", "b", "known"), [(1.5, 0.0625, True), (0.0, 1.0, False), (0.75, -0.5, False)])
def test_stable_slopes_that_become_horizontal_or_grow_without_end_are_none(bent, monkeypatch, slope, b, known):
    """With `((s, 1), (b, 0))` over each cell: for a quarter turn, and where both multipliers are complex."""
    at = np.tile(np.arange(bent.cells.chart.size), 2)

    def derivatives(map, grid, cells, parts):
        one, zero = BallArray(np.ones(at.size), np.zeros(at.size)), BallArray(np.zeros(at.size), np.zeros(at.size))
        return (
            at,
            np.repeat([0, 1], at.size // 2),
            Slopes(one * slope, one, one * -(1 + slope), zero, one * -b, one * -b),
        )

    monkeypatch.setattr(attractions, "derivatives", derivatives)
    with np.errstate(all="ignore"):
        assert (stable_slopes(bent) is not None) is known


@pytest.mark.parametrize("side", [-1, 1])
def test_a_range_of_slopes_is_widened_on_either_side_until_it_is_kept(bent, monkeypatch, side):
    """The inverse takes `q` to `0.9*q - 1`, or to `0.9*q + 1`, whose fixed point only a wide range holds."""
    at = np.arange(bent.cells.chart.size)
    one, zero = (BallArray(np.full(2 * at.size, x), 0.0) for x in (1.0, 0.0))
    monkeypatch.setattr(attractions, "derivatives", lambda *_: (np.tile(at, 2), np.repeat([0, 1], at.size), None))
    monkeypatch.setattr(attractions, "matrix", lambda _: ((one, one * -side), (zero, one * 0.9)))
    low, high = stable_slopes(replace(bent, cones=(np.full(at.size, -0.01), np.full(at.size, 0.01))))
    assert np.all((side * high if side > 0 else side * low) >= 10)
    assert np.all((low < 10 * side) & (10 * side < high))


class Walk:
    """Spans that are told, one set after the other."""

    def __init__(self, sets):
        self.sets, self.asked = iter(sets), []

    def step(self, spans):
        self.asked.append(spans)
        return next(self.sets)


def over(low, high, chart=0):
    """One span over an interval."""
    zero = np.zeros(1)
    return Spans(np.zeros(1, int), np.array([chart]), np.array([low]), np.array([high]), (zero, zero), (zero, zero))


ENDS = ((np.zeros(2),) * 2,) * 2
NOTHING = over(0.0, 0.0).chosen(np.zeros(0, int))


@pytest.mark.parametrize(
    ("cells", "edges", "proved"),
    [
        ((1, 2, 3, 5), [(0, 1), (1, 0), (2, 3), (3, 2)], True),  # 5 and 3 walk to one another, 3 is covered
        ((1, 2, 5, 6), [(0, 1), (1, 0), (2, 3), (3, 2)], False),
        ((1, 2, 5, 6), [(0, 1), (1, 0), (2, 3), (3, 0)], True),
        ((1, 2, 5, 6), [(0, 0), (1, 1), (2, 3), (3, 3)], False),
        ((1, 2, 5, 6), [(0, 0), (1, 1), (2, 3), (3, 1)], True),
    ],
)
def test_no_closed_walk_may_avoid_the_inner_parts_of_blocks_that_the_manifold_crosses(
    by_hand, monkeypatch, cells, edges, proved
):
    map = SimpleNamespace(charts=CHARTS, joins=())
    count = len(cells)
    region = by_hand(
        map, columns=8, cells=Cells(*(np.array(x) for x in ([0] * count, cells, [3] * count, [1] * count)))
    )
    graph = csr_matrix((np.ones(len(edges)), tuple(np.array(edges).T)), shape=(count, count))
    region = replace(region, inner=graph, area=np.full(count, -1.0))
    room = attractions
    asked = []
    slopes = np.full(count, -0.25), np.full(count, 0.125)
    blocks = [
        (0, 0.25, 0.75, 1, 3),
        (0, 0.5, 1.0, 2, 4),
        (0, 1.0, 1.5, 5, 7),
        (1, 5.0, 6.0, 5, 7),
        (0, 0.25, 0.75, 7, 5),
        (0, 0.25, 0.75, 5, -1),
    ]
    both = Spans(*(np.concatenate(pair) for pair in zip(over(0.4, 1.1)[:4], over(0.1, 0.2)[:4], strict=True)), *ENDS)
    walk = Walk([both, NOTHING])
    monkeypatch.setattr(room, "stable_slopes", lambda wide: slopes)
    monkeypatch.setattr(room, "_blocks", lambda narrow, course, lean: asked.append(lean) or blocks)
    monkeypatch.setattr(room, "Course", lambda narrow: walk)
    at = Anchor(0, 0.25, 0.75, -1.0, 1.0)
    found = attraction(region, region, at)
    assert found.covered.tolist() == [cell in (1, 2, 3) for cell in cells]
    assert found.proved is proved
    given = walk.asked[0]
    assert [field.tolist() for field in given[:4]] == [[0], [0], [0.25], [0.75]]
    assert [[float(x) for (x,) in ends] for ends in (given.first, given.last)] == [[-1.0, 1.0]] * 2
    lean = region.painted(np.full(count, 0.25), np.inf)
    assert np.array_equal(asked[0], lean)
    for missing in ("slopes", "contracts", "grid"):
        narrow = wide = region
        if missing == "slopes":
            monkeypatch.setattr(room, "stable_slopes", lambda wide: None)
        elif missing == "contracts":
            wide = replace(region, area=np.full(count, 1.0))
        else:
            wide = replace(region, grid=replace(region.grid, rows=region.grid.rows + 8))
        walk.sets = iter([NOTHING])
        none = attraction(narrow, wide, at)
        assert not none.proved
        assert none.covered.tolist() == [False] * count
        monkeypatch.setattr(room, "stable_slopes", lambda wide: slopes)
