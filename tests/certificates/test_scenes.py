"""What a scene may say to the second reader: letters, ranges, marks; and which documents may speak of mirror images."""

import json
import random
from fractions import Fraction
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "certificates"
EGG = {"table": "egg"}
WAVES = {"polar": "1 + b*cos(3*theta)/40"}
MARK = {"name": "m", "component": 0, "theta": "1"}  # with a mark a radius need not be positive
SQUARE = [
    {"x": x, "y": y, "from": "0", "to": "1"}
    for x, y in (("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta"))
]


@pytest.mark.parametrize(
    ("scene", "free", "title"),
    [
        ({"table": "circle", "lam": "1/3"}, "", "circle, lam = 1/3"),
        ({"table": "circle"}, "lam", "circle"),
        ({"table": "ellipse", "shape": {"a": "3/2"}, "lam": "0"}, "", "ellipse, a = 3/2, lam = 0"),
        (EGG | {"lam": "1"}, "alpha", "egg, lam = 1"),
        (EGG | {"shape": {"alpha": "1/9"}}, "lam", "egg, alpha = 1/9"),
        (EGG | {"K": 5, "lam": "1"}, "alpha", "egg of 5 points, lam = 1"),
        (EGG | {"K": 2, "lam": "1"}, "alpha", "egg of 2 points, lam = 1"),
        (EGG | {"K": 1000, "lam": "1"}, "alpha", "egg of 1000 points, lam = 1"),
        (EGG | {"K": 3, "lam": "1"}, "alpha", "egg, lam = 1"),
        (
            {"table": "circle", "law": "-b*eta", "shape": {"b": "1/7"}, "lam": "0"},
            "",
            "circle, phi = -b*eta, b = 1/7, lam = 0",
        ),
        ({"table": "circle", "law": "-b*eta", "lam": "1"}, "b", "circle, phi = -b*eta, lam = 1"),
        (WAVES | {"shape": {"b": "1/2"}, "lam": "1/2"}, "", "polar 1 + b*cos(3*theta)/40, b = 1/2, lam = 1/2"),
        (WAVES | {"shape": {"b": "0..1/2"}, "lam": "1/2"}, "b", "polar 1 + b*cos(3*theta)/40, lam = 1/2"),
        (WAVES | {"shape": {"b": "-1000000..1000000"}, "lam": "1/2", "undefined": [MARK]}, "b",
         "polar 1 + b*cos(3*theta)/40, lam = 1/2"),
        ({"table": "ellipse", "shape": {"a": "1000000"}}, "lam", "ellipse, a = 1000000"),
        ({"table": "ellipse", "shape": {"a": "1"}}, "lam", "ellipse, a = 1"),
        (EGG | {"shape": {"alpha": "1/2"}}, "lam", "egg, alpha = 1/2"),
        (EGG | {"shape": {"alpha": "0"}}, "lam", "egg, alpha = 0"),
        ({"component": SQUARE}, "lam", "boundary of 4 pieces"),
        ({"parametric": ["cos(theta)", "sin(theta)"], "lam": "1"}, "", "parametric cos(theta); sin(theta), lam = 1"),
    ],
)  # fmt: skip
def test_a_scene_is_called_by_all_that_is_told_of_it_and_by_nothing_that_is_free(check, scene, free, title):
    table, lam, words = check.read_scene(scene, free, 80)

    assert words == title
    assert (lam is None) == (free == "lam")
    assert lam is None or lam.lo <= Fraction(scene["lam"]) * 2**80 <= lam.hi
    for name, text in scene.get("shape", {}).items():
        low, high = (Fraction(x) for x in (text.split("..") * 2)[:2])
        assert table.letters[name].lo <= low * 2**80 < high * 2**80 + 1
        assert high * 2**80 <= table.letters[name].hi
        assert table.letters[name].width() <= (high - low) * 2**80 + 2


