"""Boundaries of cubic pieces, compared with the exact map and with a trial of every piece."""

from functools import cache

import numpy as np
import pytest
from one_bounce import landing_errors

from numeric import PinballMap
from symbolic import tables
from verification.measure.extremes.by_hand import cubic_hits
from verification.measure.extremes.kernels import bounced
from verification.measure.extremes.orbits import spline_cases


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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["convex", "dented", "holed"])
def test_a_bounce_is_right_to_the_last_bits(name):
    map = mapped(name)
    assert map.family.name == "spline"
    assert map.family.few
    assert map.family.convex == (name in ("convex", "many"))
    where, at, phi = starts(map, 12)
    going, position, direction, straight = landing_errors(map, where, at, phi)
    assert np.mean(going) > 0.95
    assert np.max(position * straight) < 4  # in units of 2**-52
    assert np.max(direction * straight) < 8


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TABLES, "from a tree"])
def test_hard_flights_land_where_every_zero_of_every_cubic_in_eighty_bits_says(name):
    """They include short flights along the wall, whose landing lies within 1e-12 of the start."""
    tree = name == "from a tree"
    map = PinballMap(TABLES["dented"](), lam=0.9, kernels=False) if tree else mapped(name)
    if tree:
        map.family.few = False  # as where there are more than `numeric.flights.spline.SCANNED` pieces
    lost = 0
    for case in spline_cases(name, map, 1000):
        own, after, code = bounced(case.map, case[2:])
        going = code == 0
        truth = cubic_hits(map, own)
        x, y = map.states.point(after[0].astype(int), after[1])
        size, sure = max(np.max(np.abs(x)), np.max(np.abs(y))), going & truth.sure
        aside = (np.hypot(x - truth.x, y - truth.y).astype(float)[sure]) * truth.straight[sure]
        assert np.all(aside < 4 * 2.0**-52 * size), case.label
        lost += np.sum(truth.sure & ~going)
    assert lost == 0 or map.family.convex  # what stops a particle is an end of a piece within rounding
