"""Convexity, joins, turns and chords: each step by itself, with what it rests on made to fail alone."""

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise, product
from types import SimpleNamespace

import pytest
from flint import arb
from sympy import Interval, Rational, S, Symbol, cos, exp, oo, pi, sin, sqrt

from symbolic.tables import cuspless, egg, polar, sinai, square
from symbolic.tables.table import Component, Shape, Table, theta
from verification.arithmetic.balls import working
from verification.maps import first_hit
from verification.maps.first_hit import Boundary, closes_smoothly, inside

B = Symbol("b", real=True)
ONE = Component("one", (cos(theta), sin(theta)), S(2), S(5))
SHARE = (theta - 2) / 3  # of that component


@pytest.mark.parametrize(
    ("range", "value"),
    [
        ((3, 4), 3.5),
        ((-1, oo), 0),
        ((-oo, 5), 4),
        ((Rational(1, 4), Rational(1, 2)), 0.375),
        ((3, pi), (3 + math.pi) / 2),
    ],
)
def test_a_number_inside_a_range_is_its_middle_or_one_from_its_end(range, value):
    assert first_hit._some(Interval(*range)) == arb(value)


ONCE = list(product((1, 2), ((), (arb(0.25),)), (True, False, None), ((True, True), (True, False), (None, True))))


@pytest.mark.parametrize("turned", [set(), {"given"}, {"nothing"}, {"some"}])
def test_a_boundary_that_bends_inwards_turns_once_by_one_of_three_reasons(monkeypatch, turned):
    """By the angle for the shape that is given, by a positive radius, or by the angle for one of all shapes."""

    def turns(table, shape):
        name = "nothing" if not shape else "given" if shape[0] == 0.25 else "some"
        return True if name in turned else None

    def radius_over(table):
        if table.radius is None:
            raise ValueError
        return table.radius

    monkeypatch.setattr(first_hit, "_turns", turns)
    monkeypatch.setattr(first_hit, "radius_over", radius_over)
    monkeypatch.setattr(first_hit, "turning", lambda positive: SimpleNamespace(is_positive=positive))
    for parts, given, radius, bent in ONCE:
        shapes = (Shape(B, Interval(1, 2), ""),)
        family = SimpleNamespace(components=bent[:parts], shapes=shapes, radius=radius)
        by_shape = bool(given) and "given" in turned
        by_radius = parts == 1 and radius is True
        by_one = all(bent[:parts]) and "some" in turned
        assert first_hit._once(family, given) is (by_shape or by_radius or by_one)
    assert first_hit._once(SimpleNamespace(shapes=()), ()) is ("nothing" in turned)


def bends(monkeypatch, bend, shapes=(), shape=()):
    """Does a component from 2 to 5 with a made-up turning bend inwards?"""
    table = Table("made up", (ONE,), shapes=shapes)
    monkeypatch.setattr(first_hit, "turning", lambda part: S(bend))
    monkeypatch.setattr(first_hit, "PIECES", 60)
    return first_hit._bends_inwards(table, 0, shape)


@pytest.mark.parametrize("at", [0, 1, Rational(1, 2), Rational(1, 3), Rational(9, 10)])
def test_a_component_bends_inwards_where_its_turning_is_positive_from_end_to_end(monkeypatch, at):
    assert bends(monkeypatch, (SHARE - at) ** 2 - Rational(1, 100)) is False
    assert bends(monkeypatch, (SHARE - at) ** 2 * exp(SHARE) - Rational(1, 100)) is False
    assert bends(monkeypatch, (SHARE - at) ** 2 * exp(SHARE) + Rational(1, 10)) is True


def test_the_pieces_of_a_component_cover_it_and_are_halved_only_where_it_may_not_bend(monkeypatch):
    asked = []
    for most, answer, count in ((0.8, arb(1), 3), (0.4, arb(1), 7), (3.0, arb(1), 1), (0.8, arb(0), 61)):
        asked.clear()

        def turning(at, *shape, most=most, answer=answer):
            asked.append(at)
            return [answer if at.rad() < most else arb(0, 1)]

        monkeypatch.setattr(first_hit, "load", lambda *_, turning=turning: turning)
        monkeypatch.setattr(first_hit, "_ends", lambda *_: [(arb(9), arb(9)), (arb(2), arb(5))])
        monkeypatch.setattr(first_hit, "turning", lambda part: exp(theta) - 3)
        monkeypatch.setattr(first_hit, "PIECES", 60)
        assert first_hit._bends_inwards(Table("two", (ONE, ONE)), 1, ()) is (answer > 0)
        assert len(asked) == count
        if answer > 0:
            small = sorted((at for at in asked if at.rad() < most), key=lambda at: float(at.mid()))
            assert len(small) == (count + 1) // 2
            assert small[0].contains(2)
            assert small[-1].contains(5)
            assert all(a.overlaps(b) for a, b in pairwise(small))
            assert sum(2 * float(at.rad()) for at in small) == pytest.approx(3)


