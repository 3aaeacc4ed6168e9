"""Judges of claims on the egg's basins near the boundary crisis, and on attractors beyond it. Paper: section 6.7.

At `lam = 0.66` a curve around phase space, a *barrier* above `phi = 0`, is mapped strictly below itself: no orbit that
starts below it reaches the attracting triangle with `phi > 0`. With its mirror image it encloses a trapping region. At
0.6623 an orbit crosses from below to above. Beyond the crisis there are windows in which other cycles attract.

The barriers do not prove that the region holds one chaotic attractor, nor that this attractor vanishes when the
barriers break: an attractor with a smaller basin may remain.
"""

from fractions import Fraction
from functools import cache

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.phase_points import PhasePoints, phase_points
from symbolic import tables
from symbolic.expressions.signs import SignFinding
from symbolic.tables.scene import Scene
from symbolic.tables.table import lam
from verification.arithmetic.balls import balls, working
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled
from verification.paper.judges.attractors import SHAPE, chaotic, cycles, egg, proved_at, unsettled
from verification.proofs.global_dynamics.barrier import Barrier, BarrierBreaks
from verification.proofs.global_dynamics.crisis import bounding_boxes
from verification.proofs.manifolds.known import table
from verification.rigorous.boxes import Boxes

AT, LOST, GONE = "0.66", "0.6623", "0.7"  # contractions with barriers, without, and without an attractor between
SINK, CROSSES = (-3.0003, 0.4175), 0.7251  # near the upper triangle; on `phi = 0`, the start of a crossing orbit
WINDOW, STAYS = "0.6718", (-2.32324864, 0.26943288)  # in a window of a cycle of 10 bounces; a point near it
LONG, BITS = 10, 160


@cache
def barrier(contraction: str = AT) -> Barrier:
    """The barrier at one contraction: a curve above `phi = 0` that the map sends strictly below itself."""
    return Barrier(Scene("egg", alpha=SHAPE), (Fraction(contraction), Fraction(contraction)))


@cache
def triangles(contraction: str = AT) -> SignFinding:
    """The finding on two attracting triangles, mirror images: one is above the barrier, one below its mirror image."""
    found, divides, sides = cycles(egg(contraction), 3), barrier(contraction), []
    for cycle in found:
        place = bounces(contraction, cycle.points)
        sides.append([bool(np.all(divides.above(box))) for box in (place, place.mirrored())] if place else [False] * 2)
    return by(
        "two cycles of period 3 attract what is close to them",
        proved_at(contraction, 3),
        answer(sorted(sides) == [[False, True], [True, False]], "one above the barrier, one below its mirror image"),
    )


def bounces(contraction: str, near: PhasePoints) -> Boxes | None:
    """The bounces of the cycle near the points `near`, as boxes; None if the cycle is not proved."""
    shape = Rational(SHAPE)
    proof = certificate(tables.egg(3).at(alpha=SHAPE), Rational(contraction), near)
    if not proof.proved:
        return None
    with working(BITS):
        angle = table(shape).over(balls(BITS)).angle
        ends = zip(proof.theta, (*proof.theta[1:], proof.theta[0]), strict=True)
        return bounding_boxes([(here, angle(here, there)[0]) for here, there in ends])


@cache
def divided(contraction: str = AT) -> SignFinding:
    """The finding that no orbit crosses the barrier upwards, or its mirror image downwards."""
    divides = barrier(contraction)
    return by(
        f"at lam = {contraction} a curve above phi = 0, in {divides.columns * divides.turns} steps, is mapped strictly "
        "below itself, so that no orbit crosses it from below; its mirror image likewise from above; what lies between "
        "the two is trapped",
        answer(divides.heights is not None and divides.mirrored, "boxes along the curve"),
        triangles(contraction),
    )


@judges("egg.basins_above_below")
def above_below(claim: Claim) -> Judgement:
    """The basins lie beyond the barriers, and an attractor that is its own mirror image lies between them.

    Such an attractor has a dense orbit with points below the upper barrier: the mirror image of a point above it is
    below the lower one. For the same reason it has points above the lower barrier. Orbits between the barriers stay
    there.
    """
    return Judgement(
        divided(),
        "the upper basin lies above a curve in phi > 0, the lower one below its mirror image, and all that lies "
        "between the two curves stays there, so that it reaches neither triangle. An attractor with a dense orbit that "
        "is its own mirror image, as the only chaotic one is, lies between; that there is one is not part of this",
    )


