"""Judges of claims on stability over ranges of contractions, and on chaos in the egg. Paper: sections 6.2 to 6.6.

Stability is proved. Chaos is sampled: an exponent counts as positive if it exceeds its error. A claim that a sample
contradicts stays open.
"""

from collections import Counter
from functools import cache

import mpmath
import numpy as np
from flint import arb
from sympy import Rational, S

from numeric import PinballMap
from numeric.dynamics.phase_points import PhasePoints, advanced, phase_points
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.run import in_memory
from numeric.sweeps.space import egg as shaped
from numeric.sweeps.space import followed, parameter_space
from numeric.sweeps.sweep import counted, map_of, measured
from symbolic.cycles.cycle import egg_diameter, trace_and_determinant
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import SignFinding
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam
from verification.arithmetic.iteration import telling
from verification.cycles.cascade import attractor, cycle_at, doubled, doubling
from verification.named.attractors import certificate
from verification.named.cascades import cascade
from verification.named.curves import accumulation
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled, zero
from verification.paper.egg.period3 import side_of_fold
from verification.paper.judges.attractors import strange
from verification.proofs.periodic.bifurcation import Stability, doubling_curve, over_interval, stability
from verification.proofs.periodic.triangles import contracts, flips_nowhere

SHAPE = Rational(2, 25)
PANEL_B = Rational(39, 100)  # the contraction of panel (b) of the figure with the attractors
PERIOD_4 = 0.2, (0.05, 3.1)  # a contraction, and a start whose orbit converges to the cycle


@judges("egg.period4_created")
def period4_created(claim: Claim) -> Judgement:
    """The flip along `alpha-tilde` is supercritical, by the sign of a normal-form coefficient in balls of `lam`."""
    sign = doubling_curve(tick=telling("alpha-tilde"))
    supercritical = answer(sign.proved, f"the flip is supercritical for 0 <= lam < 1, in {sign.boxes} balls")
    area = zero("det D(T^2) = 1 at lam = 1", trace_and_determinant(egg_diameter(), S.One)[1] - 1)
    return Judgement(
        counterexample(
            "at lam = 1 the map preserves area, so no cycle is asymptotically stable", area, at={lam: S.One}
        ),
        "a supercritical flip: an attracting period-4 orbit is born for 0 <= lam < 1",
        supercritical,
        "At lambda = 1 areas are kept, so that no orbit attracts its neighbours: stable in that sense needs lambda < "
        "1. Whether the orbit is stable in a weaker sense there is not part of this.",
    )


@cache
def attracting_4() -> SignFinding:
    """The finding that a cycle of period 4 attracts for every `0 <= lam <= 0.28` at `alpha = 0.08`."""
    table = egg(3).at(alpha=SHAPE)
    start = attractor(table, *PERIOD_4)
    at = PERIOD_4[0]
    found = [
        over_interval(table, (0,) * 4, start, (at, end), Stability.ATTRACTING, tick=telling(f"lam up to {end}"))
        for end in (0.0, 0.28)
    ]
    return answer(all(f.proved for f in found), "proved for every lam in [0, 0.28], interval by interval")


@judges("egg.slap_period4_stable", "egg.period4_small_lambda")
def period4_small_lambda(claim: Claim) -> Judgement:
    """A cycle of period 4 is proved to attract for small `lam`, by interval Newton over balls of `lam`."""
    return Judgement(by("an attracting cycle of period 4", attracting_4()), "attracting for 0 <= lam <= 0.28")


@judges("egg.period3_found")
def period3_found(claim: Claim) -> Judgement:
    """Jury's conditions show that the triangle is stable inside the printed range, but not at its ends."""
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
    """The bounces of the cascade's cycle of period 8, followed from its birth to a contraction, in float64."""
    critical = doubling(SHAPE, 3)
    theta, lam = doubled(critical.problem, critical.start, 1e-4)
    while lam < contraction:
        lam = min(lam + 1e-3, float(contraction))
        theta = cycle_at(egg(3).at(alpha=SHAPE), theta, lam)
    return theta


def cycles_at(contraction: Rational) -> tuple[SignFinding, SignFinding]:
    """The findings at `alpha = 0.08` that the cascade's 8-cycle is a saddle, and that a 16-cycle attracts."""
    table = egg(3).at(alpha=SHAPE)
    sixteen = attractor(table, float(contraction), (0.05, 3.1))
    eight = certificate(table, contraction, phase_points(eight_at(contraction), 0.0))
    there = all(value is True for name, value in eight.checks.items() if name != "attracting")
    saddle = there and stability(eight.trace, eight.determinant) is Stability.SADDLE
    proof = certificate(table, contraction, phase_points(sixteen, 0.0)) if len(sixteen) == 16 else None
    return (
        answer(saddle, f"the cycle of period 8 is a saddle at lam = {contraction}, trace {short(eight.trace)}"),
        answer(
            proof is not None and proof.proved,
            f"a cycle of period 16 attracts at lam = {contraction}"
            + (f", trace {short(proof.trace)}, determinant {short(proof.determinant)}" if proof else ""),
        ),
    )


