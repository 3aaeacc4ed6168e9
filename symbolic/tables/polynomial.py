"""Closed chains of pieces that are polynomials of degree three: their area and their crossings, exactly.

A piece is a cubic curve of Bezier with rational control points, which lies in their convex hull, and so does its
velocity in that of their differences. So a curve is proved simple: it is cut until each piece turns by less than a
quarter of a turn, neighbours together run forwards in one direction, and the boxes of all others are disjoint.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import isqrt

from sympy import Expr, Poly, S

from symbolic.tables.table import Component, theta

Vector = tuple[Fraction, Fraction]
Bezier = tuple[Vector, Vector, Vector, Vector]
DEEPEST = 60  # halvings
MOST = 400_000  # pairs of pieces that are looked at


def as_component(name: str, piece: Bezier) -> Component:
    """The piece as a polynomial in `theta` on [0, 1]."""
    point = []
    for axis in (0, 1):
        a, b, c, d = (p[axis] for p in piece)
        coefficients = a, 3 * (b - a), 3 * (a - 2 * b + c), d - a + 3 * (b - c)
        terms = [S(k) * theta**i for i, k in enumerate(coefficients)]
        point.append(sum(terms, S.Zero))
    return Component(name, (point[0], point[1]), S.Zero, S.One)


def cubic(component: Component) -> list[list[Expr]] | None:
    """The four coefficients of `x` and those of `y`, constant first, when both are polynomials of degree three at most.

    >>> from symbolic.tables import square
    >>> cubic(square(3).components[0])
    [[0, 3, 0, 0], [0, 0, 0, 0]]
    """
    if not all(coordinate.is_polynomial(theta) for coordinate in component.point):
        return None
    found = [Poly(coordinate, theta).all_coeffs()[::-1] for coordinate in component.point]
    return [[*row, *[S.Zero] * (4 - len(row))] for row in found] if max(map(len, found)) <= 4 else None


def as_bezier(component: Component) -> Bezier | None:
    """The control points of a component, if it is a polynomial of degree three at most with rational numbers.

    >>> from symbolic.tables import square
    >>> as_bezier(square(3).components[0])[-1]
    (Fraction(3, 1), Fraction(0, 1))
    """
    low, high = component.start, component.end
    if not (low.is_Rational and high.is_Rational):
        return None
    found = []
    for coordinate in component.point:
        if not coordinate.is_polynomial(theta) or coordinate.free_symbols - {theta}:
            return None
        inside = coordinate if (low, high) == (0, 1) else coordinate.subs(theta, low + (high - low) * theta)
        values = [_fraction(c) for c in reversed(Poly(inside, theta).all_coeffs())]
        if len(values) > 4 or None in values:
            return None
        a, b, c, d = [value for value in values if value is not None] + [Fraction(0)] * (4 - len(values))
        found.append((a, a + b / 3, a + (2 * b + c) / 3, a + b + c + d))
    one, two, three, four = zip(*found, strict=True)
    return one, two, three, four


def elevated(points: Sequence[Vector]) -> Bezier:
    """The same curve as one of degree three, from the control points of one of degree 1, 2 or 3."""
    third = Fraction(1, 3)
    if not 2 <= len(points) <= 4:
        raise ValueError(f"a piece has {len(points)} control points; accepted: 2, 3 or 4")
    p, q = points[0], points[-1]
    if len(points) == 4:
        return p, points[1], points[2], q
    inner = [(r[0] + 2 * third * (c[0] - r[0]), r[1] + 2 * third * (c[1] - r[1])) for c in points[1:-1] for r in (p, q)]
    one, two = inner or [(r[0] + third * (s[0] - r[0]), r[1] + third * (s[1] - r[1])) for r, s in ((p, q), (q, p))]
    return p, one, two, q


def _fraction(value: Expr) -> Fraction | None:
    return Fraction(int(value.p), int(value.q)) if value.is_Rational else None


def signed_area(pieces: Sequence[Bezier]) -> Fraction:
    """The area by Green's formula, negative for a clockwise curve."""
    total = Fraction(0)
    weights = {(0, 1): 6, (0, 2): 3, (0, 3): 1, (1, 2): 3, (1, 3): 3, (2, 3): 6}
    for piece in pieces:
        for (i, j), weight in weights.items():
            total += weight * (piece[i][0] * piece[j][1] - piece[i][1] * piece[j][0])
    return total / 20


def checked(name: str, *curves: Sequence[Bezier]) -> None:
    """Refuses closed curves, each the end of a piece the start of the next, that do not bound a table.

    The outer curve comes first and runs counterclockwise; holes run clockwise inside it.
    """
    for k, pieces in enumerate(curves):
        area = signed_area(pieces)
        if k == 0 and area <= 0:
            how = "runs clockwise; turn it round" if area else "encloses area 0"
            raise ValueError(f"{name}: the boundary {how}")
        if k and area >= 0:
            raise ValueError(f"{name}: hole {k} must run clockwise")
    found = meets(curves)
    if found is not None:
        raise ValueError(f"{name}: the boundary crosses itself, or stops, near ({found[0]:.6g}, {found[1]:.6g})")
    outer = curves[0]
    for k, hole in enumerate(curves[1:], 1):
        around = [other for other in curves[1:] if other is not hole and _surrounds(other, hole[0][0])]
        if around or not _surrounds(outer, hole[0][0]):
            raise ValueError(f"{name}: hole {k} does not lie in the table")


