"""Judges of claims on the period-doubling cascade of the egg's period-4 orbits. Paper: sections 6.5, 6.6."""

from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
from flint import fmpq
from sympy import Integer, Rational

from numeric import PinballMap
from numeric.sweeps.run import in_memory
from numeric.sweeps.space import parameter_space
from symbolic.cycles.polygons import saddle_node
from symbolic.cycles.thresholds import tilt
from symbolic.expressions.signs import SignFinding, positive
from symbolic.tables import egg as table_of
from symbolic.tables.scene import Scene
from symbolic.tables.table import alpha
from verification.cycles.cascade import attractor
from verification.named.cascades import cascade
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled, shown
from verification.paper.egg.period2 import SHAPES
from verification.paper.egg.stability import attracting_4, chaos_at
from verification.paper.judges.attractors import STARTS, egg, proved_at, unsettled
from verification.paper.judges.hyperbolicity import ends_of_period
from verification.paper.judges.located import certified, located
from verification.proofs.global_dynamics.fates import FewAttractingCycles
from verification.proofs.periodic.bifurcation import Stability, over_interval

SHAPE = Rational(2, 25)
SMALL = ("0", "0.05", "0.1", "0.2", "0.28")  # contractions where only period 4 attracts
BETWEEN = 0.33, (0.289, 0.371)  # inside the range where an asymmetric period 4 attracts
OTHERS = (Rational(3, 40), Rational(9, 100))  # shapes with which the cascade at 0.08 is compared
TONGUE = ("0.02", "0.05", "0.07", "0.08", "0.09", "0.1")
LAMS = np.round(np.arange(0.05, 0.96, 0.05), 3)
PROVED = Fraction(3, 128)  # the largest contraction up to which the cycles are proved
STOPS = (0.03, 0.01, 1e-12)  # tolerances of Newton's method
STRIPS = (("0.0795", "0.382", 12, 2e-4), ("0.08", "0.3716", 12, 2e-4))  # neighbouring shapes, with starts


@cache
def chaotic_lams() -> dict[str, list[float]]:
    """For each shape, the contractions on a grid at which at least a quarter of 20 particles are chaotic."""
    shapes = np.array([float(shape) for shape in TONGUE])
    found = in_memory(parameter_space(shapes, LAMS, starts=20, bounces=2000, transient=3000, seed=1), 1)
    rows = zip(TONGUE, found["chaotic"], strict=True)
    return {shape: [float(lam) for lam, n in zip(LAMS, row, strict=True) if n >= 5] for shape, row in rows}


def listed() -> str:
    """The contractions with chaos for each shape, as text."""
    rows = [(shape, lams) for shape, lams in chaotic_lams().items()]
    return "; ".join(f"{shape}: {f'{min(r):g} to {max(r):g} ({len(r)})' if r else 'none'}" for shape, r in rows)


@judges("egg.alpha_destabilises")
def destabilises(claim: Claim) -> Judgement:
    """The stability number of the diameters is proved to fall with alpha; only samples show that chaos spreads."""
    falls = positive(tilt().diff(alpha), {alpha: SHAPES})
    counts = [len(row) for row in chaotic_lams().values()]
    said = (
        f"proved: on the diameters 1 - P = (18*alpha/(1 - alpha^2))^2 grows with alpha at every lam, so that one "
        f"multiplier falls through -1 once and for all; sampled: contractions out of {LAMS.size} with chaos, by "
        f"alpha: {listed()}. The triangles at the flat points attract at every alpha"
    )
    spreads = counts[:3] == [0, 0, 0] and 0 < counts[3] < counts[4]
    return sampled(
        "the diameters lose stability and chaos spreads; the period-3 orbits go on attracting",
        said,
        bool(falls) and spreads,
    )


@judges("egg.tongue")
def tongue(claim: Claim) -> Judgement:
    """The range of contractions with chaos, for each shape, is determined from a sample."""
    rows = chaotic_lams()
    ends = [(min(rows[x]), max(rows[x])) for x in ("0.08", "0.09", "0.1") if rows[x]]
    starts_lower = [low for low, _ in ends]
    good = len(ends) == 3 and starts_lower == sorted(starts_lower, reverse=True) and not rows["0.07"]
    said = f"contractions out of {LAMS.size} in steps of 0.05 at which a quarter of 20 particles is chaotic: {listed()}"
    return sampled("a region that opens above alpha = 0.07 and moves to smaller lam as alpha grows", said, good)


