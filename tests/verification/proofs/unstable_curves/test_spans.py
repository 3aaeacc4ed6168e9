"""Images of spans of unstable curves, under maps known in closed form."""

import numpy as np
import pytest
from broken_line import CHARTS

from verification.proofs.unstable_curves.spans import PAD, SpanMap, Spans
from verification.rigorous.boxes import collected

CLOSE = 8 * PAD  # what a few paddings add


class Circle:
    """Three charts of length 1, 2 and 1 around a circle: `s` goes to `by*s + on`, and heights shrink to a quarter."""

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
    """One span of a chart, from `low` to `high`, with ranges of heights at both ends."""
    one = lambda *xs: tuple(np.array([x]) for x in xs)  # noqa: E731
    return Spans(np.array([7]), np.array([chart]), *one(low, high), one(*first), one(*last))


def bounds(at, left, right, slopes):
    """The heights at `at` between which a curve lies whose ends are in the boxes `(low, high, down, up)`."""
    fall, rise = min(slopes[0], 0.0), max(slopes[1], 0.0)
    low = max(left[2] + fall * (at - left[0]), right[2] - rise * (right[1] - at))
    high = min(left[3] + rise * (at - left[0]), right[3] - fall * (right[1] - at))
    return max(low, -1.0), min(high, 1.0)


def laid(found):
    """Spans by their position along the circle, sorted."""
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
def test_the_image_of_a_curve_is_cut_where_charts_meet(by_hand, by, on, closed, wanted, slopes):
    course = SpanMap(by_hand(Circle(by, on, closed), slopes=slopes, sign=int(np.sign(by)), most=np.log(abs(by))))
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
