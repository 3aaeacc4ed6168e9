"""That no chord meets the boundary on its way, in tables that need not be convex.

Along a chord from `p` in direction `d` a boundary point `q` lies on the line when `d x (q - p) = 0`.
The boundary is covered by balls: off the line, or on it but not between the ends, or next to an end,
where `d x q'` keeps its sign so that the line is crossed there once, at the end itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb

from symbolic.generation.text import kernel, load
from symbolic.tables.geometry import velocity
from symbolic.tables.symbols import theta
from symbolic.tables.table import Table
from verification.arithmetic.words import balls, working

BITS = 96
PIECES = 4000  # balls that one chord may use up
SMALLEST = 2.0**-48  # of the boundary; halves of halves must stay exact in floats
Frame = tuple[arb, ...]
Place = Callable[[arb], Frame]


@dataclass(frozen=True)
class Boundary:
    """A closed chain of components: point and velocity at a parameter of each, and the ends of its parameter."""

    places: Sequence[Place]
    ends: Sequence[tuple[arb, arb]]


def first_hits(table: Table, components: tuple[int, ...], zero: list[arb], shape: tuple[arb, ...] = ()) -> bool | None:
    """True when every chord of the cycle leaves inwards, arrives from inside, and meets nothing between.

    >>> from symbolic.tables import cardioid
    >>> with working(96):
    ...     third = arb.pi() / 3
    >>> first_hits(cardioid, (0, 0), [third, -third])
    True
    """
    with working(BITS):
        boundary = _boundary(table, shape)
        bounces = list(zip(components, zero, strict=False))
        chords = zip(bounces, bounces[1:] + bounces[:1], strict=True)
        return True if all(free(boundary, start, end) for start, end in chords) else None


def _boundary(table: Table, shape: tuple[arb, ...]) -> Boundary:
    def placed(index: int) -> Place:
        program = _places(table, index)
        return lambda at: program(at, *shape)

    ends = [
        tuple(load(kernel("end", [], {"end": e}), balls(BITS))()[0] + arb(0) for e in (component.start, component.end))
        for component in table.components
    ]
    return Boundary([placed(i) for i in range(len(table.components))], ends)


@cache
def _places(table: Table, index: int) -> Any:
    """The point and the velocity at a parameter of a component, in balls."""
    component = table.components[index]
    (x, y), (vx, vy) = component.point, velocity(component)
    letters = [theta, *(p.symbol for p in table.shapes)]
    return load(kernel("place", letters, {"x": x, "y": y, "vx": vx, "vy": vy}), balls(BITS))


def free(boundary: Boundary, start: tuple[int, arb], end: tuple[int, arb]) -> bool:
    """Does the chord leave inwards, arrive from inside, and meet nothing between? False when that is not proved.

    Call it inside `working`. `start` and `end` are a component and a ball of its parameter.
    """
    first, last = (boundary.places[component](at) for component, at in (start, end))
    p, d = first[:2], (last[0] - first[0], last[1] - first[1])
    if not (first[2] * d[1] - first[3] * d[0] > 0 and last[3] * d[0] - last[2] * d[1] > 0):
        return False  # the inward normal is (-vy, vx)
    spent = 0
    for index, (low, high) in enumerate(boundary.ends):
        bounces = [at for component, at in (start, end) if component == index]
        queue = [(0.5, 0.5)]
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > PIECES or half < SMALLEST:
                return False
            piece = low + (high - low) * arb(middle, half)
            near = [_between(boundary, index, at, piece) for at in bounces]
            if not _passes(boundary.places[index], piece, near, p, d):
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True


def _between(boundary: Boundary, index: int, at: arb, piece: arb) -> list[arb]:
    """Parameters that lead from a bounce to a piece: through the seam of a closed boundary where that is shorter."""
    low, high = boundary.ends[index]
    gap = piece.mid() - at.mid()
    if len(boundary.ends) > 1 or abs(gap) < (high - low) / 2:
        return [piece.union(at)]
    return [piece.union(low), at.union(high)] if gap < 0 else [piece.union(high), at.union(low)]


def _passes(place: Place, piece: arb, near: list[list[arb]], p: Any, d: Any) -> bool:
    x, y, vx, vy = place(piece)
    wx, wy = x - p[0], y - p[1]
    if not (d[0] * wy - d[1] * wx).contains(0):
        return True
    along = d[0] * wx + d[1] * wy
    if along < 0 or along > d[0] * d[0] + d[1] * d[1]:
        return True
    for ways in near:
        slopes = [d[0] * vy - d[1] * vx for _, _, vx, vy in map(place, ways)]
        if all(slope > 0 for slope in slopes) or all(slope < 0 for slope in slopes):
            return True
    middle = piece.mid()
    x, y, *_ = place(middle)  # sharper where a chord is short or runs along the boundary
    centred = d[0] * (y - p[1]) - d[1] * (x - p[0]) + (d[0] * vy - d[1] * vx) * (piece - middle)
    return not centred.contains(0)
