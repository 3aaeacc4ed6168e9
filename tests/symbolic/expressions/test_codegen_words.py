"""One expression in words, as a careful hand would write it: few signs and parentheses, and nothing twice."""

import pytest
from sympy import Add, Float, Mul, Rational, S, cos, cosh, exp, pi, sin, sinh, sqrt, symbols, tan, tanh

from symbolic.expressions.text import Words, checked

x, y = symbols("x y", real=True)

WRITTEN = [
    (x, "x"), (-x, "-x"), (S(3), "3"), (S(-3), "-3"), (Rational(1, 3), "q(1, 3)"), (Rational(-2, 3), "-q(2, 3)"),
    (x - y, "x - y"), (y - x, "y - x"), (-x - y, "-x - y"), (x + y + 1, "x + y + 1"),
    (3 * x * y, "3*x*y"), (-2 * x, "-2*x"), (x / 3, "q(1, 3)*x"), (-2 * x / (3 * y), "-q(2, 3)*x/y"),
    (1 / x, "1/x"), (-1 / x, "-1/x"), (1 / (x * y), "1/(x*y)"), ((x + 1) / (y + 2), "(x + 1)/(y + 2)"),
    ((x + 1) * (y - 2), "(x + 1)*(y - 2)"), (x * (1 - y * (x + 1)), "x*(1 - y*(x + 1))"),
    (sqrt(x), "sqrt(x)"), (x ** Rational(3, 2), "x*sqrt(x)"), (1 / sqrt(x), "1/sqrt(x)"),
    (sqrt(2) / 2, "q(1, 2)*sqrt(2)"), (x ** Rational(1, 3), "root(x, 3)"), (x ** Rational(-4, 3), "1/(x*root(x, 3))"),
    (sinh(x) - cosh(x), "sinh(x) - cosh(x)"), (tanh(x / 2), "tanh(q(1, 2)*x)"),
    (S.Exp1, "exp(1)"), (exp(x) / y, "exp(x)/y"), (tan(x), "sin(x)/cos(x)"), (sin(x) * cos(y) + 1, "sin(x)*cos(y) + 1"),
    (1 / (sin(x) * cos(x)), "1/(sin(x)*cos(x))"), (1 / sin(x + y), "1/sin(x + y)"), (x / (sin(x) + 1) + pi,
    "x/(sin(x) + 1) + pi"), (x**2, "x*x"), (x**3, "x*x*x"), (x**-2, "1/(x*x)"), (x**2 * y, "x*x*y"), (-(x**2), "-x*x"),
    (-tan(x), "-sin(x)/cos(x)"), (2 * tan(x), "2*(sin(x)/cos(x))"), (y * tan(x), "y*(sin(x)/cos(x))"),
    (tan(x) / y, "(sin(x)/cos(x))/y"), (y / tan(x), "y/(sin(x)/cos(x))"),
    (Mul(-1, x + y, evaluate=False), "-(x + y)"), (Mul(x, Mul(-1, y, evaluate=False), evaluate=False), "x*(-y)"),
    (Mul(x, S(-2), evaluate=False), "(-2)*x"), (Add(x, S(-2), evaluate=False), "x - 2"),
    (sqrt(-2 * x), "sqrt(2)*sqrt(-x)"), (x * exp(-y / 3) - Rational(1, 2), "x*exp(-q(1, 3)*y) - q(1, 2)"),
    (Mul(x, S.Zero, evaluate=False), "0*x"), (Mul(x, Rational(-2, 3), y, evaluate=False), "(-q(2, 3))*x*y"),
    (Mul(x, S(-1), evaluate=False), "(-1)*x"), (pi * x, "pi*x"), (1 / (y * tan(x)), "1/(y*(sin(x)/cos(x)))"),
]  # fmt: skip
KEPT = [
    (x**4, [("c0", "x*x")], "c0*c0"),
    (x**5, [("c0", "x*x")], "c0*c0*x"),
    (x**7, [("c0", "x*x*x")], "c0*c0*x"),
    (x**9, [("c0", "x*x"), ("c1", "c0*c0")], "c1*c1*x"),
    ((x + y) ** 4, [("c0", "x + y"), ("c1", "c0*c0")], "c1*c1"),
    ((x + y) ** Rational(3, 2), [("c0", "x + y")], "c0*sqrt(c0)"),
    (x ** Rational(5, 3), [("c0", "root(x, 3)")], "x*c0*c0"),
    ((x + y) ** -2, [("c0", "x + y")], "1/(c0*c0)"),
]


@pytest.mark.parametrize(("expression", "text"), WRITTEN, ids=[text for _, text in WRITTEN])
def test_an_expression_is_written_as_a_hand_would(expression, text):
    before, terms = Words(set()).assignment(expression)

    assert before == []
    assert " ".join(terms) == text


@pytest.mark.parametrize(("expression", "kept", "text"), KEPT, ids=[text for _, _, text in KEPT])
def test_a_power_is_made_by_squaring_and_a_base_is_written_once(expression, kept, text):
    before, terms = Words(set()).assignment(expression)

    assert before == kept
    assert " ".join(terms) == text


def test_names_that_are_taken_are_not_given_and_words_are_counted():
    words = Words({"c0", "c2"})
    before, _ = words.assignment((x + y) ** 2 + sqrt(x) * pi / 3)
    again, terms = words.assignment((x + y) ** 3)

    assert before == [("c1", "x + y")]
    assert (again, terms) == ([], ["c1*c1*c1"])
    assert words.used == {"q", "pi", "sqrt"}
    assert words.rename(x) == "c3"
    assert words.assignment(x + 1)[1] == ["c3", "+ 1"]


@pytest.mark.parametrize(("given", "exact"), [("0.001", (1, 1000)), ("0.000999000999", (1, 1000)), ("0.125", (1, 8))])
def test_a_float_is_told_the_nearest_fraction_of_at_most_three_digits(given, exact):
    with pytest.raises(ValueError, match=r"write it exactly, as Rational\({}, {}\)$".format(*exact)):
        checked("x", x * Float(given), {x})
