"""What is proved of cycles beyond existence: the checklist of a bifurcation, islands, intervals of contractions.

**The checklist.** Every item is proved (True), refuted (False), or unknown (None). Only a cycle that passes all of it
bifurcates as its kind says, at the enclosed value and nowhere else in the box. The items and what they rest on:

- `exists`, `unique`: the interval Newton operator maps the box into its interior;
- `precise`: the radius is what was asked for;
- `admissible`: bounces inside their components, and every chord first-hits the next one;
- `minimal_period`: no shorter cycle;
- `simple_multiplier`, `transversal`, `nondegenerate`: the numbers of the normal form are not 0;
- `other_multiplier_stable`: the other multiplier lies inside the unit circle.

An elliptic cycle of the elastic map whose twist is proved not to vanish is surrounded by invariant curves: an island.
Moser's twist theorem [Moser1962] [SiegelMoser1971] asks of an area-preserving analytic map: a multiplier on the unit
circle whose first four powers are not 1, and a normal form `w -> mu*w*(1 + i*twist*|w|^2 + ...)` with `twist` not 0.
Both are decided by balls on an enclosed cycle. The theorem itself is taken from the literature.

**Over an interval of contractions**, covered by small balls: of a cycle near a given one it is proved that it exists
and attracts, or is a saddle: with `lam` a ball the interval Newton operator proves one cycle for each `lam` of it,
and balls for trace and determinant of the monodromy matrix decide stability.

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
from functools import cache
from math import factorial
from typing import Any

from flint import acb, arb, arb_mat
from sympy import Interval, Rational, diff

from symbolic.cycles.normal_forms import QUARTIC, Map, bounce, chord, composed
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.expressions.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.curves import is_periodic
from symbolic.tables.table import Table, theta
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import balls, real_ball, working
from verification.arithmetic.iteration import Tick, silent
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import trace_and_determinant
from verification.cycles.newton import floats
from verification.cycles.problem import Linearised, NormalForm, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.maps.first_hit import convex, first_hits, inside, minimal
from verification.proofs.periodic.interval_newton import Enclosure, Status, dense, interval_newton, krawczyk, slope_bits

Checks = dict[str, bool | None]


@dataclass(frozen=True)
class Claim:
    """A box that should hold one solution of a problem: exact midpoints, one exact radius."""

    problem: Problem
    centre: tuple[arb, ...]
    radius: arb
    bits: int
    digits: int


@dataclass(frozen=True)
class Proof:
    """What was proved of a claim: the checklist, the enclosure, and the normal form at a bifurcation."""

    claim: Claim
    checks: Checks
    enclosure: Enclosure
    form: NormalForm | None = None

    @property
    def certified(self) -> bool:
        """True when every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())

    @property
    def value(self) -> arb:
        """The ball of the free parameter."""
        value: arb = self.enclosure.zero[-1]
        return value

    @property
    def supercritical(self) -> bool | None:
        """True when a flip bears a cycle that is stable, next to the unstable one; None when not decided."""
        return self.form.supercritical if self.form else None


