"""Tables and laws of one's own: what the package proves, the second reader proves, and a wrong reader does not."""

import copy
import json
from fractions import Fraction
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "certificates"
OWN = (
    *("law-in-all-words", "radius-in-words", "free-parameter", "marked-point", "own-mirror"),
    *("spline", "scatterer", "moved-waves", "law-parameter"),
)
WORDS = ("exp", "log", "tan", "atan", "sinh", "cosh", "tanh")


def document(name: str) -> dict:
    return json.loads((FOLDER / f"{name}.json").read_text())


def said(check, given: dict) -> str:
    """The verdict, as `main` prints it."""
    try:
        return check.checked(given)
    except check.Unproved as why:
        return f"not proved: {why}"
    except check.Wrong as why:
        return f"refused: {why}"


def replaced(given: dict, **scene: object) -> dict:
    return copy.deepcopy(given) | {"scene": given["scene"] | scene}


@pytest.mark.parametrize("name", OWN)
def test_what_the_package_proves_of_such_a_table_the_second_reader_proves(check, name):
    assert said(check, document(name)).startswith("proved: ")


def test_the_same_law_and_the_same_marked_point_are_written_again(make):
    for name in ("law-in-all-words", "marked-point", "spline"):
        assert make.text(name) == (FOLDER / f"{name}.json").read_text()


@pytest.mark.parametrize("word", [*WORDS, "sqrt", "**"])
def test_a_reader_with_one_wrong_word_proves_nothing(check, monkeypatch, word):
    """Off by a part in 10**12: the orbit is then another one."""
    formulas, given = check.beside("formulas"), document("law-in-all-words")
    right, power, off = formulas.called, formulas.power, 1 + Fraction(1, 10**12)
    wrong = lambda *all_of: [part * off for part in power(*all_of)]  # noqa: E731
    named = lambda name, *rest: [part * (off if name == word else 1) for part in right(name, *rest)]  # noqa: E731
    law = given["scene"]["law"]

    assert f"{word}(" in law
    monkeypatch.setattr(formulas, "power", wrong) if word == "**" else monkeypatch.setattr(formulas, "called", named)
    assert said(check, given).startswith("not proved: exists")


def test_only_whole_powers_of_fractions_are_taken_for_fractions(check):
    """A root is enclosed; of what is no power at all nothing is a fraction."""
    boundaries = check.beside("boundaries")
    assert boundaries.fraction(check.parse("(2/3)**(-2)"), {}) == Fraction(9, 4)
    for text in ("2**(1/2)", "4**(1/2)", "0**(-1)", "7//2"):
        assert boundaries.fraction(check.parse(text), {}) is None
    root = boundaries.number(check.parse("2**(1/2)"), {}, 100)
    assert (root * root - 2).size().hi < 2**10


@pytest.mark.parametrize(("middle", "known"), [(1, True), (-1, True), (0, False), (Fraction(1, 20), False)])
def test_a_modulus_has_a_slope_where_it_is_not_0_and_none_elsewhere(check, middle, known):
    """Of a number with its derivatives, as a law is differentiated."""
    at = check.I.of(Fraction(middle), 100).wide(check.I.of(Fraction(1, 10), 100))
    jet = check.Jet.of(at, 1, 0)
    if known:
        slope = check.evaluate(check.parse("abs(u)"), {"u": jet}, 100)[0].gradient(100)[0]
        assert (slope - (1 if middle > 0 else -1)).size().hi == 0
    else:
        with pytest.raises(check.Unproved, match="a modulus has no slope"):
            check.evaluate(check.parse("abs(u)"), {"u": jet}, 100)


