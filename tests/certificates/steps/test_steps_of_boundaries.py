"""What the second reader sees in formulas of one's own: parity, periods, fractions, joins, and where a radius ends."""

import ast
from fractions import Fraction
from types import SimpleNamespace

import pytest

P = 80


@pytest.fixture(scope="module")
def boundaries(check):
    return check.beside("boundaries")


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("3", 1), ("b", 1), ("pi", 1), ("theta", -1), ("eta", -1), ("-theta", -1), ("-b", 1), ("+theta", -1),
        *((f"{name}(theta)", -1) for name in ("sin", "tan", "sinh", "tanh", "atan")),
        *((f"{name}(theta)", 1) for name in ("cos", "cosh", "abs", "Abs")),
        *((f"{name}(theta + 1)", 0) for name in ("sin", "tan", "cos", "cosh", "abs", "exp")),
        *((f"{name}(theta**2)", 1) for name in ("sin", "atan", "cos", "abs", "exp", "sqrt", "log")),
        *((f"{name}(theta)", 0) for name in ("exp", "sqrt", "log")),
        ("theta + eta", -1), ("theta - eta", -1), ("theta*eta", 1), ("theta/eta", 1), ("theta*b", -1), ("b/theta", -1),
        ("theta + b", 0), ("b - theta", 0), ("b + theta**2", 1), ("(theta + 1)*theta", 0), ("theta/(theta + 1)", 0),
        ("theta**0", 1), ("theta**1", -1), ("theta**2", 1), ("theta**3", -1), ("theta**(-1)", -1), ("theta**(-2)", 1),
        ("(theta + 1)**2", 0), ("(theta + 1)**0", 1), ("(theta**2)**3", 1), ("theta**(1/2)", 0), ("theta**(4/2)", 1),
        ("cos(theta)**(1/3)", 1), ("b**theta", 0), ("b**cos(theta)", 1), ("theta**cos(theta)", 0), ("theta**b", 0),
        ("cos(theta)**b", 1), ("b**theta**2", 1), ("theta**(b - b + 2)", 1), ("2**(theta*eta)", 1),
        ("cos(theta)**theta", 0),
    ],
)  # fmt: skip
def test_a_formula_is_even_odd_or_neither_by_its_nodes(check, boundaries, text, sign):
    assert boundaries.parity(check.parse(text)) == sign


@pytest.mark.parametrize(
    ("parts", "law", "which", "wanted"),
    [
        ([("cos(theta)", "-pi", "pi")], None, [0], True),
        ([("sin(theta)", "-pi", "pi")], None, [0], False),
        ([("1 + theta", "-pi", "pi")], None, [0], False),
        ([("cos(theta)", "sin(theta)", "0", "theta")], None, [0], True),
        ([("cos(theta)", "cos(theta)", "0", "1")], None, [0], False),
        ([("sin(theta)", "sin(theta)", "0", "1")], None, [0], False),
        ([("sin(theta)", "cos(theta)", "0", "1")], None, [0], False),
        ([("1", "-1", "1"), ("theta", "0", "1")], None, [0, 0], True),
        ([("1", "-1", "1"), ("theta", "0", "1")], None, [0, 1], False),
        ([("theta", "0", "1"), ("1", "theta", "0", "1")], None, [1], True),
        ([("1", "0", "1")], "-lam*eta", [0], True),
        ([("1", "0", "1")], "eta**3 + theta", [0], True),
        ([("1", "0", "1")], "eta**2", [0], False),
        ([("1", "0", "1")], "eta + 1", [0], False),
        ([("theta", "0", "1")], "-lam*eta", [0], False),
    ],
)
def test_a_component_is_its_own_mirror_image_where_radius_or_x_is_even_and_y_and_law_are_odd(
    check, boundaries, parts, law, which, wanted
):
    table = SimpleNamespace(
        parts=[[check.parse(text) for text in part] for part in parts], law=law and check.parse(law)
    )
    assert boundaries.symmetric(table, which) is wanted


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("3", {"": 3}), ("pi", {"pi": 1}), ("-theta", {"theta": -1}), ("+theta", {"theta": 1}), ("-3", {"": -3}),
        ("pi/2 + 1/3", {"pi": Fraction(1, 2), "": Fraction(1, 3)}), ("2*theta - b", {"theta": 2, "b": -1}),
        ("theta*2", {"theta": 2}), ("2*3", {"": 6}), ("(theta + 1)*2", {"theta": 2, "": 2}),
        ("5/3", {"": Fraction(5, 3)}),
        ("2*(theta - pi/3)", {"theta": 2, "pi": Fraction(-2, 3)}), ("theta - theta", {}), ("(2 - 3)*pi", {"pi": -1}),
        ("theta*pi", None), ("pi/theta", None), ("theta**2", None), ("sin(theta)", None), ("theta + sin(1)", None),
        ("cos(1)*2", None), ("1/pi", None), ("-sin(1)", None), ("cos(1)/2", None), ("2/cos(1)", None), ("2**2", None),
        ("sin(1) - pi", None), ("b*theta", None), ("(theta + 1)*(pi + 1)", None), ("theta/(1 + b)", None),
    ],
)  # fmt: skip
def test_a_sum_of_letters_times_fractions_has_these_coefficients(check, boundaries, text, wanted):
    found = boundaries.linear(check.parse(text))
    assert found == wanted if wanted else not found
    assert (found is None) == (wanted is None)


