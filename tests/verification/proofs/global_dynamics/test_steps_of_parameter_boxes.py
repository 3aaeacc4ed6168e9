"""Steps over boxes of parameters: landings that are shared and that move with a shape, and which boxes continue."""

from fractions import Fraction
from itertools import pairwise, product
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics import database as databases
from verification.proofs.global_dynamics import parameter_box
from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.global_dynamics.database import (
    KNOWN,
    Graphs,
    _painted,
    _ranges,
    common,
    continued,
    database,
    same_order,
)
from verification.proofs.global_dynamics.flights import Flights, Piece
from verification.proofs.global_dynamics.graph import Grid
from verification.proofs.global_dynamics.images import QUARTER
from verification.proofs.global_dynamics.parameter_box import Landings, ParameterBox, ParameterFlights, turns_of, varied

EGG = Scene("egg", alpha="1/20")
LAM = Fraction(1, 2), Fraction(33, 64)
SHAPE = Fraction(1, 20), Fraction(1, 20) + Fraction(1, 10000)
MIDDLE = (SHAPE[0] + SHAPE[1]) / 2


@pytest.fixture(scope="module")
def egg():
    return ParameterBox(EGG, LAM, "alpha", SHAPE)


@pytest.fixture(scope="module")
def moved():
    """Maps of the kernels at both ends of a range of shapes and in the middle."""
    at = SHAPE[0], MIDDLE, SHAPE[1]
    return [PinballMap(EGG.at(alpha=str(x)), lam=LAM[0], kernels=False) for x in at]


def test_a_shape_is_known_by_its_ends_and_what_it_holds_beside_its_middle(egg):
    for ball, low, high in ((egg.reach, SHAPE[0] - MIDDLE, SHAPE[1] - MIDDLE), (egg.known["alpha"], *SHAPE)):
        assert Fraction(float(ball.lower())) <= low
        assert high <= Fraction(float(ball.upper()))
        assert float(2 * ball.r) < float(high - low) * (1 + 1e-9)
    (chart,) = egg.charts
    assert egg.turns == 3
    assert (chart.x[1] - chart.x[0]) * 3 == pytest.approx(2 * np.pi, abs=1e-14)
    assert chart.y == (-egg.height, egg.height)
    assert egg.over == SHAPE
    other = egg.at((Fraction(1, 4), Fraction(1, 3)))
    assert (other.range, other.shared is egg.shared) == ((Fraction(1, 4), Fraction(1, 3)), True)
    assert other.top == pytest.approx(np.pi / 6)
    assert egg.range == LAM


FLOWER, RANGE = {"polar": "1 + b*cos(5*theta)"}, (Fraction(1, 100), Fraction(1, 90))


@pytest.mark.parametrize(
    ("scene", "parameter", "ranges", "turns", "shares"),
    [
        (Scene("egg", alpha="1/20", lam="1/2", law="-lam*eta*(1 + cos(3*theta)/4)"), "alpha", {}, 1, False),
        (Scene.of({**FLOWER, "shape": {"b": "1/90:0..1/30"}}), "b", {"b": (0, Fraction(1, 30))}, 5, True),
        (Scene.of({**FLOWER, "shape": {"b": "1/90"}}), "b", {"b": RANGE}, 5, True),
    ],
    ids=["placed", "ranged", "free"],
)
def test_landings_are_shared_on_one_curve_under_one_law_and_else_found_for_each_box(
    scene, parameter, ranges, turns, shares
):
    """A parameter without a range is given that of the box."""
    made = ParameterBox(scene, LAM, parameter, RANGE)
    assert made.scene.ranges == ranges
    assert (made.turns, made.shared is not None) == (turns, shares)
    boxes = Boxes(
        np.zeros(2, dtype=int), (np.array([0.2, 0.5]), np.array([0.21, 0.51])), (np.zeros(2), np.full(2, 0.01))
    )
    found = made.images(boxes)
    assert set(found.source) == {0, 1}
    assert type(made.flights(boxes)) is (ParameterFlights if shares else Flights)


