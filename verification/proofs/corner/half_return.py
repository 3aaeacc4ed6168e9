"""The half return of the cuspless cardioid near its corner orbit, as affine maps with balls for entries.

A particle that comes from the arc at `-theta1 + e*u` and meets the boundary the distance `e*v` beyond the upper corner
flies to the arc again and then to the lower corner; the mirror image of its arrival is `(u1, v1)`. Here `e = lam -
lambda-star > 0`. Let `H(U, V, e)` be this map between positions that are not divided by `e`, so that `(u1, v1) = H(e*u,
e*v, e)/e`. By the mean value theorem on the segment from a base point on `v = 0`, which stays on one side of the
corner,

    (u1, v1) = A ((u, v) - base) + H(e*base, 0, e)/e,    A in the hull of dH/d(U, V) at (e*u, e*v, e),

over `(u, v)` in that side of a convex region and `e` in the given interval: one hull for `v < 0` (the bounce is on the
arc) and one for `v > 0` (on the wall). So the map itself, not only its linear part, lies in this family of piecewise
affine maps. The boxes are products of a box of `(u, v)` and its own ball of `e`: the multiples of a region by smaller
`e` lie in the multiple by the largest `e` only when the region is star-shaped about the origin, and these regions are
not.

A landing at the lower corner needs no second case: tangent and speed of the parameter agree there, so `H` is
continuously differentiable across it. On `v = 0` the bounce is at the corner for every `e`, so `H(e*base, 0, e)` does
not depend on the side. It is 0 at `e = 0`; so divided by `e` it is a mean of `base*dH/dU + dH/de` at `(f*base, 0, f)`
over all `f` from 0 to `e`, not only over the interval of `e`.

So a chaotic attractor is proved for every contraction above `lambda-star`. For `lambda-star < lam <= lambda-star + e`
the half return maps a convex polygon around the corner orbit, of a size proportional to `lam - lambda-star`, into its
interior. It maps a cone of directions into itself and stretches it by a factor above 1. So in the region no cycle is
stable, and every orbit has a positive exponent. The proof concerns the map itself, in steps of `e`; that the attractor
is connected is not proved. Paper: section 5.2. The two ideas are those of [GlendinningSimpson2021] for the piecewise
linear map.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property

from flint import arb

from verification.arithmetic.balls import cuts, halves, joined, working
from verification.arithmetic.iteration import Tick, silent
from verification.proofs.corner.border_collision import (
    AffinePiece,
    ConeExpansion,
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
    BoundaryPoint,
    Quantity,
    after_corner,
    beyond,
    corner_parameters,
    enclosed,
    on_arc,
    parameter,
)
from verification.rigorous.theorem import Theorem, hypothesis

LONGEST_U, LONGEST_V, LONGEST_E, TINY = 1e-2, 2e-3, 5e-4, 1e-9  # the longest sides of boxes
DEEPEST = 6  # the most halvings of a box whose image is not enclosed
Image = tuple[Quantity, Quantity]


def limit() -> Pieces:
    """The enclosed piecewise linear map at `lambda-star` itself, by component.

    >>> limit()[WALL].trace.str(6, radius=False), limit()[ARC].trace.str(6, radius=False)
    ('1.17184', '-2.15438')
    """
    return pieces([(0.0, 0.0)], (0.0, 0.0))


def pieces(region: Polygon, e: tuple[float, float]) -> Pieces:
    """The affine maps, by component, that hold the half return over a region for `e[0] <= lam - lambda-star <= e[1]`.

    `ValueError` unless the convex region meets `v = 0` and the range begins at 0 or above.
    """
    if not 0 <= e[0] <= e[1]:
        raise ValueError(f"half return: e = {e} is no range of distances above lambda-star; accepted: 0 <= LOW <= HIGH")
    on_border = [u for u, _ in clipped(region, 0.0, 0.0)]
    if not on_border:
        raise ValueError("half return: the region must meet v = 0, the mean value theorem's base point")
    with working(BITS):
        base = (min(on_border) + max(on_border)) / 2
        shift = _shift(base, cuts(0.0, e[1], LONGEST_E))
        found = {}
        for component in (ARC, WALL):
            boxes = (box for time in cuts(*e, LONGEST_E) for box in _boxes(region, component, time))
            images = [image for box in boxes for image in followed(component, *box)]
            hull = [joined([image[k].slopes[i] for image in images]) for k in (0, 1) for i in (0, 1)]
            found[component] = AffinePiece(((hull[0], hull[1]), (hull[2], hull[3])), shift, (arb(base), arb(0)))
        return found


def _boxes(region: Polygon, component: int, e: arb) -> list[tuple[arb, arb, arb]]:
    """Boxes of `(U, V, e)` that hold `(f*u, f*v, f)` for `f` in the ball `e` and `(u, v)` on one side of the region."""
    heights, longest = [v for _, v in region], float(e.upper()) + TINY
    low, high = (min(*heights, 0.0), 0.0) if component == ARC else (0.0, max(*heights, 0.0))
    found = []
    for v in cuts(low, high, LONGEST_V / longest):
        width = [u for u, _ in clipped(region, float(v.lower()), float(v.upper()))]
        found += [(u * e, v * e, e) for u in cuts(min(width), max(width), LONGEST_U / longest)]
    return found


def _shift(base: float, times: list[arb]) -> Row:
    """Enclosure of `H(e*base, 0, e)/e` for `e` in the last of the balls `times`, which cover the range from 0."""
    images = [image for e in times for image in followed(ARC, base * e, arb(0), e)]
    first, second = (joined([base * image[k].slopes[0] + image[k].slopes[2] for image in images]) for k in (0, 1))
    return first, second


def followed(component: int, u: arb, v: arb, e: arb, depth: int = 0) -> list[Image]:
    """The half return of a box of unscaled `(u, v, e)`; the box is halved as long as its image is not enclosed."""
    try:
        return _images(component, u, v, e)
    except ArithmeticError:
        if depth == DEEPEST:
            raise
    if v.rad() > e.rad():
        return [image for half in halves(v) for image in followed(component, u, half, e, depth + 1)]
    return [image for half in halves(e) for image in followed(component, u, v, half, depth + 1)]


def _images(component: int, u: arb, v: arb, e: arb) -> list[Image]:
    """The half return of an unscaled box `(u, v, e)`; two images where the landing may be on either component."""
    theta1, star = enclosed()
    spread = u - arb(u.mid()), v - arb(v.mid()), e - arb(e.mid())
    lam = parameter(star + e.mid(), 2, spread)
    before = BoundaryPoint(ARC, parameter(-theta1 + u.mid(), 0, spread))
    here = BoundaryPoint(component, parameter(corner_parameters()[component] + v.mid(), 1, spread))
    middle = on_arc(before, here, float(theta1.mid()), lam, spread)
    return [
        (_mirrored(middle.at, theta1), beyond(landing, False))
        for landing in after_corner(here, middle, False, lam, spread)
    ]


def _mirrored(at: Quantity, theta1: arb) -> Quantity:
    return Quantity(theta1 - at.centre, tuple(-s for s in at.slopes), theta1 - at.whole)


START = -0.5, -1.7  # near the lowest point of the attractor, in units of e
ROOM = 0.03  # the distance of the image from a polygon's sides, in units of e
FIRST, LONGEST, SHORTEST = 1e-3, 2e-3, 1e-5  # the first, longest and shortest step of e
TRIES = 4


@dataclass(frozen=True)
class ProvedRange:
    """One step of the proof: the trapping region and the cone for `e[0] < lam - lambda-star <= e[1]`.

    `cycle` holds all fixed points `(u, v)` of the half return in the region with `v <= 0`. There is a fixed point if
    `cycle` lies in the interior of the region with `v < 0` (Brouwer).
    """

    e: tuple[float, float]
    region: Polygon
    expansion: ConeExpansion
    cycle: Row

    @property
    def saddle(self) -> bool | None:
        """True if the half return is proved to have a fixed point on the arc (a saddle, by the cone); else None."""
        return True if holds(self.region, self.cycle) and self.cycle[1] < 0 else None


@dataclass(frozen=True)
class ChaosAboveLambdaStar(Theorem):
    """For `lambda-star < lam <= last` a polygon around the corner orbit is trapping, and all orbits in it have positive
    exponents.

    It is proved in at most `budget` steps of `e = lam - lambda-star`.

    >>> ChaosAboveLambdaStar(0.0725).proved, ChaosAboveLambdaStar(0.0725, budget=1).proved
    (True, False)
    """

    last: float
    budget: int = 200
    tick: Tick = field(default=silent, repr=False, compare=False)

    @cached_property
    def end(self) -> float:
        """The distance from `lambda-star` to `last`, rounded up."""
        with working(BITS):
            return float((self.last - enclosed()[1]).upper()) * (1 + 2.0**-40)

    @cached_property
    def steps(self) -> tuple[ProvedRange, ...]:
        """The steps of the proof; they cover `e` from 0 to `end`, or as far as the proof succeeds."""
        made: list[ProvedRange] = []
        with working(BITS):
            near, reached, length = limit(), 0.0, FIRST
            for _ in range(self.budget):
                e = reached, min(reached + length, self.end)
                found = step(near, e)
                if found is None:
                    length /= 2
                    if length < SHORTEST:
                        break
                    continue
                near, here = found
                made.append(here)
                self.tick((e[1] - reached) / self.end)
                reached, length = e[1], min(length * 1.3, LONGEST)
                if reached >= self.end:
                    break
        return tuple(made)

    @hypothesis
    def trapped(self) -> bool:
        """Steps reach `last`; each proves that the polygon is trapping and that a cone is invariant and stretched."""
        return bool(self.steps) and self.steps[-1].e[1] >= self.end

    @property
    def exponent(self) -> tuple[float, float]:
        """Bounds of the largest exponent per bounce of every orbit in the region, over all steps."""
        least = min(float(step.expansion.least.lower()) for step in self.steps)
        most = max(float(step.expansion.most.upper()) for step in self.steps)
        return math.log(least) / 2, math.log(most) / 2


def step(near: Pieces, e: tuple[float, float]) -> tuple[Pieces, ProvedRange] | None:
    """The affine maps for a range of `e`, and the step that they prove; None if no proof is found.

    `near` has the affine maps for a similar range, from which a first region is grown.
    """
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
            return family, ProvedRange(e, region, cone, fixed_point(family[ARC]))
        region = grown(family, START, ROOM)
    return None
