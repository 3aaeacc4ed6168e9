"""Newton's method on a problem, in mpmath, with a precision that doubles at each step.

A step needs no more digits than it will make right, so the last step costs as much as all others
together. The precision lives in a context made here; the ambient `mpmath.mp` is not touched.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import log10
from typing import Any, Protocol

import mpmath

from verification.arithmetic.words import FLOAT64, Arithmetic, bits_of, multiprecision
from verification.cycles.shooting.condition import (
    ROUNDINGS,
    Conditioning,
    Cyclic,
    costs_half,
    digits_left,
    norm_of_inverse,
)

GUARD = 15  # decimal digits beyond those asked for
START = 16  # digits of the first step in mpmath
DIGITS = 15  # of a float64, which every number of so many digits survives
ATTEMPTS = 6  # steps with the same number of digits
EPS = 2.0**-52
NEAR = 1e-2  # radians: bounces farther apart are not the same, whatever the condition
TOLD = 1e12  # the largest condition number that float64 can be trusted to tell


class System(Protocol):
    """As many equations as unknowns, over any kind of number."""

    @property
    def label(self) -> str:
        """What messages call it."""

    def value(self, arithmetic: Arithmetic, z: list[Any]) -> list[Any]:
        """`F(z)`."""

    def solved(self, arithmetic: Arithmetic, z: list[Any], r: list[Any]) -> list[Any]:
        """`F'(z)^-1 r`."""

    def newton(self, arithmetic: Arithmetic, z: list[Any]) -> list[Any]:
        """`F'(z)^-1 F(z)`, Newton's correction."""


@dataclass(frozen=True)
class Step:
    """One step: the digits it was computed with, and the size of the correction it made."""

    digits: int
    correction: float


@dataclass(frozen=True)
class Solution:
    """Numbers that solve a problem to about `digits` digits, not proved: floats, or of an mpmath context.

    What the digits are worth is computed when it is asked for.
    """

    problem: System
    z: list[Any]
    digits: int
    steps: tuple[Step, ...] = field(repr=False)

    @cached_property
    def condition(self) -> float:
        """How far an unknown moves at most when no equation is off by more than one; infinite when singular."""
        found = norm_of_inverse(self.problem, FLOAT64, [float(x) for x in self.z])
        if found > TOLD and not isinstance(self.z[0], float):
            found = norm_of_inverse(self.problem, multiprecision(type(self.z[0]).context), self.z)
        return found

    @property
    def unit(self) -> float:
        """The unit of rounding of the last step."""
        return EPS if isinstance(self.z[0], float) else float(type(self.z[0]).context.eps)

    @property
    def digits_sure(self) -> int:
        """The digits after the point that the condition number leaves of every unknown, `digits` at most."""
        return min(self.digits, digits_left(self.condition, self.unit))

    @property
    def conditioning(self) -> Conditioning:
        """The condition number in a word, with advice as its value."""
        if self.shorter:
            return Conditioning.REPEATED
        few = costs_half(self.condition, self.unit, self.digits)
        return Conditioning.SENSITIVE if few else Conditioning.SOUND

    @property
    def shorter(self) -> int:
        """The bounces after which the cycle repeats itself, as far as its digits tell; 0 for never."""
        within = min(NEAR, max(1.0, self.condition) * ROUNDINGS * self.unit)
        return self.problem.shorter(self.z, within) if isinstance(self.problem, Cyclic) else 0

    @property
    def advice(self) -> str:
        """What to do about the conditioning, for people; nothing where it is sound."""
        if self.conditioning is Conditioning.SOUND:
            return ""
        return f"{self.conditioning.value}{f' (after {self.shorter} bounces)' if self.shorter else ''}"

    @property
    def words(self) -> str:
        """One sentence for people."""
        said = f"condition number {self.condition:.2g}, {self.digits_sure} of {self.digits} digits sure"
        return f"{said}: {self.advice}" if self.advice else said


