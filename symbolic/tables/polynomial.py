"""Closed chains of polynomial pieces of degree three: their area and their crossings, exactly.

A piece is a cubic Bezier curve with rational control points. It lies in the convex hull of these points, and its
velocity in that of their differences. A curve is proved simple by cutting it until each piece turns by less than a
quarter turn, neighbours together advance along one direction, and the boxes of all other pieces are disjoint.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import ceil, floor, isqrt

from sympy import Add, Expr, Poly, Rational, S, expand

from symbolic.tables.table import Component, theta

Vector = tuple[Fraction, Fraction]
Bezier = tuple[Vector, Vector, Vector, Vector]
Piece = tuple[tuple[Fraction, ...], ...]  # control points; of arcs of conics with a third coordinate, their weights
DEEPEST = 60  # most halvings
LATTICE = 40  # bits of the sides of a box
FINE = 10**9  # denominator of the coordinates of a unit chord
MOST = 100_000  # largest number of pairs of pieces whose boxes overlap
SHARES = 10**18  # denominator of the place of a control point along a tangent


def as_component(name: str, piece: Bezier) -> Component:
    """The piece as a polynomial in `theta` on [0, 1]."""
    point = []
    for axis in (0, 1):
        a, b, c, d = (p[axis] for p in piece)
        coefficients = a, 3 * (b - a), 3 * (a - 2 * b + c), d - a + 3 * (b - c)
        point.append(Add(*(_rational(k) * theta**i for i, k in enumerate(coefficients))))
    return Component(name, (point[0], point[1]), S.Zero, S.One)


def fraction(value: Expr) -> Fraction:
    """A rational number of SymPy as a fraction.

    >>> fraction(Rational(2, 25))
    Fraction(2, 25)
    """
    return Fraction(int(S(value).p), int(S(value).q))


def _rational(value: Fraction) -> Rational:
    return Rational(value.numerator, value.denominator)


@lru_cache(maxsize=8192)
def rational_coefficients(component: Component) -> tuple[list[Fraction], list[Fraction]] | None:
    """The coefficients of `x` and of `y`, constant first; None unless both are rational polynomials with rational ends.

    >>> from symbolic.tables import square
    >>> rational_coefficients(square(3).components[0])
    ([Fraction(0, 1), Fraction(3, 1)], [Fraction(0, 1)])
    """
    if not (S(component.start).is_Rational and S(component.end).is_Rational):
        return None
    point = map(S, component.point)
    x, y = (as_sum(each) or (as_sum(expand(each)) if each.is_polynomial(theta) else None) for each in point)
    return None if x is None or y is None else (x, y)


def derivative(coordinate: Expr) -> Expr:
    """The derivative by `theta`; for a sum of powers with rational factors it is formed without SymPy's `diff`.

    >>> derivative(3 * theta**2 - theta / 2)
    6*theta - 1/2
    """
    row = as_sum(coordinate)
    if row is None:
        return coordinate.diff(theta)
    return Add(*(_rational(k * c) * theta ** (k - 1) for k, c in enumerate(row) if k))


def end_point(component: Component, last: bool) -> tuple[Expr, Expr]:
    """The first or the last point of a component, exactly."""
    place, rows = component.end if last else component.start, rational_coefficients(component)
    if rows is None:
        return component.at(place)
    x, y = (_rational(value_of(row, fraction(place))) for row in rows)
    return x, y


def as_sum(coordinate: Expr) -> list[Fraction] | None:
    """The coefficients of a sum of powers of `theta` with rational factors, constant first; None for anything else.

    >>> as_sum(theta**2 - 1), as_sum((theta + 1) ** 2)
    ([Fraction(-1, 1), Fraction(0, 1), Fraction(1, 1)], None)
    """
    found: dict[int, Fraction] = {}
    for term, c in coordinate.as_coefficients_dict().items():
        base, power = (theta, S.Zero) if term == 1 else term.as_base_exp()
        if base != theta or not (power.is_Integer and power >= 0 and c.is_Rational):
            return None
        found[int(power)] = fraction(c)
    return [found.get(k, Fraction(0)) for k in range(max(found, default=0) + 1)]


def derived(row: Sequence[Fraction]) -> list[Fraction]:
    """The coefficients of the derivative of a polynomial."""
    return [k * c for k, c in enumerate(row)][1:]


def value_of(row: Sequence[Fraction], at: Fraction) -> Fraction:
    """The value of a polynomial, by Horner's rule.

    >>> value_of([Fraction(1), Fraction(0), Fraction(2)], Fraction(3))
    Fraction(19, 1)
    """
    value = Fraction(0)
    for c in reversed(row):
        value = value * at + c
    return value


def cubic(component: Component) -> list[list[Expr]] | None:
    """The four coefficients of `x` and those of `y`, constant first, when both are polynomials of degree three at most.

    >>> from symbolic.tables import square
    >>> cubic(square(3).components[0])
    [[0, 3, 0, 0], [0, 0, 0, 0]]
    """
    if (rows := rational_coefficients(component)) is not None:
        longest = max(map(len, rows))
        padded = [[*map(_rational, row), *[S.Zero] * (4 - len(row))] for row in rows]
        return padded if longest <= 4 else None
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
    rows = rational_coefficients(component)
    if rows is None or max(map(len, rows)) > 4:
        return None
    low, high = map(fraction, (component.start, component.end))
    found = []
    for row in rows:
        _, k1, k2, k3 = row + [Fraction(0)] * (4 - len(row))
        a, b = value_of(row, low), (high - low) * (k1 + low * (2 * k2 + 3 * low * k3))
        c, d = (high - low) ** 2 * (k2 + 3 * low * k3), (high - low) ** 3 * k3
        found.append((a, a + b / 3, a + (2 * b + c) / 3, a + b + c + d))
    one, two, three, four = zip(*found, strict=True)
    return one, two, three, four


def elevated(points: Sequence[Vector]) -> Bezier:
    """The cubic Bezier curve of a curve of degree 1, 2 or 3 with these control points; `ValueError` for other degrees.

    A straight curve gets constant speed, wherever between its ends the inner control points lie.

    >>> zero, one = (Fraction(0), Fraction(0)), (Fraction(3), Fraction(0))
    >>> elevated([zero, zero, one, one]) == elevated([zero, one])
    True
    """
    third = Fraction(1, 3)
    if not 2 <= len(points) <= 4:
        raise ValueError(f"a piece has {len(points)} control points; accepted: 2, 3 or 4")
    p, q = points[0], points[-1]
    chord = q[0] - p[0], q[1] - p[1]
    ways = [_dot(chord, (c[0] - p[0], c[1] - p[1])) for c in points]
    if ways == sorted(ways) and all(chord[0] * (c[1] - p[1]) == chord[1] * (c[0] - p[0]) for c in points):
        points = p, q
    if len(points) == 4:
        return p, points[1], points[2], q
    inner = [(r[0] + 2 * third * (c[0] - r[0]), r[1] + 2 * third * (c[1] - r[1])) for c in points[1:-1] for r in (p, q)]
    one, two = inner or [(r[0] + third * (s[0] - r[0]), r[1] + third * (s[1] - r[1])) for r, s in ((p, q), (q, p))]
    return p, one, two, q


def aligned(curve: Sequence[Bezier], near: Fraction) -> list[Bezier]:
    """A closed curve with tangents made exactly equal at each join where they are equal up to rounding.

    At such a join one control point moves, by at most `near` in each coordinate. Straight pieces do not move.

    >>> side, bow = ((0, 0), (3, 0)), ((3, 0), (4, Fraction(1, 10**20)), (2, 2), (0, 0))
    >>> aligned([elevated(side), elevated(bow)], Fraction(1, 10**9))[1][1]
    (Fraction(4, 1), Fraction(0, 1))
    """
    found = [list(piece) for piece in curve]
    straight = [piece == elevated((piece[0], piece[3])) for piece in curve]
    for j, after in enumerate(found):
        before = found[j - 1]
        handles = [
            (after, 1, before, 2),
            (before, 2, after, 1),
        ]  # piece and index of the point that may move, then of the one that gives the direction
        for (one, i, other, k), stays in zip(handles, (straight[j], straight[j - 1]), strict=True):
            end = after[0]
            way, own = ((end[0] - p[0], end[1] - p[1]) for p in (other[k], one[i]))
            square, along = _dot(way, way), -_dot(way, own)
            if stays or along <= 0 or way[0] * own[1] == way[1] * own[0]:
                continue
            share = Fraction(round(along / square * SHARES), SHARES)
            moved = end[0] + share * way[0], end[1] + share * way[1]
            if max(abs(moved[0] - one[i][0]), abs(moved[1] - one[i][1])) <= near:
                one[i] = moved
    return [(p, q, r, s) for p, q, r, s in found]


def signed_area(pieces: Sequence[Bezier]) -> Fraction:
    """The area by Green's formula, negative for a clockwise curve."""
    total = Fraction(0)
    weights = {(0, 1): 6, (0, 2): 3, (0, 3): 1, (1, 2): 3, (1, 3): 3, (2, 3): 6}
    for piece in pieces:
        for (i, j), weight in weights.items():
            total += weight * (piece[i][0] * piece[j][1] - piece[i][1] * piece[j][0])
    return total / 20


