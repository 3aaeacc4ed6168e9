"""The place of the fourth collision in the cuspless cardioid, for all exit angles and contractions in given ranges.

A particle leaves the upper corner at an angle near 0. The paper's plot shows that up to `lambda-star` its fourth
collision lies beyond the corner, on the wall (`s_4 > s*`). This is proved by bisecting the ranges into boxes of angle
and contraction; each box is followed in balls until its image lies strictly inside the wall.

A particle that leaves the upper corner towards `theta1` on the arc has its second bounce near the lower corner, and its
fourth at the distance `s4` beyond the upper one (on the wall when `s4 > 0`, the paper's `s_4 > s*`). Where the second
bounce passes the corner, `s4` has a kink. A proof on boxes shows that `s4` falls with `theta1` while the second bounce
is on the wall and grows when it is on the arc, so that the kink is the minimum, and that the minimum falls with `lam`.
The minimum is 0 at `lambda-star` by the corner orbit, so it has the sign of `lambda-star - lam`. Paper: section 5.2.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

from flint import arb

from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel, ends_kernel
from symbolic.tables import cuspless
from verification.arithmetic.balls import FLOAT64, Box, balls, bisected, cuts, halves, joined, working
from verification.arithmetic.iteration import Stop, Tick, Vector, iterated, silent
from verification.cycles.problem import mirrored
from verification.proofs.corner.corner import (
    ARC,
    BITS,
    WALL,
    BoundaryPoint,
    Quantity,
    after_corner,
    angle,
    beyond,
    constant,
    corner_parameters,
    enclosed,
    on_arc,
    parameter,
)
from verification.proofs.periodic.interval_newton import near_guess
from verification.rigorous.exclusion import Search, bisect

Angle = Callable[..., Any]
Angles = dict[tuple[int, int], Angle]
TURN = 6.283185307179586


@dataclass(frozen=True)
class Departures:
    """A set of phase points: interval on a component, exit angles, and the slap map's slope along the orbit so far."""

    component: int
    theta: arb
    slope: arb
    phi: arb


@cache
def _loaded() -> tuple[Angles, Angles, Angles, dict[int, arb]]:
    pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
    kernels = {pair: chord_kernel(cuspless, *pair, 1) for pair in pairs}
    enclosing = {pair: load(made, balls(BITS)) for pair, made in kernels.items()}
    guessing = {pair: load(made, FLOAT64) for pair, made in kernels.items()}
    alone = {pair: load(chord_kernel(cuspless, *pair, 0), balls(BITS)) for pair in pairs}  # without slopes
    with working(BITS):
        values = load(ends_kernel(cuspless), balls(BITS))()
        ends = {component: values[2 * component + 1] + arb(0) for component in (ARC, WALL)}
    return enclosing, alone, guessing, ends


