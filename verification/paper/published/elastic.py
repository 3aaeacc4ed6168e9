"""Judges of claims on elastic tables: mean free path, the stadium, Sinai's square with a disc.

The *constant* of the square is the limit, for small radii `R` of its disc, of the exponent per return to the disc plus
`2*log(R)`.
"""

from functools import cache

import numpy as np
from sympy import Derivative, Function, Matrix, Rational, S, Symbol, cos, integrate, log, pi, sin, sqrt, zeta

from numeric import PinballMap
from numeric.backends import elementary
from symbolic import tables
from symbolic.expressions.signs import SignFinding
from symbolic.motion.collision import birkhoff_matrix, derivative_matrix
from symbolic.tables.gallery import arc, piecewise
from symbolic.tables.table import Table, cos_eta1, cos_phi0, lam, phi, s, t, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, greater, judges, sampled, zero

SEED, ORBITS, BOUNCES = 1, 32, 40_000


@judges("elastic.mean_free_path")
def mean_free_path(claim: Claim) -> Judgement:
    """Derives the mean free path by computing the phase-space volume in two ways: by area, and by flights (Santalo)."""
    x, y, tangent = (Function(name, real=True)(s) for name in ("x", "y", "tangent"))
    way = tangent + pi / 2 - phi
    point = Matrix([x + t * cos(way), y + t * sin(way), way])
    speed = {Derivative(x, s): cos(tangent), Derivative(y, s): sin(tangent)}
    letters = {Derivative(tangent, s): Symbol("curvature"), tangent: Symbol("angle")}
    volume = point.jacobian([s, phi, t]).subs(speed).subs(letters).det()
    preserved = birkhoff_matrix(derivative_matrix(), cos_phi0, cos_eta1).det().subs(lam, 1)
    disc = integrate(2 * cos(phi) * cos(phi), (phi, -pi / 2, pi / 2)) * 2 * pi / (2 * 2 * pi)
    return Judgement(
        by(
            "a point and a direction are met by one flight, at one time: the volume 2*pi*|Q| of all of them is the "
            "integral of the flights' lengths over cos(phi) dphi ds, a measure that the map keeps and whose whole is "
            "2*|boundary|",
            zero("dx dy d(direction) is cos(phi) ds dphi dt", volume**2 - cos(phi) ** 2),
            zero("the elastic map keeps d(sin phi) ds", preserved - 1),
            zero("the whole of cos(phi) dphi is 2", integrate(cos(phi), (phi, -pi / 2, pi / 2)) - 2),
            zero("in the circle, where a flight is 2*cos(phi)", disc - pi * pi / (2 * pi)),
        ),
        "mean free path = pi*|Q|/|boundary of Q|, for every table, holes or not, with respect to cos(phi) dphi ds",
    )


