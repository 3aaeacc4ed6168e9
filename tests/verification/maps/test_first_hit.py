"""Chords that meet nothing on their way, tables that are convex, and cycles whose period is not shorter."""

import math
import random
from itertools import pairwise

import numpy as np
import pytest
from flint import arb
from sympy import Interval, Rational, S, Symbol, cos, exp, pi, sin, sqrt

from symbolic.tables import cardioid, circle, cuspless, egg, ellipse, parametric, polar, sinai, square
from symbolic.tables.law import Law
from symbolic.tables.table import Component, Shape, Table, theta
from verification.arithmetic.balls import exact_balls, working
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.maps.first_hit import BallBoundary, closes_smoothly, convex, first_hits, inside, minimal, turns_once
from verification.proofs.periodic.cycle_in_box import UniqueCycle, cycle_in_box

WAISTED = polar(1 + cos(2 * theta) / 2)  # the waist at theta = +-pi/2 has radius 1/2


def bounces(*values: float) -> list[arb]:
    return [arb(x) for x in values]


def cycle_near(problem: Problem, start: list[float]) -> UniqueCycle:
    """The proof that a box of radius 1e-22 about the zero found from a start holds one cycle."""
    zero = refined(problem, start, 20).z
    with working(150):
        return cycle_in_box(problem, tuple(exact_balls(zero)), arb("1e-22").mid(), 150, 20)


def test_a_convex_table_agrees_with_its_convexity():
    assert first_hits(egg(3).at(alpha=Rational(2, 25)), (0, 0), bounces(0.1, 3.0)) is True
    assert first_hits(cuspless, (1, 0, 0), bounces(0.1, 0.3, 1.5)) is True


def test_a_chord_through_a_waist_is_free_and_one_around_it_is_not():
    assert first_hits(WAISTED, (0, 0), bounces(0, math.pi)) is True
    assert first_hits(WAISTED, (0, 0), bounces(0.7, math.pi - 0.7)) is None  # it leaves the table in between
    assert first_hits(WAISTED, (0, 0), bounces(math.pi / 2 - 0.2, math.pi / 2 + 0.2)) is None


@pytest.mark.parametrize("lam", [Rational(1, 3), Rational(9, 10)])
def test_the_cardioids_vertical_orbit_is_certified_though_the_table_is_not_convex(lam):
    assert cycle_near(Problem(cardioid, (0, 0), lam=lam), [1.0, -1.0]).proved


def test_a_bounce_at_the_seam_of_a_round_hole_is_one_like_any_other():
    """Between the left side of Sinai's cell and the disc, whose parameter begins and ends at the landing."""
    table = sinai()
    with working(96):
        seam, other = arb.pi(), -arb.pi()
        side = 3
        middle = arb("0.5")

        for there in (seam, other, seam + arb("0.001")):
            assert inside(table, (side, 4), [middle, there]) is True
        assert first_hits(table, (side, 4), [middle, seam]) is True
        assert first_hits(table, (side, 4), [middle, other]) is True
        assert first_hits(table, (side, 1), [middle, middle]) is None  # the disc is between
        assert minimal(table, (side, 4, side, 4), [middle, seam, middle, other]) is None  # the same point twice


def test_a_curve_of_one_formula_that_dents_where_it_closes_is_not_convex():
    """Both bend inwards except at theta = pi, where the radius has its minimum in one and its maximum in the other."""
    assert convex(polar(1 + cos(theta / 2) / 4)) is None
    assert convex(polar(1 - cos(theta / 2) / 4)) is True


def ring(points: list[tuple[int, int]]) -> Table:
    """A closed polygon, which may cross itself."""
    sides = pairwise([*points, points[0]])
    return Table("ring", tuple(Component(f"s{i}", along(p, q), S(0), S(1)) for i, (p, q) in enumerate(sides)))


def along(p, q):
    return tuple(a + (b - a) * theta for a, b in zip(p, q, strict=True))


PENTAGON = [(3, 0), (1, 3), (-2, 2), (-2, -2), (1, -3)]


def test_a_curve_that_bends_inwards_is_simple_where_it_turns_once_and_not_where_it_turns_twice():
    """A limacon with a loop, a pentagram and a circle run through twice all bend inwards everywhere."""
    limacon = Component("whole", ((S.Half + cos(theta)) * cos(theta), (S.Half + cos(theta)) * sin(theta)), -pi, pi)
    halves = [Component(f"half {i}", (cos(theta), sin(theta)), i * pi, (i + 1) * pi) for i in range(4)]

    assert turns_once(ring(PENTAGON)) is turns_once(Table("circle", tuple(halves[:2]))) is True
    for twice in (Table("limacon", (limacon,)), ring(PENTAGON[::2] + PENTAGON[1::2]), Table("circle", tuple(halves))):
        assert turns_once(twice) is None
    assert convex(Table("limacon", (limacon,))) is None


