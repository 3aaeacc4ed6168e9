"""Where a branch starts: a cycle of the paper by its name, or bounces that somebody typed."""

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np
from sympy import Expr, N, S

from symbolic import named_cycles, tables
from symbolic.cycles import Cycle
from symbolic.table import Table
from verification.continuation.branch import branch
from verification.continuation.recurrence import Array, Chords

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


def freed(ring: Chords, K: int, letter: str, interval: Sequence[Expr | Fraction]) -> Chords:
    """The same ring on the table with its shape left free; refused when an end of the interval is no shape."""
    table = tables.named(ring.table.name, K)
    for value in interval:
        try:
            table.at(**{letter: S(value)})
        except ValueError as why:
            raise ValueError(f"--shape: {why}") from None
    return Chords(table, ring.components, ring.ends)
