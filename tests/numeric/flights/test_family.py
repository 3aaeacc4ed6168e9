"""Every family of tables, by the definition of the map: flights are straight, inside, and reflected by the law."""

import numpy as np
import pytest

from numeric.backends.scalars import ArrayBackend
from numeric.flights.cardioid import Cardioid
from numeric.flights.family import NEAR, Family, Landing, grazing, law_of

EPS = 2.0**-52
LAWS = [0, 0.3, 1]


@pytest.fixture(params=LAWS, ids=["slap", "pinball", "elastic"])
def flights(request, table, bounced):
    """A map on arrays, random particles, and their bounces."""
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
    position = found.fields[: len(map.family.position)]
    if 0 in map.family.pairs:
        assert np.max(np.abs(np.hypot(*position) - 1)) <= 4 * EPS


def test_a_landing_is_a_tangency_below_four_eps_of_cosine():
    across = np.array([1.0, -1.0, 1.0, 1.0, 3.0, 1.0, 0.0])
    along = np.array([4 * EPS, 4 * EPS * (1 + EPS), 4 * EPS * (1 + EPS), -1.0, 12 * EPS, np.nan, 1e-300])

    assert grazing(ArrayBackend(), across, along).tolist() == [True, False, False, True, True, True, False]


def test_a_family_of_its_own_has_outcomes_and_registers_to_fill():
    assert (Family.stops, Family.renormalise_every, Family.width) == (True, 8, 32)
    assert Family.kept(None, None, [], []) == []
    assert (Landing([], 0, 0).code, Landing([], 0, 0).vectors, Landing([], 0, 0).numbers) == (None, {}, {})


def test_a_family_that_lacks_a_method_cannot_be_made_and_the_error_names_it():
    """Every method that a flight cannot do without is abstract: a missing one is an error at once."""
    needed = {"matches", "enter", "place", "fly", "leave", "slapped", "departure", "bend"}

    assert Family.__abstractmethods__ == needed
    for missing in needed:
        have = {name: lambda *_: None for name in needed - {missing}}
        with pytest.raises(TypeError, match=missing):
            type("Partial", (Family,), have)(None)


@pytest.mark.parametrize(
    ("low", "high", "law"),
    [
        (0, 0, "slap"),
        (1, 1, "elastic"),
        (0, 1, "pinball"),
        (0.5, 0.5, "pinball"),
        (0, 0.5, "pinball"),
        (0.5, 1, "pinball"),
    ],
)
def test_a_law_serves_every_contraction_between_two(low, high, law):
    assert law_of(low, high) == law


def test_a_landing_nearer_than_four_eps_to_the_cusp_is_the_cusp():
    miss = np.geomspace(1e-49, 1e-42, 200)
    one, nought = np.ones(200), np.zeros(200)
    with np.errstate(all="ignore"):
        landing = Cardioid().fly(ArrayBackend(), [], "pinball", [one, nought], [np.cos(miss), miss])
    p = landing.position[0]

    assert np.array_equal(landing.code == 2, p <= 4 * EPS)
    assert set(landing.code) == {0, 2}
    assert np.any((p > 3 * EPS) & (p <= 4 * EPS))
    assert np.any((p > 4 * EPS) & (p < 5 * EPS))
    assert NEAR == 4 * EPS


@pytest.mark.parametrize("bounces", [1, 3])
def test_areas_change_by_lam_and_the_ratios_of_cosines(table, bounces):
    map = table.map(0.6, kernels=False)
    where, theta, phi = table.starts(map, 20, seed=5, steepest=0.9)
    found, orbit = map.exponents(theta, phi, bounces, component=where), map.orbit(theta, phi, bounces, where)
    logs = np.log(0.6 * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))

    assert np.allclose(found.nu_plus + found.nu_minus, logs.mean(axis=0), rtol=0, atol=1e-12)


def test_at_slap_a_vector_grows_by_the_slopes(table):
    map = table.map(0, kernels=False)
    where, theta, _ = table.starts(map, 20, seed=5)
    orbit = map.orbit(theta, 0.0, 3, where)
    slopes = [map.slap(orbit.theta[i], 1, orbit.component[i]).slope for i in range(3)]
    found = map.exponents(theta, 0.0, 3, component=where)

    assert np.allclose(found.nu_plus, np.mean(np.log(np.abs(slopes)), axis=0), rtol=0, atol=1e-11)
