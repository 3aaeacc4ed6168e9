"""What the second reader makes of a formula: its value, its derivative by the place, and what it refuses."""

from fractions import Fraction

import mpmath
import pytest

P = 90


def truth(function, at):
    """The value and the slope of a function of one number, by mpmath to 50 digits."""
    context = mpmath.MPContext()
    context.dps = 50
    at = context.mpf(at.numerator) / at.denominator
    return function(context, at), context.diff(lambda x: function(context, x), at)


def encloses(check, x, true, units):
    """Is a true value in an interval no wider than so many units in the last place, or in the place of a number?"""
    x = check.I.of(x, P)
    return x.lo - 1 <= true * 2**P <= x.hi + 1 and x.width() <= units


@pytest.mark.parametrize(
    ("text", "function"),
    [
        ("theta", lambda m, t: t),
        ("-theta", lambda m, t: -t),
        ("pi*theta - a", lambda m, t: m.pi * t - m.mpf(3) / 7),
        ("a - 2*theta + 5", lambda m, t: m.mpf(3) / 7 - 2 * t + 5),
        ("theta*3 + theta/4", lambda m, t: t * 3.25),
        ("a*theta*theta", lambda m, t: m.mpf(3) / 7 * t * t),
        ("theta**1", lambda m, t: t),
        ("theta**2", lambda m, t: t**2),
        ("(2*theta - 1)**3", lambda m, t: (2 * t - 1) ** 3),
        ("theta^5", lambda m, t: t**5),
        ("a/theta", lambda m, t: m.mpf(3) / 7 / t),
        ("theta/a", lambda m, t: t * 7 / 3),
        ("(1 + theta)/(2 + theta**2)", lambda m, t: (1 + t) / (2 + t**2)),
        ("sin(3*theta)", lambda m, t: m.sin(3 * t)),
        ("cos(theta/2)", lambda m, t: m.cos(t / 2)),
        ("sin(a)*theta", lambda m, t: m.sin(m.mpf(3) / 7) * t),
        ("cos(2)*theta", lambda m, t: m.cos(2) * t),
        ("theta*cos(theta)*sin(theta)", lambda m, t: t * m.cos(t) * m.sin(t)),
        ("sqrt(a)*theta", lambda m, t: m.sqrt(m.mpf(3) / 7) * t),
        ("sqrt(2 + theta)", lambda m, t: m.sqrt(2 + t)),
        ("(2 + theta)**(1/2)", lambda m, t: m.sqrt(2 + t)),
        ("(2 + theta)**(5/3)", lambda m, t: (2 + t) ** (m.mpf(5) / 3)),
        ("(1/2 + theta/4)**33", lambda m, t: (m.mpf(1) / 2 + t / 4) ** 33),
        ("(2 + theta)**(-2)", lambda m, t: 1 / (2 + t) ** 2),
        ("(2 + theta)**(0 - 1)", lambda m, t: 1 / (2 + t)),
        ("theta - theta", lambda m, t: t - t),
        ("(theta + 1) - (theta - 1)*2", lambda m, t: 3 - t),
        ("1.25e-1*theta", lambda m, t: t / 8),
    ],
)
@pytest.mark.parametrize("at", [Fraction(5, 4), Fraction(-3, 7)])
def test_a_formula_has_its_value_and_its_slope_by_the_place(check, text, function, at):
    names = {"theta": check.I.of(at, P), "a": check.I.of(Fraction(3, 7), P + 30)}
    found = check.evaluate(check.parse(text), names, P)
    for x, true in zip(found, truth(function, at), strict=True):
        assert encloses(check, x, true, 200)


