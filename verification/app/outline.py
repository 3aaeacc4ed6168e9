"""Tables from files of data: points in a CSV file, closed paths in an SVG file, outlines in a DXF file.

The exact table is what the file says: a decimal is the decimal it shows. SVG files are read by svgelements, an
optional package, with their transforms; there `y` points down, and is turned round so that the table looks as drawn.
DXF files are read by ezdxf, which is optional too, with their blocks; lines, arcs and curves that end where others
begin are joined. An arc becomes cubic curves of at most 11.25 degrees, which miss it by less than 1e-7 of its radius.
"""

import csv
from collections.abc import Iterator
from fractions import Fraction
from math import atan, ceil, pi, radians, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import PLAIN

if TYPE_CHECKING:
    from symbolic.tables.table import Table

PIECE = pi / 16  # of an arc
NEAR = Fraction(1, 10**12)  # two points closer than this, against their size, are one: arcs end with rounding
LARGEST = 1 << 22  # bytes
JOINED = Fraction(1, 10**9)  # two ends in a DXF file closer than this, against the drawing's size, are one
DRAWN = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE")
Point = tuple[Fraction, Fraction]
Pieces = list[list[Point]]


def drawn(data: str | None, smoothness: int | None, degree: int | None) -> "Table | None":
    """The table of the option --data; None where there is none."""
    ending = None if data is None else Path(data).suffix.lower()
    for option, value in (("--smoothness", smoothness), ("--degree", degree)):
        if value is not None and ending in (None, ".svg", ".dxf"):
            raise ValueError(f"{option} = {value} says how points are fitted; give a file of them with --data FILE.csv")
    if data is None:
        return None
    if ending == ".dxf":
        return of_dxf(data)
    return of_svg(data) if ending == ".svg" else of_points(data, smoothness, degree)


def of_points(path: str, smoothness: int | None = None, degree: int | None = None) -> "Table":
    """The table fitted to the points of a file: two numbers on a line, apart by a comma, semicolon, tab or blanks.

    A first line that holds no numbers is the heading; lines that begin with `#` say nothing.
    """
    from symbolic import tables

    text = _text("--data", path)
    if not text.strip():
        raise ValueError(f"--data {path!r} holds no points; accepted: a file with x and y on each line")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    mark = next((mark for mark in ",;\t" if mark in lines[-1]), None)
    rows = [line.split() for line in lines] if mark is None else list(csv.reader(lines, delimiter=mark))
    pairs: list[tuple[Fraction, Fraction]] = []
    for i, row in enumerate(rows, 1):
        cells = [cell.strip() for cell in row]
        numbers = [cell for cell in cells if PLAIN.fullmatch(cell)]
        if i == 1 and not numbers:
            continue
        if len(cells) != 2 or len(numbers) != 2:
            shown = (mark or " ").join(row)[:80]
            raise ValueError(f"--data {path!r}: line {i} of data is {shown!r}; accepted: two numbers, x and y")
        pairs.append((Fraction(cells[0]), Fraction(cells[1])))
    if len(pairs) > 1 and pairs[0] == pairs[-1]:
        pairs.pop()  # written down twice, to close the curve
    try:
        return tables.from_points([(str(x), str(y)) for x, y in pairs], smoothness=smoothness, degree=degree)
    except ValueError as error:
        raise ValueError(f"--data {path!r}: {error}") from None


def of_svg(path: str) -> "Table":
    """The table that the closed paths of an SVG file bound: the largest is the boundary, the others are holes."""
    text = _text("--data", path)
    try:
        import svgelements as svg
    except ModuleNotFoundError:
        raise ValueError(
            "--data needs the package svgelements; install it with: pip install 'pinball-billiards[outline]'"
        ) from None
    import io
    from xml.etree.ElementTree import ParseError

    try:
        read = svg.SVG.parse(io.StringIO(text))
    except (ParseError, ValueError) as error:
        raise ValueError(f"--data {path!r} is no SVG file: {error}") from None
    curves: list[Pieces] = []
    for element in read.elements():
        if isinstance(element, svg.Shape):
            curves += [_pieces(svg, path, part) for part in svg.Path(element).as_subpaths()]
    curves = [curve for curve in curves if curve]
    if not curves:
        raise ValueError(f"--data {path!r} has no closed path; accepted: paths, circles, rectangles and polygons")
    return _bounded(path, curves)


def _bounded(path: str, curves: list[Pieces]) -> "Table":
    from symbolic import tables

    try:
        return tables.from_path(curves)
    except ValueError as error:
        raise ValueError(f"--data {path!r}: {error}") from None


def of_dxf(path: str) -> "Table":
    """The table that the outlines of a DXF file bound: the largest is the boundary, the others are holes."""
    _text("--data", path, "latin-1")  # what cannot be opened, or is too large
    try:
        from ezdxf.disassemble import recursive_decompose
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
        from ezdxf.path import make_path
    except ModuleNotFoundError:
        raise ValueError(
            "--data needs the package ezdxf; install it with: pip install 'pinball-billiards[outline]'"
        ) from None
    try:
        model = readfile(path).modelspace()
    except (OSError, DXFError, UnicodeDecodeError, ValueError) as error:
        raise ValueError(f"--data {path!r} is no DXF file: {error}") from None
    runs = []
    for entity in recursive_decompose(model):
        if entity.dxftype() in DRAWN:
            whole = make_path(entity, segments=_segments(entity), level=8)
            runs += [_run(part) for part in whole.sub_paths()]
    runs = [run for run in runs if run]
    if not runs:
        raise ValueError(f"--data {path!r} has no outline; accepted: {', '.join(DRAWN)}")
    size = max(abs(x) for run in runs for piece in run for point in piece for x in point)
    return _bounded(path, list(_joined(path, runs, JOINED * max(size, Fraction(1, 10**6)))))


