"""Enclosures in integer arithmetic: correct to the last bit, against SymPy with 60 digits."""

import random
from itertools import product

import pytest
from sympy import Abs, Rational, S, atan, cos, cosh, exp, log, pi, sin, sinh, sqrt, tan, tanh

from symbolic.expressions import enclosures
from symbolic.expressions.enclosures import sign_on
from symbolic.expressions.signs import Outcome
from symbolic.tables.table import theta

HAIR = Rational(1, 10**40)
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


def places(name):
    """Random binary fractions in the range of a word."""
    _, low, high = WORDS[name]
    chance = random.Random(name)
    return [low + (high - low) * Rational(chance.randrange(1, 2**20), 2**20) for _ in range(12)]


def exactly(expression, x):
    """The value at `x` with 75 digits, as a fraction."""
    return Rational(str(expression.subs(theta, x).evalf(75)))


@pytest.mark.parametrize("name", WORDS)
def test_what_is_positive_by_a_hair_at_the_end_of_an_interval_is_not_refuted_there(name):
    """Enclosures are multiples of `2**-96`: a bound rounded inwards would refute a tiny positive value."""
    expression = WORDS[name][0]
    for x in places(name):
        value = exactly(expression, x)
        for positive in (expression - value + HAIR, value - expression + HAIR):
            assert (theta, x) not in sign_on(positive, theta, x, x + Rational(1, 8), 100).at, x


@pytest.mark.parametrize("name", WORDS)
def test_a_bound_that_one_value_in_the_interval_breaks_is_never_proved(name):
    """The word of `x + theta**2` or `x - theta**2` has its extremum at 0, while the bound holds at both ends."""
    expression = WORDS[name][0]
    for x in places(name)[:3]:
        value = exactly(expression, x)
        for width, way in product((Rational(1, 16), Rational(1, 2**20)), (1, -1)):
            word = expression.subs(theta, x + way * theta**2)
            for negative in (word - value - HAIR, value - word - HAIR):
                assert sign_on(negative, theta, -width, 2 * width, 500).outcome is not Outcome.PROVED, (x, width)


@pytest.mark.parametrize("name", [name for name in WORDS if name not in ("sin far away", "exp", "sinh", "cosh")])
def test_a_bound_with_a_little_room_is_proved_in_a_short_interval(name):
    expression, low, high = WORDS[name]
    x = low + (high - low) * Rational(7, 10)
    below = exactly(expression, x) - Rational(1, 10**9)

    assert sign_on(expression - below, theta, x, x + Rational(1, 10**12), 2000).outcome is Outcome.PROVED


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
    with pytest.raises(enclosures.UnboundedError, match="for the function Pow"):
        sign_on(2 + theta**theta, theta, S(1), S(2))
