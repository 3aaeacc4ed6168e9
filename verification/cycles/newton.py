"""Newton's method on the equations of a cycle, in float64 and to any number of digits; condition numbers.

To many digits the precision doubles at each step: a step needs no more digits than it will make right, so the last step
costs as much as all others together. The precision lives in a context made here; `mpmath.mp` is not touched.

The condition number of a solution is the largest row sum of the inverse of the system's matrix: no unknown moves
farther when no equation has an error above 1. Next to a fold, where a multiplier is `1 + d`, it is of the size of
`1/d`. For a cycle it is estimated from a few solutions of the factored system: the estimate is a lower bound, and
rarely off by more than a factor of 3 ([Higham2002], section 15.3). For a system of a few equations the matrix is
inverted.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property, partial
from math import inf, isfinite, log10
from typing import Any, Protocol, runtime_checkable

import mpmath
from flint import arb

from verification.arithmetic.balls import FLOAT64, Arithmetic, balls, exact_balls, multiprecision, working
from verification.arithmetic.iteration import Iteration, Stop, Vector, iterated

Solve = Callable[[Vector], Vector]
ASCENTS = 4  # vectors tried after the first; two are enough nearly always
ROUNDINGS = 16  # units of rounding in a residual


class Conditioning(Enum):
    """Verdicts on a solution's condition number; the value of a member is a piece of advice."""

    SOUND = "the condition number leaves more than half of the digits"
    SENSITIVE = (
        "the condition number costs half of the digits or more; "
        "ask for more digits, or solve for the fold or the flip that is next to it"
    )
    REPEATED = "a shorter cycle run through several times, as far as its digits tell; ask for the shorter one"


@runtime_checkable
class Cyclic(Protocol):
    """A system of equations for a cycle that can tell whether the cycle has a shorter period."""

    def inverses(self, arithmetic: Arithmetic, z: Vector) -> tuple[Solve, Solve]:
        """Functions that apply `F'(z)^-1` and its transpose, from one factorisation."""

    def shorter(self, z: Vector, within: float) -> int:
        """The number of bounces after which the cycle repeats itself, up to an error `within`; 0 if it does not."""


def norm_of_inverse(system: "System", arithmetic: Arithmetic, z: Vector) -> float:
    """The largest row sum of `F'(z)^-1`; infinite where the matrix is singular.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from verification.arithmetic.balls import FLOAT64
    >>> from verification.cycles.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> round(norm_of_inverse(axis, FLOAT64, [1.5707963267948966, -1.5707963267948966]), 12)
    1.5
    """
    n = len(z)
    try:
        if isinstance(system, Cyclic):
            found = largest_row_sum(*system.inverses(arithmetic, z), n)
        else:
            columns = [system.solved(arithmetic, z, unit(n, j)) for j in range(n)]
            found = max(float(sum(abs(column[i]) for column in columns)) for i in range(n))
    except (ZeroDivisionError, OverflowError, ValueError):
        return inf
    return found if isfinite(found) else inf


def largest_row_sum(solve: Solve, transposed: Solve, n: int) -> float:
    """Lower bound of the largest row sum of the matrix that `solve` applies: Hager's ascent, then a vector of
    alternating signs.

    >>> twice = lambda r: [2 * r[0], r[0] + r[1]]
    >>> largest_row_sum(twice, lambda r: [2 * r[0] + r[1], r[1]], 2)
    2.0
    """
    y = transposed([1 / n] * n)
    best, before = total(y), -1
    for _ in range(ASCENTS):
        z = solve([-1.0 if x < 0 else 1.0 for x in y])
        row = max(range(n), key=lambda i: abs(z[i]))
        if row == before:
            break
        y, before = transposed(unit(n, row)), row
        if not total(y) > best:
            break
        best = total(y)
    alternating = [(-1.0) ** i * (1 + i / max(n - 1, 1)) for i in range(n)]
    return max(best, 2 * total(transposed(alternating)) / (3 * n))


def digits_left(condition: float, unit: float) -> int:
    """The number of reliable digits after the point, if every equation has an error of one `unit`.

    >>> digits_left(1e8, 2.0**-52), digits_left(2.9, 2.0**-52), digits_left(float("inf"), 2.0**-52)
    (7, 15, 0)
    """
    return max(0, int(-log10(condition * unit))) if isfinite(condition) else 0


