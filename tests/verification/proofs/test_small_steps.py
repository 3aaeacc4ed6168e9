"""Small steps of proofs, each by itself: cells, cones, strips and bounds that a fresh sample of mutants left unseen."""

from dataclasses import replace
from fractions import Fraction
from math import cos, sin
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb
from sympy import Rational

from symbolic import tables
from symbolic.tables import circle, egg
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import FLOAT64
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Closure
from verification.maps import first_hit
from verification.maps.enclosed import _text
from verification.proofs.corner import half_return
from verification.proofs.corner.border_collision import Expansion, _strip
from verification.proofs.corner.half_return import Step
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.graph import Grid
from verification.proofs.manifolds import enclosed
from verification.proofs.manifolds.horseshoe import _expands
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.manifolds.plane_map import Henon, Pinball, pinball
from verification.proofs.manifolds.tangency import Precision
from verification.proofs.periodic import returning, torus, triangles
from verification.proofs.periodic.bifurcation import _nonzero
from verification.proofs.periodic.interval_newton import Cover, Status, interval_newton, no_others
from verification.proofs.slap_map import transfer
from verification.proofs.starts import division
from verification.proofs.starts.basin_edge import BasinEdge
from verification.proofs.starts.core import Core
from verification.proofs.starts.division import Ring
from verification.proofs.starts.parallelograms import Parallelograms


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_boxes_hold_their_cells_with_exact_ends(scale):
    """In rationals: columns and rows that are no powers of two, on charts large and small."""
    rng = np.random.default_rng(1)
    for columns, rows in ((7, 3), (48, 36), (100, 10)):
        ends = [tuple(sorted(rng.uniform(-scale, scale, 2).tolist())) for _ in range(2)]
        grid = Grid((Chart("one", *ends),), columns, rows)
        cells = grid.whole()
        boxes = grid.boxes(cells)
        for (low, high), count, first, (left, right) in (
            (ends[0], columns, cells.column, boxes.x),
            (ends[1], rows, cells.row, boxes.y),
        ):
            step = (Fraction(high) - Fraction(low)) / count
            for k, a, b in zip(first.tolist(), left.tolist(), right.tolist(), strict=True):
                assert Fraction(a) < Fraction(low) + k * step
                assert Fraction(low) + (k + 1) * step < Fraction(b)


def test_a_number_is_not_0_where_its_ball_is_finite_and_holds_no_0():
    assert _nonzero(arb(2, 1)) is True
    assert _nonzero(arb(-2, 1)) is True
    for unknown in (arb(0), arb(1, 2), arb("inf"), arb("-inf"), arb("nan")):
        assert _nonzero(unknown) is None


@pytest.mark.parametrize("good", [(1, -1), (1,), (-1,), ()])
def test_a_ring_stretches_where_both_of_its_parts_do(monkeypatch, good):
    """Each part is known by the sign of its places."""
    ring = Ring(0.1, 0.2, 0.0, 0.0, 0.1, 0.1, 1.001)

    def derivative(map, boxes):
        side = 1 if np.all(boxes.x[0] > 0) else -1
        one, none = (BallArray(np.full(boxes.chart.size, x), np.zeros(boxes.chart.size)) for x in (1.0, 0.0))
        return (one * (2.0 if side in good else 0.5), none), (none, one * 0.1)

    monkeypatch.setattr(division, "derivative", derivative)
    assert ring.stretches(None, 0) is (good == (1, -1))


def test_the_width_of_a_strip_is_measured_across_its_longest_diagonal():
    """Of a rhombus, turned and moved: its diagonals."""
    for angle, shift in ((0.0, (0.0, 0.0)), (0.7, (3.0, -1.0)), (2.0, (-5.0, 4.0))):
        along, across = (cos(angle), sin(angle)), (-sin(angle), cos(angle))
        tips = [(2.0, 0.0), (0.0, 0.25), (-2.0, 0.0), (0.0, -0.5)]
        points = [tuple(s + u * a + v * b for s, a, b in zip(shift, along, across, strict=True)) for u, v in tips]
        length, width = _strip(points)
        assert length == pytest.approx(4, abs=1e-8)
        assert width == pytest.approx(0.75, abs=1e-8)
        assert length > 4
        assert width > 0.75


@pytest.mark.parametrize(
    ("inside", "v", "told"), [(True, -1, True), (True, 0, None), (True, 1, None), (False, -1, None)]
)
def test_a_fixed_point_is_on_the_arc_where_it_is_inside_and_below_the_border(monkeypatch, inside, v, told):
    monkeypatch.setattr(half_return, "holds", lambda region, cycle: inside)
    made = Step((0.0, 1.0), [], Expansion((arb(0), arb(1)), arb(1), arb(2)), (arb(0), arb(v)))
    assert made.saddle is told


