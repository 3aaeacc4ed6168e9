"""How a trajectory ended, by name."""

from enum import Enum


class Status(Enum):
    """The outcome of a trajectory. All but `REGULAR` stop the ball, which keeps its last good state.

    `code` is the number that kernels use.

    >>> Status.CUSP.code, Status.CUSP.value
    (2, 'lands within rounding of a cusp, where the map is undefined')
    """

    code: int

    def __new__(cls, code: int, meaning: str) -> "Status":
        member = object.__new__(cls)
        member._value_, member.code = meaning, code
        return member

    REGULAR = 0, "every bounce is defined"
    JOIN = 1, "lands within rounding of a point where two components meet"
    CUSP = 2, "lands within rounding of a cusp, where the map is undefined"
    GRAZING = 3, "tangent to the boundary: there is no next bounce"
    LOST = 4, "no landing point was found; the table is not closed"
