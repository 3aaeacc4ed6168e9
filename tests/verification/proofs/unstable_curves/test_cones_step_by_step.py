"""Cones of slopes: what arrives is inside, and one cell over which too little is known is enough to refuse."""

from dataclasses import replace

import numpy as np
import pytest

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import Slopes
from verification.proofs.unstable_curves import cover as room
from verification.proofs.unstable_curves.affine import BrokenLine
from verification.proofs.unstable_curves.cover import LEAST, WIDENED, cover


def test_cones_hold_the_images_of_those_that_lead_to_them_and_stretches_and_areas_are_those_of_the_formula(bent):
    """A vector `(1, m)` goes to `(s + m, b)`, in the direction `b/(s + m)`."""
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
    assert bent.area == pytest.approx(np.full(slope.size, np.log(0.0625)), abs=1e-9)
    assert np.all(bent.area >= np.log(0.0625))
    assert bent.sign == (1, -1)
    assert bent.contracts


@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
def test_a_region_is_refused_of_which_one_cell_alone_leads_outside(bent, monkeypatch, share):
    true = room.transitions

    def leaking(*given):
        found = true(*given)
        edges = found.edges.tolil()
        edges[int(share * bent.cells.chart.size), -1] = 1
        return replace(found, edges=edges.tocsr())

    start = bent.grid.boxes(bent.cells)
    assert not isinstance(cover(bent.map, 64, 16, start), str)
    monkeypatch.setattr(room, "transitions", leaking)
    assert cover(bent.map, 64, 16, start) == "no trapping region: an image leaves the cells"


@pytest.fixture
def grown(bent, monkeypatch):
    """Makes a cover from ranges of slopes that are said to arrive, one round after the other; then the last again.

    The first cell is said to be entered by none; the second has ranges of its own.
    """

    def made(*ranges, second=None):
        rounds = iter(ranges)
        last = [ranges[-1]]

        def arriving(map, found, inner, cells, cones):
            low, high = (np.full(cells.chart.size, float(end)) for end in next(rounds, last[0]))
            low[0], high[0] = np.inf, -np.inf
            if second:
                low[1], high[1] = second
            return low, high

        monkeypatch.setattr(room, "arriving", arriving)
        return cover(bent.map, 64, 16, bent.grid.boxes(bent.cells))

    return made


@pytest.mark.parametrize(
    "ends",
    [
        (-1e-3, 0.0),
        (0.0, 1e-3),
        (-1e-3, 2e-3),
        (-LEAST, 0.0),
        (0.0, LEAST),
        (-0.5e-9, 0.5e-9),
        (1e-3, 2e-3),
    ],
)
def test_cones_are_widened_until_what_arrives_is_inside(grown, ends):
    low, high = ends
    found = grown(ends)
    wide = (high - low) * WIDENED + LEAST
    taken = low > -LEAST and high < LEAST  # by the first cones
    wanted = (-LEAST, LEAST) if taken else (min(-LEAST, low - wide), max(LEAST, high + wide))
    assert [float(end[5]) for end in found.outer] == pytest.approx(wanted, rel=1e-12)
    assert found.outer[0][5] < low
    assert high < found.outer[1][5]
    assert [float(end[0]) for end in found.outer] == [float(end[0]) for end in found.cones] == [-LEAST, LEAST]
    if low < high:
        assert [float(end[5]) for end in found.cones] == [low, high]


def test_cones_without_an_inside_or_with_an_end_that_is_not_known_are_refused(grown):
    assert "vertical" in grown((1e-3, 1e-3))
    for ends in ((-np.inf, 1e-3), (-1e-3, np.inf), (-np.inf, np.inf)):
        assert "vertical" in grown((-1e-3, 1e-3), second=ends)
    assert "without end" in grown(*((-(1.1**n), 0.0) for n in range(70)))
    assert "without end" in grown(*((0.0, 1.1**n) for n in range(70)))


def one_cell(change):
    """Changes what is said of the derivative over one cell, and of it alone."""

    def derivatives(*given):
        found = true(*given)
        return change(found, found.source == 7)

    true = room.derivatives
    return derivatives


def with_radius(ball, on, radius):
    """A ball with another radius for some entries."""
    return BallArray(ball.m, np.where(on, radius, ball.r))


@pytest.mark.parametrize(
    "change",
    [
        lambda f, on: f._replace(slopes=f.slopes._replace(by_theta=with_radius(f.slopes.by_theta, on, 4.0))),
        lambda f, on: f._replace(slopes=f.slopes._replace(drift=with_radius(f.slopes.drift, on, np.inf))),
        lambda f, on: type(f)(f.source[~on], f.chart[~on], type(f.slopes)(*(ball[~on] for ball in f.slopes))),
    ],
    ids=["stretched by nothing", "no determinant", "no derivative"],
)
def test_one_cell_over_which_derivatives_are_not_known_is_enough(grown, monkeypatch, change):
    assert not isinstance(grown((-1e-3, 2e-3)), str)
    monkeypatch.setattr(room, "derivatives", one_cell(change))
    assert "vertical" in grown((-1e-3, 2e-3))


