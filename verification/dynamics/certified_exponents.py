"""Lyapunov exponents, proved: of a cycle, from its certified multipliers; of the cardioid's chaotic slap map."""

from typing import Any

from flint import arb
from sympy import Expr

from symbolic.table import Table
from symbolic.tables import cardioid
from verification.arithmetic import bits_of, working
from verification.balls import decimal
from verification.dynamics.certified import DIGITS, certificate
from verification.dynamics.places import Places


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
    >>> from verification.dynamics.places import places
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
    from verification.certificates.chaotic_exponent import slap_exponent

    proof = slap_exponent()
    if not proof.certified:
        return None
    value, radius = decimal(proof.value, DIGITS)
    return {"nu_plus": value, "nu_minus": None, "radius": radius, "checks": dict(proof.checks)}
