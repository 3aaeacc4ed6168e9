"""Strips of starts with images that are given: what is settled, what is left, and norms, worked out by hand."""

from dataclasses import replace
from math import exp
from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.flights import Piece
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts import strips as strips_of
from verification.proofs.starts.core import Core
from verification.proofs.starts.strips import SLACK, Strips, bounded, settled, steepest, strips, unsettled

CORE = Core(0, 0.0, 0.0, 1.0, 0.5, 1.0, 4)


@pytest.fixture(scope="module")
def wall() -> PinballImages:
    """The cuspless table, whose second component is straight: its parameter is its arc length."""
    return PinballImages(Scene("cuspless", lam="1/2"))


@pytest.mark.parametrize(("change", "why"), [
    ({}, None), ({"columns": (4,)}, "columns"), ({"columns": (4, 0)}, "columns"), ({"rows": 0}, "columns"),
    ({"columns": (4, 1, 3)}, "columns"), ({"law": "some"}, "mirror images"), ({"mirrored": False}, "mirror images"),
    ({"columns": (1, 1), "rows": 1}, None),
])  # fmt: skip
def test_strips_are_made_of_mirrored_tables_alone_and_in_every_component(monkeypatch, wall, change, why):
    given = {"columns": (4, 2), "rows": 3, "law": None, "mirrored": True} | change
    stub = SimpleNamespace(charts=wall.charts, map=None, label="table", law=given["law"], mirrored=given["mirrored"])
    monkeypatch.setattr(strips_of, "_leaning", lambda map, chart, line, middle: np.zeros((middle.size, line.size)))
    if why:
        with pytest.raises(ValueError, match=why):
            strips(stub, given["columns"], given["rows"])
    else:
        assert strips(stub, given["columns"], given["rows"]).chart.size == sum(given["columns"]) * given["rows"]


@pytest.mark.parametrize("seed", range(4))
def test_lines_of_strips_do_not_cross_however_they_lean(monkeypatch, seed):
    """The first and last of a component are straight, and neighbours share a line."""
    rng = np.random.default_rng(seed)
    monkeypatch.setattr(
        strips_of, "_leaning", lambda map, chart, line, middle: rng.uniform(-3, 3, (middle.size, line.size))
    )
    charts = Chart("one", (-1.0, 2.0), (-1.0, 1.0)), Chart("two", (0.0, 0.5), (-1.0, 1.0))
    found = strips(SimpleNamespace(charts=charts, map=None, law=None, mirrored=True), (8, 5), 3)
    for chart, count in enumerate((8, 5)):
        for eta in np.unique(found.middle):
            row = found.some((found.chart == chart) & (found.middle == eta))
            assert row.left.size == count
            assert row.half == pytest.approx(np.full(count, np.pi / 12), rel=1e-8)
            assert np.all(row.half > np.pi / 12)
            assert (row.left[0], row.right[-1]) == charts[chart].x
            assert (row.left_lean[0], row.right_lean[-1]) == (0, 0)
            assert np.array_equal(row.left[1:], row.right[:-1])
            assert np.array_equal(row.left_lean[1:], row.right_lean[:-1])
            assert np.all(np.abs(row.right_lean - row.left_lean) * row.half < row.right - row.left)
            assert np.any(row.left_lean != 0)


def one_strip() -> Strips:
    return Strips(integers(1), *(floats(x) for x in (0.25, 0.75, 0.5, -0.125, 0.5, 0.125)))


@pytest.mark.parametrize("across", [False, True])
def test_the_two_parts_of_a_strip_are_all_of_it_and_nothing_twice(across):
    whole, parts = one_strip(), one_strip().cut(np.array([across]))
    rng = np.random.default_rng(1)
    u, x = rng.uniform(-0.125, 0.125, 2000), rng.uniform(0.1, 0.9, 2000)

    def held(strip, k):
        v = 0.5 + u - strip.middle[k]
        low, high = strip.left[k] + strip.left_lean[k] * v, strip.right[k] + strip.right_lean[k] * v
        return (np.abs(v) <= strip.half[k]) & (low <= x) & (x <= high)

    assert parts.chart.tolist() == [1, 1]
    assert np.array_equal(held(whole, 0), held(parts, 0) ^ held(parts, 1))
    assert not np.any(held(parts, 0) & held(parts, 1))
    assert parts.half.tolist() == ([0.0625] * 2 if across else [0.125] * 2)


