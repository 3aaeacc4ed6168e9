"""A lower bound for the larger exponent: below what orbits show, and never positive where a cycle attracts."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics import regions as statements
from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.flights import Piece, Slopes
from verification.proofs.global_dynamics.graph import Grid, Transitions, morse_graph, refined
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import (
    Derivatives,
    arriving,
    carried,
    expansion,
    factors,
    least_mean,
    shares,
)


def regions(scene, columns=512, rows=128, lam=None):
    """The map, its Morse graph, and the trapping regions about attracting sets."""
    map = PinballImages(scene, lam)
    graph = morse_graph(refined(map, Grid(map.charts, columns, rows), 4))
    return map, graph, [graph.trapping(index) for index in graph.attracting]


@pytest.mark.parametrize("scene", [Scene("egg", alpha="0.08", lam="1/2"), Scene("cuspless", lam="0.3")])
def test_the_derivative_over_a_small_box_is_that_of_the_map(scene):
    map, h = PinballImages(scene), 1e-5
    theta, phi = np.linspace(-1.9, 1.9, 60), np.linspace(-0.9, 0.9, 60) * map.top
    boxes = Boxes(np.zeros(60, dtype=np.int64), (theta - 1e-6, theta + 1e-6), (phi - 1e-6, phi + 1e-6))
    judged = 0
    for piece, slopes in map.derivatives(boxes):
        on = piece.on
        for dx, dy, along in ((h, 0, slopes.by_theta), (0, h, slopes.by_phi)):
            a, b = (map.map.step(theta[on] + s * dx, phi[on] + s * dy, 0) for s in (-1, 1))
            near = piece.smooth & (a.component == b.component) & (np.abs(b.theta - a.theta) < 1)
            moved = ((b.theta - a.theta) / (2 * h))[near]
            turned = ((b.phi - a.phi) / (2 * h))[near]
            law = -float(scene.lam) * (slopes.bend_there * along - slopes.bend_here * bool(dx) + bool(dy))
            judged += int(near.sum())

            assert np.all(np.abs(moved - along.m[near]) < 1e-3 * (1 + np.abs(moved)))
            assert np.all(np.abs(turned - law.m[near]) < 1e-3 * (1 + np.abs(turned)))
    assert judged > 100


@pytest.mark.parametrize("lam", ["0.09", "0.12", "0.2"])
def test_every_orbit_near_the_cuspless_attractor_has_a_positive_exponent(lam):
    map, graph, (block,) = regions(Scene("cuspless", lam=lam))
    bounds = expansion(map, graph.transitions, block, parts=4)
    sampled = PinballMap("cuspless", lam=lam).exponents(np.full(5, 2.09), np.linspace(0.033, 0.037, 5), 4000, 200)
    near = sampled.nu_plus[sampled.nu_plus > 0.01]

    assert 0 < bounds.low < np.min(near)
    assert np.max(near) < bounds.high < 0.6


def test_a_vector_stays_in_the_cones_along_an_orbit_and_grows_by_more_than_the_bound():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"))
    found, grid, bounces = expansion(map, graph.transitions, block, parts=4), graph.transitions.grid, 300
    cells = graph.transitions.chosen(block)
    box = grid.painted(cells, np.arange(cells.chart.size), -1)
    orbit = PinballMap("cuspless", lam="0.12").orbit(2.09, 0.035, bounces + 50)
    chart, theta, phi = (field[50:] for field in (orbit.component, orbit.theta, orbit.phi))
    low, high = (np.array([c.x[i] for c in map.charts])[chart] for i in (0, 1))
    column, row = (theta - low) / (high - low) * grid.columns, (phi + map.top) / (2 * map.top) * grid.rows
    where = box[chart, np.minimum(column.astype(int), grid.columns - 1), row.astype(int)]
    slope, grown = float(found.cones[0][where[0]]), 0.0
    for i in range(bounces):
        point = Boxes(chart[i : i + 1], (theta[i : i + 1],) * 2, (phi[i : i + 1],) * 2)
        ((_, at),) = [(piece, slopes) for piece, slopes in map.derivatives(point) if piece.on.size]
        factor = float(at.by_theta.m[0] + at.by_phi.m[0] * slope)
        slope = -0.12 * float(at.bend_there.m[0] * factor - at.bend_here.m[0] + slope) / factor  # d phi1 / d theta1
        grown += np.log(abs(factor))

        assert found.cones[0][where[i + 1]] - 1e-9 <= slope <= found.cones[1][where[i + 1]] + 1e-9
    assert found.low < grown / bounces < found.high


def test_the_bound_holds_for_a_range_of_contractions_at_once():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"), 512, 256, (Fraction("0.12"), Fraction("0.121")))

    assert expansion(map, graph.transitions, block, parts=4).low > 0


def test_the_exponent_of_a_cycle_that_attracts_lies_within_the_bounds_of_its_region():
    """That of the horizontal cycle of the cuspless table, by its orbit."""
    map, graph, (block,) = regions(Scene("cuspless", lam="0.05"), 512, 256)
    bounds = expansion(map, graph.transitions, block, parts=4)
    sampled = PinballMap("cuspless", lam="0.05").exponents(np.array([0.01]), np.array([0.0]), 4000, 1000)

    assert bounds.low <= sampled.nu_plus[0] <= bounds.high < 0


@pytest.mark.parametrize(
    ("scene", "rows"),
    [
        (Scene("cuspless", lam="0.05"), 128),
        (Scene("egg", alpha="0.08", lam="1/2"), 256),
        (Scene("circle", lam="1/2"), 64),
    ],
)
def test_no_orbit_is_said_to_be_unstable_where_a_cycle_attracts_or_is_neutral(scene, rows):
    map, graph, blocks = regions(scene, 256 if scene.name == "circle" else 512, rows)
    lows = [expansion(map, graph.transitions, block).low for block in blocks]

    assert min(lows) <= 0
    if scene.name == "egg":  # both cycles of period 3 attract
        assert sorted(low > 0 for low in lows)[:2] == [False, False]


def test_a_set_in_which_a_walk_ends_is_refused():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"), 256, 64)
    last = np.flatnonzero(block)[:1]
    alone = np.zeros_like(block)
    alone[last] = True
    if graph.transitions.edges[last[0], last[0]]:
        pytest.fail("the box chosen is fixed; choose another")

    for some in (alone, np.zeros_like(block)):
        with pytest.raises(ValueError, match="no edge within the set"):
            expansion(map, graph.transitions, some)


def test_a_box_that_may_shrink_vectors_to_nothing_bounds_no_exponent():
    """Of four boxes that stretch `theta` by 1.5 to 2.5, by -0.1 to 0.3, by what is not known, and by 3."""
    stretch = BallArray(np.array([2.0, 0.1, 1.0, 3.0]), np.array([0.5, 0.2, np.inf, 0.0]))
    none = BallArray(np.zeros(4), np.zeros(4))
    found = Derivatives(np.arange(4), np.zeros(4, dtype=np.int64), Slopes(stretch, none, none, none, none))

    least, most = factors(found, (np.zeros(4), np.zeros(4)), 4)

    assert np.allclose(np.exp(least), [1.5, 0, 0, 3])
    assert least[0] < np.log(1.5)
    assert np.allclose(np.exp(most), [2.5, 0.3, np.inf, 3])
    assert most[0] > np.log(2.5)


def random_slopes(random, size, radius=0.0):
    """Six arrays of balls, the stretch away from 0."""
    middles = random.uniform(0.5, 1.5, (6, size)) * np.where(random.random((6, size)) < 0.5, -1, 1)
    return Slopes(*(BallArray(m, np.full(size, radius)) for m in middles))


def test_the_slope_of_an_image_is_that_of_the_image_of_a_vector():
    """`d eta1 = bend_there*d theta1 - bend_here*d theta0 + d phi0`, `d phi1 = drift*d theta1 - law*d eta1`."""
    random = np.random.default_rng(1)
    s, slope = random_slopes(random, 50), random.uniform(-0.3, 0.3, 50)
    stretch, image = carried(s, BallArray(slope, np.zeros(50)))
    there = s.by_theta.m + s.by_phi.m * slope
    incidence = s.bend_there.m * there - s.bend_here.m + slope

    assert np.allclose(stretch.m, there)
    assert np.allclose(image.m * there, s.drift.m * there - s.law.m * incidence)


def test_the_least_mean_weight_is_that_of_the_lightest_walk():
    """By trying every walk of six steps in a graph of four vertices."""
    edges = [(0, 1), (1, 0), (1, 2), (2, 3), (3, 3), (3, 0), (2, 2)]
    graph = csr_matrix((np.ones(len(edges)), tuple(zip(*edges, strict=True))), shape=(4, 4))
    for weights in np.random.default_rng(2).uniform(-1, 1, (10, 4)):
        walks = [[k] for k in range(4)]
        for _ in range(5):
            walks = [[*walk, b] for walk in walks for a, b in edges if a == walk[-1]]
        least = min(sum(weights[k] for k in walk) for walk in walks) / 6
        assert abs(least_mean(weights, graph, 6) - least) < 1e-12


class Two:
    """In the place of a map: two charts."""

    charts = ("one", "other")


def test_the_slopes_that_reach_a_box_are_those_from_all_boxes_that_lead_to_it_on_its_chart():
    """Box 0 lands on both charts, box 1 on the first, of box 2 nothing is known."""
    source, chart = np.array([0, 0, 1, 2]), np.array([0, 1, 0, 1])
    one, none = np.ones(4), np.zeros(4)
    drift = BallArray(np.array([1.0, -2.0, 5.0, 0.0]), np.array([0.5, 0.25, 0.0, np.inf]))
    s = Slopes(BallArray(one, none), *(BallArray(none, none) for _ in range(3)), BallArray(none, none), drift)
    edges = [(0, 0), (0, 1), (1, 0), (2, 1)]
    inner = csr_matrix((np.ones(4), tuple(zip(*edges, strict=True))), shape=(3, 3))
    cells = statements.Cells(np.array([0, 1, 0]), *(np.zeros(3, dtype=int) for _ in range(3)))
    low, high = arriving(Two(), Derivatives(source, chart, s), inner, cells, (np.zeros(3), np.zeros(3)))

    assert np.allclose([low[0], high[0]], [0.5, 5.0], atol=1e-12)
    assert (low[1], high[1]) == (-np.inf, np.inf)
    assert (low[2], high[2]) == (np.inf, -np.inf)


@pytest.mark.parametrize("turned", [False, True])
def test_a_bound_holds_for_every_vector_of_a_cone_along_every_walk(monkeypatch, turned):
    """Of random linear maps on a cycle of three boxes: cones hold their images, and the mean growth of the product."""
    random, found = np.random.default_rng(5), 0
    inner = csr_matrix((np.ones(3), ([0, 1, 2], [1, 2, 0])), shape=(3, 3))

    class Graph:
        grid, leaf, edges = None, np.ones(3, dtype=bool), csr_matrix((np.ones(3), ([0, 1, 2], [1, 2, 0])), shape=(4, 4))

        def chosen(self, members):
            return statements.Cells(*(np.zeros(3, dtype=int) for _ in range(4)))

        def complete(self, members):
            return not missing

    missing = False

    class One:
        charts = ("one",)

    for _ in range(20):
        s = random_slopes(random, 3)._replace(law=BallArray(np.full(3, 0.1), np.zeros(3)))
        s = s._replace(by_theta=BallArray(s.by_theta.m * (4 if not turned else 0.2), np.full(3, 1e-3)))
        rows = Derivatives(np.arange(3), np.zeros(3, dtype=int), s)
        monkeypatch.setattr(statements, "derivatives", lambda *_, rows=rows: rows)
        bound = expansion(One(), Graph(), np.array([True, True, True, False]))
        product = np.eye(2)
        for k in range(3):
            a, b, here, there, law, drift = (float(x.m[k]) for x in s)
            product = (
                np.array([[a, b], [drift * a - law * (there * a - here), drift * b - law * (there * b + 1)]]) @ product
            )
        rate = np.log(max(abs(np.linalg.eigvals(product)))) / 3
        assert bound.low <= rate + 1e-9
        assert bound.high >= rate - 1e-9
        if np.isfinite(bound.low) and not turned:
            found += 1
            low, high = bound.cones
            _, image = carried(s, statements.hull(low, high))
            assert np.all(low[inner.indices] <= image.lower())
            assert np.all(image.upper() <= high[inner.indices])
            assert rate - 1.0 < bound.low < bound.high < rate + 1.0
    assert found > 10 or turned
    missing = True  # of the edges some are not there: orbits may walk elsewhere
    unknown = expansion(One(), Graph(), np.array([True, True, True, False]))
    assert (unknown.low, unknown.high) == (-np.inf, np.inf)


@pytest.mark.parametrize(("block", "most"), [(1, 9), (20, 18), (1 << 14, 72)])
def test_derivatives_are_told_of_each_part_of_each_block_with_its_chart(monkeypatch, block, most):
    """In pieces: of a box that lands on two charts there are two rows."""
    monkeypatch.setattr(statements, "BLOCK", block)
    charts, asked = (Chart("a", (0.0, 2.0), (0.0, 2.0)), Chart("b", (5.0, 7.0), (1.0, 3.0))), []

    def derivatives(boxes):
        asked.append(boxes.chart.size)
        every = np.arange(boxes.chart.size)
        for on, chart in ((every, boxes.chart[every] + 10), (every[boxes.x[0] > 1], 20 + boxes.chart[boxes.x[0] > 1])):
            middle = [BallArray((low[on] + high[on]) / 2) for low, high in (boxes.x, boxes.y)]
            piece = Piece(on, chart, 0.0 * on, 0.0 * on, True)
            yield piece, Slopes(*middle, BallArray(3.0, 0.5), *(BallArray(0.0 * on + k) for k in (4, 5)))

    grid = Grid(charts, 2, 2)
    found = statements.derivatives(SimpleNamespace(derivatives=derivatives), grid, grid.whole(), 3)
    assert max(asked) == most
    assert sum(asked) == 8 * 9
    boxes, wanted = grid.boxes(grid.whole()), []
    for k in range(8):
        chart, left, bottom = boxes.chart[k], boxes.x[0][k], boxes.y[0][k]
        for i, j in np.ndindex(3, 3):
            row = k, chart + 10, left + (i + 0.5) / 3, bottom + (j + 0.5) / 3
            wanted += [row, (k, chart + 20, *row[2:])] if left + i / 3 > 1 + 1e-9 or chart else [row]
    rows = sorted(zip(found.source, found.chart, found.slopes.by_theta.m, found.slopes.by_phi.m, strict=True))
    assert np.allclose(rows, sorted(wanted), atol=1e-12)
    assert {*found.slopes.bend_here.m, *found.slopes.bend_here.r} == {3.0, 0.5}
    assert {*found.slopes.bend_there.m} == {4.0}
    assert {*found.slopes.law.m} == {5.0}
    assert {*found.slopes.drift.m} == {0.0}


def test_a_document_has_no_more_boxes_than_fit_and_a_region_is_cut_no_finer_than_said(monkeypatch):
    assert statements._unrolled([[0, 1, 0, 0, 1]], 1, 8, 6).chart.size == 1
    monkeypatch.setattr(statements, "MOST_BOXES", 5)
    assert statements._unrolled([[0, 1, 0, 0, 3], [0, 1, 1, 0, 2]], 1, 8, 6).chart.size == 5
    with pytest.raises(ValueError, match="runs is no list"):
        statements._unrolled([[0, 1, 0, 0, 3], [0, 1, 1, 0, 3]], 1, 8, 6)
    map = SimpleNamespace(scene=Scene("circle"), range=(Fraction(1, 2), Fraction(1, 2)))
    assert statements.region(map, walks((0, 1), (1, 0)), 0).parts == 1
    assert statements.region(map, walks((0, 1), (1, 0)), 0, 3).parts == 3


@pytest.mark.parametrize("edges", [[(0, 1), (1, 0)], [(0, 1), (1, 0), (2, 3)]])
def test_a_set_is_refused_as_soon_as_one_of_its_boxes_has_no_edge_within_it(edges):
    """Box 2 leads nowhere, or to a box outside of the set."""
    graph = walks(*edges).transitions
    members = np.isin(np.arange(9), (0, 1, 2))
    with pytest.raises(ValueError, match="no edge within the set"):
        expansion(SimpleNamespace(charts=graph.grid.charts), graph, members)


def test_shares_count_each_box_by_its_area_and_only_leaves():
    """Of two charts the first is three times as large; the other boxes lead outside, and one of them was cut."""
    graph = walks((0, 0), (1, 0), (4, 4), (5, 4), (5, 0), *((k, 8) for k in (2, 3, 6, 7, 8)))
    graph.transitions.leaf[3] = False
    graph.transitions.cells.size[1] = 2  # which has four times the area
    found = [shares(graph, k) for k in range(2)]
    rest = {(0,): (15 / 22, 16 / 22), (4,): (1 / 22, 2 / 22)}
    for some, (low, high) in zip(graph.sets[:2], found, strict=True):
        assert (low, high) == pytest.approx(rest[tuple(some)], abs=1e-8)
        assert low < rest[tuple(some)][0]
        assert rest[tuple(some)][1] < high


def walks(*edges):
    """The Morse graph of edges between the eight boxes of two charts, of which the first is three times as large."""
    grid = Grid((Chart("a", (1, 4), (-1, 1)), Chart("b", (5, 7), (2, 3))), 2, 2)
    edges = csr_matrix((np.ones(len(edges), dtype=bool), tuple(zip(*edges, strict=True))), shape=(9, 9))
    return morse_graph(Transitions(grid, grid.whole(), np.ones(8, dtype=bool), edges))


def test_a_region_is_made_of_the_leaves_of_its_walks_and_of_none_that_leads_outside():
    map = SimpleNamespace(scene=Scene("circle"), range=(Fraction(1, 2), Fraction(1, 2)))
    inward, outward = (walks((0, 1), (1, 0), (1, 2), (2, 2), (5, end), (5, 5)) for end in (2, 8))
    found = {tuple(some): statements.region(map, inward, k) for k, some in enumerate(inward.sets)}

    assert {some: None if block is None else block.cells.chart.size for some, block in found.items()} == {
        (0, 1): 3,
        (2,): 1,
        (5,): 2,
    }
    (box,) = (k for k, some in enumerate(outward.sets) if tuple(some) == (5,))
    assert statements.region(map, outward, box) is None  # 8 is the outside


@pytest.mark.parametrize(("kept", "share"), [({0, 1, 2, 3}, 0.75), ({4, 5, 6, 7}, 0.25), ({0}, 0.1875), ({7}, 0.0625)])
def test_a_sampled_share_is_that_of_the_area_within_its_standard_error(kept, share):
    """Particles stay where they are; the boxes of the first chart have three times the area of the others."""
    stays = lambda theta, phi, *_: SimpleNamespace(theta=theta, phi=phi, component=_[-1])  # noqa: E731
    map = SimpleNamespace(range=(Fraction(1, 2),) * 2, map=SimpleNamespace(exponents=stays))
    graph = walks(*((box, min(kept)) for box in kept), *((min(kept), box) for box in kept))
    found, error = statements.sampled_share(map, graph, 0)

    assert abs(found - share) < 4 * error
    assert error == pytest.approx(np.sqrt(found * (1 - found) / statements.STARTS))
    nowhere = SimpleNamespace(
        exponents=lambda theta, phi, *_: SimpleNamespace(theta=theta * np.nan, phi=phi, component=_[-1])
    )
    assert statements.sampled_share(SimpleNamespace(range=map.range, map=nowhere), graph, 0) == (
        0,
        1 / statements.STARTS,
    )
    assert statements.sampled_share(SimpleNamespace(range=(0, 1)), graph, 0) is None


@pytest.mark.parametrize("lost", [[0, 0, 0], [0, 1, 0]])
@pytest.mark.parametrize("inside", [[1, 1, 1], [1, 1, 0], [0, 0, 0]])
def test_a_region_is_trapping_where_every_image_is_enclosed_and_lies_inside(monkeypatch, lost, inside):
    cells = Grid((Chart("a", (0, 1), (0, 1)),), 3, 1).whole()
    stated = statements.Region(Scene("circle"), (Fraction(1, 2),) * 2, 3, 1, 2, cells)
    stated.__dict__["map"] = SimpleNamespace(charts=(Chart("a", (0, 1), (0, 1)),))
    monkeypatch.setattr(statements, "mapped", lambda map, grid, cells, parts: (parts, np.array(lost, dtype=bool)))
    monkeypatch.setattr(statements, "inside", lambda *_: np.array(inside, dtype=bool))

    wanted = {"images_enclosed": not any(lost) or None, "images_inside": all(inside) or None}
    assert stated.checks == {"convex_table": True} | wanted


@pytest.mark.parametrize(
    ("run", "within"),
    [
        ([0, 2, 6, 0, 3], True), ([1, 2, 0, 4, 1], True), ([2, 1, 0, 0, 1], False), ([0, 0, 0, 0, 1], False),
        ([0, 1, 0, 0, 0], False), ([0, 2, 7, 0, 1], False), ([0, 1, 8, 0, 1], False), ([0, 2, 0, 5, 1], False),
        ([0, 1, 0, 3, 4], False), ([0, 2, 0, 1, 3], False), ([-1, 1, 0, 0, 1], False), ([0, 1, 0, 0], False),
    ],
)  # fmt: skip
def test_blocks_of_a_document_lie_within_the_grid_of_one_of_its_charts(run, within):
    """Two charts of eight columns and six rows; `[chart, size, column, row, how many]`."""
    if within:
        chart, size, column, row, count = run
        found = statements._unrolled([[0, 1, 0, 0, 1], run], 2, 8, 6)
        assert [list(field[1:]) for field in found] == [
            [chart] * count,
            [column] * count,
            [row + size * k for k in range(count)],
            [size] * count,
        ]
    else:
        with pytest.raises(ValueError, match="certificate: "):
            statements._unrolled([[0, 1, 0, 0, 1], run], 2, 8, 6)