@pytest.mark.parametrize(
    ("name", "scene", "answer"),
    [
        (
            "marked-point",
            {"undefined": [{"name": "m", "component": 0, "theta": "0"}]},
            "not proved: admissible: the map",
        ),
        (
            "marked-point",
            {"undefined": [{"name": "m", "component": 0, "theta": "2*pi"}]},
            "not proved: admissible: the",
        ),
        ("marked-point", {"undefined": [{"name": "m", "component": 1, "theta": "1"}]}, "refused: scene: an undefined"),
        ("marked-point", {"undefined": [{"name": "m", "theta": "1"}]}, "refused: scene: an undefined"),
        ("free-parameter", {"shape": {"b": "0..1/20"}}, "refused: b is not in its range"),
        ("free-parameter", {"shape": {"b": "1/10"}}, "refused: scene: the table has other letters"),
        ("free-parameter", {"shape": {"c": "0..1/10"}}, "refused: scene: the table has other letters"),
        ("free-parameter", {"shape": {"b": "0..2"}}, "refused: scene: the radius"),
        ("own-mirror", {"polar": "2*cos(3*theta)/25 + sin(theta)/10**40 + 1"}, "refused: scene, components"),
        ("own-mirror", {"law": "-lam*eta + eta**2/10**40"}, "refused: scene, components"),
        ("radius-in-words", {"polar": "log(cos(2*theta)) + 2"}, "refused: scene: the radius"),
        ("radius-in-words", {"polar": "2 + exp(theta)"}, "refused: scene: the boundary is not closed"),
    ],
)
def test_another_scene_is_not_proved(check, name, scene, answer):
    assert said(check, replaced(document(name), **scene)).startswith(answer)


def turned(given: dict, piece: int, **entries: str) -> dict:
    """The document with entries of one piece replaced; the statement does not say them."""
    again = copy.deepcopy(given)
    again["scene"]["component"][piece] |= entries
    return again


@pytest.mark.parametrize(
    ("name", "piece", "entries", "item"),
    [
        ("scatterer", 0, {"y": "-1/2 - theta/10**60"}, "the boundary is not closed: piece 1 "),
        ("scatterer", 1, {"from": "1/10**60"}, "the boundary is not closed: piece 1 "),
        ("scatterer", 2, {"x": "1/2 - theta - theta*(1 - theta)/2"}, ""),  # between its ends a piece is as it likes
        ("scatterer", 0, {"from": "1", "to": "0", "x": "1/2 - theta"}, "piece 1 does not run forward"),
        ("scatterer", 0, {"from": "5", "to": "1"}, "piece 1 does not run forward"),
        ("scatterer", 0, {"to": "0"}, "piece 1 does not run forward"),
        ("scatterer", 4, {"to": "pi - 10**(-20)"}, "the boundary is not closed: piece 5 "),
        ("scatterer", 4, {"y": "-sin(theta)/4 + theta/10**20"}, "the boundary is not closed: piece 5 "),
        ("scatterer", 1, {"x": "1/2 + b"}, "piece 2 has a letter without a number"),
    ],
)
def test_pieces_join_and_run_forward_or_are_no_boundary(check, name, piece, entries, item):
    """The cycle itself is on other pieces, and its chords are free of these."""
    answer = said(check, turned(document(name), piece, **entries))

    assert answer.startswith(f"refused: scene: {item}" if item else "proved: ")


@pytest.mark.parametrize("piece", range(9))
def test_a_gap_in_a_spline_is_seen_at_every_join(check, piece):
    given = document("spline")
    moved = given["scene"]["component"][piece]["x"] + " + 1/10**80"

    assert "the boundary is not closed" in said(check, turned(given, piece, x=moved))


SIDES = [("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta")]


@pytest.mark.parametrize(
    ("bottom", "shape", "closed"),
    [
        ("sqrt(b)**2*theta*(1 - theta)", {"b": "1/3"}, True),
        ("sqrt(b)*theta", {"b": "1/10**30"}, False),
        ("b*theta*(1 - theta)", {"b": "0..1/4"}, True),
        ("b*theta", {"b": "0..1/4"}, False),
        ("b*(1/4 - b)*theta", {"b": "0..1/4"}, False),  # closed where the range begins and where it ends
        ("tan(theta - 1) + tan(1)*(1 - theta)", {}, True),
        ("cosh(theta) - 1", {}, False),
    ],
)
def test_joins_are_looked_at_for_numbers_and_over_the_range_of_a_free_parameter(check, bottom, shape, closed):
    pieces = [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in [(SIDES[0][0], bottom), *SIDES[1:]]]
    free = "b" if ".." in shape.get("b", "") else ""
    read = lambda: check.read_scene({"component": pieces, "shape": shape, "lam": "1/3"}, free, 144)  # noqa: E731

    if closed:
        assert read()[0].closed == [False] * 4
    else:
        with pytest.raises(check.Wrong, match="the boundary is not closed: piece 1 "):
            read()


