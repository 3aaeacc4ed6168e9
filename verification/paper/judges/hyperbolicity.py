"""Judges of claims on hyperbolicity of both cardioids, and on the orbit through both corners. Paper: sections 4 to 5.2.

Dominated splitting and elastic hyperbolicity are proved in `symbolic.cycles.splitting` and
`symbolic.cycles.defocusing`. Near the orbit through both corners "chaotic" is proved in this sense: a region around
that orbit is mapped into itself, and every orbit in it has an exponent above a positive bound, so no cycle in it is
stable. The module also iterates the egg's map with a Newton iteration that stops early (appendix), to measure its
effect on values in section 6.6.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray
from sympy import Matrix, Rational, S

from numeric import PinballMap
from numeric.backends import elementary
from numeric.pinball.sampling import phase_starts
from symbolic.cycles.defocusing import expands
from symbolic.cycles.splitting import grazing, radius_defects, rate, splits
from symbolic.cycles.thresholds import lambda_c
from symbolic.expressions.signs import SignFinding
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, cos_eta1, cos_phi0, lam
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import enclose
from verification.arithmetic.iteration import telling
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled, zero
from verification.paper.judges.cuspless import attracting_below
from verification.paper.judges.exponents import SPECTRA_SEED as SEED
from verification.paper.judges.located import certified, located, subcritical
from verification.proofs.corner.border_collision import FixedPointChange
from verification.proofs.corner.corner import ARC
from verification.proofs.corner.evidence import ScaledAttractor, border, measured, saddles, strips_of_the_map
from verification.proofs.corner.half_return import ChaosAboveLambdaStar
from verification.proofs.corner.return_map import fourth_on_wall, kink_falls, minimum_at_kink

BALLS, BOUNCES, BLOCK, LAG = 64, 20_000, 500, 100
Array = NDArray[np.float64]


def cones() -> SignFinding:
    """The finding that a cone of beams is mapped strictly into itself, for every contraction below 1."""
    return by(
        "a cone of beams is mapped strictly into itself at every return to the arc, at most two bounces, with a bound "
        "on the projective diameter of its image; for 0 <= lam < 1, off the points where DT does not exist",
        splits(),
    )


@judges("cuspless.dominated_splitting", "cardioid.dominated_splitting")
def dominated(claim: Claim) -> Judgement:
    """Both tables have dominated splitting, by a cone field; only the cuspless cardioid has bounded curvature."""
    here = Rational(1, 2)
    scope = "with one C and one nu for every invariant set of orbits that miss the two joins, where DT does not exist"
    if claim.id.startswith("cardioid"):
        scope = "with one C and one nu for all orbits off the cusp, when vectors are measured by |K|*ds and dphi"
    left = rate(here, wall=claim.id.startswith("cuspless")).n(3)
    return Judgement(
        cones(),
        f"dominated splitting for 0 <= lam < 1, {scope}; at lam = {here} a return to the arc leaves at most {left} of "
        "the cone's projective size",
    )


def elastic_growth() -> SignFinding:
    """The finding that at `lam = 1` the beams of a cone widen at every return to the arc, so that `nu_plus > 0`."""
    return by(
        "at lam = 1 the width of a beam in units of D grows at every return to the arc: by a gain above 1 along it, "
        "by 38/27 or more by way of the wall. The map preserves a finite measure, so almost every start comes back to "
        "where D is not small, and the mean logarithm of the growth is positive (Birkhoff, Oseledets)",
        splits(),
        zero("det DT = cos(phi0)/cos(eta1)", derivative_matrix().det().subs(lam, 1) - cos_phi0 / cos_eta1),
    )


@judges("cuspless.splitting_by_exponents")
def by_exponents(claim: Claim) -> Judgement:
    """A counterexample: at `lam = 1` the table has exponents of both signs, but no dominated splitting."""
    sheared = zero("", *(grazing() ** 2 - Matrix([[1, 4 / K0], [0, 1]])))
    return Judgement(
        counterexample(
            "at lam = 1 the same table has nu_+ > 0 > nu_- almost everywhere, but near-grazing orbits follow a shear "
            "whose powers grow like n, which no C*nu^n bounds: exponents of both signs are no dominated splitting",
            elastic_growth(),
            sheared,
            at={lam: S.One},
        ),
        "the splitting is dominated for 0 <= lam < 1 by a cone field, which exponents do not show",
        cones(),
        "Lyapunov exponents of both signs do not verify a dominated splitting (at lambda = 1 the table has the one and "
        "not the other); a strictly invariant cone field does, for every lambda in [0, 1).",
    )


@judges("cuspless.unfolded_defocusing")
def unfolded(claim: Claim) -> Judgement:
    """Wojtkowski's condition holds for both kinds of chords: on an arc, and from an arc to its mirror image."""
    return Judgement(
        by(
            "d^2 rho/ds^2 < 0 on the arc, and t >= D0 + d1 on every chord of the unfolded table: along an arc as in "
            "the cardioid; from an arc to its mirror image since t >= D on either side of the wall, as no circle of "
            "diameter 1/|K| that touches the arc from inside crosses the wall",
            splits(),
            zero("", *radius_defects()),
        ),
        "the condition holds, with equality only where both ends of a chord meet, at the joins",
    )


