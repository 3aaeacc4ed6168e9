"""Convex polygons that a piecewise affine map of the plane throws into themselves, and cones that it widens.

The map has two affine pieces, one for `v <= 0` and one for `v >= 0` (components `ARC` and `WALL`), with
balls for entries: what is proved holds for every map that lies in those balls, point by point.
Polygons are found in floats, and a proof takes their corners as exact numbers.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb

from verification.arithmetic.balls import between

Row = tuple[arb, arb]
Point = tuple[float, float]
Polygon = list[Point]  # convex, anticlockwise


@dataclass(frozen=True)
class Piece:
    """`x -> rows*(x - base) + shift`."""

    rows: tuple[Row, Row]
    shift: Row
    base: Row = (arb(0), arb(0))

    @property
    def trace(self) -> arb:
        """Of the matrix."""
        return self.rows[0][0] + self.rows[1][1]

    @property
    def determinant(self) -> arb:
        """Of the matrix."""
        return self.rows[0][0] * self.rows[1][1] - self.rows[0][1] * self.rows[1][0]

    def of(self, x: Row) -> Row:
        """The image of a point."""
        u, v = x[0] - self.base[0], x[1] - self.base[1]
        (a, b), (c, d) = self.rows
        return a * u + b * v + self.shift[0], c * u + d * v + self.shift[1]


Pieces = Mapping[int, Piece]
SIGNS = {0: -1, 1: 1}  # of v on the arc and on the wall


def hull(points: list[Point]) -> Polygon:
    """The convex hull.

    >>> hull([(0, 0), (2, 0), (1, 1), (1, 0.5), (0, 2)])
    [(0, 0), (2, 0), (0, 2)]
    """

    def chain(ordered: list[Point]) -> Polygon:
        found: Polygon = []
        for p in ordered:
            while len(found) > 1 and _left(found[-2], found[-1], p) <= 0:
                found.pop()
            found.append(p)
        return found[:-1]

    ordered = sorted(set(points))
    return chain(ordered) + chain(ordered[::-1])


def _left(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def sides(polygon: Polygon) -> list[tuple[Point, Point]]:
    """Pairs of neighbouring corners."""
    return list(pairwise([*polygon, polygon[0]]))


def clipped(polygon: Polygon, low: float, high: float) -> Polygon:
    """The corners of the part with `low <= v <= high`, rounded outwards by a hair.

    >>> clipped([(0, -1), (2, 0), (0, 1)], 0, 2)[0]
    (2, 0)
    """
    found = [p for p in polygon if low <= p[1] <= high]
    for level in (low, high):
        for p, q in sides(polygon):
            if min(p[1], q[1]) < level < max(p[1], q[1]):
                u = p[0] + (level - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
                found += [(u - HAIR, level), (u + HAIR, level)]
    return found


HAIR = 1e-9  # far above the rounding of the crossing, far below what the polygons have to spare


def grown(pieces: Pieces, start: Point, room: float, limit: float = 50.0) -> Polygon | None:
    """A polygon around `start` whose image keeps `room` from its sides, in floats; None when it grows too large.

    The hull of what the map reaches from `start` when it may err by `room`, and by its balls, at every step.
    """
    around = [(room * math.cos(k * math.pi / 4), room * math.sin(k * math.pi / 4)) for k in range(8)]
    polygon = hull([(start[0] + a, start[1] + b) for a, b in around])
    for _ in range(200):
        images = [image for c in pieces for p in part(polygon, c) for image in _vertices(pieces[c], p)]
        larger = hull(polygon + [(u + a, v + b) for u, v in images for a, b in around])
        if max(abs(x) for p in larger for x in p) > limit:
            return None
        if len(larger) == len(polygon) and all(math.dist(p, q) < 1e-9 for p, q in zip(larger, polygon, strict=True)):
            return larger
        polygon = larger
    return None


def exactly_convex(polygon: Polygon) -> Polygon:
    """The hull of the corners in exact arithmetic: floats may have taken a flat corner for a convex one."""
    exact = hull([(Fraction(u), Fraction(v)) for u, v in polygon])  # type: ignore[misc]  # as good as floats here
    return [(float(u), float(v)) for u, v in exact]


def part(polygon: Polygon, component: int) -> Polygon:
    """Points whose hull holds the part of the polygon on one side of the border."""
    return clipped(polygon, 0.0, math.inf) if SIGNS[component] > 0 else clipped(polygon, -math.inf, 0.0)


def _vertices(piece: Piece, point: Point) -> list[Point]:
    u, v = piece.of((arb(point[0]), arb(point[1])))
    return [(float(a), float(b)) for a in (u.lower(), u.upper()) for b in (v.lower(), v.upper())]


def trapped(pieces: Pieces, polygon: Polygon) -> bool | None:
    """True when the image of the polygon is proved to lie in its interior; None when nothing is proved.

    Either part of the polygon is the hull of its corners, its image under an affine map the hull of theirs.
    """
    polygon = exactly_convex(polygon)
    for component, piece in pieces.items():
        for corner in part(polygon, component):
            u, v = piece.of((arb(corner[0]), arb(corner[1])))
            for (a, b), (c, d) in sides(polygon):
                if not (arb(c) - a) * (v - b) - (arb(d) - b) * (u - a) > 0:
                    return None
    return True


@dataclass(frozen=True)
class Expansion:
    """A cone of directions `u/v` that both pieces map into itself, and how much they stretch `v` there."""

    ratio: arb
    least: arb
    most: arb


def expansion(pieces: Pieces) -> Expansion | None:
    """The cone that the pieces leave invariant, proved; None when none is found."""
    low, high = -math.inf, math.inf
    ratios = [float((p.rows[0][1] / p.rows[1][1]).mid()) for p in pieces.values()]
    low, high = min(ratios), max(ratios)
    for _ in range(50):
        images = [turned(p, between(low, high)) for p in pieces.values()]
        if not all(image.is_finite() for image in images):
            return None
        lows, highs = [float(i.lower()) for i in images], [float(i.upper()) for i in images]
        if low < min(lows) and max(highs) < high:
            stretches = [abs(p.rows[1][0] * between(low, high) + p.rows[1][1]) for p in pieces.values()]
            whole = stretches[0].union(stretches[1])
            return Expansion(between(low, high), arb(whole.lower()), arb(whole.upper()))
        low, high = min(low, *lows) - 1e-3, max(high, *highs) + 1e-3
    return None


def turned(piece: Piece, ratio: arb) -> arb:
    """The direction `u/v` of the image of a vector."""
    (a, b), (c, d) = piece.rows
    return (a * ratio + b) / (c * ratio + d)
