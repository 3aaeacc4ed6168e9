"""Boundary crises by the second reader, step by step: what a document may say, saddles, branches, and who is asked."""

import json
from fractions import Fraction
from math import atan, cos, pi, sin
from pathlib import Path
from types import SimpleNamespace

import pytest
from by_hand import number

GIVEN = json.loads((Path(__file__).parents[3] / "certificates" / "crisis-between.json").read_text())
EGG = {"table": "egg", "shape": {"alpha": "2/25"}}
TURN, P = Fraction(1, 3), 100


def saddle(start=-0.2, sign=1, shift=(1, 3), name="s"):
    return {"name": name, "start": [start], "sign": sign, "shift": [*shift]}


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        ({}, ((1, 3), "3/5", "663/1000")),
        ({"saddle": saddle(shift=(2, 3))}, ((2, 3), "3/5", "663/1000")),
        ({"saddle": saddle(shift=(1, 6)), "scene": EGG | {"K": 6, "lam": "1/2"}}, ((1, 6), "3/5", "663/1000")),
        ({"saddle": saddle(shift=(1, 2)), "scene": EGG | {"K": 4, "lam": "1/2"}}, ((1, 2), "3/5", "663/1000")),
        ({"side": -1}, ((1, 3), "3/5", "663/1000")),
        ({"lam": ["1/1000", "999/1000"]}, ((1, 3), "1/1000", "999/1000")),
        ({"columns": 1, "rows": 8192, "parts": 1}, ((1, 3), "3/5", "663/1000")),
        ({"columns": 8192, "rows": 1, "parts": 8192}, ((1, 3), "3/5", "663/1000")),
        ({"start": 9.99, "sink": [-9.99, 9.99], "saddle": saddle(9.99)}, ((1, 3), "3/5", "663/1000")),
    ],
)  # fmt: skip
def test_what_a_document_says_of_its_scene_its_turn_and_its_ends(crisis, change, wanted):
    scene, turn, low, high = crisis.said(GIVEN | change)
    assert (turn, low, high) == (wanted[0], *map(Fraction, wanted[1:]))
    assert scene == {key: x for key, x in (GIVEN | change)["scene"].items() if key != "lam"}


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"schema": 0}, "schema 1"), ({"scene": [EGG]}, "egg"), ({"scene": {"polar": "1", "lam": "1/2"}}, "egg"),
        ({"saddle": {"name": "s", "start": [0.1], "sign": 1}}, "a turn of the table|shift"),
        ({"saddle": saddle() | {"more": 1}}, "a turn of the table"),
        ({"saddle": saddle() | {"start": []}}, "a turn of the table"),
        ({"saddle": saddle(shift=(0, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(-1, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(4, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(3, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(True, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(1.0, 3))}, "a turn of the table"),
        ({"saddle": saddle(shift=(1, 3.0))}, "a turn of the table"),
        ({"saddle": saddle(shift=(2, 4))}, "a turn of the table"), ({"saddle": saddle(sign=2)}, "a turn of the table"),
        ({"saddle": saddle(shift=(1, 4)), "scene": EGG | {"K": 6, "lam": "1/2"}}, "a turn of the table"),
        ({"side": 0}, "out of range"), ({"side": 1.5}, "out of range"), ({"start": -10.0}, "out of range"),
        ({"start": 1}, "out of range"), ({"sink": [0.0]}, "out of range"), ({"sink": [0.0, 0.0, 0.0]}, "out of range"),
        ({"sink": [10.0, 0.0]}, "out of range"), ({"saddle": saddle(10.0)}, "out of range"),
        ({"saddle": saddle(0)}, "out of range"),
        ({"lam": ["3/5"]}, "out of range|unpack"), ({"lam": ["3/5", "33/50", "663/1000"]}, "out of range|unpack"),
        ({"lam": ["6/10", "663/1000"]}, "out of range"), ({"lam": ["3/5", "0.663"]}, "out of range"),
        ({"lam": ["0", "3/5"]}, "out of range"), ({"lam": ["3/5", "1"]}, "out of range"),
        ({"lam": ["3/5", "3/5"]}, "out of range"), ({"lam": ["-1/5", "3/5"]}, "out of range"),
        ({"lam": ["3/5", "6/5"]}, "out of range"),
        *(({key: n}, "out of range") for key in ("columns", "rows", "parts") for n in (0, -1, 8193, 5.0, True)),
        ({"scene": EGG | {"law": "-lam*eta", "lam": "1/2"}}, "of crises this reader knows"),
        ({"scene": EGG}, "lam is told"), ({"scene": {"table": "egg", "lam": "1/2"}}, "other letters"),
    ],
)  # fmt: skip
def test_a_document_that_says_anything_else_is_refused(check, crisis, change, why):
    with pytest.raises((check.Wrong, ValueError, KeyError), match=why):
        crisis.said(GIVEN | change)


def egg(theta):
    """Point and velocity of the egg with three points and alpha = 2/25."""
    r, dr = 1 + 0.08 * cos(3 * theta), -0.24 * sin(3 * theta)
    return r * cos(theta), r * sin(theta), dr * cos(theta) - r * sin(theta), dr * sin(theta) + r * cos(theta)


def angles(theta, there):
    """The exit angle of a chord, and minus its incidence, from the tangents' sides."""
    (x, y, tx, ty), (u, v, sx, sy) = egg(theta), egg(there)
    dx, dy = u - x, v - y
    return atan((dx * tx + dy * ty) / (dy * tx - dx * ty)), atan((dx * sx + dy * sy) / (dx * sy - dy * sx))


@pytest.mark.parametrize("turn", [TURN, 2 * TURN, Fraction(1, 4)])
@pytest.mark.parametrize("theta", ["-1/5", "3/7", "2"])
def test_the_law_of_a_chord_and_its_turn_has_its_value_and_its_slope(check, crisis, turn, theta):
    """By the egg in floating point, also for turns that are none of its own; over an interval, at all of its places."""
    table, at, lam = check.read_scene(EGG, "lam", P)[0], float(Fraction(theta)), 0.625
    exact = lambda t: (lambda out, back: (out - lam * back, out))(*angles(t, t + 2 * pi * turn))  # noqa: E731
    found = crisis.law(table, turn, check.Jet.of(number(check, theta), 1, 0), number(check, lam))
    plain = crisis.law(table, turn, number(check, theta), number(check, lam))
    for jet, value, true, up, down in zip(found, plain, exact(at), exact(at + 1e-6), exact(at - 1e-6), strict=True):
        assert check.value(jet).real() == pytest.approx(true, abs=1e-13)
        assert check.value(value).real() == pytest.approx(true, abs=1e-13)
        assert check.value(jet).width() < 2**20
        assert jet.gradient(P)[0].real() == pytest.approx((up - down) / 2e-6, abs=1e-8)


@pytest.mark.parametrize(
    ("first", "second", "fits"),
    [
        ((1, 0, 0, 1), (-1, 0, 0, -1), True), ((1, 0, 0, -1), (-1, 0, 0, -1), False), ((1, 0, 0, 1), (-1, 0, 0, 1),
        False),
        ((1, 0, 1, 0), (-1, 0, 0, -1), False), ((1, 0, 0, 1), (-1, 0, 1, 0), False), ((1, 0, 1, 0), (-1, 0, 1, 0),
        False),
    ],
)  # fmt: skip
def test_a_chord_of_the_law_runs_inside_at_both_of_its_ends(check, crisis, first, second, fits):
    """Of points and velocities that are told: along a tangent, or outwards, it does not."""
    ends = iter([first, second])
    table = SimpleNamespace(p=P, letters={}, at=lambda *_: [check.Jet.of(number(check, x), 0) for x in next(ends)])
    run = lambda: crisis.law(table, TURN, number(check, 0), number(check, 1))  # noqa: E731
    if fits:
        assert [check.value(x).real() for x in run()] == [0, 0]
    else:
        with pytest.raises(check.Unproved, match="may not run inside"):
            run()


def test_where_a_law_holds_is_one_place_of_each_box_at_both_ends_of_lam_alike(check, crisis):
    """Of the triangle at its vertices: in a box about it, in none beside it, and none where two are."""
    table = check.read_scene(EGG, "lam", P)[0]
    at = crisis.found(table, TURN, number(check, "3/5"), -0.2079)
    narrow, lam = number(check, Fraction(1, 2**30)), number(check, "3/5")
    crisis.one(table, TURN, at.wide(narrow), lam)
    for box, letter in (
        (at.wide(narrow) + narrow * 3, lam),
        (at.wide(narrow) - narrow * 3, lam),
        (at.wide(narrow), lam + Fraction(1, 100)),
    ):
        with pytest.raises(check.Unproved, match="not seen to be one cycle"):
            crisis.one(table, TURN, box, letter)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("steep", "seen"), [("0", False), ("4/5", True)])
def test_a_law_that_may_turn_back_in_a_box_is_not_seen_to_hold_once(check, crisis, monkeypatch, sign, steep, seen):
    """Of a cube about 1/2, over `0 <= theta <= 1`, where its slope by intervals is within 3/4 of `steep`."""
    middle = lambda theta: (theta if isinstance(theta, check.Jet) else check.Jet.of(theta, 0)) - Fraction(1, 2)  # noqa: E731
    cube = lambda x: (x * x * x + x * Fraction(steep)) * sign  # noqa: E731
    monkeypatch.setattr(crisis, "law", lambda table, turn, theta, lam: (cube(middle(theta)), None))
    box = number(check, 0).hull(number(check, 1))
    if seen:
        crisis.one(SimpleNamespace(p=P), TURN, box, None)
    else:
        with pytest.raises(check.Unproved, match="not seen to be one cycle"):
            crisis.one(SimpleNamespace(p=P), TURN, box, None)


@pytest.mark.parametrize(("theta", "psi"), [("-1/5", "1/10"), ("3/7", "-1/6"), ("1", "0")])
@pytest.mark.parametrize(("turn", "lam"), [(TURN, "3/5"), (2 * TURN, "1/4")])
def test_the_derivative_of_a_bounce_and_a_turn_is_that_of_differences(check, crisis, theta, psi, turn, lam):
    """By landings in floating point that Newton's method finds; the determinant is told by another formula."""
    table, by = check.read_scene(EGG, "lam", P)[0], float(Fraction(lam))

    def bounce(t, out):
        x, y, tx, ty = egg(t)
        ux, uy, there = tx * sin(out) - ty * cos(out), ty * sin(out) + tx * cos(out), t + pi - 2 * out
        for _ in range(60):
            u, v, sx, sy = egg(there)
            there -= (ux * (v - y) - uy * (u - x)) / (ux * sy - uy * sx)
        return there, by * angles(t, there)[1]

    t, out, h = float(Fraction(theta)), float(Fraction(psi)), 1e-6
    there = bounce(t, out)[0]
    turn = Fraction((there - t) / (2 * pi))  # so that the landing is where it is looked for
    (a, b), (c, d), det = crisis.derivative(table, turn, (number(check, theta), number(check, psi)), number(check, lam))
    differences = [[(p - q) / (2 * h) for p, q in zip(bounce(*up), bounce(*down), strict=True)]
                   for up, down in (((t + h, out), (t - h, out)), ((t, out + h), (t, out - h)))]  # fmt: skip
    wanted = differences[0][0], differences[1][0], differences[0][1], differences[1][1]
    for x, true in zip((a, b, c, d), wanted, strict=True):
        assert x.real() == pytest.approx(true, abs=1e-7)
        assert x.width() < 2**30
    assert (det - (a * d - b * c)).size().hi < 2**34
    assert det.width() < 2**30


LINEAR = SimpleNamespace(a="3", b="1", c="0", d="1/4", det="3/4", drift="1/50")


def continued(check, crisis, monkeypatch, at=Fraction(1, 2), near="1/1000000", **entries):
    """What is asked and answered of saddles at `1/2 + drift*(lam - 1/4)`, from lam = 1/4 to 1/2, in four cuts."""
    asked, of = [], SimpleNamespace(**vars(LINEAR) | entries)
    place = lambda lam: number(check, "1/2") + (lam - Fraction(1, 4)) * Fraction(of.drift)  # noqa: E731
    monkeypatch.setattr(crisis, "CUTS", 4)
    monkeypatch.setattr(
        crisis, "found", lambda table, turn, lam, start: asked.append(("found", start)) or place(lam).mid()
    )
    monkeypatch.setattr(crisis, "one", lambda table, turn, box, lam: asked.append(("one", box, lam)))

    def law(table, turn, theta, lam):
        theta = theta if isinstance(theta, check.Jet) else check.Jet.of(theta, 0)
        return None, theta * 2 - 1

    def derivative(table, turn, state, lam):
        asked.append(("derivative", *state, lam))
        rows = ((of.a, of.b), (of.c, of.d))
        return *(tuple(number(check, x) for x in row) for row in rows), number(check, of.det)

    monkeypatch.setattr(crisis, "law", law)
    monkeypatch.setattr(crisis, "derivative", derivative)
    ends = crisis.continued(SimpleNamespace(p=P), TURN, Fraction(1, 4), Fraction(1, 2), at + Fraction(near))
    return ends, asked


def test_saddles_are_one_curve_of_boxes_that_overlap_and_are_told_at_both_ends(check, crisis, monkeypatch):
    (first, last), asked = continued(check, crisis, monkeypatch)
    assert (first.real(), last.real()) == (0.5, 0.505)
    assert first.width() == last.width() == 2 ** (P - 35)
    starts = [start for what, start, *_ in asked if what == "found"]
    assert starts == [Fraction(500001, 10**6), *(pytest.approx(0.5 + k / 800) for k in range(4))]
    boxes = [(box, lam) for what, box, *rest in asked if what == "one" for lam in rest]
    assert len(boxes) == 12
    for k in range(4):
        (box, lam), (left, low), (right, high) = boxes[3 * k : 3 * k + 3]
        ends = Fraction(4 + k, 16), Fraction(5 + k, 16)
        assert (lam.lo, lam.hi) == tuple(x * 2**P for x in ends)
        assert [(x.lo, x.hi) for x in (low, high)] == [(x * 2**P,) * 2 for x in ends]
        assert left.inside(box) and right.inside(box)  # noqa: PT018
        assert [x.real() for x in (left, right)] == [pytest.approx(0.5 + n / 800) for n in (k, k + 1)]
        assert box.width() < 2**P / 390
    states = [given for what, *given in asked if what == "derivative"]
    assert [(lam.lo, lam.hi) for *_, lam in states] == [(lam.lo, lam.hi) for _, lam in boxes[::3]]
    for (theta, psi, _), (box, _) in zip(states, boxes[::3], strict=True):
        assert (theta.lo, theta.hi) == (box.lo, box.hi)
        assert abs(psi.lo - 2 * box.lo + 2**P) <= 4
        assert abs(psi.hi - 2 * box.hi + 2**P) <= 4


@pytest.mark.parametrize(
    ("entries", "fails"),
    [
        ({}, None), ({"d": "1/2", "det": "3/2"}, None), ({"b": "-1"}, None),
        ({"a": "11/10", "d": "-9/10", "det": "-99/100"}, None),
        ({"a": "11/10", "d": "0", "det": "0"}, None),
        ({"a": "-3"}, "multipliers"), ({"a": "1", "d": "1/2", "det": "1/2"}, "multipliers"),
        ({"b": "0"}, "multipliers"),
        ({"a": "1/2", "d": "1/4", "det": "1/8"}, "multipliers"), ({"a": "3", "d": "-1", "det": "-3"}, "multipliers"),
        ({"a": "3", "d": "-2", "det": "-6"}, "multipliers"), ({"a": "3", "d": "2", "det": "6"}, "multipliers"),
        ({"near": "1/50000"}, "not where it is said"), ({"near": "-1/50000"}, "not where it is said"),
        ({"near": "-1/1000000"}, None), ({"near": "1/100100"}, None), ({"near": "-1/100100"}, None),
        ({"near": "1/99900"}, "not where it is said"), ({"near": "-1/99900"}, "not where it is said"),
    ],
)  # fmt: skip
def test_a_saddle_has_one_multiplier_above_1_and_one_between_plus_and_minus_1(
    check, crisis, monkeypatch, entries, fails
):
    if fails:
        with pytest.raises(check.Unproved, match=fails):
            continued(check, crisis, monkeypatch, **entries)
    else:
        continued(check, crisis, monkeypatch, **entries)


@pytest.mark.parametrize(
    ("kept", "apart"),
    [
        ((8, 9), True),
        ((12, 10), True),
        ((10, 8), True),
        *(((column, row), False) for column in (9, 10, 11) for row in (9, 10, 11)),
        ((10, 12), True),
        ((341, 10), None),
    ],
)
def test_a_crisis_is_what_its_steps_say_together(check, crisis, monkeypatch, kept, apart):
    """Each step is given the contractions that it is for: the low end, the high one, or all between them."""
    asked, lam = [], [Fraction(x) for x in GIVEN["lam"]]
    span = lambda x: (Fraction(x.lo, 1 << x.p), Fraction(x.hi, 1 << x.p))  # noqa: E731
    taken = {(0, 10), (7, 7)} if apart is None else {(10, 10)}

    class Grown:
        def __init__(self, table, lam, high, parts):
            self.lam = span(lam)
            asked.append(("grown", self.lam, span(high), parts))

        def met(self, *box):
            return [self.lam, *box]

        def grow(self, seeds):
            seeds = [*seeds]
            asked.append(("grow", seeds[0], len(seeds)))
            return taken if seeds[0][1] - seeds[0][0] > Fraction(1, 100) else {kept}

    class Branch:
        def __init__(self, table, turn, lam, near, small):
            self.said = table.p, turn, lam, near, small
            asked.append(("branch", *self.said))

        def pieces(self, side, map):
            asked.append(("pieces", side, map.lam))
            return [("box", "box")] * 2

        def leaves(self, side, map, cells, rough):
            asked.append(("leaves", side, map.lam, cells, self.said[0], rough.said[0]))
            return True

    saddles = lambda table, *rest: asked.append(("continued", table.p, *rest)) or ("low end", "high end")  # noqa: E731
    monkeypatch.setattr(crisis, "Grown", Grown)
    monkeypatch.setattr(crisis, "Branch", Branch)
    monkeypatch.setattr(crisis, "continued", saddles)
    monkeypatch.setattr(crisis, "convex", lambda table: asked.append(("convex", table.p)))
    if not apart:
        with pytest.raises(check.Unproved, match="apart"):
            crisis.crisis(GIVEN)
        return
    answer = crisis.crisis(GIVEN).splitlines()
    assert answer[0] == f"proved: {GIVEN['name']}"
    assert answer[1] == "  1 cells are kept at 3/5, 1 are trapping up to 663/1000."
    start, side, bits = GIVEN["saddle"]["start"][0], GIVEN["side"], crisis.BITS
    found = {what: [rest for name, *rest in asked if name == what] for what in {name for name, *_ in asked}}
    low, high = (
        [Fraction(check.I.of(x, bits).lo, 1 << bits), Fraction(check.I.of(x, bits).hi, 1 << bits)] for x in lam
    )
    both, below = (low[0], high[1]), tuple(low)
    assert found["convex"] == [[bits]]
    assert found["continued"] == [[bits, TURN, *lam, start]]
    assert found["grown"] == [[both, tuple(high), 3], [below, tuple(high), 3]]
    assert found["grow"] == [[both, 3], [below, 6]]
    assert found["pieces"] == [[side, below]]
    assert found["leaves"] == [[side, both, taken, crisis.MORE, bits]]
    assert found["branch"] == [
        [4 * bits, TURN, lam[0], "low end", crisis.SMALL], [bits, TURN, lam[1], "high end", crisis.SMALL],
        [crisis.MORE, TURN, lam[1], "high end", crisis.TINY],
    ]  # fmt: skip
