"""The bracketed zero: what it costs, which lanes it touches, and what it asks for."""

import numpy as np
import pytest

from numeric.backends.functions import TOLERANCE, bracketed_zero, halley, polynomial_zero, value_and_slope
from numeric.backends.scalars import ArrayBackend

EPS = 2.0**-52
OPS = ArrayBackend()


def counting(function):
    """The function with a list of the points at which it was asked."""
    asked = []

    def counted(x):
        asked.append(np.array(x))
        return function(x)

    return counted, asked


def zero_of(function, start, low, high, newton, **more):
    """The zero, and how often the function was asked for it."""
    counted, asked = counting(function)
    with np.errstate(all="ignore"):
        low = low if callable(low) else np.array([low])
        x = bracketed_zero(OPS, counted, np.array([start]), low, np.array([high]), 1.0, newton, **more)
    return float(x[0]), len(asked)


def square(x):
    return x * x - 2, 2 * x


def test_a_good_start_asks_for_no_bracket():
    def dear():
        raise AssertionError("nobody needs this bound")

    x, asked = zero_of(square, 1.4, dear, 9.0, 3, accepts=lambda x: x > 0)

    assert abs(x - 2**0.5) <= EPS
    assert asked == 3


@pytest.mark.parametrize("start", [-1.4, 1e9, 1e-9, 8.9])
def test_a_bad_start_costs_a_few_steps_of_newton(start):
    x, asked = zero_of(square, start, 0.0, 9.0, 1)

    assert abs(x - 2**0.5) <= 2 * EPS
    assert asked <= 9


@pytest.mark.parametrize("wrong", [lambda x: x < 0, lambda x: x == 7])
def test_a_zero_that_is_not_accepted_is_looked_for_in_the_interval(wrong):
    x, asked = zero_of(square, 1.4, lambda: np.array([0.0]), 9.0, 3, accepts=wrong)

    assert abs(x - 2**0.5) <= EPS
    assert asked > 3


@pytest.mark.parametrize(("low", "high", "zero"), [(-2.0, 3.0, 1.0), (-9.0, 0.5, -3.0), (4.0, 99.0, 5.0)])
def test_the_zero_inside_is_found_wherever_newton_ends(low, high, zero):
    """From 0 Newton runs to one of three zeros of -(x + 3)(x - 1)(x - 5) or its negative."""

    def cubic(x):
        value, slope = value_and_slope([15.0, -13.0, -3.0, 1.0], x)
        return (-value, -slope) if zero == 1.0 else (value, slope)

    for start in np.linspace(-10, 10, 21):
        x, asked = zero_of(cubic, start, low, high, 6)
        assert abs(x - zero) <= 8 * EPS
        assert asked <= 20


@pytest.mark.parametrize("power", [3, 9, 21])
def test_where_newton_crawls_the_bracket_is_halved(power):
    """At a multiple zero Newton gains a constant factor a step; here two passes at worst gain one half."""

    def flat(x):
        return (x - 0.1) ** power, power * (x - 0.1) ** (power - 1)

    x, asked = zero_of(flat, 7.0, -5.0, 8.0, 2)

    assert abs(x - 0.1) <= power * TOLERANCE  # the last step is a power-th of the error
    assert asked <= 2 + 2 * 60


def test_a_step_function_is_bisected_to_the_last_bits_and_no_further():
    def jump(x):
        return np.where(x < 0.3, -1.0, 1.0), np.zeros_like(x)

    x, asked = zero_of(jump, 1.0, -3.0, 5.0, 0)

    assert abs(x - 0.3) <= 2.0**-53
    assert asked == 1 + 55  # from 4 to 2**-53, which is the tolerance of an error times that of a step


def scripted(values, low=0.0, high=8.0, start=4.0, scale=1.0):
    """The points at which a function of slope one is asked that has these values, one after the other."""
    left = iter(values)
    counted, asked = counting(lambda x: (np.array([next(left)]), np.ones(1)))
    bracketed_zero(OPS, counted, np.array([start]), np.array([low]), np.array([high]), scale, 0)
    return [float(x[0]) for x in asked]


def test_a_step_that_leads_to_an_end_of_the_bracket_is_not_taken():
    assert scripted([4.0, 0.0]) == [4, 2]
    assert scripted([-4.0, 0.0]) == [4, 6]


def test_a_step_is_taken_when_it_is_half_the_last_one_at_most():
    assert scripted([1.0, 0.5, 0.0]) == [4, 3, 2.5]
    assert scripted([1.0, 0.5 * (1 + EPS), 0.0]) == [4, 3, 1.5]


