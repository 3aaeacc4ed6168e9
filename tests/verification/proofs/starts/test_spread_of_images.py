"""Where images of labels leave columns, and where they cross their middles: piecewise straight ones, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.starts import labels as labels_of
from verification.proofs.starts.labels import Labels

FINE = 1 << 14  # rows that tell where a curve crosses


RATES = np.array([[1.0, 2.0, 4.0, 1.0], [2.0, 1.0, 1.0, 3.0]])  # of the parts of two labels
WIDE, CENTRE = 0.25 / 4, 0.4375  # of a part; where both middles land


def spread_of(turned: bool, radius: float = 0.0, off: float = 0.0, tall: float = 0.0):
    """Images of two labels of a row of three, the second of which is broken; the middles land within `off`."""
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


def between(found: Labels, told) -> list[tuple[float, float]]:
    """The angles of the rows that are told, from below to above."""
    high, foot = found.high[told.chart], found.bottom[told.chart]
    return list(zip(foot + told.bottom * high, foot + (told.top + 1) * high, strict=True))


@pytest.mark.parametrize("turned", [False, True])
def test_an_image_leaves_columns_where_its_stretched_parts_end(turned):
    """Without errors: where the piecewise straight image of a column crosses borders, in shares of the source."""
    found, told = spread_of(turned)
    at = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    for label, rate in ((0, RATES[0]), (2, RATES[1])):
        rate = rate[::-1] if turned else rate
        nodes = np.concatenate([[0], np.cumsum(rate * WIDE)])
        nodes = nodes - nodes[2] + CENTRE
        own = told.targets.source == label
        column = told.targets.column[own]
        first, last = int(np.floor(nodes[0] / 0.25 - 1e-9)), int(np.floor(nodes[-1] / 0.25 + 1e-9))
        assert column.tolist() == list(range(first, last + 1))
        exact = np.interp((column + 1) * 0.25, nodes, at)
        assert told.leaves[0][own] == pytest.approx(exact, abs=1e-10)
        assert told.leaves[1][own] == pytest.approx(exact, abs=1e-10)
        assert np.all(told.leaves[0][own] < exact)
        assert np.all(told.leaves[1][own] > exact)
        assert told.last[own].tolist() == [False] * (column.size - 1) + [True]
        phi, slope = ((-0.25, 0.5), (0.25, 0.25))[label // 2]
        for (foot, head), c in zip(between(found, told.targets), column, strict=False) if label == 0 else ():
            reach = slope * (abs((c + 0.5) * 0.25 - CENTRE) + 0.25)
            assert foot <= phi - reach < foot + 2.1 * found.high[0]
            assert head - 2.1 * found.high[0] < phi + reach <= head
    assert set(told.targets.source.tolist()) == {0, 2}


@pytest.mark.parametrize("turned", [False, True])
def test_where_stretching_and_landing_are_not_exact_images_leave_columns_between_two_places(turned):
    """Of images whose parts are stretched by any of the rates, and whose middle lands anywhere: some are tried."""
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


def test_an_image_over_the_middles_of_columns_crosses_them_within_the_way_from_its_own_middle():
    """A landing that is known within 1/16: the way to a middle is as uncertain."""
    found, told = spread_of(False, off=0.0625, tall=0.125)
    for (foot, head), label, c in zip(
        between(found, told.targets), told.targets.source, told.targets.column, strict=True
    ):
        phi, slope = {0: (-0.25, 0.5), 2: (0.25, 0.25)}[int(label)]
        reach = slope * (abs((c + 0.5) * 0.25 - CENTRE) + 0.0625 + 0.25) + 0.125
        assert foot <= phi - reach < foot + 2.1 * found.high[0]
        assert head - 2.1 * found.high[0] < phi + reach <= head


@pytest.mark.parametrize("turned", [False, True])
def test_roundings_of_the_stretching_are_covered(monkeypatch, turned):
    """Without anything else for them shares still lie on either side of the exact ones, away from the middle."""
    monkeypatch.setattr(labels_of, "SLOP", 0.0)
    _, told = spread_of(turned)
    for label, rate in ((0, RATES[0]), (2, RATES[1])):
        nodes = np.concatenate([[0], np.cumsum((rate[::-1] if turned else rate) * WIDE)])
        nodes = nodes - nodes[2] + CENTRE
        own = told.targets.source == label
        border = (told.targets.column[own] + 1) * 0.25
        exact = np.interp(border, nodes, np.arange(5) / 4)
        inside = (nodes[0] + 0.01 < border) & (border < nodes[-1] - 0.01)
        assert np.any(inside)
        assert np.all(told.leaves[0][own][inside] < exact[inside])
        assert np.all(told.leaves[1][own][inside] > exact[inside])
