"""The cheapest arithmetic for an orbit: float64 while enough of its digits survive, else what the table says.

A bounce loses digits, as many as the decimal logarithm of what its derivative stretches by. The kernels say how many
an orbit loses; float64 keeps the rest of what one bounce promises.
"""

import math
from dataclasses import replace
from decimal import Decimal, InvalidOperation

import numpy as np

from numeric import PinballMap
from numeric.pinball.growth import Growth
from verification.work.choice import Choice, cheapest, table

WAYS = ("compiled kernel", "arb, certified")  # that say how many digits an orbit has left: mpmath's does not
LIKE = {"cardioid": "step-cardioid", "cuspless": "step-cardioid"}  # the measured bounce that a table's is most like
OTHERS = "step-egg"
LOOKS = 1000  # at an orbit
MOST_DIGITS = 10_000
HOPELESS = 400.0  # digits: an orbit that loses more is not followed to say how many


def for_orbit(
    map: PinballMap, start: tuple[int, float, float], bounces: int, digits: int, proof: bool = False
) -> Choice:
    """What to follow the ball from `start` (component, parameter, exit angle) with, to have `digits` at its end.

    >>> circle = PinballMap("circle", lam="0.5")
    >>> for_orbit(circle, (0, 0.3, 0.2), 10, 10).arithmetic, for_orbit(circle, (0, 0.3, 0.2), 10, 20).arithmetic
    ('float64', 'arb')
    """
    if bounces < 1:
        raise ValueError(f"bounces = {bounces} is out of range; accepted: at least 1")
    name = LIKE.get(map.family.name, OTHERS)
    lost = digits_lost(map, start, bounces)
    known = [entry for entry in table()[name] if entry.method in WAYS]
    if math.isinf(lost):
        enough = [entry for entry in known if entry.arithmetic != "float64"]
        choice = cheapest(name, digits, proof, enough)
        return _saying(choice, f"in float64 the ball stops or loses every digit within {bounces} bounces")
    rounded = math.ceil(lost)
    near = [e for e in known if e.arithmetic != "float64" or e.digits >= digits + rounded]
    return _saying(cheapest(name, digits, proof, near), f"digits lost in {bounces} bounces: {rounded}")


def digits_lost(map: PinballMap, start: tuple[int, float, float], bounces: int) -> float:
    """The decimal digits that a rounding error grows by on an orbit, wherever it is made; all when the orbit stops.

    It is the largest rise of the logarithm of a tangent vector's length, looked at so often and no oftener.
    """
    growth = Growth(map, *start)
    sizes, block = [0.0], max(1, bounces // LOOKS)
    for done in range(0, bounces, block):
        growth.advance(min(block, bounces - done))
        sizes.append(float(growth.stretch[0]))
    if int(growth.code[0]) != 0 or not np.all(np.isfinite(sizes)):
        return math.inf
    lost = float(np.max(sizes - np.minimum.accumulate(sizes))) / math.log(10)
    return math.inf if lost > HOPELESS else lost


def digits_for(tolerance: Decimal | float | str) -> int:
    """The decimal digits that keep an error below a tolerance.

    >>> digits_for(1e-12), digits_for(Decimal("3e-1000"))
    (12, 1000)
    """
    try:
        given = Decimal(str(tolerance))
    except InvalidOperation:
        given = Decimal("NaN")
    if not (given.is_finite() and Decimal(10) ** -MOST_DIGITS <= given < 1):
        raise ValueError(f"tolerance = {tolerance} is out of range; accepted: numbers from 1e-{MOST_DIGITS} to below 1")
    return max(1, -given.adjusted())


def _saying(choice: Choice, more: str) -> Choice:
    return replace(choice, why=f"{choice.why}; {more}")