def test_ends_that_move_with_a_parameter_stay_in_order_over_its_range(check):
    pieces = [{"x": "theta - b", "y": "0", "from": "b", "to": "b + 1"}]
    pieces += [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in SIDES[1:]]
    scene = {"component": pieces, "shape": {"b": "0..2"}, "lam": "1/3"}

    check.read_scene(scene, "b", 144)
    pieces[0] |= {"x": "theta/(2 - b)", "from": "0", "to": "2 - b"}  # at the end of the range of no length
    with pytest.raises(check.Wrong, match="piece 1 does not run forward"):
        check.read_scene(scene, "b", 144)


def test_a_letter_of_the_law_alone_is_none_of_the_table(check):
    """A radius with a mark is not asked to be positive, and would be read with the law's parameter for its own."""
    scene = {"polar": "1 + b*cos(5*theta)", "law": "-b*eta", "lam": "1/3"}
    scene["undefined"] = [{"name": "m", "component": 0, "theta": "1"}]

    with pytest.raises(check.Wrong, match="piece 1 has a letter without a number or a range"):
        check.read_scene(scene, "b", 144)
    check.read_scene(scene | {"polar": "1 + cos(5*theta)/40"}, "b", 144)


def test_a_parameter_with_a_number_is_not_free(check):
    """Both would be said of one parameter: that it is 1/10, and that it lies in the box."""
    given = document("alpha-tilde")
    given["scene"]["shape"] = {"alpha": "1/10"}
    given["statement"] = given["statement"].replace("egg,", "egg, alpha = 1/10,")

    assert said(check, given).startswith("refused: scene: the table has other letters")


def test_the_free_parameter_of_a_family_is_that_of_the_paper_under_another_name(check):
    """The flip of the egg's diameters, once by the paper's name and once by a formula."""
    lines = [check.checked(document(name)).splitlines()[0] for name in ("free-parameter", "alpha-tilde")]

    assert lines[0].rpartition(" = ")[2] == lines[1].rpartition(" = ")[2]
    assert lines[0] != lines[1]


@pytest.mark.parametrize(
    ("formula", "sign"),
    [
        ("cos(theta)", 1),
        ("sin(3*theta) + theta*exp(theta**2)", -1),
        ("theta**3/cosh(theta) - tanh(2*sin(theta))", -1),
        ("log(2 + cos(theta)) + sqrt(theta**2 + b)", 1),
        ("exp(theta)", 0),
        ("theta + 1", 0),
        ("abs(theta)", 1),
        ("-theta**2", 1),
        ("theta**(1/3)", 0),
        ("eta*lam*cos(theta)", -1),
        ("sin(theta)**(-2)", 1),
        ("sin(theta)**(-3)", -1),
    ],
)
def test_the_symmetry_of_a_formula_is_known_or_none(check, formula, sign):
    assert check.beside("boundaries").parity(check.parse(formula)) == sign


@pytest.mark.parametrize(
    ("formula", "known"),
    [
        ("cos(3*theta + 1/2)/20 + 1", True),
        ("tan(2*(theta - pi/5))**2 + exp(sin(-theta))", True),
        ("sin(theta + sqrt(2))", True),
        ("sin(theta/2)**2", False),  # has the period, which is not seen
        ("cos(pi*theta)", False),
        ("cos(theta**2)", False),
        ("cos(b*theta)", False),
        ("theta", False),
        ("theta - theta", False),
        ("exp(theta)", False),
    ],
)
def test_the_period_of_a_formula_is_known_or_not_used(check, formula, known):
    assert check.beside("boundaries").periodic(check.parse(formula)) == known


@pytest.mark.parametrize(
    ("ends", "known"),
    [
        (("-pi", "pi"), True),
        (("pi/2", "5*pi/2"), True),
        (("1/3", "2*pi + 1/3"), True),
        (("-pi", "pi - 10**(-40)"), False),
        (("0", "pi"), False),
        (("-pi", "3*pi"), False),
        (("0", "6.28318530717958647692528676655900576839"), False),
    ],
)
def test_a_curve_is_closed_when_its_ends_are_exactly_a_period_apart(check, ends, known):
    part = [check.parse(text) for text in ("cos(theta)/9", "-sin(theta)/9", *ends)]

    assert check.beside("boundaries").closed(part) == known


