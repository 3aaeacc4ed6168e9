"""Judges of claims on attractors and exponents of both cardioids, proved or sampled. Paper: sections 4.1 to 5.3.

`symbolic.cycles.defocusing` shows, with `g = 1 + tan((1 - lam)*pi/8)**2/2`, for every `lam < 1` of the cardioid: on
every orbit off the cusp the lower limit of `log|D(T**n) (1, 0)|/n` is at least `log(g)`. `symbolic.cycles.almost_every`
shows for almost every start that its upper limit is at most `log(2)`, and that vectors of one direction shrink. For `0
< lam < 1` finitely many natural (SRB) measures have basins that hold almost every start, and the exponents exist in the
basins (`docs/exponents.md`, Theorem 11); it is not shown that there is only one such measure. At `lam = 1` the
exponents exist for almost every start; at `lam = 0` the natural measure and its exponent are proved.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from sympy import S, log, sin

from symbolic.cycles.almost_every import largest_exponent, two_rates
from symbolic.cycles.cycle import cuspless_horizontal, trace_and_determinant
from symbolic.cycles.defocusing import expands, least_exponent
from symbolic.cycles.normal_forms import a, coefficient, least_bend, return_map
from symbolic.expressions.signs import SignFinding
from symbolic.motion.collision import log_cosine_mean
from symbolic.tables import cardioid, cuspless
from symbolic.tables.geometry import arc_length, turning
from symbolic.tables.table import theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, equal, greater, judges, sampled, shown, zero
from verification.paper.judges.attractors import NEAR_ZERO, settles_near_zero
from verification.paper.judges.exponents import (
    CELLS,
    Spectrum,
    spectrum,
    uneven,
    visited,
)
from verification.paper.judges.hyperbolicity import chaos
from verification.paper.judges.located import TENTHS, at_most_zero
from verification.proofs.global_dynamics.one_step import ONE_STEP
from verification.proofs.slap_map.exponent import ChaoticProof, slap_exponent

FIFTHS = (0.2, 0.4, 0.6, 0.8, 1.0)
LONG = 12_000  # bounces of an orbit: 20 for each cell
DUE = 15  # the least expected number of visits to a cell for which a miss is not chance
Array = NDArray[np.float64]


@cache
def slap_proof() -> ChaoticProof:
    """The proof of the natural measure at `lam = 0` and of its exponent."""
    return slap_exponent()


@judges("cardioid.slap_ergodic")
def slap_ergodic(claim: Claim) -> Judgement:
    """The map is ergodic at `lam = 0`: its only invariant measure with a density is ergodic and natural."""
    proof = slap_proof()
    missing = [name for name, holds in proof.checks.items() if holds is not True]
    return Judgement(
        by(
            "the transfer operator of the slap map has exactly one invariant density on the boundary; so its measure "
            "of an invariant set is 0 or 1, and the time averages of almost every start are its means",
            answer(proof.certified, f"not proved: {', '.join(missing)}" if missing else ", ".join(proof.checks)),
        ),
        "ergodic: one invariant measure with a density, and almost every start follows it, with the exponent "
        f"{proof.value.str(15, radius=False)}; mixing is not shown",
    )


@cache
def coverage(table: str) -> Array:
    """The numbers of visits of 16 orbits to each cell of phase space, at each of the contractions `FIFTHS`."""
    return visited(table, FIFTHS, 16, LONG)


@judges("cardioid.attractor_grows", "cuspless.attractor_fills")
def grows(claim: Claim) -> Judgement:
    """Samples show that the fraction of cells that orbits visit grows with the contraction."""
    counts = coverage(claim.id.partition(".")[0])
    shares = [float(np.mean(c.sum(axis=0) > 0)) for c in counts]
    rough = uneven(counts[-1])
    listed = ", ".join(f"{x:.0%} at {value:g}" for x, value in zip(shares, FIFTHS, strict=True))
    said = (
        f"16 orbits of {LONG} bounces visit this share of {CELLS}x{CELLS} cells of (s, sin phi): {listed}; at lam = 1 "
        f"the cells' shares vary by {rough:.1%} beyond counting; |sin phi| <= sin(lam*pi/2) bounds the attractor"
    )
    good = bool(np.all(np.diff(shares) > 0)) and shares[-1] == 1 and rough < 0.05
    return sampled("it grows at each step sampled; uniform at lam = 1, the map's own measure", said, good)


@judges("cardioid.transitive")
def transitive(claim: Claim) -> Judgement:
    """Samples show that single orbits all visit the same cells, equally often."""
    worst = 1.0
    for counts in coverage("cardioid"):
        often = counts.sum(axis=0) > len(counts) * DUE
        worst = min(worst, float(np.mean(counts[:, often] > 0)))
    proof = slap_proof()
    said = (
        f"16 orbits each at lam = 0.2, ..., 1 together visit at least {worst:.2%} of the pairs of an orbit and a cell "
        f"where {DUE} visits are due; at lam = 0 it is {'' if proof.certified else 'not '}proved that almost every "
        "start has one distribution; not of any orbit: unstable cycles lie on the attractor"
    )
    derived = "almost every start, not any: proved at lam = 0, sampled for lam > 0"
    return sampled(derived, said, worst > 0.999 and proof.certified)


NOT_SHOWN = "not shown for 0 < lam < 1: that there is one natural (SRB) measure, hence transitivity"


def stretching() -> SignFinding:
    """The finding that every orbit off the cusp stretches exponentially: bounces map a cone into itself."""
    return by(
        "beams that focus before D = cos(phi)/|K| form a cone that every bounce maps into itself at any lam, since "
        "t*(t - D0 - d1) = (4/3)*sin(delta)^4 >= 0 on every chord; their width in units of D grows by (t - D0)/d1 >= 1 "
        "and by g = 1 + tan((1 - lam)*pi/8)^2/2 at least from the second bounce on, when delta >= (1 - lam)*pi/4; so "
        "|D(T^n) (1, 0)| >= sin((1 - lam)*pi/4)^4/4*g^(n - 2) for n >= 2, on every orbit off the cusp",
        expands(),
    )


def elastic() -> SignFinding:
    """The finding that at `lam = 1` the exponents exist and are not 0, for almost every start."""
    return by(
        "at lam = 1 the gain exceeds 1 on every chord, so its mean logarithm is positive for almost every start "
        "(Birkhoff); log(cos(phi)) and log|K| have finite means in the measure that the map keeps, so the exponents "
        "exist for almost every start (Oseledets), and their sum, the mean of log(cos(phi0)/cos(phi1)), is 0",
        expands(),
        answer(log_cosine_mean().is_finite, "the mean of log(cos) is log(2) - 1"),
        equal(arc_length(cardioid.components[0]), 4 * sin(theta / 2), {}),
        zero("", log_cosine_mean() - log(2) + 1),
    )


def both_signs() -> SignFinding:
    """The finding that on every orbit off the cusp one direction stretches and one shrinks, at bounded rates."""
    return by(
        "the direction that no bounce takes into the cone shrinks by the gain of the chord run backwards, by g at "
        "least from the second bounce on, and keeps apart from the cone, on every orbit off the cusp; a horizontal "
        "line is in at most 2^n pieces after n bounces, none longer than the wall, so almost every start has "
        "nu_+ <= log(2)",
        stretching(),
        two_rates(),
        at_most_zero(),
        elastic(),
    )


def measured() -> str:
    """The sampled range of both exponents, as text."""
    (low, high), (least, most) = ranges()
    return f"sampled at lam = 0.1, ..., 1: nu_+ from {low:.3f} to {high:.3f}, nu_- from {least:.2f} to {most:.3f}"


def ranges() -> tuple[tuple[float, float], tuple[float, float]]:
    """The least and the largest `nu_plus`, then `nu_minus`, of single orbits at `lam = 0.1, ..., 1`."""
    found = spectrum("cardioid", TENTHS)
    plus, minus = found.plus[1:], found.minus[1:]
    return (float(plus.min()), float(plus.max())), (float(minus.min()), float(minus.max()))


def natural_measures() -> SignFinding:
    """The finding that for `0 < lam < 1` finitely many natural measures have basins with almost every start."""
    return by(
        "for 0 < lam < 1 a short curve along the cone is cut in two pieces at most, and the sum of the inverses of "
        "their stretches is below 1; what comes within e of the cusp's curve at any one time measures O(e) on it, so "
        "almost every point has a stable curve, and lengths of curves that such curves join are comparable. A set that "
        "these curves and the map keep, of positive area, has full length on a curve of a fixed length: there are "
        "finitely many, each with one ergodic natural measure, for which Birkhoff's theorem gives the limits, the same "
        "for almost every start in the set (docs/exponents.md, Theorem 11)",
        stretching(),
        two_rates(),
        answer(ONE_STEP.proved, "one-step expansion at every 0 <= lam < 1"),
    )


@judges("cardioid.lyapunov_exist")
def existence(claim: Claim) -> Judgement:
    """The exponents exist for almost every start: by natural measures below `lam = 1`, by Oseledets' theorem at 1."""
    return Judgement(
        by("below lam = 1 and at 1", natural_measures(), elastic()),
        "for every 0 < lam <= 1 almost every start has both exponents, as limits; for lam < 1 they take finitely many "
        f"pairs of values, with nu_+ from {least_exponent()} to {largest_exponent()}, nu_- <= log(lam) and "
        f"nu_+ + nu_- <= 0",
    )


