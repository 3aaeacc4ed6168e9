"""Theorems that a box holds exactly one cycle, and that the cycle attracts or bifurcates, with their certificates.

The hypotheses, and how each is proved:

- `exists`, `unique`: the interval Newton operator maps the box into its interior;
- `precise`: the radius of the value is below `10**-digits`;
- `admissible`: the bounces lie inside their components, every chord hits the next bounce first, and the law maps
  `[-pi/2, pi/2]` into itself;
- `minimal_period`: the cycle does not repeat a shorter one;
- `simple_multiplier`, `transversal`, `nondegenerate`: the corresponding numbers of the normal form are not 0;
- `other_multiplier_stable`: the other multiplier lies inside the unit circle.

A cycle that passes all of them bifurcates as its kind says, at the enclosed value and nowhere else in the box.

In a certificate file an exact number is a pair `[mantissa, exponent]` of decimal texts; see
`docs/certificate_format.md`.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice, product
from typing import Any, Self

from flint import arb, fmpz
from sympy import Expr, Interval

from symbolic.cycles import polygons, thresholds
from symbolic.expressions.text import kernel, load
from symbolic.tables.curves import is_periodic
from symbolic.tables.definition import POINTS, table_boundary
from symbolic.tables.formula import number
from symbolic.tables.table import alpha, lam
from verification.arithmetic.balls import balls, bits_of, real_ball, working
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords
from verification.cycles.problem import Linearised, NormalForm, Problem, seen_mirrored
from verification.cycles.recurrence import IDENTITY, BifurcationKind, Closure
from verification.maps.first_hit import convex, first_hits, inside, minimal
from verification.maps.joins import SIDES, over_joins
from verification.maps.one_sided import Matrix, OneSided, of_rows, verdict
from verification.proofs.periodic.bifurcation import Stability, stability
from verification.proofs.periodic.interval_newton import UniqueZero, slope_bits
from verification.rigorous.certificate import SCHEMA, decimal_result
from verification.rigorous.scene_entries import check_size, scene_of, scene_said, title_of
from verification.rigorous.theorem import Verdict, hypothesis

LARGEST_BITS, LARGEST_DIGITS = 200_000, 60_000
LONGEST = 1024  # the most bounces in a certificate
INTEGER = re.compile(r"0|-?[1-9][0-9]{0,130000}")
Box = tuple[tuple[arb, ...], arb, int, int]  # centre, radius, bits, digits
Side = tuple[tuple[int, ...], list[arb], list[arb]]  # components, parameters, slopes
BETWEEN = 2**40  # denominators of fractions that enclose a ball


@dataclass(frozen=True, repr=False)
class SolutionInBox(UniqueZero):
    """A theorem with a certificate: a system of equations of a scene has exactly one solution in a box."""

    schema = SCHEMA
    beside = ("checks",)

    def in_box(self, exact: Expr) -> bool:
        """True if the enclosure of the last unknown holds the closed form `exact`."""
        with working(self.bits):
            return bool((self.centre[-1] + arb(0, self.radius)).overlaps(closed_form(exact, self.digits + 5)))

    @property
    def subject(self) -> dict[str, Any]:
        """The entries that describe the system: kind, scene, free parameter, components, mirror."""
        raise NotImplementedError

    @property
    def statement_in_words(self) -> str:
        """The sentence that the certificate states."""
        said = self.subject
        n = "{} bounces, and then their mirror images," if said["mirror"] else "its {} bounces"
        scene, count = title_of(said["scene"]), n.format(len(said["components"]))
        return STATEMENTS[said["kind"]].format(scene=scene, n=count, free=said["free"])

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document; `ValueError` if it exceeds the limits of certificate checkers."""
        said = self.subject
        if self.bits > LARGEST_BITS or self.digits > LARGEST_DIGITS or len(said["components"]) > LONGEST:
            given = f"{self.digits} digits, {self.bits} bits or {len(said['components'])} bounces"
            most = f"{LARGEST_DIGITS} digits, {LARGEST_BITS} bits and {LONGEST} bounces"
            raise ValueError(f"certificate: {given} is too much; accepted: up to {most}")
        check_size(said["scene"])
        box = {"bits": self.bits, "digits": self.digits, "centre": [_pair(x) for x in self.centre]}
        first = {"schema": self.schema, "name": self.name, "statement": self.statement_in_words}
        return first | said | box | {"radius": _pair(self.radius)}

    @property
    def evidence(self) -> dict[str, Any]:
        """The checklist, as an entry of the document."""
        return {"checks": self.checks}

    @property
    def result(self) -> dict[str, Any]:
        """The value as a decimal with `digits` digits, and its radius."""
        return decimal_result(self.value, self.digits)

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> Self:
        """The theorem that a document of this version states; `ValueError` if an entry is out of range."""
        bits, digits = int(given["bits"]), int(given["digits"])
        if not 16 <= bits <= LARGEST_BITS or not 1 <= digits <= LARGEST_BITS:
            wanted = f"bits from 16 and digits from 1, both up to {LARGEST_BITS}"
            raise ValueError(f"certificate: bits = {bits} or digits = {digits} is out of range; accepted: {wanted}")
        centre, radius = tuple(_ball(pair) for pair in given["centre"]), _ball(given["radius"])
        if not centre:
            raise ValueError("certificate: centre has no unknowns; accepted: one for each bounce and free parameter")
        held = number(given["scene"]["lam"], "lam") if "lam" in given["scene"] else None
        if held is not None and not 0 <= held <= 1:
            raise ValueError(f"certificate: lam = {held} is no contraction; accepted: numbers in [0, 1]")
        return cls.about(given, held, (centre, radius, bits, digits))

    @classmethod
    def about(cls, given: Mapping[str, Any], lam: Expr | None, box: Box) -> Self:
        """The theorem about the system that a document describes, for the given box."""
        raise NotImplementedError