def short(x: arb) -> str:
    """A ball to six digits, as text."""
    return str(x.str(6, radius=False))


@judges("egg.figure_attractors")
def figure_attractors(claim: Claim) -> Judgement:
    """In panel (b), at 0.39, the cascade's cycle of period 8 is unstable and one of period 16 attracts."""
    eight, sixteen = cycles_at(PANEL_B)
    return Judgement(
        counterexample("panel (b): at 0.39 period 8 has doubled already", eight, at={lam: PANEL_B}),
        "period 4 at lam = 0.1, period 16 at lam = 0.39",
        by("both cycles attract", attracting_4(), sixteen),
        "Panel (b): at lambda = 0.39 the attractor has period 16, not 8; period 8 is stable for "
        "0.3712 < lambda < 0.3888.",
    )


@judges("egg.cascade")
def cascade_limit(claim: Claim) -> Judgement:
    """The doublings are certified; their limit is extrapolated in two ways, whose difference estimates the error."""
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


SEED = 1
RETURN = 1e-6  # the distance at which an orbit counts as periodic
NEAR = 0.01  # the allowed distance of a printed end of an interval from a sampled one
LONGEST = 256  # the longest period that is detected
WITNESS = "1/20"  # a shape at which strange attractors are proved
BELOW = (("0.056", "0.745"), ("0.05", "0.868"))  # shapes below 0.06, and contractions where chaos was found
CUT = np.round(np.arange(0.38, 0.6801, 0.0025), 6)  # through the tongue at alpha = 0.08
CASCADES = (("0.08", "0.3716", 12, 2e-4, "0.374"), ("0.056", "0.741", 8, 3e-4, "0.745"))  # and where chaos is beyond


@judges("egg.no_chaos_below")
def no_chaos_below(claim: Claim) -> Judgement:
    """A coarse search finds no chaos, as in the paper, but misses strange attractors that are proved to exist."""
    limit = float(str(claim.printed))
    shapes, lams = np.linspace(0.2, 0.9, 4) * limit, np.linspace(0, 0.95, 20)
    chaotic = in_memory(parameter_space(shapes, lams, 20, seed=SEED), 1)["chaotic"]
    said = f"{np.sum(chaotic)} of {20 * chaotic.size} random particles are chaotic, on a coarse grid below {limit}"
    answered = ""
    if float(Rational(WITNESS)) < limit:
        (finding, _), known = strange(WITNESS), [(*pair, *chaos_at(*pair)) for pair in BELOW if float(pair[0]) < limit]
        seen = ", ".join(
            f"{share:.1%} of 600 random particles at alpha = {a}, lam = {x} with nu_+ = {nu:.4f} +- {error:.0e}"
            for a, x, share, nu, error in known
        )
        answered = (
            f". A finer search finds them: there are strange attractors at alpha = {WITNESS}, for a set of lam of "
            "positive "
            f"measure [{finding.reason if finding else 'not proved'}], and narrow strips of chaos, sampled, {seen} "
            "(benchmarks/parameter_space.py)"
        )
    return sampled(f"none on a coarse grid{answered}", said, not np.any(chaotic))


@cache
def chaos_at(shape: str, lam: str) -> tuple[float, float, float]:
    """The fraction of random starts that are chaotic, the mean of their exponents, and its standard error."""
    map = PinballMap("egg", lam=lam, alpha=shape)
    first = counted(followed(map, interior_starts(map, 600, SEED), (1000, 10_000)).growth, 4000)
    on = np.nonzero(first.chaotic)[0]
    if on.size < 2:
        return 0.0, float("nan"), float("nan")
    last = measured(map, first.ended(on), 100_000, 0)
    nu = last.nu_plus[last.chaotic]
    return nu.size / 600, float(np.mean(nu)), float(np.std(nu) / np.sqrt(nu.size))


@cache
def cut() -> tuple[np.ndarray, np.ndarray]:
    """A grid of contractions, and for each the number of chaotic particles out of 40 at `alpha = 0.08`."""
    pairs = parameter_space(np.array([0.08]), CUT, starts=40, bounces=2000, transient=4000, seed=SEED)
    return CUT, in_memory(pairs, 1)["chaotic"][0]