@pytest.mark.parametrize(("unstable", "factor"), [(True, 2), (False, Fraction(1, 2))])
def test_errors_shrink_by_a_power_of_the_factor_with_each_round_outwards(unstable, factor):
    """Of one bounce a round, to the order 1: a quarter a round, so a sixteenth for the one after the next."""
    factor = arb(Fraction(factor).numerator) / Fraction(factor).denominator
    made = SimpleNamespace(unstable=unstable, factor=factor, order=1)
    (found,) = enclosed.bounds(made, [(0, arb(1), arb(8), arb(32))], [arb(1)])
    assert found.contains(1 + 8 / 4 + 32 / 16)
    assert found.upper() < 5 + 1e-6


def test_a_piece_of_the_boundary_on_one_side_of_a_chord_is_settled_at_once():
    """One look at the piece is enough; one on the line is looked at again, at its middle."""
    looks = []

    def wall(height):
        return lambda at: (looks.append(at), (at, arb(height), arb(1), arb(0)))[1]

    chord = [arb(0), arb(0)], [arb(3), arb(0)]
    assert first_hit._passes(wall(1), arb(1, 0.5), [], *chord)
    assert len(looks) == 1
    assert not first_hit._passes(wall(0), arb(1, 0.5), [], *chord)
    assert len(looks) == 3


def test_a_last_gap_that_may_be_that_of_a_cycle_is_asked_about():
    """Of 5/8, a little above the least gap of 1/2, and the second gap is the largest."""

    def asked(*_):
        raise AssertionError

    cover = Cover(Problem(circle, (0, 0, 0), lam=arb(1) / 2), asked, asked, 0.5, [])
    rest = round((2 * np.pi - 3) * 2**20) / 2**20  # whose sums are exact
    with pytest.raises(AssertionError):
        cover.settled([(0.0, 1.0), (3.0, 0.01), (rest - 0.625, 0.01)], 1)
    assert cover.settled([(0.0, 1.0), (3.0, 0.01), (rest - 0.375, 0.01)], 1)
    assert cover.settled([(0.0, 1.0), (6.25, 0.375)], 2)  # nor one of nearly a whole turn, or more


@pytest.mark.parametrize("turned", [1, -1])
def test_a_core_holds_a_set_only_where_all_of_it_is_near_its_curve(turned):
    """Thin sets about a cubic, at its middle and beside it: how far their ends are off is worked out in rationals."""
    slope, cubic = Fraction(-1, 3) * turned, Fraction(5, 2) * turned
    curve = lambda x: slope * x + cubic * x**3  # noqa: E731
    for at in (Fraction(0), Fraction(1, 8), Fraction(-1, 4)):
        for reach in (Fraction(1, 16), Fraction(1, 4)):
            tangent = slope + 3 * cubic * at**2
            off = max(abs(curve(at + s * reach) - curve(at) - tangent * s * reach) for s in (1, -1))
            sides = np.array([[[float(reach)], [0.0]], [[float(tangent * reach)], [0.0]]])
            sets = Parallelograms(
                np.zeros(1, int), np.array([[float(at)], [float(curve(at))]]), sides, np.zeros((2, 1))
            )
            core = lambda width: Core(0, float(slope), float(cubic), width, 0.5, 2.0, 4)  # noqa: E731
            assert not core(float(off) * 0.99).holds(sets)[0]
            assert core(float(off) * 4 + 1e-9).holds(sets)[0]


def test_pieces_that_are_not_all_of_one_round_are_not_judged():
    """The third leads into a round of the other two, which would contract."""
    shrinks = returning.Image((), (0.0, 0.0), ((0.5, 0.5), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)))
    leads = {2: {5: (0.0, 0.0)}, 5: {2: (0.0, 0.0)}, 8: {2: (0.0, 0.0)}}
    images = dict.fromkeys(leads, shrinks)
    assert returning._judged([2, 5], leads, images, 0.1) is not None
    assert returning._judged([2, 5, 8], leads, images, 0.1) is None


def test_a_round_of_the_basin_is_one_bounce_and_a_part_of_a_turn():
    """Of two equal parts at least; what each entry is of another saddle is refused."""
    saddle = replace(TRIANGLE, closure=Closure(1, (1, 2)))
    made = BasinEdge(SimpleNamespace(turns=2), (0.0, 0.0), saddle, 0.01)
    assert made.turn == np.pi
    for turns, closure, start in (
        (1, Closure(1, (1, 1)), saddle.start), (2, Closure(-1, (1, 2)), saddle.start),
        (3, Closure(1, (1, 2)), saddle.start), (2, saddle.closure, saddle.start * 2),
    ):  # fmt: skip
        with pytest.raises(ValueError, match="not one bounce"):
            BasinEdge(SimpleNamespace(turns=turns), (0.0, 0.0), replace(saddle, closure=closure, start=start), 0.01)


