"""Attractors: a proof that a cycle attracts, its proved exponents, and which attractors coexist at a contraction.

For a cycle found in float64, it is proved in balls that it exists, is admissible, has this least period, and attracts;
its exponents come from its certified multipliers. Such a proof says nothing about other attractors, nor about the size
of a basin. The only chaotic exponent that is proved is that of the cardioid's slap map.

Which attractors coexist at a contraction is found by random starts: a basin below about `3/starts` of the table is
likely to be missed. Families of cycles over a range of contractions are those of `verification.named.families`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb
from sympy import Expr

from numeric.dynamics.attractors import Attractor, Kind, Share, wilson
from numeric.dynamics.phase_points import PhasePoints
from symbolic.tables import cardioid
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import bits_of, decimal, working
from verification.cycles.problem import Problem
from verification.named.locate import proof_near
from verification.proofs.periodic.cycle_in_box import AttractingCycle

DIGITS = 30


def certificate(
    table: Table, lam: Expr, near: PhasePoints, digits: int = DIGITS, law: Law = PAPERS_LAW
) -> AttractingCycle:
    """The theorem that the cycle whose bounces lie near the given ones exists and attracts.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import phase_points
    >>> axis = certificate(ellipse.at(a=2), Rational(1, 2), phase_points([1.5, -1.6], 0.0))
    >>> axis.proved, axis.trace.str(10, radius=False), axis.determinant.str(10, radius=False)
    (True, '-0.4375000000', '0.2500000000')
    """
    problem = Problem(table, tuple(int(i) for i in near.component), lam=lam, law=law)
    cycle = proof_near(problem, [float(x) for x in near.theta], digits, in_balls=True)
    return AttractingCycle(cycle.centre, cycle.radius, cycle.bits, cycle.digits, problem)


def exponents(trace: arb, determinant: arb, period: int) -> tuple[arb, arb]:
    """Both exponents per bounce from trace and determinant of the monodromy matrix, in balls of the current precision.

    Complex multipliers have the modulus `sqrt(det)`. If it is undecided whether they are complex, the balls hold the
    exponents of both cases.

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
    """The exponents of the cycle near some points as decimals with radius, and the checklist; None if not proved.

    At `lam = 0` the lower exponent is minus infinity, given as None.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import phase_points
    >>> axis = certified_exponents(ellipse.at(a=2), Rational(1, 2), phase_points([1.5, -1.6], 0.0), 15)
    >>> axis["nu_plus"][:16], axis["nu_minus"][:16]  # log(1/2)/2, a complex pair
    ('-0.3465735902799', '-0.3465735902799')
    """
    proof = certificate(table, lam, near, digits, law)
    if not proof.is_cycle:
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
    """The exponents of almost every start if chaos is proved (only on the cardioid at `lam = 0`), otherwise None.

    The lower exponent is minus infinity, given as None.

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


@dataclass(frozen=True, eq=False)
class Member:
    """The attractors of one symmetry class at one contraction: `copies` images of each other, and their total share."""

    kind: Kind
    period: int
    symmetry: str
    copies: int
    share: Share
    nu_plus: float
    first: Attractor


@dataclass(frozen=True, eq=False)
class AttractorCounts:
    """The attractors that starts reached at one contraction; `unsettled` starts had reached none when the run ended."""

    lam: float
    members: tuple[Member, ...]
    unsettled: int

    @property
    def attractors(self) -> int:
        """The number of different attractors that the starts reached."""
        return sum(member.copies for member in self.members)


def joined(found: Sequence[Attractor], starts: int, lam: float) -> AttractorCounts:
    """The attractors found at one contraction; those that are symmetric images of each other make one member.

    >>> from numeric import PinballMap
    >>> from numeric.dynamics.attractors import find
    >>> found = joined(find(PinballMap("egg", alpha="0.08", lam=0.2), 100, 1, images=True), 100, 0.2)
    >>> [(m.kind.name, m.period, m.symmetry, m.copies) for m in found.members], found.attractors
    ([('CYCLE', 4, 'D1', 3)], 3)
    """
    members = []
    for family in sorted({a.family for a in found}):
        images = [a for a in found if a.family == family]
        count = sum(a.share.count for a in images if a.share)
        first = images[0]
        share = wilson(count, starts)
        members.append(Member(first.kind, first.period, first.symmetry, len(images), share, first.nu_plus, first))
    return AttractorCounts(lam, tuple(members), starts - sum(m.share.count for m in members))
