"""The second reader's cycles, step by step: interval Newton, what is admissible, and what is asked of a document."""

import json
from fractions import Fraction
from functools import partial
from math import pi
from pathlib import Path
from types import SimpleNamespace

import by_hand
import pytest

FOLDER = Path(__file__).parents[3] / "certificates"
P = 90
number = partial(by_hand.number, p=P)


@pytest.mark.parametrize(("free", "box"), [("", None), ("lam", "1/2"), ("alpha", "1/3")])
def test_a_cycle_has_its_way_its_letters_and_a_box_for_each_unknown(check, free, box):
    table = check.Table([["1", "-pi", "pi"]] * 3, {"b": number(check, 7)}, None, P)
    boxes, lam = [number(check, k) for k in (1, 2, 3)], number(check, "1/9")
    for sign in (1, -1):
        made = check.Cycle(table, "fold", [2, 0, 1], boxes, sign, free, box and number(check, box), lam)
        assert [(part, x.real()) for part, x in made.way] == [(2, 1), (0, 2), (1, 3), (2, sign)]
        assert (made.kind, made.parts, made.sign, made.p, made.lam) == ("fold", [2, 0, 1], sign, P, lam)
        if box:
            assert made.box.real() == float(Fraction(box))
        else:
            assert (made.box.mid().lo, made.box.width()) == (lam.mid().lo, (lam + 0).width() + 2 ** (P - 39))
        names = made.names("the letter")
        assert names == {"b": table.letters["b"], "lam": lam} | {free or "lam": "the letter"}
        told = []
        table.orbit = lambda launch, at, way, d, told=told: told.append((launch(1, 2, "a letter"), at, way, d))
        made.run("unknowns", 5)
        assert told == [
            ((1, 2, {"b": table.letters["b"], "lam": lam} | {free or "lam": "a letter"}), "unknowns", made.way, 5)
        ]


def test_what_is_solved_begins_at_the_angle_of_the_first_chord_twice_as_wide(check, monkeypatch):
    """The bounces of the image are those of the boxes in their order, and each inside of its own."""
    table, asked = check.Table([["1", "-pi", "pi"]] * 3, {}, None, P), []
    boxes, radius = [number(check, k).wide(number(check, "1/8")) for k in (1, 2, 3)], number(check, "1/16")
    made = check.Cycle(table, "fold", [2, 0, 1], boxes, 1, "lam", number(check, "1/2").wide(radius), None)
    angle = number(check, "1/4").wide(radius)
    table.angle = lambda here, there, names: asked.append((here, there, names["lam"])) or angle
    monkeypatch.setattr(check, "newton", lambda equations, box, p: asked.append((equations, box, p)) or "image")
    for off, fails in ((0, False), (Fraction(1, 9), True), (-Fraction(1, 9), True)):
        bounces = [number(check, k).wide(radius) for k in (1, 2, 3 + off, 99)]
        made.run = lambda image, d, bounces=bounces: asked.append((image, d)) or [(x, 0) for x in bounces]
        asked.clear()
        if fails:
            with pytest.raises(check.Unproved, match="may lie outside the box"):
                made.solved()
            continue
        assert made.solved() == ("image", bounces[:3])
        assert asked[0] == ((2, boxes[0]), (0, boxes[1]), made.box)
        equations, (first, second, third), p = asked[1]
        assert (equations, first, third, p) == (made.equations, boxes[0], made.box, P)
        assert ((second.lo + second.hi) / 2**P, second.width() / 2**P) == (0.5, 0.25)
        assert asked[2] == ("image", 1)


