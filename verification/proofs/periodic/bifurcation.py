"""The checklist of a bifurcation: every item proved (True), refuted (False), or unknown (None).

Only a cycle that passes all of it bifurcates as its kind says, at the enclosed value and nowhere
else in the box. The items and what they rest on:

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
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import factorial
from typing import Any

from flint import acb, arb
from sympy import diff

from symbolic.cycles.normal_forms import QUARTIC, Map, bounce, chord, composed
from symbolic.expressions.text import kernel, load
from symbolic.tables.table import Table, theta
from verification.arithmetic.balls import balls, working
from verification.cycles.recurrence.problem import Linearised, NormalForm, Problem
from verification.maps.first_hit import convex, first_hits, inside, minimal
from verification.proofs.periodic.interval_newton import Enclosure, Status, interval_newton, slope_bits

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
        """The ball of the free letter."""
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
    found = enclosure.status is Status.UNIQUE
    checks: Checks = {"exists": True if found else None, "unique": True if found else None}
    if enclosure.status is Status.EMPTY:
        checks = {"exists": False, "unique": False}
    with working(claim.bits):
        zero = enclosure.zero
        bound = arb(10) ** -claim.digits
        checks["precise"] = bool(zero[-1].rad() < bound) if found else None
        shape = (zero[-1],) if problem.free not in ("", "lam") else ()
        whole = zero[: problem.period]
        if problem.mirror:
            whole = whole + [-x for x in whole]
        parts = problem.components * (len(whole) // problem.period)
        checks["admissible"] = _admissible(problem, parts, whole, shape) if found else None
        checks["minimal_period"] = minimal(problem.table, parts, whole) if found else None
        if problem.kind is None:
            return Proof(claim, checks, enclosure)
        form = None
        for bits in (min(claim.bits, 2 * slope_bits(len(zero))), claim.bits) if found else ():
            form = _form(problem, zero, bits)
            if None not in _generic(form).values():
                break
        return Proof(claim, checks | _generic(form), enclosure, form)


def _admissible(problem: Problem, parts: tuple[int, ...], whole: list[arb], shape: tuple[arb, ...]) -> bool | None:
    """In a convex table the bounces lie inside their parts; in any other each chord is examined too."""
    placed = inside(problem.table, parts, whole)
    if placed is not True or convex(problem.table, shape) is True:
        return placed
    return first_hits(problem.table, parts, whole, shape)


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
        return birkhoff_normal_form(
            composed([bounce(chord(here, there, lambda x: x.sqrt())) for here, there in flights])
        )


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
