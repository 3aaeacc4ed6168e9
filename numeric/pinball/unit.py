"""The unit of length and the origin in which a map computes: the table's own, or others if numbers would lose digits.

Products of four lengths must stay far from the ends of float64, and no digit should be lost to a distance from the
origin. So a table whose size is outside `RANGE` is divided by a power of two, and one that is `AWAY` times its size
from the origin is moved to it, exactly and before anything is rounded. Results are converted back.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.flights.family import Boundary

RANGE = 2.0**-16, 2.0**16  # sizes (half the longer side of a box round a table) that are left as they are
AWAY = 16.0  # times the size: up to this distance from the origin a table stays where it is
FLAT = 2.0**-200  # the shorter side of the box over the longer one
LEAST = 2.0**-960  # size of a table
PLACES = 9  # points on each component, for the box


class Unit(NamedTuple):
    """An exact change of unit and origin: table's point = map's point times `length` (a power of two) plus `(x, y)`."""

    length: float = 1.0
    x: float = 0.0
    y: float = 0.0

    def point(self, x: NDArray[Any], y: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        """The point of the table at a map's own coordinates.

        >>> Unit(4.0, 100.0, 0.0).point(np.array(0.5), np.array(0.25))
        (np.float64(102.0), np.float64(1.0))
        """
        return (x, y) if self == ONE else (x * self.length + self.x, y * self.length + self.y)

    def restore(self, rows: Mapping[str, NDArray[Any]]) -> None:
        """Converts the arrays `x` and `y`, if they are among `rows`, to the table's own coordinates, in place."""
        if self != ONE:
            for name, away in (("x", self.x), ("y", self.y)):
                if name in rows:
                    rows[name][...] = rows[name] * self.length + away


ONE = Unit()


def unit_of(boundary: Boundary) -> Unit:
    """The unit and origin for which a table has a size of about 1 and lies near the origin; `ONE` for an ordinary
    table.

    `ValueError` if points do not fit float64, or if the table is flatter than `FLAT`.
    """
    name = boundary.ir.table
    if boundary.ir.same_as:
        return ONE
    with np.errstate(all="ignore"):
        try:
            ends = enumerate(boundary.ends)
            points = [boundary.curve_on(index, np.linspace(low, high, PLACES), 2) for index, (low, high) in ends]
            low, high = np.min(points, axis=(0, 2)), np.max(points, axis=(0, 2))
        except OverflowError:  # a number of the formula does not fit float64
            low, high = np.full(2, -np.inf), np.full(2, np.inf)
        sides, middle = 0.5 * high - 0.5 * low, 0.5 * low + 0.5 * high
    size = float(np.max(sides))
    if not LEAST < size < 1 / LEAST:
        raise ValueError(f"{name}: its points do not fit float64; accepted: a size from {LEAST:.3g} to {1 / LEAST:.3g}")
    if np.min(sides) < FLAT * size:
        shown = " by ".join(f"{2 * side:.6g}" for side in sides)
        raise ValueError(f"{name}: a box of {shown} is too flat for float64; accepted: sides whose ratio is below 1e60")
    length = 1.0 if RANGE[0] <= size <= RANGE[1] else float(np.ldexp(1.0, int(np.frexp(size)[1])))
    if np.max(np.abs(middle)) <= AWAY * size:
        return Unit(length)
    x, y = np.rint(middle / length) * length
    return Unit(length, float(x) + 0.0, float(y) + 0.0)
