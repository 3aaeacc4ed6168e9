"""Cores with images that are given: each step of a proof fails alone, and borders are exact."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.starts import core as core_of
from verification.proofs.starts.core import NEARLY, Core, attracts, derivative, twice
from verification.proofs.starts.parallelograms import Parallelograms

FLAT = Core(0, 0.0, 0.0, 1.0, 0.5, 1.0, 4)  # `|theta| <= 1`, `|phi| <= 1`, in four cells
MAP = SimpleNamespace(mirrored=True)


def points(theta, phi=0.0, chart=0) -> Parallelograms:
    """Points, or lost sets where one is infinite."""
    theta, phi, chart = np.broadcast_arrays(np.asarray(theta, dtype=float), phi, chart)
    middle = np.stack([theta, phi]).astype(float)
    zero = np.zeros_like(middle)
    rest = np.where(np.isfinite(middle), 0.0, np.inf)
    return Parallelograms(chart.copy(), np.where(np.isfinite(middle), middle, 0.0), np.stack([zero, zero]), rest)


@pytest.mark.parametrize(("first", "second", "found"), [
    ((0, 1, 2), (0, 1, 2), [5.0, 6.0, 7.0]),
    ((2, 0, 1), (0, 1, 2), [5.0, 6.0, 7.0]),
    ((0, 1, 2), (1, 2, 0), [7.0, 5.0, 6.0]),
    ((0, 1, 2), (0, 1, 2, 2), None),  # one lands on both sides of a join
    ((0, 1, 1, 2), (0, 1, 2), None),
    ((0, 1), (0, 1, 2), None),  # of one there is no image
    ((0, 1, 1), (0, 1, 2), None),
])  # fmt: skip
def test_two_images_of_each_set_come_in_the_order_of_the_sets(monkeypatch, first, second, found):
    steps, asked = iter((first, second)), []

    def carried(map, sets):
        asked.append(sets.middle[0].tolist())
        source = integers(*next(steps))
        return source, points(5.0 + np.arange(source.size))

    monkeypatch.setattr(core_of, "carried", carried)
    told = twice(None, points([1.0, 2.0, 3.0]))
    assert (told if told is None else told.middle[0].tolist()) == found
    assert asked[0] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("at", [0, 1])
def test_a_set_that_is_lost_in_either_bounce_has_no_second_image(monkeypatch, at):
    count = []

    def carried(map, sets):
        count.append(0)
        return np.arange(2), points([1.0, np.inf if len(count) == at + 1 else 2.0])

    monkeypatch.setattr(core_of, "carried", carried)
    assert twice(None, points([1.0, 2.0])) is None
    assert len(count) == at + 1


@pytest.mark.parametrize(("theta", "come"), [
    ((0.1, 0.3, 0.45, 0.7), True),
    ((-0.1, -0.3, -0.45, -0.7), True),
    ((0.1, 0.3, 0.5 * NEARLY, 0.7), False),  # no nearer than the inner edge of its cell
    ((0.1, 0.3, 0.45, 0.75), False),
    ((0.1, 0.3, 0.45, -0.8), False),
    ((0.6, 0.3, 0.45, 0.7), False),  # a cell of the middle is left for one beyond
    ((0.1, 0.51, 0.45, 0.52), False),
    ((0.1, 0.3, np.inf, 0.7), False),
])  # fmt: skip
def test_each_cell_of_a_core_comes_nearer_or_stays_in_the_middle(monkeypatch, theta, come):
    monkeypatch.setattr(core_of, "twice", lambda map, sets: points(theta))
    monkeypatch.setattr(core_of, "_converges", lambda map, core: True)
    assert attracts(MAP, FLAT)["orbits come to the middle"] is come
    assert not attracts(SimpleNamespace(mirrored=False), FLAT)["orbits come to the middle"]


@pytest.mark.parametrize(("wide", "come"), [(0.04, True), (0.06, False)])
def test_a_cell_comes_nearer_with_all_of_its_image(monkeypatch, wide, come):
    one = points([0.1, 0.3, 0.45, 0.7])
    images = replace(one, rest=np.where(np.arange(4) == 2, wide, 0.0) * np.ones((2, 1)))
    monkeypatch.setattr(core_of, "twice", lambda map, sets: images)
    monkeypatch.setattr(core_of, "_converges", lambda map, core: True)
    assert attracts(MAP, FLAT)["orbits come to the middle"] is come


@pytest.mark.parametrize(("entries", "converges"), [
    (((0.5, 0.9), 0.0, 0.0, (0.25, 0.5)), True), (((0.5, 1.1), 0.0, 0.0, (0.25, 0.5)), False),
    (((0.5, 0.5), 0.0, 0.0, (-1.1, 0.5)), False), (((0.5, 0.5), (0.1, 0.9), (0.9, 0.0), (0.5, 0.5)), False),
    ((1 - 2.0**-39, 0.0, 0.0, 0.5), True), ((1 - 2.0**-41, 0.0, 0.0, 0.5), False),  # with the roundings
])  # fmt: skip
def test_over_all_parts_of_the_middle_one_norm_shrinks(monkeypatch, entries, converges):
    a, b, c, d = (BallArray(np.broadcast_to(np.asarray(x, dtype=float), (2,)), np.zeros(2)) for x in entries)
    monkeypatch.setattr(core_of, "derivative", lambda *_: [[a, b], [c, d]])
    assert core_of._converges(MAP, FLAT) is converges


@pytest.mark.parametrize(("far", "come"), [(0.5, False), (0.5 * NEARLY, True), (1.0, False)])
def test_all_of_a_core_of_one_cell_stays_in_the_middle(monkeypatch, far, come):
    """Up to the border of the middle, with the roundings."""
    monkeypatch.setattr(core_of, "twice", lambda map, sets: points([far]))
    monkeypatch.setattr(core_of, "_converges", lambda map, core: True)
    assert attracts(MAP, replace(FLAT, inner=0.5, outer=0.5, cells=1))["orbits come to the middle"] is come


@pytest.mark.parametrize("fails", [None, "phi", "chart", "converges", "first gate", "second gate", "images"])
def test_each_step_of_a_core_fails_alone(monkeypatch, fails):
    phi, chart = (
        np.where(np.arange(4) == 3, 1.5 if fails == "phi" else 0.0, 0.0),
        integers(0, 0, int(fails == "chart"), 0),
    )
    images = None if fails == "images" else points([0.1, 0.3, 0.45, 0.7], phi, chart)
    monkeypatch.setattr(core_of, "twice", lambda map, sets: images)
    monkeypatch.setattr(core_of, "_converges", lambda map, core: fails != "converges")
    monkeypatch.setattr(
        core_of, "_leads", lambda map, core, outer, width: fails != {2.0: "first gate", 3.0: "second gate"}[outer]
    )
    found = attracts(MAP, replace(FLAT, gates=((2.0, 0.5), (3.0, 0.25))))
    come = {"phi": "orbits come to the middle", "chart": "orbits come to the middle"}
    wanted = come | {"converges": "they converge there", "first gate": "gates lead in", "second gate": "gates lead in"}
    assert {name for name, held in found.items() if not held} == (set(found) if fails == "images" else
        {wanted[fails]} if fails else set())  # fmt: skip


@pytest.mark.parametrize(("theta", "leads"), [((0.1, 0.9), True), ((0.1, 1.1), False), (None, False)])
def test_all_images_of_a_gate_lie_in_the_core(monkeypatch, theta, leads):
    asked = []
    monkeypatch.setattr(core_of, "twice", lambda map, sets: asked.append(sets) or (theta and points(theta)))
    assert core_of._leads(MAP, FLAT, 2.0, 0.0025) is leads
    assert asked[0].chart.size == 3 * core_of.COARSER  # slabs at most so thick as is said
    core_of._leads(MAP, FLAT, 2.0, 1e-4)
    assert asked[1].chart.size == core_of.COARSER
    reach = asked[0].middle[1] + asked[0].sides[1, 1], asked[0].middle[1] - asked[0].sides[1, 1]
    assert reach[0].max() == pytest.approx(0.0025)
    assert reach[1].min() == pytest.approx(-0.0025)
    assert (asked[0].middle[0] + asked[0].sides[0, 0]).max() == pytest.approx(2.0)


def test_orbits_converge_over_boxes_about_the_inner_core_that_are_hardly_wider(monkeypatch):
    asked = []
    monkeypatch.setattr(core_of, "derivative", lambda map, boxes: asked.append(boxes))
    core_of._converges(None, replace(FLAT, slope=-0.5, cubic=2.0, width=0.25))
    (boxes,) = asked
    assert (boxes.x[0].min(), boxes.x[1].max()) == pytest.approx((-0.5, 0.5))
    assert (boxes.y[0].min(), boxes.y[1].max()) == pytest.approx((-0.75, 0.75))
    assert boxes.y[0].min() <= -0.75
    assert boxes.y[1].max() >= 0.75


@pytest.mark.parametrize(("theta", "outer", "width", "held"), [
    (0.5, 1.0, 0.1407, True), (0.5, 1.0, 0.1406, False), (-0.5, 1.0, 0.1407, True), (-0.5, 1.0, 0.1406, False),
    (0.5, 1.0, 0.140625 * (1 + 2e-12), True), (0.5, 1.0, 0.140625 * (1 + 5e-13), False),  # with the roundings
    (0.5, 0.75 * (1 + 2e-12), 1.0, True), (0.5, 0.75 * (1 + 5e-13), 1.0, False),
])  # fmt: skip
def test_a_set_along_the_curve_is_as_far_from_it_as_a_cubic_from_its_tangent(theta, outer, width, held):
    """Of `phi = theta**3`: at most 3 times 3/4, times the square of 1/4, from 1/2 to 1/4 and 3/4."""
    core = replace(FLAT, cubic=1.0, outer=outer, width=width)
    sides = np.zeros((2, 2, 1))
    sides[:, 0, 0] = 0.25, 0.25 * 3 * theta**2
    one = replace(points([theta], [theta**3]), sides=sides)
    assert core.holds(one).tolist() == [held]
    x = theta + np.linspace(-0.25, 0.25, 101)
    aside = np.abs(x**3 - theta**3 - 3 * theta**2 * (x - theta))
    assert aside.max() <= 0.140625


@pytest.mark.parametrize("wrong", [
    {"cells": 0}, {"inner": 0.0}, {"outer": -1.0}, {"width": np.inf}, {"gates": ((0.5, 0.0),)},
    {"gates": ((np.inf, 1.0),)}, {"inner": np.nan},
])  # fmt: skip
def test_a_core_has_cells_and_finite_sizes(wrong):
    assert replace(FLAT, cells=1, gates=((2.0, 0.5),)).bounds == (1.0, 1.0)
    with pytest.raises(ValueError, match="accepted"):
        replace(FLAT, **wrong)


def test_the_parts_of_a_core_are_a_little_wider_than_its_cells():
    """By hand: four cells of half a width of 1/8, along `theta/2 + 2*theta**3`, moved up by 1 and down by 3."""
    parts = replace(FLAT, slope=0.5, cubic=2.0).parts(floats(1, -3))
    middle = np.tile(floats(0.125, 0.375, 0.625, 0.875), 2)
    assert parts.middle[0] == pytest.approx(middle)
    assert parts.middle[1] == pytest.approx(middle / 2 + 2 * middle**3 + np.repeat(floats(1, -3), 4))
    assert parts.sides.shape == (2, 2, 8)
    assert parts.rest.shape == (2, 8)
    bend = 6 * (middle + 0.125) * 0.125**2
    tilt = parts.sides[1, 0] / parts.sides[0, 0]
    assert tilt == pytest.approx(0.5 + 6 * middle**2)
    for ours, exact in ((parts.sides[0, 0], 0.125), (parts.sides[1, 1], 1.0), (parts.rest[1], bend)):
        assert np.all((exact < ours) & (ours < exact * (1 + 1e-8)))
    assert not np.any(parts.sides[0, 1])
    assert not np.any(parts.rest[0])
    assert FLAT.parts().middle[1].tolist() == [0.0] * 4
    assert np.all(FLAT.parts().rest[1] > 0)  # for roundings


def still(x, count=2) -> BallArray:
    return BallArray(np.full(count, float(x)), np.zeros(count))


@pytest.mark.parametrize("fails", [None, "two pieces", "no piece", "on", "source", "an empty piece"])
def test_the_derivative_of_two_bounces_is_a_product_where_all_land_on_one_component(monkeypatch, fails):
    matrices = iter([[[1, 2], [3, 4]], [[5, 7], [11, 13]]])
    monkeypatch.setattr(core_of, "matrix", lambda slopes: [[still(x) for x in row] for row in slopes])
    monkeypatch.setattr(
        core_of, "carried", lambda map, sets: (integers(0, 0) if fails == "source" else integers(0, 1), sets)
    )

    def derivatives(boxes):
        piece = SimpleNamespace(on=integers(1, 0) if fails == "on" else integers(0, 1))
        empty = SimpleNamespace(on=integers())
        found = {"two pieces": [piece, piece], "no piece": [empty], "an empty piece": [empty, piece]}.get(
            fails, [piece]
        )
        slopes = next(matrices)
        return [(one, slopes) for one in found]

    boxes = Boxes(integers(0, 0), (floats(0, 1), floats(1, 2)), (floats(0, 1), floats(1, 2)))
    found = derivative(SimpleNamespace(derivatives=derivatives), boxes)
    if fails in (None, "an empty piece"):
        assert [[x.m.tolist() for x in row] for row in found] == [[[26] * 2, [38] * 2], [[50] * 2, [74] * 2]]
    else:
        assert found is None