def admissible(check, parts, bounces, sign=1, closed=(False,) * 3, marks=(), start=-1, refuses=None):
    """The chords that are asked, in their order, of a table whose parts run from -4 to 4, or once round."""
    asked = []
    once = [check.pi(P) * Fraction(start), check.pi(P) * (Fraction(start) + 2)]
    ends = lambda part, p: once if closed[part] else [number(check, -4), number(check, 4)]  # noqa: E731
    table = SimpleNamespace(closed=closed, ends=ends, marks=[(part, number(check, x)) for part, x in marks])
    table.free = lambda start, end, names: asked.append((*start, *end, names))
    cycle = check.Cycle.__new__(check.Cycle)
    cycle.table, cycle.p, cycle.parts, cycle.sign, cycle.names = (
        table,
        P,
        list(parts),
        sign,
        lambda letter: f"by {letter}",
    )
    near = number(check, Fraction(1, 2**40))
    run = lambda: cycle.admissible([number(check, x).wide(near) for x in bounces], "the letter")  # noqa: E731
    if refuses:
        with pytest.raises(check.Unproved, match=refuses):
            run()
        return None
    run()
    assert {names for *_, names in asked} == {"by the letter"}
    return [((a, round(x.real(), 9)), (b, round(y.real(), 9))) for (a, x), (b, y), _ in asked]


ROUND = (True, False, False)


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (([0, 1], [1, 2]), [((0, 1), (1, 2)), ((1, 2), (0, 1))]),
        (([0, 1, 2], [1, 2, 3]), [((0, 1), (1, 2)), ((1, 2), (2, 3)), ((2, 3), (0, 1))]),
        (([1, 2], [1, 2], -1), [((1, 1), (2, 2)), ((2, 2), (1, -1)), ((1, -1), (2, -2)), ((2, -2), (1, 1))]),
        (([1, 1], [1, 2]), [((1, 1), (1, 2)), ((1, 2), (1, 1))]),
        (([1, 1, 1, 1], [1, 2, 1, 3]), [((1, 1), (1, 2)), ((1, 2), (1, 1)), ((1, 1), (1, 3)), ((1, 3), (1, 1))]),
        (([1, 1, 2, 1], [1, 2, 1, 2]), [((1, 1), (1, 2)), ((1, 2), (2, 1)), ((2, 1), (1, 2)), ((1, 2), (1, 1))]),
    ],
)
def test_every_chord_of_a_cycle_is_asked_once_and_so_are_those_of_its_mirror_image(check, given, wanted):
    assert admissible(check, *given) == wanted


@pytest.mark.parametrize("turns", [-3, -1, 0, 1, 2])
@pytest.mark.parametrize(("start", "at"), [(-1, 1), (-1, -3), ("1/2", 2), ("1/2", 7), ("-7/2", -10)])
def test_a_bounce_on_a_closed_part_is_told_between_its_ends(check, turns, start, at):
    """Which are `start` times pi and a turn more."""
    found = admissible(check, [0, 1], [at + Fraction(turns * 2 * pi), 3], 1, ROUND, start=start)
    assert found == [((0, at), (1, 3)), ((1, 3), (0, at))]