class CusplessMap:
    """The map of the cuspless cardioid on sets of phase points, for all contractions in the ball `lam`."""

    def __init__(self, lam: arb | int = 0) -> None:
        self.lam = lam
        self.balls, self.values, self.floats, self.ends = _loaded()

    @property
    def odd(self) -> bool:
        """True if the table is proved symmetric under `theta -> -theta`, so that the slap map is odd."""
        return all(mirrored(part) for part in cuspless.components)

    def iterated(self, pieces: list[Departures], n: int) -> list[Departures] | None:
        """The images of pieces under `n` flights; None if an image could not be enclosed."""
        for _ in range(n):
            following: list[Departures] = []
            for piece in pieces:
                landed = self.landing(piece)
                if landed is None:
                    return None
                following += landed
            pieces = following
        return pieces

    def landing(self, piece: Departures) -> list[Departures] | None:
        """The image of a piece: one piece, or up to three where it may straddle the corners; None if it cannot be
        enclosed.

        The table is convex, so a root of the chord angle that is proved to lie on the boundary is the landing. The
        component is guessed in float64: the wall when the ray passes between the corners. When the root there may lie
        beyond a corner, the point where the ray meets the line of the wall says which components are possible: the
        upper arc unless that point is below the upper corner, and the lower arc unless it is above the lower corner.
        Each of them must be enclosed.
        """
        if piece.component == WALL:
            landed = self._root(piece, ARC, -1.05, 1.05)
            return [landed] if landed and abs(landed.theta) < self.ends[ARC] else None
        start, edge = float(piece.theta.mid()), float(self.ends[ARC])
        roots = {
            "upper": lambda: self._root(piece, ARC, start, edge + 0.2),
            "wall": lambda: self._root(piece, WALL, -0.6, 0.6),
            "lower": lambda: self._root(piece, ARC, TURN - edge - 0.2, start + TURN),
        }
        guess = self._guess(start, float(piece.phi.mid()), edge)
        first = roots[guess]()
        if first is None:
            return None
        if abs(first.theta) < self.ends[first.component]:
            return [first]
        roots[guess] = lambda: first
        wall = roots["wall"]()
        if wall is None:
            return None
        found: list[Departures | None] = [wall]
        if not wall.theta > -self.ends[WALL]:  # the wall's parameter grows downwards
            found.append(roots["upper"]())
        if not wall.theta < self.ends[WALL]:
            found.append(roots["lower"]())
        return _all(*found)

    def _guess(self, start: float, phi: float, edge: float) -> str:
        near = self.floats[ARC, ARC]
        if start > edge - 1e-6 or (start > -edge + 1e-6 and near(start, -edge)[0] > phi):
            return "lower"
        return "upper" if start < -edge + 1e-6 or near(start, edge)[0] < phi else "wall"

    def _root(self, piece: Departures, target: int, low: float, high: float) -> Departures | None:
        """The landing on a component, enclosed by an interval Newton step from a guess in float64; None if it fails.

        The residual of the guess is evaluated at the middle of the piece and extended by the mean value theorem, which
        needs a twentieth of the pieces that a direct evaluation needs.
        """
        pair = piece.component, target
        angle, value, near = self.balls[pair], self.values[pair], self.floats[pair]
        root = _falling_root(near, float(piece.theta.mid()), float(piece.phi.mid()), low, high)
        guess = root - (TURN if high > TURN / 2 else 0)
        radius = 4 * float(piece.theta.rad() + piece.phi.rad()) + 1e-12
        middle = arb(piece.theta.mid())
        turned = angle(piece.theta, arb(guess))[1] * (piece.theta - middle)
        missed = value(middle, arb(guess))[0] + turned - piece.phi
        image = near_guess(guess, missed, lambda box: angle(piece.theta, box)[2], radius, 6)
        if image is None:
            return None
        over = angle(piece.theta, image)
        phi_1 = -self.lam * self.values[target, piece.component](image, piece.theta)[0] + arb(0)
        return Departures(target, image, -piece.slope * over[1] / over[2], phi_1)


SETTLED, HALVED = 1e-8, 1e-15  # the last correction of Newton's method (the next is about its square), and of bisection


def _falling_root(near: Angle, start: float, phi: float, low: float, high: float) -> float:
    """The position where the chord angle, which falls along the boundary, is `phi`, by Newton steps or bisection."""
    here = (low + high) / 2
    for _ in range(60):
        value, _, slope = near(start, here)
        low, high = (here, high) if value > phi else (low, here)
        following, enough = here - (value - phi) / slope if slope else low, SETTLED
        if not low < following < high:  # also where it is NaN
            following, enough = (low + high) / 2, HALVED
        if abs(following - here) <= enough:
            return following
        here = following
    return here


def _all(*pieces: Departures | None) -> list[Departures] | None:
    found = [p for p in pieces if p is not None]
    return found if len(found) == len(pieces) else None


ROUNDING = 2.0**-50  # by which neighbouring boxes overlap
SMALLEST = 2.0**-40


def fourth_on_wall(
    angle: float,
    lowest: float,
    highest: float,
    budget: int = 50_000,
    or_lower: bool = False,
    tick: Tick = silent,
) -> Search:
    """The search for a proof that the fourth collision is on the wall if `|phi| <= angle`, `lowest <= lam <= highest`.

    With `or_lower` it may also be on the lower half of the arc; `s_4 > s*` on both.

    >>> fourth_on_wall(0.01, 0.0, 0.03).proved
    True
    """

    def lands(box: Box) -> bool:
        (phi, wide), (lam, half) = box
        return _lands_inside(arb(phi, wide + ROUNDING), arb(lam, half + ROUNDING), or_lower)

    whole = (0.0, angle), ((lowest + highest) / 2, (highest - lowest) / 2)
    with working(BITS):
        return bisect(whole, lands, budget, SMALLEST, tick, lambda box: bisected(box, int(box[0][1] <= box[1][1])))


def _lands_inside(phi: arb, lam: arb, or_lower: bool) -> bool:
    flights = CusplessMap(lam)
    images = flights.iterated([Departures(ARC, flights.ends[ARC], arb(1), phi)], 4)
    if images is None:
        return False
    edge = flights.ends[WALL]
    if or_lower:
        return all(bool(p.theta > -edge) if p.component == WALL else bool(p.theta < 0) for p in images)
    return all(p.component == WALL and bool(abs(p.theta) < edge) for p in images)


