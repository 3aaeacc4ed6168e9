"""Strict inequalities are not proved where equality holds: each tested at equality and on either side."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from hypothesis import example, given
from hypothesis import strategies as st
from sympy import Rational

from symbolic.tables import circle, square
from symbolic.tables.law import PAPERS_LAW
from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import working
from verification.maps import first_hit
from verification.maps.first_hit import BallBoundary, inside
from verification.proofs.periodic.completeness import Cover, one_sided, parted, stays_below
from verification.proofs.periodic.interval_newton import ZeroStatus, interval_newton, stepped
from verification.rigorous.exclusion import Cuboids

NEAR = 2.0**-40


@pytest.mark.parametrize(
    ("at", "answer"), [(0, None), (1, None), (NEAR, True), (1 - NEAR, True), (-NEAR, False), (1 + NEAR, False)]
)
def test_a_bounce_at_an_end_of_a_side_is_neither_inside_nor_off_it(at, answer):
    assert inside(square(), (0, 1), [arb(at), arb("0.5")]) is answer
    assert inside(square(), (2, 0), [arb("0.5"), arb(at)]) is answer


def test_a_chord_to_a_wall_that_it_runs_along_is_not_free():
    """A wall through each end of the chord from (0, 0) to (1, 0), upright or along the chord."""
    for first, last, free in (((0, -1), (0, 1), True), ((1, 0), (0, 1), False), ((0, -1), (1, 0), False)):
        places = [
            lambda t, v=first: (t * v[0], t * v[1], arb(v[0]), arb(v[1])),
            lambda t, v=last: (1 + t * v[0], t * v[1], arb(v[0]), arb(v[1])),
        ]
        boundary = BallBoundary(places, [(arb(-1), arb(1))] * 2)
        assert first_hit.free(boundary, (0, arb(0)), (1, arb(0))) is free


@pytest.mark.parametrize("middle", [-3.1, -1.0, 0.0, 3.0, 3.2, 9.4, -9.5])
def test_a_ball_of_parameters_is_parted_at_a_jump(middle):
    """Each parameter of the ball lies in one of the parts and between its ends, up to whole turns."""
    for half in (0.05, 0.3):
        parts = parted(BallArray(np.array([middle]), half))
        for x in np.linspace(middle - half, middle + half, 31):
            turn = x - 2 * math.pi * round(x / (2 * math.pi))
            assert any(np.abs(part.m - turn) <= part.r for part in parts)
        reaches = abs(abs(middle - 2 * math.pi * round(middle / (2 * math.pi))) - math.pi) < half
        assert one_sided(parts[0]) == (not reaches) == (parts[0].m == parts[1].m)


@pytest.mark.parametrize(("lam", "answer"), [("0", True), ("1/2", True), ("99/100", True), ("1", False)])
def test_exit_angles_stay_below_a_right_angle_under_contraction(lam, answer):
    assert stays_below(PAPERS_LAW, lam, circle) is answer


@pytest.mark.parametrize(("last", "answer"), [(2.0, True), (2.0 + 2.0**-51, False)])
def test_a_box_whose_centre_was_rounded_is_no_box_about_a_known_cycle(last, answer):
    """The angles are sums of gaps: 1, 3.25, and 5.25 or a little more, which takes one bit more than a float."""
    known = [(np.array([1.0, 3.25, 5.25]), 1.0)]
    box = Cuboids(np.array([[1.0, 2.25, last]]), np.full((1, 3), 0.01))

    assert Cover.of(circle, PAPERS_LAW.on(circle), Rational(1, 2)).empty(box, 1, known) == answer


def test_what_few_bits_do_not_decide_is_asked_of_all_bits():
    """A slope of `2^-200`, the difference of two numbers near 1, which few bits cannot tell from 0."""

    def solved(_, box, value):
        third = arb(1) / 3
        return [value[0] / (arb(2) ** -200 + (3 * third - 1))]

    system = SimpleNamespace(value=lambda *_: [arb(0)], solved=solved)
    few, all_of_them = (interval_newton(system, [arb(0)], arb(1), bits).status for bits in (130, 400))
    assert (few, all_of_them) == (ZeroStatus.UNKNOWN, ZeroStatus.UNIQUE)


@given(st.floats(0.25, 4), st.floats(1e-3, 0.99))
@example(2.21, 0.36)
def test_an_interval_newton_step_says_one_zero_or_none_only_of_boxes_that_have_it(centre, share):
    """For `x**2 - 2`; in the example the image meets a box that begins above the root."""
    with working(100):
        root, box = arb(2).sqrt(), arb(centre, share * centre)
        status = stepped([arb(centre)], [box], lambda: [(arb(centre) ** 2 - 2) / (2 * box)]).status
    if status is not ZeroStatus.UNKNOWN:
        assert box.contains(root) is (status is ZeroStatus.UNIQUE)
