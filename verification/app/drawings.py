"""Reads SVG and DXF files: their curves as straight sides, Bezier curves and arcs of conics.

Hidden layers, dimensions and texts are left out. Numbers are exactly the decimals in the file.
"""

import io
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import atan, cos, degrees, floor, pi, radians, sin, tan, tau
from typing import Any, NamedTuple
from xml.etree import ElementTree

from symbolic.tables.outlines import MOST, ConicArc

Point = tuple[Fraction, Fraction]
Side = list[Point] | ConicArc
Run = list[Side]
NEAR = 1e-12  # relative error up to which an angle is a whole number of quarter turns
DEEP = 32  # at most, blocks or uses within one another
MM = {  # millimetres
    "mm": Fraction(1), "cm": Fraction(10), "m": Fraction(1000), "km": Fraction(10**6), "um": Fraction(1, 1000),
    "in": Fraction(254, 10), "ft": Fraction(3048, 10), "px": Fraction(254, 960), "pt": Fraction(254, 720),
    "pc": Fraction(254, 60), "dm": Fraction(100), "yd": Fraction(9144, 10), "mi": Fraction(1609344),
}  # fmt: skip
INSUNITS = {3: "mi", 10: "yd", 14: "dm", 1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 13: "um"}
DRAWN = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE")
ACROSS = ("x", "width", "cx", "rx", "x1", "x2"), ("y", "height", "cy", "ry", "y1", "y2")
LENGTH = re.compile(r"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(mm|cm|in|pt|pc|px|)\s*", re.ASCII)
SVG = "{http://www.w3.org/2000/svg}"
UNDRAWN = {f"{SVG}{name}" for name in ("symbol", "mask", "pattern", "marker", "clipPath")}  # but where they are used
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


class DrawnRun(NamedTuple):
    """A chain of pieces, its layer, and whether it is the background of a page (white or unfilled)."""

    sides: Run
    layer: str
    page: bool = False


class Drawing(NamedTuple):
    """The chains of a file, its unit (None if it names none), and sentences about what is left out."""

    runs: list[DrawnRun]
    unit: str | None
    notes: list[str]


def shown(value: float) -> Fraction:
    """The shortest decimal that rounds to this float: the number in the file, if nothing has transformed it."""
    return Fraction(repr(float(value)))


def arc_between(p: Point, q: Point, v: tuple[float, float] | None, sweep: float) -> ConicArc:
    """The arc from `p` to `q` that turns by `sweep`, of a circle, or of an ellipse with velocity `v` at `p`."""
    quarters = floor(abs(sweep) / (pi / 2) + NEAR)
    rest = shown(tan(max(abs(sweep) - quarters * pi / 2, 0.0) / 2))
    rest = Fraction(0) if rest < NEAR else rest
    unit = ConicArc((Fraction(0), Fraction(0)), (Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)), quarters, rest)
    c, s = unit.end
    d = q[0] - p[0], q[1] - p[1]
    if v is None:
        s = s if sweep > 0 else -s
        a, square = c - 1, (c - 1) ** 2 + s * s
        u = (a * d[0] + s * d[1]) / square, (a * d[1] - s * d[0]) / square
        w = (-u[1], u[0]) if sweep > 0 else (u[1], -u[0])
    else:
        w = shown(v[0]), shown(v[1])
        u = (d[0] - w[0] * s) / (c - 1), (d[1] - w[1] * s) / (c - 1)
    return unit._replace(centre=(p[0] - u[0], p[1] - u[1]), u=u, v=w)


def whole(centre: Any, u: Any, v: Any) -> ConicArc:
    """The full ellipse with this centre and these half axes."""
    points = [(shown(x), shown(y)) for x, y in (centre, u, v)]
    return ConicArc(points[0], points[1], points[2], 4)