def _segments(entity: Any) -> int:
    """What ezdxf is told so that no arc of an entity becomes cubics of more than 11.25 degrees."""
    kind, dxf = entity.dxftype(), entity.dxf
    if kind in ("LWPOLYLINE", "POLYLINE"):  # of a bulge it makes a third as many
        bulges = (
            [b for (b,) in entity.get_points("b")] if kind == "LWPOLYLINE" else [v.dxf.bulge for v in entity.vertices]
        )
        return 3 * _cubics(max((4 * atan(abs(bulge)) for bulge in bulges), default=0.0))
    if kind == "ARC":
        return _cubics(radians((dxf.end_angle - dxf.start_angle) % 360 or 360))
    return _cubics((dxf.end_param - dxf.start_param) % tau or tau) if kind == "ELLIPSE" else _cubics(tau)


def _cubics(turn: float) -> int:
    return max(1, ceil(turn / PIECE - 1e-9))


def _run(part: Any) -> Pieces:
    """The pieces of one path of ezdxf, each by its control points, but for those of no length."""
    found: Pieces = []
    start = part.start
    for command in part.commands():
        controls = [point for point in (getattr(command, f"ctrl{k}", None) for k in (1, 2)) if point is not None]
        controls = controls or [point for point in (getattr(command, "ctrl", None),) if point is not None]
        points = [(_shown(p.x), _shown(p.y)) for p in (start, *controls, command.end)]
        start = command.end
        if not all(_near(point, points[0]) for point in points):
            points[0] = found[-1][-1] if found else points[0]
            found.append(points)
    return found


def _joined(path: str, runs: list[Pieces], near: Fraction) -> Iterator[Pieces]:
    """The closed curves that runs of pieces make, end to end, whichever way each was drawn."""

    def meet(p: Point, q: Point) -> bool:
        return max(abs(p[0] - q[0]), abs(p[1] - q[1])) <= near

    left = list(runs)
    while left:
        curve = left.pop(0)
        while (len(curve) == 1 and len(curve[0]) == 2) or not meet(curve[-1][-1], curve[0][0]):
            end = curve[-1][-1]
            following = [run for run in left if meet(run[0][0], end) or meet(run[-1][-1], end)]
            if len(following) != 1:
                x, y = map(float, end)
                said = "is open" if not following else "branches"
                raise ValueError(f"--data {path!r}: an outline {said} at ({x:.6g}, {y:.6g}); accepted: closed outlines")
            (run,) = following
            left = [other for other in left if other is not run]
            if not meet(run[0][0], end):
                run = [piece[::-1] for piece in reversed(run)]
            curve = [*curve, [end, *run[0][1:]], *run[1:]]
        yield [*curve[:-1], [*curve[-1][:-1], curve[0][0]]]


def _pieces(svg: Any, path: str, part: Any) -> Pieces:
    """The pieces of one closed path, each by its control points."""
    found: Pieces = []
    for segment in part:
        if isinstance(segment, svg.Move):
            continue
        segments = [segment]
        if isinstance(segment, svg.Arc):
            segments = list(segment.as_cubic_curves(max(1, ceil(abs(segment.sweep) / PIECE))))
        for each in segments:
            points = [each.start, getattr(each, "control1", None) or getattr(each, "control", None)]
            points += [getattr(each, "control2", None), each.end]
            exact = [(_shown(p.x), -_shown(p.y)) for p in points if p is not None]
            if found:
                exact[0] = found[-1][-1]
            if not all(_near(point, exact[0]) for point in exact):
                found.append(exact)
    if found and found[-1][-1] != found[0][0]:
        if not _near(found[-1][-1], found[0][0]):
            raise ValueError(f"--data {path!r}: a path is not closed; end it with Z")
        found[-1][-1] = found[0][0]
    return found


def _near(p: Point, q: Point) -> bool:
    size = max(abs(q[0]), abs(q[1]), Fraction(1))
    return max(abs(p[0] - q[0]), abs(p[1] - q[1])) <= NEAR * size


def _shown(value: float) -> Fraction:
    """The shortest decimal that is this float: the one that the file shows, where nothing moved it."""
    return Fraction(repr(float(value)))


def _text(option: str, path: str, encoding: str = "utf-8-sig") -> str:
    file = Path(path)
    try:
        if file.is_file() and file.stat().st_size > LARGEST:
            raise ValueError(f"{option} {path!r} is larger than {LARGEST >> 20} MB; accepted: smaller files")
        return file.read_text(encoding=encoding)
    except (OSError, UnicodeDecodeError) as reason:
        raise ValueError(f"{option} {path!r} cannot be read: {reason}") from None
