"""Where the particles of `pinball orbit` start: on the wall, at an interior point, or each row of a file.

A start on the wall is a boundary parameter (or an arc length) and an exit angle. A start inside is a point and a
direction; its first bounce is at the first wall that it meets. The quantities of all bounces are in one table.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from numeric.pinball.sampling import boundary, flight_through
from numeric.pinball.states import KEYS, STATUSES, Orbit, flights
from symbolic.tables.definition import exact
from verification.app.cli import reason
from verification.app.scene import start_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from numeric import PinballMap

MORE = ("flight", "time")
MOST = 1_000_000  # starts in a file
FILES = "theta,phi", "theta,phi,component", "s,phi", "x,y,dx,dy", "x,y,angle"  # headers of a file of starts


@dataclass(frozen=True)
class Start:
    """A particle that leaves the wall, or starts at the interior point `inside` in the middle of a flight.

    `given` has the parameter and the angle as exact numbers, if they were typed.
    """

    theta: float
    phi: float
    component: int = 0
    inside: tuple[float, float] | None = None
    given: tuple[Any, Any] | None = field(default=None, compare=False)


def chosen(
    map: "PinballMap",
    start: str | None,
    point: str | None,
    towards: str | None,
    component: str | None,
    file: Path | None,
) -> list[Start]:
    """The starts that the options describe; `ValueError` if the options contradict each other."""
    given = [name for name, value in (("--start", start), ("--from", point), ("--starts", file)) if value is not None]
    if len(given) != 1:
        raise ValueError(
            f"one start is needed, {' and '.join(given) or 'none'} given; accepted: --start THETA,PHI, "
            "--from X,Y --towards DX,DY, or --starts FILE.csv"
        )
    if (point is None) != (towards is None):
        raise ValueError("--from X,Y and --towards DX,DY make a start together; give both")
    names = [part.name for part in map.ir.parts]
    if component is not None and component not in names:
        raise ValueError(f"--component = {component} is not on this table; accepted: {', '.join(names)}")
    if component is not None and (start is None or start.startswith("s=")):
        raise ValueError(f"--component {component}: the start says on which one it is; leave --component out")
    if file is not None:
        return of_file(map, file)
    if point is not None and towards is not None:
        return [from_inside(map, *_pair("--from", point), *_direction(towards))]
    assert start is not None
    if start.startswith("s="):
        s, phi = _pair("--start", start[2:])
        return [at_length(map, s, phi)]
    theta, angle = start_of(start)
    at = _number("--start", theta), _number("--start", angle)
    return [Start(*at, names.index(component or names[0]), None, (theta, angle))]


def at_length(map: "PinballMap", s: float, phi: float) -> Start:
    """A start at an arc length, taken modulo the perimeter."""
    component, theta = boundary(map, np.array([s]))
    return Start(float(theta[0]), phi, int(component[0]))


def from_inside(map: "PinballMap", x: float, y: float, vx: float, vy: float) -> Start:
    """A start at an interior point, in a direction."""
    theta, phi, component = flight_through(map, x, y, vx, vy)
    return Start(theta, phi, component, (x, y))


def of_file(map: "PinballMap", path: Path) -> list[Start]:
    """The starts of a CSV file, whose first line names the columns."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as lines:
            rows = [row for row in csv.reader(lines) if row and not row[0].lstrip().startswith("#")]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"--starts {path} cannot be read: {reason(error)}") from None
    header = ",".join(word.strip() for word in rows[0]) if rows else ""
    if header not in FILES:
        raise ValueError(f"--starts {path}: the first line is {header[:60]!r}; accepted: {', or '.join(FILES)}")
    if not 2 <= len(rows) <= MOST + 1:
        raise ValueError(f"--starts {path} has {len(rows) - 1} starts; accepted: 1 to {MOST}")
    return [_of_row(map, header, row, f"--starts {path}, start {number}") for number, row in enumerate(rows[1:], 1)]


def _of_row(map: "PinballMap", header: str, row: Sequence[str], label: str) -> Start:
    names = header.split(",")
    if len(row) != len(names):
        raise ValueError(f"{label}: {len(row)} columns; accepted: {len(names)}, as {header}")
    if header == "theta,phi,component":
        parts = [part.name for part in map.ir.parts]
        if (own := row[2].strip()) not in parts:
            raise ValueError(f"{label}: {own} is not on this table; accepted: {', '.join(parts)}")
        return Start(_number(label, row[0]), _number(label, row[1]), parts.index(own))
    numbers = [_number(label, text) for text in row]
    try:
        if header == "theta,phi":
            return Start(numbers[0], numbers[1])
        if header == "s,phi":
            return at_length(map, numbers[0], numbers[1])
        x, y, *rest = numbers
        return from_inside(map, x, y, *(rest if len(rest) == 2 else _heading(rest[0])))
    except ValueError as reason:
        raise ValueError(f"{label}: {reason}") from None


def _number(label: str, given: Any) -> float:
    """A text or an exact number as a float."""
    try:
        found = float(given)
    except (ValueError, OverflowError):
        found = np.inf
    if not np.isfinite(found):
        text = f"{given.strip()[:40]!r} is no finite number" if isinstance(given, str) else "a number is too large"
        raise ValueError(f"{label}: {text}")
    return found


