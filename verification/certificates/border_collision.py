"""What a border collision of the plane bears, from its two affine pieces: the kind, bounds, exponents.

`x -> A x + b` with one `A` for `v < 0` and another for `v > 0`, that agree at `v = 0`, in units of the
distance `e > 0` of the parameter; for `e < 0` the shift has the other sign. Proofs hold for the
piecewise linear map. The kinds are those of [NusseYorke1992] and [BanerjeeYorkeGrebogi1998].
"""

import math
from dataclasses import dataclass
from enum import Enum

from flint import arb

from verification.certificates.polygon import (
    SIGNS,
    Piece,
    Pieces,
    Point,
    Polygon,
    Row,
    expansion,
    grown,
    hull,
    part,
    trapped,
    turned,
)


class Kind(Enum):
    """What happens to the fixed points of the two pieces as the parameter passes."""

    FOLD = "two fixed points, one on each side of the border, on one side of the parameter and none on the other"
    PERSISTENCE = "one fixed point, which crosses the border"
    UNKNOWN = "not decided"


def fixed_point(piece: Piece) -> Row:
    """The fixed point of an affine map, enclosed.

    >>> fixed_point(Piece(((arb(3), arb(0)), (arb(0), arb(2))), (arb(2), arb(1))))
    (-1.00000000000000, -1.00000000000000)
    """
    (a, b), (c, d) = piece.rows
    p, q = piece.of((arb(0), arb(0)))
    determinant = (1 - a) * (1 - d) - b * c
    return ((1 - d) * p + b * q) / determinant, (c * p + (1 - a) * q) / determinant


def kind(pieces: Pieces) -> Kind:
    """Do both pieces have their fixed point on their own side for the same sign of `e`?"""
    own = [fixed_point(piece)[1] * SIGNS[component] for component, piece in pieces.items()]
    if all(x > 0 for x in own) or all(x < 0 for x in own):
        return Kind.FOLD
    return Kind.PERSISTENCE if own[0] * own[1] < 0 else Kind.UNKNOWN


def robust(pieces: Pieces) -> bool | None:
    """True in the region of robust chaos: one trace above `1 + det`, the other below `-(1 + det)`, `0 < det < 1`."""
    low, high = sorted(pieces.values(), key=lambda piece: float(piece.trace.mid()))
    dets = low.determinant, high.determinant
    holds = all(0 < d < 1 for d in dets) and low.trace < -(1 + dets[0]) and high.trace > 1 + dets[1]
    return True if holds else None


@dataclass(frozen=True)
class Extent:
    """Bounds in units of `e`: the attractor reaches `inner`, and lies within the polygon `outer`.

    `inner` are the lowest and the highest `v` that points of the unstable manifold of the folding piece's
    fixed point are proved to have: they belong to every attracting set that holds it. `strips` are length
    and width of two thin convex sets, the images of the sides, that hold the attractor.
    """

    inner: tuple[arb, arb]
    outer: Polygon
    strips: tuple[tuple[float, float], ...]


Segment = tuple[Row, Row]


def extent(pieces: Pieces, folding: int = 0, room: float = 1e-5, images: int = 10) -> Extent | None:
    """Bounds of the attractor; `folding` is the piece with the negative multiplier. None when not proved."""
    fixed, border = fixed_point(pieces[folding]), _to_border(pieces[folding])
    if border is None or not fixed[1] * SIGNS[folding] > 0:
        return None
    manifold, heights = [(fixed, border)], [fixed[1]]
    for _ in range(images):
        manifold = [image for segment in manifold for image in _mapped(pieces, segment)]
        heights += [end[1] for segment in manifold for end in segment]
    outer = grown(pieces, _middle(pieces[folding].of(border)), room)
    if outer is None or not trapped(pieces, outer):
        return None
    inner = min(heights, key=lambda v: float(v.mid())), max(heights, key=lambda v: float(v.mid()))
    return Extent(inner, outer, strips(pieces, outer))


def strips(pieces: Pieces, region: Polygon) -> tuple[tuple[float, float], ...]:
    """Length and width of the images of both sides of a region: a trapped one has its attractor in them."""
    return tuple(_strip(_image(piece, part(region, component))) for component, piece in pieces.items())


def _to_border(piece: Piece) -> Row | None:
    """Where the unstable direction of a fixed point meets `v = 0`.

    The multiplier is negative, below -1: preimages of that way lie on it, on either side of the fixed
    point in turn and ever nearer, so that all of it belongs to the unstable manifold.
    """
    (a, b), _ = piece.rows
    u, v = fixed_point(piece)
    multiplier = (piece.trace - (piece.trace**2 - 4 * piece.determinant).sqrt()) / 2
    return (u - v * b / (multiplier - a), arb(0)) if multiplier < -1 else None


def _mapped(pieces: Pieces, segment: Segment) -> list[Segment]:
    """The image of a segment of the plane; what cannot be told to lie on one side is left out."""
    p, q = segment
    if p[1] * q[1] < 0:
        crossing = p[0] - p[1] * (q[0] - p[0]) / (q[1] - p[1]), arb(0)
        return _mapped(pieces, (p, crossing)) + _mapped(pieces, (crossing, q))
    height = p[1] + q[1]
    return [(piece.of(p), piece.of(q)) for c, piece in pieces.items() if height * SIGNS[c] > 0 and p[1] * q[1] >= 0]


def _middle(x: Row) -> Point:
    return float(x[0].mid()), float(x[1].mid())


def _image(piece: Piece, points: Polygon) -> Polygon:
    """Points whose hull holds the image of the hull."""
    images = [piece.of((arb(u), arb(v))) for u, v in points]
    return [(float(a), float(b)) for u, v in images for a in (u.lower(), u.upper()) for b in (v.lower(), v.upper())]


def _strip(points: Polygon) -> tuple[float, float]:
    """Length and width of a set, along its longest diagonal and across it, rounded up."""
    length, p, q = max((math.dist(p, q), p, q) for p in points for q in points)
    across = [((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])) / length for x in points]
    return length + 1e-9, max(across) - min(across) + 1e-9


def exponents(pieces: Pieces, region: Polygon, bounces: int = 2, length: int = 12) -> tuple[float, float] | None:
    """Bounds of the largest exponent per bounce of every orbit in a trapping region.

    From the least and the largest product of stretches over the words of this length that some point
    of the region follows; each step of the map is as many bounces as said.
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
