"""Judges of claims on pinball billiards in polygons: the equilateral triangle, the square, slap maps.

Between straight sides the angle changes by an affine map that does not depend on the position, and the position is
stretched by `cos(phi0)/cos(eta1)`. So the triangle's map consists of two affine maps of the angle, one for each of the
two sides that can be hit; at each angle, the rays that hit a side start from an interval of positions.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Interval, Matrix, Rational, S, Symbol, cos, pi, simplify, sin, sqrt, tan

from numeric import PinballMap
from symbolic import tables
from symbolic.cycles.polygons import next_exit_angle, straight_multipliers
from symbolic.expressions.signs import Box, SignFinding, positive
from symbolic.motion.collision import birkhoff_matrix, derivative_matrix, exit_angle
from symbolic.tables.table import cos_eta1, cos_phi0, eta, lam, phi, t
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, greater, identity, judges, sampled, zero

RIGHT, LEFT = 2 * pi / 3, 4 * pi / 3  # rotation of the normal to the next side of the triangle, and to the previous one
HALF = Rational(1, 2)
SEED = 1
Array = NDArray[np.int64]


def between_sides() -> Matrix:
    """The derivative matrix of a flight between straight sides."""
    return derivative_matrix(S.Zero, S.Zero, t, cos_phi0, cos_eta1)


@judges("triangle.law", "square.law")
def law(claim: Claim) -> Judgement:
    """Judges the printed exit angle as a function of the angle of incidence."""
    return identity(claim, exit_angle())


@judges("triangle.contraction")
def contraction(claim: Claim) -> Judgement:
    """Refutes area contraction: for a flight from a normal to 60 degrees at `lam = 9/10`, the area element grows."""
    here = {cos_phi0: S.One, cos_eta1: cos(pi - RIGHT), lam: Rational(9, 10)}
    areas = [between_sides(), birkhoff_matrix(between_sides(), cos_phi0, cos(here[lam] * (pi - RIGHT)))]
    grown = [greater(area.det().subs(here), S.One) for area in areas]
    return Judgement(
        counterexample("both areas grow on the flight along a normal", *grown, at={lam: here[lam]}),
        "T maps phase space into |phi| <= lam*pi/2; pointwise det DT = lam*cos(phi0)/cos(eta1)",
        by("|phi1| = lam*|eta1| <= lam*pi/2, a strip of lam times the area", zero("", exit_angle() + lam * eta)),
        "Contraction holds for phase space as a whole, not at every point: on the flight along a normal at lambda = "
        "9/10 the area element grows in (s, phi) and in (s, sin phi).",
    )


def hull() -> Expr:
    """The largest exit angle on the triangle's attractor, which is that of the orbit between two sides."""
    return lam * pi / (3 * (1 - lam))


def two_maps() -> SignFinding:
    """The finding that angles change by two affine contractions by `lam`, and tend to `|phi| <= hull()`."""
    return by(
        "a flight changes the angle to lam*(pi/3 - phi) or lam*(-pi/3 - phi), which keep |phi| <= m, m = "
        "lam*pi/(3*(1 - lam)), and draw every angle towards it",
        zero("", next_exit_angle(RIGHT, -hull()) - hull()),
        zero("", next_exit_angle(LEFT, hull()) + hull()),
        zero("", next_exit_angle(RIGHT, phi) + next_exit_angle(LEFT, -phi)),
        zero("both have the slope -lam", next_exit_angle(RIGHT, phi).diff(phi) + lam),
    )


def disjoint(box: Box) -> SignFinding:
    """The finding that the two maps have disjoint images for a range of `lam`, so that the angles form a Cantor set."""
    return by("their images are apart", positive(simplify(next_exit_angle(RIGHT, hull()) / pi), box))


@judges("triangle.measure_zero")
def measure_zero(claim: Claim) -> Judgement:
    """For `lam < 1/2` the angles are proved to have measure 0; for larger `lam` the sum of exponents is sampled."""
    below = by(
        "n bounces leave 2^n intervals of the length lam^n*2*m", two_maps(), disjoint({lam: Interval.open(0, HALF)})
    )
    sums = {}
    for value in ("0.5", "0.7", "0.9"):
        map = PinballMap(tables.triangle(), lam=value)
        found = map.exponents(*_starts(48), 4000, 2000)
        sums[value] = np.mean(found.nu_plus + found.nu_minus), np.std(found.nu_plus) / np.sqrt(48)
    said = ", ".join(f"{total:.4f} +- {error:.0e} at {value}" for value, (total, error) in sums.items())
    return sampled(
        "for lam < 1/2 the attractor lies in a Cantor set of angles of the measure 0; for every lam < 1 nu_+ + nu_- "
        "<= 0 for almost every start",
        f"proved for lam < 1/2: {below.reason}; above, nu_+ + nu_- is {said}: areas shrink along orbits",
        bool(below) and all(total < -8 * error for total, error in sums.values()),
    )