@pytest.mark.parametrize(("top", "halves"), [(QUARTER, 0), (QUARTER / 2 * 1.001, 0), (QUARTER / 2, 1), (0.3, 2)])
def test_the_strip_is_a_quarter_turn_halved_as_often_as_it_still_holds_all_exit_angles(top, halves):
    assert ParameterBox.height.fget(SimpleNamespace(top=top)) == QUARTER / 2**halves


THETA, PHI = np.array([-2.5, -0.7, 0.4, 1.9]), np.array([0.3, -0.5, 0.1, 0.6])


def test_landings_and_tangents_move_with_the_shape_as_differences_say(egg, moved):
    boxes = Boxes(np.zeros(4, dtype=int), (THETA, THETA), (PHI, PHI))
    flights, on = egg.flights(boxes), np.arange(4)
    first, middle, last = (map.step(THETA, PHI, np.zeros(4, dtype=int)) for map in moved)
    step = float(SHAPE[1] - SHAPE[0])
    by_shape, turned = flights._by_shape(on, boxes.chart, hull(middle.theta, middle.theta), hull(THETA, THETA))
    difference = np.remainder(last.theta - first.theta + np.pi, 2 * np.pi) - np.pi
    assert np.all(np.abs(by_shape.m - difference / step) <= by_shape.r + 1e-4)
    assert np.all(by_shape.r < 1e-2)

    ends = [tangent(shape, middle.theta) - tangent(shape, THETA) for shape in SHAPE]
    turn = np.remainder(ends[1] - ends[0] + np.pi, 2 * np.pi) - np.pi
    assert np.all(np.abs(turned.m - turn / step) <= turned.r + 1e-4)
    assert np.all(turned.r < 1e-2)


def tangent(shape, theta):
    """The angle of the tangent of `1 + shape*cos(3*theta)`."""
    velocity = (-3 * float(shape) * np.sin(3 * theta) + 1j * (1 + float(shape) * np.cos(3 * theta))) * np.exp(
        1j * theta
    )
    return np.angle(velocity)


def test_landings_and_incidences_over_all_shapes_are_enclosed_and_hardly_more(egg, moved):
    h = 1e-4
    boxes = Boxes(np.zeros(4, dtype=int), (THETA - h, THETA + h), (PHI - h, PHI + h))
    piece, theta, eta, phi = egg.landed(boxes)
    corners = [
        map.step(THETA + i * h, PHI + j * h, np.zeros(4, dtype=int))
        for map in moved
        for i, j in product((-1, 1), (-1, 1))
    ]
    assert phi is None
    assert piece.on.tolist() == [0, 1, 2, 3]
    for ball, name in ((theta, "theta"), (eta, "eta")):
        points = np.array([getattr(x, name) for x in corners])
        points = points + 2 * np.pi * np.rint((ball.m - points[0]) / (2 * np.pi)) * (name == "theta")
        assert np.all((ball.lower() <= points.min(0) + 1e-12) & (points.max(0) - 1e-12 <= ball.upper()))
        assert np.all(2 * ball.r <= 1.2 * np.ptp(points, axis=0))


def test_landings_are_found_once_for_each_box_and_told_for_each_in_its_place():
    """Also of a box that is there twice, among others, before and after: of each its own."""
    shared, asked, random = Landings(), [], np.random.default_rng(3)

    def find(boxes):
        asked.extend(boxes.x[0].tolist())
        code = 100 * boxes.x[0] + 10 * boxes.y[0] + boxes.y[1] + boxes.x[1] / 10
        balls = [BallArray(k + code, code / k) for k in (2, 3)]
        return Piece(np.arange(code.size), boxes.chart, -code, code, True), *balls, None

    for numbers in ([3, 3, 5], [5, 1, 3], [7], random.integers(0, 12, 30), random.integers(0, 12, 30)):
        x, zero = np.array(numbers, dtype=float), np.zeros(len(numbers), dtype=int)
        boxes = Boxes(zero, (x, x + 1), (x / 2, x / 4))
        code = 100 * x + 5 * x + x / 4 + (x + 1) / 10
        piece, theta, eta, phi = shared.of(boxes, find)
        assert phi is None
        assert piece.smooth
        assert piece.on.tolist() == list(range(x.size))
        for found, wanted in (
            (piece.low, -code), (piece.high, code), (theta.m, 2 + code), (theta.r, code / 2), (eta.m, 3 + code),
            (eta.r, code / 3),
        ):  # fmt: skip
            assert np.allclose(found, wanted)
    assert sorted(asked) == sorted(set(asked))


