"""Certificate files: read back bit for bit, with nothing believed unproved."""

import copy
import json
from dataclasses import replace

import pytest
from flint import arb
from sympy import Rational, sqrt

from symbolic import Law, Scene, tables
from verification.arithmetic.balls import working
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Closure
from verification.named.locate import locate, proof_near
from verification.named.theorems import checked, theorem
from verification.proofs.periodic.cycle_in_box import cycle_in_box
from verification.rigorous.certificate import read_document


@pytest.fixture(scope="module")
def fold() -> dict:
    return locate("saddle-node", 30, alpha=Rational(2, 25)).proof.document()


def test_a_certificate_survives_json_bit_for_bit_and_is_verified_anew(fold):
    again = checked(json.loads(json.dumps(fold)))

    assert again.document() == fold
    assert again.proved


@pytest.mark.slow
def test_a_certificate_of_five_thousand_digits_is_read_back():
    made = json.loads(json.dumps(locate("lambda-star", 5000).proof.document()))

    assert checked(made).proved


@pytest.mark.slow
def test_an_irrational_shape_is_kept_exactly():
    proof = locate("saddle-node", 20, alpha=sqrt(2) / 30).proof
    made = proof.document()

    assert made["scene"]["shape"] == {"alpha": "sqrt(2)/30"}
    assert checked(made).proved


EGG = {"table": "egg", "shape": {"alpha": "2/25"}}


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        ("name", "lambda-star"),
        ("name", "lambda-star = 0.5 +- 0 (certified)"),
        ("name", "\x1b[2Jsaddle-node"),
        ("name", None),
        ("scene", EGG | {"shape": {"alpha": "7/100"}}),
        ("kind", "flip"),
        ("mirror", True),
        ("radius", ["1", "-400"]),
    ],
)
def test_a_file_under_another_name_than_its_equations_have_is_refused(fold, entry, value):
    with pytest.raises(ValueError, match="is not what it states"):
        checked(copy.deepcopy(fold) | {entry: value})


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        ("statement", "All cycles of the egg are stable.", "statement = .* is not what its equations say"),
        ("checks", {"exists": True}, "checks must list just these"),
        ("proved_by", "me", "'proved_by' is unknown"),
        ("bits", 200.0 + 2**-20, "bits"),
    ],
)
def test_what_a_file_says_besides_its_box_is_held_to_its_equations(fold, entry, value, message):
    with pytest.raises(ValueError, match=message):
        checked(copy.deepcopy(fold) | {entry: value})


