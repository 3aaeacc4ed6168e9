"""A branch of a saddle's manifold and the cells that it meets, by the second reader, step by step."""

from fractions import Fraction
from itertools import pairwise
from math import pi
from types import SimpleNamespace

import pytest
from by_hand import number

EGG = {"table": "egg", "shape": {"alpha": "2/25"}}
TURN, P = Fraction(1, 3), 100


def branch(check, crisis, along="0", across="1", reach="1/16", slope="1/64"):
    made = crisis.Branch.__new__(crisis.Branch)
    made.table, made.turn, made.lam = SimpleNamespace(p=P, letters={"b": 7}), TURN, number(check, "3/5")
    made.along, made.across = number(check, along), number(check, across)
    made.theta, made.psi = number(check, "1/2"), number(check, "-1/4")
    made.reach, made.slope = Fraction(reach), Fraction(slope)
    return made


@pytest.mark.parametrize(("along", "across"), [("0", "1"), ("2", "-1"), ("-1/2", "3/4"), ("1", "3"), ("-2", "-1")])
@pytest.mark.parametrize(
    ("entries", "fails"),
    [
        ((3, 0, 0, "1/2"), None), ((3, 2, "1/64", "1/4"), None), ((3, -2, "-1/64", "-1/4"), None), ((2, 0, 0, "3/4"),
        None),
        ((2, 0, 0, 1), "closer"), ((2, 0, 0, "-1"), "closer"), ((2, 32, 0, "1/2"), "cone"), ((2, 63, 0, "1/2"), "cone"),
        ((1, 0, 0, "1/2"), "cone"), ((-3, 0, 0, "1/2"), "cone"), ((3, 0, "3/64", "1/2"), "cone"),
        ((3, 0, "1/32", "1/2"), None),
        ((3, 0, "-3/64", "1/2"), "cone"), ((3, 0, 0, 4), "cone"), ((3, 0, 0, "-4"), "cone"), ((3, 100, 0, "1/2"),
        "cone"),
        (("3/2", 40, 0, "1/8"), "cone"), ((5, 32, "5/64", 0), "cone"), ((3, 0, "3/64", 0), "cone"),
        ((5, 33, 0, "1/2"), None), ((8, 33, 0, "2/5"), None), ((8, 33, 0, "1/2"), "closer"),
    ],
)  # fmt: skip
def test_cones_are_kept_in_whatever_directions_the_coordinates_run(
    check, crisis, monkeypatch, along, across, entries, fails
):
    """Of `(x, y) -> (e*x + f*y, g*x + h*y)` in the coordinates of the branch, worked out in those of the table.

    With a slope of 1/64: `e - f/64 > 1`, `g + h/64 < (e - f/64)/64`, `h + f/64 < 1`, in sizes."""
    e, f, g, h = map(Fraction, entries)
    k, m = Fraction(along), Fraction(across)
    s = Fraction(1, 64)
    kept = e - abs(f) * s > 1 and abs(g) + abs(h) * s < (e - abs(f) * s) * s
    fails = None if kept and abs(h) + abs(f) * s < 1 else "cone" if not kept else "closer"
    # columns: the images of (1, k) and (1, m), from which those of (1, 0) and (0, 1)
    images = [(e + g, e * k + g * m), (f + h, f * k + h * m)]
    second = [(q - p) / (m - k) for p, q in zip(*images, strict=True)]
    first = [p - q * k for p, q in zip(images[0], second, strict=True)]
    asked = []

    def derivative(table, turn, state, lam):
        asked.append(state)
        return (
            (number(check, first[0]), number(check, second[0])),
            (number(check, first[1]), number(check, second[1])),
            None,
        )

    monkeypatch.setattr(crisis, "derivative", derivative)
    made = branch(check, crisis, along, across)
    if fails:
        with pytest.raises(check.Unproved, match=fails):
            made.proved()
        return
    most = made.proved()
    assert e + abs(f) * s <= most <= e + abs(f) * s + Fraction(1, 2**60)
    ((theta, psi),) = asked
    radius = Fraction(1, 16) * (1 + s), Fraction(1, 16) * (abs(k) + abs(m) * s)
    for x, at, r in zip((theta, psi), (Fraction(1, 2), -Fraction(1, 4)), radius, strict=True):
        assert abs(Fraction(x.lo, 2**P) - at + r) < Fraction(1, 2**60)
        assert abs(Fraction(x.hi, 2**P) - at - r) < Fraction(1, 2**60)


