"""Claims on the cardioid's positive exponent, conjectured in section 4.1 and proved in `symbolic.defocusing`."""

import numpy as np

from symbolic.defocusing import expands, least_exponent
from symbolic.signs import Finding
from verification.claims.claim import Claim, Judgement
from verification.claims.judges import by, judges
from verification.claims.on_cardioid_attractor import nearing
from verification.claims.on_contraction import TENTHS, at_most_zero
from verification.claims.spectra import spectrum


def positive_exponent() -> Finding:
    """`nu_plus > 0`, by a cone of beams that every bounce maps into itself and widens."""
    return by(
        "beams that focus before D = cos(phi)/|K| form a cone that every bounce maps into itself at any lam, since "
        "t >= D0 + d1 on every chord; their width in units of D grows by (t - D0)/d1 >= 1 + tan(delta/2)^2/2 or 3/2, "
        "and delta >= (1 - lam)*pi/4 from the first bounce on; at lam = 1 the gain exceeds 1 everywhere, so its mean "
        "logarithm is positive for almost every start (Birkhoff)",
        expands(),
    )


def measured() -> str:
    """The sampled range of both exponents, for comparison."""
    found = spectrum("cardioid", TENTHS)
    plus, minus = np.mean(found.plus, axis=1), np.mean(found.minus[1:], axis=1)
    return f"sampled at lam = 0, 0.1, ..., 1: nu_+ from {plus.min():.3f} to {plus.max():.3f}, nu_- <= {minus.max():.3f}"


@judges("cardioid.lyapunov_signs", "cardioid.nonuniformly_hyperbolic")
def signs(claim: Claim) -> Judgement:
    """One exponent is positive on every orbit, and the sum is at most 0 for almost every start."""
    return Judgement(
        by("where the exponents exist, nu_- <= -nu_+ for almost every start", positive_exponent(), at_most_zero()),
        f"nu_+ >= {least_exponent()} on every orbit that has exponents and misses the cusp, at each lam < 1, and "
        f"nu_- <= -nu_+ for almost every start; {measured()}",
    )


@judges("cardioid.chaotic_attractor")
def chaotic(claim: Claim) -> Judgement:
    """No cycle attracts: a chaotic attractor in the paper's sense, one with a positive exponent (section 6.6)."""
    return Judgement(
        by(
            "every orbit off the cusp stretches at a rate of at least log(1 + tan((1 - lam)*pi/8)^2/2) > 0: every "
            "cycle is unstable, none attracts, and almost every start has a positive exponent",
            positive_exponent(),
        ),
        f"nu_+ >= {least_exponent()} on every orbit; {measured()}",
    )


@judges("cardioid.attractor_near_cusp", "cardioid.attractor_noncompact")
def near_cusp(claim: Claim) -> Judgement:
    """A curve that no point leaves into the cusp would grow beyond the length of the boundary."""
    return Judgement(
        by(
            "a curve along the cone is monotone in s, so it measures at most 3*pi in |K|*ds; it grows at each bounce "
            "by a factor bounded away from 1 until one of its points hits the cusp, whose neighbours land arbitrarily "
            "near it. So the starts that come as near to the cusp as wanted, as late as wanted, are dense (lam < 1), "
            "and no compact set off the cusp attracts an open set",
            positive_exponent(),
        ),
        f"generic orbits come arbitrarily near the cusp again and again; {nearing()}",
    )
