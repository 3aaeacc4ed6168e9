"""Numbers of any precision as an arithmetic: mpmath's own functions, and zeros to the last digit."""

from types import SimpleNamespace

import mpmath
import pytest
from sympy import Symbol, cos, pi, sin, sqrt

from numeric.backends.functions import value_and_slope
from numeric.backends.scalars import ArrayBackend, ScalarBackend
from symbolic.expressions.text import kernel, load

MP = mpmath.MPContext()
MP.dps = 50
OPS = ScalarBackend(MP)


def test_words_are_the_contexts_own():
    third = OPS.q(1, 3)

    assert abs(3 * third - 1) <= MP.eps
    assert OPS.q(7, 1) == 7
    assert OPS.number(0.1) == MP.mpf(0.1)
    assert (OPS.pi, OPS.pi_low) == (+MP.pi, 0)
    assert (OPS.sqrt(third), OPS.sin(third), OPS.cos(third)) == (MP.sqrt(third), MP.sin(third), MP.cos(third))
    assert OPS.turn(third) == (MP.cos(third), MP.sin(third))
    assert OPS.angle(third, MP.mpf(2)) == MP.atan2(third, 2)
    assert (OPS.fma(2, 3, 4), OPS.product(2, 3), OPS.maximum(2, 3)) == (10, 6, 3)
    assert OPS.power_of_two(MP.mpf(8)) == (1, 0)


def test_signs_and_masks():
    assert [OPS.with_sign(x, y) for x, y in ((2, -1), (-2, -1), (2, 1), (-2, 1), (-2, 0))] == [-2, -2, 2, 2, 2]
    assert [OPS.times_sign(x, y) for x, y in ((2, -1), (-2, -1), (2, 1), (-2, 0))] == [-2, 2, 2, -2]
    assert (OPS.select(True, 1, 2), OPS.select(False, 1, 2)) == (1, 2)
    assert (OPS.negated(True), OPS.negated(False)) == (False, True)
    assert OPS.when(True, [1], lambda: [2]) == [2]
    assert OPS.when(False, [1], lambda: [2]) == [1]
    assert OPS.repeat(lambda state: state[0] < 5, lambda state: [state[0] + 2], [0], 1) == [6]


@pytest.mark.parametrize(
    ("p", "start", "low", "high", "zero"),
    [
        ([-2, 0, 1], 1.4, 0, 9, MP.sqrt(2)),
        ([-2, 0, 1], -1.4, 0, 9, MP.sqrt(2)),
        ([-2, 0, 1], 9, 0, 9, MP.sqrt(2)),
        ([2, -2, 0, 1], 0, -4, 4, MP.findroot(lambda x: x**3 - 2 * x + 2, -1.77)),
        ([-1, 0, 0, 1], 0, -10, 10, MP.mpf(1)),
        ([0, 1], 3, -4, 4, MP.mpf(0)),
        ([-1, 2], 0.5, 0, 2, MP.mpf(1) / 2),
    ],
)
def test_zeros_are_found_to_the_last_digit(p, start, low, high, zero):
    asked = []

    def function(x):
        asked.append(x)
        return value_and_slope(p, x)

    x = OPS.zero(function, MP.mpf(start), MP.mpf(low), MP.mpf(high), MP.mpf(1), 1)

    assert abs(x - zero) <= 2 * MP.eps * max(1, abs(zero))
    assert len(asked) <= 10 + MP.prec  # a last step that is nothing ends in a bisection of what is left
    assert OPS.polynomial_zero(p, MP.mpf(start), lambda: MP.mpf(low), MP.mpf(high), MP.mpf(1), (1, 1)) == x


def test_a_multiple_zero_is_found_by_halving():
    asked = []

    def cube(x):
        asked.append(x)
        return (x - 1) ** 3, 3 * (x - 1) ** 2

    x = OPS.zero(cube, MP.mpf(7), MP.mpf(-5), MP.mpf(8), MP.mpf(1), 1)

    assert abs(x - 1) <= 20 * MP.eps
    assert len(asked) <= 2 * MP.prec + 20


def test_a_zero_that_nobody_wants_is_not_looked_for():
    assert OPS.zero(None, 7, 0, 9, 1, 1, wanted=False) == 7
    assert OPS.zero(lambda x: (x - 2, 1), MP.mpf(7), MP.mpf(0), MP.mpf(9), 1, 1, wanted=True) == 2


def test_where_no_zero_settles_it_is_said():
    """A jump at 0 has no relative digits."""
    with pytest.raises(ArithmeticError, match=r"no zero found in \[.*\] to 50 digits"):
        OPS.zero(lambda x: (1 if x > 0 else -1, 0), MP.mpf(1), MP.mpf(-1), MP.mpf(2), MP.mpf(0), 1)


def scripted(values, low, high, start):
    """The points at which a function of slope one is asked that has these values, one after the other, then 0."""
    left, asked = iter([*values, 0]), []

    def function(x):
        asked.append(float(x))
        return MP.mpf(next(left)), MP.mpf(1)

    OPS.zero(function, MP.mpf(start), MP.mpf(low), MP.mpf(high), MP.mpf(1), 1)
    return asked


def test_only_a_start_within_the_bracket_is_taken():
    assert [scripted([], 1, 5, start) for start in (2, 3.5)] == [[2], [3.5]]
    assert [scripted([], 1, 5, start) for start in (0, 1, 5, 9)] == [[3]] * 4


def test_a_step_is_taken_within_the_bracket_when_it_is_half_the_last_one_at_most():
    assert scripted([1.5], 1, 5, 4) == [4, 2.5]  # less than half the bracket, 4
    assert scripted([2.5], 1, 5, 4) == [4, 2.5]  # more: the middle of 1 and 4, and so is
    assert scripted([2], 1, 5, 4) == [4, 2]  # exactly half
    assert scripted([-2], 1, 5, 3) == [3, 4]  # an end
    assert scripted([1, 0.5], 1, 5, 4) == [4, 3, 2.5]
    assert scripted([1, 0.75], 1, 5, 4) == [4, 3, 2]
    assert scripted([1, -0.75], 1, 5, 4) == [4, 3, 3.5]


@pytest.mark.parametrize(("ops", "eps"), [(OPS, MP.eps), (ArrayBackend(), 2.0**-52)], ids=["fifty digits", "arrays"])
def test_generated_text_runs_on_a_backend_as_on_words(ops, eps):
    """One protocol for programs and for text: what is a number system to the one is one to the other."""
    x = Symbol("x")
    made = kernel("swung", [x], {"swung": sqrt(x) / 3 + pi * sin(x) * cos(x)})
    value = load(made, ops)(ops.number(2.0))[0]

    assert abs(value - (MP.sqrt(2) / 3 + MP.pi * MP.sin(2) * MP.cos(2))) <= 4 * eps
    with pytest.raises(ValueError, match="has no cos, sin; it has q, pi"):
        load(kernel("wave", [x], {"wave": sin(x) * cos(x)}), SimpleNamespace(q=None, pi=None))
