"""Each limit: the last thing that is accepted, and the first that is refused, with what is said."""

import pytest
from sympy import Abs, Add, I, Rational, S, Symbol, asinh, cos, exp, log, pi, sin, sqrt, symbols, zoo

from symbolic.tables.formula import flaw, is_exponent, is_huge, levels, modest
from symbolic.tables.table import theta


def nested(inside, depth):
    for _ in range(depth):
        inside = sin(inside)
    return inside


LIMITS = {
    "levels": (nested(theta, 60), nested(theta, 61), "nested too deeply", "at most 60 levels"),
    "levels of a constant": (nested(S(2), 10), nested(S(2), 11), "a constant is nested", "at most 10 levels"),
    "nodes": (Add(*symbols("x:1499")), Add(*symbols("x:1500")), "too long", "at most 1500 operations"),
    "bits": (S(2) ** 1401 - 1, S(2) ** 1401, "the number is too large", "at most 1400 bits"),
    "bits below": (1 / (S(2) ** 1401 - 1), 1 / S(2) ** 1401, "the number is too large", "at most 1400 bits"),
    "exponent": (theta**64, theta**65, "the exponent 65 is", "between -64 and 64"),
    "negative exponent": (theta**-64, theta**-65, "the exponent -65 is", "between -64 and 64"),
    "half exponent": (theta ** Rational(127, 2), theta ** Rational(129, 2), "exponent 129/2", "between -64 and 64"),
    "root": (theta ** Rational(5, 12), theta ** Rational(1, 13), "the exponent 1/13 is", "a denominator of at most 12"),
    "exp": (exp(10**6), exp(10**6 + 1), "the argument of exp is too large", "at most 1000000"),
    "negative exp": (exp(-(10**6)), exp(-(10**6) - 1), "the argument of exp is too large", "at most 1000000"),
    "functions": (Abs(cos(theta)) + log(theta), asinh(theta), "asinh is beyond the vocabulary", "the named functions"),
    "reality": (log(2), log(-2), "the value is not real", "with real values"),
    "a root of reality": (sqrt(2), S(-2) ** Rational(1, 3), "the value is not real", "with real values"),
    "the imaginary unit": (theta, I * theta, "the value is not real", "with real values"),
    "finiteness": (theta, zoo, "the value is not finite", "without a pole"),
}


@pytest.mark.parametrize(("last", "first", "said", "accepted"), LIMITS.values(), ids=LIMITS.keys())
def test_a_limit_is_where_it_is_said_to_be(last, first, said, accepted):
    assert flaw(last) is None
    found, instead = flaw(first)

    assert said in found
    assert accepted in instead


def test_exponents_are_rationals_of_small_denominator_and_of_modulus_up_to_64():
    accepted = [S(64), S(-64), Rational(127, 2), Rational(1, 2), Rational(7, 12), S.Zero]
    refused = [S(65), S(-65), Rational(129, 2), Rational(1, 13), Rational(2, 25), theta, pi]

    assert [is_exponent(value) for value in accepted + refused] == [True] * 6 + [False] * 7


def test_only_a_large_constant_is_huge():
    assert [is_huge(S(n)) for n in (10**6, 10**6 + 1, -(10**6), -(10**6) - 1)] == [False, True, False, True]
    assert not is_huge(10**7 * theta)
    assert is_huge(10**6 * pi)


def test_powers_of_modest_numbers_are_judged_before_they_are_taken():
    assert modest(S(4), 700)
    assert not modest(S(4), 701)
    assert modest(S(1), 10**9)
    assert modest(Rational(1, 4), 700)
    assert not modest(Rational(-1, 4), 701)


def test_levels_count_operations_and_not_names():
    assert [levels(value) for value in (theta, S(3), 1 + theta, 1 + sin(1 + theta), Symbol("x") * sin(theta))] == [
        0, 0, 1, 3, 2,
    ]  # fmt: skip
