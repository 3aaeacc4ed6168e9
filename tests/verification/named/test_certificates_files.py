"""Certificates on paper: read back bit for bit, believed in nothing."""

import copy
import json
from dataclasses import replace
from pathlib import Path

import pytest
from sympy import Rational, sqrt

from symbolic import Law, tables
from verification.arithmetic.balls import working
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Closure
from verification.named.files import checked, claim_of, document, name_of, read
from verification.named.locate import certify, locate


@pytest.fixture(scope="module")
def fold() -> dict:
    return document(locate("saddle-node", 30, alpha=Rational(2, 25)).proof)


def test_a_certificate_survives_json_bit_for_bit(fold):
    again = json.loads(json.dumps(fold))

    assert document(checked(again)) == fold


def test_a_certificate_is_verified_anew(fold):
    assert checked(fold).certified


def test_a_certificate_of_five_thousand_digits_is_read_back():
    made = json.loads(json.dumps(document(locate("lambda-star", 5000).proof)))

    assert checked(made).certified


def test_an_irrational_shape_is_kept_exactly():
    proof = locate("saddle-node", 20, alpha=sqrt(2) / 30).proof
    made = document(proof)

    assert made["scene"]["shape"] == {"alpha": "sqrt(2)/30"}
    assert checked(made).certified


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("lambda-star", {}),
        ("phi-star", {}),
        ("lambda-c", {}),
        ("alpha-hat", {"lam": Rational(1, 3)}),
        ("alpha-tilde", {"lam": Rational(1, 3)}),
        ("symmetry-breaking", {"alpha": Rational(2, 25)}),
    ],
)
def test_every_name_has_a_certificate_that_checks(name, shape):
    made = json.loads(json.dumps(document(locate(name, 20, **shape).proof)))
    again = checked(made)

    assert again.certified
    assert document(again) == made


@pytest.mark.parametrize(
    "spoil",
    [
        lambda d: d["centre"].__setitem__(0, ["1", "-1"]),
        lambda d: d.__setitem__("digits", 60),
    ],
)
def test_a_spoiled_certificate_is_not_certified_whatever_it_says(fold, spoil):
    given = copy.deepcopy(fold)
    spoil(given)

    assert not checked(given).certified


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


def test_files_of_the_first_version_are_read():
    proof = locate("alpha-tilde", 20, lam=Rational(1, 3)).proof
    new = document(proof)
    box = {
        key: new[key] for key in ("name", "kind", "free", "mirror", "components", "bits", "digits", "centre", "radius")
    }
    old = box | {"schema": 1, "table": "egg", "points": 3, "shape": {}, "lam": "1/3", "checks": new["checks"]}

    assert document(checked(old)) == new


def test_special_files_of_the_first_version_are_read():
    new = document(locate("phi-star", 20).proof)
    box = {key: new[key] for key in ("name", "bits", "digits", "centre", "radius", "checks")}

    assert document(checked(box | {"schema": 1, "kind": "special", "value": "phi", "lam": None})) == new


