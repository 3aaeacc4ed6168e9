"""What a solution's digits are worth: its condition number, and what that means for whoever asked.

The condition number is the largest row sum of the inverse of the system's matrix: no unknown moves farther when no
equation is off by more than one. Next to a fold, where a multiplier is `1 + d`, it is of the size of `1/d`. Of a
cycle it is estimated from a few solutions of the factored system: from below, and rarely off by more than a factor
of 3 ([Higham2002], section 15.3). A system of a handful is inverted.
"""

from collections.abc import Callable
from enum import Enum
from math import inf, isfinite, log10
from typing import Any, Protocol, runtime_checkable

from verification.arithmetic.words import Arithmetic

Vector = list[Any]
Solve = Callable[[Vector], Vector]
ASCENTS = 4  # vectors tried after the first; two are enough nearly always
ROUNDINGS = 16  # of a residual


class Conditioning(Enum):
    """What a solution's condition number means; the value is the advice."""

    SOUND = "the condition number leaves more than half of the digits"
    SENSITIVE = (
        "the condition number costs half of the digits or more; "
        "ask for more digits, or solve for the fold or the flip that is next to it"
    )
    REPEATED = "a shorter cycle run through several times, as far as its digits tell; ask for the shorter one"


class System(Protocol):
    """What can solve with its matrix of first derivatives."""

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """`F'(z)^-1 r`."""


@runtime_checkable
class Cyclic(Protocol):
    """A system of any length, that can tell its cycle from a shorter one."""

    def inverses(self, arithmetic: Arithmetic, z: Vector) -> tuple[Solve, Solve]:
        """`F'(z)^-1` and its transpose, from one factorisation."""

    def shorter(self, z: Vector, within: float) -> int:
        """The bounces after which the cycle repeats itself, up to `within`; 0 for never."""


def norm_of_inverse(system: System, arithmetic: Arithmetic, z: Vector) -> float:
    """The largest row sum of `F'(z)^-1`; infinite where the matrix is singular.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from verification.arithmetic.words import FLOAT64
    >>> from verification.cycles.shooting.problem import Problem
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
    """Of the matrix that `solve` multiplies by, from below: Hager's ascent, then one vector that no symmetry hides.

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
    """The decimal digits after the point that an error of one `unit` in every equation leaves.

    >>> digits_left(1e8, 2.0**-52), digits_left(2.9, 2.0**-52), digits_left(float("inf"), 2.0**-52)
    (7, 15, 0)
    """
    return max(0, int(-log10(condition * unit))) if isfinite(condition) else 0


def costs_half(condition: float, unit: float, digits: int) -> bool:
    """Does a residual of some units of rounding leave less than half of the `digits`?

    At a fold it does, whatever is computed there: off by `h`, of the size of the root of the residual, the condition
    number is of the size of `1/h`.

    >>> costs_half(8e6, 2.0**-52, 15), costs_half(1e7, 2.0**-52, 15), costs_half(1e7, 1e-65, 50)
    (False, True, False)
    """
    return condition * ROUNDINGS * unit > 10 ** (-digits / 2)


def unit(n: int, j: int) -> Vector:
    """A vector of `n` numbers with a one at `j`."""
    return [1.0 if i == j else 0.0 for i in range(n)]


def total(x: Vector) -> float:
    """The sum of sizes."""
    return float(sum(abs(value) for value in x))
