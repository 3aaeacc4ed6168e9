"""Horseshoes: proved where they are known, with entropies that no theorem forbids; refused where they are changed."""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from symbolic.tables import cuspless
from verification.arithmetic.balls import FLOAT64, balls, working
from verification.proofs.manifolds import horseshoe as horseshoes
from verification.proofs.manifolds.horseshoe import (
    BITS,
    Edge,
    Horseshoe,
    HSet,
    _apart,
    _crosses,
    _expands,
    _frame,
    _image,
    _times,
    built,
    crossings,
    horseshoe,
)
from verification.proofs.manifolds.known import SHAPE, TRIANGLE, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact

HENON, INNER = Henon(Rational(3, 10)), Orbit("inner fixed point", (0.63,))
EGG = Contact(TRIANGLE, TRIANGLE, 4, 1, 0.0286537538597, -0.160320745918, 0.7)


@cache
def classical():
    """The horseshoe of the Henon map at the classical parameters."""
    return horseshoe(INNER, HENON, 1.4, 1e-3)


def test_the_henon_map_has_a_horseshoe_at_the_classical_parameters():
    """Its entropy is at most log 2, as that of every quadratic map of the plane of this form [FriedlandMilnor1989]."""
    found = classical()

    assert found.checks == dict.fromkeys(("admissible", "covering", "disjoint", "cones"), True)
    assert 0.18 < found.entropy < math.log(2)


def test_where_all_points_that_stay_are_a_full_shift_a_horseshoe_is_found_below_its_entropy():
    """For a > (5 + 2*sqrt(5))*(1 + b)**2/4 the entropy is log 2 [DevaneyNitecki1979]."""
    found = horseshoe(Orbit("inner fixed point", (0.35,)), HENON, 5.0, 1e-4)

    assert found.proved
    assert 0.2 < found.entropy < math.log(2)


def test_the_entropy_bound_is_the_growth_rate_of_words_in_two_loops():
    p, n = classical().loops
    h = classical().entropy
    counts = [1]
    for k in range(1, 400):
        counts.append(sum(counts[k - step] for step in (p, n) if k >= step))

    assert h <= math.log(counts[-1] / counts[-2]) < h + 1e-9


def test_orbits_of_the_henon_map_follow_the_h_sets():
    found = classical()
    for k in range(1, len(found.sets) - 1):
        before, here = found.sets[k].centre
        assert HENON.following(before, here, 1.4) == pytest.approx(found.sets[k + 1].centre[1], abs=1e-9)


@pytest.mark.parametrize(
    "changed",
    [
        lambda made: {"middle": 1.3},  # other parameters
        lambda made: {"radius": 0.1},
        lambda made: {"sets": (made.sets[0], *reversed(made.sets[1:]))},
        lambda made: {"edges": made.edges[:-1]},  # the orbit does not come back
        lambda made: {"edges": (*made.edges[:-1], Edge(made.edges[-1].source, 1))},  # one edge turned
        lambda made: {"sets": tuple(HSet(s.centre, s.contracted, s.expanded) for s in made.sets)},
        lambda made: {"sets": (*made.sets[:3], scaled(made.sets[3], 2.0), *made.sets[4:])},
        lambda made: {"sets": (*made.sets[:1], made.sets[0], *made.sets[2:])},  # two loops that begin alike
    ],
)
def test_a_horseshoe_that_is_changed_is_not_proved(changed):
    found = replace(classical(), **changed(classical()))

    assert not found.proved
    assert found.entropy == 0


def scaled(h, by):
    return HSet(h.centre, tuple(by * x for x in h.expanded), tuple(by * x for x in h.contracted))


def test_h_sets_with_a_common_point_prove_nothing():
    found = classical()
    near = HSet(found.sets[1].centre, found.sets[0].expanded, found.sets[1].contracted)

    assert replace(found, sets=(found.sets[0], near, *found.sets[2:])).checks["disjoint"] is None


