"""Words of formulas in the second reader: enclosures as narrow as they can be, slopes, and what is no word."""

from fractions import Fraction
from itertools import product

import mpmath
import pytest

BITS = (16, 53, 100)
AT = ("0", "1/4", "-1/4", "1/2", "-1/2", "1", "-1", "5/4", "2", "-2", "9/4", "-9/4", "3", "7", "-7", "31/2", "-31/2")


@pytest.fixture(scope="module")
def formulas(check):
    return check.beside("formulas")


@pytest.fixture(scope="module")
def context():
    found = mpmath.MPContext()
    found.dps = 90
    return found


def real(context, x):
    return context.mpf(Fraction(x).numerator) / Fraction(x).denominator


def narrow(context, found, true, units) -> bool:
    """Does an interval hold a number, and is it no wider than so many units of its last place?"""
    scaled = true * context.mpf(2) ** found.p
    return found.lo <= scaled <= found.hi and found.hi - found.lo <= units


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize(("word", "units"), [("exp", 1), ("log", 2), ("tanh", 4), ("atan", 24)])
def test_a_word_at_a_point_is_enclosed_within_a_few_units(check, formulas, context, word, units, bits):
    """By mpmath, to 90 digits. An exponential and a logarithm are rounded once, at the end."""
    for text in AT if word != "log" else [x for x in AT if Fraction(x) > 0]:
        at = check.I.of(Fraction(text), bits)
        assert narrow(context, formulas.at_number(word, at, None), getattr(context, word)(real(context, text)), units)


@pytest.mark.parametrize("bits", BITS)
def test_small_and_large_numbers_have_exponentials_and_logarithms_too(check, formulas, context, bits):
    for end in (1, 2, 3, 5, (1 << bits) - 1, (1 << bits) + 1, 3 << bits + 20, (1 << bits + 40) + 1):
        at = real(context, Fraction(end, 1 << bits))
        assert narrow(context, formulas.log_at(check.I(end, end, bits)), context.log(at), 2)
    for end in (-bits << bits, (-bits << bits) - 1, -(bits + 1) << bits, -(bits - 1) << bits, -(3 << bits), 40 << bits):
        at = real(context, Fraction(end, 1 << bits))
        assert narrow(context, formulas.exp_at(check.I(end, end, bits)), context.exp(at), 1)


def test_the_exponential_of_what_is_far_below_0_takes_no_more_digits(check, formulas):
    for end in (-(1 << 70), -(1 << 90)):
        found = formulas.exp_at(check.I(end << 20, end << 20, 20))
        assert (found.lo, found.hi, found.p) == (0, 1, 20)


def test_an_exponential_is_enclosed_by_whichever_power_of_2_it_is_divided(check, formulas, context, monkeypatch):
    for k in (-7, -1, 0, 3, 9):
        monkeypatch.setattr(formulas, "twos", lambda x, k=k: k)
        for text in ("-5/2", "0", "3/8", "4"):
            found = formulas.exp_at(check.I.of(Fraction(text), 53))
            assert narrow(context, found, context.exp(real(context, text)), 2)


def test_the_logarithm_of_2_and_the_series_for_it_are_narrow(check, formulas, context):
    for bits in (1, 16, 53, 200):
        assert narrow(context, formulas.log2(bits), context.log(2), 1)
    for text in ("1/3", "-1/3", "1/5", "-1/100", "0"):
        found = formulas.artanh(check.I.of(Fraction(text), 200))
        assert narrow(context, found, context.atanh(real(context, text)), 400)
    for bits, ends in ((6, (15, 18)), (7, (31, 35))):  # after the first term below 2 units, with what may follow
        coarse = formulas.artanh(check.I.of(Fraction(1, 4), bits))
        assert (coarse.lo, coarse.hi) == ends


def test_an_exponential_that_is_too_large_and_roots_and_logarithms_of_0_are_refused(check, formulas):
    with pytest.raises(check.Unproved, match="an exponential is too large"):
        formulas.exp_at(check.I.of(2**16, 20))
    for low in (0, -1):
        with pytest.raises(check.Unproved, match="a logarithm of what may not be positive"):
            formulas.log_at(check.I(low, low, 20))
        with pytest.raises(check.Unproved, match="a root of what may not be positive"):
            formulas.at_number("power", check.I(low, 1 << 20, 20), Fraction(1, 3))


@pytest.mark.parametrize("word", ["exp", "log", "tanh", "atan"])
def test_a_word_over_an_interval_is_that_of_both_ends(check, formulas, word):
    low, high = (check.I.of(Fraction(x), 60) for x in ("1/3", "5/2"))
    whole, first, last = (formulas.at_number(word, x, None) for x in (low.hull(high), low, high))
    assert (whole.lo, whole.hi) == (first.lo, last.hi)


