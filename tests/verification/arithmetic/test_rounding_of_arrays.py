"""Balls in arrays, in rational numbers: no rounding loses an end of a ball, and none is wider than its proof says."""

from fractions import Fraction
from itertools import product
from operator import add, mul, sub, truediv

import numpy as np
import pytest
from flint import arb

from numeric.backends import elementary
from verification.arithmetic import arrays
from verification.arithmetic.arrays import (
    EXPONENTIAL_ERROR,
    LARGEST,
    TINY,
    UNIT_ERROR,
    ArrayOps,
    BallArray,
    Compiled,
    ball,
    common_part,
    direction,
    exactly,
    hull,
    spread,
    turned,
)
from verification.arithmetic.balls import working

MIDDLES = [0.0, 1.0, -3.0, 1e-200, 1 + 2.0**-52]
RADII = [0.0, 1.0, 2.0**-53]
HAIR = Fraction(1, 2**44)  # what sixteen roundings of a radius may add, sixteen times
UNIT = Fraction(1, 2**52)


def every(*lists):
    """All ways to take one of each, as arrays."""
    return np.array(list(product(*lists))).T


@pytest.mark.parametrize("operation", [add, sub, mul, truediv])
def test_each_operation_holds_the_corners_exactly_and_reaches_hardly_beyond(operation):
    """The extremes of a sum, difference, product or quotient are at corners: all its radius but a hair."""
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


def test_a_number_beside_a_ball_is_a_ball_of_radius_0():
    x = BallArray(np.array([0.5, 2.0]), np.array([0.25, 0.5]))
    for one, other in ((3 - x, ball(3.0) - x), (3 + x, x + 3), (3 * x, x * 3), (3 / x, ball(3.0) / x)):
        assert np.array_equal(one.m, other.m)
        assert np.allclose(one.r, other.r, rtol=1e-14)
    assert (3 - x).m.tolist() == [2.5, 1.0]
    assert (3 / x).m.tolist() == [6.0, 1.5]
    assert (-x).m.tolist() == [-0.5, -2.0]
    assert (-x).r.tolist() == [0.25, 0.5]
    assert ball(x) is x
    assert ball(2.0).r == BallArray(2.0).r == 0


def test_ends_and_magnitudes_are_beyond_the_ball_and_hardly_so():
    m, r = every([*MIDDLES, 1 / 3, -1e-200, -1e9], [*RADII, 1e-200])
    x = BallArray(m, r)
    rows = zip(*(row.tolist() for row in (m, r, x.lower(), x.upper(), x.magnitude())), strict=True)
    for middle, radius, low, high, size in ((*map(Fraction, row),) for row in rows):
        room = (abs(middle) + radius) * 3 * UNIT + 2 * Fraction(TINY)
        assert middle - radius - room <= low <= middle - radius
        assert middle + radius <= high <= middle + radius + room
        assert abs(middle) + radius <= size <= (abs(middle) + radius) * (1 + HAIR)


@pytest.mark.parametrize("r", [0.0, 0.5, np.inf])
def test_a_sign_is_known_where_no_number_of_the_ball_is_0(r):
    for m in (-2.0, -0.5, 0.0, 0.5, 2.0):
        one, row = BallArray(m, r), BallArray(np.array([m]), np.array([r]))
        for x in (one, row):
            assert bool(np.all(x.positive())) is (m > r)
            assert bool(np.all(x.negative())) is (m < -r)


def test_a_part_of_a_ball_array_has_the_radii_of_its_places():
    m, r = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])
    for x, radii in ((BallArray(m, r), [0.2, 0.3]), (BallArray(m, 0.5), [0.5, 0.5]), (BallArray(7.0, r), [0.2, 0.3])):
        part = x[1:]
        assert part.r.tolist() == radii
        assert part.m.tolist() == ([2.0, 3.0] if np.ndim(x.m) else [7.0, 7.0])
    wide = spread(2.0, m)
    assert (wide.m.tolist(), wide.r.tolist()) == ([2.0] * 3, [0.0] * 3)
    assert spread(BallArray(2.0, r), m).r.tolist() == [0.1, 0.2, 0.3]


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


def test_the_common_part_of_two_balls_is_between_the_nearer_ends():
    x, y = BallArray(np.array([0.0, 5.0]), np.array([2.0, 1.0])), BallArray(np.array([1.5, 4.0]), np.array([1.0, 3.0]))
    for found in (common_part(x, y), common_part(y, x)):
        assert np.allclose(found.lower(), [0.5, 4.0])
        assert np.allclose(found.upper(), [2.0, 6.0])
    nothing = BallArray(np.array([0.0, np.nan]), np.array([np.inf, np.nan]))
    for found in (common_part(x, nothing), common_part(nothing, x)):
        assert np.allclose(found.lower(), [-2.0, 4.0])
        assert np.allclose(found.upper(), [2.0, 6.0])


def test_a_compiled_function_takes_and_gives_midpoints_and_radii_in_turn():
    x, y = BallArray(np.array([1.0, 2.0]), np.array([0.5, 0.25])), BallArray(np.array([3.0, 5.0]), np.array([0.125, 1]))
    total, gap, mixed = Compiled(lambda a, b: [a + b, a - b, a * b])(x, y)
    for found, wanted in ((total, x + y), (gap, x - y), (mixed, x * y)):
        assert found.m.tolist() == wanted.m.tolist()
        assert found.r.tolist() == wanted.r.tolist()