class UnsettledError(ValueError):
    """Newton's method in float64 did not settle; `last` is where it was."""

    def __init__(self, message: str, last: Solution) -> None:
        super().__init__(message)
        self.last = last


def refined(problem: System, start: Sequence[Any], digits: int) -> Solution:
    """The solution near `start` to `digits` digits.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.shooting.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> found = refined(axis, [1.5, -1.6], 30)
    >>> mpmath.nstr(found.z[0], 30)
    '1.57079632679489661923132169164'
    """
    context = mpmath.MPContext()
    context.prec = 53
    z = [context.mpf(x) for x in floats(problem, start)]
    arithmetic = multiprecision(context)
    steps: list[Step] = []
    for level in levels(digits + GUARD):
        context.dps = level
        for attempt in range(ATTEMPTS):
            correction = problem.newton(arithmetic, z)
            z = [x - d for x, d in zip(z, correction, strict=True)]
            steps.append(Step(level, _log10(context, max(abs(d) for d in correction))))
            right = -2 * steps[-1].correction  # convergence is quadratic
            if right >= (digits + GUARD // 2 if level == digits + GUARD else 0.7 * level):
                break
            if attempt == ATTEMPTS - 1:
                raise ValueError(
                    f"{problem.label}: {ATTEMPTS} Newton steps with {level} digits still correct by "
                    f"1e{steps[-1].correction:.0f}; the cycle is lost or singular"
                )
    return Solution(problem, z, digits, tuple(steps))


def levels(digits: int) -> list[int]:
    """The digits of each step, doubling (nearly) up to `digits`.

    >>> levels(100)
    [16, 28, 52, 100]
    """
    found = [digits]
    while found[0] > 2 * START - 4:
        found.insert(0, found[0] // 2 + 2)
    return found if found[0] <= START or digits <= START else [START, *found]


def floats(problem: System, start: Sequence[Any], steps: int = 40) -> list[float]:
    """The solution near `start` in float64, as numbers alone.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.shooting.problem import Problem
    >>> [round(x, 12) for x in floats(Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3)), [1.5, -1.6])]
    [1.570796326795, -1.570796326795]
    """
    return in_floats(problem, start, steps).z


def in_floats(problem: System, start: Sequence[Any], steps: int = 40) -> Solution:
    """The solution near `start` in float64: steps as long as they shorten.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.shooting.problem import Problem
    >>> in_floats(Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3)), [1.5, -1.6]).words
    'condition number 1.5, 15 of 15 digits sure'
    """
    z = [float(x) for x in start]
    sizes: list[float] = []
    for _ in range(steps):
        try:
            correction = problem.newton(FLOAT64, z)
        except ZeroDivisionError:
            break
        size = max(abs(d) for d in correction)
        if len(sizes) > 4 and size < 1e-6 and size >= sizes[-1]:
            return _in_floats(problem, z, sizes)
        reach = min(1.0, 0.3 / size) if size > 0 else 1.0
        z = [x - reach * d for x, d in zip(z, correction, strict=True)]
        sizes.append(size)
        if size < 1e-15:
            break
    last = _in_floats(problem, z, sizes)
    if sizes and sizes[-1] < 1e-6:
        return last
    why = f"; at the last step: {last.words}" if last.advice else ""
    raise UnsettledError(
        f"{problem.label}: Newton's method in float64 did not settle from {[*start][:4]} ...{why}", last
    )


def _in_floats(problem: System, z: list[float], sizes: list[float]) -> Solution:
    return Solution(problem, z, DIGITS, tuple(Step(START, log10(size) if size else -START) for size in sizes[-1:]))


def given(problem: System, z: Sequence[Any]) -> Solution:
    """A solution in float64 that was found elsewhere, to say what its digits are worth."""
    return _in_floats(problem, [float(x) for x in z], [])


def _log10(context: Any, size: Any) -> float:
    return float(context.log10(size)) if size else -float(bits_of(context.dps))