def of_svg(path: str, text: str) -> Drawing:
    """The shapes of an SVG file; `y`, which points down in SVG, is reversed so that the table looks as drawn."""
    import svgelements as svg

    try:
        root = ElementTree.fromstring(text.encode())
    except (ElementTree.ParseError, ValueError, RecursionError) as error:
        raise ValueError(f"--data {path!r} is no SVG file: {error}") from None
    count = _shapes(path, root)
    if count > MOST:
        raise ValueError(f"--data {path!r} draws more than {MOST} shapes; accepted: up to {MOST}")
    box = [float(x) for x in re.findall(r"[-+.\deE]+", root.get("viewBox", ""))]
    scale, unit = Fraction(1), "px"
    size = LENGTH.fullmatch(root.get("width", ""))
    if size is not None:
        unit = size[2] or "px"
        scale = _page_scale(path, root, box) or MM["px"] / MM[unit]
    page = box[2:] if len(box) == 4 else [_pixels(root.get(name)) for name in ("width", "height")]
    for name in ("width", "height", "viewBox"):
        root.attrib.pop(name, None)
    _label(root, "", page)
    source = io.StringIO(ElementTree.tostring(root, encoding="unicode"))
    try:
        read = svg.SVG.parse(source, width=page[0] or 1000, height=page[1] or 1000)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"--data {path!r} is no SVG file: {error}") from None
    runs = []
    for element in read.elements():
        hidden = element.values.get("visibility") in ("hidden", "collapse") if isinstance(element, svg.Shape) else True
        if hidden or re.fullmatch(r"0*\.?0*%?", str(element.values.get("opacity", 1))):
            continue
        layer = str(element.values.get("data-layer", ""))
        fill = str(element.values.get("fill", "")).replace(" ", "").lower()
        plain = fill in ("white", "#fff", "#ffffff", "none", "rgb(255,255,255)")
        for sides in _of_shape(svg, path, element):
            corners = [p for side in sides for p in ends(side)]
            spans = [max(p[i] for p in corners) - min(p[i] for p in corners) for i in (0, 1)]
            covers = all(p and span >= shown(p) * Fraction(999, 1000) for p, span in zip(page, spans, strict=True))
            straight = len(sides) == 4 and not any(isinstance(side, ConicArc) for side in sides)
            runs.append(DrawnRun([scaled(side, scale) for side in sides], layer, plain and covers and straight))
    return Drawing(runs, unit, [])


def _page_scale(path: str, root: ElementTree.Element, box: list[float]) -> Fraction | None:
    """Page units per unit of the view box: the smaller of the factors in x and y, or the larger one for `slice`."""
    sizes = [LENGTH.fullmatch(root.get(name, "")) for name in ("width", "height")]
    if len(box) != 4 or not (box[2] and box[3]):
        return None
    unit = MM[sizes[0][2] or "px"] if sizes[0] else Fraction(1)
    scales = [
        Fraction(size[1]) * MM[size[2] or "px"] / unit / shown(wide)
        for size, wide in zip(sizes, box[2:], strict=True)
        if size
    ]
    kept = root.get("preserveAspectRatio", "")
    if "none" in kept and max(scales) - min(scales) > max(scales) / 1000:
        raise ValueError(f"--data {path!r} scales width and height differently; accepted: one scale for both")
    return max(scales) if "slice" in kept else min(scales)


def _pixels(given: str | None) -> float:
    found = LENGTH.fullmatch(given or "")
    return float(Fraction(found[1]) * MM[found[2] or "px"] / MM["px"]) if found else 0.0


def _shapes(path: str, root: ElementTree.Element) -> int:
    """The number of elements that are drawn, each `use` counted as the elements it refers to."""
    named = {e.get("id"): e for e in root.iter() if e.get("id")}
    known: dict[int, int] = {}

    def count(element: ElementTree.Element, depth: int) -> int:
        if depth > 8 * DEEP:
            raise ValueError(f"--data {path!r} has groups or uses within one another more than {8 * DEEP} deep")
        if id(element) not in known:
            target = next((v for k, v in element.attrib.items() if k.rpartition("}")[2] == "href"), "")
            used = named.get(target[1:]) if element.tag == f"{SVG}use" else None
            total = 1 + sum(count(child, depth + 1) for child in element)
            known[id(element)] = total + (count(used, depth + 1) if used is not None else 0)
        return known[id(element)]

    return count(root, 0)