@judges("cardioid.lyapunov_signs")
def signs(claim: Claim) -> Judgement:
    """The lower limit of one growth rate is proved to be positive, the upper limit of the other to be negative."""
    return Judgement(
        both_signs(),
        f"for every lam < 1 the rate of the largest singular value of D(T^n) has a lower limit of at least "
        f"{least_exponent()} on every orbit off the cusp, and that of the smallest an upper limit of at most minus "
        f"that and, for lam > 0, at most log(lam); at lam = 1 nu_+ = -nu_- > 0 for almost every start; {measured()}",
    )


@judges("cardioid.exponents_bounded_away")
def bounded_away(claim: Claim) -> Judgement:
    """Exponents are proved to be bounded away from 0 at each `lam < 1`; one bound for all `lam` is only sampled."""
    (least, _), (_, most) = ranges()
    return sampled(
        f"proved at each lam < 1: {least_exponent()} bounds all orbits; it tends to 0 as lam tends to 1, so neither "
        "one bound for all lam nor one for all orbits at lam = 1 is shown",
        f"proved at each lam < 1, with a bound that tends to 0 as lam tends to 1; {measured()}",
        bool(both_signs()) and least > 0.2 and most < -0.2,
    )


@judges("cardioid.nonuniformly_hyperbolic")
def nonuniformly_hyperbolic(claim: Claim) -> Judgement:
    """Every orbit that misses the cusp is hyperbolic, with bounds that depend only on `lam < 1`."""
    return Judgement(
        both_signs(),
        "for every lam < 1 every orbit off the cusp is hyperbolic, and uniformly so in |K|*ds and dphi: the rate of "
        f"one direction has a lower limit of at least {least_exponent()}, that of the other an upper limit of at most "
        f"minus that and at most log(lam); limits exist for almost every start, at lam = 1 too",
    )