def test_a_sum_of_coefficients_has_no_zeros(boundaries):
    assert boundaries.plus({"a": 1, "b": 2}, {"a": 1, "c": 3}, -1) == {"b": 2, "c": -3}
    assert boundaries.plus({"a": 1, "b": 2}, {"a": -1, "c": 3}, 1) == {"b": 2, "c": 3}


@pytest.mark.parametrize(
    ("text", "has", "slope"),
    [
        ("3", False, 0), ("sin(b)", False, 0), ("theta", True, 1), ("-theta", True, -1), ("theta*3", True, 3),
        ("theta + sin(b)", True, 1), ("sin(b) - 2*theta", True, -2), ("b - (theta - pi)*3", True, -3),
        ("theta/2", True, Fraction(1, 2)),
        ("theta - theta", True, 0), ("2*theta + 3*theta", True, 5), ("theta - 4*theta", True, -3),
        ("sin(theta)", True, None), ("theta*b", True, None), ("b + theta**2", True, None),
        ("theta**2 - theta", True, None),
        ("theta - cos(theta)", True, None), ("b/theta", True, None), ("-sin(theta)", True, None),
    ],
)  # fmt: skip
def test_the_place_has_a_fraction_for_its_coefficient_or_none_is_known(check, boundaries, text, has, slope):
    node = check.parse(text)
    assert boundaries.has_theta(node) is has
    assert boundaries.slope(node) == slope
    assert (boundaries.slope(node) is None) == (slope is None)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("3", True), ("b + pi", True), ("sin(theta)", True), ("cos(2*theta + b)", True), ("tan(theta - 1)", True),
        ("sin(0*theta)", True), ("exp(sin(theta))*b", True), ("-cos(theta)**3/(2 + sin(theta))", True),
        ("sin(theta) + theta", False), ("theta*sin(theta)", False), ("exp(theta)", False), ("sinh(theta)", False),
        ("sin(theta/2)", False), ("sin(theta**2)", False), ("sin(sin(theta))", True), ("cos(theta*b)", False),
        ("sin(b)", True), ("b**theta", False), ("sqrt(2 + cos(theta))", True), ("sin(cos(theta)/3)", True),
        ("-theta", False),
    ],
)  # fmt: skip
def test_a_formula_has_the_period_where_the_place_stands_in_waves_of_whole_numbers_alone(
    check, boundaries, text, wanted
):
    assert boundaries.periodic(check.parse(text)) is wanted


