"""Errors, condition number and verdict of a computed answer; cycles for which they are extreme.

With data `x`, truth `f(x)` and answer `y`, the *forward error* is `|y - f(x)|`. The *backward error* is the smallest
`(dx, dy)` with `y + dy = f(x + dx)`, to first order: the smallest change of the data and the result that makes the
answer exact ([Higham2002], section 1.5, calls this the mixed error). The *condition number* is the largest factor
between the two. Errors are absolute, in units of the rounding of 1.

The cases are very long cycles and cycles next to a bifurcation, where the chord system is nearly singular. Their
backward error is the residual of the collision rule, the largest of the angles at the bounces; their forward error is
the largest error at a bounce. The condition number is that of `Solution`, taken at the truth; near a multiplier `1 + d`
it is of the size of `1/d`. The truth is the solution with 100 digits.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import partial
from math import inf, isfinite, log10, ulp
from typing import Any

import mpmath
from sympy import Expr, N, Rational, acos, pi, sqrt, tan

from symbolic import tables
from symbolic.cycles import polygons
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables.table import alpha as alpha_symbol
from symbolic.tables.table import lam as lam_symbol
from verification.arithmetic.balls import bits_of, multiprecision
from verification.arithmetic.iteration import Stop, iterated
from verification.cycles.cascade import doubled, doubling
from verification.cycles.newton import (
    ROUNDINGS,
    Conditioning,
    Solution,
    UnsettledError,
    costs_half,
    in_floats,
    norm_of_inverse,
    refined,
)
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind

DOUBLE = 2.0**-52  # the unit of rounding

SMALL = ROUNDINGS  # units of rounding: up to this, the backward error is explained by the data
UNIT, DIGITS = 2.0**-52, 15  # of a float64


class StabilityVerdict(Enum):
    """The verdict on a computed answer; the value of a member is its explanation for a user."""

    STABLE = "as accurate as rounded data allow"
    SENSITIVE = "as accurate as rounded data allow, but to less than half of the digits; give data with more digits"
    STOPPED = "no number: the kernel stops the particle and names the outcome"
    UNSTABLE = "wrong by more than rounded data explain; use the named alternative"


@dataclass(frozen=True)
class Errors:
    """Forward and backward error in units of rounding, and the condition number that relates them."""

    forward: float
    backward: float
    condition: float

    @property
    def ratio(self) -> float:
        """Forward error over condition number; if at most 1, rounding the data once has at least as large an effect."""
        return self.forward / self.condition if isfinite(self.condition) else 0.0

    @property
    def stability(self) -> StabilityVerdict:
        """The verdict from backward error and condition number.

        >>> Errors(forward=4e3, backward=2, condition=1e4).stability.name
        'STABLE'
        >>> Errors(forward=4e3, backward=2e3, condition=2).stability.name
        'UNSTABLE'
        """
        if not self.backward <= SMALL:
            return StabilityVerdict.UNSTABLE
        return StabilityVerdict.SENSITIVE if costs_half(self.condition, UNIT, DIGITS) else StabilityVerdict.STABLE


WRONG = Errors(inf, inf, 1.0)  # another component, or no number at all


@dataclass(frozen=True)
class Finding:
    """One kernel on one case: its worst answer over all starts, the outcome if it stopped, and what to use instead.

    `named` is the kernel's own verdict on its condition number, if it gives one; `reason` explains a verdict that is
    not plainly stable.
    """

    case: str
    kernel: str
    measured: Errors | None
    status: str = ""
    instead: str = ""
    named: Conditioning | None = None
    reason: str = ""

    @property
    def stability(self) -> StabilityVerdict:
        """The verdict on the worst start; `STOPPED` if the kernel gave no number.

        Unless it is unstable, the verdict is the kernel's own on its condition number (`named`), if there is one.

        >>> Finding("fold", "Newton", Errors(4e9, 0.5, 8e12), named=Conditioning.SENSITIVE).stability.name
        'SENSITIVE'
        """
        if self.measured is None:
            return StabilityVerdict.STOPPED
        if self.named is None or self.measured.stability is StabilityVerdict.UNSTABLE:
            return self.measured.stability
        return StabilityVerdict.STABLE if self.named is Conditioning.SOUND else StabilityVerdict.SENSITIVE


NEAR_DIGITS = 100
Sought = tuple[Problem, list[float]]


@dataclass(frozen=True)
class ChordSystem:
    """A cycle that is hard to compute: its equations, and a start for Newton's method."""

    name: str
    group: str
    sought: Callable[[], Sought]


def nearly_round(gap: Expr) -> Sought:
    """The short axis of the ellipse `a = 1 + gap`; its multipliers are near 1, their value for a circle."""
    return Problem(tables.ellipse.at(a=1 + gap), (0, 0), lam=Rational(1, 3)), [1.5707963, -1.5707964]


def nearly_flipped(gap: Expr, twice: bool) -> Sought:
    """The egg's diameter where its multiplier is close to -1, as a cycle of period 2, or of period 4 if `twice`."""
    shape = alpha_tilde().subs(lam_symbol, Rational(1, 3)) + gap
    table = tables.egg(3).at(alpha=Rational(float(N(shape, 30))))
    times = 2 if twice else 1
    return Problem(table, (0, 0) * times, lam=Rational(1, 3)), [1e-7, 3.1415926] * times


