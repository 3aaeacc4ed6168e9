"""Judges of claims on basins of attraction, and on the absence of cycles of short periods.

The basin of an attracting cycle is open, so two such basins cannot be intermingled at every point. Pictures show a
fractal boundary, whose dimension is measured. Paper: sections 5.2, 5.4, 6.2, 6.4, 6.7 and 7.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import tau

from sympy import Expr, Rational

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor
from numeric.dynamics.basins import Uncertainty, uncertainty
from numeric.dynamics.phase_points import phase_points
from symbolic.cycles.cycle import cuspless_horizontal, cuspless_vertical, is_double_normal
from symbolic.cycles.polygons import near_flat, saddle_node
from symbolic.expressions.signs import SignFinding
from symbolic.tables import egg
from symbolic.tables.scene import Scene
from symbolic.tables.table import alpha, lam
from verification.arithmetic.iteration import telling
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, greater, judges, sampled, shown
from verification.paper.judges.attractors import SHAPE, found
from verification.paper.judges.cuspless import attracting_below
from verification.proofs.global_dynamics.common_boundary import CommonBoundary, entered_around
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.periodic.triangles import PRODUCED, SLAP, no_triangles, witness
from verification.proofs.slap_map.exponent import PeriodicPoints, periodic_points
from verification.proofs.starts.alternating import Alternating
from verification.proofs.starts.core import AbsorbingTube
from verification.proofs.starts.division import Division, ExpandingAnnulus

SEED = 1
PAIRS = 4000
EARLY = 400  # bounces before an orbit's attractor is determined


def scene(name: str, contraction: str) -> tuple[PinballMap, tuple[Attractor, ...]]:
    """The map of a table at a contraction, and its attractors."""
    if name == "egg":
        return PinballMap("egg", lam=contraction, alpha=SHAPE), found("egg", contraction, alpha=SHAPE)
    return PinballMap(name, lam=contraction), found(name, contraction)


@cache
def boundary(name: str, contraction: str, distances: tuple[float, ...]) -> Uncertainty:
    """The uncertainty exponent of the basin boundary over a range of distances."""
    map, attractors = scene(name, contraction)
    return uncertainty(map, attractors, PAIRS, SEED, distances=distances, transient=EARLY)


def told(law: Uncertainty) -> str:
    """The dimension of the basin boundary with its error, and the range of distances, as text."""
    return f"{law.dimension:.3f} +- {law.error:.3f} for eps from {law.largest:g} to {law.smallest:g}"


@cache
def division() -> Division:
    """The theorem's data at `lam = 9/100`: a tube around period 2, and an annulus around an unstable 4-cycle."""
    entries = (0.14, 0.006), (0.1, 0.01)
    tube = AbsorbingTube(1, 0.0885142, -0.0312524, 1e-4, inner=0.04, outer=0.15, cells=1600, entry_tubes=entries)
    annulus = ExpandingAnnulus(0.1395, 0.216, slope=0.08551, offset=0.000347, width=6e-4, cone=0.003, growth=1.001)
    return Division(Scene("cuspless"), (Fraction(9, 100),) * 2, (8192, 1024), 8, tube, annulus, rate=0.16)


def alternating() -> Alternating:
    """The theorem that strips of both basins alternate next to the stable manifold of the vertical orbit."""
    return Alternating(Fraction(9, 100), division().tube)


@judges("cuspless.basins_intermingled")
def cuspless_intermingled(claim: Claim) -> Judgement:
    """Strips of both basins are proved to alternate next to the whole stable manifold of a saddle."""
    found = alternating()
    return Judgement(
        by(
            "the inclination lemma, for the vertical orbit of period 2",
            answer(
                found.proved,
                "it is a saddle; of the orbits along its unstable manifold one is proved to enter a set that converges "
                "to the horizontal orbit, and one the trapping polygon of the chaotic attractor",
            ),
            attracting_below(),
        ),
        "next to the stable manifold of the vertical orbit: on each smooth curve across it infinitely many intervals, "
        "of the one basin and of the other in turn, come to the point of crossing (where its orbit misses the joins). "
        "Both basins are open, so at no point of either are they; of other points nothing is proved, and by samples "
        "the strips shrink by the orbit's multiplier and are no Cantor set",
    )