@pytest.mark.parametrize(
    ("part", "wanted"),
    [
        (("1", "-pi", "pi"), True), (("cos(theta)", "sin(theta)", "0", "2*pi"), True), (("1", "b", "b + 2*pi"), True),
        (("theta", "-pi", "pi"), False), (("cos(theta)", "theta", "-pi", "pi"), False), (("1", "pi", "-pi"), False),
        (("1", "0", "pi"), False), (("1", "0", "2*pi + 1/10**9"), False), (("1", "sin(1)", "sin(1) + 2*pi"), False),
        (("1", "0", "sin(1)"), False), (("1", "b", "2*pi"), False), (("theta", "cos(theta)", "-pi", "pi"), False),
    ],
)  # fmt: skip
def test_a_part_comes_round_by_its_formulas_and_its_ends(check, boundaries, part, wanted):
    assert boundaries.closed([check.parse(text) for text in part]) is wanted


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("3", 3), ("b", Fraction(2, 7)), ("-b", Fraction(-2, 7)), ("+b", Fraction(2, 7)), ("b + 1", Fraction(9, 7)),
        ("b - 1", Fraction(-5, 7)), ("1 - b", Fraction(5, 7)), ("b*3", Fraction(6, 7)), ("b/2", Fraction(1, 7)),
        ("2/b", 7), ("b**2", Fraction(4, 49)), ("2**b", None), ("b**(-2)", Fraction(49, 4)), ("b**0", 1), ("0**2", 0),
        ("0**0", None), ("0**(-1)", None), ("1/0", None), ("b/(b - b)", None), ("pi", None), ("pi + 1", None),
        ("sin(b)", None),
        ("1 + sin(b)", None), ("b // 2", None), ("2**100000", 2**100000), ("2**500000", None), ("2**(-500000)", None),
        ("2**(b*7)", 4), ("c*b", None), ("-pi", None), ("(-1)**3", -1), ("0**1", 0), ("1**499999", 1),
        ("1**500000", None),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)  # fmt: skip
def test_a_formula_of_fractions_has_its_exact_value_and_another_none(check, boundaries, text, wanted):
    assert boundaries.fraction(check.parse(text), {"b": Fraction(2, 7)}) == wanted
    if wanted is not None:
        assert boundaries.number(check.parse(text), {"b": Fraction(2, 7)}, P) == wanted


def test_what_is_no_fraction_is_enclosed(check, boundaries):
    found = boundaries.number(check.parse("pi*b + c"), {"b": Fraction(1, 3), "c": check.I.of(Fraction(1, 7), P)}, P)
    assert isinstance(found, check.I)
    assert found.real() == pytest.approx(1.1900546940537405, abs=1e-15)
    assert found.width() < 8
    assert boundaries.number(check.parse("b + 1"), {"b": Fraction(1, 3), "c": check.I.of(0, P)}, P) == Fraction(4, 3)


def test_parameters_are_looked_at_nine_times_from_end_to_end_of_a_range(boundaries):
    assert boundaries.settings({}, P) == [{}]
    assert boundaries.settings({"shape": {"a": "3/2", "b": "-1"}}, P) == [{"a": Fraction(3, 2), "b": -1}]
    found = boundaries.settings({"shape": {"a": "3/2", "b": "-1..3"}}, P)
    assert found == [{"a": Fraction(3, 2), "b": Fraction(k, 2) - 1} for k in range(9)]


