"""Spans of unstable curves, one step at a time: maps that are known in closed form, and covers written by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from verification.proofs.global_dynamics.boxes import Boxes, Chart, collected
from verification.proofs.global_dynamics.graph import Cells
from verification.proofs.unstable_curves.affine import BrokenLine
from verification.proofs.unstable_curves.spans import PAD, WIDEST, Course, Spans, longest

CHARTS = tuple(Chart(name, ends, (-1.0, 1.0)) for name, ends in (("a", (-1.0, 0.0)), ("b", (3.0, 5.0)), ("c", (0, 1))))
CLOSE = 8 * PAD  # what a few paddings add


class Circle:
    """Three charts of length 1, 2 and 1 end to end around a circle: `s` goes to `by*s + on`, heights to a quarter."""

    label, homeomorphism = "a circle", True
    charts = CHARTS
    starts = np.array([0.0, 1.0, 3.0, 4.0])

    def __init__(self, by, on, closed=True):
        self.by, self.on, self.joins = by, on, ((0, 1), (1, 2), (2, 0))[: 3 if closed else 2]

    def images(self, boxes):
        rows, lows = [], np.array([chart.x[0] for chart in CHARTS])
        along = [self.starts[boxes.chart] + x - lows[boxes.chart] for x in boxes.x]
        a, b = sorted((self.by * s + self.on for s in along), key=lambda s: s.sum())
        for turn in range(-3, 4) if len(self.joins) == 3 else (0,):
            for chart in range(3):
                start, stop = self.starts[chart] + 4 * turn, self.starts[chart + 1] + 4 * turn
                on = np.flatnonzero((b >= start) & (a <= stop))
                ends = [np.clip(s[on], start, stop) - start + lows[chart] for s in (a, b)]
                rows.append((on, np.full(on.size, chart), *ends, *(y[on] / 4 for y in boxes.y)))
        return collected(rows, boxes.chart.size)


def span(chart, low, high, first, last):
    """One span."""
    one = lambda *xs: tuple(np.array([x]) for x in xs)  # noqa: E731
    return Spans(np.array([7]), np.array([chart]), *one(low, high), one(*first), one(*last))


def test_charts_lie_one_after_the_other_and_the_last_may_end_at_the_first(by_hand):
    course = Course(by_hand(Circle(1.0, 0.0)))
    assert course.starts.tolist() == [0, 1, 3, 4]
    assert course.lows.tolist() == [-1, 3, 0]
    assert course.around
    assert not Course(by_hand(Circle(1.0, 0.0, closed=False))).around
    turned = Circle(1.0, 0.0)
    turned.joins = ((0, 2), (1, 0))  # of other charts
    assert not Course(by_hand(turned)).around


def test_slopes_are_the_ends_of_all_cones(by_hand):
    region = by_hand(Circle(1.0, 0.0))
    region.cones[0][:] = np.linspace(-0.25, 0.125, region.cells.chart.size)
    region.cones[1][:] = np.linspace(0.75, 0.25, region.cells.chart.size)
    assert Course(region).slopes == (-0.25, 0.75)


@pytest.mark.parametrize("seed", range(3))
def test_heights_are_those_of_the_cells_of_a_column_and_of_both_columns_where_two_meet(by_hand, some_cells, seed):
    region = by_hand(Circle(1.0, 0.0), cells=some_cells(seed))
    course = Course(region)
    held = {(c, i): [] for c in range(3) for i in range(4)}
    for c, i, j in zip(*region.cells[:3], strict=True):
        held[c, i].append(j / 4 - 1)
    for c, chart in enumerate(CHARTS):
        wide = (chart.x[1] - chart.x[0]) / 4
        for i in range(4):
            rows = held[c, i]
            assert course.rows[0][c, i] == (pytest.approx(min(rows), abs=1e-12) if rows else np.inf)
            assert course.rows[1][c, i] == (pytest.approx(max(rows) + 0.25, abs=1e-12) if rows else -np.inf)
        for half in range(9):  # ends and middles of columns
            found = course.heights(np.array([c]), np.array([chart.x[0] + half * wide / 2]))
            meet = {min(half // 2, 3), max(0, (half - 1) // 2)}
            rows = [y for i in meet for y in held[c, i]]
            wanted = (min(rows), max(rows) + 0.25) if rows else (-WIDEST, WIDEST)
            assert [float(end[0]) for end in found] == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("slopes", [(-0.25, 0.5), (0.25, 0.5), (-0.5, -0.25)])
def test_a_curve_over_a_column_that_begins_in_a_cell_ends_as_far_from_it_as_slopes_allow(by_hand, some_cells, slopes):
    region = by_hand(Circle(1.0, 0.0), cells=some_cells(1), slopes=slopes)
    spans, boxes = Course(region).columns(), region.grid.boxes(region.cells)
    assert spans.origin.tolist() == list(range(region.cells.chart.size))
    assert spans.chart.tolist() == region.cells.chart.tolist()
    assert np.all((boxes.x[0] < spans.low) & (spans.low < boxes.x[0] + CLOSE))
    assert np.all((boxes.x[1] - CLOSE < spans.high) & (spans.high < boxes.x[1]))
    for at, ends in ((spans.low, spans.first), (spans.high, spans.last)):
        run = at - boxes.x[0]
        bottom, top = Course(region).heights(spans.chart, at)
        low = np.maximum(bottom, boxes.y[0] + min(slopes[0], 0) * run)
        high = np.minimum(top, boxes.y[1] + max(slopes[1], 0) * run)
        assert np.all((low - CLOSE < ends[0]) & (ends[0] <= low))
        assert np.all((high <= ends[1]) & (ends[1] < high + CLOSE))


def test_spans_cross_an_interval_that_they_end_with_in_its_own_chart():
    some = span(1, 3.25, 4.0, (0.0, 0.0), (0.0, 0.0))
    assert some.crossing(1, 3.25, 4.0).tolist() == [True]
    for chart, low, high in ((0, 3.25, 4.0), (1, 3.125, 4.0), (1, 3.25, 4.125)):
        assert some.crossing(chart, low, high).tolist() == [False]
    assert some.chosen(np.array([False])).origin.size == 0
    again = some.chosen(np.array([0, 0]))
    assert (again.first[1].size, again.last[0].size) == (2, 2)


def test_the_longest_spans_of_each_origin_are_kept():
    rng = np.random.default_rng(3)
    origin, low = rng.integers(0, 4, 40), rng.random(40)
    size = rng.permutation(40) / 64
    zero = np.zeros(40)
    some = Spans(origin, np.zeros(40, dtype=int), low, low + size, (zero, zero), (zero, zero))
    for kept in (1, 3, 50):
        found = longest(some, kept)
        for i in range(4):
            wanted = sorted(size[origin == i])[::-1][:kept]
            assert (found.high - found.low)[found.origin == i] == pytest.approx(wanted, abs=1e-12)


def landing(course, chart, theta, low, high, last=False):
    """Where an end of a span is sent: two places along the charts and two heights."""
    ends = (0.0, 0.0), (low, high)
    some = span(chart, *((0.0, theta) if last else (theta, 0.0)), *(ends if last else ends[::-1]))
    return [float(x[0]) for x in course.ends(some, last)]


def test_ends_are_sent_to_places_along_all_charts(by_hand):
    course = Course(by_hand(Circle(0.5, 1.0, closed=False)))
    for last in (False, True):
        low, high, down, up = landing(course, 1, 3.5, -0.5, 0.25, last)  # 1.5 along the charts, to 1.75
        assert 1.75 - CLOSE < low < 1.75 < high < 1.75 + CLOSE
        assert (down, up) == (-0.125, 0.0625)


def test_an_end_next_to_a_join_has_one_place_also_where_the_charts_close_a_circle(by_hand):
    """4 along the charts is 0: both landings are within a padding of one another, not a turn apart."""
    for on in (2.0, -2.0):
        low, high, _, _ = landing(Course(by_hand(Circle(1.0, on))), 1, 4.0, 0.0, 0.0)  # 2 along the charts
        assert high - low < CLOSE
        assert min(abs(low), abs(low - 4)) < CLOSE


class Scattered:
    """Lands in two rectangles, or is lost."""

    label, homeomorphism, joins, charts = "scattered", True, ((0, 1), (1, 2)), CHARTS

    def __init__(self, rows, lost=()):
        self.rows, self.gone = rows, np.array(lost, dtype=int)

    def images(self, boxes):
        columns = [np.array(column) for column in zip(*self.rows, strict=True)]
        source, chart, a, b, c, d = columns
        return SimpleNamespace(source=source, boxes=Boxes(chart, (a, b), (c, d)), lost=self.gone)


def test_an_end_that_lands_in_two_rectangles_is_in_their_hull_and_one_that_is_lost_is_nowhere(by_hand):
    rows = [(0, 0, -0.5, 0.0, 0.125, 0.5), (0, 1, 3.0, 3.5, -0.25, 0.25)]
    found = landing(Course(by_hand(Scattered(rows))), 0, 0.0, 0.0, 0.0)
    assert found == pytest.approx([0.5, 1.5, -0.25, 0.5], abs=CLOSE)
    assert landing(Course(by_hand(Scattered(rows[::-1]))), 0, 0.0, 0.0, 0.0) == pytest.approx(found, abs=CLOSE)
    assert np.all(np.isnan(landing(Course(by_hand(Scattered(rows, [0]))), 0, 0.0, 0.0, 0.0)))
    around = Scattered([(0, 1, 3.5, 3.75, 0.0, 0.0), (0, 1, 4.5, 4.75, 0.0, 0.0)])
    around.joins = Circle(1.0, 0.0).joins  # a turn is 4
    assert landing(Course(by_hand(around)), 0, 0.0, 0.0, 0.0)[:2] == pytest.approx([1.5, 2.75], abs=CLOSE)
    none = [(1, *rows[0][1:])]
    two = Spans(*(np.array([x, x]) for x in (0, 0, 0.0, 0.0)), *((np.zeros(2),) * 2 for _ in range(2)))
    found = Course(by_hand(Scattered(none))).ends(two, False)
    assert [np.isnan(x).tolist() for x in found] == [[True, False]] * 4


def bounds(at, left, right, slopes):
    """Between which heights a curve is at a place, whose ends are in boxes `(low, high, down, up)`."""
    fall, rise = min(slopes[0], 0.0), max(slopes[1], 0.0)
    low = max(left[2] + fall * (at - left[0]), right[2] - rise * (right[1] - at))
    high = min(left[3] + rise * (at - left[0]), right[3] - fall * (right[1] - at))
    return max(low, -1.0), min(high, 1.0)


def laid(found):
    """Spans with their ends along the charts of the circle, in order."""
    lows, starts = np.array([chart.x[0] for chart in CHARTS]), Circle.starts
    shift = starts[found.chart] - lows[found.chart]
    low, high = found.low + shift, found.high + shift
    rows = zip(low, high, *found.first, *found.last, strict=True)
    return sorted(tuple(map(float, row)) for row in rows)


@pytest.mark.parametrize(
    ("by", "on", "closed", "wanted"),
    [
        (2.0, -1.5, False, [(0.5, 1), (1, 2.5)]),  # of 1 to 2 along the charts
        (1.0, 0.25, False, [(1.25, 2.25)]),
        (2.0, -1.0, False, [(1, 3)]),
        (-2.0, 5.0, False, [(1, 3)]),
        (-2.0, 4.5, False, [(0.5, 1), (1, 2.5)]),
        (1.5, 2.0, True, [(0, 1), (3.5, 4)]),
        (1.5, -2.0, True, [(0, 1), (3.5, 4)]),
        (1.5, -6.0, True, [(0, 1), (3.5, 4)]),
        (-1.5, 1.0, True, [(2, 3), (3, 3.5)]),
        (-1.5, 2.25, True, [(0, 0.75), (3.25, 4)]),
        (1.5, 0.25, True, [(1.75, 3), (3, 3.25)]),
        (1.5, 2.375, True, [(0, 1), (1, 1.375), (3.875, 4)]),
    ],
)
@pytest.mark.parametrize("slopes", [(-0.25, 0.5), (-0.5, 0.125)])
def test_the_image_of_a_curve_is_cut_where_charts_meet_and_its_heights_follow_from_both_ends(
    by_hand, by, on, closed, wanted, slopes
):
    course = Course(by_hand(Circle(by, on, closed), slopes=slopes, sign=int(np.sign(by)), most=np.log(abs(by))))
    first, last = (-0.5, 0.25), (-0.25, 0.75)
    found = course.step(span(1, 3.0, 4.0, first, last))
    assert found.origin.tolist() == [7] * len(wanted)
    parts = laid(found)
    assert [part[:2] for part in parts] == [pytest.approx(ends, abs=CLOSE) for ends in wanted]
    assert all(a < part[0] and part[1] < b for part, (a, b) in zip(parts, wanted, strict=True))
    here, there = by + on, 2 * by + on  # where the ends land
    sides = [(here, here, -0.125, 0.0625), (there, there, -0.0625, 0.1875)]
    left, right = sides if by > 0 else sides[::-1]
    for a, b, *heights in parts:
        shift = 4 * np.floor((left[0] - a) / 4 + 1 - 1e-9)
        for at, found in ((a, heights[:2]), (b, heights[2:])):
            assert found == pytest.approx(bounds(at + shift, left, right, slopes), abs=CLOSE)


def test_heights_are_kept_within_the_cells_of_the_columns_where_a_part_ends(by_hand):
    """From the first column of the second chart to its third; and all heights where nothing is left."""
    chart, column, row = (np.array(x) for x in ((1, 1, 1, 1, 1), (0, 0, 1, 2, 2), (3, 4, 4, 2, 3)))
    cells = Cells(chart, column, row, np.ones(5, dtype=int))
    course = Course(by_hand(Circle(1.0, 0.25, closed=False), cells=cells))
    part = laid(course.step(span(1, 3.0, 4.0, (-3.0, 3.0), (-3.0, 3.0))))[0]
    assert part[2:] == pytest.approx((-0.25, 0.25, -0.5, 0.0), abs=CLOSE)
    for low, high, wanted in (
        (-0.125, 0.125, (-0.125, 0.125)),
        (0.25, 0.5, (0.25, 0.25)),
        (0.375, 0.5, (-0.25, 0.25)),
        (-0.5, -0.375, (-0.25, 0.25)),
    ):
        given = [np.array([x]) for x in (3.125, low, high)]
        assert [float(x[0]) for x in course._within(np.array([1]), *given)] == pytest.approx(wanted, abs=1e-12)


def test_ends_that_are_known_up_to_a_box_are_cut_off_and_heights_there_allow_for_it(by_hand):
    """The curve is sure to lie between the boxes; it may begin at the far side of either."""
    slopes = -0.25, 0.5
    rows = [(0, 1, 3.25, 3.5, 0.0, 0.125)], [(0, 1, 4.0, 4.5, 0.25, 0.375)]
    one = Course(by_hand(Scattered(rows[0]), slopes=slopes))
    ends = [[np.array([float(x)]) for x in side] for side in ((1.25, 1.5, 0.0, 0.125), (2.0, 2.5, 0.25, 0.375))]
    for sign, order in ((1, ends), (-1, ends[::-1])):
        course = Course(replace(one.cover, sign=(sign,) * 3))
        course.__dict__["slopes"] = slopes
        given = iter(order)
        object.__setattr__(course, "ends", lambda spans, last, given=given: tuple(next(given)))
        part = laid(course.step(span(1, 3.0, 4.0, (0.0, 0.0), (0.0, 0.0))))
        assert len(part) == 1
        assert part[0][:2] == pytest.approx((1.5, 2.0), abs=CLOSE)
        left, right = ([float(x[0]) for x in side] for side in ends)
        wanted = *bounds(1.5, left, right, slopes), *bounds(2.0, left, right, slopes)
        assert part[0][2:] == pytest.approx(wanted, abs=CLOSE)


@pytest.fixture
def stepped(by_hand):
    """Counts the parts of an image whose ends are given, of a curve that is `size` long."""

    def counted(ends, closed, size=0.25, most=0.0):
        course = Course(by_hand(Circle(1.0, 0.0, closed), most=most))
        course.cover.most[0] = 0.0  # the greatest counts
        given = iter([[np.array([float(x)]) for x in side] for side in ends])
        object.__setattr__(course, "ends", lambda spans, last: tuple(next(given)))
        return course.step(span(1, 3.0, 3.0 + size, (0.0, 0.0), (0.0, 0.0))).chart.size

    return counted


def test_nothing_is_known_of_an_image_whose_ends_overlap_are_lost_or_are_too_far_apart(stepped):
    near, far = (1.125, 1.25, 0.0, 0.0), (2.0, 2.125, 0.0, 0.0)
    for closed in (False, True):
        assert stepped([near, far], closed) == 1
        assert stepped([near, (1.25, 1.375, 0.0, 0.0)], closed) == 0  # they touch
        assert stepped([far, near], closed) == 0
        for unknown in ((np.nan,) * 4, (1.5, 1.625, -np.inf, 0.0)):
            assert stepped([near, unknown], closed) == 0
            assert stepped([unknown, far], closed) == 0
    wide = (1.0, 1.25, 0.0, 0.0)  # a sixteenth of a turn
    assert stepped([wide, far], False) == 1
    assert stepped([wide, far], True) == 0
    assert stepped([near, (2.0, 2.25, 0.0, 0.0)], False) == 1
    assert stepped([near, (2.0, 2.25, 0.0, 0.0)], True) == 0
    assert stepped([near, far], True, size=1.99) == 1
    assert stepped([near, far], True, size=2.0) == 0  # it may be half a turn long
    assert stepped([near, far], False, size=2.0) == 1
    assert stepped([near, far], True, size=1.25, most=np.log(2)) == 0
    assert stepped([near, far], True, size=0.75, most=np.log(2)) == 1
    assert stepped([near, far], True, size=2.0 - 1e-9) == 0  # rounding is allowed for


def test_ends_around_a_circle_are_compared_by_their_middles_whichever_turn_they_are_told_in(stepped):
    """A turn is 4, a curve shorter than half of one: from 0.12 to 2.11 it runs on, from 2.62 to 0.63 it does not."""
    flat = 0.0, 0.0
    for turn in (-8, -4, 0, 4):
        assert stepped([(0.0, 0.24, *flat), (1.99 + turn, 2.23 + turn, *flat)], True) == 2
        assert stepped([(2.5, 2.74, *flat), (0.51 + turn, 0.75 + turn, *flat)], True) == 0
        assert stepped([(-0.5 + turn, -0.375 + turn, *flat), (0.25, 0.375, *flat)], True) == 2
        assert stepped([(3.875 + turn, 4.125 - 1e-3 + turn, *flat), (4.5, 4.625, *flat)], True) == 1


def test_curves_of_a_broken_line_are_sent_to_those_that_its_formula_gives(by_hand):
    """A straight line goes to one piece on each chart; each height of it is between those of the spans there."""
    map = BrokenLine(((-2.0, -1.5), (0.0, 1.5), (2.0, -1.5)), 0.125, 0.25)
    region = by_hand(map, slopes=(-0.25, 0.25))
    course = Course(replace(region, sign=(1, -1)))
    for chart, low, high, a, b in ((0, -1.75, -0.25, 0.0, 0.125), (1, 0.25, 1.5, 0.125, -0.125)):
        found = course.step(span(chart, low, high, (a, a), (b, b)))
        x = np.linspace(low, high, 301)
        y = a + (b - a) * (x - low) / (high - low)
        there = 1.5 - 1.5 * abs(x) + y, x / 8
        parts = sorted(zip(found.chart.tolist(), found.low, found.high, *found.first, *found.last, strict=True))
        assert [part[0] for part in parts] == [0, 1]
        ends = min(there[0]), max(there[0])
        assert parts[0][1:3] == pytest.approx((ends[0], 0.0), abs=CLOSE)
        assert parts[1][1:3] == pytest.approx((0.0, ends[1]), abs=CLOSE)
        order = np.argsort(there[0])
        for part in parts:
            for at, (down, up) in ((part[1], part[3:5]), (part[2], part[5:7])):
                assert down <= np.interp(at, there[0][order], there[1][order]) + 1e-12 <= up + 2e-12