def separate(name: str, curves: Sequence[Sequence[Piece]]) -> None:
    """Raises `ValueError` if closed curves meet themselves or each other, or if a later one is not inside the first."""
    for pieces in curves:
        for piece in pieces:
            if len(set(piece)) == 1:
                x, y = _shown(piece)
                raise ValueError(f"{name}: a piece at ({x:.12g}, {y:.12g}) has length 0; leave it out")
    found = meets(curves)
    if found is not None:
        raise ValueError(f"{name}: the boundary crosses itself, or stops, near ({found[0]:.12g}, {found[1]:.12g})")
    hole = _outside(curves)
    if hole:
        raise ValueError(f"{name}: hole {hole} does not lie in the table")


def bound_a_table(curves: Sequence[Sequence[Bezier]]) -> bool:
    """Is it proved that these closed curves bound a table, the first as its outer boundary and the others as holes?"""
    areas = [signed_area(pieces) for pieces in curves]
    if areas[0] <= 0 or any(area >= 0 for area in areas[1:]):
        return False
    return meets(curves) is None and not _outside(curves)


def _outside(curves: Sequence[Sequence[Piece]]) -> int:
    """The number of a hole that does not lie in the outer curve, or lies in another hole; 0 when there is none."""
    outer = curves[0]
    for k, hole in enumerate(curves[1:], 1):
        point = _cartesian(hole[0])[0]
        around = [other for other in curves[1:] if other is not hole and _surrounds(other, point)]
        if around or not _surrounds(outer, point):
            return k
    return 0