STATEMENTS = {  # by kind; docs/certificate_format.md explains each
    "cycle": "{scene}: exactly one cycle has {n} in the box.",
    "fold": "{scene}: exactly one cycle with {n} and {free} in the box has the multiplier 1: a fold.",
    "flip": "{scene}: exactly one cycle with {n} and {free} in the box has the multiplier -1: a flip.",
    "focus": "{scene}: exactly one cycle with {n} and {free} in the box has two equal multipliers.",
    "corner": "{scene}: exactly one orbit with theta and lam in the box runs from the upper corner to theta, the lower "
    "corner, -theta and back; it is unstable; as a function of the exit angle s_4 has a minimum at a kink there, which "
    "falls as lam grows; the value is {free}.",
}


def check_unknowns(box: Box, wanted: int) -> None:
    """`ValueError` unless the centre of the box has `wanted` entries."""
    if len(box[0]) != wanted:
        raise ValueError(f"certificate: centre has {len(box[0])} entries for {wanted} unknowns")


def closed_form(expression: Expr, digits: int) -> arb:
    """An exact expression as a ball of about `digits` digits."""
    bits = bits_of(digits, 64)
    with working(bits):
        ball: arb = load(kernel("value", [], {"value": expression}), balls(bits))()[0] + arb(0)
        return ball


