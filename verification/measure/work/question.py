"""Benchmark problems: a question with its reference value, the methods that answer it, and rows of error and time.

An answer is a list of numbers of any kind. Its error is the largest distance of one of them from the reference,
a list of balls; the radius of the reference counts, so no error is understated. Times are processor time of one core,
which other work on the machine disturbs least; of several runs the median counts.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from flint import arb, fmpq

from verification.arithmetic.balls import as_ball, bits_of, decimal, working
from verification.arithmetic.iteration import silent
from verification.measure.work.row import MethodResult, timed

COUNTS = ("particles", "points")  # the units of settings that say how many answers a call gives
TOLERANCES = ("xtol", "epsabs")  # the units of settings that are the error
SHOWN = 3  # numbers of a reference in text
GUARD = 20  # extra digits of a reference
Answer = Sequence[Any]


class Claimed(list[Any]):
    """An answer with the error that it claims for itself, such as an error bar."""

    def __init__(self, numbers: Answer, claim: float) -> None:
        super().__init__(numbers)
        self.claim = Decimal(f"{claim:.3g}")


@dataclass(frozen=True)
class Method:
    """A method for a question: `call(setting)` answers it, for each of the `settings`, from quick to exact.

    `unit` names the kind of setting (`digits`, `xtol`, `bounces`). `promise(setting)` is the largest error that the
    method claims, or None if it claims none. A call gives `per` answers at a time; if the setting counts particles or
    points, it gives that many.
    """

    name: str
    arithmetic: str
    unit: str
    settings: tuple[Any, ...]
    call: Callable[[Any], Answer]
    promise: Callable[[Any], Decimal | None] = lambda setting: None
    per: int = 1
    textbook: bool = False
    proved: bool = False

    def labelled(self, setting: Any) -> str:
        """A setting as text with its unit.

        >>> Method("m", "a", "digits", (), list).labelled(30), Method("m", "a", "xtol", (), list).labelled(1e-8)
        ('30 digits', 'xtol 1e-08')
        """
        if isinstance(setting, float):
            return f"{self.unit} {setting:g}"
        return f"{setting:,} {self.unit}" if not isinstance(setting, str) else setting

    def answers(self, setting: Any) -> int:
        """The number of answers that a call gives."""
        return int(setting) if self.unit in COUNTS else self.per

    def within(self, most_digits: int) -> tuple[Any, ...]:
        """The settings that need at most `most_digits` digits."""
        return tuple(s for s in self.settings if self.unit != "digits" or s <= most_digits)


def textbook(
    name: str,
    call: Callable[[Any], Answer],
    unit: str = "",
    settings: tuple[Any, ...] = ("to rounding",),
    per: int = 1,
) -> Method:
    """A textbook method: in mpmath if its settings are digits, else in float64.

    An answer to a number of digits, or to a tolerance (`xtol`, `epsabs`), claims that error.
    """
    if unit == "digits":
        return Method(name, "mpmath", unit, settings, call, lambda digits: power(-digits), per, textbook=True)
    claims = unit in TOLERANCES
    promise = lambda setting: Decimal(f"{setting:.3g}") if claims else None  # noqa: E731
    return Method(name, "float64", unit, settings, call, promise, per, textbook=True)


@dataclass(frozen=True)
class Question:
    """A question with a function `reference(digits)`, which gives proved balls of radius below `10**-digits`.

    If no proof is known, `certified` is False, and the balls are a measured value with its error. `answers` describes
    the numbers, `unit` is the unit of the error.
    """

    name: str
    title: str
    answers: str
    unit: str
    reference: Callable[[int], Answer]
    methods: tuple[Method, ...]
    certified: bool = True
    most_digits: int = 1000

    def document(self) -> dict[str, str | bool]:
        """Name, title, answers, unit and certainty, as JSON."""
        return {name: getattr(self, name) for name in ("name", "title", "answers", "unit", "certified")}

    def values(self) -> str:
        """The reference as text: the first `SHOWN` numbers to 15 digits, each with a bound of its error."""
        found = self.reference(15)
        first = ["{} ± {}".format(*decimal(value, 15)) for value in map(enclosed, found[:SHOWN])]
        return "; ".join(first) + (f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else "")


def enclosed(value: Any) -> arb:
    """A number of any kind as a ball that contains it, in the ambient precision.

    >>> enclosed(0.5) == enclosed(Fraction(1, 2)) == enclosed("0.5") == enclosed(np.longdouble("0.5"))
    True
    """
    if isinstance(value, arb):
        return value
    if isinstance(value, mpmath.ctx_mp_python._mpf):
        return as_ball(value)
    if isinstance(value, np.longdouble):
        value = Fraction(*value.as_integer_ratio()) if np.isfinite(value) else float(value)
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    return arb(value) if isinstance(value, str) else arb(float(value))


def distance(answer: Answer, reference: Answer, digits: int) -> tuple[Decimal | None, Decimal | None]:
    """Bounds (lower and upper) of the largest distance of an answer from the reference; None if one is not finite.

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
    """The number `10**exponent`, even if it is outside the range of floats.

    >>> power(-1000)
    Decimal('1E-1000')
    """
    return Decimal(10) ** Decimal(exponent) if exponent != int(exponent) else Decimal(1).scaleb(int(exponent))