def test_a_strip_is_as_large_as_its_sides_say(wall):
    """On the wall, of speed 1: its width in the middle, times its height, times the cosine of the least incidence."""
    assert one_strip().measures(wall)[0] == pytest.approx(0.5 * 0.25 * np.cos(0.375), rel=1e-9)
    assert one_strip().measures(wall)[0] > 0.5 * 0.25 * np.cos(0.375)
    small = one_strip()._replace(chart=integers(0), right=floats(0.25 + 2.0**-10), half=floats(2.0**-11))  # of the arc
    exact = 2.0**-20 * np.cos(0.5 - 2.0**-11) * 2 * np.cos(0.125)
    assert exact * (1 - 1e-3) < small.measures(wall)[0] < exact * 1.01
    low = one_strip()._replace(middle=floats(0.0625))
    assert low.measures(wall)[0] == pytest.approx(0.5 * 0.25, rel=1e-9)
    meet = one_strip()._replace(left_lean=floats(2.0), right_lean=floats(-2.0))
    assert meet.measures(wall)[0] == np.inf  # the lines meet at an end


def test_a_strip_starts_as_a_parallelogram_that_leans_in_the_middle_of_its_lines(wall):
    """With `lam = 1/2`: its sides are half its width, and its height along both coordinates; lines part by 5/64."""
    sets = one_strip().started(wall)
    assert sets.chart.tolist() == [1]
    assert sets.middle.ravel() == pytest.approx([0.5, -0.25])
    assert sets.sides[:, :, 0] == pytest.approx(np.array([[0.25, 0.1875 * 0.125], [0.0, -0.5 * 0.125]]), rel=1e-9)
    assert sets.rest[0, 0] == pytest.approx(0.3125 * 0.125, rel=1e-9)
    assert sets.rest[0, 0] > 0.3125 * 0.125
    assert 1e-15 < sets.rest[1, 0] < 1e-13
    assert sets.sides[0, 0, 0] > 0.25
    assert sets.sides[1, 1, 0] < -0.0625
    wide = SimpleNamespace(lam=BallArray(0.5, 0.125))
    assert one_strip().started(wide).rest[1, 0] == pytest.approx(0.125 * 0.5 + 0.125 * 0.125, rel=1e-9)
    alike = one_strip()._replace(right_lean=floats(0.5))  # lines that do not part leave room for a rounding alone
    assert 1e-15 < alike.started(wall).rest[0, 0] < 1e-13


def test_a_norm_of_no_bounces_is_that_of_the_matrix(wall):
    """In `max(abs(ds), abs(dphi)/weight)` at the end, and `first` times the parameter at the start."""
    boxes = Boxes(integers(1, 1, 1), (floats(0, 0, 0), floats(1, 1, 1) / 8), (floats(0, 0, 0), floats(0, 0, 0)))
    entries = [[floats(3, 1, np.nan), floats(8, 1, 0)], [floats(-1, 2, 0), floats(0.5, -10, 0)]]
    product = [[BallArray(x, floats(0, 0.5, 0)) for x in row] for row in entries]
    found = np.zeros(3)
    strips_of._steepest(wall, boxes, integers(2, 0, 1), product, 0, found, (floats(4, 1, 2), 0.25))
    assert found[2] == pytest.approx(max(3 / 2 + 8 * 0.25, 1 / 2 / 0.25 + 0.5), rel=1e-9)
    assert found[0] == pytest.approx(max(1.5 / 4 + 0.25 * 1.5, 2.5 / 4 / 0.25 + 10.5), rel=1e-9)
    assert found[1] == np.inf
    strips_of._steepest(wall, boxes.chosen(slice(1)), integers(0), [[x[:1] for x in row] for row in product], 0, found,
                        (floats(2.0), 0.25))  # fmt: skip
    assert found[0] == pytest.approx(13.0, rel=1e-9)  # the larger one of two images counts
    assert steepest(wall, boxes, 0, 0.25) == pytest.approx([1.0] * 3, rel=1e-9)
    wide = Boxes(integers(0), (floats(1.0), floats(1 + 2.0**-6)), (floats(0), floats(0)))  # speeds differ along it
    assert np.cos(0.5) / np.cos(0.5 + 2.0**-7) < steepest(wall, wide, 0, 0.25)[0] < 1.2


