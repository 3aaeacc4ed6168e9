"""Sums of growth: in one go or in parts, from a start or after a transient, and where a particle stops."""

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


def test_what_is_skipped_does_not_count(table):
    map = table.map(0.6, kernels=False)
    where, at, phi = table.starts(map, 5, seed=1, steepest=0.8)
    growth = Growth(map, at, phi, where)
    growth.skip(0)
    assert np.array_equal(growth.theta, at)
    growth.skip(3)
    orbit = map.orbit(at, phi, 3, where)
    assert np.array_equal(growth.theta, orbit.theta[-1])
    assert not np.any([growth.stretch, growth.volume, growth.bounces])

    growth.advance(4)
    fresh = Growth(map, orbit.theta[-1], orbit.phi[-1], orbit.component[-1])
    fresh.advance(4)
    assert np.allclose(growth.stretch, fresh.stretch, rtol=0, atol=1e-9)
    assert np.allclose(growth.volume, fresh.volume, rtol=0, atol=1e-9)


def test_the_first_step_is_that_of_the_derivative_matrix(table):
    map = table.map(0.6, kernels=False)
    where, at, phi = table.starts(map, 5, seed=1, steepest=0.8)
    growth = Growth(map, at, phi, where)
    growth.advance(1)
    matrix = map.derivative(at, phi, where)

    assert np.allclose(growth.stretch, np.log(np.linalg.norm(matrix @ [0.8, 0.6], axis=1)), rtol=0, atol=1e-12)
    assert np.allclose(growth.volume, np.log(np.abs(np.linalg.det(matrix)) / 0.6), rtol=0, atol=1e-11)


def test_at_slap_the_vector_starts_along_the_boundary(table):
    map = table.map(0, kernels=False)
    where, at, _ = table.starts(map, 5, seed=1)
    growth = Growth(map, at, 0.0, where)
    growth.advance(1)

    assert np.allclose(growth.stretch, np.log(np.abs(map.slap(at, 1, where).slope)), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kernels", [True, False])
def test_sums_stop_with_their_ball(kernels):
    map = PinballMap("cardioid", lam=0.9, kernels=kernels)
    aimed = 2 * float(map.step(0.3, 0.4).phi)
    growth = Growth(map, [0.3, aimed], [0.4, aimed / 2])
    growth.advance(3)
    first = growth.stretch.copy(), growth.volume.copy()
    growth.advance(2)

    assert growth.bounces.tolist() == [5, 0]
    assert growth.code.tolist() == [0, 2]
    assert abs(growth.theta[1] - aimed) <= 2 * 2.0**-52 * aimed  # it comes back from its half angle's direction
    assert growth.stretch[0] != first[0][0]
    assert np.array_equal([growth.stretch[1], growth.volume[1]], [first[0][1], first[1][1]])


def test_growth_beyond_what_a_double_holds_is_summed():
    """1024 doublings would overflow; the slap map of the cardioid's short cycle stretches by 5/4 a bounce."""
    growth = Growth(PinballMap("cardioid", lam=0), np.pi / 3, 0.0)
    growth.advance(5000)
    growth.advance(5000)

    assert growth.stretch[0] / 10_000 == pytest.approx(np.log(5 / 4), abs=1e-12)


@pytest.mark.parametrize("name", ["ellipse", "egg", "cardioid"])
def test_areas_beyond_what_a_double_holds_are_summed(name):
    """The logarithm of the product of the ratios of cosines, bounce by bounce along the orbit."""
    map = PinballMap(name, lam=0.97, **{"ellipse": {"a": 2}, "egg": {"alpha": "0.08"}}.get(name, {}))
    theta, phi = np.array([0.3, 1.1]), np.array([0.4, -0.9])
    growth, orbit = Growth(map, theta, phi), map.orbit(theta, phi, 1500)
    growth.advance(1500)
    sums = np.sum(np.log(np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:])), axis=0)

    assert np.allclose(growth.volume, sums, rtol=0, atol=1e-9)