def test_a_cycle_of_a_table_given_by_a_formula_has_a_certificate():
    table = tables.polar("1 + cos(5*theta)/40")
    made = json.loads(json.dumps(proof_near(Problem(table, (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20).document()))

    assert made["scene"] == {"polar": "cos(5*theta)/40 + 1", "lam": "1/3"}
    assert made["name"] == "a cycle of period 2: polar cos(5*theta)/40 + 1, lam = 1/3"
    assert checked(made).document() == made


POINTS = [(2, 0), (1, "1.3"), (0, "1.5"), (-2, 0), ("-0.1", "-1.5")]


@pytest.mark.parametrize(
    ("fit", "across", "start"),
    [
        ({}, (4, 3), [0.98, 0.01]),
        ({"smoothness": 1}, (4, 2), [0.97, 0.99]),
        ({"degree": 2, "by": "index"}, (0, 0), [0.0, 3.1]),
    ],
    ids=str,
)
def test_a_table_fitted_to_points_is_told_by_the_formulas_of_its_fit(fit, across, start):
    """A reader need not fit the points again: the proof is about the fitted table."""
    table = tables.from_points(POINTS, "oval", **fit)
    proof = proof_near(Problem(table, across, lam=Rational(1, 3)), start, 20)
    made = json.loads(json.dumps(proof.document()))
    kind, words = ("parametric", "parametric ") if "degree" in fit else ("component", "boundary of 5 pieces, lam = 1/3")

    assert proof.proved
    assert kind in made["scene"]
    assert made["statement"].startswith(words)
    assert checked(made).document() == made


def test_one_name_for_a_number_of_the_table_and_another_of_the_law_is_refused():
    """The file would use the law's number for the egg's shape, a table that nobody asked for."""
    egg, law = tables.egg(3).at(alpha="2/25"), Law("-lam*eta - alpha*eta**3")
    other, same = (
        proof_near(Problem(egg, (0, 0, 0), lam=Rational(1, 2), law=law.at(alpha=number)), [0.96, 3.05, 5.15], 20)
        for number in ("1/100", "2/25")
    )
    with pytest.raises(ValueError, match="alpha is a parameter of the table, and another one of the law"):
        other.document()

    assert checked(json.loads(json.dumps(same.document()))).proved


def test_a_law_that_is_another_a_round_further_on_proves_nothing_beyond_the_ends():
    """The exit angle at `theta = 5.15` differs from that at `5.15 - 2*pi`, the same point of the egg."""
    egg = tables.egg(3).at(alpha="2/25")
    for formula, starts in (("theta/100", (5.15,)), ("cos(3*theta)/100", (5.15, -1.13))):
        for last in starts:
            problem = Problem(egg, (0, 0, 0), lam=Rational(1, 2), law=Law(f"-lam*eta*(1 + {formula})"))
            proof = proof_near(problem, [0.96, 3.05, last], 20)
            known = formula == "theta/100"

            assert proof.checks["admissible"] is (None if known else True)


def test_a_symmetry_that_only_algebra_sees_is_not_written():
    proof = proof_near(Problem(tables.polar("1 + cos(5*theta)/40"), (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20)
    table = tables.polar("1 + cos(theta - pi/7)*cos(theta + pi/7)/20")  # even, as its sum of waves would show
    mirrored = Problem(table, (0, 0), lam=Rational(1, 3), closure=Closure(-1))

    with pytest.raises(ValueError, match="the text of the formulas does not show it"):
        replace(proof, problem=mirrored).document()


def test_what_the_format_does_not_hold_is_refused_in_one_sentence():
    proof = proof_near(Problem(tables.polar("1 + cos(5*theta)/40"), (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20)
    long = replace(proof, digits=70_000)

    with pytest.raises(ValueError, match=r"70000 digits, .* is too much; accepted: up to 60000 digits"):
        long.document()


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        ("bits", 10**9, "out of range"),
        ("scene", EGG | {"table": "egg; import os"}, "no table is called"),
        ("scene", EGG | {"shape": {"alpha": "__import__('os').system('true')"}}, "."),
        ("scene", EGG | {"file": "/etc/passwd"}, "'file' is unknown"),
        ("scene", None, "."),
        ("centre", [["x", "0"]] * 4, "."),
        ("kind", "crisis", "."),
        ("components", None, "."),
    ],
)
def test_a_malformed_certificate_is_one_sentence(fold, entry, value, message):
    given = copy.deepcopy(fold) | {entry: value}

    with pytest.raises(ValueError, match=message):
        theorem(given)


def test_a_file_that_is_no_certificate_is_refused(tmp_path):
    (tmp_path / "list.json").write_text("[1, 2]")
    (tmp_path / "text.json").write_text("no")
    messages = {"list.json": "no JSON object", "text.json": "no JSON document", "none": "cannot be read"}
    for name, message in messages.items():
        with pytest.raises(ValueError, match=message):
            read_document(tmp_path / name)


def test_a_certificate_of_a_table_with_a_hole_and_whole_numbers_is_checked():
    """Straight from the middle of a side of a 4 by 4 square to a disc of radius 1 inside, and back."""
    sides = [("theta", "-2"), ("2", "theta"), ("-theta", "2"), ("-2", "-theta")]
    parts = [{"name": f"side {i}", "x": x, "y": y, "from": "-2", "to": "2"} for i, (x, y) in enumerate(sides)] + [
        {"name": "disc", "x": "cos(theta)", "y": "-sin(theta)", "from": "-pi", "to": "pi"}
    ]
    table = Scene.of({"component": parts, "lam": "1/2"}).table
    problem = Problem(table, (1, 4), lam=Rational(1, 2))
    with working(128):
        made = cycle_in_box(problem, (arb(0), arb(0)), arb("1e-20").mid(), 128, 20)

    assert made.proved
    assert checked(json.loads(json.dumps(made.document()))).proved
