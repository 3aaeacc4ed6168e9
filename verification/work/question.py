"""What is asked and in how many ways it can be answered: questions, methods, and the distance of an answer.

An answer is a list of numbers of any kind. Its error is the largest distance of one of them from the reference,
a list of balls; the radius of the reference counts, so no error is understated.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from flint import arb, fmpq

from verification.arithmetic import bits_of, working

COUNTS = ("balls", "points")  # the units of settings that say how many answers a call gives
GUARD = 20  # digits of a reference beyond the most that are asked for
Answer = Sequence[Any]


class Claimed(list[Any]):
    """An answer that states its own error, as an error bar does."""

    def __init__(self, numbers: Answer, claim: float) -> None:
        super().__init__(numbers)
        self.claim = Decimal(f"{claim:.3g}")


@dataclass(frozen=True)
class Method:
    """One way to answer: `call(setting)` for each setting of a ladder, from quick to exact.

    `unit` says what a setting is (`digits`, `xtol`, `bounces`), `promise(setting)` the largest error that the way
    claims for itself, None when it claims none. A call gives `per` answers at a time, or as many as the setting says
    where that counts balls or points. A method that is `elsewhere` is run by another process of its own.
    """

    name: str
    arithmetic: str
    unit: str
    ladder: tuple[Any, ...]
    call: Callable[[Any], Answer]
    promise: Callable[[Any], Decimal | None] = lambda setting: None
    per: int = 1
    textbook: bool = False
    proved: bool = False
    elsewhere: bool = False

    def labelled(self, setting: Any) -> str:
        """A setting in words.

        >>> Method("m", "a", "digits", (), list).labelled(30), Method("m", "a", "xtol", (), list).labelled(1e-8)
        ('30 digits', 'xtol 1e-08')
        """
        if isinstance(setting, float):
            return f"{self.unit} {setting:g}"
        return f"{setting:,} {self.unit}" if not isinstance(setting, str) else setting

    def answers(self, setting: Any) -> int:
        """How many answers a call gives."""
        return int(setting) if self.unit in COUNTS else self.per

    def within(self, most_digits: int) -> tuple[Any, ...]:
        """The settings that ask for no more digits than that."""
        return tuple(s for s in self.ladder if self.unit != "digits" or s <= most_digits)


@dataclass(frozen=True)
class Question:
    """A question with its reference: `reference(digits)` are balls of radius below `10**-digits`, proved.

    Where no proof is known `certified` is False, and the balls hold what was measured with its error.
    `answers` says what the numbers are, `unit` in what the error is.
    """

    name: str
    title: str
    answers: str
    unit: str
    reference: Callable[[int], Answer]
    methods: tuple[Method, ...]
    certified: bool = True
    most_digits: int = 1000


def enclosed(value: Any) -> arb:
    """A number of any kind as a ball that contains it, in the ambient precision.

    >>> enclosed(0.5) == enclosed(Fraction(1, 2)) == enclosed("0.5") == enclosed(np.longdouble("0.5"))
    True
    """
    if isinstance(value, arb):
        return value
    if isinstance(value, mpmath.ctx_mp_python._mpf):
        sign, mantissa, exponent, _ = value._mpf_
        return arb((-int(mantissa) if sign else int(mantissa), int(exponent)))
    if isinstance(value, np.longdouble):
        value = Fraction(*value.as_integer_ratio()) if np.isfinite(value) else float(value)
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    return arb(value) if isinstance(value, str) else arb(float(value))


def distance(answer: Answer, reference: Answer, digits: int) -> tuple[Decimal | None, Decimal | None]:
    """The largest distance of an answer from the reference: at least, and at most; None when a number is not finite.

    >>> distance([0.5, 1], [arb("0.5"), arb("1.25")], 10)
    (Decimal('0.2500'), Decimal('0.2500'))
    """
    if len(answer) != len(reference):
        raise ValueError(f"answer: {len(answer)} numbers where the reference has {len(reference)}")
    largest = least = arb(0)
    with working(bits_of(digits + GUARD, 64)):
        for value, truth in zip(answer, reference, strict=True):
            gap = abs(enclosed(value) - truth)
            if not gap.is_finite():
                return None, None
            largest, least = largest.max(arb(gap.abs_upper())), least.max(arb(gap.abs_lower()))
        return Decimal(least.str(4, radius=False)), Decimal(largest.str(4, radius=False))


def power(exponent: float) -> Decimal:
    """`10**exponent`, which need not be a float.

    >>> power(-1000)
    Decimal('1E-1000')
    """
    return Decimal(10) ** Decimal(exponent) if exponent != int(exponent) else Decimal(1).scaleb(int(exponent))
