"""The algebraic slap map of the cardioid against a direct one, which follows the normal to its landing."""

from fractions import Fraction
from functools import cache
from itertools import pairwise

import mpmath
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Rational

from symbolic.cycles.cardioid_slap import (  # fmt: skip
    COS2,
    LAUNCH_COS2,
    LAUNCH_Q2,
    expands_by,
    expansion_infimum,
    forward_once,
    infimum_attained,
    parametrised,
    q,
    slope_squared,
    slow_region,
    unbounded,
)
from symbolic.expressions.signs import Outcome
from symbolic.tables import cardioid
from symbolic.tables.geometry import curvature
from symbolic.tables.table import theta

mp = mpmath.MPContext()
mp.dps = 50
NOTHING = mp.mpf(10) ** -35
LEAST = mp.mpf("1.50626223937")  # the infimum of |(T0**2)'|, to its last digit
LAUNCHES = st.fractions(Fraction(1, 50), Fraction(3), max_denominator=200)


def point(angle):
    return (1 + mp.expj(angle)) ** 2 / 2


def slap(start):
    """`(landing angle, flight length)` where the inward normal first meets the boundary again."""
    inward = -mp.expj(3 * start / 2)  # i times the tangent exp(3i*theta/2), upper half

    def miss(angle):
        return mp.im((point(angle) - point(start)) / inward) / mp.sin((angle - start) / 2)

    grid = [-mp.pi + 2 * mp.pi * (k + mp.mpf(1) / 3) / 60 for k in range(60)]
    landings = []
    for low, high in pairwise(grid):
        if miss(low) * miss(high) < 0 and not low < start < high:
            angle = mp.findroot(miss, (low, high), solver="anderson", tol=mp.mpf(10) ** -90)
            length = mp.re((point(angle) - point(start)) / inward)
            if length > NOTHING:
                landings.append((length, angle))
    length, angle = min(landings)
    return angle, length


def coordinate(angle):
    return mp.sin(angle / 2) / mp.sqrt(1 + 7 * mp.cos(angle / 2) ** 2)


@cache
def infimum():
    return mp.mpf(expansion_infimum().evalf(20))


def value(expression, at):
    return mp.mpf(expression.evalf(50, subs={q: mp.nstr(at, 55)}))


@settings(max_examples=15)
@given(LAUNCHES)
@example(Fraction(1, 50))
@example(Fraction(3))
def test_landing_and_slope_are_those_of_the_direct_map(start):
    start = mp.mpf(start.numerator) / start.denominator
    angle, length = slap(start)
    landing = coordinate(angle)

    assert -1 < landing < mp.mpf(1) / 3
    assert abs(value(LAUNCH_COS2, landing) - mp.cos(start / 2) ** 2) < NOTHING
    assert abs(value(LAUNCH_Q2, landing) - coordinate(start) ** 2) < NOTHING
    assert abs(value(COS2, landing) - mp.cos(angle / 2) ** 2) < NOTHING

    kappa = mp.mpf(curvature(cardioid.components[0]).evalf(50, subs={theta: mp.nstr(start, 55)}))
    cosine = abs(mp.cos(3 * (angle - start) / 2))  # between the two normals, up to sign
    assert abs(value(slope_squared(), landing) - ((1 + length * kappa) / cosine) ** 2) < NOTHING * (1 + 1 / cosine**4)


@settings(max_examples=5)
@given(LAUNCHES)
def test_the_slope_is_the_limit_of_difference_quotients(start):
    start, h = mp.mpf(start.numerator) / start.denominator, mp.mpf(10) ** -12
    (up, _), (middle, _), (down, _) = (slap(start + sign * h) for sign in (1, 0, -1))
    rise = 4 * (mp.sin(up / 2) - mp.sin(down / 2))
    run = 4 * (mp.sin((start + h) / 2) - mp.sin((start - h) / 2))
    slope = value(slope_squared(), coordinate(middle))

    assert abs(slope - (rise / run) ** 2) < mp.mpf(10) ** -16 * (1 + slope) ** 3


@settings(max_examples=4)
@given(LAUNCHES)
def test_two_bounces_expand_by_at_least_the_infimum(start):
    first, _ = slap(mp.mpf(start.numerator) / start.denominator)
    second, _ = slap(abs(first))  # the lower half is the mirror image
    product = value(slope_squared(), coordinate(first)) * value(slope_squared(), coordinate(second))

    assert product > LEAST**2 - mp.mpf(10) ** -9


@pytest.mark.slow
def test_the_infimum_is_attained_and_lies_between_the_proved_bounds():
    assert expands_by(Rational(3, 2)).outcome is Outcome.PROVED
    assert expands_by(Rational(16, 10)).outcome is Outcome.UNKNOWN
    assert abs(infimum() - LEAST) < mp.mpf(10) ** -10

    starts = [mp.mpf(k) / 40 for k in range(2, 125, 4)]
    firsts = [slap(start)[0] for start in starts]
    seconds = [slap(abs(first))[0] for first in firsts]
    found = [
        mp.sqrt(value(slope_squared(), coordinate(x)) * value(slope_squared(), coordinate(y)))
        for x, y in zip(firsts, seconds, strict=True)
    ]
    assert 0 <= min(found) - infimum() < 0.05


def test_the_infimum_is_proved_to_be_the_least_value_and_not_only_a_critical_one():
    assert unbounded().outcome is Outcome.PROVED
    assert infimum_attained().outcome is Outcome.PROVED


def test_one_bounce_contracts_exactly_in_the_slow_region():
    low, high = (mp.mpf(edge.evalf(40)) for edge in slow_region())
    for edge in (low, high):
        for side in (-1, 1):
            start = 2 * mp.asin((edge + side * mp.mpf(10) ** -6) / 4)
            slope = value(slope_squared(), coordinate(slap(start)[0]))

            assert (slope < 1) == (low < 4 * mp.sin(start / 2) < high)


@pytest.mark.slow
def test_the_parametrisation_and_its_uniqueness_are_proved():
    assert parametrised().outcome is Outcome.PROVED
    assert forward_once().outcome is Outcome.PROVED
