"""The period-doubling ladder of the egg: `lambda_n`, where period `2**(n-1)` becomes `2**n`.

Paper: section 6.6, with `alpha = 0.08` and `lambda_3` to `lambda_6`. The second rung, where it exists,
is the flip of the diameter; from the third on the cycles are followed from an attractor of period 4.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from sympy import Expr, N

from symbolic import tables
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables.symbols import lam as lam_letter
from symbolic.tables.table import Table
from verification.arithmetic.progress import telling
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.closure import MIRROR
from verification.cycles.shooting.attracting import FEIGENBAUM, attractor, doubled, next_critical
from verification.cycles.shooting.newton import floats
from verification.cycles.shooting.problem import Problem

GRID = [k / 25 for k in range(20, -1, -1)]
TRIED = f"a ball settles on at lam = {GRID[-1]}, ..., {GRID[0]} in steps of 0.04"
HIGHEST = 17  # the rung whose period, 2**16, still takes minutes


@dataclass(frozen=True)
class Rung:
    """`lambda_n` in float64: the problem that defines it, and a start for its solution."""

    n: int
    problem: Problem
    start: list[float]

    @property
    def lam(self) -> float:
        """The contraction."""
        return self.start[-1]


def ladder(alpha: Expr) -> Iterator[Rung]:
    """The rungs from the third on, in float64.

    >>> from sympy import Rational
    >>> rungs = ladder(Rational(2, 25))
    >>> [round(next(rungs).lam, 9) for _ in range(4)]
    [0.371235503, 0.388761023, 0.392501516, 0.393302227]
    """
    table = tables.egg(3).at(alpha=alpha)
    lam, theta = stable_four(table)
    critical = next_critical(table, theta, lam, 0.005, BifurcationKind.FLIP)
    n, gap = 3, (critical[-1] - lam) / 4
    while True:
        problem = Problem(table, (0,) * (len(critical) - 1), BifurcationKind.FLIP, "lam")
        yield Rung(n, problem, critical)
        theta, lam = doubled(problem, critical, 0.3 * gap)
        following = next_critical(table, theta, lam, 0.15 * gap, BifurcationKind.FLIP)
        gap = (following[-1] - critical[-1]) / FEIGENBAUM
        n, critical = n + 1, following


def stable_four(table: Table) -> tuple[float, list[float]]:
    """The largest contraction of a coarse grid with an attracting cycle of period 4 near a diameter."""
    for lam in GRID:
        cycle = attractor(table, lam, (0.05, 3.1), 16)
        if len(cycle) == 4:
            return lam, cycle
    raise ValueError(
        f"egg: alpha = {dict(table.fixed)['alpha']} has no attracting cycle of period 4 near a diameter "
        f"that {TRIED}; the ladder starts from one"
    )


def symmetry_breaking(alpha: Expr) -> tuple[Problem, list[float]]:
    """Where the mirror-symmetric cycle of period 4 bears two that are not: a flip of half the cycle.

    A symmetric cycle cannot double its period: half of it would need the multipliers `i` and `-i`,
    whose product is 1. It breaks its symmetry first, and the ladder climbs from what it bears.
    """
    table = tables.egg(3).at(alpha=alpha)
    problem = Problem(table, (0, 0), BifurcationKind.FLIP, "lam", closure=MIRROR)
    for lam in GRID:
        cycle = attractor(table, lam, (0.05, 3.1), 16)
        if len(cycle) == 4 and abs(math.remainder(cycle[0] + cycle[2], 2 * math.pi)) < 1e-6:
            for share in range(1, 12):
                try:
                    found = floats(problem, [*cycle[:2], lam + share / 100])
                except ValueError:
                    continue
                if 0 <= found[-1] - lam < 0.15:
                    return problem, found
    raise ValueError(f"egg: alpha = {alpha} has no symmetric attracting cycle of period 4 that {TRIED}")


def critical_cycle(alpha: Expr, n: int) -> tuple[Problem, list[float]]:
    """What `lambda_n` solves, and where to start."""
    if not 2 <= n <= HIGHEST:
        raise ValueError(f"locate doubling: n = {n} is out of range; accepted: 2 to {HIGHEST}")
    if n == 2:
        return _second(alpha)
    found = rung(alpha, n)
    return found.problem, found.start


def rung(alpha: Expr, n: int) -> Rung:
    """The rung `lambda_n` in float64; those below it are climbed once."""
    rungs, more = _climb(alpha)
    tick = telling("rungs in float64")
    while len(rungs) < n - 2:
        try:
            rungs.append(next(more))
        except (ValueError, StopIteration):
            _climb.cache_clear()
            raise
        tick(2.0 ** (rungs[-1].n - n - 1))  # a rung costs twice the one before
    return rungs[n - 3]


@cache
def _climb(alpha: Expr) -> tuple[list[Rung], Iterator[Rung]]:
    return [], ladder(alpha)


def _second(alpha: Expr) -> tuple[Problem, list[float]]:
    ends = [alpha_tilde().subs(lam_letter, k) for k in (1, 0)]
    if not ends[0] < alpha < ends[1]:
        raise ValueError(
            f"locate doubling: alpha = {alpha} has no lambda_2; the diameter doubles for alpha "
            f"between {N(ends[0], 6)} and {N(ends[1], 6)}"
        )
    low, high = 0.0, 1.0  # alpha-tilde falls as lam grows
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if float(alpha_tilde().subs(lam_letter, middle)) > alpha else (low, middle)
    return Problem(tables.egg(3).at(alpha=alpha), (0, 0), BifurcationKind.FLIP, "lam"), [0.0, 3.14159265, low]
