"""Curves that the map takes below themselves: that all below stays below, and what must not be proved."""

from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics import barrier as barriers
from verification.proofs.global_dynamics import crisis
from verification.proofs.global_dynamics.barrier import Barrier, lost, point
from verification.proofs.global_dynamics.boxes import Boxes
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
    bottom = rng.uniform(-0.6, 0.6, 60)
    boxes = Boxes(np.zeros(60, dtype=np.int64), (left, left + wide), (bottom, bottom + 0.02))
    width = 2 * np.pi / 24
    steps = [
        np.unique(np.floor((np.linspace(a, b, 200) + np.pi) / width).astype(int) % 8)
        for a, b in zip(*boxes.x, strict=True)
    ]

    assert list(stated.below(boxes)) == [b + 0.02 < heights[some].min() for b, some in zip(bottom, steps, strict=True)]
    assert list(stated.above(boxes)) == [b > heights[some].max() for b, some in zip(bottom, steps, strict=True)]
    assert 0 < stated.below(boxes).sum() < 60
    stated.__dict__["heights"] = None
    assert not stated.below(boxes).any()
    assert not stated.above(boxes).any()