@judges("cuspless.elastic_hyperbolic", "cardioid.elastic_hyperbolic")
def hyperbolic(claim: Claim) -> Judgement:
    """The elastic tables are hyperbolic: at `lam = 1` they have invariant cones."""
    finding = by("every bounce widens the beams of a cone, by a gain above 1", expands())
    if claim.id.startswith("cuspless"):
        finding = elastic_growth()
    return Judgement(finding, "nu_+ > 0 > nu_- = -nu_+ for almost every start at lam = 1")


def averages(table: str, contraction: str = "1") -> tuple[Array, Array, Array]:
    """Averages of three functions along orbits, their errors, and the correlations after `LAG` bounces.

    The functions are `sin(phi)^2 - 1/3`, `cos(2*pi*s/S)` and `sin(phi)*sin(2*pi*s/S)`, where `S` is the perimeter;
    their means in the elastic measure `cos(phi) ds dphi` are 0.
    """
    map = PinballMap(table, lam=contraction)
    start = phase_starts(map, BALLS, SEED)
    orbit = map.orbit(start.theta, start.phi, BOUNCES, start.component)
    turn = 2 * np.pi * map.arclength.s(orbit.theta, orbit.component) / map.arclength.perimeter
    sine = np.sin(orbit.phi)
    values = np.stack([sine**2 - 1 / 3, np.cos(turn), sine * np.sin(turn)])[:, 1:]
    count = BOUNCES // BLOCK
    blocks = values[:, : count * BLOCK].reshape(3, count, BLOCK, BALLS).mean(axis=2)
    errors = blocks.std(axis=1, ddof=1) / np.sqrt(count)
    later = np.mean(values[:, LAG:] * values[:, :-LAG], axis=(1, 2)) / np.mean(values**2, axis=(1, 2))
    return values.mean(axis=1), errors, later


@judges("cuspless.elastic_ergodic", "cardioid.elastic_ergodic")
def ergodic(claim: Claim) -> Judgement:
    """Ergodicity is cited from the literature; samples show that time averages agree with means over phase space."""
    means, errors, later = averages(claim.id.partition(".")[0])
    chi = np.mean((means / errors) ** 2, axis=1)
    good = bool(np.all(chi < 2)) and bool(np.max(np.abs(later)) < 0.02)
    said = (
        f"cited, not proved here; sampled: {BALLS} orbits of {BOUNCES} bounces at lam = 1 have the averages of "
        "sin(phi)^2, cos(2*pi*s/S) and sin(phi)*sin(2*pi*s/S) over the whole phase space, reduced chi^2 "
        f"{', '.join(f'{x:.2f}' for x in chi)}; correlations after {LAG} bounces: {np.max(np.abs(later)):.0e} at most"
    )
    what = "ergodic and mixing" if claim.id.startswith("cardioid") else "ergodic"
    return sampled(f"{what} at lam = 1 by the theorems cited, whose defocusing condition is proved here", said, good)