@judges("egg.chaotic_interval")
def chaotic_interval(claim: Claim) -> Judgement:
    """A search gives the first contraction at which most particles are chaotic, and the last at which some are.

    The claim is about a search, so it is not refuted by strange attractors that are proved but too small to be found.
    """
    lams, chaotic = cut()
    first, last = lams[chaotic >= 20][0], lams[chaotic >= 4][-1]
    low, high = (float(end) for end in str(claim.printed).strip("[]").split(","))
    agrees = [abs(found - end) <= NEAR for found, end in ((first, low), (last, high))]
    ends = [
        f"{name} {'agrees' if same else 'does not agree'}"
        for name, same in zip(("lower", "upper"), agrees, strict=True)
    ]
    said = (
        f"with 40 particles at each of {lams.size} contractions, most are chaotic first at {first:.4f}, and some up to "
        f"{last:.4f}; the cascade ends at 0.3935 (egg.cascade) and the attractor at 0.6621 (egg.boundary_crisis). "
        f"The {ends[0]} and the {ends[1]} with the printed end to {NEAR}"
    )
    (early, lower), (late, upper) = strange("0.08", "band-merging"), strange("0.08")
    return sampled(
        f"chaos is sampled from about {first:.3f} to {last:.4f}, with windows; strange attractors, in the sense of "
        f"sets of contractions of positive measure, are proved next to {lower.str(5, radius=False)} and next to "
        f"{upper.str(5, radius=False)}, and how large they are is not",
        f"{said}; {by('strange attractors at both', early, late).reason}",
        all(agrees) and bool(early) and bool(late),
    )


@judges("egg.chaos_beyond_cascade")
def chaos_beyond_cascade(claim: Claim) -> Judgement:
    """Between the cascade and the boundary crisis, samples show chaos except in windows with attracting cycles."""
    lams, chaotic = cut()
    inside = (lams > 0.3936) & (lams < 0.662)
    periods = {float(lam): set(periods_at("0.08", str(lam), 40)) for lam in lams[inside & (chaotic == 0)]}
    listed = "; ".join(f"{lam}: {', '.join(str(p or '> 256') for p in sorted(p))}" for lam, p in periods.items())
    share = float(np.mean(chaotic[inside] > 0))
    said = (
        f"some of 40 are chaotic at {share:.0%} of the {np.sum(inside)} contractions tried between 0.3936 and "
        f"0.662, and at the others cycles attract them, of periods {listed}. Beyond the crisis at 0.662 there is "
        "no chaotic attractor, as section 6.7 says"
    )
    windows = all(found - {0, 3} for found in periods.values())
    return sampled("for lambda_oo < lam < 0.662, except in windows", said, windows and share > 0.9)


@judges("egg.isolated_regions")
def isolated_regions(claim: Claim) -> Judgement:
    """The first doublings towards two of the regions are proved; chaos just beyond is sampled."""
    said, good = [], True
    for shape, contraction, period, step, beyond in CASCADES:
        found = cascade(Rational(shape), Rational(contraction), period, step)
        share, nu, error = chaos_at(shape, beyond)
        good = good and found.proved and share > 0 and found.limit < float(beyond)
        flips = ", ".join(f"{p} at {at:.6f}" for p, at in zip(found.periods, found.lams, strict=True))
        said.append(
            f"at alpha = {shape} doublings of period {flips}, certified and supercritical, the distances in the ratio "
            f"{found.ratios[0]:.3f}; they would accumulate at {found.limit:.6f}, and at {beyond} {share:.1%} of 600 "
            f"particles have nu_+ = {nu:.4f} +- {error:.0e}"
        )
    return sampled(
        "the regions tried are strips at the ends of cascades from period 12 and from period 8", "; ".join(said), good
    )


def periods_at(shape: str, lam: str, particles: int) -> Counter[int]:
    """How many random particles end on a cycle of each period; 0 stands for no period up to `LONGEST`."""
    map = map_of(shaped(3, float(shape)), float(lam))
    starts = interior_starts(map, particles, SEED)
    end = advanced(map, PhasePoints(*starts[:3]), 40_000).points
    orbit = map.orbit(end.theta, end.phi, LONGEST, end.component)
    gap = np.hypot(orbit.x - orbit.x[0], orbit.y - orbit.y[0]) + np.abs(orbit.phi - orbit.phi[0])
    back = gap[1:] < RETURN
    period = np.where(back.any(axis=0), back.argmax(axis=0) + 1, 0)
    return Counter(period.tolist())
