"""That no chord of a cycle meets the boundary on its way, in tables that need not be convex.

Along a chord from `p` in direction `d` a boundary point `q` lies on the line when `d x (q - p) = 0`.
The boundary is covered by balls: off the line, or on it but not between the ends, or next to an end,
where `d x q'` keeps its sign so that the line is crossed there once, at the end itself.
"""

from functools import cache
from typing import Any

from flint import arb

from symbolic.codegen import kernel, load
from symbolic.geometry import velocity
from symbolic.symbols import theta
from symbolic.table import Table
from verification.arithmetic import balls, working

BITS = 96
PIECES = 4000  # balls that one chord may use up
SMALLEST = 2.0**-40  # of the boundary; halves of halves must stay exact in floats
Frame = tuple[arb, arb, arb, arb]


def first_hits(table: Table, components: tuple[int, ...], zero: list[arb], shape: tuple[arb, ...] = ()) -> bool | None:
    """True when every chord of the cycle leaves inwards, arrives from inside, and meets nothing between.

    >>> from symbolic.tables import cardioid
    >>> with working(96):
    ...     third = arb.pi() / 3
    >>> first_hits(cardioid, (0, 0), [third, -third])
    True
    """
    with working(BITS):
        n = len(components)
        parts = [_places(table, i) for i in range(len(table.components))]
        frames = [parts[c](x, *shape) for c, x in zip(components, zero, strict=False)]
        for i in range(n):
            ends = ((components[i], zero[i]), (components[(i + 1) % n], zero[(i + 1) % n]))
            if not _free(table, parts, frames[i], frames[(i + 1) % n], ends, shape):
                return None
        return True


@cache
def _places(table: Table, index: int) -> Any:
    """The point and the velocity at a parameter of a component, in balls."""
    component = table.components[index]
    (x, y), (vx, vy) = component.point, velocity(component)
    letters = [theta, *(p.symbol for p in table.shapes)]
    return load(kernel("place", letters, {"x": x, "y": y, "vx": vx, "vy": vy}), balls(BITS))


def _free(
    table: Table, parts: list[Any], start: Frame, end: Frame, ends: tuple[tuple[int, arb], ...], shape: tuple[arb, ...]
) -> bool:
    p, d = start[:2], (end[0] - start[0], end[1] - start[1])
    if not (start[2] * d[1] - start[3] * d[0] > 0 and end[3] * d[0] - end[2] * d[1] > 0):
        return False  # the inward normal is (-vy, vx)
    spent = 0
    for index, component in enumerate(table.components):
        low, high = (
            load(kernel("end", [], {"end": e}), balls(BITS))()[0] + arb(0) for e in (component.start, component.end)
        )
        queue = [(0.5, 0.5)]
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > PIECES or half < SMALLEST:
                return False
            piece = low + (high - low) * arb(middle, half)
            near = [_nearest(table, x, piece) for c, x in ends if c == index]
            if not _passes(parts[index], piece, near, p, d, shape):
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True


def _nearest(table: Table, x: arb, piece: arb) -> arb:
    """A bounce as the parameter next to `piece`, on a closed boundary up to full turns."""
    if len(table.components) > 1:
        return x
    turns = round(float((piece.mid() - x.mid()) / (2 * arb.pi())))
    return x + 2 * arb.pi() * turns


def _passes(place: Any, piece: arb, near: list[arb], p: Any, d: Any, shape: tuple[arb, ...]) -> bool:
    x, y, _, _ = place(piece, *shape)
    wx, wy = x - p[0], y - p[1]
    if not (d[0] * wy - d[1] * wx).contains(0):
        return True
    along = d[0] * wx + d[1] * wy
    if along < 0 or along > d[0] * d[0] + d[1] * d[1]:
        return True
    for bounce in near:
        _, _, vx, vy = place(piece.union(bounce), *shape)
        if not (d[0] * vy - d[1] * vx).contains(0):
            return True
    return False
