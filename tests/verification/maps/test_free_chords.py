"""Chords that are free: of a star by exact rational arithmetic, and of a circle with a hole."""

import math
import random
from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb

from symbolic.tables import cuspless, egg, sinai
from verification.arithmetic.balls import working
from verification.maps import first_hit
from verification.maps.first_hit import Boundary


def polygonal(corners):
    """A boundary of straight sides."""

    def side(p, q):
        (vx, vy) = (b - a for a, b in zip(p, q, strict=True))
        return lambda t: (p[0] + t * vx, p[1] + t * vy, arb(vx), arb(vy))

    return Boundary([side(*pair) for pair in pairwise([*corners, corners[0]])], [(arb(0), arb(1))] * len(corners))


def cross(p, q):
    return p[0] * q[1] - p[1] * q[0]


STAR = [(4, 0), (1, 1), (0, 5), (-1, 1), (-6, 2), (-2, -1), (-3, -5), (0, -2), (3, -4), (2, -1)]


def test_a_chord_between_sides_of_a_star_is_free_exactly_where_it_meets_no_other_side():
    """Of random chords, by exact rational arithmetic; no chord of these passes through a corner."""
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
    """A circle about 0 by angles from -pi to pi; backwards where it is a hole."""
    return lambda t: (radius * t.cos(), sign * radius * t.sin(), -radius * t.sin(), sign * radius * t.cos())


def test_a_chord_of_a_circle_is_free_where_it_passes_by_the_hole():
    """From anywhere to anywhere, also through the seam; and from the circle to the hole where it sees it."""
    chance = random.Random(6)
    with working(96):
        ends = (-arb.pi(), arb.pi())
        alone, holed = Boundary([ring(1)], [ends]), Boundary([ring(1), ring(0.25, -1)], [ends] * 2)
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


def test_each_component_has_its_two_ends():
    assert [len(first_hit._ends(table, (), 64)) for table in (cuspless, sinai(), egg(3).at(alpha="0.08"))] == [2, 5, 1]
    with working(64):
        for low, high in first_hit._ends(sinai(), (), 64)[:4]:
            assert (low, high) == (0, 1)
    assert first_hit._exact(Fraction(-3, 4)) == arb(-0.75)


def test_the_pieces_that_a_chord_is_asked_about_cover_every_component(monkeypatch):
    """Halved until they are short; next to a bounce is only what lies on its own component."""
    asked = []

    def passes(place, piece, near, p, d):
        asked.append((place, piece, near))
        return bool(piece.rad() < 0.5)

    monkeypatch.setattr(first_hit, "_passes", passes)
    places = [lambda t: (arb(0), t, arb(0), arb(-1)), lambda t: (arb(1), t, arb(0), arb(1))]
    boundary = Boundary(places, [(arb(2), arb(5)), (arb(-1), arb(0.5))])
    with working(96):
        assert first_hit.free(boundary, (0, arb(2.25)), (1, arb(0.25)))
    for place, (low, high), count in zip(places, ((2, 5), (-1, 0.5)), (7, 3), strict=True):
        own = [(piece, near) for other, piece, near in asked if other is place]
        short = sorted((piece for piece, _ in own if piece.rad() < 0.5), key=lambda piece: float(piece.mid()))
        assert len(own) == count
        assert short[0].contains(low)
        assert short[-1].contains(high)
        assert all(a.overlaps(b) for a, b in pairwise(short))
        assert sum(2 * float(piece.rad()) for piece in short) < (high - low) * 1.001
        assert all(len(near) == 1 for _, near in own)


def test_a_chord_that_leaves_outwards_or_arrives_from_outside_is_not_asked_about(monkeypatch):
    """Of walls at both ends of a chord, each turned the right and the wrong way, and along it."""
    monkeypatch.setattr(first_hit, "_passes", lambda *_: True)
    for first in (-1, 0, 1):
        for last in (-1, 0, 1):
            places = [
                lambda t, v=first: (arb(0), t, arb(1 - abs(v)), arb(v)),
                lambda t, v=last: (arb(1), t, arb(1 - abs(v)), arb(v)),
            ]
            boundary = Boundary(places, [(arb(-1), arb(1))] * 2)
            with working(96):
                assert first_hit.free(boundary, (0, arb(0)), (1, arb(0))) is (first < 0 < last)


def test_a_chord_is_given_up_where_too_many_pieces_or_too_short_ones_are_asked(monkeypatch):
    walls = [lambda t: (arb(0), t, arb(0), arb(-1)), lambda t: (arb(1), t, arb(0), arb(1))]
    boundary, chord = Boundary(walls, [(arb(0), arb(1))] * 2), ((0, arb(0.25)), (1, arb(0.25)))
    monkeypatch.setattr(first_hit, "_passes", lambda place, piece, *_: bool(piece.rad() < 2.0**-4 * 1.0001))
    with working(96):
        for most, free in ((30, True), (29, False)):  # 1 + 2 + 4 + 8 on either wall
            monkeypatch.setattr(first_hit, "PIECES_OF_CHORD", most)
            assert first_hit.free(boundary, *chord) is free
        for shortest, free in ((2.0**-5, True), (2.0**-4, True), (2.0**-4 * 1.5, False)):
            monkeypatch.setattr(first_hit, "PIECES_OF_CHORD", 4000)
            monkeypatch.setattr(first_hit, "SMALLEST", shortest)
            assert first_hit.free(boundary, *chord) is free


