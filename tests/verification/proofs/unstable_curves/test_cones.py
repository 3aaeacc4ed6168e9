"""Cones of slopes: they contain all arriving slopes, and maps that do not preserve them are refused."""

import numpy as np
import pytest
from broken_line import BrokenLine

from verification.arithmetic.arrays import BallArray
from verification.proofs.unstable_curves.cover import cover


def test_cones_hold_their_images_and_stretches_are_the_formulas(bent):
    """A vector `(1, m)` is mapped to `(s + m, b)`, which has the slope `b/(s + m)`."""
    edges = bent.inner.tocoo()
    slope = np.array([1.5, -1.75])[bent.cells.chart]
    for cones in (bent.outer, bent.cones):
        for end in cones:
            there = 0.0625 / (slope + end)
            assert np.all(cones[0][edges.col] < there[edges.row] + 1e-14)
            assert np.all(there[edges.row] < cones[1][edges.col] + 1e-14)
    entered = np.unique(edges.col)
    lows, highs = (np.full(bent.cells.chart.size, sign * np.inf) for sign in (1, -1))
    ends = [0.0625 / (slope + end) for end in bent.cones]
    np.minimum.at(lows, edges.col, np.minimum(*ends)[edges.row])
    np.maximum.at(highs, edges.col, np.maximum(*ends)[edges.row])
    assert np.all(bent.outer[0][entered] < lows[entered])
    assert np.all(bent.outer[1][entered] > highs[entered])
    assert bent.cones[0][entered] == pytest.approx(lows[entered], rel=0.05)
    assert bent.cones[1][entered] == pytest.approx(highs[entered], rel=0.05)
    assert np.all(bent.outer[1] - bent.outer[0] > 2e-9)
    size = np.abs([slope + end for end in bent.cones])
    assert bent.least == pytest.approx(np.log(size.min(axis=0)), abs=1e-9)
    assert bent.most == pytest.approx(np.log(size.max(axis=0)), abs=1e-9)
    assert bent.sign == (1, -1)


class Made(BrokenLine):
    """A broken line with an altered derivative."""

    def __init__(self, line, slopes, of=lambda boxes, found: found):
        super().__init__(line.knots, line.b, line.height)
        object.__setattr__(self, "made", slopes)
        object.__setattr__(self, "of", of)

    def derivatives(self, boxes):
        return self.of(
            boxes, [(piece, self.made(boxes.chosen(piece.on), found)) for piece, found in super().derivatives(boxes)]
        )


def turned(boxes, found):
    """The derivative with the sign reversed on one half of the first chart."""
    sign = np.where((boxes.chart == 0) & (boxes.x[0] < -0.5), -1.0, 1.0)
    slope = BallArray(found.by_theta.m * sign, found.by_theta.r)
    return found._replace(by_theta=slope, bend_here=-(slope + 1))


def flat(boxes, found):
    """The derivative with slope 0, which makes vectors of slope 0 vertical."""
    slope = found.by_theta * 0.0
    return found._replace(by_theta=slope, bend_here=-(slope + 1))


def wild(boxes, found):
    """The derivative with an unknown determinant."""
    return found._replace(drift=BallArray(found.law.m, found.law.r + np.inf))


@pytest.mark.parametrize(
    ("slopes", "said"),
    [(turned, "in one part of a chart"), (flat, "may become vertical"), (wild, "may become vertical")],
)
def test_cones_that_are_not_carried_along_are_refused(bent, slopes, said):
    start = bent.grid.boxes(bent.cells)
    assert said in cover(Made(bent.map, slopes), 64, 16, start)
    assert not isinstance(cover(Made(bent.map, lambda boxes, found: found), 64, 16, start), str)