def read(check, text, at=None, bits=100):
    return check.evaluate(check.parse(text), {} if at is None else {"theta": check.I.of(Fraction(at), bits)}, bits)


SLOPED = {
    "exp(theta)": lambda m, x: m.exp(x),
    "log(theta)": lambda m, x: m.log(x),
    "tanh(theta)": lambda m, x: m.tanh(x),
    "atan(theta)": lambda m, x: m.atan(x),
    "tan(theta)": lambda m, x: m.tan(x),
    "sinh(theta)": lambda m, x: m.sinh(x),
    "cosh(theta)": lambda m, x: m.cosh(x),
    "sqrt(theta)": lambda m, x: m.sqrt(x),
    "theta**(-1)": lambda m, x: 1 / x,
    "theta**(-3)": lambda m, x: x**-3,
    "theta**40": lambda m, x: x**40,
    "theta**(2/3)": lambda m, x: m.cbrt(x) ** 2,
    "theta**(-1/3)": lambda m, x: 1 / m.cbrt(x),
    "abs(-theta)": lambda m, x: x,
    "Abs(theta)": lambda m, x: x,
    "+theta": lambda m, x: x,
    "exp(theta**2)": lambda m, x: m.exp(x**2),
    "atan(2*theta)": lambda m, x: m.atan(2 * x),
    "log(3*theta)": lambda m, x: m.log(3 * x),
    "tanh(theta/2)": lambda m, x: m.tanh(x / 2),
    "tan(theta/2)": lambda m, x: m.tan(x / 2),
    "sinh(2*theta)": lambda m, x: m.sinh(2 * x),
    "cosh(2*theta)": lambda m, x: m.cosh(2 * x),
    "sqrt(3*theta)": lambda m, x: m.sqrt(3 * x),
    "(2*theta)**(-2)": lambda m, x: (2 * x) ** -2,
}


@pytest.mark.parametrize("text", SLOPED)
def test_a_formula_has_its_value_and_its_slope_within_a_few_units(check, context, text):
    for at in ("3/5", "7/8", "9/8"):
        found = [check.I.of(x, 100) for x in read(check, text, at)]
        true = (
            SLOPED[text](context, real(context, at)),
            context.diff(lambda x: SLOPED[text](context, x), real(context, at)),
        )
        size = 1 + max(map(abs, true))
        assert narrow(context, found[0], true[0], 400 * size)
        assert abs(found[1].real() - true[1]) < 1e-12 * size
        assert found[1].width() <= 40000 * size


@pytest.mark.parametrize("text", SLOPED)
def test_a_formula_without_theta_has_no_slope(check, text):
    """Not even a small one: a root of what may be 0 has a value only where there is none."""
    value, slope = check.evaluate(check.parse(text.replace("theta", "b")), {"b": check.I.of(Fraction(3, 5), 100)}, 100)
    assert (type(slope), slope) == (int, 0)
    assert value.width() <= 4000


JETS = {**SLOPED, "exp(theta**2 - theta)": lambda m, x: m.exp(x**2 - x)}