RUNS = 5
SHORTEST = 1e-3  # seconds of a sample; a shorter call is repeated within it
HOPELESS = 5.0  # seconds: a longer first call is not repeated
PATIENCE = 0.4  # seconds for all runs of one setting; a longer call runs once
Say = Callable[[str], None]


def measured(question: Question, runs: int = RUNS, most_digits: int = 1000, say: Say = silent) -> list[MethodResult]:
    """The rows of a question, method by method; `say` is called with the name of each method before it runs.

    If a method raises `ValueError` or an arithmetical error, it has no answer at that setting, and its row says why.
    """
    digits = min(most_digits, question.most_digits)
    say("the reference")
    reference = question.reference(digits + GUARD)
    rows: list[MethodResult] = []
    for method in question.methods:
        say(method.name)
        rows += _rows(question, method, method.within(digits), reference, digits, runs)
    return rows


def _rows(
    question: Question, method: Method, settings: tuple[Any, ...], reference: Answer, digits: int, runs: int
) -> Iterator[MethodResult]:
    for i, setting in enumerate(settings):
        answer, seconds, failure = sample(method, setting, runs, warm=i > 0)
        least, error = (None, None) if answer is None else distance(answer, reference, digits)
        if answer is not None and error is None:
            failure = "no finite number"
        yield timed(
            question.name,
            method.name,
            [each / method.answers(setting) for each in seconds],
            arithmetic=method.arithmetic,
            setting=method.labelled(setting),
            error=error,
            least=least,
            promise=answer.claim if isinstance(answer, Claimed) else method.promise(setting),
            textbook=method.textbook,
            proved=method.proved,
            failure=failure,
            digits=setting if method.unit == "digits" else None,
        )


def sample(method: Method, setting: Any, runs: int, warm: bool = False) -> tuple[Answer | None, list[float], str]:
    """The answer at a setting, the seconds of some calls, and what went wrong, if anything; the first call warms up.

    A slow method is timed fewer than `runs` times, but at least once. If the method is `warm`, as after another
    setting, its first call counts as timed.
    """
    clock = time.perf_counter(), time.process_time()
    answer, failure = None, ""
    try:
        answer = method.call(setting)
    except (ValueError, ArithmeticError) as error:
        failure = " ".join(str(error).split()) or type(error).__name__
    first, spent = time.perf_counter() - clock[0], time.process_time() - clock[1]
    if answer is None:
        return None, [spent], failure
    if first > PATIENCE and (warm or first > HOPELESS):
        return answer, [spent], ""
    repeats = max(1, int(SHORTEST / max(first, 1e-9)))
    seconds = []
    for _ in range(max(1, min(runs, int(PATIENCE / max(first, 1e-9))))):
        start = time.process_time()
        for _ in range(repeats):
            method.call(setting)
        seconds.append((time.process_time() - start) / repeats)
    return answer, seconds, ""
