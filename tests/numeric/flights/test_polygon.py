"""Tables with straight sides against the exact map, which finds its flights the general way."""

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap, phase_starts
from numeric.flights.cuspless import Cuspless
from numeric.flights.general import General
from symbolic import tables
from symbolic.tables.table import theta
from verification.maps.exact import ExactMap, errors


def polygon(name, *corners):
    arcs = []
    for i, ((x, y), (X, Y)) in enumerate(zip(corners, [*corners[1:], corners[0]], strict=True)):
        arcs.append(tables.arc(f"side {i}", x + theta * (X - x), y + theta * (Y - y), 0, 1))
    return tables.piecewise(*arcs, name=name)


SQUARE = polygon("square", (0, 0), (1, 0), (1, 1), (0, 1))
TRIANGLE = polygon("triangle", (0, 0), (2, 0), (Rational(1, 2), Rational(3, 2)))
CORNER = polygon("corner", (0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))  # not convex
TABLES = [SQUARE, TRIANGLE, CORNER]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.name)
def test_a_landing_on_straight_sides_is_the_exact_first_hit_to_a_few_roundings(table):
    map = PinballMap(table, lam=0.8)
    assert map.path.startswith("closed form on every straight side")
    starts = phase_starts(map, 60, seed=5)
    own = map.states.enter(starts.component, starts.theta, starts.phi * 0.8, map.law)
    step = PinballMap(table, lam=0.8, kernels=False).orbit(starts.theta, starts.phi * 0.8, 1, starts.component)
    landed = map.states.enter(step.component[1], step.theta[1], step.phi[1], map.law)
    position, direction = errors(map, ExactMap(map), own, landed)

    assert np.all(step.code == 0)
    assert np.max(position * np.cos(step.eta[1])) <= 8
    assert np.max(direction * np.cos(step.eta[1])) <= 24


def test_a_square_keeps_a_particle_between_opposite_sides_for_ever():
    map = PinballMap(SQUARE, lam="1/2")
    orbit = map.orbit(0.25, 0.0, 4)

    assert orbit.component.tolist() == [0, 2, 0, 2, 0]
    assert orbit.theta.tolist() == [0.25, 0.75, 0.25, 0.75, 0.25]


def test_one_exponent_of_a_polygon_is_the_logarithm_of_lam():
    found = PinballMap(TRIANGLE, lam=0.3).exponents(0.37, 0.1, 400)

    assert float(found.nu_minus) == pytest.approx(np.log(0.3), abs=5e-3)


def test_a_particle_that_flies_into_a_corner_stops_there():
    assert PinballMap(SQUARE, lam=1).step(0.5, np.arctan(0.5)).status.name == "JOIN"


def test_straight_sides_get_a_flight_of_their_own_and_bent_ones_do_not():
    assert not isinstance(PinballMap(SQUARE).family, General)
    assert isinstance(PinballMap("cuspless").family, Cuspless)
