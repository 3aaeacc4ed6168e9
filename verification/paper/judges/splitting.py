"""Claims on dominated splitting and on elastic hyperbolicity of the two cardioids. Paper: sections 4, 4.1 and 5.

What is proved lies in `symbolic.cycles.splitting` and `symbolic.cycles.defocusing`; what is sampled says so.

The egg's map with a Newton-Raphson iteration that stops early: how far values in section 6.6 depend on it.
"""

import numpy as np
from numpy.typing import NDArray
from sympy import Matrix, Rational, S

from numeric import PinballMap
from numeric.pinball.sampling import phase_starts
from symbolic.cycles.defocusing import expands
from symbolic.cycles.splitting import grazing, least_rate, radius_defects, rate, splits
from symbolic.expressions.signs import Finding
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, cos_eta1, cos_phi0, lam
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, judges, zero
from verification.paper.judges.attractors import STARTS, chaotic, found, unsettled
from verification.paper.judges.exponents import SPECTRA_SEED as SEED
from verification.paper.judges.exponents import sampled

BALLS, BOUNCES, BLOCK, LAG = 64, 20_000, 500, 100
Array = NDArray[np.float64]


def cones() -> Finding:
    """The cone of beams that focus within `D` is mapped strictly into itself, for every contraction below 1."""
    return by(
        "a cone of beams is mapped strictly into itself at every return to the arc, at most two bounces, with a bound "
        "on the projective diameter of its image; for 0 <= lam < 1, off the points where DT does not exist",
        splits(),
    )


@judges("cuspless.dominated_splitting", "cardioid.dominated_splitting")
def dominated(claim: Claim) -> Judgement:
    """Not by exponents: by a cone field. Curvature is bounded on the cuspless cardioid, not on the cardioid."""
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


def elastic_growth() -> Finding:
    """At `lam = 1` beams of the cone widen at every return to the arc; with an invariant measure, `nu_plus > 0`."""
    return by(
        "at lam = 1 the width of a beam in units of D grows at every return to the arc: by a gain above 1 along it, "
        "by 38/27 or more by way of the wall. The map preserves a finite measure, so almost every start comes back to "
        "where D is not small, and the mean logarithm of the growth is positive (Birkhoff, Oseledets)",
        splits(),
        zero("det DT = cos(phi0)/cos(eta1)", derivative_matrix().det().subs(lam, 1) - cos_phi0 / cos_eta1),
    )


@judges("cuspless.splitting_by_exponents")
def by_exponents(claim: Claim) -> Judgement:
    """The same table at `lam = 1` has exponents of both signs and no dominated splitting."""
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
    """Both halves of Wojtkowski's condition, on an arc and from an arc to its mirror image."""
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
    """The cones of either table at `lam = 1`."""
    finding = by("every bounce widens the beams of a cone, by a gain above 1", expands())
    if claim.id.startswith("cuspless"):
        finding = elastic_growth()
    return Judgement(finding, "nu_+ > 0 > nu_- = -nu_+ for almost every start at lam = 1")