@pytest.mark.parametrize("text", [
    "theta", "-theta + a", "pi*theta - a", "theta/4 - 5", "theta**1", "theta**5", "a/theta", "theta/a", "a**3/7",
    "(1 + theta)/(2 + theta**2)", "sin(3*theta)*a", "cos(theta - a)", "sqrt(2 + theta)", "sqrt(a)*theta",
    "1/(a - 4*theta)", "a*theta - theta*a",
])  # fmt: skip
def test_a_formula_of_jets_has_the_slopes_of_a_formula_of_numbers_and_of_differences(check, text):
    """By the place, a letter of jets, the jet of the slope is the derivative of the jet; by `a` a quotient."""
    at, b = Fraction(5, 4), Fraction(3, 7)
    place, letter = (check.Jet.of(check.I.of(x, P), 2, k) for k, x in enumerate((at, b)))
    tree, one = check.parse(text), check.I.of(1, P)
    found, slope = check.evaluate(tree, {"theta": place, "a": letter}, P)
    found, slope = (check.Jet.of(0, 2) + x * one for x in (found, slope))
    number, rate = check.evaluate(tree, {"theta": check.I.of(at, P), "a": check.I.of(b, P)}, P)
    alike = [(found.c[0], number), (found.c[3], rate), *zip(found.diff(0).c, slope.c, strict=False)]
    near = lambda x: check.evaluate(tree, {"theta": check.I.of(at, 400), "a": check.I.of(x, 400)}, 400)[0]  # noqa: E731
    step = Fraction(1, 2**60)
    alike.append((found.c[2], check.I.of((near(b + step) - near(b - step)) * 2**59, P)))
    for x, y in alike:
        gap = check.I.of(x - y, P)
        assert gap.size().lo < 2**12


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("3", 3),
        ("-5/8", Fraction(-5, 8)),
        ("2*3 - 7/4", Fraction(17, 4)),
        ("0.125", Fraction(1, 8)),
        ("2e3/3", Fraction(2000, 3)),
    ],
)
def test_numbers_stay_exact_and_have_no_slope(check, text, wanted):
    assert check.evaluate(check.parse(text), {}, P) == (wanted, 0)


def test_what_has_no_place_has_no_slope_at_all(check):
    """Not even an interval about 0: a formula of letters and `pi` is as a number is."""
    for text in ("a", "pi", "a + pi", "a*pi - a/3", "a**4", "sin(a)", "cos(pi)", "sqrt(a)", "a/(1 + a)", "2**5", "-a"):
        assert check.evaluate(check.parse(text), {"a": check.I.of(Fraction(3, 7), P)}, P)[1] == 0


@pytest.mark.parametrize(("x", "root"), [("2", 2**0.5), ("1/4", 0.5), ("0", 0.0), ("1/9", 1 / 3), ("2**60", 2.0**30)])
def test_the_root_of_a_number_is_within_a_few_units(check, x, root):
    found, slope = check.evaluate(check.parse(f"sqrt({x})"), {}, P)
    assert slope == 0
    assert found.real() == pytest.approx(root, abs=1e-15)
    assert found.width() <= 3
    low, high = Fraction(found.lo, 2**P), Fraction(found.hi, 2**P)
    square = check.I.of(check.evaluate(check.parse(x), {}, P)[0], P)
    assert low**2 <= Fraction(square.hi, 2**P)
    assert Fraction(square.lo, 2**P) <= high**2


def test_the_root_of_what_is_wide_is_that_of_both_ends(check):
    wide = check.I.of(Fraction(1, 9), P).hull(check.I.of(Fraction(49, 16), P))
    found, _ = check.evaluate(check.parse("sqrt(a)"), {"a": wide}, P)
    assert found.lo <= Fraction(2**P, 3) < found.lo + 2
    assert found.hi - 2 < Fraction(7 * 2**P, 4) <= found.hi


