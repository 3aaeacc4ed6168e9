"""Orbits beyond float64: to a number of digits with mpmath, or enclosed in balls.

A ball orbit is proved bounce by bounce, for every start in the ball before: each landing lies in its
ball, and is the first hit (`EnclosedMap`). Where that cannot be proved the orbit ends with the status
`unproved`. How an orbit ends (a join, a cusp, a tangency) is what mpmath finds, and is not proved.
"""

from collections.abc import Callable, Sequence
from typing import Any

from flint import acb, arb, fmpq

from numeric import PinballMap, Status
from verification.arithmetic.words import bits_of, working
from verification.maps.enclosed import Balls, EnclosedMap, Refusal, number
from verification.maps.exact import ExactMap

TRIES = 8  # doublings of the precision before giving up
Step = Callable[[str], None]
Start = tuple[int, Any, Any]  # component, theta and phi, exactly


def in_multiprecision(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step
) -> list[dict[str, Any]]:
    """The orbit computed with mpmath; rounding errors grow as the orbit's own instability makes them."""
    exact = ExactMap(map, digits, lam)
    mp = exact.context
    turns = _turns(map, start)
    ball = exact.ball(start[0], exact.exactly(start[1]) - 2 * turns * mp.pi, exact.exactly(start[2]))
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


def in_balls(map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step) -> list[dict[str, Any]]:
    """The orbit enclosed to `digits` digits, which count from the point where a number is below one."""
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
    enclosed = EnclosedMap(map, lam, bits)
    names = [part.name for part in map.blueprint.parts]
    entries: list[dict[str, Any]] = []
    with working(bits):
        theta = number(start[1], bits) - 2 * _turns(map, start) * arb.pi()
    ball = enclosed.ball(start[0], theta, start[2])
    for i in range(bounces + 1):
        if i:
            following = enclosed.bounce(ball)
            if following is Refusal.WIDE:
                return None
            if isinstance(following, Refusal) or following.code:
                status = "unproved" if isinstance(following, Refusal) else list(Status)[following.code].name.lower()
                entries.append(entries[-1] | {"eta": None, "status": status})
                break
            ball = following
            step(str(i))
        with working(bits):
            s = _enclosed_length(enclosed, ball.component, ball.theta, digits)
            numbers = (ball.theta, s, ball.x, ball.y, ball.eta, ball.phi)
            texts = [None if n is None else _text(n, digits) for n in numbers]
        if "" in texts:
            return None
        entries.append(_entry(names[ball.component], texts))
    return entries


def _turns(map: PinballMap, start: Start) -> int:
    """The whole turns by which a start on a closed curve lies beyond the range of its parameter."""
    low, high = map.states.ends[start[0]]
    theta = float(start[1])
    return 0 if len(map.states.ends) > 1 or low <= theta <= high else round((theta - (low + high) / 2) / (high - low))


def _text(number: arb, digits: int) -> str:
    """A ball's middle, of whose digits the last is off by one at most; empty when the ball is too wide for `digits`.

    Digits count from the point where a number is below one, and what is below all of them is 0.
    """
    size = max(1.0, float(abs(number.mid())))
    if not number.rad() < arb(10) ** (-digits) * size:
        return ""
    if abs(number) < arb(10) ** -digits:
        return "0"
    known = digits if number.is_exact() else min(digits, int(0.301 * (number.rel_accuracy_bits() - 2)))
    return str(number.mid().str(known, radius=False)) if known > 0 else ""


def _enclosed_length(enclosed: EnclosedMap, component: int, theta: arb, digits: int) -> Any:
    """The paper's arc length, by rigorous integration of the speed where there is no closed form."""
    closed = _closed_length(enclosed.map, enclosed.ops, enclosed.shape, component, theta)
    if closed is not None:
        return closed
    if len(enclosed.parts) > 1:
        return None
    boxed = [acb(x) for x in enclosed.shape]

    def speed(z: acb, analytic: bool) -> Any:
        _, _, dx, dy, _, _ = enclosed.parts[component](_Complex(), z, *boxed)
        return (dx * dx + dy * dy).sqrt(analytic=analytic)

    with working(bits_of(digits, 40)):
        return acb.integral(speed, acb(0), acb(theta)).real


class _Complex(Balls):
    def constant(self, p: int, q: int = 1) -> Any:
        return acb(fmpq(p, q))

    def pi(self) -> Any:
        return acb.pi()


def _length(exact: ExactMap, map: PinballMap, component: int, theta: Any) -> Any:
    """The paper's arc length to mpmath's precision."""
    mp = exact.context
    closed = _closed_length(map, exact.ops, exact.shape, component, theta)
    if closed is not None:
        return closed
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


def _closed_length(map: PinballMap, ops: Any, shape: Sequence[Any], component: int, theta: Any) -> Any:
    """Arc length from the table's origin in elementary functions, component by component; None where there is none."""
    parts, length = map.blueprint.parts, map.family.arclength
    index, start = map.blueprint.origin
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
    raise ValueError(f"{map.blueprint.table} has no component {component}")


def _entry(name: str, texts: list[str | None]) -> dict[str, Any]:
    theta, s, x, y, eta, phi = texts
    return {"component": name, "theta": theta, "s": s, "x": x, "y": y, "eta": eta, "phi": phi, "status": "regular"}
