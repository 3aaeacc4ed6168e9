"""The map in balls: a landing is enclosed by Newton's step and proved to be the first hit, or not given at all.

A float64 kernel, or mpmath where that fails, guesses a landing. Newton's method sharpens it; an interval
Newton step then shows that near it every ball of the start lands exactly once; and the boundary is covered
to show that no such flight meets it before (`certificates.first_hit`), whatever the shape of the table.
What is proved rests on the balls alone, and not on where the guess came from.
"""

from collections.abc import Iterator
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import arb, fmpq

from numeric import PinballMap
from numeric.backends.scalars import Scalars
from verification.arithmetic.balls import as_ball, enclose
from verification.arithmetic.words import working
from verification.maps.exact import Ball, ExactMap
from verification.maps.first_hit import BITS, Boundary, Frame, free

GUESSED = 40  # digits of a guess by mpmath
STEPS = 40  # of Newton's method, whose digits double from 15 on
MARGIN = 2.0**-20  # how far a ball's angle must stay within what the kernels take


class Refusal(Enum):
    """Why a bounce is not given."""

    WIDE = "the start is not known well enough; ask for more digits"
    UNPROVED = "no proof that the flight meets nothing before it lands"


class Balls(Scalars):
    """What a program needs of ball arithmetic: constants, roots, sine and cosine."""

    def __init__(self) -> None:
        super().__init__(None)

    def constant(self, p: int, q: int = 1) -> arb:
        """`p/q`, enclosed."""
        return arb(fmpq(p, q))

    def pi(self) -> arb:
        """Pi, enclosed."""
        return arb.pi()

    def sqrt(self, x: Any) -> Any:
        """The square root."""
        return x.sqrt()

    def sin(self, x: Any) -> Any:
        """The sine."""
        return x.sin()

    def cos(self, x: Any) -> Any:
        """The cosine."""
        return x.cos()


class EnclosedMap:
    """The map of a `PinballMap`'s table in balls of `bits` bits.

    >>> from numeric import PinballMap
    >>> ellipse = EnclosedMap(PinballMap("ellipse", a=2, lam=1), 1, bits=100)
    >>> bounce = ellipse.bounce(ellipse.ball(0, Fraction(0), Fraction(0)))
    >>> bounce.x.contains(-2), bounce.x.rad() < 1e-20
    (True, True)
    """

    def __init__(self, map: PinballMap, lam: Any, bits: int) -> None:
        self.map, self.bits, self.ops = map, bits, Balls()
        self.exact = ExactMap(map, GUESSED, lam)
        with working(bits):
            self.lam = number(lam, bits)
            self.shape = [number(value, bits) for value in map.exact_shape]
            self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in map.blueprint.parts]
        self.parts = [part.curve for part in map.blueprint.parts]
        self.boundary = Boundary([self._placed(i) for i in range(len(self.parts))], self.ends)

    def ball(self, component: int, theta: Any, phi: Any) -> Ball:
        """All balls whose parameter and exit angle lie in these, which may be exact numbers."""
        with working(self.bits):
            theta, phi = number(theta, self.bits), number(phi, self.bits)
            x, y, dx, dy, _, _ = self.curve(component, theta)
            speed = (dx * dx + dy * dy).sqrt()
            c, s = phi.cos(), phi.sin()
            v = (s * dx - c * dy) / speed, (s * dy + c * dx) / speed
            return Ball(component, theta, phi, v, x, y)

    def bounce(self, ball: Ball) -> Ball | Refusal:
        """One flight and one reflection, proved; a ball that stops by a named outcome has that outcome's `code`.

        An outcome is what mpmath finds for the middle of the ball, and is not proved.
        """
        refusal = Refusal.WIDE
        for guess in self._guesses(ball):
            if guess.code:
                return guess
            with working(self.bits):
                landed = self._landed(ball, guess)
            if landed is None:
                continue
            with working(BITS):
                ends = (ball.component, ball.theta), (landed.component, landed.theta)
                if free(self.boundary, *ends):
                    return landed
            refusal = Refusal.UNPROVED
        return refusal

    def curve(self, component: int, theta: arb) -> list[arb]:
        """Point, velocity and acceleration."""
        return self.parts[component](self.ops, theta, *self.shape)

    def _placed(self, component: int) -> Any:
        def place(theta: arb) -> Frame:
            return tuple(self.curve(component, theta)[:4])

        return place

    def _guesses(self, ball: Ball) -> Iterator[Ball]:
        """The landing of the middle: by a kernel if it finds one, then by mpmath."""
        theta, phi = float(ball.theta.mid()), float(ball.phi.mid())
        low, high = self.map.states.ends[ball.component]
        if low <= theta <= high and abs(phi) < 1.5707 and abs(abs(theta) - 3.141592653589793) > MARGIN:
            step = self.map.step(theta, phi, ball.component)
            if not step.code:
                yield Ball(int(step.component), arb(float(step.theta)), None, (None, None), None, None)
        exact = self.exact
        guess = exact.bounce(exact.ball(ball.component, exact.middle(ball.theta), exact.middle(ball.phi)))
        yield Ball(guess.component, as_ball(guess.theta), None, (None, None), None, None, code=guess.code)

    def _landed(self, ball: Ball, guess: Ball) -> Ball | None:
        """The enclosed landing near a guess, or None when Newton's step does not close."""
        vx, vy = ball.v

        def flight(theta: arb) -> tuple[arb, arb]:
            x, y, dx, dy, _, _ = self.curve(guess.component, theta)
            return vx * (y - ball.y) - vy * (x - ball.x), vx * dy - vy * dx

        middle, last = guess.theta, arb(1)
        for _ in range(STEPS):
            value, slope = (each.mid() for each in flight(middle))
            if slope == 0:
                return None
            step = (value / slope).mid()
            middle = (middle - step).mid()
            if not abs(step) * 2 < last:  # what is left is rounding
                break
            last = abs(step)
        value, slope = flight(middle)
        radius = abs(value / slope) * 4 + (abs(middle) + 1) * arb(2) ** (4 - self.bits)
        if slope.contains(0) or not radius.is_finite():
            return None
        box = arb(middle, radius.upper())
        newton = middle - value / flight(box)[1]
        low, high = self.ends[guess.component]
        if not box.contains_interior(newton) or not (len(self.ends) == 1 or low < newton < high):
            return None
        x, y, dx, dy, _, _ = self.curve(guess.component, newton)
        if not vx * (x - ball.x) + vy * (y - ball.y) > 0:
            return None
        eta = -(arb.atan2(vx * dx + vy * dy, vx * dy - vy * dx))
        following = self.ball(guess.component, newton, -self.lam * eta)
        return Ball(guess.component, newton, following.phi, following.v, x, y, eta)


def number(value: Any, bits: int = 0) -> arb:
    """A number, exact or float or a ball, as a ball."""
    if isinstance(value, arb):
        return value
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    if isinstance(value, int | float):
        return arb(value)
    return enclose(value, digits=int(bits / 3.3219) + 2).real