@judges("cuspless.two_basins")
def two_basins(claim: Claim) -> Judgement:
    """Almost every start is in one of two basins; it is not proved that the chaotic set is one attractor."""
    found = division()
    rate = f"each orbit that misses the joins has nu_+ >= {found.rate}"
    return Judgement(
        by(
            "boxes of all of phase space, and two bounces over a ring where boxes do not see orbits drift",
            answer(
                found.proved,
                "almost every orbit converges to the period-2 orbit, or ends in a trapping region apart, where "
                f"{rate}; what stays near the unstable orbits of period 4 and the vertical one has no area",
            ),
        ),
        "proved of almost every start: it is attracted to the period-2 orbit, or by what a trapping region keeps, "
        f"where {rate}: chaos, in one attractor or several; what does neither has no area, as the vertical orbit",
    )


def beyond_the_crisis() -> CommonBoundary:
    """The theorem that, at 0.7, orbits lead from the saddle triangle near the vertices to both attracting triangles."""
    sink, saddle = (1.16897116, 0.43119899), replace(TRIANGLE, start=(-0.14235898,))
    sinks, turns = (sink, (-sink[0], -sink[1])), (Fraction(1, 3), Fraction(2, 3))
    starts = 0.9, 0.21125  # middles of pieces of the branch that were sampled to end on one triangle
    return CommonBoundary(Scene("egg", alpha=SHAPE), Fraction(7, 10), saddle, 1, starts, sinks, turns)


NEARLY_ALL = 1.9  # the least dimension that counts as near 2
MIDDLE = (Fraction(0), Fraction(1, 50)), (Fraction(0), Fraction(1, 20))  # between the triangles, one for each basin


@cache
def common() -> tuple[SignFinding, SignFinding]:
    """The findings that both basins contain open discs, and that both have a stable manifold in their boundary."""
    found = beyond_the_crisis()
    checks = found.checks
    cycles = answer(bool(checks["discs"] and checks["apart"]), "two cycles attract a disc each, apart from the other")
    inner = [entered_around(found, k, *point) for k, point in enumerate(MIDDLE)]
    said = ", ".join(f"all starts near theta = {x}, phi = {y}" for x, y in MIDDLE)
    open_ = answer(all(inner), f"{said} go to one triangle each")
    proof = "of the orbits along one branch of its unstable manifold, one is proved to go to each attracting triangle"
    return by("both basins are open", cycles, open_), by("the inclination lemma", answer(found.proved, proof))


@judges("egg.basins_intermingled")
def egg_intermingled(claim: Claim) -> Judgement:
    """A sample gives a boundary dimension near 2; both basins are proved to accumulate at a stable manifold.

    Basins of attracting cycles are open, so neither is dense in a disc of the other, whatever a sample may suggest.
    """
    law = boundary("egg", "0.7", (1e-3, 1e-5, 1e-7))
    open_, both = common()
    return sampled(
        f"sampled, the boundary between the basins has the dimension {told(law)}, near that of the plane. Proved: "
        "each neighbourhood of each point of the stable manifold of the triangle of "
        "the vertices holds open sets of both basins; and both are open, so that smaller discs of one basin alone lie "
        "between them",
        f"dimension {told(law)}; proved: {both.reason}; {open_.reason}",
        bool(open_) and bool(both) and law.dimension > NEARLY_ALL,
    )


EXACT_SHAPE = Rational(2, 25)
BELOW = Rational(378, 1000)  # just below lambda_c(0.08) = 0.37812...


@cache
def without_triangles(shape: Expr, most: Expr) -> SignFinding:
    """The finding that no cycle of period 3 exists for `0 <= lam <= most`, proved by interval exclusion."""
    found = no_triangles(shape, most, tick=telling(f"triangles excluded at alpha = {shape}"))
    if not found.proved:
        return answer(None, f"{found.share:.0%} of the triangles excluded")
    return answer(found.proved, f"no period 3 at alpha = {shape} for lam <= {most}: {found.boxes} boxes excluded")