@pytest.mark.parametrize(
    ("text", "error", "why"),
    [
        ("1/0", "Unproved", "a divisor may be 0"),
        ("1/(a - a)", "Unproved", "a divisor may be 0"),
        ("sqrt(-1/9)", "Unproved", "root|negative|may"),
        ("b", "Wrong", "not understood"),
        ("b*2", "Wrong", "not understood"),
        ("sin(a, a)", "Wrong", "characters"),
        ("sin()", "Wrong", "not understood"),
        ("theta(a)", "Wrong", "not understood"),
        ("a % 2", "Wrong", "characters"),
        ("a // 2", "Wrong", "not understood"),
        ("a.real", "Wrong", "not understood"),
        ("0x10", "Wrong", "not understood"),
        ("1_0", "Wrong", "not understood"),
        ("1e9999", "Wrong", "not understood"),
        ("2 +", "Wrong", "not understood"),
        ("", "Wrong", "characters"),
        ("a" * 2001, "Wrong", "characters"),
    ],
)
def test_what_is_no_formula_is_refused_and_what_has_no_value_is_not_proved(check, text, error, why):
    with pytest.raises(getattr(check, error), match=why):
        check.evaluate(check.parse(text), {"a": check.I.of(Fraction(3, 7), P)}, P)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("pi*theta", "22/7*5/4"), ("theta**1", "5/4"), ("(4*theta/5)**32", 1), ("theta^2/theta", "5/4"),
        ("1/theta", "4/5"),
        ("-sqrt(0)", 0), ("sqrt(1/4) - 2*theta", -2), ("sin(0)*theta + cos(0)", 1), ("theta/(3/7)", "35/12"),
    ],
)  # fmt: skip
def test_the_formulas_of_the_tables_of_the_paper_are_read_by_one_file_alone(check, monkeypatch, text, wanted):
    monkeypatch.setattr(check, "beside", None)
    for place in (check.I.of(Fraction(5, 4), P), check.Jet.of(check.I.of(Fraction(5, 4), P), 1, 0)):
        value = check.value(check.evaluate(check.parse(text), {"theta": place}, P)[0])
        true = check.evaluate(check.parse(str(wanted)), {}, P)[0]
        assert abs(check.I.of(value, P).real() - true) < (0.002 if "pi" in text else 1e-20)


def test_two_thousand_characters_are_read(check):
    assert check.evaluate(check.parse("1 + 1".ljust(2000)), {}, P) == (2, 0)


@pytest.mark.parametrize(
    ("pair", "wanted"),
    [(["3", "-2"], Fraction(3, 4)), (["-5", "3"], -40), (["1", "500000"], 2**500000), (["0", "-500000"], 0)],
    ids=["a fraction", "a whole number", "large", "nothing"],
)
def test_a_number_of_a_file_is_a_whole_one_times_a_power_of_2(check, pair, wanted):
    assert check.exact(pair) == wanted


@pytest.mark.parametrize(
    "pair",
    [
        ["1", "500001"],
        ["1", "-500001"],
        ["1" * 130_001, "0"],
        ["1", "0" * 130_001],
        [1, "0"],
        ["1", 0],
        ["1"],
        ["x", "0"],
    ],
    ids=["large", "small", "long", "a long exponent", "a number", "a number as exponent", "one", "a letter"],
)
def test_a_number_of_a_file_of_another_form_or_beyond_all_sizes_is_refused(check, pair):
    with pytest.raises((check.Wrong, ValueError)):
        check.exact(pair)


def test_a_number_of_a_file_may_have_so_many_digits(check):
    assert check.exact(["1" * 130_000, "0"]) > 0


@pytest.mark.parametrize(
    ("name", "table", "low", "high"),
    [
        ("lam", None, 0, 1), ("lam", "egg", 0, 1), ("a", "ellipse", 1, 10**6), ("alpha", "egg", 0, Fraction(1, 2)),
        ("a", None, -(10**6), 10**6), ("alpha", "circle", -(10**6), 10**6), ("phi", None, -(10**6), 10**6),
    ],
)  # fmt: skip
def test_a_letter_is_within_its_range_up_to_both_ends_and_no_further(check, name, table, low, high):
    for x in (low, high, Fraction(low + high) / 2):
        assert check.within(name, check.I.of(x, P), table) is not None
    whole = check.I.of(low, P).hull(check.I.of(high, P))
    assert check.within(name, whole, table) is whole
    for x in (check.I(whole.lo - 1, whole.hi, P), check.I(whole.lo, whole.hi + 1, P)):
        with pytest.raises(check.Wrong, match=f"{name} is out of range"):
            check.within(name, x, table)
