"""Half the return of the cuspless cardioid near its corner orbit, as affine maps with balls for entries.

A ball that comes from the arc at `-theta1 + e*u` and meets the boundary the distance `e*v` beyond the
upper corner flies to the arc again and to the lower corner; the mirror image of where it arrives is
`(u1, v1)`. Here `e = lam - lambda-star`, and `H` is that map before it is divided by `e`. By the mean
value theorem on the straight way from a base point on `v = 0`, which the corner divides nowhere,

    (u1, v1) = A ((u, v) - base) + H(base)/e,    A in the hull of DH over the region,

with one hull for `v < 0` (the bounce is on the arc) and one for `v > 0` (on the wall). So the map itself,
and not its linear part, lies in this family of piecewise affine maps.
"""

from flint import arb

from verification.arithmetic import working
from verification.certificates.boxes import cuts, halves, joined
from verification.certificates.corner import ARC, WALL, enclosed
from verification.certificates.polygon import Piece, Pieces, Polygon, Row, clipped
from verification.certificates.trail import (
    BITS,
    Bounce,
    Quantity,
    at_corner,
    beyond,
    corners,
    on_arc,
    parameter,
)

LONGEST_U, LONGEST_V, LONGEST_E, TINY = 1e-2, 2e-3, 1e-3, 1e-9  # sides of the boxes that are followed
DEEPEST = 6  # halvings of a box that is not enclosed
Image = tuple[Quantity, Quantity]


def limit() -> Pieces:
    """The piecewise linear map at `lambda-star` itself, enclosed.

    >>> limit()[WALL].trace.str(6, radius=False), limit()[ARC].trace.str(6, radius=False)
    ('1.17184', '-2.15438')
    """
    return pieces([(0.0, 0.0)], (0.0, 0.0))


def pieces(region: Polygon, e: tuple[float, float]) -> Pieces:
    """The family over a convex region that meets `v = 0`, for all `e[0] <= lam - lambda-star <= e[1]`."""
    with working(BITS):
        middle = sorted(u for u, _ in clipped(region, 0.0, 0.0))
        base = (middle[0] + middle[-1]) / 2
        times = cuts(*e, LONGEST_E)
        shift = _shift(base, cuts(0.0, e[1], LONGEST_E))
        found = {}
        for component in (ARC, WALL):
            images = [i for box in _boxes(region, component, e[1]) for time in times for i in _followed(*box, time)]
            hull = [joined([image[k].slopes[i] for image in images]) for k in (0, 1) for i in (0, 1)]
            found[component] = Piece(((hull[0], hull[1]), (hull[2], hull[3])), shift, (arb(base), arb(0)))
        return found


def _boxes(region: Polygon, component: int, e: float) -> list[tuple[int, arb, arb]]:
    """Boxes, of the unscaled `u` and `v`, that cover the part of the region on one side of the corner."""
    ends = [v for _, v in region]
    low, high = (min(ends), 0.0) if component == ARC else (0.0, max(ends))
    found = []
    for v in cuts(low, high, LONGEST_V / (e + TINY)):
        width = [u for u, _ in clipped(region, float(v.lower()), float(v.upper()))]
        for u in cuts(min(width), max(width), LONGEST_U / (e + TINY)):
            found.append((component, u * e, v * e))
    return found


def _shift(base: float, times: list[arb]) -> Row:
    """`H(base)/e`: a mean of its derivative by `e` from 0 on, so within the hull of that."""
    images = [image for e in times for image in _followed(ARC, base * e, arb(0), e)]
    first, second = (joined([base * image[k].slopes[0] + image[k].slopes[2] for image in images]) for k in (0, 1))
    return first, second


def _followed(component: int, u: arb, v: arb, e: arb, depth: int = 0) -> list[Image]:
    """The images of a box, in halves where it is not enclosed as a whole."""
    try:
        return _images(component, u, v, e)
    except ArithmeticError:
        if depth == DEEPEST:
            raise
    if v.rad() > e.rad():
        return [image for half in halves(v) for image in _followed(component, u, half, e, depth + 1)]
    return [image for half in halves(e) for image in _followed(component, u, v, half, depth + 1)]


def _images(component: int, u: arb, v: arb, e: arb) -> list[Image]:
    """The half return of a box, by `(u, v, e)` unscaled; two images where the landing may be on either part."""
    theta1, star = enclosed()
    spread = u - arb(u.mid()), v - arb(v.mid()), e - arb(e.mid())
    lam = parameter(star + e.mid(), 2, spread)
    before = Bounce(ARC, parameter(-theta1 + u.mid(), 0, spread))
    here = Bounce(component, parameter(corners()[component] + v.mid(), 1, spread))
    middle = on_arc(before, here, float(theta1.mid()), lam, spread)
    return [
        (_mirrored(middle.at, theta1), beyond(landing, False))
        for landing in at_corner(here, middle, False, lam, spread)
    ]


def _mirrored(at: Quantity, theta1: arb) -> Quantity:
    return Quantity(theta1 - at.centre, tuple(-s for s in at.slopes), theta1 - at.whole)
