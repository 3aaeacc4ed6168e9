"""Chords that meet nothing on their way, in tables that are not convex."""

import math
import random
from itertools import pairwise

import numpy as np
import pytest
from flint import arb
from sympy import Interval, Rational, S, Symbol, cos, exp, oo, pi, sin, sqrt

from symbolic.tables import cardioid, cuspless, egg, ellipse, parametric, polar, sinai
from symbolic.tables.law import Law
from symbolic.tables.table import Component, Shape, Table, theta
from verification.arithmetic.balls import exact_balls, working
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.maps import first_hit
from verification.maps.first_hit import closes_smoothly, convex, first_hits, inside, minimal, turns_once
from verification.proofs.periodic.bifurcation import Claim, proved

WAISTED = polar(1 + cos(2 * theta) / 2)  # the waist at theta = +-pi/2 has radius 1/2


def bounces(*values: float) -> list[arb]:
    return [arb(x) for x in values]


def test_a_convex_table_agrees_with_its_convexity():
    assert first_hits(egg(3).at(alpha=Rational(2, 25)), (0, 0), bounces(0.1, 3.0)) is True
    assert first_hits(cuspless, (1, 0, 0), bounces(0.1, 0.3, 1.5)) is True


def test_a_chord_through_a_waist_is_free_and_one_around_it_is_not():
    assert first_hits(WAISTED, (0, 0), bounces(0, math.pi)) is True
    assert first_hits(WAISTED, (0, 0), bounces(0.7, math.pi - 0.7)) is None  # it leaves the table in between


def test_a_chord_that_leaves_outwards_is_refused():
    assert first_hits(WAISTED, (0, 0), bounces(math.pi / 2 - 0.2, math.pi / 2 + 0.2)) is None


@pytest.mark.parametrize("lam", [Rational(1, 3), Rational(9, 10)])
def test_the_cardioids_vertical_orbit_is_certified_though_the_table_is_not_convex(lam):
    problem = Problem(cardioid, (0, 0), lam=lam)
    solution = refined(problem, [1.0, -1.0], 20)
    with working(150):
        claim = Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20)

    assert proved(claim).certified


def test_a_bounce_at_the_seam_of_a_round_hole_is_one_like_any_other():
    """Between the left side of Sinai's cell and the disc, whose parameter begins and ends where it is met."""
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
    """Both bend inwards everywhere else; at theta = pi the radius is least in the one and largest in the other."""
    assert convex(polar(1 + cos(theta / 2) / 4)) is None
    assert convex(polar(1 - cos(theta / 2) / 4)) is True


def ring(points: list[tuple[int, int]]) -> Table:
    """A closed polygon, whatever it does to itself."""
    sides = pairwise([*points, points[0]])
    return Table("ring", tuple(Component(f"s{i}", along(p, q), S(0), S(1)) for i, (p, q) in enumerate(sides)))


def along(p, q):
    return tuple(a + (b - a) * theta for a, b in zip(p, q, strict=True))


PENTAGON = [(3, 0), (1, 3), (-2, 2), (-2, -2), (1, -3)]


def test_a_curve_that_bends_inwards_is_simple_where_it_turns_once_and_not_where_it_turns_twice():
    """A limacon with a loop, a pentagram and a circle run through twice bend inwards all along."""
    limacon = Component("whole", ((S.Half + cos(theta)) * cos(theta), (S.Half + cos(theta)) * sin(theta)), -pi, pi)
    circle = [Component(f"half {i}", (cos(theta), sin(theta)), i * pi, (i + 1) * pi) for i in range(4)]

    assert turns_once(ring(PENTAGON)) is turns_once(Table("circle", tuple(circle[:2]))) is True
    for twice in (Table("limacon", (limacon,)), ring(PENTAGON[::2] + PENTAGON[1::2]), Table("circle", tuple(circle))):
        assert turns_once(twice) is None
    assert convex(Table("limacon", (limacon,))) is None


