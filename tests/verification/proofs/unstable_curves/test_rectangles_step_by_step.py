"""The rectangle about a saddle: each inequality, each step by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.graph import Cells
from verification.proofs.unstable_curves import anchor as anchors
from verification.proofs.unstable_curves.affine import BrokenLine
from verification.proofs.unstable_curves.anchor import (
    CUTS,
    _fixed,
    _followed,
    _held,
    _hyperbolic,
    _inside,
    _slope,
    _span,
)
from verification.proofs.unstable_curves.spans import Course

TENT = BrokenLine(((-2.0, -1.5), (0.0, 1.5), (2.0, -1.5)), 0.125, 0.25)
FIXED = 1.5 / (1 + 1.5 - 0.125)  # of 1.5 - 1.5*x + y with y = x/8
CHARTS = Chart("a", (0.0, 2.0), (-1.0, 1.0)), Chart("b", (4.0, 8.0), (-1.0, 1.0))


def matrix(a, b, c, d, radius=0.0):
    """Of balls."""
    return [[BallArray(float(x), radius) for x in row] for row in ((a, b), (c, d))]


BASE = {"a": 4.0, "b": 0.5, "c": 0.25, "d": 0.125, "s": 2.0, "least": 1.0, "most": 1.5, "height": 1.0}


def holds(radius=0.0, **altered):
    """Are the three inequalities said to hold?"""
    now = BASE | altered
    entries = matrix(*(now[x] for x in "abcd"), radius)
    return _hyperbolic(entries, now["s"], now["least"], now["most"], now["height"])


@pytest.mark.parametrize(
    ("name", "edge", "others", "way"),
    [
        ("a", 2.0, {"s": 2.0, "c": 0.0, "d": 0.0, "most": 1.0}, 1),  # a - 2/2 > 1
        ("b", 1.5, {"c": 0.0, "d": 0.0}, -1),  # 4 - 2*b > 1
        ("s", 6.0, {"c": 0.0, "d": 0.0}, -1),  # 4 - s/2 > 1
        ("c", 1.75, {}, -1),  # c/2 + 1/8 < 1
        ("d", 0.875, {}, -1),  # 1/8 + d < 1
        ("least", 0.5, {}, 1),  # 4*least - 1/2 > 3/2
        ("height", 5.0, {}, -1),  # 4 - height/2 > 3/2
        ("most", 3.5, {}, -1),  # 4 - 1/2 > most
    ],
)
def test_each_of_the_three_inequalities_fails_alone_and_at_equality(name, edge, others, way):
    assert holds()
    for sign in (1, -1) if name in "abcd" else (1,):
        assert holds(**others, **{name: sign * (edge + way * 1e-6)})
        for beyond in (0.0, 1e-13, 0.5, 4.0):
            if name != "a" or beyond < 1:
                assert not holds(**others, **{name: sign * (edge - way * beyond)})
        if name != "most" and name != "s":
            continue
        assert not holds(**others, **{name: edge + way * 1e-12})  # rounding is allowed for


def test_radii_of_the_entries_count_against_each_inequality():
    assert holds(radius=0.1)
    assert not holds(radius=0.1, b=0.0, a=1.25, c=0.0, d=0.0, most=0.5)  # 1.15 - 2*0.1 at worst
    assert holds(radius=0.1, b=0.0, a=1.45, c=0.0, d=0.0, most=0.5)
    assert not holds(radius=0.1, d=0.75)  # 0.35/2 + 0.85
    assert holds(radius=0.1, d=0.7)


def test_rounding_of_both_terms_is_allowed_for():
    """17 - 2*8 is a little more than 1, by less or by more than products in float64 may err."""
    most = {"b": 8.0, "c": 0.0, "d": 0.0, "height": 0.5, "most": 0.5}
    assert not holds(a=17 + 25e-12, **most)
    assert holds(a=17 + 1e-10, **most)


def test_a_slope_lies_in_the_middle_of_those_that_may_do_and_above_all_curves():
    ball = matrix(5.0, 0.5, 0.5, 0.5)
    ball[0][0] = BallArray(-5.0, 0.5)
    assert _slope(ball, 0.25) == pytest.approx(4)  # between (1/2)/(1 - 1/2) and (5 - 1/2 - 1)/(1/2)
    assert _slope(ball, 2.0) == pytest.approx(4.5)
    assert _slope(ball, 9.0) == pytest.approx(9)
    assert _slope(ball, 9.0) > 9
    assert _slope(matrix(5.0, 0.5, 0.5, 1.0), 0.25) == np.inf
    assert _slope(matrix(5.0, 0.0, 0.5, 0.5), 0.25) > 1e200


@pytest.mark.parametrize(("low", "high"), [(0.25, 0.25), (0.3, 0.7), (0.5, 1.5), (0.26, 1.74), (1.0, 1.49)])
def test_over_an_interval_the_region_lies_between_the_heights_of_its_columns_and_of_those_beside(
    by_hand, some_cells, low, high
):
    map = SimpleNamespace(charts=CHARTS, joins=())
    for seed in range(5):
        region = by_hand(map, columns=8, cells=some_cells(seed, charts=2, columns=8, rows=64), rows=64)
        rows = Course(region).rows
        for chart, shift, wide in ((0, 0.0, 1), (1, 4.0, 2)):
            on = slice(int(low // 0.25) - 1, int(high // 0.25) + 2)
            found = _span(region, chart, shift + wide * low, shift + wide * high)
            assert found == (rows[0][chart, on].min(), rows[1][chart, on].max())


def test_an_interval_next_to_an_end_of_a_chart_has_no_columns_beside_it(by_hand):
    region = by_hand(SimpleNamespace(charts=CHARTS, joins=()), columns=8)
    assert _span(region, 1, 4.25, 5.0) == (0.0, 0.0)
    assert _span(region, 1, 4.5, 5.0) != (0.0, 0.0)
    assert _span(region, 1, 5.0, 7.25) != (0.0, 0.0)
    assert _span(region, 1, 5.0, 7.5) == (0.0, 0.0)


def test_a_box_is_followed_and_derivatives_are_multiplied_in_order(by_hand):
    """From the left piece to the right one: `((-1.5, 1), (1/8, 0))` times `((1.5, 1), (1/8, 0))`."""
    region = by_hand(TENT)
    left, right = np.array([[1.5, 1.0], [0.125, 0.0]]), np.array([[-1.5, 1.0], [0.125, 0.0]])
    box, product, chart = ((-0.9, -0.88), (-0.01, 0.02)), np.eye(2), 0
    corners = np.array([[x, y] for x in box[0] for y in box[1]])
    for period, chart_there in ((0, 0), (1, 1), (2, 1), (3, 0)):
        found = _followed(region, 0, box, period)
        assert found[0] == chart_there
        for i in (0, 1):
            for j in (0, 1):
                assert abs(found[2][i][j].m - product[i, j]) <= found[2][i][j].r + 1e-15 < 1e-9
            ends = corners[:, i].min(), corners[:, i].max()
            assert found[1][i] == pytest.approx(ends, abs=0.03 if period > 1 else 1e-12)
            assert found[1][i][0] <= ends[0] + 1e-15
            assert ends[1] - 1e-15 <= found[1][i][1]
        product = (right if chart else left) @ product
        x, y = corners.T
        corners, chart = np.array([1.5 - 1.5 * abs(x) + y, x / 8]).T, int(1.5 - 1.5 * abs(x[0]) + y[0] > 0)


def test_a_box_that_is_cut_lost_or_of_unknown_derivative_is_not_followed(by_hand):
    region = by_hand(TENT)
    assert _followed(region, 0, ((-1.1, -0.9), (0.0, 0.0)), 1) is None  # its image lies on both charts
    assert _followed(region, 1, ((1.99, 2.0), (-0.25, 0.25)), 1)[0] == 0
    assert _followed(region, 1, ((1.0 + 2, 1.0 + 2), (0.0, 0.0)), 1) is None  # its image is outside of the charts
    box = (-0.9, -0.8), (-0.01, 0.02)
    full = TENT.derivatives

    def by(change):
        return SimpleNamespace(charts=TENT.charts, joins=TENT.joins, images=TENT.images, derivatives=change)

    def vague(boxes):
        ((piece, slopes),) = full(boxes)
        return [(piece, slopes._replace(law=BallArray(slopes.law.m, slopes.law.r + np.inf)))]

    def steeper(boxes):
        ((piece, slopes),) = full(boxes)
        return [(piece, slopes._replace(by_phi=BallArray(1 + boxes.x[0] + boxes.y[0], 0.25)))]

    def sent(lost, chart):
        def images(boxes):
            found = TENT.images(boxes)
            found.boxes.chart[-1] = chart
            return found._replace(lost=np.array(lost, dtype=int))

        return SimpleNamespace(charts=TENT.charts, joins=TENT.joins, images=images, derivatives=full)

    def half(boxes):
        ((piece, slopes),) = full(boxes.chosen(slice(1, None)))
        return [(piece, slopes)]

    assert _followed(by_hand(by(full)), 0, box, 1) is not None
    assert _followed(by_hand(sent([], 1)), 0, box, 1) is not None
    assert _followed(by_hand(sent([3], 1)), 0, box, 1) is None
    assert _followed(by_hand(sent([], 0)), 0, box, 1) is None
    entry = _followed(by_hand(by(steeper)), 0, box, 1)[2][0][1]  # over all parts
    step = (box[0][1] - box[0][0]) / CUTS, (box[1][1] - box[1][0]) / CUTS
    assert float(entry.m - entry.r) == pytest.approx(0.75 + box[0][0] + box[1][0], abs=1e-12)
    assert float(entry.m + entry.r) == pytest.approx(1.25 + box[0][1] - step[0] + box[1][1] - step[1], abs=1e-12)
    for change in (vague, half, lambda boxes: full(boxes) * 2):
        assert _followed(by_hand(by(change)), 0, box, 1) is None


@pytest.mark.parametrize("aside", [(0.0, 0.0), (0.05, 0.01), (-0.03, -0.02)])
def test_an_interval_newton_step_finds_the_fixed_point_of_an_affine_map(by_hand, aside):
    region, guess = by_hand(TENT), (FIXED + aside[0], FIXED / 8 + aside[1])
    whole = matrix(-1.5, 1.0, 0.125, 0.0)
    found = _fixed(whole, guess, region, 1, 1)
    for x, truth in zip(found, (FIXED, FIXED / 8), strict=True):
        assert abs(x.m - truth) <= x.r < 1e-12
    assert _fixed(matrix(1.0, 1.0, 0.0, 0.5), guess, region, 1, 1) is None  # determinant 0 of the map less identity
    assert _fixed(whole, (-0.5, 0.0), region, 0, 1) is None  # sent to the other chart
    wide = _fixed(matrix(-1.5, 1.0, 0.125, 0.0, 0.25), guess, region, 1, 1)
    assert all(x.m - x.r <= truth <= x.m + x.r for x, truth in zip(wide, (FIXED, FIXED / 8), strict=True))
    assert _fixed(matrix(-1.5, 1.0, 0.125, 0.0, 2.0), guess, region, 1, 1) is None
    two = _fixed(matrix(2.25 + 0.125, -1.5, -0.1875, 0.125), guess, region, 1, 2)
    assert all(abs(x.m - truth) <= x.r < 1e-12 for x, truth in zip(two, (FIXED, FIXED / 8), strict=True))


def test_a_box_that_reaches_the_border_of_another_is_not_inside():
    x, y = hull(0.25, 0.5), hull(-0.5, 0.125)
    ends = [[float(z.lower()), float(z.upper())] for z in (x, y)]
    assert _inside((x, y), ((0.0, 1.0), (-1.0, 1.0)))
    for i in (0, 1):
        for j in (0, 1):
            box = [[0.0, 1.0], [-1.0, 1.0]]
            box[i][j] = ends[i][j]
            assert not _inside((x, y), box)


@pytest.mark.parametrize(
    ("x", "y", "held"),
    [
        ((4.55, 4.95), (-0.7, -0.55), True),
        ((4.55, 4.95), (-0.7, -0.45), True),
        ((5.05, 5.1), (-0.2, -0.1), False),  # in the cell that is missing
        ((4.6, 5.4), (-0.2, -0.1), False),
        ((4.6, 5.8), (-0.7, 0.3), False),
        ((4.6, 4.9999), (-0.2, -0.1), True),
        ((4.6, 5.0 - 1e-8), (-0.2, -0.1), False),  # as good as at its border
        ((5.5 + 1e-8, 5.8), (-0.2, -0.1), False),
        ((5.5001, 5.8), (-0.2, -0.1), True),
        ((5.1, 5.2), (-0.3, -0.25 - 1e-9), False),
        ((5.1, 5.2), (1e-9, 0.3), False),
        ((5.1, 5.2), (0.001, 0.3), True),
        ((4.0, 4.1), (-1.0, -0.9), True),
        ((7.9, 8.0), (0.9, 1.0), True),
        ((4.0, 4.1), (0.9, 1.0), False),
        ((6.6, 6.7), (-1.0, -0.9), False),
    ],
)
def test_a_region_holds_a_box_if_it_has_all_cells_that_this_meets(by_hand, x, y, held):
    map = SimpleNamespace(charts=CHARTS, joins=())
    cells = by_hand(map, columns=8).cells
    kept = ~((cells.chart == 1) & (cells.column == 2) & (cells.row == 3))  # x from 5 to 5.5, y from -1/4 to 0
    kept &= ~((cells.chart == 1) & (cells.column == 0) & (cells.row == 7))
    kept &= ~((cells.chart == 1) & (cells.column == 5) & (cells.row == 0))
    region = by_hand(map, columns=8, cells=Cells(*(field[kept] for field in cells)))
    assert _held(region, 1, (hull(*x), hull(*y))) is held


BAND = slice(36, 48)  # rows from 1/32 to 1/8, of 64


@pytest.fixture
def banded(by_hand):
    """The tent on cells 1/16 wide and 1/128 high, of a band."""
    cells = by_hand(TENT, columns=32, rows=64).cells
    kept = (cells.row >= BAND.start) & (cells.row < BAND.stop)
    kept |= (cells.chart == 1) & (cells.column == 5) & (cells.row == BAND.stop)  # beside the first column, a row more
    kept |= (cells.chart == 1) & (cells.column == 15) & (cells.row == BAND.start - 1)  # beside the last one
    region = by_hand(TENT, columns=32, rows=64, cells=Cells(*(field[kept] for field in cells)), slopes=(-0.0625, 0.03))
    region.cones[1][region.cells.chart == 0] = 7.0  # of no matter for the other chart
    return region


POINT = 1, FIXED, FIXED / 8


def test_a_rectangle_about_a_saddle_is_all_of_the_region_there(banded):
    found = anchors.anchor(banded, POINT, 1, 0.25)
    assert (found.chart, found.low, found.high) == (1, FIXED - 0.25, FIXED + 0.25)
    assert (found.bottom, found.top) == pytest.approx((1 / 32 - 1 / 128, 1 / 8 + 1 / 128), abs=1e-12)
    assert anchors.anchor(banded, POINT, 2, 0.25) is None  # its second image lies on both charts
    assert anchors.anchor(banded, POINT, 1, 0.6) is None  # a column beside it is none
    assert anchors.anchor(banded, (1, FIXED + 0.2, FIXED / 8), 1, 0.15) is None  # the fixed point is not in it
    for end in (found.bottom, found.top):
        assert anchors.anchor(banded, (1, FIXED, end), 1, 0.25) is None
    assert anchors.anchor(banded, (1, FIXED, found.top - 1e-9), 1, 0.25) is not None


@pytest.mark.parametrize(
    ("name", "answer"),
    [("_followed", lambda *_: None), ("_fixed", lambda *_: None), ("_inside", lambda *_: False),
     ("_held", lambda *_: False), ("_hyperbolic", lambda *_: False)],
)  # fmt: skip
def test_each_step_for_a_rectangle_fails_alone(banded, monkeypatch, name, answer):
    monkeypatch.setattr(anchors, name, answer)
    assert anchors.anchor(banded, POINT, 1, 0.25) is None


def test_a_rectangle_that_is_sent_to_another_chart_holds_no_fixed_point(banded, monkeypatch):
    monkeypatch.setattr(anchors, "_fixed", lambda *_: (hull(0.625, 0.625), hull(0.0625, 0.0625)))
    assert anchors.anchor(banded, POINT, 1, 0.25) is not None
    true = anchors._followed
    monkeypatch.setattr(anchors, "_followed", lambda *given: (0, *true(*given)[1:]))
    assert anchors.anchor(banded, POINT, 1, 0.25) is None


@pytest.mark.parametrize("aside", [0.0625, -0.0625])
def test_inequalities_are_asked_of_the_nearest_and_the_farthest_the_fixed_point_may_be_to_each_side(
    banded, monkeypatch, aside
):
    asked = []
    monkeypatch.setattr(anchors, "_fixed", lambda *_: (hull(0.59375 + aside, 0.65625 + aside), hull(0.0625, 0.078125)))
    monkeypatch.setattr(anchors, "_hyperbolic", lambda *given: asked.append(given[1:]) or True)
    monkeypatch.setattr(anchors, "_slope", lambda whole, steep: steep)
    assert anchors.anchor(banded, (1, 0.625, 0.0625), 1, 0.25) is not None
    steep, least, most, height = asked[0]
    assert steep == 0.0625
    assert least == pytest.approx(0.25 - 0.03125 - 0.0625, abs=1e-12)
    assert most == pytest.approx(0.25 + 0.03125 + 0.0625, abs=1e-12)
    assert height == pytest.approx(9 / 128, abs=1e-11)
    assert height >= 9 / 128 * (1 + 5e-13)
    asked.clear()
    monkeypatch.setattr(anchors, "_fixed", lambda *_: (hull(0.625, 0.625), hull(0.09375, 0.109375)))
    assert anchors.anchor(banded, (1, 0.625, 0.0625), 1, 0.25) is not None
    assert asked[0][3] == pytest.approx(0.109375 - 1 / 32 + 1 / 128, abs=1e-11)
