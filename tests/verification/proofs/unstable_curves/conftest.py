"""Fixtures: cone fields on grids of few cells."""

import numpy as np
import pytest
from broken_line import BrokenLine
from scipy.sparse import csr_matrix

from verification.proofs.unstable_curves.cover import ConeField, cover
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Cells, Grid


@pytest.fixture(scope="session")
def by_hand():
    """Makes a cone field with the same cone and stretch on all cells, or on given ones."""

    def made(map, columns=4, rows=8, cells=None, slopes=(-0.25, 0.5), sign=1, most=0.0):
        grid = Grid(map.charts, columns, rows)
        cells = grid.whole() if cells is None else cells
        count = cells.chart.size
        full = lambda x: np.full(count, float(x))  # noqa: E731
        cones, signs = (full(slopes[0]), full(slopes[1])), (sign,) * len(map.charts)
        return ConeField(map, grid, cells, csr_matrix((count, count)), cones, cones, full(most), full(most), signs)

    return made


@pytest.fixture(scope="session")
def some_cells():
    """Makes a random half of the cells of charts; one column and some of the lowest rows stay empty."""

    def made(seed, charts=3, columns=4, rows=8):
        chart, column, row = np.nonzero(np.random.default_rng(seed).random((charts, columns, rows)) < 0.5)
        kept = ((chart != 1) | (column != 2)) & (row >= seed % 3)
        return Cells(chart[kept], column[kept], row[kept], np.ones(kept.sum(), dtype=int))

    return made


@pytest.fixture(scope="session")
def bent():
    """A tent map with a thin fibre and slopes 1.5 and -1.75, on 64 by 16 cells, grown from its fixed point."""
    map = BrokenLine(((-2.0, -1.75), (0.0, 1.25), (2.0, -2.25)), 0.0625, 0.125)
    x = 1.25 / (1 + 1.75 - 0.0625)
    start = Boxes(np.array([1]), (np.array([x]),) * 2, (np.array([x / 16]),) * 2)
    return cover(map, 64, 16, start)
