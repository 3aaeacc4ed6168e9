"""Columns that images of labels leave or whose middles they cross, for piecewise straight images by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from verification.arithmetic.arrays import BallArray
from verification.proofs.starts.labels import Labels
from verification.rigorous.boxes import Chart

FINE = 1 << 14  # rows that tell where a curve crosses


RATES = np.array([[1.0, 2.0, 4.0, 1.0], [2.0, 1.0, 1.0, 3.0]])  # of the parts of two labels
WIDE, CENTRE = 0.25 / 4, 0.4375  # of a part; where both middles land


def spread_of(turned: bool, radius: float = 0.0, off: float = 0.0, tall: float = 0.0):
    """The spread of images of three labels in a row, the second broken; middles land within `off` of the centre."""
    charts = Chart("short", (0.0, 1.0), (-1.0, 1.0)), Chart("long", (1.0, 3.0), (-2.0, 2.0))
    found = Labels(SimpleNamespace(charts=charts, closed=False), 8, FINE)
    found.add(np.array([0, 0, 0]), np.array([1, 1, 2]), np.array([2, 3, 2]))
    rates = np.concatenate([RATES[0], [9.0] * 4, RATES[1]]) * (-1 if turned else 1)
    label = np.repeat(np.arange(3), 4)
    where = SimpleNamespace(stretch=BallArray(rates, np.full(12, radius)))
    middle = SimpleNamespace(
        source=np.array([2, 0, 1]), chart=np.zeros(3, dtype=int), theta=BallArray(np.full(3, CENTRE), np.full(3, off)),
        phi=BallArray(np.array([0.25, -0.25, 7.0]), np.full(3, tall)),
    )  # fmt: skip
    cast = SimpleNamespace(
        landed=where, label=label, part=np.tile(np.arange(4), 3), middle=middle,
        broken=np.array([False, True, False]), rising=np.full(3, not turned),
        slopes=(np.array([-0.5, 0, -0.25]), np.array([0.5, 0, 0.25])),
    )  # fmt: skip
    none = np.full((2, 8), np.inf), np.full((2, 8), -np.inf)
    return found, found.spread(cast, none)


@pytest.mark.parametrize("turned", [False, True])
def test_images_leave_columns_between_two_places(turned):
    """Random images whose parts are stretched by rates from the balls, and whose middle lands at several places."""
    radius, off = 0.125, 0.0078125
    _, told = spread_of(turned, radius, off)
    rng, tight = np.random.default_rng(1), [[], []]
    at = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    for label, rates in ((0, RATES[0]), (2, RATES[1])):
        own = told.targets.source == label
        border = (told.targets.column[own] + 1) * 0.25
        seen = []
        for way in (-1, 1, *rng.uniform(-1, 1, (40, 4))):
            for shift in (-off, 0.0, off):
                rate = (rates + radius * way)[:: -1 if turned else 1]
                nodes = np.concatenate([[0], np.cumsum(rate * WIDE)])
                nodes = nodes - nodes[2] + CENTRE + shift
                columns = np.floor(nodes[[0, -1]] / 0.25)
                assert set(np.arange(columns[0], columns[1] + 1)) <= set(told.targets.column[own])
                seen.append(np.interp(border, nodes, at))
        low, high = np.min(seen, axis=0), np.max(seen, axis=0)
        assert np.all(told.leaves[0][own] <= low)
        assert np.all(high <= told.leaves[1][own])
        tight[0] += list(low - told.leaves[0][own])
        tight[1] += list(told.leaves[1][own] - high)
    assert max(*tight[0], *tight[1]) < 1e-9