@pytest.mark.parametrize("text", JETS)
def test_a_formula_of_a_jet_has_its_taylor_coefficients(check, context, text):
    at = Fraction(7, 8)
    wanted = context.taylor(lambda x: JETS[text](context, x), real(context, at), 3)
    for degree, letter in product((1, 2, 3), (0, 1, 2)):
        jet = check.Jet.of(check.I.of(at, 130), degree, letter)
        found = check.evaluate(check.parse(text.replace("theta", "u")), {"u": jet}, 130)[0]
        assert found.degree == degree
        assert len(found.c) == len(check.algebra(degree)[0])
        for order in range(degree + 1):
            index = check.algebra(degree)[1][tuple(order * (k == letter) for k in range(3))]
            assert check.I.of(found.c[index], 130).real() == pytest.approx(float(wanted[order]), rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("text", JETS)
def test_the_slope_of_a_formula_of_a_jet_has_the_taylor_coefficients_of_the_derivative(check, context, text):
    at = Fraction(7, 8)
    wanted = context.taylor(lambda x: JETS[text](context, x), real(context, at), 3)
    for degree in (1, 2):
        slope = check.evaluate(check.parse(text), {"theta": check.Jet.of(check.I.of(at, 130), degree, 0)}, 130)[1]
        found = slope.c if isinstance(slope, check.Jet) else check.Jet.of(slope, degree).c
        for order in range(degree + 1):
            index = check.algebra(degree)[1][order, 0, 0]
            true = float((order + 1) * wanted[order + 1])
            assert check.I.of(found[index], 130).real() == pytest.approx(true, rel=1e-12, abs=1e-13)


def test_a_square_is_not_below_0_and_the_slope_of_an_arctangent_not_below_that_at_the_farther_end(check, formulas):
    around = check.I(-2 << 40, 3 << 40, 40)
    for x, low, high in ((around, 0, 9), (-around, 0, 9), (check.I(2 << 40, 3 << 40, 40), 4, 9)):
        found = formulas.square(x)
        assert (found.lo, found.hi) == (low << 40, high << 40)
    slope = check.evaluate(check.parse("atan(theta)"), {"theta": around}, 40)[1]
    assert slope.lo <= Fraction(2**40, 10) <= slope.lo + 2
    assert slope.hi - 2 <= 2**40 <= slope.hi


@pytest.mark.parametrize(
    ("text", "at", "low", "high"),
    [
        ("abs(b)", ("-1/8", "1/4"), "0", "1/4"),
        ("abs(b)", ("-1/4", "1/8"), "0", "1/4"),
        ("abs(b)", ("1/4", "1/2"), "1/4", "1/2"),
        ("abs(b)", ("-1/2", "-1/4"), "1/4", "1/2"),
        ("abs(b)", ("0", "1/2"), "0", "1/2"),
        ("abs(b)", ("-1/2", "0"), "0", "1/2"),
        ("b**(1/2)", ("0", "1/4"), "0", "1/2"),
        ("b**(1/2)", ("0", "0"), "0", "0"),
        ("b**(2/3)", ("0", "1/8"), "0", "1/4"),
        ("b**(1/2)", ("1/4", "9/4"), "1/2", "3/2"),
    ],
)
def test_what_may_be_0_has_a_modulus_and_a_root(check, text, at, low, high):
    wide = check.I.of(Fraction(at[0]), 100).hull(check.I.of(Fraction(at[1]), 100))
    found, slope = check.evaluate(check.parse(text), {"b": wide}, 100)
    assert (type(slope), slope) == (int, 0)
    assert found.lo <= Fraction(low) * 2**100 <= found.lo + 8
    assert found.hi - 8 <= Fraction(high) * 2**100 <= found.hi
    assert found.lo >= 0 or Fraction(low) > 0


@pytest.mark.parametrize("text", ["theta**(1/2)", "theta**(-1/2)", "abs(theta)", "log(theta)", "theta**(-1)"])
def test_at_0_nothing_that_moves_has_a_root_a_modulus_or_an_inverse(check, text):
    with pytest.raises(check.Unproved):
        read(check, text, 0)
    with pytest.raises(check.Unproved):
        check.evaluate(check.parse(text), {"theta": check.Jet.of(check.I.of(0, 64), 1, 0)}, 64)
    with pytest.raises(check.Unproved):  # nor has what moves with another letter than theta
        check.evaluate(
            check.parse(text.replace("theta", "b")), {"b": check.Jet.of(check.I.of(Fraction(0), 64), 1, 1)}, 64
        )
    if text != "abs(theta)" and "-" in text:
        with pytest.raises(check.Unproved):
            check.evaluate(check.parse(text.replace("theta", "b")), {"b": check.I.of(0, 64)}, 64)


@pytest.mark.parametrize("exponent", ["64", "-64", "33", "1/12", "-11/12", "63/2"])
def test_exponents_up_to_64_with_denominators_up_to_12_have_a_meaning(check, context, exponent):
    found, slope = read(check, f"theta**({exponent})", "9/8", 160)
    true = real(context, "9/8") ** real(context, exponent)
    assert narrow(context, found, true, 10**7)
    assert slope.real() == pytest.approx(float(true * real(context, exponent) / real(context, "9/8")), rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        *("theta**65", "theta**(-65)", "theta**0", "theta**(1/13)", "theta**(129/2)", "theta**theta", "theta//40"),
        *("E(1)", "UAdd(theta)", "not theta", "Pow(theta, 40)", "Pow(theta)", "f", "f(theta)", "exp()", "theta.exp"),
        *("exp(theta, theta)", "exp", "theta is 1", "theta and theta", "exp(*theta)", "asin(theta)", "2**pi"),
    ],
)
def test_what_is_no_word_or_has_no_such_part_is_refused(check, text):
    with pytest.raises(check.Wrong):
        read(check, text, 1)


def test_e_is_eulers_number(check, context):
    found, slope = read(check, "E")
    assert narrow(context, found, context.e, 2)
    assert slope == 0
    found, slope = read(check, "+(theta + 1)", "1/2")
    assert found.lo == found.hi == 3 << 99
    assert slope == 1
