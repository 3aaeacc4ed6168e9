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


def test_where_no_zero_settles_it_is_said():
    """A jump at 0 has no relative digits."""
    with pytest.raises(ArithmeticError, match=r"no zero found in \[.*\] to 50 digits"):
        OPS.zero(lambda x: (1 if x > 0 else -1, 0), MP.mpf(1), MP.mpf(-1), MP.mpf(2), MP.mpf(0), 1)


@pytest.mark.parametrize(("ops", "eps"), [(OPS, MP.eps), (ArrayBackend(), 2.0**-52)], ids=["fifty digits", "arrays"])
def test_generated_text_runs_on_a_backend_as_on_words(ops, eps):
    """Programs and generated text use the same protocol of number systems."""
    x = Symbol("x")
    made = kernel("swung", [x], {"swung": sqrt(x) / 3 + pi * sin(x) * cos(x)})
    value = load(made, ops)(ops.number(2.0))[0]

    assert abs(value - (MP.sqrt(2) / 3 + MP.pi * MP.sin(2) * MP.cos(2))) <= 4 * eps
    with pytest.raises(ValueError, match="has no cos, sin; it has q, pi"):
        load(kernel("wave", [x], {"wave": sin(x) * cos(x)}), SimpleNamespace(q=None, pi=None))
