"""Sums of logarithmic growth: computed at once or in parts, also beyond the range of a double."""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.pinball.sampling import Growth


@pytest.mark.parametrize("lam", [0, 0.6, 1])
def test_parts_of_a_run_add_up_to_the_whole(table, lam):
    map = table.map(lam, kernels=False)
    where, at, phi = table.starts(map, 5, seed=1, steepest=0.8)
    one, two = (Growth(map, at, phi, where) for _ in range(2))
    one.advance(7)
    for bounces in (3, 0, 4):
        two.advance(bounces)

    assert np.allclose(one.stretch, two.stretch, rtol=0, atol=1e-12)
    assert np.allclose(one.volume, two.volume, rtol=0, atol=1e-12)
    assert np.array_equal(one.theta, two.theta)
    assert (one.bounces.tolist(), two.bounces.tolist()) == ([7] * 5, [7] * 5)


def test_growth_beyond_what_a_double_holds_is_summed():
    """1024 doublings overflow a double; on the cardioid's short cycle the slap map stretches by 5/4 per bounce."""
    growth = Growth(PinballMap("cardioid", lam=0), np.pi / 3, 0.0)
    growth.advance(5000)
    growth.advance(5000)

    assert growth.stretch[0] / 10_000 == pytest.approx(np.log(5 / 4), abs=1e-12)


@pytest.mark.parametrize("name", ["ellipse", "egg", "cardioid"])
def test_areas_beyond_what_a_double_holds_are_summed(name):
    """The expected sum has the logarithm of the ratio of cosines at each bounce of the orbit."""
    map = PinballMap(name, lam=0.97, **{"ellipse": {"a": 2}, "egg": {"alpha": "0.08"}}.get(name, {}))
    theta, phi = np.array([0.3, 1.1]), np.array([0.4, -0.9])
    growth, orbit = Growth(map, theta, phi), map.orbit(theta, phi, 1500)
    growth.advance(1500)
    sums = np.sum(np.log(np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:])), axis=0)

    assert np.allclose(growth.volume, sums, rtol=0, atol=1e-9)