def costs_half(condition: float, unit: float, digits: int) -> bool:
    """Does a residual of some units of rounding leave less than half of the `digits`?

    Next to a fold it always does: a computed solution is off by some `h` of the size of the root of the residual, and
    the condition number there is of the size of `1/h`.

    >>> costs_half(8e6, 2.0**-52, 15), costs_half(1e7, 2.0**-52, 15), costs_half(1e7, 1e-65, 50)
    (False, True, False)
    """
    return condition * ROUNDINGS * unit > 10 ** (-digits / 2)


def unit(n: int, j: int) -> Vector:
    """The unit vector of `n` numbers with a one at index `j`."""
    return [1.0 if i == j else 0.0 for i in range(n)]


def total(x: Vector) -> float:
    """The sum of absolute values."""
    return float(sum(abs(value) for value in x))


GUARD = 15  # decimal digits beyond those asked for
GUARD_BITS = 64  # of balls, beyond those of the numbers
START = 16  # digits of the first step in mpmath
DIGITS = 15  # of a float64, which every number of so many digits survives
ATTEMPTS = 6  # steps with the same number of digits
SPARE = 8  # digits of the last step that may be rounding
EPS = 2.0**-52
IN_FLOATS = Stop(small=1e-6, enough=1e-15, steps=40, reach=0.3)
NEAR = 1e-2  # radians: bounces farther apart are not the same, whatever the condition
TOLD = 1e12  # the largest condition number that float64 computes reliably


class System(Protocol):
    """A system with as many equations as unknowns, in any arithmetic."""

    @property
    def label(self) -> str:
        """The name used in messages."""

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The equations `F(z)`."""

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The solution `x` of `F'(z) x = r`."""

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction `F'(z)^-1 F(z)`."""


@dataclass(frozen=True)
class NewtonStep:
    """One Newton step: its number of digits, and the decimal logarithm of its correction."""

    digits: int
    correction: float


@dataclass(frozen=True)
class Solution:
    """An unproved solution of a problem, correct to about `digits` digits, in floats or numbers of an mpmath context.

    The condition number is computed on first use.
    """

    problem: System
    z: Vector
    digits: int
    steps: tuple[NewtonStep, ...] = field(repr=False)

    @cached_property
    def condition(self) -> float:
        """The condition number: how far an unknown moves if no equation has an error above 1; may be infinite."""
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
        """Digits after the point that are reliable in every unknown, by the condition number; at most `digits`."""
        return min(self.digits, digits_left(self.condition, self.unit))

    @property
    def conditioning(self) -> Conditioning:
        """The verdict on the condition number; the value of the verdict is a piece of advice."""
        if self.shorter:
            return Conditioning.REPEATED
        few = costs_half(self.condition, self.unit, self.digits)
        return Conditioning.SENSITIVE if few else Conditioning.SOUND

    @property
    def shorter(self) -> int:
        """The number of bounces after which the cycle repeats itself, up to the solution's error; 0 if it does not."""
        within = min(NEAR, max(1.0, self.condition) * ROUNDINGS * self.unit)
        return self.problem.shorter(self.z, within) if isinstance(self.problem, Cyclic) else 0

    @property
    def advice(self) -> str:
        """Advice on what to do about the conditioning, in words; empty if the condition number is sound."""
        if self.conditioning is Conditioning.SOUND:
            return ""
        return f"{self.conditioning.value}{f' (after {self.shorter} bounces)' if self.shorter else ''}"

    @property
    def words(self) -> str:
        """Condition number, reliable digits and advice in one sentence."""
        said = f"condition number {self.condition:.2g}, {self.digits_sure} of {self.digits} digits sure"
        return f"{said}: {self.advice}" if self.advice else said


class UnsettledError(ValueError):
    """Raised if Newton's method in float64 does not converge; `last` is the last iterate."""

    def __init__(self, message: str, last: Solution) -> None:
        super().__init__(message)
        self.last = last