Span = tuple[int, int, int, int, int, int, Piece]  # box, outwards on a lattice; curve, place in it, control points


def meets(curves: Sequence[Sequence[Piece]]) -> tuple[float, float] | None:
    """A point near which curves meet, or have velocity 0, or may do so; None if it is proved that they do not.

    Boxes are swept from left to right, and only pieces whose boxes overlap are compared. `ValueError` if more than
    `MOST` pairs do.
    """
    rings: list[list[Piece]] = []
    for pieces in curves:
        ring = [part for piece in pieces for part in _monotone(piece, 0)]
        stop = _run_forwards(ring)
        if stop is not None:
            return _shown(stop)
        rings.append(ring)
    boxes = [(_box(part), k, i, part) for k, ring in enumerate(rings) for i, part in enumerate(ring)]
    unit = max(abs(side) for box, *_ in boxes for side in box) / (1 << LATTICE) or Fraction(1)
    spans: list[Span] = []
    for (a, b, c, d), k, i, part in boxes:
        spans.append((floor(a / unit), ceil(b / unit), floor(c / unit), ceil(d / unit), k, i, part))
    active: list[Span] = []
    looked = 0
    for span in sorted(spans, key=lambda span: span[:2]):
        left, _, low, high, k, i, part = span
        active = [other for other in active if other[1] >= left]
        for _, _, bottom, top, other, j, piece in active:
            if bottom > high or top < low or (k == other and (i - j) % len(rings[k]) in (1, len(rings[k]) - 1)):
                continue
            looked += 1
            if looked > MOST:
                raise ValueError(
                    f"over {MOST} pairs of pieces are close, too many to prove that none cross; give fewer pieces"
                )
            if _touch(part, piece, 0):
                return _shown(part)
        active.append(span)
    return None


def _run_forwards(ring: list[Piece]) -> Piece | None:
    """Halves pieces in place until all neighbours advance along one direction; a piece that never does, else None."""
    known = [False] * len(ring)
    for _ in range(DEEPEST):
        bad = [i for i, fine in enumerate(known) if not fine and not _forwards(ring[i - 1], ring[i])]
        if not bad:
            return None
        if any(_straight(ring[i - 1]) and _straight(ring[i]) for i in bad):
            return ring[bad[0]]  # halving straight pieces does not help
        stop, count = ring[bad[0]], len(ring)
        cut = {i % count for i in bad} | {(i - 1) % count for i in bad}
        parts = [
            (_halves(part), False) if i in cut else ((part,), (i - 1) % count not in cut) for i, part in enumerate(ring)
        ]
        ring[:] = [half for halves, _ in parts for half in halves]
        known = [fine for halves, fine in parts for _ in halves]
    return stop


