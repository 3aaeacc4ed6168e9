"""Every family of tables, by the definition of the map: flights are straight, inside, and reflected by the law."""

import numpy as np
import pytest

from numeric.families.family import Family, Landing, grazing
from numeric.readers.arrays import Arrays

EPS = 2.0**-52
LAWS = [0, 0.3, 1]


@pytest.fixture(params=LAWS, ids=["slap", "pinball", "elastic"])
def flights(request, table, bounced):
    """A map on arrays, random balls, and their bounces."""
    map = table.map(request.param, kernels=False)
    where, theta, phi = table.starts(map, 400, seed=3, steepest=0.98)
    phi = phi if request.param else 0 * phi
    return map, phi, bounced(map, where, theta, phi)


def test_a_flight_is_straight_and_inside_and_lands_on_the_boundary(flights):
    _, _, found = flights

    assert np.max(found.off_the_line) <= 64 * EPS
    assert np.min(found.length) > 0
    assert np.min(found.depth) > -64 * EPS
    assert np.max(found.depth) > 0


def test_the_exit_angle_is_minus_lam_times_the_incidence(flights):
    _, _, found = flights

    assert np.max(found.turned * np.cos(found.eta)) <= 64 * EPS


def test_the_derivative_is_the_papers_matrix(flights):
    map, phi, found = flights
    component, theta = map.states.place(found.own)
    formula = found.matrix(float(map.lam), phi)
    matrix = map.derivative(theta, phi, component)
    size = 1 + np.max(np.abs(formula), axis=(1, 2))

    assert np.max(np.abs(matrix - formula), axis=(1, 2)) == pytest.approx(0, abs=1e-11 * np.max(size**2))
    assert np.quantile(np.max(np.abs(matrix - formula), axis=(1, 2)) / size, 0.5) <= 64 * EPS


def test_directions_have_the_length_one(flights):
    map, _, found = flights
    exits = found.fields[len(map.family.position) :]
    if len(exits) == 2:
        assert np.max(np.abs(np.hypot(*exits) - 1)) <= 4 * EPS
    place = found.fields[: len(map.family.position)][-2:]
    if map.family.name not in ("circle", "cuspless"):
        assert np.max(np.abs(np.hypot(*place) - 1)) <= 4 * EPS


def test_a_landing_is_a_tangency_below_four_eps_of_cosine():
    across = np.array([1.0, -1.0, 1.0, 1.0, 3.0, 1.0, 0.0])
    along = np.array([4 * EPS, 4 * EPS * (1 + EPS), 4 * EPS * (1 + EPS), -1.0, 12 * EPS, np.nan, 1e-300])

    assert grazing(Arrays(), across, along).tolist() == [True, False, False, True, True, True, False]


def test_a_family_of_its_own_has_outcomes_and_registers_to_fill():
    assert (Family.stops, Family.often, Family.width) == (True, 8, 32)
    assert Family().kept(None, [], []) == []
    assert (Landing([], 0, 0).code, Landing([], 0, 0).more) == (None, {})
    for method, count in (("fly", 5), ("leave", 5), ("slapped", 3), ("departure", 4), ("bend", 3)):
        with pytest.raises(NotImplementedError):
            getattr(Family(), method)(*[None] * count)
