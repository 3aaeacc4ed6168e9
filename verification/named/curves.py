"""The bifurcation curves of the K-pointed egg that lead to its chaotic attractor, and where the cascade ends.

For odd K the vertex-to-flat diameter doubles its period on `alpha-tilde`; the symmetric cycle of period 4
born there breaks its symmetry (a pitchfork, on half the cycle), and the cycles born then double again and
again, up to an accumulation curve. Every curve is followed in the two parameters from one start.

A cycle may expand areas although `lam < 1`, as its determinant is not `lam**p` (`symbolic.cycles.thresholds`), and then
Neimark-Sacker bifurcations are possible. Four facts about the paper's own egg are proved in balls:

- `contracting_up_to`: a contraction below which no cycle of the egg expands areas, so that none bifurcates that way;
- `expanding_cycle`: a hexagon at `alpha = 0.08`, `lam = 0.95` whose determinant is above 1;
- `double_one`: a cycle of period 17 with the double multiplier 1 at some `lam < 1`. It is a regular zero, so along
  `det M = 1` the trace crosses 2 there: on one side the multipliers are complex, of modulus 1;
- `invariant_circle`: the cycle on that side with trace 1/2, around which an attracting closed curve is born.

The limit `lambda_infinity` of a cascade, and `delta`, that of the ratios of its steps, are estimated and not certified.
Two schemes that both assume only geometric convergence are used: Wynn's epsilon algorithm on the sequence itself, and
Aitken's process on the remainder after the leading term has been removed with the universal constant of
[Feigenbaum1979]. Their difference is the stated error.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from math import pi
from typing import Any

import mpmath
import numpy as np
from flint import arb
from sympy import Expr, Rational, atan

from symbolic.cycles.polygons import largest_tilt
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.expressions.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.table import alpha as alpha_symbol
from symbolic.tables.table import lam
from verification.arithmetic.balls import balls, decimal, exact_balls, working
from verification.cycles.arc import Steps
from verification.cycles.branch import branch
from verification.cycles.cascade import doubling
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords
from verification.cycles.critical import Small, critical, polygon
from verification.cycles.newton import refined
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import Array, BifurcationKind
from verification.cycles.switching import CodimensionOneCurve, Degenerate, curve, switched
from verification.named.locate import proof_near
from verification.proofs.periodic.interval_newton import Enclosure, interval_newton
from verification.proofs.periodic.torus import TRACE, Rotating, Torus, torus

TWO = ("alpha", "lam")
SHARE = 0.96  # times the shape whose diameter doubles at lam = 0: there all doublings exist
Tick = Callable[[str], None]


@dataclass(frozen=True)
class BifurcationCurve:
    """A curve of the cascade: a bifurcation of a cycle of `period` bounces."""

    name: str
    period: int
    kind: BifurcationKind
    curve: CodimensionOneCurve = field(repr=False)

    @property
    def special(self) -> tuple[Degenerate, ...]:
        """Points of codimension two on the curve."""
        return self.curve.special

    def lam(self, alpha: float) -> float | None:
        """The contraction on the curve at the shape `alpha`; None if the curve does not reach this shape."""
        found = self.curve.crossing(alpha)
        return float(found[0][-1]) if found else None


def largest_shape(K: int) -> float:
    """The largest `alpha` for which the table is convex, `1/(1 + K**2)`."""
    return 1 / (1 + K * K)


def cascade(K: int = 3, highest: int = 64, tick: Tick = lambda name: None) -> Iterator[BifurcationCurve]:
    """The curves from the period doubling of the diameter to those of the cycles of `highest` bounces; K must be odd.

    >>> curves = cascade(3, 4)
    >>> [(c.name, [d.kind.value for d in c.special]) for c in curves]  # doctest: +NORMALIZE_WHITESPACE
    [('doubling of 2', ['1:2 resonance']), ('symmetry breaking of 4', ['1:2 resonance']),
     ('doubling of 4', ['1:2 resonance'])]
    """
    if K % 2 == 0:
        raise ValueError(f"cascade: K = {K} is even, and no diameter doubles its period; accepted: odd K from 3")
    table, top = egg(K), largest_shape(K)
    at = {"alpha": SHARE * float(alpha_tilde(K).subs(lam, 0))}
    box, steps = ((top / 200, top), (0.0, 1.0)), Steps(largest=0.15)
    one = branch(Chords(table, (0, 0)), np.array([0.0, pi]), "lam", 0.0, (0.0, 1.0), at)
    period = 2
    while period <= highest:
        event = next(e for e in one.events if e.kind in (BifurcationKind.FLIP, BifurcationKind.PITCHFORK))
        period = one.system.recurrence.period
        what = "doubling" if event.kind is BifurcationKind.FLIP else "symmetry breaking"
        name = f"{what} of {period}"
        tick(name)
        found = curve(event.ring, BifurcationKind.FLIP, event.x, TWO, (at["alpha"], event.value), box, steps=steps)
        yield BifurcationCurve(name, period, event.kind, found)
        if period >= highest and event.kind is BifurcationKind.FLIP:
            return
        one = switched(one, event, (0.0, 1.0))[0]


def fold(K: int = 3, p: int = 1, q: int = 3) -> BifurcationCurve:
    """The fold curve of the egg's polygon that turns by `2*pi*p/q` at each bounce, computed by continuation."""
    ring = polygon(K, p, q)
    top = largest_shape(K)
    at = {"alpha": 0.8 * top}
    one = branch(ring, np.array([pi / K]), "lam", 1.0, (0.0, 1.0), at)
    event = next(e for e in one.events if e.kind is BifurcationKind.FOLD)
    box = ((top / 200, top), (0.0, 1.0))
    found = curve(ring, BifurcationKind.FOLD, event.x, TWO, (at["alpha"], event.value), box, steps=Steps(largest=0.15))
    return BifurcationCurve(f"fold of {p}/{q}", q, BifurcationKind.FOLD, found)