def test_a_law_that_knows_where_theta_began_is_read_between_the_ends_alone(check):
    """The same place of a closed curve has many parameters, and such a law another angle for each of them."""
    given = document("law-in-all-words")
    law = "-lam*eta*(1 + cos(3*theta)/100)"
    for formula, answer in ((law, "not proved: exists"), ("-lam*eta*(1 + theta/100)", "not proved: exists")):
        again = replaced(given, law=formula)
        for key in ("name", "statement"):
            again[key] = again[key].replace(given["scene"]["law"], formula)
        assert said(check, again).startswith(answer)  # another cycle
    table, *_ = check.read_scene(replaced(given, law=law)["scene"], "", 64)
    other, *_ = check.read_scene(replaced(given, law="-lam*eta*(1 + theta/100)")["scene"], "", 64)

    assert (table.closed, other.closed) == ([True], [False])


def test_what_only_the_package_reads_of_laws_is_refused_in_one_sentence(check):
    """Arc length in a law, even where a number of that name is given, and in the law of a tangency."""
    law = "-lam*eta*(1 + sin(s)/50)"
    length = "refused: scene: a law with s, arc length as an integral, is read by `pinball check` alone"
    touch = document("boundary-crisis")

    assert said(check, replaced(document("law-in-all-words"), law=law)) == length
    assert said(check, replaced(document("law-in-all-words"), law=law, shape={"alpha": "2/25", "s": "1"})) == length
    assert said(check, replaced(document("own-mirror"), law=law)) == length
    assert said(check, replaced(touch, law=law)) == length


DISC = {"name": "disc", "x": "cos(theta)", "y": "-sin(theta)", "from": "-pi", "to": "pi"}
OTHER = {"name": "other", "x": "4 - cos(theta)", "y": "sin(theta)", "from": "-pi", "to": "pi"}
ROUND = {"name": "round", "x": "2 + 5*cos(theta)", "y": "5*sin(theta)", "from": "-pi", "to": "pi"}


@pytest.mark.parametrize(
    ("curves", "answer"),
    [
        ([DISC, OTHER, ROUND], "proved"),
        ([DISC, OTHER, ROUND | {"y": "-5*sin(theta)"}], "not proved: admissible: the boundary does not run once round"),
        ([DISC, OTHER], "not proved: admissible: the boundary does not run once round"),
        ([DISC, OTHER, ROUND | {"x": "20 + 5*cos(theta)"}], "not proved: admissible: the boundary does not run once"),
        ([DISC, OTHER, ROUND, ROUND | {"y": "6*sin(theta)"}], "not proved: admissible: the boundary may cross itself"),
        ([DISC | {"y": "-7*sin(theta)"}, OTHER, ROUND], "not proved: admissible: two curves of the boundary may meet"),
        (
            [DISC, OTHER, ROUND, ROUND | {"x": "2 + 6*cos(theta)", "y": "6*sin(theta)"}],
            "not proved: admissible: the bound",
        ),
    ],
)
def test_a_cycle_between_two_discs_is_one_of_a_table_that_holds_them(check, curves, answer):
    """Clockwise discs are holes. With nothing round them, two curves, one elsewhere or across, they are no table."""
    given = document("scatterer") | {"components": [0, 1], "centre": [["0", "0"]] * 2, "radius": ["1", "-60"]}
    given |= {"digits": 15, "scene": {"component": curves, "lam": "1/3"}}
    for key in ("name", "statement"):
        given[key] = given[key].replace("5 pieces", f"{len(curves)} pieces")

    assert said(check, given).startswith(answer)


def test_a_number_below_the_last_place_of_an_interval_is_no_zero(check):
    """Of a spline's formula `1177...*theta**3/12978...`: at 64 bits the divisor's inverse has no digit."""
    large, theta = 10**28, check.I.of(Fraction(1, 2), 64)
    x = check.evaluate(check.parse(f"{large}*theta**3/{large}"), {"theta": theta}, 64)[0]

    assert Fraction(x.lo, 1 << 64) <= Fraction(1, 8) <= Fraction(x.hi, 1 << 64)
    assert x.width() < 8