def test_no_horseshoe_is_found_where_every_orbit_that_stays_tends_to_a_cycle():
    assert crossings(Orbit("outer fixed point", (-2.2,)), HENON, 0.3, 4) == []
    with pytest.raises(ValueError, match="none of the outer fixed point"):
        horseshoe(Orbit("outer fixed point", (-2.2,)), HENON, 0.3, 1e-6, 4)


@cache
def egg():
    return built(EGG, table(SHAPE), 4, 4, 3e-5)


def test_the_egg_has_a_horseshoe_where_its_chaotic_attractor_has_ended():
    """At alpha = 0.08, 0.69997 <= lam <= 0.70003: infinitely many cycles, with orbits of positive entropy."""
    found = egg()

    assert found.proved
    assert found.loops == (1, 13)
    assert 0.151 < found.entropy < 0.152


def test_elastic_collisions_have_chaotic_orbits_in_the_egg():
    found = built(replace(EGG, z=0.024272312279, end=-0.107805922573, parameter=1.0), table(SHAPE), 3, 4, 1e-6)

    assert found.proved
    assert found.loops == (1, 12)


def test_a_horseshoe_of_the_egg_is_refused_with_another_symmetry_at_its_end():
    last = egg().edges[-1]
    turned = replace(last, turns=(last.turns[0] + 1, last.turns[1] + 1))

    assert not replace(egg(), edges=(*egg().edges[:-1], turned)).proved
    assert replace(egg(), map=Pinball(cuspless)).checks["admissible"] is None


@pytest.mark.parametrize(
    ("edges", "apart", "admissible", "missing"),
    [
        ({}, True, True, set()),
        ({2: (True, False)}, True, True, {"cones"}),
        ({-1: (True, False)}, True, True, {"cones"}),
        ({0: (False, False)}, True, True, {"covering", "cones"}),
        ({2: (True, False), -1: (False, True)}, True, True, {"covering", "cones"}),
        ({-1: (False, True)}, True, True, {"covering", "cones"}),
        ({}, False, True, {"disjoint"}),
        ({}, True, None, {"admissible"}),
    ],
)
def test_each_item_of_a_horseshoe_is_what_its_own_step_proves(monkeypatch, edges, apart, admissible, missing):
    made = replace(egg())
    wrong = {made.edges[k]: answer for k, answer in edges.items()}
    monkeypatch.setattr(type(made), "_covering", lambda self, map, parameter, edge: wrong.get(edge, (True, True)))
    monkeypatch.setattr(horseshoes, "_apart", lambda *_: apart)
    monkeypatch.setattr(horseshoes, "smooth", lambda _: admissible)

    assert made.checks == {item: None if item in missing else True for item in horseshoes.CHECKS}
    assert replace(made, edges=made.edges[:-1]).checks["covering"] is None  # these are no two loops
    assert (made.entropy > 0) is (not missing)


