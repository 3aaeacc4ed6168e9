"""Starts for Newton's method, in float64: attractors by iteration, cycles followed in the contraction.

Nothing here is proved and nothing needs to be: a start only has to lie in reach of Newton's method.
"""

import math
from collections.abc import Callable, Sequence

from sympy import Rational

from symbolic.tables.table import Table
from verification.arithmetic.words import FLOAT64
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.shooting.newton import floats
from verification.cycles.shooting.normal_form import normal_form
from verification.cycles.shooting.problem import Linearised, Problem, Rows

FEIGENBAUM = 4.6692
SETTLE = 3000  # bounces thrown away before an attractor is looked at
SAME = 1e-7  # radians: an orbit that returns this close is taken for a cycle


def attractor(table: Table, lam: float, start: tuple[float, float], longest: int = 64) -> list[float]:
    """The cycle that a ball settles on, as bounce parameters; empty when none of `longest` bounces.

    For tables of one convex component; `start` are two successive bounces.

    >>> from symbolic.tables import ellipse
    >>> [round(abs(x), 6) for x in attractor(ellipse.at(a="3/2"), 0.25, (0.4, 2.9))]
    [1.570796, 1.570796]
    """
    angle = Rows(Problem(table, (0, 0), lam=Rational(0)), FLOAT64).kernel(0, 0, 1)
    before, here = start
    orbit: list[float] = []
    for bounce in range(SETTLE):
        before, here = here, math.remainder(_landing(angle, here, -lam * angle(here, before)[0]), 2 * math.pi)
        orbit.append(here)
        if bounce % 200 == 199:
            last = orbit[-2 * longest :]
            for period in range(1, longest + 1):
                if all(_near(last[i], last[i + period]) for i in range(longest)):
                    return last[-period:]
    return []


def _landing(angle: Callable[..., tuple[float, ...]], here: float, phi: float) -> float:
    """Where a ball lands that leaves `here` at `phi`: the angle falls from pi/2 to -pi/2 on the way round."""
    low, high = here, here + 2 * math.pi
    x = here + math.pi - 2 * phi
    for _ in range(60):
        value, _, slope, *_ = angle(here, x)
        low, high = (x, high) if value > phi else (low, x)
        better = x - (value - phi) / slope
        better = better if low < better < high else (low + high) / 2
        if abs(better - x) < 4e-16 * 8:
            return better
        x = better
    return x


def _near(x: float, y: float) -> bool:
    return abs(math.remainder(x - y, 2 * math.pi)) < SAME


def characteristic(
    table: Table, theta: Sequence[float], lam: float, kind: BifurcationKind, components: tuple[int, ...] = ()
) -> float:
    """`det(M - mu)` of a cycle's monodromy matrix `M`, up to sign; `mu` is the critical multiplier of `kind`."""
    free = Problem(table, components or (0,) * len(theta), kind, "lam")
    found = Linearised(Rows(free, FLOAT64), [*theta, lam], slope=False).critical
    value, power = found.rest / found.chain.upper[-1], 0
    for pivot, upper in zip(found.pivots, found.chain.upper, strict=False):
        value, more = math.frexp(value * pivot / upper)  # a long product leaves the range of floats on its way
        power += more
    return math.ldexp(value, power)


def cycle_at(table: Table, theta: Sequence[float], lam: float, components: tuple[int, ...] = ()) -> list[float]:
    """The cycle near `theta` at contraction `lam`, in float64; on one component when none are given."""
    return floats(Problem(table, components or (0,) * len(theta), lam=Rational(lam)), theta)


def next_critical(table: Table, theta: Sequence[float], lam: float, step: float, kind: BifurcationKind) -> list[float]:
    """`[*theta, lam]` where the cycle has the multiplier -1 (or 1), followed from `lam` in steps of `step`."""
    problem = Problem(table, (0,) * len(theta), kind, "lam")
    before: list[float] = []
    here = cycle_at(table, theta, lam)
    value = characteristic(table, here, lam, kind)
    for _ in range(400):
        guess = here if not before else [2 * x - y for x, y in zip(here, before, strict=True)]
        if not 0 <= lam + step <= 1:
            break
        after = cycle_at(table, guess, lam + step)
        if max(abs(x - y) for x, y in zip(after, guess, strict=True)) > 0.1:
            before, step = [], step / 2
            continue
        new = characteristic(table, after, lam + step, kind)
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
        f"{table.name}: no {kind.name.lower()} of this cycle of period {len(theta)} was met up to lam = {lam:.6f}, "
        f"followed in steps of {step:.3g}"
    )


def doubled(problem: Problem, critical: Sequence[float], distance: float) -> tuple[list[float], float]:
    """The cycle of twice the period that a flip bears, near `lam + distance`, and that `lam`.

    The branch is `lam + c*e**2`, with `c` from the third-order terms; it may lie on either side.
    """
    at = Linearised(Rows(problem, FLOAT64), list(critical))
    c, vector = float(normal_form(at, FLOAT64).branch), at.critical.right
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
