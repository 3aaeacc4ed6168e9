"""One-sided derivatives at the corner orbit: against difference quotients, and the signs that the proofs need."""

from dataclasses import replace

import numpy as np
import pytest
from affine_pieces import affine
from flint import arb

from symbolic.cycles.thresholds import lambda_c
from verification.arithmetic.balls import FLOAT64, real_ball, working
from verification.proofs.corner import corner, corner_orbit
from verification.proofs.corner.corner import ARC, WALL, BoundaryPoint, Corner, constant
from verification.proofs.corner.corner_orbit import BITS, MOST, divided, doubled_branch, half, linearised, slope_at_zero

ARC_END, WALL_END = (float(x.mid()) for x in corner.corner_parameters())


OPEN, SAME = arb(0, 1), affine(1, 0, 0, 1)


def sides_of(motion: float | arb = 1, slope_wall: float | arb = -1, slope_arc: float | arb = 1) -> Corner:
    return Corner(*(arb(x) for x in (slope_wall, slope_arc, motion)), SAME, SAME, arb(-1))


@pytest.mark.parametrize(
    ("motion", "slope_wall", "slope_arc", "answer"),
    [
        (1, -1, 1, True), (-1, 1, -1, True), (1, 1, 1, False), (1, -1, -1, False), (1, 1, -1, False),
        (-1, -1, 1, False), (1, OPEN, -1, False), (1, 1, OPEN, False), (1, OPEN, 1, None), (1, -1, OPEN, None),
        (OPEN, -1, 1, None), (0, -1, 1, None), (1, 0, 1, None), (1, -1, 0, None),
    ],
)  # fmt: skip
def test_a_curve_has_a_minimum_at_a_kink(motion, slope_wall, slope_arc, answer):
    assert sides_of(motion, slope_wall, slope_arc).minimum_at_kink is answer


@pytest.mark.parametrize(
    ("piece", "unstable"),
    [
        (affine(1.5, 0.5, 0.5, 0.5), True),  # trace 2, determinant 1/2
        (affine(1.5, 0.5, 0, 0.5), None),  # its directions may lie along the border
        (affine(1.5, 0, OPEN, 0.75), None),
        (affine(0.75, -0.5, 0.5, 0.5), None),  # multipliers of modulus below 1
        (affine(1, 0, 0.5, 0.5), None),  # the multiplier 1
        (affine(0.5, 2, 0.5, 1.5), None),  # a negative one
        (affine(2, 1, 1, 0.5), None),  # the multiplier 0
        (affine(-1.5, 0.5, 0.5, -0.5), None),
    ],
)
def test_orbits_leave_along_a_multiplier_above_1(piece, unstable):
    for at in ("wall", "arc"):
        assert replace(sides_of(), **{at: piece}).unstable is unstable


def test_one_sided_derivatives_are_difference_quotients():
    """From the upper corner to `theta1`, by the rules of the lower corner, continued, and of the upper one."""
    theta1, star = (float(x.mid()) for x in corner.enclosed())
    found, h = corner.at_corner(FLOAT64, theta1, star), 1e-5

    def distances(theta, lam, component):
        with working(200):
            contraction = constant(arb(lam), ())
            start, first = (BoundaryPoint(ARC, constant(x, ())) for x in (corner.corner_parameters()[ARC], arb(theta)))
            near = -(ARC_END, WALL_END)[component]
            second = corner.following(start, first, component, near, contraction, ())
            third = corner.following(first, second, ARC, -theta1, contraction, ())
            fourth = corner.following(second, third, ARC, ARC_END, contraction, ())
            angle = corner.angle(start, first)[0]
        return [float(x.mid()) for x in (-second.at.whole, fourth.at.whole, angle)]

    for component, slope in ((ARC, found.slope_arc), (WALL, found.slope_wall)):
        low, high = (np.array(distances(theta1 + e, star, component)) for e in (-h, h))
        before, after = (np.array(distances(theta1, star + e, component)) for e in (-h, h))
        (second, fourth, phi), (shift, growth, _) = (high - low) / (2 * h), (after - before) / (2 * h)
        assert abs(fourth / phi - slope) < 1e-4 * abs(slope)
        if component == WALL:
            assert abs(growth - fourth * shift / second - found.descent) < 1e-3
        assert abs(abs(second / phi) - abs(found.motion)) < 1e-3 * abs(found.motion)


