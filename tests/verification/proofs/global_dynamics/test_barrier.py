"""Curves that the map takes below themselves: that all below stays below, and what must not be proved."""

from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics import barrier as barriers
from verification.proofs.global_dynamics import crisis
from verification.proofs.global_dynamics.barrier import Barrier, lost, point
from verification.proofs.global_dynamics.boxes import Boxes, Chart, Images
from verification.proofs.global_dynamics.graph import Grid
from verification.proofs.manifolds.known import BOUNDARY, SHAPE

EGG, AT = Scene("egg", alpha="0.08"), Fraction(66, 100)
SINK, CROSSES, AFTER = (-3.0003, 0.4175), 0.7251, Fraction(6623, 10000)


@pytest.fixture(scope="module")
def barrier() -> Barrier:
    return Barrier(EGG, (AT, AT), 4096)


def test_no_orbit_that_begins_below_the_barrier_comes_above_it(barrier):
    """Half a million bounces of the kernel, which shares no formula with boxes; the starts crowd below the curve."""
    rng = np.random.default_rng(1)
    columns = rng.integers(0, barrier.columns, 5000)
    theta = (columns + 0.5) / (barrier.columns * barrier.turns) * 2 * np.pi - np.pi
    phi = barrier.heights[columns] - rng.exponential(0.01, 5000)
    orbit = PinballMap("egg", lam="0.66", alpha="0.08").orbit(theta, phi, 100)
    ends = orbit.theta[1:].ravel(), orbit.phi[1:].ravel()

    assert not np.any(barrier.above(Boxes(np.zeros(ends[0].size, dtype=np.int64), *((x, x) for x in ends))))
    assert barrier.between(point(0.3, 0.0)).all()
    assert barrier.above(point(*SINK)).all()


def test_points_of_every_step_and_of_every_border_between_two_are_mapped_below_the_staircase_all_around(barrier):
    """By the kernel, also over the seam; steps that are not asked about again after a neighbour rose would show."""
    count, rng = barrier.columns * barrier.turns, np.random.default_rng(2)
    column = np.repeat(np.arange(count), 8)
    share, width = rng.random(column.size), 2 * np.pi / count
    left, (own, before) = column * width - np.pi, (barrier.heights[(column - k) % barrier.columns] for k in (0, 1))
    theta, phi = np.append(left + share * width, left), np.append(own, own + (before - own) * share)
    step = PinballMap("egg", lam="0.66", alpha="0.08").step(theta, phi, np.zeros(theta.size, dtype=int))
    landed = np.floor((step.theta + np.pi) / width).astype(int) % barrier.columns

    assert np.all(step.phi < barrier.heights[landed])


def test_a_barrier_is_lost_where_the_tangency_of_manifolds_is(barrier):
    """That was located, and proved, by other means."""
    assert all(lost(barrier, AFTER, SINK, CROSSES).values())
    assert barrier.lam[0] < Fraction(BOUNDARY[SHAPE][1]) < AFTER


def test_beyond_the_crisis_no_barrier_is_below_the_triangle():
    """The least one goes around above it."""
    assert not Barrier(EGG, (AFTER, AFTER), 4096).above(point(*SINK)).any()


def test_an_orbit_that_does_not_cross_proves_no_loss(barrier, monkeypatch):
    monkeypatch.setattr(crisis, "MOST_BOUNCES", 4)
    assert lost(barrier, AFTER, SINK, 0.0)["crossed"] is None  # the end of a diameter stays there


def test_a_barrier_at_a_cycle_that_lies_below_it_is_not_apart(barrier):
    assert lost(barrier, AFTER, (SINK[0], -SINK[1]), CROSSES)["apart"] is None


@pytest.mark.parametrize(
    ("scene", "lam"),
    [(Scene("cuspless"), AT), (EGG, Fraction(0)), (Scene("egg", law="-lam*sin(eta)", alpha="0.08"), AT)],
)
def test_tables_with_joins_a_map_that_is_not_invertible_and_other_laws_are_refused(scene, lam):
    with pytest.raises(ValueError, match="barrier: "):
        _ = Barrier(scene, (lam, AT), 64).heights


@pytest.mark.parametrize("missing", ["heights", "taken"])
def test_without_a_barrier_or_a_region_beyond_it_nothing_is_said_of_either(monkeypatch, missing):
    stated = Barrier(EGG, (AT, AT), 64)
    stated.__dict__["heights"] = None if missing == "heights" else np.zeros(64)
    monkeypatch.setattr(barriers, "PinballImages", lambda *_: None)
    monkeypatch.setattr(barriers, "grown", lambda *_: None if missing == "taken" else (None, None))
    monkeypatch.setattr(barriers, "enters", lambda *_: True)

    assert lost(stated, AFTER, SINK, CROSSES) == dict.fromkeys(("barrier", "taken", "apart", "crossed"))