def test_pieces_have_their_formulas_and_their_ends_and_are_called(boundaries):
    assert boundaries.pieces("polar", "R") == [["R", "-pi", "pi"]]
    assert boundaries.pieces("parametric", ["X", "Y"]) == [["X", "Y", "-pi", "pi"]]
    said = [{"x": "X", "y": "Y", "from": "A", "to": "B", "name": "n"}, {"x": "U", "y": "V", "from": "C", "to": "D"}]
    assert boundaries.pieces("component", said) == [["X", "Y", "A", "B"], ["U", "V", "C", "D"]]
    assert boundaries.called_by("component", said) == "boundary of 2 pieces"
    assert boundaries.called_by("polar", "R") == "polar R"
    assert boundaries.called_by("parametric", ["X", "Y"]) == "parametric X; Y"


def line(a, b, c, d, low="0", high="1"):
    """A piece from one point to another."""
    return f"{a} + ({c} - ({a}))*theta", f"{b} + ({d} - ({b}))*theta", low, high


TRIANGLE = [line(0, 0, 1, 0), line(1, 0, 0, 1), line(0, 1, 0, 0)]
AWAY = [line(5, 5, 6, 5), line(6, 5, 5, 5)]
DISC = [("5 + cos(theta)", "sin(theta)", "-pi", "pi")]


@pytest.mark.parametrize(
    ("parts", "shape", "wanted"),
    [
        (TRIANGLE, {}, [(0, 3)]),
        (TRIANGLE + AWAY, {}, [(0, 3), (3, 5)]),
        (DISC + TRIANGLE + DISC, {}, [(0, 1), (1, 4), (4, 5)]),
        (DISC, {}, [(0, 1)]),
        ([("theta - b", "0", "b", "1 + b"), *TRIANGLE[1:]], {"b": "0..4"}, [(0, 3)]),
        ([("theta + b*pi*E - b*E*pi", "0", "0", "1"), *TRIANGLE[1:]], {"b": "1"}, [(0, 3)]),
        (TRIANGLE[:2], {}, "piece 2 ends where no other begins"),
        (TRIANGLE[1:] + AWAY, {}, "piece 2 ends where no other begins"),
        (AWAY + TRIANGLE[:2], {}, "piece 4 ends where no other begins"),
        (TRIANGLE[::-1], {}, "piece 1 ends where no other begins"),
        ([TRIANGLE[0], line(1, "10**(-30)", 0, 1), TRIANGLE[2]], {}, "piece 1 ends where no other begins"),
        ([*TRIANGLE[:2], line(0, 1, 0, 0, "1", "0")], {}, "piece 3 does not run forward"),
        ([*TRIANGLE[:2], line(0, 1, 0, 0, "1", "1")], {}, "piece 3 does not run forward"),
        ([line(0, "b", 1, 0), line(1, 0, 0, 1), line(0, 1, 0, "b")], {"b": "0..1/4"}, [(0, 3)]),
        ([line(0, "b", 1, 0), line(1, 0, 0, 1), line(0, 1, 0, "b**2")], {"b": "0..1"}, "piece 3 ends where no other"),
        ([line(0, "b", 1, 0), line(1, 0, 0, 1), line(0, 1, 0, "b**2")], {"b": "1"}, [(0, 3)]),
        ([line(0, "c", 1, 0), *TRIANGLE[1:]], {"b": "1"}, "piece 1 has a letter without a number"),
        ([*TRIANGLE[:2], line(0, 1, 0, "c")], {"b": "1"}, "piece 3 has a letter without a number"),
        ([("theta - 1", "0", "1", "1 + b"), line("b", 0, 0, 1), TRIANGLE[2]], {"b": "1..2"}, [(0, 3)]),
        ([("theta - 1", "0", "1", "1 + b"), line("b", 0, 0, 1),
        TRIANGLE[2]], {"b": "0..2"}, "piece 1 does not run forward"),
        ([("theta - 1", "0", "1", "1 + b"), line("b", 0, 0, 1),
        TRIANGLE[2]], {"b": "-1/9"}, "piece 1 does not run forward"),
        ([("theta", "0", "0", "(b - 1/16)**2"), line("(b - 1/16)**2", 0, 0, 1),
        TRIANGLE[2]], {"b": "0..1"}, "piece 1 does not"),
    ],
)  # fmt: skip
def test_pieces_are_chained_to_curves_that_come_back_to_where_they_began(check, boundaries, parts, shape, wanted):
    table = SimpleNamespace(p=P, parts=[[check.parse(text) for text in part] for part in parts])
    if isinstance(wanted, list):
        found = boundaries.joined(table, {"shape": shape} if shape else {})
        assert found == [range(*pair) for pair in wanted]
    else:
        with pytest.raises(check.Wrong, match=wanted):
            boundaries.joined(table, {"shape": shape})


