"""A branch of cycles in one parameter: its start, its events (bifurcations), and its points as a table.

A branch is followed in both directions. Each event is a zero of a test function between two points, located on the
curve; `verification.cycles.recurrence` lists the kinds of events.

The table is an xarray Dataset or a record for JSON. Points and events stand in one order, by arc length along the
branch; `event` is empty at an ordinary point.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import N

from symbolic.cycles import cycle as named_cycles
from symbolic.cycles.cycle import Cycle
from symbolic.tables.table import Table
from verification.cycles import arc
from verification.cycles.arc import CurvePoint, End, LostError, Path, Steps
from verification.cycles.cells import CycleType, MonodromyDeterminants
from verification.cycles.chords import Chords
from verification.cycles.problem import NormalForm
from verification.cycles.recurrence import IDENTITY, Array, BifurcationKind, Parameters, Recurrence
from verification.cycles.systems import Cycles, coefficients, crossed, images, parts, repeats, whole
from verification.maps.joins import joins
from verification.maps.one_sided import OneSided, of_rows, verdict

if TYPE_CHECKING:
    import xarray


NOISE = 1e-9  # a test function that small has no sign
APPROACHES = 3  # iterations for a join's place, which may depend on the parameter
DIFFERENCE = 2.0**-20  # step of the parameter, for the derivative of a join's place
WIDTHS = (1e-4, 1e-3, 1e-2)  # steps of the parameter to either side of a birth
AGAIN = 1e-6  # in radians and parameter: so near, two events or an event and an image are the same
NEARBY = 0.3  # largest distance of a start from its cycle
Interval = tuple[float, float]


class Collision(Enum):
    """The effect of a border collision on a cycle, where a bounce meets a join at which the tangents agree."""

    PERSISTENCE = "persistence: the cycle goes on over the join"
    FOLD = "nonsmooth fold: two cycles meet on the join, and exist on one side of this value alone"
    SEVERAL = "more than two cycles meet on joins"


@dataclass(frozen=True)
class Event:
    """An event on a branch: its kind, its point, and the coefficients of its normal form if it has one.

    `ring` and `x` are the cycle or, where a symmetry breaks, the part of the cycle that flips. If an event is not
    `located`, its point is interpolated between two points of the branch. At a `birth` the branch turns back, and
    `ring` is the cycle from which the branch is born.
    """

    kind: BifurcationKind
    point: CurvePoint
    ring: Recurrence
    x: Array = field(repr=False)
    form: NormalForm | None = None
    located: bool = True
    birth: bool = False
    collision: Collision | None = None

    @property
    def value(self) -> float:
        """The value of the parameter at which the event occurs."""
        return float(self.point.z[-1])


@dataclass(frozen=True)
class Branch:
    """A branch of cycles: points and events in order of arc length, and the reason why it ends at either end.

    At `births` the branch turns back: these are bifurcations of the cycles from which the branch is born. A family that
    goes on over joins has `pieces`, each with its own equations; `system` is that of the first piece.
    """

    system: Cycles
    points: tuple[CurvePoint, ...] = field(repr=False)
    events: tuple[Event, ...]
    ends: tuple[tuple[End, str], tuple[End, str]]
    births: tuple[Event, ...] = ()
    pieces: "tuple[Branch, ...]" = ()

    @property
    def each(self) -> "tuple[Branch, ...]":
        """The pieces of the branch; the branch itself if it crosses no join."""
        return self.pieces or (self,)

    @property
    def along(self) -> list[Event]:
        """The events and the births, in order of arc length along the branch."""
        return sorted((*self.events, *self.births), key=lambda event: event.point.s)

    def spectra(self) -> list[MonodromyDeterminants]:
        """The determinants that give the multipliers, at each point of the branch."""
        return [spectrum_of(point) for point in self.points]

    @property
    def values(self) -> Array:
        """The values of the parameter at the points."""
        return np.array([point.z[-1] for point in self.points])

    def at(self, value: float) -> list[Array]:
        """The cycles (bounces, then parameter) where the branch passes `value`, each corrected by Newton's method."""
        return [z for piece in self.each for z in arc.passing(piece.system, piece.points, -1, value)]