def starts(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random positions on the first component, and exit angles with the density `cos(phi)`."""
    rng = np.random.default_rng(SEED)
    return rng.random(count), elementary.arcsin(rng.uniform(-1, 1, count))


@judges("stadium.ergodic")
def ergodic(claim: Claim) -> Judgement:
    """Time averages along a few orbits (bounces on arcs, mean length of flights) agree with phase-space averages."""
    table = tables.stadium()
    place, angle = starts(8)
    orbit = PinballMap(table, lam=1).orbit(place, angle, BOUNCES)
    length, area = 4 + 2 * np.pi, 4 + np.pi
    flights = np.hypot(np.diff(orbit.x, axis=0), np.diff(orbit.y, axis=0))
    curved = np.isin(orbit.component, [0, 2])
    found = {
        "of bounces on the arcs": (curved.mean(axis=0), 2 * np.pi / length),
        "mean flight": (flights.mean(axis=0), np.pi * area / length),
    }
    told, near = [], []
    for what, (values, whole) in found.items():
        error = np.std(values, ddof=1)
        told.append(f"{what} {np.mean(values):.4f}, orbit by orbit +- {error:.4f}, over phase space {whole:.4f}")
        near.append(abs(np.mean(values) - whole) < 4 * error / np.sqrt(8) and error < 0.02 * whole)
    return sampled(
        "share of the arcs pi/(2 + pi), mean flight pi*(4 + pi)/(4 + 2*pi), for sides of length 2 and arcs of radius 1",
        f"8 orbits of {BOUNCES} bounces in the stadium: {'; '.join(told)}",
        all(near),
    )


def elliptical(a: Rational, h: Rational) -> Table:
    """The elliptical stadium: half ellipses with half axes `a` (along the sides) and 1, and sides of length `2*h`."""
    return piecewise(
        arc("right", h + a * cos(theta), sin(theta), -pi / 2, pi / 2),
        arc("top", -theta, S.One, -h, h),
        arc("left", -h - a * cos(theta), -sin(theta), -pi / 2, pi / 2),
        arc("bottom", theta, -S.One, -h, h),
        name="elliptical stadium",
    )


@judges("stadium.elliptical")
def elliptical_stadium(claim: Claim) -> Judgement:
    """For one table in the range, both conditions are proved exactly, and the exponents are sampled."""
    a, h = Rational(21, 20), Rational(1)
    inside = by(
        f"a = {a} and h = {h} are in the range",
        greater(sqrt(4 - 2 * sqrt(2)), a),
        greater(h, 2 * a**2 * sqrt(a**2 - 1)),
    )
    place, angle = starts(ORBITS)
    found = PinballMap(elliptical(a, h), lam=1).exponents(place - 0.5, angle, 8000, 1000)
    low, spread = float(np.min(found.nu_plus)), float(np.std(found.nu_plus))
    return sampled(
        f"nu_+ = {np.mean(found.nu_plus):.3f} per bounce at a = {a}, h = {h}",
        f"{inside.reason}; the least of {ORBITS} random orbits over 8000 bounces has nu_+ = {low:.3f}, their spread "
        f"is {spread:.3f}",
        bool(inside) and low > 5 * spread > 0,
    )


CONSTANT = 1 - 4 * log(2) + 27 * zeta(3) / (2 * pi**2)
OTHER = 2 - 3 * log(2) + 27 * zeta(3) / (2 * pi**2)


@cache
def from_disc_to_disc(radius: str) -> tuple[float, float]:
    """The exponent per return to a disc of radius `R`, plus `2*log(R)`, and its standard error.

    The exponent per return is the exponent per bounce, divided by the fraction of bounces on the disc. This fraction is
    the disc's part of the perimeter.
    """
    size = float(Rational(radius))
    place, angle = starts(ORBITS)
    found = PinballMap(tables.sinai(radius), lam=1).exponents(place, angle, BOUNCES, 1000)
    growth = found.nu_plus * (4 + 2 * np.pi * size) / (2 * np.pi * size)
    return float(np.mean(growth) + 2 * elementary.log(size)), float(np.std(growth) / np.sqrt(ORBITS))


def measured() -> tuple[str, list[tuple[float, float, float]]]:
    """The sampled value of the constant for each radius `R`: as text, and as numbers (value, error, `R*log(R)^2`)."""
    found = {radius: from_disc_to_disc(radius) for radius in ("1/25", "1/50", "1/100")}
    said = ", ".join(f"{value:.3f} +- {error:.3f} at R = {radius}" for radius, (value, error) in found.items())
    sizes = [float(Rational(radius)) for radius in found]
    return said, [
        (*pair, size * float(elementary.log(size)) ** 2) for pair, size in zip(found.values(), sizes, strict=True)
    ]


@judges("sinai.small_disc")
def small_disc(claim: Claim) -> Judgement:
    """The sampled constant agrees with the printed one within its error plus `R*log(R)^2`."""
    said, found = measured()
    true = float(CONSTANT.evalf())
    near = [abs(value - true) < 4 * error + size for value, error, size in found]
    return sampled(
        f"C = {true:.4f}", f"{ORBITS} orbits of {BOUNCES} bounces: the exponent plus 2*log(R) is {said}", all(near)
    )


@cache
def jensen() -> SignFinding:
    """The finding of an upper bound for the constant, for discs of radius epsilon around unit lattice points."""
    return by(
        "where epsilon is the radius of discs about the points of the unit lattice, c <= 1 - log(2): h(T) is the "
        "mean of log(1 + tau*B), B = 2/(R*cos(phi)) + B' with 0 <= B' <= 1/(1 - 2*R); the mean of -log(cos(phi)) is "
        "1 - log(2), and that of log(tau) at most log((1 - pi*R^2)/(2*R)), by Jensen's inequality and the mean free "
        "path",
        zero(
            "mean of -log(cos(phi))",
            integrate(-log(1 - Symbol("u", positive=True) ** 2) / 2, (Symbol("u", positive=True), 0, 1)) - 1 + log(2),
        ),
        by("zeta(3) > 1", greater(2 - 3 * log(2) + 27 / (2 * pi**2), 1 - log(2))),
    )


@judges("sinai.constant")
def constant(claim: Claim) -> Judgement:
    """The printed constant differs from that of another sentence; it is compared with samples and Jensen's bound."""
    said, found = measured()
    true = float(OTHER.evalf())
    agrees = all(abs(value - true) < 4 * error + size for value, error, size in found)
    return sampled(
        f"the constant printed here, {true:.4f}, is that of the sentence it confirms, {float(CONSTANT.evalf()):.4f}, "
        "plus 1 + log(2)",
        f"{jensen().reason}. Sampled, h(T) + 2*log(R) is {said}. The abstract does not say what epsilon and T are, so "
        "that nothing is refuted",
        agrees,
    )
