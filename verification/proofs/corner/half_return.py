"""Half the return of the cuspless cardioid near its corner orbit, as affine maps with balls for entries.

A particle that comes from the arc at `-theta1 + e*u` and meets the boundary the distance `e*v` beyond the
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

Where the particle lands at the lower corner divides nothing: tangent and speed of the parameter agree there, so
`H` is continuously differentiable across it. On `v = 0` the bounce is at the corner for every `e`, so that
`H(e*base, 0, e)` has no part of either side in it, and as it is 0 at `e = 0`, divided by `e` it is a mean of
`base*dH/dU + dH/de` at `(f*base, 0, f)` over all `f` from 0 to `e`, not over the stretch of `e` alone.

This proves a chaotic attractor for every contraction from `lambda-star` on. For `lambda-star < lam <= lambda-star +
e` a convex polygon around the corner orbit, of a size proportional to `lam - lambda-star`, is thrown into its own
interior by half the return (`half_return`), and there is a cone of directions that this map keeps and stretches by a
factor above 1. So in the region no cycle is stable, and every orbit in it has a positive exponent. It is a proof
about the map itself, in steps of `e`; that the attractor in the region is one piece is not proved. Paper: section
5.2. The two ideas are those of [GlendinningSimpson2021] for the piecewise linear map.
"""

import math
from dataclasses import dataclass

from flint import arb

from verification.arithmetic.balls import cuts, halves, joined, working
from verification.arithmetic.iteration import Tick, silent
from verification.proofs.corner.border_collision import (
    Expansion,
    Piece,
    Pieces,
    Polygon,
    Row,
    clipped,
    expansion,
    fixed_point,
    grown,
    holds,
    trapped,
)
from verification.proofs.corner.corner import (
    ARC,
    BITS,
    WALL,
    Bounce,
    Quantity,
    after_corner,
    beyond,
    corner_parameters,
    enclosed,
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
            images = [image for box in boxes for image in followed(component, *box)]
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
    images = [image for e in times for image in followed(ARC, base * e, arb(0), e)]
    first, second = (joined([base * image[k].slopes[0] + image[k].slopes[2] for image in images]) for k in (0, 1))
    return first, second


def followed(component: int, u: arb, v: arb, e: arb, depth: int = 0) -> list[Image]:
    """The images of a box, in halves where it is not enclosed as a whole."""
    try:
        return _images(component, u, v, e)
    except ArithmeticError:
        if depth == DEEPEST:
            raise
    if v.rad() > e.rad():
        return [image for half in halves(v) for image in followed(component, u, half, e, depth + 1)]
    return [image for half in halves(e) for image in followed(component, u, v, half, depth + 1)]


def _images(component: int, u: arb, v: arb, e: arb) -> list[Image]:
    """The half return of a box, by `(u, v, e)` unscaled; two images where the landing may be on either part."""
    theta1, star = enclosed()
    spread = u - arb(u.mid()), v - arb(v.mid()), e - arb(e.mid())
    lam = parameter(star + e.mid(), 2, spread)
    before = Bounce(ARC, parameter(-theta1 + u.mid(), 0, spread))
    here = Bounce(component, parameter(corner_parameters()[component] + v.mid(), 1, spread))
    middle = on_arc(before, here, float(theta1.mid()), lam, spread)
    return [
        (_mirrored(middle.at, theta1), beyond(landing, False))
        for landing in after_corner(here, middle, False, lam, spread)
    ]


def _mirrored(at: Quantity, theta1: arb) -> Quantity:
    return Quantity(theta1 - at.centre, tuple(-s for s in at.slopes), theta1 - at.whole)


START = -0.5, -1.7  # near the lowest point of the attractor, in units of e
ROOM = 0.03  # what a polygon has to spare, in units of e
FIRST, LONGEST, SHORTEST = 1e-3, 2e-3, 1e-5  # steps of e
TRIES = 4


@dataclass(frozen=True)
class Step:
    """What is proved for `e[0] < lam - lambda-star <= e[1]`.

    `cycle` holds all fixed points `(u, v)` of half the return in the region that lie on the arc or at the corner; there
    is one where all of `cycle` lies in the interior of the region and has `v < 0` (Brouwer).
    """

    e: tuple[float, float]
    region: Polygon
    expansion: Expansion
    cycle: Row

    @property
    def saddle(self) -> bool | None:
        """Is it proved that half the return has a fixed point on the arc? The cone makes it unstable."""
        return True if holds(self.region, self.cycle) and self.cycle[1] < 0 else None


@dataclass(frozen=True)
class TrappingRegion:
    """`reached`: how far from `lambda-star` the proof came; `proved`: as far as it was asked to."""

    proved: bool | None
    reached: float
    steps: tuple[Step, ...]

    @property
    def exponent(self) -> tuple[float, float]:
        """Bounds of the largest exponent per bounce of every orbit in the region, over all steps."""
        least = min(float(step.expansion.least.lower()) for step in self.steps)
        most = max(float(step.expansion.most.upper()) for step in self.steps)
        return math.log(least) / 2, math.log(most) / 2


def trapping_region(last: float, budget: int = 200, tick: Tick = silent) -> TrappingRegion:
    """The proof for `lambda-star < lam <= last`; `proved` is None when the budget of steps ends first.

    >>> trapping_region(0.0725).proved, trapping_region(0.0725, budget=1).proved
    (True, None)
    """
    steps: list[Step] = []
    with working(BITS):
        star = enclosed()[1]
        end = float((last - star).upper()) * (1 + 2.0**-40)
        near, reached, length = limit(), 0.0, FIRST
        for _ in range(budget):
            e = reached, min(reached + length, end)
            found = step(near, e)
            if found is None:
                length /= 2
                if length < SHORTEST:
                    break
                continue
            near, made = found
            steps.append(made)
            tick((e[1] - reached) / end)
            reached, length = e[1], min(length * 1.3, LONGEST)
            if reached >= end:
                return TrappingRegion(True, reached, tuple(steps))
    return TrappingRegion(None, reached, tuple(steps))


def step(near: Pieces, e: tuple[float, float]) -> tuple[Pieces, Step] | None:
    """The family for a stretch of `e` and what it proves; `near` is one that resembles it, for a first region."""
    region = grown(near, START, ROOM)
    for _ in range(TRIES):
        if region is None:
            return None
        try:
            family = pieces(region, e)
        except ArithmeticError:
            return None
        cone = expansion(family)
        if cone is None or not cone.least > 1:
            return None
        if trapped(family, region):
            return family, Step(e, region, cone, fixed_point(family[ARC]))
        region = grown(family, START, ROOM)
    return None