def test_a_norm_of_one_bounce_is_that_of_all_images_and_infinite_where_one_is_not_known(monkeypatch, wall):
    """Boxes with an image; with two, of which the steeper counts; with none; lost; without an arc; without an angle."""
    rows = [(0, 3.0, 0.0, True), (1, 2.0, 0.0, True), (1, 5.0, 0.0, True), (3, 1.0, 0.0, False), (4, 1.0, np.inf, True),
            (5, 9.0, 0.0, True)]  # fmt: skip

    class Given:
        def __init__(self, map, boxes):
            self.asked = boxes

        def arcs(self):
            return None, None

        def split(self, low, high):
            for on, *_ in rows:
                yield Piece(integers(on), integers(1), floats(0.125), floats(0.25), True)

        def exits(self, on, chart, arc):
            row = rows[turn[0]]
            return np.array([row[3]]), floats(0.5), floats(0.25 if row[0] == 5 else 0.75)

        def slopes(self, on, chart, arc):
            a = rows[turn[0]][1]
            turn[0] += 1
            return [[BallArray(floats(a)), BallArray(floats(1.0))], [BallArray(floats(0.0)), BallArray(floats(a))]]

    turn = [0]
    monkeypatch.setattr(strips_of, "Chords", Given)
    monkeypatch.setattr(strips_of, "matrix", lambda slopes: slopes)
    monkeypatch.setattr(strips_of, "hull", lambda low, high: BallArray((low + high) / 2, (high - low) / 2 + (
        rows[turn[0]][2] if turn[0] < len(rows) else 0.0)))  # fmt: skip
    zero = np.zeros(6)
    boxes = Boxes(integers(1, 1, 1, 1, 1, 1), (zero, zero + 0.125), (zero, zero + 0.125))
    found = np.zeros(6)
    one, two = BallArray(np.full(6, 1.0), zero), BallArray(np.full(6, 2.0), zero)
    strips_of._steepest(wall, boxes, np.arange(6), [[one, zero_of(6)], [two, one]], 1, found, (np.ones(6), 0.25))
    after = lambda a: max(a + 2 + 0.25 * 1, 2 * a / 0.25 + a)  # noqa: E731  [[a, 1], [0, a]] after [[1, 0], [2, 1]]
    assert found[:2] == pytest.approx([after(3.0), after(5.0)], rel=1e-9)
    assert found[2:].tolist() == [np.inf, np.inf, np.inf, 0.0]


def zero_of(count: int) -> BallArray:
    return BallArray(np.zeros(count), np.zeros(count))


@pytest.mark.parametrize(("mirrored", "excess", "halvings", "held"), [
    (True, 0, 1, True), (False, 0, 1, True), (True, 1, 3, True), (True, 1, 1, False), (True, 2, 3, True),
    (True, 3, 3, False),
])  # fmt: skip
def test_a_rate_bounds_all_orbits_where_a_norm_does_over_all_boxes_cut_as_needed(
    monkeypatch, wall, mirrored, excess, halvings, held
):
    """Boxes about a place are too steep until they are cut so often; those that are not are not asked again."""
    rate, bounces, asked = 0.5, 3, []
    sizes = [(low, high) for chart in wall.charts for low, high in [chart.x]]

    def norm(map, boxes, count, weight):
        assert (count, weight) == (bounces, 0.25)
        asked.append(boxes)
        steep = (boxes.x[1] - boxes.x[0]) > (
            sizes[boxes.chart[0]][1] - sizes[boxes.chart[0]][0]
        ) / 128 / 2**excess * 1.5
        here = (boxes.x[0] <= 0.1) & (boxes.x[1] >= 0.1)
        good = exp(rate * bounces) * (1 - 2.0**-38)
        return np.where(here & steep if excess else np.zeros(steep.shape, dtype=bool), good * 1.001, good)

    monkeypatch.setattr(strips_of, "steepest", norm)
    stub = SimpleNamespace(charts=wall.charts, mirrored=mirrored, top=wall.charts[0].y[1])
    assert bounded(stub, rate, bounces, 0.25, halvings) is held
    first = [boxes for boxes in asked if boxes.chart.size == 128 * 4]
    for chart, boxes in zip(wall.charts, first, strict=False):
        assert (boxes.x[0].min(), boxes.x[1].max()) == chart.x
        assert boxes.y[0].min() == (0.0 if mirrored else chart.y[0])
        assert boxes.y[1].max() == chart.y[1]
        assert np.sum((boxes.x[1] - boxes.x[0]) * (boxes.y[1] - boxes.y[0])) == pytest.approx(
            (chart.x[1] - chart.x[0]) * (chart.y[1] - (0.0 if mirrored else chart.y[0])), rel=1e-9
        )
    cut = [boxes for boxes in asked if boxes.chart.size < 128 * 4]
    assert all(np.all((boxes.x[0] <= 0.2) & (boxes.x[1] >= 0.0)) for boxes in cut)
    assert len(first) == (2 if held else 1)


