"""How a trajectory ended, by name."""

from enum import Enum


class Status(Enum):
    """The outcome of a trajectory. All but `REGULAR` stop the ball, which keeps its last good state."""

    REGULAR = "every bounce is defined"
    JOIN = "lands within rounding of a point where two components meet"
    CUSP = "lands within rounding of a cusp, where the map is undefined"
    GRAZING = "tangent to the boundary: there is no next bounce"
    LOST = "no landing point was found; the table is not closed"

    @property
    def code(self) -> int:
        """The number that kernels use."""
        return list(Status).index(self)
