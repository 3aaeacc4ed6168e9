"""What the last piece, the other end and the rounding of a step say: mistakes there let a proof pass too early."""

from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb

from symbolic.tables import egg
from verification.arithmetic.balls import balls
from verification.proofs.corner import border_collision, evidence
from verification.proofs.corner.border_collision import HAIR, clipped
from verification.proofs.global_dynamics.common_boundary import CommonBoundary
from verification.proofs.manifolds import touching
from verification.proofs.manifolds.enclosed import complex_balls
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.periodic import triangles
from verification.proofs.slap_map.transfer import inverted
from verification.proofs.starts.basin_edge import BasinEdge
from verification.proofs.unstable_curves import growth


@pytest.mark.parametrize("at", [0.001, 3.0, 6.282])
def test_no_gap_is_told_where_one_part_of_the_curve_has_small_exit_angles(at):
    def angle(x, y):
        return [arb(0) if x.contains(arb(at)) else arb(10)]

    assert triangles._gap(angle, arb(1)) == 0
    assert triangles._gap(lambda x, y: [arb(10)], arb(1)) == 1.5


def test_what_floats_may_have_lost_counts_against_an_inverse():
    # A matrix of equal columns vanishes with I - Q, whose columns sum to 0: both leave the identity as the defect.
    nothing, large = np.zeros((64, 64)), np.full((64, 64), 2.0**40)
    assert inverted(64, large).defect > inverted(64, nothing).defect


def test_a_root_in_complex_balls_has_the_given_power():
    cubed = complex_balls(53).root(acb(8, 1), 3) ** 3
    assert cubed.overlaps(acb(8, 1))
    assert abs(cubed - acb(8, 1)) < 1e-10


def test_the_greatest_about_an_entry_is_asked_of_each_neighbour():
    values = np.array([0.0, 5.0, 0.0, 0.0, 0.0, 7.0])
    for reach in range(6):
        expected = [values[max(0, k - reach) : k + reach + 1].max() for k in range(6)]
        assert growth._greatest(values, reach, axis=0).tolist() == expected


@pytest.mark.parametrize("made", [CommonBoundary, BasinEdge])
def test_one_item_that_is_open_leaves_a_statement_open(made):
    for checks, answer in (({"a": True, "b": True}, True), ({"a": True, "b": None}, False), ({"a": False}, False)):
        assert made.proved.fget(SimpleNamespace(checks=checks)) is answer


def test_every_flight_of_an_orbit_between_its_ends_must_be_clear(monkeypatch):
    asked = []
    monkeypatch.setattr(touching, "unobstructed", lambda table, run: asked.append(len(run)) or True)
    made = SimpleNamespace(map=Pinball(egg(3), turn=3).over(balls(64)), pairs=[])
    orbit = [arb(k) for k in range(7)]  # the first and the last are parameters, no bounces
    assert touching.Touching.clear(made, touching.Point(orbit, [], arb(0)))
    assert asked == [5]


def test_a_segment_that_may_cross_the_border_has_no_image():
    pieces = dict.fromkeys(border_collision.SIGNS, SimpleNamespace(of=lambda p: p))
    unknown, above, beyond = (arb(0), arb(0, 1)), (arb(1), arb(5)), (arb(2), arb(6))
    assert border_collision._mapped(pieces, (unknown, above)) == []
    assert border_collision._mapped(pieces, (above, beyond)) == [(above, beyond)]


def test_a_crossing_lies_between_two_corners_of_what_is_cut_off():
    cut = sorted(u for u, v in clipped([(-1.0, -1.0), (1.0, 1.0), (-2.0, 1.0)], 0, 2) if v == 0)
    assert cut == [-1.5 - HAIR, -1.5 + HAIR, -HAIR, HAIR]


def test_angles_over_a_larger_region_reach_further_on_both_sides():
    square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    small, large = (evidence._angles([(size * u, size * v) for u, v in square]) for size in (1e-3, 2e-3))
    assert large[0] < small[0] < small[1] < large[1]
