"""The proof that short unstable curves grow in spite of folds, by the sum of inverse stretches over their parts.

A smooth unstable curve `p` in one chart is mapped to a curve that may pass from one chart to the next, where it is cut
into smooth *parts*. For `n` bounces `p` is the union of arcs `p_i`; each arc is mapped to a smooth part and stretched
by a factor of at least `L_i` in the chart's parameter. As the lengths of the arcs add up to that of `p`,

    max length of a part  >=  length of p / sum(1/L_i),

so if that sum is below 1 for all curves, every curve grows. (Collet and Levy for the Lozi map; in the theory of
billiards this is the one-step expansion of an iterate.)

A curve *crosses* a column of cells if it lies over all of it. A curve over a chart that crosses no column lies over two
columns at most, next to each other, and changes its height by no more than twice the greatest slope times the width of
a column. So if it is in a cell, it is within one column and `reach` rows of that cell; `stretch` is the least stretch
over these cells. Its image, if no part of it crosses a column, passes at most one join, and then has two parts, both in
the columns at that join, within `reach` rows of each other. With `V_0 = 1` for every cell, and

    V_n(b) = 1/stretch(b) * max over the edges b -> c of ( V_{n-1}(c), plus, where c is at a join,
             the greatest V_{n-1} of a cell across that join within `reach` rows ),

`V_n(b)` bounds the sum over `n` bounces for all curves that are in `b`, as long as no part crosses a column. Therefore
*if `V_n` is below 1 for every cell of a trapping region, each unstable curve in it has, after finitely many bounces, an
image with a smooth part that crosses a column.* Otherwise the longest part would grow without end, within two columns.
"""

from dataclasses import dataclass

import numpy as np

from numeric.backends import elementary
from verification.arithmetic.arrays import Array
from verification.proofs.unstable_curves.cover import ConeField

LONGEST = 60  # the most bounces over which the sum is taken
UP = 1 + 1e-13  # above the rounding of a step in float64


@dataclass(frozen=True)
class CurveGrowth:
    """Bounds `sums[n - 1]` of the sum of inverse stretches over `n` bounces, for every curve that crosses no column.

    `reach` is the number of rows by which such a curve may rise or fall within its columns.
    """

    sums: tuple[float, ...]
    reach: int

    @property
    def bounces(self) -> int | None:
        """The number of bounces after which the sum is below 1 for every curve; None if there is no such number."""
        return len(self.sums) if self.sums[-1] < 1 else None


def growth(cover: ConeField, longest: int = LONGEST) -> CurveGrowth:
    """The bounds of the sum of inverse stretches, up to the first number of bounces for which they are all below 1."""
    reach = _reach(cover)
    weight = _about(cover, elementary.exp(-cover.least) * UP, reach)
    value, sums, starts = np.ones(weight.size), list[float](), cover.inner.indptr[:-1]
    while len(sums) < longest:
        landing = folded(cover, value, reach) * UP
        value = weight * np.maximum.reduceat(landing[cover.inner.indices], starts) * UP
        sums.append(float(value.max()))
        if sums[-1] < 1:
            break
    return CurveGrowth(tuple(sums), reach)


def folded(cover: ConeField, value: Array, reach: int) -> Array:
    """The values of cells; for a cell at a join the greatest value across the join, within `reach` rows, is added."""
    picture, found, cells = cover.to_array(value, 0.0), value.copy(), cover.cells
    last = cover.grid.columns - 1
    for before, after in cover.map.joins:
        for here, column, there, across in ((before, last, after, 0), (after, 0, before, last)):
            on = np.flatnonzero((cells.chart == here) & (cells.column == column))
            found[on] += _greatest(picture[there, across], reach, axis=0)[cells.row[on]]
    return found


def _reach(cover: ConeField) -> int:
    """The number of rows by which a curve may rise or fall over two columns."""
    low, high = cover.steepest
    steep = np.maximum(np.abs(low), np.abs(high))
    steep[~np.isfinite(steep)] = 0.0  # charts without cells
    wide, tall = cover.sides
    return int(np.ceil(np.max(2 * steep * wide / tall) * (1 + 1e-9)))


def _about(cover: ConeField, values: Array, reach: int) -> Array:
    """The greatest value within one column and `reach` rows of each cell."""
    first, last = cover.cells.row.min(), cover.cells.row.max()
    picture = cover.to_array(values, 0.0)[:, :, first : last + 1]  # rows beyond hold nothing
    picture = _greatest(_greatest(picture, 1, axis=1), reach, axis=2)
    found: Array = picture[cover.cells.chart, cover.cells.column, cover.cells.row - first]
    return found


def _greatest(values: Array, reach: int, axis: int) -> Array:
    """For each entry the greatest of the entries at most `reach` places before or after it."""
    turned = np.moveaxis(values, axis, 0)
    found = turned.copy()
    for step in range(1, min(reach, len(turned)) + 1):
        found[step:] = np.maximum(found[step:], turned[:-step])
        found[:-step] = np.maximum(found[:-step], turned[step:])
    return np.moveaxis(found, 0, axis)
