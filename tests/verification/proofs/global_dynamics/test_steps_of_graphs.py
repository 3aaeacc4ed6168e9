"""Small steps of the proofs on all orbits, each by itself: walks, flights, discs, and landings next to a border."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.common_boundary import Disc, attracts
from verification.proofs.global_dynamics.fates import Cluster, holding
from verification.proofs.global_dynamics.flights import flown, newton
from verification.proofs.global_dynamics.graph import Cells, Grid, MorseGraph, Transitions
from verification.proofs.global_dynamics.regions import Region, shares

ROUND = Disc((0.1, 0.2), ((1.0, 0.0), (0.0, 1.0)), 0.01)


def random_graph(seed: int, cut: bool) -> Transitions:
    """Twelve blocks and the outside, which leads everywhere or is led to by none."""
    rng, count = np.random.default_rng(seed), 12
    edges = rng.random((count + 1, count + 1)) < 0.09
    edges[-1] = False
    leaf = np.ones(count, dtype=bool)
    leaf[:2] = not cut
    cells = Cells(np.zeros(count, int), np.arange(count), np.zeros(count, int), np.ones(count, int))
    grid = Grid((Chart("one", (0.0, 1.0), (0.0, 1.0)),), count, 1)
    return Transitions(grid, cells, leaf, csr_matrix(edges))


def closure(graph: Transitions) -> np.ndarray:
    """Whether a walk of one step or more leads from one vertex to another: by multiplying matrices."""
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
def test_edges_are_complete_where_no_closed_walk_through_a_member_meets_a_block_that_was_cut(seed):
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


def test_a_flight_is_as_long_as_the_distance_of_its_ends_and_turns_as_it_lands():
    """Between points, without width: 3, 4, 5; and the speed and the incidence there."""
    one = lambda x: BallArray(np.array([float(x)]))  # noqa: E731
    row = lambda *xs: [one(x) for x in xs]  # noqa: E731
    start, there = (1, 7, 0.6, 0.8), (4, 11, -0.8, 0.6, 0.3, -0.1)
    arc, at, wide, high, here, bend, phi, turn = 2, 2, 0, 0, 0.5, 0.7, 0.25, 0.5
    unknown = BallArray(np.array([0.0]), np.array([np.inf]))
    length, fast, eta = flown(
        *row(*there), *row(*start), *row(*start), *row(*there[:4]),
        *row(arc, at, wide, high, here, bend, phi, turn), unknown,
    )  # fmt: skip
    for found, truth in ((length, 5), (fast, 1), (eta, 0.75)):
        assert abs(float(found.m[0]) - truth) <= float(found.r[0]) < 1e-12


@pytest.mark.parametrize(
    ("factor", "landed", "told", "lost", "held"),
    [
        (0.5, 0.0, True, False, True),
        (0.5, 0.0, False, False, False),  # of a part of the disc no derivative is known
        (0.5, 0.0, True, True, False),  # or its middle is lost
        (0.999, 0.0, True, False, True),
        (1.0, 0.0, True, False, False),
        (0.5, 0.004, True, False, True),
        (0.5, 0.006, True, False, False),  # the image is half as large, and lies too far off
    ],
)
def test_a_disc_attracts_where_it_is_taken_into_itself_by_a_contraction(monkeypatch, factor, landed, told, lost, held):
    def derivatives(parts):
        size = parts.chart.size
        ball = lambda x: BallArray(np.full(size, float(x)), np.zeros(size))  # noqa: E731
        on = np.arange(size) if told else np.arange(size)[1:]
        return [(SimpleNamespace(on=on), tuple(map(ball, (factor, 0, 0, 0, -factor, 0))))]

    def images(points):
        at = [(x[0] + shift - 1e-12, x[1] + shift + 1e-12) for x, shift in ((points.x, 0.5 + landed), (points.y, 0.0))]
        return SimpleNamespace(lost=np.arange(int(lost)), boxes=Boxes(points.chart, *at))

    made = SimpleNamespace(derivatives=derivatives, images=images)
    assert attracts(made, ROUND, 0.5) is held
    assert attracts(made, ROUND, 0.5 + 2 * np.pi) is held
    assert not attracts(made, ROUND, 0.4)


def test_a_flight_from_somewhere_near_is_as_long_as_both_enclosures_say():
    """From within 3/10 of the start: 5 at the middle, and at most as much more or less as the start may move."""
    ball = lambda x, r=0.0: BallArray(np.array([float(x)]), np.array([float(r)]))  # noqa: E731
    row = lambda *xs: [ball(x) for x in xs]  # noqa: E731
    wide = [ball(1, 0.3), ball(0.1), *row(1, 0)]
    there = row(4, 4.1, -0.8, 0.6, 0, 0)
    unknown = BallArray(np.array([0.0]), np.array([np.inf]))
    length, *_ = flown(
        *there, *wide, *row(1, 0.1, 1, 0), *there[:4], *row(2, 2), ball(0, 0.3), *row(0, 0, 0, 0, 0), unknown
    )
    for moved in (-0.3, 0.0, 0.3):
        assert float(length.lower()[0]) <= np.hypot(3 - moved, 4) <= float(length.upper()[0])


def cluster(sink: bool, *rectangles: tuple[float, float, float, float]) -> Cluster:
    left, right, low, high = np.array(rectangles, dtype=float).T
    return Cluster(Boxes(np.zeros(left.size, int), (left, right), (low, high)), sink, None)


def test_a_cycle_is_held_by_a_sink_where_no_other_part_holds_one_of_its_points():
    """Not even on its border; however many others there are that hold none."""
    points = [(0, 0.5, 0.5), (0, 2.5, 0.5)]
    sink, far = cluster(True, (0, 1, 0, 1), (2, 3, 0, 1)), cluster(False, (5, 6, 0, 1), (7, 8, 0, 1))
    for met in (cluster(False, (0.25, 0.75, 0, 1)), cluster(False, (2.5, 4, 0, 1)), cluster(True, (-1, 0.5, 0, 0.5))):
        for parts in ([sink, met], [met, sink], [sink, met, far], [far, sink, met]):
            assert holding(parts, points) is None
    for parts in ([sink], [sink, far], [far, sink, far], [cluster(True, (5, 6, 0, 1)), sink]):
        assert holding(parts, points) is sink
    assert holding([sink], points[:1]) is None  # a cluster without a point
    assert holding([sink], [points[0], (0, 0.25, 0.25)]) is None  # or with both
    assert holding([cluster(True, (0, 1, 0, 1), (0.25, 0.75, 0, 1))], points) is None  # one in both, the other in none
    three = cluster(True, (0, 1, 0, 1), (0.25, 0.75, 0, 1), (5, 6, 0, 1))
    assert holding([three], [*points, (0, 5.5, 0.5)]) is None  # also beside one that is as it should be
    assert holding([cluster(True, (0, 3, 0, 1), (2, 3, 0, 1))], points) is None  # or a point in both


@pytest.mark.parametrize("root", [0.35, 0.5, 0.6, 0.78])
@pytest.mark.parametrize("length", [0.25, 1.0, 4.0])
def test_a_step_of_newton_encloses_where_a_line_meets_the_circle(root, length):
    """From the centre, by a direction of any length: at the direction's angle, more closely than the arc tells."""
    at, (low, high) = 0.5, (0.3, 0.8)
    exact = lambda x: BallArray(np.array([float(x)]))  # noqa: E731
    over = lambda a, b: BallArray(np.array([(a + b) / 2]), np.array([abs(b - a) / 2 + 1e-12]))  # noqa: E731
    line = 0, 0, length * np.cos(root), length * np.sin(root)
    slopes = over(-np.sin(low), -np.sin(high)), over(np.cos(low), np.cos(high))
    known = *map(exact, (*line, np.cos(at), np.sin(at))), *slopes
    (found,) = newton(exact(at), over(low, high), *known)
    assert found.lower()[0] - 1e-12 <= root <= found.upper()[0] + 1e-12
    assert found.r[0] < 0.2
    (unknown,) = newton(exact(at), over(0.6, 0.8), *known)  # nothing is known of the slopes at the guess
    assert np.isinf(unknown.r[0])


