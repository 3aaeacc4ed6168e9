"""Tables from files of data: points in a CSV file, closed paths in an SVG file.

The exact table is what the file says: a decimal is the decimal it shows. SVG files are read by svgelements, an
optional package, with their transforms; there `y` points down, and is turned round so that the table looks as drawn.
An arc becomes cubic curves of at most 11.25 degrees, which miss it by less than 1e-7 of its radius.
"""

import csv
from fractions import Fraction
from math import ceil, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import PLAIN

if TYPE_CHECKING:
    from symbolic.tables.table import Table

PIECE = pi / 16  # of an arc
NEAR = Fraction(1, 10**12)  # two points closer than this, against their size, are one: arcs end with rounding
LARGEST = 1 << 22  # bytes
Point = tuple[Fraction, Fraction]


def drawn(data: str | None, smoothness: int | None, degree: int | None) -> "Table | None":
    """The table of the option --data; None where there is none."""
    svg = data is not None and data.lower().endswith(".svg")
    for option, value in (("--smoothness", smoothness), ("--degree", degree)):
        if value is not None and (data is None or svg):
            raise ValueError(f"{option} = {value} says how points are fitted; give a file of them with --data FILE.csv")
    if data is None:
        return None
    return of_svg(data) if svg else of_points(data, smoothness, degree)


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
    from symbolic import tables

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
    curves: list[list[list[Point]]] = []
    for element in read.elements():
        if isinstance(element, svg.Shape):
            curves += [_pieces(svg, path, part) for part in svg.Path(element).as_subpaths()]
    curves = [curve for curve in curves if curve]
    if not curves:
        raise ValueError(f"--data {path!r} has no closed path; accepted: paths, circles, rectangles and polygons")
    try:
        return tables.from_path(curves)
    except ValueError as error:
        raise ValueError(f"--data {path!r}: {error}") from None


def _pieces(svg: Any, path: str, part: Any) -> list[list[Point]]:
    """The pieces of one closed path, each by its control points."""
    found: list[list[Point]] = []
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


def _text(option: str, path: str) -> str:
    file = Path(path)
    try:
        if file.is_file() and file.stat().st_size > LARGEST:
            raise ValueError(f"{option} {path!r} is larger than {LARGEST >> 20} MB; accepted: smaller files")
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as reason:
        raise ValueError(f"{option} {path!r} cannot be read: {reason}") from None