def _pair(label: str, text: str) -> tuple[float, float]:
    parts = text.split(",")
    if len(parts) != 2:
        raise ValueError(f"{label} {text!r} is no pair of numbers; give two such as 0.5,-pi/6")
    one, two = (_number(label, exact(label, part.strip())) for part in parts)
    return one, two


def _direction(text: str) -> tuple[float, float]:
    """The direction `(dx, dy)` from the text `DX,DY`, or from one angle to the x axis."""
    return _pair("--towards", text) if "," in text else _heading(_number("--towards", exact("--towards", text.strip())))


def _heading(angle: float) -> tuple[float, float]:
    return float(np.cos(angle)), float(np.sin(angle))


def fields_of(text: str | None) -> tuple[str, ...] | None:
    """The columns that `--fields` names.

    >>> fields_of("x,y,flight")
    ('x', 'y', 'flight')
    """
    if text is None:
        return None
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in (*KEYS, *MORE):
            raise ValueError(
                f"--fields {text}: {name!r} is no field of a bounce; accepted: {', '.join((*KEYS, *MORE))}"
            )
    if len({*names}) < len(names):
        raise ValueError(f"--fields {text} names a field twice; accepted: each once")
    return names


def columns(
    map: "PinballMap", starts: Sequence[Start], bounces: int, fields: Sequence[str]
) -> "dict[str, NDArray[Any]]":
    """The named fields of each bounce and particle, with its `code`, as arrays of shape `(bounces + 1, particles)`.

    For a particle that starts in the interior, the start has component -1, and its parameter and angle are nan.
    """
    needed = {*fields} & {*Orbit._fields, "s"} | {"code"} | ({"x", "y"} if {*fields} & {*MORE} else set())
    theta, phi, component = _arrays(starts)
    names = tuple(name for name in (*Orbit._fields, "s") if name in needed)
    found: dict[str, NDArray[Any]] = map.orbit(theta, phi, bounces, component, fields=names)
    for i, each in enumerate(starts):
        if each.inside is not None:
            first = {"component": -1, "x": each.inside[0], "y": each.inside[1], "code": 0}
            for name, rows in found.items():
                rows[0, i] = first.get(name, np.nan)
    if {*fields} & {*MORE}:
        found["flight"], found["time"] = flights(found["x"], found["y"], found["code"])
    return {name: found[name] for name in (*fields, "code") if name in found}


def _arrays(starts: Sequence[Start]) -> "tuple[NDArray[Any], NDArray[Any], NDArray[Any]]":
    """Parameters, exit angles and components of the starts, as arrays."""
    return (
        np.array([each.theta for each in starts]),
        np.array([each.phi for each in starts]),
        np.array([each.component for each in starts]),
    )


def entries_of(map: "PinballMap", found: "dict[str, NDArray[Any]]", particle: int) -> list[dict[str, Any]]:
    """A dictionary for each bounce of a particle until it stops; missing numbers are None."""
    names = [part.name for part in map.ir.parts]
    codes = found["code"][:, particle]
    stopped = np.flatnonzero(codes)
    rows = {
        name: values[: stopped[0] + 1 if stopped.size else None, particle].tolist() for name, values in found.items()
    }
    told: dict[str, list[Any]] = {"status": [STATUSES[code].name.lower() for code in rows["code"]]}
    for name, values in rows.items():
        if name == "component":
            told[name] = [None if index < 0 else names[index] for index in values]
        else:
            told[name] = [None if value != value else value for value in values]
    return [dict(zip(told, row, strict=True)) for row in zip(*told.values(), strict=True)]


def written(map: "PinballMap", starts: Sequence[Start], bounces: int, path: Path, fields: Sequence[str] | None) -> str:
    """Writes all bounces as rows, in the format of the file's ending; returns the first stopped particle's status."""
    from numeric.sweeps.orbits import COLUMNS, record, table_written

    several = len(starts) > 1
    if path.suffix == ".zarr":
        if fields is not None and {*fields} - {*COLUMNS}:
            raise ValueError(
                f"--fields {','.join(fields)}: a .zarr store has the fields {', '.join(COLUMNS)} only; leave others out"
            )
        if any(each.inside for each in starts):
            raise ValueError(f"--out {path}: a .zarr store holds starts on the wall; accepted: .csv, .npz or .parquet")
        names = COLUMNS if fields is None else tuple(dict.fromkeys((*(f for f in fields if f != "status"), "code")))
        theta, phi, component = _arrays(starts)
        codes = record(map, path, theta, phi, bounces, component, fields=names).code.values[-1]
    else:
        asked = [name for name in fields or COLUMNS if name not in ("status", "code")]
        found = columns(map, starts, bounces, asked)
        codes = found["code"][-1]
        index = np.indices(found["code"].shape)
        numbers = {"bounce": index[0], **({"particle": index[1]} if several else {})}
        rows = {name: values.T.ravel() for name, values in (numbers | found).items()}
        if fields is None and not several and path.suffix != ".csv":
            del rows["bounce"]  # the number of the row
        table_written(rows, path)
    return str(STATUSES[next((code for code in codes if code), 0)].name.lower())
