"""The border collision at the corner orbit: the proofs, the piecewise linear limit, and the map in float64."""

import math

import numpy as np
import pytest
from affine_pieces import SQUARE, affine
from flint import arb

from numeric import PinballMap
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t
from verification.arithmetic.balls import FLOAT64, working
from verification.named.locate import locate
from verification.proofs.corner.border_collision import (
    FixedPointChange,
    exponents,
    extent,
    fixed_point,
    grown,
    kind,
    robust,
    trapped,
)
from verification.proofs.corner.corner import ARC, BITS, WALL, at_corner, enclosed
from verification.proofs.corner.evidence import border, measured, saddles
from verification.proofs.corner.half_return import limit, pieces
from verification.proofs.corner.return_map import exit_angle, kink, kink_falls, minimum_at_kink

THETA1, STAR = (float(x.mid()) for x in enclosed())
CORNER = 2 * math.pi / 3


def by_the_map(u: float, v: float, e: float) -> tuple[float, float]:
    """Half a return in float64, from the two bounces with coordinates `(u, v)`."""
    map = PinballMap("cuspless", lam=STAR + e)
    before = -THETA1 + e * u
    component, theta = (ARC, CORNER + e * v) if v <= 0 else (WALL, -math.sqrt(3) / 4 + e * v)
    (x, y), (px, py) = (_point(component, theta), _point(ARC, before))
    tangent = _tangent(component, theta)
    eta = math.atan2((px - x) * tangent[0] + (py - y) * tangent[1], (py - y) * tangent[0] - (px - x) * tangent[1])
    orbit = map.orbit(np.array([theta]), np.array([-(STAR + e) * eta]), 2, np.array([component]))
    landing = orbit.theta[2, 0]
    beyond = -landing - CORNER if orbit.component[2, 0] == ARC else -landing + math.sqrt(3) / 4
    return (-orbit.theta[1, 0] + THETA1) / e, beyond / e


def _point(component: int, theta: float) -> tuple[float, float]:
    r = 1 + math.cos(theta)
    return (-0.25, -theta) if component == WALL else (r * math.cos(theta), r * math.sin(theta))


def _tangent(component: int, theta: float) -> tuple[float, float]:
    if component == WALL:
        return 0.0, -1.0
    return -math.sin(1.5 * theta), math.cos(1.5 * theta)


@pytest.mark.parametrize("e", [1e-5, 1e-3, 1e-2])
def test_the_map_lies_in_the_family_that_encloses_it(e):
    region = grown(limit(), (-0.5, -1.7), 0.1)
    family = pieces(region, (0.5 * e, e))
    random = np.random.default_rng(3)
    for _ in range(60):
        shares = random.dirichlet(np.ones(len(region)))
        u, v = shares @ np.array(region)
        found = by_the_map(u, v, e * random.uniform(0.5, 1))
        with working(BITS):
            image = family[WALL if v > 0 else ARC].of((arb(u), arb(v)))

        assert all(x - 1e-9 < y < x + 1e-9 or x.contains(y) for x, y in zip(image, found, strict=True))


def test_a_family_holds_the_map_at_every_e_of_its_stretch():
    """For small `e` the set `e*region` lies outside of the largest multiple of the region, where `H'` differs."""
    last, off = 0.01, [(20.0, -0.5), (21.0, -0.5), (21.0, 0.5), (20.0, 0.5)]
    family, random = pieces(off, (0.0, last)), np.random.default_rng(5)
    for e in (1e-5, 1e-3, last):
        for component, v in ((ARC, -0.5), (WALL, 0.5)):
            ends = [(random.uniform(20, 21), v * random.uniform(0, 1)) for _ in range(2)]
            p, q = (np.array(by_the_map(u, v, e)) for u, v in ends)
            with working(BITS):
                du, dv = (arb(x) - y for x, y in zip(*ends, strict=True))
                moved = [a * du + b * dv + arb(0, 1e-9) for a, b in family[component].rows]

            assert all(x.contains(float(y)) for x, y in zip(moved, p - q, strict=True))
    for component, known in limit().items():  # e = 0 belongs to the stretch
        rows = zip(family[component].rows, known.rows, strict=True)
        assert all(x.overlaps(y) for row, other in rows for x, y in zip(row, other, strict=True))


def test_a_region_must_meet_the_border():
    with pytest.raises(ValueError, match="must meet v = 0"):
        pieces([(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)], (0.0, 1e-3))
    with pytest.raises(ValueError, match="above lambda-star"):
        pieces(SQUARE, (-1e-3, 1e-3))


def curved_flight(start: float, end: float, leaving: float, landing: float) -> np.ndarray:
    """The derivative matrix of one flight at `lambda-star`, with given curvatures at its ends."""
    (x, y), (x1, y1) = _point(ARC, start), _point(ARC, end)
    chord = np.array([x1 - x, y1 - y])
    length = np.hypot(*chord)
    tangents = [_tangent(ARC, at) for at in (start, end)]
    cosines = [abs(u * chord[1] - v * chord[0]) / length for u, v in tangents]
    letters = {K0: leaving, K1: landing, t: length, cos_phi0: cosines[0], cos_eta1: cosines[1], lam: STAR}
    return np.array(derivative_matrix().subs(letters), float)


