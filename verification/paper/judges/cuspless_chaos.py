"""Judges of claims on the chaos of the cuspless cardioid, from `lambda*` to 1. Paper: section 5.

A *chaotic attractor* is defined in the report (`senses` of its `paper.toml`). `symbolic.cycles.returns` and `splitting`
prove for every `1/10 <= lam < 1` that each return to the arc stretches the beams in a cone, so that every orbit which
misses the joins is unstable; a trapping polygon proves chaos from `lambda*` to 1/10. It is not proved that the
attractor has a dense orbit, that it is unique, or that it attracts globally.
"""

from fractions import Fraction
from functools import cache
from itertools import pairwise

from flint import arb

from symbolic.cycles.returns import HIGHEST, LOWEST
from symbolic.cycles.splitting import least_rate, splits
from symbolic.expressions.signs import SignFinding
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import real_ball
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled
from verification.paper.judges.attractors import (
    NEAR_ZERO,
    STARTS,
    chaotic,
    found,
    near_zero,
    unsettled,
)
from verification.paper.judges.cuspless import attracting_below
from verification.paper.judges.hyperbolicity import PROVED_TO, chaos
from verification.paper.judges.located import certified, settled, value
from verification.proofs.global_dynamics.fates import AlmostEveryOrbit
from verification.proofs.global_dynamics.returns import every_return
from verification.proofs.starts.below_star import (
    ANGLE,
    HORIZONTAL,
    NEXT,
    TOP,
    AlmostEveryOrbitBelowLambdaStar,
    AlmostEveryOrbitBesideLambdaStar,
    ConvergenceBelowLambdaStar,
)
from verification.proofs.starts.core import AbsorbingTube
from verification.proofs.starts.mean import HIGH, LOW, MULTIPLIER, RATE, average

NEAR_ONE = ("0.7", "0.8", "0.9", "0.95", "0.99")
ABOVE = ("0.0935", "0.1", "0.15", "0.25", "0.4", "0.6", "0.8", "0.95")
ONE_PIECE = "that what attracts has one dense orbit is not shown"


def unstable() -> SignFinding:
    """The finding that every orbit that misses the joins is unstable, for every contraction from 1/10 to 1."""
    return by(
        f"for {LOWEST} <= lam <= {HIGHEST} each return to the arc, in at most two bounces, multiplies a form of beams "
        "that "
        "is positive in a cone by a number above 1 that depends on lam alone; for 16/27 < lam < 1 their widths grow; "
        "so "
        "every orbit that misses the joins stretches at an exponential rate, and no cycle off the joins attracts",
        every_return(),
        splits(),
    )


def attracted() -> SignFinding:
    """The finding that a compact connected set attracts every orbit, and its orbits off the joins are unstable."""
    return by(
        "the map is continuous and takes the strip abs(phi) <= lam*pi/2 into itself; what its images have in common "
        "is "
        "compact and connected, attracts every orbit and holds the unstable orbit of period 2",
        unstable(),
    )


def one_set(lams: tuple[str, ...]) -> str:
    """A sentence on the attractors that random starts reach at some contractions."""
    each = [found("cuspless", x) for x in lams]
    single = all(len(some) == len(chaotic(some)) == 1 and not unsettled(some) for some in each)
    least = min(a.nu_plus for some in each for a in some)
    reached = f"reach one and the same chaotic set, nu_+ >= {least:.2f}" if single else "do not all reach one set"
    return f"sampled, {STARTS} starts at each of lam = {', '.join(lams)} {reached}"