@pytest.mark.slow
def test_a_short_loop_is_in_no_convex_table():
    """The loop bends inwards everywhere, is 0.001 long, and is no Fourier sum."""
    size = (Rational(999, 1000) + cos(theta)) * (1 + exp(cos(theta)) / 10**4)

    loop = size * cos(theta), size * sin(theta)

    assert convex(Table("loop", (Component("loop", loop, -pi, pi),))) is None
    with pytest.raises(ValueError, match="meets itself"):
        parametric(*loop)
    assert convex(polar(exp(cos(2 * theta) / 20))) is True  # and a formula of such words is not to blame


def test_whether_a_boundary_with_free_parameters_turns_once_is_asked_for_all_of_them():
    assert convex(egg(3)) is convex(egg(4)) is convex(ellipse) is True
    b = Symbol("b", real=True)
    looped = ((b + cos(theta)) * cos(theta), (b + cos(theta)) * sin(theta))
    family = Table(
        "limacons",
        (Component("whole", looped, -pi, pi),),
        shapes=(Shape(b, Interval(S(1) / 4, S(1) / 2), "is no limacon with a loop"),),
    )
    assert convex(family) is None
    assert convex(family, (arb("0.3"),)) is None


def test_a_family_of_circles_is_convex_run_through_once_and_not_twice():
    """Signs alone show for both that they bend inwards, whatever the radius."""
    r = Symbol("r", positive=True)
    for times, answer in ((1, True), (2, None)):
        turned = r * cos(times * theta), r * sin(times * theta)
        shape = Shape(r, Interval(1, 2), "is no circle of the family")
        family = Table("circles", (Component("whole", turned, -pi, pi),), shapes=(shape,))
        assert convex(family) is convex(family, (arb("1.5"),)) is answer


def test_corners_that_turn_right_or_all_the_way_round_are_not_those_of_a_convex_table():
    dented, folded = [*PENTAGON[:2], (0, 0), *PENTAGON[3:]], [(0, 0), (2, 0), (1, 0), (1, 1)]

    assert turns_once(ring(dented)) is turns_once(ring(folded)) is None
    assert turns_once(cardioid) is turns_once(egg(3)) is None  # a cusp; a free parameter


def test_what_a_formula_draws_beyond_the_ends_of_its_parameter_is_no_boundary():
    """Beyond the ends the formula's curve goes on, and the chord system has a zero there that is no cycle."""
    table = polar(1 + cos(theta / 2) / 4 + sin(theta) / 8)
    problem = Problem(table, (0, 0), lam=Rational(1, 2))
    proof = cycle_near(problem, [4.85837, 8.15732])

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is None
    assert "bounce 0 left" in problem.ring.obstacle(np.array([4.85837, 8.15732]), {"lam": 0.5})


@pytest.mark.parametrize(
    ("law", "admissible"), [("-lam*eta*(1 + cos(theta)/9)", True), ("-lam*eta*(1 + theta/99)", None)]
)
def test_a_law_that_a_whole_turn_changes_is_asked_between_the_ends_alone(law, admissible):
    problem = Problem(egg(3).at(alpha=Rational(2, 25)), (0, 0), lam=Rational(1, 2), law=Law(law))
    proof = cycle_near(problem, [math.pi, 2 * math.pi])

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is admissible


def test_a_law_of_arc_length_on_a_disc_among_sides_is_asked_between_the_ends_alone():
    """At `theta - 2*pi` the same point has another arc length, and a zero of the chord system there is no cycle."""
    problem = Problem(sinai(), (0, 4), lam=Rational(1, 2), law=Law("-lam*eta + sin(s)/9"))
    for start, admissible in (([0.467, 1.669], True), ([0.4745, -4.644], False)):
        proof = cycle_near(problem, start)

        assert proof.checks["exists"] is True
        assert proof.checks["admissible"] is admissible


def test_convexity_is_proved_where_it_holds_and_left_open_at_a_cusp():
    eggs = [egg(k).at(alpha=alpha) for k, alpha in ((3, "2/25"), (3, "1/10"), (5, "1/26"))]

    assert [convex(table) for table in (circle, ellipse.at(a=5), cuspless, *eggs)] == [True] * 6
    assert convex(cardioid) is None


def test_convexity_is_proved_piece_by_piece_where_no_formula_decides_it():
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 40)) is True
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 4)) is None
    assert convex(egg(3), (arb("0.099"),)) is True
    assert convex(egg(3), (arb("0.101"),)) is None
    assert convex(sinai()) is None  # the disc bends outwards by a constant


