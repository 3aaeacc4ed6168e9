"""Arc length is the integral of the speed, from the paper's origin in the paper's direction."""

import pytest
from sympy import Rational, S, elliptic_e, pi, simplify, sin, sqrt

from numeric import PinballMap
from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, piecewise, stadium
from symbolic.tables.curves import trigonometric
from symbolic.tables.geometry import arc_length, perimeter, positions, speed
from symbolic.tables.table import Mark, Table, theta

TABLES = [circle, ellipse, cardioid, cuspless, egg(3), egg(4)]


def identity(table: Table) -> str:
    return table.name


@pytest.mark.parametrize("table", TABLES, ids=identity)
def test_the_derivative_of_arc_length_is_the_speed(table):
    for component in table.components:
        slope = arc_length(component).diff(theta)

        assert trigonometric(slope**2 - speed(component) ** 2) == 0
        assert simplify(slope.subs(theta, 0)).is_positive
        assert arc_length(component).subs(theta, 0).doit() == 0


def test_the_cusp_of_the_cardioid_is_at_plus_and_minus_four():
    (s,) = positions(cardioid)

    assert s == 4 * sin(theta / 2)
    assert [s.subs(theta, value) for value in (-pi, 0, pi)] == [-4, 0, 4]


def test_the_cuspless_table_counts_from_the_wall_and_its_upper_join_is_negative():
    on_arc, on_wall = positions(cuspless)
    arc_, wall = cuspless.components
    upper = wall.at(wall.start)

    assert upper[1].is_positive
    assert on_wall.subs(theta, wall.start) == -sqrt(3) / 4
    assert on_wall.subs(theta, 0) == 0
    assert on_wall.subs(theta, wall.end) == sqrt(3) / 4
    assert simplify(on_arc.subs(theta, arc_.start)) == sqrt(3) / 4
    assert on_arc.subs(theta, 0) == 9 * sqrt(3) / 4  # the paper's C


def test_positions_go_once_around_without_a_gap():
    table = piecewise(*stadium().components, origin=(2, S.Zero))
    s = positions(table)
    ends = [(p.subs(theta, c.start), p.subs(theta, c.end)) for p, c in zip(s, table.components, strict=True)]

    assert s[2].subs(theta, 0) == 0
    assert ends[2][1] == ends[3][0]
    assert ends[3][1] == ends[0][0]
    assert ends[0][1] == ends[1][0]
    assert simplify(ends[1][1] - ends[2][0] - perimeter(table)) == 0


def test_perimeters_are_those_of_a_hand_calculation():
    assert perimeter(circle) == 2 * pi
    assert perimeter(cardioid) == 8
    assert perimeter(cuspless) == 2 * 4 * sqrt(3) / 2 + sqrt(3) / 2
    assert perimeter(egg(3).at(alpha=0)) == 2 * pi
    cycloid = arc("arch", "sin(theta) - theta", "1 - cos(theta)", 0, 2 * pi), arc("base", theta, 0, -2 * pi, 0)
    assert simplify(perimeter(piecewise(*cycloid)) - 8 - 2 * pi) == 0
    star = [arc(f"{k}", "cos(theta)**3", "sin(theta)**3", k * pi / 2, (k + 1) * pi / 2) for k in range(4)]
    assert perimeter(piecewise(*star)) == 6
    turned = piecewise(arc("c", *cardioid.components[0].point, 0, 2 * pi), undefined=[Mark("cusp", 0, pi)])
    assert PinballMap(turned, lam=1).arclength.perimeter == pytest.approx(8, abs=1e-12)


def test_the_perimeter_of_an_ellipse_is_the_complete_elliptic_integral():
    expected = 4 * 2 * elliptic_e(1 - Rational(1, 4))  # 4*a*E(1 - 1/a**2)

    assert abs((perimeter(ellipse.at(a=2)) - expected).evalf(30)) < Rational(1, 10**25)