@judges("egg.small_basins")
def small_basins(claim: Claim) -> Judgement:
    """Computes exactly the probability that 100 independent random starts all miss a basin."""
    missed = Rational(999, 1000) ** 100
    return Judgement(
        by(
            "100 random starts miss a basin of the share p with the probability (1 - p)^100, above 0.9 for p <= 0.001",
            shown("0.999^100 > 0.9", bool(missed > Rational(9, 10))),
        ),
        "(1 - p)^100 is 0.90 for p = 0.001, 0.37 for p = 0.01 and 0.05 for p = 0.03",
    )


@judges("egg.representative")
def representative(claim: Claim) -> Judgement:
    """At two other shapes the same bifurcations occur in the same order, except for the fold of the triangles."""
    said, good = [], True
    for shape in (OTHERS[0], SHAPE, OTHERS[1]):
        events = [located("symmetry-breaking", alpha=shape)]
        events += [located("doubling", alpha=shape, n=Integer(n)) for n in (3, 4)]
        values = [float(event.ball.mid()) for event in events]
        good = good and all(event.certified for event in events) and values == sorted(values)
        fold = float(saddle_node().subs(alpha, shape))
        told = ", ".join(f"{value:.5f}" for value in values)
        said.append(f"alpha = {float(shape):g}: {told}, and period 3 from {fold:.4f} on")
    return sampled(
        "the same order for 0.0717 < alpha < 0.1; above 0.0807 chaos comes before the triangles, not after",
        f"loss of symmetry and doublings of periods 4 and 8, certified: {'; '.join(said)}; other shapes of the "
        "region and later events are not computed here",
        good,
    )


@cache
def cycles_for_small_lam() -> SignFinding:
    """The finding that, for every contraction up to `PROVED`, all cycles but at most three are unstable."""
    ends, scene = [PROVED * k / 3 for k in range(4)], Scene("egg", alpha=SHAPE)
    return answer(
        all(FewAttractingCycles(scene, band, (12288, 256), 32, 3).proved for band in pairwise(ends)),
        "for every lam in [0, 3/128] all cycles are unstable, but for at most one in each of three sinks; a cycle of "
        "period 4 is none of its turned copies, so that where one attracts it is the only one, up to symmetry",
    )


@judges("egg.only_period4")
def only_period4(claim: Claim) -> Judgement:
    """A cover of phase space proves the claim for small contractions; for larger ones it is sampled."""
    alone = all([a.period for a in egg(x)] == [4, 4, 4] and unsettled(egg(x)) == 0 for x in SMALL)
    proofs = [proved_at(x, 4) for x in SMALL]
    said = (
        f"sampled at lam = {', '.join(SMALL)}, each of {STARTS} random starts reaches one of three cycles of period 4, "
        f"which are proved to attract; a share below {3 / STARTS:.1%} of others is not excluded"
    )
    whole = by("the attracting cycles are those of period 4", cycles_for_small_lam(), attracting_4())
    if not whole:
        return sampled("three attracting orbits of period 4", said, alone and all(proofs))
    return Judgement(
        whole,
        "proved for 0 <= lam <= 3/128: a stable cycle has period 4, and there is one, up to symmetry; up to the "
        f"pitchfork at 0.2878 three are found: {said}",
    )


@cache
def attracting_without_mirror() -> SignFinding:
    """The finding that asymmetric cycles of period 4 attract, from the loss of symmetry to the period doubling."""
    table, (lam, ends) = table_of(3).at(alpha=SHAPE), BETWEEN
    start = attractor(table, lam, (0.05, 3.1))
    away = abs(np.remainder(start[0] + start[2] + np.pi, 2 * np.pi) - np.pi) > 0.01
    found = all(over_interval(table, (0,) * 4, start, (lam, end), Stability.ATTRACTING).proved for end in ends)
    low, high = ends
    return answer(bool(found and away), f"a period 4 without the mirror attracts for every {low} <= lam <= {high}")


@judges("egg.period4_doubles")
def period4_doubles(claim: Claim) -> Judgement:
    """Two bifurcations are found: a pitchfork that breaks the symmetry, and a doubling of the asymmetric cycles."""
    breaks, doubles = located("symmetry-breaking", alpha=SHAPE), located("doubling", alpha=SHAPE, n=Integer(3))
    stable = breaks.proof.supercritical if breaks.proof else None  # type: ignore[union-attr]  # a cycle's proof
    flips = doubles.proof.supercritical if doubles.proof else None  # type: ignore[union-attr]
    before = answer(bool(breaks.ball < fmpq(29, 100) and doubles.ball > fmpq(37, 100)), "0.2878 comes before 0.3712")
    pitchfork = answer(stable, "there two attracting cycles of period 4, mirror images, are born from each")
    return Judgement(
        counterexample(
            "the period-4 orbits of small lam are mirror-symmetric and become unstable at 0.287785..., in a pitchfork "
            "and with a multiplier of half the orbit at -1, of the whole one at 1: no period doubling",
            certified("symmetry-breaking", alpha=SHAPE),
            pitchfork,
        ),
        "3 symmetric orbits of period 4 up to lam = 0.287785..., 6 without the mirror from there to 0.371235..., where "
        "these double: 6 attracting orbits of period 8",
        by(
            "a pitchfork, then a supercritical doubling",
            certified("symmetry-breaking", alpha=SHAPE),
            pitchfork,
            attracting_without_mirror(),
            certified("doubling", alpha=SHAPE, n=Integer(3)),
            answer(flips, "the flip bears attracting orbits of period 8"),
            before,
        ),
        "The period-4 orbits of small lambda lose their mirror symmetry first, at lambda = 0.287785, in a pitchfork "
        "that bears six stable period-4 orbits; it is these that double, at 0.371235.",
    )


