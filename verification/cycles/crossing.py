"""Continuation of families of cycles over joins where the tangents agree and the curvature jumps.

A branch of one set of equations ends where a bounce meets the join: a border collision. The map is continuous there, so
the cycles with that bounce on the neighbouring component are sought, from the collision inwards. One of them that goes
on in the direction of the parameter is the same cycle: persistence. If the only one goes back in the parameter, two
cycles meet on the join and exist on one side of it alone: a nonsmooth fold, through which the family goes on as through
a smooth one. `verification.maps.one_sided` has the condition on the derivatives. At a corner the map has no
continuation.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from symbolic.tables.curves import curves
from symbolic.tables.table import Table
from verification.cycles import arc
from verification.cycles.arc import CurvePoint, End, LostError, Steps
from verification.cycles.branch import Branch, Collision, Event, Interval, through
from verification.cycles.chords import Chords
from verification.cycles.recurrence import Array, BifurcationKind
from verification.cycles.systems import Cycles
from verification.maps.joins import joins

TOUCHING = 1e-7  # a bounce that close to a join, in its parameter, collides with it
CROSSINGS = 64  # of one branch
AGAIN = 1e-6  # of a collision that was met before
Tick = Callable[[CurvePoint], object]
Start = tuple[Cycles, Array, Array]  # a system, a cycle of it next to a collision, and the cycle at the collision


def next_to(table: Table, part: int, after: bool) -> int:
    """The index of the component after (or before) component `part`, on the same closed curve.

    >>> from symbolic.tables.gallery import sinai
    >>> next_to(sinai(), 3, True), next_to(sinai(), 0, False)  # four sides, and a disc
    (0, 3)
    """
    first = 0
    for curve in curves(table):
        if part < first + len(curve):
            break
        first += len(curve)
    return first + (part - first + (1 if after else -1)) % len(curve)


def beyond(system: Cycles, event: Event, rough: bool = False) -> Iterator[Start]:
    """Cycles next to a border collision for which some or all colliding bounces lie on the neighbouring components.

    With `rough`, nothing is yielded if the tangents disagree at one of the joins that bounces meet.
    """
    ring, x = system.recurrence, event.x
    if not isinstance(ring, Chords):
        return
    at = system.at(event.point.z)
    nearest, ends = ring.nearest_joins(x, at), ring.ends(at)
    met = [(i, end) for i, end in enumerate(nearest) if end is not None and abs(end - x[i]) < TOUCHING]
    sides = [(i, int(abs(end - ends[ring.components[i]][1]) < TOUCHING)) for i, end in met]
    known = joins(ring.table)
    if rough and not all(known.smooth[ring.components[i], side] for i, side in sides):
        return
    for some in (some for size in range(1, len(sides) + 1) for some in combinations(sides, size)):
        parts, moved, inwards = list(ring.components), x.copy(), {}
        for bounce, side in some:
            parts[bounce] = next_to(ring.table, parts[bounce], bool(side))
            moved[bounce] = ends[parts[bounce]][1 - side]
            inwards[bounce] = 1.0 if side else -1.0  # parameters grow counterclockwise, from the join inwards
        other = Cycles(replace(ring, components=tuple(parts)), system.parameter, system.fixed)
        z = np.append(moved, event.value)
        if (near := _inwards(other, z, inwards)) is not None:
            yield other, near, z


def _inwards(system: Cycles, z: Array, inwards: dict[int, float]) -> Array | None:
    """A cycle next to a border collision for which the bounces in `inwards` have left their joins; or None."""
    bounce = next(iter(inwards))
    row = np.zeros(len(z))
    row[bounce] = 1.0
    for size in (1e-6, 1e-4):
        try:
            near, _ = arc.corrected(system, z + inwards[bounce] * size * row, row, z[bounce] + inwards[bounce] * size)
        except LostError:
            continue
        if not system.obstacle(near) and abs(near[-1] - z[-1]) < 1e3 * size:
            return near
    return None


def continued(branch: Branch, interval: Interval, steps: Steps | None = None, tick: Tick | None = None) -> Branch:
    """The family of a branch, continued over the joins at which it ends, as pieces in order of arc length.

    Each border collision has its kind (persistence, fold, several) in its event's `collision`.
    """
    pieces, first, last = [branch], branch.ends[0], branch.ends[1]
    for way in (-1, 1):
        for _ in range(CROSSINGS):
            piece, at = (pieces[-1], -1) if way > 0 else (pieces[0], 0)
            end, event = piece.ends[at][0], _at_end(piece, at)
            if end is not End.OBSTACLE or event is None:
                break
            forth = way * piece.points[at].tangent[-1]
            starts = list(beyond(piece.system, event, True))
            on = [start for start in starts if (start[1][-1] - start[2][-1]) * forth > 0]
            chosen = on if len(on) == 1 else starts
            kind = Collision.PERSISTENCE if len(on) == 1 else Collision.FOLD if len(starts) == 1 else Collision.SEVERAL
            if not starts:
                break
            named = replace(piece, events=tuple(replace(e, collision=kind) if e is event else e for e in piece.events))
            pieces[at] = named
            if len(chosen) != 1 or _met(pieces, named, event):
                break
            system, near, z = chosen[0]
            found = through(system, near, near - z, interval, steps, tick, ways=(1,))
            pieces.insert(len(pieces) if way > 0 else 0, _placed(found, way, event.point.s, z))
            first, last = (first, found.ends[1]) if way > 0 else (found.ends[1], last)
    if len(pieces) == 1:
        return pieces[0]
    events, births = ([e for piece in pieces for e in getattr(piece, which)] for which in ("events", "births"))
    points = tuple(point for piece in pieces for point in piece.points)
    return Branch(branch.system, points, tuple(events), (first, last), tuple(births), tuple(pieces))


def _at_end(piece: Branch, at: int) -> Event | None:
    """The border collision at the end `at` of a branch, if its kind is not known yet; else None."""
    for event in piece.events:
        there = event.point.s == piece.points[at].s
        if event.kind is BifurcationKind.BORDER_COLLISION and there and event.collision is None:
            return event
    return None


def _met(pieces: list[Branch], own: Branch, event: Event) -> bool:
    """Was this collision met before, by another piece? Then the family is closed."""
    others = [e for piece in pieces if piece is not own for e in piece.events if e.collision]
    return any(abs(e.value - event.value) < AGAIN and _alike(e, event) for e in others)


def _alike(one: Event, two: Event) -> bool:
    same = isinstance(one.ring, Chords) and isinstance(two.ring, Chords) and one.ring.components == two.ring.components
    return same and bool(np.max(np.abs(one.x - two.x)) < AGAIN)


def _placed(found: Branch, way: int, s: float, z: Array) -> Branch:
    """The piece `found` that begins next to a collision, with arc lengths counted from `s` in the direction `way`."""
    gap = found.points[0].z - z
    start = float(np.sqrt(gap @ (found.system.weights * gap)))

    def moved(point: CurvePoint) -> CurvePoint:
        return CurvePoint(point.z, way * point.tangent, s + way * (start + point.s), point.tests)

    events, births = (
        tuple(replace(event, point=moved(event.point)) for event in some)[::way]
        for some in (found.events, found.births)
    )
    ends = found.ends if way > 0 else (found.ends[1], found.ends[0])
    return replace(found, points=tuple(map(moved, found.points))[::way], events=events, births=births, ends=ends)