@judges("cardioid.chaotic_attractor")
def chaotic_attractor(claim: Claim) -> Judgement:
    """The likely limit set [Milnor1985] is not a finite union of cycles, and almost every orbit in it is unstable."""
    proof = slap_proof()
    return Judgement(
        by(
            "phase space is taken into the strip abs(phi) <= lam*pi/2, and the smallest closed set that holds the "
            "limit points of almost every orbit is an attractor [Milnor1985]. Two points of a horizontal line whose "
            "orbits pass the cusp on the same sides are one, so almost every orbit converges to no cycle, and none to "
            "the cusp: the attractor is no finite union of cycles. Every orbit off the cusp stretches",
            both_signs(),
            answer(proof.certified, "at lam = 0 one natural measure, with its exponent"),
        ),
        "for every lam < 1 an attractor in Milnor's sense that is no finite union of cycles; almost every orbit "
        f"converges to no cycle and stretches at a rate from {least_exponent()} to {largest_exponent()} a bounce; for "
        f"lam < 1/2 it has no area. {NOT_SHOWN[0].upper()}{NOT_SHOWN[1:]}; {measured()}",
    )


@judges("cardioid.attractor_near_cusp", "cardioid.attractor_noncompact")
def near_cusp(claim: Claim) -> Judgement:
    """Almost every orbit comes near the cusp: curves grow although the cusp cuts them; long ones come near it."""
    return Judgement(
        by(
            "a short curve along the cone is cut in two pieces at most, and the sum of the inverses of their stretches "
            "is below 1; so, as distortion is bounded, the points of a curve whose pieces stay short have length 0. A "
            "fixed share of each long piece comes next to the cusp, where 0 < h' <= cos(theta/2) < h, within a fixed "
            "number of bounces, since what never does would outgrow the wall; so those that do not, from some time on, "
            "have no point of density (docs/exponents.md)",
            stretching(),
            answer(ONE_STEP.proved, "one-step expansion at every 0 <= lam < 1"),
        ),
        "for every 0 <= lam < 1 the orbit of almost every start has limit points off the cusp as near to it as wanted; "
        "so the attractor, the closed set of limit points of almost every orbit, does, and is not compact off the cusp",
    )