@pytest.mark.parametrize(
    ("scene", "free", "why"),
    [
        ([], "", "the entries are one of"),
        (None, "", "the entries are one of"),
        ("table", "", "the entries are one of"),
        ({"table": "circle", "shape": "a", "lam": "1"}, "", "the entries are one of"),
        ({"lam": "1"}, "", "the entries are one of"),
        ({"table": "circle", "polar": "1", "lam": "1"}, "", "the entries are one of"),
        ({"table": "circle", "lam": "1", "more": 1}, "", "the entries are one of"),
        ({"table": "square", "lam": "1"}, "", "other letters"),
        ({"table": "circle", "shape": [], "lam": "1"}, "", "the entries are one of"),
        (EGG | {"K": 1, "lam": "1"}, "alpha", "other letters"),
        (EGG | {"K": 1001, "lam": "1"}, "alpha", "other letters"),
        (EGG | {"K": True, "lam": "1"}, "alpha", "other letters"),
        (EGG | {"K": 3.0, "lam": "1"}, "alpha", "other letters"),
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
        *((WAVES | {"shape": {"b": "1", name: "1"}, "lam": "1"}, "", "other letters")
          for name in ("theta", "eta", "lam", "pi", "E")),
        ({"table": "circle"}, "", "lam is told where it is not the free letter"),
        ({"table": "circle", "lam": "1"}, "lam", "lam is told where it is not the free letter"),
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
    """What is stated of `b` would be stated of a table that has none, or of every `b`."""
    with pytest.raises(check.Wrong, match=why):
        check.read_scene(scene, free, 80)


@pytest.mark.parametrize(
    ("scene", "free", "closed"),
    [
        ({"table": "circle", "lam": "1"}, "", [True]),
        ({"table": "cuspless", "lam": "1"}, "", [False, False]),
        ({"table": "circle", "law": "-lam*eta*cos(theta)", "lam": "1"}, "", [True]),
        ({"table": "circle", "law": "-lam*eta*(1 + theta/99)", "lam": "1"}, "", [False]),
        ({"polar": "2 + cos(theta)", "lam": "1"}, "", [True]),
        ({"parametric": ["cos(theta)", "sin(theta)*(1 + sin(theta/2)**2/9)"], "lam": "1"}, "", [False]),
        ({"component": SQUARE, "lam": "1"}, "", [False] * 4),
    ],
)
def test_a_bounce_may_run_on_over_the_end_of_a_parameter_where_curve_and_law_have_its_period(
    check, scene, free, closed
):
    assert check.read_scene(scene, free, 80)[0].closed == closed


@pytest.mark.parametrize("points", [2, 3, 7])
def test_an_egg_has_as_many_points_as_are_told(check, points):
    """Where `cos(K*theta)` is 1, and where it is -1."""
    table, *_ = check.read_scene(EGG | {"K": points, "shape": {"alpha": "1/9"}, "lam": "1"}, "", 80)
    for k in range(2 * points):
        x, y, *_ = table.at(0, check.pi(80) * Fraction(k, points), table.letters, 80)
        assert abs(x.real() ** 2 + y.real() ** 2 - (1 + (-1) ** k / 9) ** 2) < 1e-12


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
    """Without it the second half is none: what is closed by the mirror is no cycle, by 40 digits."""
    given = json.loads((FOLDER / "own-mirror.json").read_text())
    scene = {"table": "egg", "shape": {"alpha": "1/25"}} | entries
    given |= {"scene": {key: x for key, x in scene.items() if x and (key != "shape" or scene["table"])}}

    with pytest.raises((check.Wrong, check.Unproved)) as why:
        check.checked(given)
    assert ("do not fit" in str(why.value)) is not fits


def test_a_chord_is_free_where_no_wall_is_between_its_ends_in_whatever_direction_it_runs(check):
    """Between random places on two sides of a square, with a two-sided wall somewhere, by the signs of four areas."""
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
        table, *_ = check.read_scene({"component": [*SQUARE, *wall], "lam": "1"}, "", 80)
        table.turns.clear()  # a wall with two sides is a curve that meets itself, and bounds no table
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


@pytest.mark.parametrize(
    ("low", "high", "holds"),
    [(0, 4, True), (1, 3, True), (1, 2, True), (2, 3, True), (0, 1, True), (-1, 2, False), (3, 5, False)],
)
def test_an_orbit_over_a_box_holds_that_from_its_middle_or_is_none(check, low, high, holds):
    """A flight over the box lands in [0, 4], the one from the middle in `[low, high]`."""
    p, table = 60, check.Table([["1", "-pi", "pi"]], {}, "", 60)
    jet = lambda a, b: check.Jet.of(check.I.of(a, p).hull(check.I.of(b, p)), 1, 0)  # noqa: E731
    table.flight = lambda part, place, state, names: [jet(0, 4), jet(0, 4)]
    launch = lambda *letters: (letters[0], letters[1], {})  # noqa: E731
    boxes = [check.I.of(-1, p).hull(check.I.of(1, p))] * 3
    middle = [None, [jet(low, high), jet(1, 2)]]
    run = lambda given: table.orbit(launch, boxes, [(0, None)] * 2, 1, given)  # noqa: E731

    if holds:
        for given in (middle, [None, middle[1][::-1]]):
            x, y = (check.value(f) for f in run(given)[1])
            assert {(x.lo, x.hi), (y.lo, y.hi)} == {(low << p, high << p), (1 << p, 2 << p)}
    else:
        for given in (middle, [None, middle[1][::-1]]):
            with pytest.raises(check.Unproved, match="no middle orbit"):
                run(given)