def averages(table: str, law: str = "1") -> tuple[Array, Array, Array]:
    """Averages of three functions along orbits, their errors, and their correlation after `LAG` bounces.

    The functions are `sin(phi)^2 - 1/3`, `cos(2*pi*s/S)` and `sin(phi)*sin(2*pi*s/S)`; for the elastic measure
    `cos(phi) ds dphi` the mean of each is 0.
    """
    map = PinballMap(table, lam=law)
    start = phase_starts(map, BALLS, SEED)
    orbit = map.orbit(start.theta, start.phi, BOUNCES, start.component)
    turn = 2 * np.pi * map.arclength.s(orbit.theta, orbit.component) / map.arclength.perimeter
    sine = np.sin(orbit.phi)
    values = np.stack([sine**2 - 1 / 3, np.cos(turn), sine * np.sin(turn)])[:, 1:]
    blocks = values[:, : BOUNCES // BLOCK * BLOCK].reshape(3, -1, BLOCK, BALLS).mean(axis=2)
    errors = blocks.std(axis=1, ddof=1) / np.sqrt(blocks.shape[1])
    later = np.mean(values[:, LAG:] * values[:, :-LAG], axis=(1, 2)) / np.mean(values**2, axis=(1, 2))
    return values.mean(axis=1), errors, later


@judges("cuspless.elastic_ergodic", "cardioid.elastic_ergodic")
def ergodic(claim: Claim) -> Judgement:
    """Proved in the literature for billiards with this condition; here time averages against those over the space."""
    means, errors, later = averages(claim.id.partition(".")[0])
    chi = np.mean((means / errors) ** 2, axis=1)
    good = bool(np.all(chi < 2)) and bool(np.max(np.abs(later)) < 0.02)
    said = (
        f"cited, not proved here; sampled: {BALLS} orbits of {BOUNCES} bounces at lam = 1 have the averages of "
        "sin(phi)^2, cos(2*pi*s/S) and sin(phi)*sin(2*pi*s/S) over the whole phase space, reduced chi^2 "
        f"{', '.join(f'{x:.2f}' for x in chi)}; correlations after {LAG} bounces: {np.max(np.abs(later)):.0e} at most"
    )
    return sampled("ergodic at lam = 1 by the theorems cited, whose defocusing condition is proved here", said, good)


@judges("cuspless.global_near_one")
def global_near_one(claim: Claim) -> Judgement:
    """That nothing but chaos attracts is proved near 1; that there is one attractor is sampled."""
    near = ("0.7", "0.8", "0.9", "0.95", "0.99")
    seen = {x: found("cuspless", x) for x in near}
    single = all(len(some) == len(chaotic(some)) == 1 and not unsettled(some) for some in seen.values())
    said = (
        "proved: for 16/27 < lam < 1 every orbit stretches at a rate of at least "
        f"{least_rate()}, so no cycle attracts; sampled: at lam = {', '.join(near)} all of {STARTS} "
        "starts reach one and the same chaotic attractor"
    )
    return sampled(
        "for lam > 16/27 nothing but chaos attracts; one chaotic attractor is found", said, single and bool(splits())
    )


MOST = 30  # steps of Newton's method


def bounced(theta: Array, phi: Array, lam: Array, alpha: float, tolerance: float) -> tuple[Array, Array]:
    """The next bounce; Newton's method on `cross(z1 - z0, v) = 0` ends with the first step below `tolerance`.

    >>> quarter = np.array([0.3])
    >>> [float(x.round(6)[0]) for x in bounced(quarter, quarter, np.array([0.5]), 0.0, 1e-9)]  # the circle
    [2.841593, 0.15]
    """
    z, tangent = _boundary(theta, alpha)
    v = 1j * tangent / np.abs(tangent) * np.exp(-1j * phi)  # the inward normal, turned by phi towards the tangent
    landing = theta + np.pi - 2 * phi  # as in the circle; then Newton's method
    for _ in range(MOST):
        there, along = _boundary(landing, alpha)
        step = _cross(there - z, v) / _cross(along, v)
        landing = landing - step
        if np.max(np.abs(step)) < tolerance:
            break
    _, along = _boundary(landing, alpha)
    sliding = np.clip((np.conj(along) * v).real / np.abs(along), -1, 1)  # minus the sine of eta
    return np.remainder(landing + np.pi, 2 * np.pi) - np.pi, lam * np.arcsin(sliding)


def ends_of_period(
    period: int, lams: Array, alpha: float, tolerance: float, start: tuple[float, float], bounces: int, apart: float
) -> Array:
    """The contractions at which an orbit is not back after a period, to `apart`, once the transient is over."""
    theta, phi = np.full(lams.size, start[0]), np.full(lams.size, start[1])
    for _ in range(bounces):
        theta, phi = bounced(theta, phi, lams, alpha, tolerance)
    then = theta
    for _ in range(period):
        theta, phi = bounced(theta, phi, lams, alpha, tolerance)
    return np.asarray(lams[np.abs(theta - then) > apart])


def _boundary(theta: Array, alpha: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    turn, rho = np.exp(1j * theta), 1 + alpha * np.cos(3 * theta)
    return rho * turn, (-3 * alpha * np.sin(3 * theta) + 1j * rho) * turn


def _cross(a: NDArray[np.complex128], b: NDArray[np.complex128]) -> Array:
    return np.asarray((np.conj(a) * b).imag)
