"""The last step of a landing has more digits: on any formula and on splines what is left is its own rounding."""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from verification.maps.exact import ExactMap, errors

BENT = tables.parametric("cos(theta) + cos(2*theta)/5", "sin(theta)*exp(cos(theta)/3)")
PEBBLE = tables.from_points(
    [("1.5", "0"), ("0.7", "0.9"), ("-0.7", "0.9"), ("-1.4", "0"), ("-0.7", "-0.9"), ("0.7", "-1")]
)


@pytest.mark.parametrize("table", [BENT, PEBBLE], ids=["formula", "spline"])
@pytest.mark.parametrize("lam", ["0", "0.9"])
def test_flat_landings_are_right_to_the_last_bits(table, lam, monkeypatch):
    """At 0.01 from the tangent a residual in doubles is off by many roundings."""
    map = PinballMap(table, lam=lam, kernels=False)
    low, high = map.states.ends[0]
    theta = low + (high - low) * np.array([0.93, 0.71, 0.3, 0.11])
    phi = np.array([1, -1, 1, -1]) * (np.pi / 2 - 0.01) * (lam != "0")

    def largest():
        own = map.states.enter(np.zeros(4, dtype=np.int64), theta, phi, map.law)
        found = map.engine.run(KernelSpec(map.law, record=True), own, np.full(4, float(lam)), map.shape, 1).record[0]
        return [np.max(error) for error in errors(map, ExactMap(map, 30), own, list(found))]

    place, direction = largest()
    assert place <= 1
    assert direction <= 8
    monkeypatch.setattr(map.family, "refines", False)
    assert lam == "0" or largest()[0] > 1
