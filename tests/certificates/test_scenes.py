"""Scenes in certificates for the independent checker: letters, ranges, marks, and mirror images."""

import random
from fractions import Fraction

import pytest
from committed import document

EGG = {"table": "egg"}
WAVES = {"polar": "1 + b*cos(3*theta)/40"}
MARK = {"name": "m", "component": 0, "theta": "1"}  # with a mark a radius need not be positive
SQUARE = [
    {"x": x, "y": y, "from": "0", "to": "1"}
    for x, y in (("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta"))
]


@pytest.mark.parametrize(
    ("scene", "free", "why"),
    [
        ({"lam": "1"}, "", "the entries are one of"),
        ({"table": "circle", "polar": "1", "lam": "1"}, "", "the entries are one of"),
        ({"table": "circle", "lam": "1", "more": 1}, "", "the entries are one of"),
        ({"table": "circle", "K": 3, "lam": "1"}, "", "other letters"),
        (WAVES | {"K": 3, "shape": {"b": "1"}, "lam": "1"}, "", "the entries are one of"),
        (EGG | {"lam": "1"}, "", "other letters"),  # a shape that nobody tells
        (EGG, "lam", "other letters"),
        (EGG | {"shape": {"alpha": "1/9"}, "lam": "1"}, "alpha", "other letters"),  # and one that is told and free
        (EGG | {"shape": {"alpha": "1/9..1/8"}, "lam": "1"}, "alpha", "other letters"),
        (EGG | {"shape": {"a": "1/9"}, "lam": "1"}, "alpha", "other letters"),
        ({"table": "circle", "shape": {"b": "1"}, "lam": "1"}, "", "other letters"),  # that nothing has
        ({"table": "circle", "lam": "1"}, "b", "other letters"),
        ({"table": "circle", "law": "-lam*eta", "shape": {"b": "1"}, "lam": "1"}, "", "other letters"),
        ({"table": "circle", "law": "-b*eta", "shape": {"b": "0..1"}, "lam": "1"}, "b", "other letters"),
        (WAVES | {"lam": "1"}, "b", "other letters"),  # free without a range
        (WAVES | {"shape": {"b": "0..1"}, "lam": "1"}, "", "other letters"),  # a range, and not free
        (WAVES | {"shape": {"b": "0..1"}}, "lam", "other letters"),
        (WAVES | {"shape": {"b": "0..1", "c": "0..1"}, "lam": "1"}, "b", "other letters"),
        ({"table": "circle"}, "", "lam must have a number unless it is the free letter"),
        ({"table": "circle", "lam": "1"}, "lam", "lam must have a number unless it is the free letter"),
        ({"table": "circle", "lam": "-1/9"}, "", "lam is out of range"),
        ({"table": "circle", "lam": "10/9"}, "", "lam is out of range"),
        ({"table": "ellipse", "shape": {"a": "9/10"}, "lam": "1"}, "", "a is out of range"),
        ({"table": "ellipse", "shape": {"a": "1000001"}, "lam": "1"}, "", "a is out of range"),
        (EGG | {"shape": {"alpha": "-1/9"}, "lam": "1"}, "", "alpha is out of range"),
        (EGG | {"shape": {"alpha": "5/9"}, "lam": "1"}, "", "alpha is out of range"),
        (WAVES | {"shape": {"b": "1000001"}, "lam": "1"}, "", "b is out of range"),
        (WAVES | {"shape": {"b": "-1000001"}, "lam": "1"}, "", "b is out of range"),
        ({"component": SQUARE[:3], "lam": "1"}, "", "the boundary is not closed"),
        ({"polar": "cos(theta)", "lam": "1"}, "", "the radius may not be positive"),
        *(({"table": "circle", "lam": "1"} | more, "", "the entries are one of")
          for more in ({"undefined": [MARK]}, {"origin": {"component": 0, "theta": "1"}})),
        (WAVES | {"shape": {"b": "1"}, "lam": "1", "undefined": [MARK | {"component": 1}]}, "", "an undefined point"),
    ],
)  # fmt: skip
def test_a_scene_with_a_letter_too_many_too_few_or_out_of_its_range_is_refused(check, scene, free, why):
    """Otherwise a statement about `b` would concern a table without `b`, or every `b`."""
    with pytest.raises(check.Wrong, match=why):
        check.read_scene(scene, free, 80)


@pytest.mark.parametrize(
    ("entries", "fits"),
    [
        ({}, True),
        ({"law": "-lam*eta**3"}, True),
        ({"law": "-lam*eta + eta**2/10**40"}, False),
        ({"law": "-lam*eta + theta**2/10**40"}, False),
        ({"table": None, "polar": "1 + cos(3*theta)/25"}, True),
        ({"table": None, "polar": "1 + cos(3*theta)/25 + sin(theta)/10**40"}, False),
    ],
)
def test_half_of_a_cycle_is_spoken_of_only_where_table_and_law_have_the_mirror_symmetry(check, entries, fits):
    """Without it the mirror image of half an orbit does not continue it, by 40 digits."""
    given = document("own-mirror")
    scene = {"table": "egg", "shape": {"alpha": "1/25"}} | entries
    given |= {"scene": {key: x for key, x in scene.items() if x and (key != "shape" or scene["table"])}}

    with pytest.raises((check.Wrong, check.Unproved)) as why:
        check.checked(given)
    assert ("do not fit" in str(why.value)) is not fits


def test_a_chord_is_free_where_no_wall_is_between_its_ends_in_whatever_direction_it_runs(check):
    """Between random places on two sides of a square, with a two-sided wall, by the signs of four areas."""
    dice, met = random.Random(3), {True: 0, False: 0}
    area = lambda a, b, c: (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])  # noqa: E731
    place = lambda part, s: ((s, 0), (1, s), (1 - s, 1), (0, 1 - s))[part]  # noqa: E731
    for _ in range(60):
        (a, b), (c, d) = ((Fraction(dice.randrange(5, 60), 64) for _ in range(2)) for _ in range(2))
        if (a, b) == (c, d):
            continue
        ends = [
            (f"{a} + ({c - a})*theta", f"{b} + ({d - b})*theta"),
            (f"{c} + ({a - c})*theta", f"{d} + ({b - d})*theta"),
        ]
        wall = [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in ends]
        parts = [[piece[key] for key in ("x", "y", "from", "to")] for piece in [*SQUARE, *wall]]
        table = check.Table(parts, {}, None, 80)  # a wall with two sides is a curve that meets itself
        table.closed = [False] * len(parts)
        (i, s), (j, t) = ((part, Fraction(dice.randrange(3, 61), 64)) for part in dice.sample(range(4), 2))
        p, q = place(i, s), place(j, t)
        crossed = (
            area(p, q, (a, b)) * area(p, q, (c, d)) <= 0 and area((a, b), (c, d), p) * area((a, b), (c, d), q) <= 0
        )
        if met[crossed] == (2 if crossed else 9):  # to halve a wall that is in the way takes longest
            continue
        met[crossed] += 1
        try:
            table.free([(i, check.I.of(s, 80))], [(j, check.I.of(t, 80))], table.letters)
            assert not crossed
        except check.Unproved:
            assert crossed
    assert met == {True: 2, False: 9}
