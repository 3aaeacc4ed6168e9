"""The fourth collision near `lambda-star`: its least position is at a kink, and crosses the corner there.

A ball leaves the upper corner of the cuspless cardioid towards `theta1` on the arc; its second bounce
is near the lower corner, its fourth the distance `s4` beyond the upper one (on the wall when positive:
the paper's `s_4 > s*`). Where the second bounce passes the corner, `s4` has a kink. Proved on boxes: `s4`
falls with `theta1` while the second bounce is on the wall and grows when it is on the arc, so that its
minimum is the kink; and the value there falls with `lam`. It is 0 at `lambda-star`, by the corner orbit.
So the minimum has the sign of `lambda-star - lam`. Paper: section 5.2.
"""

from dataclasses import dataclass
from itertools import pairwise

from flint import arb

from verification.arithmetic.balls import cuts, halves, joined
from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.words import working
from verification.proofs.corner.corner import ARC, WALL, enclosed
from verification.proofs.corner.mean_value import (
    BITS,
    Bounce,
    Quantity,
    angle,
    at_corner,
    beyond,
    constant,
    corners,
    on_arc,
    parameter,
)

LONGEST_THETA, LONGEST_LAM = 2e-3, 5e-4  # sides of boxes
MARGIN = 1e-6  # of the angles at the ends


@dataclass(frozen=True)
class Course:
    """One course of the orbit over a box: the part that the second bounce is on, and two distances beyond a corner."""

    component: int
    second: Quantity
    fourth: Quantity


def courses(theta1: arb, lam: arb) -> list[Course]:
    """What a box of first bounces and contractions does; the derivatives are by these two."""
    spread = theta1 - arb(theta1.mid()), lam - arb(lam.mid())
    contraction = parameter(arb(lam.mid()), 1, spread)
    start = Bounce(ARC, constant(corners()[ARC], spread))
    first = Bounce(ARC, parameter(arb(theta1.mid()), 0, spread))
    found = []
    for second in at_corner(start, first, False, contraction, spread):
        third = on_arc(first, second, -float(enclosed()[0].mid()), contraction, spread)
        for fourth in at_corner(second, third, True, contraction, spread):
            found.append(Course(second.component, beyond(second, False), beyond(fourth, True)))
    return found


def minimum_at_kink(most: float, lowest: float, highest: float, tick: Tick = silent) -> bool | None:
    """For all `|phi| <= most` and contractions of the range: has `s4` one kink, and its minimum there?

    Once all boxes turn as they should, the second bounce need only be on the wall at the one end and on the arc
    at the other: at angles just within `most`, so that the kink is between.

    >>> minimum_at_kink(0.03, 0.0712, 0.0713)
    True
    """
    with working(BITS):
        left, right = (_towards(phi * (1 + MARGIN)) for phi in (most, -most))
        inner = [_towards(phi * (1 - MARGIN)) for phi in (most, -most)]
        if not (exit_angle(arb(left)) > most > abs(exit_angle(arb(inner[0])))):
            return None
        if not (exit_angle(arb(right)) < -most < -abs(exit_angle(arb(inner[1])))):
            return None
        strips, lams = cuts(left, right, LONGEST_THETA), cuts(lowest, highest, LONGEST_LAM)
        try:
            for strip in strips:
                if not all(_turns(course) for lam in lams for course in _followed(strip, lam)):
                    return None
                tick(1 / len(strips))
            ends = [{c.component for lam in lams for c in courses(arb(end), lam)} for end in inner]
        except ArithmeticError:
            return None
    return True if ends == [{WALL}, {ARC}] else None


def _towards(phi: float) -> float:
    """About where a ball lands that leaves the upper corner at this exit angle, by halving."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if exit_angle(arb(middle)) > phi else (low, middle)
    return (low + high) / 2


def _followed(theta1: arb, lam: arb, depth: int = 0) -> list[Course]:
    try:
        return courses(theta1, lam)
    except ArithmeticError:
        if depth == 4:
            raise
    return [course for half in halves(theta1) for course in _followed(half, lam, depth + 1)]


def _turns(course: Course) -> bool:
    """The second bounce moves from the wall to the arc as `theta1` grows; `s4` falls there and grows here."""
    slope = course.fourth.slopes[0]
    return bool(course.second.slopes[0] < 0 and (slope < 0 if course.component == WALL else slope > 0))


def exit_angle(theta1: arb) -> arb:
    """The exit angle at the upper corner of a ball that flies to `theta1`; it falls as `theta1` grows."""
    return angle(Bounce(ARC, constant(corners()[ARC], ())), Bounce(ARC, constant(theta1, ())))[0]


@dataclass(frozen=True)
class Kink:
    """Over a stretch of contractions: where the kink is, `s4` at it, and how fast that grows with `lam`."""

    lam: arb
    theta1: arb
    value: arb
    speed: arb


def kink(lam: arb) -> Kink:
    """The kink for every contraction of a ball; `ArithmeticError` when it is not enclosed."""
    with working(BITS):
        near = _near(arb(lam.mid()))
        radius = 0.6 * float(lam.rad()) + 1e-9  # it moves half as fast as lam
        box = arb(near, radius)
        sides = [courses(arb(end), lam) for end in (near - radius, near + radius)]
        if not (all(c.second.whole > 0 for c in sides[0]) and all(c.second.whole < 0 for c in sides[1])):
            raise ArithmeticError("the kink is not enclosed")
        found = courses(box, lam)
        speeds = [c.fourth.slopes[1] - c.fourth.slopes[0] * c.second.slopes[1] / c.second.slopes[0] for c in found]
        middle = courses(arb(near), arb(lam.mid()))
        steepest = max(abs(c.fourth.slopes[0] / c.second.slopes[0]).upper() for c in found)
        missed = max(abs(c.second.whole).upper() for c in middle)  # how far from the corner, by rounding
        room = arb(0, 1) * (steepest * missed)
        value, speed = joined([c.fourth.whole for c in middle]) + room, joined(speeds)
        return Kink(lam, box, value + speed * (lam - arb(lam.mid())), speed)


def _near(lam: arb) -> float:
    near = float(enclosed()[0].mid())
    for _ in range(8):
        (course, *_) = courses(arb(near), lam)
        near -= float((course.second.centre / course.second.slopes[0]).mid())
    return near


def kink_falls(lowest: float, highest: float) -> bool | None:
    """Is `s4` at the kink 0 at `lambda-star`, and does it fall with `lam` over the whole range, which holds that?

    On each box the second bounce passes the corner once, and boxes that meet have one kink in common.

    >>> kink_falls(0.071, 0.0713), kink_falls(0.072, 0.073)
    (True, None)
    """
    theta1, star = enclosed()
    try:
        with working(BITS):
            found = [kink(lam) for lam in cuts(lowest, highest, LONGEST_LAM)]
    except ArithmeticError:
        return None
    one = all(before.theta1.overlaps(after.theta1) for before, after in pairwise(found))
    starts = any(at.lam.contains(star) and at.theta1.contains(theta1) for at in found)
    return True if one and starts and all(at.speed < 0 for at in found) else None
