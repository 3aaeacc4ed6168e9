"""The determinant of a polygon's bounce, `lam` times a ratio of cosines, at the polygon's own angles."""

import pytest
from sympy import Rational, Symbol, cos, diff, simplify, tan

from symbolic.cycles.polygons import half_turn
from symbolic.cycles.thresholds import flux, flux_slope, polygon_factor, polygon_slope

x, delta = Symbol("x"), Symbol("delta")


def test_the_slope_is_the_derivative_of_the_flux_and_vanishes_where_x_tan_x_is_one():
    assert simplify(diff(flux(x), x) - flux_slope(x)) == 0
    assert simplify(flux_slope(x) / cos(x) - (1 - x * tan(x))) == 0


@pytest.mark.parametrize(("p", "q"), [(1, 3), (1, 4), (1, 6)])
def test_a_polygon_lands_at_gamma_plus_delta_and_leaves_at_gamma_minus_delta(p, q):
    gamma = half_turn(p, q)
    ratio = (gamma - delta) / (gamma + delta)

    assert simplify(polygon_factor(delta, p, q) - ratio * cos(gamma - delta) / cos(gamma + delta)) == 0
    assert simplify(polygon_slope(p, q) - (cos(gamma) - gamma * cos(gamma) * tan(gamma))) == 0


def test_the_triangle_and_the_square_contract_near_the_elastic_law_and_the_pentagon_expands():
    for q, contracts in ((3, True), (4, True), (5, False), (6, False)):
        assert bool(polygon_slope(1, q) > 0) is contracts
        assert bool(polygon_factor(Rational(1, 1000), 1, q).evalf() < 1) is contracts
