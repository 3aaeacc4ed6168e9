"""Cycles of many bounces in the second reader: the same answers as where it follows them round, and exact systems."""

import json
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "certificates"
SHORT = (
    *("minor-axis", "saddle-node", "doubling-3", "doubling-4", "own-mirror", "symmetry-breaking", "free-parameter"),
    *("law-in-all-words", "law-parameter", "spline", "cardioid-period-9", "limacon-12", "moved-waves", "scatterer"),
)


def document(name: str) -> dict:
    return json.loads((FOLDER / f"{name}.json").read_text())


def said(check, given: dict) -> str:
    try:
        return check.checked(given).splitlines()[0]
    except check.Unproved as why:
        return f"not proved: {why}"
    except check.Wrong as why:
        return f"refused: {why}"


@pytest.mark.parametrize("name", SHORT)
def test_a_short_cycle_is_proved_by_the_equations_for_long_ones_with_the_same_digits(check, monkeypatch, name):
    """Two sets of equations: states that are followed all round, and the rule of two chords at each bounce."""
    followed = said(check, document(name))
    monkeypatch.setattr(check, "SHORT", 0)

    assert followed.startswith("proved: ")
    assert said(check, document(name)) == followed


def test_a_cycle_of_48_bounces_is_proved(check):
    assert said(check, document("limacon-48")).startswith(
        "proved: flip of a cycle of period 48 in lam: polar 3*cos(theta)/5 + 1 = 0.73304507687465284564"
    )


def test_a_doubling_inside_of_a_report_is_proved(check):
    blocks = [
        b for part in json.loads((ROOT / "docs/reports/limacon.json").read_text())["sections"] for b in part["blocks"]
    ]
    given = next(b["document"] for b in blocks if b.get("name") == "cascade-3-96-0")

    assert said(check, given).startswith("proved: flip of a cycle of period 96 in lam: ")


def moved(given: dict, place: int, by: Fraction) -> dict:
    """The middle of one unknown moved by so many radii."""
    (m, e), (r, f) = given["centre"][place], given["radius"]
    x = int(m) * Fraction(2) ** int(e) + by * int(r) * Fraction(2) ** int(f)
    centre = [*given["centre"]]
    centre[place] = [str(round(x * 2**400)), "-400"]
    return given | {"centre": centre}


@pytest.mark.parametrize(
    ("place", "by", "answer"),
    [
        (0, Fraction(1, 2), "proved: "),
        (0, Fraction(2), "not proved: exists, unique"),
        (-1, Fraction(1, 2), "proved: "),
        (-1, Fraction(-2), "not proved: exists, unique"),
    ],
)
def test_a_box_beside_the_solution_holds_none(check, monkeypatch, place, by, answer):
    monkeypatch.setattr(check, "SHORT", 0)

    assert said(check, moved(document("doubling-3"), place, by)).startswith(answer)


@pytest.mark.parametrize(
    ("name", "change", "answer"),
    [
        ("doubling-3", {"radius": ["1", "-8"]}, "not proved: exists, unique"),
        ("doubling-3", {"radius": ["1", "-300"]}, "not proved: exists, unique"),
        ("doubling-3", {"digits": 60}, "not proved: precise"),
        ("alpha-hat", {}, "refused: kind"),
    ],
)
def test_what_long_equations_do_not_give_is_not_proved(check, monkeypatch, name, change, answer):
    monkeypatch.setattr(check, "SHORT", 0)

    assert said(check, document(name) | change).startswith(answer)


def test_a_flip_is_no_fold(check, monkeypatch):
    """The same box, with a name and a statement that say the other multiplier."""
    monkeypatch.setattr(check, "SHORT", 0)
    text = json.dumps(document("doubling-3")).replace("flip of", "fold of").replace('"flip"', '"fold"')
    text = text.replace("the multiplier -1: a flip", "the multiplier 1: a fold")

    assert said(check, json.loads(text)).startswith("not proved: exists, unique")


