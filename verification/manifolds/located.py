"""A crisis of the egg to many digits, by two methods that share nothing but the chord.

The value comes from the fold of a long cycle that shadows the tangency (`shadows`): its distance to
the tangency falls like `unstable**-rounds`, and a cycle with four rounds more tells how far the
shorter one was. The tangency of the manifolds themselves (`tangency`) has to agree.
"""

import math
from dataclasses import dataclass
from typing import Any

import mpmath
from sympy import Expr

from verification.manifolds.claim import TangencyClaim, TangencyProof, worked_through
from verification.manifolds.known import contact, table
from verification.manifolds.proof import LEAST_DIGITS, sharpened
from verification.manifolds.shadows import Shadow, shadow
from verification.manifolds.tangency import Touch, tangency
from verification.shooting.newton import refined

MOST_DIGITS = 500
MANIFOLD_DIGITS = 20  # asked of the second method at most
SPARE = 4  # rounds by which the second cycle is longer


@dataclass(frozen=True)
class Crisis:
    """`letter +- error` and how it was found; `apart` is how far the two methods are from each other."""

    kind: str
    letter: Any
    error: Any
    touch: Touch
    apart: float
    cycle: Shadow

    @property
    def period(self) -> int:
        """Bounces of the cycle before it repeats, or repeats as its mirror image."""
        return self.cycle.problem.period

    @property
    def agrees(self) -> bool:
        """Do the two methods agree within their errors?"""
        return self.apart <= 10 * self.touch.error + float(self.error)

    @property
    def exponent(self) -> float:
        """Of the mean transient above a homoclinic crisis [GrebogiOttRomeirasYorke1987]."""
        return homoclinic_exponent(self.touch.multipliers[0], self.touch.multipliers[1])


def homoclinic_exponent(stable: float, unstable: float) -> float:
    """`ln|stable| / (2*ln|stable*unstable|)`, reached in the limit; at a finite distance see `local_exponent`.

    >>> homoclinic_exponent(1 / 16, 4)
    1.0
    """
    return math.log(abs(stable)) / (2 * math.log(abs(stable * unstable)))


def heteroclinic_exponent(stable: float, unstable: float) -> float:
    """`1/2 + ln|unstable|/|ln|stable||`, of the saddle inside the attractor.

    >>> heteroclinic_exponent(1 / 16, 4)
    1.0
    """
    return 0.5 + math.log(abs(unstable)) / abs(math.log(abs(stable)))


def crisis(kind: str, alpha: Expr, digits: int) -> Crisis:
    """The `merging` or the `boundary` crisis of the three-pointed egg to `digits` digits, not proved.

    >>> from sympy import Rational
    >>> mpmath.nstr(crisis("boundary", Rational(2, 25), 10).letter, 10)
    '0.6621442734'
    """
    if digits > MOST_DIGITS:
        raise ValueError(f"{kind} crisis: digits = {digits} is out of range; accepted: up to {MOST_DIGITS}")
    map = table(alpha)
    where = contact(kind, alpha)
    touch = tangency(where, map, min(digits, MANIFOLD_DIGITS))
    unstable = abs(touch.multipliers[1])
    rounds = math.ceil((digits + 2) * math.log(10) / math.log(unstable))
    found = []
    for more in (0, SPARE):
        cycle = shadow(where, map, float(touch.letter), rounds + more)
        found.append(refined(cycle.problem, cycle.start, digits + 5).z[-1])
    context = mpmath.MPContext()
    context.dps = digits + 10
    short, letter = found
    error = abs(context.mpf(letter) - context.mpf(short)) + context.mpf(10) ** -(digits + 2)
    return Crisis(kind, context.mpf(letter), error, touch, float(abs(context.mpf(touch.letter) - letter)), cycle)


def proof(found: Crisis, alpha: Expr, digits: int) -> TangencyProof:
    """The proof in balls of a tangency near the value, within `10**-digits` or less.

    It proves the contact of the manifolds, and not that the attractor ends there.
    """
    digits, map, touch = max(LEAST_DIGITS, digits), table(alpha), found.touch
    try:
        value = sharpened(touch.contact, map, str(touch.letter), digits)
    except (ValueError, ArithmeticError):  # then no proof succeeds either; which step fails the checks tell
        value = str(touch.letter)
    return worked_through(TangencyClaim(touch.contact, alpha, value, digits))


def decimals(found: Crisis) -> tuple[str, str]:
    """The value and its error as decimals, all digits of both."""
    return str(found.letter), mpmath.nstr(found.error, 3)