def one_attractor(lams: tuple[str, ...]) -> Judgement:
    """It is proved that a chaotic set attracts every orbit; that it is a single attractor is only sampled.

    If there were two chaotic attractors, both would lie in this set, and neither would attract every orbit.
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
    """Near 1, a compact set of orbits that are unstable off the joins attracts all; samples show one attractor."""
    return one_attractor(NEAR_ONE)


@judges("cuspless.chaotic_above_tenth")
def above_tenth(claim: Claim) -> Judgement:
    """From 1/10 to 1 a chaotic set is proved to attract every orbit; that it is one attractor is sampled."""
    return one_attractor(ABOVE)


@judges("cuspless.only_attractor")
def only_attractor(claim: Claim) -> Judgement:
    """No cycle off the joins attracts for `lam >= 1/10`; that there is one chaotic attractor is only sampled."""
    said = (
        f"proved for {LOWEST} <= lam < 1: every orbit that misses the joins is unstable, so no cycle off the joins "
        f"attracts; {one_set(ABOVE)}; a share below {3 / STARTS:.0%} of others is not excluded"
    )
    return sampled(
        f"no cycle that misses the joins attracts for {LOWEST} <= lam < 1: proved; that there is one chaotic "
        f"attractor, and that nothing else attracts from lambda_c = 0.0934... to {LOWEST}, is not shown",
        said,
        "one and the same" in said and bool(unstable()),
    )


@cache
def almost_every() -> AlmostEveryOrbitBelowLambdaStar:
    """The theorem that almost every orbit below `lambda*` converges, proved with three graphs of boxes."""
    scene = Scene("cuspless")
    middle = AlmostEveryOrbit(scene, (NEAR_ZERO, NEXT), (4096, 512), 8, (HORIZONTAL,), 30)
    last = AlmostEveryOrbitBesideLambdaStar(scene, (NEXT, TOP), (4096, 512), 8, (HORIZONTAL,), 60)
    return AlmostEveryOrbitBelowLambdaStar((near_zero(), middle, last))


@judges("cuspless.lambda_star_caption")
def alone_below_star(claim: Claim) -> Judgement:
    """Judges the printed digits of `lambda*`, and that almost every orbit below it ends on the horizontal orbit."""
    digits = settled(claim, "lambda-star")
    return Judgement(
        by(
            "for every 0 <= lam < lambda* almost every orbit converges to the horizontal one of period 2",
            digits.printed,
            answer(
                almost_every().proved,
                "every orbit ends in boxes about it, where the map contracts, or about the vertical one, where it "
                "stretches, so that those which stay have no area; none stays beside the corner orbit, where half a "
                "return moves landings along the wall, away from the corner. At lam = 0, where the map has no inverse, "
                "those which stay have no length on any line of one exit angle, and each flight moves the landing at "
                "a speed above 0",
            ),
            splits(),
            attracting_below(),
        ),
        f"lambda* = {digits.derived}; almost every start ends on the horizontal orbit, for every 0 <= lam < lambda*",
        value=digits.value,
    )


@judges("cuspless.lambda_star_body")
def persists_above_star(claim: Claim) -> Judgement:
    """Judges the printed digits; above `lambda*` a chaotic attractor coexists with the attracting period-2 orbit."""
    digits = settled(claim, "lambda-star")
    return Judgement(
        by("from lambda* on, while the orbit of period 2 attracts", digits.printed, chaos(), attracting_below()),
        f"lambda* = {digits.derived}; for every lambda* < lam < lambda_c there are a chaotic attractor and the orbit "
        "of period 2, which attracts",
        value=digits.value,
    )


@cache
def below() -> ConvergenceBelowLambdaStar:
    """The theorem on orbits from the upper join at small angles below `lambda*`.

    Its tubes surround the horizontal orbit; tubes for the graphs are small, the last tube almost reaches the joins.
    """
    cuts, grids = (NEAR_ZERO, Fraction("0.06"), NEXT), ((2048, 128), (4096, 256))
    parts, scene = zip(pairwise(cuts), grids, strict=True), Scene("cuspless")
    graphs = (AlmostEveryOrbit(scene, lam, grid, 8, (HORIZONTAL,)) for lam, grid in parts)
    small = (0.056, -0.0202, 0.0025, 0.06, 0.2, 200), (0.0649, -0.0227, 0.002, 0.06, 0.2, 200)
    wide = AbsorbingTube(1, 0.0702, -0.0241, 0.0012, 0.05, 0.41, 410, ((0.405, 0.003), (0.4, 0.006), (0.38, 0.012)))
    pairs = zip(graphs, (AbsorbingTube(1, *one) for one in small), strict=True)
    return ConvergenceBelowLambdaStar(((near_zero(), None), *pairs), wide)


@judges("cuspless.below_star_converges")
def below_star(claim: Claim) -> Judgement:
    """Orbits from the join at small angles converge to the horizontal orbit, for every contraction below `lambda*`."""
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
    """Chaos is proved for `lam` up to 1/10 by a polygon and above by a cone of beams; one attractor is not proved."""
    return Judgement(
        by(
            "from lambda* to 1/10, and from there to 1, almost every start of an open set stretches, and "
            "converges to no "
            "cycle: of two points of a short curve along the cone that stay near a cycle, all points between them stay "
            "there, since the map is continuous and images are monotone in s, and that piece would grow for ever; so "
            "each such curve has one point at most that stays, and those of all curves have no area",
            chaos(),
            attracted(),
        ),
        f"for lambda* < lam <= {PROVED_TO} an open set of angles at the join leads to a chaotic attractor next to the "
        f"corner orbit; for {LOWEST} <= lam < 1 every orbit is attracted by a compact set, and each that misses the "
        f"joins is unstable; {ONE_PIECE}; at lam = 1, which is taken not to be meant, areas are kept",
    )


@judges("cuspless.nu_crosses_zero")
def crosses_zero(claim: Claim) -> Judgement:
    """The mean exponent is negative at `lambda*`, where nearly all starts are proved to end on period 2."""
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
    """Orbits accumulate at the joins: a curve along the cone that never lands there would grow without bound."""
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