def table(ends, name="some"):
    return SimpleNamespace(name=name, components=[SimpleNamespace(start=a, end=b) for a, b in ends])


@pytest.mark.parametrize(
    ("ends", "measured", "formula", "said"),
    [
        ([(0, 1), (1, 2)], False, "a", ""),
        ([(0, "b"), ("b", 2)], False, "a", "end elsewhere"),
        ([(0, 1), (1, "2*b + 1")], False, "a", "end elsewhere"),
        ([("b", 1), (1, 2)], False, "a", "end elsewhere"),
        ([(0, "c"), ("c", 2)], False, "a", ""),
        ([(0, 1)], True, "a", "it depends on b"),
        ([(0, 1)], False, "b", "it depends on b"),
    ],
)
def test_a_shape_may_be_varied_where_no_end_of_a_component_and_no_law_depends_on_it(
    monkeypatch, ends, measured, formula, said
):
    monkeypatch.setattr(parameter_box, "parameters_of_law", lambda formula: {formula})
    law = SimpleNamespace(measured=measured, formula=formula)
    scene = SimpleNamespace(law=law, over=lambda parameter, low, high: table(ends))
    if said:
        with pytest.raises(ValueError, match=said):
            varied(scene, "b", 0, 1)
    else:
        assert varied(scene, "b", 0, 1).name == "some"


def test_turns_are_counted_of_tables_that_close_smoothly_and_convexity_is_asked_over_the_whole_range(monkeypatch):
    monkeypatch.setattr(parameter_box, "rotations", lambda _: 5)
    for closes, turns in ((True, 5), (False, 1)):
        monkeypatch.setattr(parameter_box, "closes_smoothly", lambda _, closes=closes: closes)
        assert turns_of(None) == turns
    for held in (None, False):
        monkeypatch.setattr(parameter_box, "convex", lambda _, held=held: held)
        with pytest.raises(ValueError, match="not proved convex for alpha = 0 to 1/20"):
            parameter_box._over.__wrapped__(EGG.text, "alpha", "0", "1/20")


def test_borders_are_told_of_the_box_about_each_middle():
    borders = ["0", "1/10", "1/3", "1/2"]
    ends = [Fraction(x) for x in borders]
    middles = databases._middles(ends)
    assert middles == pytest.approx([1 / 20, 13 / 60, 5 / 12])
    assert list(_ranges(borders, middles)) == [*pairwise(ends)]
    assert list(_ranges(borders, middles[[2, 0]])) == [(ends[2], ends[3]), (ends[0], ends[1])]


def cells_of(top, rows):
    """The ends of the rows of a strip."""
    return [(-top + 2 * top * k / rows, -top + 2 * top * (k + 1) / rows) for k in range(rows)]


@pytest.mark.parametrize(("one", "other"), [(1, 1), (1, 2), (2, 1), (4, 1), (1, 4)])
@pytest.mark.parametrize("rows", [4, 6])
def test_sets_meet_where_a_cell_of_the_one_overlaps_a_cell_of_the_other(one, other, rows):
    random = np.random.default_rng(one * 10 + other)
    for _ in range(10):
        here, there = random.integers(-1, 3, (2, rows, 3)).astype(np.int8)
        wanted = np.zeros((3, 3), dtype=bool)
        for (i, (a, b)), (j, (c, d)) in product(*(enumerate(cells_of(Fraction(top), rows)) for top in (one, other))):
            for column in range(3):
                pair = here[i, column], there[j, column]
                if a < d and c < b and min(pair) >= 0:
                    wanted[pair] = True
        assert np.array_equal(common(here, there, float(one), float(other), (3, 3)), wanted)