@pytest.mark.parametrize("digits", [1, 20, 40])
@pytest.mark.parametrize("over", [0, 1])
def test_the_digits_that_are_stated_hold_a_width_of_one_of_the_last_of_them_and_no_more(
    check, monkeypatch, digits, over
):
    """Of an orbit whose enclosure is made as wide as that, rounded down, or by one unit wider."""
    given = json.loads((FOLDER / "minor-axis.json").read_text())

    def solved(self):
        low = self.boxes[1].lo
        return [x.mid() for x in (*self.boxes, self.box)], [
            self.boxes[0],
            check.I(low, low + 2**self.p // 10**digits + over, self.p),
        ]

    monkeypatch.setattr(check.Cycle, "solved", solved)
    monkeypatch.setattr(check.Cycle, "admissible", lambda *_: None)
    if over:
        with pytest.raises(check.Unproved, match="precise"):
            check.checked(given | {"digits": digits})
    else:
        assert check.checked(given | {"digits": digits}).startswith("proved")


@pytest.mark.parametrize(
    ("given", "item"),
    [
        (([1, 2], [1, 4]), "off its component"), (([1, 2], [1, 5]), "off its component"), (([1, 2], [-4, 1]),
        "off its component"),
        (([1, 2], [-9, 1]), "off its component"), (([1, 2], ["1/2", "39/10"]), None), (([0, 1], [4, 1], 1, ROUND),
        None),
        (([0, 1], [1, 4], 1, ROUND), "off its component"),
        (([1, 1, 1, 1], [1, 2, 1, 2]), "minimal_period"), (([1, 2, 1, 2], [1, 2, 1, 2]), "minimal_period"),
        (([1, 1], [1, 1]), "minimal_period"), (([1] * 6, [1, 2, 3] * 2), "minimal_period"), (([1] * 6, [1, 2] * 3),
        "minimal_period"),
        (([1] * 6, [1, 2, 3, 1, 2, "7/2"]), None), (([1, 2], [1, 1]), None), (([1, 2, 1, 1], [1, 2, 1, 2]), None),
        (([0, 0], [1, 1 + Fraction(2 * pi)], 1, ROUND), "minimal_period"), (([0, 0], [1, -1], 1, ROUND), None),
        (([0, 0], [3, Fraction(3 - 2 * pi)], 1, ROUND), "minimal_period"), (([0, 0], [3, -3], 1, ROUND), None),
        (([0, 0], [1, 1 + Fraction(4 * pi)], 1, ROUND), "minimal_period"),
        (([1], [0], -1), "minimal_period"), (([1], [1], -1), None), (([1, 1], [1, -1], -1), None),
        (([1, 1], [1, 2], -1), None),
        (([1, 2], [1, 2], 1, ROUND, [(1, 1)]), "may be undefined"), (([1, 2], [1, 2], 1, ROUND, [(2, 2)]),
        "may be undefined"),
        (([1, 2], [1, 2], 1, ROUND, [(1, 2), (2, 1), (0, 1)]), None), (([1, 2], [1, 2], 1, ROUND, [(1, 3), (2, 2)]),
        "may be undefined"),
        (([0, 2], [1, 2], 1, ROUND, [(0, 1 + Fraction(2 * pi))]), "may be undefined"),
        (([1, 2], [1, 2], -1, ROUND, [(1, -1)]), "may be undefined"),
        (([0, 1], [Fraction(pi), 1], 1, ROUND), None), (([0, 1], [-Fraction(pi), 1], 1, ROUND), None),  # on the seam
    ],
)  # fmt: skip
def test_bounces_are_on_their_parts_off_the_marks_and_of_no_shorter_cycle(check, given, item):
    admissible(check, *given, refuses=item)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("a", "b", "c", "e"), [(2, 3, 5, 11), (-1, 4, 2, -3), (0, -1, 1, 0)])
def test_the_equations_of_a_cycle_say_that_it_closes_and_what_its_multipliers_are(check, sign, a, b, c, e):
    """Of `(x, y) -> (a*x + b*y + 7 + x*y, c*x + e*y - 3 + x*z)`, perhaps mirrored, at (1/2, 1/4, 1/8), with slopes."""
    p, (x, y, z) = 60, (Fraction(1, 2**k) for k in (1, 2, 3))
    at, asked = [check.I.of(number, p) for number in (x, y, z)], []
    cycle = check.Cycle.__new__(check.Cycle)
    cycle.p, cycle.sign, cycle.table = p, sign, check.Table([["1", "-pi", "pi"]], {}, "", p)

    def run(unknowns, d):
        asked.append((unknowns, d))
        u, v, w = (check.Jet.of(number, d, k) for k, number in enumerate(unknowns))
        return [(u, v), None, ((u * a + v * b + 7 + u * v) * sign, (u * c + v * e - 3 + u * w) * sign)]

    cycle.run = run
    trace, det = a + y + e, (a + y) * e - (b + x) * (c + z)
    of_det = -(c + z), e, -(b + x)
    wanted = {
        "fold": (1 - trace + det, *(m - n for m, n in zip(of_det, (0, 1, 0), strict=True))),
        "flip": (1 + trace + det, *(m + n for m, n in zip(of_det, (0, 1, 0), strict=True))),
        "focus": (trace**2 - 4 * det, *(2 * trace * n - 4 * m for m, n in zip(of_det, (0, 1, 0), strict=True))),
        "cycle": (z - Fraction(1, 9), 0, 0, 1),
        "corner": (None, 1, 0, 0),
    }
    closes = (a - 1) * x + b * y + 7 + x * y, c * x + (e - 1) * y - 3 + x * z
    slopes = (a - 1 + y, b + x, 0), (c + z, e - 1, x)
    for kind, last in wanted.items():
        cycle.kind = kind
        cycle.lam, cycle.box = (check.I.of(Fraction(1, 9), p), None) if kind == "cycle" else (None, at[2])
        for d in (0, 1):
            found = cycle.equations(at, d)
            for jet, true in zip(found, [*((f, *g) for f, g in zip(closes, slopes, strict=True)), last], strict=True):
                for ours, number in zip([jet.c[0], *(jet.gradient(p) if d else ())], true, strict=False):
                    ours = check.I.of(ours, p)
                    assert number is None or Fraction(ours.lo, 2**p) <= number <= Fraction(ours.hi, 2**p)
                    assert ours.width() <= 2
            assert kind != "corner" or abs(check.value(found[2]).real() - 0.5 + 3.141592653589793) < 1e-12
            assert asked.pop() == (at, d + 1)


