"""Orbits with a given number of correct digits, as tables of text: in mpmath, or enclosed in balls.

An orbit loses digits where its flights spread errors. In mpmath the derivatives along the float64 orbit give the number
of digits to add; if those along the new orbit ask for more, it is computed again. The radii of balls show the loss: an
attempt that ends too soon gives the number of bits lost per bounce.
"""

from collections.abc import Callable, Sequence
from math import ceil, log
from typing import Any

import numpy as np
from flint import arb

from numeric import PinballMap
from numeric.pinball.states import KEYS, STATUSES
from verification.arithmetic.balls import bits_of, working
from verification.maps.enclosed import EnclosedMap, Refusal, number
from verification.maps.exact import Bounce, ExactMap
from verification.maps.flight import Landings

Step = Callable[[str], None]
Start = tuple[Any, Any, int]  # theta and phi, exactly, and the component
Entries = list[dict[str, Any]]

SPARE = 10  # extra digits in mpmath, which rounding may take
FIRST = 64  # balls have at first EACH bits for each of so many bounces, and MORE
EACH, MORE = 4, 64
TRIES = 8  # precisions before giving up
AGAIN = 1.1  # times the bits that an attempt shows to be needed


def in_multiprecision(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step, fields: Sequence[str] = KEYS
) -> Entries:
    """The orbit in mpmath, with as many extra digits as its instability loses, so that `digits` are correct.

    The arc length `s`, the length `flight` of the last flight and the `time` since the start are computed only if they
    are among the `fields`. `step` is called with the number of each bounce, for a progress bar.
    """
    lost = _lost_in_float64(map, start, bounces)
    while True:
        exact = ExactMap(map, digits + lost, lam)
        orbit, ended = _computed(exact, start, bounces, step)
        if (more := digits_lost(map, [(b.component, float(b.theta), float(b.phi)) for b in orbit])) <= lost + SPARE:
            break
        lost = more + SPARE
    mp, entries = exact.context, Entries()
    names = [part.name for part in map.ir.parts]
    flight, time = None, mp.zero
    for i, here in enumerate(orbit):
        if i and ("flight" in fields or "time" in fields):
            flight = mp.hypot(here.x - orbit[i - 1].x, here.y - orbit[i - 1].y)
            time += flight
        s = exact.length(here.component, here.theta) if "s" in fields else None
        texts = [None if x is None else mp.nstr(x, digits) for x in (s, flight, time, *_numbers(here))]
        entries.append(_entry(names[here.component], texts, fields))
    return entries + ([_stopped(entries[-1], STATUSES[ended].name.lower())] if ended else [])


def _computed(exact: ExactMap, start: Start, bounces: int, step: Step) -> tuple[list[Bounce], int]:
    """The start and the bounces after it, and the status code of the outcome that ended the orbit, or 0."""
    theta, phi, component = start
    turned = _turned(exact.map, start, exact.exactly(theta), exact.ends[component], 2 * exact.context.pi)
    orbit = [exact.start(turned, exact.exactly(phi), component)]
    for i in range(bounces):
        following = exact.bounce(orbit[-1])
        if following.code:
            return orbit, following.code
        orbit.append(following)
        step(str(i + 1))
    return orbit, 0


def _lost_in_float64(map: PinballMap, start: Start, bounces: int) -> int:
    """The digits that the float64 orbit loses, extrapolated to `bounces` if it stops too soon."""
    orbit = map.orbit(float(start[0]), float(start[1]), bounces, start[2])
    made = int(np.argmax(np.append(orbit.code, 1) != 0))  # bounces that are regular, and the start
    lost = digits_lost(map, list(zip(*(field[:made].tolist() for field in orbit[:2]), orbit.phi[:made], strict=True)))
    return ceil(lost * bounces / max(made - 1, 1))


def digits_lost(map: PinballMap, states: Sequence[tuple[int, float, float]]) -> int:
    """The largest number of decimal digits by which an error made anywhere on an orbit grows.

    `states` are component, parameter and exit angle, bounce by bounce. The number is the largest rise of the logarithm
    of a tangent vector's length.

    >>> egg = PinballMap("egg", alpha="0.08", lam="0.5")
    >>> orbit = egg.orbit(0.3, 0.2, 100)
    >>> 10 < digits_lost(egg, list(zip(orbit.component, orbit.theta, orbit.phi))) < 30
    True
    """
    component, theta, phi = (np.array(field) for field in zip(*states, strict=True))
    map = Landings(map).map
    low, high = np.array(map.states.ends)[component].T
    steep = np.nextafter(np.pi / 2, 0)
    matrices = map.derivative(np.clip(theta, low, high), np.clip(phi, -steep, steep), component)
    vector, grown, least, rise = np.array([1.0, 1.0]), 0.0, 0.0, 0.0
    for matrix in matrices[:-1]:
        vector = matrix @ vector
        size = float(np.max(np.abs(vector)))
        if not 0 < size < np.inf:
            break
        vector, grown = vector / size, grown + log(size)
        least = min(least, grown)
        rise = max(rise, grown - least)
    return ceil(rise / log(10))


