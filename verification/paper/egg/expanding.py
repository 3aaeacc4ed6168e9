"""Claims on how the egg's attractor expands with the contraction, by bounds for its extent in exit angle. Section 6.7.

Between a barrier and its mirror image a largest set is kept that attracts all orbits there and holds every attractor.
Its largest exit angle is bounded from above for all contractions of a range, and from below at its ends, so closely
that at each end it is larger than at every contraction from 0.43 to the end before. So no attractor there reaches as
far before. That the chaotic one reaches as far as all that is kept, at each end, is sampled: it may be a part, as a
cycle is in windows.
"""

from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import asin, ceil, floor, inf

from symbolic.expressions.signs import Finding
from symbolic.tables.scene import Scene
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, judges, sampled
from verification.paper.egg import crises
from verification.paper.judges.attractors import SHAPE
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.starts.extent import Extent

FIRST = "0.43"
CURVES = {  # contractions, and what gives a curve across all that is kept: a point, bounces, and how far up and down
    "0.5": ((1.901118735636582, 0.17411021420227438), 11, 0.4),
    "0.66": ((1.6494213273015186, -0.034534792301400684), 11, 0.5),
}


STOPS = (FIRST, "0.46", "0.5", "0.55", "0.6", "0.65", "0.66")  # one barrier serves all from each to the next


@cache
def extent(lam: str) -> Extent:
    """At one contraction."""
    return Extent(Barrier(Scene("egg", alpha=SHAPE), (Fraction(lam),) * 2), *CURVES[lam])


@cache
def ceiling(low: str, high: str) -> float:
    """A bound for the extent at every contraction of a range; infinite where none is proved."""
    barrier = Barrier(Scene("egg", alpha=SHAPE), (Fraction(low), Fraction(high)))
    return Extent(barrier, (0.0, 0.0), 1, 0.0).high


@cache
def expands() -> Finding:
    """At each contraction of the list the extent is larger than at all those from `FIRST` to the one before."""
    steps, most = [], ceiling(FIRST, FIRST)
    for before, lam in pairwise(STOPS):
        if lam in CURVES:
            low = extent(lam).low
            said = f"{down(low)} or more at {lam}, at most {up(most)} up to {before}"
            steps.append(answer(low > most or None, said))
        most = max(most, ceiling(before, lam))
    return by(f"the largest exit angle of what is kept between a barrier and its mirror image, from {FIRST} on", *steps)


def down(x: float) -> str:
    """Four decimals, none above the number."""
    return f"{floor(x * 10**4) / 10**4:.4f}"


def up(x: float) -> str:
    """Four decimals, none below the number."""
    return f"{ceil(x * 10**4) / 10**4:.4f}" if x < inf else "nothing"


def judged(range: str) -> Judgement:
    """What is proved of all that is kept, and what is sampled of the chaotic attractor within."""
    bounds = ", ".join(f"{down(extent(lam).low)} to {up(extent(lam).high)} at {lam}" for lam in CURVES)
    seen = {lam: asin(crises.extent(lam).height) for lam in CURVES}
    reaches = all(extent(lam).low <= angle <= extent(lam).high for lam, angle in seen.items())
    said = ", ".join(f"{angle:.4f} at {lam}" for lam, angle in seen.items())
    return sampled(
        f"{range}: of all that is kept between a barrier and its mirror image, where it attracts every orbit, the "
        f"largest exit angle is {bounds}; at each of these it is larger than at every contraction from {FIRST} to the "
        "one before. That the chaotic attractor, which is a part of it, reaches as far is sampled; in windows a cycle "
        "attracts",
        f"proved: {expands().reason}; sampled: chaotic orbits have exit angles up to {said}",
        bool(expands()) and reaches,
    )


@judges("egg.attractor_expands")
def attractor_expands(claim: Claim) -> Judgement:
    """Before the three regions have merged, and after: what is kept holds all of them."""
    return judged("proved from 0.43, where it holds three attractors or more, to 0.66")


@judges("egg.single_expands")
def single_expands(claim: Claim) -> Judgement:
    """Between the two crises, at 0.4434 and 0.6621."""
    return judged("proved between both crises, from 0.5 to 0.66")
