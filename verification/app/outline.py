"""Tables from files of data: points, polygons of GIS programs (GeoJSON, WKT), drawings in SVG or DXF.

The table is exact: each decimal in the file is taken as the number it shows. SVG files are read by svgelements, DXF
files by ezdxf, both optional packages. Pieces are joined end to end. Arcs of circles and ellipses are kept; only if the
outline has Bezier curves as well, they are replaced by cubic curves within 1e-7 of their radius.
"""

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from math import atan, atan2, cos, floor, pi, sin, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from symbolic.tables.definition import exact
from verification.app.cli import reason
from verification.app.points import rings

if TYPE_CHECKING:
    from symbolic.tables.table import Table
    from verification.app.drawings import Point, Run, Side

LARGEST = 1 << 22  # bytes
JOINED = Fraction(1, 10**9)  # times the extent: gaps that are closed without a tolerance
ROUNDING = Fraction(1, 2**50)  # times the coordinates of a drawing: gaps from their rounding
ROUNDED = Fraction(1, 10**12)  # times the size: error of a control point beside its tangent
SLIGHT = 0.02  # radians: a smaller bend may be rounding in the file
LISTED = 6  # curves in a sentence
FINE = 8  # cubic curves for a quarter of a turn


class Data(NamedTuple):
    """A file of data and how it is read, as given by the options of a command line."""

    path: str
    smoothness: int | None = None
    degree: int | None = None
    tolerance: str | None = None
    units: str | None = None
    layers: tuple[str, ...] = ()
    curves: tuple[int, ...] = ()


class Outline(NamedTuple):
    """A table, and sentences about how the file was read: what was left out, what was closed."""

    table: "Table"
    notes: list[str]


def read(data: Data) -> Outline:
    """The table of the option --data, with notes; `ValueError` if the file holds no table."""
    ending = Path(data.path).suffix.lower()
    drawing = ending in (".svg", ".dxf")
    text = _text("--data", data.path, "latin-1" if ending == ".dxf" else "utf-8-sig")
    for option, value in (("--smoothness", data.smoothness), ("--degree", data.degree)):
        if value is not None and drawing:
            raise ValueError(f"{option} = {value} says how points are fitted; give a file of them with --data FILE.csv")
    for option, given in (("--units", data.units), ("--layer", data.layers), ("--curve", data.curves)):
        if given and not drawing:
            raise ValueError(f"{option} is for drawings, .svg or .dxf, and {data.path!r} is none; leave it out")
    try:
        return _of_drawing(data, ending, text) if drawing else _of_text(data, text)
    except OverflowError:
        raise ValueError(f"--data {data.path!r} has numbers that are too large; accepted: up to 1e100") from None
    except ValueError as error:
        said = str(error)
        raise ValueError(said if said.startswith("--") else f"--data {data.path!r}: {said}") from None


# ---- points and polygons


def _of_text(data: Data, text: str) -> Outline:
    found, polygon = rings(text)
    straight = polygon and data.smoothness is None and data.degree is None
    return _fitted(data, found, 0 if straight else data.smoothness)


def _fitted(data: Data, rings: "list[list[Point]]", smoothness: int | None) -> Outline:
    """The table from points: a curve or a polygon through one ring, or a polygon with holes through several rings."""
    from symbolic import tables
    from symbolic.tables.measured import unclosed

    notes, kept = [], []
    for ring in rings:
        near = _near(data, ring)
        open_ = unclosed(ring)
        while len(open_) > 2 and _gap(open_[0], open_[-1]) <= near:
            open_ = open_[:-1]
        different = [p for p, before in zip(open_, [*open_[-1:], *open_[:-1]], strict=True) if _gap(p, before) > near]
        if len(open_) < len(ring):
            how = "the first" if ring[0] == ring[-1] else "the first up to rounding"
            notes.append(f"closed: the last point is {how}")
        if len(different) < len(open_):
            notes.append(f"{len(open_) - len(different)} repeated points are left out")
        kept.append(different)
    if len(kept) == 1:
        points = [(str(x), str(y)) for x, y in kept[0]]
        table = tables.from_points(points, smoothness=smoothness, degree=data.degree)
    elif smoothness or data.degree is not None:
        raise ValueError("a polygon with holes has straight sides; leave --smoothness and --degree out")
    else:
        table = tables.from_path([list(zip(ring, [*ring[1:], *ring[:1]], strict=True)) for ring in kept])
    how = "straight sides" if smoothness == 0 else "a Fourier sum" if data.degree else "a spline"
    x, y = _extent([p for ring in kept for p in ring])
    said = f"{sum(map(len, kept))} points of {_count(len(kept), 'curve')}, joined by {how}, {x:.6g} by {y:.6g}"
    return Outline(table, ["; ".join([said, *notes])])