def curve(check, launched, v, bend, sign=1, mirrored=False):
    """The terms of a round of `(x, y) -> (x**2 + 3*y**3, x*y - y + lam)` along a curve from (1/2, 1/4)."""
    cycle, asked = check.Cycle.__new__(check.Cycle), []

    def orbit(launch, at, way, d, states):
        asked.append(([x.real() for x in at], way, d, states))
        x, y, names = launch(*(check.Jet.of(x, d, k) for k, x in enumerate(at)))
        return ["first", "between", (x * x + y * y * y * 3, x * y - y + names["lam"])]

    cycle.table, cycle.p, cycle.sign, cycle.way, cycle.names = (
        SimpleNamespace(orbit=orbit),
        P,
        sign,
        "way",
        lambda letter: {"lam": letter},
    )
    image = [number(check, x) for x in ("1/2", "1/4", "1/8")]
    found = cycle.along(image, "states", [number(check, x) for x in v], [number(check, x) for x in bend])
    assert asked == [([0, 0, 0.125], "way", 3, "states")]
    return [[check.I.of(c, P).real() for c in row] for row in found]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("v", "bend"), [((1, 0), (0, 0)), ((0, 1), (0, 0)), ((2, -1), (3, 5)), ((1, "1/2"), (-2, "1/4"))]
)
def test_the_terms_of_a_round_along_a_curve_are_those_of_the_second_and_third_order(check, sign, v, bend):
    """By hand: with `x = 1/2 + a*e + c*e**2` and `y = 1/4 + b*e + d*e**2`."""
    (a, b), (c, d) = (map(Fraction, pair) for pair in (v, bend))
    x, y = Fraction(1, 2), Fraction(1, 4)
    second = a * a + 2 * x * c + 3 * (3 * y * y * d + 3 * y * b * b), a * b + x * d + y * c - d
    third = 2 * a * c + 3 * (6 * y * b * d + b**3), a * d + b * c
    assert curve(check, None, v, bend, sign) == [[sign * float(z) for z in pair] for pair in (second, third)]


