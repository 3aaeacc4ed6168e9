"""The destination of almost every orbit: known answers, and false statements that are refused."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.fates import (
    AlmostEveryOrbit,
    Cluster,
    FewAttractingCycles,
    clusters,
    holding,
)
from verification.proofs.global_dynamics.flights import LandingArcs, Slopes
from verification.rigorous.boxes import Boxes, Chart
from verification.rigorous.graph import Grid, Transitions

HORIZONTAL = ((0, 0.0, 0.0), (1, 0.0, 0.0))
LOW = AlmostEveryOrbit(Scene("cuspless"), (Fraction(0), Fraction(1, 100)), (1024, 16), 4, (HORIZONTAL,))
MINOR = ((0, np.pi / 2, 0.0), (0, -np.pi / 2, 0.0))
ELLIPSE = AlmostEveryOrbit(Scene("ellipse", a="3/2"), (Fraction(1, 10), Fraction(1, 10)), (512, 64), 4, (MINOR,))


def test_in_the_ellipse_orbits_end_on_the_minor_axis():
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


def test_about_each_diameter_of_the_egg_at_most_one_cycle_attracts_and_orbits_end_there():
    found = FewAttractingCycles(Scene("egg", alpha="2/25"), (Fraction(0), Fraction(1, 128)), (12288, 256), 32, 3)
    left, right = np.concatenate([part.boxes.x for part in found.parts if part.sink], axis=1)
    orbit = PinballMap("egg", alpha="2/25", lam="1/256").orbit([0.3, 1.3, 2.6], [0.0] * 3, 2000)
    last = np.remainder(orbit.theta[-4:] + np.pi, 2 * np.pi).ravel() - np.pi

    assert found.proved
    assert np.all(np.any((left < last[:, None]) & (last[:, None] < right), axis=1))


def test_it_is_proved_under_strictly_monotonic_laws():
    """Both laws have the slope `lam` at the normal, where orbits end; the second is not monotonic and is refused."""
    monotonic, folded = (
        replace(ELLIPSE, scene=Scene("ellipse", a="3/2", law=law))
        for law in ("-lam*(2*eta + sin(eta))/3", "-lam*sin(2*eta)/2")
    )

    assert monotonic.proved
    assert not folded.proved


@pytest.mark.slow
@pytest.mark.parametrize(
    "wrong",
    [
        replace(LOW, lam=(Fraction(93, 1000), Fraction(94, 1000)), grid=(512, 64)),  # period 2 loses its stability
        replace(LOW, scene=Scene("circle"), cycles=(MINOR,)),  # each diameter is neutral
        replace(LOW, grid=(64, 4)),
    ],
)
def test_what_is_not_so_or_not_seen_is_not_proved(wrong):
    assert not wrong.proved


def graph(size, *edges):
    return csr_matrix((np.ones(len(edges), dtype=bool), tuple(zip(*edges, strict=True))), shape=(size, size))


@pytest.mark.parametrize("point", [(1, 0.001, 0.0), (1, 1e-5, 0.0), (1, 0.0, 1e-5), (0, 0.0, 0.0)])
def test_points_that_are_no_cycle_prove_nothing(point):
    fate = replace(LOW, cycles=((HORIZONTAL[0], point),))

    assert fate.checks["cycles"] is None
    assert not fate.proved


class Landings:
    """A stand-in for a map: every box lands on one arc, and `theta` shrinks by half or by `factor`."""

    def __init__(self, wide=1.0, closed=True, smooth=True, joins=0, less=0, others=(), factor=0.5, none=False, far=0.0):
        self.wide, self.closed, self.smooth, self.joins, self.less = wide, closed, smooth, joins, less
        self.factor, self.none, self.far = factor, none, far
        self.others = [(LandingArcs(np.arange(count), None, None, None, False), None) for count in others]

    def derivatives(self, boxes):
        count = boxes.chart.size - self.less
        chart = np.arange(count) // self.joins % 2 if self.joins else np.zeros(count, dtype=int)
        low = np.linspace(-self.wide / 2, 0, count)
        high = low + self.wide / 2 + self.far * (np.arange(count) < 192)  # further of the first cluster
        piece = LandingArcs(np.arange(count), chart, low, high, self.smooth)
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
def test_boxes_are_judged_where_all_land_on_one_arc(map, edges, sinks):
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
    assert part.growth == pytest.approx(np.log(map.factor), abs=1e-6)
    if factor:
        assert part.factor == pytest.approx(factor, rel=1e-6)
    else:  # as many walks as Fibonacci says
        number = [1, 1]
        for _ in range(65):
            number.append(sum(number[-2:]))
        assert part.factor == pytest.approx(number[65] / map.factor**64, rel=1e-6)


def cluster(sink: bool, *rectangles: tuple[float, float, float, float]) -> Cluster:
    left, right, low, high = np.array(rectangles, dtype=float).T
    return Cluster(Boxes(np.zeros(left.size, int), (left, right), (low, high)), sink, None)


def test_a_cycle_is_held_by_one_sink_alone():
    """All points lie inside one sink, each in one of its boxes, and on the border of no other cluster."""
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