def in_balls(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step, fields: Sequence[str] = KEYS
) -> Entries:
    """The orbit enclosed in balls, to `digits` digits, or decimals for numbers below one; one row per bounce."""
    bits = bits_of(digits, MORE + EACH * min(bounces, FIRST))
    for _ in range(TRIES):
        entries, last = _attempt(map, lam, start, bounces, digits, bits, step, fields)
        if last is None:
            return entries
        tried, made = bits, len(entries)
        spent = max(bits - min(bits, _bits_known(x)) for x in (last.theta, last.phi))
        bits = max(tried + tried // 4, bits_of(digits, MORE + ceil(AGAIN * spent * bounces / max(made, 1))))
    raise ValueError(f"--digits = {digits}: {tried} bits do not enclose {bounces} bounces; ask for fewer of either")


def _bits_known(ball: arb) -> int:
    """The number of bits after the binary point that a ball's radius leaves known; 2**30 for an exact ball."""
    mantissa, exponent = ball.rad().man_exp()
    return -int(exponent) - int(mantissa).bit_length() if mantissa != 0 else 1 << 30


def _attempt(
    map: PinballMap,
    lam: Any,
    start: Start,
    bounces: int,
    digits: int,
    bits: int,
    step: Step,
    fields: Sequence[str] = KEYS,
) -> tuple[Entries, Bounce | None]:
    """The orbit with `bits` bits, and its last bounce if the bits are too few, else None."""
    enclosed = EnclosedMap(map, lam, bits)
    names = [part.name for part in map.ir.parts]
    entries = Entries()
    with working(bits):
        theta = _turned(map, start, number(start[0], bits), enclosed.ends[start[2]], 2 * arb.pi())
    here = enclosed.start(theta, *start[1:])
    flight, time = None, arb(0)
    for i in range(bounces + 1):
        if i:
            following = enclosed.bounce(here)
            if following is Refusal.WIDE:
                return entries, here
            if isinstance(following, Refusal) or following.code:
                status = "unproved" if isinstance(following, Refusal) else STATUSES[following.code].name.lower()
                entries.append(_stopped(entries[-1], status))
                break
            if "flight" in fields or "time" in fields:
                with working(bits):
                    flight = ((following.x - here.x) ** 2 + (following.y - here.y) ** 2).sqrt()
                    time += flight
            here = following
            step(str(i))
        with working(bits):
            s = enclosed.length(here.component, here.theta, digits) if "s" in fields else None
            texts = [None if n is None else text_of(n, digits) for n in (s, flight, time, *_numbers(here))]
        if "" in texts:
            return entries, here
        entries.append(_entry(names[here.component], texts, fields))
    return entries, None


def _turned(map: PinballMap, start: Start, theta: Any, ends: tuple[Any, Any], turn: Any) -> Any:
    """The start's parameter, on a closed curve less the whole turns by which it is outside of its range."""
    if not map.states.boundary.closed:
        return theta
    low, high = map.states.ends[start[2]]
    theta = theta - turn * round((float(start[0]) - (low + high) / 2) / (high - low))
    return theta - turn if theta > ends[1] else theta + turn if theta < ends[0] else theta  # what float64 cannot tell


def text_of(number: arb, digits: int) -> str:
    """The digits of a ball's midpoint, the last one off by at most one; empty when the ball is too wide for `digits`.

    For a number below one, digits after the point are counted; a number smaller than all of them is shown as 0.
    """
    size = max(1.0, float(abs(number.mid())))
    if not number.rad() < arb(10) ** (-digits) * size:
        return ""
    if abs(number) < arb(10) ** -digits:
        return "0"
    known = digits if number.is_exact() else min(digits, int(0.301 * (number.rel_accuracy_bits() - 2)))
    return str(number.mid().str(known, radius=False)) if known > 0 else ""


def _numbers(here: Bounce) -> tuple[Any, ...]:
    return here.theta, here.x, here.y, here.eta, here.phi


def _entry(name: str, texts: Sequence[str | None], fields: Sequence[str]) -> dict[str, Any]:
    s, flight, time, theta, x, y, eta, phi = texts
    entry = {"component": name, "theta": theta, "s": s, "x": x, "y": y, "eta": eta, "phi": phi, "status": "regular"}
    entry |= {"flight": flight, "time": time}
    return {key: value for key, value in entry.items() if key in fields or key not in ("s", "flight", "time")}


def _stopped(last: dict[str, Any], status: str) -> dict[str, Any]:
    """The row of a particle that stops: the position of its last bounce and the name of the outcome."""
    return last | {"eta": None, "status": status}