@dataclass(frozen=True)
class AccumulationCurve:
    """The curve at which the doublings accumulate: for each shape a contraction with its error."""

    alpha: Array
    lam: Array
    error: Array


def accumulation_curve(curves: list[BifurcationCurve], alphas: Array) -> AccumulationCurve:
    """The contraction at which the cascade ends, for each shape that all doublings in `curves` reach.

    The error is the largest difference to other extrapolations, and to the same one without the last curve.
    """
    doublings = [c for c in curves if c.kind is BifurcationKind.FLIP and c.period > 2]
    found = []
    for alpha in alphas:
        values = [c.lam(float(alpha)) for c in doublings]
        if any(value is None for value in values):
            continue
        decimals = [repr(value) for value in values]
        estimate, shorter = limit(decimals), limit(decimals[:-1])
        error = max(estimate.error, abs(estimate.value - shorter.value))
        found.append((float(alpha), float(estimate.value), float(error)))
    rows = np.array(found).reshape(-1, 3)
    return AccumulationCurve(rows[:, 0], rows[:, 1], rows[:, 2])


BITS = 128
HEXAGON = (0.0, 1.0472, 2.0944, 3.1416, 4.1888, 5.236)
LONG = (  # period 17, rotation number 4/17; then alpha and lam
    *(0.031731, 1.939716, 3.434869, 4.415375, 6.136337, 1.136034, 2.284457, 4.108431, 5.740919),
    *(0.357381, 2.12005, 4.011587, 5.416771, 0.214657, 2.020715, 3.654544, 4.551936),
    *(0.06873034054513638, 0.9637899748709065),
)
TURNING = 0.06873034020024987, 0.9637899755913615  # where its trace is 1/2


