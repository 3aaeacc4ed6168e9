"""Claims of captions, judged from the data behind the figures. Paper: sections 6.4, 6.6 and 6.7."""

from functools import cache

import numpy as np
from sympy import Interval, Rational, Symbol, cos, diff

from numeric import PinballMap
from numeric.dynamics.attractors import find, wilson
from numeric.dynamics.basins import labels
from numeric.dynamics.phase_points import PhasePoints
from numeric.pinball.sampling import interior_starts, phase_starts
from symbolic import tables
from symbolic.cycles.polygons import required_tilt
from symbolic.expressions.signs import positive
from symbolic.tables.table import alpha, lam, theta
from verification.cycles.recurrence.cascade import FEIGENBAUM, doubled, next_critical
from verification.cycles.recurrence.problem import Problem
from verification.cycles.recurrence.recurrence import BifurcationKind
from verification.named.crises import changed_axis, stay
from verification.named.locate import certify
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, judges, zero
from verification.paper.shared.samples import sampled
from verification.proofs.periodic.bifurcation import Proof

SHAPE = Rational(2, 25)
SEED = 1
SIDE = {12: (0.3725, (-1.544175, -0.015589)), 8: (0.379, (-2.258379, -0.040530))}  # lam, and theta, phi on a cycle
RUNGS, STARTS = 2, 8000


@judges("egg.period3_direction")
def period3_direction(claim: Claim) -> Judgement:
    """A bounce where `rho'/rho = T` moves by `dT*rho**2/(-9*alpha*(c + alpha))`, `c = cos(3*theta)`."""
    c = Symbol("c", real=True)
    rho = 1 + alpha * cos(3 * theta)
    return Judgement(
        by(
            "from the flat point, c = -1, to the fold, c = -alpha, the bounce of the triangle that the ball runs "
            "anti-clockwise grows with T, and T grows as lam falls; the other triangle is its mirror image",
            zero("", rho * diff(rho, theta, 2) - diff(rho, theta) ** 2 + 9 * alpha * (cos(3 * theta) + alpha)),
            positive(-SHAPE - c, {c: Interval.Ropen(-1, -SHAPE)}),
            positive(-diff(required_tilt(), lam), {lam: Interval(0, 1)}),
        ),
        "one of the two turns anti-clockwise, the other clockwise",
    )


@judges("egg.stays_long")
def stays_long(claim: Claim) -> Judgement:
    """The mean number of bounces before an orbit is near another diameter."""
    mean = stay(changed_axis, str(SHAPE), 0.45, 10**6)
    said = f"an orbit at lam = 0.45 makes {mean:.0f} bounces on average near one diameter, over 10^6 bounces"
    return sampled(f"{mean:.0f} bounces", said, mean > 100)


@cache
def side_cascade(period: int) -> tuple[Proof, ...]:
    """The first rungs of a cascade beside the ladder, each flip certified."""
    table, (lam_at, (theta, phi)) = tables.egg(3).at(alpha=SHAPE), SIDE[period]
    settled = PinballMap("egg", lam=lam_at, alpha=str(SHAPE)).orbit(theta, phi, 4000)
    critical = next_critical(table, settled.theta[-period:].tolist(), lam_at, 2e-4, BifurcationKind.FLIP)
    proofs, gap = [], 4e-5
    for rung in range(RUNGS):
        problem = Problem(table, (0,) * (period * 2**rung), BifurcationKind.FLIP, "lam")
        proofs.append(certify(problem, critical, 10))
        if rung < RUNGS - 1:
            following = next_critical(table, *doubled(problem, critical, gap), gap / 2, BifurcationKind.FLIP)
            gap, critical = (following[-1] - critical[-1]) / FEIGENBAUM / 3, following
    return tuple(proofs)


@judges("egg.noise")
def noise(claim: Claim) -> Judgement:
    """Two cascades of cycles that are not on the ladder: first rungs proved, chaos and its end sampled."""
    sentences, holds = [], True
    for period, chaotic, gone in ((12, "0.375", "0.3765"), (8, "0.382", "0.3835")):
        proofs = side_cascade(period)
        holds = holds and all(proof.certified and proof.supercritical for proof in proofs)
        flips = " and ".join(f"{float(proof.value.mid()):.7f}" for proof in proofs)
        inside, outside = chaotic_share(chaotic), chaotic_share(gone)
        holds = holds and inside > 0 and outside == 0
        sentences.append(
            f"period {period} doubles and doubles again at lam = {flips} (certified, supercritical); sampled at "
            f"{chaotic}, {inside:.1%} of {STARTS} random starts are chaotic, and {outside:.1%} at {gone}"
        )
    return sampled("; ".join(sentences), "; ".join(sentences), holds)


def chaotic_share(lam_text: str) -> float:
    """The share of random starts whose neighbourhood still grows after a long time."""
    map = PinballMap("egg", lam=lam_text, alpha=str(SHAPE))
    starts = interior_starts(map, STARTS, SEED)
    return float(np.mean(map.exponents(starts.theta, starts.phi, 500, 4000).nu_plus > 0.02))


@judges("egg.basins_above_below")
def basins_above_below(claim: Claim) -> Judgement:
    """Random starts over all of phase space: those that reach a triangle leave to the same side as it does."""
    map, count = PinballMap("egg", lam="0.66", alpha=str(SHAPE)), 10 * STARTS
    attractors = find(map, 100, SEED)
    starts = phase_starts(map, count, SEED)
    label = labels(map, PhasePoints(starts.component, starts.theta, starts.phi), attractors)
    wrong = total = 0
    for i, attractor in enumerate(attractors):
        if attractor.period == 3:
            wrong += int(np.sum(starts.phi[label == i] * attractor.points.phi[0] < 0))
            total += int(np.sum(label == i))
    most = wilson(wrong, total).high
    said = (
        f"of {count} starts uniform in s and sin(phi), {total} reach a triangle, {wrong} of them from angles of the "
        f"other sign (at most {most:.1e} with 95 per cent confidence)"
    )
    return sampled("the upper basin lies in phi > 0, the lower in phi < 0", said, wrong == 0 and total > 0)
