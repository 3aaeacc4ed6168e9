"""Identities are recognised, and no other expression is ever called one."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import I, Rational, S, Symbol, cos, expand, nan, sin, sqrt, tan

from symbolic.expressions.identities import is_zero_in_ring, over_one_root, reduced_numerator
from symbolic.expressions.signs import vanishes
from symbolic.tables.curves import trigonometric
from symbolic.tables.table import a, theta

x, y = Symbol("x", real=True), Symbol("y", real=True)
SMALL = st.integers(-3, 3)
MONOMIALS = [(i, j, k) for i in range(4) for j in range(4) for k in range(2) if i + j + k <= 4]
SHIFTS = st.fractions(-1, 1, max_denominator=10**6).filter(bool)


@st.composite
def trigonometric_sums(draw):
    chosen = draw(st.lists(st.sampled_from(MONOMIALS), min_size=1, max_size=4))
    return sum((draw(SMALL) * cos(theta) ** i * sin(theta) ** j * cos(3 * theta) ** k for i, j, k in chosen), S.Zero)


@st.composite
def radical_sums(draw):
    roots = [S.One, sqrt(a), sqrt(1 + a), sqrt(a) * sqrt(1 + a), sqrt(3), a]
    return sum((draw(SMALL) * root for root in roots), S.Zero)


@settings(max_examples=15)
@given(trigonometric_sums(), trigonometric_sums())
@example(cos(theta) ** 3, sin(theta) ** 3)
def test_a_product_of_trigonometric_sums_equals_its_linear_form(p, q):
    assert vanishes(p * q - trigonometric(p * q))


@pytest.mark.slow
@settings(max_examples=15)
@given(radical_sums(), radical_sums())
def test_radical_identities_are_recognised(p, q):
    assert vanishes((p + q) ** 2 - p**2 - 2 * p * q - q**2)
    assert vanishes(expand(p * q) - p * q)
    if expand(q) != 0:
        assert vanishes(p / q - p * q / expand(q**2))


@settings(max_examples=5)
@given(trigonometric_sums(), st.sampled_from([S.Zero, S.One]))
@example(cos(theta) + sin(theta), S.One)
def test_the_ring_of_polynomials_decides_what_reduction_proves(p, wrong):
    difference = a * (p * sin(theta) - trigonometric(p * sin(theta)) + sin(2 * x) ** 2 + cos(2 * x) ** 2 - 1)
    difference += wrong * tan(theta) / (2 + a)

    assert is_zero_in_ring(difference) is (wrong == 0)
    assert (reduced_numerator(difference) == 0) is (wrong == 0)


z = Symbol("z")


@pytest.mark.parametrize(
    "identity",
    [
        (a - 1) / (sqrt(a) + 1) - sqrt(a) + 1,
        (1 - a**2) ** Rational(-3, 2) * (1 + a) - 1 / (sqrt(1 - a**2) * (1 - a)),
        1 / (sqrt(a + sqrt(a)) + 1) - (sqrt(a + sqrt(a)) - 1) / (a + sqrt(a) - 1),
        1 / (a + I) - (a - I) / (a**2 + 1),
        sqrt(1 + sin(theta)) * (1 - sin(theta)) - cos(theta) ** 2 / sqrt(1 + sin(theta)),
    ],
    ids=str,
)
def test_a_root_is_a_generator_whose_square_is_known(identity):
    assert is_zero_in_ring(identity) is True
    for wrong in (Rational(1, 10**9), sqrt(a), I):
        assert is_zero_in_ring(identity + wrong) is None


@pytest.mark.parametrize("false", [sqrt(z**2) - z, sqrt(z - 1) - I * sqrt(1 - z), sqrt(z) + sqrt(z + 1)], ids=str)
def test_a_root_is_the_principal_one_and_no_other(false):
    """The first two expressions vanish for some values of `z` only, and the last for none."""
    assert is_zero_in_ring(false) is None
    assert not vanishes(false)


@pytest.mark.slow
@settings(max_examples=10)
@given(trigonometric_sums(), trigonometric_sums(), SHIFTS)
@example(cos(theta), sin(theta), Rational(1, 10**6))
def test_a_perturbed_trigonometric_identity_is_never_called_one(p, q, shift):
    shift = Rational(shift.numerator, shift.denominator)
    for wrong in (shift, shift * cos(2 * theta), shift * sin(theta)):
        assert not vanishes(p * q - trigonometric(p * q) + wrong)


@settings(max_examples=15)
@given(radical_sums(), radical_sums(), SHIFTS)
def test_a_perturbed_radical_identity_is_never_called_one(p, q, shift):
    shift = Rational(shift.numerator, shift.denominator)
    for wrong in (shift, shift * sqrt(a), shift * sqrt(2)):
        assert not vanishes((p + q) ** 2 - p**2 - 2 * p * q - q**2 + wrong)


@settings(max_examples=40)
@given(st.one_of(trigonometric_sums(), radical_sums()))
def test_whatever_is_called_zero_is_zero_at_points(expression):
    if vanishes(expression):
        for value in (Rational(1, 3), Rational(7, 5), Rational(22, 9)):
            assert abs(expression.subs({theta: value, a: value}).evalf(30)) < Rational(1, 10**25)


@pytest.mark.parametrize(
    "expression",
    [
        sqrt(2) * sqrt(3) - sqrt(6), sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3), 1 / (sqrt(2) - 1) - sqrt(2) - 1,
        tan(theta) * cos(theta) - sin(theta), 1 / (1 + sqrt(a)) - (1 - sqrt(a)) / (1 - a),
        sqrt(4 * a + 4) - 2 * sqrt(a + 1),
        (1 + a) ** Rational(3, 2) - (1 + a) * sqrt(1 + a), cos(5 * theta) - 16 * cos(theta) ** 5 + 20 * cos(theta) ** 3
        - 5 * cos(theta), S.Zero, (7 + 5 * sqrt(2)) ** Rational(1, 3) - 1 - sqrt(2),
        (2 + sqrt(5)) ** Rational(1, 3) - (1 + sqrt(5)) / 2, sqrt(1 + sin(theta) ** 2) - sqrt(2 - cos(theta) ** 2),
        sqrt(a / 2 + Rational(1, 2)) - sqrt(2 * a + 2) / 2, (a / 9 + 1) ** Rational(-3, 2)
        - 27 * (a + 9) ** Rational(-3, 2),
        1 / sqrt(1 + sin(theta)) + sin(theta) / sqrt(1 + sin(theta)) - sqrt(1 + sin(theta)),
    ],
)  # fmt: skip
def test_known_identities_vanish(expression):
    assert vanishes(expression)


@pytest.mark.parametrize(
    "expression",
    [
        sqrt(x**2) - x, sqrt(x**2 - 2 * x + 1) - (x - 1), sqrt(x) * sqrt(y) - sqrt(x * y), sqrt(-x) - I * sqrt(x),
        sqrt(1 - cos(theta) ** 2) - sin(theta), sqrt(x - 1) * sqrt(x + 1) - sqrt(x**2 - 1), cos(theta) - 1,
        sqrt(2) + sqrt(3) - sqrt(10), Rational(1, 10**40), nan, S.ComplexInfinity, cos(theta) - cos(3 * theta),
    ],
)  # fmt: skip
def test_statements_that_fail_on_a_branch_do_not_vanish(expression):
    assert not vanishes(expression)


@settings(max_examples=15)
@given(st.sampled_from([S(3), 1 - x**2, x]), st.lists(SMALL, min_size=8, max_size=8))
@example(1 - x**2, [0, 0, 1, 0, 1, 0, 0, 1])
def test_a_quotient_with_one_square_root_is_a_rational_part_and_a_rational_multiple_of_the_root(base, numbers):
    c = [S(number) for number in numbers]
    r = sqrt(base)
    bottom = c[4] + c[5] * x + (c[6] + 7 * y) * r
    quotient = (c[0] + c[1] * y + (c[2] + c[3] * x) * r**3) / bottom + c[7] / r + r
    found = over_one_root(quotient)
    share = Symbol("share")
    parts = found.xreplace({r: share})
    assert vanishes(found - quotient)
    assert parts.is_rational_function()
    assert parts.diff(share, 2) == 0