# ---- drawings


def _of_drawing(data: Data, ending: str, text: str) -> Outline:
    from verification.app import drawings

    package = "svgelements" if ending == ".svg" else "ezdxf"
    try:
        drawing = drawings.of_svg(data.path, text) if ending == ".svg" else drawings.of_dxf(data.path)
    except ModuleNotFoundError:
        raise ValueError(
            f"--data needs the package {package}; install it with: pip install '.[outline]' in a checkout"
        ) from None
    runs, unit, notes = drawing.runs, drawing.unit, list(drawing.notes)
    layers = list(dict.fromkeys(run.layer for run in runs if run.layer))
    for layer in data.layers:
        if layer not in layers:
            raise ValueError(f"--layer {layer!r} draws nothing; accepted: {', '.join(layers[:20]) or 'none'}")
    runs = [run for run in runs if not data.layers or run.layer in data.layers]
    if not data.curves and not all(run.page for run in runs):
        pages = sum(run.page for run in runs)
        runs = [run for run in runs if not run.page]
        notes += [f"left out: {_count(pages, 'background')} as large as the page"] if pages else []
    if not runs:
        kinds = "paths, circles, rectangles and polygons" if ending == ".svg" else ", ".join(drawings.DRAWN)
        raise ValueError(f"has no {'closed path' if ending == '.svg' else 'outline'}; accepted: {kinds}")
    if data.units is not None:
        scale = _scale(data.units, unit)
        runs = [run._replace(sides=[drawings.scaled(side, scale) for side in run.sides]) for run in runs]
        unit = data.units
    pieces = [run.sides for run in runs]
    closed, open_ = ([p for p in pieces if (_both(p)[0] == _both(p)[1]) == word] for word in (True, False))
    open_, again = _different(open_)
    notes += [f"{_count(again, 'piece')} drawn twice, read once"] if again else []
    curves = _joined(data, [*closed, *open_], notes)
    curves, copies = _different(curves)
    notes += [f"{_count(copies, 'curve')} drawn twice, read once"] if copies else []
    return _bounded(data, curves, unit, notes)


def _scale(wanted: str, unit: str | None) -> Fraction:
    from verification.app.drawings import MM

    if unit is None:
        raise ValueError(f"--units {wanted}: the file names no unit; leave --units out")
    if wanted not in MM:
        raise ValueError(f"--units {wanted!r} is no unit; accepted: {', '.join(MM)}")
    return MM[unit] / MM[wanted]