def expanding_cycle() -> tuple[bool, arb]:
    """A hexagon in the egg at `alpha = 0.08`, `lam = 0.95`: True if it is proved to exist, and its determinant.

    >>> proved, determinant = expanding_cycle()
    >>> proved, bool(determinant > 1)
    (True, True)
    """
    problem = Problem(egg(3).at(alpha="2/25"), (0,) * 6, lam=Rational(19, 20))
    proof = proof_near(problem, list(HEXAGON), 20)
    with working(BITS):
        chain = Linearised(problem, balls(BITS), proof.enclosure.zero).plain
        _, determinant = trace_and_determinant(chain.rows)
    return proof.proved, determinant


def resonance(period: int) -> Small:
    """The system for a cycle of the egg with the double multiplier 1; unknowns are the bounces, `alpha` and `lam`."""
    both = BifurcationKind.FOLD, BifurcationKind.TORUS
    return critical(Chords(egg(3), (0,) * period), both, ("alpha", "lam"))


def double_one() -> Enclosure:
    """The cycle of period 17 with the double multiplier 1, enclosed; the last two balls are `alpha` and `lam`."""
    system = resonance(17)
    solution = refined(system, list(LONG), 24)
    with working(256):
        radius = (arb(10) ** -22).mid()
    return interval_newton(system, exact_balls(solution.z), radius, 256)


@cache
def invariant_circle() -> Torus:
    """The cycle of period 17 with trace 1/2 and determinant 1, a torus bifurcation as the contraction varies.

    For each contraction above the enclosed one and near it, an attracting closed curve of the 17th iterate surrounds
    each point of the cycle. As the trace 1/2 is not an integer, contractions with an irrational rotation on the curve
    come arbitrarily close.

    >>> found = invariant_circle()
    >>> found.certified, found.attracting, found.side, found.problem.irrational
    (True, True, 1, True)
    """
    problem = Rotating(Chords(egg(3), (0,) * 17), TWO, {TRACE: Rational(1, 2)})
    return torus(problem, [*LONG[:17], *TURNING], "lam")


def contracting_up_to(alpha: Expr) -> float:
    """A contraction, a multiple of 1/64, up to which the determinant of every cycle of the egg is below 1.

    With `d` the largest tilt of the normal and `r` the ratio of the largest and the smallest radius, the sine
    rule on the triangle of a chord and the centre gives `|eta| <= d + asin(r*sin(d + |phi|))`. As `|phi|` is at most
    `lam*|eta|`, this can exclude that the largest `|eta|` of a cycle is between the root of `x*tan(x) = 1` and
    `pi/2`; then every factor `lam*cos(phi)/cos(eta)` of the determinant, one for each bounce, is below 1.

    >>> contracting_up_to(Rational(2, 25))
    0.328125
    """
    best = 0.0
    with working(BITS):
        tilt, ratio = load(
            kernel(
                "egg", [], {"tilt": atan(largest_tilt(3).subs(alpha_symbol, alpha)), "ratio": (1 + alpha) / (1 - alpha)}
            ),
            balls(BITS),
        )()
        for step in range(1, 64):
            if not _confined(tilt, ratio, arb(step) / 64):
                return best
            best = step / 64
    return best


def _confined(tilt: arb, ratio: arb, lam: arb) -> bool:
    """True if `d + asin(r*sin(d + lam*E)) < E` is proved for all `E` from the root of `x*tan(x) = 1` to `pi/2`."""
    low, high, pieces = arb("0.8603"), arb.pi() / 2, 512
    for k in range(pieces):
        E = low + (high - low) * arb(2 * k + 1, 1) / (2 * pieces)
        steepest = ratio * (tilt + lam * E).sin()
        if not (tilt + lam * E < arb.pi() / 2 and steepest < 1 and tilt + steepest.asin() < E):
            return False
    return bool(low * low.tan() < 1)


DELTA = "4.669201609102990671853203820466201617258185577475768632745651343"  # [Feigenbaum1979]; OEIS A006890
DIGITS = 60
EACH = 50  # digits of each doubling