def test_a_start_at_an_end_of_the_bracket_is_moved_to_its_middle():
    assert scripted([0.0], start=8.0) == [4]
    assert scripted([0.0], low=-2.0, start=-2.0) == [3]


def test_steps_as_short_as_the_tolerance_are_the_last():
    """Inside the loop, and before it; both as a share of the larger of zero and scale."""
    assert scripted([8 * TOLERANCE, 0.0], scale=8.0) == [4]
    assert scripted([8 * TOLERANCE * (1 + EPS), 0.0], scale=8.0) == [4, 4 - 8 * TOLERANCE * (1 + EPS)]
    for step, asked in ((TOLERANCE, 1), (TOLERANCE * (1 + EPS), 2)):
        left = iter([step, 0.0])
        assert zero_of(lambda x, left=left: (np.array([next(left)]), np.ones(1)), 0.5, 0.0, 1.0, 1)[1] == asked


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_zero_at_an_end_asks_for_no_bracket(end):
    assert zero_of(lambda x: (x - end, np.ones(1)), 0.5, 0.0, 1.0, 2) == (end, 2)


def test_of_a_large_zero_the_relative_digits_count():
    def large(x):
        return x * x - 1e12, 2 * x

    (x, asked), (again, more) = (zero_of(large, start, 0.0, 1e9, 3) for start in (1.001e6, -5.0))

    assert abs(x - 1e6) <= 1e6 * EPS
    assert abs(again - 1e6) <= 1e6 * EPS
    assert (asked, more) == (3, 3 + 14)


def test_a_point_where_the_function_vanishes_is_kept():
    x, asked = zero_of(lambda x: (x, np.zeros_like(x)), 7.0, -4.0, 4.0, 0)

    assert (x, asked) == (0.0, 1)


def test_near_zero_the_error_counts_in_units_of_the_scale():
    """x**2 + x has the zero 0; relative digits of it are not asked for."""
    x, asked = zero_of(lambda x: (x * x + x, 2 * x + 1), 0.3, -0.5, 1.0, 4)

    assert abs(x) <= TOLERANCE**2
    assert asked == 4 or abs(x) < EPS


def test_lanes_do_not_touch_each_other():
    start, low, high = np.array([1.4, 5.0, np.nan, -3.0]), np.zeros(4), np.array([2.0, 2.0, 2.0, 9.0])
    with np.errstate(all="ignore"):
        together = bracketed_zero(OPS, square, start, low, high, 1.0, 2)
        alone = [bracketed_zero(OPS, square, *(x[i : i + 1] for x in (start, low, high)), 1.0, 2)[0] for i in range(4)]

    assert together.tolist() == alone
    assert np.max(np.abs(together - 2**0.5)) <= 2 * EPS


def test_lanes_that_nobody_wants_stay_where_newton_took_them():
    start = np.array([50.0, 50.0])
    counted, asked = counting(square)
    x = bracketed_zero(OPS, counted, start, np.zeros(2), np.full(2, 60.0), 1.0, 1, np.array([True, False]))

    assert abs(x[0] - 2**0.5) <= 2 * EPS
    assert x[1] == 50 - (2500 - 2) / 100

    asked.clear()

    def crawls(x):
        """Newton's method has no trouble in the first lane, and much in the second."""
        return np.where([True, False], x - 1, (x - 1) ** 9), np.where([True, False], 1.0, 9 * (x - 1) ** 8)

    slow, asked_slowly = counting(crawls)
    bracketed_zero(OPS, slow, start, np.zeros(2), np.full(2, 60.0), 1.0, 0, np.array([True, False]))
    assert len(asked_slowly) <= 3

    bracketed_zero(OPS, counted, start, np.zeros(2), np.full(2, 60.0), 1.0, 1, np.array([False, False]))
    assert len(asked) == 1


def test_polynomials_take_steps_of_halley_and_then_of_newton():
    p = [-2.0, 0.0, 0.0, 1.0]
    value, slope = value_and_slope(p, halley(p, halley(p, 1.3)))
    expected = halley(p, halley(p, 1.3)) - value / slope
    nobody = np.array([False])
    found = polynomial_zero(OPS, [np.array([c]) for c in p], np.array([1.3]), 0.0, 2.0, 1.0, (2, 1), nobody)

    assert found[0] == expected
    assert halley([-6.0, 2.0], 11.0) == 3.0