def spectrum_of(point: CurvePoint) -> MonodromyDeterminants:
    """The determinants that give the multipliers at a point of a branch."""
    return MonodromyDeterminants(point.tests["one"], point.tests["minus_one"], point.tests["volume"] + 1)


def branch(
    ring: Recurrence,
    x: Array,
    parameter: str,
    value: float,
    interval: Interval,
    fixed: Parameters | None = None,
    steps: Steps | None = None,
    tick: Callable[[CurvePoint], object] | None = None,
) -> Branch:
    """The branch through the cycle near `x` at `parameter = value`, followed in both directions inside `interval`.

    >>> from sympy import Symbol
    >>> from verification.cycles.recurrence import logistic
    >>> found = branch(logistic(1), np.array([0.6]), "r", 2.5, (2.0, 3.9))
    >>> [(event.kind.value, round(event.value, 9)) for event in found.events]
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
    tick: Callable[[CurvePoint], object] | None = None,
    ways: tuple[int, ...] = (-1, 1),
) -> Branch:
    """Branch through the cycle `z`, followed along `direction` and against it (`ways` 1 and -1), with its events."""
    limits = {len(z) - 1: interval}
    tangent = arc.tangent_at(system, z, direction)
    ring = system.recurrence
    other = None if repeats(ring, z[:-1]) else lambda at: repeats(ring, at[:-1])
    paths: dict[int, Path] = {}
    for way in ways:
        first = CurvePoint(z, way * tangent, 0.0, system.tests(z))
        if arc.leaves(first, interval):
            paths[way] = Path(system, (first,), End.INTERVAL, "the end of the interval was reached")
            continue
        paths[way] = arc.follow(system, first, limits, steps, tick, other)
        if paths[way].end is End.CLOSED:
            paths = {1: paths[way]}
            break
    one = Path(system, (CurvePoint(z, tangent, 0.0, system.tests(z)),), End.INTERVAL, "followed one way only")
    back, forth = paths.get(-1, one), paths.get(1, one)
    reversed_ = [CurvePoint(p.z, -p.tangent, -p.s, p.tests) for p in reversed(back.points[1:])]
    points = [*reversed_, CurvePoint(z, tangent, 0.0, system.tests(z)), *forth.points[1:]]
    events = [event for a, b in pairwise(points) for event in between(system, a, b)]
    for path, end in ((back, points[0]), (forth, points[-1])):
        collision = border(system, end) if path.end is End.OBSTACLE else None
        events += [collision] if collision else []
    events = _each_once(ring, events)
    own, births = (tuple(event for event in events if event.birth == born) for born in (False, True))
    return Branch(system, tuple(points), own, ((back.end, back.why), (forth.end, forth.why)), births)


def _each_once(ring: Recurrence, events: Sequence[Event]) -> list[Event]:
    """The events without repetitions: a branch may meet an event again at an image of its cycle under a symmetry."""
    found: list[Event] = []
    for event in events:
        z = event.point.z
        if not any(
            (event.kind, event.birth) == (one.kind, one.birth)
            and abs(z[-1] - one.value) < AGAIN
            and images(ring, one.point.z[:-1], z[:-1], AGAIN)
            for one in found
        ):
            found.append(event)
    return found


def between(system: Cycles, a: CurvePoint, b: CurvePoint) -> list[Event]:
    """The events between two neighbouring points, in order."""
    found, turns = [], a.tangent[-1] * b.tangent[-1] < 0
    for name in ("one", "minus_one", "volume"):
        before, after = a.tests[name], b.tests[name]
        if before * after < 0 and min(abs(before), abs(after)) > NOISE:
            broken = _broken(system, a, b) if name == "one" and not turns else None
            found.append(broken or _located(system, a, b, name, turns))
    if turns and a.tests["one"] * b.tests["one"] > 0:
        found += _birth(system, a, b)
    return sorted(found, key=lambda event: event.point.s)


def _located(system: Cycles, a: CurvePoint, b: CurvePoint, name: str, turns: bool) -> Event:
    """The event at the zero of a test function; interpolated where Newton's method fails, as at a branch point."""
    try:
        return _named(system, name, arc.zero(system, a, b, name), turns)
    except ValueError:
        share = a.tests[name] / (a.tests[name] - b.tests[name])
        z = a.z + share * (b.z - a.z)
        point = CurvePoint(z, a.tangent, a.s + share * (b.s - a.s), system.tests(z))
        return replace(_named(system, name, point, turns), located=False, form=None)


