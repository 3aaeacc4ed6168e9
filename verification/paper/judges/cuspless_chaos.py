"""Claims on the chaos of the cuspless cardioid, from `lambda*` to 1. Paper: section 5.

`symbolic.cycles.returns` and `splitting` show, for every `1/10 <= lam < 1`, that each return to the arc stretches beams
of a cone, so that every orbit that misses the joins is unstable; a trapping polygon shows chaos from `lambda*` to 1/10.
Not shown is that what attracts has one dense orbit: claims that there is a chaotic attractor are settled, claims that
one attracts globally, or that it is the only one, are not.
"""

from fractions import Fraction
from functools import cache
from itertools import pairwise

from flint import arb

from symbolic.cycles.returns import HIGHEST, LOWEST
from symbolic.cycles.splitting import least_rate, splits
from symbolic.expressions.signs import Finding
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import real_ball
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled
from verification.paper.judges.attractors import (
    HORIZONTAL,
    NEAR_ZERO,
    STARTS,
    chaotic,
    found,
    near_zero,
    unsettled,
)
from verification.paper.judges.cuspless import attracting_below
from verification.paper.judges.hyperbolicity import PROVED_TO, chaos
from verification.paper.judges.located import certified, value
from verification.proofs.global_dynamics.fates import Fate
from verification.proofs.global_dynamics.returns import every_return
from verification.proofs.starts.below_star import ANGLE, NEXT, BelowStar
from verification.proofs.starts.core import Core
from verification.proofs.starts.mean import HIGH, LOW, MULTIPLIER, RATE, average

NEAR_ONE = ("0.7", "0.8", "0.9", "0.95", "0.99")
ABOVE = ("0.0935", "0.1", "0.15", "0.25", "0.4", "0.6", "0.8", "0.95")
ONE_PIECE = "that what attracts has one dense orbit is not shown"


def unstable() -> Finding:
    """Every orbit that misses the joins is unstable, for every contraction from 1/10 to 1."""
    return by(
        f"for {LOWEST} <= lam <= {HIGHEST} each return to the arc, in at most two bounces, multiplies a form of beams "
        "that "
        "is positive in a cone by a number above 1 that depends on lam alone; for 16/27 < lam < 1 their widths grow; "
        "so "
        "every orbit that misses the joins stretches at an exponential rate, and no cycle off the joins attracts",
        every_return(),
        splits(),
    )


def attracted() -> Finding:
    """What attracts every orbit is compact and connected, and its orbits that miss the joins are unstable."""
    return by(
        "the map is continuous and takes the strip abs(phi) <= lam*pi/2 into itself; what its images have in common "
        "is "
        "compact and connected, attracts every orbit and holds the unstable orbit of period 2",
        unstable(),
    )


def one_set(lams: tuple[str, ...]) -> str:
    """What random starts reach, in words."""
    each = [found("cuspless", x) for x in lams]
    single = all(len(some) == len(chaotic(some)) == 1 and not unsettled(some) for some in each)
    least = min(a.nu_plus for some in each for a in some)
    reached = f"reach one and the same chaotic set, nu_+ >= {least:.2f}" if single else "do not all reach one set"
    return f"sampled, {STARTS} starts at each of lam = {', '.join(lams)} {reached}"


def one_attractor(lams: tuple[str, ...]) -> Judgement:
    """Chaos attracts every orbit, proved; that it is one attractor, as "a globally attracting" one has to be, sampled.

    Two chaotic attractors would be in the compact set too, and neither would attract globally.
    """
    seen = one_set(lams)
    return sampled(
        f"proved for every {LOWEST} <= lam < 1: a compact, connected set attracts every orbit, and each that misses "
        f"the joins is unstable, near lam = 1 at a rate of at least {least_rate()}; {ONE_PIECE}",
        f"proved for {LOWEST} <= lam < 1: nothing but chaos attracts off the joins; {seen}; a share below "
        f"{3 / STARTS:.0%} of others is not excluded",
        "one and the same" in seen and bool(attracted()),
    )


@judges("cuspless.global_near_one")
def global_near_one(claim: Claim) -> Judgement:
    """Near 1: a compact set whose orbits off the joins are unstable attracts every orbit; one attractor is sampled."""
    return one_attractor(NEAR_ONE)


@judges("cuspless.chaotic_above_tenth")
def above_tenth(claim: Claim) -> Judgement:
    """From 1/10 on, for every contraction below 1, likewise."""
    return one_attractor(ABOVE)


@judges("cuspless.only_attractor")
def only_attractor(claim: Claim) -> Judgement:
    """No cycle off the joins attracts from 1/10 on; that chaos has one attractor is sampled."""
    said = (
        f"proved for {LOWEST} <= lam < 1: every orbit that misses the joins is unstable, so no cycle off the joins "
        f"attracts; {one_set(ABOVE)}; a share below {3 / STARTS:.0%} of others is not excluded"
    )
    return sampled(
        "one chaotic attractor, from lambda_c = 0.0934... on, for lam < 1; that no cycle attracts beside it is proved "
        f"from lam = {LOWEST} on",
        said,
        "one and the same" in said and bool(unstable()),
    )


