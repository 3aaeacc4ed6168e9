"""A landing is at a corner, or a tangent, if rounding hides the side on which the flight passes, at every scale."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap, Status, phase_starts
from numeric.flights.general import UNSURE
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from symbolic.tables.gallery import GALLERY
from symbolic.tables.table import theta
from verification.measure.extremes import by_hand
from verification.measure.extremes.by_hand import bounced, comet, hard, judged

EPS = 2.0**-52
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
NOTCHED = tables.polygon((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), name="notched")
SMALL = Rational(1, 10**6)
UNEQUAL = tables.polygon((0, 0), (SMALL, 0), (10**6, SMALL), (10**6, 1), (0, 1), name="unequal")
AWAY = tables.polygon((10**6, 10**6), (10**6 + 1, 10**6), (10**6 + 1, 10**6 + 1), (10**6, 10**6 + 1), name="away")
SIZES = {"1e-6": SMALL, "1": Rational(1), "1e6": Rational(10**6)}
SCENES = [(name, size) for name in ["square", "sinai", "reuleaux", "diamond", "notched"] for size in SIZES]
SCENES += [(name, "1") for name in ["stadium", "semi_ellipse", "mushroom", "unequal", "away"]]


def hundred():
    """A convex polygon of a hundred sides, with rational corners."""
    turn = 2 * np.pi * np.arange(101) / 100
    at = [[Rational(round(f(part) * 10**6), 10**6) for f in (np.cos, np.sin)] for part in turn]
    sides = [tables.arc(f"{i}", x + theta * (X - x), y + theta * (Y - y), 0, 1) for i, ((x, y), (X, Y)) in
             enumerate(pairwise(at))]  # fmt: skip
    return tables.Table("hundred", tuple(sides))


OWN = {
    "notched": lambda: NOTCHED,
    "unequal": lambda: UNEQUAL,
    "away": lambda: AWAY,
    "100 sides": hundred,
    "comet": comet,
}


@cache
def mapped(name, size="1", shift=(0, 0), lam=0.9, kernels=False):
    """The map of a table that is scaled by a factor and shifted by a multiple of it."""
    table = (OWN.get(name) or GALLERY[name])()
    if (size, shift) != ("1", (0, 0)):
        points = [
            [SIZES[size] * (x + by) for x, by in zip(part.point, shift, strict=True)] for part in table.components
        ]
        parts = zip(table.components, points, strict=True)
        table = tables.Table(name, tuple(tables.arc(part.name, *point, part.start, part.end) for part, point in parts))
    return PinballMap(table, lam=lam, kernels=kernels)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size"), SCENES)
def test_no_flight_past_a_corner_or_a_tangent_lands_on_the_wrong_side_and_only_those_near_one_stop(name, size):
    map = mapped(name, size)
    for starts in hard(map, 300, seed=21).values():
        found = judged(map, starts)

        assert not np.any(found.wrong)
        assert np.max(found.error) < 1  # a bound of eight is promised
        assert np.max(found.reason) < 5 * UNSURE / EPS


LOT = [(0, 0), (4, 0), (4, 3), (0, 3), (0, Rational(4, 1000))]  # the last side is a thousandth of the first
LIKE = [("notched", 1e-10, 0), ("notched", 1e8, 0), ("square", 1e-9, 0), ("square", 1, 10**9), ("lot", 1, 5 * 10**6)]


@pytest.mark.parametrize(("name", "size", "shift"), LIKE)
def test_a_table_of_any_size_at_any_place_has_the_flights_of_a_like_one(name, size, shift):
    """Up to the rounding of its points: of a thousand random flights none ends elsewhere."""
    corners = {"notched": [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], "lot": LOT}.get(name) or SQUARE
    factor = Rational(f"{size:g}")
    moved = tables.polygon(*((factor * x + shift, factor * y + shift) for x, y in corners))
    one, other = (PinballMap(table, lam=0.9, kernels=False) for table in (tables.polygon(*corners), moved))
    starts = phase_starts(one, 1000, seed=29)
    here, there = (map.step(starts.theta, starts.phi, starts.component) for map in (one, other))
    aside = np.hypot(here.x - (there.x - shift) / size, here.y - (there.y - shift) / size) * np.cos(here.eta)

    assert not np.any(here.code)
    assert not np.any(there.code)
    assert np.array_equal(here.component, there.component)
    assert np.max(aside) < 8 * EPS * max(2, shift)


AIMED = ["square", "triangle", "reuleaux", "lemon", "semi_ellipse", "mushroom", "sinai", "notched"]
PLACES = [("1e-6", (0, 0)), ("1", (3, -5)), ("1e6", (Rational(-1, 2), 7))]


TARGETS = [(name, *place) for name in AIMED for place in PLACES]
TARGETS += [("100 sides", *PLACES[2]), ("comet", *PLACES[0])]  # dear ones, once


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size", "shift"), TARGETS)
def test_every_flight_that_is_aimed_at_a_corner_exactly_ends_there_wherever_the_table_is(name, size, shift):
    """From the rounded particle's place, in 64 bits; a flight that misses by five bounds neither stops nor errs."""
    map, rng, count = mapped(name, size, shift), np.random.default_rng(26), 200
    known = by_hand.pieces(map.family, map.shape)
    starts = phase_starts(map, count, seed=26)
    own = [np.asarray(row) for row in map.states.enter(starts.component, starts.theta, starts.phi, map.law)]
    z, _, size = by_hand.placed(known, map.family, own)
    goals = np.array([piece.start for j, piece in enumerate(known) if not map.family.closed[j]])
    way = goals[rng.integers(0, len(goals), count)].T - z
    far = np.hypot(*way)
    turn = 8 * UNSURE * (2 * size + far) / far  # the corner's numbers are no larger than its distance and the start's
    for off in (0 * turn, turn, -turn):
        aimed = [*own[:3], *((way + off * np.array([-way[1], way[0]])) / far / np.hypot(1, off)).astype(float)]
        frame = map.states.frame(starts.component, starts.theta)
        truth = by_hand.hits(map, aimed)
        seen = np.abs(frame.angle(map.states.ops, *aimed[3:])) < 1.5
        seen &= (truth.length >= far * (1 - 1e-6)) | (truth.aside < 16)
        result = map.engine.run(KernelSpec(map.law, record=True), aimed, np.full(count, 0.9), map.shape, 1)
        stopped = result.rows["code"][seen]

        assert np.sum(seen) > 30
        if not np.any(off):
            assert set(stopped) == {Status.JOIN.code}
        else:
            going = seen & (truth.aside > 5 * UNSURE / EPS)
            assert np.mean(going[seen]) > 0.5
            assert not np.any(result.rows["code"][going])
            assert np.array_equal(result.record[0][0][going], truth.piece[going])


