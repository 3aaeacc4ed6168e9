"""Period-doubling cascades in float64: an attracting cycle is followed to its flip, then the cycle born there, etc.

Nothing here is proved: each flip is a start for Newton's method. The cascade of the paper (section 6.6, `alpha = 0.08`)
is the egg's, `lambda_n`, where period `2**(n-1)` becomes `2**n`. `lambda_2`, where it exists, is the flip of the
diameter; from `lambda_3` on the cycles are followed from an attractor of period 4.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from sympy import Expr, N, Rational

from symbolic import tables
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables.table import Table
from symbolic.tables.table import lam as lam_symbol
from verification.arithmetic.balls import FLOAT64
from verification.arithmetic.iteration import telling
from verification.cycles.chords import chord_angles, landing
from verification.cycles.newton import floats
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR, BifurcationKind

FEIGENBAUM = 4.6692
SETTLE = 3000  # bounces thrown away before an attractor is looked at
SAME = 1e-7  # radians: an orbit that returns this close counts as a cycle


def attractor(table: Table, lam: float, start: tuple[float, float], longest: int = 64) -> list[float]:
    """The attracting cycle that a particle approaches, as bounce parameters; empty if it has more than `longest`
    bounces.

    For tables of one convex component; `start` are two successive bounces.

    >>> from symbolic.tables import ellipse
    >>> [round(abs(x), 6) for x in attractor(ellipse.at(a="3/2"), 0.25, (0.4, 2.9))]
    [1.570796, 1.570796]
    """
    angle = chord_angles(table, FLOAT64)(0, 0, 1)
    before, here = start
    orbit: list[float] = []
    for bounce in range(SETTLE):
        before, here = here, math.remainder(landing(table, here, -lam * angle(here, before)[0]), 2 * math.pi)
        orbit.append(here)
        if bounce % 200 == 199:
            last = orbit[-2 * longest :]
            for period in range(1, longest + 1):
                if all(_near(last[i], last[i + period]) for i in range(longest)):
                    return last[-period:]
    return []


def _near(x: float, y: float) -> bool:
    return abs(math.remainder(x - y, 2 * math.pi)) < SAME


def characteristic(table: Table, theta: Sequence[float], lam: float) -> float:
    """`det(M + 1)` of a cycle's monodromy matrix `M`, up to sign."""
    free = Problem(table, (0,) * len(theta), BifurcationKind.FLIP, "lam")
    found = Linearised(free, FLOAT64, [*theta, lam], slope=False).critical
    value, power = found.bordering / found.chain.upper[-1], 0
    for pivot, upper in zip(found.pivots, found.chain.upper, strict=False):
        value, more = math.frexp(value * pivot / upper)  # a long product leaves the range of floats on its way
        power += more
    return math.ldexp(value, power)


def cycle_at(table: Table, theta: Sequence[float], lam: float, components: tuple[int, ...] = ()) -> list[float]:
    """The cycle near `theta` at contraction `lam`, in float64; without `components`, on the first component."""
    return floats(Problem(table, components or (0,) * len(theta), lam=Rational(lam)), theta)


def next_critical(table: Table, theta: Sequence[float], lam: float, step: float) -> list[float]:
    """First flip of the cycle near `theta`, as `[*theta, lam]`; followed from `lam` in steps of `step`."""
    problem = Problem(table, (0,) * len(theta), BifurcationKind.FLIP, "lam")
    before: list[float] = []
    here = cycle_at(table, theta, lam)
    value = characteristic(table, here, lam)
    for _ in range(400):
        guess = here if not before else [2 * x - y for x, y in zip(here, before, strict=True)]
        if not 0 <= lam + step <= 1:
            break
        after = cycle_at(table, guess, lam + step)
        if max(abs(x - y) for x, y in zip(after, guess, strict=True)) > 0.1:
            before, step = [], step / 2
            continue
        new = characteristic(table, after, lam + step)
        if value * new <= 0:
            share = value / (value - new)
            start = [x + share * (y - x) for x, y in zip(here, after, strict=True)]
            try:
                found = floats(problem, [*start, lam + share * step])
            except ValueError:
                found = []
            if found and abs(found[-1] - lam) < 3 * abs(step):
                return found
            before, step = [], step / 4
            continue
        before, here, value, lam = here, after, new, lam + step
    raise ValueError(
        f"{table.name}: no flip of this cycle of period {len(theta)} was met up to lam = {lam:.6f}, "
        f"followed in steps of {step:.3g}"
    )


def doubled(problem: Problem, critical: Sequence[float], distance: float) -> tuple[list[float], float]:
    """The cycle of twice the period that is born at a flip, near `lam + distance`, and its `lam`.

    The branch is `lam + c*e**2`, with `c` from the third-order terms; the branch may lie on either side of the flip.
    """
    at = Linearised(problem, FLOAT64, list(critical))
    c, vector = float(at.normal_form(FLOAT64).branch), at.critical.right
    amplitude = math.sqrt(abs(distance / c))
    lam = critical[-1] + math.copysign(abs(distance), c)
    theta = critical[:-1]
    both = [x + s * amplitude * v for s in (1, -1) for x, v in zip(theta, vector, strict=True)]
    found = cycle_at(problem.table, both, lam, problem.components * 2)
    half = len(theta)
    apart = max(abs(math.remainder(found[i] - found[i + half], 2 * math.pi)) for i in range(half))
    if apart < amplitude / 20:
        raise ValueError(f"{problem.table.name}: the branch of period {2 * half} was lost at lam = {lam}")
    return found, lam


GRID = [k / 25 for k in range(20, -1, -1)]
START = 0.05, 3.1  # two successive bounces near a diameter
TRIED = f"a particle settles on at lam = {GRID[-1]}, ..., {GRID[0]} in steps of 0.04"
HIGHEST = 17  # n of the last doubling: from period 2**16, which takes minutes