def _bounded(data: Data, curves: "list[Run]", unit: str | None, notes: list[str]) -> Outline:
    """The table that the chosen curves bound, with notes on what was read."""
    from symbolic import tables
    from symbolic.tables.outlines import ConicArc, area
    from symbolic.tables.polynomial import elevated

    def size(curve: "Run") -> Fraction:
        return abs(area([side if isinstance(side, ConicArc) else elevated(side) for side in curve]))

    curves = sorted(curves, key=size, reverse=True)
    label = f" {unit}" if unit else ""

    def about(i: int, curve: "Run") -> str:
        x, y = _extent(_hull(curve))
        word = f"curve {i}" if len(curves) > 1 else "1 curve"
        return f"{word} of {_count(len(curve), 'piece')}, {x:.6g} by {y:.6g}{label}, area {float(size(curve)):.6g}"

    said = [about(i, curve) for i, curve in enumerate(curves, 1)]
    listed = "; ".join([*said[:LISTED], *([f"and {len(said) - LISTED} more"] if len(said) > LISTED else [])])
    if wrong := [i for i in data.curves if not 1 <= i <= len(curves)]:
        raise ValueError(f"--curve {wrong[0]} is not there; accepted: {listed}")
    chosen = [curves[i - 1] for i in sorted(set(data.curves))] or curves
    if len(chosen) < len(curves):
        notes = [f"chosen: {', '.join(f'curve {i}' for i in sorted(set(data.curves)))}", *notes]
    bent = any(not isinstance(side, ConicArc) and len(side) > 2 for curve in chosen for side in curve)
    if bent and any(isinstance(side, ConicArc) for curve in chosen for side in curve):
        chosen = [[part for side in curve for part in _cubics(side)] for curve in chosen]
        notes = [*notes, "arcs are cubic curves within 1e-7 of their radius, as there are Bezier curves"]
    tolerance = Fraction(0) if data.tolerance is None else _near(data, [])
    chosen = [_aligned(curve, tolerance) for curve in chosen]
    notes = [*notes, *_nearly_smooth(chosen)]
    try:
        table = tables.from_path(chosen)
    except ValueError as error:
        more = f"; the file has {listed}; --curve N chooses one" if len(curves) > 1 else ""
        raise ValueError(f"{error}{more}") from None
    return Outline(table, [listed, *(["; ".join(notes)] if notes else [])])


def _aligned(curve: "Run", tolerance: Fraction) -> "Run":
    """The curve; at each join whose tangents differ only by rounding or the tolerance, they are made equal."""
    from symbolic.tables.outlines import ConicArc, aligned_arcs
    from symbolic.tables.polynomial import aligned, elevated

    pieces = [elevated(side) for side in curve if not isinstance(side, ConicArc)]
    if len(pieces) < len(curve):
        return aligned_arcs(curve, tolerance)
    near = ROUNDED * max(abs(x) for piece in pieces for point in piece for x in point)
    return [list(piece) for piece in aligned(pieces, max(near, tolerance))]


def _nearly_smooth(curves: "list[Run]") -> Iterable[str]:
    """Yields a sentence about joins of curved pieces whose angle is so small that they may be meant as smooth."""
    from symbolic.tables.outlines import ConicArc, directions, shorter
    from symbolic.tables.polynomial import elevated

    angles, wide = [], 0.0
    for curve in curves:
        for before, after in pairwise([*curve[-1:], *curve]):
            (x, y), (u, v) = directions(before)[1], directions(after)[0]
            angle = abs(atan2(x * v - y * u, x * u + y * v))
            curved = any(isinstance(s, ConicArc) or elevated(s) != elevated((s[0], s[-1])) for s in (before, after))
            if 0 < angle < SLIGHT and curved:
                angles.append(angle)
                wide = max(wide, angle * float(shorter(before, after)))
    if angles:
        yield (
            f"{_count(len(angles), 'join')} of curved pieces bend by up to {max(angles):.2g} radians; "
            f"--tolerance {2 * wide:.2g} makes such joins smooth"
        )


def _cubics(side: "Side") -> "list[Side]":
    """The cubic curves that replace an arc, each over at most 11.25 degrees; a piece that is not an arc is kept."""
    from symbolic.tables.outlines import ConicArc

    if not isinstance(side, ConicArc):
        return [side]
    from math import tan

    from verification.app.drawings import shown

    angle = side.quarters * pi / 2 + 2 * atan(side.rest)
    count = max(1, floor(angle / (pi / 2) * FINE + 0.999999))
    handle = 4 / 3 * tan(angle / count / 4)
    values = [[float(x) for x in v] for v in (side.centre, side.u, side.v)]
    found: list[Side] = []
    last = side.start
    for k in range(1, count + 1):
        at = [angle * j / count for j in (k - 1, k)]
        places = [[c + u * cos(t) + v * sin(t) for c, u, v in zip(*values, strict=True)] for t in at]
        slopes = [[v * cos(t) - u * sin(t) for _, u, v in zip(*values, strict=True)] for t in at]
        one = [shown(p + handle * d) for p, d in zip(places[0], slopes[0], strict=True)]
        two = [shown(p - handle * d) for p, d in zip(places[1], slopes[1], strict=True)]
        end = side.end if k == count else (shown(places[1][0]), shown(places[1][1]))
        found.append([last, (one[0], one[1]), (two[0], two[1]), end])
        last = end
    return found