def point(h, x, y):
    """The point of an h-set with these coordinates."""
    return np.array(h.centre) + x * np.array(h.expanded) + y * np.array(h.contracted)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_covering_is_that_the_images_of_the_corners_lie_as_they_must_for_each_parameter(sign):
    """Of h-sets so small that the Henon map is affine over them, but for less than a hundredth of a side."""
    random, seen, size = np.random.default_rng(6), [], 1e-4
    map, spread = HENON.over(balls(BITS)), 1e-6
    for _ in range(500):
        source, at = random_h_set(random, size), random.uniform(-0.8, 0.8, 2)
        source = HSet(tuple(at), source.expanded, source.contracted)
        corners = {
            (x, y, move): (point(source, x, y)[1], HENON.following(*point(source, x, y), 1.4 + move))
            for x in (1, -1) for y in (1, -1) for move in (spread, -spread)
        }  # fmt: skip
        middle = np.mean(list(corners.values()), axis=0)
        way = (np.subtract(corners[1, 1, spread], corners[-1, 1, spread])) / 2  # about the image of the expanded side
        target = HSet(
            tuple(sign * (middle + random.uniform(-0.5, 0.5, 2) * size)),
            tuple(way * random.choice([0.3, 0.6, 1.1])),
            tuple(random.uniform(0.5, 4.0) * size * np.array((-way[1], way[0])) / np.hypot(*way)),
        )
        frame = np.column_stack([target.expanded, target.contracted]) * sign
        placed = {k: np.linalg.solve(frame, c - sign * np.array(target.centre)) for k, c in corners.items()}
        ends = [[c[0] for (x, _, _), c in placed.items() if x == side] for side in (1, -1)]
        left = any(min(a) > 1 and max(b) < -1 for a, b in (ends, ends[::-1]))
        covers = bool(left and max(abs(c[1]) for c in placed.values()) < 1)
        d = np.linalg.solve(
            frame, [[0, 1], [0.3, -2.8 * at[1]]] @ np.column_stack([source.expanded, source.contracted])
        )
        least = np.linalg.eigvalsh(d.T @ np.diag([1.0, -1.0]) @ d - np.diag([1.0, -1.0]))[0]
        if min(abs(abs(x) - 1) for c in placed.values() for x in c) < 0.02 or abs(least) < 0.1:
            continue
        found = Horseshoe(HENON, 1.4, spread, 1, (source, target), ())
        with working(BITS):
            assert found._covering(map, arb(1.4, spread), Edge(0, 1, sign)) == (covers, least > 0)
        seen.append((covers, bool(least > 0)))
    assert all(seen.count(each) > 20 for each in ((True, True), (False, True), (False, False)))


def random_h_set(random, size=1.0):
    return HSet(*(tuple(size * x) for x in random.uniform(-1, 1, (3, 2))))


def test_coordinates_in_an_h_set_are_those_that_its_points_have():
    """Mirrored and turned as an edge says: a turn of the egg is 2*pi/3 at each of the two bounces."""
    random = np.random.default_rng(1)
    for _ in range(20):
        h, (x, y) = random_h_set(random), random.uniform(-1, 1, 2)
        for map, turn in ((table(SHAPE), 2 * math.pi / 3), (HENON, 0.0)):
            for sign, turns in ((1, (0, 0)), (-1, (2, 1)), (1, (-1, 3))):
                at = sign * point(h, x, y) + turn * np.array(turns)
                inverse, centre = _frame(h, Edge(0, 0, sign, turns), map.over(balls(BITS)))
                found = _times(inverse, *(arb(a) - b for a, b in zip(at, centre, strict=True)))

                assert [float(z) for z in found] == pytest.approx([x, y], abs=1e-9)


@pytest.mark.parametrize(
    ("off", "matrix", "crosses"),
    [
        ((0, 0), (2, 0.5, 0.25, 0.5), True),
        ((0, 0), (-2, 0.5, 0.25, 0.5), True),
        ((0.75, 0), (2, 0.5, 0.25, 0.5), False),  # one end is not left by 0.25
        ((-0.75, 0), (2, 0.5, 0.25, 0.5), False),
        ((0, 0), (1.25, 0.5, 0.25, 0.5), False),
        ((0, 0), (1.5, -0.5, 0, 0), False),  # just reaches the end
        ((0, 0.25), (2, 0, 0.25, 0.5), False),  # just reaches a contracted end
        ((0, -0.5), (2, 0, 0.25, 0.5), False),
        ((0, 0), (2, 0, -0.75, 0.5), False),
        ((0, 0), (2, 0, 0.25, -1), False),
        ((0.25, -0.25), (2, -0.5, -0.25, 0.25), True),
    ],
)
def test_one_h_set_covers_another_when_its_ends_leave_and_nothing_reaches_the_contracted_ends(off, matrix, crosses):
    """The affine images of the four corners say the same: those of either end lie beyond 1 or -1, all between in y."""
    corners = {(x, y): np.array(off) + np.array(matrix).reshape(2, 2) @ (x, y) for x in (1, -1) for y in (1, -1)}
    ends = [[corners[x, y][0] for y in (1, -1)] for x in (1, -1)]
    left = any(min(a) > 1 and max(b) < -1 for a, b in (ends, ends[::-1]))
    assert bool(left and all(abs(c[1]) < 1 for c in corners.values())) is crosses
    assert _crosses(tuple(map(arb, off)), tuple(map(arb, matrix))) is crosses