def test_what_is_followed_begins_in_the_cone_over_its_interval_and_not_beyond_the_reach(check, crisis):
    made, asked = branch(check, crisis, "2", "-1"), []

    def orbit(launch, boxes, way, degree):
        asked.append((launch(*boxes), boxes, way, degree))
        return [None, *([check.Jet.of(number(check, x), 0) for x in (k, k + 1)] for k in (3, 8))]

    made.table.orbit = orbit
    x = number(check, "-1/16").hull(number(check, "-1/32"))
    assert [z.real() for z in made.followed(x, ["a way"])] == [8, 9]
    (((theta, psi, names), (first, second, lam), way, degree),) = asked
    assert (first, way, degree, names) == (x, ["a way"], 1, {"b": 7, "lam": made.lam})
    assert (second.lo, second.hi) == (-(2**P) // 1024, 2**P // 1024)
    assert lam is made.lam
    assert theta.real() == pytest.approx(0.5 - 3 / 64)
    assert psi.real() == pytest.approx(-0.25 - 3 / 32)
    for far in (
        number(check, "1/16") + number(check, Fraction(1, 2**P)),
        number(check, -1),
        x.hull(number(check, "1/8")),
    ):
        with pytest.raises(check.Unproved, match="a start beyond it"):
            made.followed(far, [])


@pytest.mark.parametrize("side", [1, -1])
def test_pieces_of_a_branch_run_from_a_point_to_beyond_its_image_without_a_gap(check, crisis, monkeypatch, side):
    made, asked = branch(check, crisis, reach=Fraction(1, 2**24)), []
    made.most = Fraction(5, 2)
    made.sampled = lambda x, rounds, map: (("a way", asked.append((x, rounds, map)))[0], None)
    made.followed = lambda x, way: (x, way)
    monkeypatch.setattr(crisis, "PIECES", 7)
    found = list(made.pieces(side, "the map"))
    assert len(found) == 7
    assert {way for _, way in found} == {"a way"}
    assert {(rounds, map) for _, rounds, map in asked} == {(17, "the map")}  # 5/2 to the 16 is 0.1*2**24, and more
    pieces = sorted((Fraction(x.lo, 2**P), Fraction(x.hi, 2**P)) for x, _ in found)
    assert all(b >= c for (_, b), (c, _) in pairwise(pieces))
    low, high = (Fraction(2, 5 * 2**24), Fraction(1, 2**24))[::side]
    assert (pieces[0][0] - side * low) <= 0 <= pieces[-1][1] - side * high
    assert pieces[-1][1] - pieces[0][0] < high * side - low * side + Fraction(1, 2**90)


def leaving(check, crisis, monkeypatch, near, far, side=1, fails=(), more=True):
    """Orbits of which the rough one enters at the samples `near`, the fine one at those of `far`; what was asked."""
    asked, samples = [], []
    for key, x in (("SAMPLES", 4), ("TINY", 44), ("SMALL", 24), ("LONG", 5), ("MORE", 200)):
        monkeypatch.setattr(crisis, key, x)
    rough, fine = branch(check, crisis, reach=Fraction(1, 2**24)), branch(check, crisis, reach=Fraction(1, 2**44))
    rough.most, fine.grows = Fraction(2), check.I.of(4, 200)

    def sampled(x, rounds, map, until):
        samples.append(x)
        if len(samples) - 1 in fails:
            raise check.Unproved
        return None, "in" if len(samples) - 1 in near else "out"

    rough.sampled = sampled
    fine.sampled = lambda x, rounds, map, until: (asked.append((x, rounds)) or ["way", x], None)
    fine.followed = lambda x, way: "in" if way == ["way", x] and len(samples) - 1 in far else "out"
    cells = {"in": {(1, 2), (3, 4)}, "out": {(1, 2), (5, 6)}}
    map = SimpleNamespace(met=lambda *box: cells["".join(box)])
    monkeypatch.setattr(crisis, "I", SimpleNamespace(of=lambda z, p: z if isinstance(z, str) else check.I.of(z, p)))
    return fine.leaves(side, map, cells["in"] | {(7, 8)} if more else cells["in"], rough), samples, asked


@pytest.mark.parametrize(
    ("near", "far", "fails", "wanted"),
    [
        ((0,), (0,), (), (True, 1)), ((2,), (2,), (), (True, 3)), ((0, 3), (3,), (), (True, 4)), ((), (0, 1, 2, 3),
        (), (False, 4)),
        ((0, 1, 2, 3), (), (), (False, 4)), ((1,), (2,), (), (False, 4)), ((0, 1), (0, 1), (0,), (True, 2)), ((0,),
        (0,), (0,), (False, 4)),
    ],
)  # fmt: skip
@pytest.mark.parametrize("side", [1, -1])
def test_a_branch_leaves_where_an_orbit_that_was_looked_for_is_enclosed_in_the_set(
    check, crisis, monkeypatch, near, far, fails, wanted, side
):
    found, samples, asked = leaving(check, crisis, monkeypatch, near, far, side, fails)
    assert (found, len(samples)) == wanted
    for k, x in enumerate(samples):
        assert x.real() * 2**24 == pytest.approx(side / 2 ** (k * 0.381966 % 1))
    wanted = [x.real() for k, x in enumerate(samples) if k in near and k not in fails]
    assert [x.real() * 2**20 for x, _ in asked] == [pytest.approx(x) for x in wanted]  # as many bits nearer
    assert {rounds for _, rounds in asked} <= {5 + 21 + 10}  # 2 to the 21 is 0.1*2**24, and more; 4 to the 10 is 2**20


def test_a_branch_leaves_also_where_its_orbit_meets_all_of_the_set(check, crisis, monkeypatch):
    assert leaving(check, crisis, monkeypatch, (1,), (1,), more=False)[0]


@pytest.mark.parametrize("letters", [("1/8", "1/16"), ("-1/8", "0"), ("0", "1/16")])
def test_a_state_of_a_branch_is_the_saddle_and_two_directions(check, crisis, letters):
    x, y = map(Fraction, letters)
    found = branch(check, crisis, "2", "-3").state(number(check, x), number(check, y))
    assert [z.real() for z in found] == [0.5 + x + y, -0.25 + 2 * x - 3 * y]


def grown(check, crisis, monkeypatch, grid=(20, 16), parts=3):
    monkeypatch.setattr(crisis, "GRID", grid)
    monkeypatch.setattr(check.beside("region"), "POINTS", 8)  # only for guesses
    table = check.read_scene(EGG, "lam", 64)[0]
    return crisis.Grown(table, number(check, "3/5", 64), number(check, "663/1000", 64), parts)


def test_cells_are_those_of_one_part_of_the_table_and_the_others_are_turned_into_it(check, crisis, monkeypatch):
    map = grown(check, crisis, monkeypatch)
    assert (map.columns, map.rows, map.cells) == (60, 16, set())
    assert map.top.real() == pytest.approx(pi / 2 * 0.663)
    for column in (1, 21, 41, -19, -59):
        theta = number(check, -pi + 2 * pi * (column + 0.4) / 60, 64).hull(
            number(check, -pi + 2 * pi * (column + 0.6) / 60, 64)
        )
        assert map.met(theta, map.top * Fraction(1, 32)) == {(1, 8)}


def test_a_set_grows_by_the_images_of_whole_cells_each_asked_once(check, crisis, monkeypatch):
    """Of a map of columns that doubles their number, which has two cycles of three among seven."""
    map, asked = grown(check, crisis, monkeypatch), []
    monkeypatch.setattr(map, "images", lambda *square: asked.append(square) or {(square[0] * 2 % 7, square[1])})
    cells = [(1, 5), (2, 5), (3, 8), (4, 5), (5, 8), (6, 8)]
    assert sorted(map.grow([(1, 5), (3, 8)])) == cells
    assert sorted(asked) == [(*cell, 1, crisis.HALVINGS) for cell in cells]
    for most, fits in ((6, True), (5, False)):
        monkeypatch.setattr(crisis, "MOST", most)
        if fits:
            map.grow([(1, 5), (3, 8)])
        else:
            with pytest.raises(check.Unproved, match="the cells have no end"):
                map.grow([(1, 5), (3, 8)])


@pytest.mark.parametrize("depth", [0, 1, 2, 3])
def test_what_is_not_enclosed_is_halved_both_ways_as_often_as_is_told(check, crisis, monkeypatch, depth):
    map, asked = grown(check, crisis, monkeypatch), []

    def image(column, row, size):
        asked.append((column, row, size))
        if size > Fraction(1, 4):
            raise check.Unproved("so far nothing")
        return column, row

    monkeypatch.setattr(map, "image", image)
    monkeypatch.setattr(map, "met", lambda *at: {at})
    if depth < 2:
        with pytest.raises(check.Unproved, match="so far nothing"):
            map.images(Fraction(3), Fraction(5), Fraction(1), depth)
        assert [size for *_, size in asked] == [1, Fraction(1, 2)][: depth + 1]
        return
    found = map.images(Fraction(3), Fraction(5), Fraction(1), depth)
    assert found == {(3 + Fraction(i, 4), 5 + Fraction(k, 4)) for i in range(4) for k in range(4)}
    assert len(asked) == 21
