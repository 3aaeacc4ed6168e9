"""Free chords, that meet the boundary at their ends only: in a star by exact rational arithmetic, and round a hole."""

import math
import random
from fractions import Fraction
from itertools import pairwise

from flint import arb

from verification.arithmetic.balls import working
from verification.maps import first_hit
from verification.maps.first_hit import BallBoundary


def polygonal(corners):
    """A boundary of straight sides between corners."""

    def side(p, q):
        (vx, vy) = (b - a for a, b in zip(p, q, strict=True))
        return lambda t: (p[0] + t * vx, p[1] + t * vy, arb(vx), arb(vy))

    return BallBoundary([side(*pair) for pair in pairwise([*corners, corners[0]])], [(arb(0), arb(1))] * len(corners))


def cross(p, q):
    return p[0] * q[1] - p[1] * q[0]


STAR = [(4, 0), (1, 1), (0, 5), (-1, 1), (-6, 2), (-2, -1), (-3, -5), (0, -2), (3, -4), (2, -1)]


def test_a_chord_between_sides_of_a_star_is_free_exactly_where_it_meets_no_other_side():
    """Random chords, none of them through a corner, against exact rational arithmetic."""
    chance, boundary, seen = random.Random(4), polygonal(STAR), [0, 0]
    sides = list(pairwise([*STAR, STAR[0]]))
    for _ in range(120):
        i, j = chance.sample(range(len(STAR)), 2)
        at = [Fraction(chance.randint(40, 984), 1024) for _ in range(2)]
        (p, q) = (
            tuple(a + t * (b - a) for a, b in zip(*sides[k], strict=True)) for k, t in zip((i, j), at, strict=True)
        )
        d = q[0] - p[0], q[1] - p[1]
        way = [tuple(b - a for a, b in zip(*sides[k], strict=True)) for k in (i, j)]
        free = cross(way[0], d) > 0 and cross(d, way[1]) > 0
        for k, (a, b) in enumerate(sides):
            if k not in (i, j):
                left = [cross(d, (c[0] - p[0], c[1] - p[1])) for c in (a, b)]
                across = [cross((b[0] - a[0], b[1] - a[1]), (e[0] - a[0], e[1] - a[1])) for e in (p, q)]
                free = free and not (left[0] * left[1] <= 0 and across[0] * across[1] <= 0)
        with working(96):
            assert first_hit.free(boundary, (i, arb(float(at[0]))), (j, arb(float(at[1])))) is bool(free)
        seen[free] += 1
    assert min(seen) > 20


def ring(radius, sign=1):
    """A circle about 0 by angles from -pi to pi, run through backwards for a hole."""
    return lambda t: (radius * t.cos(), sign * radius * t.sin(), -radius * t.sin(), sign * radius * t.cos())


def test_a_chord_of_a_circle_is_free_where_it_passes_by_the_hole():
    """Between random points of the circle, also across the seam, and from the circle to a visible point of the hole."""
    chance = random.Random(6)
    with working(96):
        ends = (-arb.pi(), arb.pi())
        alone, holed = BallBoundary([ring(1)], [ends]), BallBoundary([ring(1), ring(0.25, -1)], [ends] * 2)
        for k in range(40):
            start = chance.uniform(-3.1, 3.1)
            end = math.remainder(start + chance.uniform(0.1, 6.18), 2 * math.pi)
            if k % 4 == 0:  # on either side of the seam
                start, end = 3.1, -3.1
            chord = (0, arb(start)), (0, arb(end))
            assert first_hit.free(alone, *chord)
            assert first_hit.free(holed, *chord) is (abs(math.cos((start - end) / 2)) > 0.25)
            there = math.remainder(start + chance.uniform(-1, 1), 2 * math.pi)  # the hole is seen up to 1.318
            assert first_hit.free(holed, (0, arb(start)), (1, arb(-there)))
            assert first_hit.free(holed, (1, arb(-there)), (0, arb(start)))
            hidden = math.remainder(start + chance.choice((-1, 1)) * chance.uniform(1.4, 3.1), 2 * math.pi)
            assert not first_hit.free(holed, (0, arb(start)), (1, arb(-hidden)))
            assert not first_hit.free(holed, (1, arb(-hidden)), (0, arb(start)))