@judges("egg.slap_no_period3")
def slap_no_period3(claim: Claim) -> Judgement:
    """There is no cycle of period 3 at either of the two shapes in the figure."""
    findings = without_triangles(Rational(1, 20), Rational(1, 16)), without_triangles(EXACT_SHAPE, BELOW)
    return Judgement(
        by("exclusion of every triangle", *findings), "none for alpha = 0.05 and 0.08, and lam up to 0.378 at 0.08"
    )


def triangle_at(contraction: Rational) -> SignFinding:
    """The finding that a cycle of period 3 attracts at `alpha = 0.08`, proved by interval Newton."""
    bounce = float(near_flat().subs({alpha: EXACT_SHAPE, lam: contraction}))
    near = phase_points([bounce + k * tau / 3 for k in range(3)], 0.0)
    proof = certificate(egg(3).at(alpha=EXACT_SHAPE), contraction, near)
    return answer(proof.proved, f"an attracting cycle of period 3 is proved at lam = {contraction}")


@judges("egg.no_period3_caption")
def no_period3_caption(claim: Claim) -> Judgement:
    """The printed limit 0.4 is too large: cycles of period 3 are born below it."""
    fold = saddle_node().subs(alpha, EXACT_SHAPE)
    return Judgement(
        counterexample(
            "a triangle at lam = 0.39; equilateral ones exist for every lam >= lambda_c(0.08) = 0.37812...",
            triangle_at(Rational(39, 100)),
            at={lam: Rational(39, 100)},
        ),
        "no orbit of period 3 for lam <= 0.378; two pairs of equilateral ones for lam > 0.37812...",
        by("every triangle is excluded up to 0.378", without_triangles(EXACT_SHAPE, BELOW), greater(fold, BELOW)),
        "The limit 0.4 should read 0.378: at alpha = 0.08 orbits of period 3 exist for every lambda >= 0.37812... .",
        value=fold,
    )


@judges("egg.projection_misses")
def projection_misses(claim: Claim) -> Judgement:
    """Two counterexamples: orbits that return after three bounces to their first position, but at another angle."""
    free, produced = witness(EXACT_SHAPE, Rational(0), *SLAP), witness(EXACT_SHAPE, Rational(3, 10), *PRODUCED)
    proved = bool(free.exists and produced.exists and produced.produced)
    met = answer(proved, "both orbits proved by interval Newton")
    return Judgement(
        counterexample(
            "at lam = 0 with a free first angle, and at lam = 3/10 with an angle that a collision can produce, "
            "an orbit is back at its first position after three bounces",
            met,
            at={lam: Rational(3, 10)},
        ),
        "the projected graph meets the diagonal at lam = 0 and at lam = 0.3; there is no period 3 up "
        "to 0.378 all the same",
        by("every triangle is excluded up to 0.378", without_triangles(EXACT_SHAPE, BELOW)),
        "The graph over all initial angles does meet the diagonal below lambda_c, so the argument as stated proves "
        "nothing there; its conclusion (no period 3) holds, up to 0.378 and not 0.39.",
    )


@cache
def points_of_period_4() -> PeriodicPoints:
    """Intervals that hold all fixed points of the fourth iterate of the cuspless slap map."""
    return periodic_points(4, tick=telling("boundary followed"))


@judges("cuspless.slap_no_period4")
def slap_no_period4(claim: Claim) -> Judgement:
    """Fixed points of `T0^4` lie in four intervals, at most one in each; these are the points of the two 2-cycles."""
    found = points_of_period_4()
    known = [cuspless_horizontal(), cuspless_vertical()]
    return Judgement(
        by(
            "the two period-2 orbits are four solutions of T0^4(x) = x, and there are no more",
            answer(
                found.stretches is not None and len(found.stretches) == 4,
                f"T0^4(x) = x has at most four solutions ({found.boxes} boxes)",
            ),
            shown("both orbits are normal to the boundary at both ends", all(is_double_normal(c) for c in known)),
            shown("their four ends are different points", len({end for c in known for end in c.bounces}) == 4),
        ),
        "the points of the horizontal and the vertical orbit, and no other",
    )
