"""Claims on what simulations of the two cardioids show, and on a table that would behave otherwise.

Paper: sections 4.1 to 5.3.
"""

import numpy as np
from numpy.typing import NDArray
from sympy import S

from numeric import PinballMap
from symbolic.cycles.cycle import cuspless_horizontal, trace_and_determinant
from symbolic.cycles.normal_forms import a, coefficient, least_bend, return_map
from verification.paper.cardioid.attractor import FIFTHS, LONG, coverage
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, greater, judges, shown, zero
from verification.paper.shared.attractors import STARTS, chaotic, cycles, found, unsettled
from verification.paper.shared.contraction import TENTHS
from verification.paper.shared.samples import CELLS, Spectrum, sampled, spectrum
from verification.proofs.slap_map.chaotic_exponent import slap_exponent

Array = NDArray[np.float64]
BELOW = ("0.01", "0.03", "0.05", "0.07", "0.071")
ABOVE = ("0.08", "0.2", "0.5", "0.9")


@judges("cuspless.stable_if_flatter")
def stable_if_flatter(claim: Claim) -> Judgement:
    """The normal form of the flip in the wall's jets: its sign changes when the wall bends away from its centre."""
    free, bent = coefficient()
    M, _ = return_map()
    trace, det = trace_and_determinant(cuspless_horizontal())
    return Judgement(
        by(
            "with the wall x = -1/4 + b*y^4 the orbit, its multipliers and lambda_c stay, and the flip has the "
            f"coefficient c = {free} + {bent}*b: negative for the straight wall, positive, and the period-4 orbit "
            f"stable, for b > {least_bend()}; b > 0 makes the curvature -12*b*s^2, smaller around s = 0",
            zero("", M.subs(a, 0).trace() - trace, M.subs(a, 0).det() - det),
            greater(-free, S.Zero),
            greater(bent, S.Zero),
            greater(least_bend(), S.Zero),
        ),
        f"stable when the curvature at s = 0 stays 0 and has kappa''(0) < {-24 * least_bend()}",
    )


def from_the_join(contraction: str, bounces: int = 4000) -> Array:
    """The exit angles after so many bounces of balls that leave the upper join at 41 angles up to 0.05."""
    map = PinballMap("cuspless", lam=contraction)
    start = np.linspace(-0.05, 0.05, 41)
    return np.asarray(map.orbit(np.full(41, 2 * np.pi / 3), start, bounces).phi[-1])


@judges("cuspless.below_star_converges")
def below_star(claim: Claim) -> Judgement:
    """From the join, at angles near 0, below `lambda_star`."""
    worst = max(float(np.max(np.abs(from_the_join(x)))) for x in BELOW)
    said = (
        f"sampled at lam = {', '.join(BELOW)}: each of 41 balls that leave the upper join at angles from -0.05 to 0.05 "
        f"has come to the horizontal orbit after 4000 bounces, exit angles up to {worst:.0e}"
    )
    return sampled("the horizontal orbit, proved to attract below lambda_c", said, worst < 1e-9)


@judges("cuspless.nontrivial_larger")
def nontrivial_larger(claim: Claim) -> Judgement:
    """No chaotic attractor below `lambda_star`, one above."""
    small, large = ([found("cuspless", x) for x in some] for some in (BELOW, ABOVE))
    trivial = all(len(cycles(some, 2)) == len(some) == 1 and not unsettled(some) for some in small)
    said = (
        f"{STARTS} random starts each: at lam = {', '.join(BELOW)} all reach the period-2 orbit, at lam = "
        f"{', '.join(ABOVE)} some or all a chaotic attractor"
    )
    return sampled("from lambda_star = 0.07122 on", said, trivial and all(chaotic(some) for some in large))


@judges("cuspless.visits_more_boundary")
def visits_more(claim: Claim) -> Judgement:
    """The share of cells along the boundary that 16 orbits visit."""
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
    """Over 100 starts, as in the paper's figure, whose symbols are taken to be a hundredth of the axis."""
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
    """For the slap map: one, since it has one invariant density, on which almost every start settles."""
    proof = slap_exponent()
    return Judgement(
        by(
            "T_0 has exactly one invariant density, and the time averages of almost every start are its own",
            shown("the certificate of the slap map's exponent holds", bool(proof.certified) or None),
        ),
        "exactly one at lam = 0; nothing is proved on their number for lam > 0",
    )
