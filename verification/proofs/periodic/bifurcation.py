"""Further proofs on cycles: elliptic islands, cycles over an interval of contractions, doubling of the egg's diameters.

**Islands.** An elliptic cycle of the elastic map with a twist that is not 0 is surrounded by invariant curves. Moser's
twist theorem [Moser1962] [SiegelMoser1971] requires that an area-preserving analytic map has a multiplier `mu` on the
unit circle whose first four powers are not 1, and a normal form `w -> mu*w*(1 + i*twist*|w|^2 + ...)` with `twist` not
0. Both are proved in balls on an enclosed cycle. The theorem itself is taken from the literature.

**An interval of contractions** is covered by small balls of `lam`. For each ball the interval Newton operator proves
one cycle near a given one, and balls for trace and determinant of its monodromy matrix prove that the cycle attracts,
or that it is a saddle.

**Doubling.** The egg's diameters undergo a supercritical period doubling all along `alpha-tilde`. On that curve the
multiplier is -1 by a closed form, so only signs remain to be proved, in balls that cover `0 <= lam <= 1`. With the
vertex first, `turn = -(1 - lam**2)*u0*u1/d0` exactly, where `u`, `d` are entries of the chain, so the zero of `turn` at
`lam = 1` is divided out analytically. The flip is supercritical when `bend` and `turn` differ in sign; at `lam = 1`
both multipliers are -1, and a flip is neither super- nor subcritical.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from math import factorial
from typing import Any

from flint import acb, arb, arb_mat
from sympy import Rational, diff

from symbolic.cycles.normal_forms import QUARTIC, Map, bounce, chord, composed
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.expressions.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.table import Table, theta
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import Box, balls, working
from verification.arithmetic.iteration import Tick, silent
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import trace_and_determinant
from verification.cycles.newton import floats
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.maps.first_hit import convex, inside, minimal
from verification.proofs.periodic.interval_newton import ZeroStatus, dense, krawczyk
from verification.rigorous.exclusion import Search, bisect

Checks = dict[str, bool | None]


@dataclass(frozen=True)
class Twist:
    """Trace and twist of an elliptic cycle; `drift` is the real part of the cubic coefficient, 0 if areas are kept."""

    trace: arb
    twist: arb
    drift: arb

    @property
    def islands(self) -> bool | None:
        """True when the hypotheses of the twist theorem are proved, with `mu**k` not 1 for `k` up to 4; else None."""
        elliptic = abs(self.trace) < 2 and self.trace != 0 and self.trace + 1 != 0
        return True if elliptic and (self.twist > 0 or self.twist < 0) else None


def twist(points: Table, components: Sequence[int], bounces: Sequence[arb], bits: int) -> Twist:
    """The twist of an elastic cycle whose bounces are enclosed boundary parameters on the given components.

    >>> from symbolic.tables import ellipse
    >>> axis = twist(ellipse.at(a=3), (0, 0), [-arb.pi() / 2, arb.pi() / 2], 100)  # trace 4*(1 - 2/9)^2 - 2
    >>> (81 * axis.trace).contains(34), axis.drift.contains(0)
    (True, True)
    """
    with working(bits):
        jets = [_jet(points, index, bits)(at) for index, at in zip(components, bounces, strict=True)]
        ends = [(jet[: QUARTIC + 1], jet[QUARTIC + 1 :]) for jet in jets]
        flights = zip(ends, [*ends[1:], ends[0]], strict=True)
        bounced = [bounce(chord(here, there, lambda x: x.sqrt())) for here, there in flights]
        return birkhoff_normal_form(composed(bounced))


def birkhoff_normal_form(map: Map) -> Twist:
    """Trace and twist of an area-preserving map at an elliptic fixed point, with `c1` as in [Kuznetsov2004]."""
    x, p = map
    A, B, D = x[1, 0], x[0, 1], p[0, 1]
    trace = A + D
    sine = (1 - trace * trace / 4).sqrt()
    sine = sine if B > 0 else -sine
    alpha, beta = (A - D) / (2 * sine), B / sine
    mu, scale = acb(trace / 2, sine), beta.sqrt()
    # x = scale*X, p = (P - alpha*X)/scale turns by the angle; z = X - i*P, so X = (z + w)/2, P = i*(z - w)/2
    one, i = acb(1), acb(0, 1)
    X = {(1, 0): one / 2, (0, 1): one / 2}
    P = {(1, 0): i / 2, (0, 1): -i / 2}
    here = {at: scale * c for at, c in X.items()}, {at: (P[at] - alpha * X[at]) / scale for at in X}
    moved = composed([here, map])
    turned = {
        at: moved[0].get(at, 0) / scale - i * (scale * moved[1].get(at, 0) + alpha * moved[0].get(at, 0) / scale)
        for at in {**moved[0], **moved[1]}
    }
    g20, g11, g02, g21 = (turned.get(at, acb(0)) * n for at, n in (((2, 0), 2), ((1, 1), 1), ((0, 2), 2), ((2, 1), 2)))
    bar = mu.conjugate()
    c1 = (
        g20 * g11 * (bar - 3 + 2 * mu) / (2 * (mu * mu - mu) * (bar - 1))
        + g11 * g11.conjugate() / (1 - bar)
        + g02 * g02.conjugate() / (2 * (mu * mu - bar))
        + g21 / 2
    )
    return Twist(trace, (bar * c1).imag, (bar * c1).real)


@cache
def _jet(table: Table, index: int, bits: int) -> Any:
    """A function that gives the Taylor coefficients, to order 4, of `x` and then of `y` on a component."""
    x, y = table.components[index].point
    terms = {f"{name}{k}": diff(f, theta, k) / factorial(k) for name, f in (("x", x), ("y", y)) for k in range(5)}
    return load(kernel("jet", [theta], terms), balls(bits))


BITS = 80
SMALLEST = 2.0**-40  # above it halves are exact in floats


def doubling_curve(K: int = 3, budget: int = 4000, tick: Tick = silent) -> Search:
    """The proof that the period doubling of the diameters is supercritical for every `0 <= lam < 1`.

    >>> doubling_curve().proved
    True
    """
    with working(BITS):
        curve = load(kernel("curve", [letter], {"alpha": alpha_tilde(K)}), balls(BITS))

        def supercritical(box: Box) -> bool:
            lam = arb(*box[0])
            return _supercritical(K, lam, curve(lam)[0])

        return bisect(((0.5, 0.5),), supercritical, budget, SMALLEST, tick)


def _supercritical(K: int, lam: arb, alpha: arb) -> bool:
    problem = Problem(egg(K), (0, 0), BifurcationKind.FLIP, "alpha", lam)
    try:
        at = Linearised(problem, balls(BITS), [arb(0), arb.pi(), alpha])
        bend = at.normal_form(balls(BITS)).bend
    except ZeroDivisionError:
        return False
    return bool(math.prod((bend, *at.plain.upper, at.plain.diagonal[0])) > 0)  # turn and u0*u1*d0 have opposite signs


BITS_OF_INTERVAL = 96
ROUNDING = 2.0**-50  # so that neighbouring balls of lam overlap in spite of rounding


class Stability(Enum):
    """The position of a cycle's two multipliers relative to the unit circle."""

    ATTRACTING = "inside the unit circle"
    SADDLE = "one outside [-1, 1], one inside"
    UNKNOWN = "not decided"