def test_graphs_are_alike_where_sets_that_meet_are_matched_one_to_one_with_the_same_order():
    random, seen = np.random.default_rng(4), set()
    for _ in range(300):
        met = random.random((3, 3)) < 0.25
        here, there = (random.random((2, 3, 3)) < 0.6).astype(np.int8)
        pairs = [*zip(*(x.tolist() for x in np.nonzero(met)), strict=True)]
        one = len({a for a, _ in pairs}) == len(pairs) == len({b for _, b in pairs})
        wanted = one and all(here[a, c] == there[b, d] for (a, b), (c, d) in product(pairs, pairs))
        assert same_order(met, here, there) is wanted
        seen.add((one, wanted))
    assert seen == {(False, False), (True, False), (True, True)}


def test_classes_are_the_boxes_joined_by_borders_across_which_graphs_continue(monkeypatch):
    """Boxes continue where their numbers are equal and known; the largest class is the first."""
    monkeypatch.setattr(databases, "common", lambda here, there, *_: (here, there))
    monkeypatch.setattr(databases, "same_order", lambda met, *_: bool(met[0][0] == met[1][0]))
    asked = np.array([[7, 7, 5, 5, 5], [4, 7, 5, 4, 6], [4, 4, 9, 9, 9]], dtype=np.int8)
    sets = np.array([[1, 0, KNOWN, KNOWN + 1, 1], [2, 3, 3, 3, 2], [1, 1, 1, -1, 2]])
    values = {"sets": sets, "top": np.ones((3, 5)), "cells": asked[:, :, None], "leads": asked[:, :, None]}
    found = SimpleNamespace(**{name: SimpleNamespace(values=some) for name, some in values.items()})
    assert continued(found).tolist() == [[0, 0, 2, -1, 3], [1, 0, 2, 4, 5], [1, 1, 6, -1, 7]]


@pytest.mark.parametrize("sets", [1, KNOWN, KNOWN + 1])
def test_of_boxes_with_graphs_the_counts_are_told_and_the_cells_of_those_that_are_not_too_many(monkeypatch, sets):
    """Of three contractions the second is not proved; the first map is asked for the others."""
    made = []

    def map_of(scene, lam, parameter, shape):
        made.append((lam, parameter, shape))
        return SimpleNamespace(at=made_at, charts=("c",), height=lam)

    def made_at(lam):
        made.append(lam)
        if lam == 2:
            raise ValueError
        return SimpleNamespace(at=made_at, charts=("c",), height=lam)

    order = np.arange(sets * sets).reshape(sets, sets) % 2 == 0
    trapping = lambda index: np.array([False, True, index == 0])  # noqa: E731
    graph = SimpleNamespace(attracting=(0, 2, 5), trapping=trapping, sets=(None,) * sets, below=order)
    monkeypatch.setattr(databases, "ParameterBox", map_of)
    monkeypatch.setattr(databases, "Grid", lambda *all: all)
    monkeypatch.setattr(databases, "refined", lambda map, grid, coarsest: (grid, coarsest))
    monkeypatch.setattr(databases, "morse_graph", lambda given: graph if given == ((("c",), 5, 3), 4) else None)
    monkeypatch.setattr(databases, "_painted", lambda graph: np.full((3, 5), 9, dtype=np.int8))
    task = Graphs(EGG.text, "alpha", (), (), 5, 3, 4)
    first, second, third = task.boxes([1, 2, 3], SHAPE)

    assert made == [(1, "alpha", SHAPE), 2, 3]
    assert [box[:3] for box in (first, third)] == [(sets, 2, 1), (sets, 2, 3)]
    assert second[:2] == (-1, -1)
    assert np.isnan(second[2])
    assert np.all(second[3] == -1)
    assert np.all(second[4] == -1)
    if sets <= KNOWN:
        assert np.all(first[3] == 9)
        assert np.array_equal(first[4][:sets, :sets], order)
        assert np.all(first[4][sets:] == -1)
        assert np.all(first[4][:, sets:] == -1)
    else:
        assert np.all(first[3] == -1)
        assert np.all(first[4] == -1)


