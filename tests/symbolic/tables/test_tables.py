"""The paper's tables are tables: closed, counterclockwise, convex where the paper says so."""

import re

import pytest
from sympy import Interval, Rational, S, Symbol, pi, simplify, sqrt

from symbolic.expressions.signs import Outcome, positive, vanishes
from symbolic.motion.chords import convexity
from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, named, piecewise
from symbolic.tables.geometry import turning
from symbolic.tables.table import Mark, Table, a, alpha, interval_text, theta
from symbolic.tables.validity import enclosed_area

TABLES = [circle, ellipse, cardioid, cuspless, egg(2), egg(3), egg(4), egg(7)]
AREAS = {
    "circle": pi,
    "ellipse": pi * a,
    "cardioid": 3 * pi / 2,
    "cuspless": pi + 7 * sqrt(3) / 8 + sqrt(3) / 16,  # the sector of 240 degrees and a triangle at the origin
    "egg": pi * (1 + alpha**2 / 2),
}


def identity(table: Table) -> str:
    return table.name


@pytest.mark.parametrize("table", TABLES, ids=identity)
def test_each_component_starts_where_the_last_one_ends(table):
    for before, after in zip(table.components, (*table.components[1:], table.components[0]), strict=True):
        ends = zip(before.at(before.end), after.at(after.start), strict=True)

        assert all(vanishes(p - q) for p, q in ends)


@pytest.mark.parametrize("table", TABLES, ids=identity)
def test_the_enclosed_area_is_that_of_a_hand_calculation_and_positive(table):
    area = enclosed_area(table)

    assert simplify(area - AREAS[table.name]) == 0
    assert positive(area, {shape.symbol: shape.range for shape in table.shapes})


@pytest.mark.parametrize("table", [t for t in TABLES if t.name != "cardioid"], ids=identity)
def test_tables_are_convex_for_every_shape_of_their_range(table):
    assert convexity(table).outcome is Outcome.PROVED


@pytest.mark.parametrize("K", [2, 3, 4, 5, 7])
def test_eggs_stop_being_convex_exactly_at_the_end_of_their_range(K):
    end = Rational(1, 1 + K * K)
    flat = turning(egg(K).components[0]).subs(theta, pi / K)

    assert flat.subs(alpha, end) == 0
    assert convexity(egg(K), {alpha: Interval(0, end + Rational(1, 10**6))}).outcome is Outcome.REFUTED


def test_a_symbolic_egg_has_the_range_of_every_egg():
    K = Symbol("K", integer=True, positive=True)

    assert egg(K).shapes[0].range == Interval(0, 1 / (1 + K**2))


@pytest.mark.parametrize("K", [2, 3, 4, 5, 10])
def test_a_shape_out_of_range_is_refused_with_the_range(K):
    said = f"egg: alpha = 1/4 makes the table non-convex; alpha must lie in [0, 1/{K * K + 1}]"
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        egg(K).at(alpha=Rational(1, 4))


def test_the_sentence_of_the_house_is_said_word_for_word():
    said = "egg: alpha = 1/5 makes the table non-convex; alpha must lie in [0, 1/10]"
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        egg(3).at(alpha=Rational(1, 5))


@pytest.mark.parametrize("K", [2, 3, 5])
def test_both_ends_of_a_range_belong_to_it_and_nothing_beyond_does(K):
    end, little = Rational(1, 1 + K * K), Rational(1, 10**30)

    assert [egg(K).at(alpha=value).shapes for value in (0, end)] == [(), ()]
    assert ellipse.at(a=1).components[0].point == circle.components[0].point
    for table, name, value in ((egg(K), "alpha", -little), (egg(K), "alpha", end + little), (ellipse, "a", 1 - little)):
        with pytest.raises(ValueError, match="must lie in"):
            table.at(**{name: value})


def test_a_table_remembers_the_numbers_it_was_given():
    table = ellipse.at(a="1.5")

    assert table == ellipse.at(a=Rational(3, 2))
    assert table.fixed == (("a", Rational(3, 2)),)
    assert table.components[0].at(S.Zero) == (Rational(3, 2), 0)


def test_an_ellipse_may_have_an_irrational_axis():
    assert ellipse.at(a=sqrt(2)).components[0].at(S.Zero) == (sqrt(2), 0)
    with pytest.raises(ValueError, match="must lie in"):
        ellipse.at(a=sqrt(2) / 2)


@pytest.mark.parametrize("name", ["circle", "ellipse", "cardioid", "cuspless", "egg"])
def test_the_five_names_of_the_paper_are_known(name):
    assert named(name).name == name


def test_only_the_cardioid_has_an_undefined_point_and_it_is_where_the_speed_vanishes():
    (mark,) = cardioid.undefined
    velocity = [coordinate.diff(theta).subs(theta, mark.theta) for coordinate in cardioid.components[0].point]

    assert (mark.name, velocity) == ("cusp", [0, 0])
    assert [table.name for table in TABLES if table.undefined] == ["cardioid"]


def test_cuspless_joins_share_a_tangent_and_not_a_curvature():
    arc, wall = cuspless.components
    along = [[c.diff(theta).subs(theta, end) for c in part.point] for part, end in ((arc, arc.end), (wall, wall.start))]

    assert along[0][0] == along[1][0] == 0
    assert along[0][1].is_negative
    assert along[1][1].is_negative
    assert turning(arc).subs(theta, arc.end) != 0
    assert turning(wall) == 0


@pytest.mark.parametrize(
    ("interval", "text"),
    [(Interval(1, 2), "[1, 2]"), (Interval.open(0, 1), "(0, 1)"), (Interval.Ropen(0, 1), "[0, 1)")],
)
def test_intervals_print_as_mathematicians_write_them(interval, text):
    assert interval_text(interval) == text


@pytest.mark.parametrize("table", TABLES, ids=identity)
def test_a_table_is_a_value_that_can_be_a_key(table):
    assert {table: 1}[table] == 1
    for part in (table, table.components[0], *table.shapes, *table.undefined):
        with pytest.raises(AttributeError):
            part.name = "other"
        with pytest.raises(AttributeError):
            part.symbol = alpha


def test_what_is_left_out_is_the_papers():
    square = [
        arc(f"side {i}", *side, -1, 1) for i, side in enumerate([(theta, -1), (1, theta), (-theta, 1), (-1, -theta)])
    ]

    assert egg() == named("egg") == egg(3)
    assert named("egg", 4) == egg(4)
    assert piecewise(*square).origin == Table("square", tuple(square)).origin == (0, 0)
    assert cardioid.undefined == (Mark("cusp", 0, pi),)


@pytest.mark.parametrize("given", [True, False, None, [1], {"x": 1}])
def test_what_is_neither_number_nor_formula_is_refused(given):
    with pytest.raises(ValueError, match="is no formula; give an exact expression"):
        arc("side", given, theta, -1, 1)
