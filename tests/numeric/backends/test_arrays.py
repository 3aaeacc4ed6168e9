"""Arrays as an arithmetic: the fused product and its error, and the power of two below a number."""

from fractions import Fraction

import numpy as np
import pytest

from numeric.backends.scalars import ArrayBackend

OPS = ArrayBackend()


@pytest.mark.parametrize("size", [1.0, 1e-9, 1e9])
def test_the_emulated_fused_product_is_rounded_once(size):
    """Where the sum does not cancel: one rounding, up to the rounding of the correction."""
    rng = np.random.default_rng(4)
    x, y, z = rng.normal(size=(3, 400)) * np.array([[1.0], [1.0], [size]])
    z[::2] = -(x * y)[::2] * (1 + 1e-12 * rng.normal(size=200))
    found = OPS.fma(x, y, z).tolist()
    truth = [Fraction(a) * Fraction(b) + Fraction(c) for a, b, c in zip(*(r.tolist() for r in (x, y, z)), strict=True)]

    assert sum(f == float(t) for f, t in zip(found, truth, strict=True)) >= 398
    assert all(abs(Fraction(f) - t) <= 2.0**-52 * abs(t) for f, t in zip(found, truth, strict=True))
    assert OPS.product(3.0, 0.1) == 3.0 * 0.1


def test_what_a_product_loses_is_exact():
    """Also for mantissas of ones, and for those next to where they are split in halves."""
    ends = [2 - 2.0**-52, 1 + 2.0**-52, 1 + 2.0**-26 + 2.0**-52, 1 + 2.0**-27 - 2.0**-52, 2 - 2.0**-26, 4 / 3, 1.1]
    rng = np.random.default_rng(6)
    x = np.concatenate([np.repeat(ends, len(ends)), rng.uniform(1, 2, 2000)])
    y = np.concatenate([np.tile(ends, len(ends)), rng.uniform(1, 2, 2000)])
    lost = OPS.fma(x, y, -x * y).tolist()
    for a, b, c in zip(x.tolist(), y.tolist(), lost, strict=True):
        assert Fraction(a) * Fraction(b) == Fraction(a * b) + Fraction(c)


def test_the_power_of_two_below_a_number():
    x = np.array([1e-300, 0.49, 0.5, 1.0, 1.5, 2.0, 1023.0, 1e300])
    inverse, exponent = OPS.power_of_two(x)

    assert inverse.tolist() == [2.0**-e for e in exponent.tolist()]
    assert np.all((x * inverse >= 1) & (x * inverse < 2))
