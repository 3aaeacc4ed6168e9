"""Plane arithmetic against exact rationals: where a function promises digits, they are counted."""

from fractions import Fraction

import numpy as np
import pytest

from numeric.backends import functions as plane
from numeric.backends.scalars import ArrayBackend

EPS = 2.0**-52
OPS = ArrayBackend()
Z, W = (Fraction(2), Fraction(3)), (Fraction(5), Fraction(-7))


def pairs(count=300, seed=3):
    """Pairs of vectors that are nearly parallel."""
    rng = np.random.default_rng(seed)
    z = rng.normal(size=(2, count))
    return z, z * (1 + 1e-15 * rng.normal(size=(2, count)))


def exactly(x, y):
    """The cross product of columns, with nothing rounded."""
    columns = (map(Fraction, row.tolist()) for row in (*x, *y))
    return [a * d - b * c for a, b, c, d in zip(*columns, strict=True)]


def test_products_are_those_of_complex_numbers():
    assert plane.times(Z, W) == (31, 1)
    assert plane.squared(Z) == plane.times(Z, Z) == (-5, 12)
    assert plane.times(W, plane.conjugate(W)) == (74, 0)
    assert (plane.dot(Z, W), plane.cross(Z, W)) == (-11, -29)


def test_a_scalar_product_that_almost_vanishes_keeps_its_digits():
    z, w = pairs()
    turned = np.array([-w[1], w[0]])
    truth = exactly(z, w)
    found = plane.exact_dot(OPS, tuple(turned), tuple(-z)), plane.exact_cross(OPS, tuple(z), tuple(w))

    for row in found:
        assert all(abs(Fraction(x) - t) <= 2 * EPS * abs(t) for x, t in zip(row.tolist(), truth, strict=True))


def test_a_product_and_its_rest_lose_nothing():
    x, y = pairs()
    product, rest = plane.product_and_error(OPS, x[0], y[1])
    for p, r, a, b in zip(*(row.tolist() for row in (product, rest, x[0], y[1])), strict=True):
        assert p == a * b
        assert Fraction(p) + Fraction(r) == Fraction(a) * Fraction(b)


@pytest.mark.parametrize("order", [1, -1])
def test_a_cross_product_and_its_rest_have_twice_the_digits(order):
    z, w = pairs(seed=5)[::order]
    w = np.where(np.arange(w.shape[1]) % 2 == 0, w, w[::-1])  # half of them as large as their terms
    found, rest = plane.cross_and_error(OPS, tuple(z), tuple(w))
    terms = np.abs(z[0] * w[1]) + np.abs(z[1] * w[0])
    for f, r, t, size in zip(found.tolist(), rest.tolist(), exactly(z, w), terms.tolist(), strict=True):
        assert abs(Fraction(f) - t) <= EPS * size
        assert abs(Fraction(f) + Fraction(r) - t) <= 2 * EPS**2 * size


def test_a_unit_number_is_one_again_up_to_the_square_of_what_it_was_off():
    x, y = plane.unit(OPS, (0.6 * (1 + 1e-6), 0.8 * (1 + 1e-6)))

    assert 1.4e-12 < 1 - np.hypot(x, y) < 1.6e-12  # 3/2 of the square
    assert abs(x * 0.8 - y * 0.6) <= EPS


def test_a_vector_of_any_length_is_normalised():
    x, y = plane.normalised(OPS, (np.array([3e5, -3e-5]), np.array([4e5, 4e-5])))

    assert np.max(np.abs(x - [0.6, -0.6])) <= EPS / 2
    assert np.max(np.abs(y - 0.8)) <= EPS / 2
