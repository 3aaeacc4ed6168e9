"""Images and derivatives of broken lines: those by the formula, cut where pieces meet, lost beyond the charts."""

from itertools import pairwise

import numpy as np
import pytest

from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.unstable_curves.affine import BrokenLine, lozi

LINE = BrokenLine(((-2.0, -1.0), (-0.5, 1.5), (1.0, 0.25), (2.0, -1.5)), 0.125, 0.25)


def sent(line, x, y):
    """A point's image, by the formula."""
    return np.interp(x, *zip(*line.knots, strict=True)) + y, line.b * x


def box(chart, x, y):
    """One box."""
    one = lambda ends: tuple(np.array([float(end)]) for end in ends)  # noqa: E731
    return Boxes(np.array([chart]), one(x), one(y))


@pytest.mark.parametrize(
    ("chart", "x", "y"),
    [
        (0, (-1.75, -1.5), (-0.125, 0.125)),
        (0, (-1.0, -0.5), (0.0, 0.0625)),
        (1, (-0.5, 1.0), (-0.25, 0.25)),
        (2, (1.0, 1.125), (-0.25, 0.0)),
        (2, (1.5, 2.0), (0.0, 0.25)),
    ],
)
def test_an_image_is_the_hull_of_those_of_the_corners_cut_where_pieces_meet(chart, x, y):
    ends = [sent(LINE, a, b) for a in x for b in y]
    low, high = min(u for u, _ in ends), max(u for u, _ in ends)
    found = LINE.images(box(chart, x, y))
    assert found.lost.size == 0
    assert np.all(found.source == 0)
    knots = [knot for knot, _ in LINE.knots]
    wanted = [(k, max(low, a), min(high, c)) for k, (a, c) in enumerate(pairwise(knots))]
    wanted = [(k, a, c) for k, a, c in wanted if a <= c]
    assert found.boxes.chart.tolist() == [k for k, _, _ in wanted]
    assert found.boxes.x[0] == pytest.approx([a for _, a, _ in wanted], abs=1e-12)
    assert found.boxes.x[1] == pytest.approx([c for _, _, c in wanted], abs=1e-12)
    assert min(found.boxes.x[0]) <= low
    assert high <= max(found.boxes.x[1])
    down, up = LINE.b * x[0], LINE.b * x[1]
    assert np.all(found.boxes.y[0] <= down)
    assert np.all(up <= found.boxes.y[1])
    assert found.boxes.y[0] == pytest.approx(np.full(len(wanted), down), abs=1e-12)
    assert found.boxes.y[1] == pytest.approx(np.full(len(wanted), up), abs=1e-12)


def test_an_image_that_ends_where_pieces_meet_is_on_both():
    found = BrokenLine(((-2.0, -1.0), (0.0, 1.0), (2.0, -1.0)), 0.125, 0.25).images(box(0, (-1.5, -1.0), (0.0, 0.0)))
    assert found.boxes.chart.tolist() == [0, 1]
    found = BrokenLine(((-2.0, -1.0), (0.0, 1.0), (2.0, -1.0)), 0.125, 0.25).images(box(0, (-1.0, -0.5), (0.0, 0.0)))
    assert found.boxes.chart.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("b", "x", "y", "lost"),
    [
        (0.125, (0.0, 0.5), (0.0, 0.25), False),
        (0.125, (0.0, 0.5), (0.0, 0.75), True),  # to 2.25
        (0.125, (0.0, 0.5), (-4.0, 0.0), True),  # to -2.9
        (-0.125, (1.5, 2.0), (0.0, 0.0), False),  # down to -0.25
        (-0.15, (1.5, 2.0), (0.0, 0.0), True),
        (0.15, (1.5, 2.0), (0.0, 0.0), True),
        (-0.15, (-2.0, -1.5), (0.0, 0.0), True),
        (0.15, (-2.0, -1.5), (0.0, 0.0), True),
        (0.1249, (1.5, 2.0), (0.0, 0.0), False),
    ],
)
def test_a_box_of_which_some_part_leaves_the_charts_is_lost(b, x, y, lost):
    line = BrokenLine(((-2.0, -1.5), (0.0, 1.5), (2.0, -1.5)), b, 0.25)
    found = line.images(box(int(x[0] >= 0), x, y))
    assert found.lost.tolist() == [0] * lost
    assert (found.source.size == 0) is lost


def test_derivatives_are_those_of_the_formula_for_each_chart_where_a_box_lands():
    for chart, slope in enumerate((5 / 3, -5 / 6, -1.75)):
        x = np.mean([LINE.knots[chart][0], LINE.knots[chart + 1][0]])
        ((piece, slopes),) = LINE.derivatives(box(chart, (x - 0.125, x + 0.125), (-0.125, 0.125)))
        images = LINE.images(box(chart, (x - 0.125, x + 0.125), (-0.125, 0.125)))
        assert piece.smooth
        assert piece.on.tolist() == images.source.tolist()
        assert piece.chart.tolist() == images.boxes.chart.tolist()
        assert (piece.low.tolist(), piece.high.tolist()) == tuple(end.tolist() for end in images.boxes.x)
        for row, wanted in zip(matrix(slopes), ((slope, 1.0), (0.125, 0.0)), strict=True):
            for entry, value in zip(row, wanted, strict=True):
                assert np.all(np.abs(entry.m - value) <= entry.r + 1e-15)
                assert np.all(entry.r < 1e-12)


def test_charts_are_the_pieces_each_joined_to_the_next():
    assert [chart.x for chart in LINE.charts] == [(-2.0, -0.5), (-0.5, 1.0), (1.0, 2.0)]
    assert {chart.y for chart in LINE.charts} == {(-0.25, 0.25)}
    assert all(chart.kept and not chart.period for chart in LINE.charts)
    assert LINE.joins == ((0, 1), (1, 2))
    assert [BrokenLine(LINE.knots, b, 0.25).homeomorphism for b in (0.0, 1.0, -0.5)] == [False, True, True]


def test_lozis_map_is_that_of_a_tent():
    for x, y in ((-1.5, 0.25), (0.0, -0.5), (0.75, 0.125)):
        assert sent(lozi(1.6, -0.25), x, y) == pytest.approx((1 - 1.6 * abs(x) + y, -0.25 * x))
    made = lozi(1.6, -0.25)
    assert (made.height, made.knots[0][0], made.knots[-1][0]) == (0.5, -2.0, 2.0)
