"""Absorbing sets: the cells that a few boxes and all their later images meet, when these are finitely many.

The map takes such a set into its interior. Only the indices of its cells are stored, so the grid may be as fine as the
gap between two thin sets requires.

On a table with a threefold rotation symmetry every set has three copies. Let a set be grown from boxes near an end of
one diameter. If it has no point in common with its rotated copies, then *each of three disjoint regions, one about each
diameter, holds at least one attractor*, and no orbit that starts near the chosen end comes near one of its rotated
copies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verification.arithmetic.arrays import Array, Indices, Mask
from verification.rigorous.boxes import Boxes, BoxMap, Images
from verification.rigorous.graph import BLOCK, CELLS, LARGEST, Cells, Grid, Rectangles, mapped, ranges

MOST = 1 << 22  # the most cells that a growing set may have
BESIDE = (-1, 0, 1)


def reached(
    map: BoxMap, grid: Grid, start: Boxes, parts: int, turns: Sequence[int] = (), most: int = MOST
) -> Indices | None:
    """The sorted indices of all cells that the boxes `start` and their later images meet; or None.

    Cells are cut into `parts` by `parts` pieces before they are mapped. None is returned if there are no boxes, if an
    image is not enclosed, if a box or an image leaves the charts, if there are more than `most` cells, or if the set
    touches a copy of itself that is shifted by one of the `turns`, in columns.
    """
    first = grid.met(Images.exact(start))
    if first.out.any() or not first.source.size:
        return None
    member = new = numbered(grid, first)
    while new.size:
        if member.size > most or _touches(grid, new, member, turns):
            return None
        found = list[Indices]()
        for at in range(0, new.size, BLOCK):
            met, lost = mapped(map, grid, cells(grid, new[at : at + BLOCK]), parts)
            if lost.any() or met.out.any():
                return None
            found.append(numbered(grid, met))
        after = _ordered(np.concatenate(found))
        new = after[~_held(after, member)]
        member = np.sort(np.concatenate((member, new)))  # disjoint
    return member


def numbered(grid: Grid, met: Rectangles) -> Indices:
    """The sorted indices `(chart*columns + column)*rows + row` of the cells in the rectangles `met`."""
    across, high = met.right - met.left + 1, met.top - met.bottom + 1
    owner = np.repeat(np.arange(across.size), across)
    column = met.chart[owner] * grid.columns + ranges(met.left, met.right + 1) % grid.columns
    first = column * grid.rows + met.bottom[owner]
    return _ordered(ranges(first, first + high[owner]))


def cells(grid: Grid, numbers: Indices) -> Cells:
    """The cells with the given indices."""
    column = numbers // grid.rows
    return Cells(column // grid.columns, column % grid.columns, numbers % grid.rows, np.ones_like(numbers))


def _ordered(numbers: Indices) -> Indices:
    """The distinct numbers, sorted; this is faster than `np.unique` if many numbers are neighbours."""
    found = np.sort(numbers)
    return found[np.append(True, found[1:] != found[:-1])] if found.size else found


def _held(some: Indices, ordered: Indices) -> Mask:
    """A mask of those numbers in `some` that are in the sorted array `ordered`."""
    if not ordered.size:
        return np.zeros(some.shape, dtype=bool)
    place = np.minimum(np.searchsorted(ordered, some), ordered.size - 1)
    return np.asarray(ordered[place] == some)


def _touches(grid: Grid, new: Indices, member: Indices, turns: Sequence[int]) -> bool:
    """True if a new cell, shifted by one of the `turns` either way, has a point in common with a cell of `member`."""
    at = cells(grid, new)
    for turn in {sign * t for t in turns for sign in (1, -1)}:
        for right in BESIDE:
            for up in BESIDE:
                row = at.row + up
                column = at.chart * grid.columns + (at.column + turn + right) % grid.columns
                beside = (column * grid.rows + row)[(row >= 0) & (row < grid.rows)]
                if np.any(_held(beside, member)):
                    return True
    return False


@dataclass(frozen=True, eq=False)
class AbsorbingSet:
    """Cells that the map takes into the interior of their union; `numbers` are the sorted indices of the cells."""

    grid: Grid
    numbers: Indices

    @property
    def cells(self) -> Cells:
        """The cells by chart, column and row."""
        return cells(self.grid, self.numbers)

    @property
    def boxes(self) -> Boxes:
        """The cells as boxes."""
        return self.grid.boxes(self.cells)

    def meets(self, boxes: Boxes) -> bool:
        """True if some of the boxes may have a point in common with the set."""
        return bool(np.any(_held(numbered(self.grid, self.grid.met(Images.exact(boxes))), self.numbers)))

    def holds(self, boxes: Boxes) -> bool:
        """True if all boxes lie in the set."""
        met = self.grid.met(Images.exact(boxes))
        return not met.out.any() and bool(np.all(_held(numbered(self.grid, met), self.numbers)))


def grown(map: BoxMap, grid: tuple[int, int, int], start: Boxes) -> AbsorbingSet | None:
    """The absorbing set grown from the boxes `start`; None if the growth does not end or an image is not enclosed.

    `grid` is the number of columns, of rows, and of parts in each direction into which a cell is cut before it is
    mapped.
    """
    fine = Grid(map.charts, *grid[:2])
    numbers = reached(map, fine, start, grid[2], most=CELLS)
    return None if numbers is None else AbsorbingSet(fine, numbers)


def kept_apart(map: BoxMap, grid: tuple[int, int, int], start: Boxes | None) -> Array | None:
    """The polar angles of a trapping region that grows from `start` and is disjoint from its copies, or None.

    The copies are rotated by 120 and 240 degrees; the table has this symmetry. An angle is given for each column of
    cells that the region meets. `grid` is as for `grown`, with a multiple of three columns.
    """
    if start is None or grid[0] % 3 or not map.charts[0].period:
        return None
    fine = Grid(map.charts, *grid[:2], most=LARGEST**2)
    member = reached(map, fine, start, grid[2], (grid[0] // 3,))
    if member is None:
        return None
    low, high = map.charts[0].x
    return low + (high - low) * (np.unique(cells(fine, member).column) + 0.5) / grid[0]
