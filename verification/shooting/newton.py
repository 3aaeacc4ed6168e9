"""Newton's method on a problem, in mpmath, with a precision that doubles at each step.

A step needs no more digits than it will make right, so the last step costs as much as all others
together. The precision lives in a context made here; the ambient `mpmath.mp` is not touched.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import mpmath

from verification.arithmetic import FLOAT64, Arithmetic, bits_of, multiprecision

GUARD = 15  # decimal digits beyond those asked for
START = 16  # digits of the first step in mpmath
ATTEMPTS = 6  # steps with the same number of digits


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
    """Numbers of an mpmath context that solve a problem to about `digits` digits, not proved."""

    problem: System
    z: list[Any]
    digits: int
    steps: tuple[Step, ...] = field(repr=False)


def refined(problem: System, start: Sequence[Any], digits: int) -> Solution:
    """The solution near `start` to `digits` digits.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.shooting.problem import Problem
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
    """The solution near `start` in float64: steps as long as they shorten.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.shooting.problem import Problem
    >>> [round(x, 12) for x in floats(Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3)), [1.5, -1.6])]
    [1.570796326795, -1.570796326795]
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
            return z
        reach = min(1.0, 0.3 / size) if size > 0 else 1.0
        z = [x - reach * d for x, d in zip(z, correction, strict=True)]
        sizes.append(size)
        if size < 1e-15:
            return z
    if sizes and sizes[-1] < 1e-6:
        return z
    raise ValueError(f"{problem.label}: Newton's method in float64 did not settle from {[*start][:4]} ...")


def _log10(context: Any, size: Any) -> float:
    return float(context.log10(size)) if size else -float(bits_of(context.dps))
