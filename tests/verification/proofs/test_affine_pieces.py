"""Maps of two affine pieces: hulls, parts, trapped polygons, cones and exponents, against float64 points."""

import math
from itertools import pairwise

import numpy as np
import pytest
from affine_pieces import SQUARE, affine
from flint import arb

from verification.proofs.corner.border_collision import (
    HAIR,
    FixedPointChange,
    clipped,
    expansion,
    exponents,
    holds,
    hull,
    kind,
    sides,
    trapped,
)
from verification.proofs.corner.corner import ARC, WALL


def turning(a, b, c):
    """Positive where `c` lies to the left of the line from `a` to `b`."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def test_a_hull_holds_its_points_and_turns_left():
    random = np.random.default_rng(7)
    for count in (3, 4, 6, 12, 40):
        points = [(int(u), int(v)) for u, v in random.integers(-5, 6, (count, 2))]
        found = hull(points)
        assert set(found) <= set(points)
        if len(found) > 2:
            assert all(turning(a, b, c) > 0 for (a, b), (_, c) in pairwise([*sides(found), *sides(found)[:1]]))
            assert all(turning(a, b, p) >= 0 for a, b in sides(found) for p in points)


def test_a_part_of_a_polygon_lies_between_two_levels():
    random = np.random.default_rng(8)
    for _ in range(40):
        polygon = hull([tuple(p) for p in random.uniform(-1, 1, (7, 2))])
        low, high = sorted(random.uniform(-1, 1, 2))
        shares = random.dirichlet(np.ones(len(polygon)) / 3, 60)
        within = [p for p in shares @ np.array(polygon) if low <= p[1] <= high]
        found = hull(clipped(polygon, low, high))
        assert found or not within
        assert all(turning(a, b, p) >= -1e-12 for a, b in pairwise([*found, *found[:1]]) for p in within)
        assert all(low <= v <= high for _, v in found)
        assert all(turning(a, b, p) >= -4 * HAIR for a, b in sides(polygon) for p in found)
        crossed = sum((p[1] - level) * (q[1] - level) < 0 for level in (low, high) for p, q in sides(polygon))
        assert len(clipped(polygon, low, high)) == 2 * crossed + sum(low < v < high for _, v in polygon)


def test_a_polygon_holds_exactly_the_points_inside_it():
    triangle = [(0.0, 0.0), (4.0, 1.0), (1.0, 3.0)]
    for u in range(-4, 20):
        for v in range(-4, 16):
            inside = all(turning(a, b, (u / 4, v / 4)) > 0 for a, b in sides(triangle))
            assert holds(triangle, (arb(u) / 4, arb(v) / 4)) is inside
    assert not holds(triangle, (arb(2, 3), arb("1.5")))
    assert not holds(triangle, (arb("1.5"), arb(2, 3)))


def test_a_trapped_polygon_is_one_whose_points_all_come_to_lie_inside():
    """Random pieces that agree on `v = 0`; shrinking the polygon or moving a corner out ends the trapping."""
    random, proved = np.random.default_rng(9), 0
    for _ in range(60):
        a, c = random.uniform(-0.7, 0.7, 2)
        b, d = random.uniform(-0.7, 0.7, (2, 2))
        shift = random.uniform(-1, 1, 2)
        made = {k: affine(a, b[k], c, d[k], *shift) for k in (ARC, WALL)}
        polygon = hull([tuple(p) for p in random.uniform(-4, 4, (6, 2))])
        for region in (polygon, polygon[:2] + [(u / 3, v / 3) for u, v in polygon[2:]]):
            shares = random.dirichlet(np.ones(len(region)) / 4, 200) @ np.array(region)
            images = [np.array([[a, b[k]], [c, d[k]]]) @ x + shift for x in shares for k in (int(x[1] > 0),)]
            kept = all(turning(p, q, x) > 0 for p, q in sides(hull(region)) for x in images)
            if trapped(made, hull(region)):
                proved += 1
                assert kept
            elif kept:  # then a corner leaves, or a point of the border next to one
                ends = [x for k in (ARC, WALL) for x in clipped(hull(region), *((-9, 0) if k == ARC else (0, 9)))]
                images = [np.array([[a, b[k]], [c, d[k]]]) @ x + shift for x in ends for k in (ARC, WALL)]
                assert any(turning(p, q, x) <= 1e-8 for p, q in sides(hull(region)) for x in images)
    assert proved > 10


def test_a_fold_has_both_fixed_points_on_their_own_sides_or_neither():
    """One piece contracts `v` about a point on its side, and the other stretches it."""
    for arc, wall, expected in (
        (-1, 1, FixedPointChange.FOLD),
        (1, -1, FixedPointChange.FOLD),
        (1, 1, FixedPointChange.PERSISTENCE),
        (-1, -1, FixedPointChange.PERSISTENCE),
        (0, 1, FixedPointChange.UNKNOWN),
        (0, 0, FixedPointChange.UNKNOWN),
    ):
        made = {ARC: affine(0.5, 0, 0, 0.5, 0, arc / 2), WALL: affine(0.5, 0, 0, 0.5, 0, wall / 2)}
        assert kind(made) is expected


def test_an_invariant_cone_stays_in_itself_and_its_vectors_grow_as_said():
    random, found = np.random.default_rng(11), 0
    for _ in range(40):
        rows = [[[u, w], [x, y]] for u, w, x, y in random.uniform((-1, -1, -1, 1), (1, 1, 1, 3), (2, 4))]
        cone = expansion({ARC: affine(*rows[0][0], *rows[0][1]), WALL: affine(*rows[1][0], *rows[1][1])})
        if cone is None:
            continue
        found += 1
        for ratio in np.linspace(float(cone.ratio.lower()), float(cone.ratio.upper()), 9):
            for step in rows:
                u, v = np.array(step) @ (ratio, 1.0)
                assert cone.ratio.contains(u / v)
                assert cone.least <= abs(v) * (1 + 1e-9)
                assert abs(v) * (1 - 1e-9) <= cone.most
    assert found > 10


def test_exponents_are_logarithms_of_known_factors():
    """A triangular matrix stretches `v` by its last entry; bounds may differ where orbits choose the piece."""
    double = affine(0.5, 0.1, 0, 2, 0, 0)
    treble = affine(0.5, 0.1, 0, 3, 0, 0)
    same = exponents({ARC: double, WALL: double}, SQUARE, bounces=2, length=3)
    other = exponents({ARC: double, WALL: treble}, SQUARE, bounces=1, length=3)

    assert same == pytest.approx((math.log(2) / 2, math.log(2) / 2), abs=1e-6)
    assert other == pytest.approx((math.log(2), math.log(3)), abs=1e-6)
    assert exponents({ARC: affine(0, -2, 2, 0), WALL: double}, SQUARE) is None
    for rows in ((0.5, 0.25, 0.5, 2.0), (0.25, -0.5, 0.75, -3.0)):  # by the larger multiplier, wherever `v` comes from
        low, high = exponents({ARC: affine(*rows), WALL: affine(*rows)}, SQUARE, bounces=1, length=8)
        assert low <= math.log(max(abs(np.linalg.eigvals(np.array(rows).reshape(2, 2))))) <= high < low + 0.06
    above = [(-1.0, 0.5), (1.0, 0.5), (1.0, 1.0), (-1.0, 1.0)]  # goes up, and never to the other piece
    assert exponents({ARC: double, WALL: treble}, above, bounces=1, length=3)[0] == pytest.approx(math.log(3), abs=1e-6)
