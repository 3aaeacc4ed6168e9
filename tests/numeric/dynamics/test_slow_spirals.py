"""Particles that spiral slowly to a weakly attracting cycle are undecided, and none is called chaotic."""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.dynamics.attractors import UNSETTLED, Kind, classify
from symbolic.cycles.thresholds import lambda_c

PARTICLES = 32
CLOSE = 0.03, 0.003  # in theta and phi of the horizontal orbit of the cuspless cardioid


@pytest.mark.slow
@pytest.mark.parametrize("below", [1e-5])  # the nearer, the slower the spiral
def test_no_ball_on_its_way_to_a_weakly_attracting_cycle_is_called_chaotic(below):
    """Paper, section 5.1: the cycle attracts below `lambda_c`; here its multiplier is within 2e-4 of -1."""
    rng = np.random.default_rng(0)
    theta, phi = rng.uniform(-0.02, 0.02, PARTICLES), rng.uniform(-0.002, 0.002, PARTICLES)
    map = PinballMap("cuspless", lam=float(lambda_c()) - below)
    found = classify(map, theta, phi, np.zeros(PARTICLES, dtype=np.int64))
    end = map.exponents(theta, phi, 200_000, 0, 0)
    there = (np.abs(end.theta) < CLOSE[0]) & (np.abs(end.phi) < CLOSE[1])
    chaotic = [i for i, one in enumerate(found.attractors) if one.kind is Kind.CHAOTIC]

    assert np.sum(there) >= 3
    assert not np.any(there & np.isin(found.label, chaotic))
    assert np.any(found.label == UNSETTLED)
    assert [one.period for one in found.attractors if one.kind is Kind.CYCLE] == [2]
