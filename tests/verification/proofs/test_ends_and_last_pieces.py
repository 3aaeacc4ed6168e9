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
from verification.proofs.starts import basin_edge
from verification.proofs.starts.basin_edge import BasinEdge
from verification.proofs.unstable_curves import attraction, growth
from verification.proofs.unstable_curves.spans import Course


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


@pytest.mark.parametrize("hit", [None, 0, 1, 2])
def test_one_flight_that_may_be_obstructed_is_enough_and_places_are_told_without_their_turns(monkeypatch, hit):
    """Of the orbit, and of those from and to the saddles; angles far away are the same within half a turn of 0."""
    asked = []
    monkeypatch.setattr(touching, "unobstructed", lambda table, run: asked.append(run) or len(asked) - 1 != hit)
    tubes = [arb(-20), arb(3)], [arb(9.5), arb(-3)]
    made = SimpleNamespace(map=Pinball(egg(3)).over(balls(64)), pairs=[SimpleNamespace(tube=tube) for tube in tubes])
    clear = touching.Touching.clear(made, touching.Point([arb(k) for k in (99, 0, 4, 40, 99)], [], arb(0)))
    assert clear is (hit is None)
    for run, given in zip(asked, ([0, 4, 40], [-20, 3], [9.5, -3]), strict=False):
        wanted = [(0, pytest.approx(np.angle(np.exp(1j * x)))) for x in given]
        assert [(component, float(x)) for component, x in run] == wanted
    made.map = SimpleNamespace(words=balls(64))  # of another kind
    assert touching.Touching.clear(made, touching.Point([arb(0)] * 3, [], arb(0))) is False


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


@pytest.mark.parametrize("fails", ["barrier", "disc", "hyperbolic", "alone", None])
def test_what_is_not_proved_of_an_edge_is_open_and_not_refuted(monkeypatch, fails):
    monkeypatch.setattr(basin_edge, "attracts", lambda *_: fails != "disc")
    heights = None if fails == "barrier" else np.zeros(1)
    made = SimpleNamespace(
        barrier=SimpleNamespace(heights=heights, map=None, above=lambda boxes: np.array([True])),
        disc=None,
        turn=1.0,
        place=(0.0, 0.0),
        _about=lambda half: None,
        _disc_above=lambda: True,
        _hyperbolic=lambda: fails != "hyperbolic",
        _alone=lambda: fails != "alone",
    )
    found = BasinEdge.checks.func(made)
    assert all(value in (True, None) for value in found.values())
    assert [name for name, value in found.items() if value is None and name == fails] == ([fails] if fails else [])


TURN = 2 * np.pi
SHORT = {"high": 0.01, "left": (1.0, 1.0, 0.0, 0.0), "right": (1.01, 1.01, 0.0, 0.0)}  # the image of a short span


@pytest.mark.parametrize(
    ("change", "kept"),
    [
        ({}, [0]),
        ({"high": 2.0}, []),  # as steep as the steepest cell it might go around
        ({"left": (0.5, 1.0, 0.0, 0.0)}, []),
        ({"right": (1.01, 1.51, 0.0, 0.0)}, []),
        ({"right": (0.99, 0.99, 0.0, 0.0)}, []),
        ({"left": (1.0, 1.0, np.nan, np.nan)}, []),
        ({"right": (1.01, 1.01, np.nan, np.nan)}, []),
    ],
)
def test_only_spans_whose_images_are_known_and_short_go_on(change, kept):
    case = SHORT | change
    sides = {last: [np.array([x]) for x in case["right" if last else "left"]] for last in (False, True)}
    cover = SimpleNamespace(sign=[1], most=np.array([-9.0, 1.0]))
    course = SimpleNamespace(
        cover=cover,
        starts=[0.0, TURN],
        around=True,
        ends=lambda spans, last: sides[last],
        _cut=lambda origin, left, right: origin.tolist(),
    )
    one = np.array([0])
    spans = SimpleNamespace(chart=one, origin=one, low=np.zeros(1), high=np.array([case["high"]]))
    assert Course.step(course, spans) == kept


@pytest.mark.parametrize(("wide", "tall", "lean"), [(0.01, 0.1, 0.5), (0.1, 0.01, 8.0), (1.0, 1.0, 1.0)])
def test_the_inner_part_of_a_block_is_as_far_from_its_ends_as_stable_curves_lean(wide, tall, lean):
    columns = 4 * max(attraction.WIDTHS)
    shape = SimpleNamespace(x=(0.0, columns * wide), y=(0.0, 4 * tall))
    narrow = SimpleNamespace(grid=SimpleNamespace(charts=[shape], columns=columns), sides=([wide], [tall]))
    rows = np.full((1, columns), tall), np.full((1, columns), 3 * tall)
    found = attraction._blocks(narrow, SimpleNamespace(rows=rows), np.full((1, columns, 4), lean))
    assert found
    for _, low, high, first, last in found:
        assert first * wide - low >= lean * 2 * tall  # across the two rows that the narrow region fills
        assert high - last * wide >= lean * 2 * tall
