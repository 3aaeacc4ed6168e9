"""The orbit through both corners of the cuspless cardioid at `lambda-star`, and the bounces near it, enclosed.

A bounce at a corner has a tangent (the joins are C1) and two curvatures, that of the arc and that of the wall. So the
collision rules hold there, but a derivative along an orbit that passes the lower corner has two values, one for each
side. Both boundary parameters run counterclockwise, with the speed of arc length at the corners. Paper: section 5.2.

Bounces that depend on a few parameters are enclosed in mean value form: the value at the centre of a box of parameters,
and the derivatives over the box. So each bounce keeps its dependence on the parameters, which plain balls would lose,
at the price of wider enclosures. Positions near a corner are given as the distance `beyond` it: positive arc length on
the wall, and negative on the arc, where the parameter agrees with arc length to first order.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb
from sympy import pi, sqrt

from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import cuspless
from verification.arithmetic.balls import FLOAT64, Arithmetic, balls, bits_of, exact_balls, working
from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.cycles.critical import corner
from verification.cycles.newton import refined
from verification.proofs.corner.border_collision import AffinePiece, robust
from verification.proofs.periodic.interval_newton import ZeroStatus, interval_newton, near_guess

ARC, WALL = 0, 1
NEAR = (0.2545, 0.0712)  # theta1 and lambda-star: the start of Newton's method
Place = tuple[int, Any]  # component and parameter


@dataclass(frozen=True)
class Corner:
    """One-sided derivatives at the orbit that leaves the upper corner at the exit angle `phi-star`.

    `s_2` and `s_4` are the arc lengths of the second and the fourth bounce, `s*` that of the upper corner. `slope_wall`
    and `slope_arc` are `d s_4/d phi` where the second bounce is on the wall or the arc; `motion` is `d s_2/d phi`,
    positive when larger angles land on the arc. `wall` and `arc` are the linear parts of the half return, mirrored to
    the upper corner; their shift is the derivative by `lam`. `descent` is the derivative in `lam` of `s_4` at the kink:
    when it is negative, the minimum of `s_4` falls below `s*` as `lam` grows.
    """

    slope_wall: arb
    slope_arc: arb
    motion: arb
    wall: AffinePiece
    arc: AffinePiece
    descent: arb

    @property
    def unstable(self) -> bool | None:
        """True if one side has a multiplier above 1, a second one in (0, 1), and an eigenvector off the border; else
        None.

        Then the half return maps a cone around the eigenvector, on its side, into itself and stretches it, also near
        its fixed point, so orbits leave. A multiplier below -1 would not prove this, as its eigenvector changes sides,
        and vectors that are stretched on one side may shrink on the other.
        """
        sides = (self.wall, self.arc)
        leaves = any(p.determinant > 0 and p.trace > 1 + p.determinant and not p.rows[1][0].contains(0) for p in sides)
        return True if leaves else None

    @property
    def robust(self) -> bool | None:
        """The verdict on robust chaos of the piecewise linear half return for `lam` above `lambda-star`."""
        return robust({ARC: self.arc, WALL: self.wall})

    @property
    def minimum_at_kink(self) -> bool | None:
        """True when `s_4` falls up to `phi-star` and grows beyond, False when that is refuted, None when undecided."""
        left, right = (self.slope_wall, self.slope_arc) if self.motion > 0 else (self.slope_arc, self.slope_wall)
        if not (self.motion > 0 or self.motion < 0):
            return None
        if left < 0 and right > 0:
            return True
        return False if left > 0 or right < 0 else None


@dataclass(frozen=True)
class LinearRule:
    """The linearised collision rule at a bounce: coefficients of the parameters before, here, after, and of `lam`."""

    lower: Any
    diagonal: Any
    upper: Any
    eta: Any

    def next(self, before: Any, here: Any, lam: Any) -> Any:
        """The derivative of the next boundary parameter, from those of the two parameters before it and of `lam`."""
        return -(self.lower * before + self.diagonal * here + self.eta * lam) / self.upper


def rule(arithmetic: Arithmetic, before: Place, here: Place, after: Place, contraction: Any) -> LinearRule:
    """The linearised collision rule at `here`, between the bounces `before` and `after`."""
    back = load(chord_kernel(cuspless, here[0], before[0], 1), arithmetic)(here[1], before[1])
    forth = load(chord_kernel(cuspless, here[0], after[0], 1), arithmetic)(here[1], after[1])
    return LinearRule(contraction * back[2], forth[1] + contraction * back[1], forth[2], back[0])


def corners(arithmetic: Arithmetic) -> tuple[Any, Any]:
    """The parameters of the upper corner on arc and wall; those of the lower corner are their negatives."""
    arc, wall = load(kernel("corners", [], {"arc": 2 * pi / 3, "wall": -sqrt(3) / 4}), arithmetic)()
    return arc, wall


def at_corner(arithmetic: Arithmetic, theta1: Any, contraction: Any) -> Corner:
    """The one-sided derivatives at the orbit through both corners that lands on the arc at `theta1` first."""
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
        halves.append(_half(around, to_top))  # the mirror image of one corner is the other
    return Corner(slopes[WALL], slopes[ARC], motion / by_angle, halves[WALL], halves[ARC], descents[WALL])


def _half(first: LinearRule, second: LinearRule) -> AffinePiece:
    """Linear part of half a return, as a map of two successive displacements; the mirror image changes their sign."""
    columns = []
    for before, here, lam in ((-1, 0, 0), (0, -1, 0), (0, 0, 1)):
        third = first.next(before, here, lam)
        columns.append((third, second.next(here, third, lam)))
    by_u, by_v, by_lam = columns
    return AffinePiece(((by_u[0], by_v[0]), (by_u[1], by_v[1])), by_lam)


@cache
def enclosed(digits: int = 25) -> tuple[arb, arb]:
    """The orbit through both corners as balls `(theta1, lambda-star)`, proved by an interval Newton step.

    >>> print(enclosed()[1].str(12, radius=False))
    0.0712172452489
    """
    solution, bits = refined(corner(), NEAR, digits), bits_of(digits, 64)
    with working(bits):
        found = interval_newton(corner(), exact_balls(solution.z), (arb(10) ** -(digits - 3)).mid(), bits)
    if found.status is not ZeroStatus.UNIQUE:
        raise ArithmeticError(f"the orbit through both corners is not proved to {digits} digits")
    theta1, contracted = found.zero
    return theta1, contracted


BITS = 64
Spread = tuple[arb, ...]  # the box of the parameters, centred at 0
Angle = Callable[[arb, arb], tuple[arb, arb, arb]]


@dataclass(frozen=True)
class Quantity:
    """A function of the parameters: its value at the centre, its derivatives over the box, and its range."""

    centre: arb
    slopes: Spread
    whole: arb


@dataclass(frozen=True)
class BoundaryPoint:
    """A bounce: the component of the boundary, and the boundary parameter as a function of the parameters."""

    component: int
    at: Quantity


def parameter(value: arb, index: int, spread: Spread) -> Quantity:
    """The function `value + p` of the parameters, whose box is `spread`; `p` is the parameter with this index."""
    slopes = tuple(arb(1 if i == index else 0) for i in range(len(spread)))
    return Quantity(value, slopes, value + spread[index])


def constant(value: arb, spread: Spread) -> Quantity:
    """A constant function of the parameters, whose box is `spread`."""
    return Quantity(value, (arb(0),) * len(spread), value)


@cache
def _angles(order: int = 1) -> dict[tuple[int, int], Angle]:
    pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
    return {pair: load(chord_kernel(cuspless, *pair, order), balls(BITS)) for pair in pairs}


@cache
def _guesses() -> dict[tuple[int, int], Callable[[float, float], tuple[float, float, float]]]:
    return {pair: load(chord_kernel(cuspless, *pair, 1), FLOAT64) for pair in _angles()}


@cache
def corner_parameters() -> tuple[arb, arb]:
    """The parameters of the upper corner on arc and wall, in balls of `BITS` bits."""
    with working(BITS):
        return corners(balls(BITS))


def angle(here: BoundaryPoint, there: BoundaryPoint) -> tuple[arb, arb, arb]:
    """The angle of the chord from `here` to `there` with the normal at `here`, and its derivatives by the two ends."""
    return _angles()[here.component, there.component](here.at.whole, there.at.whole)


def following(
    previous: BoundaryPoint, here: BoundaryPoint, component: int, near: float, lam: Quantity, spread: Spread
) -> BoundaryPoint:
    """The bounce after `here` on a component, from a guess `near`; `ArithmeticError` if none is enclosed.

    The bounce solves the collision rule at `here`, on the component continued beyond its ends; `spread` is the
    parameters' box.

    >>> with working(BITS):
    ...     (right, left), lam = (BoundaryPoint(c, constant(arb(0), ())) for c in (ARC, WALL)), constant(arb(0), ())
    ...     abs(following(left, right, WALL, 0.1, lam, ()).at.whole) < 1e-12
    True
    """
    back, forth = _angles()[here.component, previous.component], _angles()[here.component, component]
    eta = _angles(0)[here.component, previous.component](here.at.centre, previous.at.centre)[0]
    plain = _angles(0)[here.component, component]
    middle = _polished(here, component, float((-lam.centre * eta).mid()), near)
    centre = _root(plain, forth, here.at.centre, -lam.centre * eta, middle, 1e-14)
    into = back(here.at.whole, previous.at.whole)
    room = here.at.whole.rad() + previous.at.whole.rad() + lam.whole.rad()
    whole = _root(plain, forth, here.at.whole, -lam.whole * into[0], middle, 3 * float(room) + 1e-13)
    slopes: Spread = ()
    for _ in range(2):  # the second step refines the ball of the first
        out = forth(here.at.whole, whole)
        by = -lam.whole * into[2] / out[2], -(out[1] + lam.whole * into[1]) / out[2], -into[0] / out[2]
        slopes = tuple(
            by[0] * p + by[1] * h + by[2] * m
            for p, h, m in zip(previous.at.slopes, here.at.slopes, lam.slopes, strict=True)
        )
        whole = whole.intersection(sum((s * d for s, d in zip(slopes, spread, strict=True)), centre))
    return BoundaryPoint(component, Quantity(centre, slopes, whole))


def on_arc(previous: BoundaryPoint, here: BoundaryPoint, near: float, lam: Quantity, spread: Spread) -> BoundaryPoint:
    """The bounce after `here` on the arc; `ArithmeticError` unless it is proved to lie between the corners."""
    found = following(previous, here, ARC, near, lam, spread)
    if not abs(found.at.whole) < corner_parameters()[ARC]:
        raise ArithmeticError("a landing on the arc is not enclosed")
    return found


def beyond(bounce: BoundaryPoint, upper: bool) -> Quantity:
    """The distance of a bounce, or if `upper` is False of its mirror image, beyond the upper corner."""
    sign, at = 1 if upper else -1, bounce.at
    edge = corner_parameters()[bounce.component]
    return Quantity(sign * at.centre - edge, tuple(sign * s for s in at.slopes), sign * at.whole - edge)


def after_corner(
    previous: BoundaryPoint, here: BoundaryPoint, upper: bool, lam: Quantity, spread: Spread
) -> list[BoundaryPoint]:
    """The bounces after `here` near a corner: one bounce, or one on each component if the component is undecided.

    The table is convex, so a zero of the collision rule that is proved to lie on the boundary is the landing. When the
    ball of the zero on the arc holds the corner, the angle is monotone there, and it is monotone along the whole line
    of the wall; both have the same value at the corner. So the landing is the zero on the arc when the zero on the
    wall's line lies before the wall, and one of the two when that zero may lie on the wall. `ArithmeticError` when
    neither is enclosed.
    """
    sign, found, places = 1 if upper else -1, {}, {}
    for component in (ARC, WALL):
        near = sign * float(corner_parameters()[component].mid())
        try:
            found[component] = following(previous, here, component, near, lam, spread)
        except ArithmeticError:
            continue
        places[component] = beyond(found[component], upper).whole
    arc, wall = corner_parameters()
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


def _polished(here: BoundaryPoint, component: int, value: float, near: float) -> float:
    """The position on a component at which the chord angle has this value, by Newton's method in float64."""
    angle, start = _guesses()[here.component, component], float(here.at.centre.mid())

    def correction(x: Vector) -> list[float]:
        found = angle(start, x[0])
        return [(found[0] - value) / found[2]]

    return float(iterated(correction, [near], Stop(enough=1e-13, steps=8)).x[0])


def _root(plain: Angle, angle: Angle, here: arb, value: arb, near: float, radius: float) -> arb:
    """The position where the chord angle from `here` is `value`, by an interval Newton step from `near`."""
    gap = plain(here, arb(near))[0] - value
    if (found := near_guess(near, gap, lambda box: angle(here, box)[2], radius, 10)) is not None:
        return found
    raise ArithmeticError("a landing is not enclosed")