def test_a_cone_condition_is_that_the_quadratic_form_grows_between_any_two_points():
    random, seen = np.random.default_rng(2), set()
    for _ in range(300):
        matrix = random.uniform(-2, 2, 4) * (1, 0.5, 0.5, 0.5)
        d, q = matrix.reshape(2, 2), np.diag([1.0, -1.0])
        least = np.linalg.eigvalsh(d.T @ q @ d - q)[0]
        if abs(least) > 1e-9:
            assert _expands(tuple(map(arb, matrix))) is bool(least > 0)
            seen.add(bool(least > 0))
    assert seen == {True, False}
    assert not _expands((arb(2, 1), arb(0), arb(0), arb(0)))


def test_two_h_sets_are_apart_only_when_one_lies_beyond_an_end_of_the_expanded_side_of_the_other():
    random, seen = np.random.default_rng(3), set()
    for _ in range(200):
        first, other = random_h_set(random, 0.3), random_h_set(random, 0.3)
        for map, sign, turns in ((HENON, 1, (0, 0)), (table(SHAPE), -1, (1, 0))):
            turn = 2 * math.pi / 3 * np.array(turns)
            frame = np.column_stack([first.expanded, first.contracted]) * sign
            corners = [point(other, x, y) - sign * np.array(first.centre) - turn for x in (1, -1) for y in (1, -1)]
            along = [np.linalg.solve(frame, c)[0] for c in corners]
            apart = bool(min(along) > 1 or max(along) < -1)
            seen.add(apart)
            assert _apart(first, Edge(0, 0, sign, turns), other, map.over(balls(BITS))) is apart
    assert seen == {True, False}
    far = HSet((7.0, 0.0), (0.1, 0.0), (0.0, 0.1))  # on angles the same place may come again a turn further
    near, small = HSet((0.0, 0.0), (0.1, 0.0), (0.0, 0.1)), ((0.1, 0.0), (0.0, 0.1))
    assert _apart(near, Edge(0, 0), far, HENON.over(balls(BITS)))
    assert not _apart(near, Edge(0, 0), far, table(SHAPE).over(balls(BITS)))
    for turned in (HSet((2 * math.pi + 0.1, 0.0), *small), HSet((-2 * math.pi, 0.0), *small)):
        assert not _apart(near, Edge(0, 0), turned, table(SHAPE).over(balls(BITS)))
    assert _apart(near, Edge(0, 0), HSet((5.7, 0.0), *small), table(SHAPE).over(balls(BITS)))


@pytest.mark.parametrize(("map", "parameter", "size"), [(HENON, 1.4, 0.05), (None, 0.7, 0.002)], ids=["henon", "egg"])
def test_the_image_of_an_h_set_is_its_centres_and_the_slopes_times_the_way_from_there(map, parameter, size):
    """Between any two points of the h-set, by the mean-value theorem; the map itself is float64's."""
    map, random = map or table(SHAPE), np.random.default_rng(4)
    centres = [(0.4, 0.3), (-0.5, 0.9)] if map is HENON else [(0.1, 2.2), (1.0, 3.2)]
    floats, spread = map.over(FLOAT64), 1e-3
    for centre in centres:
        h = HSet(centre, (size, size / 2), (-size / 3, size))
        with working(BITS):
            start, slopes = _image(map.over(balls(BITS)), arb(parameter, spread), h, parameter)
            for x, y in random.uniform(-1, 1, (40, 2)):
                before, here = point(h, x, y)
                at = parameter + spread * random.uniform(-1, 1)
                away = slopes[0] * (before - h.centre[0]) + slopes[1] * (here - h.centre[1])

                assert (start[1] + away + arb(0, 1e-12)).contains(float(floats.following(before, here, at)))
                assert start[0] == h.centre[1]
            assert float(slopes[1].rad()) < 1
    wide = HSet(centres[0], (3.0, 0.0), (0.0, 3.0))
    assert map is HENON or _image(map.over(balls(BITS)), arb(parameter), wide, parameter) is None