def test_a_norm_that_is_as_large_as_the_rate_says_is_refused_with_the_roundings(monkeypatch, wall):
    for share, held in ((1 / SLACK, True), (1.0, False), (np.nan, False)):
        monkeypatch.setattr(strips_of, "steepest", lambda map, boxes, *_, share=share: np.full(
            boxes.chart.size, exp(1.0) * share))  # fmt: skip
        assert bounded(SimpleNamespace(charts=wall.charts, mirrored=True, top=1.0), 0.5, 2, 0.25, 1) is held


def side_by_side(count: int) -> Strips:
    """Strips on the wall, each as large as its number and one more."""
    zero, ends = np.zeros(count), np.cumsum(np.arange(count + 1)) / 1024
    return Strips(np.ones(count, dtype=int), ends[:-1], ends[1:], zero, zero, zero + 0.5, zero + 1e-3)


@pytest.mark.parametrize(("look", "block"), [(100, 100), (3, 2), (1, 1)])
@pytest.mark.parametrize("rounds", [1, 2])
def test_what_is_not_settled_counts_whole_in_whatever_blocks_it_is_asked(monkeypatch, wall, look, block, rounds):
    """Those of the left half are settled in the first round; in the second all parts of some of the others."""
    first, closely = side_by_side(8), []
    sizes, settles = 2 * first.measures(wall), first.left[4]

    def settled_of(map, core, some):
        closely.append(some.left.size)
        done = some.left < settles if rounds == 1 or sum(closely) <= 8 else some.left < first.left[6]
        return done, np.zeros(some.left.size, dtype=bool)

    monkeypatch.setattr(strips_of, "LOOK", look)
    monkeypatch.setattr(strips_of, "BLOCK", block)
    monkeypatch.setattr(strips_of, "MORE", 1e9)
    monkeypatch.setattr(strips_of, "hopeful", lambda map, core, some: (some.left >= 0, some.left < 0))
    monkeypatch.setattr(strips_of, "settled", settled_of)
    left = unsettled(wall, None, first, 0.0, rounds)
    exact = float(np.sum(sizes[4:] if rounds == 1 else sizes[6:]))
    assert exact <= left.measure <= exact * (1 + 1e-9)
    assert left.strips == (8 if rounds == 1 else 8 + 8)
    assert max(closely) <= block


@pytest.mark.parametrize(("enough", "strips_asked"), [(0.0, 8), (1e9, 1)])
def test_no_more_is_asked_when_enough_is_settled(monkeypatch, wall, enough, strips_asked):
    monkeypatch.setattr(strips_of, "BLOCK", 1)
    monkeypatch.setattr(strips_of, "MORE", 1e9)
    none = lambda some: np.zeros(some.left.size, dtype=bool)  # noqa: E731
    monkeypatch.setattr(strips_of, "hopeful", lambda map, core, some: (~none(some), none(some)))
    monkeypatch.setattr(strips_of, "settled", lambda map, core, some: (none(some), none(some)))
    first = side_by_side(8)
    whole = float(np.sum(2 * first.measures(wall)))
    left = unsettled(wall, None, first, enough if enough else 0.0, 1)
    assert left.strips == (strips_asked if enough == 0.0 else 0) or left.strips == strips_asked
    assert left.measure >= whole or left.measure == np.inf


@pytest.mark.parametrize(("wide", "done"), [(0.1, True), (0.3, False), (np.inf, False)])
def test_a_strip_whose_image_is_too_wide_or_lost_is_not_settled(monkeypatch, wall, wide, done):
    """Even if it comes home later."""
    calls = []

    def carried(map, sets):
        calls.append(sets.chart.size)
        rest = np.full_like(sets.rest, wide if len(calls) == 1 else 1e-9)
        return np.arange(sets.chart.size), replace(sets, sides=0 * sets.sides, rest=rest)

    monkeypatch.setattr(strips_of, "carried", carried)
    monkeypatch.setattr(strips_of, "FEW", 0.0)
    monkeypatch.setattr(Core, "enters", lambda self, sets: np.full(sets.chart.size, len(calls) >= 2))
    assert settled(wall, CORE, one_strip())[0].tolist() == [done]


def test_strips_that_have_not_come_home_when_bounces_are_over_are_not_settled(monkeypatch, wall):
    monkeypatch.setattr(strips_of, "carried", lambda map, sets: (np.arange(sets.chart.size), sets))
    monkeypatch.setattr(Core, "enters", lambda self, sets: sets.middle[0] < 0.1)
    two = strips_of.joined([one_strip(), one_strip()._replace(left=floats(0.0), right=floats(0.01))])
    assert settled(wall, CORE, two)[0].tolist() == [False, True]
