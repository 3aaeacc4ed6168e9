"""Judges of claims on Lyapunov exponents and sizes of basins: proved for cycles, otherwise sampled with an error.

Paper: sections 5.3, 6.4, 6.6 and the appendix. Exponents of cycles are proved from certified multipliers, those of
chaotic orbits are sampled, with standard errors.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import islice

import numpy as np
from flint import arb
from sympy import Expr, Rational, S, log, pi, sqrt

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.phase_points import Array, phase_points
from numeric.pinball.sampling import Growth, interior_starts, phase_starts
from symbolic import tables
from symbolic.cycles.cycle import contracting_norm, major_axis
from symbolic.cycles.polygons import saddle_node
from symbolic.cycles.thresholds import lambda_c
from symbolic.expressions.signs import Outcome, SignFinding
from symbolic.motion.collision import area_factor, steepening, weak_dissipation
from symbolic.tables.table import a, alpha, eta, lam
from verification.arithmetic.balls import enclose, working
from verification.cycles.cascade import cascade, cycle_at, doubled
from verification.named.attractors import certificate, exponents
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, digits, greater, judges, rounded, sampled, zero
from verification.paper.judges.attractors import strange

SHAPE = Rational(2, 25)
SEED = 1


def share_of_period_3(lam: str, starts: int = 400, bounces: int = 3000) -> float:
    """The fraction of random starts that end on period 3 (with a negative exponent, away from the diameters)."""
    map = PinballMap("egg", lam=lam, alpha=str(SHAPE))
    ball = phase_starts(map, starts, SEED)
    end = map.exponents(ball.theta, ball.phi, 200, bounces, ball.component)
    return float(np.mean((end.nu_plus < 0) & (np.abs(end.phi) > 0.15)))


@judges("egg.period3_end_caption")
def end_of_period_3(claim: Claim) -> Judgement:
    """Judges the digits of the fold, by a closed form; plots show it late, since the basins start with size 0."""
    shares = ", ".join(f"{share_of_period_3(lam):.1%} at {lam}" for lam in ("0.3785", "0.38", "0.39", "0.42"))
    found = digits(claim, saddle_node().subs(alpha, SHAPE), ("0.39", "0.378"))
    return replace(found, derived=f"{found.derived}; random starts that reach period 3: {shares}, so plots see it late")


SPECTRA_SEED, BALLS, BOUNCES, EARLY = 1, 48, 2000, 500
CELLS = 24  # along each side of phase space, in (s, sin(phi))


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The exponents of single orbits at several contractions; the last axis of each array counts the orbits."""

    lams: Array
    plus: Array
    minus: Array

    @property
    def total(self) -> Array:
        """The sum of both exponents of each orbit."""
        return self.plus + self.minus

    @staticmethod
    def error(values: Array) -> Array:
        """The standard errors of means over orbits, which are counted by the last axis of `values`."""
        return np.asarray(np.std(values, axis=-1, ddof=1) / np.sqrt(values.shape[-1]))


@cache
def spectrum(table: str, lams: tuple[float, ...], particles: int = BALLS, bounces: int = BOUNCES) -> Spectrum:
    """The exponents of `particles` orbits at each contraction, after a transient. Paper: figures of 4.1 and 5.3."""
    growth = settled(table, np.maximum(lams, 1e-300), particles)  # no log(0)
    growth.advance(bounces)
    plus = growth.stretch / bounces
    minus = growth.volume / bounces + elementary.log(growth.lam) - plus
    return Spectrum(np.array(lams), *(x.reshape(len(lams), particles) for x in (plus, minus)))


def settled(table: str, lams: Array, particles: int) -> Growth:
    """The same random particles at each contraction, started as in the paper's appendix, after a transient."""
    map = PinballMap(table, lam=np.repeat(lams, particles))
    starts = interior_starts(map.at(1), particles, SPECTRA_SEED)
    growth = Growth(map, *(np.tile(field, len(lams)) for field in (starts.theta, starts.phi, starts.component)))
    growth.skip(EARLY)
    return growth


