"""The map to any number of digits, by its definition: the truth that float64 kernels are held against.

Flights are found by `numeric.flights.general` on mpmath numbers, that is on the flight function as
the paper has it, with every zero bracketed and the first hit taken. Nothing is shared with the
closed forms and the deflated polynomials of the kernels but the exact table itself. Beyond 50 digits
the first hit is found with 50 and sharpened by Newton's method on the same flight function. `errors` says how far a
float64 step is from this map of the rounded state, in units of 2**-52.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap, Status
from numeric.backends.scalars import ScalarBackend
from numeric.flights.family import FORMULA, NEAR, Frame, law_of
from numeric.flights.general import General
from verification.arithmetic.iteration import Stop, Vector, iterated

GUARD = 30  # digits more than asked for: a grazing flight loses as many as its angle has zeros
COARSE = 50  # digits of the search for the first hit, when more are asked for


@dataclass(frozen=True)
class Bounce:
    """A bounce on the boundary: component, parameter, exit angle and direction; `eta` is how it came."""

    component: int
    theta: Any
    phi: Any
    v: tuple[Any, Any]
    x: Any
    y: Any
    eta: Any = None
    code: int = 0


class ExactMap:
    """The map of a `PinballMap`'s table to `digits` digits.

    >>> from numeric import PinballMap
    >>> exact = ExactMap(PinballMap("ellipse", a=2, lam=1), digits=30)
    >>> print(exact.bounce(exact.start(0, 0)).x)
    -2.0
    """

    def __init__(self, map: PinballMap, digits: int = 50, lam: Any = None) -> None:
        self.map, self.context = map, mpmath.MPContext()
        self.context.dps = digits + GUARD
        self.digits = digits
        self.ops = ScalarBackend(self.context)
        self.general = General(map.states.boundary)
        self.lam = self.exactly(map.lam.flat[0] if lam is None else lam)  # a float is the double it is
        self.law = map.law if map.law == FORMULA else law_of(float(map.lam.flat[0]), float(map.lam.flat[0]))
        self.formula = map.family.formula if map.law == FORMULA else None
        self.shape = [self.exactly(value) for value in map.exact_shape]
        parts = map.ir.parts
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in parts]
        self.general.ends = self.ends
        self.cusped = map.family.cusped
        self.coarse = ExactMap(map, COARSE, lam) if digits > COARSE else None

    def start(self, theta: Any, phi: Any, component: int = 0) -> Bounce:
        """The bounce at `theta` that leaves at the exit angle `phi`, both taken exactly."""
        mp = self.context
        theta, phi = mp.mpf(theta), mp.mpf(phi)
        tx, ty, x, y = self._frame(component, theta)
        c, s = mp.cos(phi), mp.sin(phi)
        return Bounce(component, theta, phi, (s * tx - c * ty, s * ty + c * tx), x, y)

    def along(self, theta: Any, v: Sequence[Any], component: int = 0) -> Bounce:
        """The bounce at `theta` that flies along `v`, which need not have length one."""
        mp = self.context
        x, y = mp.mpf(v[0]), mp.mpf(v[1])
        tx, ty, px, py = self._frame(component, theta)
        size = mp.hypot(x, y)
        v = (x / size, y / size)
        return Bounce(component, theta, mp.atan2(v[0] * tx + v[1] * ty, v[1] * tx - v[0] * ty), v, px, py)

    def bounce(self, here: Bounce) -> Bounce:
        """One flight and one reflection."""
        mp = self.context
        component, theta, code = self._landing(here)
        if self.cusped and (mp.cos(theta / 2) < NEAR or self._meets_the_cusp(here)):
            return replace(here, eta=None, code=Status.CUSP.code)
        tx, ty, x, y = self._frame(component, theta)
        vx, vy = here.v
        eta = -mp.atan2(vx * tx + vy * ty, vx * ty - vy * tx)
        phi = -self.lam * eta if self.formula is None else self._exit(eta, component, theta)
        c, s = mp.cos(phi), mp.sin(phi)
        return Bounce(component, theta, phi, (s * tx - c * ty, s * ty + c * tx), x, y, eta, code)

    def _exit(self, eta: Any, component: int, theta: Any) -> Any:
        """The exit angle of a law that is no uniform contraction."""
        assert self.formula is not None
        place = (theta, self.length(component, theta)) if self.formula.measured else (theta,)
        return self.formula.exit(self.ops, eta, self.lam, *place)[0]

    def length(self, component: int, theta: Any) -> Any:
        """The paper's arc length to this map's precision; None on tables of several pieces without a closed form."""
        mp, map = self.context, self.map
        closed = closed_length(map, self.ops, self.shape, component, theta)
        if closed is not None:
            return closed
        if map.ir.table == "ellipse" and self.shape:
            return mp.ellipe(theta, 1 - self.shape[0] ** 2)
        if len(map.ir.parts) > 1:
            return None

        def speed(at: Any) -> Any:
            _, _, dx, dy, _, _ = map.ir.parts[0].curve(self.ops, at, *self.shape)
            return mp.hypot(dx, dy)

        (zero,) = map.ir.origin[1](self.ops, *self.shape)
        return mp.quad(speed, [zero + (theta - zero) * k / 8 for k in range(9)])

    def _landing(self, here: Bounce) -> tuple[int, Any, int]:
        """Component and parameter of the first hit, and the code of its outcome."""
        mp = self.context
        if self.coarse is not None:
            component, theta, code = self.coarse._landing(here)
            sharp = None if code else self._sharpened(here, component, mp.mpf(theta))
            if sharp is not None:
                return component, sharp, code
        state = [mp.mpf(here.component), mp.mpf(here.theta)], [mp.mpf(x) for x in here.v]
        landing = self.general.fly(self.ops, self.shape, "pinball", *state)
        return int(landing.position[0]), landing.position[1], int(landing.code or 0)

    def _meets_the_cusp(self, here: Bounce) -> bool:
        """Does the flight pass the origin, which every point of the cardioid sees, closer than any landing tells?"""
        (x, y), (vx, vy) = (here.x, here.y), here.v
        return bool(x * vx + y * vy < 0 and abs(x * vy - y * vx) < NEAR * NEAR)

    def _sharpened(self, here: Bounce, component: int, theta: Any) -> Any:
        """The zero of the flight function that Newton's method reaches; None if it is not the one nearby."""
        mp, (vx, vy) = self.context, here.v

        def correction(at: Vector) -> Vector:
            x, y, dx, dy, _, _ = self.general.parts[component].curve(self.ops, *at, *self.shape)
            return [(vx * (y - here.y) - vy * (x - here.x)) / (vx * dy - vy * dx)]

        enough = mp.mpf(10) ** (-mp.dps * 3 // 5)  # the next correction would be lost in rounding
        found = iterated(correction, [theta], Stop(enough=enough, steps=self.digits))
        return found.x[0] if found.settled and abs(found.x[0] - theta) < mp.mpf(10) ** -COARSE else None

    def orbit(self, here: Bounce, bounces: int) -> list[Bounce]:
        """A bounce and the next `bounces` ones; shorter when an outcome stops it."""
        orbit = [here]
        for _ in range(bounces):
            following = self.bounce(orbit[-1])
            if following.code:
                break
            orbit.append(following)
        return orbit

    def frame(self, component: int, theta: Any) -> Frame[Any]:
        """Point and unit tangent."""
        tx, ty, x, y = self._frame(component, theta)
        return Frame(x, y, tx, ty)

    def _frame(self, component: int, theta: Any) -> tuple[Any, Any, Any, Any]:
        """Unit tangent and point."""
        x, y, dx, dy, _, _ = self.general.parts[component].curve(self.ops, theta, *self.shape)
        speed = self.context.hypot(dx, dy)
        return dx / speed, dy / speed, x, y

    def middle(self, ball: Any) -> Any:
        """The midpoint of a ball of python-flint."""
        man, exp = ball.mid().man_exp()
        return self.context.ldexp(self.context.mpf(int(man)), int(exp))

    def exactly(self, value: Any) -> Any:
        if isinstance(value, Fraction):
            return self.context.mpf(value.numerator) / value.denominator
        if hasattr(value, "evalf"):
            return self.context.mpf(str(value.evalf(self.context.dps)))
        return self.context.mpf(float(value))


def closed_length(map: PinballMap, ops: Any, shape: Sequence[Any], component: int, theta: Any) -> Any:
    """Arc length from the table's origin in elementary functions, component by component; None where there is none."""
    parts, length, law = map.ir.parts, map.family.arclength, map.family.formula
    if law is not None and law.lengths:
        return law.length(ops, component, theta)
    index, start = map.ir.origin
    first = length(ops, index, start(ops, *shape)[0])
    if first is None:
        return None
    reached = -first
    for turn in range(len(parts)):
        at = (index + turn) % len(parts)
        low, high = parts[at].ends(ops, *shape)
        if turn:
            reached = reached - length(ops, at, low)
        if at == component:
            return reached + length(ops, at, theta)
        reached = reached + length(ops, at, high)
    raise ValueError(f"{map.ir.table} has no component {component}")


EPS = 2.0**-52
Array = NDArray[np.float64]


def exact_bounce(map: PinballMap, exact: ExactMap, fields: list[Any]) -> Bounce:
    """The exact bounce whose rounded state these kernel fields are."""
    f = [_number(exact.context, x) for x in fields]
    component, theta = _place(map, exact, f)
    leaving = f[len(map.family.position) :]
    phi = map.family.exit(exact.ops, exact.frame(component, theta), leaving) if leaving else 0
    return exact.start(theta, phi, component)


def errors(map: PinballMap, exact: ExactMap, before: list[Array], after: list[Array]) -> tuple[Array, Array]:
    """Errors of position and direction of one bounce; infinite where it ended on the wrong component."""
    family, ops, at = map.family, exact.ops, len(map.family.position)
    position, direction = np.zeros(before[0].size), np.zeros(before[0].size)
    for i in range(before[0].size):
        truth = exact.bounce(exact_bounce(map, exact, [row[i] for row in before]))
        g = [exact.context.mpf(float(row[i])) for row in after]
        if _place(map, exact, g)[0] != truth.component:
            position[i] = direction[i] = np.inf
            continue
        right = family.enter(ops, ops.number(float(truth.component)), truth.theta)
        position[i] = family.distance(ops, g[:at], right) / EPS
        if map.law != "slap":
            aim = family.aim(ops, exact.frame(truth.component, truth.theta), truth.phi)
            direction[i] = exact.context.norm([x - y for x, y in zip(g[at:], aim, strict=True)]) / EPS
    return position, direction


def _number(mp: Any, x: Any) -> Any:
    """A float of 64 or 80 bits, exactly."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - high))


def _place(map: PinballMap, exact: ExactMap, fields: list[Any]) -> tuple[int, Any]:
    """Component and parameter of exact fields."""
    component, theta = map.family.place(exact.ops, fields[: len(map.family.position)])
    return int(component), theta