@dataclass(frozen=True, repr=False)
class UniqueCycle(SolutionInBox):
    """The box holds exactly one cycle of a problem; its coordinates are the bounces, and the free parameter if any.

    >>> from symbolic.tables import cuspless
    >>> horizontal = Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam")
    >>> with working(80):
    ...     near = (arb(0), arb(0), arb("0.0934003354315").mid())
    >>> proof = cycle_in_box(horizontal, near, arb(2) ** -40, 80, 10)
    >>> proof.proved, proof.supercritical
    (True, False)
    """

    problem: Problem

    @property
    def system(self) -> Problem:
        """The equations of the problem, as a system."""
        return self.problem

    @hypothesis(refutable=True)
    def precise(self) -> Verdict:
        """The radius of the value is small enough for the digits stated."""
        return self.within_digits() if self.found else None

    @property
    def theta(self) -> list[arb]:
        """The bounces of the box; only half of them if their mirror images complete the cycle."""
        return self.enclosure.zero[: self.problem.period]

    @property
    def whole(self) -> tuple[tuple[int, ...], list[arb]]:
        """Components and bounces of the whole cycle, with the mirror images if they complete it."""
        bounces = self.theta + [-x for x in self.theta] if self.problem.mirror else self.theta
        return self.problem.components * (len(bounces) // self.problem.period), bounces

    @hypothesis(refutable=True)
    def admissible(self) -> Verdict:
        """Bounces lie inside their components, every chord ends at its first hit, and the law is valid."""
        with working(self.bits):
            return self.first_hits() if self.found and self.allowed() and self.reflects() else None

    @hypothesis
    def minimal_period(self) -> Verdict:
        """The cycle is not a shorter one run through several times."""
        with working(self.bits):
            on_sides = [minimal(self.problem.table, parts, theta) for parts, theta, _ in self.sides if self.found]
            return all(on_sides) if on_sides else None

    @property
    def is_cycle(self) -> bool:
        """True if the box is proved to hold exactly one solution, a cycle of the table with this minimal period."""
        return self.exists is self.unique is self.admissible is self.minimal_period is True

    @cached_property
    def sides(self) -> list[Side]:
        """The ways to assign the bounces to components on which they may lie; several if the box reaches over joins.

        Each way has the components, the parameters on them, and the derivatives of these by the bounces' own
        parameters. The list is empty if there are too many ways.
        """
        table = self.problem.table
        several = self.problem.kind is None and len(table.components) > 1
        over = over_joins(table, balls(self.bits)) if several else None
        ways = [over(*bounce) if over else [(*bounce, arb(1))] for bounce in zip(*self.whole, strict=True)]
        found = [tuple(zip(*way, strict=True)) for way in islice(product(*ways), SIDES + 1)]
        return [(parts, [*theta], [*slopes]) for parts, theta, slopes in found] if len(found) <= SIDES else []

    @property
    def one_sided(self) -> OneSided | None:
        """The verdict of the one-sided derivatives if the box reaches over a join; else None."""
        if not (self.found and len(self.sides) > 1):
            return None
        with working(self.bits):
            return verdict([self.derivative(*side) for side in self.sides])

    def derivative(self, parts: Sequence[int], theta: list[arb], slopes: list[arb]) -> Matrix:
        """Derivative of the return map in two successive bounces, for one assignment of the bounces to components."""
        words = balls(self.bits)
        ring = Chords(self.problem.table, tuple(parts), law=self.problem.law)
        terms = ring.bounces(words, IDENTITY.padded(theta, 0), self.problem.at(words, self.enclosure.zero), 2)
        return of_rows(terms.rows, slopes)  # to order 2, in which no formula stops at its join

    @property
    def form(self) -> NormalForm | None:
        """The normal form of the bifurcation; None for a cycle without a bifurcation."""
        return None

    @property
    def supercritical(self) -> Verdict:
        """True if a flip gives birth to a stable cycle beside the unstable one; None if not decided."""
        return self.form.supercritical if self.form else None

    def first_hits(self) -> Verdict:
        """True if the bounces lie inside their components and no chord meets the boundary on its way; else None."""
        problem, law, (parts, whole) = self.problem, self.problem.law, self.whole
        shape = (self.value,) if problem.table.shapes else ()  # else lam, or a letter of the law, is free
        turns = not law.measured and is_periodic(law.phi)  # arc length is not periodic
        if law.measured and len(problem.table.components) == 1:  # beyond its jump the equations belong to another law
            whole = [arb(x, self.radius) for x in self.centre[: problem.period]]
        rough = problem.kind is None and not law.placed
        placed = inside(problem.table, parts, whole, shape, turns or not law.placed, rough, over=not law.placed)
        if placed is not True or convex(problem.table, shape) is True:
            return placed
        free = [first_hits(problem.table, on, theta, shape) for on, theta, _ in self.sides]
        return all(free) if free else None

    def allowed(self) -> bool:
        """True if the free parameter is proved to lie in its range: that of the shape, or 0 to 1 for a contraction."""
        ranges = {"lam": Interval(0, 1)} | {p.symbol.name: p.range for p in self.problem.table.shapes}
        if self.problem.free not in ranges:
            return True
        low, high = ranges[self.problem.free].start, ranges[self.problem.free].end
        above = low.is_infinite or self.value >= real_ball(low)
        return bool(above and (high.is_infinite or self.value <= real_ball(high)))

    def reflects(self) -> bool:
        """True if the law is proved to map `[-pi/2, pi/2]` into itself, for all values of the free parameter."""
        problem, law, free = self.problem, self.problem.law, self.value
        if law.uniform:
            return True
        low, high = (Fraction(int((side * BETWEEN).floor().fmpq()), BETWEEN) for side in (free.lower(), free.upper()))
        ball = low, high + Fraction(1, BETWEEN)
        lam = (max(low, 0), min(ball[1], 1)) if problem.free == "lam" else (problem.lam, problem.lam)
        own = dict.fromkeys(law.parameters, ball)
        return bool(law.proof((0, 1) if None in lam else lam, *law.places(problem.table), **own))

    @property
    def name(self) -> str:
        """The title of the theorem; a name known to `locate` if the box holds the closed form that belongs to this
        name.

        A doubling has no name, since other cycles of the same period double too.
        """
        problem, table = self.problem, self.problem.table
        what = None if problem.mirror else (table.name, problem.period, problem.kind, problem.free)
        if what == ("cuspless", 2, BifurcationKind.FLIP, "lam") and self.in_box(thresholds.lambda_c()):
            return "lambda-c"
        if what and table_boundary(table)[0].get("K", POINTS) == POINTS:
            if what == ("egg", 2, BifurcationKind.FLIP, "alpha") and self.in_box(
                thresholds.alpha_tilde().subs(lam, problem.lam)
            ):
                return "alpha-tilde"
            if what == ("egg", 3, BifurcationKind.FOLD, "lam") and self.in_box(
                polygons.saddle_node().subs(alpha, dict(table.fixed).get("alpha"))
            ):
                return "saddle-node"
        said = self.subject
        half = "half of a symmetric cycle," if problem.mirror else "a cycle"
        if problem.kind is None:
            return f"{half} of period {problem.period}: {title_of(said['scene'])}"
        return f"{said['kind']} of {half} of period {problem.period} in {problem.free}: {title_of(said['scene'])}"

    @property
    def subject(self) -> dict[str, Any]:
        """The entries that describe the problem."""
        problem = self.problem
        scene = scene_said(problem.table, problem.law, problem.lam)
        said = {"kind": problem.kind.name.lower() if problem.kind else "cycle", "scene": scene, "free": problem.free}
        return said | {"components": list(problem.components), "mirror": problem.mirror}

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document."""
        found = super().to_dict()
        if len(self.sides) > 1 or any(side[0] != self.whole[0] for side in self.sides):
            raise ValueError("certificate: the box reaches over a join; accepted: bounces within a component")
        if self.problem.mirror and not seen_mirrored(self.problem, "table" not in found["scene"]):
            raise ValueError(
                "certificate: theta -> -theta is proved to be a symmetry, but the text of the formulas does not show it"
            )
        return found

    @classmethod
    def about(cls, given: Mapping[str, Any], lam: Expr | None, box: Box) -> Self:
        """The theorem about the problem that a document describes, for the given box."""
        components = tuple(int(i) for i in given["components"])
        if not 2 <= len(components) <= LONGEST:
            raise ValueError(f"certificate: {len(components)} bounces are out of range; accepted: 2 to {LONGEST}")
        table, law = scene_of(given["scene"], given["free"], box[0][-1] + arb(0, box[1]))
        if not set(components) <= set(range(len(table.components))):
            raise ValueError(f"certificate: {table.name} has components 0 to {len(table.components) - 1} only")
        kind = None if given["kind"] == "cycle" else BifurcationKind[given["kind"].upper()]
        closure = Closure(-1 if given["mirror"] else 1)
        problem = Problem(table, components, kind, given["free"], lam, closure, law)
        check_unknowns(box, problem.period + bool(problem.free))
        return cls(*box, problem)


@dataclass(frozen=True, repr=False)
class Bifurcation(UniqueCycle):
    """The box holds exactly one cycle with multiplier 1 or -1, and its bifurcation is generic.

    The coordinates are the bounces and the free parameter.
    """

    @cached_property
    def generic(self) -> tuple[NormalForm | None, tuple[Verdict, ...]]:
        """The normal form, at low precision if this suffices, and the verdicts on its numbers."""
        found: tuple[NormalForm | None, tuple[Verdict, ...]] = None, (None,) * 4
        for bits in (min(self.bits, 2 * slope_bits(len(self.centre))), self.bits) if self.found else ():
            try:
                with working(bits):
                    form = Linearised(self.problem, balls(bits), self.enclosure.zero).normal_form(balls(bits))
            except ZeroDivisionError:
                continue
            with working(self.bits):
                size = abs(form.determinant)
                inner = True if size < 1 else False if size > 1 else None
                found = form, (*(_nonzero(x) for x in (form.turn, form.speed, form.bend)), inner)
            if None not in found[1]:
                break
        return found

    @property
    def form(self) -> NormalForm | None:
        """The normal form."""
        return self.generic[0]

    @hypothesis
    def simple_multiplier(self) -> Verdict:
        """The critical multiplier is simple."""
        return self.generic[1][0]

    @hypothesis
    def transversal(self) -> Verdict:
        """The critical multiplier passes 1 or -1 at a speed that is not 0."""
        return self.generic[1][1]

    @hypothesis
    def nondegenerate(self) -> Verdict:
        """The coefficient of the normal form is not 0."""
        return self.generic[1][2]

    @hypothesis(refutable=True)
    def other_multiplier_stable(self) -> Verdict:
        """The other multiplier lies inside the unit circle."""
        return self.generic[1][3]


@dataclass(frozen=True, repr=False)
class AttractingCycle(UniqueCycle):
    """The box holds exactly one cycle of a problem, and it attracts."""

    @cached_property
    def invariants(self) -> tuple[arb, arb]:
        """Trace and determinant of the monodromy matrix; NaN if they are not enclosed."""
        with working(self.bits):
            try:
                chain = Linearised(self.problem, balls(self.bits), self.enclosure.zero).plain
                trace, determinant = trace_and_determinant(chain.rows)
            except ZeroDivisionError:
                return arb("nan"), arb("nan")
            return trace, determinant

    @property
    def trace(self) -> arb:
        """The trace of the monodromy matrix."""
        return self.invariants[0]

    @property
    def determinant(self) -> arb:
        """The determinant of the monodromy matrix."""
        return self.invariants[1]

    @hypothesis
    def attracting(self) -> bool:
        """Both multipliers lie inside the unit circle."""
        with working(self.bits):
            on_sides = self.one_sided
            return on_sides is OneSided.ATTRACTS if on_sides else stability(*self.invariants) is Stability.ATTRACTING


def _nonzero(x: arb) -> Verdict:
    return True if x.is_finite() and not x.contains(0) else None


def cycle_in_box(problem: Problem, centre: tuple[arb, ...], radius: arb, bits: int, digits: int) -> UniqueCycle:
    """The theorem that a box holds exactly one cycle, which includes its bifurcation if the problem has a kind."""
    return (Bifurcation if problem.kind else UniqueCycle)(centre, radius, bits, digits, problem)


def _pair(x: arb) -> list[str]:
    mantissa, exponent = x.man_exp()
    return [str(mantissa), str(exponent)]


def _ball(pair: Any) -> arb:
    if not all(isinstance(text, str) and INTEGER.fullmatch(text) for text in pair):
        raise ValueError("certificate: a number is not written as a pair of texts, each a decimal integer")
    mantissa, exponent = map(fmpz, pair)  # int() refuses more than 4300 digits
    if abs(exponent) > LARGEST_BITS * 2:
        raise ValueError(f"certificate: the exponent {exponent} is out of range; accepted: up to {LARGEST_BITS * 2}")
    return arb((mantissa, exponent))