@dataclass(frozen=True)
class Doubling:
    """A flip in float64: the problem that defines it, and a start for its solution."""

    problem: Problem
    start: list[float]

    @property
    def n(self) -> int:
        """The `n` of `lambda_n`, where period `2**(n-1)` doubles."""
        return self.problem.period.bit_length()

    @property
    def lam(self) -> float:
        """The contraction of the flip."""
        return self.start[-1]


def doublings(table: Table, theta: Sequence[float], lam: float, step: float) -> Iterator[Doubling]:
    """The flips of an attracting cycle and of the cycles born at each, in turn; the first search starts at `lam`."""
    critical = next_critical(table, theta, lam, step)
    gap = (critical[-1] - lam) / 4
    while True:
        problem = Problem(table, (0,) * (len(critical) - 1), BifurcationKind.FLIP, "lam")
        yield Doubling(problem, critical)
        theta, lam = doubled(problem, critical, 0.3 * gap)
        following = next_critical(table, theta, lam, 0.15 * gap)
        gap, critical = (following[-1] - critical[-1]) / FEIGENBAUM, following


def cascade(alpha: Expr) -> Iterator[Doubling]:
    """The doublings of the egg's cascade, from `lambda_3` on.

    >>> from sympy import Rational
    >>> members = cascade(Rational(2, 25))
    >>> [round(next(members).lam, 9) for _ in range(4)]
    [0.371235503, 0.388761023, 0.392501516, 0.393302227]
    """
    table = tables.egg(3).at(alpha=alpha)
    lam, theta = stable_four(table)
    yield from doublings(table, theta, lam, 0.005)


def _cycles_of_four(table: Table) -> Iterator[tuple[float, list[float]]]:
    """The contractions in `GRID` for which a particle near a diameter ends on a cycle of period 4, and that cycle."""
    from numeric import PinballMap

    theta = np.full(len(GRID), START[1])
    map = PinballMap("egg", lam=np.array(GRID), alpha=str(dict(table.fixed)["alpha"]))
    orbit = map.orbit(theta, 0 * theta, 4000).theta[-5:]
    for lam, gap in zip(GRID, orbit[-1] - orbit[0], strict=True):
        if abs(math.remainder(gap, math.tau)) < SAME and len(cycle := attractor(table, lam, START, 16)) == 4:
            yield lam, cycle


def stable_four(table: Table) -> tuple[float, list[float]]:
    """The largest contraction of `GRID` with an attracting cycle of period 4 near a diameter, and that cycle."""
    found = next(_cycles_of_four(table), None)
    if found is None:
        raise ValueError(
            f"egg: alpha = {dict(table.fixed)['alpha']} has no attracting cycle of period 4 near a diameter "
            f"that {TRIED}; the cascade starts from one"
        )
    return found


def symmetry_breaking(alpha: Expr) -> tuple[Problem, list[float]]:
    """Problem and start for the pitchfork of the mirror-symmetric cycle of period 4: a flip of half the cycle.

    A symmetric cycle cannot double its period: half of the cycle would need the multipliers `i` and `-i`, whose product
    is 1. It loses its symmetry first, and the asymmetric cycle born there doubles its period.
    """
    table = tables.egg(3).at(alpha=alpha)
    problem = Problem(table, (0, 0), BifurcationKind.FLIP, "lam", closure=MIRROR)
    for lam, cycle in _cycles_of_four(table):
        if abs(math.remainder(cycle[0] + cycle[2], 2 * math.pi)) < 1e-6:
            for share in range(1, 12):
                try:
                    found = floats(problem, [*cycle[:2], lam + share / 100])
                except ValueError:
                    continue
                if 0 <= found[-1] - lam < 0.15:
                    return problem, found
    raise ValueError(f"egg: alpha = {alpha} has no symmetric attracting cycle of period 4 that {TRIED}")


def critical_cycle(alpha: Expr, n: int) -> tuple[Problem, list[float]]:
    """The system of equations for `lambda_n`, and a starting point for its solution."""
    if not 2 <= n <= HIGHEST:
        raise ValueError(f"locate doubling: n = {n} is out of range; accepted: 2 to {HIGHEST}")
    if n == 2:
        return _second(alpha)
    found = doubling(alpha, n)
    return found.problem, found.start


def doubling(alpha: Expr, n: int) -> Doubling:
    """The flip `lambda_n` of the egg in float64; earlier flips are computed once and kept."""
    known, more = _known(alpha)
    tick = telling("doublings in float64")
    while len(known) < n - 2:
        try:
            known.append(next(more))
        except (ValueError, StopIteration):
            _known.cache_clear()
            raise
        tick(2.0 ** (known[-1].n - n - 1))  # each costs twice the one before
    return known[n - 3]


@cache
def _known(alpha: Expr) -> tuple[list[Doubling], Iterator[Doubling]]:
    return [], cascade(alpha)


def _second(alpha: Expr) -> tuple[Problem, list[float]]:
    ends = [alpha_tilde().subs(lam_symbol, k) for k in (1, 0)]
    if not ends[0] < alpha < ends[1]:
        raise ValueError(
            f"locate doubling: alpha = {alpha} has no lambda_2; the diameter doubles for alpha "
            f"between {N(ends[0], 6)} and {N(ends[1], 6)}"
        )
    low, high = 0.0, 1.0  # alpha-tilde falls as lam grows
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if float(alpha_tilde().subs(lam_symbol, middle)) > alpha else (low, middle)
    return Problem(tables.egg(3).at(alpha=alpha), (0, 0), BifurcationKind.FLIP, "lam"), [0.0, 3.14159265, low]
