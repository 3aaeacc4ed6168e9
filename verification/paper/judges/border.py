"""Claims on the orbit through both corners and on what it bears. Paper: section 5.2.

"Chaotic" is proved in this sense: a region around the corner orbit is thrown into itself, and every
orbit in it has an exponent above a positive bound, so that no cycle in it is stable.
"""

from functools import cache

import numpy as np
from sympy import Rational

from numeric import PinballMap
from symbolic.cycles.thresholds import lambda_c
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import enclose
from verification.arithmetic.progress import telling
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, judges
from verification.paper.judges.cuspless import attracting_below
from verification.paper.judges.located import certified, located, subcritical
from verification.proofs.corner.border_collision import Kind
from verification.proofs.corner.corner import ARC
from verification.proofs.corner.evidence import Attractor, border, measured, saddles, strips_of_the_map
from verification.proofs.corner.half_return import TrappingRegion, trapping_region
from verification.proofs.corner.return_map import fourth_on_wall, kink_falls, minimum_at_kink

PROVED_TO, NEAR = 0.1, 1e-6  # a contraction, and a distance from lambda-star
ANGLE = 0.04  # what "phi close to 0" is taken for: phi-star is -0.029
SAMPLED = np.linspace(PROVED_TO, 0.99, 48)


def answer(holds: bool | None, reason: str) -> Finding:
    """A three-valued proof as a finding; a proof that fails refutes nothing."""
    return Finding(Outcome.PROVED if holds else Outcome.UNKNOWN, reason)


def corner(check: str, reason: str) -> Finding:
    """One item of the checklist of the orbit through both corners."""
    return answer(located("lambda-star").checks[check], reason)


@cache
def born() -> TrappingRegion:
    """The trapping region and the expanding cone, from `lambda-star` on."""
    return trapping_region(PROVED_TO, tick=telling("trapping regions"))


def chaos() -> Finding:
    """A chaotic attractor near the corner orbit for `lambda-star < lam <= 0.1`."""
    found = born()
    least, most = found.exponent
    return answer(
        found.proved,
        f"for lambda* < lam <= {PROVED_TO} a polygon proportional to lam - lambda* is mapped into its interior and a "
        f"cone of directions stretched, so every exponent there is at least {least:.3f} a bounce (at most {most:.3f})",
    )


@cache
def sizes() -> list[Attractor]:
    """The attractor at a few distances, measured in float64."""
    return measured([1e-5, 1e-3, 8.8e-3, 0.0288], 20_000)


@judges("cuspless.corner_orbit_unstable")
def corner_orbit_unstable(claim: Claim) -> Judgement:
    """On one side of the join a direction is stretched and kept on that side, so that orbits leave along it."""
    arc = border().pieces[ARC]
    return Judgement(
        by(
            "the half return at the joins",
            corner("unstable", "on the wall's side a multiplier above 1, off the border: orbits leave along it"),
            answer(arc.trace < -(1 + arc.determinant), "on the arc's side a multiplier below -1"),
        ),
        "unstable: a multiplier above 1 on the wall's side, one below -1 on the arc's",
    )


@judges("cuspless.fourth_collision_below")
def fourth_collision_below(claim: Claim) -> Judgement:
    """Boxes of angle and contraction up to 0.06; from there on the minimum is at a kink, whose value falls to 0."""
    far = fourth_on_wall(ANGLE, 0.0, 0.06, tick=telling("boxes of phi and lam"))
    near = minimum_at_kink(ANGLE, 0.06, 0.0713, tick=telling("slopes of s_4"))
    return Judgement(
        by(
            f"for |phi| <= {ANGLE}",
            answer(far.on_wall, f"s_4 > s* for lam <= 0.06, in {far.boxes} boxes"),
            answer(near, "for 0.06 <= lam <= 0.0713 s_4 has one kink, and its minimum there"),
            answer(kink_falls(0.06, 0.0713), "s_4 at the kink falls as lam grows"),
            corner("unique", "and is s* at lambda*"),
        ),
        f"s_4 > s* for all |phi| <= {ANGLE} if and only if lam < lambda*, on [0, 0.0713]; at lambda* the minimum "
        "touches s* at a corner of the curve, which is not smooth there",
    )