def _label(element: ElementTree.Element, layer: str, page: list[float]) -> None:
    """Writes into every shape the name of its group, and replaces percentages by lengths on the page."""
    if element.tag in UNDRAWN:
        inner = ElementTree.Element(element.tag, element.attrib)
        inner.extend(list(element))
        element[:], element.tag, element.attrib = [inner], f"{SVG}defs", {}
        return
    if element.tag == f"{SVG}g":
        layer = element.get(LABEL) or element.get("id") or layer
    element.set("data-layer", layer)
    for names, size in zip(ACROSS, page, strict=True):
        for name in names:
            if re.fullmatch(r"[\d.]+%", given := element.get(name, "")):
                element.set(name, str(float(Fraction(given[:-1]) * shown(size) / 100)))
    for child in element:
        _label(child, layer, page)


def _of_shape(svg: Any, path: str, element: Any) -> Iterator[Run]:
    """The curves of a shape, after its transformations have been applied."""
    drawn = svg.Path(element).reify()  # which carries out rotations and skews
    if isinstance(element, svg.Circle | svg.Ellipse):
        arcs = [segment for segment in drawn if isinstance(segment, svg.Arc)]
        if arcs:
            centre, prx, pry = arcs[0].center, arcs[0].prx, arcs[0].pry
            u, v = ((p.x - centre.x, centre.y - p.y) for p in (prx, pry))
            yield [whole((centre.x, -centre.y), u, v)]
        return
    for part in drawn.as_subpaths():
        sides = [side for segment in part if not isinstance(segment, svg.Move) for side in _of_segment(svg, segment)]
        if sides := list(_chained(sides)):
            yield sides


def _of_segment(svg: Any, segment: Any) -> Iterator[Side]:
    p, q = ((shown(z.x), -shown(z.y)) for z in (segment.start, segment.end))
    if isinstance(segment, svg.Arc):
        centre, a, b = segment.center, segment.prx, segment.pry
        (ux, uy), (vx, vy) = ((z.x - centre.x, centre.y - z.y) for z in (a, b))
        if not (segment.rx and segment.ry):  # which SVG draws as a straight side
            yield [p, q]
            return
        square, x, y = ux * ux + uy * uy, float(p[0]) - centre.x, float(p[1]) + centre.y
        c, s = (ux * x + uy * y) / square, (vx * x + vy * y) / (vx * vx + vy * vy)
        sign = -1 if segment.sweep > 0 else 1  # y is turned round
        cross = ux * vy - uy * vx
        turn = sign if cross > 0 else -sign
        same = abs(square - (vx * vx + vy * vy)) <= 1e-12 * square
        v = None if same else (turn * (c * vx - s * ux), turn * (c * vy - s * uy))
        yield arc_between(p, q, v, sign * abs(segment.sweep) if same else abs(segment.sweep))
        return
    controls = [getattr(segment, name, None) for name in ("control", "control1", "control2")]
    yield straightened([p, *((shown(z.x), -shown(z.y)) for z in controls if z is not None), q])


def straightened(points: list[Point]) -> list[Point]:
    """The control points of a Bezier curve, or only its ends where all lie on the line segment between them."""
    p, q = points[0], points[-1]
    d = q[0] - p[0], q[1] - p[1]
    size = d[0] ** 2 + d[1] ** 2
    inner = [(x - p[0], y - p[1]) for x, y in points[1:-1]]
    if all(d[0] * y == d[1] * x and 0 <= d[0] * x + d[1] * y <= size for x, y in inner):
        return [p, q]
    for end, handle in ((p, points[1]), (q, points[-2])):
        if end == handle:
            x, y = map(float, end)
            raise ValueError(
                f"a Bezier curve has no direction at its end ({x:.12g}, {y:.12g}), which is also a control point; "
                "accepted: control points away from the ends"
            )
    return points


def ends(side: Side) -> tuple[Point, Point]:
    """The first and the last point of a piece."""
    return (side.start, side.end) if isinstance(side, ConicArc) else (side[0], side[-1])