def two_loops(period, length):
    """The edges of two loops, one round of a cycle and an orbit that leaves it and comes back."""
    cycle = [(i, (i + 1) % period) for i in range(period)]
    orbit = [0, *range(period, length), 0]
    return [Edge(a, b) for a, b in (*cycle, *pairwise(orbit))]


@pytest.mark.parametrize(("period", "length"), [(1, 2), (1, 4), (2, 4), (3, 4), (3, 6)])
def test_two_loops_are_one_round_of_the_cycle_and_the_orbit_and_no_edge_else(monkeypatch, period, length):
    """Whichever order they are told in; the h-sets after the first one, on either loop, have to be apart."""
    sets = tuple(HSet((float(k), 0.0), (0.1, 0.0), (0.0, 0.1)) for k in range(length))
    asked, edges = [], two_loops(period, length)
    monkeypatch.setattr(Horseshoe, "_covering", lambda *_: (True, True))
    monkeypatch.setattr(horseshoes, "_apart", lambda *given: asked.append(given[:3]) or True)
    for some in (edges, edges[::-1]):
        found = Horseshoe(HENON, 1.4, 1e-3, period, sets, tuple(some))
        assert found.proved
        assert found.loops == (period, length - period + 1)
        assert asked[-1] == (sets[1 % period], Edge(0, 1 % period), sets[period])
    for k, edge in enumerate(edges):
        for target in set(range(length)) - {edge.target}:
            other = [*edges[:k], Edge(edge.source, target), *edges[k + 1 :]]
            made = Horseshoe(HENON, 1.4, 1e-3, period, sets, tuple(other))
            if any((e.source, e.target) == (0, 1 % period) for e in other):
                assert made.checks["covering"] is None
        if edge != edges[0]:
            assert Horseshoe(HENON, 1.4, 1e-3, period, sets, (*edges, edge)).checks["covering"] is None


def test_where_an_image_is_not_enclosed_nothing_is_covered(monkeypatch):
    monkeypatch.setattr(horseshoes, "_image", lambda *_: None)
    made = Horseshoe(HENON, 1.4, 1e-3, 1, (random_h_set(np.random.default_rng(0)),), ())
    assert made._covering(HENON, arb(1), Edge(0, 0)) == (False, False)


@pytest.mark.parametrize(("share", "proved"), [(0.99, False), (1.01, True), (3.0, True)])
def test_the_image_of_an_affine_map_is_found_from_a_guess_beside_it_where_a_step_stays_in_the_trial_ball(
    monkeypatch, share, proved
):
    """`2*x[1] = x[-1] + 3*x[0] + 1`: 7/4 after 1/4 and 3/4, guessed as 2; half-widths 1/8 and 1/16."""

    class Affine:
        def over(self, words):
            return SimpleNamespace(following=lambda *_: 2.0)

        def rule(self, near, parameter):
            return 2 * near[2] - near[0] - 3 * near[1] - parameter

        def slopes(self, near, parameter):
            return arb(-1), arb(-3), arb(2)

    step = 0.25 + 0.125 / 2 + 3 * 0.0625 / 2  # to the zeros of all rules over the h-set
    monkeypatch.setattr(horseshoes, "_roughly", lambda *_: arb(0, share * step))
    source = HSet((0.25, 0.75), (0.0625, 0.03125), (-0.0625, 0.03125))
    found = _image(Affine(), arb(1), source, 1.0)
    assert (found is not None) is proved
    if found:
        (here, there), slopes = found
        assert (float(here), float(there), *map(float, slopes)) == (0.75, 1.75, 0.5, 1.5)
    monkeypatch.setattr(Affine, "slopes", lambda *_: (arb(-1), arb(-3), arb(2, 2.5)))
    assert _image(Affine(), arb(1), source, 1.0) is None
