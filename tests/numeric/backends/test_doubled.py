"""Numbers that are sums of two doubles: ten bits more than doubles in every word."""

import mpmath
import numpy as np
import pytest

from numeric.backends.doubled import OTHERS, UNIT, WORDS, Double, Doubles
from numeric.backends.scalars import ArrayBackend
from numeric.lowering.program import VOCABULARY

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
    """The errors of a word, and the moduli of the exact values and of what went in."""
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


def test_every_word_of_programs_has_its_cost():
    assert WORDS.keys() | OTHERS.keys() == VOCABULARY
    assert OTHERS.keys() == POINTS.keys()