Span = tuple[int, int, Fraction, Fraction, Bezier]  # curve, piece, where on it, control points


def meets(curves: Sequence[Sequence[Bezier]]) -> tuple[float, float] | None:
    """A point near which the curves meet themselves, one another or stop; None when it is proved that they do not."""
    rings: list[list[Bezier]] = []
    for pieces in curves:
        ring = [part for piece in pieces for part in _monotone(piece, 0)]
        for _ in range(DEEPEST):
            bad = [i for i in range(len(ring)) if not _forwards(ring[i - 1], ring[i])]
            if not bad:
                break
            cut = {i % len(ring) for i in bad} | {(i - 1) % len(ring) for i in bad}
            ring = [half for i, part in enumerate(ring) for half in (_halves(part) if i in cut else (part,))]
        else:
            return _shown(ring[bad[0]])
        rings.append(ring)
    boxed = [(*_box(part), k, i, part) for k, ring in enumerate(rings) for i, part in enumerate(ring)]
    boxed.sort(key=lambda row: row[0])
    looked = 0
    for at, (_, right, low, high, k, i, part) in enumerate(boxed):
        for left, _, bottom, top, other, j, piece in boxed[at + 1 :]:
            if left > right:
                break
            looked += 1
            if looked > MOST:
                return _shown(part)
            if bottom > high or top < low:
                continue
            n = len(rings[k])
            if k == other and (i - j) % n in (1, n - 1):
                continue
            if _touch(part, piece, 0):
                return _shown(part)
    return None


def _monotone(piece: Bezier, depth: int) -> list[Bezier]:
    """The piece in parts on which the velocity turns by less than a quarter of a turn; a part that stops is one too."""
    d = _differences(piece)
    if depth >= DEEPEST // 4 or all(_dot(v, w) > 0 for i, v in enumerate(d) for w in d[i:]):
        return [piece]
    first, last = _halves(piece)
    return _monotone(first, depth + 1) + _monotone(last, depth + 1)


def _forwards(before: Bezier, after: Bezier) -> bool:
    """Do two neighbours run forwards in one direction, so that together they do not meet themselves?"""
    v, w = (_along(piece) for piece in (before, after))
    direction = v[0] + w[0], v[1] + w[1]
    return all(_dot(d, direction) > 0 for piece in (before, after) for d in _differences(piece))


def _along(piece: Bezier) -> Vector:
    """The chord, about of length one: any vector will do, and this one is best."""
    x, y = piece[3][0] - piece[0][0], piece[3][1] - piece[0][1]
    size = max(abs(x), abs(y))
    if not size:
        return Fraction(0), Fraction(0)
    x, y = round(x / size, 3), round(y / size, 3)
    length = isqrt(int((x * x + y * y) * 10**6))
    return x / length, y / length


def _touch(p: Bezier, q: Bezier, depth: int) -> bool:
    """Is it not proved that two pieces are disjoint?"""
    left, right, low, high = _box(p)
    a, b, c, d = _box(q)
    if left > b or a > right or low > d or c > high or _apart(p, q) or _apart(q, p):
        return False
    if depth >= DEEPEST:
        return True
    return any(_touch(x, y, depth + 1) for x in _halves(p) for y in _halves(q))


def _apart(p: Bezier, q: Bezier) -> bool:
    """Does a line along the chord of `p` separate the two?"""
    x, y = p[3][0] - p[0][0], p[3][1] - p[0][1]
    own = [x * (c[1] - p[0][1]) - y * (c[0] - p[0][0]) for c in p]
    other = [x * (c[1] - p[0][1]) - y * (c[0] - p[0][0]) for c in q]
    return max(own) < min(other) or max(other) < min(own)


def _differences(piece: Bezier) -> list[Vector]:
    return [(q[0] - p[0], q[1] - p[1]) for p, q in pairwise(piece)]


def _dot(v: Vector, w: Vector) -> Fraction:
    return v[0] * w[0] + v[1] * w[1]


def _halves(piece: Bezier) -> tuple[Bezier, Bezier]:
    a, b, c, d = piece
    ab, bc, cd = _middle(a, b), _middle(b, c), _middle(c, d)
    abc, bcd = _middle(ab, bc), _middle(bc, cd)
    centre = _middle(abc, bcd)
    return (a, ab, abc, centre), (centre, bcd, cd, d)


def _middle(p: Vector, q: Vector) -> Vector:
    return (p[0] + q[0]) / 2, (p[1] + q[1]) / 2


def _box(piece: Bezier) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    xs, ys = [p[0] for p in piece], [p[1] for p in piece]
    return min(xs), max(xs), min(ys), max(ys)


def _surrounds(pieces: Sequence[Bezier], point: Vector) -> bool:
    """Does the point lie inside the curve? A ray to the right crosses its pieces an odd number of times."""
    inside = False
    for piece in pieces:
        queue = [(piece, 0)]
        while queue:
            part, depth = queue.pop()
            _, right, low, high = _box(part)
            if right < point[0] or low > point[1] or high < point[1]:
                continue
            above = [p[1] > point[1] for p in part]
            if min(p[0] for p in part) > point[0] and (depth > DEEPEST // 2 or sorted(above) in (above, above[::-1])):
                inside ^= above[0] != above[3]
            elif depth <= DEEPEST:
                queue += [(half, depth + 1) for half in _halves(part)]
    return inside


def _shown(piece: Bezier) -> tuple[float, float]:
    return float(piece[0][0]), float(piece[0][1])
