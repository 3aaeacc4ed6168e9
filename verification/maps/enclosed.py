"""The map in balls: a landing is enclosed by an interval Newton step and proved to be the first hit, or it is refused.

A float64 kernel, or mpmath where that fails, guesses a landing and Newton's method sharpens it. An interval Newton step
then shows that every start in the ball lands exactly once near it, and a cover of the boundary shows that no such
flight meets the boundary before (`verification.maps.first_hit`), whatever the shape of the table. The proof rests on
the balls alone, and not on the guess.

So an enclosed orbit is proved bounce by bounce, for every start in the ball before. Where a landing cannot be proved
the orbit ends with the status `unproved`. How an orbit ends (at a join, a cusp, a tangency) is found by mpmath and not
proved.
"""

from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import arb

from numeric.pinball.states import components
from symbolic.tables.definition import exact
from symbolic.tables.joins import JoinKind, contacts, following
from symbolic.tables.law import Law
from verification.arithmetic.balls import as_ball, bits_of, enclose, fraction_ball, joined, working
from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.maps.exact import Bounce, ExactMap, closed_length, float_map
from verification.maps.first_hit import BITS, BallBoundary, Frame, closes_smoothly, free
from verification.maps.flight import Curves, Landings, Obstacles, precisions
from verification.maps.lengths import ExactArcLength
from verification.maps.numbers import Balls

DIGITS, SPARE = 50, 64  # digits without `digits` or `bits`; bits beyond the digits
GUESSED = 40  # digits of a guess by mpmath
Flight = Callable[[arb], tuple[arb, arb]]  # by the wall's parameter: 0 where the ray meets it, and its slope
NEWTON = Stop(small=1e-6, steps=40)  # a guess has 15 digits, which double at each step


class Refusal(Enum):
    """Reason why a bounce is not enclosed."""

    WIDE = "the start is not known well enough; ask for more digits"
    UNPROVED = "no proof that the flight meets nothing before it lands"


