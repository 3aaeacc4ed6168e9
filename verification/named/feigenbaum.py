"""The end of a period-doubling cascade: `delta` and `lambda_infinity`, estimated and not certified.

Two schemes that share no assumption but geometric convergence: Wynn's epsilon algorithm on the
sequence itself, and Aitken's process on what is left after the leading term has been removed with
the universal constant of [Feigenbaum1979]. Their difference is the error that is stated.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mpmath
from sympy import Expr

from verification.arithmetic.balls import decimal
from verification.cycles.recurrence.cascade import doubling
from verification.named.locate import certify

DELTA = "4.669201609102990671853203820466201617258185577475768632745651343"  # [Feigenbaum1979]; OEIS A006890
DIGITS = 60
EACH = 50  # digits of each doubling


@dataclass(frozen=True)
class Estimate:
    """A limit, and the largest difference from other ways to it, as mpmath numbers."""

    value: Any
    error: Any


def limit(values: Sequence[str]) -> Estimate:
    """The limit of `lambda_n`, given as decimals.

    >>> found = limit([str(1 - mpmath.mpf(4.669201609) ** -n) for n in range(3, 12)])
    >>> abs(found.value - 1) < 1e-12
    True
    """
    context = mpmath.MPContext()
    context.dps = DIGITS
    given = [context.mpf(v) for v in values]
    delta = context.mpf(DELTA)
    removed = [(delta * b - a) / (delta - 1) for a, b in pairwise(given)]
    return _compared(wynn(given), wynn(removed))


def ratio(values: Sequence[str]) -> Estimate:
    """The limit of `(lambda_n - lambda_(n-1))/(lambda_(n+1) - lambda_n)`: an estimate of `delta`.

    >>> found = ratio([str(1 - mpmath.mpf(3) ** -n) for n in range(3, 12)])
    >>> abs(found.value - 3) < 1e-9
    True
    """
    context = mpmath.MPContext()
    context.dps = DIGITS
    gaps = [b - a for a, b in pairwise(context.mpf(v) for v in values)]
    ratios = [a / b for a, b in pairwise(gaps)]
    return _compared(wynn(ratios), aitken(ratios), wynn(ratios[:-1]))  # on four terms the first two are one


def _compared(one: Any, *others: Any) -> Estimate:
    return Estimate(one, max(abs(one - other) for other in others))


def wynn(values: Sequence[Any]) -> Any:
    """The last even entry of Wynn's epsilon table.

    >>> wynn([1, 1.5, 1.75, 1.875])
    2.0
    """
    before: list[Any] = [0] * (len(values) + 1)
    here = list(values)
    best = here[-1]
    for order in range(1, len(values)):
        differences = [b - a for a, b in pairwise(here)]
        if any(d == 0 for d in differences):
            return best
        before, here = here, [before[i + 1] + 1 / d for i, d in enumerate(differences)]
        if order % 2 == 0:
            best = here[-1]
    return best


def aitken(values: Sequence[Any]) -> Any:
    """Aitken's process, repeated as long as three terms are left."""
    here = list(values)
    while len(here) >= 3:
        following = []
        for a, b, c in zip(here, here[1:], here[2:], strict=False):
            if c - 2 * b + a == 0:
                return c
            following.append(c - (c - b) ** 2 / (c - 2 * b + a))
        here = following
    return here[-1]


@dataclass(frozen=True)
class Accumulation:
    """The certified doublings of a cascade as decimals, and the estimates of where and how it ends.

    `supercritical`: each bears a stable cycle, by the sign of its normal form in balls.
    """

    lams: tuple[str, ...]
    supercritical: bool
    limit: Estimate
    ratio: Estimate


def accumulation(alpha: Expr, highest: int = 10) -> Accumulation:
    """The cascade of the egg up to `lambda_highest`, each doubling certified to 50 digits, and its end.

    >>> from sympy import Rational
    >>> found = accumulation(Rational(2, 25), 8)
    >>> mpmath.nstr(found.limit.value, 8), found.limit.error < 1e-7
    ('0.39352047', True)
    """
    lams, stable = [], True
    for n in range(3, highest + 1):
        here = doubling(alpha, n)
        proof = certify(here.problem, here.start, EACH)
        if not proof.certified:
            raise ValueError(f"cascade: lambda_{n} at alpha = {alpha} is not certified: {proof.checks}")
        lams.append(decimal(proof.value, EACH)[0])
        stable = stable and proof.supercritical is True
    return Accumulation(tuple(lams), stable, limit(lams), ratio(lams))
