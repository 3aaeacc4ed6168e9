"""The edge of a basin step by step: cells, what they meet, and which graphs leave nothing but the saddle."""

from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats
from flint import acb, arb

from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.starts import basin_edge
from verification.proofs.starts.basin_edge import SLACK, BasinEdge, _cells

PLACE = 0.25, 0.5  # of a saddle; a bounce turns it by 1


def box(*ends) -> Boxes:
    """One box, or as many as there are ends."""
    left, right, low, high = (np.atleast_1d(np.asarray(end, dtype=float)) for end in ends)
    return Boxes(np.zeros(left.size, dtype=int), (left, right), (low, high))


def stub(**given) -> SimpleNamespace:
    made = SimpleNamespace(place=PLACE, turn=1.0, **given)
    for name in ("_beside", "_meets", "_inside", "_about", "_boxes", "_disc_above", "_alone"):
        if name not in given:
            setattr(made, name, lambda *a, name=name: getattr(BasinEdge, name)(made, *a))
    return made


def test_cells_are_met_with_their_borders_included():
    ends = floats(1.25, 1.3, 1.3, 0.9), floats(1.5, 1.4, 1.5, 1.25)
    first, last = _cells(ends, 1.0, 0.25)
    assert first.tolist() == [0, 1, 1, -1]
    assert last.tolist() == [2, 1, 2, 1]


def test_cells_cover_one_turn_and_all_angles_above_0_and_hardly_more():
    made = stub(barrier=SimpleNamespace(map=SimpleNamespace(top=1.5)))
    column, row = (index.ravel() for index in np.indices((4, 3)))
    found = made._boxes(column, row, 4, 3)
    for (low, high), index, start, size in ((found.x, column, -0.5, 0.25), (found.y, row, 0.0, 0.5)):
        left, right = start + index * size, start + (index + 1) * size
        assert np.all((low < left) & (left < low + 1e-13))
        assert np.all((high > right) & (right > high - 1e-13))
    assert set(found.chart.tolist()) == {0}


def test_angles_are_told_apart_up_to_turns_of_the_table():
    made = stub()
    assert made._beside(floats(0.25, 0.5, 1.5, -0.5, -3.625, 0.0), 0.25).tolist() == [
        0.0,
        0.25,
        0.25,
        0.25,
        0.125,
        -0.25,
    ]
    made.turn = 0.25
    assert made._beside(floats(0.25, 0.3125, 1.0625, -0.6875), 0.25).tolist() == [0.0, 0.0625, 0.0625, 0.0625]


@pytest.mark.parametrize("turns", [0, 2, -1])
@pytest.mark.parametrize(("ends", "met"), [
    ((0.25, 0.25, 0.5, 0.5), True),
    ((0.3125, 0.375, 0.5, 0.5), True), ((0.125, 0.1875, 0.5, 0.5), True),  # they touch
    ((0.25, 0.25, 0.5625, 0.75), True), ((0.25, 0.25, 0.25, 0.4375), True),
    ((0.3125, 0.375, 0.5625, 0.75), True),  # at a corner
    ((0.328125, 0.375, 0.5, 0.5), False), ((0.125, 0.171875, 0.5, 0.5), False),
    ((0.25, 0.25, 0.578125, 0.75), False), ((0.25, 0.25, 0.25, 0.421875), False),
    ((0.125, 0.375, 0.25, 0.75), True),
])  # fmt: skip
def test_cells_meet_the_rectangle_about_the_saddle_with_its_border(monkeypatch, ends, met, turns):
    """Of half a side of 1/16, and each turned copy."""
    monkeypatch.setattr(basin_edge, "NEAR", 0.0625)
    left, right, low, high = ends
    assert stub()._meets(box(left + turns, right + turns, low, high)).tolist() == [met]


@pytest.mark.parametrize("turns", [0, 2])
@pytest.mark.parametrize("at", range(4))
def test_cells_lie_within_the_larger_rectangle_if_all_their_ends_do(monkeypatch, at, turns):
    monkeypatch.setattr(basin_edge, "WITHIN", 0.0625)
    ends, shift = np.array([0.203125, 0.296875, 0.453125, 0.546875]), floats(turns, turns, 0, 0)
    assert stub()._inside(box(*(ends + shift)))
    beyond = ends.copy()
    beyond[at] += (-0.015625, 0.015625, -0.015625, 0.015625)[at]  # its border
    assert not stub()._inside(box(*(beyond + shift)))
    assert not stub()._inside(box(*np.stack([ends, beyond], 1)))  # all of them must
    assert not stub()._inside(box(*np.zeros((4, 0))))
    made, border = stub(), 0.0625 * (1 - SLACK)
    made.place = 0.0, 0.0
    for end, held in ((border, False), (np.nextafter(border, 0), True)):
        assert made._inside(box(-end, end, -end, end)) is held