def _starts(count: int, sides: int = 3) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Random positions and angles on the first side, which represents all sides by symmetry."""
    rng = np.random.default_rng([SEED, sides])
    return rng.random(count), rng.uniform(-1.5, 1.5, count)


@judges("triangle.expansion")
def expansion(claim: Claim) -> Judgement:
    """Of two consecutive bounces, one lands at 30 degrees or more, so any two bounces stretch by a factor above 1."""
    x = Symbol("x", positive=True)
    box = {lam: Interval.open(0, 1), x: Interval.Ropen(0, Rational(1, 6))}  # x in units of pi
    stretch = cos(lam * x) / cos(x)
    rise = sin((1 - lam) * x) + (1 - lam) * sin(lam * x) * cos(x)
    return Judgement(
        by(
            "up to its ends, a product over an orbit is that of cos(lam*eta)/cos(eta), at least 1; it grows with "
            "|eta|, for sin((1 - lam)*x) and (1 - lam)*sin(lam*x)*cos(x) are positive on 0 < x < pi/2; and the next "
            "incidence is at least pi/3 - lam*|eta|, more than pi/6 where |eta| is less",
            zero("the matrix is triangular", between_sides()[1, 0]),
            zero("the place is stretched by cos(phi0)/cos(eta1)", between_sides()[0, 0] + cos_phi0 / cos_eta1),
            zero("d/dx of cos(lam*x)/cos(x)", stretch.diff(x) * cos(x) ** 2 - rise),
            zero("the incidence after phi is pi/3 - phi", next_exit_angle(RIGHT, phi) / lam - pi / 3 + phi),
            zero("or -pi/3 - phi", next_exit_angle(LEFT, phi) / lam + pi / 3 + phi),
            by("more than pi/6", positive(Rational(1, 3) - lam * x - Rational(1, 6), box)),
        ),
        "nu_+ >= log(cos(lam*pi/6)/cos(pi/6))/2 > 0 on every orbit that meets no corner, for every lam < 1",
    )


@judges("triangle.cantor")
def cantor(claim: Claim) -> Judgement:
    """For `lam < 1/3`, the rays at each angle on the attractor reach both other sides, and each of them completely."""
    box = claim.box
    return Judgement(
        by(
            "rays of one direction |phi| < pi/6 from a whole side are parted by the opposite corner, and fill each "
            "of the other two sides; so n bounces leave whole sides times 2^n intervals of angles, of the length "
            "lam^n*2*m",
            two_maps(),
            disjoint(box),
            by("m < pi/6", positive(Rational(1, 6) - hull() / pi, box)),
            by("angles after a bounce are below pi/6", positive(Rational(1, 6) - lam / 2, box)),
            zero("at pi/6 the corner is seen from the end of the side", tan(pi / 6) * sqrt(3) / 2 - HALF),
        ),
        "the attractor is {whole sides} x {the angles that stay under phi -> lam*(+-pi/3 - phi)}, a Cantor set of "
        "the dimension log(2)/log(1/lam); its angles are a Cantor set for every lam < 1/2",
    )


@judges("triangle.nonaccessible")
def nonaccessible(claim: Claim) -> Judgement:
    """Rays above 30 degrees reach only the lower part of the next side, and no other rays leave it at these angles."""
    box = claim.box
    steep, other = next_exit_angle(RIGHT, lam * pi / 2), next_exit_angle(LEFT, -lam * pi / 2)
    top = next_exit_angle(RIGHT, pi / 6)
    return Judgement(
        by(
            "after one bounce |phi| < lam*pi/2; rays with pi/6 < phi < lam*pi/2 land below the share h = "
            "cos(phi)/cos(pi/3 - phi) of the next side, h < 1, and leave with an angle between lam*(pi/3 - lam*pi/2) "
            "and lam*pi/6; what comes from the other side leaves below lam*(lam*pi/2 - pi/3)",
            zero("1 - h has the sign of phi - pi/6", cos(pi / 3 - phi) - cos(phi) - sin(phi - pi / 6)),
            by("there are such rays", positive(lam / 2 - Rational(1, 6), box)),
            by("their angles are an interval", positive(simplify((top - steep) / (lam * pi)), box)),
            by("some of it is theirs alone", positive(simplify((top - other) / (lam * pi)), box)),
        ),
        "for every lam in (1/3, 1) no orbit enters, after two bounces, the places above the share h(phi) of a side "
        "with the angle lam*(pi/3 - phi), pi/6 < phi < min(lam*pi/2, 2*pi/3 - lam*pi/2)",
    )


NEAR, CELLS, SETTLE, FOLLOW, ORBITS = "0.99", 48, 60_000, 8000, 24


def _cell(component: Array, place: NDArray[np.float64], angle: NDArray[np.float64]) -> Array:
    """The index of the phase-space cell; angles are relative to the largest exit angle."""
    share = (angle / (float(NEAR) * np.pi / 2) + 1) / 2
    row, column = (np.clip((each * CELLS).astype(np.int64), 0, CELLS - 1) for each in (place, share))
    return (component * CELLS + row) * CELLS + column


@cache
def components() -> tuple[Array, list[int]]:
    """For each cell the index of the triangle's attractor that visits it (or -1), and the number of orbits on each."""
    map = PinballMap(tables.triangle(), lam=NEAR)
    settled = map.exponents(*_starts(ORBITS), 1, SETTLE)
    orbit = map.orbit(settled.theta, settled.phi, FOLLOW, component=settled.component)
    cells = _cell(orbit.component, orbit.theta, orbit.phi)
    groups: list[tuple[set[int], int]] = []
    for visited in (set(column.tolist()) for column in cells.T):
        met = [group for group in groups if group[0] & visited]
        apart = [group for group in groups if not group[0] & visited]
        groups = [*apart, (visited.union(*(cells for cells, _ in met)), 1 + sum(number for _, number in met))]
    owner = np.full(3 * CELLS**2, -1)
    for index, (visited, _) in enumerate(groups):
        owner[list(visited)] = index
    return owner, [number for _, number in groups]


