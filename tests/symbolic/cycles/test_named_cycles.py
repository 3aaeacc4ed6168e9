"""Where the named cycles bounce, in the order in which the ball gets there."""

import pytest
from sympy import Rational, nsolve, pi

from symbolic.cycles import cycle as named_cycles
from symbolic.cycles.cycle import c, egg_diameter, egg_parallel, egg_triangle, parallel_shape
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.table import lam, theta

PLACES = {
    "diameter": (circle, [(0, 0), (0, pi)]),
    "major_axis": (ellipse, [(0, 0), (0, pi)]),
    "minor_axis": (ellipse, [(0, pi / 2), (0, -pi / 2)]),
    "cardioid_vertical": (cardioid, [(0, pi / 3), (0, -pi / 3)]),  # s = 4*sin(theta/2) = 2
    "cuspless_vertical": (cuspless, [(0, pi / 3), (0, -pi / 3)]),
    "cuspless_horizontal": (cuspless, [(1, 0), (0, 0)]),
    "egg_diameter": (egg(3), [(0, 0), (0, pi)]),
    "egg_triangle": (egg(3), [(0, pi / 3), (0, pi), (0, 5 * pi / 3)]),
}


@pytest.mark.parametrize("name", PLACES)
def test_a_cycle_has_its_places_on_its_table(name):
    table, places = PLACES[name]
    cycle = getattr(named_cycles, name)()

    assert (cycle.table, list(cycle.bounces)) == (table, places)


def test_the_other_triangle_and_the_other_diameters():
    assert list(egg_triangle(at_flat=False).bounces) == [(0, 0), (0, 2 * pi / 3), (0, 4 * pi / 3)]
    assert list(egg_diameter(4, pi / 4).bounces) == [(0, pi / 4), (0, 5 * pi / 4)]
    assert egg_diameter(4).table == egg(4)


def test_the_orbit_between_parallel_tangents_lives_from_the_circle_to_the_flat_egg():
    cycle = egg_parallel()
    interval = cycle.ranges[c]
    last = nsolve(parallel_shape() - Rational(1, 10), c, -0.2)

    assert [place for place, _ in cycle.bounces] == [0, 0]
    assert set(cycle.ranges) == {c, lam}
    assert parallel_shape().subs(c, interval.end) == 0
    assert interval.start < last < interval.start + 0.01
    assert cycle.table.components[0].point[0].free_symbols == {theta, c}
