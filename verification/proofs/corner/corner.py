"""The orbit through both corners of the cuspless cardioid: what happens at `lambda-star`.

A bounce at a corner has a tangent (the joins are C1) and two curvatures, that of the arc and that of
the wall. So the collision rules hold there, but the derivative of whatever passes the lower corner
has two values. Both parameters run counterclockwise, and at a corner at the speed of arc length.
Paper: section 5.2.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb
from sympy import pi, sqrt

from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import cuspless
from verification.arithmetic.balls import Arithmetic, bits_of, exact_balls, working
from verification.cycles.recurrence.critical import corner
from verification.cycles.recurrence.newton import refined
from verification.proofs.corner.border_collision import robust
from verification.proofs.corner.polygon import Piece
from verification.proofs.periodic.interval_newton import Status, interval_newton

ARC, WALL = 0, 1
NEAR = (0.2545, 0.0712)  # theta1 and lambda-star, from where Newton's method finds them
Place = tuple[int, Any]  # component and parameter


@dataclass(frozen=True)
class Corner:
    """One-sided derivatives at the orbit that leaves the upper corner at `phi-star`.

    `slope_wall` and `slope_arc` are `d s_4/d phi` where the second bounce is on the wall or the arc;
    `motion` is `d s_2/d phi`, positive when larger angles land on the arc. `wall` and `arc` are the half
    return's linear parts, mirrored to the same corner, with `d/d lam` for the shift. `descent` is the speed
    in `lam` of the value of `s_4` at the kink: negative when the touching curve then dips below `s*`.
    """

    slope_wall: arb
    slope_arc: arb
    motion: arb
    wall: Piece
    arc: Piece
    descent: arb

    @property
    def unstable(self) -> bool | None:
        """True when a side has a multiplier above 1, the other one in (0, 1), and a direction off the border.

        Then near that direction a cone of displacements on that side is mapped into itself and stretched, by the
        half return itself near its fixed point too: orbits leave. A multiplier below -1 would not show it, as
        its direction changes sides, and what is stretched on the one may shrink on the other.
        """
        sides = (self.wall, self.arc)
        leaves = any(p.determinant > 0 and p.trace > 1 + p.determinant and not p.rows[1][0].contains(0) for p in sides)
        return True if leaves else None

    @property
    def robust(self) -> bool | None:
        """Is the piecewise linear half return in the region of robust chaos, for `lam` above `lambda-star`?"""
        return robust({ARC: self.arc, WALL: self.wall})

    @property
    def minimum_at_kink(self) -> bool | None:
        """True when `s_4` falls up to `phi-star` and grows from there: it touches with a corner of its curve."""
        left, right = (self.slope_wall, self.slope_arc) if self.motion > 0 else (self.slope_arc, self.slope_wall)
        if not (self.motion > 0 or self.motion < 0):
            return None
        if left < 0 and right > 0:
            return True
        return False if left > 0 or right < 0 else None


@dataclass(frozen=True)
class Rule:
    """The collision rule at a bounce, linearised: the parameter of the next one by those before it and `lam`."""

    lower: Any
    diagonal: Any
    upper: Any
    eta: Any

    def next(self, before: Any, here: Any, lam: Any) -> Any:
        """How the next parameter moves when the two before it, and `lam`, move so."""
        return -(self.lower * before + self.diagonal * here + self.eta * lam) / self.upper


def rule(arithmetic: Arithmetic, before: Place, here: Place, after: Place, contraction: Any) -> Rule:
    """The rule at `here`."""
    back = load(chord_kernel(cuspless, here[0], before[0], 1), arithmetic)(here[1], before[1])
    forth = load(chord_kernel(cuspless, here[0], after[0], 1), arithmetic)(here[1], after[1])
    return Rule(contraction * back[2], forth[1] + contraction * back[1], forth[2], back[0])


def corners(arithmetic: Arithmetic) -> tuple[Any, Any]:
    """The parameters of the upper corner, on the arc and on the wall; those of the lower have the other sign."""
    arc, wall = load(kernel("corners", [], {"arc": 2 * pi / 3, "wall": -sqrt(3) / 4}), arithmetic)()
    return arc, wall


def at_corner(arithmetic: Arithmetic, theta1: Any, contraction: Any) -> Corner:
    """The one-sided derivatives at a solution of `shooting.small.corner`."""
    edge = corners(arithmetic)
    top, right, left = (ARC, edge[ARC]), (ARC, theta1), (ARC, -theta1)
    bottom = {component: (component, -edge[component]) for component in (ARC, WALL)}
    to_bottom = rule(arithmetic, top, right, bottom[ARC], contraction)
    to_top = rule(arithmetic, bottom[ARC], left, top, contraction)
    by_angle = load(chord_kernel(cuspless, ARC, ARC, 1), arithmetic)(edge[ARC], theta1)[2]  # d phi/d theta1
    slopes, descents, halves = [], [], []
    for component in (ARC, WALL):
        around = rule(arithmetic, right, bottom[component], left, contraction)
        moved = []
        for first, lam in ((1, 0), (0, 1)):  # by theta1, by lam
            second = to_bottom.next(0, first, lam)
            third = around.next(first, second, lam)
            moved.append((second, to_top.next(second, third, lam)))
        (motion, slope), (shift, growth) = moved
        slopes.append(slope / by_angle)
        descents.append(growth - slope * shift / motion)
        halves.append(_half(around, to_top))  # the mirror image of a corner is the other one
    return Corner(slopes[WALL], slopes[ARC], motion / by_angle, halves[WALL], halves[ARC], descents[WALL])


def _half(first: Rule, second: Rule) -> Piece:
    """Half a return as a map of two successive displacements; the mirror turns the sign of what comes in around."""
    columns = []
    for before, here, lam in ((-1, 0, 0), (0, -1, 0), (0, 0, 1)):
        third = first.next(before, here, lam)
        columns.append((third, second.next(here, third, lam)))
    by_u, by_v, by_lam = columns
    return Piece(((by_u[0], by_v[0]), (by_u[1], by_v[1])), by_lam)


@cache
def enclosed(digits: int = 25) -> tuple[arb, arb]:
    """The orbit itself, `(theta1, lambda-star)`, proved by interval Newton.

    >>> print(enclosed()[1].str(12, radius=False))
    0.0712172452489
    """
    solution, bits = refined(corner(), NEAR, digits), bits_of(digits, 64)
    with working(bits):
        found = interval_newton(corner(), exact_balls(solution.z), (arb(10) ** -(digits - 3)).mid(), bits)
    if found.status is not Status.UNIQUE:
        raise ArithmeticError(f"the orbit through both corners is not proved to {digits} digits")
    theta1, contracted = found.zero
    return theta1, contracted
