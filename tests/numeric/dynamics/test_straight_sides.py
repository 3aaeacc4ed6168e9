"""Between straight sides the angle changes by an affine law and the place is stretched: the map agrees."""

from functools import cache

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
LAM = Rational(3, 10)
SKEW = tables.polygon((0, 0), (4, 0), (5, 2), (1, 3), (-1, 1), name="skew")
TABLES = {"triangle": tables.triangle(), "square": tables.square(), "skew": SKEW}


@cache
def mapped(name):
    return PinballMap(TABLES[name], lam=LAM)


def normals(table):
    """The angle of each side's inward normal."""
    ways = [[float(c.diff(theta)) for c in part.point] for part in table.components]
    return np.array([np.arctan2(x, -y) for x, y in ways])


def starts(map, count):
    rng = np.random.default_rng(7)
    return rng.integers(0, len(map.ir.parts), count), rng.random(count), rng.uniform(-1.5, 1.5, count)


@pytest.mark.parametrize("name", TABLES)
def test_the_exit_angle_after_a_flight_is_affine_in_the_one_before(name):
    map, angle = mapped(name), normals(TABLES[name])
    where, at, phi = starts(map, 4000)
    step = map.step(at, phi, where)
    going = step.code == 0
    turn = np.mod(angle[step.component] - angle[where], 2 * np.pi)
    assert np.max(np.abs(step.phi - float(LAM) * (np.pi - turn - phi))[going]) < 8 * EPS


@pytest.mark.parametrize("name", TABLES)
def test_one_exponent_is_the_logarithm_of_the_contraction_and_the_other_is_not_negative(name):
    map = mapped(name)
    where, at, phi = starts(map, 64)
    matrix = map.derivative(at, phi, where)
    assert np.max(np.abs(matrix[:, 1, 0])) == 0
    assert np.max(np.abs(matrix[:, 1, 1] + 0.3)) <= EPS
    bounces = 1000
    found = map.exponents(at, phi, bounces, component=where)
    going = found.bounces == bounces
    assert np.mean(going) > 0.9
    assert np.max(np.abs(found.nu_minus[going] - np.log(0.3))) < 10 / bounces  # of a vector that starts anywhere
    assert np.min(found.nu_plus[going]) > -10 / bounces


def test_the_word_of_three_sides_gives_the_cycle_of_the_triangle_and_what_it_repels():
    """From one side to the next the particle lands at the share of the side from which it left."""
    phi = np.pi / 3 * 0.3 / 1.3  # from sides turned by 2*pi/3 it arrives at the angle phi/lam
    map = mapped("triangle")
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        step = map.step(middle, phi, 0)
        assert int(step.component) == 1
        low, high = (middle, high) if float(step.theta) > middle else (low, middle)
    orbit = map.orbit(low, phi, 3, 0)
    assert orbit.component.tolist() == [0, 1, 2, 0]
    assert abs(float(orbit.theta[3]) - low) < 64 * EPS
    product = np.linalg.multi_dot([map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i]) for i in (2, 1, 0)])
    expected = (np.cos(phi) / np.cos(phi / 0.3)) ** 3
    assert sorted(np.abs(np.linalg.eigvals(product))) == pytest.approx([0.3**3, expected], rel=1e-12)
    assert expected > 1


def test_particles_in_the_square_settle_on_parallel_sides_or_go_on_for_ever():
    """The two published attractors of the square: one parabolic, one chaotic."""
    map = PinballMap(tables.square(), lam="0.8")
    where, at, phi = starts(map, 300)
    orbit = map.orbit(at, phi, 400, where)
    going = orbit.code[-1] == 0
    rests = np.all(np.abs(orbit.phi[-4:]) < 1e-9, axis=0)
    assert np.any(rests & going)
    assert np.any(~rests & going)
    sides = orbit.component[-2:, rests & going]
    assert np.all((sides[0] + 2) % 4 == sides[1])