def test_the_tips_of_a_piece_and_whether_two_are_the_same(check, boundaries):
    part = [check.parse(text) for text in ("1 + theta", "-1", "2")]
    (x, y), names = boundaries.tip(part, part[1], {}, P), {"b": Fraction(1, 3)}
    assert max((x * x).size().hi, (y * y).size().hi) == 0  # the radius is 0 at -1
    pair = [check.parse(text) for text in ("theta*b", "b - theta", "-1", "b/2")]
    assert boundaries.tip(pair, pair[2], names, P) == [Fraction(-1, 3), Fraction(4, 3)]
    assert boundaries.tip(pair, pair[3], names, P) == [Fraction(1, 18), Fraction(1, 6)]
    one, near, pi = Fraction(1), check.I.of(1, P).wide(check.I(1, 1, P)), check.pi(P)
    cases = (([one, one], [one, one], True), ([one, one], [one, 1 + Fraction(1, 10**90)], False),
             ([one, 0], [1, one], False),
             ([one, one], [near, one], True), ([one, near], [one, near + 1], False), ([one, pi], [one, pi], True),
             ([0, one], [near, one], False))  # fmt: skip
    for a, b, wanted in cases:
        assert boundaries.meet(a, b, P) is boundaries.meet(b, a, P) is wanted


@pytest.mark.parametrize(
    ("radius", "most"),
    [
        ("1", 1),
        ("b", 1),
        ("cos(theta) + 2", 1),
        ("1 - cos(theta)*99/100", 40),
        ("sqrt(cos(theta) + 101/100)", 60),
        ("theta**2 + 1/50", 40),
        ("1/(theta**2 - theta + 1)", 40),
        ("theta**2 - theta + 1", 40),
        ("theta**2 + theta + 1", 40),
        ("1/18446744073709551616", 1),
    ],
)
def test_a_positive_radius_is_seen_to_be_positive_on_few_pieces(check, boundaries, monkeypatch, radius, most):
    looked, real = [], boundaries.evaluate
    monkeypatch.setattr(boundaries, "evaluate", lambda *given: looked.append(given[1]["theta"]) or real(*given))
    boundaries.positive(SimpleNamespace(letters={"b": check.I.of(Fraction(1, 9), 64)}, parts=[[check.parse(radius)]]))
    assert len(looked) <= most
    pieces = sorted((x.lo / 2**64, x.hi / 2**64) for x in looked)
    last = [x for x in pieces if not any(x != y and x[0] - 1e-9 < y[0] and y[1] < x[1] + 1e-9 for y in pieces)]
    wanted = [-3.141592653589793, *(low for low, _ in last[1:]), 3.141592653589793]  # where the pieces before end
    assert [last[0][0], *(high for _, high in last)] == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(
    "radius",
    ["-1", "0", "b", "theta", "cos(theta) + 1", "theta**2", "(theta - pi)**2", "(theta + pi)**2", "pi - theta"],
)
def test_a_radius_that_is_0_somewhere_or_below_is_refused(check, boundaries, radius):
    near = check.I.of(0, 64).wide(check.I.of(Fraction(1, 9), 64))
    with pytest.raises(check.Wrong, match="radius may not be positive"):
        boundaries.positive(SimpleNamespace(letters={"b": near}, parts=[[check.parse(radius)]]))


