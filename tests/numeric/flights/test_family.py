"""Every family of tables, by the definition of the map: flights are straight, inside, and reflected by the law."""

import numpy as np
import pytest

EPS = 2.0**-52


@pytest.mark.parametrize("lam", [0, 0.3, 1], ids=["slap", "pinball", "elastic"])
def test_a_flight_is_straight_and_inside_and_leaves_its_landing_by_the_law(table, bounced, lam):
    map = table.map(lam, kernels=False)
    where, theta, phi = table.starts(map, 400, seed=3, steepest=0.98)
    found = bounced(map, where, theta, phi * (lam > 0))

    assert np.max(found.off_the_line) <= 64 * EPS
    assert np.min(found.length) > 0
    assert np.min(found.depth) > -64 * EPS
    assert np.max(found.depth) > 0
    assert np.max(found.turned * np.cos(found.eta)) <= 64 * EPS


@pytest.mark.parametrize("bounces", [1, 3])
def test_areas_change_by_lam_and_the_ratios_of_cosines(table, bounces):
    map = table.map(0.6, kernels=False)
    where, theta, phi = table.starts(map, 20, seed=5, steepest=0.9)
    found, orbit = map.exponents(theta, phi, bounces, component=where), map.orbit(theta, phi, bounces, where)
    logs = np.log(0.6 * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))

    assert np.allclose(found.nu_plus + found.nu_minus, logs.mean(axis=0), rtol=0, atol=1e-12)
