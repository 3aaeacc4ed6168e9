"""The paper's tables are valid: closed, counterclockwise, and convex where the paper says so."""

import re

import numpy as np
import pytest
from sympy import Interval, Rational, pi, simplify, sqrt

from numeric import PinballMap
from symbolic import Scene
from symbolic.expressions.signs import Outcome, positive, vanishes
from symbolic.motion.chords import convexity
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse, support
from symbolic.tables.geometry import turning
from symbolic.tables.table import Table, a, alpha, theta
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


@pytest.mark.slow
@pytest.mark.parametrize("K", [2, 3, 4, 5, 7])
def test_eggs_stop_being_convex_exactly_at_the_end_of_their_range(K):
    end = Rational(1, 1 + K * K)
    flat = turning(egg(K).components[0]).subs(theta, pi / K)

    assert flat.subs(alpha, end) == 0
    assert convexity(egg(K), {alpha: Interval(0, end + Rational(1, 10**6))}).outcome is Outcome.REFUTED


@pytest.mark.parametrize("K", [2, 3, 4, 5, 10])
def test_a_shape_out_of_range_is_refused_with_the_range(K):
    said = f"egg: alpha = 1/4 makes the table non-convex; alpha must lie in [0, 1/{K * K + 1}]"
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        egg(K).at(alpha=Rational(1, 4))


@pytest.mark.parametrize("K", [2, 3, 5])
def test_both_ends_of_a_range_belong_to_it_and_nothing_beyond_does(K):
    end, little = Rational(1, 1 + K * K), Rational(1, 10**30)

    assert [egg(K).at(alpha=value).shapes for value in (0, end)] == [(), ()]
    assert ellipse.at(a=1).components[0].point == circle.components[0].point
    for table, name, value in ((egg(K), "alpha", -little), (egg(K), "alpha", end + little), (ellipse, "a", 1 - little)):
        with pytest.raises(ValueError, match="must lie in"):
            table.at(**{name: value})


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


def test_a_body_of_constant_width_has_barbiers_perimeter_and_a_double_normal_everywhere():
    """Perimeter pi*width (Barbier), width h(theta) + h(theta + pi) = 2; where h + h'' changes sign it is refused."""
    map = PinballMap(Scene.of({"support": "1 + b*cos(3*theta)", "shape": {"b": "1/10"}, "lam": "1/2"}))
    theta = np.linspace(-3, 3, 50)
    landed, here = map.step(theta, 0 * theta), map.states.point(np.zeros(50, dtype=int), theta)

    assert map.arclength.perimeter == pytest.approx(2 * np.pi, abs=1e-12)
    assert np.max(np.abs(landed.eta)) < 1e-12
    assert np.hypot(landed.x - here[0], landed.y - here[1]) == pytest.approx(2, abs=1e-12)
    with pytest.raises(ValueError, match="not proved to be a table"):
        support("1 + cos(3*theta)/7")