def moved(side: Side, p: Point, q: Point) -> Side:
    """The piece, changed so that it runs from `p` to `q`, which are close to its ends."""
    start, end = ends(side)
    if (start, end) == (p, q):
        return side
    if not isinstance(side, ConicArc):
        if len(side) == 2:
            return [p, q]
        first, *_, last = side
        inner = [(x + p[0] - first[0], y + p[1] - first[1]) for x, y in side[1:2]]
        inner += [(x + q[0] - last[0], y + q[1] - last[1]) for x, y in side[2:-1]]
        return [p, *inner, q]
    unit = side._replace(centre=(Fraction(0), Fraction(0)), u=(Fraction(1), Fraction(0)), v=(Fraction(0), Fraction(1)))
    c, s = unit.end
    d = q[0] - p[0], q[1] - p[1]
    (ux, uy), v = side.u, side.v
    if v in ((-uy, ux), (uy, -ux)):
        sign = 1 if v == (-uy, ux) else -1
        a, b, square = c - 1, sign * s, (c - 1) ** 2 + s * s
        u = (a * d[0] + b * d[1]) / square, (a * d[1] - b * d[0]) / square
        v = (-u[1] * sign, u[0] * sign)
    else:
        u = (d[0] - v[0] * s) / (c - 1), (d[1] - v[1] * s) / (c - 1)
    return side._replace(centre=(p[0] - u[0], p[1] - u[1]), u=u, v=v)


def _chained(sides: Iterable[Side]) -> Iterator[Side]:
    """The pieces, without those of zero length; small gaps between one and the next are closed."""
    last = None
    for side in sides:
        p, q = ends(side)
        if last is not None and max(abs(x - y) for x, y in zip(last, p, strict=True)) <= NEAR * max(
            1.0, *(abs(float(x)) for x in p)
        ):
            side = moved(side, last, q)
        if isinstance(side, ConicArc) or any(point != side[0] for point in side):
            yield side
            last = q


def scaled(side: Side, scale: Fraction) -> Side:
    """The piece with lengths multiplied by `scale`; decimals keep 17 digits."""
    if scale == 1:
        return side

    def point(p: Point) -> Point:
        return shown(float(p[0] * scale)), shown(float(p[1] * scale))

    if isinstance(side, ConicArc):
        c, u, v = ((x * scale, y * scale) for x, y in (side.centre, side.u, side.v))
        larger = side._replace(centre=c, u=u, v=v)
        return larger if side.quarters == 4 else moved(larger, point(larger.start), point(larger.end))
    return [point(p) for p in side]


def of_dxf(path: str) -> Drawing:
    """The curves in the model space of a DXF file and its blocks, without hidden layers, dimensions and texts."""
    import ezdxf  # noqa: F401 (a missing package is named in the message)
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    try:
        document = readfile(path)
    except (OSError, DXFError, UnicodeDecodeError, ValueError) as error:
        raise ValueError(f"--data {path!r} is no DXF file: {error}") from None
    hidden = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
    hidden.add("defpoints")  # is never printed
    left: dict[str, int] = {}
    runs: list[DrawnRun] = []

    def visit(entities: Iterable[Any], layer: str, depth: int) -> None:
        for entity in entities:
            own = layer if entity.dxf.layer == "0" and layer else entity.dxf.layer
            if own.lower() in hidden or entity.dxf.get("invisible", 0):
                left[f"layer {own}, which is hidden"] = left.get(f"layer {own}, which is hidden", 0) + 1
            elif entity.dxftype() == "INSERT":
                if depth == DEEP:
                    raise ValueError(f"--data {path!r} has blocks within one another more than {DEEP} deep")
                for each in entity.multi_insert() if entity.mcount > 1 else (entity,):
                    visit(each.virtual_entities(), own, depth + 1)
            elif entity.dxftype() not in DRAWN:
                left[entity.dxftype().lower()] = left.get(entity.dxftype().lower(), 0) + 1
            else:
                runs.extend(DrawnRun(run, own) for run in _of_entity(entity) if run)
                if sum(len(run.sides) for run in runs) > MOST:
                    raise ValueError(f"--data {path!r} draws more than {MOST} pieces; accepted: up to {MOST}")

    visit(document.modelspace(), "", 0)
    notes = [f"left out: {', '.join(f'{n} on {w}' if 'layer' in w else f'{n} {w}' for w, n in left.items())}"]
    return Drawing(runs, INSUNITS.get(document.header.get("$INSUNITS", 0)), notes if left else [])


