"""Cycles of many bounces in the independent checker: the digits of the package, and exact systems."""

import json
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
from by_hand import holds, number
from committed import document, moved, verdict

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_a_doubling_inside_of_a_report_is_proved(check):
    blocks = [
        b for part in json.loads((ROOT / "docs/reports/limacon.json").read_text())["sections"] for b in part["blocks"]
    ]
    inside = [b["document"] for b in blocks if b["kind"] == "certificate"]
    given = next(one for one in inside if one["kind"] == "flip" and len(one["components"]) == 96)

    assert verdict(check, given).startswith("proved: flip of a cycle of period 96 in lam: ")


LIMACON = document("limacon-48")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "answer"),
    [
        ({}, "proved: flip of a cycle of period 48 in lam: polar 3*cos(theta)/5 + 1 = 0.73304507687465284564"),
        (moved(LIMACON, 0, Fraction(1, 2)), "proved: "),
        (moved(LIMACON, 0, 2), "not proved: exists, unique"),
        (moved(LIMACON, -1, Fraction(1, 2)), "proved: "),
        (moved(LIMACON, -1, -2), "not proved: exists, unique"),
        ({"radius": ["1", "-8"]}, "not proved: exists, unique"),
        ({"radius": ["1", "-300"]}, "not proved: exists, unique"),
        ({"digits": 60}, "not proved: precise"),
    ],
)
def test_a_cycle_of_48_bounces_is_proved_in_a_box_that_holds_it(check, change, answer):
    assert verdict(check, LIMACON | change).startswith(answer)


def test_a_flip_is_no_fold(check):
    """The same box, with a name and a statement that claim the other multiplier."""
    text = json.dumps(document("limacon-48")).replace("flip of", "fold of").replace('"flip"', '"fold"')
    text = text.replace("the multiplier -1: a flip", "the multiplier 1: a fold")

    assert verdict(check, json.loads(text)).startswith("not proved: exists, unique")


def cyclic(dice: Random, n: int) -> list[dict[int, Fraction]]:
    """A cyclic tridiagonal system with an additional last column and row, as bordered systems have."""
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
    """`x[k+1] = F(x[k]) - d*x[k-1]` at 0, with slopes of F for the multipliers -1 or 1, and -d or d.

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
    """On the axis of a disc in a disc: from one end of it to a bounce on the inner disc, and on to the other end."""
    outer = {"x": "5*cos(theta)", "y": "5*sin(theta)", "from": "-pi", "to": "pi"}
    disc = {"x": "cos(theta)", "y": "-sin(theta)", "from": "-pi", "to": "pi"}
    table, lam, _ = check.read_scene({"component": [outer, disc], "lam": "1/3"}, "", 128)
    at = [check.pi(128) if text == "pi" else check.I.of(0, 128) for text in bounces]
    cycle = check.beside("long").Long(table, "cycle", [0, 1, 0], at, 1, "", None, lam)
    cycle.free = False
    with pytest.raises(check.Unproved, match="may not leave or arrive inwards"):
        cycle.chords(at, lam, 1)


P = 100


def cycle(check, long, parts, sign=1, twist=1):
    made = long.Long.__new__(long.Long)
    made.p, made.parts, made.sign, made.twist = P, parts, sign, twist
    return made


def jets(check, dice, n, degree):
    """Pairs of polynomials with fractional coefficients, for each chord of a round and the first of the next."""
    count = len(check.algebra(degree)[0])
    told = [[[Fraction(dice.randrange(-8, 9), 4) for _ in range(count)] for _ in range(2)] for _ in range(n + 1)]
    return told, [[check.Jet([number(check, x) for x in c], degree) for c in pair] for pair in told]


def later(bounces, sign):
    return [*bounces, *(x * sign for x in bounces[:2])]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("twist", [1, -1])
@pytest.mark.parametrize("n", [2, 3])
def test_how_the_linear_rule_moves_between_two_vectors_is_minus_its_second_derivative(check, long, n, twist, sign):
    """`-u * d/dx (dR * w)` of quadratic polynomials, exactly, for each bounce and for the letter."""
    dice = Random(7 * n + twist)
    told, chords = jets(check, dice, n, 2)
    made = cycle(check, long, [0] * n, sign, twist)
    w, u = ([Fraction(dice.randrange(-4, 5), 2) for _ in range(n)] for _ in range(2))
    found = made.moving(chords, [number(check, x) for x in w], [number(check, x) for x in u])
    at, wide = check.algebra(2)[1], later(w, sign * twist)

    def slope(moved):
        """The linearised rule at a place, between u and w."""
        ends, letter, total = later(moved[:n], sign), moved[n], Fraction(0)
        for k in range(1, n + 1):
            for c, first, by in ((told[k][0], k, 1), (told[k - 1][1], k - 1, -1)):
                (x, y), (a, b) = ends[first : first + 2], wide[first : first + 2]
                q = {e: c[at[e]] for e in at}
                here = q[1, 0, 0] + 2 * q[2, 0, 0] * x + q[1, 1, 0] * y + q[1, 0, 1] * letter
                there = q[0, 1, 0] + 2 * q[0, 2, 0] * y + q[1, 1, 0] * x + q[0, 1, 1] * letter
                total += u[k - 1] * by * (here * a + there * b)
        return total

    for column in range(n + 1):
        unit = [int(k == column) for k in range(n + 1)]
        assert holds(check.I.of(found.get(column, 0), P), slope([0] * (n + 1)) - slope(unit), 64)
    assert set(found) <= set(range(n + 1))