LONGEST_THETA, LONGEST_LAM = 2e-3, 5e-4  # the longest sides of boxes
MARGIN = 1e-6  # relative, around the greatest exit angle


@dataclass(frozen=True)
class Course:
    """The components and positions of one possible orbit over a box: `component` is that of the second bounce.

    `second` is the distance of the second bounce beyond the lower corner, and `fourth` the distance of the fourth
    bounce beyond the upper corner.
    """

    component: int
    second: Quantity
    fourth: Quantity


def courses(theta1: arb, lam: arb) -> list[Course]:
    """The possible courses of orbits with `theta1` and `lam` in balls; derivatives are with respect to these two."""
    spread = theta1 - arb(theta1.mid()), lam - arb(lam.mid())
    contraction = parameter(arb(lam.mid()), 1, spread)
    start = BoundaryPoint(ARC, constant(corner_parameters()[ARC], spread))
    first = BoundaryPoint(ARC, parameter(arb(theta1.mid()), 0, spread))
    found = []
    for second in after_corner(start, first, False, contraction, spread):
        third = on_arc(first, second, -float(enclosed()[0].mid()), contraction, spread)
        for fourth in after_corner(second, third, True, contraction, spread):
            found.append(Course(second.component, beyond(second, False), beyond(fourth, True)))
    return found


def minimum_at_kink(most: float, lowest: float, highest: float, tick: Tick = silent) -> bool | None:
    """True if, for `|phi| <= most` and all contractions in the range, the only kink of `s4` is its minimum; else None.

    Once `s4` is proved monotone on both sides, it remains to show that the second bounce is on the wall at one end of
    the range and on the arc at the other; this is shown at angles just within `most`.

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
    """Landing `theta1` of a particle that leaves the upper corner at the exit angle `phi`, by bisection in floats."""
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
    """True if the second bounce moves from wall to arc as `theta1` grows, and `s4` falls (wall) or grows (arc)."""
    slope = course.fourth.slopes[0]
    return bool(course.second.slopes[0] < 0 and (slope < 0 if course.component == WALL else slope > 0))


def exit_angle(theta1: arb) -> arb:
    """The exit angle at the upper corner of a particle that flies to `theta1`; this angle falls as `theta1` grows."""
    return angle(BoundaryPoint(ARC, constant(corner_parameters()[ARC], ())), BoundaryPoint(ARC, constant(theta1, ())))[
        0
    ]


@dataclass(frozen=True)
class Kink:
    """The kink of `s4` over a range of contractions: `theta1`, the `value` of `s4`, and its derivative by `lam`."""

    lam: arb
    theta1: arb
    value: arb
    speed: arb


def kink(lam: arb) -> Kink:
    """The kink of `s4` for every contraction in a ball; `ArithmeticError` if it cannot be enclosed."""
    with working(BITS):
        near = _near(arb(lam.mid()))
        radius = 0.6 * float(lam.rad()) + 1e-9  # the kink moves half as fast as lam
        box = arb(near, radius)
        sides = [courses(arb(end), lam) for end in (near - radius, near + radius)]
        if not (all(c.second.whole > 0 for c in sides[0]) and all(c.second.whole < 0 for c in sides[1])):
            raise ArithmeticError(f"the kink of s4 is not enclosed for lam in {lam}; give a narrower range of lam")
        found = courses(box, lam)
        speeds = [c.fourth.slopes[1] - c.fourth.slopes[0] * c.second.slopes[1] / c.second.slopes[0] for c in found]
        middle = courses(arb(near), arb(lam.mid()))
        steepest = max(abs(c.fourth.slopes[0] / c.second.slopes[0]).upper() for c in found)
        missed = max(abs(c.second.whole).upper() for c in middle)  # the distance from the corner due to rounding
        room = arb(0, 1) * (steepest * missed)
        value, speed = joined([c.fourth.whole for c in middle]) + room, joined(speeds)
        return Kink(lam, box, value + speed * (lam - arb(lam.mid())), speed)


def _near(lam: arb) -> float:
    def correction(x: Vector) -> list[float]:
        (course, *_) = courses(arb(x[0]), lam)
        return [float((course.second.centre / course.second.slopes[0]).mid())]

    return float(iterated(correction, [float(enclosed()[0].mid())], Stop(steps=8)).x[0])


def kink_falls(lowest: float, highest: float) -> bool | None:
    """True if `s4` at the kink is 0 at `lambda-star` and falls with `lam` over the whole range; else None.

    On each box the second bounce passes the corner once; neighbouring boxes have a kink in common.

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
