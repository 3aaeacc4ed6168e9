"""Numbers that are sums of two doubles: ten bits more than doubles in every word."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from numeric.backends.doubled import UNIT, Double, Doubles, Sum
from numeric.backends.scalars import ArrayBackend

MP = mpmath.MPContext()
MP.dps = 60
OPS = ArrayBackend()
NEAR = np.geomspace(1e-100, 1, 30)  # to 0, or to 1
EITHER = np.concatenate([NEAR, -NEAR, np.linspace(-5, 5, 301)])
FAR = np.concatenate([EITHER, np.linspace(-300, 300, 61)])
QUARTERS = np.concatenate([np.arange(1, 40) * np.pi / 2, np.arange(1, 40) * np.pi / 4])
ANGLES = np.concatenate([EITHER, QUARTERS, np.linspace(-1e9, 1e9, 61)])
ABOVE = np.concatenate([NEAR, 1 + NEAR, 1 - NEAR[:-1], np.geomspace(1e-200, 1e200, 61), np.linspace(0.1, 5, 300)])
POINTS = dict.fromkeys(("exp", "sinh", "cosh", "tanh"), FAR) | {
    "sin": ANGLES,
    "cos": ANGLES,
    "log": ABOVE,
    "atan": np.concatenate([EITHER, np.geomspace(1e-80, 1e80, 61)]),
}


def doubled(x):
    """Numbers whose second halves are not 0."""
    return Double(OPS, x, x * 2.0**-54 * np.random.default_rng(1).uniform(-1, 1, x.size))


def off(word, x, *args):
    """The errors of a function, and the moduli of the exact values and of the arguments."""
    given = doubled(x)
    with np.errstate(over="ignore"):  # of what is not selected
        found = getattr(Doubles(OPS), word)(given, *args)
    for parts in zip(given.high, given.low, found.high, found.low, strict=True):
        high, low, first, second = (MP.mpf(float(part)) for part in parts)
        truth = getattr(MP, word)(high + low, *args)
        yield abs(first + second - truth), abs(truth), abs(high)


@pytest.mark.parametrize("word", list(POINTS))
def test_a_word_has_ten_bits_more_than_a_double(word):
    for error, value, size in off(word, POINTS[word]):
        assert error <= UNIT * value + MP.mpf(2) ** -104 * size


@pytest.mark.parametrize("n", [3, 7, 12])
def test_a_root_has_twice_the_digits(n):
    for error, value, _ in off("root", np.concatenate([np.linspace(0.1, 5, 100), np.geomspace(1e-200, 1e200, 61)]), n):
        assert error <= MP.mpf(2) ** -100 * value


@pytest.mark.parametrize("size", [2.0**-20, 1.0, 2.0**20])
def test_a_sum_above_a_large_number_is_right_to_its_small_share_of_the_size(size):
    """Numbers and products that cancel to a millionth, as in the residual of a landing."""
    random = np.random.default_rng(7)
    x, u, z = size * random.uniform(-1, 1, 50), random.uniform(-1, 1, 50), doubled(size * random.uniform(-1, 1, 50))
    rest = -(x * u + z.high) * (1 + 1e-6)
    found = Sum(OPS, size)
    found.add_product(x, u)
    found.add(z)
    found.add(Double(OPS, rest, 0 * rest))
    value = found.value()
    for high, low, *terms in zip(value.high, value.low, x, u, z.high, z.low, rest, strict=True):
        a, b, c, d, e = map(Fraction, terms)

        assert abs(Fraction(high) + Fraction(low) - (a * b + c + d + e)) <= Fraction(size) / 2**85
