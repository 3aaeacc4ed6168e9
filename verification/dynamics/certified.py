"""A proof that a cycle found in float64 exists, is admissible, of least period, and attracts: balls decide.

`lam` is the exact number given. A proof says nothing about other attractors, nor about the size of a basin.
"""

from dataclasses import dataclass

from flint import arb
from sympy import Expr

from symbolic.table import Table
from verification.arithmetic import balls, working
from verification.certificates.bifurcation import Checks
from verification.certificates.everywhere import Stability, stability, trace_and_determinant
from verification.dynamics.places import Places
from verification.locate import certify
from verification.shooting.problem import Linearised, Problem, Rows

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
    >>> from verification.dynamics.places import places
    >>> axis = certificate(ellipse.at(a=2), Rational(1, 2), places(0, [1.5, -1.6], 0.0))
    >>> axis.proved, axis.trace.str(10, radius=False), axis.determinant.str(10, radius=False)
    (True, '-0.4375000000', '0.2500000000')
    """
    problem = Problem(table, tuple(int(i) for i in near.component), lam=lam)
    proof = certify(problem, [float(x) for x in near.theta], digits)
    bits = proof.claim.bits
    with working(bits):
        try:
            trace, determinant = trace_and_determinant(
                Linearised(Rows(problem, balls(bits)), proof.enclosure.zero).plain
            )
        except ZeroDivisionError:
            trace = determinant = arb("nan")
        attracts = stability(trace, determinant) is Stability.ATTRACTING
    checks = {**proof.checks, "attracting": True if attracts else None}
    return Certificate(checks, tuple(proof.enclosure.zero), trace, determinant)