@dataclass(frozen=True)
class OverInterval:
    """Result: contractions from the first end to `reached` are done; `proved` is True if that is the other end."""

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
    """The proof of a cycle of the `wanted` stability for every `lam` between `ends`, near `start` at the first end.

    >>> from symbolic.tables import egg
    >>> flat, tilted = [1.05, 3.14, 5.24], Rational(2, 25)
    >>> over_interval(egg(3).at(alpha=tilted), (0, 0, 0), flat, (0.99, 0.9), Stability.ATTRACTING).proved
    True
    """
    (lam, end), spent = ends, 0
    theta = floats(Problem(table, components, lam=Rational(lam)), start)
    step, at = (end - lam) / 16, lam
    while lam != end:
        there = lam + step if abs(step) < abs(end - lam) else end
        step = there - lam
        spent += 1
        if spent > budget or abs(step) < 1e-9:
            return OverInterval(False, lam, spent)
        middle = lam + step / 2
        try:
            moved = floats(Problem(table, components, lam=Rational(middle)), theta)
        except ValueError:
            step /= 2
            continue
        radii = _radii(moved, theta, step / (middle - at))
        if _proved(table, components, moved, middle, abs(step) / 2, radii) is wanted:
            tick(step / (end - ends[0]))
            lam, at, theta, step = there, middle, moved, step * 1.3
        else:
            step /= 2
    return OverInterval(True, end, spent)


def _radii(moved: list[float], theta: list[float], share: float) -> list[float]:
    """A guess of the radii of the box of bounces in the next step: about `share` times their last displacements."""
    reaches = [abs((x - y) * share) for x, y in zip(moved, theta, strict=True)]
    return [0.7 * reach + 0.2 * max(reaches) + 1e-12 for reach in reaches]


def _proved(
    table: Table, components: tuple[int, ...], theta: list[float], middle: float, half: float, radii: list[float]
) -> Stability:
    with working(BITS_OF_INTERVAL):
        reach = arb(0, half + ROUNDING)
        wide = Problem(table, components, lam=arb(middle) + reach)
        thin = Problem(table, components, lam=arb(middle))
        centre = [arb(x) for x in theta]
        over = krawczyk(wide, centre, radii, BITS_OF_INTERVAL)
        at = krawczyk(thin, centre, radii, BITS_OF_INTERVAL)
        sound = over.status is at.status is ZeroStatus.UNIQUE and convex(table) is True
        if not (sound and inside(table, components, over.zero) and minimal(table, components, over.zero)):
            return Stability.UNKNOWN
        here = trace_and_determinant(Linearised(thin, balls(BITS_OF_INTERVAL), at.zero).terms.rows)
        slopes = _slopes(wide, over.zero)
        if slopes is None:
            return Stability.UNKNOWN
        return stability(*(x + d * reach for x, d in zip(here, slopes, strict=True)))


def _slopes(problem: Problem, zero: list[arb]) -> tuple[arb, arb] | None:
    """The derivatives of trace and determinant by `lam` along the family of cycles, over a ball of `lam`; or None."""
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
    """The position of the multipliers, from trace and determinant.

    >>> [stability(arb(t), arb("0.5")).name for t in (1, 2, 1.5)]
    ['ATTRACTING', 'SADDLE', 'UNKNOWN']
    """
    at_one, at_minus_one = 1 - trace + determinant, 1 + trace + determinant  # the characteristic polynomial
    if at_one > 0 and at_minus_one > 0 and determinant < 1:
        return Stability.ATTRACTING
    if at_one * at_minus_one < 0:
        return Stability.SADDLE
    return Stability.UNKNOWN