@judges("cuspless.fourth_collision_above")
def fourth_collision_above(claim: Claim) -> Judgement:
    """At a contraction well above, every small angle lands beyond the upper join again."""
    far = fourth_on_wall(0.05, 0.9, 0.9, or_lower=True)
    return Judgement(
        counterexample(
            "lam = 0.9",
            answer(far.on_wall, "s_4 > s* for every |phi| <= 0.05"),
            at={letter: Rational(9, 10)},
        ),
        f"s_4 < s* at the kink of s_4 for lambda* < lam <= {PROVED_TO}, not near phi = 0 for every lam > lambda*",
        by(
            "s_4 at its kink is s* at lambda* and falls from there on",
            corner("s4_dips_below", "enclosed at the corner orbit"),
            answer(kink_falls(0.0712, PROVED_TO), f"on [0.0712, {PROVED_TO}]"),
        ),
        "Not for every lambda > lambda*: at lambda = 0.9 the fourth collision lies beyond s* again "
        "for all |phi| <= 0.05.",
    )


@judges("cuspless.chaotic_above_star")
def chaotic_above_star(claim: Claim) -> Judgement:
    """Proved up to 0.1; from there on exponents along orbits from the join."""
    map = PinballMap("cuspless", lam=SAMPLED)
    start = np.full(SAMPLED.size, 2 * np.pi / 3)
    least = float(map.exponents(start, np.full(SAMPLED.size, -0.025), 20_000, 2000).nu_plus.min())
    near = chaos()
    said = (
        f"proved: {near.reason}; sampled: at {SAMPLED.size} contractions from {PROVED_TO} to {SAMPLED[-1]} the orbit "
        f"from the join has an exponent of at least {least:.2f}"
    )
    return Judgement(
        Finding(Outcome.UNKNOWN, f"not proved for lam > {PROVED_TO}"),
        f"a chaotic attractor next to the corner orbit for lambda* < lam <= {PROVED_TO}, with an open set of angles "
        "at the join that lead to it; at lam = 1 area is kept, and there is none",
        evidence=said if near and least > 0.1 else "",
    )


@judges("cuspless.coexistence")
def coexistence(claim: Claim) -> Judgement:
    """Both ends of the printed range are left out: at `lambda_c` the orbit repels, by the sign of its flip."""
    repels = subcritical("lambda-c")
    end = answer(bool(enclose(lambda_c()).real < PROVED_TO), f"lambda_c < {PROVED_TO}")
    return Judgement(
        counterexample(
            "at lam = lambda_c the period-2 orbit attracts no more",
            certified("lambda-c"),
            repels,
            at={letter: lambda_c()},
        ),
        "they coexist for lambda* < lam < lambda_c",
        by("both attract", chaos(), end, attracting_below()),
        "The range is open: at lambda_c the period-2 orbit has the multiplier -1 and, the flip being subcritical, "
        "repels; at lambda* the corner orbit has just appeared and nothing near it attracts.",
    )


@judges("cuspless.thin_at_birth")
def thin_at_birth(claim: Claim) -> Judgement:
    """The region of the proof for the place, the images of its two sides for the thickness."""
    limit, thin = border(), strips_of_the_map(NEAR)
    (low, high), (arc, wall) = limit.extent.inner, limit.pieces.values()
    widths = " and ".join(f"{width:.2g}" for _, width in limit.extent.strips)
    seen = "; ".join(
        f"[{a.lengths[0]:.3f}, {a.lengths[1]:.3f}], {a.widths[0]:.2g} and {a.widths[1]:.2g} at {a.lam:.5f}"
        for a in sizes()
    )
    within = " and ".join(f"{length:.2f} by {width:.5f}" for length, width in thin or ())
    return Judgement(
        by(
            "concentrated there, and thin",
            chaos(),
            answer(bool(thin), f"up to lambda* + {NEAR} in two strips, {within} in units of lam - lambda*"),
            answer(bool(saddles()), "two unstable orbits of period 4 appear with it (arc only; arc and wall)"),
            answer(limit.kind is Kind.FOLD and limit.robust, "a border collision: two saddles and robust chaos"),
        ),
        "a border collision: in the piecewise linear limit the half return has no fixed point for lam < lambda*, and "
        "for lam > lambda* two saddles (orbits of period 4: arc only; arc and wall) and robust chaos; traces "
        f"{float(arc.trace):.4f} and {float(wall.trace):.4f}, determinant {float(arc.determinant):.5f}. In "
        f"units of lam - lambda* the attractor reaches from {float(low):.4f} (arc) to {float(high):.4f} (wall) along "
        f"the boundary, in strips {widths} wide, exponents within [{limit.exponent[0]:.3f}, {limit.exponent[1]:.3f}] "
        f"(proved for the limit); measured: {seen}",
    )
