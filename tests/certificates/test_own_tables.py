"""User-defined tables and laws: both checkers prove the same, and a faulty checker does not."""

import copy
from fractions import Fraction

import pytest
from committed import document, verdict


def replaced(given: dict, **scene: object) -> dict:
    return copy.deepcopy(given) | {"scene": given["scene"] | scene}


def marked(theta: str, component: int = 0) -> dict:
    return {"undefined": [{"name": "m", "component": component, "theta": theta}]}


@pytest.mark.parametrize(
    ("name", "scene", "answer"),
    [
        ("marked-point", marked("0"), "not proved: admissible: the map"),
        ("marked-point", marked("2*pi"), "not proved: admissible: the"),
        ("marked-point", marked("1", component=1), "refused: scene: an undefined"),
        ("marked-point", {"undefined": [{"name": "m", "theta": "1"}]}, "refused: the file is not of its format"),
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
    assert verdict(check, replaced(document(name), **scene)).startswith(answer)


SIDES = [("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta")]


def test_ends_that_move_with_a_parameter_stay_in_order_over_its_range(check):
    pieces = [{"x": "theta - b", "y": "0", "from": "b", "to": "b + 1"}]
    pieces += [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in SIDES[1:]]
    scene = {"component": pieces, "shape": {"b": "0..2"}, "lam": "1/3"}

    check.read_scene(scene, "b", 144)
    pieces[0] |= {"x": "theta/(2 - b)", "from": "0", "to": "2 - b"}  # at the end of the range of no length
    with pytest.raises(check.Unproved, match="piece 1 does not run forward"):
        check.read_scene(scene, "b", 144)


def test_a_letter_of_the_law_alone_is_none_of_the_table(check):
    """A marked radius need not be positive, and could be read with the law's parameter as its own."""
    scene = {"polar": "1 + b*cos(5*theta)", "law": "-b*eta", "lam": "1/3"} | marked("1")

    with pytest.raises(check.Wrong, match="piece 1 has a letter without a number or a range"):
        check.read_scene(scene, "b", 144)
    check.read_scene(scene | {"polar": "1 + cos(5*theta)/40"}, "b", 144)


def test_a_parameter_with_a_number_is_not_free(check):
    """The parameter would be stated twice: as 1/10, and as free in the box."""
    given = document("alpha-tilde")
    given["scene"]["shape"] = {"alpha": "1/10"}
    given["statement"] = given["statement"].replace("egg,", "egg, alpha = 1/10,")

    assert verdict(check, given).startswith("refused: scene: the table has other letters")


def test_the_free_parameter_of_a_family_is_that_of_the_paper_under_another_name(check):
    """The flip of the egg's diameters, by the paper's name and by a formula."""
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


def test_what_only_the_package_reads_of_laws_is_refused_in_one_sentence(check):
    """Arc length in a law, also where a number has that name, and in the law of a tangency."""
    law = "-lam*eta*(1 + sin(s)/50)"
    length = "refused: scene: a law with s, arc length as an integral, is read by `pinball check` alone"
    touch = document("boundary-crisis")

    assert verdict(check, replaced(document("law-in-all-words"), law=law)) == length
    named = replaced(document("law-in-all-words"), law=law, shape={"alpha": "2/25", "s": "1"})
    assert verdict(check, named).startswith("refused: the file is not of its format: scene.shape has the entry 's'")
    assert verdict(check, replaced(document("own-mirror"), law=law)) == length
    assert verdict(check, replaced(touch, law=law)) == length


def test_a_number_below_the_last_place_of_an_interval_is_no_zero(check):
    """A spline's formula `1177...*theta**3/12978...`: at 64 bits the inverse of the divisor has no digit."""
    large, theta = 10**28, check.I.of(Fraction(1, 2), 64)
    x = check.evaluate(check.parse(f"{large}*theta**3/{large}"), {"theta": theta}, 64)[0]

    assert Fraction(x.lo, 1 << 64) <= Fraction(1, 8) <= Fraction(x.hi, 1 << 64)
    assert x.width() < 8
