"""Landings that are no mistake but end an orbit have a name, and the particle stays where it was last good."""

import numpy as np
import pytest

from numeric import PinballMap, Status


@pytest.mark.parametrize("kernels", [True, False])
@pytest.mark.parametrize("theta", [0.0, 0.3, -1.0, 2.5])
def test_a_ball_aimed_at_the_cusp(kernels, theta):
    """Along the axis, and on the line by the tip that passes on one side of it and lands at it on the other."""
    map = PinballMap("cardioid", lam=0.9, kernels=kernels)
    step = map.step(theta, theta / 2)

    assert step.status == Status.CUSP
    assert (step.theta, step.phi) == (theta, theta / 2)


@pytest.mark.parametrize("kernels", [True, False])
def test_a_ball_aimed_at_a_join(kernels):
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    x, y = -0.25 - 2.0, np.sqrt(3) / 4  # from theta = 0, at (2, 0), to the upper join
    phi = np.arctan2(y, -x)
    steps = [map.step(0.0, sign * phi) for sign in (1, -1)]

    assert {step.status for step in steps} == {Status.JOIN}


def test_a_tangent_ball():
    map = PinballMap("ellipse", lam=1, a=2)
    step = map.step(0.3, np.nextafter(np.pi / 2, 0))

    assert step.status == Status.GRAZING


@pytest.mark.parametrize("kernels", [True, False])
def test_neighbours_of_a_stopped_ball_go_on(kernels):
    map = PinballMap("cardioid", lam=0.9, kernels=kernels)
    theta, phi = np.array([0.3, 0.0, -0.4]), np.array([0.1, 0.0, 0.2])
    orbit = map.orbit(theta, phi, 6)

    assert [status.name for status in orbit.status[-1]] == ["REGULAR", "CUSP", "REGULAR"]
    assert np.all(orbit.theta[:, 1] == 0.0)
    assert np.all(np.isnan(orbit.eta[1:, 1]))
    assert np.array_equal(orbit.theta[:, 0], map.orbit(0.3, 0.1, 6).theta)


def test_exponents_say_how_far_a_ball_came():
    found = PinballMap("cardioid", lam=0.9).exponents(np.array([0.3, 0.0]), np.array([0.1, 0.0]), 50)

    assert found.bounces.tolist() == [50, 0]
    assert [status.name for status in found.status] == ["REGULAR", "CUSP"]


def test_near_the_cusp_is_not_at_the_cusp():
    map = PinballMap("cardioid", lam=0.9)
    step = map.step(0.0, 1e-9)

    assert step.status == Status.REGULAR
    assert np.pi - abs(step.theta) < 1e-2