def test_a_loop_that_an_inscribed_polygon_does_not_see_is_in_no_convex_table():
    """It bends inwards all along, is 0.001 long and no Fourier sum, so that validation knows its polygon alone."""
    size = (Rational(999, 1000) + cos(theta)) * (1 + exp(cos(theta)) / 10**4)

    assert convex(parametric(size * cos(theta), size * sin(theta))) is None
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
    """Both bend inwards for every radius, by signs alone."""
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
    """A chord system has a zero there, on the curve that the formula goes on to draw; a turn less is elsewhere."""
    table = polar(1 + cos(theta / 2) / 4 + sin(theta) / 8)
    problem = Problem(table, (0, 0), lam=Rational(1, 2))
    solution = refined(problem, [4.85837, 8.15732], 20)
    with working(150):
        proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is None
    assert "bounce 0 left" in problem.ring.obstacle(np.array([4.85837, 8.15732]), {"lam": 0.5})


@pytest.mark.parametrize(
    ("law", "admissible"), [("-lam*eta*(1 + cos(theta)/9)", True), ("-lam*eta*(1 + theta/99)", None)]
)
def test_a_law_that_a_whole_turn_changes_is_asked_between_the_ends_alone(law, admissible):
    problem = Problem(egg(3).at(alpha=Rational(2, 25)), (0, 0), lam=Rational(1, 2), law=Law(law))
    solution = refined(problem, [math.pi, 2 * math.pi], 20)
    with working(150):
        proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is admissible


def test_a_law_of_arc_length_on_a_disc_among_sides_is_asked_between_the_ends_alone():
    """A turn less on the disc the same point has another length, and a zero of the chord system is no cycle."""
    problem = Problem(sinai(), (0, 4), lam=Rational(1, 2), law=Law("-lam*eta + sin(s)/9"))
    for start, admissible in (([0.467, 1.669], True), ([0.4745, -4.644], False)):
        solution = refined(problem, start, 20)
        with working(150):
            proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

        assert proof.checks["exists"] is True
        assert proof.checks["admissible"] is admissible


def test_a_piece_that_crosses_a_chord_never_passes_and_a_small_one_beside_it_does():
    """Straight pieces in all directions through points of the chord from (0, 0) to (2, 1), and beside it."""
    chance = random.Random(1)
    p, d = (arb(0), arb(0)), (arb(2), arb(1))
    for _ in range(100):
        share, angle, half = chance.uniform(0.1, 0.9), chance.uniform(-3, 3), 2.0 ** chance.uniform(-20, -1)
        vx, vy = arb(math.cos(angle)), arb(math.sin(angle))
        seen = abs(2 * math.sin(angle) - math.cos(angle)) > 0.1  # else it runs along the chord
        crossing = lambda t, share=share, vx=vx, vy=vy: (2 * share + vx * t, share + vy * t, vx, vy)  # noqa: E731
        beside = lambda t, share=share, vx=vx, vy=vy: (2 * share - 0.2 + vx * t, share + 0.4 + vy * t, vx, vy)  # noqa: E731

        piece = arb(half * chance.uniform(-0.9, 0.9), half)
        assert not first_hit._passes(crossing, piece, [], p, d)
        assert first_hit._passes(beside, piece, [], p, d) or half > 0.1
        assert first_hit._passes(crossing, arb(0, half), [[arb(0, half)]], p, d) or not seen  # next to a bounce


def test_only_a_component_that_ends_where_it_begins_is_closed():
    """The wall of the cuspless table ends above its beginning; the disc of Sinai's cell is a circle."""
    assert first_hit._boundary(cuspless, ()).closed == (False, False)
    assert first_hit._boundary(sinai(), ()).closed == (False, False, False, False, True)


def test_convexity_is_proved_piece_by_piece_where_no_formula_decides_it():
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 40)) is True
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 4)) is None
    assert convex(egg(3), (arb("0.099"),)) is True
    assert convex(egg(3), (arb("0.101"),)) is None
    assert convex(sinai()) is None  # the disc bends outwards by a constant