def visited(table: str, lams: tuple[float, ...], particles: int, bounces: int) -> Array:
    """How often each particle visits each cell of `(s, sin(phi))`: an array (contractions, particles, cells)."""
    growth = settled(table, np.array(lams), particles)
    map = growth.map
    orbit = map.orbit(growth.theta, growth.phi, bounces, growth.component)
    share = np.mod(map.arclength.s(orbit.theta, orbit.component) / map.arclength.perimeter, 1.0)
    row = np.minimum((share * CELLS).astype(int), CELLS - 1)
    column = np.minimum(((np.sin(orbit.phi) + 1) / 2 * CELLS).astype(int), CELLS - 1)
    number = np.arange(len(lams) * particles) * CELLS**2 + row * CELLS + column
    counts = np.bincount(number.ravel(), minlength=len(lams) * particles * CELLS**2)
    return counts.reshape(len(lams), particles, CELLS**2).astype(float)


@cache
def coverage(table: str, lams: tuple[float, ...]) -> Array:
    """The visits of 16 orbits of 4000 bounces to each cell, cached for several judges."""
    return visited(table, lams, 16, 4000)


def uneven(counts: Array) -> float:
    """The relative standard deviation of the counts in cells, in excess of that of random counting."""
    whole = counts.sum(axis=0)
    mean = float(np.mean(whole))
    return float(np.sqrt(max(np.var(whole) / mean - 1, 0.0) / mean))


BITS = 128


@judges("cuspless.lyapunov_signs")
def cuspless_signs(claim: Claim) -> Judgement:
    """Samples show `nu_plus > 0 > nu_minus` on the chaotic attractor; in the basin of period 2, both are negative."""
    lams = tuple(k / 10 for k in range(1, 11))
    found = spectrum("cuspless", lams)
    least, most = float(np.min(found.plus)), float(np.max(found.minus))
    plus = np.mean(found.plus, axis=1)
    error = np.max(Spectrum.error(found.plus))
    said = (
        f"every one of {found.plus.size} orbits at lam = 0.1, 0.2, ..., 1 has nu_+ >= {least:.3f} and nu_- <= "
        f"{most:.3f}; means from {plus[0]:.3f} to {plus.max():.3f}, errors up to {error:.0e} (between lambda* and "
        "lambda_c starts in the basin of period 2 have two negative exponents)"
    )
    return sampled("nu_+ > 0 > nu_- on the chaotic attractor", said, least > 0.2 and most < -0.5)


@cache
def averaged(contraction: str, orbits: int = 1500) -> tuple[float, float, float]:
    """The mean `nu_plus` over random starts, its standard error, and the fraction of starts that reach no cycle."""
    map = PinballMap("cuspless", lam=contraction)
    start = interior_starts(map, orbits, SEED)
    plus = map.exponents(start.theta, start.phi, 500, 4000, start.component).nu_plus
    return float(np.mean(plus)), float(np.std(plus) / np.sqrt(orbits)), float(np.mean(plus > 0.1))


def listed(contractions: tuple[str, ...]) -> str:
    """The means of `nu_plus` at the given contractions, as text."""
    rows = [(x, *averaged(x)) for x in contractions]
    return "; ".join(f"{m:+.4f} +- {e:.0e} at {x} ({c:.1%} chaotic)" for x, m, e, c in rows)


@judges("cuspless.nu_jump")
def jumps(claim: Claim) -> Judgement:
    """The mean exponent rises steeply but does not jump, since the basin of period 2 shrinks to nothing."""
    points = ("0.09", "0.092", "0.093", "0.0933", "0.095")
    exact = float(lambda_c())
    gaps, shares = [exact - float(x) for x in points[:4]], [1 - averaged(x)[2] for x in points[:4]]
    power = float(np.polyfit(elementary.log(gaps), elementary.log(shares), 1)[0])
    said = (
        f"sampled, the average has no jump at lambda_c = {exact:.4f}: the flip is subcritical, so the basin of period "
        f"2 shrinks to nothing there, like (lambda_c - lam)^{power:.2f}, and its nu_+ = log|mu_-|/2 tends to 0: "
        f"{listed(points)}"
    )
    near, after = averaged(points[3])[0], averaged(points[4])[0]
    return sampled("a steep rise, like the square root of lambda_c - lam, and no jump", said, after - near > 0.1)


