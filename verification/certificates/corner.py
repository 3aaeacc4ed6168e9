"""The orbit through both corners of the cuspless cardioid: what happens at `lambda-star`.

A bounce at a corner has a tangent (the joins are C1) and two curvatures, that of the arc and that of
the wall. So the collision rules hold there, but the derivative of whatever passes the lower corner
has two values. Paper: section 5.2.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb

from symbolic.chords import chord_kernel
from symbolic.codegen import kernel, load
from symbolic.collision import derivative_matrix
from symbolic.geometry import curvature
from symbolic.symbols import K0, K1, cos_eta1, cos_phi0, lam, t, theta
from symbolic.tables import cuspless
from verification.arithmetic import Arithmetic, bits_of, working
from verification.certificates.contraction import Status, contraction, exact_balls
from verification.shooting.newton import refined
from verification.shooting.small import corner, corner_parameter

NEAR = (0.2545, 0.0712)  # theta1 and lambda-star, from where Newton's method finds them
Matrix = tuple[Any, Any, Any, Any]


@dataclass(frozen=True)
class Corner:
    """One-sided derivatives at the orbit that leaves the upper corner at `phi-star`.

    `slope_wall` and `slope_arc` are `d s_4/d phi` where the second bounce is on the wall or the arc;
    `motion` is `d s_2/d phi`, positive when larger angles land on the arc. `wall` and `arc` are
    `(trace, determinant)` of the half return map, mirrored to the same corner. `descent` is the speed in
    `lam` of the value of `s_4` at the kink: negative when the touching curve then dips below `s*`.
    """

    slope_wall: arb
    slope_arc: arb
    motion: arb
    wall: tuple[arb, arb]
    arc: tuple[arb, arb]
    descent: arb

    @property
    def unstable(self) -> bool | None:
        """True when the half return has a multiplier outside the unit circle on either side."""
        both = all(abs(trace) > 1 + determinant for trace, determinant in (self.wall, self.arc))
        return True if both else None

    @property
    def minimum_at_kink(self) -> bool | None:
        """True when `s_4` falls up to `phi-star` and grows from there: it touches with a corner of its curve."""
        left, right = (self.slope_wall, self.slope_arc) if self.motion > 0 else (self.slope_arc, self.slope_wall)
        if not (self.motion > 0 or self.motion < 0):
            return None
        if left < 0 and right > 0:
            return True
        return False if left > 0 or right < 0 else None


def at_corner(arithmetic: Arithmetic, theta1: Any, contraction: Any) -> Corner:
    """The one-sided derivatives at a solution of `shooting.small.corner`."""
    edge = corner_parameter(arithmetic)
    bend = load(kernel("curvature", [theta], {"curvature": curvature(cuspless.components[0])}), arithmetic)
    middle, sharp = bend(theta1)[0], bend(edge)[0]

    def down(K: Any) -> Matrix:  # from the arc's bounce to the lower corner, on the side of curvature K
        return flight(arithmetic, theta1, -edge, middle, K, contraction)

    def up(K: Any) -> Matrix:  # from the lower corner to the mirrored bounce
        return flight(arithmetic, -edge, -theta1, K, middle, contraction)

    first = flight(arithmetic, edge, theta1, sharp, middle, contraction)  # its second column holds no K0
    last = flight(arithmetic, -theta1, edge, middle, sharp, contraction)  # its first row holds no K1
    slopes = [_product(last, _product(up(K), _product(down(K), first)))[1] for K in (0, sharp)]
    halves = []
    for K in (0, sharp):
        half = _product(down(K), flight(arithmetic, edge, theta1, K, middle, contraction))
        halves.append((-(half[0] + half[3]), half[0] * half[3] - half[1] * half[2]))  # the mirror is -1
    motion = _product(down(0), first)[1]
    descent = _descent(arithmetic, theta1, first, down(0), up(0), last, motion)
    return Corner(slopes[0], slopes[1], motion, halves[0], halves[1], descent)


def _descent(
    arithmetic: Arithmetic, theta1: Any, first: Matrix, down: Matrix, up: Matrix, last: Matrix, motion: Any
) -> Any:
    """`d s_4/d lam` along the angles that hit the lower corner: each reflection shifts `phi` by `-eta`."""
    angle, edge = load(chord_kernel(cuspless, 0, 0, 0), arithmetic), corner_parameter(arithmetic)
    eta1, eta2 = angle(theta1, edge)[0], angle(-edge, theta1)[0]  # the mirrored bounces have -eta1, -eta2
    turned = down[1] * -eta1 / motion  # with this much less of the initial angle the lower corner stays hit
    x = _times(first, (0, -turned))
    x = _times(down, (x[0], x[1] - eta1))
    x = _times(up, (0, x[1] - eta2))
    return _times(last, (x[0], x[1] + eta1))[0]


def _times(m: Matrix, x: tuple[Any, Any]) -> tuple[Any, Any]:
    return m[0] * x[0] + m[1] * x[1], m[2] * x[0] + m[3] * x[1]


def flight(arithmetic: Arithmetic, start: Any, end: Any, leaving: Any, landing: Any, contraction: Any) -> Matrix:
    """The derivative matrix of one flight between two points of the arc."""
    angle = load(chord_kernel(cuspless, 0, 0, 0), arithmetic)
    here, there = (load(_place(), arithmetic)(x) for x in (start, end))
    dx, dy = there[0] - here[0], there[1] - here[1]
    length, cos = arithmetic["sqrt"](dx * dx + dy * dy), arithmetic["cos"]
    entries: Matrix = load(_matrix(), arithmetic)(
        leaving, landing, length, cos(angle(start, end)[0]), cos(angle(end, start)[0]), contraction
    )
    return entries


def _place() -> Any:
    x, y = cuspless.components[0].point
    return kernel("place", [theta], {"x": x, "y": y})


def _matrix() -> Any:
    entries = dict(zip(("a", "b", "c", "d"), derivative_matrix(), strict=True))
    return kernel("derivative_matrix", [K0, K1, t, cos_phi0, cos_eta1, lam], entries)


def _product(m: Matrix, n: Matrix) -> Matrix:
    return (
        m[0] * n[0] + m[1] * n[2],
        m[0] * n[1] + m[1] * n[3],
        m[2] * n[0] + m[3] * n[2],
        m[2] * n[1] + m[3] * n[3],
    )


@cache
def enclosed(digits: int = 25) -> tuple[arb, arb]:
    """The orbit itself, `(theta1, lambda-star)`, proved by interval Newton.

    >>> print(enclosed()[1].str(12, radius=False))
    0.0712172452489
    """
    solution, bits = refined(corner(), NEAR, digits), bits_of(digits, 64)
    with working(bits):
        found = contraction(corner(), exact_balls(solution.z), (arb(10) ** -(digits - 3)).mid(), bits)
    if found.status is not Status.UNIQUE:
        raise ArithmeticError(f"the orbit through both corners is not proved to {digits} digits")
    theta1, contracted = found.zero
    return theta1, contracted