@judges("egg.negative_exponents")
def negative_exponents(claim: Claim) -> Judgement:
    """A counterexample: a cycle that attracts at its period doubling has a multiplier -1 and the exponent 0."""
    doubles = located("doubling", alpha=SHAPE, n=Integer(3))
    flips = doubles.proof.supercritical if doubles.proof else None  # type: ignore[union-attr]  # a cycle's proof
    return Judgement(
        counterexample(
            "at lam = lambda_3 itself the cycle of period 4 has the multiplier -1, so the exponent log|-1|/4 = 0, and "
            "still attracts, since the flip is supercritical",
            certified("doubling", alpha=SHAPE, n=Integer(3)),
            answer(flips, "supercritical"),
            at={alpha: SHAPE},
        ),
        "negative on every attracting cycle with both multipliers inside the unit circle; 0 at the bifurcations",
        by(
            "the exponent is log|mu|/n with the largest multiplier, negative when both lie inside the circle",
            attracting_without_mirror(),
        ),
        "Of attracting orbits it is negative, but at bifurcation values it is 0: at lambda_3 the orbit still attracts.",
    )


@judges("egg.tolerance_sensitive")
def tolerance_sensitive(claim: Claim) -> Judgement:
    """Period 4 seems to end at contractions that depend on the tolerance with which flights are solved."""
    ends = seen_ends()
    true = float(located("doubling", alpha=SHAPE, n=Integer(3)).ball.mid())
    said = ", ".join(f"{f'{end:.5f}' if end else 'above 0.3725'} with {stop:g}" for stop, end in ends.items())
    exact, loose = ends[STOPS[-1]], ends[STOPS[0]]
    good = exact is not None and loose is not None and abs(exact - true) < 3e-4 < abs(loose - exact) < 2e-3
    return sampled(
        "lambda_3 shifts by less than 1e-3 up to a tolerance of 0.03, enough to read 0.372 for 0.3712",
        f"period 4 is seen to end (2000 bounces at each contraction, steps of 1e-4, back to 1e-4) at {said} as the "
        f"last step of Newton's method; certified {true:.6f}. From 0.01 down the tolerance changes nothing",
        good,
    )


@cache
def seen_ends() -> dict[float, float | None]:
    """For each tolerance, the first contraction on a grid whose orbit does not close after four bounces, or None."""
    settled = PinballMap("egg", lam="0.36", alpha=str(SHAPE)).orbit(0.05, 0.0, 1000)
    start, lams = (float(settled.theta[-1]), float(settled.phi[-1])), np.arange(0.3705, 0.3725, 1e-4)
    found = ends_of_period(4, lams, 0.08, STOPS, start, 2000, 1e-4)
    return {stop: float(ends[0]) if ends.size else None for stop, ends in zip(STOPS, found, strict=True)}


@judges("egg.isolated_resolution")
def isolated_resolution(claim: Claim) -> Judgement:
    """A strip of chaos that a coarse grid meets at one shape continues at other shapes."""
    said, good = [], True
    for shape, lam, period, step in STRIPS:
        found = cascade(Rational(shape), Rational(lam), period, step)
        good = good and found.proved
        beyond = f"{found.limit + 1e-4:.6f}"
        share, nu, error = chaos_at(shape, beyond)
        good = good and share > 0
        said.append(
            f"at alpha = {shape} the doublings of period {period} are certified and accumulate near {found.limit:.6f}; "
            f"at {beyond} {share:.1%} of 600 particles have nu_+ = {nu:.4f} +- {error:.0e}"
        )
    return sampled(
        "narrow strips across the plane of alpha and lam, of which a coarse grid meets a point here and there; at one "
        "alpha they are apart from the tongue",
        "; ".join(said),
        good,
    )