def test_a_rectangle_about_the_saddle_and_one_about_the_disc_are_as_wide_as_is_said():
    asked = []
    made = stub(
        disc=SimpleNamespace(centre=(0.5, 0.75), rectangle=(0.125, 0.25)),
        barrier=SimpleNamespace(above=lambda boxes: asked.append(boxes) or np.array([True])),
    )
    assert made._disc_above()
    assert [x.tolist() for x in (*asked[0].x, *asked[0].y)] == [[0.375], [0.625], [0.5], [1.0]]
    assert [x.tolist() for x in (*made._about(0.125).x, *made._about(0.125).y)] == [[0.125], [0.375], [0.375], [0.625]]
    assert asked[0].chart.tolist() == made._about(0.125).chart.tolist() == [0]
    made.barrier.above = lambda boxes: np.array([False])
    assert not made._disc_above()


@pytest.mark.parametrize("change", [None, "theta", "phi", "wide", "divided"])
def test_the_place_of_the_saddle_is_told_where_it_is_enclosed_closely(monkeypatch, change):
    """To a quarter of the smaller rectangle at most, in both coordinates; the next bounce is a turn farther."""
    wide, thin = arb(0, basin_edge.NEAR / 3.9), arb(0, basin_edge.NEAR / 4.1)
    here, phi = arb("0.5") + thin, arb("0.25") + thin

    class Map:
        def __init__(self, table, turn):
            assert turn == 3

        def over(self, numbers):
            return self

        def angle(self, before, after):
            assert (after - before).overlaps(2 * arb.pi() / 3)
            return (phi + wide if change == "phi" else phi), None

    def enclosed(saddle, map, lam):
        assert lam.real.contains(arb("0.25"))
        assert lam.real.contains(arb("0.75"))
        if change in ("wide", "divided"):
            raise TooWideError("saddle", "box") if change == "wide" else ZeroDivisionError
        return SimpleNamespace(points=[acb(here + wide if change == "theta" else here)])

    monkeypatch.setattr(basin_edge, "Pinball", Map)
    monkeypatch.setattr(basin_edge, "enclosed_saddle", enclosed)
    half = lambda p: SimpleNamespace(numerator=p, denominator=4)  # noqa: E731
    barrier = SimpleNamespace(lam=(half(1), half(3)), turns=3, map=SimpleNamespace(map=SimpleNamespace(table=None)))
    found = BasinEdge.place.func(SimpleNamespace(barrier=barrier, saddle=None))
    assert found == (None if change else (0.5, 0.25))


MISSING = {
    "none": set(), "barrier": {"barrier", "saddle", "hyperbolic", "alone"}, "place": {"saddle", "hyperbolic", "alone"},
    "disc": {"disc"}, "above": {"disc"}, "hyperbolic": {"hyperbolic"}, "low": {"alone"}, "alone": {"alone"},
}  # fmt: skip


@pytest.mark.parametrize(("fails", "missing"), MISSING.items())
def test_each_item_of_an_edge_is_what_its_own_step_proves(monkeypatch, fails, missing):
    """Without a barrier or a place nothing is asked of the saddle."""
    asked = []
    says = lambda step: asked.append(step) or fails != step  # noqa: E731
    monkeypatch.setattr(basin_edge, "attracts", lambda map, disc, turn: says("disc"))
    barrier = SimpleNamespace(
        heights=None if fails == "barrier" else 1.0, above=lambda boxes: np.array([True, fails != "low"]), map=None
    )
    made = stub(
        barrier=barrier, disc=None, _disc_above=lambda: says("above"), _hyperbolic=lambda: says("hyperbolic"),
        _alone=lambda: says("alone"), _about=lambda half: asked.append(half),
    )  # fmt: skip
    made.place = None if fails == "place" else PLACE
    made.checks = BasinEdge.checks.func(made)
    assert made.checks == {name: None if name in missing else True for name in basin_edge.CHECKS}
    assert BasinEdge.proved.fget(made) is (not missing)
    if fails in ("barrier", "place"):
        assert set(asked) <= {"disc", "above"}
    else:
        assert basin_edge.NEAR in asked