AT = np.array([0.0, 0.3, -0.34, 0.35, 1.0, -1.5, 7.7, -20.0, 63.9, -63.9])


def test_the_exponential_is_as_wide_as_the_count_of_its_errors():
    """Relative to its value `r + r**2`, for `exp(r) - 1`, and the error of a double, which a factor `1 + r` spreads."""
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
    """At doubles near multiples of a quarter turn, where what three doubles leave of it decides."""
    k = np.arange(-40, 41)
    c, s = turned(BallArray(k * (np.pi / 2)))
    with working(300):
        for x, cosine, sine in zip((k * (np.pi / 2)).tolist(), c.m.tolist(), s.m.tolist(), strict=True):
            assert abs(arb(x).cos() - cosine) <= abs(arb(x).cos()) * 2.0**-49
            assert abs(arb(x).sin() - sine) <= abs(arb(x).sin()) * 2.0**-49


def test_horners_rule_is_the_polynomial():
    z = np.array([-2.0, 0.0, 0.5, 3.0])
    for coefficients in ([1.0, 2.0], [3.0, -1.0, 0.5], [1.0, 0.0, -2.0, 4.0, 8.0]):
        wanted = [sum(c * x**k for k, c in enumerate(coefficients)) for x in z.tolist()]
        assert arrays._horner(coefficients, z).tolist() == wanted


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


OFF = [0.0, 1e-3, -1e-3, 0.1, -0.1, 0.3, -0.3]


@pytest.mark.parametrize("off", OFF)
def test_a_logarithm_is_enclosed_whatever_was_guessed(monkeypatch, off):
    """Within the square of how far the guess is off, and the errors of the exponential and of a double."""
    own = elementary.log
    monkeypatch.setattr(arrays.elementary, "log", lambda x: own(x) + off)
    m = np.array([0.1, 1.0, 3.7, 1e5])
    found = ArrayOps().log(BallArray(m))
    with working(200):
        for value, radius, x in zip(found.m.tolist(), found.r.tolist(), m.tolist(), strict=True):
            true = arb(x).log()
            assert abs(true - value) <= radius
            assert radius <= 1.01 * np.expm1(-off) ** 2 + 1.6 * EXPONENTIAL_ERROR + abs(value) * 2.0**-51


@pytest.mark.parametrize("off", OFF)
@pytest.mark.parametrize("n", [2, 3, 5])
def test_a_root_is_enclosed_whatever_was_guessed(monkeypatch, n, off):
    own = elementary.root
    monkeypatch.setattr(arrays.elementary, "root", lambda x, n: own(x, n) * (1 + off / n))
    m = np.array([0.1, 1.0, 3.7, 1e5])
    found = ArrayOps().root(BallArray(m), n)
    far = abs((1 + off / n) ** -n - 1)
    with working(200):
        for value, radius, x in zip(found.m.tolist(), found.r.tolist(), m.tolist(), strict=True):
            true = arb(x).root(n)
            assert not np.isfinite(radius) or abs(true - value) <= radius
            assert far > 0.49 or radius <= true * (1.2 * far**2 + (2 * n + 3) * 2.0**-52)


@pytest.mark.parametrize("off", OFF)
def test_a_direction_is_enclosed_whatever_was_guessed(monkeypatch, off):
    """Within a third of the cube of the tangent of how far it is off, and the errors of sine and cosine."""

    class Near:
        @staticmethod
        def atan2(s, c):
            return np.arctan2(s, c) + off

    monkeypatch.setattr(arrays, "GUESS", Near)
    at = np.array([0.0, 0.5, np.pi / 2, 2.0, 3.0, -0.5, -np.pi / 2, -3.0])
    c, s = np.cos(at), np.sin(at)
    c[2], c[6] = 0.0, 0.0  # straight up and straight down
    found = direction(BallArray(c), BallArray(s))
    with working(200):
        for value, radius, x, y in zip(*(row.tolist() for row in (found.m, found.r, c, s)), strict=True):
            assert abs(arb.atan2(arb(y), arb(x)) - value) <= radius
            assert radius <= 1.01 * abs(np.tan(off)) ** 3 / 3 + 4 * UNIT_ERROR + 2.0**-49


def test_no_direction_is_told_of_a_vector_that_may_be_0_and_no_warning_given():
    for c, s, r in ((0.0, 0.0, 0.0), (0.1, 0.0, 0.2), (0.0, -0.1, 0.2), (-1.0, 0.0, 1.0)):
        with np.errstate(invalid="raise"):
            found = direction(BallArray(np.array([c]), np.array([r])), BallArray(np.array([s]), np.array([r])))
        assert found.r[0] == np.inf


def test_hyperbolic_functions_hold_their_ends_and_are_as_wide_as_the_exponentials():
    m, r = every([-3.0, -0.5, 0.0, 0.5, 3.0], [0.0, 1e-6])
    x = BallArray(m, r)
    for word, way in (("sinh", arb.sinh), ("cosh", arb.cosh), ("tanh", arb.tanh)):
        found = getattr(ArrayOps(), word)(x)
        with working(200):
            for value, radius, at, s in zip(*(row.tolist() for row in (found.m, found.r, m, r)), strict=True):
                assert all(abs(way(arb(at) + end * arb(s)) - value) <= radius for end in (-1, 1))
                assert radius <= (s + 2 * EXPONENTIAL_ERROR) * 1.01 * np.cosh(at) * (2 if word == "tanh" else 1)