def test_one_cone_without_an_inside_is_enough_but_its_image_may_be_horizontal(grown, monkeypatch):
    assert "vertical" in grown((-1e-3, 2e-3), second=(1e-3, 1e-3))
    zero = lambda ball, on: BallArray(np.where(on, 0.0, ball.m), np.where(on, 0.0, ball.r))  # noqa: E731
    flat = lambda f, on: f._replace(  # noqa: E731
        slopes=f.slopes._replace(law=zero(f.slopes.law, on), drift=zero(f.slopes.drift, on))
    )
    monkeypatch.setattr(room, "derivatives", one_cell(flat))
    found = grown((-1e-3, 2e-3))
    assert np.flatnonzero(found.area < -100).tolist() == [7]


def test_areas_shrink_by_the_determinant(grown, monkeypatch):
    """Of `((2, 1/4), (-5/8, -5/32))`: 5/32."""
    numbers = {"by_theta": 2.0, "by_phi": 0.25, "bend_here": -3.0, "bend_there": 0.5, "law": 0.125, "drift": -0.0625}

    def change(f, on):
        balls = {name: BallArray(np.full(on.size, x), np.zeros(on.size)) for name, x in numbers.items()}
        return f._replace(slopes=Slopes(**balls))

    monkeypatch.setattr(room, "derivatives", one_cell(change))
    found = grown((-1e-3, 2e-3))
    assert found.area == pytest.approx(np.full(found.area.size, np.log(5 / 32)), abs=1e-12)
    assert found.least[5] == pytest.approx(np.log(2 - 0.25e-3), abs=1e-12)
    assert found.sign == (1, 1)


def test_a_chart_without_cells_has_no_sign():
    """The fixed point of `x -> x/2 + 1/2 + y` attracts and lies on the second chart."""
    x = 0.5 / (1 - 0.5 - 0.0625)
    map = BrokenLine(((-2.0, -0.5), (0.0, 0.5), (2.0, 1.5)), 0.0625, 0.125)
    found = cover(map, 64, 64, Boxes(np.array([1]), (np.array([x]),) * 2, (np.array([x / 16]),) * 2))
    assert found.sign == (0, 1)


def test_after_some_bounces_cones_are_what_arrived_last_within_what_arrived_before(grown):
    outer = [(-1e-2, 1e-2)] * 2
    found = grown(*outer, (-8e-3, 9e-3), (-9e-3, 7e-3), (-6e-3, 8e-3), (-5e-3, 6e-3), (-4e-3, 5e-3), (-1e-3, 1e-3))
    assert [float(end[5]) for end in found.cones] == [-4e-3, 5e-3]
    assert found.outer[1][5] == pytest.approx(1e-2 + 2e-2 * WIDENED + LEAST, rel=1e-12)


class Made(BrokenLine):
    """A broken line with another derivative."""

    def __init__(self, line, slopes, of=lambda boxes, found: found):
        super().__init__(line.knots, line.b, line.height)
        object.__setattr__(self, "made", slopes)
        object.__setattr__(self, "of", of)

    def derivatives(self, boxes):
        return self.of(
            boxes, [(piece, self.made(boxes.chosen(piece.on), found)) for piece, found in super().derivatives(boxes)]
        )


def turned(boxes, found):
    """The slope of one half of the first chart has another sign."""
    sign = np.where((boxes.chart == 0) & (boxes.x[0] < -0.5), -1.0, 1.0)
    slope = BallArray(found.by_theta.m * sign, found.by_theta.r)
    return found._replace(by_theta=slope, bend_here=-(slope + 1))


def flat(boxes, found):
    """A vector of slope 0 becomes vertical."""
    slope = found.by_theta * 0.0
    return found._replace(by_theta=slope, bend_here=-(slope + 1))


def wild(boxes, found):
    """Nothing is known of the determinant."""
    return found._replace(drift=BallArray(found.law.m, found.law.r + np.inf))


@pytest.mark.parametrize(
    ("slopes", "said"),
    [(turned, "in one part of a chart"), (flat, "may become vertical"), (wild, "may become vertical")],
)
def test_cones_that_are_not_carried_along_are_refused(bent, slopes, said):
    start = bent.grid.boxes(bent.cells)
    assert said in cover(Made(bent.map, slopes), 64, 16, start)
    assert not isinstance(cover(Made(bent.map, lambda boxes, found: found), 64, 16, start), str)


def test_a_rotation_has_no_cones(bent):
    """By a quarter turn: horizontal vectors become vertical; by less, cones grow without end."""

    def rotated(boxes, found):
        one = found.by_phi
        return found._replace(by_theta=one * 0.8, by_phi=one * -0.6, bend_here=-(one * 1.6), law=-one, drift=-one)

    said = cover(Made(bent.map, rotated), 64, 16, bent.grid.boxes(bent.cells))
    assert isinstance(said, str)
    assert "no cones" in said
