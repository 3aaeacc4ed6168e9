"""Flights between arc and wall of the cuspless table, and landings near its joins."""

import numpy as np
import pytest
from attacks.joins import past_joins

from numeric import PinballMap

LAWS = [0, 0.3, 1]
TOP = np.sqrt(3) / 4


def cuspless(lam):
    return PinballMap("cuspless", lam=lam, kernels=False)


@pytest.mark.parametrize("near", [False, True])
def test_no_flight_past_a_join_lands_on_the_wrong_side_and_only_those_near_one_stop(near):
    """The flights miss a join by up to 30 rounding units; `benchmarks/torture.py joins` tries millions."""
    found = past_joins(20_000, 30, near, kernels=False, seed=7)

    assert not np.any(found.wrong)
    assert 0.05 < np.mean(found.stopped) < 0.5
    assert np.max(found.miss[found.stopped]) < 10


@pytest.mark.parametrize("lam", LAWS)
def test_flights_are_straight_and_inside_from_every_place_to_every_other(lam, bounced):
    theta = np.concatenate([np.repeat(np.linspace(-2.09, 2.09, 40), 40), np.repeat(np.linspace(-0.43, 0.43, 40), 40)])
    where = np.repeat([0, 1], 1600)
    phi = np.tile(np.linspace(-1.56, 1.56, 40), 80) * (lam > 0)
    found = bounced(cuspless(lam), where, theta, phi)

    assert np.max(found.off_the_line) <= 64 * 2.0**-52
    assert np.min(found.length) > 0
    assert np.min(found.depth) > -64 * 2.0**-52
    assert np.max(found.turned * np.cos(found.eta)) <= 1e-13
    assert {(a, b) for a, b in zip(where.tolist(), found.where.tolist(), strict=True)} >= {(0, 0), (0, 1), (1, 0)}
    assert (1, 1) not in set(zip(where.tolist(), found.where.tolist(), strict=True))


@pytest.mark.parametrize("at", [0.0, 1.0, -1.2])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_landing_within_rounding_of_a_join_is_one_and_no_other_is(at, sign):
    """Flights from the arc aimed at a join, and 1e-9 beside it on either side, at the arc or at the wall."""
    map = cuspless(0.9)
    x, y = map.states.point(np.array(0), np.array(at))
    aim = np.arctan2(sign * TOP - y, -0.25 - x)
    phi = map.states.angle_to_normal(np.array(0), np.array(at), np.cos(aim), np.sin(aim))
    codes = [int(map.step(at, float(phi) + miss).code) for miss in (0.0, 1e-9, -1e-9)]

    assert codes[1:] == [0, 0]
    assert {int(map.step(at, float(phi) + k * 2.0**-53).code) for k in range(-12, 13)} >= {1}
    assert {int(map.step(at, float(phi) + miss).component) for miss in (1e-9, -1e-9)} == {0, 1}