def triangle_rate() -> Expr:
    """The exponents `nu_plus = nu_minus` of the egg's triangles while their multipliers are complex: `log(g(eta))/2`.

    A bounce multiplies areas `ds d(sin(phi))` by `g(eta)`, as `area_factor` says. At a corner of an equilateral
    triangle the chords make the angle `pi/3`, so `eta + lam*eta = pi/3`.

    >>> round(float(triangle_rate().subs(lam, Rational(3937, 10000))), 4)
    -0.3314
    """
    return log(area_factor().subs(eta, pi / (3 * (1 + lam)))) / 2


def agree(one: arb, other: arb) -> SignFinding:
    """The finding that two balls for one number, with radii up to 1e-15, meet; refuted if they do not."""
    if not one.overlaps(other):
        return SignFinding(Outcome.REFUTED, f"{one} and {other} are different")
    return answer(max(one.rad(), other.rad()) < arb("1e-15"), "both agree to 1e-15")


@judges("egg.exponent_period3")
def period3(claim: Claim) -> Judgement:
    """Judges the printed exponent of period 3, by a closed form at the contraction of the paper's comparison."""
    here = Rational(3937, 10000)
    value = triangle_rate().subs(lam, here)
    born = enclose(saddle_node().subs(alpha, SHAPE)).real
    table = tables.egg(3).at(alpha=SHAPE)
    proof = certificate(table, here, phase_points([-1.4541, 0.6403, 2.7347], 0.0), 20)
    with working(BITS):
        same = agree(exponents(proof.trace, proof.determinant, 3)[0], enclose(value, {}, BITS).real)
    finding = rounded(str(claim.printed), value)
    ranged = "; it rounds to -0.3 from soon after the birth at lam = " + born.str(5, radius=False) + " up to lam = 0.49"
    return Judgement(
        by(
            "at lam = 0.3937, from the certified cycle and in closed form",
            finding,
            answer(proof.is_cycle, "proved"),
            same,
        ),
        "nu = log(lam*cos(lam*eta)/cos(eta))/2 with eta = pi/(3*(1 + lam)) while the multipliers are complex: -0.3314 "
        "at 0.3937, -0.2825 at 0.45, -0.1455 at 0.66" + ranged,
        value=value,
    )


@cache
def period_32(share: Fraction) -> tuple[bool, Rational, arb]:
    """The cycle of period 32 inside its window, at the fraction `share`: True if proved, `lam`, and `nu_plus`."""
    table = tables.egg(3).at(alpha=SHAPE)
    _, _, born, dies = proved_doublings()
    theta, contraction = doubled(born.problem, born.start, (dies.lam - born.lam) / 50)
    steps = 1 + int(8 * share)
    target = born.lam + float(share) * (dies.lam - born.lam)
    for k in range(1, steps + 1):
        theta = cycle_at(table, theta, contraction + (target - contraction) * k / steps)
    exact = Rational(Fraction(target).limit_denominator(10**7))
    proof = certificate(table, exact, phase_points(theta, 0.0), 20)
    with working(BITS):
        return proof.is_cycle, exact, exponents(proof.trace, proof.determinant, len(theta))[0]


@cache
def proved_doublings() -> list:  # type: ignore[type-arg]
    """The period doublings `lambda_3` to `lambda_6` of the egg's cascade, computed in float64 and not proved here."""
    return list(islice(cascade(SHAPE), 4))


@judges("egg.exponent_period32")
def period32(claim: Claim) -> Judgement:
    """The exponent of the cycle of period 32 is 0 at both ends of its window; between, five values are certified."""
    shares = [Fraction(k, 20) for k in (1, 3, 10, 17, 19)]
    rows = [period_32(share) for share in shares]
    fits = next(row for row in rows if row[0] and round(float(row[2].mid()), 2) == -0.01)
    told = ", ".join(f"{nu.str(3, radius=False)} at {float(where):.6f}" for _, where, nu in rows)
    return Judgement(
        by(
            f"the certified cycle of period 32 at lam = {float(fits[1]):.7f} has nu_+ = {fits[2].str(6, radius=False)}",
            answer(all(row[0] for row in rows), "every one of five cycles along the window is proved"),
            rounded(str(claim.printed), lambda bits: fits[2]),
        ),
        f"it depends on lam: 0 at both ends of the window (lambda_5, lambda_6), and {told}",
    )


