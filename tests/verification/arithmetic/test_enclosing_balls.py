"""What becomes a ball: words of each arithmetic, powers, decimals that are known, cuts of a stretch."""

import math
from fractions import Fraction

import pytest
from flint import arb
from sympy import CRootOf, Integer, Pow, Rational, S, Symbol, cbrt, pi, sqrt

from numeric.backends import elementary
from verification.arithmetic import balls as module
from verification.arithmetic.balls import ARRAYS, FLOAT64, bisected, bits_of, cuts, decimal, enclose, halves, working


def test_a_rational_is_a_quotient_and_arrays_have_the_functions_that_kernels_have():
    assert FLOAT64.q(1, 4) == ARRAYS.q(1, 4) == 0.25
    assert FLOAT64.root(8.0, 3) == pytest.approx(2)
    assert FLOAT64.pi == math.pi
    for word in module.FUNCTIONS:
        own = getattr(elementary, "arctan" if word == "atan" else word, None)
        assert own is None or getattr(ARRAYS, word) is own
    assert ARRAYS.root is elementary.root
    with pytest.raises(AttributeError, match="no attribute 'MATRICES'"):
        _ = module.MATRICES


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
    """The real root of `x**3 - x - 1`, which Cardano's formula gives too."""
    x = Symbol("x")
    for digits in (10, 30, 60):
        found = enclose(CRootOf(x**3 - x - 1, 0), digits=digits).real
        assert 0 < found.rad() * 2 ** (int(3.33 * digits) + 20) < 3.5
        root = sqrt(Rational(23, 108))
        assert found.overlaps(enclose(cbrt(S.Half + root) + cbrt(S.Half - root), digits=80).real)


def test_a_decimal_has_the_digits_that_are_asked_for_or_known_and_two_more():
    with working(300):
        third = arb(1) / 3
        assert decimal(arb(1) / 8, 20)[0].startswith("0.125")
        assert decimal(third, 5)[0] == "0.33333"
        for digits in (4, 9, 15):
            shown, bound = decimal(third + arb(0, 10.0**-digits), 40)
            assert digits <= len(shown) - 2 <= digits + 1
            assert 0.99 < float(bound) * 10.0**digits < 1.7
        assert decimal(arb("0.37", 2), 20)[0] == "0.4"
        exact = arb(12345678901234567890)
        assert Fraction(decimal(exact, 20)[0]) == 12345678901234567890
        assert Fraction(decimal(arb(1) / 1024, 60)[0]) == Fraction(1, 1024)


def test_a_decimal_of_many_digits_is_worked_out_with_the_bits_that_it_needs():
    """Whatever the precision outside is."""
    with working(400):
        value = arb(1) / 3
    with working(53):
        shown, bound = decimal(value, 100)
    assert shown == "0." + "3" * 100
    assert Fraction(bound) < Fraction(1, 10**100)
    assert abs(Fraction(shown) - Fraction(1, 3)) <= Fraction(bound)


@pytest.mark.parametrize(
    ("low", "high", "longest"), [(0.0, 1.0, 0.3), (2.0, 3.0, 5.0), (-2.0, -1.0, 0.5), (5.0, 6.5, 0.5)]
)
def test_a_stretch_is_cut_into_as_few_equal_pieces_as_are_short(low, high, longest):
    pieces = cuts(low, high, longest)
    count = max(1, math.ceil((high - low) / longest))
    assert len(pieces) == count
    width = (high - low) / count
    for k, piece in enumerate(pieces):
        assert float(piece.mid()) == pytest.approx(low + (k + 0.5) * width)
        assert float(piece.rad()) == pytest.approx(width / 2, rel=1e-6)


def test_halves_meet_in_the_middle():
    left, right = halves(arb(3, 1))
    assert left.contains(arb(2.5, 0.499))
    assert right.contains(arb(3.5, 0.499))
    assert max(left.rad(), right.rad()) < 0.5000001
    assert bits_of(10) == 34
    assert bits_of(10, 5) == 39


@pytest.mark.parametrize("longest", range(3))
def test_the_halves_of_a_box_are_all_of_it_and_meet_in_a_face(longest):
    box = tuple((float(i), 2.0 if i == longest else 1.0) for i in range(3))
    low, high = bisected(box)
    assert low[longest] == (longest - 1.0, 1.0)
    assert high[longest] == (longest + 1.0, 1.0)
    assert all(part[i] == box[i] for part in (low, high) for i in range(3) if i != longest)
