"""Attractors: a proof that one exists, its proved exponents, and which of them coexist at each contraction.

Of a cycle found in float64 balls prove that it exists, is admissible, of least period, and attracts; its exponents
come from its certified multipliers. Such a proof says nothing about other attractors, nor about the size of a basin.
Of chaotic attractors the exponent of the cardioid's slap map is proved.

Which attractors coexist is found by two methods that check each other: random starts on a grid of contractions, and
each cycle they find followed to both ends of its life, where its event is proved, and past them to the cycles born
there. What is listed is proved to exist; that nothing else attracts is not, and cannot be by sampling: a basin below
about `3/starts` of the table is likely to be missed at any one contraction.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb
from sympy import Expr

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, Share, classify, find, moved, name, wilson
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.recognition import polished, shortest
from symbolic.tables import cardioid
from symbolic.tables.geometry import Symmetry, group
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import balls, bits_of, decimal, working
from verification.cycles.chain import trace_and_determinant
from verification.cycles.problem import Linearised, Problem
from verification.named.branches import Branch, Event, alike, ends, own
from verification.named.locate import certify
from verification.proofs.periodic.bifurcation import Checks, Stability, stability

DIGITS = 30


@dataclass(frozen=True)
class Certificate:
    """The checklist of a cycle, with `attracting` as its last item, and balls for what was proved."""

    checks: Checks
    theta: tuple[arb, ...]
    trace: arb
    determinant: arb

    @property
    def proved(self) -> bool:
        """True when every item of the checklist is."""
        return all(value is True for value in self.checks.values())


def certificate(table: Table, lam: Expr, near: PhasePoints, digits: int = DIGITS, law: Law = PAPERS_LAW) -> Certificate:
    """What balls prove about the cycle whose bounces lie near the given ones.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import phase_points
    >>> axis = certificate(ellipse.at(a=2), Rational(1, 2), phase_points([1.5, -1.6], 0.0))
    >>> axis.proved, axis.trace.str(10, radius=False), axis.determinant.str(10, radius=False)
    (True, '-0.4375000000', '0.2500000000')
    """
    problem = Problem(table, tuple(int(i) for i in near.component), lam=lam, law=law)
    proof = certify(problem, [float(x) for x in near.theta], digits, in_balls=True)
    bits = proof.claim.bits
    with working(bits):
        try:
            chain = Linearised(problem, balls(bits), proof.enclosure.zero).plain
            trace, determinant = trace_and_determinant(chain.rows)
        except ZeroDivisionError:
            trace = determinant = arb("nan")
        attracts = stability(trace, determinant) is Stability.ATTRACTING
    checks = {**proof.checks, "attracting": True if attracts else None}
    return Certificate(checks, tuple(proof.enclosure.zero), trace, determinant)


def exponents(trace: arb, determinant: arb, period: int) -> tuple[arb, arb]:
    """Both exponents per bounce from trace and determinant of the monodromy matrix, in the ambient precision.

    Complex multipliers have the modulus `sqrt(det)`; where it is not decided whether they are, the ball holds both
    answers.

    >>> plus, minus = exponents(arb(5) / 2, arb(1), 2)  # multipliers 2 and 1/2
    >>> abs(plus - arb(2).log() / 2) < 1e-14, abs(plus + minus) < 1e-14
    (True, True)
    """
    size, mean = abs(determinant), abs(determinant).log() / (2 * period)
    gap = trace * trace - 4 * determinant
    if gap < 0:
        return mean, mean
    root = gap.sqrt() if gap > 0 else arb(0).union(gap.abs_upper().sqrt())
    plus = ((abs(trace) + root) / 2).log() / period
    return plus, size.log() / period - plus


def certified_exponents(
    table: Table, lam: Expr, near: PhasePoints, digits: int = DIGITS, law: Law = PAPERS_LAW
) -> dict[str, Any] | None:
    """The exponents of the cycle near some points as decimals with a radius, and the checklist; None if not proved.

    At `lam = 0` the lower one is minus infinity, and null.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import phase_points
    >>> axis = certified_exponents(ellipse.at(a=2), Rational(1, 2), phase_points([1.5, -1.6], 0.0), 15)
    >>> axis["nu_plus"][:16], axis["nu_minus"][:16]  # log(1/2)/2, a complex pair
    ('-0.3465735902799', '-0.3465735902799')
    """
    proof = certificate(table, lam, near, digits, law)
    if not all(proof.checks[name] for name in ("exists", "unique", "admissible", "minimal_period")):
        return None
    with working(bits_of(digits, 64)):
        if lam == 0 and law.uniform:
            plus, minus = abs(proof.trace).log() / near.size, None
        else:
            plus, minus = exponents(proof.trace, proof.determinant, near.size)
        if not plus.is_finite() or (minus is not None and not minus.is_finite()):
            return None
        upper, radius = decimal(plus, digits)
        lower = decimal(minus, digits) if minus is not None else (None, radius)
    return {"nu_plus": upper, "nu_minus": lower[0], "radius": radius, "checks": dict(proof.checks)}


def chaotic_exponents(table: Table, lam: Expr) -> dict[str, Any] | None:
    """The exponents of almost every start, where chaos is proved to have them: the cardioid at `lam = 0`; else None.

    The lower one is minus infinity, and null.

    >>> from sympy import S
    >>> chaotic_exponents(cardioid, S(1) / 2) is None  # no proof is known there
    True
    """
    if table != cardioid or lam != 0:
        return None
    from verification.proofs.slap_map.exponent import slap_exponent

    proof = slap_exponent()
    if not proof.certified:
        return None
    value, radius = decimal(proof.value, DIGITS)
    return {"nu_plus": value, "nu_minus": None, "radius": radius, "checks": dict(proof.checks)}


FOLLOWED = 64  # the longest period whose branch is followed
BEYOND = 0.1  # of a branch's length past its end: where its successor is looked for


@dataclass(frozen=True, eq=False)
class Member:
    """The attractors of one family at one contraction: `copies` images of each other, and their joint share."""

    kind: Kind
    period: int
    symmetry: str
    copies: int
    share: Share
    nu_plus: float
    first: Attractor


@dataclass(frozen=True, eq=False)
class Row:
    """What the starts reached at one contraction; `unsettled` of them reached nothing in the time given."""

    lam: float
    members: tuple[Member, ...]
    unsettled: int

    @property
    def attractors(self) -> int:
        """How many coexist, as far as the starts saw."""
        return sum(member.copies for member in self.members)


def row(map: PinballMap, starts: int, seed: int) -> Row:
    """The row at the map's contraction.

    >>> found = row(PinballMap("egg", alpha="0.08", lam=0.2), 100, 1)
    >>> [(m.kind.name, m.period, m.symmetry, m.copies) for m in found.members], found.attractors
    ([('CYCLE', 4, 'D1', 3)], 3)
    """
    return joined(find(map, starts, seed, images=True), starts, float(map.lam.flat[0]))


def joined(found: Sequence[Attractor], starts: int, lam: float) -> Row:
    """The row of attractors that were found with their images: each family a member."""
    members = []
    for family in sorted({a.family for a in found}):
        images = [a for a in found if a.family == family]
        count = sum(a.share.count for a in images if a.share)
        first = images[0]
        share = wilson(count, starts)
        members.append(Member(first.kind, first.period, first.symmetry, len(images), share, first.nu_plus, first))
    return Row(lam, tuple(members), starts - sum(m.share.count for m in members))


def branches(map: PinballMap, table: Table, rows: Sequence[Row], longest: int = FOLLOWED) -> Iterator[Branch]:
    """Every branch of cycles up to a period that the rows or the ends of other branches lead to, each once.

    >>> from symbolic.tables import cuspless
    >>> map = PinballMap("cuspless", lam=0.05)
    >>> [(b.period, b.low.event.name, b.high.value) for b in branches(map, cuspless, [row(map, 50, 1)])]
    [(2, 'EDGE', '0.09340033543136')]
    """
    symmetries = group(table)
    known: list[Branch] = []
    for here in rows:
        for member in here.members:
            cycle = member.kind is Kind.CYCLE and member.period <= longest
            queue = [(here.lam, member.first.points)] if cycle else []
            while queue:
                new = _followed(map, table, symmetries, known, *queue.pop())
                if new is not None:
                    known.append(new)
                    queue += _successors(map, new, longest)
                    yield new


def _followed(
    map: PinballMap,
    table: Table,
    symmetries: Sequence[Symmetry],
    known: Sequence[Branch],
    lam: float,
    near: PhasePoints,
) -> Branch | None:
    """The branch through a cycle, unless it is known."""
    there = map.at(lam)
    cycle = shortest(there, near)
    kept = own(there, cycle.points, symmetries)
    if any(_on(there, branch, cycle.points, symmetries) for branch in known):
        return None
    low, high = ends(there, table, symmetries, cycle, lam)
    return Branch(cycle.period, name(kept), len(symmetries) // len(kept), low, high)


def _on(map: PinballMap, branch: Branch, points: PhasePoints, symmetries: Sequence[Symmetry]) -> bool:
    """Is the branch's cycle at this contraction the given one, or an image of it?"""
    lam = float(map.lam.flat[0])
    if branch.period != points.size or not branch.low.lam <= lam <= branch.high.lam:
        return False
    here = polished(map, branch.nearest(lam))
    return here is not None and any(alike(map, here.points, moved(s, points)) < 1e-6 for s in symmetries)


def _successors(map: PinballMap, branch: Branch, longest: int) -> list[tuple[float, PhasePoints]]:
    """Cycles of at most twice the period that attract just past an end at which the branch hands over."""
    found = []
    for end, way in ((branch.low, -1), (branch.high, 1)):
        lam = end.lam + way * BEYOND * (branch.high.lam - branch.low.lam)
        if end.event not in (Event.FLIP, Event.PITCHFORK, Event.HALVED) or not 0 <= lam < 1:
            continue
        first = end.cycle.points.only(slice(0, 1))
        there = map.at(lam)
        for nudge in (1e-5, -1e-5):
            label, attractors = classify(there, first.theta + nudge, first.phi, first.component, transient=20_000)
            near = [attractors[i] for i in label[label >= 0]]
            found += [(lam, a.points) for a in near if a.kind is Kind.CYCLE and a.period <= longest]
    return found


def coexisting(branches: Sequence[Branch], lam: float) -> list[Branch]:
    """The branches that attract at a contraction."""
    return [branch for branch in branches if branch.low.lam < lam < branch.high.lam]