def _joined(data: Data, runs: "list[Run]", notes: list[str]) -> "list[Run]":
    """The closed curves formed by joining pieces end to end, whatever the direction in which each was drawn."""
    from symbolic.tables.outlines import ConicArc
    from verification.app.drawings import ends, moved

    points = [point for run in runs for point in _hull(run)]
    near = max(_near(data, points), ROUNDING * max(abs(x) for point in points for x in point))
    cell = near or Fraction(1, 10**30)
    places: dict[tuple[int, int], set[int]] = {}

    def key(p: "Point") -> tuple[int, int]:
        return floor(p[0] / cell), floor(p[1] / cell)

    for i, run in enumerate(runs):
        for point in (ends(run[0])[0], ends(run[-1])[1]):
            places.setdefault(key(point), set()).add(i)
    left, widest, found = dict(enumerate(runs)), Fraction(0), list["Run"]()
    while left:
        curve = left.pop(next(iter(left)))
        while (len(curve) == 1 and not isinstance(curve[0], ConicArc) and len(curve[0]) == 2) or (
            _gap(ends(curve[-1])[1], ends(curve[0])[0]) > near
        ):
            end = ends(curve[-1])[1]
            x, y = key(end)
            cells = [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
            beside = {i for each in cells for i in places.get(each, ()) if i in left}
            following = [i for i in beside if min(_gap(p, end) for p in _both(left[i])) <= near]
            if len(following) != 1:
                svg = data.path.lower().endswith(".svg")
                raise ValueError(
                    f"{'a path is not closed: ' if svg else ''}{_open(end, curve, left, near, len(following))}"
                )
            run = left.pop(following[0])
            first, last = _both(run)
            if _gap(first, end) > near:
                first, last = last, first
                run = [side.turned() if isinstance(side, ConicArc) else side[::-1] for side in reversed(run)]
            widest = max(widest, _gap(first, end))
            curve = [*curve, moved(run[0], end, ends(run[0])[1]), *run[1:]]
        widest = max(widest, _gap(ends(curve[-1])[1], ends(curve[0])[0]))
        if ends(curve[-1])[1] != ends(curve[0])[0]:
            curve = [*curve[:-1], moved(curve[-1], ends(curve[-1])[0], ends(curve[0])[0])]
        found.append(curve)
    if widest > _near(data._replace(tolerance=None), points):
        notes.append(f"closed: gaps of up to {float(widest):.3g}")
    return found


def _open(end: "Point", curve: "Run", left: "dict[int, Run]", near: Fraction, branches: int) -> str:
    """An error message: an outline is open at the point `end`, or branches there."""
    x, y = map(float, end)
    where = f"an outline {'branches' if branches else 'is open'} at ({x:.12g}, {y:.12g})"
    others = [p for run in (*left.values(), curve) for p in _both(run) if p != end]
    gap, other = min(((_gap(p, end), p) for p in others), default=(None, end))
    if branches or gap is None or gap <= near or gap * 100 > max(_extent(others)):
        return f"{where}; accepted: closed outlines"
    a, b = map(float, other)
    wide = f"{1.1 * float(gap):.2g}"
    return (
        f"{where}; accepted: closed outlines, and the nearest other end, ({a:.12g}, {b:.12g}), "
        f"is {float(gap):.3g} away; --tolerance {wide} closes gaps of that width"
    )


def _different(curves: "list[Run]") -> "tuple[list[Run], int]":
    """The curves without duplicates, and the number of duplicates."""
    known: dict[frozenset[Any], Run] = {}
    for curve in curves:
        sides = [_unordered(side) for side in curve]
        known.setdefault(frozenset(sides), curve)
    return list(known.values()), len(curves) - len(known)


def _unordered(side: "Side") -> Any:
    from symbolic.tables.outlines import ConicArc

    if isinstance(side, ConicArc):
        if side.quarters == 4:
            return (
                side.centre,
                frozenset([side.u, (-side.u[0], -side.u[1])]),
                frozenset([side.v, (-side.v[0], -side.v[1])]),
            )
        back = side.turned()
        return side.centre, frozenset([(side.u, side.v), (back.u, back.v)]), side.quarters, side.rest
    return min(tuple(side), tuple(side[::-1]))


def _both(run: "Run") -> "tuple[Point, Point]":
    from verification.app.drawings import ends

    return ends(run[0])[0], ends(run[-1])[1]


def _hull(run: "Run") -> "list[Point]":
    """The end points of a run's pieces and their extreme points in x and y; their extent is that of the run."""
    from symbolic.tables.outlines import ConicArc
    from symbolic.tables.polynomial import elevated
    from verification.app.drawings import ends

    found: list[Point] = []
    for side in run:
        found += ends(side)
        if isinstance(side, ConicArc):
            angle = side.quarters * pi / 2 + 2 * atan(side.rest)
            turns = [atan2(side.v[i], side.u[i]) + half for i in (0, 1) for half in (0, pi)]
            values = [tuple(map(float, v)) for v in (side.centre, side.u, side.v)]
            places = [[c + u * cos(t) + v * sin(t) for c, u, v in zip(*values, strict=True)] for t in turns
                      if t % (2 * pi) < angle]  # fmt: skip
        else:
            p, q, r, s = ([float(x) for x in point] for point in elevated(side))
            times = [t for i in (0, 1) for t in _stops(q[i] - p[i], r[i] - q[i], s[i] - r[i])]
            weights = [((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3) for t in times]
            places = [[sum(w * x[i] for w, x in zip(each, (p, q, r, s), strict=True)) for i in (0, 1)]
                      for each in weights]  # fmt: skip
        found += [(Fraction(x), Fraction(y)) for x, y in places]
    return found


def _stops(a: float, b: float, c: float) -> list[float]:
    """Parameters in (0, 1) at which a cubic is stationary; `a`, `b`, `c` are differences of its control points."""
    square, middle = a - 2 * b + c, a - b
    if abs(square) <= 1e-12 * (abs(a) + abs(b) + abs(c)):
        times = [a / (2 * middle)] if middle else []
    else:
        root = middle * middle - square * a
        times = [(middle + sign * sqrt(root)) / square for sign in (1, -1)] if root >= 0 else []
    return [t for t in times if 0 < t < 1]


def _near(data: Data, points: "list[Point]") -> Fraction:
    """The largest gap between points that is closed: the tolerance given, or a small fraction of their extent."""
    if data.tolerance is None:
        return JOINED * Fraction(max(_extent(points)))
    try:
        wide = Fraction(exact("--tolerance", data.tolerance))
    except (TypeError, ValueError):
        raise ValueError(f"--tolerance = {data.tolerance} is no length such as 0.001") from None
    if wide < 0:
        raise ValueError(f"--tolerance = {data.tolerance} is no length; accepted: numbers from 0")
    return wide


def _gap(p: "Point", q: "Point") -> Fraction:
    return max(abs(p[0] - q[0]), abs(p[1] - q[1]))


def _extent(points: "list[Point]") -> tuple[float, float]:
    xs, ys = zip(*points, strict=True) if points else ((0,), (0,))
    return float(max(xs) - min(xs)), float(max(ys) - min(ys))


def _count(n: int, word: str) -> str:
    return f"{n} {word}" if n == 1 else f"{n} {word}s"


def _text(option: str, path: str, encoding: str = "utf-8-sig") -> str:
    try:
        with Path(path).open("rb") as file:
            content = file.read(LARGEST + 1)  # a device may never end
        if len(content) > LARGEST:
            raise ValueError(f"{option} {path!r} is larger than {LARGEST >> 20} MB; accepted: smaller files")
        return content.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{option} {path!r} cannot be read: {reason(error)}") from None
