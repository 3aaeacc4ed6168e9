"""Growth of folded curves, and at most one attractor: known answers, refusals, and the cuspless table."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from broken_line import CHARTS, BrokenLine, Unfolded, about_the_fixed_point, at

from verification.proofs.unstable_curves.anchor import anchor
from verification.proofs.unstable_curves.cover import cover
from verification.proofs.unstable_curves.growth import growth
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors, continuous

LOZI = about_the_fixed_point(1.6, 0.05)
TWO = BrokenLine(((-2.0, -1.1), (-1.5, -1.9), (-1.0, -1.1), (1.0, 1.1), (1.5, 1.9), (2.0, 1.1)), 0.02, 0.04)
FIXED = (1.9 + 1.6 * 1.5) / (2.6 - 0.02)


def two(starts):
    """The statement for a map with two attractors, side by side, and the region that grows from `starts`."""
    return NoTwoAttractors(TWO, 256, 256, starts, (4, FIXED, 0.02 * FIXED), 1, 0.06)


@pytest.mark.parametrize(("a", "b"), [(1.6, 0.05), (1.5, 0.05)])
def test_a_lozi_attractor_is_transitive_as_misiurewicz_proved(a, b):
    found = about_the_fixed_point(a, b)
    assert found.proved
    assert "at most one attractor" in found.reason


@pytest.mark.parametrize(("up", "down"), [(1.5, 1.9), (1.6, 1.7), (1.9, 1.5), (1.45, 1.45)])
def test_a_skew_tent_has_no_two_attractors(up, down):
    """The tent is transitive: an interval grows until it contains the kink twice in a row. Here it has a thin fibre."""
    x = 1 / (1 + down - 0.02)
    tent = BrokenLine(((-2.0, 1 - 2 * up), (0.0, 1.0), (2.0, 1 - 2 * down)), 0.02, 0.04)
    found = NoTwoAttractors(tent, 256, 256, at([1], [x], [0.02 * x]), (1, x, 0.02 * x), 1, 0.06)
    assert found.proved, found.reason
    assert found.growth.sums[0] >= 1 / up + 1 / down > 1 > found.growth.sums[-1]


def test_the_sum_of_a_lozi_map_has_one_fold_in_two_bounces():
    """The least stretch is `(a + sqrt(a**2 - 4*b))/2`, and a fold in two bounces makes two parts."""
    least = (1.6 + np.sqrt(1.6**2 - 0.2)) / 2
    assert LOZI.growth.bounces == 2
    assert LOZI.growth.sums[1] == pytest.approx(2 / least**2, rel=0.02)
    assert LOZI.growth.sums[1] >= 2 / least**2


def test_two_attractors_are_refused_together_and_each_is_one_by_itself():
    both = two(at([4, 0], [FIXED, -FIXED], [0.02 * FIXED, -0.02 * FIXED]))
    assert both.growth.bounces is not None
    assert both.checks["crossing"] is None
    assert both.astray == both.region.cells.chart.size // 2
    assert next(iter(both.open)) == "crossing"
    assert two(at([4], [FIXED], [0.02 * FIXED])).astray == 0


class Stacked:
    """A Lozi map on each of two strips, one above the other, at heights about 1/2 and -1/2."""

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


def test_two_attractors_above_one_another_are_refused_together():
    """The rectangle about the cycle must contain all of the region over its interval, and so both attractors."""
    _, x, y = LOZI.saddle
    above, below = at([1], [x], [y + 0.5]), at([1, 1], [x, x], [y + 0.5, y - 0.5])
    alone, both = (NoTwoAttractors(Stacked(), 512, 2048, some, (1, x, y + 0.5), 1, 0.1) for some in (above, below))
    assert alone.checks["saddle"]
    assert alone.checks["crossing"]
    assert both.growth.bounces == alone.growth.bounces
    assert both.checks["saddle"] is None


def test_a_map_that_is_not_one_to_one_is_refused():
    assert replace(LOZI, map=replace(LOZI.map, b=0.0)).checks["continuous"] is None


def test_an_attracting_cycle_in_the_region_is_refused():
    """The right fixed point has multipliers near -0.3 and 0.03."""
    bent = BrokenLine(((-2.0, -3.4), (0.0, 1.0), (2.0, 0.4)), 0.01, 0.02)
    found = NoTwoAttractors(bent, 256, 64, at([1], [0.7], [0.007]), (1, 1 / 1.29, 0.01 / 1.29), 1, 0.1)
    assert found.growth.bounces is None
    assert found.checks["saddle"] is None
    assert not found.proved


def test_a_rectangle_about_no_cycle_is_refused():
    assert replace(LOZI, saddle=(1, 0.6, 0.03)).checks["saddle"] is None
    assert replace(LOZI, half=0.001).checks["saddle"] is None


def test_an_interval_newton_step_from_outside_of_the_rectangle_is_none():
    """The derivative is bounded over the rectangle only, and orbits from elsewhere may differ."""
    chart, x, y = LOZI.saddle
    top = LOZI.anchor.top
    assert anchor(LOZI.region, (chart, x, (y + top) / 2), 1, 0.1) is not None
    assert anchor(LOZI.region, (chart, x, top + 1e-3), 1, 0.1) is None


def test_a_fold_that_is_left_out_changes_the_sum():
    """Without its join the Lozi map would seem to stretch without a fold."""

    part = LOZI.map
    unfolded = Unfolded(part.knots, part.b, part.height)
    assert growth(cover(unfolded, 512, 512, LOZI.start)).sums[0] < 1 < LOZI.growth.sums[0]


def table(joins=((0, 1), (1, 2)), charts=CHARTS, one_to_one=True):
    """A stand-in for a map of which only the charts are used."""
    return SimpleNamespace(charts=charts, joins=joins, homeomorphism=one_to_one, label="a map")


@pytest.mark.parametrize(
    ("map", "held"),
    [
        (table(), True),
        (table(((0, 1), (1, 2), (2, 0))), True),
        (table(one_to_one=False), False),
        (table(((0, 1),)), False),
        (table(((0, 1), (2, 0))), False),
        (table(((0, 1), (1, 2), (2, 1))), False),
        (table(((0, 1), (1, 2), (0, 2))), False),
        (table(charts=(*CHARTS[:2], CHARTS[2]._replace(y=(-1.0, 2.0)))), False),
        (table((), CHARTS[:1]), True),
        (table(((0, 0),), CHARTS[:1]), True),
    ],
)
def test_charts_are_joined_each_to_the_next_at_the_same_heights(map, held):
    assert continuous(map) is held