@pytest.mark.parametrize("count", [0, 3, 7, 12])
def test_shares_of_phase_space_are_bounds_with_room_for_roundings(count):
    """Of twelve equal boxes: those from which every walk ends in a region, and those from which some does."""
    graph, block = random_graph(1, cut=False), np.zeros(13, dtype=bool)
    sure = np.arange(13) < count
    made = SimpleNamespace(transitions=graph, trapping=lambda _: block, basin=lambda _: sure)
    low, high = shares(made, 0)
    assert (low, high) == (pytest.approx(count / 12, abs=1e-8), pytest.approx(0, abs=1e-8))
    assert low < count / 12 or low == count == 0
    assert high > 0
    block[:] = True
    assert shares(made, 0)[1] == 1


@pytest.mark.parametrize(("parts", "held"), [(1, True), (16, True), (17, False), (0, False)])
def test_a_document_of_a_region_says_into_how_many_parts_its_boxes_are_cut_up_to_sixteen(parts, held):
    numbers = {"kind": "trapping region", "schema": 1, "lam": ["1/3", "1/2"], "columns": 4, "rows": 2, "parts": parts}
    document = numbers | {"scene": Scene("circle", lam="1/2").document, "runs": [[0, 1, 3, 0, 2]]}
    if not held:
        with pytest.raises(ValueError, match="parts"):
            Region.from_dict(document)
        return
    found = Region.from_dict(document)
    assert (found.parts, found.columns, found.rows, found.lam) == (parts, 4, 2, (Fraction(1, 3), Fraction(1, 2)))
    assert found.cells.row.tolist() == [0, 1]
