"""Half the return of the cuspless cardioid near its corner orbit, as affine maps with balls for entries.

A ball that comes from the arc at `-theta1 + e*u` and meets the boundary the distance `e*v` beyond the
upper corner flies to the arc again and to the lower corner; the mirror image of where it arrives is
`(u1, v1)`. Here `e = lam - lambda-star > 0`. Let `H(U, V, e)` be this map between positions that are not
divided by `e`, so that `(u1, v1) = H(e*u, e*v, e)/e`. By the mean value theorem on the straight way from a
base point on `v = 0`, which stays on one side of the corner,

    (u1, v1) = A ((u, v) - base) + H(e*base, 0, e)/e,    A in the hull of dH/d(U, V) at (e*u, e*v, e),

over `(u, v)` in that side of a convex region and `e` in the stretch that is asked for: one hull for `v < 0`
(the bounce is on the arc) and one for `v > 0` (on the wall). So the map itself, and not its linear part,
lies in this family of piecewise affine maps. The boxes that are followed are therefore products: a box of
`(u, v)` times the ball of `e` that goes with it. The multiples of a region by a smaller `e` lie in its
multiple by the largest one only where the region is star-shaped about the origin, and ours are not.

Where the ball lands at the lower corner divides nothing: tangent and speed of the parameter agree there, so
`H` is continuously differentiable across it. On `v = 0` the bounce is at the corner for every `e`, so that
`H(e*base, 0, e)` has no part of either side in it, and as it is 0 at `e = 0`, divided by `e` it is a mean of
`base*dH/dU + dH/de` at `(f*base, 0, f)` over all `f` from 0 to `e`, not over the stretch of `e` alone.
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

LONGEST_U, LONGEST_V, LONGEST_E, TINY = 1e-2, 2e-3, 5e-4, 1e-9  # sides of the boxes that are followed
DEEPEST = 6  # halvings of a box that is not enclosed
Image = tuple[Quantity, Quantity]


def limit() -> Pieces:
    """The piecewise linear map at `lambda-star` itself, enclosed.

    >>> limit()[WALL].trace.str(6, radius=False), limit()[ARC].trace.str(6, radius=False)
    ('1.17184', '-2.15438')
    """
    return pieces([(0.0, 0.0)], (0.0, 0.0))


def pieces(region: Polygon, e: tuple[float, float]) -> Pieces:
    """The family over a convex region that meets `v = 0`, for all `e[0] <= lam - lambda-star <= e[1]`, but 0."""
    if not 0 <= e[0] <= e[1]:
        raise ValueError(f"half return: e = {e} is no stretch of distances above lambda-star")
    on_border = [u for u, _ in clipped(region, 0.0, 0.0)]
    if not on_border:
        raise ValueError("half return: the region does not meet v = 0, where the mean value theorem starts")
    with working(BITS):
        base = (min(on_border) + max(on_border)) / 2
        shift = _shift(base, cuts(0.0, e[1], LONGEST_E))
        found = {}
        for component in (ARC, WALL):
            boxes = (box for time in cuts(*e, LONGEST_E) for box in _boxes(region, component, time))
            images = [image for box in boxes for image in _followed(component, *box)]
            hull = [joined([image[k].slopes[i] for image in images]) for k in (0, 1) for i in (0, 1)]
            found[component] = Piece(((hull[0], hull[1]), (hull[2], hull[3])), shift, (arb(base), arb(0)))
        return found


def _boxes(region: Polygon, component: int, e: arb) -> list[tuple[arb, arb, arb]]:
    """Boxes of `(U, V, e)` that hold `(f*u, f*v, f)` for all `f` of a ball and `(u, v)` on one side of the region."""
    heights, longest = [v for _, v in region], float(e.upper()) + TINY
    low, high = (min(*heights, 0.0), 0.0) if component == ARC else (0.0, max(*heights, 0.0))
    found = []
    for v in cuts(low, high, LONGEST_V / longest):
        width = [u for u, _ in clipped(region, float(v.lower()), float(v.upper()))]
        found += [(u * e, v * e, e) for u in cuts(min(width), max(width), LONGEST_U / longest)]
    return found


def _shift(base: float, times: list[arb]) -> Row:
    """`H(e*base, 0, e)/e` for every `e` up to the end of the last of these balls, which begin at 0."""
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