def _of_entity(entity: Any) -> Iterator[Run]:
    kind = entity.dxftype()
    if kind == "LINE":
        points = [(shown(p.x), shown(p.y)) for p in (entity.dxf.start, entity.dxf.end)]
        if points[0] != points[1]:
            yield [points]
    elif kind in ("CIRCLE", "ARC", "ELLIPSE"):
        yield [_of_round(entity, kind)]
    elif kind == "LWPOLYLINE" or (kind == "POLYLINE" and (entity.is_2d_polyline or entity.is_3d_polyline)):
        yield list(_of_polyline(entity, kind))
    elif kind == "SPLINE":
        from ezdxf.path import make_path

        for part in make_path(entity, level=8).sub_paths():
            start, run = part.start, list[Side]()
            for command in part.commands():
                inner = [getattr(command, name, None) for name in ("ctrl", "ctrl1", "ctrl2")]
                run.append([(shown(p.x), shown(p.y)) for p in (start, *inner, command.end) if p is not None])
                start = command.end
            yield list(_chained(map(straightened, run)))  # type: ignore[arg-type]


def _of_round(entity: Any, kind: str) -> ConicArc:
    """The circle, ellipse or arc of either that a DXF entity describes, as seen along the z axis."""
    dxf = entity.dxf
    if kind == "ELLIPSE":
        c, u, v = dxf.center, dxf.major_axis, entity.minor_axis
        low, sweep = dxf.start_param, (dxf.end_param - dxf.start_param) % tau or tau
    else:
        ocs = entity.ocs()
        c, u, v = (ocs.to_wcs(p) for p in (dxf.center, (dxf.radius, 0, 0), (0, dxf.radius, 0)))
        low, sweep = 0.0, tau
        if kind == "ARC":
            low, sweep = radians(dxf.start_angle), radians((dxf.end_angle - dxf.start_angle) % 360 or 360)
    if tau - sweep < NEAR:
        return whole((c.x, c.y), (u.x, u.y), (v.x, v.y))
    p, q = ((shown(c.x + x * u.x + y * v.x), shown(c.y + x * u.y + y * v.y)) for x, y in map(_unit, (low, low + sweep)))
    x, y = _unit(low)
    if u.x * u.x + u.y * u.y == v.x * v.x + v.y * v.y and u.x * v.x + u.y * v.y == 0:
        return arc_between(p, q, None, sweep if u.x * v.y > u.y * v.x else -sweep)
    return arc_between(p, q, (x * v.x - y * u.x, x * v.y - y * u.y), sweep)


def _unit(angle: float) -> tuple[float, float]:
    """Cosine and sine, exact near multiples of a quarter turn."""
    right = round(degrees(angle) / 90)
    if abs(angle - right * pi / 2) < NEAR:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[right % 4]
    return cos(angle), sin(angle)


def _of_polyline(entity: Any, kind: str) -> Iterator[Side]:
    if kind == "LWPOLYLINE":
        rows = [(x, y, b) for x, y, b in entity.get_points("xyb")]
        closed = entity.closed
    else:
        rows = [(v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices]
        closed = entity.is_closed
    mirrored = False
    if kind == "LWPOLYLINE" or entity.is_2d_polyline:
        ocs = entity.ocs()
        placed = [ocs.to_wcs((x, y, 0)) for x, y, _ in rows]
        mirrored = entity.dxf.extrusion.z < 0
        rows = [(p.x, p.y, b) for p, (_, _, b) in zip(placed, rows, strict=True)]
    points = [(shown(x), shown(y)) for x, y, _ in rows]
    for i, (_, _, bulge) in enumerate(rows if closed else rows[:-1]):
        p, q = points[i], points[(i + 1) % len(points)]
        if p != q:
            yield arc_between(p, q, None, 4 * atan(-bulge if mirrored else bulge)) if bulge else [p, q]