def test_flights_to_corners_and_tangents_are_stopped_as_often_as_not():
    for name, kind in (("square", "at corners"), ("sinai", "at tangents"), ("notched", "at corners")):
        found = judged(mapped(name), hard(mapped(name), 300, seed=24)[kind])

        assert 0.2 < np.mean(found.stopped) < 0.8


@pytest.mark.parametrize("size", SIZES)
def test_along_the_normals_of_a_reuleaux_triangle_all_particles_end_in_the_opposite_corner(size):
    map = mapped("reuleaux", size, lam=0.0)
    starts = phase_starts(map, 250, seed=22)
    step = map.step(starts.theta, 0.0, starts.component)

    assert {status.name for status in step.status} == {"JOIN"}


def test_a_flight_past_a_corner_that_bends_into_the_table_ends_there_on_both_sides_of_it():
    """From the floor of the notched square to the corner (1, 1), passed on one side and met on the other."""
    map = mapped("notched")
    shifts = (-1e-12, -2 * EPS, 0, 2 * EPS, 1e-12)
    steps = [map.step(0.25, np.arctan(0.5) + shift, 0) for shift in shifts]  # from (1/2, 0)

    assert [step.status.name for step in steps] == ["REGULAR", "JOIN", "JOIN", "JOIN", "REGULAR"]
    assert [float(steps[0].x), float(steps[-1].y)] == pytest.approx([1, 1], abs=1e-11)


def test_a_short_flight_along_an_arc_is_no_landing_at_its_far_end():
    """Chords of 2e-12 in a half disc, a hundredth from its end: the landing is known to the last bits."""
    map = mapped("stadium", lam=1)
    step = map.step(np.pi / 2 - 0.01, np.pi / 2 - 1e-12, 0)

    assert step.status.name == "REGULAR"
    assert step.theta - (np.pi / 2 - 0.01) == pytest.approx(2e-12, rel=1e-3)


def test_kernels_and_arrays_stop_the_same_particles_up_to_rounding():
    plain, compiled = mapped("sinai"), mapped("sinai", kernels=True)
    starts = hard(plain, 400, seed=23)["at tangents"]
    one, other = (bounced(map, starts)[2] for map in (plain, compiled))

    assert np.mean(one != other) < 0.05


@pytest.mark.parametrize("factor", [1, SMALL, 10**6])
def test_a_table_of_any_two_arcs_has_its_corners_told_in_the_same_way(factor):
    """A lens of two parabolas, without closed form: one of them on each side of a corner."""
    lower = tables.arc("lower", factor * theta, factor * (theta**2 - 1) / 2, -1, 1)
    upper = tables.arc("upper", -factor * theta, factor * (1 - theta**2) / 2, -1, 1)
    map = PinballMap(tables.piecewise(lower, upper, name="lens"), lam=0.9, kernels=False)
    rng, count, wide = np.random.default_rng(25), 300, np.longdouble
    where, at = rng.integers(0, 2, count), rng.uniform(-0.9, 0.9, count)
    frame = map.states.frame(where, at)
    right = rng.choice([-1, 1], count)
    away = np.arctan2(-frame.y, float(factor) * right - frame.x)
    phi = frame.angle(map.states.ops, np.cos(away), np.sin(away)) + rng.integers(-40, 41, count) * EPS / 2
    own, after, code = bounced(map, (where, at, phi))
    x, y = own[1].astype(wide) * (1 - 2 * where), (own[1].astype(wide) ** 2 - 1) / 2 * (1 - 2 * where)
    aside = own[2].astype(wide) * (0 - y) - own[3].astype(wide) * (right - x)  # of the corner, as a share of the size
    going = code == 0
    above = right * aside < 0  # the line passes the corner on its upper side

    assert 0.2 < np.mean(going) < 0.8
    assert np.array_equal(after[0][going] == 1, above[going])
    assert np.max(np.abs(aside[~going])) < 5 * UNSURE * 2