def test_convexity_is_asked_for_the_shape_that_is_given(monkeypatch):
    asked = []
    monkeypatch.setattr(first_hit, "_convex", lambda table, shape: asked.append(shape))
    first_hit.convex(Table("new", (ONE,)), (arb("0.25"),))
    first_hit.convex(Table("new", (ONE,)))
    assert asked == [(arb("0.25"),), ()]


def test_a_turning_is_asked_over_the_ranges_or_at_the_shape_that_is_given(monkeypatch):
    for_range = lambda end: (Shape(B, Interval(0, end), ""),)  # noqa: E731
    straight = 1 - B * exp(SHARE)
    assert bends(monkeypatch, straight, for_range(Rational(1, 4))) is True
    assert bends(monkeypatch, straight, for_range(1)) is False
    assert bends(monkeypatch, straight, for_range(1), (arb(0.25),)) is True
    assert bends(monkeypatch, straight, for_range(1), (arb(0.5),)) is False
    assert bends(monkeypatch, 1 + B * cos(theta), for_range(1)) is True
    assert bends(monkeypatch, 1 + B * cos(theta), for_range(1), (arb(1),)) is True  # 0 at pi: its polynomial decides
    assert bends(monkeypatch, 1 + B * cos(theta), for_range(1), (arb(1.5),)) is False  # outside the range nothing
    assert bends(monkeypatch, S(2)) is bends(monkeypatch, S(0)) is True


def test_coefficients_are_polynomials_with_rational_coefficients():
    a = Symbol("a", real=True)
    held = [S(2), Rational(1, 3), a, 1 - a**2 / 3, a * B - 2]
    assert all(map(first_hit._rational, held))
    assert not any(map(first_hit._rational, [sqrt(2), pi, sqrt(2) * a, 1 / a, sqrt(a), pi * a, cos(a)]))


class Joins:
    """A table of which the tangents at two joins are told, and everything else is made up."""

    def __init__(self, *told):
        self.told = told


def test_joins_bend_in_by_less_than_a_right_angle_or_half_a_turn(monkeypatch):
    """Vector and scalar products of all signs, at either of two joins."""
    monkeypatch.setattr(first_hit, "tangents", lambda table: table.told)
    good = S(1), S(1)
    for across, along in product((-1, 0, 1), repeat=2):
        for told in ((good, (S(across), S(along))), ((S(across), S(along)), good)):
            assert first_hit._joined(Joins(*told)) is (across >= 0 and along > 0)
            assert first_hit._turned(Joins(*told)) is (across > 0 or (across == 0 and along > 0))


def drawn(*corners):
    """A table of straight sides between corners."""
    sides = [
        Component(f"side {k}", tuple(a + theta * (b - a) for a, b in zip(p, q, strict=True)), S(0), S(1))
        for k, (p, q) in enumerate(pairwise([*corners, corners[0]]))
    ]
    return Table("drawn", tuple(sides))


def test_tangents_at_the_joins_of_a_polygon_are_those_of_its_sides():
    """Sides (4, 0), (-3, 1), (-1, -1): their products in order, the last with the first."""
    found = list(first_hit.tangents(drawn((0, 0), (4, 0), (1, 1))))
    assert found == [(4, -12), (4, 2), (4, -4)]
    half = Component("half", (cos(theta), sin(theta)), S(0), pi)
    assert list(first_hit.tangents(Table("half", (half,)))) == [(0, -1)]
    whole = replace(half, end=2 * pi)
    assert list(first_hit.tangents(Table("whole", (whole,)))) == []
    assert list(first_hit.tangents(Table("both", (whole, half)))) == [(0, 1), (0, -1)]


def test_a_whole_component_has_a_whole_turn_and_the_same_formula_after_it():
    circle = (cos(theta), sin(theta))
    for point, start, end, whole in (
        (circle, 0, 2 * pi, True),
        (circle, -pi, pi, True),
        (circle, 0, pi, False),
        (circle, 0, 4 * pi, False),
        ((cos(theta), sin(theta / 2)), 0, 2 * pi, False),
        ((cos(theta / 2), sin(theta)), 0, 2 * pi, False),
    ):
        part = Component("part", point, S(start), S(end))
        assert first_hit._whole(part) is whole
        assert closes_smoothly(Table("one", (part,))) is whole
        assert closes_smoothly(Table("two", (part, part))) is False


ODD = polar(1 + cos(theta / 2) / 4)  # of one component, which a whole turn changes