def _broken(system: Cycles, a: CurvePoint, b: CurvePoint) -> Event | None:
    """The pitchfork between two neighbouring points, computed on the part of the cycle that flips; None without one."""
    ring = system.recurrence
    for part, _ in parts(ring, a.z[:-1]) if isinstance(ring, Chords) else []:
        first, last = (np.append(p.z[: part.period], p.z[-1]) for p in (a, b))
        there = arc.zero_near(Cycles(part, system.parameter, system.fixed), first, last, "minus_one")
        if there is not None:
            return _parted(system, part, there, a, b, (there.z[-1] - a.z[-1]) / (b.z[-1] - a.z[-1]))
    return None


def _birth(system: Cycles, a: CurvePoint, b: CurvePoint) -> list[Event]:
    """The birth between two neighbouring points, if any: a flip of the cycle from which the branch is born."""
    for part, x, share in crossed(system.recurrence, a.z[:-1], b.z[:-1]):
        for wide in WIDTHS:
            first, last = (np.append(x, a.z[-1] + side * wide) for side in (-1, 1))
            there = arc.zero_near(Cycles(part, system.parameter, system.fixed), first, last, "minus_one")
            if there is not None:
                return [replace(_parted(system, part, there, a, b, share), birth=True)]
    return []


def _parted(system: Cycles, part: Chords, there: CurvePoint, a: CurvePoint, b: CurvePoint, share: float) -> Event:
    """The event where `part` flips, placed at the fraction `share` of the way from point `a` to point `b`."""
    kind = BifurcationKind.FLIP if part.closure == IDENTITY else BifurcationKind.PITCHFORK
    x = there.z[:-1]
    form = _form(
        part, x, {**system.fixed, system.parameter: float(there.z[-1])}, BifurcationKind.FLIP, system.parameter
    )
    z = np.append(whole(part, x, system.recurrence.period)[1], there.z[-1])
    return Event(kind, CurvePoint(z, a.tangent, a.s + share * (b.s - a.s), system.tests(z)), part, x, form)


def _named(system: Cycles, name: str, point: CurvePoint, turns: bool) -> Event:
    (ring, x), at = _placed(system.recurrence, point.z[:-1]), system.at(point.z)
    if name == "volume":
        what = BifurcationKind.TORUS if abs(spectrum_of(point).trace) < 2 else BifurcationKind.NEUTRAL_SADDLE
        return Event(what, point, ring, x)
    if name == "minus_one":
        return Event(BifurcationKind.FLIP, point, ring, x, _form(ring, x, at, BifurcationKind.FLIP, system.parameter))
    if turns:
        return Event(BifurcationKind.FOLD, point, ring, x, _form(ring, x, at, BifurcationKind.FOLD, system.parameter))
    return Event(BifurcationKind.BRANCH_POINT, point, ring, x)


def _placed(ring: Recurrence, x: Array) -> tuple[Recurrence, Array]:
    """The cycle with each bounce assigned to the component on which it lies; a branch may cross a smooth join."""
    return ring.placed(x) if isinstance(ring, Chords) else (ring, x)


def _form(ring: Recurrence, x: Array, at: Parameters, kind: BifurcationKind, parameter: str) -> NormalForm | None:
    try:
        return coefficients(ring, x, at, kind, parameter)
    except ValueError:
        return None


def border(system: Cycles, last: CurvePoint) -> Event | None:
    """The border collision next to the last point of a path, where a bounce lies on the join itself.

    Where two bounces reach a corner, or a flight touches the boundary on its way, the event is put at the last point
    and marked as not located, as the equations have no solution beyond.
    """
    ring, z = system.recurrence, last.z
    if not isinstance(ring, Chords):
        return None
    beside_it = Event(BifurcationKind.BORDER_COLLISION, last, ring, z[:-1], located=False)
    gaps = [(abs(end - z[i]), i) for i, end in enumerate(ring.nearest_joins(z[:-1], system.at(z))) if end is not None]
    if not gaps or min(gaps)[0] > 1e-3:
        return beside_it
    bounce = min(gaps)[1]
    for _ in range(APPROACHES):
        here, beside = z, np.append(z[:-1], z[-1] + DIFFERENCE)
        ends = [ring.nearest_joins(at[:-1], system.at(at))[bounce] or 0.0 for at in (here, beside)]
        row = np.zeros(len(z))
        row[bounce], row[-1] = 1.0, -(ends[1] - ends[0]) / DIFFERENCE
        try:
            z, _ = arc.corrected(system, z, row, ends[0] + row[-1] * here[-1])
        except LostError:
            return beside_it
        if not row[-1]:
            break
    return Event(BifurcationKind.BORDER_COLLISION, CurvePoint(z, last.tangent, last.s, last.tests), ring, z[:-1])


