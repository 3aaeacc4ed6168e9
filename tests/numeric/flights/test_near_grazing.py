"""Flights along the wall of the cuspless table: the angle and the distance from the wall, with twice the digits."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from numeric import PinballMap
from numeric.backends.scalars import ArrayBackend
from numeric.flights.cuspless import above_the_wall, sharp_back, sharpened

EPS = 2.0**-52
OPS = ArrayBackend()
MP = mpmath.MPContext()
MP.dps = 60
NEAR_GRAZING = np.array([  # theta and phi, as in test_accuracy
    (-1.95277363, -1.37612652), (-0.670208058, -0.25451718), (1.25956245, 0.694918384), (-1.9531, -1.3763),
    (1.6162036187902906, 1.0014056098562036), (-1.6335621826646394, -1.0183761112721677), (2.0943, 1.5705),
    (1.9172456314571602, 1.3024506414317365), (-1.6527902530959695, -1.0372593151405034), (2.01866398, 1.45999368),
]).T  # fmt: skip


def numbers(x, y):
    """Columns as 60-digit numbers."""
    return [(MP.mpf(a), MP.mpf(b)) for a, b in zip(x.tolist(), y.tolist(), strict=True)]


def states(seed=2, count=200):
    """`sigma` and the exit as doubles, half of them nearly along the wall."""
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-2.09, 2.09, count)
    phi = np.where(np.arange(count) % 2 == 0, rng.uniform(-1.5, 1.5, count), 1.5 * theta - np.pi / 2 * np.sign(theta))
    phi[::4] += 1e-9
    return (np.cos(theta / 2), np.sin(theta / 2)), (np.cos(phi), np.sin(phi))


def test_the_real_part_of_back_keeps_its_digits_however_small_it_is():
    sigma, leaving = states()
    found = sharp_back(OPS, sigma, leaving)
    for f, (p, q), (c, s) in zip(found.tolist(), numbers(*sigma), numbers(*leaving), strict=True):
        exact = (MP.mpc(p, q) ** 3 * MP.mpc(c, -s)).real
        assert abs(f - exact) <= 4 * EPS * abs(exact) + EPS**2


def test_the_distance_from_the_wall_is_that_of_the_nearest_point_of_the_arc():
    theta = np.concatenate([np.linspace(-2.09, 2.09, 200), 2 * np.pi / 3 - np.geomspace(1e-12, 1e-2, 40)])
    sigma = np.cos(theta / 2), np.sin(theta / 2)
    for off in (0.0, 2 * EPS):  # sigma's length is one up to rounding only
        p, q = (x * (1 + off) for x in sigma)
        gap, height = above_the_wall(OPS, (p, q))
        for g, h, (a, b) in zip(gap.tolist(), height.tolist(), numbers(p, q), strict=True):
            length = MP.sqrt(a * a + b * b)
            a, b = a / length, b / length
            assert abs(g - (2 * a * a - MP.mpf(1) / 2)) <= 2 * EPS * abs(g) + 4 * EPS**2
            assert abs(h - 4 * a**3 * b) <= 4 * EPS * abs(h) + EPS**2


def test_a_step_of_newton_ends_on_the_line_of_flight():
    """From a landing that is off by 1e-9; what is left is the square, or rounding."""
    rng = np.random.default_rng(3)
    theta, end = rng.uniform(0.5, 2.0, 50), -rng.uniform(1.7, 2.09, 50)
    sigma, landing = ((np.cos(x / 2), np.sin(x / 2)) for x in (theta, end))
    z, z1 = (2 * np.cos(x / 2) ** 2 * np.exp(1j * x) for x in (theta, end))
    v = (z1 - z) / abs(z1 - z)
    tangent, tangent1 = 1j * np.exp(1.5j * theta), 1j * np.exp(1.5j * end)
    phi = np.angle(v / (1j * tangent)) * -1
    back = np.exp(1.5j * theta) * np.exp(-1j * phi)
    off = np.exp(0.5e-9j)
    moved = (landing[0] + 1j * landing[1]) * off
    along = (v * np.conj(-1j * tangent1)).real
    real, height, found = sharpened(OPS, sigma, (np.cos(phi), np.sin(phi)), back.imag, (moved.real, moved.imag), along)

    assert np.max(np.abs(2 * np.arctan2(found[1], found[0]) - end)) <= 1e-14
    assert np.max(np.abs(real - back.real)) <= 4 * EPS
    wall = z + v * (-0.25 - z.real) / v.real
    assert np.max(np.abs(height - wall.imag)) <= 1e-13


@pytest.mark.parametrize("lam", [0.95, 1])
@pytest.mark.parametrize("turn", [1, -1])
def test_flights_along_the_wall(lam, turn, rounding):
    map = PinballMap("cuspless", lam=lam, kernels=False)
    theta, phi = NEAR_GRAZING * turn
    place, direction = rounding(map, np.zeros(theta.size, dtype=int), theta, phi)

    assert place <= 4
    assert direction <= 8


def test_the_wall_is_where_the_paper_has_it():
    gap, height = above_the_wall(OPS, (np.array([0.5]), np.array([np.sqrt(0.75)])))

    assert abs(gap[0]) <= EPS
    assert Fraction(float(height[0])) == pytest.approx(np.sqrt(3) / 4, abs=EPS)
