"""The cardioid's step: what rounding does to it, where the cusp is near as elsewhere."""

import numpy as np
import pytest

from numeric import PinballMap

ARC = np.zeros(24, dtype=np.int64)
SIGN = np.where(np.arange(24) % 2 == 0, 1, -1)
LAWS = [0, 0.3, 1]


def cardioid(lam):
    return PinballMap("cardioid", lam=lam, kernels=False)


@pytest.mark.parametrize("lam", LAWS)
def test_anywhere(lam, rounding):
    rng = np.random.default_rng(5)
    theta, phi = rng.uniform(-3.1, 3.1, 24), rng.uniform(-1.5, 1.5, 24) * (lam > 0)
    place, direction = rounding(cardioid(lam), ARC, theta, phi)

    assert place <= 2
    assert direction <= 8


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-11])
def test_starting_near_the_cusp(gap, rounding):
    place, direction = rounding(cardioid(0.9), ARC, SIGN * (np.pi - gap), np.linspace(-1.5, 1.5, 24))

    assert place <= 2
    assert direction <= 8


@pytest.mark.parametrize("miss", [1e-2, 1e-6, 1e-12])
def test_aimed_at_the_cusp(miss, rounding):
    theta = np.linspace(-2.9, 2.9, 24)
    place, direction = rounding(cardioid(0.9), ARC, theta, theta / 2 + SIGN * miss)

    assert place <= 2
    assert direction <= 8


@pytest.mark.parametrize("gap", [1e-3, 1e-7, 1e-12])
def test_grazing(gap, rounding):
    place, direction = rounding(cardioid(0.9), ARC, np.linspace(-3, 3, 24), SIGN * (np.pi / 2 - gap))

    assert place <= 2
    assert direction <= 8


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
    """A ball that passes it by `k` lands where `cos(theta/2)` is about the cube root of `k`."""
    map = cardioid(0.9)
    miss = np.array([0.0, 1e-50, 1e-42, -1e-42, -1e-50, 1e-6])
    step = map.step(np.zeros(6), miss)

    assert step.code.tolist() == [2, 2, 0, 0, 2, 0]
    assert np.all(np.abs(step.theta[[2, 3, 5]]) > np.pi - 0.1)
