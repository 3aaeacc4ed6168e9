"""Boxes about phase points, the cells that they meet, and sets of cells that hold their images."""

import numpy as np
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.global_dynamics import crisis
from verification.proofs.global_dynamics.apart import _held, kept_apart
from verification.proofs.global_dynamics.boxes import Boxes, Chart, Images
from verification.proofs.global_dynamics.crisis import _marked, _meets, _next, _within, boxed, grown
from verification.proofs.global_dynamics.graph import Grid, Rectangles


def test_the_cells_of_rectangles_are_marked_and_no_others():
    """Up to the last row, in two charts, and over the seam of the columns."""
    grid = Grid(tuple(Chart(name, (0, 1), (0, 1)) for name in "ab"), 6, 4)
    rows = [(0, 1, 2, 0, 1), (0, 4, 7, 2, 3), (1, 5, 5, 3, 3), (1, 0, 5, 0, 0)]  # chart, left, right, bottom, top
    chart, *sides = (np.array(column) for column in zip(*rows, strict=True))
    wanted = np.zeros((2, 6, 4), dtype=bool)
    for number, left, right, bottom, top in rows:
        wanted[number, [column % 6 for column in range(left, right + 1)], bottom : top + 1] = True

    assert np.array_equal(_marked(grid, Rectangles(np.arange(4), chart, *sides, np.zeros(4, dtype=bool))), wanted)


def test_the_cells_of_rectangles_that_overlap_are_marked_as_well_as_those_of_one():
    random, grid = np.random.default_rng(3), Grid(tuple(Chart(name, (0, 1), (0, 1)) for name in "ab"), 6, 4)
    for _ in range(20):
        chart, left, bottom = random.integers(0, (2, 6, 4), (5, 3)).T
        right, top = left + random.integers(0, 6, 5), np.minimum(bottom + random.integers(0, 4, 5), 3)
        wanted = np.zeros((2, 6, 4), dtype=bool)
        for number, a, b, c, d in zip(chart, left, right, bottom, top, strict=True):
            wanted[number, np.arange(a, b + 1) % 6, c : d + 1] = True
        met = Rectangles(np.arange(5), chart, left, right, bottom, top, np.zeros(5, dtype=bool))
        assert np.array_equal(_marked(grid, met), wanted)


def test_boxes_of_which_one_leaves_the_chart_do_not_lie_in_its_cells():
    grid = Grid((Chart("plane", (0.0, 1.0), (0.0, 1.0)),), 4, 4)
    for ends, held in (((0.5, 0.75), True), ((0.5, 1.25), False), ((-0.25, 0.5), False), ((-0.25, 1.25), False)):
        at = np.array(ends)
        boxes = Boxes(np.zeros(2, dtype=int), (at, at), (np.full(2, 0.5),) * 2)
        assert _within((grid, np.ones((1, 4, 4), dtype=bool)), boxes) is held
    assert crisis._as_images(boxes).lost.size == 0


def test_boxes_about_phase_points_hold_them_up_to_whole_turns():
    random = np.random.default_rng(1)
    rows = random.uniform((-40, -1.5, 0), (40, 1.5, 0.1), (50, 3))
    points = [(arb(theta, radius), arb(phi, radius)) for theta, phi, radius in rows]
    boxes = boxed(points)
    with working(200):
        for k, ball in enumerate(points):
            middle = (boxes.x[0][k] + boxes.x[1][k]) / 2
            turns = round(float(ball[0].mid() - middle) / (2 * np.pi))
            for x, ends, by in zip(ball, (boxes.x, boxes.y), (turns, 0), strict=True):
                low, high = (arb(float(end[k])) + by * 2 * arb.pi() for end in ends)
                assert low < x.lower()
                assert x.upper() < high
                assert high - low < 2 * x.rad() + 2.5e-14 * (1 + 2 * np.pi * abs(by))
            assert abs(middle) <= np.pi + 1e-9
    for bad in ((arb("nan"), arb(0)), (arb(0), arb(0, "inf"))):
        assert boxed([(arb(0), arb(0)), bad]) is None


