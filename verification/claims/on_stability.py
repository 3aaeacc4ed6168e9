"""Claims that a cycle is attracting or unstable over a range of contractions. Paper: sections 6.2 to 6.5."""

from functools import cache

from flint import fmpq
from sympy import Integer, Rational, S

from symbolic.cycles import trace_and_determinant
from symbolic.named_cycles import egg_diameter
from symbolic.signs import Finding, Outcome
from symbolic.tables import egg
from verification.certificates.branch import contracts, flips_nowhere
from verification.certificates.curve import doubling_curve
from verification.certificates.everywhere import Stability, everywhere
from verification.claims.claim import Claim, Judgement
from verification.claims.judges import by, counterexample, judges, zero
from verification.claims.on_egg_period3 import side_of_fold
from verification.claims.on_located import located
from verification.feigenbaum import accumulation
from verification.progress import telling
from verification.shooting.follow import attractor

SHAPE = Rational(2, 25)
PERIOD_4 = 0.2, (0.05, 3.1)  # a contraction, and a start from which iteration finds the cycle


def answer(holds: bool | None, reason: str) -> Finding:
    """A three-valued proof as a finding; a proof that fails refutes nothing."""
    return Finding(Outcome.PROVED if holds else Outcome.UNKNOWN, reason)


@judges("egg.period4_created")
def period4_created(claim: Claim) -> Judgement:
    """The sign of the flip's normal-form coefficient along all of alpha-tilde, in balls of `lam`."""
    sign = doubling_curve(tick=telling("alpha-tilde"))
    supercritical = answer(sign.supercritical, f"the flip is supercritical for 0 <= lam < 1, in {sign.balls} balls")
    area = zero("det D(T^2) = 1 at lam = 1", trace_and_determinant(egg_diameter(), S.One)[1] - 1)
    return Judgement(
        counterexample("at lam = 1 the map preserves area, so no cycle is asymptotically stable", area),
        "a supercritical flip: a stable period-4 orbit for 0 <= lam < 1",
        supercritical,
        "At lambda = 1 the period-4 orbit that is born is elliptic, not attracting; stable needs lambda < 1.",
    )


@cache
def attracting_4() -> Finding:
    """An attracting cycle of period 4 for every `0 <= lam <= 0.28` at `alpha = 0.08`."""
    table = egg(3).at(alpha=SHAPE)
    start = attractor(table, *PERIOD_4)
    lam = PERIOD_4[0]
    found = [
        everywhere(table, (0,) * 4, start, (lam, end), Stability.ATTRACTING, tick=telling(f"lam up to {end}"))
        for end in (0.0, 0.28)
    ]
    return answer(all(f.proved for f in found), "proved for every lam in [0, 0.28], interval by interval")


@judges("egg.slap_period4_stable", "egg.period4_small_lambda")
def period4_small_lambda(claim: Claim) -> Judgement:
    """Interval Newton over balls of `lam`, with the multipliers."""
    return Judgement(by("an attracting cycle of period 4", attracting_4()), "attracting for 0 <= lam <= 0.28")


@judges("egg.period3_found")
def period3_found(claim: Claim) -> Judgement:
    """Jury's three conditions on one bounce: one by monotonicity, one exact, one in balls."""
    jury = [
        answer(contracts(SHAPE), "det < 1, as x*cos(x) grows up to the largest incidence angle"),
        answer(flips_nowhere(SHAPE), "1 + trace + det > 0 on the closed branch, in balls"),
        *side_of_fold(),
    ]
    return Judgement(
        counterexample("at lam = lambda_c the cycle has the multiplier 1", *side_of_fold()),
        "attracting for every lambda_c < lam < 1; at lambda_c a multiplier is 1, at lam = 1 the orbit is elliptic",
        by("both multipliers inside the unit circle for lambda_c < lam < 1", *jury),
        "The range is open: attracting for lambda_c < lambda < 1, not at lambda_c itself nor at lambda = 1.",
    )


@judges("egg.figure_attractors")
def figure_attractors(claim: Claim) -> Judgement:
    """The rung between 8 and 16 lies below 0.39."""
    fourth = located("doubling", alpha=SHAPE, n=Integer(4))
    below = bool(fourth.certified and fourth.ball < fmpq(39, 100))
    born = fourth.notes.get("kind", "")
    passed = answer(below, "lambda_4 = 0.38876... < 0.39, certified: the cycle of period 8 has doubled")
    return Judgement(
        counterexample("panel (b)", passed),
        "at lam = 0.39 the attracting cycle has period 16",
        answer(
            below and born.startswith("supercritical"), "the flip at lambda_4 is supercritical: period 16 beyond it"
        ),
        "Panel (b): at lambda = 0.39 the attractor has period 16, not 8; period 8 is stable for "
        "0.3712 < lambda < 0.3888.",
    )


@judges("egg.cascade")
def cascade(claim: Claim) -> Judgement:
    """Certified rungs, and their limit by two extrapolations."""
    found = accumulation(SHAPE, 8)
    return Judgement(
        Finding(Outcome.UNKNOWN, "infinitely many rungs are not proved"),
        "lambda_oo = 0.3935204..., estimated",
        evidence=f"lambda_3 to lambda_8 certified, all supercritical; ratios tend to {float(found.ratio.value):.5f} "
        f"+- {float(found.ratio.error):.0e} (Feigenbaum 4.66920), lambda_oo = {float(found.limit.value):.9f}",
    )
