"""Claims that a cycle is attracting or unstable over a range of contractions. Paper: sections 6.2 to 6.5."""

from functools import cache

import mpmath
from flint import arb
from sympy import Rational, S

from numeric.dynamics.phase_points import phase_points
from symbolic.cycles.cycle import egg_diameter, trace_and_determinant
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import Finding
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam
from verification.arithmetic.progress import telling
from verification.cycles.recurrence import cascade as ladder
from verification.cycles.recurrence.cascade import attractor, cycle_at, doubled
from verification.named.attractors import certificate
from verification.named.feigenbaum import accumulation
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, zero
from verification.paper.egg.period3 import side_of_fold
from verification.proofs.periodic.over_interval import Stability, doubling_curve, everywhere, stability
from verification.proofs.periodic.triangles import contracts, flips_nowhere

SHAPE = Rational(2, 25)
PANEL_B = Rational(39, 100)  # the contraction of panel (b) of the figure with the attractors
PERIOD_4 = 0.2, (0.05, 3.1)  # a contraction, and a start from which iteration finds the cycle


@judges("egg.period4_created")
def period4_created(claim: Claim) -> Judgement:
    """The sign of the flip's normal-form coefficient along all of alpha-tilde, in balls of `lam`."""
    sign = doubling_curve(tick=telling("alpha-tilde"))
    supercritical = answer(sign.supercritical, f"the flip is supercritical for 0 <= lam < 1, in {sign.balls} balls")
    area = zero("det D(T^2) = 1 at lam = 1", trace_and_determinant(egg_diameter(), S.One)[1] - 1)
    return Judgement(
        counterexample(
            "at lam = 1 the map preserves area, so no cycle is asymptotically stable", area, at={lam: S.One}
        ),
        "a supercritical flip: a stable period-4 orbit for 0 <= lam < 1",
        supercritical,
        "At lambda = 1 the period-4 orbit that is born is elliptic, not attracting; stable needs lambda < 1.",
    )


@cache
def attracting_4() -> Finding:
    """An attracting cycle of period 4 for every `0 <= lam <= 0.28` at `alpha = 0.08`."""
    table = egg(3).at(alpha=SHAPE)
    start = attractor(table, *PERIOD_4)
    at = PERIOD_4[0]
    found = [
        everywhere(table, (0,) * 4, start, (at, end), Stability.ATTRACTING, tick=telling(f"lam up to {end}"))
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
        counterexample(
            "at lam = lambda_c the cycle has the multiplier 1",
            *side_of_fold(),
            at={lam: saddle_node().subs(alpha, SHAPE)},
        ),
        "attracting for every lambda_c < lam < 1; at lambda_c a multiplier is 1, at lam = 1 the orbit is elliptic",
        by("both multipliers inside the unit circle for lambda_c < lam < 1", *jury),
        "The range is open: attracting for lambda_c < lambda < 1, not at lambda_c itself nor at lambda = 1.",
    )


@cache
def eight_at(contraction: Rational) -> list[float]:
    """The cycle of period 8 of the cascade, followed from its birth to a contraction, in float64."""
    critical = ladder.rung(SHAPE, 3)
    theta, lam = doubled(critical.problem, critical.start, 1e-4)
    while lam < contraction:
        lam = min(lam + 1e-3, float(contraction))
        theta = cycle_at(egg(3).at(alpha=SHAPE), theta, lam)
    return theta


def cycles_at(contraction: Rational) -> tuple[Finding, Finding]:
    """At `alpha = 0.08` the cascade's cycle of period 8 is a saddle, and a cycle of period 16 attracts: in balls."""
    table = egg(3).at(alpha=SHAPE)
    sixteen = attractor(table, float(contraction), (0.05, 3.1))
    eight = certificate(table, contraction, phase_points(0, eight_at(contraction), 0.0))
    there = all(value is True for name, value in eight.checks.items() if name != "attracting")
    saddle = there and stability(eight.trace, eight.determinant) is Stability.SADDLE
    proof = certificate(table, contraction, phase_points(0, sixteen, 0.0)) if len(sixteen) == 16 else None
    return (
        answer(saddle, f"the cycle of period 8 is a saddle at lam = {contraction}, trace {short(eight.trace)}"),
        answer(
            proof is not None and proof.proved,
            f"a cycle of period 16 attracts at lam = {contraction}"
            + (f", trace {short(proof.trace)}, determinant {short(proof.determinant)}" if proof else ""),
        ),
    )


def short(x: arb) -> str:
    """A ball to six digits."""
    return str(x.str(6, radius=False))


@judges("egg.figure_attractors")
def figure_attractors(claim: Claim) -> Judgement:
    """Panel (b): at 0.39 the cascade's cycle of period 8 does not attract any more, one of period 16 does."""
    eight, sixteen = cycles_at(PANEL_B)
    return Judgement(
        counterexample("panel (b): at 0.39 period 8 has doubled already", eight, at={lam: PANEL_B}),
        "period 4 at lam = 0.1, period 16 at lam = 0.39",
        by("both cycles attract", attracting_4(), sixteen),
        "Panel (b): at lambda = 0.39 the attractor has period 16, not 8; period 8 is stable for "
        "0.3712 < lambda < 0.3888.",
    )


@judges("egg.cascade")
def cascade(claim: Claim) -> Judgement:
    """Certified doublings, and their limit by two extrapolations, whose difference is the error."""
    found = accumulation(SHAPE, 8)
    limit = f"{mpmath.nstr(found.limit.value, 10)} +- {float(found.limit.error):.0e}"
    return Judgement(
        answer(None, "infinitely many doublings are not proved"),
        f"lambda_oo = {limit}, estimated",
        evidence=f"lambda_3 to lambda_8 certified, each supercritical; ratios tend to {float(found.ratio.value):.5f} "
        f"+- {float(found.ratio.error):.0e} (Feigenbaum 4.66920), lambda_oo = {limit}"
        if found.supercritical
        else "",
    )