@judges("triangle.three_components")
def three_components(claim: Claim) -> Judgement:
    """A sample gives three attractors; orbits that visit a common cell count as being on the same one."""
    owner, orbits = components()
    said = (
        f"at lam = {NEAR} {sum(orbits)} random starts, after {SETTLE} bounces, visit {len(orbits)} sets of cells in "
        f"{FOLLOW} bounces, apart from each other on a grid of {CELLS} by {CELLS} on each side, "
        f"{', '.join(map(str, orbits))} starts to each; they fill {int(np.sum(owner >= 0))} of {len(owner)} cells"
    )
    return sampled(f"{len(orbits)} attractors at lam = {NEAR}", said, len(orbits) == 3)


@judges("triangle.fractal_boundaries")
def fractal_boundaries(claim: Claim) -> Judgement:
    """Measures the fraction of close pairs of starts that end apart; smooth boundaries make it linear in distance."""
    map, owner = PinballMap(tables.triangle(), lam=NEAR), components()[0]
    place, angle = _starts(160, 1)
    ends = []
    for distance in (0.0, 1e-3, 1e-6, 1e-9):
        found = map.exponents(0.01 + 0.98 * place + distance, angle, 1, SETTLE)
        ends.append(owner[_cell(found.component, found.theta, found.phi)])
    known = [(end >= 0) & (ends[0] >= 0) for end in ends[1:]]
    shares = [float(np.mean((end != ends[0])[both])) for end, both in zip(ends[1:], known, strict=True)]
    said = ", ".join(f"{share:.0%} of {int(np.sum(both))}" for share, both in zip(shares, known, strict=True))
    return sampled(
        "the share of pairs that end apart falls far slower than their distance",
        f"at lam = {NEAR}, of pairs of starts at the distances 1e-3, 1e-6, 1e-9 there end on different attractors "
        f"{said}; across a smooth boundary it would fall by a factor of a thousand each time",
        bool(owner.max() == 2) and min(shares[:2]) > 0.1 and min(int(np.sum(both)) for both in known) > 100,
    )


FACING = pi  # rotation of the normal to the facing side


