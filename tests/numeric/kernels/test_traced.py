"""A traced function has the same bits as the NumPy function it was traced from."""

import numpy as np
import pytest

from numeric.kernels import machine
from numeric.kernels.traced import WIDTH, Traced, text

SPECIAL = [0.0, -0.0, 1.0, -1.5, np.inf, -np.inf, np.nan, 5e-324, 1e308, 3.0]


def formula(x, y):
    """A formula with every operation that a traced function may have."""
    near, far = np.where(x < y, x, y), np.where((x >= y) & ~np.isnan(x) | (x == 0), 1.0, np.sqrt(np.abs(x)))
    rounded = np.rint(x) + np.floor(y) * 2
    extremes = [np.maximum(x, y), np.minimum(x, y), np.fmax(x, y), np.fmin(x, y)]  # of two zeros NumPy gives either
    signed = np.where(np.isfinite(x), y, 7), np.copysign(x, y)
    plain = x + y, x - y, x * y, x / y, x * y + 1 / x, -x
    return [*plain, near, far, rounded, *signed, *(1 + each for each in extremes)]


@pytest.mark.parametrize("size", [0, 1, WIDTH - 1, WIDTH, 100, 1003])
def test_a_traced_function_has_the_bits_of_numpy_whatever_the_length(size):
    if machine.from_text(text(formula, 2)[0]) is None:
        pytest.fail("there is no compiler: nothing is compared")
    rng = np.random.default_rng(size)
    x, y = rng.choice([*SPECIAL, *rng.normal(size=20)], (2, size))
    with np.errstate(all="ignore"):
        found, expected = Traced(formula)(x, y), formula(x, y)
    for one, other in zip(found, expected, strict=True):
        assert np.array_equal(one, other, equal_nan=True)
        assert np.array_equal(np.signbit(one)[other == 0], np.signbit(other)[other == 0])


def test_a_product_and_a_sum_are_rounded_each_by_itself():
    x = np.array([1 + 2.0**-30])
    assert Traced(lambda x: [x * x - 1])(x)[0][0] == (1 + 2.0**-29) - 1  # a fused product would keep 2**-60


def test_an_operation_without_proved_bits_is_refused():
    with pytest.raises(TypeError, match="sin is no operation of a traced function"):
        Traced(lambda x: [np.sin(x)])(np.arange(3.0))
