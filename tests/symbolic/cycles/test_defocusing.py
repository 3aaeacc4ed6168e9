"""The cone of beams in the cardioid: exact identities, and the cases in which its bounds are equalities."""

import cmath
import math

import pytest
from sympy import Rational, S, cos, pi, simplify, sin, sqrt, tan

from symbolic.cycles.defocusing import C, away, delta, ends, expands, gain, half, least_stretch, x
from symbolic.tables.table import lam


@pytest.mark.slow
def test_every_step_of_the_proof_is_an_identity():
    assert expands()


CHORDS = [(-1.5, -0.2), (0.2, 1.4), (1.5, 0.9), (1.1, -0.7), (-0.4, 0.5), (-1.0, -1.56), (0.9, -0.9)]  # theta/2 at ends


def direction(first, last):
    """The chord over the unit tangent at its start, times 1 or -1 for the sense of the motion, as a complex number."""
    start, end = ((1 + cmath.exp(2j * h)) ** 2 / 2 for h in (first, last))
    return (end - start) / (1j * cmath.exp(3j * first)) * (1 if last > first else -1)


@pytest.mark.parametrize(("first", "last"), CHORDS)
def test_a_chord_makes_an_angle_between_delta_and_twice_delta_with_the_tangent(first, last):
    angle, half_way = abs(cmath.phase(direction(first, last))), abs(last - first)

    assert half_way < angle < 2 * half_way


@pytest.mark.parametrize(("first", "last"), CHORDS)
def test_one_end_of_a_chord_inside_the_table_is_away_from_the_cusp(first, last):
    c0, c1, apart = math.cos(first), math.cos(last), last - first
    leaves, lands = c0 + 2 * c1 * math.cos(apart), c1 + 2 * c0 * math.cos(apart)

    assert leaves > 0 < lands
    assert abs(math.sin(apart) ** 2 - (c0**2 + c1**2 - 2 * c0 * c1 * math.cos(apart))) < 1e-15
    assert math.cos(apart) > -0.5
    assert 3 * max(c0, c1) ** 2 >= math.sin(apart) ** 2


def test_the_bounds_away_from_the_cusp_and_on_the_stretch_are_positive_below_1_alone():
    for k in range(10):
        assert away().subs(lam, Rational(k, 10)).is_positive
        assert least_stretch(7).subs(lam, Rational(k, 10)).n() > 0
    assert away().subs(lam, 1) == least_stretch(7).subs(lam, 1) == 0
    assert simplify(least_stretch(12) / least_stretch(11) - 1 - tan((1 - lam) * pi / 8) ** 2 / 2) == 0
    with pytest.raises(ValueError, match="from 2 bounces on"):
        least_stretch(1)


def test_the_vertical_chord_has_the_length_and_the_slope_that_are_known():
    """From theta = -pi/3 to pi/3: length 3*sqrt(3)/2, and slope `t*K + 1 = -5/4` of the slap map."""
    c0, c1 = (simplify(c.subs({half: -pi / 6, delta: pi / 3})) for c in ends())
    radius = 4 * sqrt(3) / 2 / 3
    length = 2 * sin(pi / 3) * sqrt(c0**2 + c1**2 + 2 * c0 * c1 * cos(pi / 3))

    assert (c0, c1) == (sqrt(3) / 2, sqrt(3) / 2)
    assert simplify(length - 3 * sqrt(3) / 2) == 0
    assert simplify(gain().subs({x: 1, C: S.Half}) - (length - radius) / radius) == 0
    assert simplify((length - radius) / radius) == Rational(5, 4)