@judges("square.parabolic")
def parabolic(claim: Claim) -> Judgement:
    """Between opposite sides each bounce multiplies the angle by `lam`, and the total drift is a convergent sum."""
    shrinking, place = straight_multipliers([S.Zero, S.Zero])
    return Judgement(
        by(
            "from |phi| on, the particle drifts by side*(tan(|phi|) + tan(lam*|phi|) + ...) <= side*tan(|phi|)/(1 - "
            "lam), for tan is convex, so that tan(lam*x) <= lam*tan(x); a start further than this from the corners "
            "stays between the two sides, and phi -> 0",
            zero("tan'' = 2*tan*(1 + tan^2)", tan(phi).diff(phi, 2) - 2 * tan(phi) * (1 + tan(phi) ** 2)),
            zero("the angle becomes -lam*phi", next_exit_angle(FACING, phi) + lam * phi),
            zero("round the cycle: lam^2 along the angle", shrinking - lam**2),
            zero("and 1 along the place", place - 1),
        ),
        "each orbit of period 2 between facing sides has the multipliers lam^2 and 1; together they attract every "
        "start with tan(|phi|) < (1 - lam)*(distance from the corners)/side",
    )


@judges("square.integrable")
def integrable(claim: Claim) -> Judgement:
    """The elastic law preserves `cos(4*phi)`, whichever side is hit next."""
    after = [next_exit_angle(turn, phi).subs(lam, 1) for turn in (pi / 2, pi, 3 * pi / 2)]
    return Judgement(
        by(
            "cos(4*phi) is the same after every flight and changes from one angle to another",
            *(zero("", (cos(4 * angle) - cos(4 * phi)).expand(trig=True)) for angle in after),
            greater(cos(4 * S.Zero), cos(4 * pi / 4)),
        ),
        "cos(4*phi) is a first integral: at most four angles on an orbit up to sign",
    )


@cache
def ends_in_the_square(value: str, count: int = 200, bounces: int = 3000) -> tuple[float, float, float]:
    """The fraction of random starts that end on no orbit of period 2, and the range of their larger exponent."""
    found = PinballMap(tables.square(), lam=value).exponents(*_starts(count, 4), bounces, bounces)
    going = np.abs(found.phi) > 1e-6
    growth = found.nu_plus[going]
    return float(np.mean(going)), float(np.min(growth, initial=np.inf)), float(np.max(growth, initial=-np.inf))


@judges("square.chaotic", "square.coexistence")
def coexistence(claim: Claim) -> Judgement:
    """Samples the fraction of starts that keep moving, and their exponents, at some contractions."""
    found = {value: ends_in_the_square(value) for value in ("0.5", "0.7", "0.9")}
    said = "; ".join(
        f"at lam = {value} {share:.0%}" + (f" with nu_+ from {low:.4f} to {high:.4f}" if share else "")
        for value, (share, low, high) in found.items()
    )
    both = [value for value, (share, low, _) in found.items() if 0 < share < 1 and low > 0]
    none = [value for value, (share, _, _) in found.items() if share == 0]
    return sampled(
        f"both attractors are met at lam = {', '.join(both)}, none but the parabolic one at "
        f"{', '.join(none) or 'no other'}",
        f"of 200 random starts keep moving after 6000 bounces: {said}; the others are on orbits of period 2. The "
        "sentence names no range of lam",
        len(both) >= 2,
    )


@judges("slap.expanding")
def expanding(claim: Claim) -> Judgement:
    """The slope of the slap map between two sides depends only on the angle between them."""
    turn = Symbol("turn", real=True)
    slope = between_sides()[0, 0].subs(cos_phi0, 1)
    incidence = next_exit_angle(turn, S.Zero) / lam
    return Judgement(
        by(
            "a particle that leaves along a normal lands at pi - turn, the same all along the side; the square of "
            "the slope exceeds 1 by tan(turn)^2, which is 0 where the normals are opposite and nowhere else",
            zero("the slope is -1/cos(eta1)", slope + 1 / cos_eta1),
            zero("eta1 = pi - turn", incidence - (pi - turn)),
            zero("constant along the side", slope.diff(t)),
            zero("its square less 1", slope.subs(cos_eta1, cos(incidence)) ** 2 - 1 - tan(turn) ** 2),
        ),
        "the slope is -1/cos(pi - turn) from a side to one whose normal is turned by turn: -2 in the equilateral "
        "triangle, 1 in modulus where the sides are parallel",
    )
