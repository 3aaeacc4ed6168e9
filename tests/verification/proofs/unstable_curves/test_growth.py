"""Growth of curves, compared with a computation cell by cell."""

from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from broken_line import CHARTS
from scipy.sparse import csr_matrix

from verification.proofs.unstable_curves.growth import growth

ROUND = SimpleNamespace(charts=CHARTS, joins=((0, 1), (1, 2), (2, 0)))


@pytest.fixture
def uneven(by_hand, some_cells):
    """Makes a cone field on a random half of the cells, with random stretches and edges."""

    def made(seed, joins=ROUND.joins):
        rng = np.random.default_rng(seed)
        region = by_hand(SimpleNamespace(charts=CHARTS, joins=joins), cells=some_cells(seed), slopes=(-0.3, 0.1))
        count = region.cells.chart.size
        edges = rng.random((count, count)) < 0.03
        edges[np.arange(count), rng.integers(0, count, count)] = True
        return replace(region, inner=csr_matrix(edges.astype(float)), least=rng.random(count) - 0.2)

    return made


def places(region):
    """The cells as triples (chart, column, row)."""
    return list(zip(*(field.tolist() for field in region.cells[:3]), strict=True))


def across(region, values, reach):
    """For each cell its value, plus, for each join beside it, the largest value within `reach` rows across it."""
    held, last = dict(zip(places(region), values, strict=True)), region.grid.columns - 1
    found = []
    for (chart, column, row), value in held.items():
        more = 0.0
        for before, after in region.map.joins:
            for end, there in (((before, last), (after, 0)), ((after, 0), (before, last))):
                if (chart, column) == end:
                    near = [held.get((*there, row + j), 0.0) for j in range(-reach, reach + 1)]
                    more += max(near)
        found.append(value + more)
    return found


@pytest.mark.parametrize("seed", range(3))
def test_sums_of_inverse_stretches_are_those_of_the_worst_way(uneven, seed):
    region = uneven(seed)
    reach = 2  # cells are 1/2 wide in the second chart and 1/4 high: 2*0.3*(1/2)/(1/4) = 1.2
    held = dict(zip(places(region), np.exp(-region.least), strict=True))
    beside = list(product((-1, 0, 1), range(-reach, reach + 1)))
    weight = [max(held.get((c, i + k, j + n), 0.0) for k, n in beside) for c, i, j in held]
    value, edges = [1.0] * len(held), region.inner.toarray()
    found = growth(region, 5)
    assert found.reach == reach
    for total in found.sums:
        there = across(region, value, reach)
        value = [w * max(there[k] for k in np.flatnonzero(row)) for w, row in zip(weight, edges, strict=True)]
        assert max(value) <= total <= max(value) * (1 + 1e-11)
    assert len(found.sums) == 5
    assert found.bounces is None
