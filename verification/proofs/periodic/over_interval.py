"""Statements about cycles for every contraction of an interval: the interval is covered by small balls.

Of a cycle near a given one it is proved that it exists and attracts, or is a saddle: with `lam` a ball the interval
Newton operator proves one cycle for each `lam` of it, and balls for trace and determinant of the monodromy matrix
decide stability.

Of the egg's diameters it is proved that they double supercritically all along `alpha-tilde`. On that curve the
multiplier is -1 by a closed form, so only signs are left, and balls decide them on a cover of `0 <= lam <= 1`. With
the vertex first, `turn = -(1 - lam**2)*u0*u1/d0` exactly, where `u`, `d` are the entries of the chain: its zero at
`lam = 1` is divided out. The flip is supercritical when `bend` and `turn` differ in sign; at `lam = 1` the second
multiplier is -1 too, and a flip has no side there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from flint import arb, arb_mat
from sympy import Rational

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.expressions.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.table import Table
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import balls, working
from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.series import Jet, jets
from verification.cycles.recurrence.chain import trace_and_determinant
from verification.cycles.recurrence.newton import floats
from verification.cycles.recurrence.problem import Linearised, Problem
from verification.cycles.recurrence.recurrence import BifurcationKind
from verification.maps.first_hit import convex, inside, minimal
from verification.proofs.periodic.interval_newton import Status, dense, krawczyk

BITS = 80
SMALLEST = 2.0**-40  # halves of halves must stay exact in floats


@dataclass(frozen=True)
class Sign:
    """`supercritical` for all contractions, or None when the budget ended; and the balls it took."""

    supercritical: bool | None
    balls: int


def doubling_curve(K: int = 3, budget: int = 4000, tick: Tick = silent) -> Sign:
    """Is the period doubling of the diameters supercritical for every `0 <= lam < 1`?

    >>> doubling_curve().supercritical
    True
    """
    queue, spent = [(0.5, 0.5)], 0
    with working(BITS):
        curve = load(kernel("curve", [letter], {"alpha": alpha_tilde(K)}), balls(BITS))
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > budget or half < SMALLEST:
                return Sign(None, spent)
            if _supercritical(K, arb(middle, half), curve(arb(middle, half))[0]):
                tick(2 * half)
            else:
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return Sign(True, spent)


def _supercritical(K: int, lam: arb, alpha: arb) -> bool:
    problem = Problem(egg(K), (0, 0), BifurcationKind.FLIP, "alpha", lam)
    try:
        at = Linearised(problem, balls(BITS), [arb(0), arb.pi(), alpha])
        bend = at.normal_form(balls(BITS)).bend
    except ZeroDivisionError:
        return False
    chain = at.plain
    return bool(-bend * chain.upper[0] * chain.upper[1] / chain.diagonal[0] < 0)


BITS_OF_INTERVAL = 96
ROUNDING = 2.0**-50  # neighbouring balls of lam overlap, whatever floats do to their ends


class Stability(Enum):
    """Where the multipliers of a cycle lie."""

    ATTRACTING = "inside the unit circle"
    SADDLE = "one outside [-1, 1], one inside"
    UNKNOWN = "not decided"


@dataclass(frozen=True)
class OverInterval:
    """`reached` is how far the proof came, from the first end; `proved` when that is the other end."""

    proved: bool
    reached: float
    balls: int


def over_interval(
    table: Table,
    components: tuple[int, ...],
    start: Sequence[float],
    ends: tuple[float, float],
    wanted: Stability,
    budget: int = 2000,
    tick: Tick = silent,
) -> OverInterval:
    """Is there a cycle of the `wanted` stability for every `lam` between `ends`, near `start` at the first?

    >>> from symbolic.tables import egg
    >>> flat, tilted = [1.05, 3.14, 5.24], Rational(2, 25)
    >>> over_interval(egg(3).at(alpha=tilted), (0, 0, 0), flat, (0.99, 0.9), Stability.ATTRACTING).proved
    True
    """
    lam, end = ends
    theta = floats(Problem(table, components, lam=Rational(lam)), start)
    spent, step, at = 0, (end - lam) / 16, lam
    rates = [1.0] * len(theta)
    while (end - lam) * step > 0:
        step = math.copysign(min(abs(step), abs(end - lam)), step)
        spent += 1
        if spent > budget or abs(step) < 1e-9:
            return OverInterval(False, lam, spent)
        middle = lam + step / 2
        try:
            moved = floats(Problem(table, components, lam=Rational(middle)), theta)
        except ValueError:
            step /= 2
            continue
        if middle != at:
            rates = [abs(x - y) / abs(middle - at) for x, y in zip(moved, theta, strict=True)]
        radii = [abs(step) * (0.7 * rate + 0.2 * max(rates)) + 1e-12 for rate in rates]
        if _proved(table, components, moved, middle, abs(step) / 2, radii) is wanted:
            tick(step / (end - ends[0]))
            lam, at, theta, step = lam + step, middle, moved, step * 1.3
        else:
            step /= 2
    return OverInterval(True, end, spent)


def _proved(
    table: Table, components: tuple[int, ...], theta: list[float], middle: float, half: float, radii: list[float]
) -> Stability:
    with working(BITS_OF_INTERVAL):
        wide = Problem(table, components, lam=arb(middle, half + ROUNDING))
        thin = Problem(table, components, lam=arb(middle))
        centre = [arb(x) for x in theta]
        over = krawczyk(wide, centre, radii, BITS_OF_INTERVAL)
        at = krawczyk(thin, centre, radii, BITS_OF_INTERVAL)
        if over.status is not Status.UNIQUE or at.status is not Status.UNIQUE or convex(table) is not True:
            return Stability.UNKNOWN
        if not inside(table, components, over.zero) or not minimal(table, components, over.zero):
            return Stability.UNKNOWN
        here = trace_and_determinant(Linearised(thin, balls(BITS_OF_INTERVAL), at.zero).terms.rows)
        slopes = _slopes(wide, over.zero)
        if slopes is None:
            return Stability.UNKNOWN
        return stability(*(x + d * arb(0, half + ROUNDING) for x, d in zip(here, slopes, strict=True)))


def _slopes(problem: Problem, zero: list[arb]) -> tuple[arb, arb] | None:
    """The derivatives by `lam` of trace and determinant along the cycle, over the ball of `lam`."""
    at = Linearised(problem, balls(BITS_OF_INTERVAL), zero)
    try:
        motion = dense(at.plain).solve(arb_mat([[-x] for x in at.terms.by["lam"]]))
    except ZeroDivisionError:
        return None
    moving = Problem(problem.table, problem.components, lam=Jet(problem.lam, 1))
    path = [Jet(x, motion[i, 0]) for i, x in enumerate(zero)]
    trace, determinant = trace_and_determinant(Linearised(moving, jets(balls(BITS_OF_INTERVAL)), path).terms.rows)
    return trace.c[1], determinant.c[1]


def stability(trace: arb, determinant: arb) -> Stability:
    """Both multipliers inside the unit circle, or one on each side of it, or not decided.

    >>> [stability(arb(t), arb("0.5")).name for t in (1, 2, 1.5)]
    ['ATTRACTING', 'SADDLE', 'UNKNOWN']
    """
    at_one, at_minus_one = 1 - trace + determinant, 1 + trace + determinant  # the characteristic polynomial
    if at_one > 0 and at_minus_one > 0 and determinant < 1:
        return Stability.ATTRACTING
    if at_one * at_minus_one < 0:
        return Stability.SADDLE
    return Stability.UNKNOWN