def test_a_cycle_of_a_table_given_by_a_formula_has_a_certificate():
    table = tables.polar("1 + cos(5*theta)/40")
    made = json.loads(json.dumps(document(certify(Problem(table, (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20))))

    assert made["scene"] == {"polar": "cos(5*theta)/40 + 1", "lam": "1/3"}
    assert made["name"] == "a cycle of period 2: polar cos(5*theta)/40 + 1, lam = 1/3"
    assert document(checked(made)) == made


POINTS = [(2, 0), (1, "1.3"), (0, "1.5"), (-2, 0), ("-0.1", "-1.5")]


@pytest.mark.parametrize("fit", [{}, {"smoothness": 1}, {"degree": 2, "by": "index"}], ids=str)
def test_a_table_fitted_to_points_is_told_by_the_formulas_of_its_fit(fit):
    """A reader need not fit again, and what is proved is so for the fit."""
    table = tables.from_points(POINTS, "oval", **fit)
    across = (0, 3) if len(table.components) > 1 else (0, 0)
    start = [0.02, 0.0] if len(table.components) > 1 else [0.0, 3.1]
    proof = certify(Problem(table, across, lam=Rational(1, 3)), start, 20)
    made = json.loads(json.dumps(document(proof)))
    kind, words = ("parametric", "parametric ") if "degree" in fit else ("component", "boundary of 5 pieces, lam = 1/3")

    assert kind in made["scene"]
    assert made["statement"].startswith(words)
    assert document(checked(made)) == made


def test_files_of_the_third_version_are_read():
    """Where a fitted table was its points, and pieces were told as Python writes them."""
    proof = certify(Problem(tables.from_points(POINTS, "oval"), (0, 3), lam=Rational(1, 3)), [0.02, 0.0], 20)
    made = json.loads(json.dumps(document(proof, 3)))

    assert "points" in made["scene"]
    assert document(checked(made), 3) == made
    with pytest.raises(ValueError, match=r"name = .* is not what it states"):
        checked(made | {"schema": 4})


def test_one_name_for_a_number_of_the_table_and_another_of_the_law_is_refused():
    """The file would be about a table that nobody asked for: the egg with the law's number for its shape."""
    egg, law = tables.egg(3).at(alpha="2/25"), Law("-lam*eta - alpha*eta**3")
    other, same = (
        certify(Problem(egg, (0, 0, 0), lam=Rational(1, 2), law=law.at(alpha=number)), [0.96, 3.05, 5.15], 20)
        for number in ("1/100", "2/25")
    )
    with pytest.raises(ValueError, match="alpha is a number of the table, and another one of the law"):
        document(other)

    assert checked(json.loads(json.dumps(document(same)))).certified


def test_a_law_that_is_another_a_round_further_on_proves_nothing_beyond_the_ends():
    """Its exit angle at `theta = 5.15` is not that at the same point of the egg, `5.15 - 2*pi`."""
    egg = tables.egg(3).at(alpha="2/25")
    for formula, starts in (("theta/100", (5.15,)), ("cos(3*theta)/100", (5.15, -1.13))):
        for last in starts:
            problem = Problem(egg, (0, 0, 0), lam=Rational(1, 2), law=Law(f"-lam*eta*(1 + {formula})"))
            proof = certify(problem, [0.96, 3.05, last], 20)
            known = formula == "theta/100"

            assert proof.checks["admissible"] is (None if known else True)


def test_a_symmetry_that_only_algebra_sees_is_not_written():
    proof = certify(Problem(tables.polar("1 + cos(5*theta)/40"), (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20)
    table = tables.polar("1 + cos(theta - pi/7)*cos(theta + pi/7)/20")  # even, as its sum of waves would show
    mirrored = Problem(table, (0, 0), lam=Rational(1, 3), closure=Closure(-1))

    with pytest.raises(ValueError, match="not seen in the formulas"):
        document(replace(proof, claim=replace(proof.claim, problem=mirrored)))


def test_what_the_format_does_not_hold_is_refused_in_one_sentence():
    proof = certify(Problem(tables.polar("1 + cos(5*theta)/40"), (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20)
    long = replace(proof, claim=replace(proof.claim, digits=70_000))

    with pytest.raises(ValueError, match=r"70000 digits, .* is too much; accepted: up to 60000 digits"):
        document(long)


def test_an_angle_is_not_told_under_the_name_of_a_contraction():
    made = document(locate("phi-star", 20).proof)

    with pytest.raises(ValueError, match="is not what it states, which is 'lambda-star'"):
        checked(made | {"free": "lam"})


def test_a_contraction_beyond_one_is_refused():
    made = document(locate("alpha-tilde", 20, lam=Rational(1, 3)).proof)

    with pytest.raises(ValueError, match="lam = 2 is no contraction"):
        checked(made | {"scene": {"table": "egg", "lam": "2"}})


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        ("schema", 5, "schema = 5 is unknown"),
        ("bits", 10**9, "out of range"),
        ("scene", EGG | {"table": "egg; import os"}, "no table is called"),
        ("scene", EGG | {"shape": {"alpha": "__import__('os').system('true')"}}, "."),
        ("scene", EGG | {"file": "/etc/passwd"}, "'file' is unknown"),
        ("scene", None, "."),
        ("centre", [["1", "0"]], "1 entries for 4 unknowns"),
        ("centre", [], "no unknowns"),
        ("centre", [["x", "0"]] * 4, "."),
        ("radius", ["1", "999999999999"], "out of range"),
        ("kind", "crisis", "."),
        ("components", None, "."),
    ],
)
def test_a_malformed_certificate_is_one_sentence(fold, entry, value, message):
    given = copy.deepcopy(fold) | {entry: value}

    with pytest.raises(ValueError, match=message):
        claim_of(given)


@pytest.mark.parametrize(("bits", "lam", "read"), [
    (16, "1/3", True), (15, "1/3", False), (64, "0", True), (64, "1", True), (64, "5/4", False), (64, "-1/4", False),
])  # fmt: skip
def test_a_claim_is_read_from_16_bits_on_and_for_contractions_from_0_to_1(bits, lam, read):
    """Both ends of the contractions are laws: all particles leave along the normal, or are reflected."""
    table = tables.egg(3).at(alpha=Rational(1, 10))
    given = document(certify(Problem(table, (0, 0), lam=Rational(1, 3)), [0.0, 3.14], 20)) | {"bits": bits}
    given["scene"] = given["scene"] | {"lam": lam}
    if read:
        claim = claim_of(given)
        assert (claim.bits, claim.problem.lam) == (bits, Rational(lam))
    else:
        with pytest.raises(ValueError, match="out of range" if bits < 16 else "no contraction"):
            claim_of(given)


def test_a_file_that_is_no_certificate_is_refused(tmp_path):
    (tmp_path / "list.json").write_text("[1, 2]")
    (tmp_path / "text.json").write_text("no")
    messages = {"list.json": "no JSON object", "text.json": "no JSON document", "none": "cannot be read"}
    for name, message in messages.items():
        with pytest.raises(ValueError, match=message):
            read(tmp_path / name)


@pytest.mark.parametrize("name", ["alpha-tilde", "alpha-hat", "saddle-node", "lambda-c", "lambda-star", "phi-star"])
def test_a_value_that_is_known_has_its_name_and_beside_it_there_is_none(name):
    given = read(Path(__file__).parents[3] / "certificates" / f"{name}.json")
    claim = claim_of(given)

    assert name_of(claim) == name
    with working(200):
        moved = replace(claim, centre=tuple((x + 1000 * claim.radius).mid() for x in claim.centre))
    assert name_of(moved) != name or name.endswith("-star")
