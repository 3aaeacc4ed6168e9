"""A branch of cycles in one parameter: followed both ways from a start, with what happens on it.

Each event is a zero of a test function between two points, located on the curve
(`verification.cycles.recurrence.recurrence` names them).
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from verification.cycles.continuation import arc
from verification.cycles.continuation.arc import End, LostError, Path, Point, Steps
from verification.cycles.continuation.linear import Spectrum
from verification.cycles.continuation.systems import Cycles, coefficients, parts, whole
from verification.cycles.recurrence.chords import Chords
from verification.cycles.recurrence.problem import NormalForm
from verification.cycles.recurrence.recurrence import Array, BifurcationKind, Parameters, Recurrence

NOISE = 1e-9  # a test function that small has no sign
NEARBY = 0.3  # a start that is farther from the cycle it leads to is no start for it
Interval = tuple[float, float]


@dataclass(frozen=True)
class Event:
    """What happens, where, and the coefficients of its normal form where there is one.

    `ring` and `x` are the cycle, or the part of it that flips where a symmetry breaks. When it is not `located` its
    place is interpolated between two points.
    """

    what: BifurcationKind
    point: Point
    ring: Recurrence
    x: Array = field(repr=False)
    form: NormalForm | None = None
    located: bool = True

    @property
    def value(self) -> float:
        """The parameter."""
        return float(self.point.z[-1])


@dataclass(frozen=True)
class Branch:
    """The points in order of arc length, the events among them, and how either end came about."""

    system: Cycles
    points: tuple[Point, ...] = field(repr=False)
    events: tuple[Event, ...]
    ends: tuple[tuple[End, str], tuple[End, str]]

    def spectra(self) -> list[Spectrum]:
        """The multipliers at each point."""
        return [spectrum_of(point) for point in self.points]

    @property
    def values(self) -> Array:
        """The parameter along the branch."""
        return np.array([point.z[-1] for point in self.points])

    def at(self, value: float) -> list[Array]:
        """The cycles where the branch passes `value`, each solved for."""
        return arc.passing(self.system, self.points, -1, value)


def spectrum_of(point: Point) -> Spectrum:
    """The multipliers at a point of a branch."""
    return Spectrum(point.tests["one"], point.tests["minus_one"], point.tests["volume"] + 1)


def branch(
    ring: Recurrence,
    x: Array,
    parameter: str,
    value: float,
    interval: Interval,
    fixed: Parameters | None = None,
    steps: Steps | None = None,
    tick: Callable[[Point], None] | None = None,
) -> Branch:
    """The branch through the cycle near `x` at `parameter = value`, both ways, inside `interval`.

    >>> from sympy import Symbol
    >>> from verification.cycles.recurrence.recurrence import logistic
    >>> found = branch(logistic(1), np.array([0.6]), "r", 2.5, (2.0, 3.9))
    >>> [(event.what.value, round(event.value, 9)) for event in found.events]
    [('period doubling', 3.0)]
    """
    system = Cycles(ring, parameter, fixed or {})
    if not interval[0] < interval[1]:
        raise ValueError(f"{parameter} = {interval[0]}:{interval[1]} is no interval; its first end must be the smaller")
    if not interval[0] <= value <= interval[1]:
        raise ValueError(f"the start at {parameter} = {value} lies outside the interval {interval[0]}:{interval[1]}")
    z = np.append(np.asarray(x, dtype=float), value)
    row = np.append(np.zeros(len(z) - 1), 1.0)
    given = z
    try:
        z, _ = arc.corrected(system, z, row, value)
        if np.max(np.abs(z - given)) > NEARBY:
            raise LostError(f"{ring.label}: the nearest cycle is {np.max(np.abs(z - given)):.2g} away")
    except LostError:
        if np.max(np.abs(system.linear(given)[0])) < 1e-6:
            why = "is a cycle with the multiplier 1, one of a family or at a bifurcation: no single branch leaves it"
            raise ValueError(f"{ring.label}: the start at {parameter} = {value} {why}") from None
        raise ValueError(f"{ring.label}: the start is no cycle at {parameter} = {value}, nor is one near it") from None
    why = system.obstacle(z)
    if why:
        raise ValueError(f"{ring.label}: the start is no cycle at {parameter} = {value}: {why}")
    return through(system, z, row, interval, steps, tick)


def through(
    system: Cycles,
    z: Array,
    direction: Array,
    interval: Interval,
    steps: Steps | None = None,
    tick: Callable[[Point], None] | None = None,
    ways: tuple[int, ...] = (-1, 1),
) -> Branch:
    """The branch through `z`, followed along `direction` and against it; events included."""
    limits = {len(z) - 1: interval}
    tangent = arc.tangent_at(system, z, direction)
    paths: dict[int, Path] = {}
    for way in ways:
        first = Point(z, way * tangent, 0.0, system.tests(z))
        if leaves(first, interval):
            paths[way] = Path(system, (first,), End.INTERVAL, "the end of the interval was reached")
            continue
        paths[way] = arc.follow(system, first, limits, steps, tick)
        if paths[way].end is End.CLOSED:
            paths = {1: paths[way]}
            break
    one = Path(system, (Point(z, tangent, 0.0, system.tests(z)),), End.INTERVAL, "followed one way only")
    back, forth = paths.get(-1, one), paths.get(1, one)
    reversed_ = [Point(p.z, -p.tangent, -p.s, p.tests) for p in reversed(back.points[1:])]
    points = [*reversed_, Point(z, tangent, 0.0, system.tests(z)), *forth.points[1:]]
    events = [event for a, b in pairwise(points) for event in between(system, a, b)]
    for path, end in ((back, points[0]), (forth, points[-1])):
        collision = border(system, end) if path.end is End.OBSTACLE else None
        events += [collision] if collision else []
    return Branch(system, tuple(points), tuple(events), ((back.end, back.why), (forth.end, forth.why)))


def leaves(point: Point, interval: Interval) -> bool:
    """Is the point on a side of the interval, with a tangent that points outwards?"""
    value, slope = point.z[-1], point.tangent[-1]
    return bool((value <= interval[0] and slope < 0) or (value >= interval[1] and slope > 0))


def between(system: Cycles, a: Point, b: Point) -> list[Event]:
    """The events between two neighbours, in order."""
    found = []
    for name in ("one", "minus_one", "volume"):
        before, after = a.tests[name], b.tests[name]
        if before * after < 0 and min(abs(before), abs(after)) > NOISE:
            turns = a.tangent[-1] * b.tangent[-1] < 0
            broken = _broken(system, a, b) if name == "one" and not turns else None
            found.append(broken or _located(system, a, b, name, turns))
    return sorted(found, key=lambda event: event.point.s)


def _located(system: Cycles, a: Point, b: Point, name: str, turns: bool) -> Event:
    """The event at the zero of a test function; where branches cross the corrector may be lost, and it is estimated."""
    try:
        return _named(system, name, arc.zero(system, a, b, name), turns)
    except ValueError:
        share = a.tests[name] / (a.tests[name] - b.tests[name])
        z = a.z + share * (b.z - a.z)
        point = Point(z, a.tangent, a.s + share * (b.s - a.s), system.tests(z))
        return replace(_named(system, name, point, turns), located=False, form=None)


def _broken(system: Cycles, a: Point, b: Point) -> Event | None:
    """The pitchfork between two neighbours, on the part of the cycle that flips there.

    The whole ring is singular at a pitchfork, the part is not, so it is the part that is solved for.
    """
    ring = system.recurrence
    for part, _ in parts(ring, a.z[:-1]) if isinstance(ring, Chords) else []:
        reduced = Cycles(part, system.parameter, system.fixed)
        m = part.period
        row = np.append(np.zeros(m), 1.0)
        try:
            first, last = (
                arc.started(reduced, np.append(p.z[:m], p.z[-1]), row if b.z[-1] > a.z[-1] else -row) for p in (a, b)
            )
            if first.tests["minus_one"] * last.tests["minus_one"] > 0:
                continue
            there = arc.zero(reduced, first, last, "minus_one")
        except ValueError:
            continue
        _, x = whole(part, there.z[:-1], ring.period)
        form = _form(part, there.z[:-1], reduced.at(there.z), BifurcationKind.FLIP, system.parameter)
        z = np.append(x, there.z[-1])
        share = (z[-1] - a.z[-1]) / (b.z[-1] - a.z[-1])
        point = Point(z, a.tangent, a.s + share * (b.s - a.s), system.tests(z))
        return Event(BifurcationKind.PITCHFORK, point, part, there.z[:-1], form)
    return None


def _named(system: Cycles, name: str, point: Point, turns: bool) -> Event:
    ring, x, at = system.recurrence, point.z[:-1], system.at(point.z)
    if name == "volume":
        what = BifurcationKind.TORUS if abs(spectrum_of(point).trace) < 2 else BifurcationKind.NEUTRAL_SADDLE
        return Event(what, point, ring, x)
    if name == "minus_one":
        return Event(BifurcationKind.FLIP, point, ring, x, _form(ring, x, at, BifurcationKind.FLIP, system.parameter))
    if turns:
        return Event(BifurcationKind.FOLD, point, ring, x, _form(ring, x, at, BifurcationKind.FOLD, system.parameter))
    return Event(BifurcationKind.BRANCH_POINT, point, ring, x)


def _form(ring: Recurrence, x: Array, at: Parameters, kind: BifurcationKind, parameter: str) -> NormalForm | None:
    try:
        return coefficients(ring, x, at, kind, parameter)
    except ValueError:
        return None


def border(system: Cycles, last: Point) -> Event | None:
    """The border collision next to the last point of a path, where a bounce lies on the join itself."""
    ring = system.recurrence
    joins = ring.nearest_joins(last.z[:-1]) if isinstance(ring, Chords) else []
    gaps = [(abs(end - last.z[i]), i, end) for i, end in enumerate(joins) if end is not None]
    if not gaps or min(gaps)[0] > 1e-3:
        return None
    _, bounce, end = min(gaps)
    row = np.zeros(len(last.z))
    row[bounce] = 1.0
    try:
        z, _ = arc.corrected(system, last.z, row, end)
    except LostError:
        return None
    return Event(BifurcationKind.BORDER_COLLISION, Point(z, last.tangent, last.s, last.tests), ring, z[:-1])
