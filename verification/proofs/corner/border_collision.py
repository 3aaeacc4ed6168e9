"""Border-collision bifurcations of piecewise affine maps: their kind, trapping polygons, cones and exponents.

The map acts on points `(u, v)`. It has one affine piece for `v <= 0` and one for `v >= 0` (components `ARC` and
`WALL`), which agree at `v = 0`. Their entries are balls: a proof holds for every map whose entries lie in those balls
at each point. Polygons are found in float64, and a proof takes their corners as exact numbers.

Lengths are in units of `e > 0`, the distance of the parameter from the bifurcation; for `e < 0` the shift has the other
sign. The theorems concern the piecewise affine map only, not higher-order terms. The kinds are those of
[NusseYorke1992] and [BanerjeeYorkeGrebogi1998].

**Robust chaos.** Suppose that for `e > 0` each piece has its fixed point on its own side. Call the piece with the
larger trace the left one, and let `x` be a multiple of `v` that is negative there. With a suitable `y` the map is

    (x, y) -> (tL*x + y + 1, -dL*x) for x <= 0,   (tR*x + y + 1, -dR*x) for x >= 0,

with the traces `t` and the determinants `d` of the pieces. (The new value of `v` must depend on `u`; the inequalities
below imply it.) Let `n < m` be the multipliers of the left piece, and

    0 < dL < 1,  0 < dR < 1,  tL > 1 + dL,  tR < -(1 + dR),
    phi > 0  with  phi = dR - (tR + dL + dR - (1 + tR)*m)*m.

Then a triangle is mapped into itself and a slightly larger one into its interior, and every orbit in it has an exponent
of at least `log min(m, abs(mR)) > 0`, where `mR` is the right multiplier below -1 (one-sided derivatives where the
orbit meets `x = 0`). So there is an attractor, and no cycle in the triangle is stable. The same holds for all nearby
pieces, since the hypotheses are strict inequalities. The region is that of [BanerjeeYorkeGrebogi1998], in the form that
[GlendinningSimpson2021] give its last inequality, and the two steps of the proof are theirs. The theorem does not say
that the attractor is connected, or the only one.

Proof. By the third inequality `0 < n < 1 < m`; let `Y` be the left fixed point, `h = m*(x - xY) + (y - yY)` and `k =
n*(x - xY) + (y - yY)`. On the left `h` is multiplied by `m` and `k` by `n`, so `h = 0` is the stable line of `Y` and `k
= 0` the unstable one. This meets `x = 0` at a point whose image is `D = (1/(1 - n), 0)`, and `h(f(D)) = phi/((1 - n)*(m
- 1))`: the last inequality says that `f(D)`, where the unstable manifold has folded, has not crossed the stable line.
Then the triangle `h >= h(f(D))`, `k <= 0`, above the line from `D` to `f(D)`, is mapped into itself. Its left part goes
to `h >= m*h(f(D))`, `k <= 0`, `y >= 0`, which is part of it. The corners of its right part go there too when they are
on `x = 0`, to `f(D)`, or to the line from `D` to `f(D)`; and it is convex. (Moved outwards a little, the end at `f(D)`
of the line by far more than the rest, the sides go strictly inside.) With `phi < 0` orbits that start near `f(D)` run
off beside the unstable line: `h < 0` grows in size, `k < 0` fades, and `x` falls for ever. A direction `y/x = s` goes
to `-d/(t + s)`: those from `-n` to `-nR`, `nR` the smaller right multiplier, go to such, and `x` is multiplied by `t +
s`, at least `m` on the left and at most `mR` on the right.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from itertools import pairwise

from flint import arb

from verification.arithmetic.balls import between

Row = tuple[arb, arb]
Point = tuple[float, float]
Polygon = list[Point]  # convex, anticlockwise


@dataclass(frozen=True)
class AffinePiece:
    """The affine map `x -> rows*(x - base) + shift` of the plane."""

    rows: tuple[Row, Row]
    shift: Row
    base: Row = (arb(0), arb(0))

    @property
    def trace(self) -> arb:
        """Trace of the matrix."""
        return self.rows[0][0] + self.rows[1][1]

    @property
    def determinant(self) -> arb:
        """Determinant of the matrix."""
        return self.rows[0][0] * self.rows[1][1] - self.rows[0][1] * self.rows[1][0]

    def of(self, x: Row) -> Row:
        """The image of a point `(u, v)`."""
        u, v = x[0] - self.base[0], x[1] - self.base[1]
        (a, b), (c, d) = self.rows
        return a * u + b * v + self.shift[0], c * u + d * v + self.shift[1]


Pieces = Mapping[int, AffinePiece]
SIGNS = {0: -1, 1: 1}  # of v on the arc and on the wall


def inward(v: arb, component: int) -> arb:
    """The signed distance of `v` from the border, positive on the side of the component.

    >>> inward(arb(2), 0), inward(arb(2), 1)
    (-2.00000000000000, 2.00000000000000)
    """
    return v if SIGNS[component] > 0 else -v


def hull(points: list[Point]) -> Polygon:
    """The corners of the convex hull, counterclockwise.

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
    """The sides of a polygon, as pairs of corners."""
    return list(pairwise([*polygon, polygon[0]]))