@judges("egg.basins_separate")
def separate(claim: Claim) -> Judgement:
    """The basins are proved disjoint; only samples show that the basin of one chaotic attractor lies between them."""
    attractors = egg(AT)
    inner = chaotic(attractors)
    shares = ", ".join(str(a.share.count) for a in attractors if a.share)
    return sampled(
        "no orbit goes from between two curves to a triangle, nor from one basin to the other: proved; that what lies "
        "between is the basin of one chaotic attractor is sampled",
        f"proved: {divided().reason}; sampled: of random starts {shares} reach one chaotic attractor and the triangles",
        bool(divided()) and len(inner) == 1 and len(attractors) == 3 and unsettled(attractors) == 0,
    )


@cache
def barrier_ends() -> SignFinding:
    """The finding that the barrier between `phi = 0` and the triangles breaks between two given contractions."""
    breaks = BarrierBreaks(barrier(), Fraction(LOST), SINK, CROSSES)
    return by(
        f"a first contraction above {AT}, and not above {LOST}, has no barrier between phi = 0 and the upper triangle",
        divided(),
        answer(breaks.proved, f"at {LOST} an orbit from phi = 0 enters trapped boxes about that triangle"),
    )


@judges("egg.another_crisis")
def another_crisis(claim: Claim) -> Judgement:
    """The barrier between `phi = 0` and the triangles exists at 0.66, and is broken at 0.6623."""
    return Judgement(
        barrier_ends(),
        f"at {AT} a curve above phi = 0 is mapped below itself, so that no orbit from phi = 0 comes to a triangle; at "
        f"{LOST} one does. What is kept before is not shown to be one chaotic attractor",
    )


@judges("egg.crisis_below")
def crisis_below(claim: Claim) -> Judgement:
    """The barrier exists at 0.66 and is broken at 0.6623; only samples show that an attractor vanishes with it."""
    bracket = barrier_ends()
    before, after = (len(chaotic(egg(x))) for x in (AT, GONE))
    return sampled(
        f"what keeps orbits from phi = 0 from the triangles is lost at a contraction above {AT}, and not above {LOST}: "
        "proved, and the tangency at 0.66214 is there; that a chaotic attractor vanishes with it is sampled",
        f"proved: {bracket.reason}; sampled: random starts find {before} chaotic attractor at {AT}, {after} at {GONE}",
        bool(bracket) and before == 1 and after == 0,
    )


@cache
def window() -> SignFinding:
    """The finding that, beyond the crisis, another cycle attracts within the region between the former barriers."""
    map = PinballMap("egg", lam=WINDOW, alpha=SHAPE)
    orbit = map.orbit(*STAYS, 1000 + LONG)
    near = phase_points(orbit.theta[-LONG:], orbit.phi[-LONG:])
    place = bounces(WINDOW, near)
    return by(
        f"at lam = {WINDOW} a cycle of {LONG} bounces attracts, besides the two of period 3",
        answer(place is not None, f"{LONG} bounces, proved with their least period"),
        answer(place is not None and bool(np.all(barrier().between(place))), "between the barriers of lam = 0.66"),
        proved_at(WINDOW, 3),
    )


@judges("egg.after_crisis")
def beyond(claim: Claim) -> Judgement:
    """The word "all" is wrong even if read as "almost all": in each window, another cycle has an open basin."""
    others = window()
    return Judgement(
        counterexample("an open set of starts goes elsewhere", others, at={lam: Rational(WINDOW)}),
        f"not at every contraction beyond the crisis: at {WINDOW} cycles of 10 bounces attract too, one and its copies "
        f"turned by thirds, from inside the region that at {AT} no orbit leaves for a triangle; samples show more such "
        "windows, near 0.66346, 0.67738 and 0.69596",
        others,
        f"Beyond the crisis there are windows in which other cycles attract as well: at lambda = {WINDOW} cycles of "
        f"period 10, inside the region from which at {AT} no orbit reaches the period-3 orbits.",
    )
