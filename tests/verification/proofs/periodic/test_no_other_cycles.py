"""Proofs that no other cycles or triangles exist: first boxes, laws with their slopes, Krawczyk's operator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flint import arb
from sympy import Rational, cos, pi, sin

from symbolic.tables import circle, egg
from symbolic.tables.gallery import arc, piecewise
from symbolic.tables.law import Law
from symbolic.tables.table import theta
from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import balls, working
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.search import Catalogue, all_cycles
from verification.proofs.periodic import completeness, triangles
from verification.proofs.periodic.interval_newton import ZeroStatus, krawczyk

EGG = egg(3).at(alpha="2/25")


@pytest.mark.parametrize("turn", [1, 2, 3, 5])
@pytest.mark.parametrize("gap", [0.5, 1.0625, 1.5])
def test_the_first_box_holds_all_chains_up_to_a_turn_of_the_table_and_hardly_more(turn, gap):
    for n in (2, 4):
        box = completeness.start(turn, n, gap)
        (middle, reach), *gaps = zip(box.middle[0], box.half[0], strict=True)
        assert middle == 0
        assert math.pi / turn <= reach < math.pi / turn + 2.0**-10
        assert len(gaps) == n - 1
        for middle, half in gaps:
            assert middle - half <= gap < middle - half + 0.04
            assert 2 * math.pi - gap <= middle + half < 2 * math.pi - gap + 0.04
            assert all((x * 2**10).is_integer() for x in (middle, half, reach))


LAWS = {  # `phi`, `-d phi/d eta` and `d phi/d theta` at eta = 0.7, theta = 1.3, lam = 1/4; on a circle `s = theta`
    "-lam*eta": (-0.175, 0.25, 0),
    "-lam*eta*(1 - eta**2/8) + sin(2*theta)/20":
        (-0.175 * (1 - 0.49 / 8) + math.sin(2.6) / 20, 0.25 * (1 - 1.47 / 8), math.cos(2.6) / 10),
    "-lam*eta + s/20": (-0.175 + 1.3 / 20, 0.25, 1 / 20),
}  # fmt: skip


@pytest.mark.parametrize("formula", LAWS)
def test_exit_angles_and_their_slopes_are_those_worked_out_by_hand(formula):
    law = Law(formula).on(circle)
    for found in completeness.reflection(law, BallArray(0.25), circle)(one(0.7), one(1.3)):
        assert [float(np.ravel(x.m)[0]) for x in found] == pytest.approx(LAWS[formula], rel=1e-13, abs=1e-15)


def test_a_law_of_arc_length_has_an_exit_angle_on_either_side_of_its_jump():
    law = Law("-lam*eta + s/20")
    sides = completeness.reflection(law, BallArray(0.25), circle)(one(0.7), BallArray(np.array([3.1]), 0.1))
    values = sorted(float(phi.m[0]) for phi, _, _ in sides)

    assert values == pytest.approx([-0.175 + (3.1 - 2 * math.pi) / 20, -0.175 + 3.1 / 20], abs=1e-4)


def one(x):
    return BallArray(np.array([x]))


@pytest.mark.parametrize("turns", [-3, -1, 0, 1, 4])
@pytest.mark.parametrize("at", [-3.1, -1.0, 0.0, 2.0, 3.1])
def test_a_ball_of_parameters_is_moved_by_whole_turns_to_the_middle_one(turns, at):
    first, beyond = completeness.parted(BallArray(np.array([at + 2 * turns * math.pi]), 0.1))

    assert abs(first.m - at) < 1e-12
    assert 0.1 <= first.r < 0.1001
    assert abs(np.abs(beyond.m - first.m) - (2 * math.pi if abs(at) == 3.1 else 0)) < 1e-12


@pytest.mark.parametrize("off", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("half", [0.0, 1e-4])
def test_krawczyks_operator_holds_the_cycle_of_each_contraction_and_is_hardly_wider_than_it_moves(off, half):
    """A triangle of the egg without symmetry, in a box displaced by a part of its size."""
    near, radius = [-0.2, 1.9, 4.0], 0.002
    cycles = [floats(Problem(EGG, (0, 0, 0), lam=Rational(lam)), near) for lam in (0.4 - half, 0.4, 0.4 + half)]
    centre = [arb(x + off * radius) for x in cycles[1]]
    with working(64):
        found = krawczyk(Problem(EGG, (0, 0, 0), lam=arb(0.4, half)), centre, [radius] * 3, 64)
        assert found.status is ZeroStatus.UNIQUE
        for k, image in enumerate(found.zero):
            places = [cycle[k] for cycle in cycles]
            assert all(image.overlaps(arb(x, 1e-14)) for x in places)
            moved = (max(places) - min(places)) / 2
            assert float(image.rad()) < 1.3 * moved + radius / 6


@pytest.mark.parametrize("lam", [0, Rational(3, 10)])
def test_the_equations_of_a_return_are_the_rule_at_the_second_and_third_bounce(lam):
    table, at = EGG, [arb(1), arb(3), arb(5)]
    with working(80):
        angle = triangles.load(triangles.chord_kernel(table, 0, 0, 0), balls(80))
        found = triangles.returning(Rational(2, 25), Rational(lam), Rational(1)).equations(balls(80), at[1:])
        share = arb(Rational(lam).p) / Rational(lam).q
        out = [angle(at[k], at[(k + 1) % 3])[0] for k in range(3)]
        back = [angle(at[k], at[k - 1])[0] for k in range(3)]
        for k, value in zip((1, 2), found, strict=True):
            assert abs(value - (out[k] + share * back[k])) < 1e-20


def test_a_least_gap_is_the_largest_sixteenth_at_which_chords_are_steep_both_ways_and_everywhere():
    def angle(here, there):  # falls in size with the gap
        gap = (there - here).m
        return [BallArray(np.sign(gap) * 1.25 - gap)]

    for largest, gap in ((0.0, 1.1875), (0.5, 0.6875), (1.17, 0.0625), (1.25, 0.0), (-1.0, 1.5)):
        assert completeness.least_gap(angle, largest) == gap
    assert completeness.least_gap(lambda here, there: [BallArray(np.ones(256))], 0.0) == 0


@pytest.mark.slow
def test_a_catalogue_without_one_cycle_is_never_complete_be_it_a_turned_copy_of_another():
    table, lam = egg(3).at(alpha="1/20"), Rational(1, 4)
    whole = all_cycles(table, lam, 2).catalogue
    assert completeness.no_others(whole, lam, 2).complete
    for left_out in whole.cycles:
        rest = replace(whole, cycles=[cycle for cycle in whole.cycles if cycle is not left_out])
        assert completeness.no_others(rest, lam, 2, 3000).complete is None


def test_there_are_no_cycles_of_no_bounces():
    catalogue = all_cycles(egg(3).at(alpha="1/20"), Rational(1, 4), 1).catalogue
    with pytest.raises(ValueError, match="n = 0"):
        completeness.no_others(catalogue, Rational(1, 4), 0)


def test_of_one_formula_that_has_not_the_period_of_its_curve_nothing_is_proved():
    """An ellipse run through once as theta runs from 0 to 4*pi; both its axes are cycles of period 2."""
    whole = piecewise(arc("c", 11 * cos(theta / 2) / 10, sin(theta / 2), 0, 4 * pi))

    assert all_cycles(whole, Rational(1, 4), 2).catalogue.count(2) == 2
    assert completeness.no_others(Catalogue(whole, 0.25), Rational(1, 4), 2).complete is None
