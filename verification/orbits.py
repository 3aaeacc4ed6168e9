"""Orbits beyond float64: to a number of digits with mpmath, or enclosed in balls.

A ball orbit is certified bounce by bounce: an interval Newton step on the flight function proves
that the landing parameter lies in its ball, for every start in the ball before. That it is the first
hit is certain on convex tables, where a line has only one other end; elsewhere it rests on mpmath.
"""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from numeric import PinballMap, Status
from numeric.readers.scalars import Scalars
from verification.arithmetic import bits_of, working
from verification.balls import decimal, enclose
from verification.exact_map import ExactMap

TRIES = 8  # doublings of the precision before giving up
Step = Callable[[str], None]
Start = tuple[int, Any, Any]  # component, theta and phi, exactly


def in_multiprecision(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step
) -> list[dict[str, Any]]:
    """The orbit computed with mpmath; rounding errors grow as the orbit's own instability makes them."""
    exact = ExactMap(map, digits, lam)
    mp = exact.context
    ball = exact.ball(start[0], exact.exactly(start[1]), exact.exactly(start[2]))
    names = [part.name for part in map.blueprint.parts]
    entries: list[dict[str, Any]] = []
    for i in range(bounces + 1):
        if i:
            following = exact.bounce(ball)
            if following.code:
                entries.append(entries[-1] | {"eta": None, "status": list(Status)[following.code].name.lower()})
                break
            ball = following
            step(str(i))
        numbers = (ball.theta, _length(exact, map, ball.component, ball.theta), ball.x, ball.y, ball.eta, ball.phi)
        texts = [None if x is None else mp.nstr(x, digits) for x in numbers]
        entries.append(_entry(names[ball.component], texts))
    return entries


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


def in_balls(map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step) -> list[dict[str, Any]]:
    """The orbit in balls of radius below `10**-digits`, relative where a number exceeds one."""
    bits = bits_of(digits, 64 + 4 * bounces)
    for _ in range(TRIES):
        found = _attempt(map, lam, start, bounces, digits, bits, step)
        if found is not None:
            return found
        bits *= 2
    raise ValueError(f"--digits = {digits}: {bits // 2} bits do not enclose {bounces} bounces; ask for fewer of either")


def _attempt(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, bits: int, step: Step
) -> list[dict[str, Any]] | None:
    exact = ExactMap(map, int(bits / 3.3219), lam)
    mp, ops = exact.context, Balls()
    names = [part.name for part in map.blueprint.parts]
    with working(bits):
        shape = [_ball(value) for value in map.exact_shape]
        wanted = int(bits / 3.3219)
        component, at, out, eta = start[0], _ball(start[1], wanted), _ball(start[2], wanted), None
        entries: list[dict[str, Any]] = []
        for i in range(bounces + 1):
            if i:
                middle = exact.ball(component, _middle(mp, at), _middle(mp, out))
                guess = exact.bounce(middle)
                if guess.code:
                    entries.append(entries[-1] | {"eta": None, "status": list(Status)[guess.code].name.lower()})
                    break
                flown = _flown(map, ops, shape, (component, at, out), (guess.component, _arb(mp, guess.theta)))
                if flown is None:
                    return None
                component, (at, eta) = guess.component, flown
                out = -_ball(lam, wanted) * eta
                step(str(i))
            x, y, *_ = map.blueprint.parts[component].curve(ops, at, *shape)
            numbers = (at, _enclosed_length(map, ops, shape, component, at), x, y, eta, out)
            if any(n is not None and not _sharp(n, digits) for n in numbers):
                return None
            entries.append(_entry(names[component], [None if n is None else decimal(n, digits)[0] for n in numbers]))
    return entries


