"""The last step of a landing has more digits: on any formula, splines, sides and arcs its own rounding is left."""

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


@pytest.mark.parametrize(
    "table", [tables.stadium(), tables.diamond(), tables.sinai(), tables.regular(40)], ids=lambda table: table.name
)
@pytest.mark.parametrize("lam", ["0", "0.9"])
def test_landings_on_sides_and_arcs_are_right_to_the_last_bits(table, lam, monkeypatch):
    """Random flights; in doubles some on the diamond are off by several roundings, and those on 40 sides by more."""
    random, count = np.random.default_rng(5), 4 if len(table.components) > 10 else 30
    map = PinballMap(table, lam=lam, kernels=False)
    low, high = np.array(map.states.ends).T
    where = random.integers(0, low.size, count)
    theta = low[where] + (high - low)[where] * random.random(count)
    phi = np.arcsin(random.uniform(-1, 1, count)) * (lam != "0")

    def largest():
        own = map.states.enter(where, theta, phi, map.law)
        lams = np.full(count, float(lam))
        found = map.engine.run(KernelSpec(map.law, record=True), own, lams, map.shape, 1).record[0]
        return [np.max(error) for error in errors(map, ExactMap(map, 30), own, list(found))]

    place, direction = largest()
    assert place <= 1
    assert direction <= 4
    monkeypatch.setattr(map.family, "refines", False)
    assert table.name not in ("diamond", "regular40") or largest()[0] > 1