def clipped(polygon: Polygon, low: float, high: float) -> Polygon:
    """Points whose hull holds the part of a polygon with `low <= v <= high`, rounded outwards by `HAIR`.

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


HAIR = 1e-9  # far above rounding errors, far below the margins of the polygons


def grown(pieces: Pieces, start: Point, room: float) -> Polygon | None:
    """A polygon around `start` whose image lies within it, at least `room` from its sides; None if it grows beyond
    50.

    The polygon is the hull, in floats, of all images of `start`, where each step may err by `room`.
    """
    around = [(room * math.cos(k * math.pi / 4), room * math.sin(k * math.pi / 4)) for k in range(8)]
    polygon = hull([(start[0] + a, start[1] + b) for a, b in around])
    for _ in range(200):
        images = [image for c, piece in pieces.items() for image in _image(piece, part(polygon, c), 0.0)]
        larger = hull(polygon + [(u + a, v + b) for u, v in hull(images) for a, b in around])
        if max(abs(x) for p in larger for x in p) > 50.0:
            return None
        if len(larger) == len(polygon) and all(math.dist(p, q) < 1e-9 for p, q in zip(larger, polygon, strict=True)):
            return larger
        polygon = larger
    return None


def exactly_convex(polygon: Polygon) -> Polygon:
    """The convex hull of the corners in exact arithmetic; corners that are convex only by rounding are dropped."""
    exact = hull([(Fraction(u), Fraction(v)) for u, v in polygon])  # type: ignore[misc]  # hull works for fractions too
    return [(float(u), float(v)) for u, v in exact]


def part(polygon: Polygon, component: int) -> Polygon:
    """Points whose hull holds the part of the polygon on the component's side of the border."""
    return clipped(polygon, 0.0, math.inf) if SIGNS[component] > 0 else clipped(polygon, -math.inf, 0.0)


def trapped(pieces: Pieces, polygon: Polygon) -> bool | None:
    """True when the image of the polygon is proved to lie in its interior; None if it is not proved.

    On each side of the border the map is affine, so the image is the hull of the images of the corners.
    """
    polygon = exactly_convex(polygon)
    for component, piece in pieces.items():
        for corner in part(polygon, component):
            if not holds(polygon, piece.of((arb(corner[0]), arb(corner[1])))):
                return None
    return True


def holds(polygon: Polygon, point: Row) -> bool:
    """True when a point is proved to lie in the interior of a convex, counterclockwise polygon."""
    u, v = point
    return all((arb(c) - a) * (v - b) - (arb(d) - b) * (u - a) > 0 for (a, b), (c, d) in sides(polygon))


@dataclass(frozen=True)
class ConeExpansion:
    """A cone that both pieces map into itself: the range `ratio` of `u/v` in it; and bounds of the growth of `|v|`."""

    ratio: arb
    least: arb
    most: arb


def expansion(pieces: Pieces) -> ConeExpansion | None:
    """A cone that both pieces are proved to map into its interior; None when none is found."""
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
            return ConeExpansion(between(low, high), arb(whole.lower()), arb(whole.upper()))
        low, high = min(low, *lows) - 1e-3, max(high, *highs) + 1e-3
    return None


def turned(piece: AffinePiece, ratio: arb) -> arb:
    """The direction `u/v` of the image of a vector of direction `ratio`."""
    (a, b), (c, d) = piece.rows
    return (a * ratio + b) / (c * ratio + d)


