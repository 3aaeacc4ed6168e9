"""How far the egg's attractor reaches: bounds that orbits agree with, known answers, and what proves nothing."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.starts import extent as extent_of
from verification.proofs.starts.extent import Extent
from verification.proofs.starts.parallelograms import Parallelograms


def egg(lam: str, columns: int = 8192) -> Barrier:
    """A barrier at one contraction."""
    return Barrier(Scene("egg", alpha="0.08"), (Fraction(lam), Fraction(lam)), columns)


@cache
def half() -> Extent:
    """At 0.5, with a curve found once by hand."""
    return Extent(egg("0.5"), (1.901118735636582, 0.17411021420227438), 11, 0.4)


def test_orbits_reach_as_far_as_the_bounds_say():
    """Of 200 orbits of 2000 bounces the largest exit angle at 0.5 is below the upper bound, and close to both."""
    found = half()
    map = PinballMap("egg", lam="0.5", alpha="0.08")
    start = np.random.default_rng(1).uniform(-0.05, 0.05, (2, 200))
    settled = map.exponents(start[0], start[1], 500, 2000)
    seen = float(np.max(np.abs(map.orbit(settled.theta, settled.phi, 2000).phi)))
    assert seen < found.high
    assert found.low <= found.high
    assert abs(found.low - seen) < 0.001
    assert found.high - seen < 0.001


def test_the_curve_crosses_all_that_is_kept_and_its_points_go_the_same_way():
    """Its ends lie beyond both barriers; those within are, after its bounces, within a hundredth of one another."""
    found = half()
    theta, phi = found.curve
    zero = np.zeros(theta.size, dtype=np.int64)
    points = Boxes(zero, (theta, theta), (phi, phi))
    above, below = found.barrier.above(points), found.barrier.above(points.mirrored())
    assert above[-1]
    assert below[0]
    map = PinballMap("egg", lam="0.5", alpha="0.08")
    at = theta[~(above | below)], phi[~(above | below)]
    assert np.ptp(at[1]) > 0.01
    for _ in range(found.bounces):
        step = map.step(*at)
        at = step.theta, step.phi
    assert np.ptp(np.unwrap(at[0])) < 0.01
    assert np.ptp(at[1]) < 0.01


def test_in_the_circle_nothing_is_kept_but_the_diameters():
    """Every exit angle is multiplied by `lam`: what is kept has `phi = 0`, and both bounds say so."""
    circle = Extent(Barrier(Scene("circle"), (Fraction(1, 2), Fraction(1, 2)), 256), (0.0, 0.0), 3, 0.1)
    assert circle.low <= 0 < circle.high < 1e-5


@pytest.mark.parametrize(
    "change",
    [
        {"height": 0.01},  # its ends lie between the barriers
        {"barrier": egg("0.5", 256)},  # too few steps: no barrier
        {"barrier": egg("0.67")},  # beyond the crisis there is none
    ],
)
def test_where_a_step_is_not_proved_nothing_is_said(change):
    assert replace(half(), **change).low == 0


KEPT = 0.5  # what is kept has a smaller exit angle, and all smaller ones are


def moved(bounces: int = 2, by: float = 0.25, ends: tuple[float, float] = (-1.0, 1.0), mirrored: bool = True) -> Extent:
    """Of the map `phi -> phi + by`, along a curve of one `theta`."""
    barrier = SimpleNamespace(
        heights=np.array([0.1, KEPT, 0.3]), mirrored=mirrored, map=by, above=lambda boxes: boxes.y[0] > KEPT
    )
    found = Extent(barrier, (0.0, 0.0), bounces, 1.0)
    found.__dict__["curve"] = np.zeros(extent_of.SIDES + 1), np.linspace(*ends, extent_of.SIDES + 1)
    return found


def test_of_each_point_of_the_curve_the_farthest_image_counts_and_of_all_points_the_least(monkeypatch):
    """Worked out by hand: within two bounces the points at -0.375 come to -0.125 and 0.125, and none stays nearer."""

    def shifted(by, sets):
        middle = sets.middle + np.array([[0.0], [by]])
        return np.arange(sets.chart.size), Parallelograms(sets.chart, middle, sets.sides, sets.rest)

    monkeypatch.setattr(extent_of, "carried", shifted)
    fine = 2 / extent_of.SIDES
    assert 0.125 - 2 * fine < moved().low <= 0.125
    assert 0.125 - 2 * fine < moved(by=-0.25).low <= 0.125
    assert 0.0 <= moved(bounces=1).low + 2 * fine < 3 * fine
    assert 0.25 - 2 * fine < moved(bounces=3, by=0.25).low <= 0.25
    assert moved().high == KEPT
    assert (moved(mirrored=False).high, moved(mirrored=False).low) == (np.inf, 0.0)
    for ends in ((-1.0, 0.4), (-0.4, 1.0), (1.0, -1.0)):  # it does not cross all that is kept, from below
        assert moved(ends=ends).low == 0.0
    monkeypatch.setattr(
        extent_of, "carried", lambda by, sets: shifted(by, replace(sets, rest=np.full_like(sets.rest, 0.4)))
    )
    assert moved().low == 0.0  # sets so wide are given up


def test_a_curve_crosses_all_that_is_kept_with_its_first_and_its_last_side(monkeypatch):
    """These alone lie beyond; with less of them it does not cross. All of its points are moved up by 1."""
    monkeypatch.setattr(extent_of, "carried", lambda by, sets: (
        np.arange(sets.chart.size), replace(sets, middle=sets.middle + np.array([[0.0], [1.0]]))
    ))  # fmt: skip
    fine = 2 * KEPT / (extent_of.SIDES - 2)
    for first, last, crosses in ((1.5, 1.5, True), (0.9, 1.5, False), (1.5, 0.9, False)):
        found = moved(1, ends=(-KEPT - first * fine, KEPT + last * fine))
        found.__dict__["curve"] = np.linspace(0, 1, extent_of.SIDES + 1), found.curve[1]
        asked = []
        found.barrier.above = lambda boxes, asked=asked: asked.append(boxes) or boxes.y[0] > KEPT
        found.barrier.heights = np.array([KEPT])
        reached = found.low
        assert 0.49 < reached < 0.5 if crosses else reached == 0.0
        assert len(asked) == 2
        theta, phi = found.curve
        for (low, high), ends in ((asked[0].x, theta), (asked[0].y, phi)):
            assert np.all((low < ends[:-1]) & (ends[1:] < high))
            assert np.all((low > ends[:-1] - 1e-11) & (high < ends[1:] + 1e-11))
        left = ~((asked[0].y[0] > KEPT) | (asked[1].y[0] > KEPT))
        assert (left[0], left[-1]) == (first < 1, last < 1)


def test_of_a_curve_that_lies_beyond_as_a_whole_nothing_is_said(monkeypatch):
    monkeypatch.setattr(extent_of, "carried", lambda by, sets: (np.arange(sets.chart.size), sets))
    found = moved()
    found.barrier.above = lambda boxes: np.full(boxes.chart.size, True)
    assert found.low == 0.0


def test_only_what_a_barrier_bounds_has_a_highest_angle():
    found = moved()
    found.barrier.heights = None
    assert (found.high, found.low) == (np.inf, 0.0)