@pytest.mark.parametrize(
    ("table", "part", "value", "turns", "told"),
    [
        (square(), 1, "0.5", True, True),
        (square(), 1, "1 +/- 0.1", True, None),
        (square(), 1, "0 +/- 0.1", True, None),
        (square(), 1, "0.5 +/- 0.5", True, None),
        (square(), 1, "0", True, None),
        (square(), 1, "1", True, None),
        (cuspless, 1, "0.1", True, True),
        (cuspless, 1, "2", True, False),
        (cuspless, 0, "-3", True, False),
        (square(), 1, "1.2 +/- 0.1", True, False),
        (square(), 1, "-0.2 +/- 0.1", True, False),
        (ODD, 0, "1", True, True),
        (ODD, 0, "4", True, None),
        (ODD, 0, "-4", True, None),
        (egg(3).at(alpha="0.08"), 0, "4", True, True),
        (egg(3).at(alpha="0.08"), 0, "4", False, None),
        (egg(3).at(alpha="0.08"), 0, "-1", False, True),
        (sinai(), 4, "4", True, True),
        (sinai(), 4, "4", False, False),
        (sinai(), 4, "-4", False, False),
        (sinai(), 4, "3", False, True),
    ],
)
def test_a_bounce_is_inside_its_component_off_it_or_not_known(table, part, value, turns, told):
    assert inside(table, (part,), [arb(value)], (), turns) is told
    if len(table.components) > 1:  # and one that is inside changes nothing, before or after
        assert inside(table, (0, part), [arb("0.5"), arb(value)], (), turns) is told
        assert inside(table, (part, 0), [arb(value), arb("0.5")], (), turns) is told


def test_bounces_are_apart_on_different_components_or_where_their_gap_is_no_whole_turn():
    table = sinai()
    with working(64):
        turn = 2 * arb.pi()
        for parts, gap, apart in (
            ((0, 1), arb(0), True),
            ((0, 0), arb(0), False),
            ((0, 0), arb("0.1"), True),
            ((0, 0), turn, True),  # on a side a parameter is a place
            ((4, 4), turn, False),
            ((4, 4), -turn, False),
            ((4, 4), turn / 2, True),
            ((4, 4), arb(0, 1), False),
        ):
            zero = [arb(1) + gap, arb(1)]
            assert first_hit._apart(table, parts, zero, 0, 1) is apart
        assert not first_hit._apart(ODD, (0, 0), [turn, arb(0)], 0, 1)


def test_a_component_is_closed_where_both_coordinates_end_as_they_begin():
    def place(first, last):
        return lambda t: (*map(arb, first if t < 0.5 else last), arb(1), arb(0))

    corners = [(2, 5), (2, 6), (3, 5), (3, 6), ("2 +/- 0.1", 5), (2, "5 +/- 0.1")]
    many = Boundary([place((2, 5), last) for last in corners], [(arb(0), arb(1))] * 6)
    assert many.closed == (True, False, False, False, True, True)
    assert Boundary([place((0, 0), (1, 1))], [(arb(0), arb(1))]).closed == (True,)


def test_the_flights_of_a_cycle_are_all_asked_and_the_last_leads_back_to_the_first(monkeypatch):
    asked, refused = [], []

    def free(boundary, start, end):
        asked.append((start, end))
        return (start, end) not in refused

    monkeypatch.setattr(first_hit, "free", free)
    bounces = [(0, arb(0.25)), (1, arb(0.5)), (2, arb(0.75))]
    flights = [*pairwise(bounces), (bounces[2], bounces[0])]
    parts, zero = zip(*bounces, strict=True)

    assert first_hit.first_hits(square(), parts, list(zero)) is True
    assert asked == flights
    for flight in flights:
        refused[:] = [flight]
        assert first_hit.first_hits(square(), parts, list(zero)) is None
        assert first_hit.unobstructed(square(), bounces) is (flight == flights[2])


def test_a_boundary_is_said_to_turn_once_only_where_all_that_this_rests_on_holds(monkeypatch):
    monkeypatch.setattr(first_hit, "_turned", lambda table: table.turned)
    monkeypatch.setattr(first_hit, "_bends_inwards", lambda table, index, shape: table.bends[index])
    monkeypatch.setattr(first_hit, "_turns", lambda table, shape: True)
    good = {"shapes": (), "undefined": (), "turned": True, "bends": (True, True), "components": (0, 1)}
    assert first_hit.turns_once(SimpleNamespace(**good)) is True
    for worse in ({"shapes": (1,)}, {"undefined": (1,)}, {"turned": False}, {"bends": (True, False)}):
        assert first_hit.turns_once(SimpleNamespace(**good | worse)) is None
    monkeypatch.setattr(first_hit, "_joined", lambda table: table.turned)
    monkeypatch.setattr(first_hit, "_once", lambda table, shape: table.once)
    good |= {"once": True}
    assert first_hit._convex(SimpleNamespace(**good), ()) is True
    for worse in ({"undefined": (1,)}, {"turned": False}, {"bends": (False, True)}, {"once": False}):
        assert first_hit._convex(SimpleNamespace(**good | worse), ()) is None


