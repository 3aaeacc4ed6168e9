"""The normal form of the egg's triangle: exact, area-preserving, and the same as computed in balls."""

import numpy as np
import pytest
from flint import arb
from sympy import QQ, Poly, Rational, fraction

from numeric import PinballMap
from symbolic.cycles.polygons import elastic_trace
from symbolic.cycles.resonance import at_shape, flat_triangle
from symbolic.tables import egg
from symbolic.tables.table import alpha
from verification.arithmetic.balls import working
from verification.proofs.periodic.bifurcation import twist

THIRD, FOURTH = Rational(1, 13), Rational(1, 19)


def test_the_trace_of_one_flight_is_that_of_the_monodromy_in_the_turning_frame():
    assert (flat_triangle()[0] - elastic_trace(True)).equals(0)


def test_area_is_kept_so_that_half_of_the_cubic_coefficient_is_exactly_0():
    assert flat_triangle()[2] == 0
    assert at_shape(FOURTH).drift == 0


@pytest.mark.parametrize("shape", ["0.02", "0.05", "0.08", "1/37", "1/19"])
def test_the_exact_twist_is_that_of_the_ball_computation_for_three_flights(shape: str):
    """The exact twist is of one flight, in units of sqrt(3): three flights twist 3/sqrt(3) times as much."""
    with working(120):
        places = [arb.pi() * k for k in (arb(1) / 3, arb(1), arb(-1) / 3)]
        balls = twist(egg(3).at(alpha=Rational(shape)), (0, 0, 0), places, 120)
        exact = flat_triangle()[1].subs(alpha, Rational(shape))

        assert (balls.twist / arb(3).sqrt() - arb(exact.p) / exact.q).contains(0)


def test_the_twist_vanishes_at_one_shape_between_0_and_a_tenth():
    top, _ = fraction(flat_triangle()[1].together())

    assert Poly(top, alpha).count_roots(0, Rational(1, 10)) == 1
    assert Poly(top, alpha).count_roots(Rational(767986, 10**7), Rational(767987, 10**7)) == 1


def test_three_flights_at_a_thirteenth_are_the_identity_with_a_quadratic_part():
    found = at_shape(THIRD)

    assert found.trace == -1
    assert found.third


def test_four_flights_at_a_nineteenth_twist_more_than_the_resonance_pulls():
    """The quartic Hamiltonian of the map `mu*z*(1 + i*a*|z|**2) + c*conj(z)**3` is definite when `|a| > |c|`."""
    found = at_shape(FOURTH)
    size = found.fourth.a**2 - found.fourth.b**2 * found.fourth.square

    assert found.trace == 0
    assert found.square == -1
    assert (found.twist / found.B) ** 2 == QQ(31, 8) ** 2
    assert size == QQ(9, 8) ** 2


def distance(shape: float, offset: float, bounces: int) -> np.ndarray:
    """The largest distances in `(theta, phi)` from the triangle of orbits that start in a circle about it."""
    map = PinballMap("egg", lam=1, alpha=shape)
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    orbit = map.orbit(np.pi / 3 + offset * np.cos(turn), np.pi / 6 + offset * np.sin(turn), bounces)
    theta = np.remainder(orbit.theta, 2 * np.pi / 3) - np.pi / 3
    return np.max(np.hypot(theta, orbit.phi - np.pi / 6), axis=0)


def test_orbits_leave_the_triangle_at_a_thirteenth_and_stay_at_other_shapes():
    """A second method, float64 orbits: at a stable triangle they stay within a multiple of their first distance."""
    away = distance(1 / 13, 0.004, 4000)

    assert np.median(away) > 10 * 0.004
    for stable in (1 / 37, 1 / 19, 0.05, 0.08):
        assert np.max(distance(stable, 0.001, 4000)) < 5 * 0.001
