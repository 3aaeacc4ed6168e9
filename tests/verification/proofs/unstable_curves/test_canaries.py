"""The proof that there is at most one attractor refuses data in which one piece is missing, turned or weakened."""

from dataclasses import replace

import numpy as np
from broken_line import BrokenLine, Unfolded, about_the_fixed_point, at

from verification.proofs.unstable_curves.anchor import anchor
from verification.proofs.unstable_curves.growth import growth
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Cells

X = 1 / (1 + 1.6 - 0.05)  # the fixed point on the right


LOZI = about_the_fixed_point(1.6, 0.05)


def given(region):
    """The same statement with another region."""
    found = about_the_fixed_point(1.6, 0.05)
    found.__dict__["region"] = region
    return found


def test_what_the_canaries_are_made_from_is_proved():
    assert LOZI.proved
    assert given(LOZI.region).proved


def test_a_map_without_the_images_in_one_chart_is_refused():
    """All edges to one chart are removed, while derivatives still lead there."""

    class Partial(BrokenLine):
        def images(self, boxes):
            found = super().images(boxes)
            on = found.boxes.chart == 0
            return found._replace(source=found.source[on], boxes=found.boxes.chosen(on))

    part = LOZI.map
    found = replace(LOZI, map=Partial(part.knots, part.b, part.height))
    assert not found.proved
    assert found.reason


def test_a_saddle_that_the_cells_do_not_hold_is_refused():
    """Only the cells of the rectangle about the saddle are removed."""
    region = LOZI.region
    boxes = region.grid.boxes(region.cells)
    hold = (boxes.x[0] <= X) & (boxes.x[1] >= X) & (boxes.y[0] <= 0.05 * X) & (boxes.y[1] >= 0.05 * X)
    on = ~(hold & (region.cells.chart == 1))
    less = replace(
        region,
        cells=Cells(*(field[on] for field in region.cells)),
        inner=region.inner[on][:, on],
        outer=tuple(end[on] for end in region.outer),
        cones=tuple(end[on] for end in region.cones),
        **{name: getattr(region, name)[on] for name in ("least", "most")},
    )
    assert 0 < np.sum(~on) < 5
    assert anchor(region, LOZI.saddle, 1, 0.1) is not None
    assert anchor(less, LOZI.saddle, 1, 0.1) is None


def test_growth_is_measured_along_every_edge():
    """Without the edges of cells beside the join, where folds count twice, curves would seem to grow at once."""
    cover, graph = LOZI.region, LOZI.region.inner.tolil()
    beside = np.flatnonzero((cover.cells.column == 0) | (cover.cells.column == cover.grid.columns - 1))
    graph[:, beside] = 0
    for cell in np.flatnonzero(np.diff(graph.tocsr().indptr) == 0):
        graph[cell, cell] = 1
    assert growth(replace(cover, inner=graph.tocsr())).sums[0] < 1 < LOZI.growth.sums[0]


def test_stretching_that_is_less_than_what_folds_undo_is_refused():
    """The least factor is 1.57. A curve that is never stretched does not grow; with a little less growth is slower."""
    weak = given(replace(LOZI.region, least=LOZI.region.least - np.log(1.6)))
    assert weak.growth.bounces is None
    assert next(iter(weak.open)) == "growth"
    assert given(replace(LOZI.region, least=LOZI.region.least - np.log(1.2))).growth.bounces > LOZI.growth.bounces


def test_cones_that_are_turned_to_the_vertical_are_refused():
    """Their slopes would exceed that of the rectangle."""
    low, high = LOZI.region.cones
    turned = replace(LOZI.region, cones=(low + 20.0, high + 20.0))
    assert given(turned).anchor is None
    assert given(turned).checks["saddle"] is None


def test_cones_that_the_map_does_not_keep_are_refused():
    """The fixed point's multipliers are not real, so vectors turn about it, and horizontal ones become vertical."""
    turn = BrokenLine(((-2.0, -0.2), (0.0, 0.0), (2.0, 0.2)), -0.8, 1.6)
    found = NoTwoAttractors(turn, 128, 128, at([1], [0.0], [0.0]), (1, 0.0, 0.0), 1, 0.1)
    assert found.region == "no cones: over some cell a vector of its cone may become vertical"
    assert found.reason.endswith(found.region)


def test_a_map_that_says_of_no_join_where_it_folds_is_refused():
    part = LOZI.map
    unfolded = replace(LOZI, map=Unfolded(part.knots, part.b, part.height))
    assert unfolded.checks["continuous"] is None
    assert next(iter(unfolded.open)) == "continuous"


def test_two_sinks_with_the_saddle_between_them_are_refused():
    sinks = BrokenLine(((-2.0, -1.5), (-0.5, -0.75), (0.5, 0.75), (2.0, 1.5)), 0.02, 0.04)
    sides = np.array([-1.5, -0.5, 0.5, 1.5])
    whole = Boxes(np.arange(3), (sides[:-1], sides[1:]), (np.full(3, -0.03), np.full(3, 0.03)))
    found = NoTwoAttractors(sinks, 256, 256, whole, (1, 0.0, 0.0), 1, 0.06)
    assert found.checks["growth"] is None
    assert not found.proved
