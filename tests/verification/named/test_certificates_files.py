"""Certificates on paper: read back bit for bit, believed in nothing."""

import copy
import json

import pytest
from sympy import Rational, sqrt

from verification.named.files import checked, claim_of, document, read
from verification.named.locate import locate


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

    assert made["shape"] == {"alpha": "sqrt(2)/30"}
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


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        ("name", "lambda-star"),
        ("name", "lambda-star = 0.5 +- 0 (certified)"),
        ("name", "\x1b[2Jsaddle-node"),
        ("name", None),
        ("shape", {"alpha": "7/100"}),
        ("kind", "flip"),
        ("mirror", True),
        ("radius", ["1", "-400"]),
    ],
)
def test_a_file_under_another_name_than_its_equations_have_is_refused(fold, entry, value):
    with pytest.raises(ValueError, match="is not what it states"):
        checked(copy.deepcopy(fold) | {entry: value})


def test_an_angle_is_not_told_under_the_name_of_a_contraction():
    made = document(locate("phi-star", 20).proof)

    with pytest.raises(ValueError, match="is not what it states, which is 'lambda-star'"):
        checked(made | {"value": "lam"})


def test_a_contraction_beyond_one_is_refused():
    made = document(locate("alpha-tilde", 20, lam=Rational(1, 3)).proof)

    with pytest.raises(ValueError, match="lam = 2 is no contraction"):
        checked(made | {"lam": "2"})


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        ("schema", 2, "schema = 2 is unknown"),
        ("bits", 10**9, "out of range"),
        ("table", "egg; import os", "no table is called"),
        ("shape", {"alpha": "__import__('os').system('true')"}, "."),
        ("centre", [["1", "0"]], "1 entries for 4 unknowns"),
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


def test_a_file_that_is_no_certificate_is_refused(tmp_path):
    (tmp_path / "list.json").write_text("[1, 2]")
    (tmp_path / "text.json").write_text("no")
    messages = {"list.json": "no JSON object", "text.json": "no JSON document", "none": "cannot be read"}
    for name, message in messages.items():
        with pytest.raises(ValueError, match=message):
            read(tmp_path / name)
