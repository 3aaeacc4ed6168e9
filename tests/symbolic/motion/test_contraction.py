"""Contraction of areas: the factor of a bounce, its sum along orbits, and the limit of elastic collisions."""

from sympy import Rational, cos, limit, log, oo, pi, simplify, symbols, tan

from symbolic.expressions.signs import vanishes
from symbolic.motion.collision import area_factor, elastic_mean, joachimsthal_defect, telescoped, weak_dissipation
from symbolic.tables.table import eta, lam


def test_contraction_is_not_pointwise_however_strong_it_is():
    for contraction in (Rational(1, 100), Rational(1, 2), Rational(99, 100)):
        factor = area_factor().subs(lam, contraction)

        assert factor.subs(eta, 0) == contraction
        assert limit(factor, eta, pi / 2, "-") is oo


def test_determinants_along_an_orbit_telescope_to_the_sum_rule():
    assert [telescoped(n) for n in (1, 2, 4)] == [1, 1, 1]


def test_leaving_the_elastic_law_contracts_nothing_on_average_over_phase_space():
    assert elastic_mean(weak_dissipation()) == 0
    assert elastic_mean(eta * tan(eta)) == 1
    assert elastic_mean(eta * tan(eta) * cos(eta) ** 2) == Rational(2, 9)  # by parts: the integral of cos(eta)**3/6


def test_oblique_bounces_expand_and_steep_ones_contract_under_weak_dissipation():
    rate = weak_dissipation()

    assert rate.subs(eta, pi / 6) > 0  # log(g) falls with lam below 1: a triangle attracts
    assert rate.subs(eta, pi / 4) > 0
    assert rate.subs(eta, 3 * pi / 10) < 0  # and a pentagon repels


def test_in_an_ellipse_the_sum_rule_ends_after_one_term():
    """`cos(phi0)*g(q0) = cos(eta1)*g(q1)`, so `det DT` is `lam` times a quotient of positions, with sum `log(lam)`."""
    g0, g1, leaving = symbols("g0 g1 leaving", positive=True)
    landing = g0 * leaving / g1

    assert vanishes(joachimsthal_defect())
    assert simplify(log(lam * leaving / landing) - log(lam) - log(g1 / g0)).expand(force=True) == 0