@judges("egg.chaos_by")
def chaos_by(claim: Claim) -> Judgement:
    """Strange attractors are proved near a tangency below the printed contraction."""
    chaos, value = strange("0.08", "earliest")
    where = value.str(9, radius=False)
    return Judgement(
        by(
            f"before lam = {claim.printed} there are strange attractors, next to a tangency of a cycle of period 32",
            chaos,
            answer(value < enclose(Rational(str(claim.printed))).real, f"{where} < {claim.printed}"),
        ),
        "strange attractors, which hold a dense orbit along which some vectors grow exponentially, for a set of "
        f"contractions of positive measure in every neighbourhood of {where}; period 64 is born at lam = "
        f"{proved_doublings()[-1].lam:.6f}. For one given contraction, as {claim.printed} is, no theorem says it",
    )


@judges("egg.weak_dissipation_attracts")
def weak_dissipation_attracts(claim: Claim) -> Judgement:
    """A counterexample: a hexagon of the egg that is elliptic at `lam = 1` repels at `lam = 99/100`."""
    table = tables.egg(3).at(alpha=Rational(1, 20))
    six = [-3.0849, -2.0728, -0.9905, 0.0216, 1.1038, 2.1160]
    damped, elastic = (certificate(table, x, phase_points(six, 0.0), 20) for x in (Rational(99, 100), S.One))
    with working(BITS):
        turning = bool(elastic.trace**2 < 4), bool(damped.trace**2 < 4 * damped.determinant)
        repels = bool(damped.determinant > 1)
    size = damped.determinant.str(6, radius=False)
    return Judgement(
        counterexample(
            "at alpha = 1/20 a cycle of period 6 is elliptic at lam = 1, and at lam = 99/100 a repeller with complex "
            f"multipliers, |mu|^2 = {size}",
            answer(damped.is_cycle and elastic.is_cycle, "both cycles are proved"),
            answer(all(turning), "complex multipliers at both"),
            answer(repels, "det > 1 at lam = 99/100"),
            at={alpha: Rational(1, 20), lam: Rational(99, 100)},
        ),
        "an elliptic cycle becomes attracting for lam below 1 when the mean of eta*tan(eta) over it is below 1, and "
        "repelling when it is above",
        by(
            "its multipliers have the modulus sqrt(det), and d log(det)/d lam at lam = 1 is the sum of "
            f"{weak_dissipation()}, since log(g) does not depend on eta at lam = 1; eta = pi/6 on the triangles there",
            zero("d log(g)/d eta is 0 at lam = 1", steepening().subs(lam, 1)),
            zero("eta + lam*eta = pi/3", (eta + lam * eta).subs({eta: pi / 6, lam: 1}) - pi / 3),
            greater(weak_dissipation().subs(eta, pi / 6), S.Zero),
        ),
        "True of the period-3 orbits; elliptic orbits with oblique bounces, where eta*tan(eta) exceeds 1 on average, "
        "become repelling, so weak dissipation does not show their islands.",
    )


@judges("appendix.chaotic_sign")
def chaotic_sign(claim: Claim) -> Judgement:
    """A counterexample: the ellipse's major axis has a positive exponent in a table without chaos."""
    from symbolic.cycles.cycle import monodromy

    here = {a: S(2), lam: S.Half}
    matrix = monodromy(major_axis()).subs(here)
    largest = (matrix.trace() + sqrt(matrix.trace() ** 2 - 4 * matrix.det())) / 2
    return Judgement(
        counterexample(
            "in the ellipse a = 2 at lam = 1/2, which has no chaotic attractor, the orbit along the major axis has "
            f"nu_+ = log({largest})/2 > 0",
            greater(largest, S.One),
            at=here,
        ),
        "a positive maximal exponent excludes convergence to an attracting cycle, and no more",
        by(
            "near an attracting cycle off joins and cusps DT is continuous, so over a period it contracts there in the "
            "quadratic norm in which the monodromy matrix does: on an orbit that converges to the cycle every vector "
            "shrinks exponentially, and no exponent is positive",
            contracting_norm(),
        ),
        "A positive exponent does not make a trajectory converge to a chaotic attractor (unstable cycles have one "
        "too); the criterion is meant for almost every initial condition.",
    )
