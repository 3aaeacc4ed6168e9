"""Covers of a few cells, written by hand, for tests of single steps."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.graph import Cells, Grid
from verification.proofs.unstable_curves.affine import BrokenLine
from verification.proofs.unstable_curves.cover import Cover, cover


@pytest.fixture(scope="session")
def by_hand():
    """Makes a cover with the same cone and stretch everywhere; of all cells, unless some are given."""

    def made(map, columns=4, rows=8, cells=None, slopes=(-0.25, 0.5), sign=1, most=0.0):
        grid = Grid(map.charts, columns, rows)
        cells = grid.whole() if cells is None else cells
        count = cells.chart.size
        full = lambda x: np.full(count, float(x))  # noqa: E731
        cones, signs = (full(slopes[0]), full(slopes[1])), (sign,) * len(map.charts)
        return Cover(map, grid, cells, csr_matrix((count, count)), cones, cones, full(most), full(most), full(0), signs)

    return made


@pytest.fixture(scope="session")
def some_cells():
    """Makes a random half of the cells of charts; one column has none, nor have some of the lowest rows."""

    def made(seed, charts=3, columns=4, rows=8):
        chart, column, row = np.nonzero(np.random.default_rng(seed).random((charts, columns, rows)) < 0.5)
        kept = ((chart != 1) | (column != 2)) & (row >= seed % 3)
        return Cells(chart[kept], column[kept], row[kept], np.ones(kept.sum(), dtype=int))

    return made


@pytest.fixture(scope="session")
def bent():
    """A tent with a thin fibre on 64 by 16 cells, from its fixed point: slopes of 1.5 and -1.75."""
    map = BrokenLine(((-2.0, -1.75), (0.0, 1.25), (2.0, -2.25)), 0.0625, 0.125)
    x = 1.25 / (1 + 1.75 - 0.0625)
    start = Boxes(np.array([1]), (np.array([x]),) * 2, (np.array([x / 16]),) * 2)
    return cover(map, 64, 16, start)