def cyclic(dice: Random, n: int) -> list[dict[int, Fraction]]:
    """A cyclic tridiagonal system with a last column and a last row, as bordered ones are."""
    number = lambda: Fraction(dice.randrange(-99, 100), 37)  # noqa: E731
    rows = [{k: number() + 9, (k + 1) % n: number(), (k - 1) % n: number(), n: number()} for k in range(n)]
    return [*rows, {j: number() for j in range(n)}]


@pytest.mark.parametrize("seed", range(4))
def test_a_linear_system_is_enclosed_with_its_exact_solution(check, seed):
    dice, p, n = Random(seed), 200, 9
    rows, x = cyclic(dice, n), [Fraction(dice.randrange(-50, 50), 7) for _ in range(n + 1)]
    right = [sum(a * x[j] for j, a in row.items()) for row in rows]
    made = check.beside("long").Linear([{j: check.I.of(a, p) for j, a in row.items()} for row in rows], p)
    found = made.solve([check.I.of(b, p) for b in right], 6)

    for enclosure, exact in zip(found, x, strict=True):
        assert enclosure.lo <= exact * 2**p <= enclosure.hi
        assert enclosure.width() < 2 ** (p - 150)


def test_a_system_that_may_be_singular_is_refused(check):
    p, long = 100, check.beside("long")
    one, wide = check.I.of(1, p), check.I.of(1, p).wide(check.I.of(Fraction(3, 2), p))
    for rows in ([{0: one, 1: one}, {0: one, 1: one}], [{0: wide, 1: one}, {0: one, 1: one * 3}]):
        with pytest.raises(check.Unproved, match="may be singular"):
            long.Linear(rows, p)


@pytest.mark.parametrize("name", ["doubling-3", "saddle-node", "own-mirror", "free-parameter"])
def test_the_row_of_g_has_its_derivatives(check, monkeypatch, name):
    """Against difference quotients of g itself, at the middle of the box."""
    asked, long = [], check.beside("long")
    kept = long.Long.moving
    monkeypatch.setattr(
        long.Long, "moving", lambda self, *given: asked.append((self, kept(self, *given))) or asked[-1][1]
    )
    monkeypatch.setattr(check, "SHORT", 0)
    assert said(check, document(name)).startswith("proved: ")
    (cycle, row), p = asked[0], asked[0][0].p
    middle = [x.mid() for x in [*cycle.boxes, cycle.box]]

    def g(place: int, step: Fraction):
        at = [x + step if k == place else x for k, x in enumerate(middle)]
        rows = cycle.matrix(cycle.chords(at[:-1], at[-1], 1), cycle.twist, False)
        return cycle.bordered(rows, cycle.border)[0].solve(cycle.end, 20)[-1]

    for place in range(len(middle)):
        step = Fraction(1, 2**40)
        slope = (g(place, step) - g(place, -step)).real() * 2.0**39
        assert check.I.of(row[place], p).real() == pytest.approx(slope, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["alpha-tilde", "doubling-3", "own-mirror"])
def test_the_second_and_third_order_at_a_doubling_are_those_of_the_rule_on_cycles_of_twice_the_length(
    check, monkeypatch, name
):
    """Along w*e + h*e**2, by differences in e; the first order is 0, and the second, for which h is made."""
    asked, long = [], check.beside("long")
    kept = long.Long.along
    monkeypatch.setattr(long.Long, "along", lambda self, *given: asked.append((self, given)) or kept(self, *given))
    monkeypatch.setattr(check, "SHORT", 0)
    assert said(check, document(name)).startswith("proved: ")
    (_, (_, _, none)), (cycle, (chords, w, h)) = asked
    assert all(x.real() == 0 for x in none)
    letter = cycle.box.mid()
    twice = long.Long(cycle.table, "flip", cycle.parts * 2, cycle.boxes * 2, 1, "", None, letter)
    twice.free, twice.names, n = True, cycle.names, len(cycle.parts)

    def rule(e: Fraction) -> list:
        first = [x.mid() + a.mid() * e + b.mid() * e * e for x, a, b in zip(cycle.bounces, w, h, strict=True)]
        later = [x.mid() - a.mid() * e + b.mid() * e * e for x, a, b in zip(cycle.bounces, w, h, strict=True)]
        made = twice.chords([*first, *(x * cycle.sign for x in later)], letter, 1)
        return [check.value(made[k][0]) - check.value(made[k - 1][1]) for k in range(1, n + 1)]

    e = Fraction(1, 2**12)
    for k, (_, third) in enumerate(cycle.along(chords, w, h)):
        (a, b), (c, d) = ((rule(s)[k], rule(-s)[k]) for s in (2 * e, e))
        here, cubic = rule(Fraction(0))[k], ((a - b) / 4 - (c - d) / 2) / 3
        assert (c + d - here * 2).real() / 2 / float(e) ** 2 == pytest.approx(0, abs=1e-4)
        assert cubic.real() / float(e) ** 3 == pytest.approx(third.real(), rel=1e-4, abs=1e-4)
        assert (c - d).real() / 2 / float(e) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("bounces", [3, 5])
