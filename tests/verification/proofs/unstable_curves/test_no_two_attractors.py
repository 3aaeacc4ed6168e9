"""Growth of folded curves, and no two attractors: known answers, refusals, and the cuspless table."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from verification.proofs.global_dynamics import Boxes
from verification.proofs.unstable_curves.affine import BrokenLine, lozi
from verification.proofs.unstable_curves.anchor import anchor
from verification.proofs.unstable_curves.cover import cover
from verification.proofs.unstable_curves.growth import growth
from verification.proofs.unstable_curves.no_two_attractors import REFUSED, NoTwoAttractors, continuous
from verification.proofs.unstable_curves.spans import Course


def at(chart, x, y):
    """Points as boxes."""
    return Boxes(np.array(chart), (np.array(x),) * 2, (np.array(y),) * 2)


def about_the_fixed_point(a, b, columns=512):
    """What is to be proved of a Lozi map, from its fixed point on the right."""
    x = 1 / (1 + a - b)
    return NoTwoAttractors(lozi(a, b), columns, 512, at([1], [x], [b * x]), (1, x, b * x), 1, 0.1, 4)


LOZI = about_the_fixed_point(1.6, 0.05)
TWO = BrokenLine(((-2.0, -1.1), (-1.5, -1.9), (-1.0, -1.1), (1.0, 1.1), (1.5, 1.9), (2.0, 1.1)), 0.02, 0.04)
FIXED = (1.9 + 1.6 * 1.5) / (2.6 - 0.02)


def two(starts):
    """Of a map with an attractor on either side: what is to be proved of the region that grows from `starts`."""
    return NoTwoAttractors(TWO, 256, 256, starts, (4, FIXED, 0.02 * FIXED), 1, 0.06, 2)


@pytest.mark.parametrize(("a", "b"), [(1.6, 0.05), (1.5, 0.05)])
def test_the_closure_of_an_unstable_manifold_of_a_lozi_map_is_transitive_as_misiurewicz_proved(a, b):
    found = about_the_fixed_point(a, b)
    assert found.proved
    assert "at most one attractor" in found.reason
    assert found.checks["visits"] is None  # more than that is asked for it, and is not proved here


@pytest.mark.parametrize(("up", "down"), [(1.5, 1.9), (1.6, 1.7), (1.9, 1.5), (1.45, 1.45)])
def test_a_skew_tent_that_stretches_by_more_than_the_root_of_2_has_no_two_attractors(up, down):
    """The tent is transitive, as an interval grows until it holds the kink twice in a row; here it has a thin fibre."""
    x = 1 / (1 + down - 0.02)
    tent = BrokenLine(((-2.0, 1 - 2 * up), (0.0, 1.0), (2.0, 1 - 2 * down)), 0.02, 0.04)
    found = NoTwoAttractors(tent, 256, 256, at([1], [x], [0.02 * x]), (1, x, 0.02 * x), 1, 0.06, 2)
    assert found.proved, found.reason
    assert found.growth.sums[0] >= 1 / up + 1 / down > 1 > found.growth.sums[-1]


def test_the_sum_of_inverse_stretches_of_a_lozi_map_is_that_of_one_fold_in_two_bounces():
    """The least stretch is `(a + sqrt(a**2 - 4*b))/2`; a curve folded once in two bounces has two parts."""
    least = (1.6 + np.sqrt(1.6**2 - 0.2)) / 2
    assert LOZI.growth.bounces == 2
    assert LOZI.growth.sums[1] == pytest.approx(2 / least**2, rel=0.02)
    assert LOZI.growth.sums[1] >= 2 / least**2


def test_a_lozi_map_that_stretches_too_little_is_refused():
    """Below the square root of 2 two bounces do not undo one fold, and bands are swapped."""
    weak = about_the_fixed_point(1.2, 0.01)
    assert weak.growth.bounces is None or weak.growth.bounces > 2


def test_two_attractors_are_refused_together_and_each_is_one_by_itself():
    both = two(at([4, 0], [FIXED, -FIXED], [0.02 * FIXED, -0.02 * FIXED]))
    assert both.growth.bounces is not None
    assert both.checks["crossing"] is None
    assert both.astray == both.region.cells.chart.size // 2
    assert REFUSED["crossing"] in both.reason
    assert two(at([4], [FIXED], [0.02 * FIXED])).astray == 0


class Stacked:
    """A Lozi map on each of two strips above one another, about heights of 1/2 and -1/2."""

    label, joins, homeomorphism = "two Lozi maps", ((0, 1),), True
    charts = tuple(chart._replace(y=(-1.0, 1.0)) for chart in LOZI.map.charts)

    def level(self, boxes):
        low, high = boxes.y
        shift = np.where(low > 0, 0.5, np.where(high < 0, -0.5, np.nan))
        return shift, boxes._replace(y=(low - shift, high - shift))

    def images(self, boxes):
        shift, there = self.level(boxes)
        found = LOZI.map.images(there)
        low, high = found.boxes.y
        y = low + shift[found.source] - 1e-15, high + shift[found.source] + 1e-15
        return found._replace(boxes=found.boxes._replace(y=y))

    def derivatives(self, boxes):
        return LOZI.map.derivatives(self.level(boxes)[1])


def test_two_attractors_above_one_another_are_refused_together_though_all_curves_cross_the_same_columns():
    """The rectangle about the cycle has to hold all of the region over its interval, so both of them."""
    _, x, y = LOZI.saddle
    above, below = at([1], [x], [y + 0.5]), at([1, 1], [x, x], [y + 0.5, y - 0.5])
    alone, both = (NoTwoAttractors(Stacked(), 512, 2048, some, (1, x, y + 0.5), 1, 0.1) for some in (above, below))
    assert alone.checks["saddle"]
    assert alone.checks["crossing"]
    assert both.growth.bounces == alone.growth.bounces
    assert both.checks["saddle"] is None


def test_a_rotation_says_nothing():
    turn = BrokenLine(((-2.0, -1.0), (0.0, 0.0), (2.0, 1.0)), -1.0, 2.0)
    found = NoTwoAttractors(turn, 64, 64, at([1], [0.5], [0.0]), (1, 0.5, 0.0), 1, 0.1)
    assert not found.proved
    assert found.checks["cones"] is None
    assert "cones" in found.reason or "region" in found.reason


def test_a_map_that_is_not_one_to_one_is_refused():
    assert replace(LOZI, map=replace(LOZI.map, b=0.0)).checks["continuous"] is None


def test_charts_that_are_not_all_joined_end_to_end_are_refused():
    class Apart(BrokenLine):
        joins = ((0, 1),)

    assert continuous(TWO)
    assert not continuous(Apart(TWO.knots, TWO.b, TWO.height))


def test_an_attracting_cycle_in_the_region_is_refused():
    """Here the fixed point on the right has multipliers near -0.3 and 0.03."""
    bent = BrokenLine(((-2.0, -3.4), (0.0, 1.0), (2.0, 0.4)), 0.01, 0.02)
    found = NoTwoAttractors(bent, 256, 64, at([1], [0.7], [0.007]), (1, 1 / 1.29, 0.01 / 1.29), 1, 0.1, 2)
    assert found.growth.bounces is None
    assert found.checks["saddle"] is None
    assert not found.proved


def test_a_stable_curve_turns_back_away_from_the_joins():
    """So it may end twice on one border, and need not meet a curve that crosses the region: nothing more is claimed.

    A vertical line taken back twice by a Lozi map: its height rises up to a preimage of the join, and falls again.
    """
    height = np.linspace(-2.5e-4, 2.5e-4, 2001)
    points = [(np.full(height.shape, 1.03), height)]
    for _ in range(2):
        x, y = points[-1]
        points.append((y / LOZI.map.b, x - 1 + 1.6 * np.abs(y / LOZI.map.b)))
    x, y = points[-1]
    there = LOZI.map.images(Boxes(np.ones(x.size, dtype=int), (x, x), (y, y)))
    assert np.allclose(there.boxes.x[0], points[1][0][there.source], atol=1e-9)
    turn = int(np.argmin(y))
    assert 0 < turn < y.size - 1
    assert x.min() > 0.5
    assert points[1][0][turn] == pytest.approx(0, abs=1e-9)


def test_heights_where_a_curve_is_cut_off_allow_for_its_slope():
    """A span begins a little beside its column; up to there a curve may have left its cell."""
    course = Course(LOZI.region)
    spans, boxes = course.columns(), LOZI.region.grid.boxes(LOZI.region.cells)
    bottom, top = course.heights(spans.chart, spans.low)
    assert np.all((spans.first[0] < boxes.y[0]) | (spans.first[0] == bottom))
    assert np.all((spans.first[1] > boxes.y[1]) | (spans.first[1] == top))


def test_a_rectangle_about_no_cycle_is_refused():
    assert replace(LOZI, saddle=(1, 0.6, 0.03)).checks["saddle"] is None
    assert replace(LOZI, half=0.001).checks["saddle"] is None


def test_an_interval_newton_step_from_outside_of_the_rectangle_is_none():
    """The derivative is known over the rectangle alone, and orbits from elsewhere may take another way."""
    chart, x, y = LOZI.saddle
    top = LOZI.anchor.top
    assert anchor(LOZI.region, (chart, x, (y + top) / 2), 1, 0.1) is not None
    assert anchor(LOZI.region, (chart, x, top + 1e-3), 1, 0.1) is None


def test_inner_cones_lie_within_outer_ones_whatever_rounding_adds(monkeypatch):
    """Images of cones are kept by the map as long as each range is taken from within the one before it."""
    ranges = iter([1e-3, 1e-3] + 20 * [1.0])  # outer cones are found in the second round

    def arriving(map, found, inner, cells, cones):
        end = np.full(cells.chart.size, next(ranges))
        return -end, end

    monkeypatch.setattr(import_module("verification.proofs.unstable_curves.cover"), "arriving", arriving)
    found = cover(LOZI.map, 512, 512, LOZI.start)
    assert np.all(found.outer[1] < 1e-2)
    assert np.all((found.outer[0] <= found.cones[0]) & (found.cones[1] <= found.outer[1]))


def test_a_fold_that_is_left_out_changes_the_sum():
    """The canary: without its join the Lozi map would seem to stretch without a fold."""

    class Unfolded(BrokenLine):
        joins = ()

    part = LOZI.map
    unfolded = Unfolded(part.knots, part.b, part.height)
    assert growth(cover(unfolded, 512, 512, LOZI.start)).sums[0] < 1 < LOZI.growth.sums[0]
