"""A family of cycles: a branch, where its cycle attracts, and marks by which cycles are recognised.

The marks are those of `numeric.sweeps.endings`: mean distances between bounces, which do not change under symmetries.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.sweeps.endings import MARKS, marks_of
from symbolic.expressions.text import kernel, load
from symbolic.tables.table import theta as place
from verification.arithmetic.balls import ARRAYS, FLOAT64
from verification.cycles.arc import CurvePoint, LostError
from verification.cycles.branch import Branch, Event, spectrum_of
from verification.cycles.chords import Chords, chord_angles
from verification.cycles.recurrence import Array, BifurcationKind
from verification.cycles.systems import ROUND

UNSTABLE = 600  # over the period: points of a branch without attraction after which it is left
CLOSE, SAME = 3e-3, 1e-6  # between marks, over the table's size: of a start and a branch; of one cycle
ALIKE = 1e-7  # between the parameters of one event on two branches
Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class CycleFamily:
    """A branch of cycles, its parent family's index and the event of its birth (None if found from starts)."""

    branch: Branch
    size: float
    parent: int | None = None
    birth: Event | None = None

    @property
    def period(self) -> int:
        """The number of bounces."""
        return self.branch.system.recurrence.period

    @property
    def low(self) -> float:
        """The least value of the parameter at which the cycles exist."""
        return min(float(np.min(self.branch.values)), *(e.value for e in self.branch.along), np.inf)

    @property
    def high(self) -> float:
        """The largest value of the parameter at which the cycles exist."""
        return max(float(np.max(self.branch.values)), *(e.value for e in self.branch.along), -np.inf)

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """For each point of the branch, whether the cycle attracts."""
        return np.array([spectrum_of(point).stable for point in self.branch.points])

    @cached_property
    def attracts(self) -> tuple[Interval, ...]:
        """The ranges of the parameter on which the cycle attracts; they end at events."""
        points, ranges = self.branch.points, list[Interval]()
        for k in range(len(points) - 1):
            (a, b), (first, last) = self.stable[k : k + 2], (float(p.z[-1]) for p in points[k : k + 2])
            if not a and not b:
                continue
            along = sorted(self.branch.along, key=lambda e: abs(e.point.s - points[k].s))
            between = [e.value for e in along if points[k].s <= e.point.s <= points[k + 1].s]
            if a and b:
                ranges.append((min(first, last, *between), max(first, last, *between)))  # it may turn there
                continue
            between += [
                e.value for e in along if min(first, last) <= e.value <= max(first, last)
            ]  # met on the way there
            edge = between[0] if between else last if a else first  # without an event the range ends with the interval
            ranges.append((min(first, edge), max(first, edge)) if a else (min(last, edge), max(last, edge)))
        return tuple(joined(ranges))

    @cached_property
    def orbit(self) -> tuple[tuple[int, ...], Array, Array]:
        """The components, parameters and exit angles of the cycle at `start`."""
        system, z = self.branch.system, self.start
        assert isinstance(system.recurrence, Chords)
        ring, x = system.recurrence.placed(z[:-1])
        shape = [system.at(z)[name] for name in ring.shapes]
        pairs = zip(ring.components, np.roll(ring.components, -1).tolist(), x, np.roll(x, -1), strict=True)
        angles = chord_angles(ring.table, FLOAT64)
        return ring.components, x, np.array([angles(i, j, 1)(float(a), float(b), *shape)[0] for i, j, a, b in pairs])

    @property
    def marked_start(self) -> tuple[float, Array]:
        """The parameter value and the marks of the cycle `start`."""
        z, ring = self.start, self.branch.system.recurrence
        assert isinstance(ring, Chords)
        return float(z[-1]), marks_along(ring, z[None])[0]

    def attracts_next_to(self, event: Event) -> bool:
        """Does the cycle attract next to this event, on at least one side of it?"""
        s = np.array([point.s for point in self.branch.points])
        k = int(np.clip(np.searchsorted(s, event.point.s), 1, len(s) - 1))
        return bool(np.any(self.stable[max(0, k - 2) : k + 2]))

    @property
    def start(self) -> Array:
        """Bounces and parameter of the cycle with multipliers farthest from 1 and -1; of a stable one if possible."""
        best = [min(abs(p.tests["one"]), abs(p.tests["minus_one"])) * (2 if s else 1) for p, s in self._points]
        return np.asarray(self._points[int(np.argmax(best))][0].z)

    @property
    def _points(self) -> list[tuple[Any, Any]]:
        inner = list(zip(self.branch.points, self.stable, strict=True))
        return inner[1:-1] or inner

    @cached_property
    def marks(self) -> Array:
        """The marks of the cycle at each point of the branch, one row per point."""
        ring = self.branch.system.recurrence
        assert isinstance(ring, Chords)
        return marks_along(ring, np.array([p.z for p in self.branch.points]))

    def near(self, value: float, attracting: bool = True) -> Iterator[tuple[Array, float]]:
        """The marks of the family's (attracting) cycles at a value, interpolated between points, with error bounds."""
        v = self.branch.values
        passing = (v[:-1] - value) * (v[1:] - value) <= 0
        for k in np.nonzero(passing & (self.stable[:-1] | self.stable[1:] | (not attracting)))[0]:
            share = (value - v[k]) / (v[k + 1] - v[k]) if v[k] != v[k + 1] else 0.0
            step = self.marks[k + 1] - self.marks[k]
            yield self.marks[k] + share * step, CLOSE * self.size + float(np.max(np.abs(step))) / 2

    def holds(self, value: float, marks: Array) -> bool:
        """Is there a cycle with these marks on the branch at this value, attracting or not? It is computed to check."""
        if not any(np.max(np.abs(near - marks)) < 10 * wide for near, wide in self.near(value, False)):
            return False
        system = self.branch.system
        assert isinstance(system.recurrence, Chords)
        try:
            found = self.branch.at(value)
        except LostError:
            return True  # next to a fold, where the marks are near enough
        rows = marks_along(system.recurrence, np.array(found)) if found else np.empty((0, MARKS))
        return any(np.max(np.abs(row - marks)) < SAME * self.size * self.period for row in rows)


