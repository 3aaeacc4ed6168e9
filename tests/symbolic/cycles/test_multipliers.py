"""Jury's criterion against numerically computed multipliers."""

from fractions import Fraction

import mpmath
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Interval, Rational, S, Symbol

from symbolic.cycles.cycle import saddle
from symbolic.expressions.signs import Outcome

mp = mpmath.MPContext()
mp.dps = 60
NOTHING = mp.mpf(10) ** -40
NUMBERS = st.fractions(-3, 3, max_denominator=12)


def exact(value: Fraction) -> Rational:
    return Rational(value.numerator, value.denominator)


def roots(trace: Fraction, det: Fraction) -> tuple:
    trace, det = (mp.mpf(value.numerator) / value.denominator for value in (trace, det))
    half = mp.sqrt(trace**2 / 4 - det)
    return trace / 2 + half, trace / 2 - half


@settings(max_examples=80)
@given(NUMBERS, NUMBERS)
@example(Fraction(0), Fraction(1))
@example(Fraction(2), Fraction(1))
@example(Fraction(-1), Fraction(0))
@example(Fraction(3, 2), Fraction(1, 2))
def test_each_verdict_is_that_of_the_roots(trace, det):
    plus, minus = roots(trace, det)
    t, d = exact(trace), exact(det)
    real = abs(mp.im(plus)) < NOTHING
    expected = real and 0 + NOTHING < mp.re(minus) < 1 - NOTHING and mp.re(plus) > 1 + NOTHING

    assert saddle(t, d, {}).outcome is (Outcome.PROVED if expected else Outcome.REFUTED)


def test_a_whole_range_is_judged_with_its_ends():
    x = Symbol("x", real=True)

    assert saddle(2 + x, S.One, {x: Interval.Lopen(0, 5)})
    assert saddle(2 + x, S.One, {x: Interval(0, 5)}).outcome is Outcome.REFUTED