@pytest.mark.parametrize(
    ("radius", "turns", "mirrored"),
    [
        ("1 + cos(3*theta)/40", 3, True),
        ("1 + cos(3*theta)/40 + sin(6*theta)/200", 3, False),
        ("1 + cos(theta)/9", 1, True),
    ],
)
def test_turns_and_mirror_images_of_a_table_are_counted_apart(radius, turns, mirrored):
    found = Barrier(Scene.of({"polar": radius, "lam": "1/2"}), (AT, AT), 64)

    assert (found.turns, found.mirrored) == (turns, mirrored)
    assert (found.grid.columns, found.grid.rows) == (64 * turns, 1)


def test_a_box_is_on_a_side_of_the_staircase_where_it_is_on_that_side_of_every_step_below_or_above_it():
    """Narrow boxes and wide ones at once, over the seam too; three turns of eight steps."""
    stated, rng = Barrier(EGG, (AT, AT), 8), np.random.default_rng(5)
    heights = stated.__dict__["heights"] = rng.uniform(-0.5, 0.5, 8)
    left, wide = rng.uniform(-np.pi, np.pi, 60), rng.choice([0.01, 0.3, 1.5], 60)
    bottom, tall = rng.uniform(-0.6, 0.6, 60), rng.choice([0.02, 0.4], 60)
    boxes = Boxes(np.zeros(60, dtype=np.int64), (left, left + wide), (bottom, bottom + tall))
    width = 2 * np.pi / 24
    steps = [
        np.unique(np.floor((np.linspace(a, b, 200) + np.pi) / width).astype(int) % 8)
        for a, b in zip(*boxes.x, strict=True)
    ]

    tops = bottom + tall
    assert list(stated.below(boxes)) == [top < heights[some].min() for top, some in zip(tops, steps, strict=True)]
    assert list(stated.above(boxes)) == [b > heights[some].max() for b, some in zip(bottom, steps, strict=True)]
    assert 0 < stated.below(boxes).sum() < 60
    stated.__dict__["heights"] = None
    assert not stated.below(boxes).any()
    assert not stated.above(boxes).any()


class Staircase(Barrier):
    """Steps above a plain strip, whose map is what a test says."""

    def __init__(self, map, columns):
        super().__init__(EGG, (AT, AT), columns)
        chart = Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True)
        self.__dict__ |= {"map": map, "turns": 1, "grid": Grid((chart,), columns, 1)}


def test_the_boxes_of_steps_and_of_borders_hold_all_of_the_staircase_and_little_beside_it():
    """Of borders in pieces that are no higher than two columns are wide, one upon the other."""
    stairs, width = Staircase(None, 16), 2 * np.pi / 16
    heights = np.random.default_rng(3).uniform(-2, 2, 16)
    wanted = np.arange(16) % 5 < 3
    boxes = stairs._pieces(heights, wanted)
    rows = [*zip(*boxes.x, *boxes.y, strict=True)]
    for k, row in zip(np.flatnonzero(wanted), rows, strict=False):
        left = -np.pi + k * width
        assert row == pytest.approx((left, left + width, heights[k] - 1e-7, heights[k] + 1e-7), abs=1e-12)
        assert row[0] <= left
        assert left + width <= row[1]
        low, high = sorted((heights[k], heights[k - 1]))
        pile = sorted(some[2:] for some in rows[wanted.sum() :] if some[0] < left < some[1])
        assert len(pile) == max(1, np.ceil((high - low) / (2 * width)))
        assert [pile[0][0], pile[-1][1]] == pytest.approx([low - 1e-7, high + 1e-7], abs=1e-12)
        assert all(b[0] < a[1] for a, b in pairwise(pile))
        assert max(top - bottom for bottom, top in pile) <= 2 * width + 2.1e-7
    assert all(0 < b - a < 2.1e-12 for a, b, *_ in rows[wanted.sum() :])


