"""Balls in arrays against rational numbers: they contain all true values, and are as narrow as their proofs say."""

from fractions import Fraction
from itertools import product
from operator import add, mul, sub, truediv

import numpy as np
import pytest
from flint import arb

from verification.arithmetic.arrays import (
    EXPONENTIAL_ERROR,
    LARGEST,
    TINY,
    UNIT_ERROR,
    ArrayOps,
    BallArray,
    exactly,
    hull,
    turned,
)
from verification.arithmetic.balls import working

MIDDLES = [0.0, 1.0, -3.0, 1e-200, 1 + 2.0**-52]
RADII = [0.0, 1.0, 2.0**-53]
HAIR = Fraction(1, 2**44)  # what sixteen roundings of a radius may add, sixteen times
UNIT = Fraction(1, 2**52)


def every(*lists):
    """All combinations of one entry from each list, as columns of an array."""
    return np.array(list(product(*lists))).T


@pytest.mark.parametrize("operation", [add, sub, mul, truediv])
def test_each_operation_holds_the_corners_exactly_and_reaches_hardly_beyond(operation):
    """Extremes of a sum, difference, product or quotient lie at corners, which fill nearly all of the radius."""
    a, ra, b, rb = every(MIDDLES, RADII, MIDDLES, RADII)
    found = operation(BallArray(a, ra), BallArray(b, rb))
    for m, r, *ends in zip(*(x.tolist() for x in (found.m, found.r, a, ra, b, rb)), strict=True):
        x, dx, y, dy = map(Fraction, ends)
        if operation is truediv and abs(y) <= dy:
            assert r == np.inf
            continue
        corners = [operation(x + i * dx, y + j * dy) for i, j in product((-1, 1), repeat=2)]
        assert abs(Fraction(m) - operation(x, y)) <= abs(Fraction(m)) * UNIT / 2 + Fraction(5e-324)
        assert all(abs(corner - Fraction(m)) <= Fraction(r) for corner in corners)
        needed = max(abs(corner - operation(x, y)) for corner in corners)
        spare = 2 * Fraction(TINY) * (1 if operation is not truediv else 1 + (1 + dy) / (abs(y) - dy))
        assert Fraction(r) <= (needed + abs(Fraction(m)) * UNIT) * (1 + HAIR) + spare


def test_ends_and_magnitudes_are_beyond_the_ball_and_hardly_so():
    m, r = every([*MIDDLES, 1 / 3, -1e-200, -1e9], [*RADII, 1e-200])
    x = BallArray(m, r)
    rows = zip(*(row.tolist() for row in (m, r, x.lower(), x.upper(), x.magnitude())), strict=True)
    for middle, radius, low, high, size in ((*map(Fraction, row),) for row in rows):
        room = (abs(middle) + radius) * 3 * UNIT + 2 * Fraction(TINY)
        assert middle - radius - room <= low <= middle - radius
        assert middle + radius <= high <= middle + radius + room
        assert abs(middle) + radius <= size <= (abs(middle) + radius) * (1 + HAIR)


@pytest.mark.parametrize("p", [-10, -1, 0, 1, 3, 10**20 + 1])
def test_a_rational_is_exact_where_a_double_is_and_else_as_near_as_one(p):
    for q in (1, 2, 3, 7, 10**17):
        found, true = exactly(Fraction(p, q)), Fraction(p, q)
        assert abs(Fraction(found.m) - true) <= Fraction(found.r) <= abs(true) * UNIT * (1 + HAIR)
        assert (found.r == 0) is (Fraction(found.m) == true)
    with working(100):
        assert abs(arb.pi() - ArrayOps().pi.m) < ArrayOps().pi.r < 1e-15
    assert ArrayOps().q(1, 4).m == 0.25


def test_a_hull_holds_both_ends_exactly_also_where_its_middle_is_rounded():
    steps = [0.0, 1.0, 1 + 2.0**-52, 1 + 2.0**-51, 3.0, 1e-200]
    low, high = np.array([(a, b) for a, b in product([-3.0, -1.0, *steps], steps) if a <= b]).T
    found = hull(low, high)
    for m, r, a, b in ((*map(Fraction, row),) for row in zip(found.m, found.r, low, high, strict=True)):
        assert m - r <= a <= b <= m + r
        assert r <= max(b - m, m - a) * (1 + HAIR) + 2 * Fraction(TINY)
        assert abs(m - (a + b) / 2) <= max(abs(a), abs(b)) * UNIT