def test_cells_are_painted_with_the_number_of_their_set_chart_beside_chart():
    """A large block that was cut is not painted, nor is the outside, though it counts as a set."""
    grid = Grid((Chart("a", (0.0, 1.0), (0.0, 1.0)), Chart("b", (0.0, 1.0), (0.0, 1.0))), 3, 2)
    leaf = np.arange(12) != 3
    graph = SimpleNamespace(
        sets=(np.array([12, 3, 1]), np.array([6, 11])), transitions=SimpleNamespace(count=12, leaf=leaf, grid=grid)
    )
    every = grid.whole()
    graph.transitions.chosen = lambda some: type(every)(*(field[some[:-1]] for field in every))
    assert _painted(graph).tolist() == [[-1, -1, -1, 1, -1, -1], [0, -1, -1, -1, -1, 1]]


def test_a_database_says_where_its_boxes_and_cells_lie():
    sweep = database(EGG, "alpha", [0.05, 0.06, 0.075], [0.0, 0.1, 0.2, 0.4], 24, 16, 4)
    sizes = {axis.name: len(axis.values) for axis in sweep.axes}
    assert sizes == {"alpha": 2, "lam": 3, "row": 16, "column": 24, "from": KNOWN, "to": KNOWN}
    assert [axis.part for axis in sweep.axes] == [1, 3, 0, 0, 0, 0]
    assert sweep.seed == 0
    assert sweep.axes[0].values == pytest.approx([0.055, 0.0675])
    assert sweep.axes[1].values == pytest.approx([0.05, 0.15, 0.3])
    said = sweep.settings
    assert (said["values"], said["lams"]) == (["1/20", "3/50", "3/40"], ["0", "1/10", "1/5", "2/5"])
    assert (said["turns"], sweep.collisions) == (3, 2 * 3 * 24 * 16)
    assert said["theta"][1] - said["theta"][0] == pytest.approx(2 * np.pi / 3)


@pytest.mark.parametrize("placed", [False, True])
def test_borders_are_clipped_to_the_range_of_a_shape_and_all_charts_lie_side_by_side(monkeypatch, placed):
    monkeypatch.setattr(databases, "varied", lambda scene, name, *ends: asked.append(ends) or table([(0, 1)] * 3))
    monkeypatch.setattr(databases, "turns_of", lambda _: 5)
    law = {"law": "-lam*eta*(1 + cos(5*theta)/4)", "lam": "1/2"} if placed else {}
    asked, scene = [], Scene.of({**FLOWER, **law, "shape": {"b": "1/90:1/100..1/30"}})
    sweep = database(scene, "b", [0.0, 0.02, 0.05], list(np.arange(40) / 100), 24, 16, 4)
    assert asked == [(Fraction(1, 100), Fraction(1, 30))]
    assert sweep.settings["values"] == ["1/100", "1/50", "1/30"]
    assert (sweep.settings["turns"], sweep.collisions) == (1 if placed else 5, 2 * 39 * 24 * 16 * 3)
    assert [axis.part for axis in sweep.axes[:2]] == [1, databases.TOGETHER]
    assert sweep.axes[3].size == 3 * 24


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"parameter": "beta"}, "is no shape parameter"),
        ({"lams": [0.3, 0.3]}, "is no range"),
        ({"lams": [0.5, 1.0]}, "is no range"),
        ({"lams": [-0.1, 0.5]}, "is no range"),
        ({"values": [0.05]}, "a box has two ends"),
        ({"coarsest": 3}, "no power of 2"),
        ({"columns": 26}, "no power of 2"),
        ({"rows": 18}, "no power of 2"),
    ],
)
def test_a_database_is_refused_where_its_boxes_or_blocks_do_not_fit(change, said):
    given = {"parameter": "alpha", "values": [0.05, 0.06], "lams": [0.1, 0.2], "columns": 24, "rows": 16, "coarsest": 4}
    with pytest.raises(ValueError, match=said):
        database(EGG, **(given | change))
