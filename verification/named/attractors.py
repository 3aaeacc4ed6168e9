"""A proof that a cycle found in float64 exists, is admissible, of least period, and attracts: balls decide.

`lam` is the exact number given. A proof says nothing about other attractors, nor about the size of a basin.

Lyapunov exponents, proved: of a cycle, from its certified multipliers; of the cardioid's chaotic slap map.
"""

from dataclasses import dataclass
from typing import Any

from flint import arb
from sympy import Expr

from numeric.dynamics.phase_points import Places
from symbolic.tables import cardioid
from symbolic.tables.table import Table
from verification.arithmetic.balls import decimal
from verification.arithmetic.words import balls, bits_of, working
from verification.cycles.recurrence.chain import trace_and_determinant
from verification.cycles.shooting.problem import Linearised, Problem, Rows
from verification.named.locate import certify
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.periodic.over_interval import Stability, stability

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


def certificate(table: Table, lam: Expr, near: Places, digits: int = DIGITS) -> Certificate:
    """What balls prove about the cycle whose bounces lie near the given ones.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import places
    >>> axis = certificate(ellipse.at(a=2), Rational(1, 2), places(0, [1.5, -1.6], 0.0))
    >>> axis.proved, axis.trace.str(10, radius=False), axis.determinant.str(10, radius=False)
    (True, '-0.4375000000', '0.2500000000')
    """
    problem = Problem(table, tuple(int(i) for i in near.component), lam=lam)
    proof = certify(problem, [float(x) for x in near.theta], digits)
    bits = proof.claim.bits
    with working(bits):
        try:
            chain = Linearised(Rows(problem, balls(bits)), proof.enclosure.zero).plain
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


def certified_exponents(table: Table, lam: Expr, near: Places, digits: int = DIGITS) -> dict[str, Any] | None:
    """The exponents of the cycle near some points as decimals with a radius, and the checklist; None if not proved.

    At `lam = 0` the lower one is minus infinity, and null.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from numeric.dynamics.phase_points import places
    >>> axis = certified_exponents(ellipse.at(a=2), Rational(1, 2), places(0, [1.5, -1.6], 0.0), 15)
    >>> axis["nu_plus"][:16], axis["nu_minus"][:16]  # log(1/2)/2, a complex pair
    ('-0.3465735902799', '-0.3465735902799')
    """
    proof = certificate(table, lam, near, digits)
    if not all(proof.checks[name] for name in ("exists", "unique", "admissible", "minimal_period")):
        return None
    with working(bits_of(digits, 64)):
        if lam == 0:
            plus, minus = abs(proof.trace).log() / near.size, None
        else:
            plus, minus = exponents(proof.trace, proof.determinant, near.size)
        if not plus.is_finite():
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
    from verification.proofs.slap_map.chaotic_exponent import slap_exponent

    proof = slap_exponent()
    if not proof.certified:
        return None
    value, radius = decimal(proof.value, DIGITS)
    return {"nu_plus": value, "nu_minus": None, "radius": radius, "checks": dict(proof.checks)}
