"""Growth of curves, cells beside cells and cones, against the same said cell by cell."""

import sys
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.graph import Cells, Grid
from verification.proofs.unstable_curves import cover as room
from verification.proofs.unstable_curves.affine import lozi
from verification.proofs.unstable_curves.cover import cover
from verification.proofs.unstable_curves.growth import UP, Growth, folded, growth

CHARTS = Chart("a", (-1.0, 0.0), (-1.0, 1.0)), Chart("b", (3.0, 5.0), (-1.0, 1.0)), Chart("c", (0.0, 1.0), (-1.0, 1.0))
ROUND = SimpleNamespace(charts=CHARTS, joins=((0, 1), (1, 2), (2, 0)))


@pytest.fixture
def uneven(by_hand, some_cells):
    """Makes a cover of a random half of the cells with random stretches, cones and edges."""

    def made(seed, joins=ROUND.joins):
        rng = np.random.default_rng(seed)
        region = by_hand(SimpleNamespace(charts=CHARTS, joins=joins), cells=some_cells(seed), slopes=(-0.3, 0.1))
        count = region.cells.chart.size
        edges = rng.random((count, count)) < 0.03
        edges[np.arange(count), rng.integers(0, count, count)] = True
        return replace(region, inner=csr_matrix(edges.astype(float)), least=rng.random(count) - 0.2)

    return made


def places(region):
    """The cells, as triples."""
    return list(zip(*(field.tolist() for field in region.cells[:3]), strict=True))


def across(region, values, reach):
    """For each cell its value, and for each join beside it the greatest across it within `reach` rows."""
    held, last = dict(zip(places(region), values, strict=True)), region.grid.columns - 1
    found = []
    for (chart, column, row), value in held.items():
        more = 0.0
        for before, after in region.map.joins:
            for end, there in (((before, last), (after, 0)), ((after, 0), (before, last))):
                if (chart, column) == end:
                    near = [held.get((*there, row + j), 0.0) for j in range(-reach, reach + 1)]
                    more += max(near)
        found.append(value + more)
    return found