MOST = 30  # the most steps of Newton's method


def bounced(theta: Array, phi: Array, lam: Array, alpha: float, tolerance: float | Array) -> tuple[Array, Array]:
    """The next bounce of the egg, as `(theta, phi)`, by Newton steps until a step is below `tolerance`.

    Each row of particles stops on its own, when all its steps are below its tolerance.

    >>> quarter = np.array([0.3])
    >>> [float(x.round(6)[0]) for x in bounced(quarter, quarter, np.array([0.5]), 0.0, 1e-9)]  # the circle
    [2.841593, 0.15]
    """
    z, tangent = _boundary(theta, alpha)
    v = 1j * tangent / np.abs(tangent) * _turned(-phi)  # the inward normal, rotated by phi towards the tangent
    landing = theta + np.pi - 2 * phi  # the landing in the circle, as a start
    going: NDArray[np.bool_] = np.array(True)
    for _ in range(MOST):
        there, along = _boundary(landing, alpha)
        step = np.where(going, _cross(there - z, v) / _cross(along, v), 0.0)
        landing = landing - step
        going = going & ~(np.max(np.abs(step), axis=-1, keepdims=True) < tolerance)
        if not np.any(going):
            break
    _, along = _boundary(landing, alpha)
    sliding = np.clip((np.conj(along) * v).real / np.abs(along), -1, 1)  # minus the sine of eta
    return np.remainder(landing + np.pi, 2 * np.pi) - np.pi, lam * elementary.arcsin(sliding)


def ends_of_period(
    period: int,
    lams: Array,
    alpha: float,
    tolerances: Sequence[float],
    start: tuple[float, float],
    bounces: int,
    apart: float,
) -> list[Array]:
    """For each tolerance, the contractions at which an orbit is not back within `apart` after `period` bounces.

    This is tested after a transient of `bounces` bounces.
    """
    least = np.array(tolerances)[:, None]
    theta, phi = (np.full((least.size, lams.size), x) for x in start)
    for _ in range(bounces):
        theta, phi = bounced(theta, phi, lams, alpha, least)
    then = theta
    for _ in range(period):
        theta, phi = bounced(theta, phi, lams, alpha, least)
    return [lams[gap > apart] for gap in np.abs(theta - then)]


