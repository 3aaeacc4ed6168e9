"""Bounces of the cuspless cardioid that depend on a few parameters: enclosed, with their derivatives.

A box of parameters is followed as a centre and the derivatives over the box (the mean value form), so
that bounce after bounce keeps what ties it to the parameters. A plain ball would forget it and swell.
Positions near a corner are told as the distance beyond it, `beyond`: on the arc negative, and there
the arc's parameter differs from arc length by its square only; on the wall positive and arc length.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from flint import arb

from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import cuspless
from verification.arithmetic.balls import balls, working
from verification.proofs.corner import corner
from verification.proofs.corner.corner import ARC, WALL

BITS = 64
Spread = tuple[arb, ...]  # the box of the parameters, around 0
Angle = Callable[[arb, arb], tuple[arb, arb, arb]]


@dataclass(frozen=True)
class Quantity:
    """A number at the centre of the box, its derivatives by the parameters over the box, and all its values."""

    centre: arb
    slopes: Spread
    whole: arb


@dataclass(frozen=True)
class Bounce:
    """A parameter of a component of the boundary."""

    component: int
    at: Quantity


def parameter(value: arb, index: int, spread: Spread) -> Quantity:
    """`value` plus the parameter of this index."""
    slopes = tuple(arb(1 if i == index else 0) for i in range(len(spread)))
    return Quantity(value, slopes, value + spread[index])


def constant(value: arb, spread: Spread) -> Quantity:
    """A number that depends on no parameter."""
    return Quantity(value, (arb(0),) * len(spread), value)


@cache
def _angles() -> dict[tuple[int, int], Angle]:
    pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
    return {pair: load(chord_kernel(cuspless, *pair, 1), balls(BITS)) for pair in pairs}


@cache
def corners() -> tuple[arb, arb]:
    """The parameters of the upper corner, on the arc and on the wall; those of the lower have the other sign."""
    with working(BITS):
        return corner.corners(balls(BITS))


def angle(here: Bounce, there: Bounce) -> tuple[arb, arb, arb]:
    """The angle of the chord from `here` to `there` and its derivatives by the two ends, over the box."""
    return _angles()[here.component, there.component](here.at.whole, there.at.whole)


def following(previous: Bounce, here: Bounce, component: int, near: float, lam: Quantity, spread: Spread) -> Bounce:
    """The bounce after `here` on a component, `near` it; `ArithmeticError` when it is not enclosed.

    The equation is the collision rule at `here`; a part of the boundary counts as prolonged beyond its ends.

    >>> with working(BITS):
    ...     (right, left), lam = (Bounce(c, constant(arb(0), ())) for c in (ARC, WALL)), constant(arb(0), ())
    ...     abs(following(left, right, WALL, 0.1, lam, ()).at.whole) < 1e-12
    True
    """
    back, forth = _angles()[here.component, previous.component], _angles()[here.component, component]
    eta = back(here.at.centre, previous.at.centre)[0]
    middle = _polished(lambda x: forth(here.at.centre, x), -lam.centre * eta, near)
    centre = _root(lambda x: forth(here.at.centre, x), -lam.centre * eta, middle, 1e-14)
    into = back(here.at.whole, previous.at.whole)
    room = here.at.whole.rad() + previous.at.whole.rad() + lam.whole.rad()
    whole = _root(lambda x: forth(here.at.whole, x), -lam.whole * into[0], middle, 3 * float(room) + 1e-13)
    slopes: Spread = ()
    for _ in range(2):  # the second time on the smaller ball that the first one gives
        out = forth(here.at.whole, whole)
        by = -lam.whole * into[2] / out[2], -(out[1] + lam.whole * into[1]) / out[2], -into[0] / out[2]
        slopes = tuple(
            by[0] * p + by[1] * h + by[2] * m
            for p, h, m in zip(previous.at.slopes, here.at.slopes, lam.slopes, strict=True)
        )
        whole = whole.intersection(sum((s * d for s, d in zip(slopes, spread, strict=True)), centre))
    return Bounce(component, Quantity(centre, slopes, whole))


def on_arc(previous: Bounce, here: Bounce, near: float, lam: Quantity, spread: Spread) -> Bounce:
    """The bounce after `here` on the arc, proved to lie between its ends: on a convex table it is the landing."""
    found = following(previous, here, ARC, near, lam, spread)
    if not abs(found.at.whole) < corners()[ARC]:
        raise ArithmeticError("a landing on the arc is not enclosed")
    return found


def beyond(bounce: Bounce, upper: bool) -> Quantity:
    """How far beyond the upper corner a bounce lies, or beyond the lower one in the mirror image."""
    sign, at = 1 if upper else -1, bounce.at
    edge = corners()[bounce.component]
    return Quantity(sign * at.centre - edge, tuple(sign * s for s in at.slopes), sign * at.whole - edge)


def at_corner(previous: Bounce, here: Bounce, upper: bool, lam: Quantity, spread: Spread) -> list[Bounce]:
    """The bounce after `here`, near a corner: on one part of the boundary, or on either.

    The table is convex, so a zero of the collision rule that is proved to lie on a true part of the
    boundary is the landing. When the ball of the arc's zero holds the corner, the angle is monotone there,
    and so it is along the whole line of the wall; at the corner both have one value. So the landing is the
    arc's zero when that of the wall lies before the wall, and one of the two when it may lie on the wall.
    """
    sign, found, places = 1 if upper else -1, {}, {}
    for component in (ARC, WALL):
        near = sign * float(corners()[component].mid())
        try:
            found[component] = following(previous, here, component, near, lam, spread)
        except ArithmeticError:
            continue
        places[component] = beyond(found[component], upper).whole
    arc, wall = corners()
    if ARC in found and -2 * arc < places[ARC] < 0:
        return [found[ARC]]
    if WALL in found and 0 < places[WALL] < -2 * wall:
        return [found[WALL]]
    if len(found) == 2 and places[ARC].contains(0):
        if places[WALL] < 0:
            return [found[ARC]]
        if places[WALL].contains(0):
            return list(found.values())
    raise ArithmeticError("a landing near a corner is not enclosed")


def _polished(rule: Callable[[arb], tuple[arb, arb, arb]], value: arb, near: float) -> float:
    for _ in range(8):
        found = rule(arb(near))
        step = float(((found[0] - value) / found[2]).mid())
        near -= step
        if not abs(step) > 1e-13:
            break
    return near


def _root(rule: Callable[[arb], tuple[arb, arb, arb]], value: arb, near: float, radius: float) -> arb:
    """Where the rule takes the value, by an interval Newton step: one place for each pair of rule and value."""
    for _ in range(10):
        box = arb(near, radius)
        image: arb = near - (rule(arb(near))[0] - value) / rule(box)[2]
        if image.is_finite() and box.contains_interior(image):
            return image
        radius *= 2
    raise ArithmeticError("a landing is not enclosed")