def proved(claim: Claim) -> Proof:
    """The checklist of a claim, worked through.

    >>> from symbolic.tables import cuspless
    >>> horizontal = Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam")
    >>> with working(80):
    ...     near = (arb(0), arb(0), arb("0.0934003354315").mid())
    >>> proof = proved(Claim(horizontal, near, arb(2) ** -40, 80, 10))
    >>> proof.certified, proof.supercritical
    (True, False)
    """
    problem = claim.problem
    enclosure = interval_newton(problem, list(claim.centre), claim.radius, claim.bits)
    found = {Status.UNIQUE: True, Status.EMPTY: False}.get(enclosure.status)
    checks: Checks = {"exists": found, "unique": found}
    with working(claim.bits):
        zero = enclosure.zero
        bound = arb(10) ** -claim.digits
        checks["precise"] = bool(zero[-1].rad() < bound) if found else None
        shape = (zero[-1],) if problem.table.shapes else ()  # else what varies is lam, or a letter of the law
        whole = zero[: problem.period]
        if problem.mirror:
            whole = whole + [-x for x in whole]
        parts = problem.components * (len(whole) // problem.period)
        inner = found and _allowed(problem, zero[-1])
        checks["admissible"] = _admissible(claim, parts, whole, shape) if inner else None
        checks["minimal_period"] = minimal(problem.table, parts, whole) if found else None
        if problem.kind is None:
            return Proof(claim, checks, enclosure)
        form = None
        for bits in (min(claim.bits, 2 * slope_bits(len(zero))), claim.bits) if found else ():
            form = _form(problem, zero, bits)
            if None not in _generic(form).values():
                break
        return Proof(claim, checks | _generic(form), enclosure, form)


def _admissible(claim: Claim, parts: tuple[int, ...], whole: list[arb], shape: tuple[arb, ...]) -> bool | None:
    """In a convex table the bounces lie inside their parts; in any other each chord is examined too."""
    problem, law = claim.problem, claim.problem.law
    turns = not law.measured and is_periodic(law.phi)  # arc length grows by a whole perimeter
    if law.measured and len(problem.table.components) == 1:  # it jumps: beyond, the equations are of another law
        whole = [arb(x, claim.radius) for x in claim.centre[: problem.period]]
    placed = inside(problem.table, parts, whole, shape, turns or not law.placed)
    if placed is not True or convex(problem.table, shape) is True:
        return placed
    return first_hits(problem.table, parts, whole, shape)


def _allowed(problem: Problem, free: arb) -> bool:
    """Does the free parameter lie in its range: a shape where the table is one, a contraction from 0 to 1?"""
    ranges = {"lam": Interval(0, 1)} | {p.symbol.name: p.range for p in problem.table.shapes}
    if problem.free not in ranges:
        return True
    low, high = ranges[problem.free].start, ranges[problem.free].end
    return bool((low.is_infinite or free >= real_ball(low)) and (high.is_infinite or free <= real_ball(high)))


def _form(problem: Problem, zero: list[arb], bits: int) -> NormalForm | None:
    try:
        with working(bits):
            return Linearised(problem, balls(bits), zero).normal_form(balls(bits))
    except ZeroDivisionError:
        return None


def _generic(form: NormalForm | None) -> Checks:
    items = ("simple_multiplier", "transversal", "nondegenerate", "other_multiplier_stable")
    if form is None:
        return dict.fromkeys(items)
    values = [_nonzero(form.turn), _nonzero(form.speed), _nonzero(form.bend)]
    size = abs(form.determinant)
    values.append(True if size < 1 else False if size > 1 else None)
    return dict(zip(items, values, strict=True))


def _nonzero(x: arb) -> bool | None:
    return True if x.is_finite() and not x.contains(0) else None


@dataclass(frozen=True)
class Twist:
    """Of an elliptic cycle: trace, twist, and the real part of the cubic coefficient, which conserved area makes 0."""

    trace: arb
    twist: arb
    drift: arb

    @property
    def islands(self) -> bool | None:
        """True when the hypotheses of the twist theorem are proved: no power of `mu` up to the fourth is 1."""
        elliptic = abs(self.trace) < 2 and self.trace != 0 and self.trace + 1 != 0
        return True if elliptic and (self.twist > 0 or self.twist < 0) else None


def twist(points: Table, components: Sequence[int], bounces: Sequence[arb], bits: int) -> Twist:
    """The twist of the elastic cycle through the enclosed boundary parameters.

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
    """Trace and twist of a map that preserves area, at an elliptic fixed point. `c1` as in [Kuznetsov2004]."""
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
    """The Taylor coefficients of `x`, then those of `y`, on a component."""
    x, y = table.components[index].point
    terms = {f"{name}{k}": diff(f, theta, k) / factorial(k) for name, f in (("x", x), ("y", y)) for k in range(5)}
    return load(kernel("jet", [theta], terms), balls(bits))


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
    return bool(math.prod((bend, *at.plain.upper, at.plain.diagonal[0])) > 0)  # turn has the other sign than u0*u1*d0


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
    """How far from the middle of a step its bounces may be, from how far they moved to it: a guess."""
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
        sound = over.status is at.status is Status.UNIQUE and convex(table) is True
        if not (sound and inside(table, components, over.zero) and minimal(table, components, over.zero)):
            return Stability.UNKNOWN
        here = trace_and_determinant(Linearised(thin, balls(BITS_OF_INTERVAL), at.zero).terms.rows)
        slopes = _slopes(wide, over.zero)
        if slopes is None:
            return Stability.UNKNOWN
        return stability(*(x + d * reach for x, d in zip(here, slopes, strict=True)))


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