def test_the_contraction_moves_along_the_branch_as_fast_as_is_said():
    """By the mean-value theorem `lam = lambda_c + bend*e**2` at the end of the branch, for some `bend` in its ball."""
    found = doubled_branch()
    with working(corner_orbit.BITS):
        moved = (found.end - real_ball(lambda_c(), 30)) / arb(corner_orbit.MOST) ** 2

        assert found.bend.contains(moved)
        assert abs(found.bend / moved - 1) < 0.5


@pytest.mark.parametrize("e", ["0.001", "0.01", "0.04"])
def test_derivatives_of_divided_rules_are_difference_quotients(e):
    """By `m` and by `lam`, at a point of the branch; a wide ball of `e` contains them."""
    with working(corner_orbit.BITS):
        m, lam, h = corner_orbit.slope_at_zero(), real_ball(lambda_c(), 30).mid(), arb(10) ** -8
        thin = corner_orbit.derivatives(arb(e), m, lam)
        wide = corner_orbit.derivatives(arb(0.02, 0.02), m, lam)
        for k, (dm, dlam) in enumerate(((h, 0), (0, h))):
            ends = [corner_orbit.divided(arb(e), m + s * dm, lam + s * dlam) for s in (-1, 1)]
            for i, (low, high) in enumerate(zip(*ends, strict=True)):
                quotient = ((high - low) / (2 * h)).mid()
                assert (thin[i, k] + arb(0, 1e-9)).contains(quotient)
                assert thin[i, k].rad() < 0.01
                assert wide[i, k].contains(quotient)


WIDE = arb(MOST / 2, MOST / 2 * (1 + 2.0**-40))
POINTS = ("0.0005", "0.01", "0.025", "0.04")


def near():
    return slope_at_zero(), real_ball(lambda_c(), 30).mid()


def test_division_by_a_ball_around_0_holds_that_by_numbers():
    with working(BITS):
        m, lam = near()
        for dm, dlam in ((0, 0), (arb(0.05), arb(0.01)), (arb(-0.03), arb(0.005))):
            over = divided(WIDE, m + dm, lam + dlam)
            for e in map(arb, POINTS):
                at = divided(e, m + dm, lam + dlam)
                rule = linearised(e, e * (m + dm), lam + dlam).value
                assert all(abs(x * e - y) < 1e-25 for x, y in zip(at, rule, strict=True))
                assert all(x.contains(y) for x, y in zip(over, at, strict=True))
            assert all(x.rad() < 0.02 for x in over)


def test_the_second_derivative_over_e_holds_differences():
    """`H_e/e` from differences at numbers `e` of the ball; the enclosure is not much wider than their spread."""
    with working(BITS):
        (m, lam), h = near(), arb(10) ** -9
        m, lam = m + arb("0.01"), lam + arb("0.003")
        over = corner_orbit.third_order(WIDE, m, lam)
        told = [[], []]
        for e in map(arb, POINTS[1:]):
            low, high = divided(e - h, m, lam), divided(e + h, m, lam)
            for known, a, b, ball in zip(told, low, high, over, strict=True):
                known.append(((b - a) / (2 * h) / e).mid())
                assert (ball + arb(0, 1e-6)).contains(known[-1])
        assert all(abs(ball.mid() - known[0]) < 0.2 * abs(known[0]) for ball, known in zip(over, told, strict=True))


def test_the_direction_of_the_doubling_has_the_multiplier_minus_1():
    """At `lambda_c` both rules vanish to first order along `(1, m)`, and the trace of half an orbit agrees."""
    with working(BITS):
        m, lam = near()
        a = corner_orbit.dense(linearised(arb(0), arb(0), real_ball(lambda_c(), 30)).plain)
        assert all(abs(a[i, 0] + a[i, 1] * m) < 1e-25 for i in range(2))
        trace, determinant = half(arb(0), m, lam)
        assert abs(1 - trace + determinant) < 1e-25  # of half an orbit and the mirror: the multiplier 1
