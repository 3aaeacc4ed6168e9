"""What a proof that there are no two attractors must refuse: each of its pieces left out, turned or weakened."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from verification.proofs.global_dynamics import Boxes
from verification.proofs.unstable_curves import no_two_attractors
from verification.proofs.unstable_curves.affine import BrokenLine, lozi
from verification.proofs.unstable_curves.attraction import attraction, stable_slopes
from verification.proofs.unstable_curves.cover import Cover
from verification.proofs.unstable_curves.growth import growth
from verification.proofs.unstable_curves.no_two_attractors import REFUSED, NoTwoAttractors


def at(chart, x, y):
    """Points as boxes."""
    return Boxes(np.array(chart), (np.array(x),) * 2, (np.array(y),) * 2)


X = 1 / (1 + 1.6 - 0.05)  # the fixed point on the right


def fresh():
    """A Lozi map of which all that is needed is proved."""
    return NoTwoAttractors(lozi(1.6, 0.05), 512, 512, at([1], [X], [0.05 * X]), (1, X, 0.05 * X), 1, 0.1, 4)


LOZI = fresh()


def given(region):
    """The same statement with another region."""
    found = fresh()
    found.__dict__["region"] = region
    return found


def test_what_the_canaries_are_made_from_is_proved():
    assert LOZI.proved
    assert given(LOZI.region).proved


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.999])
def test_a_region_without_one_of_its_cells_is_refused(monkeypatch, share):
    room = sys.modules[Cover.__module__]
    reached = room.reached

    def without_one(*given, **more):
        numbers = reached(*given, **more)
        return np.delete(numbers, int(share * numbers.size))

    monkeypatch.setattr(room, "reached", without_one)
    found = fresh()
    assert found.region == "no trapping region: an image leaves the cells"
    assert not found.proved
    assert "an image leaves the cells" in found.reason


def test_a_map_without_the_images_in_one_chart_is_refused():
    """All edges to that chart are left out, and the derivatives still lead there."""

    class Partial(BrokenLine):
        def images(self, boxes):
            found = super().images(boxes)
            on = found.boxes.chart == 0
            return found._replace(source=found.source[on], boxes=found.boxes.chosen(on))

    part = LOZI.map
    found = replace(LOZI, map=Partial(part.knots, part.b, part.height))
    assert not found.proved
    assert found.reason


def test_growth_is_measured_along_every_edge():
    """Without edges of the cells beside the join, where folds count twice, curves would seem to grow at once."""
    cover, graph = LOZI.region, LOZI.region.inner.tolil()
    beside = np.flatnonzero((cover.cells.column == 0) | (cover.cells.column == cover.grid.columns - 1))
    graph[:, beside] = 0
    for cell in np.flatnonzero(np.diff(graph.tocsr().indptr) == 0):
        graph[cell, cell] = 1
    assert growth(replace(cover, inner=graph.tocsr())).sums[0] < 1 < LOZI.growth.sums[0]


def test_stretching_that_is_less_than_what_folds_undo_is_refused():
    """The least factor is 1.57. Some curve that is never stretched does not grow; a little less only takes longer."""
    weak = given(replace(LOZI.region, least=LOZI.region.least - np.log(1.6)))
    assert weak.growth.bounces is None
    assert weak.reason.endswith(REFUSED["growth"])
    assert given(replace(LOZI.region, least=LOZI.region.least - np.log(1.2))).growth.bounces > LOZI.growth.bounces


def test_cones_that_are_turned_to_the_vertical_are_refused():
    """The slope of the rectangle has to exceed theirs, and no stable direction may lie in them."""
    low, high = LOZI.region.cones
    turned = replace(LOZI.region, cones=(low + 20.0, high + 20.0))
    assert given(turned).anchor is None
    assert given(turned).checks["saddle"] is None
    around = replace(LOZI.wide, cones=(np.full(LOZI.wide.least.size, -100.0), np.full(LOZI.wide.least.size, 100.0)))
    assert stable_slopes(LOZI.wide) is not None
    assert stable_slopes(around) is None
    assert not attraction(LOZI.region, around, LOZI.anchor).proved


def test_cones_that_the_map_does_not_keep_are_refused():
    """Multipliers of the fixed point are not real: vectors turn about it, and horizontal ones become vertical."""
    turn = BrokenLine(((-2.0, -0.2), (0.0, 0.0), (2.0, 0.2)), -0.8, 1.6)
    found = NoTwoAttractors(turn, 128, 128, at([1], [0.0], [0.0]), (1, 0.0, 0.0), 1, 0.1, 2)
    assert found.region == "no cones: over some cell a vector of its cone may become vertical"
    assert found.reason.endswith(found.region)


def test_a_map_that_says_of_no_join_where_it_folds_is_refused():
    class Unfolded(BrokenLine):
        joins = ()

    part = LOZI.map
    unfolded = replace(LOZI, map=Unfolded(part.knots, part.b, part.height))
    assert unfolded.checks["continuous"] is None
    assert unfolded.reason.endswith(REFUSED["continuous"])


def test_a_rectangle_that_no_curve_comes_to_is_refused(monkeypatch):
    """Of one cell nothing is seen."""
    crossing = no_two_attractors.crossing

    def missed(region, at):
        found = crossing(region, at)
        found[:1] = False
        return found

    monkeypatch.setattr(no_two_attractors, "crossing", missed)
    found = fresh()
    assert found.astray == 1
    assert found.reason.endswith(REFUSED["crossing"])


def test_two_fixed_points_that_attract_are_refused_and_so_is_each_alone():
    sinks = BrokenLine(((-2.0, -1.5), (-0.5, -0.75), (0.5, 0.75), (2.0, 1.5)), 0.02, 0.04)
    x = 0.5 / (1 - 0.5 - 0.02)
    for starts in (at([0, 2], [-x, x], [-0.02 * x, 0.02 * x]), at([2], [x], [0.02 * x])):
        found = NoTwoAttractors(sinks, 256, 256, starts, (1, 0.0, 0.0), 1, 0.06, 2)
        assert not found.proved
        assert found.reason.endswith(REFUSED["growth"])


def test_two_sinks_with_the_saddle_between_them_are_refused():
    sinks = BrokenLine(((-2.0, -1.5), (-0.5, -0.75), (0.5, 0.75), (2.0, 1.5)), 0.02, 0.04)
    sides = np.array([-1.5, -0.5, 0.5, 1.5])
    whole = Boxes(np.arange(3), (sides[:-1], sides[1:]), (np.full(3, -0.03), np.full(3, 0.03)))
    found = NoTwoAttractors(sinks, 256, 256, whole, (1, 0.0, 0.0), 1, 0.06, 2)
    assert found.checks["growth"] is None
    assert not found.proved