class FixedPointChange(Enum):
    """The kinds of border collision, by the fixed points of the two pieces before and after the bifurcation."""

    FOLD = "two fixed points, one on each side of the border, on one side of the parameter and none on the other"
    PERSISTENCE = "one fixed point, which crosses the border"
    UNKNOWN = "not decided"


def fixed_point(piece: AffinePiece) -> Row:
    """The fixed point of an affine map, enclosed.

    >>> fixed_point(AffinePiece(((arb(3), arb(0)), (arb(0), arb(2))), (arb(2), arb(1))))
    (-1.00000000000000, -1.00000000000000)
    """
    (a, b), (c, d) = piece.rows
    p, q = piece.of((arb(0), arb(0)))
    determinant = (1 - a) * (1 - d) - b * c
    return ((1 - d) * p + b * q) / determinant, (c * p + (1 - a) * q) / determinant


def kind(pieces: Pieces) -> FixedPointChange:
    """The kind of the border collision; it depends on whether fixed points lie on their own sides for `e > 0`."""
    own = [inward(fixed_point(piece)[1], component) for component, piece in pieces.items()]
    if all(x > 0 for x in own) or all(x < 0 for x in own):
        return FixedPointChange.FOLD
    return FixedPointChange.PERSISTENCE if own[0] * own[1] < 0 else FixedPointChange.UNKNOWN


def hypotheses(pieces: Pieces) -> dict[str, bool | None]:
    """The verdicts on the hypotheses of robust chaos for `e > 0`: True if proved, False if refuted, None if open."""
    right, left = sorted(pieces, key=lambda component: float(pieces[component].trace.mid()))
    low, high = pieces[right], pieces[left]
    return {
        "fixed_points_on_their_sides": less(arb(0), inward(fixed_point(high)[1], left)),
        "determinants_between_0_and_1": both(
            *(both(less(arb(0), piece.determinant), less(piece.determinant, arb(1))) for piece in (low, high))
        ),
        "left_trace_above_1_plus_det": less(1 + high.determinant, high.trace),
        "right_trace_below_minus_1_minus_det": less(low.trace, -1 - low.determinant),
        "unstable_manifold_short_of_the_stable_one": less(arb(0), homoclinic(high, low)),
    }


def robust(pieces: Pieces) -> bool | None:
    """True if all hypotheses of robust chaos are proved, False if one is refuted, None if undecided."""
    return both(*hypotheses(pieces).values())


def homoclinic(left: AffinePiece, right: AffinePiece) -> arb:
    """The quantity `phi` of the module's theorem; it is 0 if the left fixed point has a homoclinic tangency.

    >>> shift = arb(0), arb(1)
    >>> left, right = (AffinePiece(((arb(0), arb(-d)), (arb(1), arb(t))), shift) for t, d in ((2.5, 1), (-2, 0.5)))
    >>> homoclinic(left, right)  # 0.5 - (-2 + 1 + 0.5 + 2)*2
    -2.50000000000000
    """
    t, d = left.trace, left.determinant
    m = (t + (t**2 - 4 * d).sqrt()) / 2
    return right.determinant - (right.trace + d + right.determinant - (1 + right.trace) * m) * m


def less(a: arb, b: arb) -> bool | None:
    """The verdict on `a < b` for balls: True or False if proved, else None."""
    return True if a < b else False if a >= b else None


def both(*answers: bool | None) -> bool | None:
    """The conjunction of answers: False if one is False, else None if one is None, else True."""
    return False if False in answers else None if None in answers else True


@dataclass(frozen=True)
class AttractorBounds:
    """Bounds in units of `e`: the attractor reaches `inner`, and lies within the polygon `outer`.

    `inner` are a low and a high `v` of points on the unstable manifold of a fixed point, that of the piece with a
    multiplier below -1; every attracting set that holds this fixed point contains them. `strips` are the lengths and
    widths of two thin convex sets whose union holds the attractor: the images of the two sides of the border.
    """

    inner: tuple[arb, arb]
    outer: Polygon
    strips: tuple[tuple[float, float], ...]


Segment = tuple[Row, Row]


