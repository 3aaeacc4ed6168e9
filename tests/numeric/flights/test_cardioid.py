"""Flights near the cardioid's cusp are straight and inside, and only a landing within rounding of it stops."""

import numpy as np
import pytest

from numeric import PinballMap

SIGN = np.where(np.arange(24) % 2 == 0, 1, -1)
LAWS = [0, 0.3, 1]


def cardioid(lam):
    return PinballMap("cardioid", lam=lam, kernels=False)


@pytest.mark.parametrize("lam", LAWS)
def test_flights_near_the_cusp_are_straight_and_inside(lam, bounced):
    theta = np.concatenate([np.linspace(-3.1, 3.1, 300), SIGN * (np.pi - 1e-3)])
    phi = np.concatenate([np.linspace(-3.1, 3.1, 300) / 2 + 1e-3, np.linspace(-1.5, 1.5, 24)]) * (lam > 0)
    found = bounced(cardioid(lam), 0 * theta.astype(int), theta, phi)

    assert np.max(found.off_the_line) <= 1e-13
    assert np.min(found.length) > 0
    assert np.min(found.depth) > -1e-13
    assert np.max(found.turned * np.cos(found.eta) * np.cos(found.theta / 2)) <= 1e-13


def test_a_landing_within_rounding_of_the_cusp_is_the_cusp():
    """A particle that passes it by `k` lands where `cos(theta/2)` is about the cube root of `k`."""
    map = cardioid(0.9)
    miss = np.array([0.0, 1e-50, 1e-42, -1e-42, -1e-50, 1e-6])
    step = map.step(np.zeros(6), miss)

    assert step.code.tolist() == [2, 2, 0, 0, 2, 0]
    assert np.all(np.abs(step.theta[[2, 3, 5]]) > np.pi - 0.1)
