"""Where almost every orbit ends: known answers, and what must not be proved."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics import fates
from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.fates import (
    Cluster,
    Fate,
    _contraction,
    _reach,
    _rectangles,
    _staying,
    clusters,
    holding,
)
from verification.proofs.global_dynamics.flights import Piece, Slopes, matrix
from verification.proofs.global_dynamics.graph import Cells, Grid, Transitions

ONE = np.ones(1)
HORIZONTAL = ((0, 0.0, 0.0), (1, 0.0, 0.0))
LOW = Fate(Scene("cuspless"), (Fraction(0), Fraction(1, 100)), (1024, 16), 4, (HORIZONTAL,))
MINOR = ((0, np.pi / 2, 0.0), (0, -np.pi / 2, 0.0))
ELLIPSE = Fate(Scene("ellipse", a="3/2"), (Fraction(1, 10), Fraction(1, 10)), (512, 64), 4, (MINOR,))


def test_in_the_ellipse_almost_every_orbit_ends_on_the_minor_axis_as_is_known():
    assert ELLIPSE.proved
    assert sorted(part.sink for part in ELLIPSE.parts) == [False, True]  # the major axis is a saddle


def test_orbits_end_in_the_boxes_that_are_said_to_hold_what_returns():
    rng = np.random.default_rng(1)
    end = PinballMap("cuspless", lam="1/100").exponents(rng.uniform(-2, 2, 200), rng.uniform(-1.5, 1.5, 200), 1, 400)
    (sink,) = (part.boxes for part in LOW.parts if part.sink)
    at = {int(c): k for k, c in enumerate(sink.chart)}
    rows = np.array([at[int(c)] for c in end.component])

    assert np.all((sink.x[0][rows] < end.theta) & (end.theta < sink.x[1][rows]))
    assert np.all((sink.y[0][rows] < end.phi) & (end.phi < sink.y[1][rows]))


def test_under_another_law_it_is_proved_where_the_law_is_strictly_monotonic_and_nowhere_else():
    """Both laws have the slope `lam` along the normal, where the orbits end; the second one turns back on its way."""
    monotonic, folded = (
        replace(ELLIPSE, scene=Scene("ellipse", a="3/2", law=law))
        for law in ("-lam*(2*eta + sin(eta))/3", "-lam*sin(2*eta)/2")
    )

    assert monotonic.proved
    assert not folded.proved


@pytest.mark.parametrize(
    "wrong",
    [
        replace(LOW, cycles=()),  # an attracting cycle is not named
        replace(LOW, cycles=(((0, 0.5, 0.0), (1, 0.0, 0.0)),)),  # this is no cycle
        replace(LOW, cycles=(HORIZONTAL, HORIZONTAL)),
        replace(LOW, cycles=(((0, 1.0472, 0.0), (0, -1.0472, 0.0)),)),  # the vertical orbit is a saddle
        replace(LOW, lam=(Fraction(93, 1000), Fraction(94, 1000)), grid=(512, 64)),  # period 2 loses its stability
        replace(LOW, scene=Scene("circle"), cycles=(MINOR,)),  # each diameter is neutral
        replace(LOW, lam=(Fraction(7, 100), Fraction(71, 1000)), grid=(512, 64)),  # boxes that return meet a join
        replace(LOW, grid=(64, 4)),
    ],
)
def test_what_is_not_so_or_not_seen_is_not_proved(wrong):
    assert not wrong.proved


def slopes(*rows, radius=0.0):
    """Derivatives that take `(dtheta, dphi)` to `(a*dtheta + b*dphi, 0)`, with `a` known but for `radius`."""
    a, b = np.array(rows, dtype=float).T
    return Slopes(BallArray(a, 0 * a + radius), *(BallArray(x, 0 * x) for x in (b, 0 * a, 0 * a, 0 * a)))


def graph(size, *edges):
    return csr_matrix((np.ones(len(edges), dtype=bool), tuple(zip(*edges, strict=True))), shape=(size, size))


def test_factors_of_linear_maps_are_those_worked_out_by_hand():
    round = graph(2, (0, 1), (1, 0))
    each = np.arange(2)

    assert _contraction(slopes((0.5, 0), (0.5, 0)), each, round) == pytest.approx(0.5, abs=1e-6)
    assert _contraction(slopes((4, 0), (0.2, 0)), each, round) < 1  # 0.8 in a round
    assert _contraction(slopes((4, 0), (0.3, 0)), each, round) > 1
    assert _staying(slopes((2, 0), (2, 0)), each, round) == pytest.approx(2.0**-64, rel=1e-6)
    assert _staying(slopes((2, 0), (2, 0)), each, round) > 2.0**-64 * (1 + 64 * 1.5e-9)  # with room for roundings
    assert _staying(slopes((4, 0), (0.2, 0)), each, round) > 1
    for sign in (1, -1):  # of all derivatives in the balls the least favourable one
        wide = slopes((2 * sign, 0), (2 * sign, 0), radius=0.5)
        assert _staying(wide, each, round) == pytest.approx(1.5**-64, rel=1e-6)
        assert _contraction(slopes((0.5 * sign, 0), (0.5 * sign, 0), radius=0.25), each, round) == pytest.approx(
            0.75, abs=1e-6
        )
    assert _staying(slopes((1, 0), (-1, 0)), np.zeros(2, dtype=np.int64), graph(1, (0, 0))) is None  # it folds


LINKS = (0, 1), (1, 2), (2, 0), (1, 0), (2, 2)  # of three clusters


def random_slopes(random, wide):
    """Derivatives on seven pieces of three clusters, each stretched one way; the balls are so wide."""
    where = np.array([0, 0, 1, 1, 1, 2, 2])
    sign = random.choice([-1, 1], 3)[where]
    stretch, law = random.uniform(2.5, 3.5, 7) * sign, random.uniform(0.2, 0.4, 7)
    others = random.uniform(-0.5, 0.5, (3, 7))
    drift = random.uniform(-0.3, 0.3, 7)
    balls = [BallArray(x, np.full(7, wide)) for x in (stretch, *others, law, drift)]
    return where, Slopes(*balls)


@pytest.mark.parametrize("seed", range(6))
def test_cones_hold_all_slopes_that_come_to_a_cluster_and_walks_are_summed_by_the_least_growth(monkeypatch, seed):
    """Of horizontal vectors over all walks of six bounces; what is found is no less than that, and hardly more."""
    monkeypatch.setattr(fates, "WALKS", 3)
    where, s = random_slopes(np.random.default_rng(seed), 0.0)
    by_theta, by_phi, here, there, law, drift = (ball.m for ball in s)
    come = [[0.0], [0.0], [0.0]]
    for _ in range(6):
        after = [list(some) for some in come]
        for a, b in LINKS:
            for k in np.flatnonzero(where == a):
                for slope in come[a]:
                    stretch = by_theta[k] + by_phi[k] * slope
                    image = drift[k] - law[k] * (there[k] - (here[k] - slope) / stretch)
                    after[b].append(image)
        come = [[min(some), max(some)] for some in after]
    least = [
        min(abs(by_theta[k] + by_phi[k] * x) for k in np.flatnonzero(where == a) for x in come[a]) for a in range(3)
    ]
    sums = np.ones(3)
    for _ in range(3):
        sums = np.array([sum(sums[b] for a, b in LINKS if a == k) / least[k] for k in range(3)])
    found = _staying(s, where, graph(3, *LINKS))
    assert sums.max() < found < sums.max() * 1.05
    wide = random_slopes(np.random.default_rng(seed), 0.02)[1]
    assert found < _staying(wide, where, graph(3, *LINKS)) < found * 1.3


@pytest.mark.parametrize("side", [1, -1])
def test_a_cone_grows_until_it_holds_what_comes_when_that_comes_from_one_side_alone(side):
    """`slope' = side/10 + slope/(2 - side*slope/2)`: from 0 on one end stays, and the other one nears a fixed point."""
    one = lambda x: BallArray(np.array([float(x)]), np.zeros(1))  # noqa: E731
    found = _staying(Slopes(*map(one, (-2, side / 2, 0, 0, 1, side / 10))), np.zeros(1, dtype=int), graph(1, (0, 0)))
    slope = 0.0
    for _ in range(200):
        slope = side / 10 + slope / (2 - side * slope / 2)
    least = 2 - abs(slope) / 2
    assert least**-64.0 < found < (least - 0.01) ** -64.0


@pytest.mark.parametrize("seed", range(6))
def test_a_contraction_along_a_round_is_the_root_of_that_of_its_product_and_no_less(seed):
    """Of three clusters in a round, with two pieces each: of the greatest absolute values of the entries."""
    random = np.random.default_rng(seed)
    by_theta, by_phi, here, there, law, drift = random.uniform(-1, 1, (6, 6))
    radius = random.uniform(0, 0.1, 6)
    s = Slopes(BallArray(by_theta, radius), *(BallArray(x, 0 * x) for x in (by_phi, here, there, law, drift)))
    entries = matrix(s)
    size = np.array([[np.abs(x.m) + x.r for x in row] for row in entries])
    each = [np.maximum(size[:, :, 2 * k], size[:, :, 2 * k + 1]) for k in range(3)]
    root = np.max(np.abs(np.linalg.eigvals(each[2] @ each[1] @ each[0]))) ** (1 / 3)
    found = _contraction(s, np.repeat(np.arange(3), 2), graph(3, (0, 1), (1, 2), (2, 0)))
    assert root < found < root * (1 + 1e-7)
    assert _contraction(slopes((0.5, 0), (0.25, 0)), np.zeros(2, dtype=int), graph(1, (0, 0))) > 0.5 * (1 + 1.5e-9)
    unknown = s._replace(by_theta=BallArray(by_theta, np.where(np.arange(6) == 3, np.inf, radius)))
    with np.errstate(invalid="ignore"):
        assert _contraction(unknown, np.repeat(np.arange(3), 2), graph(3, (0, 1), (1, 2), (2, 0))) == np.inf


def test_the_rectangle_of_a_cluster_is_the_least_about_its_boxes_on_their_chart():
    """Of three clusters on two charts, of boxes of two sizes."""
    grid = Grid((Chart("a", (0.0, 4.0), (0.0, 4.0)), Chart("b", (10.0, 14.0), (-4.0, 0.0))), 4, 4)
    rows = [(0, 0, 0, 2), (0, 3, 3, 1), (0, 2, 1, 1), (1, 1, 2, 1), (1, 3, 0, 1)]
    cells = Cells(*(np.array(field) for field in zip(*rows, strict=True)))
    found = _rectangles(SimpleNamespace(grid=grid), cells, np.array([0, 2, 0, 1, 1]), 3)
    assert found.chart.tolist() == [0, 1, 0]
    assert np.allclose(np.transpose([*found.x, *found.y]), [(0, 3, 0, 2), (11, 14, -4, -1), (3, 4, 3, 4)])


def test_where_as_many_walks_go_on_as_stretching_thins_points_out_nothing_is_proved():
    full = graph(2, (0, 0), (0, 1), (1, 0), (1, 1))

    assert _staying(slopes((2, 0), (2, 0)), np.arange(2), full) >= 1  # x -> 2*x (mod 1): every point stays
    assert _staying(slopes((3, 0), (3, 0)), np.arange(2), full) < 1e-9  # the middle third leaves


def test_a_sink_is_not_said_to_hold_a_point_that_another_part_may_hold():
    def part(left: float, right: float, sink: bool) -> Cluster:
        return Cluster(
            Boxes(np.array([0]), (np.array([left]), np.array([right])), (left * ONE, right * ONE)), sink, 0.5
        )

    sink = part(-1, 1, True)

    assert holding([part(0.5, 2, False), sink], [(0, 0.0, 0.0)]) is sink
    assert holding([part(-0.5, 2, False), sink], [(0, 0.0, 0.0)]) is None  # its box may be the saddle's
    assert holding([part(0, 2, False), sink], [(0, 0.0, 0.0)]) is None  # on the border
    assert holding([sink], [(0, 1.0, 0.0)]) is None
    assert holding([sink], [(1, 0.0, 0.0)]) is None


def test_a_cycle_that_no_sink_holds_counts_for_none():
    """Two sinks, and two cycles of which one is in neither: of the other sink nothing is known."""

    def sink(at: float) -> Cluster:
        return Cluster(Boxes(np.array([0]), (at - ONE, at + ONE), (-ONE, ONE)), True, 0.5)

    def checks(*at: float) -> dict[str, bool | None]:
        fate = replace(LOW, cycles=tuple(((0, x, 0.0),) for x in at))
        fate.__dict__["parts"] = [sink(0.0), sink(9.0)]
        return fate.checks

    assert checks(0.0, 9.0)["sinks"] is True
    assert checks(0.0, 5.0)["sinks"] is None
    assert checks(0.0, 0.0)["sinks"] is None
    assert checks(0.0)["sinks"] is None


@pytest.mark.parametrize(
    ("factors", "answer"),
    [([0.5], True), ([0.5, 0.999], True), ([], True), ([1.0], None), ([0.5, 1.5], None), ([None], None)],
)
def test_saddles_are_told_where_of_each_other_set_less_than_all_points_stay(factors, answer):
    fate = replace(LOW, cycles=())
    fate.__dict__["parts"] = [Cluster(Boxes(np.array([0]), (ONE, ONE), (ONE, ONE)), False, x) for x in factors]

    assert fate.checks == {"returning": True, "sinks": True, "saddles": answer}
    assert fate.proved is (answer is True)
    fate = replace(LOW, cycles=())
    fate.__dict__["parts"] = None
    assert fate.checks == dict.fromkeys(("returning", "sinks", "saddles"))
    assert not fate.proved


def test_the_reach_of_a_cluster_is_that_of_its_furthest_box():
    assert list(_reach(np.array([3.0, 1.0, 5.0]), np.array([0, 0, 1]), 3)) == [3, 5, -np.inf]


class Landings:
    """In the place of a map: every box lands on one arc, and `theta` shrinks by a half, or is multiplied by so much."""

    def __init__(self, wide=1.0, closed=True, smooth=True, joins=0, less=0, others=(), factor=0.5, none=False, far=0.0):
        self.wide, self.closed, self.smooth, self.joins, self.less = wide, closed, smooth, joins, less
        self.factor, self.none, self.far = factor, none, far
        self.others = [(Piece(np.arange(count), None, None, None, False), None) for count in others]

    def derivatives(self, boxes):
        count = boxes.chart.size - self.less
        chart = np.arange(count) // self.joins % 2 if self.joins else np.zeros(count, dtype=int)
        low = np.linspace(-self.wide / 2, 0, count)
        high = low + self.wide / 2 + self.far * (np.arange(count) < 192)  # further of the first cluster
        piece = Piece(np.arange(count), chart, low, high, self.smooth)
        zero = BallArray(np.zeros(count), np.zeros(count))
        stretch = BallArray(np.full(count, self.factor), np.zeros(count))
        return [] if self.none else [(piece, Slopes(stretch, zero, zero, zero, zero)), *self.others]


@pytest.mark.parametrize(
    ("map", "edges", "sinks"),
    [
        (Landings(), [(9, 10), (32, 0)], []),  # no box returns
        (Landings(), [(9, 9)], [True]),
        (Landings(), [(9, 9), (27, 27)], [True, True]),
        (Landings(), [(9, 27), (27, 9), (1, 9)], [True]),  # box 1 is passed once
        (Landings(wide=6.0), [(9, 9)], None),  # with the box itself a whole turn and more
        (Landings(wide=6.0, closed=False), [(9, 9)], [True]),
        (Landings(smooth=False), [(9, 9)], None),
        (Landings(joins=1), [(9, 9)], None),
        (Landings(joins=96), [(9, 9)], None),
        (Landings(joins=192), [(9, 9), (27, 27)], [True, True]),  # each cluster on a component of its own
        (Landings(none=True), [(9, 9)], None),
        (Landings(), [(9, 9), (9, 27), (27, 27)], [True, True]),  # one leads to the other, and not back
        (Landings(), [(9, 9), (32, 32)], [True]),  # the outside, to which nothing leads
        (Landings(), [(9, 9), (31, 32), (32, 31)], None),  # to which the last box leads
        (Landings(less=1), [(9, 9)], None),
        (Landings(others=[0, 0]), [(9, 9)], [True]),
        (Landings(others=[0, 1]), [(9, 9)], None),  # some landings lie elsewhere
        (Landings(others=[1, 0]), [(9, 9)], None),
        (Landings(wide=7.0), [(9, 9), (25, 25)], [True, True]),
        (Landings(wide=7.0), [(9, 9), (25, 29), (29, 25)], None),  # of two clusters one is wider: with it a whole turn
        (Landings(far=6.0), [(9, 9), (27, 27)], None),  # of two clusters one lands within more than a turn
        (Landings(far=3.0), [(9, 9), (27, 27)], [True, True]),
        (Landings(), [(9, 9), (9, 32), (32, 9)], None),  # 32 is the outside: some box is lost
    ],
)
def test_boxes_that_return_are_judged_only_where_all_of_them_land_on_one_arc_less_than_a_turn(map, edges, sinks):
    grid = Grid((Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),), 8, 4)
    cells = grid.whole()
    found = clusters(map, Transitions(grid, cells, np.ones(32, dtype=bool), graph(33, *edges)), near=0)

    assert (found and [part.sink for part in found]) == sinks
    for part in found or ():
        assert part.factor == pytest.approx(0.5, abs=1e-6)
        assert np.all(part.boxes.x[1] - part.boxes.x[0] == pytest.approx(np.pi / 4))
        assert np.all(part.boxes.y[1] - part.boxes.y[0] == pytest.approx(0.5))


@pytest.mark.parametrize(
    ("map", "edges", "factor"),
    [
        (Landings(factor=1.5), [(9, 9)], 1.5**-64),
        (Landings(factor=3.0), [(9, 9), (9, 27), (27, 9)], None),
        (Landings(factor=0.5), [(9, 9), (9, 27), (27, 9)], None),  # walks go two ways
    ],
)
def test_what_stretches_and_what_walks_may_leave_two_ways_is_no_sink(map, edges, factor):
    grid = Grid((Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),), 8, 4)
    (part,) = clusters(map, Transitions(grid, grid.whole(), np.ones(32, dtype=bool), graph(33, *edges)), near=0)
    count = len({end for edge in edges for end in edge})
    assert (part.sink, part.boxes.chart.size) == (False, count)
    if factor:
        assert part.factor == pytest.approx(factor, rel=1e-6)
    else:  # as many walks as Fibonacci says
        number = [1, 1]
        for _ in range(65):
            number.append(sum(number[-2:]))
        assert part.factor == pytest.approx(number[65] / map.factor**64, rel=1e-6)


def test_among_some_vertices_those_that_are_passed_once_are_no_part_of_what_stays():
    """Where 5 leads to 9, and 9 to itself; 17, which returns too, is not among them."""
    grid = Grid((Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),), 8, 4)
    made = Transitions(grid, grid.whole(), np.ones(32, dtype=bool), graph(33, (5, 9), (9, 9), (17, 17)))
    assert [part.factor for part in clusters(Landings(), made, 0, np.isin(np.arange(33), (5, 9)))] == [
        pytest.approx(0.5)
    ]
    assert len(clusters(Landings(), made, 0)) == 2
    assert clusters(Landings(), made, 0, np.isin(np.arange(33), (5,))) == []


@pytest.mark.parametrize(("edges", "complete"), [([(4, 5), (5, 6), (6, 4)], False), ([(4, 5), (5, 6), (6, 6)], True)])
def test_walks_that_return_by_way_of_a_block_that_was_cut_leave_edges_between_leaves_in_doubt(edges, complete):
    """Leaf 4 is larger than a cell and leads to block 5, since cut: into 6, which leads back, or to itself alone."""
    grid = Grid((Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),), 8, 4)
    cells, leaf = grid.whole(), np.ones(32, dtype=bool)
    leaf[5] = False
    cut = Transitions(grid, cells, leaf, graph(33, (4, 4), (6, 6), *edges))
    assert cut.complete(cut.recurrent) == complete
    assert (clusters(Landings(), cut, near=0) is not None) == complete
