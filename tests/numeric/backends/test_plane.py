"""Plane arithmetic against exact rational numbers, with the digits that functions promise."""

from fractions import Fraction

import numpy as np
import pytest

from numeric.backends import functions as plane
from numeric.backends.scalars import ArrayBackend

EPS = 2.0**-52
OPS = ArrayBackend()


def pairs(count=300, seed=3):
    """Pairs of vectors that are nearly parallel."""
    rng = np.random.default_rng(seed)
    z = rng.normal(size=(2, count))
    return z, z * (1 + 1e-15 * rng.normal(size=(2, count)))


def exactly(x, y):
    """The cross product of columns, without rounding."""
    columns = (map(Fraction, row.tolist()) for row in (*x, *y))
    return [a * d - b * c for a, b, c, d in zip(*columns, strict=True)]


def test_a_scalar_product_that_almost_vanishes_keeps_its_digits():
    z, w = pairs()
    turned = np.array([-w[1], w[0]])
    truth = exactly(z, w)
    found = plane.exact_dot(OPS, tuple(turned), tuple(-z)), plane.exact_cross(OPS, tuple(z), tuple(w))

    for row in found:
        assert all(abs(Fraction(x) - t) <= 2 * EPS * abs(t) for x, t in zip(row.tolist(), truth, strict=True))


@pytest.mark.parametrize("order", [1, -1])
def test_a_cross_product_and_its_rest_have_twice_the_digits(order):
    z, w = pairs(seed=5)[::order]
    w = np.where(np.arange(w.shape[1]) % 2 == 0, w, w[::-1])  # half of them as large as their terms
    found, rest = plane.cross_and_error(OPS, tuple(z), tuple(w))
    terms = np.abs(z[0] * w[1]) + np.abs(z[1] * w[0])
    for f, r, t, size in zip(found.tolist(), rest.tolist(), exactly(z, w), terms.tolist(), strict=True):
        assert abs(Fraction(f) - t) <= EPS * size
        assert abs(Fraction(f) + Fraction(r) - t) <= 2 * EPS**2 * size