@cache
def below() -> BelowStar:
    """What leaves the upper join at small angles below `lambda*`: three graphs of boxes, and the corners from there on.

    The cores are about the horizontal orbit; those of graphs are small, the last one comes near to the joins.
    """
    cuts, grids = (NEAR_ZERO, Fraction("0.06"), NEXT), ((2048, 128), (4096, 256))
    graphs = (Fate(Scene("cuspless"), x, g, 8, (HORIZONTAL,)) for x, g in zip(pairwise(cuts), grids, strict=True))
    small = Core(1, 0.056, -0.0202, 0.0025, 0.06, 0.2, 200), Core(1, 0.0649, -0.0227, 0.002, 0.06, 0.2, 200)
    wide = Core(1, 0.0702, -0.0241, 0.0012, 0.05, 0.41, 410, ((0.405, 0.003), (0.4, 0.006), (0.38, 0.012)))
    return BelowStar(((near_zero(), None), *zip(graphs, small, strict=True)), wide)


@judges("cuspless.below_star_converges")
def below_star(claim: Claim) -> Judgement:
    """From the join, at angles near 0, for every contraction below `lambda_star`."""
    return Judgement(
        by(
            f"for every 0 <= lam < lambda* and every exit angle up to {ANGLE}",
            answer(
                below().proved,
                f"up to {NEXT} walks of boxes from the upper join end about the horizontal orbit alone; from there to "
                "lambda* half a return next to the corners moves the landing on, along the wall, by a factor and by a "
                "positive number, until it is in a set all of which converges to the horizontal orbit",
            ),
            attracting_below(),
        ),
        f"each trajectory from the upper join with an exit angle of at most {ANGLE} converges to the horizontal orbit, "
        "for every 0 <= lam < lambda*",
    )


@judges("cuspless.chaotic_above_star")
def chaotic_above_star(claim: Claim) -> Judgement:
    """By a polygon up to 1/10 and by the form of beams from there on; that it is one and the same is not claimed."""
    return Judgement(
        by("from lambda* to 1/10, and from there to 1", chaos(), attracted()),
        f"for lambda* < lam <= {PROVED_TO} an open set of angles at the join leads to a chaotic attractor next to the "
        f"corner orbit; for {LOWEST} <= lam < 1 every orbit is attracted by a compact set, and each that misses the "
        f"joins is unstable; {ONE_PIECE}; at lam = 1, which is taken not to be meant, areas are kept",
    )


@judges("cuspless.nu_crosses_zero")
def crosses_zero(claim: Claim) -> Judgement:
    """Nearly all starts are proved to end on period 2 when the chaotic attractor appears."""
    found, born = average(), real_ball(value("lambda-star"), 20)
    first, last = (arb(end.numerator) / end.denominator for end in (LOW, HIGH))
    settled = all(found.checks.values())
    negative = answer(
        settled and found.mean < 0 and bool(first < born) and bool(born < last),
        f"for every lam from {float(LOW)} to {float(HIGH)} at most {found.share:.3f} of the starts are not proved to "
        f"end on period 2, where nu_+ < log({MULTIPLIER})/2, and nu_+ < {float(RATE)} of every orbit: the mean is at "
        f"most {found.mean:.4f}, of starts uniform in the table, the first bounce elastic or not, or uniform in s and "
        "sin(phi)",
    )
    argument = "lambda* = 0.07122 lies inside a range of contractions at each of which the average is negative"
    changes = f"it changes its sign between {float(HIGH)} and {LOWEST}"
    return Judgement(
        counterexample(argument, negative, certified("lambda-star")),
        f"the average is negative for {float(LOW)} <= lam <= {float(HIGH)}, lambda* among them, and positive at lam = "
        f"{LOWEST}: {changes}, not where the attractor appears",
        by("negative by the shares of the basins, positive since every orbit is unstable", negative, unstable()),
        "nu_+ does not cross 0 when the chaotic attractor appears: next to lambda* nearly all starts end on period 2, "
        f"so that the average over starts is negative; {changes}.",
    )


@judges("cuspless.accumulates_on_joins")
def accumulates(claim: Claim) -> Judgement:
    """A curve along the cone that no point leaves onto a join would grow beyond all bounds."""
    return Judgement(
        by(
            "a curve along the cone that never meets a join lies on one component at each bounce, where its length is "
            "bounded, and grows at every return; so after finitely many bounces some point lands on a join, and its "
            "neighbours near it. Hence starts that come as near to a join as wanted, as late as wanted, are open and "
            "dense, and those that do so again and again are dense (Baire): among all starts that miss the joins for "
            f"{LOWEST} <= lam < 1, in the trapping polygon for lambda* < lam <= {PROVED_TO}",
            chaos(),
            unstable(),
        ),
        "generic orbits, a countable intersection of open dense sets of starts, come arbitrarily near the joins again "
        f"and again: of all starts for {LOWEST} <= lam < 1, of those in the polygon for lambda* < lam < {LOWEST}",
    )