@pytest.mark.parametrize("joins", [ROUND.joins, ((0, 1),), ()])
@pytest.mark.parametrize("reach", [0, 1, 3, 20])
def test_next_to_a_join_the_greatest_value_across_it_is_added(uneven, joins, reach):
    region = uneven(1, joins)
    values = np.random.default_rng(5).random(region.cells.chart.size)
    assert folded(region, values, reach) == pytest.approx(across(region, values, reach), abs=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_sums_of_inverse_stretches_are_those_of_the_worst_way(uneven, seed):
    region = uneven(seed)
    reach = 2  # cells are 1/2 wide in the second chart and 1/4 high: 2*0.3*(1/2)/(1/4) = 1.2
    held = dict(zip(places(region), np.exp(-region.least), strict=True))
    beside = list(product((-1, 0, 1), range(-reach, reach + 1)))
    weight = [max(held.get((c, i + k, j + n), 0.0) for k, n in beside) for c, i, j in held]
    value, edges = [1.0] * len(held), region.inner.toarray()
    found = growth(region, 5)
    assert found.reach == reach
    for total in found.sums:
        there = across(region, value, reach)
        value = [w * max(there[k] for k in np.flatnonzero(row)) for w, row in zip(weight, edges, strict=True)]
        assert max(value) <= total <= max(value) * (1 + 1e-11)
    assert len(found.sums) == 5
    assert found.bounces is None


@pytest.mark.parametrize(
    ("slope", "chart", "reach"),
    [(0.49, 2, 1), (0.5, 2, 2), (-0.49, 2, 1), (-0.51, 0, 2), (0.24, 1, 1), (0.26, 1, 2), (-0.74, 1, 3), (0.0, 0, 0)],
)
def test_a_curve_over_two_columns_rises_or_falls_over_so_many_rows(uneven, slope, chart, reach):
    """Columns are 1/4, 1/2 and 1/4 wide, rows 1/4 high."""
    region = uneven(0)
    on = region.cells.chart == chart
    ends = np.where(on, min(slope, 0), 0), np.where(on, max(slope, 0), 0)
    assert growth(replace(region, cones=ends), 1).reach == reach


def test_a_chart_without_cells_has_no_slopes(by_hand):
    region = by_hand(ROUND)
    kept = region.cells.chart != 1
    cells = Cells(*(field[kept] for field in region.cells))
    few = by_hand(ROUND, cells=cells)
    few = replace(few, inner=csr_matrix(np.eye(cells.chart.size)))
    assert few.steepest[0].tolist() == [-0.25, np.inf, -0.25]
    assert few.steepest[1].tolist() == [0.5, -np.inf, 0.5]
    assert growth(few, 1).reach == 2


def test_sums_end_with_the_first_that_is_below_one(uneven, monkeypatch):
    """Without joins each bounce multiplies by the stretch: 3/2 first halves, then grows."""
    region = uneven(2, ())
    count = region.cells.chart.size
    shrinking = replace(region, least=np.full(count, np.log(1.25)))
    found = growth(shrinking)
    assert found.sums == (pytest.approx(0.8),)
    assert found.bounces == 1
    assert growth(replace(region, least=np.full(count, -np.log(1.25))), 7).sums[-1] == pytest.approx(1.25**7)
    assert Growth((2.0, 1.0), 1).bounces is None
    assert Growth((2.0, 0.99), 1).bounces == 2
    still = growth(replace(region, least=np.zeros(count)), 3)
    assert still.sums == pytest.approx((1, 1, 1), abs=1e-11)
    assert all(total > UP ** (3 * n - 0.5) for n, total in enumerate(still.sums, 1))  # three products a bounce
    monkeypatch.setattr(sys.modules[growth.__module__], "UP", 1.0)
    assert growth(replace(region, least=np.zeros(count)), 3).sums == (1.0, 1.0, 1.0)


def test_cells_are_painted_where_they_are_and_are_as_large_as_charts_say(uneven):
    region = uneven(1)
    values = np.arange(1.0, region.cells.chart.size + 1)
    picture = region.painted(values, -1.0)
    held = dict(zip(places(region), values, strict=True))
    for place in product(range(3), range(4), range(8)):
        assert picture[place] == held.get(place, -1.0)
    assert region.shape == picture.shape == (3, 4, 8)
    assert [side.tolist() for side in region.sides] == [[0.25, 0.5, 0.25], [0.25] * 3]


def test_vectors_outside_of_the_cones_shrink_where_determinants_shrink_more_than_cones_grow(uneven):
    """Along each walk: a mean that is 0 up to rounding is no proof."""
    region = uneven(0)
    count = region.cells.chart.size
    rng = np.random.default_rng(1)
    least = rng.random(count)
    for gap, held in ((1e-3, True), (2e-12, True), (0.0, False), (5e-13, False), (-1e-3, False)):
        assert replace(region, least=least, area=least - gap).contracts is held
    area = least - 1.0
    area[0] = least[0] + 9.0  # one bad cell: it is left at once, unless it leads to itself
    edges = region.inner.toarray()
    edges[0] = 0
    edges[0, 1] = 1
    edges[:, 0] = 0
    edges[2, 1] = 1
    edges[np.arange(3, count), 3] = 1
    assert replace(region, least=least, area=area, inner=csr_matrix(edges)).contracts
    edges[0, 0] = 1
    assert not replace(region, least=least, area=area, inner=csr_matrix(edges)).contracts


@pytest.mark.parametrize("around", [1, 2, 5])
def test_cells_beside_cells_are_all_within_so_many_columns_and_rows(monkeypatch, around):
    """Nothing crosses to another chart; and from these cells the region is grown again."""
    grid, asked = Grid(CHARTS, 6, 8), []
    first = np.array([0 * 48 + 3 * 8 + 7, 2 * 48 + 0 * 8 + 1])

    def reached(map, grid, start, parts, most):
        asked.append(start)
        return first if len(asked) == 1 else None

    monkeypatch.setattr(room, "reached", reached)
    map = SimpleNamespace(charts=CHARTS, joins=())
    assert "no trapping region: images leave" in cover(map, 6, 8, Boxes(*((np.zeros(1, int),) * 3)), 1, around)
    wanted = [
        (c, i, j)
        for c, i, j in product(range(3), range(6), range(8))
        if any(c == a and abs(i - k) <= around and abs(j - n) <= around for a, k, n in ((0, 3, 7), (2, 0, 1)))
    ]
    cells = Cells(*(np.array(x) for x in zip(*wanted, strict=True)), np.ones(len(wanted), dtype=int))
    for found, end in zip(
        (asked[1].chart, *asked[1].x, *asked[1].y), (lambda b: (b.chart, *b.x, *b.y))(grid.boxes(cells)), strict=True
    ):
        assert np.array_equal(found, end)


def test_a_closed_curve_and_an_image_that_leaves_are_refused(monkeypatch):
    start = Boxes(np.array([1]), (np.array([0.5]),) * 2, (np.array([0.0]),) * 2)
    closed = SimpleNamespace(charts=(CHARTS[0], CHARTS[1]._replace(period=True)), joins=())
    assert "closed curve" in cover(closed, 8, 8, start)
    asked = []
    monkeypatch.setattr(room, "reached", lambda *given, **_: asked.append(given[3]))
    assert "images leave" in cover(lozi(1.6, 0.05), 8, 8, start)
    assert "images leave" in cover(lozi(1.6, 0.05), 8, 8, start, 2, 1)
    assert asked == [1, 2]  # parts
    monkeypatch.setattr(room, "reached", lambda *_, **__: np.arange(8))
    assert cover(lozi(1.6, 0.05), 8, 8, start) == "no trapping region: an image leaves the cells"
