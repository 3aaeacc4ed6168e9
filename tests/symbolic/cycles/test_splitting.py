"""The cones of beams in the two cardioids: the proved inequalities, and their bounds in numbers."""

import pytest
from sympy import Rational, cos, pi, sqrt

from symbolic.cycles.defocusing import half
from symbolic.cycles.splitting import angle, c, clear, clearance, diameters, least_rate, rate, splits
from symbolic.expressions.signs import Outcome


@pytest.mark.slow
def test_the_cones_of_both_tables_are_proved():
    assert splits().outcome is Outcome.PROVED


def test_the_circle_in_the_boundary_touches_the_wall_at_the_join_alone():
    assert clear().subs(c, Rational(1, 2)) == 0
    assert all(clear().subs(c, Rational(k, 20)) > 0 for k in range(11, 21))


def test_a_chord_to_the_wall_is_longer_than_the_circle_by_what_is_said():
    """From the topmost point, theta = pi/3, to the wall: t = 1 and cos(phi) = 0, so that t - rho*cos(phi) = 1."""
    excess = clear() + 2 * c / 3 * (1 - cos(3 * half + 2 * angle))

    assert excess.subs({c: sqrt(3) / 2, half: pi / 6, angle: 0}).equals(1)


@pytest.mark.slow
def test_bounds_are_finite_below_the_elastic_case_and_give_way_there():
    values = [Rational(k, 10) for k in range(1, 10)]

    assert all(0 < rate(x).n(10) < 1 for x in values[::4])
    assert clearance(1) == 0
    assert all(bound.n(10) > 0 for x in values[::4] for bound in diameters(x))
    assert least_rate(Rational(16, 27)) == 0
    assert least_rate(1) == 0
    assert least_rate(Rational(3, 5)).n(10) > 0