def test_the_one_sided_half_returns_are_those_of_the_derivative_matrices():
    """Chords of both components, against the paper's matrix with either curvature; the mirror acts as -1."""
    sides, bend = at_corner(FLOAT64, THETA1, STAR), -1.5 / (2 * math.cos(THETA1 / 2))
    for component, curvature, side in ((ARC, -1.5, sides.arc), (WALL, 0.0, sides.wall)):
        half = curved_flight(THETA1, -CORNER, bend, curvature) @ curved_flight(CORNER, THETA1, curvature, bend)
        near = limit()[component]

        assert abs(np.trace(half) + side.trace) < 1e-12
        assert abs(np.linalg.det(half) - side.determinant) < 1e-12
        for known, own in zip((*near.rows, near.shift), (*side.rows, side.shift), strict=True):
            assert all(abs(x - y) < 1e-12 for x, y in zip(known, own, strict=True))


def test_two_unstable_orbits_of_period_4_are_born():
    found = border()

    assert found.kind is FixedPointChange.FOLD
    assert found.robust
    assert fixed_point(found.pieces[ARC])[1] < 0 < fixed_point(found.pieces[WALL])[1]
    assert all(abs(p.trace) > 1 + p.determinant for p in found.pieces.values())


def test_the_map_has_two_orbits_of_period_4_beyond_lambda_star():
    e = 2e-6
    for u, v in saddles(3e-6).values():
        found = by_the_map(float(u.mid()), float(v.mid()), e)

        assert abs(found[0] - float(u.mid())) < 1e-3
        assert abs(found[1] - float(v.mid())) < 1e-2


def test_a_stable_side_is_no_robust_chaos_and_one_fixed_point_may_cross():
    crossing = {ARC: affine(0.5, 0, 0, 0.2, 0, 1), WALL: affine(0.5, 0, 0, -0.5, 0, 1)}

    assert robust(crossing) is False
    assert kind(crossing) is FixedPointChange.PERSISTENCE
    assert extent(crossing) is None


def test_a_polygon_is_trapped_only_when_its_image_is_inside():
    shrinking, swelling = affine(0.5, 0, 0, 0.5), affine(2, 0, 0, 0.5)

    assert trapped({ARC: shrinking, WALL: shrinking}, SQUARE) is True
    assert trapped({ARC: shrinking, WALL: swelling}, SQUARE) is None
    assert trapped({ARC: affine(1, 0, 0, 1), WALL: shrinking}, SQUARE) is None  # the image touches the sides


def test_the_bounds_of_the_attractor_meet_and_the_map_attains_them():
    bounds = border()
    lowest, highest = (float(x.mid()) for x in bounds.extent.inner)
    (found,) = measured([1e-6], 60_000)

    assert min(v for _, v in bounds.extent.outer) > lowest - 1e-4
    assert max(v for _, v in bounds.extent.outer) < highest + 2e-4
    assert found.lengths == pytest.approx((lowest, highest), abs=2e-3)  # 2e4 points near an end of slope 1
    assert found.angles == pytest.approx(bounds.angles, abs=2e-4)
    for width, (_, most) in zip(found.widths, bounds.extent.strips, strict=True):
        assert 0.97 * most < width < most + 1e-5


def test_the_exponent_lies_between_its_bounds():
    least, most = border().exponent
    coarse = exponents(border().pieces, border().extent.outer, length=2)
    (found,) = measured([1e-5], 60_000)

    assert 0 < coarse[0] < least < found.exponent < most
    assert abs(found.exponent - 0.2525) < 3e-3  # the scatter of 6e4 bounces


def test_the_kink_of_s4_moves_as_the_one_sided_derivatives_say():
    exact = at_corner(FLOAT64, THETA1, STAR)
    balls_of_it = locate("lambda-star", 15)

    assert exact.minimum_at_kink
    assert abs(exact.descent + 1.68078633425) < 1e-9
    assert balls_of_it.checks["s4_dips_below"]
    assert balls_of_it.checks["unstable"]
    assert kink(enclosed()[1]).speed.overlaps(arb(exact.descent, 1e-6))


def test_the_least_fourth_position_passes_the_corner_at_lambda_star():
    with working(BITS):
        below, above = (kink(arb(x)) for x in (0.0712, 0.07122))

        assert minimum_at_kink(0.03, 0.0712, 0.0713)
        assert kink_falls(0.0712, 0.0713)
        assert below.value > 0 > above.value
        assert abs(exit_angle(enclosed()[0]) + 0.0289794737869139599) < 1e-15


def test_the_least_fourth_position_agrees_with_orbits():
    below = 0.0705
    phi = np.linspace(-0.04, 0.04, 4001)
    orbit = PinballMap("cuspless", lam=below).orbit(np.full(phi.size, CORNER), phi, 4)
    least = orbit.theta[4].min() + math.sqrt(3) / 4

    assert np.all(orbit.component[4] == WALL)
    with working(BITS):
        assert abs(kink(arb(below)).value - least) < 1e-4  # 2e-5 between angles, slope 4.5