@judges("cuspless.stable_if_flatter")
def stable_if_flatter(claim: Claim) -> Judgement:
    """A straight wall has the least curvature; a bent wall can reverse the sign of the flip's normal form."""
    free, bent = coefficient()
    M, _ = return_map()
    trace, det = trace_and_determinant(cuspless_horizontal())
    return Judgement(
        counterexample(
            "around s = 0 the wall is straight: its curvature is 0, and no table has one of smaller modulus",
            zero("", turning(cuspless.component("wall"))),
        ),
        "stable when the curvature at s = 0 stays 0 and its modulus grows beside it, kappa''(0) < "
        f"{-24 * least_bend()}",
        by(
            "with the wall x = -1/4 + b*y^4 the orbit, its multipliers and lambda_c stay, and the flip has the "
            f"coefficient c = {free} + {bent}*b: negative for the straight wall, positive, and the period-4 orbit "
            f"stable, for b > {least_bend()}; b > 0 makes the curvature -12*b*s^2 next to s = 0, which focuses",
            zero("", M.subs(a, 0).trace() - trace, M.subs(a, 0).det() - det),
            greater(-free, S.Zero),
            greater(bent, S.Zero),
            greater(least_bend(), S.Zero),
        ),
        "Around s = 0 the wall is straight, so its curvature cannot be smaller. The period-4 orbit becomes stable when "
        f"the wall is bent to focus beside s = 0: x = -1/4 + b*y^4 with b > {least_bend()}.",
    )


@judges("cuspless.nontrivial_larger")
def nontrivial_larger(claim: Claim) -> Judgement:
    """For small `lam` only the period-2 orbit attracts; above `lambda_star`, a chaotic attractor exists."""
    return Judgement(
        by("none near 0, and one above", settles_near_zero(), chaos()),
        f"no attractor but the period-2 orbit for 0 < lam <= {NEAR_ZERO}; a chaotic one for lambda_star < lam <= 0.1, "
        "lambda_star = 0.07122",
    )


@judges("cuspless.visits_more_boundary")
def visits_more(claim: Claim) -> Judgement:
    """Samples show that the fraction of boundary cells that 16 orbits visit grows with the contraction."""
    counts = coverage("cuspless").reshape(len(FIFTHS), -1, CELLS, CELLS).sum(axis=(1, 3))
    shares = np.mean(counts > 0, axis=1)
    said = (
        f"16 orbits of {LONG} bounces visit this share of {CELLS} cells of s: "
        f"{', '.join(f'{x:.0%} at {value:g}' for x, value in zip(shares, FIFTHS, strict=True))}"
    )
    grows = bool(np.all(np.diff(shares) >= 0)) and bool(shares[0] < shares[-1] == 1)
    return sampled("it grows until the whole boundary is visited, and stays", said, grows)


@judges("cardioid.error_bars")
def error_bars(claim: Claim) -> Judgement:
    """The error bars from 100 sampled starts are smaller than symbols of a hundredth of the axis."""
    exponents = spectrum("cardioid", TENTHS, 100)
    values = np.stack([exponents.plus[1:], exponents.minus[1:]])
    spread, error = float(np.max(np.std(values, axis=-1))), float(np.max(Spectrum.error(values)))
    axis = float(np.ptp(np.mean(values, axis=-1)))
    said = (
        f"100 starts of 2000 bounces at lam = 0.1, ..., 1: the exponents vary by {spread:.3f} from orbit to orbit at "
        f"most, their means by {error:.4f}, where the axis is {axis:.1f} high"
    )
    return sampled("time averages are the same for almost every start sampled", said, error < axis / 100)


@judges("cardioid.finitely_many_attractors")
def finitely_many(claim: Claim) -> Judgement:
    """The slap map has one natural measure; for `0 < lam < 1` there are finitely many."""
    proof = slap_proof()
    return Judgement(
        by(
            "T_0 has exactly one invariant density, and the time averages of almost every start are its own",
            shown("the certificate of the slap map's exponent holds", bool(proof.certified) or None),
            natural_measures(),
        ),
        "exactly one at lam = 0; for 0 < lam < 1 there are finitely many, whose basins hold almost every start",
    )
