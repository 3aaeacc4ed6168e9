"""The map in mpmath to any number of digits, from its definition: the reference for float64 kernels.

A landing is a zero of the paper's flight function. The float64 kernel gives a guess, Newton's method with doubling
precision refines it, and `maps.flight` shows it to be the first hit; so nothing rests on the closed forms of the
kernels. If there is no guess, or the guess grazes, lies beside a join or is not shown to be first, all zeros are
bracketed by `numeric.flights.general` in mpmath, with at most 50 digits, and the first is refined. `errors` compares a
float64 step with this map of the same state, in units of 2**-52.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import mpmath
import numpy as np
from flint import arb
from numpy.typing import NDArray

from numeric import PinballMap, Status
from numeric.flights.family import FORMULA, NEAR, Frame, law_of
from numeric.flights.general import General
from numeric.pinball.states import components
from symbolic.tables.definition import exact
from symbolic.tables.law import Law
from symbolic.tables.scene import as_scene
from verification.arithmetic.balls import as_ball, exact_balls, working
from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.maps.flight import Curves, Landings, Obstacles, precisions
from verification.maps.lengths import ExactArcLength
from verification.maps.numbers import Numbers

GUARD = 30  # extra digits, since a grazing flight loses some
COARSE = 50  # digits of the search for all zeros, when more are wanted
STEEP = 2.0**-10  # cosine of the angle of incidence below which all zeros are searched
LAST = 20  # bits that a last step of Newton's method may leave to rounding
STEPS = 4  # Newton steps with all digits


@dataclass(frozen=True)
class Bounce:
    """A bounce: component, parameter `theta`, exit angle, direction `v`, point, incidence angle, and `Status` code."""

    component: int
    theta: Any
    phi: Any
    v: tuple[Any, Any]
    x: Any
    y: Any
    eta: Any = None
    code: int = 0


class ExactMap:
    """The map in mpmath, to `digits` digits.

    `table` is a table, its name or a scene, with exact numbers; or a `PinballMap`, whose `lam` then is the double with
    which it computes, unless another `lam` is given.

    >>> exact = ExactMap("ellipse", a=2, lam="1/2", digits=30)
    >>> print(exact.bounce(exact.start(0, 0)).x)
    -2.0
    """

    def __init__(
        self, table: Any, digits: int = 50, lam: Any = None, *, law: Law | str | None = None, **shape: Any
    ) -> None:
        map, lam = float_map(table, lam, law, shape)
        self.map, self.context = map, mpmath.MPContext()
        self.context.dps = digits + GUARD
        self.digits = digits
        self.ops = Numbers(self.context)
        self.general = General(map.states.boundary)
        self.general.parts = map.ir.parts  # in the table's own lengths
        self.contraction = exact("lam", lam) if isinstance(lam, str) else map.lam.flat[0] if lam is None else lam
        self.lam = self.exactly(self.contraction)  # a float is the double it is
        self.law = map.law if map.law == FORMULA else law_of(float(map.lam.flat[0]), float(map.lam.flat[0]))
        self.formula = map.family.formula if map.law == FORMULA else None
        self.shape = [self.exactly(value) for value in map.exact_shape]
        parts = map.ir.parts
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in parts]
        self.general.ends = self.ends
        self.cusped = map.family.cusped
        self.landings, self.obstacles = Landings(map), Obstacles(map)
        programs = [part.curve for part in parts]
        self.curves, self.levels = Curves(programs, self.ops, self.shape), list[tuple[Any, Curves]]()
        for bits in precisions(self.context.prec)[:-1]:
            level = mpmath.MPContext()
            level.prec = bits
            self.levels.append((level, Curves(programs, Numbers(level), [level.mpf(value) for value in self.shape])))

    def __repr__(self) -> str:
        return f"ExactMap({self.map!r}, {self.digits}, {str(self.contraction)!r})"

    @cached_property
    def coarse(self) -> "ExactMap | None":
        """The same map to `COARSE` digits, for finding landings; None if this map itself has no more digits."""
        return ExactMap(self.map, COARSE, self.lam) if self.digits > COARSE else None

    def start(self, theta: Any, phi: Any, component: int = 0) -> Bounce:
        """The bounce at parameter `theta` with exit angle `phi`, both taken exactly."""
        mp, component = self.context, int(components(component, [part.name for part in self.map.ir.parts]))
        theta, phi = mp.mpf(theta), mp.mpf(phi)
        tx, ty, x, y = self._frame(component, theta)
        c, s = mp.cos(phi), mp.sin(phi)
        return Bounce(component, theta, phi, (s * tx - c * ty, s * ty + c * tx), x, y)

    def along(self, theta: Any, v: Sequence[Any], component: int = 0) -> Bounce:
        """The bounce at `theta` that leaves in the direction `v`, a vector of any length."""
        mp = self.context
        x, y = mp.mpf(v[0]), mp.mpf(v[1])
        tx, ty, px, py = self._frame(component, theta)
        size = mp.hypot(x, y)
        v = (x / size, y / size)
        return Bounce(component, theta, mp.atan2(v[0] * tx + v[1] * ty, v[1] * tx - v[0] * ty), v, px, py)

    def bounce(self, here: Bounce) -> Bounce:
        """The next bounce, after one flight and one reflection; `code` is not 0 if the particle stops."""
        mp = self.context
        if self.cusped and self._meets_the_cusp(here):
            return replace(here, eta=None, code=Status.CUSP.code)
        component, theta, code, (x, y, dx, dy) = self._guessed(here) or self._searched(here)
        if self.cusped and mp.cos(theta / 2) < NEAR:
            return replace(here, eta=None, code=Status.CUSP.code)
        vx, vy = here.v
        eta = -mp.atan2(vx * dx + vy * dy, vx * dy - vy * dx)
        phi = -self.lam * eta if self.formula is None else self._exit(eta, component, theta)
        c, s = self.ops.turned(phi)
        speed = mp.hypot(dx, dy)
        return Bounce(component, theta, phi, ((s * dx - c * dy) / speed, (s * dy + c * dx) / speed), x, y, eta, code)

    def _exit(self, eta: Any, component: int, theta: Any) -> Any:
        """The exit angle of a law other than `-lam*eta`."""
        assert self.formula is not None
        place = (theta, self.length(component, theta)) if self.formula.measured else (theta,)
        return self.formula.exit(self.ops, eta, self.lam, *place)[0]

    def length(self, component: int, theta: Any) -> Any:
        """Paper's arc length, to this map's precision; None on tables of several components without a closed form."""
        mp, map = self.context, self.map
        closed = closed_length(map, self.ops, self.shape, component, theta)
        if closed is not None:
            return closed
        if len(map.ir.parts) > 1:
            return None
        (zero,) = map.ir.origin[1](self.ops, *self.shape)
        found: arb = self.arclength(as_ball(mp.mpf(zero)), as_ball(mp.mpf(theta)))
        return self.middle(found)

    @cached_property
    def arclength(self) -> ExactArcLength:
        """The function for the length between two parameters, on a boundary of one component."""
        (part,), (ends,) = self.map.ir.parts, self.ends
        bits = self.context.prec
        with working(bits):
            low, high = exact_balls(ends)
            return ExactArcLength(part.curve, exact_balls(self.shape), (low, high), bits)

    def _guessed(self, here: Bounce) -> tuple[int, Any, int, Sequence[Any]] | None:
        """Component, parameter, status code and curve at the landing near the kernel's guess; None if unreliable."""
        guess = self.landings.guess(float(here.theta), float(here.phi), here.component)
        if guess is None:
            return None
        component, near = guess
        for level, curves in self.levels:
            x0, y0, vx, vy = (level.mpf(value) for value in (here.x, here.y, *here.v))
            theta = level.mpf(near)
            x, y, dx, dy = curves[component](theta)
            near = theta - (vx * (y - y0) - vy * (x - x0)) / (vx * dy - vy * dx)
        mp, (vx, vy), at = self.context, here.v, self.curves[component]
        theta = mp.mpf(near)
        for _ in range(STEPS):
            x, y, dx, dy = found = at(theta)
            wx, wy, arrival = x - here.x, y - here.y, vx * dy - vy * dx
            if not arrival > 0:
                return None
            step = (vx * wy - vy * wx) / arrival
            if abs(step) < mp.ldexp(1 + abs(theta), LAST - mp.prec):
                break
            theta -= step
        else:
            return None
        low, high = self.ends[component]
        away, speed = float(vx * wx + vy * wy), math.hypot(float(dx), float(dy))
        if not (low < theta < high and away > 0 and float(arrival) > STEEP * speed):
            return None
        start, end = (here.component, here.theta, here.x, here.y), (component, theta, x, y)
        return (component, theta, 0, found) if self.obstacles.passed(start, end) else None

    def _searched(self, here: Bounce) -> tuple[int, Any, int, Sequence[Any]]:
        """Component, parameter, status code and curve at the landing, found by the search for all zeros."""
        component, theta, code = self._landing(here)
        return component, theta, code, self.curves[component](theta)

    def _landing(self, here: Bounce) -> tuple[int, Any, int]:
        """Component and parameter of the first hit, and the code of its status."""
        mp = self.context
        if self.coarse is not None:
            component, theta, code = self.coarse._landing(here)
            sharp = None if code else self._sharpened(here, component, mp.mpf(theta))
            low, high = self.ends[component]
            if sharp is not None and low <= sharp <= high:
                return component, sharp, code
        state = [mp.mpf(here.component), mp.mpf(here.theta)], [mp.mpf(x) for x in here.v]
        landing = self.general.fly(self.ops, self.shape, "pinball", *state)
        return int(landing.position[0]), landing.position[1], int(landing.code or 0)

    def _meets_the_cusp(self, here: Bounce) -> bool:
        """Does the flight pass within `NEAR**2` of the origin, where the cardioid has its cusp?"""
        (x, y), (vx, vy) = (here.x, here.y), here.v
        return bool(x * vx + y * vy < 0 and abs(x * vy - y * vx) < NEAR * NEAR)

    def _sharpened(self, here: Bounce, component: int, theta: Any) -> Any:
        """The zero of the flight function near `theta`, by Newton's method from there; None if that fails."""
        mp, (vx, vy) = self.context, here.v

        def correction(at: Vector) -> Vector:
            x, y, dx, dy = self.curves[component](*at)
            return [(vx * (y - here.y) - vy * (x - here.x)) / (vx * dy - vy * dx)]

        enough = mp.mpf(10) ** (-mp.dps * 3 // 5)  # the next correction would be lost in rounding
        found = iterated(correction, [theta], Stop(enough=enough, steps=self.digits))
        return found.x[0] if found.settled and abs(found.x[0] - theta) < mp.mpf(10) ** -COARSE else None

    def orbit(self, here: Bounce, bounces: int) -> list[Bounce]:
        """The bounce `here` and the next `bounces` bounces; fewer if the particle stops."""
        orbit = [here]
        for _ in range(bounces):
            following = self.bounce(orbit[-1])
            if following.code:
                break
            orbit.append(following)
        return orbit

    def frame(self, component: int, theta: Any) -> Frame[Any]:
        """Point and unit tangent at a parameter, as a `Frame`."""
        tx, ty, x, y = self._frame(component, theta)
        return Frame(x, y, tx, ty)

    def _frame(self, component: int, theta: Any) -> tuple[Any, Any, Any, Any]:
        """Unit tangent and point at a parameter: four numbers."""
        x, y, dx, dy = self.curves[component](self.context.mpf(theta))
        speed = self.context.hypot(dx, dy)
        return dx / speed, dy / speed, x, y

    def middle(self, ball: Any) -> Any:
        """The midpoint of a ball of python-flint, as a number of mpmath."""
        man, exp = ball.mid().man_exp()
        return self.context.ldexp(self.context.mpf(int(man)), int(exp))

    def exactly(self, value: Any) -> Any:
        if isinstance(value, Fraction):
            return self.context.mpf(value.numerator) / value.denominator
        if hasattr(value, "evalf"):
            return self.context.mpf(str(value.evalf(self.context.dps)))
        return self.context.mpf(float(value))


def float_map(table: Any, lam: Any, law: Law | str | None, shape: Mapping[str, Any]) -> tuple[PinballMap, Any]:
    """The map in float64 of a table, a name or a scene, and its exact contraction; a map and `lam` stay unchanged."""
    if isinstance(table, PinballMap) and law is None and not shape:
        return table, lam
    scene = as_scene(table, lam=lam, law=law, **shape)
    return PinballMap(scene), scene.lam


def closed_length(map: PinballMap, ops: Any, shape: Sequence[Any], component: int, theta: Any) -> Any:
    """Arc length from the table's origin in elementary functions, summed over the components; None if impossible."""
    parts, length, law = map.ir.parts, map.family.arclength, map.family.formula
    if map.unit.length != 1 and not (law is not None and law.lengths):
        return None
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
    """The bounce in mpmath of a kernel's rounded state: `fields` are floats of 64 or 80 bits."""
    f = [_number(exact.context, x) for x in fields]
    component, theta = _place(map, exact, f)
    leaving = f[len(map.family.position) :]
    phi = map.family.exit(exact.ops, exact.frame(component, theta), leaving) if leaving else 0
    return exact.start(theta, phi, component)


def errors(map: PinballMap, exact: ExactMap, before: list[Array], after: list[Array]) -> tuple[Array, Array]:
    """Errors of position and direction of a float64 step, in units of 2**-52; infinite on a wrong component."""
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
            aim = family.exit_fields(ops, exact.frame(truth.component, truth.theta), truth.phi)
            direction[i] = exact.context.norm([x - y for x, y in zip(g[at:], aim, strict=True)]) / EPS
    return position, direction


def _number(mp: Any, x: Any) -> Any:
    """A float of 64 or 80 bits as an exact mpmath number."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - high))


def _place(map: PinballMap, exact: ExactMap, fields: list[Any]) -> tuple[int, Any]:
    """Component and parameter in a kernel's fields, as mpmath numbers."""
    component, theta = map.family.place(exact.ops, fields[: len(map.family.position)])
    return int(component), theta