def folded(ulps: int | None) -> Sought:
    """The egg's triangle, `ulps` doubles above the contraction at which it is born, or at that contraction for None."""
    shape = Rational(2, 25)
    table = tables.egg(3).at(alpha=shape)
    exact = float(N(polygons.saddle_node().subs(alpha_symbol, shape), 30))
    turn = -float(N(acos(-shape))) / 3
    start = [turn + float(N(2 * pi / 3)) * k for k in range(3)]
    if ulps is None:
        return Problem(table, (0, 0, 0), BifurcationKind.FOLD, "lam"), [*start, exact]
    lam = exact + ulps * ulp(exact)
    aside = (ulps * ulp(exact)) ** 0.5
    return Problem(table, (0, 0, 0), lam=Rational(lam)), [x + aside for x in start]


def touching(gap: Expr) -> Sought:
    """The egg's triangle at a contraction that is a double, for a shape whose fold is lower by `gap`."""
    lam = Rational(float(N(polygons.saddle_node().subs(alpha_symbol, Rational(2, 25)), 30)))
    tilt = pi / 6 * (1 - lam + gap) / (1 + lam - gap)  # the closed form of the fold, solved for the shape
    shape = Rational(str(N(tan(tilt) / sqrt(9 + tan(tilt) ** 2), 60)))
    turn = -acos(-shape) / 3
    start = [float(N(turn + 2 * pi * k / 3, 30)) + float(sqrt(gap)) for k in range(3)]
    return Problem(tables.egg(3).at(alpha=shape), (0, 0, 0), lam=lam), start


def in_the_cascade(power: int) -> Sought:
    """A cycle of period `2**power` of the egg; the contraction is a third of the way from its birth to its doubling."""
    below = doubling(Rational(2, 25), power)
    gap = (doubling(Rational(2, 25), power + 1).lam - below.lam) / 3
    theta, lam = doubled(below.problem, below.start, gap)
    return Problem(below.problem.table, (0,) * 2**power, lam=Rational(lam)), theta


UNSETTLED = "did not settle"
FLOAT64, SIXTEEN = "Newton, float64", "Newton, mpmath, 16 digits"


def findings(cycle: ChordSystem) -> list[Finding]:
    """Errors, residual and condition number of a cycle solved in float64 and in mpmath."""
    problem, start = cycle.sought()
    truth = solution(problem, start)
    context = mpmath.MPContext()
    context.dps = NEAR_DIGITS + 20
    wide = multiprecision(context)
    condition = norm_of_inverse(problem, wide, truth)
    made = []
    for kernel, solve in ((FLOAT64, in_floats), (SIXTEEN, settled)):
        try:
            found, stopped = solve(problem, start), False
        except UnsettledError as error:
            found, stopped = error.last, True
        said = found.conditioning
        status = [UNSETTLED] * stopped + ([] if said is Conditioning.SOUND else [said.name])
        z = [context.mpf(x) for x in found.z]
        residual = max(abs(x) for x in problem.value(wide, z))
        forward = max(abs(one - two) for one, two in zip(z, truth, strict=True))
        sizes = Errors(*(float(x) for x in (forward / DOUBLE, residual / DOUBLE, condition)))
        measured = None if stopped else sizes if sizes.forward < 1 / DOUBLE else WRONG
        why = f"condition number {found.condition:.2g}, {found.digits_sure} digits sure" if found.advice else ""
        made.append(Finding(cycle.name, kernel, measured, ", ".join(status), found.advice, said, why))
    return made


def solution(problem: Problem, start: list[float]) -> list[Any]:
    """The solution with `NEAR_DIGITS` digits: by doubling the digits at each step, or at once if float64 diverges."""
    try:
        return refined(problem, start, NEAR_DIGITS).z
    except ValueError:
        return settled(problem, start, bits_of(NEAR_DIGITS + 20)).z


def settled(problem: Problem, start: list[float], bits: int = 53) -> Solution:
    """The solution by Newton's method in mpmath with `bits` bits, iterated until the corrections stop shrinking."""
    context = mpmath.MPContext()
    context.prec = bits
    newton = partial(problem.newton, multiprecision(context))
    found = iterated(newton, [context.mpf(x) for x in start], Stop(small=1e-6, steps=60))
    return Solution(problem, found.x, int((bits - 1) * log10(2)), ())


ONE, MINUS, LONG = "Multipliers next to +1", "Multipliers next to -1", "Long cycles"
COARSE_GAP, FINE_GAP = Rational(1, 10**6), Rational(1, 2 * 10**13)
FLIP_GAP, FOLD_GAP = Rational(1, 10**14), Rational(1, 10**27)
CYCLES = (
    ChordSystem("short axis, a = 1 + 1e-6: 1.6e-5 from +1", ONE, lambda: nearly_round(COARSE_GAP)),
    ChordSystem("short axis, a = 1 + 5e-14: 8e-13 from +1", ONE, lambda: nearly_round(FINE_GAP)),
    ChordSystem("triangle, 1e6 ulp above its fold", ONE, lambda: folded(10**6)),
    ChordSystem("triangle, 4 ulp above its fold", ONE, lambda: folded(4)),
    ChordSystem("triangle, lam 1e-27 above its fold: 9e-13 from +1", ONE, lambda: touching(FOLD_GAP)),
    ChordSystem("the fold itself, lam unknown", ONE, lambda: folded(None)),
    ChordSystem(
        "egg's diameter, alpha 1e-14 from its flip: 8e-13 from -1", MINUS, lambda: nearly_flipped(FLIP_GAP, twice=False)
    ),
    ChordSystem("the same run twice, as period 4", MINUS, lambda: nearly_flipped(FLIP_GAP, twice=True)),
    ChordSystem("period 2^4 of the egg's cascade", LONG, lambda: in_the_cascade(4)),
)
LONGER = (
    ChordSystem("period 2^8 of the egg's cascade", LONG, lambda: in_the_cascade(8)),
    ChordSystem("period 2^12 of the egg's cascade", LONG, lambda: in_the_cascade(12)),
)