def _straight(piece: Piece) -> bool:
    (x, y), *others = _differences(piece)
    return all(x * w == y * v for v, w in others)


def _monotone(piece: Piece, depth: int) -> list[Piece]:
    """The piece cut into parts on which the velocity turns by less than a quarter turn, unless they get too short."""
    d = _differences(piece)
    if depth >= DEEPEST // 4 or all(_dot(v, w) > 0 for i, v in enumerate(d) for w in d[i:]):
        return [piece]
    first, last = _halves(piece)
    return _monotone(first, depth + 1) + _monotone(last, depth + 1)


def _forwards(before: Piece, after: Piece) -> bool:
    """Do two neighbouring pieces advance along one direction, so that together they do not meet themselves?"""
    v, w = (_along(piece) for piece in (before, after))
    direction = v[0] + w[0], v[1] + w[1]
    return all(_dot(d, direction) > 0 for piece in (before, after) for d in _differences(piece))


def _along(piece: Piece) -> Vector:
    """The chord, scaled to length about 1. Rounding does no harm, since `_forwards` may use any vector."""
    (x0, y0), *_, (x1, y1) = _cartesian(piece)
    x, y = x1 - x0, y1 - y0
    size = max(abs(x), abs(y))
    if not size:
        return Fraction(0), Fraction(0)
    x, y = Fraction(round(x / size * FINE), FINE), Fraction(round(y / size * FINE), FINE)
    length = isqrt(int((x * x + y * y) * FINE**2))
    return x / length, y / length


def _touch(p: Piece, q: Piece, depth: int) -> bool:
    """False if two pieces are proved to be disjoint; True if they are not."""
    left, right, low, high = _box(p)
    a, b, c, d = _box(q)
    if left > b or a > right or low > d or c > high or _apart(p, q) or _apart(q, p):
        return False
    if depth >= DEEPEST:
        return True
    return any(_touch(x, y, depth + 1) for x in _halves(p) for y in _halves(q))


def _apart(p: Piece, q: Piece) -> bool:
    """Does a line parallel to the chord of `p` separate the pieces `p` and `q`?"""
    mine, others = _cartesian(p), _cartesian(q)
    (x0, y0), *_, (x1, y1) = mine
    own, other = ([(x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) for x, y in points] for points in (mine, others))
    return max(own) < min(other) or max(other) < min(own)


def _differences(piece: Piece) -> list[Vector]:
    return [(x1 - x0, y1 - y0) for (x0, y0), (x1, y1) in pairwise(_cartesian(piece))]


def _cartesian(piece: Piece) -> list[Vector]:
    """The control points in the plane, divided by their weights; the curve lies in their convex hull."""
    return [(p[0] / p[2], p[1] / p[2]) if len(p) == 3 else (p[0], p[1]) for p in piece]


def _dot(v: Vector, w: Vector) -> Fraction:
    return v[0] * w[0] + v[1] * w[1]


def _halves(piece: Piece) -> tuple[Piece, Piece]:
    rows = [piece]
    while len(rows[-1]) > 1:
        rows.append(tuple(tuple((x + y) / 2 for x, y in zip(p, q, strict=True)) for p, q in pairwise(rows[-1])))
    return tuple(row[0] for row in rows), tuple(row[-1] for row in reversed(rows))


def _box(piece: Piece) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    xs, ys = zip(*_cartesian(piece), strict=True)
    return min(xs), max(xs), min(ys), max(ys)


def _surrounds(pieces: Sequence[Piece], point: Vector) -> bool:
    """Does the point lie inside the curve? A ray to the right crosses its pieces an odd number of times."""
    inside = False
    for piece in pieces:
        queue: list[tuple[Piece, int]] = [(piece, 0)]
        while queue:
            part, depth = queue.pop()
            left, right, low, high = _box(part)
            if right < point[0] or low > point[1] or high < point[1]:
                continue
            above = [y > point[1] for _, y in _cartesian(part)]
            if left > point[0] and (depth > DEEPEST // 2 or sorted(above) in (above, above[::-1])):
                inside ^= above[0] != above[-1]
            elif depth <= DEEPEST:
                queue += [(half, depth + 1) for half in _halves(part)]
    return inside


def _shown(piece: Piece) -> tuple[float, float]:
    x, y = _cartesian(piece)[0]
    return float(x), float(y)