def walks(edges, near=(0,), below=(), absorbed=(), inner=True, later=None):
    """Four cells of one turn, which lead to one another as is said, and may lie below the barrier or in the disc."""
    asked = []

    def lead(column, row, boxes, columns, rows):
        cells = list(zip((column * 1000 + row).tolist(), range(column.size), strict=True))
        asked.append((columns, rows, sorted(zip(column.tolist(), row.tolist(), strict=True))))
        if edges is None:
            return None
        if len(asked) > 1:
            return later
        names = {column // 1000 * 2 + column % 1000: k for column, k in cells}
        some = [(names[a], names[b]) for a, b in edges if a in names and b in names]
        return tuple(np.array(side, dtype=np.int32) for side in (zip(*some, strict=True) if some else ((), ())))

    def among(cells, boxes):
        column, row = np.floor((boxes.x[0] + 1e-9 + 0.5) / 0.5), np.floor(boxes.y[0] + 1e-9)
        return np.isin(column * 2 + row, cells)

    made = stub(
        barrier=SimpleNamespace(map=SimpleNamespace(top=2.0), below=lambda boxes: among(below, boxes)),
        _edges=lead, _absorbed=lambda boxes: among(absorbed, boxes), _meets=lambda boxes: among(near, boxes),
        _inside=lambda boxes: inner,
    )  # fmt: skip
    return made, asked


@pytest.mark.parametrize(("given", "alone"), [
    ({"edges": [(0, 0), (1, 0), (2, 1), (3, 2)]}, True),
    ({"edges": []}, True),
    ({"edges": [(0, 0), (0, 1), (1, 2)]}, True),  # what leaves the saddle does not come back
    ({"edges": [(0, 0), (1, 1)]}, False),
    ({"edges": [(0, 0), (1, 2), (2, 1)]}, False),
    ({"edges": [(0, 1), (1, 0)]}, False),  # a walk that leaves the saddle and comes back
    ({"edges": [(0, 1), (1, 0)], "near": (0, 1)}, True),  # cells about the saddle are one vertex
    ({"edges": [(0, 1), (1, 2), (2, 0)], "near": (0, 1)}, False),
    ({"edges": None}, False),  # a landing that is not proved
    ({"edges": [(0, 0), (1, 1)], "below": (1,)}, True),
    ({"edges": [(0, 0), (1, 1)], "absorbed": (1,)}, True),
    ({"edges": [(1, 1)], "below": (0,)}, False),  # the saddle may lie below the barrier
    ({"edges": [], "absorbed": (0,)}, False),
    ({"edges": [(0, 0)], "inner": False}, False),
])  # fmt: skip
def test_no_closed_walk_is_left_but_that_about_the_saddle(monkeypatch, given, alone):
    monkeypatch.setattr(basin_edge, "COLUMNS", 2)
    monkeypatch.setattr(basin_edge, "ROWS", 2)
    monkeypatch.setattr(basin_edge, "HALVINGS", 1)
    made, asked = walks(**given)
    assert made._alone() is alone
    assert len(asked) <= 1


def test_cells_on_closed_walks_and_about_the_saddle_are_cut_in_four_and_asked_again(monkeypatch):
    monkeypatch.setattr(basin_edge, "COLUMNS", 2)
    monkeypatch.setattr(basin_edge, "ROWS", 2)
    monkeypatch.setattr(basin_edge, "HALVINGS", 2)
    none = np.array([], dtype=np.int32)
    for edges, parts in (([(0, 0), (3, 3), (2, 1)], {(0, 0), (1, 1)}), ([(3, 2), (2, 3)], {(0, 0), (1, 0), (1, 1)})):
        made, asked = walks(edges, later=(none, none))
        assert made._alone()
        assert asked[0] == (2, 2, [(0, 0), (0, 1), (1, 0), (1, 1)])
        quarters = [(2 * c + i, 2 * r + j) for c, r in parts for i in (0, 1) for j in (0, 1)]
        assert asked[1] == (4, 4, sorted(quarters))
        again = np.array([1], dtype=np.int32)
        made, asked = walks(edges, later=(again, again))  # a cell that leads to itself is left
        assert not made._alone() or (1, 1) not in parts