def refined(problem: System, start: Sequence[Any], digits: int, in_balls: bool = False) -> Solution:
    """The solution near `start` to `digits` digits, in mpmath numbers.

    With `in_balls` a correction is computed in balls, many times faster than in mpmath, and its midpoint taken if the
    radii show all digits right; if not, as along long cycles, it is computed in mpmath. The last bits of the result
    may depend on `in_balls`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> found = refined(axis, [1.5, -1.6], 30)
    >>> mpmath.nstr(found.z[0], 30)
    '1.57079632679489661923132169164'
    """
    context = mpmath.MPContext()
    context.prec = 53
    z: Vector = [context.mpf(x) for x in floats(problem, start)]
    steps: list[NewtonStep] = []
    for level in levels(digits + GUARD):
        context.dps = level
        enough = context.mpf(10) ** -enough_digits(level, digits + GUARD)
        found = iterated(_correction(problem, context, in_balls), z, Stop(enough=enough, steps=ATTEMPTS))
        z = found.x
        steps += [NewtonStep(level, float(context.log10(size))) for size in found.sizes or [context.mpf(10) ** -level]]
        if not found.settled:
            raise ValueError(
                f"{problem.label}: after {found.steps} Newton steps with {level} digits the last correction is still "
                f"1e{steps[-1].correction:.0f}; the cycle is lost or singular"
            )
    return Solution(problem, z, digits, tuple(steps))


def _correction(problem: System, context: Any, in_balls: bool) -> Callable[[Vector], Vector]:
    """Newton's correction as a function, which works with the current number of digits of a context."""
    rounded = partial(problem.newton, multiprecision(context))
    if not in_balls:
        return rounded
    bits = context.prec + GUARD_BITS
    arithmetic, close = balls(bits), arb(2) ** -context.prec

    def correction(z: Vector) -> Vector:
        with working(bits):
            moved = problem.newton(arithmetic, exact_balls(z))
            if all(isinstance(d, arb) and d.rad() < close for d in moved):
                return [context.mpf(tuple(map(int, d.mid().man_exp()))) for d in moved]
        return rounded(z)

    return correction


def enough_digits(level: int, digits: int) -> float:
    """The number `d` such that a correction below `10**-d` ends a level: half the level's digits, as convergence is
    quadratic.

    >>> enough_digits(100, 100), enough_digits(50, 100)
    (46.0, 17.5)
    """
    return (digits - SPARE if level == digits else 0.7 * level) / 2


def levels(digits: int) -> list[int]:
    """The numbers of digits of successive Newton steps, (nearly) doubling up to `digits`.

    >>> levels(100)
    [16, 28, 52, 100]
    """
    found = [digits]
    while found[0] > 2 * START - 4:
        found.insert(0, found[0] // 2 + 2)
    return found if found[0] <= START or digits <= START else [START, *found]


def floats(problem: System, start: Sequence[Any]) -> list[float]:
    """The unknowns of the solution near `start` in float64.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.problem import Problem
    >>> [round(x, 12) for x in floats(Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3)), [1.5, -1.6])]
    [1.570796326795, -1.570796326795]
    """
    return in_floats(problem, start).z


def in_floats(problem: System, start: Sequence[Any]) -> Solution:
    """The solution near `start` in float64; `UnsettledError` where Newton's method does not converge.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.problem import Problem
    >>> in_floats(Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3)), [1.5, -1.6]).words
    'condition number 1.5, 15 of 15 digits sure'
    """
    found = settled(problem, FLOAT64, [float(x) for x in start])
    last = Solution(problem, found.x, DIGITS, tuple(NewtonStep(START, log10(size)) for size in found.sizes[-1:]))
    if found.settled:
        return last
    why = f"; at the last step: {last.words}" if last.advice else ""
    raise UnsettledError(
        f"{problem.label}: Newton's method in float64 did not settle from {[*start][:4]} ...{why}", last
    )


def settled(system: System, arithmetic: Arithmetic, start: Sequence[Any]) -> Iteration:
    """The result of Newton's iteration in one arithmetic; at a double zero convergence is slow."""
    found = iterated(partial(system.newton, arithmetic), start, IN_FLOATS)
    return replace(found, settled=found.settled or bool(found.sizes and found.sizes[-1] < IN_FLOATS.small))


def given(problem: System, z: Sequence[Any]) -> Solution:
    """A `Solution` made from float64 numbers found elsewhere, so that its condition number can be computed."""
    return Solution(problem, [float(x) for x in z], DIGITS, ())