def _flown(
    map: PinballMap, ops: Balls, shape: list[Any], start: Start, guess: tuple[int, arb]
) -> tuple[arb, arb] | None:
    """Landing parameter and incidence, enclosed; None when Newton's step does not close."""
    component, at, out = start
    x0, y0, dx, dy, _, _ = map.blueprint.parts[component].curve(ops, at, *shape)
    speed = (dx * dx + dy * dy).sqrt()
    tx, ty = dx / speed, dy / speed
    c, s = out.cos(), out.sin()
    vx, vy = s * tx - c * ty, s * ty + c * tx
    landing, middle = guess
    curve = map.blueprint.parts[landing].curve

    def flight(theta: arb) -> tuple[arb, arb]:
        x, y, dx, dy, _, _ = curve(ops, theta, *shape)
        return vx * (y - y0) - vy * (x - x0), vx * dy - vy * dx

    slope = flight(middle)[1]
    if not (slope > 0 or slope < 0):
        return None
    radius = abs(flight(middle)[0] / slope) * 4
    box = arb(middle.mid(), radius.upper()) if radius.is_finite() else None
    if box is None:
        return None
    newton = middle - flight(middle)[0] / flight(box)[1]
    if not box.contains_interior(newton):
        return None
    _, _, dx, dy, _, _ = curve(ops, newton, *shape)
    return newton, -(arb.atan2(vx * dx + vy * dy, vx * dy - vy * dx))


def _sharp(number: arb, digits: int) -> bool:
    size = max(1.0, float(abs(number.mid())))
    return bool(number.rad() < arb(10) ** (-digits) * size)


def _enclosed_length(map: PinballMap, ops: Balls, shape: list[Any], component: int, theta: arb) -> Any:
    """The paper's arc length, by rigorous integration of the speed where there is no closed form."""
    name = map.family.name
    if name == "circle" or (name == "cuspless" and component == 1):
        return theta
    if name in ("cardioid", "cuspless"):
        length = 4 * (theta / 2).sin()
        return length + 9 * arb(3).sqrt() / 4 if name == "cuspless" else length
    if len(map.blueprint.parts) > 1:
        return None
    curve = map.blueprint.parts[component].curve
    boxed = [acb(x) for x in shape]

    def speed(z: acb, analytic: bool) -> Any:
        _, _, dx, dy, _, _ = curve(_Complex(), z, *boxed)
        return (dx * dx + dy * dy).sqrt(analytic=analytic)

    return acb.integral(speed, acb(0), acb(theta)).real


class _Complex(Balls):
    def constant(self, p: int, q: int = 1) -> Any:
        return acb(fmpq(p, q))

    def pi(self) -> Any:
        return acb.pi()


def _length(exact: ExactMap, map: PinballMap, component: int, theta: Any) -> Any:
    """The paper's arc length to mpmath's precision."""
    mp, name = exact.context, map.family.name
    if name == "circle" or (name == "cuspless" and component == 1):
        return theta
    if name in ("cardioid", "cuspless"):
        return 4 * mp.sin(theta / 2) + (9 * mp.sqrt(3) / 4 if name == "cuspless" else 0)
    if map.blueprint.table == "ellipse" and exact.shape:
        return mp.ellipe(theta, 1 - exact.shape[0] ** 2)
    if len(map.blueprint.parts) > 1:
        return None
    curve = map.blueprint.parts[component].curve

    def speed(at: Any) -> Any:
        _, _, dx, dy, _, _ = curve(exact.ops, at, *exact.shape)
        return mp.hypot(dx, dy)

    pieces = [theta * k / 8 for k in range(9)]
    return mp.quad(speed, pieces)


def _entry(name: str, texts: list[str | None]) -> dict[str, Any]:
    theta, s, x, y, eta, phi = texts
    return {"component": name, "theta": theta, "s": s, "x": x, "y": y, "eta": eta, "phi": phi, "status": "regular"}


def _ball(value: Any, digits: int = 0) -> arb:
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    if isinstance(value, float):
        return arb(value)
    return enclose(value, digits=digits).real


def _middle(mp: Any, ball: arb) -> Any:
    man, exp = ball.mid().man_exp()
    return mp.ldexp(mp.mpf(int(man)), int(exp))


def _arb(mp: Any, x: Any) -> arb:
    sign, man, exp, _ = x._mpf_
    return arb(-int(man) if sign else int(man)) * arb(2) ** int(exp)
