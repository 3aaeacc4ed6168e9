"""Boundaries of cubic pieces: against the exact map, and against every piece tried."""

from functools import cache

import numpy as np
import pytest

from numeric import PinballMap
from numeric.flights.family import Boundary
from numeric.flights.general import General
from numeric.flights.registry import family_of
from numeric.kernels.engine import Engine
from numeric.kernels.machine import KernelSpec
from numeric.pinball.coordinates import States
from symbolic import tables
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.by_hand import cubic_hits
from verification.measure.extremes.orbits import bounced, spline_cases


def wavy(count, depth):
    """Points of an ellipse with three dents."""
    angle = 2 * np.pi * np.arange(count) / count
    r = 1 + depth * np.cos(3 * angle)
    return [(f"{x:.6f}", f"{y:.6f}") for x, y in zip(1.5 * r * np.cos(angle), r * np.sin(angle), strict=True)]


HOLED = [
    [[(0, 0), (4, 0)], [(4, 0), (5, 2), (4, 3), (3, 3)], [(3, 3), (1, 2), (0, 4)], [(0, 4), (-1, 1), (0, 0)]],
    [[(1, 1), (2, 1)], [(2, 1), (2, 2), (1, 1)]],
]
TABLES = {
    "convex": lambda: tables.from_points(wavy(9, 0.02)),
    "many": lambda: tables.from_points(wavy(30, 0.03)),
    "dented": lambda: tables.from_points(wavy(12, 0.2)),
    "corners": lambda: tables.from_path(HOLED[:1]),
    "holed": lambda: tables.from_path(HOLED),
}


@cache
def mapped(name):
    return PinballMap(TABLES[name](), lam=0.9)


def starts(map, count, steep=1.45):
    rng = np.random.default_rng(5)
    return (
        rng.integers(0, len(map.ir.parts), count),
        rng.uniform(0.01, 0.99, count),
        rng.uniform(-steep, steep, count),
    )


@pytest.mark.parametrize("name", ["convex", "dented", "holed"])
def test_a_bounce_is_right_to_the_last_bits(name):
    map = mapped(name)
    assert map.family.name == "spline"
    assert map.family.few
    assert map.family.convex == (name in ("convex", "many"))
    where, at, phi = starts(map, 12)
    own = map.states.enter(where, at, phi, map.law)
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(at.size, 0.9), map.shape, 1)
    going = result.rows["code"] == 0
    assert np.mean(going) > 0.95
    before, after = [row[going] for row in own], [row[going] for row in result.record[0]]
    position, direction = errors(map, ExactMap(map, 30), before, after)
    eta = map.step(at[going], phi[going], where[going]).eta
    assert np.max(position * np.cos(eta)) < 4  # in units of 2**-52
    assert np.max(direction * np.cos(eta)) < 8


@pytest.mark.parametrize("name", TABLES)
def test_the_first_hit_is_that_of_the_flight_that_tries_every_piece(name):
    fast = mapped(name)
    slow = PinballMap(TABLES[name](), lam=0.9, kernels=False)
    slow.family = General(Boundary(slow.ir, []))
    slow.states = States(slow.family)
    slow.engine = Engine(slow.family, "", [], False)
    where, at, phi = starts(fast, 4000, 1.57)
    a, b = fast.step(at, phi, where), slow.step(at, phi, where)
    both = (a.code == 0) & (b.code == 0)
    assert np.mean(both) > 0.999
    off = both & (np.hypot(a.x - b.x, a.y - b.y) * np.cos(a.eta) > 1e-12)
    assert not np.any(off)


@pytest.mark.parametrize("name", ["convex", "dented", "holed", "from a tree"])
def test_hard_flights_land_where_every_zero_of_every_cubic_in_eighty_bits_says(name):
    """Short ones along the wall among them, whose landing lies within 1e-12 of the start."""
    tree = name == "from a tree"
    map = PinballMap(TABLES["dented"](), lam=0.9, kernels=False) if tree else mapped(name)
    if tree:
        map.family.few = False  # as where there are more than `numeric.flights.spline.SCANNED` pieces
    lost = 0
    for case in spline_cases(name, map, 1000):
        own, after, going = bounced(case)
        truth = cubic_hits(map, own)
        x, y = map.states.point(after[0].astype(int), after[1])
        size, sure = max(np.max(np.abs(x)), np.max(np.abs(y))), going & truth.sure
        aside = (np.hypot(x - truth.x, y - truth.y).astype(float)[sure]) * truth.straight[sure]
        assert np.all(aside < 4 * 2.0**-52 * size), case.label
        lost += np.sum(truth.sure & ~going)
    assert lost == 0 or map.family.convex  # what stops a particle is an end of a piece within rounding


@pytest.mark.parametrize("name", ["many", "dented"])
def test_arrays_give_what_kernels_give(name):
    fast = mapped(name)
    where, at, phi = starts(fast, 500)
    a = fast.step(at, phi, where)
    b = PinballMap(TABLES[name](), lam=0.9, kernels=False).step(at, phi, where)
    assert np.array_equal(a.code, b.code)
    assert np.nanmax(np.hypot(a.x - b.x, a.y - b.y) * np.cos(a.eta)) < 1e-14


def test_straight_sides_in_a_spline_go_to_the_closed_forms():
    table = tables.from_points([(0, 0), (3, 0), (3, 2), (0, 2)], smoothness=0)
    assert PinballMap(table, lam=0.5).family.name == "pieces"
    assert family_of(Boundary(mapped("convex").ir, [])).name == "spline"