AT = np.array([0.0, 0.3, -0.34, 0.35, 1.0, -1.5, 7.7, -20.0, 63.9, -63.9])


def test_the_exponential_is_as_wide_as_the_count_of_its_errors():
    """The width relative to `r + r**2 >= exp(r) - 1`, plus the error of a double times `1 + r`."""
    m, r = every(AT, [0.0, 2.0**-60, 2.0**-10, 0.5, 1.0])
    found = ArrayOps().exp(BallArray(m, r))
    with working(200):
        for value, radius, x, s in zip(*(row.tolist() for row in (found.m, found.r, m, r)), strict=True):
            size = Fraction(s)
            counted = Fraction(value) * (size * (1 + size) + Fraction(EXPONENTIAL_ERROR) * (1 + size) ** 2)
            assert counted <= Fraction(radius) <= counted * (1 + HAIR)
            assert abs((arb(x)).exp() - value) < arb(value) * EXPONENTIAL_ERROR / 2
            for end in (-1, 1):
                assert abs((arb(x) + end * arb(s)).exp() - value) <= radius
    outside = BallArray(np.array([64.0, -64.0, 0.0, np.nan, 1e300]), np.array([0.0, 0.0, 1 + 2.0**-52, 0.0, 0.0]))
    assert not np.isfinite(ArrayOps().exp(outside).r).any()


def test_sines_and_cosines_are_as_wide_as_their_argument_and_one_error():
    m, r = every(AT, [0.0, 2.0**-60, 0.5, 1.0])
    for found, way in zip(turned(BallArray(m, r)), (arb.cos, arb.sin), strict=True):
        with working(200):
            for value, radius, x, s in zip(*(row.tolist() for row in (found.m, found.r, m, r)), strict=True):
                assert Fraction(s) + Fraction(UNIT_ERROR) <= Fraction(radius)
                assert Fraction(radius) <= (Fraction(s) + Fraction(UNIT_ERROR)) * (1 + HAIR)
                assert abs(way(arb(x)) - value) < UNIT_ERROR / 4
    for word, value in (("cos", np.cos(AT)), ("sin", np.sin(AT))):
        assert np.allclose(getattr(ArrayOps(), word)(BallArray(AT)).m, value, rtol=0, atol=1e-15)
    for found in turned(BallArray(np.array([LARGEST, -LARGEST, np.inf, np.nan]))):
        assert not np.isfinite(found.r).any()
    for found in turned(BallArray(np.array([np.nextafter(LARGEST, 0.0)]))):
        assert np.isfinite(found.r).all()


def test_small_sines_and_cosines_are_right_to_their_last_digits():
    """At doubles near multiples of a quarter turn, whose remainder takes three doubles to represent."""
    k = np.arange(-40, 41)
    c, s = turned(BallArray(k * (np.pi / 2)))
    with working(300):
        for x, cosine, sine in zip((k * (np.pi / 2)).tolist(), c.m.tolist(), s.m.tolist(), strict=True):
            assert abs(arb(x).cos() - cosine) <= abs(arb(x).cos()) * 2.0**-49
            assert abs(arb(x).sin() - sine) <= abs(arb(x).sin()) * 2.0**-49


def test_a_square_root_holds_the_ends_and_is_at_most_twice_as_wide():
    m, r = every([1.0, 2.0, 3.0, 1e-10, 1e10], [0.0, 2.0**-30, 0.3, 0.999])
    r = r * m
    found = ArrayOps().sqrt(BallArray(m, r))
    with working(200):
        for value, radius, x, s in zip(*(row.tolist() for row in (found.m, found.r, m, r)), strict=True):
            ends = [(arb(x) + end * arb(s)).sqrt() for end in (-1, 1)]
            assert all(abs(end - value) <= radius for end in ends)
            assert radius <= arb(s) / arb(x).sqrt() * (1 + 1e-12) + value * 2.0**-51 + 1e-299
    touching = BallArray(np.array([1.0, 0.0]), np.array([1.0, 0.0]))
    assert not np.isfinite(ArrayOps().sqrt(touching).r).any()