@pytest.mark.parametrize(
    ("low", "high", "held", "outside"),
    [
        ("0", "1/8", ["0", "0.125", "0.06"], ["-1e-15", "0.12500001", "0.1 +/- 0.03"]),
        ("0", oo, ["0", "1e30"], ["-1e-15", "0 +/- 1e-9"]),
        (-oo, "1/8", ["-1e30", "0.125"], ["0.126"]),
        (0, pi, [], ["1"]),  # an end that is no rational is not asked
        (-pi, 0, [], ["-1"]),
    ],
)
def test_a_shape_is_within_its_range_up_to_the_ends_and_not_beyond(low, high, held, outside):
    range = Interval(Rational(low) if isinstance(low, str) else low, Rational(high) if isinstance(high, str) else high)
    with working(64):
        assert all(first_hit._within(arb(x), range) for x in held)
        assert not any(first_hit._within(arb(x), range) for x in outside)
        for x in (*held, *outside):
            assert first_hit._all_within((arb(0.06), arb(x)), [Interval(0, 1), range]) is (x in held)
        whole = first_hit._over(range)
        assert all(whole.overlaps(arb(x)) for x in held)
        assert whole.is_finite() == (range == Interval(0, Rational(1, 8)))
        if whole.is_finite():
            assert whole.rad() < 0.0626
    assert first_hit._all_within((), [range])
    assert not first_hit._all_within((arb(1),), [Rational(1)])


@pytest.mark.parametrize(
    ("bend", "nonnegative"),
    [
        (1 + cos(theta), True),
        (1 + 2 * cos(theta), False),
        (1 - cos(2 * theta), True),
        (cos(theta) + cos(theta) ** 2 + Rational(1, 4), True),  # a square
        (cos(theta) + cos(theta) ** 2 + Rational(1, 5), False),
        (2 + cos(3 * theta) + cos(6 * theta) / 2, True),
        (2 + sin(theta), False),  # no sum of cosines: another way is taken
        (2 + sqrt(2) * cos(theta), False),  # nor are these coefficients rational
        (cos(theta), False),
    ],
)
def test_sums_of_cosines_are_nonnegative_where_their_polynomial_is(bend, nonnegative):
    assert first_hit._exactly_nonnegative(bend, {}) is nonnegative


def test_random_sums_of_cosines_are_nonnegative_where_their_least_value_is():
    """Of multiples of a frequency, with rational coefficients; the least value in floats decides, where it is not 0."""
    chance, at, seen = random.Random(8), np.linspace(0, 2 * np.pi, 4001), []
    for _ in range(40):
        step = chance.choice([1, 1, 2, 3])
        numbers = [Rational(chance.randint(-8, 8), 4) for _ in range(chance.choice([2, 3, 4]))]
        numbers[0] = Rational(chance.randint(-2, 16), 4)
        bend = sum(c * cos(step * k * theta) for k, c in enumerate(numbers))
        least = np.min(sum(float(c) * np.cos(step * k * at) for k, c in enumerate(numbers)))
        if abs(least) > 1e-3:
            varies = any(numbers[1:])
            assert first_hit._exactly_nonnegative(S(bend), {}) is bool(
                least > 0 and varies
            )  # a number is asked of SymPy
            seen.append(bool(least > 0))
    assert min(sum(seen), len(seen) - sum(seen)) > 5


def test_a_number_and_what_has_other_letters_are_no_sums_of_cosines():
    a, b = Symbol("a", real=True), Symbol("b", real=True)
    for bend in (S(2), S(-1), 2 + cos(theta) + sin(theta), 2 + cos(theta / 2), 3 + sqrt(a) * cos(theta)):
        assert first_hit._exactly_nonnegative(bend, {a: Interval(0, 1)}) is False
    assert first_hit._exactly_nonnegative(3 + a * b * cos(theta), {a: Interval(-1, 1), b: Interval(0, 1)})
    assert not first_hit._exactly_nonnegative(3 + a * b * cos(theta), {a: Interval(-1, 1), b: Interval(0, 4)})


def test_a_table_has_as_many_joins_as_components_unless_it_is_one_whole_curve():
    whole = Component("hole", (2 + cos(theta), sin(theta)), 0, 2 * pi)
    for table in (cuspless, sinai(), drawn((0, 0), (1, 0), (0, 1)), Table("two", (whole, whole))):
        assert len(list(first_hit.tangents(table))) == len(table.components)
    assert not list(first_hit.tangents(Table("one", (whole,))))


def test_a_sum_of_cosines_with_a_parameter_is_nonnegative_over_the_range_alone():
    a = Symbol("a", real=True)
    for end, nonnegative in ((1, True), (Rational(11, 10), False)):
        assert first_hit._exactly_nonnegative(1 + a * cos(theta), {a: Interval(0, end)}) is nonnegative
    assert not first_hit._exactly_nonnegative(1 + a * cos(theta), {a: a})