@pytest.mark.parametrize(
    ("kind", "det", "cubic", "answer"),
    [
        ("fold", "1/2", "0", None),
        ("fold", "1", "0", "other_multiplier"),
        ("fold", "-3/2", "0", "other_multiplier"),
        ("flip", "1/2", "0", None),
        ("flip", "1/2", "-2/27", "nondegenerate"),
        ("flip", "-1/2", "-2/9", "nondegenerate"),
        ("flip", "-1/2", "-1/9", None),
        ("flip", "3/2", "0", "other_multiplier"),
        ("flip", "-1", "0", "other_multiplier"),
    ],
)
def test_a_degenerate_bifurcation_is_refused(check, bounces, kind, det, cubic, answer):
    """Of `x[k+1] = F(x[k]) - d*x[k-1]` at 0, whose slope of F makes a multiplier -1 or 1, and the other one -d or d.

    By hand the doubling has the coefficient `c + q**2/(1 + d)`, with q and c those of `x**2` and `x**3` in F.
    """
    p, long = 200, check.beside("long")
    d, number = Fraction(det), lambda x: check.I.of(Fraction(x), 200).wide(check.I.of(Fraction(1, 2**150), 200))
    slope = -1 - d if kind == "flip" else 1 + d
    cycle = long.Long.__new__(long.Long)
    cycle.p, cycle.sign, cycle.kind, cycle.parts, cycle.border = p, 1, kind, [0] * bounces, (0, 0)
    cycle.twist, cycle.bounces = -1 if kind == "flip" else 1, [check.I.of(0, p)] * bounces
    cycle.end = [check.I.of(0, p)] * bounces + [check.I.of(1, p)]

    def chords(_bounces, _letter, degree):
        before, x = (check.Jet.of(check.I.of(0, p), degree, k) for k in (0, 1))
        zero = check.Jet.of(check.I.of(0, p), degree)
        law = x * number(slope) + x * x * number("1/3") + x * x * x * number(cubic) - before * number(d)
        return [(x + zero, law)] * (bounces + 1)

    cycle.chords = chords
    if answer is None:
        cycle.generic([None, None, None])
    else:
        with pytest.raises(check.Unproved, match=answer):
            cycle.generic([None, None, None])


@pytest.mark.parametrize("bounces", [("pi", "pi", "0"), ("pi", "0", "0"), ("0", "0", "pi")])
def test_a_chord_that_leaves_or_arrives_on_the_far_side_of_a_disc_is_refused(check, bounces):
    """Along the axis of a disc in a disc: from one end of it to a bounce on the inner disc, and on to the other end."""
    outer = {"x": "5*cos(theta)", "y": "5*sin(theta)", "from": "-pi", "to": "pi"}
    disc = {"x": "cos(theta)", "y": "-sin(theta)", "from": "-pi", "to": "pi"}
    table, lam, _ = check.read_scene({"component": [outer, disc], "lam": "1/3"}, "", 128)
    at = [check.pi(128) if text == "pi" else check.I.of(0, 128) for text in bounces]
    cycle = check.beside("long").Long(table, "cycle", [0, 1, 0], at, 1, "", None, lam)
    cycle.free = False
    with pytest.raises(check.Unproved, match="may not leave or arrive inwards"):
        cycle.chords(at, lam, 1)
