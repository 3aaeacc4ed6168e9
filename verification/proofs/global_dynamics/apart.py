"""Sets of cells that grow from a few: all that their images meet, again and again; and regions kept apart.

A set that has stopped growing is taken into its interior. Only its cells are kept in mind, by their numbers, so that
the grid may be as fine as the gap between two thin sets asks for.

A table that turns by thirds has three copies of each set. A set grown from about an end of one diameter that has no
point in common with its turned copies says that *three regions, one about each diameter, hold an attractor each, or
more*, and that no orbit that starts near that end ever comes near one of its copies.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from verification.proofs.global_dynamics.boxes import Boxes, BoxMap, Images
from verification.proofs.global_dynamics.graph import BLOCK, LARGEST, Cells, Grid, Rectangles, mapped, ranges
from verification.proofs.global_dynamics.images import PinballImages

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
MOST = 1 << 22  # cells of a set that grows
BESIDE = (-1, 0, 1)


def reached(
    map: BoxMap, grid: Grid, start: Boxes, parts: int, turns: Sequence[int] = (), most: int = MOST
) -> Indices | None:
    """The numbers of the cells that boxes and, again and again, their images meet, in order; or None.

    It is None where a box is lost or leaves the charts, where there are more than `most` cells, and where one of them
    touches one of the others turned by so many columns.
    """
    member = new = numbered(grid, grid.met(Images(np.arange(start.chart.size), start, np.zeros(0, dtype=np.int64))))
    while new.size:
        if member.size > most or _touches(grid, new, member, turns):
            return None
        found = list[Indices]()
        for first in range(0, new.size, BLOCK):
            met, lost = mapped(map, grid, cells(grid, new[first : first + BLOCK]), parts)
            if lost.any() or met.out.any():
                return None
            found.append(numbered(grid, met))
        after = _ordered(np.concatenate(found))
        new = after[~_held(after, member)]
        member = np.sort(np.concatenate((member, new)))  # which have none in common
    return member


def numbered(grid: Grid, met: Rectangles) -> Indices:
    """The numbers of the cells of rectangles, in order: `(chart*columns + column)*rows + row`."""
    across, high = met.right - met.left + 1, met.top - met.bottom + 1
    owner = np.repeat(np.arange(across.size), across)
    column = met.chart[owner] * grid.columns + ranges(met.left, met.right + 1) % grid.columns
    first = column * grid.rows + met.bottom[owner]
    return _ordered(ranges(first, first + high[owner]))


def cells(grid: Grid, numbers: Indices) -> Cells:
    """The cells with these numbers."""
    column = numbers // grid.rows
    return Cells(column // grid.columns, column % grid.columns, numbers % grid.rows, np.ones_like(numbers))


def _ordered(numbers: Indices) -> Indices:
    """Each number once, in order; where most stand side by side, sorting is quicker than the tables of `np.unique`."""
    found = np.sort(numbers)
    return found[np.append(True, found[1:] != found[:-1])] if found.size else found


def _held(some: Indices, ordered: Indices) -> NDArray[np.bool_]:
    """Which numbers are among others, which are in order."""
    if not ordered.size:
        return np.zeros(some.shape, dtype=bool)
    place = np.minimum(np.searchsorted(ordered, some), ordered.size - 1)
    return np.asarray(ordered[place] == some)


def _touches(grid: Grid, new: Indices, member: Indices, turns: Sequence[int]) -> bool:
    """Has a new cell, turned one way or the other, a point in common with a cell of the set?"""
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


def kept_apart(map: PinballImages, grid: tuple[int, int, int], start: Boxes | None) -> Array | None:
    """The polar angles of a trapping region grown from boxes, apart from its copies turned by thirds; or None.

    `grid` is columns, a multiple of three, rows and parts; the map is that of a table which turns by thirds.
    """
    if start is None or grid[0] % 3 or not map.closed:
        return None
    fine = Grid(map.charts, *grid[:2], most=LARGEST**2)
    member = reached(map, fine, start, grid[2], (grid[0] // 3,))
    if member is None:
        return None
    low, high = map.charts[0].x
    return low + (high - low) * (np.unique(cells(fine, member).column) + 0.5) / grid[0]
