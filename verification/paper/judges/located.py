"""Judges of claims on certified parameter values and phase-space contraction. Sections 4.1, 5.1, 5.2, 6.3 and 6.6."""

from collections.abc import Callable
from functools import cache

import numpy as np
from flint import arb
from sympy import Expr, Integer, Rational, log, pi, sin

from numeric.dynamics.phase_points import phase_points
from symbolic import tables
from symbolic.cycles.almost_every import largest_sum, two_rates
from symbolic.expressions.signs import SignFinding, conjunction
from symbolic.motion.collision import area_factor, image_share, log_cosine_mean, telescoped
from symbolic.tables.table import lam
from verification.named.attractors import certificate
from verification.named.locate import Located, locate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, digits, judges, sampled, zero
from verification.paper.judges.exponents import Spectrum, spectrum
from verification.proofs.periodic.cycle_in_box import UniqueCycle

SHAPE = Rational(2, 25)


@cache
def located(name: str, wanted: int = 20, **given: Expr) -> Located:
    """The certified value of the bifurcation `name`, computed once per run."""
    return locate(name, wanted, **given)


def value(name: str, **given: Expr) -> Callable[[int], arb]:
    """A function that maps a number of digits to a ball around the certified value."""
    return lambda wanted: located(name, max(wanted, 20), **given).ball


def certified(name: str, **given: Expr) -> SignFinding:
    """The finding that all items of a certificate's checklist are proved."""
    found = located(name, **given)
    missing = [check for check, holds in found.checks.items() if holds is not True]
    reason = f"{name}: not proved: {', '.join(missing)}" if missing else f"{name} certified: {', '.join(found.checks)}"
    return answer(found.certified, reason)


def supercritical(name: str, **given: Expr) -> bool | None:
    """True if the cycle born at a flip is proved stable, False if proved unstable, None if neither."""
    found = located(name, **given)
    return found.proof.supercritical if found.certified and isinstance(found.proof, UniqueCycle) else None


def subcritical(name: str, **given: Expr) -> SignFinding:
    """The finding that the cycle born at a flip is unstable, and so is the old cycle at the flip."""
    return answer(supercritical(name, **given) is False, f"{name}: the normal form bears an unstable cycle")


def settled(claim: Claim, name: str, mend: tuple[str, str] | None = None, **given: Expr) -> Judgement:
    """The judgement on printed digits, by comparison with a certified value."""
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
    """Judges the digits of `lambda*`, by interval Newton on the orbit through both corners."""
    return settled(claim, "lambda-star", ("0.0712173", "0.0712172"))


@judges("cuspless.phi_star")
def phi_star(claim: Claim) -> Judgement:
    """Judges the digits of `phi*`, the exit angle at the upper corner of the orbit through both corners."""
    return settled(claim, "phi-star", ("-0.0289796", "-0.0289795"))


@judges("cuspless.corner_orbit")
def corner_orbit(claim: Claim) -> Judgement:
    """The orbit through both corners is proved to exist, to be unique in a box, and to have minimal period 4."""
    return Judgement(
        by("exactly one such orbit in a box around the printed values", certified("lambda-star")),
        "the orbit through both joins at lambda*",
        value=value("lambda-star"),
    )


@judges("cuspless.unstable_period4", "cuspless.no_stable_period4")
def unstable_period4(claim: Claim) -> Judgement:
    """The period-4 orbits are unstable, by the sign of the normal-form coefficient at the flip."""
    return Judgement(
        by("the flip at lambda_c is subcritical", certified("lambda-c"), subcritical("lambda-c")),
        "an unstable cycle of twice the period is born, on the side where the period-2 orbit is stable",
    )


MISPRINTS = {3: ("0.372", "0.371"), 6: ("0.3935", "0.3933")}  # by `n`: the printed digits and the right ones


@judges("egg.doubling.3", "egg.doubling.4", "egg.doubling.5", "egg.doubling.6")
def doubling(claim: Claim) -> Judgement:
    """Judges the printed contraction at which the cycle of period `2**(n-1)` doubles its period."""
    n = int(claim.id.rpartition(".")[2])
    return settled(claim, "doubling", MISPRINTS.get(n), alpha=SHAPE, n=Integer(n))


TENTHS = tuple(k / 10 for k in range(11))
NINE = [-2.2794, 0.0999, 2.9941, 2.5028, 1.9891, 1.3928, 0.7008, -0.1020, -1.0494]  # a cycle at lam = 9/10


