"""Small steps of the proofs on sets of starts, each by itself: what is covered, and what is said where it fails."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from symbolic import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.arithmetic.balls import working
from verification.cycles.recurrence import Closure
from verification.proofs.corner.corner import ARC, WALL, corner_parameters
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.slap_map import exponent
from verification.proofs.starts import alternating, below_star, core, division, strips
from verification.proofs.starts.alternating import Alternating
from verification.proofs.starts.basin_edge import BasinEdge
from verification.proofs.starts.below_star import BelowStar
from verification.proofs.starts.chords import Chords
from verification.proofs.starts.core import Core
from verification.proofs.starts.division import Division, Ring
from verification.proofs.starts.strips import Strips

CURVED = Core(0, -0.4, 0.9, 0.0025, 0.2, 0.3, 12)


def corners(theta: float, width: float, slope: float = CURVED.slope) -> list[tuple[float, float]]:
    """Points of the set at one place of its curve."""
    return [(theta, (slope + CURVED.cubic * theta**2) * theta + s * width) for s in (-1, -0.9, -0.3, 0, 0.4, 1)]


def test_the_slabs_of_a_gate_cover_it(monkeypatch):
    """Each point of the half `theta >= 0` lies in a parallelogram whose image is asked for."""
    asked = []
    monkeypatch.setattr(core, "twice", lambda map, sets: asked.append(sets))
    assert not core._leads(None, CURVED, 0.25, 0.0025)
    (sets,) = asked
    for theta in np.linspace(0, 0.25, 40):
        for x, y in corners(theta, 0.0025):
            along = (x - sets.middle[0]) / sets.sides[0, 0]
            far = np.abs(y - sets.middle[1] - along * sets.sides[1, 0]) <= sets.sides[1, 1] + sets.rest[1]
            assert np.any(far & (np.abs(along) <= 1))


@pytest.mark.parametrize("slope", [-0.4, 0.4])
def test_orbits_converge_over_boxes_that_hold_all_of_the_inner_core(monkeypatch, slope):
    asked = []
    monkeypatch.setattr(core, "derivative", lambda map, boxes: asked.append(boxes))
    assert not core._converges(None, replace(CURVED, slope=slope))
    (boxes,) = asked
    for theta in np.linspace(-0.2, 0.2, 41):
        for x, y in corners(theta, CURVED.width, slope):
            held = (boxes.x[0] <= x) & (x <= boxes.x[1]) & (boxes.y[0] <= y) & (y <= boxes.y[1])
            assert np.any(held)


@pytest.mark.parametrize(("factor", "stretched"), [(1 + 1e-9, True), (1.0, False), (1 - 1e-9, False)])
def test_a_ring_stretches_by_more_than_its_growth_so_that_roundings_are_covered(monkeypatch, factor, stretched):
    ring = Ring(0.1, 0.2, 0.0, 0.0, 0.1, 0.1, 1.001)

    def derivative(map, boxes):
        one, none = (BallArray(np.full(boxes.chart.size, x), np.zeros(boxes.chart.size)) for x in (1.0, 0.0))
        return (one * (1.001 * factor), none), (none, one * 0.01)

    monkeypatch.setattr(division, "derivative", derivative)
    assert ring.stretches(None, 0) is stretched


@pytest.mark.parametrize("leans", [(0.5, -0.25), (-0.25, 0.5), (0.1, 0.8)])
def test_the_measure_of_a_strip_is_bounded_by_the_speed_over_all_that_it_reaches(monkeypatch, leans):
    """From the outermost end of either line to that of the other."""
    asked = []
    monkeypatch.setattr(strips, "speeds", lambda map, chart, whole: (asked.append(whole), BallArray(np.ones(1)))[1])
    left, right, middle, half = 0.3, 0.4, 0.6, 0.05
    one = Strips(np.zeros(1, int), *(np.array([x]) for x in (left, right, *leans, middle, half)))
    measure = one.measures(None)
    ends = [end + s * lean * half for end, lean in zip((left, right), leans, strict=True) for s in (1, -1)]
    assert asked[0].lower()[0] <= min(ends)
    assert asked[0].upper()[0] >= max(ends)
    assert measure[0] >= (right - left) * (np.sin(middle + half) - np.sin(middle - half))
    assert measure[0] <= (right - left) * 2 * half * np.cos(middle - half) * 1.001


@pytest.mark.parametrize(("stretches", "joined"), [
    ([(0, 0.0, 1.0, 1), (0, 1.0, 2.0, 1)], [(0, 0.0, 2.0)]),
    ([(0, 0.0, 3.0, 1), (0, 1.0, 2.0, 1)], [(0, 0.0, 3.0)]),
    ([(0, 0.0, 1.0, 1), (0, 1.25, 2.0, 1)], [(0, 0.0, 1.0), (0, 1.25, 2.0)]),
    ([(0, 0.0, 1.0, 1), (0, 1.0, 2.0, -1)], [(0, 0.0, 1.0), (0, 1.0, 2.0)]),
    ([(0, 0.0, 1.0, 1), (1, 1.0, 2.0, 1)], [(0, 0.0, 1.0), (1, 1.0, 2.0)]),
])  # fmt: skip
def test_stretches_of_one_sign_are_one_where_they_touch(stretches, joined):
    assert exponent._joined(stretches) == joined


@pytest.mark.parametrize("name", ["egg", "cuspless", "ellipse"])
def test_the_landing_of_the_middle_of_a_box_is_that_of_float64(name):
    """Within what is enclosed, which is thin; 1e-11 is for roundings."""
    shape = {"egg": {"alpha": "0.08"}, "cuspless": {}, "ellipse": {"a": "1.3"}}[name]
    scene = Scene(name, lam="1/2", **shape)
    map, rng = PinballImages(scene), np.random.default_rng(2)
    low, high = map.charts[0].x
    theta, phi = rng.uniform(low + 0.05, high - 0.05, 60), rng.uniform(-0.7, 0.7, 60)
    boxes = Boxes(np.zeros(60, int), (theta - 1e-4, theta + 1e-4), (phi - 1e-4, phi + 1e-4))
    step = PinballMap(scene).step(theta, phi, np.zeros(60, int))
    flights, seen = Chords(map, boxes), 0
    for on, chart, first, last, smooth in flights.split(*flights.arcs()):
        if smooth:
            arc = hull(first, last)
            at = BallArray(arc.m + arc.r / 3)  # from any place in the arc
            flights.kept = arc, at, map.place(chart, at)
            landing, exit = flights.midpoints(on, chart, arc, flights.slopes(on, chart, arc).bend_there)
            off = np.remainder(step.theta[on] - landing.m + np.pi, 2 * np.pi) - np.pi if map.closed else (
                step.theta[on] - landing.m
            )  # fmt: skip
            assert np.all(np.abs(off) <= landing.r + 1e-11)
            assert np.all(np.abs(step.phi[on] - exit.m) <= exit.r + 1e-11)
            assert np.all(landing.r < 1e-5)
            seen += on.size
    assert seen > 30


@pytest.mark.parametrize("at", [None, 0, 3])
def test_an_orbit_comes_where_one_of_its_bounces_is_inside(monkeypatch, at):
    """Asked of each bounce with the one before it; of as many as are allowed."""

    class Map:
        start = staticmethod(lambda *point: 0)
        orbit = staticmethod(lambda before, count: range(1, count + 1))

    monkeypatch.setattr(alternating, "EnclosedMap", lambda *_: Map)
    asked = []

    def inside(before, here):
        asked.append((before, here))
        return at is not None and here == at + 1

    made = Alternating(Fraction(1, 2), CURVED)
    assert made._comes((arb(0), arb(0)), inside) is (at is not None)
    count = alternating.MOST_BOUNCES if at is None else at + 1
    assert asked == [(k, k + 1) for k in range(count)]


def test_the_first_derivatives_are_those_of_all_contractions_below_lambda_star(monkeypatch):
    """From `depth` below it up to it, and of places on both sides of the first bounce."""
    given = []

    def after(join, here, late, lam, spread):
        given.append((here.at, lam))
        return [None]

    monkeypatch.setattr(below_star, "after_corner", after)
    monkeypatch.setattr(below_star, "beyond", lambda *_: SimpleNamespace(slopes=(arb(1), arb(2))))
    depth = arb(1) / 1000
    with working(100):
        theta1, star = below_star.enclosed()
        below_star.first_hull(depth)
        for share in (0.01, 0.5, 0.99):
            assert any(lam.whole.contains(star - depth * share) for _, lam in given)
        assert not any(lam.whole.contains(star + depth / 2) for _, lam in given)
        for u in (-0.99, 0.0, 0.99):
            assert any(at.whole.contains(theta1 - u * below_star.BESIDE) for at, _ in given)


STEPS = ("boxes", "core", "inner", "starts", "exits", "carried")


@pytest.mark.parametrize("held", [*STEPS, "", "all"])
def test_what_is_not_proved_below_lambda_star_is_open_and_not_false(monkeypatch, held):
    says = lambda step: held in (step, "all")  # noqa: E731
    monkeypatch.setattr(below_star, "unreturning", lambda *_: says("boxes"))
    monkeypatch.setattr(below_star, "attracts", lambda *_: {"one": True, "other": says("core")})
    monkeypatch.setattr(below_star, "hulls", lambda *_: None)
    monkeypatch.setattr(below_star, "first_hull", lambda *_: None)
    monkeypatch.setattr(below_star, "inner", lambda *_: says("inner"))
    monkeypatch.setattr(below_star, "begins", lambda *_: says("starts"))
    monkeypatch.setattr(BelowStar, "_exits", lambda *_: says("exits"))
    monkeypatch.setattr(BelowStar, "_carried", lambda *_: says("carried"))
    found = BelowStar(((SimpleNamespace(lam=(Fraction(0), below_star.NEXT)), None),), CURVED)
    assert found.checks == {step: True if says(step) else None for step in found.checks}
    assert set(found.checks) == set(STEPS)


@pytest.mark.parametrize("sign", [1, -1])
def test_two_bounces_are_those_of_a_point_of_the_polygon_or_of_its_mirror_image(sign):
    """Of a square, in units of `lam - lambda*`; the first bounce on the arc, the second on the arc or the wall."""
    made = Alternating(Fraction(3, 40), CURVED)
    made.__dict__["polygon"] = SimpleNamespace(region=[(-1, -1), (1, -1), (1, 1), (-1, 1)])
    with working(alternating.BITS):
        theta1, star = alternating.enclosed()
        e = arb(3) / 40 - star

        def held(u, v, components=(ARC, ARC)):
            ends = -theta1 + u * e, corner_parameters()[components[1]] + v * e
            pair = (SimpleNamespace(component=c, theta=sign * x) for c, x in zip(components, ends, strict=True))
            return made.in_polygon(*pair)

        for second in (ARC, WALL):
            assert held(0.5, -0.75, (ARC, second))
            assert not held(1.5, 0.0, (ARC, second))
            assert not held(0.5, -0.75, (WALL, second))
            assert not held(0.5, 1.5, (ARC, second))


@pytest.mark.parametrize(("low", "high", "rows"), [
    (0.5, 0.5, [1]), (0.8, 0.95, [2]), (0.1, 0.9, [0, 1, 2]), (0.9, 1.2, [2]), (-0.2, 0.1, [0]), (0.5, 1.6, [1, 2]),
])  # fmt: skip
def test_edges_lead_to_the_cells_that_an_image_meets_and_to_no_others(low, high, rows):
    """Of four columns and three rows, where an image may end beyond the last row and go over the end of the turn."""

    def images(boxes):
        full = lambda x: np.full(boxes.chart.size, float(x))  # noqa: E731
        x, y = (full(np.pi * 3 / 8), full(np.pi * 5 / 8)), (full(low), full(high))
        return SimpleNamespace(lost=np.zeros(0, int), boxes=Boxes(boxes.chart, x, y), source=np.arange(full(0).size))

    barrier = SimpleNamespace(turns=2, map=SimpleNamespace(top=1.0, images=images))
    made = BasinEdge(barrier, (0.0, 0.0), replace(TRIANGLE, closure=Closure(1, (1, 2))), 0.01)
    column, row = (index.ravel() for index in np.indices((4, 3)))
    found = made._edges(column, row, made._boxes(column, row, 4, 3), 4, 3)
    wanted = {(k, c * 3 + r) for k in range(12) for c in (3, 0) for r in rows}
    assert set(zip(*(ends.tolist() for ends in found), strict=True)) == wanted


def test_strips_are_cut_into_as_many_columns_and_rows_as_are_asked_for():
    """Which cover all angles between the normal and the tangent."""
    found = strips.strips(PinballImages(Scene("egg", alpha="0.08", lam="1/2")), (5,), 3)
    assert found.chart.size == 15
    middles = np.unique(found.middle)
    assert middles.size == 3
    assert np.min(found.middle - found.half) <= 0
    assert np.max(found.middle + found.half) >= np.pi / 2 - 1e-15
    assert np.all(np.diff(middles) <= 2 * found.half[0])


@pytest.mark.parametrize(
    ("first", "last"), [(-0.0203, 0.0101), (-0.05, -0.0158), (0.0101, 0.05), (np.nan, 0.0101), (-0.0203, np.nan)]
)
def test_orbits_from_the_join_are_carried_that_leave_beside_the_first_ones(monkeypatch, first, last):
    """All of those, and none that leave among the first ones, at angles between `first` and `last`."""
    asked, ends = [], iter((arb(first), arb(last)))
    monkeypatch.setattr(below_star, "_leaving", lambda _: next(ends))
    for name in ("unreturning", "inner", "begins"):
        monkeypatch.setattr(below_star, name, lambda *_: True)
    for name in ("attracts", "hulls", "first_hull"):
        monkeypatch.setattr(below_star, name, lambda *_: {})
    monkeypatch.setattr(BelowStar, "_exits", lambda _: True)
    monkeypatch.setattr(BelowStar, "_carried", lambda _, map, low, high: asked.append((low, high)))
    assert BelowStar((), CURVED).checks["carried"] is None
    ((low, high),) = asked
    assert not np.any((low >= first) & (high <= last))
    for angle in np.linspace(-below_star.ANGLE, below_star.ANGLE, 101):
        assert np.any((low <= angle) & (angle <= high)) or first < angle < last


def test_states_next_to_the_join_lie_in_the_boxes_that_are_to_be_in_the_core(monkeypatch):
    """With the roundings of all four ends."""
    asked = []
    monkeypatch.setattr(below_star, "Parallelograms", SimpleNamespace(about=asked.append))
    monkeypatch.setattr(below_star, "cuts", lambda low, high, size: [arb((low + high) / 2, abs(high - low) / 7)])
    core = SimpleNamespace(enters=lambda _: np.array([True]))
    with working(below_star.BITS):
        assert BelowStar((), core)._exits()
        theta1, _ = below_star.enclosed()
        v = below_star.cuts(below_star.V_HIGH, below_star.FAR, 0)[0]
        u = below_star.cuts(-below_star.THICK, below_star.LEAN * float(v.upper()) + below_star.THICK, 0)[0]
        at = corner_parameters()[WALL] + v
        ends = (below_star.Bounce(c, below_star.constant(x, ())) for c, x in ((WALL, at), (ARC, u - theta1)))
        eta = below_star.angle(*ends)[0]
        lam = arb(below_star.NEXT.numerator) / below_star.NEXT.denominator
        lam = lam.union(arb(below_star.TOP.numerator) / below_star.TOP.denominator)
        (boxes,) = asked
        for ball, (low, high) in ((at, boxes.x), (-lam * eta, boxes.y)):
            assert arb(low[0]) < ball.lower()
            assert arb(high[0]) > ball.upper()
            assert float(ball.lower()) - low[0] < 1e-12
            assert high[0] - float(ball.upper()) < 1e-12


@pytest.mark.parametrize(("x", "y", "outside", "held"), [
    ((1.0, 2.0), (-1.0, 1.0), False, True),
    ((0.0, 2.0), (-1.0, 1.0), False, False),  # the horizontal orbit is at its border
    ((-2.0, 0.0), (-1.0, 0.0), False, False),
    ((-2.0, 2.0), (0.0, 1.0), False, False),
    ((-2.0, 2.0), (0.5, 1.0), False, True),
    ((1.0, 2.0), (-1.0, 1.0), True, False),
])  # fmt: skip
def test_a_region_beside_the_core_holds_no_point_of_the_horizontal_orbit_and_lets_nothing_out(x, y, outside, held):
    boxes = Boxes(np.zeros(1, int), *((np.array([low]), np.array([high])) for low, high in (x, y)))
    grid = SimpleNamespace(boxes=lambda _: boxes)
    graph = SimpleNamespace(
        transitions=SimpleNamespace(grid=grid, chosen=lambda found: found),
        attracting=(0,), sets=(np.array([0]),), trapping=lambda _: np.array([True, outside]),
    )  # fmt: skip
    found = Division.region.func(SimpleNamespace(graph=graph, settled=np.array([False, False])))
    assert (found is not None) is held
