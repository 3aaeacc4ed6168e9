"""Exact numbers become balls that contain them, and decimals with the requested number of digits."""

from fractions import Fraction

import pytest
from flint import arb
from sympy import CRootOf, Integer, Pow, Rational, S, Symbol, cbrt, pi, sqrt

from verification.arithmetic.balls import decimal, enclose, working


@pytest.mark.parametrize(
    ("base", "power", "value"),
    [
        (Rational(3, 2), 3, Fraction(27, 8)),
        (Integer(-2), 3, Fraction(-8)),
        (Integer(-2), -2, Fraction(1, 4)),
        (Rational(9, 4), Rational(1, 2), Fraction(3, 2)),
        (Rational(9, 4), Rational(3, 2), Fraction(27, 8)),
        (Rational(1, 4), Rational(-1, 2), Fraction(2)),
    ],
)
def test_a_power_that_is_a_number_of_binary_digits_is_that_number_exactly(base, power, value):
    found = enclose(Pow(base, power, evaluate=False))
    assert found.real == arb(value.numerator) / value.denominator
    assert found.imag == 0


@pytest.mark.parametrize("power", [sqrt(2), pi, Rational(1, 3), Rational(5, 3), Rational(3, 2), Rational(-7, 2)])
def test_a_power_of_any_exponent_is_that_of_doubles(power):
    found = enclose(Pow(Integer(5), power, evaluate=False), digits=30)
    assert float(found.real) == pytest.approx(5 ** float(power), rel=1e-14)
    assert found.real.rad() < 1e-27


def test_a_root_of_a_polynomial_is_within_three_units_of_the_bits_that_are_worked_with():
    """The real root of `x**3 - x - 1`, compared with Cardano's formula."""
    x = Symbol("x")
    for digits in (10, 30, 60):
        found = enclose(CRootOf(x**3 - x - 1, 0), digits=digits).real
        assert 0 < found.rad() * 2 ** (int(3.33 * digits) + 20) < 3.5
        root = sqrt(Rational(23, 108))
        assert found.overlaps(enclose(cbrt(S.Half + root) + cbrt(S.Half - root), digits=80).real)


def test_a_decimal_of_many_digits_is_worked_out_with_the_bits_that_it_needs():
    """The decimal does not depend on the ambient precision."""
    with working(400):
        value = arb(1) / 3
    with working(53):
        shown, bound = decimal(value, 100)
    assert shown == "0." + "3" * 100
    assert Fraction(bound) < Fraction(1, 10**100)
    assert abs(Fraction(shown) - Fraction(1, 3)) <= Fraction(bound)