@pytest.mark.parametrize(
    ("corners", "bends_in"),
    [
        ([(0, 0), (4, 0), (4, 4), (2, 3), (0, 4)], None),
        ([(0, 0), (4, 0), (4, 4), (2, 5), (0, 4)], True),
        ([(0, 0), (4, 0), (4, 4), (2, 4), (0, 4)], True),  # straight on
        ([(0, 0), (4, 0), (1, 1)], None),  # so sharp that only a sharper proof would do
    ],
)
def test_joins_bend_in_where_no_corner_is_reflex_and_none_is_a_cusp(corners, bends_in):
    right = all(
        (q[0] - p[0]) * (r[0] - q[0]) + (q[1] - p[1]) * (r[1] - q[1]) > 0
        for p, q, r in zip(corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True)
    )
    assert convex(ring(corners)) is (bends_in if right else None)


def test_a_boundary_closes_smoothly_only_as_one_formula_that_a_whole_turn_repeats():
    assert closes_smoothly(cardioid)
    assert not closes_smoothly(polar(1 + cos(theta / 2) / 4))
    assert not closes_smoothly(sinai())


@pytest.mark.parametrize("n", [2, 3, 4, 6, 8, 9, 12])
def test_a_cycle_is_minimal_exactly_when_no_proper_part_of_it_is_repeated(n):
    chance, table = random.Random(n), egg(3).at(alpha=Rational(2, 25))
    for part in (k for k in range(1, n + 1) if n % k == 0):
        shorter = [chance.uniform(-3, 3) for _ in range(part)]
        turns = [2 * math.pi * chance.choice([-1, 0, 1]) for _ in range(n)]
        zero = [arb(x + turn, 1e-9) for x, turn in zip(shorter * (n // part), turns, strict=True)]
        assert minimal(table, (0,) * n, zero) is (True if part == n else None)
        assert minimal(table, (0,) * n, [*zero[:-1], zero[-1] + 1]) is True  # repeated but for one bounce
        sides = [*[0] * (part - 1), 1]  # no shorter list is repeated in it
        assert minimal(cuspless, tuple(sides * (n // part)), [arb("0.1")] * n) is (True if part == n else None)


EGG = egg(3).at(alpha="0.08")
ODD = polar(1 + cos(theta / 2) / 4)  # of one component, which a whole turn changes


@pytest.mark.parametrize(
    ("table", "part", "value", "turns", "told"),
    [
        (square(), 1, "0.5", True, True), (square(), 1, "1.2 +/- 0.1", True, False),
        (square(), 1, "-0.2 +/- 0.1", True, False), (square(), 1, "1 +/- 0.1", True, None),
        (square(), 1, "0 +/- 0.1", True, None), (square(), 1, "0.5 +/- 0.5", True, None),
        (square(), 1, "0", True, None), (square(), 1, "1", True, None),
        (cuspless, 1, "0.1", True, True), (cuspless, 1, "2", True, False), (cuspless, 0, "-3", True, False),
        (cuspless, 0, "2.5", True, False), (cuspless, 0, "2.0943951023931954923 +/- 1e-18", True, None),  # 2*pi/3
        (ODD, 0, "1", True, True), (ODD, 0, "4", True, None), (ODD, 0, "-4", True, None),
        (EGG, 0, "4", True, True), (EGG, 0, "4", False, None), (EGG, 0, "-1", False, True),
        (sinai(), 4, "4", True, True), (sinai(), 4, "3", False, True),
        (sinai(), 4, "4", False, False), (sinai(), 4, "-4", False, False),
    ],
)  # fmt: skip
def test_a_bounce_is_inside_its_component_off_it_or_not_known(table, part, value, turns, told):
    assert inside(table, (part,), [arb(value)], (), turns) is told
    if len(table.components) > 1:  # and one that is inside changes nothing, before or after
        assert inside(table, (0, part), [arb("0.5"), arb(value)], (), turns) is told
        assert inside(table, (part, 0), [arb(value), arb("0.5")], (), turns) is told


def test_a_component_is_closed_where_both_coordinates_end_as_they_begin():
    def place(first, last):
        return lambda t: (*map(arb, first if t < 0.5 else last), arb(1), arb(0))

    corners = [(2, 5), (2, 6), (3, 5), (3, 6), ("2 +/- 0.1", 5), (2, "5 +/- 0.1")]
    many = BallBoundary([place((2, 5), last) for last in corners], [(arb(0), arb(1))] * 6)
    assert many.closed == (True, False, False, False, True, True)
    assert BallBoundary([place((0, 0), (1, 1))], [(arb(0), arb(1))]).closed == (True,)
