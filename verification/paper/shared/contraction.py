"""Claims on what the contraction of phase space implies for exponents. Paper: section 4.1."""

from functools import cache

import numpy as np
from flint import arb
from sympy import Rational, log, pi, sin

from numeric.dynamics.phase_points import phase_points
from symbolic import tables
from symbolic.expressions.signs import Finding
from symbolic.motion.collision import area_factor, image_share, log_cosine_mean, telescoped
from symbolic.tables.table import lam
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, zero
from verification.paper.shared.samples import Spectrum, sampled, spectrum

TENTHS = tuple(k / 10 for k in range(11))
NINE = [-2.2794, 0.0999, 2.9941, 2.5028, 1.9891, 1.3928, 0.7008, -0.1020, -1.0494]  # a cycle at lam = 9/10


def at_most_zero() -> Finding:
    """The upper limit of `log|det D(T^n)|/n` is at most 0 for almost every start, on every table, for `lam > 0`.

    At `lam = 0` the determinant is 0. The end term `log(cos(phi_0)/cos(phi_n))` is bounded for `lam < 1`, where
    `|phi_n| <= lam*pi/2`; at `lam = 1` it grows slower than `n` for almost every start, since its mean is finite.
    """
    return by(
        "T^n is injective into phase space of finite area ds d(sin phi), so the set where it multiplies areas by more "
        "than exp(e*n) has at most exp(-e*n) of the whole; these sum up, and by Borel and Cantelli almost every "
        "start has limsup log|det D(T^n)|/n <= 0",
        zero("the image of T fills sin(lam*pi/2) of phase space", image_share() - sin(lam * pi / 2)),
        zero("log|det D(T^n)| is the sum of log(g(eta)) up to the end term", telescoped(3) - 1),
        answer(log_cosine_mean().is_finite, "log(cos(phi)) has a finite mean"),
    )


def at_least_log() -> Finding:
    """`nu_plus + nu_minus >= log(lam)` on every orbit."""
    return by(
        "log|det D(T^n)| = n*log(lam) + sum of log(cos(lam*eta)/cos(eta)) + a term bounded below, and "
        "cos(lam*eta) >= cos(eta)",
        zero("the sum rule", telescoped(3) - 1),
    )


@cache
def expanding_cycle() -> tuple[bool, arb]:
    """A certified cycle of period 9 at `lam = 9/10`: proved or not, and its determinant."""
    proof = certificate(tables.cardioid, Rational(9, 10), phase_points(0, NINE, 0.0), 20)
    wanted = ("exists", "unique", "admissible", "minimal_period")
    return all(proof.checks[name] is True for name in wanted), proof.determinant


@judges("cardioid.contraction_implies")
def contraction_implies(claim: Claim) -> Judgement:
    """Contraction of phase space as a whole bounds almost every orbit, and not every orbit."""
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
    """`<= 0` is proved for almost every start; the strict sign is sampled."""
    found = spectrum("cardioid", TENTHS)
    total, error = np.mean(found.total, axis=1)[1:-1], Spectrum.error(found.total)[1:-1]
    ratio = float(np.max(total / error))
    said = (
        f"<= 0 is proved for almost every start; sampled, the sum is negative by {-ratio:.0f} standard errors or more "
        f"at lam = 0.1, ..., 0.9 (nearest to 0 at 0.9: {total[-1]:.4f} +- {error[-1]:.0e})"
    )
    return sampled("nu_+ + nu_- < 0 for almost every start and lam < 1", said, bool(at_most_zero()) and ratio < -10)


@judges("cardioid.lyapunov_sum_one")
def sum_one(claim: Claim) -> Judgement:
    """Squeezed between `log(lam)` and 0."""
    limit = zero("log(1) = 0", log(lam).subs(lam, 1))
    return Judgement(
        by("log(lam) <= nu_+ + nu_- <= 0 for almost every start", at_least_log(), at_most_zero(), limit),
        "log(lam) <= nu_+ + nu_- <= 0",
    )


@judges("cardioid.lyapunov_sum_zero")
def sum_zero(claim: Claim) -> Judgement:
    """`nu_+ + nu_- - log(lam)` is the mean of `log(cos(lam*eta)/cos(eta))`, which stays finite."""
    small = (1e-2, 1e-4, 1e-6)
    found = spectrum("cardioid", small)
    rest = np.mean(found.total, axis=1) - np.log(small)
    error = Spectrum.error(found.total)
    said = ", ".join(f"{r:.4f} +- {e:.0e} at {x:g}" for r, e, x in zip(rest, error, small, strict=True))
    good = bool(np.all(np.abs(rest - rest[-1]) < 6 * np.hypot(error, error[-1]) + 0.002))
    return sampled(
        "nu_+ + nu_- = log(lam) + <-log cos(eta)> + o(1), the mean over the slap map's own measure",
        f"by the exact sum rule nu_+ + nu_- - log(lam) = <log(cos(lam*eta)/cos(eta))>; sampled: {said}",
        good,
    )