def extent(pieces: Pieces, folding: int = 0, images: int = 10) -> AttractorBounds | None:
    """Bounds of the attractor; None if not proved. `folding` is the piece with a multiplier below -1."""
    fixed, border = fixed_point(pieces[folding]), _to_border(pieces[folding])
    if border is None or not inward(fixed[1], folding) > 0:
        return None
    manifold, heights = [(fixed, border)], [fixed[1]]
    for _ in range(images):
        manifold = [image for segment in manifold for image in _mapped(pieces, segment)]
        heights += [end[1] for segment in manifold for end in segment]
    outer = grown(pieces, _middle(pieces[folding].of(border)), 1e-5)
    if outer is None or not trapped(pieces, outer):
        return None
    inner = min(heights, key=lambda v: float(v.mid())), max(heights, key=lambda v: float(v.mid()))
    return AttractorBounds(inner, outer, strips(pieces, outer))


def strips(pieces: Pieces, region: Polygon) -> tuple[tuple[float, float], ...]:
    """Length and width of the images of the two sides of a trapping region; the union holds the region's attractor."""
    return tuple(_strip(_image(piece, part(region, component))) for component, piece in pieces.items())


def _to_border(piece: AffinePiece) -> Row | None:
    """The point where the unstable line of a piece's fixed point meets `v = 0`; None unless its multiplier is below -1.

    The preimages of the segment from the fixed point to that point lie on the same line, on alternate sides and ever
    closer to the fixed point, so the segment belongs to the unstable manifold.
    """
    (a, b), _ = piece.rows
    u, v = fixed_point(piece)
    multiplier = (piece.trace - (piece.trace**2 - 4 * piece.determinant).sqrt()) / 2
    return (u - v * b / (multiplier - a), arb(0)) if multiplier < -1 else None


def _mapped(pieces: Pieces, segment: Segment) -> list[Segment]:
    """The images of a segment, split at the border; parts whose side is not decided are left out."""
    p, q = segment
    if p[1] * q[1] < 0:
        crossing = p[0] - p[1] * (q[0] - p[0]) / (q[1] - p[1]), arb(0)
        return _mapped(pieces, (p, crossing)) + _mapped(pieces, (crossing, q))
    height = p[1] + q[1]
    return [(piece.of(p), piece.of(q)) for c, piece in pieces.items() if inward(height, c) > 0 and p[1] * q[1] >= 0]


def _middle(x: Row) -> Point:
    return float(x[0].mid()), float(x[1].mid())


def _image(piece: AffinePiece, points: Polygon, hair: float = HAIR) -> Polygon:
    """Points whose hull holds the image of the hull of `points`; they are moved by `hair` to allow for rounding."""
    images = [piece.of((arb(u) + arb(0, hair), arb(v) + arb(0, hair))) for u, v in points]
    return [(float(a), float(b)) for u, v in images for a in (u.lower(), u.upper()) for b in (v.lower(), v.upper())]


def _strip(points: Polygon) -> tuple[float, float]:
    """The length of a set along its longest diagonal, and its width across the diagonal, rounded up."""
    length, p, q = max((math.dist(p, q), p, q) for p in points for q in points)
    across = [_left(p, q, x) / length for x in points]
    return length + 1e-9, max(across) - min(across) + 1e-9


def exponents(pieces: Pieces, region: Polygon, bounces: int = 2, length: int = 12) -> tuple[float, float] | None:
    """Lower and upper bound of the largest exponent per bounce, for every orbit in a trapping region; None if not
    proved.

    They come from the least and the greatest product of stretches along itineraries of `length` steps that some point
    of the region may follow. A step of the map consists of `bounces` bounces.
    """
    whole = expansion(pieces)
    if whole is None:
        return None
    words = [(region, whole.ratio, arb(1))]
    for _ in range(length):
        words = [longer for word in words for longer in _continued(pieces, *word)]
    steps = length * bounces
    products = [product for _, _, product in words]
    least, most = (float(f(float(e(p)) for p in products)) for f, e in ((min, arb.lower), (max, arb.upper)))
    return math.log(least) / steps, math.log(most) / steps


def _continued(pieces: Pieces, at: Polygon, ratio: arb, product: arb) -> list[tuple[Polygon, arb, arb]]:
    found = []
    for component, piece in pieces.items():
        here: list[Point] = part(at, component)
        if here:
            stretch = abs(piece.rows[1][0] * ratio + piece.rows[1][1])
            found.append((hull(_image(piece, here)), turned(piece, ratio), product * stretch))
    return found