@pytest.mark.parametrize(
    ("parts", "bounces", "boxes", "scene", "what", "name"),
    [
        (2, ["0", "40*pi"], ["0", "0"], {"table": "cuspless"}, ("flip", 1, "lam"), "lambda-c"),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg"}, ("flip", 1, "alpha"), "alpha-tilde"),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg"}, ("focus", 1, "alpha"), "alpha-hat"),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg"}, ("fold", 1, "alpha"), None),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg"}, ("flip", 1, "lam"), None),
        (2, ["1/9", "1"], ["-1/9", "1"], {"table": "egg"}, ("flip", 1, "alpha"), None),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg", "law": "eta"}, ("flip", 1, "alpha"), None),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg", "K": 5}, ("flip", 1, "alpha"), None),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg", "K": 3}, ("flip", 1, "alpha"), "alpha-tilde"),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"polar": "1"}, ("flip", 1, "alpha"), None),
        (2, ["1/9", "1"], ["-1/9", "-1"], {"table": "egg"}, ("flip", -1, "alpha"), None),
        (3, ["1", "1+2*pi/3", "1-2*pi/3"], None, {"table": "egg"}, ("fold", 1, "lam"), "saddle-node"),
        (3, ["1", "1-2*pi/3", "1+2*pi/3"], None, {"table": "egg"}, ("fold", 1, "lam"), None),
        (3, ["0", "1", "-1"], ["0", "-1", "1"], {"table": "egg"}, ("fold", 1, "lam"), None),
        (3, ["1", "1+2*pi/3", "1-2*pi/3"], None, {"table": "egg"}, ("fold", -1, "lam"), None),
        (2, ["1", "2"], None, {"table": "circle"}, ("cycle", 1, ""), "a cycle of period 2: title"),
        (2, ["1", "2"], None, {"table": "circle"}, ("cycle", -1, ""), "half of a symmetric cycle, of period 2: title"),
    ],
)  # fmt: skip
def test_a_value_is_named_by_the_symmetry_of_its_cycle_or_by_what_is_stated(
    check, parts, bounces, boxes, scene, what, name
):
    at = lambda text: check.I.of(check.evaluate(check.parse(text), {}, P)[0], P)  # noqa: E731
    near, small = number(check, Fraction(1, 2**30)), number(check, Fraction(1, 2**50))
    kind, sign, free = what
    found = [at(x).wide(small) for x in bounces]
    around = [at(x).wide(near) for x in boxes or bounces]
    half = "half of a symmetric cycle," if sign < 0 else "a cycle"
    name = name or f"{kind} of {half} of period {parts} in {free}: title"
    assert check.named(kind, sign, [0] * parts, found, around, scene, free, "title", P) == name


def test_what_is_printed_is_the_middle_of_the_enclosure_with_its_digits_as_far_as_these_are_seen(check):
    """Of the short axis, whose last bounce is a right angle: fewer digits are rounded, too many are refused."""
    given = json.loads((FOLDER / "minor-axis.json").read_text())
    for digits, value in ((7, "1.5707963"), (given["digits"], None)):
        first, second = check.checked(given | {"digits": digits}).split("\n")
        told, end = first.removeprefix(f"proved: {given['name']}, last bounce at -").split(", within ")
        assert (end, second) == (f"1e-{digits}", f"  {given['statement']}")
        assert len(told.split(".")[1]) == digits
        assert value is None or told == value
    with pytest.raises(check.Unproved, match="precise"):
        check.checked(given | {"digits": 60_000})


def test_the_second_reader_says_of_each_file_in_its_turn_what_is_proved_of_it(check, monkeypatch, tmp_path, capsys):
    """The status is 0 where all is proved, and there is something."""
    paths = [str(tmp_path / name) for name in ("good", "bad", "wrong", "odd", "none")]
    for name in paths[:-1]:
        Path(name).write_text(json.dumps(Path(name).name))

    def checked(given):
        errors = {"bad": check.Unproved("an item"), "wrong": check.Wrong("an entry"), "odd": KeyError("x")}
        if given in errors:
            raise errors[given]
        return f"proved: {given}"

    monkeypatch.setattr(check, "checked", checked)
    answers = ["proved: good", "not proved: an item", "refused: an entry", "refused: this is no certificate (KeyError)"]
    answers.append("refused: this is no certificate (FileNotFoundError)")
    for which, status in (
        ((), 1),
        ((0,), 0),
        ((0, 0), 0),
        ((0, 1), 1),
        ((1, 0), 1),
        ((2, 0), 1),
        ((3, 0), 1),
        ((4, 0), 1),
        ((0, 4), 1),
        ((1,), 1),
    ):
        assert check.main([paths[k] for k in which]) == status
        assert capsys.readouterr().out.splitlines() == [f"{paths[k]}: {answers[k]}" for k in which]