class EnclosedMap:
    """The map in balls, to `digits` digits and some more, or in balls of `bits` bits.

    `table` is a table, its name, a scene or a `PinballMap`, as for `ExactMap`.

    >>> ellipse = EnclosedMap("ellipse", a=2, lam=1, digits=30)
    >>> bounce = ellipse.bounce(ellipse.start("0", "0"))
    >>> bounce.x.contains(-2), bounce.x.rad() < 1e-20
    (True, True)

    `lam` is a number or its text (`"9/10"` and `"0.9"` mean the same); a float stands for its exact binary value.
    """

    def __init__(
        self,
        table: Any,
        lam: Any = None,
        bits: int | None = None,
        *,
        digits: int | None = None,
        law: Law | str | None = None,
        **shape: Any,
    ) -> None:
        if bits is not None and digits is not None:
            raise ValueError(f"EnclosedMap: digits = {digits} and bits = {bits} are given; give one of them")
        map, lam = float_map(table, lam, law, shape)
        bits = bits_of(digits or DIGITS, SPARE) if bits is None else bits
        self.map, self.bits, self.ops = map, bits, Balls()
        self.exact = ExactMap(map, GUESSED, lam)
        with working(bits):
            self.lam = number(self.exact.contraction, bits)
            self.shape = [number(value, bits) for value in map.exact_shape]
            self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in map.ir.parts]
            self.parts = [part.curve for part in map.ir.parts]
            self.quarter = arb.pi() / 2
            self.frames, self.curves = (Curves(self.parts, self.ops, self.shape, count, bits) for count in (4, 6))
        self.lengths: dict[tuple[int, int], ExactArcLength] = {}
        self.closed = closes_smoothly(map.table) and not map.reflection.placed  # its formulas run on beyond both ends
        self.joins: tuple[list[tuple[JoinKind, JoinKind]], tuple[int, ...]] = (
            [(JoinKind.SMOOTH, JoinKind.SMOOTH)],
            (0,),
        )
        if not self.closed:
            after, agree = following(map.table), contacts(map.table)
            self.joins = [(agree[after.index(i)], agree[i]) for i in range(len(after))], after
        self.landings, self.obstacles, self.precisions = Landings(map), Obstacles(map), precisions(bits)
        self.boundary = BallBoundary(
            [self._placed(i) for i in range(len(self.parts))], self.ends, lambda: self.joins[1]
        )

    def __repr__(self) -> str:
        return f"EnclosedMap({self.map!r}, {str(self.exact.contraction)!r}, {self.bits})"

    def start(self, theta: Any, phi: Any, component: int = 0) -> Bounce:
        """The bounce, in balls, with parameter `theta` and exit angle `phi`, which are balls or exact numbers."""
        component = int(components(component, [part.name for part in self.map.ir.parts]))
        with working(self.bits):
            theta, phi = number(theta, self.bits), number(phi, self.bits)
            return self._leaving(theta, phi, component, self._frame(component, theta))

    def _leaving(self, theta: arb, phi: arb, component: int, frame: Sequence[arb], eta: arb | None = None) -> Bounce:
        """The bounce that leaves at exit angle `phi`, where `frame` is point and velocity of the boundary curve."""
        x, y, dx, dy = frame
        speed = (dx * dx + dy * dy).sqrt()
        c, s = self.ops.turned(phi)
        return Bounce(component, theta, phi, ((s * dx - c * dy) / speed, (s * dy + c * dx) / speed), x, y, eta)

    def bounce(self, here: Bounce) -> Bounce | Refusal:
        """The next bounce, enclosed and proved, or a `Refusal`; `code` is not 0 if the particle stops.

        That a particle stops is what mpmath finds for the midpoint of `here`; it is not proved.
        """
        refusal = Refusal.WIDE
        with working(self.bits):
            low, high = self.ends[here.component]
            if not (low <= here.theta <= high or self._on_boundary(here.component, here.theta)):
                return Refusal.UNPROVED if here.theta < low or here.theta > high else Refusal.WIDE
        for guess in self._guesses(here):
            if guess.code:
                return guess
            with working(self.bits):
                landed = self._landed(here, guess)
            if landed is None:
                continue
            if self._first(here, landed):
                return landed
            refusal = Refusal.UNPROVED
        return refusal

    def _first(self, here: Bounce, landed: Bounce) -> bool:
        """Is the enclosed landing proved to be the first hit?"""
        ends = here, landed
        turned = abs(here.phi) < self.quarter and abs(landed.eta) < self.quarter  # inwards, and from inside
        if turned and all(self._inside(end.component, end.theta) for end in ends):
            start, stop = ((end.component, end.theta, end.x, end.y) for end in ends)
            if self.obstacles.passed(start, stop, max(float(x.rad()) for x in (*start[1:], *stop[1:]))):
                return True
        with working(BITS):
            return free(self.boundary, *((end.component, end.theta) for end in ends))

    def orbit(self, here: Bounce, bounces: int) -> Iterator[Bounce]:
        """The next `bounces` bounces, each proved; fewer if a bounce cannot be proved or the particle stops."""
        for _ in range(bounces):
            landed = self.bounce(here)
            if isinstance(landed, Refusal) or landed.code:
                return
            yield landed
            here = landed

    def curve(self, component: int, theta: arb) -> Sequence[arb]:
        """Point, velocity and acceleration, as six balls; beyond a smooth join, those of the next component."""
        return self._along(self.curves, component, theta)

    def _frame(self, component: int, theta: arb) -> Sequence[arb]:
        """Point and velocity of the curve, as four balls; beyond a smooth join, those of the next component."""
        return self._along(self.frames, component, theta)

    def _along(self, curves: Curves, component: int, theta: arb) -> Sequence[arb]:
        stretches = self._stretches(component, theta)
        if len(stretches) == 1 and stretches[0][1] is theta:
            return curves[component](theta)
        found = []
        for part, at, ratio in stretches:
            x, y, *moved = curves[part](at)
            found.append([x, y, *(v * ratio ** (1 + k // 2) for k, v in enumerate(moved))])
        return [joined(values) for values in zip(*found, strict=True)]

    def _stretches(self, component: int, theta: arb) -> list[tuple[int, arb, arb]]:
        """Triples (component, parameter on it, its derivative by `theta`) that together cover the ball `theta`.

        Beyond a smooth join the next component continues the curve, with a parameter of the same speed at the join.
        """
        agree, after = self.joins
        (low, high), found = self.ends[component], []
        if self.closed or low < theta < high:
            return [(component, theta, arb(1))]
        inner = theta
        for side, end, gap in ((1, high, theta - high), (0, low, low - theta)):
            if gap < 0 or not agree[component][side].smooth:
                continue
            beyond = after[component] if side else after.index(component)
            there = self.ends[beyond][1 - side]
            (_, _, px, py), (_, _, qx, qy) = self.frames[component](end), self.frames[beyond](there)
            ratio = ((px * px + py * py) / (qx * qx + qy * qy)).sqrt()
            far = arb(max(gap.lower(), arb(0))).union(arb(gap.upper()))
            found.append((beyond, there + far * ratio if side else there - far * ratio, ratio))
            if gap > 0:
                return found
            inner = inner.lower().union(end) if side else inner.upper().union(end)
        return [(component, inner, arb(1)), *found]

    def _on_boundary(self, component: int, theta: arb) -> bool:
        """Does a parameter lie within its component, or on the next one beyond a smooth join?"""
        if self.closed:
            return True
        agree, _ = self.joins
        low, high = self.ends[component]
        for side, gap in ((1, theta - high), (0, low - theta)):
            if not gap < 0 and not (agree[component][side].smooth and self._short(component, theta, side)):
                return False
        return True

    def _inside(self, component: int, theta: arb) -> bool:
        """Does a parameter lie strictly within its component, or on the next one beyond a smooth join?"""
        low, high = self.ends[component]
        return bool(low < theta < high) or (not self.closed and self._on_boundary(component, theta))

    def _short(self, component: int, theta: arb, side: int) -> bool:
        """Does a parameter that is beyond an end of its component stay within the neighbouring component?"""
        after = self.joins[1]
        beyond = after[component] if side else after.index(component)
        low, high = self.ends[beyond]
        return all(
            at < high if side else at > low for part, at, _ in self._stretches(component, theta) if part == beyond
        )

    def _exit(self, eta: arb, component: int, theta: arb) -> arb:
        """The exit angle for the angle of incidence `eta`, as a ball."""
        formula = self.exact.formula
        if formula is None:
            return -self.lam * eta
        found = []
        for part, at, _ in self._stretches(component, theta):
            place: tuple[arb, ...] = (at, self._length_on(part, at, 0)) if formula.measured else (at,)
            found.append(formula.exit(self.ops, eta, self.lam, *place)[0])
        return joined(found)

    def length(self, component: int, theta: arb, digits: int = 0) -> Any:
        """The paper's arc length, in closed form or by rigorous integration; `digits` 0 means full precision."""
        whole = [self._length_on(part, at, digits) for part, at, _ in self._stretches(component, theta)]
        return None if any(one is None for one in whole) else joined(whole)

    def _length_on(self, component: int, theta: arb, digits: int) -> Any:
        closed = closed_length(self.map, self.ops, self.shape, component, theta)
        if closed is not None or len(self.parts) > 1:
            return closed
        (zero,), middle = self.map.ir.origin[1](self.ops, *self.shape), arb(theta.mid())
        _, _, dx, dy = self._frame(component, theta)
        found = self.arclength(component, digits or int(self.bits / 3.33))(zero, middle)
        return found + (dx * dx + dy * dy).sqrt() * (theta - middle)

    def arclength(self, component: int, digits: int) -> ExactArcLength:
        """The function for the arc length between two parameters of a component, to `digits` digits; cached."""
        asked = component, bits_of(digits, 40)
        if asked not in self.lengths:
            self.lengths[asked] = ExactArcLength(self.parts[component], self.shape, self.ends[component], asked[1])
        return self.lengths[asked]

    def _placed(self, component: int) -> Any:
        def place(theta: arb) -> Frame:
            return tuple(self._frame(component, theta))

        return place

    def _guesses(self, here: Bounce) -> Iterator[Bounce]:
        """Guesses of where the midpoint of `here` lands: from the float64 kernel if it has one, then from mpmath."""
        guess = self.landings.guess(float(here.theta.mid()), float(here.phi.mid()), here.component)
        if guess is not None:
            component, at = guess
            yield self._guess(component, self._sharpened(here, component, arb(at)))
        exact = self.exact
        begin = exact.middle(here.theta)
        if not self.closed:  # a bounce on a join may lie on either side of it
            begin = min(max(begin, exact.ends[here.component][0]), exact.ends[here.component][1])
        start = exact.start(begin, exact.middle(here.phi), here.component)
        bounce = exact.bounce(start)
        yield self._guess(bounce.component, self._polished(here, bounce.component, as_ball(bounce.theta)), bounce.code)

    @staticmethod
    def _guess(component: int, theta: arb, code: int = 0) -> Bounce:
        return Bounce(component, theta, None, (None, None), None, None, code=code)

    def _sharpened(self, here: Bounce, component: int, near: arb) -> arb:
        """A guess of the kernel, refined to all digits by Newton's method with doubling precision; proves nothing."""
        x0, y0, vx, vy = (value.mid() for value in (here.x, here.y, *here.v))
        for bits in self.precisions:
            with working(bits):
                x, y, dx, dy = self.frames[component](near)
                near = (near - (vx * (y - y0) - vy * (x - x0)) / (vx * dy - vy * dx)).mid()
        return near

    def _flight(self, here: Bounce, component: int) -> Flight:
        """The flight function, which is 0 where the flight meets the boundary, with its derivative."""
        vx, vy = here.v

        def flight(theta: arb) -> tuple[arb, arb]:
            x, y, dx, dy = self._frame(component, theta)
            return vx * (y - here.y) - vy * (x - here.x), vx * dy - vy * dx

        return flight

    def _polished(self, here: Bounce, component: int, near: arb) -> arb:
        """A guess of mpmath, refined to all digits by Newton's method; proves nothing."""
        flight = self._flight(here, component)

        def correction(at: Vector) -> Vector:
            value, slope = (each.mid() for each in flight(*at))
            return [(value / slope).mid()]

        with working(self.bits):
            middle: arb = iterated(correction, [near], NEWTON, kept=arb.mid).x[0]
        return middle

    def _reach(self, step: arb, middle: arb) -> arb:
        """Radius about a guess within which an interval Newton step is tried."""
        return abs(step) * 4 + (abs(middle) + 1) * arb(2) ** (4 - self.bits)

    def _landed(self, here: Bounce, guess: Bounce) -> Bounce | None:
        """The enclosed landing near a guess; None if the interval Newton step does not lead inside its interval."""
        flight, middle, (vx, vy) = self._flight(here, guess.component), guess.theta, here.v
        value, slope = flight(middle)
        box = arb(middle, self._reach(value / slope, middle).upper())  # infinite where the slope may be 0
        newton = middle - value / flight(box)[1]
        if not box.contains_interior(newton) or not self._on_boundary(guess.component, newton):
            return None
        component, stretches = guess.component, self._stretches(guess.component, newton)
        if len(stretches) == 1:  # it may be wholly beyond a join
            ((component, newton, _),) = stretches
        x, y, dx, dy = frame = self._frame(component, newton)
        if not vx * (x - here.x) + vy * (y - here.y) > 0:
            return None
        eta = -(arb.atan2(vx * dx + vy * dy, vx * dy - vy * dx))
        return self._leaving(newton, self._exit(eta, component, newton), component, frame, eta)


def number(value: Any, bits: int = 0) -> arb:
    """An exact number or its text, a float (with its exact binary value) or a ball, as a ball."""
    if isinstance(value, arb):
        return value
    if isinstance(value, str):
        value = exact("start", value)
    if isinstance(value, Fraction):
        return fraction_ball(value)
    if isinstance(value, int | float):
        return arb(value)
    return enclose(value, digits=int(bits / 3.3219) + 2).real


def perimeter(enclosed: EnclosedMap, digits: int) -> arb:
    """The length of the whole boundary, by rigorous integration of the speed.

    >>> circle = EnclosedMap("circle", bits=100)
    >>> bool(abs(perimeter(circle, 20) - 2 * arb.pi()) < 1e-15)
    True
    """
    parts = (enclosed.arclength(i, digits)(*ends) for i, ends in enumerate(enclosed.ends))
    with working(bits_of(digits, 40)):
        return sum(parts, arb(0))