def _boundary(theta: Array, alpha: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    turn, rho = _turned(theta), 1 + alpha * np.cos(3 * theta)
    return rho * turn, (-3 * alpha * np.sin(3 * theta) + 1j * rho) * turn


def _turned(angle: Array) -> NDArray[np.complex128]:
    return np.asarray(np.cos(angle) + 1j * np.sin(angle))


def _cross(a: NDArray[np.complex128], b: NDArray[np.complex128]) -> Array:
    return np.asarray((np.conj(a) * b).imag)


PROVED_TO, NEAR = 0.1, 1e-6  # the end of the proof in lam; a distance from lambda-star
ANGLE = 0.04  # the meaning given to "phi close to 0"; phi-star is -0.029


def corner(check: str, reason: str) -> SignFinding:
    """The finding on one item of the checklist for the orbit through both corners."""
    return answer(located("lambda-star").checks[check], reason)


@cache
def born() -> ChaosAboveLambdaStar:
    """The theorem on the trapping region and the expanding cone above `lambda-star`."""
    return ChaosAboveLambdaStar(PROVED_TO, tick=telling("trapping regions"))


def chaos() -> SignFinding:
    """The finding that a chaotic attractor exists near the corner orbit for `lambda-star < lam <= 0.1`."""
    found = born()
    least, most = found.exponent
    return answer(
        found.proved or None,
        f"for lambda* < lam <= {PROVED_TO} a polygon proportional to lam - lambda* is mapped into its interior and a "
        f"cone of directions stretched, so every exponent there is at least {least:.3f} a bounce (at most {most:.3f})",
    )


@cache
def sizes() -> list[ScaledAttractor]:
    """The attractor at several small distances `lam - lambda-star`, measured in units of the distance."""
    return measured([1e-5, 1e-3, 8.8e-3, 0.0288], 20_000)


@judges("cuspless.corner_orbit_unstable")
def corner_orbit_unstable(claim: Claim) -> Judgement:
    """Orbits leave the corner orbit along a direction that is stretched, and that stays on one side of the join."""
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
    """Boxes prove the claim up to `lam = 0.06`; above, the minimum is at a kink and reaches the join at `lambda*`."""
    far = fourth_on_wall(ANGLE, 0.0, 0.06, tick=telling("boxes of phi and lam"))
    near = minimum_at_kink(ANGLE, 0.06, 0.0713, tick=telling("slopes of s_4"))
    return Judgement(
        by(
            f"for |phi| <= {ANGLE}",
            answer(far.proved, f"s_4 > s* for lam <= 0.06, in {far.boxes} boxes"),
            answer(near, "for 0.06 <= lam <= 0.0713 s_4 has one kink, and its minimum there"),
            answer(kink_falls(0.06, 0.0713), "s_4 at the kink falls as lam grows"),
            corner("unique", "and is s* at lambda*"),
        ),
        f"s_4 > s* for all |phi| <= {ANGLE} if and only if lam < lambda*, on [0, 0.0713]; at lambda* the minimum "
        "touches s* at a corner of the curve, which is not smooth there",
    )


@judges("cuspless.fourth_collision_above")
def fourth_collision_above(claim: Claim) -> Judgement:
    """A counterexample: at a larger contraction, all small angles land beyond the upper join again."""
    far = fourth_on_wall(0.05, 0.9, 0.9, or_lower=True)
    return Judgement(
        counterexample(
            "lam = 0.9",
            answer(far.proved, "s_4 > s* for every |phi| <= 0.05"),
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


@judges("cuspless.coexistence")
def coexistence(claim: Claim) -> Judgement:
    """At the upper end of the range, `lambda_c`, the period-2 orbit repels; at the lower end chaos begins."""
    repels = subcritical("lambda-c")
    end = answer(bool(enclose(lambda_c()).real < PROVED_TO), f"lambda_c < {PROVED_TO}")
    return Judgement(
        counterexample(
            "at lam = lambda_c the period-2 orbit attracts no more",
            certified("lambda-c"),
            repels,
            at={letter: lambda_c()},
        ),
        "both attract for every lambda* < lam < lambda_c, and at lambda_c the orbit of period 2 repels; what "
        "attracts at "
        "lambda* itself, and whether a chaotic attractor exists below, is not settled here",
        by("both attract", chaos(), end, attracting_below()),
        "At the upper end they do not coexist: at lambda_c the period-2 orbit has the multiplier -1 and, the "
        "flip being "
        "subcritical, repels. Both attract for every lambda between lambda* and lambda_c.",
    )


@judges("cuspless.thin_at_birth")
def thin_at_birth(claim: Claim) -> Judgement:
    """The attractor's position is proved by a trapping region, its thickness by images of its arc and wall sides."""
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
            answer(
                limit.kind is FixedPointChange.FOLD and limit.robust, "a border collision: two saddles and robust chaos"
            ),
        ),
        "a border collision: in the piecewise linear limit the half return has no fixed point for lam < lambda*, and "
        "for lam > lambda* two saddles (orbits of period 4: arc only; arc and wall) and robust chaos; traces "
        f"{float(arc.trace):.4f} and {float(wall.trace):.4f}, determinant {float(arc.determinant):.5f}. In "
        f"units of lam - lambda* the attractor reaches from {float(low):.4f} (arc) to {float(high):.4f} (wall) along "
        f"the boundary, in strips {widths} wide, exponents within [{limit.exponent[0]:.3f}, {limit.exponent[1]:.3f}] "
        f"(proved for the limit); measured: {seen}",
    )
