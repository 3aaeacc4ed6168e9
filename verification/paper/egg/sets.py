"""Claims that something exists nowhere, settled by exclusion over sets. Paper: sections 5.4, 6.2 and 6.4."""

from functools import cache
from math import tau

from sympy import Expr, Rational

from numeric.dynamics.phase_points import phase_points
from symbolic.cycles.cycle import cuspless_horizontal, cuspless_vertical, is_double_normal
from symbolic.cycles.polygons import near_flat, saddle_node
from symbolic.expressions.signs import Finding
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam
from verification.arithmetic.progress import telling
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, greater, judges, shown
from verification.proofs.periodic.triangles import PRODUCED, SLAP, no_triangles, witness
from verification.proofs.slap_map.periodic_points import PeriodicPoints, periodic_points

SHAPE = Rational(2, 25)
BELOW = Rational(378, 1000)  # just below lambda_c(0.08) = 0.37812...


@cache
def without_triangles(shape: Expr, most: Expr) -> Finding:
    """No cycle of period 3 for `0 <= lam <= most`, by interval exclusion."""
    found = no_triangles(shape, most, tick=telling(f"triangles excluded at alpha = {shape}"))
    if not found.excluded:
        return answer(None, f"{found.share:.0%} of the triangles excluded")
    return answer(found.excluded, f"no period 3 at alpha = {shape} for lam <= {most}: {found.boxes} boxes excluded")


@judges("egg.slap_no_period3")
def slap_no_period3(claim: Claim) -> Judgement:
    """At both shapes of the figure."""
    findings = without_triangles(Rational(1, 20), Rational(1, 16)), without_triangles(SHAPE, BELOW)
    return Judgement(
        by("exclusion of every triangle", *findings), "none for alpha = 0.05 and 0.08, and lam up to 0.378 at 0.08"
    )


def triangle_at(contraction: Rational) -> Finding:
    """A cycle of period 3 at `alpha = 0.08`, by interval Newton."""
    bounce = float(near_flat().subs({alpha: SHAPE, lam: contraction}))
    near = phase_points(0, [bounce + k * tau / 3 for k in range(3)], 0.0)
    proof = certificate(egg(3).at(alpha=SHAPE), contraction, near)
    return answer(proof.proved, f"an attracting cycle of period 3 is proved at lam = {contraction}")


@judges("egg.no_period3_caption")
def no_period3_caption(claim: Claim) -> Judgement:
    """The fold lies below 0.4."""
    fold = saddle_node().subs(alpha, SHAPE)
    return Judgement(
        counterexample(
            "a triangle at lam = 0.39; equilateral ones exist for every lam >= lambda_c(0.08) = 0.37812...",
            triangle_at(Rational(39, 100)),
            at={lam: Rational(39, 100)},
        ),
        "no orbit of period 3 for lam <= 0.378; two pairs of equilateral ones for lam > 0.37812...",
        by("every triangle is excluded up to 0.378", without_triangles(SHAPE, BELOW), greater(fold, BELOW)),
        "The limit 0.4 should read 0.378: at alpha = 0.08 orbits of period 3 exist for every lambda >= 0.37812... .",
        value=fold,
    )


@judges("egg.projection_misses")
def projection_misses(claim: Claim) -> Judgement:
    """Witnesses: orbits that come back to their first position after three bounces."""
    free, produced = witness(SHAPE, Rational(0), *SLAP), witness(SHAPE, Rational(3, 10), *PRODUCED)
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
        by("every triangle is excluded up to 0.378", without_triangles(SHAPE, BELOW)),
        "The graph over all initial angles does meet the diagonal below lambda_c, so the argument as stated proves "
        "nothing there; its conclusion (no period 3) holds, up to 0.378 and not 0.39.",
    )


@cache
def points_of_period_4() -> PeriodicPoints:
    """Where the fourth iterate of the cuspless slap map may return."""
    return periodic_points(4, tick=telling("boundary followed"))


@judges("cuspless.slap_no_period4")
def slap_no_period4(claim: Claim) -> Judgement:
    """Four stretches hold at most one point each of period dividing 4, and the two orbits of period 2 take them."""
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