def test_launching_points_are_those_of_an_even_number_of_cells_up_to_4096(monkeypatch):
    def branches(bits):
        raise AssertionError

    monkeypatch.setattr(transfer, "Branches", branches)
    for cells in (2, 4096):
        with pytest.raises(AssertionError):
            transfer.launching_points(cells)
    for cells in (0, -2, 3, 4098):
        with pytest.raises(ValueError, match="even number"):
            transfer.launching_points(cells)


def test_a_law_of_the_place_leaves_the_map_no_turn_of_the_table():
    """Under the paper's law the egg's turns by a third change nothing."""
    table = egg(3).at(alpha=Fraction(2, 25))
    assert pinball(table).turn == 3
    assert pinball(table, Law("-lam*eta + cos(theta)/20")).turn == 1


def test_a_cell_leads_to_all_to_which_a_stretch_may_reach_by_a_rounding():
    """At its upper end as at its lower one."""
    width = 0.1
    for cells in (1, 3, 7):
        edge, near = cells * width, returning.SLACK * width / 4
        below = returning.Image(((edge - 0.05, edge - near, 1),), (0.0, 0.1), ((0.0, 0.0),) * 4)
        above = returning.Image(((edge + near, edge + 0.05, 1),), (0.0, 0.1), ((0.0, 0.0),) * 4)
        for image in (below, above):
            images = dict.fromkeys(range(10), image)
            assert set(returning._leads(images, (0.5, 0.5), width)[0]) == {cells - 1, cells}


@pytest.mark.parametrize(("first", "last"), [((0, -1), (0, 1)), ((0, 1), (0, -1))])
def test_a_chord_along_the_outside_is_refused_before_the_boundary_is_looked_at(first, last):
    """Of two walls, along `y = 0` and `y = 1`, one with its inside on the wrong side."""
    looks = []

    def wall(height, way):
        return lambda at: (looks.append(at), (at * way, arb(height), arb(way), arb(0)))[1]

    ends = [(arb(-1), arb(1))] * 2
    boundary = first_hit.Boundary([wall(0, first[1]), wall(1, last[1] * -1)], ends)
    assert not first_hit.free(boundary, (0, arb(0)), (1, arb(0)))
    assert len(looks) == 2


def test_where_a_question_on_all_cycles_is_not_asked_no_box_is_counted():
    """Of a table with a corner, and one that is not convex."""
    for table in (tables.cuspless, tables.cardioid):
        found = no_others(SimpleNamespace(table=table, law=PAPERS_LAW, count=lambda n: 5), Rational(1, 2), 2)
        assert (found.complete, found.boxes, found.known, found.period) == (None, 0, 5, 2)


def test_the_plane_of_the_henon_map_is_that_in_which_it_is_written():
    """`(x, y)` to `(1 - a*x**2 + y, b*x)`, and back."""
    map = Henon(Rational(3, 10)).over(FLOAT64)
    before, here, a = 0.25, -0.5, 1.4
    x, y = map.plane(before, here)
    following = map.following(before, here, a)
    assert (x, y) == (here, pytest.approx(0.3 * before))
    assert map.plane(here, following) == (pytest.approx(1 - a * x * x + y), pytest.approx(0.3 * x))
    assert map.previous(here, following, a) == pytest.approx(before)


@pytest.mark.parametrize(
    ("matrix", "grows"),
    [
        ((2, 0, 0, 0), True),
        ((1, 0, 0, 0), False),
        ((2, 0, 0, 1), False),
        ((2, 1, 0, 0), True),
        ((2, 0, 1, 0), True),
        ((2, 0, 3, 0), False),
    ],
)
def test_a_cone_of_an_h_set_grows_where_a_matrix_is_positive_definite(matrix, grows):
    """By its eigenvalues, of `D'QD - Q` for `Q = diag(1, -1)`."""
    a, b, c, d = matrix
    D, Q = np.array([[a, b], [c, d]]), np.diag([1.0, -1.0])
    least = np.linalg.eigvalsh(D.T @ Q @ D - Q)[0]
    assert bool(least > 1e-9) is grows
    assert _expands(tuple(map(arb, matrix))) is grows