def circular(times, first=0.0):
    """A unit circle, run through so many times from 1 to 3, begun after a share of a turn."""

    def place(t):
        angle = 2 * arb.pi() * (first + times * (t - 1) / 2)
        return angle.cos(), angle.sin(), -angle.sin(), angle.cos()

    return place


@pytest.mark.parametrize("parts", [(1,), (0.5, 0.5), (0.25, 0.5, 0.25)])
@pytest.mark.parametrize("times", [1, 2, -1])
def test_the_angle_of_a_boundary_is_summed_over_all_its_parts_and_joins(monkeypatch, parts, times):
    """Of a circle in parts, run through once, twice or backwards; and of polygons, whose turns are at their joins."""
    starts = [sum(parts[:k]) for k in range(len(parts))]
    places = [circular(times * part, times * first) for part, first in zip(parts, starts, strict=True)]
    monkeypatch.setattr(first_hit, "_boundary", lambda *_: Boundary(places, [(arb(1), arb(3))] * len(parts)))
    assert first_hit._turns(None, ()) is (True if times == 1 else None)


@pytest.mark.parametrize(
    ("directions", "once"),
    [
        ([(1, 0), (0, 1), (-1, 0), (0, -1)], True),
        ([(1, 0), (-1, 1), (0, -1)], True),
        ([(1, 0), (0, -1), (-1, 0), (0, 1)], None),  # clockwise
        ([(1, 0), (0, 1), (-1, 0), (0, -1)] * 2, None),
        ([(1, 0), (-1, 0)], None),  # back, on which side nobody knows
        ([(1, 1), (1, 1), (-1, 2), (0, -1), (-3, -1)], None),  # one corner turns right, by more than a right angle
        ([(1, 0), (1, 1), (1, 0), (0, 1), (-1, 0), (0, -1)], True),  # one turns right, by less
    ],
)
def test_the_corners_of_a_polygon_turn_to_the_left_where_they_turn_far(monkeypatch, directions, once):
    places = [lambda t, v=v: (arb(0), arb(0), arb(v[0]), arb(v[1])) for v in directions]
    monkeypatch.setattr(first_hit, "_boundary", lambda *_: Boundary(places, [(arb(0), arb(1))] * len(places)))
    assert first_hit._turns(None, ()) is once


def test_an_arc_is_halved_until_no_tangent_is_as_far_as_a_right_angle_from_the_first(monkeypatch):
    """Of sides of a square, on which nothing is known of a whole piece, or that it is at a right angle."""
    for inner, once in (((0, 1), None), (("nan", "nan"), None), ((0.25, 1), True), (("0.5 +/- 0.5", 0), None)):
        asked = []

        def place(t, way, inner=inner, asked=asked):
            u, v = (arb(1), arb(0)) if t.is_exact() else map(arb, inner)
            asked.append(t)
            return arb(0), arb(0), u * way[0] - v * way[1], u * way[1] + v * way[0]

        places = [partial(place, way=way) for way in ((1, 0), (0, 1), (-1, 0), (0, -1))]
        monkeypatch.setattr(first_hit, "_boundary", lambda *_, p=places: Boundary(p, [(arb(0), arb(1))] * 4))
        monkeypatch.setattr(first_hit, "PIECES", 5)
        assert first_hit._turns(None, ()) is once
        assert sum(not t.is_exact() for t in asked) == (4 if once else 6)


def test_the_angle_from_one_velocity_to_another_is_left_of_it_or_a_small_one_to_the_right():
    with working(80):
        for start, size in product((0.0, 1.0, 2.5, -2.0), (0.5, 3.0)):
            p = arb(0), arb(0), arb(start).cos() * 2, arb(start).sin() * 2
            for angle in (-1.5, -0.3, 0.0, 0.4, 1.5, 1.6, 3.0, -1.6, -3.0):
                q = arb(0), arb(0), arb(start + angle).cos() * size, arb(start + angle).sin() * size
                across, along = first_hit._products(p, q)
                assert abs(across - 2 * size * arb(angle).sin()) < 1e-14
                assert abs(along - 2 * size * arb(angle).cos()) < 1e-14
                found = first_hit._angle(p, q)
                assert abs(found - angle) < 1e-14 if angle > -1.55 else found.is_nan()
    assert first_hit._angle((0, 0, arb(1), arb(0)), (0, 0, arb(0), arb(1))).overlaps(arb.pi() / 2)
    assert first_hit._angle((0, 0, arb(1), arb(0)), (0, 0, arb(0), arb(-1))).is_nan()
    assert first_hit._angle((0, 0, arb(1), arb(0)), (0, 0, arb(-1), arb(0))).is_nan()