class Thirds:
    """A map of a closed chart that draws each third of it together about the middle, and may turn it."""

    charts = (Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),)
    closed = True

    def __init__(self, turn=0.0, lost=(), twice=False):
        self.turn, self.lost, self.twice = 2 * np.pi * turn, np.array(lost, dtype=int), twice

    def images(self, boxes):
        on = np.setdiff1d(np.arange(boxes.chart.size), self.lost)
        on = np.repeat(on, 2) if self.twice else on
        centre = 0.05 + np.rint(((boxes.x[0] + boxes.x[1]) / 2 - 0.05) / (2 * np.pi / 3))[on] * (2 * np.pi / 3)
        ends = tuple(centre + (x[on] - centre) / 2 + self.turn for x in boxes.x), tuple(y[on] / 2 for y in boxes.y)
        return Images(on, Boxes(boxes.chart[on], *ends), self.lost)


def at(*thetas, width=0.01):
    return boxed([(arb(theta, width), arb(0, width)) for theta in thetas])


def test_boxes_are_followed_only_where_each_has_one_image_that_is_proved():
    moved = _next(Thirds(0.4), at(0.05, 2.05))
    centres = [0.05 + 0.8 * np.pi, (0.05 + 2 * np.pi / 3 + 2.05) / 2 + 0.8 * np.pi - 2 * np.pi]

    assert np.allclose([(a + b) / 2 for a, b in zip(*moved.x, strict=True)], centres)
    assert np.allclose(moved.x[1] - moved.x[0], 0.01)
    assert _next(Thirds(lost=[1]), at(0.1, 3.1)) is None
    assert _next(Thirds(twice=True), at(0.1, 3.1)) is None


def test_a_set_that_grows_holds_its_image_and_none_is_found_where_a_box_is_lost():
    size = (30, 8, 1)
    for turn, copies in ((0.0, 1), (1 / 3, 3)):
        grid, member = grown(Thirds(turn), size, at(0.05))
        assert copies <= member[0].any(1).sum() <= 4 * copies
        assert 2 <= member[0].any(0).sum() <= 4
        assert _within((grid, member), at(0.05))
        assert _within((grid, member), at(0.05 + 2 * np.pi / 3)) is (copies == 3)
        assert _meets((grid, member), (grid, member))
        assert not _meets((grid, member), (grid, member & False))
    grid, member = grown(Thirds(0.0), size, at(0.05))
    far = np.roll(member, 5, 1)
    assert not _meets((grid, member), (grid, far))
    assert _meets((grid, member), (grid, np.roll(member, 1, 1)))  # cells next to each other share a border
    assert not _within((grid, far), at(0.05))
    assert not _within((grid, member), at(0.05, width=0.9))
    assert grown(Thirds(0.0, lost=[0]), size, at(0.05)) is None


def test_a_region_apart_from_its_turned_copies_is_told_by_its_angles():
    here = at(0.05)
    angles = kept_apart(Thirds(0.0), (30, 8, 1), here)
    width = 2 * np.pi / 30

    assert any(abs(x - 0.05) <= width for x in angles)
    assert max(abs(x - 0.05) for x in angles) < 3 * width
    assert np.allclose((angles + np.pi) / width % 1, 0.5)
    assert kept_apart(Thirds(1 / 3), (30, 8, 1), here) is None  # a copy is reached
    assert kept_apart(Thirds(2 / 3), (30, 8, 1), here) is None
    assert kept_apart(Thirds(0.0), (32, 8, 1), here) is None  # thirds are no columns
    assert kept_apart(Thirds(0.0), (30, 8, 1), boxed([(arb("nan"), arb(0))])) is None
    open_ = Thirds(0.0)
    open_.closed = False
    assert kept_apart(open_, (30, 8, 1), here) is None


def test_numbers_are_held_by_a_list_in_order_up_to_its_first_and_its_last():
    chance = np.random.default_rng(4)
    for size in (0, 1, 2, 9):
        ordered = np.unique(chance.integers(0, 20, size))
        assert np.array_equal(_held(np.arange(-2, 23), ordered), np.isin(np.arange(-2, 23), ordered))
