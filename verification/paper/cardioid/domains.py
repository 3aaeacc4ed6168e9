"""Claims on where the map is defined, and whether that is compact. Paper: sections 2 and 5."""

from sympy import S, pi

from symbolic.tables import cardioid
from symbolic.tables.geometry import velocity
from symbolic.tables.table import lam, theta
from verification.paper.cardioid.cuspless import convex, joined_smoothly
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, greater, judges, zero


@judges("map.noncompact_domain")
def noncompact(claim: Claim) -> Judgement:
    """The cardioid: a ball from the rightmost point along the normal hits the cusp, its neighbours do not."""
    arc = cardioid.components[0]
    start, cusp = arc.at(0), arc.at(pi)
    return Judgement(
        by(
            "in the cardioid the point s = 0, phi = 0 is removed, since its trajectory along y = 0 lands on the cusp; "
            "from the same place no other direction leads there, so points as near to it as wanted are not removed, "
            "and the domain is not closed",
            zero("the cusp is at the pole, on the normal of s = 0", start[1], velocity(arc).subs(theta, 0)[0], *cusp),
            greater(start[0], S.Zero),
        ),
        "not compact where a trajectory can reach a corner",
    )


@judges("cuspless.noncompact")
def cuspless_noncompact(claim: Claim) -> Judgement:
    """The normal is unique at the joins, so nothing is removed there; the derivative alone does not exist."""
    return Judgement(
        counterexample(
            "the normal is unique at every point, joins included, so by the definition of section 2 no point is "
            "removed: phase space, the boundary times [-pi/2, pi/2], is compact",
            joined_smoothly(),
            at={lam: S.Half},
        ),
        "after one bounce every ball is in the compact set |phi| <= lam*pi/2, where the map is defined and continuous "
        "for lam < 1; what is not compact is the set where it has a derivative",
        by(
            "a convex table with a continuous tangent: exits off the tangent cross it and land transversally, so the "
            "landing depends continuously on the start",
            joined_smoothly(),
            convex(claim).printed,
        ),
        "The phase space of the cuspless cardioid is compact and the map is continuous on |phi| <= lambda*pi/2, into "
        "which it maps everything; it is the set of points with a derivative that is not compact, without those that "
        "land on a join.",
    )
