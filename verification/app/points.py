"""Points of text files: rows of two numbers, polygons of GIS programs (GeoJSON, WKT), corners on a command line."""

import csv
import json
import re
from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import PLAIN, exact

if TYPE_CHECKING:
    from symbolic.tables.table import Table
    from verification.app.drawings import Point

COMMA = re.compile(r"[+-]?\d+,\d+")
RING = re.compile(r"\(([^()]*)\)")


def rings(text: str) -> "tuple[list[list[Point]], bool]":
    """The rings of points in a text, and True if they come from a GIS polygon (GeoJSON or WKT).

    >>> rings("0 0\\n4 0\\n0 3")
    ([[(Fraction(0, 1), Fraction(0, 1)), (Fraction(4, 1), Fraction(0, 1)), (Fraction(0, 1), Fraction(3, 1))]], False)
    """
    head = text.lstrip()[:60].upper()
    if not head:
        raise ValueError("holds no points; accepted: a file with x and y on each line")
    if head.startswith("{"):
        return _of_geojson(text), True
    if re.match(r"(SRID=\d+;)?\s*(MULTI)?(POLYGON|LINESTRING|POINT)|GEOMETRY", head):
        return _of_wkt(text), True
    return [_of_rows(text)], False


def _of_rows(text: str) -> "list[Point]":
    """Points from lines of two numbers, separated by a comma, semicolon, tab or blanks; a heading is skipped."""
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise ValueError("holds no points; accepted: a file with x and y on each line")
    mark = next((mark for mark in ";\t," if mark in lines[-1]), None)
    rows = [line.split() for line in lines] if mark is None else list(csv.reader(lines, delimiter=mark))
    points: list[Point] = []
    for i, row in enumerate(rows, 1):
        cells = [cell.strip() for cell in row]
        numbers = [cell for cell in cells if PLAIN.fullmatch(cell)]
        if i == 1 < len(rows) and not numbers and not any(map(COMMA.fullmatch, cells)):
            continue
        if len(cells) != 2 or len(numbers) != 2:
            shown = (mark or " ").join(row)[:80]
            commas = "decimal points, as in 1.5, and no decimal commas" if any(map(COMMA.fullmatch, cells)) else ""
            raise ValueError(f"line {i} of data is {shown!r}; accepted: {commas or 'two numbers, x and y'}")
        points.append((Fraction(cells[0]), Fraction(cells[1])))
    return points


def _of_geojson(text: str) -> "list[list[Point]]":
    """The rings of the one polygon of a GeoJSON document."""
    try:
        found = json.loads(text, parse_float=str, parse_int=str)
        polygons = list(_polygons(found))
    except (json.JSONDecodeError, RecursionError, TypeError, AttributeError, KeyError) as error:
        raise ValueError(f"is no GeoJSON document: {str(error)[:80]}") from None
    if len(polygons) != 1:
        raise ValueError(f"holds {len(polygons)} polygons; accepted: a GeoJSON document with one")
    return [_ring(ring) for ring in polygons[0]]


def _polygons(node: dict[str, Any]) -> Iterable[Any]:
    """The coordinates of every polygon in a GeoJSON object."""
    kind = node.get("type")
    if kind == "Polygon":
        yield node["coordinates"]
    elif kind == "MultiPolygon":
        yield from node["coordinates"]
    elif kind in ("Feature", "FeatureCollection", "GeometryCollection"):
        parts = [node["geometry"]] if kind == "Feature" else node["features" if "features" in node else "geometries"]
        for part in parts:
            yield from _polygons(part) if part else ()


def _of_wkt(text: str) -> "list[list[Point]]":
    """The rings of a WKT `POLYGON ((x y, ...), ...)`, or of a `MULTIPOLYGON` that holds one."""
    found = re.fullmatch(r"\s*(?:SRID=\d+;)?\s*(MULTI)?POLYGON\s*(?:Z|M|ZM)?\s*\((.*)\)\s*;?\s*", text, re.I | re.S)
    inner = found[2].strip() if found else ""
    if found and found[1]:
        inner = inner[1:-1] if len(re.split(r"\)\s*\)\s*,", inner)) == 1 else ""
    rings = RING.findall(inner)
    if not rings or RING.sub("", inner).strip(" ,\r\n\t"):
        raise ValueError(f"{text.strip()[:60]!r} is no WKT of one polygon; accepted: POLYGON ((0 0, 4 0, 4 2, 0 0))")
    return [_ring([point.split() for point in ring.split(",")]) for ring in rings]


def _ring(rows: Any) -> "list[Point]":
    """The points of a ring, without third coordinates."""
    points = []
    for i, row in enumerate(rows, 1):
        if not isinstance(row, list) or len(row) < 2 or not all(PLAIN.fullmatch(str(c)) for c in row[:2]):
            raise ValueError(f"point {i} of a ring is {str(row)[:60]!r}; accepted: two numbers, x and y")
        points.append((Fraction(row[0]), Fraction(row[1])))
    return points


def polygon_of(text: str) -> "Table":
    """The polygon with corners `X,Y X,Y ...` (exact numbers), clockwise or not; the first may be repeated at the end.

    >>> [side.at(0) for side in polygon_of("0,0 0,1/2 2,0").components]
    [(2, 0), (0, 1/2), (0, 0)]
    """
    from sympy import S

    from symbolic import tables

    corners: list[tuple[Any, Any]] = []
    for part in text.split():
        pair = part.split(",")
        if len(pair) != 2:
            raise ValueError(f"--polygon: {part[:60]!r} is no corner; accepted: X,Y X,Y X,Y such as '0,0 1,0 1,1 0,1'")
        x, y = (S(exact("--polygon", number)) for number in pair)
        if not corners or corners[-1] != (x, y):
            corners.append((x, y))
    corners = corners[:-1] if len(corners) > 1 and corners[0] == corners[-1] else corners
    area = sum((p[0] * q[1] - p[1] * q[0] for p, q in pairwise([*corners, *corners[:1]])), S.Zero)
    try:
        return tables.polygon(*(reversed(corners) if area.is_negative else corners))
    except ValueError as error:
        raise ValueError(f"--{error}") from None
