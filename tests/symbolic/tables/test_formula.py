"""The formula parser: exact, total, and closed to all text that is not a formula."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Abs, Expr, Float, Rational, S, Symbol, atan, cos, exp, log, pi, sin, sqrt, tan

from symbolic.tables.formula import flaw, number, parse
from symbolic.tables.table import theta

numbers = st.fractions(max_denominator=99).map(lambda q: Rational(q.numerator, q.denominator) % 100)
leaves = st.sampled_from([theta, pi, sqrt(2)]) | numbers
functions = st.sampled_from([sqrt, sin, cos, tan, exp, log, atan, Abs])


def compound(parts: st.SearchStrategy[Expr]) -> st.SearchStrategy[Expr]:
    return st.one_of(
        st.builds(lambda x, y: x + y, parts, parts),
        st.builds(lambda x, y: x * y, parts, parts),
        st.builds(lambda x, n: x ** Rational(n, 2), parts, st.integers(-6, 6)),
        st.builds(lambda f, x: f(x), functions, parts),
    )


expressions = st.recursive(leaves, compound, max_leaves=8).filter(lambda value: flaw(value) is None)


def read(text: str) -> tuple[Expr, str]:
    """The expression of `text` and ""; or 0 and the sentence that refuses `text`."""
    try:
        return parse(text), ""
    except ValueError as error:
        return S.Zero, str(error)


@given(expressions)
def test_a_formula_is_read_back_from_its_own_text(expression):
    assert parse(str(expression)) == expression


@pytest.mark.slow
@given(st.text(alphabet="0123456789.eE+-*/^()_ ,thasincoqrpl[]'\"\n\0", max_size=60) | st.text(max_size=2100))
@example("sqrt(3)-sin(1)*(" * 50 + "sqrt(2)" + ")" * 50)  # SymPy needs a day to find the sign of this
@example("sin(atan(" * 29 + "theta" + "))" * 29)  # doubles in size at each level
@example("abs(" * 58 + "theta" + "-theta)" * 58)
@example("+".join(["sqrt(12345678**56+1)"] * 90))
@example("((((9**64)**64)**64)**64)**64")
@example("1/(sin(1)**2 + cos(1)**2 - 1)")
@example("abs(exp(sqrt(theta)))")
@settings(max_examples=300)
def test_any_text_is_a_formula_or_one_sentence(text):
    value, sentence = read(text)
    assert "\n" not in sentence
    assert len(sentence) < 300
    assert flaw(value) is None
    assert not value.has(Float)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.08", Rational(2, 25)),
        ("1e-3", Rational(1, 1000)),
        (".5E1", Rational(5)),
        ("-2^2", Rational(-4)),
        ("2**3**2", Rational(512)),
        ("2^-1", Rational(1, 2)),
        ("6/2/3", Rational(1)),
        ("1 - 2 - 3", Rational(-4)),
        ("--+-3", Rational(-3)),
        ("abs(-sqrt(2))", sqrt(2)),
        ("1 + cos(5*theta)/40", 1 + cos(5 * theta) / 40),
        ("theta^(-3/2)", theta ** Rational(-3, 2)),
        ("tan(theta + pi/2)", -cos(theta) / sin(theta)),
    ],
)
def test_a_formula_means_what_mathematicians_write(text, value):
    assert parse(text) == value


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("__import__('os').system('true')", '"\'" at column 12 is no part of a formula'),
        ("__class__", "'__class__' at column 1 is unknown"),
        ("theta.real", "'.' at column 6 is no part"),
        ("theta[0]", "'[' at column 6 is no part"),
        ("lambda x: x", "':' at column 9 is no part"),
        ("eval(1)", "'eval' at column 1 is unknown"),
        ("theta(2)", "'(' at column 6 is unexpected"),
        ("sin theta", "'theta' at column 5 is unexpected; accepted: sin(...)"),
        ("(1 + 2", "the end at column 7 is unexpected"),
        ("2theta", "'theta' at column 2 is unexpected"),
        ("\u0441os(theta)", "'\\u0441' at column 1 is no part"),  # a Cyrillic letter
        ("\u00bd", "'\\xbd' at column 1 is no part"),
        ("1\0", "'\\x00' at column 2 is no part"),
        ("", "the end at column 1 is unexpected"),
        ("2**theta", "'theta' at column 4 is no accepted exponent"),
        ("9**9**9", "'387420489' at column 4 is no accepted exponent"),
        ("theta**0.03", "'3/100' at column 8 is no accepted exponent"),
        ("(theta**64)**2", "the exponent 128 is not accepted"),
        ("1/(theta - theta)", "'0' at column 3 may not be divided by"),
        ("0**-1", "'0' at column 1 may not be divided by"),
        ("tan(pi/2)", "the value is not finite"),
        ("sqrt(1 - sqrt(2))", "the value is not real"),
        ("exp(exp(exp(10)))", "'exp' at column 1 has too large an argument"),
        ("1e401", "too long a number"),
        ("9" * 401, "too long a number"),
        ("1" * 2001, "2001 characters; at most 2000"),
        ("(" * 100, "nested too deeply; accepted: at most 60 levels"),
    ],
)
def test_what_is_no_formula_is_named_with_its_place(text, complaint):
    with pytest.raises(ValueError, match="accepted") as caught:
        parse(text)

    assert complaint in str(caught.value)


def test_only_the_given_names_are_known():
    x = Symbol("x")

    assert parse("x**2", {"x": x}) == x**2
    with pytest.raises(ValueError, match="'theta' at column 1 is unknown"):
        parse("theta", {"x": x})


@pytest.mark.parametrize(("text", "value"), [("2/25", Rational(2, 25)), ("sqrt(2)", sqrt(2)), ("pi/4", pi / 4)])
def test_a_number_is_exact(text, value):
    assert number(text, "a") == value


@pytest.mark.parametrize("text", ["theta", "sqrt(-1)", "log(-1)", "1/0", "nan", "inf", "0x10", "1_000", "1,5"])
def test_what_is_no_real_number_is_named_with_its_label(text):
    with pytest.raises(ValueError, match=r"^alpha = "):
        number(text, "alpha")