# name: the cycle, the table it belongs to, and the contraction at which it is given (None: all of them)
NAMED: dict[str, tuple[Callable[[], Cycle], str, float | None]] = {
    "diameter": (named_cycles.egg_diameter, "egg circle", None),
    "triangle": (named_cycles.egg_triangle, "egg circle", 1.0),
    "vertex-triangle": (lambda: named_cycles.egg_triangle(False), "egg", 1.0),
    "major-axis": (named_cycles.major_axis, "ellipse", None),
    "minor-axis": (named_cycles.minor_axis, "ellipse", None),
    "vertical": (named_cycles.cuspless_vertical, "cuspless cardioid", None),
    "horizontal": (named_cycles.cuspless_horizontal, "cuspless", None),
}


def named(name: str, table: Table) -> tuple[Chords, Array, float | None]:
    """The chord system of the named cycle, its bounces, and its contraction (None if it exists for any).

    >>> from symbolic.tables import cuspless
    >>> named("horizontal", cuspless)[0].components
    (1, 0)
    """
    if name not in NAMED:
        raise ValueError(f"--cycle {name} is no cycle with a name; accepted: {', '.join(NAMED)}")
    make, tables, lam = NAMED[name]
    if table.name not in tables.split():
        known = ", ".join(key for key, (_, where, _) in NAMED.items() if table.name in where.split()) or "none"
        raise ValueError(f"--cycle {name} belongs to the {tables.split()[0]}, not to {table.name}; accepted: {known}")
    bounces = make().bounces
    return Chords(table, tuple(i for i, _ in bounces)), np.array([float(N(x)) for _, x in bounces]), lam


def typed(table: Table, theta: Sequence[float], components: Sequence[str] | None = None) -> tuple[Chords, Array]:
    """Chord system of bounces at the parameters `theta` on the named components (None: the first one), and `theta`."""
    names = [component.name for component in table.components]
    if len(theta) < 2:
        raise ValueError(f"--start has {len(theta)} bounce; a cycle has at least 2, such as 0.1,3.0")
    for value in theta:
        if not np.isfinite(value):
            raise ValueError(f"--start: {value} is no boundary parameter; accepted: finite numbers such as 0.1,3.0")
    for name in components or ():
        if name not in names:
            raise ValueError(f"--components: {name!r} is not on this table; accepted: {', '.join(names)}")
    if components and len(components) != len(theta):
        raise ValueError(f"--components names {len(components)} bounces and --start has {len(theta)}; give one each")
    indices = tuple(names.index(name) for name in components) if components else (0,) * len(theta)
    return Chords(table, indices), np.array(theta, dtype=float)


def at_contraction(ring: Chords, x: Array, given: float, lam: float) -> Array:
    """The first cycle at `lam` on the branch of the cycle near `x`, whose contraction is `given`."""
    if given == lam:
        return x
    found = branch(ring, x, "lam", given, (min(given, lam), max(given, lam)))
    there = [point for point in (found.points[0], found.points[-1]) if point.z[-1] == lam]
    if not there:
        raise ValueError(f"{ring.label}: the cycle at lam = {given} does not reach lam = {lam}; give another --start")
    return min(there, key=lambda point: abs(point.s)).z[:-1]


def rows(branch: Branch) -> list[tuple[CurvePoint, Event | None]]:
    """The points and the events in order, each with its event or None."""
    both: list[tuple[CurvePoint, Event | None]] = [(point, None) for point in branch.points]
    both += [(event.point, event) for event in branch.along]
    return sorted(both, key=lambda row: (row[0].s, row[1] is not None))


