"""Claims supported by sampling, with its error: the sizes of basins. Paper: section 6.4."""

from dataclasses import replace

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import phase_starts
from symbolic.polygons import saddle_node
from symbolic.signs import Finding, Outcome
from symbolic.symbols import alpha
from verification.claims.claim import Claim, Judgement
from verification.claims.judges import digits, judges

SHAPE = Rational(2, 25)
SEED = 1


def sampled(derived: str, evidence: str, agrees: bool) -> Judgement:
    """A claim that sampling supports within the error it states, and leaves open where it does not."""
    return Judgement(Finding(Outcome.UNKNOWN, evidence), derived, evidence=evidence if agrees else "")


def share_of_period_3(lam: str, starts: int = 400, bounces: int = 3000) -> float:
    """The share of random starts that end on period 3: their neighbourhood shrinks, off the diameters."""
    map = PinballMap("egg", lam=lam, alpha=str(SHAPE))
    ball = phase_starts(map, starts, SEED)
    end = map.exponents(ball.theta, ball.phi, 200, bounces, ball.component)
    return float(np.mean((end.nu_plus < 0) & (np.abs(end.phi) > 0.15)))


@judges("egg.period3_end_caption")
def end_of_period_3(claim: Claim) -> Judgement:
    """The fold in closed form, and why sampling sees it late: the basins are born with size 0."""
    shares = ", ".join(f"{share_of_period_3(lam):.1%} at {lam}" for lam in ("0.3785", "0.38", "0.39", "0.42"))
    found = digits(claim, saddle_node().subs(alpha, SHAPE), ("0.39", "0.378"))
    return replace(found, derived=f"{found.derived}; random starts that reach period 3: {shares}, so plots see it late")