@pytest.mark.parametrize("size", [1, 8])
def test_a_bounce_is_led_to_a_piece_through_the_seam_where_that_is_no_longer(size):
    """On a closed component, in eighths of its length; on one with two ends there is no seam."""
    boundary = Boundary([lambda t: (t - t, t - t), lambda t: (t, t)], [(arb(0), arb(size))] * 2)
    assert boundary.closed == (True, False)
    piece_of = lambda k: arb(k, 0.25) * size / 8  # noqa: E731
    ends = lambda ball: tuple(float(x) * 8 / size for x in (ball.lower(), ball.upper()))  # noqa: E731
    for at, piece, ways in (
        (1, 4, [(1, 4.25)]),
        (4, 1, [(0.75, 4)]),
        (3, 3, [(2.75, 3.25)]),
        (1, 5, [(4.75, 8), (0, 1)]),  # as long on either way
        (5, 1, [(0, 1.25), (5, 8)]),
        (1, 7, [(6.75, 8), (0, 1)]),
        (7, 1, [(0, 1.25), (7, 8)]),
    ):
        found = first_hit._between(boundary, 0, arb(at) * size / 8, piece_of(piece))
        assert [ends(way) for way in found] == [pytest.approx(way, abs=1e-6) for way in ways]
        (found,) = first_hit._between(boundary, 1, arb(at) * size / 8, piece_of(piece))
        assert ends(found) == pytest.approx((min(at, piece - 0.25), max(at, piece + 0.25)))


def passes(place, near=(), d=(2, 0), piece=(0, 0.5)):
    """Of a chord from (1, 1) in a direction."""
    return first_hit._passes(place, arb(*piece), near, (arb(1), arb(1)), tuple(map(arb, d)))


@pytest.mark.parametrize("d", [(2, 0), (0, -2), (1, 2)])
def test_a_piece_passes_a_chord_that_it_is_off_or_not_between_the_ends_of(d):
    """`along` it and `across`, in shares of the chord: where nothing is known of velocities these alone decide."""
    for along, across, off in (
        (0.5, 0, False), (0.125, 0, False), (0, 0, False), (1, 0, False),
        (-0.25, 0, True), (1.25, 0, True), (0.5, 0.25, True), (0.5, -0.25, True), (0, 2.0**-40, True),
        (arb(-1, 0.5), arb(0, 0.1), True), (arb(2, 0.5), arb(0, 0.1), True),
        (arb(-1, 2), 0, False), (0.5, arb(0, 0.1), False), (0.5, arb(0.5, 0.25), True),
    ):  # fmt: skip
        x, y = (1 + along * a + across * b for a, b in zip(d, (-d[1], d[0]), strict=True))
        at = arb(x), arb(y), arb("nan"), arb("nan")
        assert passes(lambda t, at=at: at, d=d) is off


def test_a_piece_next_to_a_bounce_crosses_the_chord_once_where_a_slope_keeps_its_sign():
    """On the line of the chord, with the velocity `(2, t)`: the slope along `(1, 1)` is `t - 2`."""
    on_line = lambda t: (arb(1.5), arb(1.5), arb(2), t)  # noqa: E731
    for ways, once in (
        ([[3]], True), ([[1]], True), ([[2]], False), ([[3, 4]], True), ([[1, -1]], True), ([[1, 3]], False),
        ([[3, 1]], False), ([[2, 3]], False), ([[1, 2]], False), ([[2.5, 1.5]], False), ([[1.5, 2.5]], False),
        ([[2.5, 2.25]], True), ([[1.5, 1.75]], True), ([[1, 3], [1]], True), ([[1], [1, 3]], True), ([], False),
    ):  # fmt: skip
        near = [[arb(t) for t in way] for way in ways]
        assert passes(on_line, near, (1, 1)) is once
    assert passes(on_line, [[arb(2, 0.5)]], (1, 1)) is False


@pytest.mark.parametrize(
    ("d", "v", "passed"),
    [
        ((2, 0), (0, 0), True),
        ((2, 0), (1, 0.25), True),
        ((2, 0), (1, 0.625), False),  # as far as 5/16 up to where the piece ends
        ((2, 0), (1, -0.625), False),
        ((1, 1), (2, 2), True),
        ((1, 1), (2, 2.25), True),
        ((1, 1), (-2, 2), False),
        ((1, 1), (2, 0.5), False),
    ],
)
def test_a_piece_of_which_only_the_middle_is_sharp_passes_where_its_velocity_leads_not_across(d, v, passed):
    """A quarter above the chord at its middle; in a ball the place is anywhere about the chord."""

    def place(t):
        wide = t - t if t.rad() > 0 else arb(0)
        return arb(1.5) + wide, arb(1.25 if d == (2, 0) else 1.75) + wide, arb(v[0]), arb(v[1])

    assert passes(place, d=d) is passed
