"""Boxes about phase points, the cells that they meet, and sets of cells that contain their images."""

import numpy as np
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.global_dynamics.crisis import bounding_boxes
from verification.rigorous.absorbing import grown, kept_apart
from verification.rigorous.boxes import Boxes, Chart, Images


def test_boxes_about_phase_points_hold_them_up_to_whole_turns():
    random = np.random.default_rng(1)
    rows = random.uniform((-40, -1.5, 0), (40, 1.5, 0.1), (50, 3))
    points = [(arb(theta, radius), arb(phi, radius)) for theta, phi, radius in rows]
    boxes = bounding_boxes(points)
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
        assert bounding_boxes([(arb(0), arb(0)), bad]) is None


class Thirds:
    """A map of a closed chart that contracts each third about its middle, and may turn the chart."""

    charts = (Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),)

    def __init__(self, turn=0.0, lost=(), twice=False):
        self.turn, self.lost, self.twice = 2 * np.pi * turn, np.array(lost, dtype=int), twice

    def images(self, boxes):
        on = np.setdiff1d(np.arange(boxes.chart.size), self.lost)
        on = np.repeat(on, 2) if self.twice else on
        centre = 0.05 + np.rint(((boxes.x[0] + boxes.x[1]) / 2 - 0.05) / (2 * np.pi / 3))[on] * (2 * np.pi / 3)
        ends = tuple(centre + (x[on] - centre) / 2 + self.turn for x in boxes.x), tuple(y[on] / 2 for y in boxes.y)
        return Images(on, Boxes(boxes.chart[on], *ends), self.lost)


def at(*thetas, width=0.01):
    return bounding_boxes([(arb(theta, width), arb(0, width)) for theta in thetas])


def test_a_set_that_grows_holds_its_image():
    """Grown from the middle of one third, and also from its copies if the map turns the chart by thirds."""
    size, column = (30, 8, 1), int((0.05 + np.pi) / (2 * np.pi) * 30)
    for turn, copies in ((0.0, 1), (1 / 3, 3)):
        found = grown(Thirds(turn), size, at(0.05))
        columns, rows = {*found.cells.column}, {*found.cells.row}
        assert copies <= len(columns) <= 4 * copies
        assert 2 <= len(rows) <= 4
        assert all(((column + 10 * k) % 30 in columns) is (copies == 3 or k == 0) for k in range(3))
        assert found.holds(Thirds(turn).images(found.boxes).boxes)
        assert found.meets(at(0.05, width=2.0))
        assert not found.holds(at(0.05, width=2.0))
        assert not found.meets(at(0.05 + np.pi / 3))
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
    assert kept_apart(Thirds(0.0), (30, 8, 1), bounding_boxes([(arb("nan"), arb(0))])) is None
    open_ = Thirds(0.0)
    open_.charts = (Thirds.charts[0]._replace(period=False),)
    assert kept_apart(open_, (30, 8, 1), here) is None