def at_most_zero() -> SignFinding:
    """The finding that `limsup log|det D(T^n)|/n <= 0` for almost every start, on every table, for `lam > 0`.

    At `lam = 0` the determinant is 0. The end term `log(cos(phi_0)/cos(phi_n))` is bounded for `lam < 1`, where
    `|phi_n| <= lam*pi/2`; at `lam = 1` it grows more slowly than `n` for almost every start, since its mean is finite.
    """
    return by(
        "T^n is injective into phase space of finite area ds d(sin phi), so the set where it multiplies areas by more "
        "than exp(e*n) has at most exp(-e*n) of the whole; these sum up, and by Borel and Cantelli almost every "
        "start has limsup log|det D(T^n)|/n <= 0",
        zero("the image of T fills sin(lam*pi/2) of phase space", image_share() - sin(lam * pi / 2)),
        zero("log|det D(T^n)| is the sum of log(g(eta)) up to the end term", telescoped(3) - 1),
        answer(log_cosine_mean().is_finite, "log(cos(phi)) has a finite mean"),
    )


def at_least_log() -> SignFinding:
    """The finding that `nu_plus + nu_minus >= log(lam)` on every orbit."""
    return by(
        "log|det D(T^n)| = n*log(lam) + sum of log(cos(lam*eta)/cos(eta)) + a term bounded below, and "
        "cos(lam*eta) >= cos(eta)",
        zero("the sum rule", telescoped(3) - 1),
    )


@cache
def expanding_cycle() -> tuple[bool, arb]:
    """A cycle of period 9 at `lam = 9/10`: True if it is proved, and its determinant."""
    proof = certificate(tables.cardioid, Rational(9, 10), phase_points(NINE, 0.0), 20)
    return proof.is_cycle, proof.determinant


@judges("cardioid.contraction_implies")
def contraction_implies(claim: Claim) -> Judgement:
    """If phase space contracts as a whole, this bounds the exponents of almost every orbit, but not of each orbit."""
    proved, determinant = expanding_cycle()
    rate = determinant.log() / 9
    return Judgement(
        counterexample(
            "at lam = 9/10 a certified cycle of period 9 expands areas: |det D(T^9)| = "
            f"{determinant.str(8, radius=False)}, nu_+ + nu_- = +{rate.str(6, radius=False)}",
            answer(proved and determinant > 1, "proved in balls: it exists, is admissible and of least period"),
            at={lam: Rational(9, 10)},
        ),
        "log(lam) <= nu_+ + nu_- on every orbit, and nu_+ + nu_- <= 0 for almost every start; a bounce contracts "
        f"ds d(sin phi) by {area_factor()}, which exceeds 1 at grazing landings however small lam > 0 is",
        by("both bounds", at_most_zero(), at_least_log()),
        "Contraction of phase space does not act at every point, nor on every orbit: it implies nu_+ + nu_- <= 0 for "
        "almost every initial condition; on single periodic orbits the sum can be positive.",
    )


@judges("cardioid.lyapunov_sum_negative")
def sum_negative(claim: Claim) -> Judgement:
    """It is proved that the sum of exponents is at most 0 for almost every start; that it is negative is sampled."""
    found = spectrum("cardioid", TENTHS)
    total, error = np.mean(found.total, axis=1)[1:-1], Spectrum.error(found.total)[1:-1]
    ratio = float(np.max(total / error))
    said = (
        f"proved for almost every start: <= 0, and <= {largest_sum()}, negative for lam < 1/2; sampled, the sum is "
        f"negative by {-ratio:.0f} standard errors or more at lam = 0.1, ..., 0.9 (nearest to 0 at 0.9: "
        f"{total[-1]:.4f} +- {error[-1]:.0e})"
    )
    good = bool(at_most_zero()) and bool(two_rates()) and ratio < -10
    return sampled(
        "for almost every start nu_+ + nu_- <= 0 for lam < 1, and < 0 for lam < 1/2: proved; that it is negative from "
        "there on is sampled",
        said,
        good,
    )


@judges("cardioid.lyapunov_sum_one")
def sum_one(claim: Claim) -> Judgement:
    """The sum of exponents tends to 0 as `lam` tends to 1, since it is between `log(lam)` and 0."""
    limit = zero("log(1) = 0", log(lam).subs(lam, 1))
    return Judgement(
        by("log(lam) <= nu_+ + nu_- <= 0 for almost every start", at_least_log(), at_most_zero(), limit),
        "log(lam) <= nu_+ + nu_- <= 0",
    )


@judges("cardioid.lyapunov_sum_zero")
def sum_zero(claim: Claim) -> Judgement:
    """At `lam = 0` the sum of exponents is minus infinity, since it is bounded above by `log(2*lam)`."""
    return Judgement(
        by(
            "log(lam) <= nu_+ + nu_- on every orbit; a bounce multiplies areas in |K|*ds and dphi by at most "
            "lam*r*(c0/c1)^(2/3), where r is the growth of a curve along the cone and c = cos(theta/2), and the mean "
            "over a horizontal line of the product of n of the r is at most 2^n: so log|det D(T^n)|/n has an upper "
            "limit of at most log(2*lam) for almost every start",
            two_rates(),
            at_least_log(),
        ),
        f"log(lam) <= nu_+ + nu_- <= {largest_sum()} for almost every start",
    )
