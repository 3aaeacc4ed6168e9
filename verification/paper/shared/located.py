"""Claims on where something happens, settled by certified values. Paper: sections 5.1, 5.2, 6.3, 6.6."""

from collections.abc import Callable
from functools import cache

from flint import arb
from sympy import Expr, Integer, Rational

from symbolic.expressions.signs import Finding, conjunction
from verification.named.locate import Located, locate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, digits, judges
from verification.proofs.periodic.bifurcation import Proof

SHAPE = Rational(2, 25)


@cache
def located(name: str, wanted: int = 20, **given: Expr) -> Located:
    """A certified value; each is computed once a run."""
    return locate(name, wanted, **given)


def value(name: str, **given: Expr) -> Callable[[int], arb]:
    """The value as balls of as many digits as asked for."""
    return lambda wanted: located(name, max(wanted, 20), **given).ball


def certified(name: str, **given: Expr) -> Finding:
    """The whole checklist of a certificate."""
    found = located(name, **given)
    missing = [check for check, holds in found.checks.items() if holds is not True]
    reason = f"{name}: not proved: {', '.join(missing)}" if missing else f"{name} certified: {', '.join(found.checks)}"
    return answer(found.certified, reason)


def supercritical(name: str, **given: Expr) -> bool | None:
    """Does a flip bear a stable cycle? The sign of its normal form in balls; None when they do not decide it."""
    found = located(name, **given)
    return found.proof.supercritical if found.certified and isinstance(found.proof, Proof) else None


def subcritical(name: str, **given: Expr) -> Finding:
    """Is the cycle that a flip bears unstable? So is the old one at the flip itself."""
    return answer(supercritical(name, **given) is False, f"{name}: the normal form bears an unstable cycle")


def settled(claim: Claim, name: str, mend: tuple[str, str] | None = None, **given: Expr) -> Judgement:
    """Printed digits beside a certified value."""
    judgement = digits(claim, value(name, **given), mend)
    proof = certified(name, **given)
    weakest = conjunction(proof, judgement.printed)
    return Judgement(
        weakest if not proof else judgement.printed,
        judgement.derived,
        judgement.mended and conjunction(proof, judgement.mended),
        judgement.erratum,
        judgement.value,
    )


@judges("cuspless.lambda_star")
def lambda_star(claim: Claim) -> Judgement:
    """The orbit through both corners, by interval Newton on the chord system."""
    return settled(claim, "lambda-star", ("0.0712173", "0.0712172"))


@judges("cuspless.phi_star")
def phi_star(claim: Claim) -> Judgement:
    """Its exit angle at the upper corner."""
    return settled(claim, "phi-star", ("-0.0289796", "-0.0289795"))


@judges("cuspless.lambda_star_caption", "cuspless.lambda_star_body")
def lambda_star_rounded(claim: Claim) -> Judgement:
    """The same, to fewer digits."""
    return settled(claim, "lambda-star")


@judges("cuspless.corner_orbit")
def corner_orbit(claim: Claim) -> Judgement:
    """Existence, uniqueness in a box, first hits and minimal period."""
    return Judgement(
        by("exactly one such orbit in a box around the printed values", certified("lambda-star")),
        "the orbit through both joins at lambda*",
        value=value("lambda-star"),
    )


@judges("cuspless.unstable_period4", "cuspless.no_stable_period4")
def unstable_period4(claim: Claim) -> Judgement:
    """The sign of the flip's normal-form coefficient."""
    return Judgement(
        by("the flip at lambda_c is subcritical", certified("lambda-c"), subcritical("lambda-c")),
        "an unstable cycle of twice the period is born, on the side where the period-2 orbit is stable",
    )


@judges("egg.doubling.3")
def doubling_3(claim: Claim) -> Judgement:
    """Period 4 to 8."""
    return settled(claim, "doubling", ("0.372", "0.371"), alpha=SHAPE, n=Integer(3))


@judges("egg.doubling.4")
def doubling_4(claim: Claim) -> Judgement:
    """Period 8 to 16."""
    return settled(claim, "doubling", alpha=SHAPE, n=Integer(4))


@judges("egg.doubling.5")
def doubling_5(claim: Claim) -> Judgement:
    """Period 16 to 32."""
    return settled(claim, "doubling", alpha=SHAPE, n=Integer(5))


@judges("egg.doubling.6")
def doubling_6(claim: Claim) -> Judgement:
    """Period 32 to 64."""
    return settled(claim, "doubling", ("0.3935", "0.3933"), alpha=SHAPE, n=Integer(6))