def drawn(*corners):
    """A table of straight sides between corners."""
    ring = [*corners, corners[0]]
    sides = [
        Component(f"side {k}", (p[0] + theta * (q[0] - p[0]), p[1] + theta * (q[1] - p[1])), 0, 1)
        for k, (p, q) in enumerate(pairwise(ring))
    ]
    return Table("drawn", tuple(sides))


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
    assert convex(drawn(*corners)) is (bends_in if right else None)


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
        sides = [*[0] * (part - 1), 1]  # no shorter list is repeated in it
        assert minimal(cuspless, tuple(sides * (n // part)), [arb("0.1")] * n) is (True if part == n else None)


def around(place):
    """A unit circle about a point, as a piece of boundary: point and velocity."""
    return lambda t: (place[0] + t.cos(), place[1] + t.sin(), -t.sin(), t.cos())


def test_a_curved_piece_that_meets_the_chord_never_passes_and_short_ones_that_do_not_pass():
    """Arcs of circles around random places against the chord from (0, 0) to (2, 1), by 400 points of each."""
    chance, met, passed = random.Random(3), 0, 0
    p, d = (arb(0), arb(0)), (arb(2), arb(1))
    for k in range(300):
        place, half = (chance.uniform(-1, 3), chance.uniform(-1, 2)), 2.0 ** chance.uniform(-9, 0)
        middle, share = chance.uniform(-math.pi, math.pi), chance.uniform(0, 1)
        if k % 2:  # about a point of the chord
            place = 2 * share - math.cos(middle + half / 3), share - math.sin(middle + half / 3)
        at = np.linspace(middle - half, middle + half, 400)
        x, y = place[0] + np.cos(at), place[1] + np.sin(at)
        side, along = 2 * y - x, 2 * x + y
        cross = np.flatnonzero(side[:-1] * side[1:] <= 0)
        meets = any(0 <= along[k] <= 5 and 0 <= along[k + 1] <= 5 for k in cross)
        found = first_hit._passes(around(place), arb(middle, half), [], p, d)
        assert not (meets and found)
        clear = np.min(np.hypot(side, np.maximum(0, np.abs(along - 2.5) - 2.5))) > 6 * half
        assert found or not clear
        met, passed = met + meets, passed + clear
    assert min(met, passed) > 30


def test_ways_from_a_bounce_to_a_piece_hold_the_shorter_way_along_the_boundary():
    """On one closed curve through the seam where that is shorter; on an open component never."""
    chance = random.Random(5)
    with working(96):
        ends = [(-arb.pi(), arb.pi())]
        closed = first_hit.Boundary([around((0, 0))], ends)
        open_ = first_hit.Boundary([around((0, 0))] * 2, [(arb(-3), arb(3)), (arb(0), arb(1))])
        for _ in range(60):
            at, piece = arb(chance.uniform(-3, 3), 1e-3), arb(chance.uniform(-3, 3), 1e-2)
            gap = float(piece.mid() - at.mid())
            turn = math.remainder(gap, 2 * math.pi)
            for boundary, way in ((closed, turn), (open_, gap)):
                ways = first_hit._between(boundary, 0, at, piece)
                assert len(ways) == (1 if way == gap else 2)
                for share in (0, 0.2, 0.5, 0.9, 1):
                    there = math.remainder(float(at.mid()) + share * way, 2 * math.pi)
                    assert any(held.overlaps(arb(there, 1e-12)) for held in ways)
                assert sum(2 * float(held.rad()) for held in ways) < abs(way) + 0.05
                assert ways[0].contains(piece)
                assert ways[-1].contains(at)


def test_next_to_a_bounce_all_ways_to_it_must_cross_the_line_in_one_sense():
    """Of two ways, through the seam of a closed boundary, that cross in opposite senses nothing follows."""
    p, d = (arb(0), arb(0)), (arb(2), arb(0))
    place = lambda t: (arb(1), arb(0, 1), arb(0), t)  # noqa: E731  # on the chord, and up or down as `t` says
    up, down = arb(1, "0.5"), arb(-1, "0.5")

    for ways, passes in (([up], True), ([down], True), ([up, up], True), ([down, down], True), ([up, down], False)):
        assert first_hit._passes(place, arb(0, 1), [ways], p, d) is passes
        assert first_hit._passes(place, arb(0, 1), [[arb(0, 1)], ways], p, d) is passes  # one of two bounces is near