@pytest.mark.parametrize(("number", "told"), [("5e-11", "0"), ("9.9e-11", "0"), ("-5e-11", "0"), ("2e-10", "2e-10")])
def test_what_is_below_all_digits_asked_for_is_told_as_0(number, told):
    assert float(_text(arb(number).mid(), 10)) == pytest.approx(float(told), abs=0, rel=1e-3)


@pytest.mark.parametrize("doubtful", [(), (2,), (0, 5)])
@pytest.mark.parametrize("unknown", [(), (3,), (0, 1)])
def test_angles_told_by_gaps_are_taken_where_they_hold_and_are_finite(doubtful, unknown):
    """Where the sine by which they are told may not be positive, they may be those of another chord."""
    told = [arb("inf") if k in unknown else arb(k) for k in range(6)]
    ahead = [arb(-1) if k in doubtful else arb(1) for k in range(6)]
    found = triangles._from_gaps(lambda *_: [arb(10 + k) for k in range(6)], lambda *_: [*told, *ahead], [], [])
    assert found == [10 + k if k in doubtful + unknown else k for k in range(6)]


@pytest.mark.parametrize("at", range(3))
@pytest.mark.parametrize(("exit", "none"), [(arb(2), True), (arb(-1), True), (arb(0, 5), False), (arb(1, 0.5), False)])
def test_no_triangle_has_an_exit_angle_below_0_or_above_the_largest(at, exit, none):
    """Of one bounce of the three; nothing is known of the others."""
    phi = [exit if k == at else arb(0, 5) for k in range(3)]
    angles, slopes = lambda *_: [*phi, *[arb(0, 100)] * 3], lambda *_: [arb(0, 100)] * 18
    box = [(0.0, 0.1), (2.2, 0.1), (2.0, 0.1)]
    assert triangles._impossible(angles, slopes, arb(1), arb(1), 0.1, box) is none


def test_a_region_is_asked_up_to_the_upper_end_of_the_distance_from_lambda_star(monkeypatch):
    """Which is enclosed, here in a wide ball: whichever number of it is `lambda*`, all contractions are held."""
    monkeypatch.setattr(half_return, "limit", lambda: None)
    monkeypatch.setattr(half_return, "enclosed", lambda: (None, arb("0.07", "0.001")))
    monkeypatch.setattr(half_return, "step", lambda near, e: (near, e))
    found = half_return.trapping_region(0.0725)
    assert found.proved
    assert found.steps[0][0] == 0
    assert all(one[1] == other[0] for one, other in zip(found.steps, found.steps[1:], strict=False))
    assert found.steps[-1][1] >= 0.0035


@pytest.mark.parametrize(
    ("trace", "told"),
    [(x, True) for x in (0.5, -1.5, 1.75)] + [(x, None) for x in (2.5, -2.5, 2.0, -2.0, 0, -1)],
)
def test_multipliers_turn_where_the_trace_is_below_2_and_are_resonant_at_0_and_minus_1(monkeypatch, trace, told):
    """Beyond 2 the cycle is a neutral saddle, with real multipliers whose product is 1."""
    here = SimpleNamespace(drift=lambda _: acb(1), cubic=lambda: acb(-1), mu=acb(arb(trace) / 2))
    monkeypatch.setattr(torus, "refined", lambda *_: SimpleNamespace(z=None))
    monkeypatch.setattr(torus, "exact_balls", lambda _: None)
    monkeypatch.setattr(torus, "interval_newton", lambda *_: SimpleNamespace(status=Status.UNIQUE, zero=None))
    monkeypatch.setattr(torus, "Rotation", lambda *_: here)
    found = torus.torus(SimpleNamespace(ring=None), [], "r")
    assert found.checks == {"exists": True, "nonresonant": told, "transversal": True, "nondegenerate": True}


@pytest.mark.parametrize("digits", [1, 8, 30])
def test_parameters_of_a_box_reach_as_far_as_its_digits_say(digits):
    assert abs(Precision(digits).step * arb(10) ** digits - 1) < 1e-12


def test_places_of_a_table_of_which_no_symmetry_is_told_are_known_up_to_whole_turns():
    assert Pinball(circle).turn == 1


def test_what_few_bits_do_not_decide_is_asked_of_all_bits():
    """A slope of `2^-200`, as a difference of two numbers near 1, which few bits do not tell from 0."""

    def solved(_, box, value):
        third = arb(1) / 3
        return [value[0] / (arb(2) ** -200 + (3 * third - 1))]

    system = SimpleNamespace(value=lambda *_: [arb(0)], solved=solved)
    few, all_of_them = (interval_newton(system, [arb(0)], arb(1), bits).status for bits in (130, 400))
    assert (few, all_of_them) == (Status.UNKNOWN, Status.UNIQUE)