@pytest.mark.parametrize("radius", ["-1", "0", "-2**(-64)", "-theta**2/10**9 - 1"])
def test_a_radius_that_is_positive_nowhere_is_refused_at_once(check, boundaries, monkeypatch, radius):
    looked, real = [], boundaries.evaluate
    monkeypatch.setattr(boundaries, "evaluate", lambda *given: looked.append(given) or real(*given))
    with pytest.raises(check.Wrong, match="radius may not be positive"):
        boundaries.positive(SimpleNamespace(letters={}, parts=[[check.parse(radius)]]))
    assert len(looked) == 1


@pytest.mark.parametrize(
    ("mark", "wanted"),
    [
        ({}, (1, 0.5)), ({"component": 0, "theta": "pi*b"}, (0, 3.141592653589793 / 9)), ({"component": 2}, None),
        ({"component": -1}, None), ({"component": True}, None), ({"component": 1.0}, None), ({"more": 1}, None),
    ],
)  # fmt: skip
def test_a_marked_point_is_a_place_on_a_component_there_is(check, boundaries, mark, wanted):
    table = SimpleNamespace(parts=[0, 0], letters={"b": check.I.of(Fraction(1, 9), P)}, p=P)
    given = {"name": "m", "component": 1, "theta": "1/2"} | mark
    if wanted:
        part, at = boundaries.marked(table, given)
        assert (part, at.real()) == (wanted[0], pytest.approx(wanted[1], abs=1e-15))
        assert at.p == P
    else:
        with pytest.raises(check.Wrong, match="an undefined point is not understood"):
            boundaries.marked(table, given)


SQUARE = [
    {"x": x, "y": y, "from": low, "to": high}
    for x, y, low, high in [line(0, 0, 1, 0), line(1, 0, 1, 1), line(1, 1, 0, 1), line(0, 1, 0, 0)]
]
MARK = {"name": "m", "component": 0, "theta": "1"}


@pytest.mark.parametrize(
    ("way", "scene", "law", "wanted"),
    [
        ("table", {"table": "circle"}, None, ([True], [], 0)),
        ("table", {"table": "circle"}, "-lam*eta*sin(theta)", ([True], [], 0)),
        ("table", {"table": "circle"}, "-lam*eta*theta", ([False], [], 0)),
        ("polar", {"polar": "2 + cos(theta)"}, None, ([True], [], 1)),
        ("polar", {"polar": "2 + cos(theta)"}, "-lam*eta*theta", ([False], [], 1)),
        ("polar", {"polar": "cos(theta)", "undefined": [MARK]}, None, ([True], [0], 1)),
        ("polar", {"polar": "cos(theta)"}, None, "radius may not be positive"),
        ("parametric", {"parametric": ["cos(theta)", "sin(theta)"]}, None, ([True], [], 1)),
        ("component", {"component": SQUARE, "undefined": [MARK, MARK | {"component": 2}]}, None,
         ([False] * 4, [0, 2], 1)),
        ("component", {"component": SQUARE[1:]}, None, "not closed"),
        ("table", {"table": "circle"}, "-lam*eta + s", "arc length"),
        ("table", {"table": "circle"}, "-lam*eta + sin(s)", "arc length"),
    ],
)  # fmt: skip
def test_a_table_of_ones_own_has_its_curves_marks_and_turns(check, boundaries, way, scene, law, wanted):
    parts = boundaries.pieces(way, scene[way]) if way != "table" else check.PAPER["circle"][1]
    table = check.Table(parts, {}, law, P)
    if isinstance(wanted, str):
        with pytest.raises(check.Wrong, match=wanted):
            boundaries.own(table, way, scene)
    else:
        boundaries.own(table, way, scene)
        assert (table.closed, [part for part, _ in table.marks], len(table.turns)) == wanted
        if way != "table":
            assert table.curves == [range(len(table.parts))]
    assert isinstance(table.parts[0][0], ast.expr)