@pytest.mark.parametrize("block", [4, 1 << 14])
@pytest.mark.parametrize("lost_box", [None, 0, 6])
def test_each_step_is_raised_above_all_images_that_come_to_its_column(monkeypatch, block, lost_box):
    """Also over the seam; those of the columns that changed and of the borders to their right are asked for."""
    random, asked, seen = np.random.default_rng(8), [], []
    monkeypatch.setattr(barriers, "BLOCK", block)

    def images(boxes):
        count = boxes.chart.size
        left, wide, top = random.uniform(-4, 3, count), random.uniform(0, 2, count), random.uniform(-0.3, 0.6, count)
        gone = np.array([lost_box] if lost_box is not None and len(seen) <= lost_box < len(seen) + count else [], int)
        seen.extend(zip(left, left + wide, top, strict=True))
        return Images(np.arange(count), Boxes(boxes.chart, (left, left + wide), (top - 0.1, top)), gone)

    stairs, heights = Staircase(SimpleNamespace(images=images), 8), random.uniform(0, 0.2, 8)
    pieces = Barrier._pieces
    monkeypatch.setattr(Barrier, "_pieces", lambda self, *given: asked.append(given[1]) or pieces(self, *given))
    found = stairs._raised(heights, np.isin(np.arange(8), (1, 2, 7)), True)

    assert [np.flatnonzero(some).tolist() for some in asked] == [[0, 1, 2, 3, 7]]
    if lost_box is not None:
        assert found is None
        return
    wanted, width = heights.copy(), 2 * np.pi / 8
    for left, right, top in seen:
        for column in range(int(np.floor((left + np.pi) / width)), int(np.floor((right + np.pi) / width)) + 1):
            wanted[column % 8] = max(wanted[column % 8], top + 1e-7)
    assert found == pytest.approx(wanted, abs=1e-15)
    assert np.any(found > heights)


def test_a_staircase_is_told_once_boxes_raise_it_no_more_and_while_it_stays_below_all_exit_angles(monkeypatch):
    asked = []

    def heights(*rounds):
        """What is told where the rounds raise the first of three steps so, first by points and then by boxes."""
        left = list(rounds)
        asked.clear()

        def raised(self, heights, changed, proved):
            asked.append((proved, changed.tolist()))
            to = left.pop(0)
            return None if to is None else np.maximum(heights, [to, 0, 0])

        monkeypatch.setattr(Barrier, "_raised", raised)
        found = Staircase(SimpleNamespace(top=0.75), 3).heights
        return None if found is None else found.tolist()

    every, first = [True] * 3, [True, False, False]
    assert heights(0.25, 0.5, 0.5, 0.5) == [0.5, 0, 0]
    assert asked == [(False, every), (False, first), (False, first), (True, every)]
    assert heights(0.25, 0.25, 0.5, 0.5) == [0.5, 0, 0]
    assert asked == [(False, every), (False, first), (True, every), (True, first)]
    assert heights(0.0, 0.0) == [0, 0, 0]
    assert heights(0.25, None) is None
    assert heights(0.25, 0.75) is None  # at the top itself
    assert heights(0.0, None) is None
    monkeypatch.setattr(barriers, "ROUNDS", 2)
    assert heights(0.25, 0.25, 0.5, 0.5) == [0.5, 0, 0]
    assert heights(0.25, 0.5, 0.5) is None
    assert heights(0.25, 0.25, 0.5, 0.625) is None


@pytest.mark.parametrize("mirrored", [True, False])
def test_between_a_barrier_and_its_mirror_image_are_boxes_below_both_that_is_of_a_map_that_has_one(mirrored):
    stairs = Staircase(SimpleNamespace(mirrored=mirrored), 4)
    stairs.__dict__["heights"] = np.array([0.1, 0.2, 0.3, 0.4])
    theta, phi = np.array([-3.0, -3.0, -3.0, 3.0, 3.0]), np.array([0.05, 0.15, -0.35, 0.35, -0.15])
    boxes = Boxes(np.zeros(5, dtype=int), (theta, theta), (phi, phi))
    assert stairs.below(boxes).tolist() == [True, False, True, True, True]
    assert stairs.between(boxes).tolist() == [mirrored and held for held in (True, False, True, True, False)]


@pytest.mark.parametrize(("apart", "crossed"), [([True, True], True), ([True, False], True), ([True, True], False)])
def test_a_barrier_is_lost_where_it_is_apart_from_all_cells_and_the_orbit_enters_them(monkeypatch, apart, crossed):
    asked = []
    stated = SimpleNamespace(
        lam=(AT, (AT + AFTER) / 2), scene=EGG, heights=np.zeros(4), above=lambda boxes: np.array(apart)
    )
    taken = SimpleNamespace(boxes=lambda cells: "boxes"), None
    monkeypatch.setattr(barriers, "PinballImages", lambda scene, lam: lam)
    monkeypatch.setattr(barriers, "marked_cells", lambda member: "cells")
    monkeypatch.setattr(barriers, "grown", lambda map, grid, start: asked.append((map, start)) or taken)
    monkeypatch.setattr(barriers, "enters", lambda *given: asked.append(given) or crossed)
    found = lost(stated, AFTER, SINK, CROSSES)

    assert found == {"barrier": True, "taken": True, "apart": all(apart) or None, "crossed": crossed or None}
    assert asked[0][0] == (AT, AFTER)
    assert [float(end[0]) for end in (*asked[0][1].x, *asked[0][1].y)] == [SINK[0], SINK[0], SINK[1], SINK[1]]
    scene, lam, (theta, phi), cells = asked[1]
    assert (scene, lam, float(theta), float(phi), cells) == (EGG, AFTER, CROSSES, 0.0, taken)
