"""Enclosures in integers hold the value, against SymPy with 50 digits, and their verdicts are true."""

import random

import pytest
from sympy import Abs, Float, Rational, S, atan, cos, cosh, exp, log, pi, sin, sinh, sqrt, tan, tanh

from symbolic.expressions import enclosures
from symbolic.expressions.enclosures import BITS, sign_on
from symbolic.expressions.signs import Outcome
from symbolic.tables.table import theta

WORDS = {
    "cos": (cos(theta), -40, 40),
    "sin": (sin(theta), -40, 40),
    "sin far away": (sin(theta), 10**6, 10**6 + 9),
    "tan": (tan(theta), -1, 1),
    "exp": (exp(theta), -30, 30),
    "log": (log(theta), Rational(1, 1000), 50),
    "atan": (atan(theta), -50, 50),
    "abs": (Abs(theta), -3, 3),
    "sinh": (sinh(theta), -9, 9),
    "cosh": (cosh(theta), -9, 9),
    "tanh": (tanh(theta), -9, 9),
    "sqrt": (sqrt(theta), 0, 90),
    "inverse": (1 / theta, 1, 90),
    "even power": (theta**4, -3, 3),
    "odd power": (theta**-3, 1, 3),
    "half power": (theta ** Rational(-3, 2), 1, 9),
    "third root": (theta ** Rational(2, 3), 1, 9),
    "constants": (pi * theta + exp(1), -1, 1),
    "nested": (cos(cos(2 * theta) + sin(theta)) / (2 + sin(3 * theta)), -4, 4),
}


def exactly(expression, x):
    """The value with 50 digits, in units of `2**-BITS`."""
    return expression.subs(theta, x).evalf(60) * Float(2, 60) ** BITS


@pytest.mark.parametrize("name", WORDS)
def test_the_enclosure_over_an_interval_holds_every_value_in_it(name):
    expression, low, high = WORDS[name]
    steps, chance = enclosures._steps(expression, theta), random.Random(name)
    for _ in range(40):
        ends = sorted(low + (high - low) * Rational(chance.randrange(10**6 + 1), 10**6) for _ in range(2))
        if chance.random() < 0.6:  # narrow ones, where rounding is all there is
            ends[1] = ends[0] + (ends[1] - ends[0]) / 10 ** chance.choice((3, 9, 20, 40))
        x = ends[0] + (ends[1] - ends[0]) * Rational(chance.randrange(1001), 1000)
        box = enclosures._rational(ends[0])[0], enclosures._rational(ends[1])[1]
        found, value = enclosures._value(steps, box), exactly(expression, x)

        assert found[0] <= value <= found[1], (name, ends, x)


@pytest.mark.parametrize("name", [name for name in WORDS if name not in ("sin far away", "exp", "sinh", "cosh")])
def test_at_a_point_all_but_a_few_bits_are_known(name):
    expression, low, high = WORDS[name]
    x = low + (high - low) * Rational(7, 10)
    found = enclosures._value(enclosures._steps(expression, theta), enclosures._rational(x))

    assert found[1] - found[0] < 1 << 20


@pytest.mark.parametrize(
    ("expression", "outcome"),
    [
        (1 + cos(theta) * Rational(99, 100), Outcome.PROVED),
        (1 + cos(theta), Outcome.UNKNOWN),  # 0 at pi, which is no fraction
        (cos(theta) + Rational(98, 100), Outcome.REFUTED),
        (1 / (theta - 1), Outcome.REFUTED),
        (1 / (theta - 1) ** 2, Outcome.UNKNOWN),  # a pole
        (log(theta), Outcome.UNKNOWN),
        (sqrt(2 + sin(theta)), Outcome.PROVED),
    ],
)
def test_a_sign_is_proved_refuted_or_open(expression, outcome):
    assert sign_on(expression, theta, S(-4), S(4), 20_000).outcome is outcome


def test_a_refutation_is_a_point_where_it_fails():
    expression = 1 + cos(7 * theta) * Rational(101, 100)
    found = sign_on(expression, theta, S(-4), S(4))
    ((_, at),) = found.at

    assert found.outcome is Outcome.REFUTED
    assert expression.subs(theta, at).evalf(30) <= 0


def test_work_is_bounded_and_said():
    found = sign_on(1 + cos(theta), theta, S(-4), S(4), 500)

    assert found.outcome is Outcome.UNKNOWN
    assert "500 operations" in found.reason


def test_a_word_that_is_not_known_is_no_proof():
    with pytest.raises(enclosures.UnboundedError, match="Pow is not known"):
        sign_on(2 + theta**theta, theta, S(1), S(2))