def dataset(branch: Branch) -> "xarray.Dataset":
    """A branch as an xarray Dataset over `point`, `bounce`, `which` (multiplier); parameter and event as coordinates.

    >>> from verification.cycles.branch import branch as followed
    >>> from verification.cycles.recurrence import logistic
    >>> table = dataset(followed(logistic(1), np.array([0.6]), "r", 2.5, (2.0, 3.4)))
    >>> [str(name) for name in table["event"].values if name], table["x"].dims
    (['period doubling'], ('point', 'bounce'))
    """
    import xarray

    listed = rows(branch)
    parameter, n = branch.system.parameter, branch.system.recurrence.period
    spectra = [spectrum_of(point) for point, _ in listed]
    multipliers = np.array([s.multipliers for s in spectra]).reshape(len(listed), 2)
    values = {
        "x": (("point", "bounce"), np.array([point.z[:-1] for point, _ in listed]).reshape(len(listed), n)),
        "multiplier_real": (("point", "which"), multipliers.real),
        "multiplier_imaginary": (("point", "which"), multipliers.imag),
        "determinant": ("point", np.array([s.determinant for s in spectra])),
        "stable": ("point", np.array([s.stable for s in spectra])),
        "branch_coefficient": (
            "point",
            np.array([np.nan if e is None or e.form is None else e.form.branch for _, e in listed]),
        ),
    }
    coordinates = {
        parameter: ("point", np.array([point.z[-1] for point, _ in listed])),
        "arclength": ("point", np.array([point.s for point, _ in listed])),
        "event": ("point", np.array(["" if e is None else e.kind.value for _, e in listed])),
    }
    about = {"cycle": branch.system.label, "parameter": parameter, **_ended(branch)}
    return xarray.Dataset(values, coordinates, attrs=about)


def record(branch: Branch) -> dict[str, Any]:
    """A branch as JSON, with the entries of `dataset`."""
    parameter, points = branch.system.parameter, []
    for system, (point, event) in ((piece.system, row) for piece in branch.each for row in rows(piece)):
        spectrum = spectrum_of(point)
        kind = CycleType.of(spectrum.multipliers, spectrum.determinant == 1)
        if sides := sides_at(system, point):
            kind = CycleType(sides.stability)
        form = event.form if event is not None else None
        points.append(
            {
                parameter: float(point.z[-1]),
                "arclength": point.s,
                **_bounces(system.recurrence, point.z[:-1]),
                "multipliers": [{"real": m.real, "imaginary": m.imag} for m in spectrum.multipliers],
                "determinant": spectrum.determinant,
                "stable": kind is CycleType.STABLE if sides else spectrum.stable,
                "stability": kind.value,
                "event": event.kind.value if event is not None else None,
                "branch_coefficient": form.branch if form is not None else None,
                "supercritical": form.supercritical if form is not None else None,
            }
        )
    return {"cycle": branch.system.label, "parameter": parameter, **_ended(branch), "points": points}


def sides_at(system: Cycles, point: CurvePoint) -> OneSided | None:
    """The one-sided derivatives of a cycle that stays on joins, and its stability; None if its derivative is unique."""
    ring = system.recurrence
    if not isinstance(ring, Chords) or ring.shapes or len(ring.table.components) == 1:
        return None
    at, x = ring.placed(point.z[:-1])
    known = joins(ring.table)
    several = known.sides(at.components, x)
    if len(several) == 1:
        return None
    rings = [(replace(at, components=parts), y) for parts, y in several]
    rows = [one.terms(y, system.at(point.z), 1).listed().rows for one, y in rings]
    slopes = [known.slopes(at.components, parts) for parts, _ in several]
    return verdict([of_rows(row, slope) for row, slope in zip(rows, slopes, strict=True)])


def _bounces(ring: Recurrence, x: Array) -> dict[str, Any]:
    """The boundary parameters of the bounces, and their components where the table has several, as JSON."""
    at, x = _placed(ring, x)
    theta: dict[str, Any] = {"theta": [float(value) for value in x]}
    if isinstance(at, Chords) and len(at.table.components) > 1:
        theta["components"] = list(at.components)
    return theta


def _ended(branch: Branch) -> dict[str, str]:
    return {"first_end": branch.ends[0][1], "last_end": branch.ends[1][1]}