@dataclass(frozen=True)
class LimitEstimate:
    """A limit, and the largest difference to other extrapolations, as mpmath numbers."""

    value: Any
    error: Any


def limit(values: Sequence[str]) -> LimitEstimate:
    """The limit of the contractions `lambda_n` of a cascade, which are given as decimals, with an error.

    >>> found = limit([str(1 - mpmath.mpf(4.669201609) ** -n) for n in range(3, 12)])
    >>> abs(found.value - 1) < 1e-12
    True
    """
    context = mpmath.MPContext()
    context.dps = DIGITS
    given = [context.mpf(v) for v in values]
    delta = context.mpf(DELTA)
    removed = [(delta * b - a) / (delta - 1) for a, b in pairwise(given)]
    return _compared(wynn(given), wynn(removed))


def ratio(values: Sequence[str]) -> LimitEstimate:
    """The limit of `(lambda_n - lambda_(n-1))/(lambda_(n+1) - lambda_n)`: an estimate of `delta`.

    >>> found = ratio([str(1 - mpmath.mpf(3) ** -n) for n in range(3, 12)])
    >>> abs(found.value - 3) < 1e-9
    True
    """
    context = mpmath.MPContext()
    context.dps = DIGITS
    gaps = [b - a for a, b in pairwise(context.mpf(v) for v in values)]
    ratios = [a / b for a, b in pairwise(gaps)]
    return _compared(wynn(ratios), aitken(ratios), wynn(ratios[:-1]))  # on four terms the first two are equal


def _compared(one: Any, *others: Any) -> LimitEstimate:
    return LimitEstimate(one, max(abs(one - other) for other in others))


def wynn(values: Sequence[Any]) -> Any:
    """The limit of a sequence, as the last even entry of Wynn's epsilon table.

    >>> wynn([1, 1.5, 1.75, 1.875])
    2.0
    """
    before: list[Any] = [0] * (len(values) + 1)
    here = list(values)
    best = here[-1]
    for order in range(1, len(values)):
        differences = [b - a for a, b in pairwise(here)]
        if any(d == 0 for d in differences):
            return best
        before, here = here, [before[i + 1] + 1 / d for i, d in enumerate(differences)]
        if order % 2 == 0:
            best = here[-1]
    return best


def aitken(values: Sequence[Any]) -> Any:
    """The limit of a sequence, by Aitken's process, which is repeated while three terms remain."""
    here = list(values)
    while len(here) >= 3:
        following = []
        for a, b, c in zip(here, here[1:], here[2:], strict=False):
            if c - 2 * b + a == 0:
                return c
            following.append(c - (c - b) ** 2 / (c - 2 * b + a))
        here = following
    return here[-1]


@dataclass(frozen=True)
class Accumulation:
    """The certified doublings of a cascade as decimals, and estimates of its limit and ratio.

    `supercritical` says that a stable cycle is born at each doubling, by the sign of its normal form in balls.
    """

    lams: tuple[str, ...]
    supercritical: bool
    limit: LimitEstimate
    ratio: LimitEstimate


def accumulation(alpha: Expr, highest: int = 10) -> Accumulation:
    """The cascade of the egg up to `lambda_highest`, each doubling certified to 50 digits, and its estimated limit.

    >>> from sympy import Rational
    >>> found = accumulation(Rational(2, 25), 8)
    >>> mpmath.nstr(found.limit.value, 8), found.limit.error < 1e-7
    ('0.39352047', True)
    """
    lams, stable = [], True
    for n in range(3, highest + 1):
        here = doubling(alpha, n)
        proof = proof_near(here.problem, here.start, EACH, in_balls=True)
        if not proof.proved:
            raise ValueError(f"cascade: lambda_{n} at alpha = {alpha} is not certified: {proof.checks}")
        lams.append(decimal(proof.value, EACH)[0])
        stable = stable and proof.supercritical is True
    return Accumulation(tuple(lams), stable, limit(lams), ratio(lams))