def joined(ranges: Sequence[Interval]) -> list[Interval]:
    """The intervals in order, with touching or overlapping ones united.

    >>> joined([(2.0, 3.0), (0.0, 1.0), (1.0, 1.5)])
    [(0.0, 1.5), (2.0, 3.0)]
    """
    found: list[Interval] = []
    for low, high in sorted(ranges):
        if found and low <= found[-1][1]:
            found[-1] = found[-1][0], max(high, found[-1][1])
        else:
            found.append((low, high))
    return found


def same_event(one: Event, two: Event) -> bool:
    """Are events on two branches the same? A doubling of a cycle may appear as a pitchfork of a part of the cycle."""
    both = {one.kind, two.kind} <= {BifurcationKind.FLIP, BifurcationKind.PITCHFORK, BifurcationKind.BRANCH_POINT}
    return (both or one.kind is two.kind) and abs(one.value - two.value) < ALIKE


def closing(part: Chords, x: Array) -> int:
    """The period of the full cycle that a part and its images under the symmetry make up."""
    for rounds in range(2, 2 * ROUND + 1):
        if np.max(np.abs(np.sin((part.closure.carried(x, part.closure.radians, rounds) - x) / 2))) < ALIKE:
            return rounds * part.period
    raise LostError(f"{part.label}: the part and its images under the symmetry do not close to a cycle")


def left(period: int) -> Callable[[CurvePoint], bool]:
    """A `tick` that ends a path when the cycle has been unstable for a number of points, smaller for longer cycles."""
    patience = max(5, UNSTABLE // period)
    since = 0

    def ended(point: CurvePoint) -> bool:
        nonlocal since
        since = 0 if spectrum_of(point).stable else since + 1
        return since > patience

    return ended


def marks_along(ring: Chords, rows: Array) -> Array:
    """The marks of cycles, one row per cycle; a row of `rows` has the bounces, then the parameter."""
    table = ring.table
    points = np.empty((2, ring.period, len(rows)))
    placed = [ring.placed(z[:-1]) for z in rows]
    for part in {part for at, _ in placed for part in at.components}:
        xy = table.components[part].point
        names = [place, *(p.symbol for p in table.shapes)]
        point = load(kernel("point", names, {"x": xy[0], "y": xy[1]}), ARRAYS)
        where = np.array([[component == part for component in at.components] for at, _ in placed]).T
        x = np.array([x for _, x in placed]).T
        given = [np.broadcast_to(rows[:, -1], where.shape)[where] for _ in ring.shapes]  # the parameter itself
        for axis, value in enumerate(point(x[where], *given)):
            points[axis][where] = value
    return marks_of(points)
