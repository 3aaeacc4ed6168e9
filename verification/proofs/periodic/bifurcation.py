"""The checklist of a bifurcation: every item proved (True), refuted (False), or unknown (None).

Only a cycle that passes all of it bifurcates as its kind says, at the enclosed value and nowhere
else in the box. The items and what they rest on:

- `exists`, `unique`: the interval Newton operator maps the box into its interior;
- `precise`: the radius is what was asked for;
- `admissible`: bounces inside their components, and every chord first-hits the next one;
- `minimal_period`: no shorter cycle;
- `simple_multiplier`, `transversal`, `nondegenerate`: the numbers of the normal form are not 0;
- `other_multiplier_stable`: the other multiplier lies inside the unit circle.
"""

from dataclasses import dataclass

from flint import arb

from verification.arithmetic.words import balls, working
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.shooting.normal_form import NormalForm, normal_form
from verification.cycles.shooting.problem import Linearised, Problem, Rows
from verification.maps.admissible import convex, inside, minimal
from verification.maps.first_hit import first_hits
from verification.proofs.periodic.interval_newton import Enclosure, Status, contraction, slope_bits

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
        return self.enclosure.zero[-1]

    @property
    def supercritical(self) -> bool | None:
        """True when a flip bears a cycle that is stable, next to the unstable one; None when not decided.

        The cycle that is born lies on the side `branch`, and the old one is unstable where its
        multiplier has passed -1: the two sides agree at a supercritical flip.
        """
        if self.form is None or self.claim.problem.kind is not BifurcationKind.FLIP:
            return None
        side = self.form.branch * self.form.multiplier_speed
        return True if side < 0 else False if side > 0 else None


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
    enclosure = contraction(problem, list(claim.centre), claim.radius, claim.bits)
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
            return normal_form(Linearised(Rows(problem, balls(bits)), zero), balls(bits))
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
