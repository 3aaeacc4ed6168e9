"""How a branch comes in and goes out: its starting cycle, by name or by bounces typed; its points as a labelled table.

The table is an xarray Dataset or a record for JSON. Points and events stand in one order, by arc length along the
branch; `event` is empty at an ordinary point.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Expr, N, S

from symbolic import tables
from symbolic.cycles import cycle as named_cycles
from symbolic.cycles.cycle import Cycle
from symbolic.tables.table import Table
from verification.cycles.continuation.arc import Point
from verification.cycles.continuation.branch import Branch, Event, branch, spectrum_of
from verification.cycles.recurrence.chords import Chords
from verification.cycles.recurrence.recurrence import Array

if TYPE_CHECKING:
    import xarray


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
    """The ring, its bounces, and the contraction it belongs to.

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
    """The ring of bounces at the parameters `theta`, on the components named; on the first one when none is."""
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
    """The cycle near `x` at the contraction `given`, followed to `lam`; the one that its branch meets there first."""
    if given == lam:
        return x
    found = branch(ring, x, "lam", given, (min(given, lam), max(given, lam)))
    there = [point for point in (found.points[0], found.points[-1]) if point.z[-1] == lam]
    if not there:
        raise ValueError(f"{ring.label}: the cycle at lam = {given} does not reach lam = {lam}; give another --start")
    return min(there, key=lambda point: abs(point.s)).z[:-1]


def freed(ring: Chords, K: int, parameter: str, interval: Sequence[Expr | Fraction]) -> Chords:
    """The same ring on the table with its shape left free; refused when an end of the interval is no shape."""
    table = tables.named(ring.table.name, K)
    for value in interval:
        try:
            table.at(**{parameter: S(value)})
        except ValueError as why:
            raise ValueError(f"--shape: {why}") from None
    return Chords(table, ring.components, ring.closure)


def rows(branch: Branch) -> list[tuple[Point, Event | None]]:
    """Points and events in order."""
    both: list[tuple[Point, Event | None]] = [(point, None) for point in branch.points]
    both += [(event.point, event) for event in branch.events]
    return sorted(both, key=lambda row: (row[0].s, row[1] is not None))


def dataset(branch: Branch) -> "xarray.Dataset":
    """Dimensions `point`, `bounce` and `which` (multiplier); the parameter and the event are coordinates.

    >>> from verification.cycles.continuation.branch import branch as followed
    >>> from verification.cycles.recurrence.recurrence import logistic
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
        "event": ("point", np.array(["" if e is None else e.what.value for _, e in listed])),
    }
    about = {"cycle": branch.system.label, "letter": parameter, **_ended(branch)}
    return xarray.Dataset(values, coordinates, attrs=about)


def record(branch: Branch) -> dict[str, Any]:
    """The same for JSON."""
    parameter, points = branch.system.parameter, []
    for point, event in rows(branch):
        spectrum = spectrum_of(point)
        form = event.form if event is not None else None
        points.append(
            {
                parameter: float(point.z[-1]),
                "arclength": point.s,
                "theta": [float(x) for x in point.z[:-1]],
                "multipliers": [{"real": m.real, "imaginary": m.imag} for m in spectrum.multipliers],
                "determinant": spectrum.determinant,
                "stable": spectrum.stable,
                "event": event.what.value if event is not None else None,
                "branch_coefficient": form.branch if form is not None else None,
                "supercritical": form.supercritical if form is not None else None,
            }
        )
    return {"cycle": branch.system.label, "letter": parameter, **_ended(branch), "points": points}


def _ended(branch: Branch) -> dict[str, str]:
    return {"first_end": branch.ends[0][1], "last_end": branch.ends[1][1]}
