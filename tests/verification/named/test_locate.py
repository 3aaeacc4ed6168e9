"""The named values agree with the paper, with closed forms, and with each other."""

import json
import re
from fractions import Fraction
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest
from click.testing import CliRunner
from sympy import Integer, Rational

from symbolic.tables.law import Law
from verification.app.commands.locate import check_command as check
from verification.app.commands.locate import command as locate_command
from verification.cycles.cascade import cascade
from verification.named.locate import NAMES, locate
from verification.named.theorems import check as check_file

ALPHA = Rational(2, 25)
run = partial(CliRunner().invoke, standalone_mode=False)  # of a command, with its words
SHAPES = {
    "alpha-tilde": {"lam": Rational(1, 3)},
    "alpha-hat": {"lam": Rational(1, 3)},
    "saddle-node": {"alpha": ALPHA},
    "doubling": {"alpha": ALPHA, "n": Integer(3)},
    "symmetry-breaking": {"alpha": ALPHA},
}
KNOWN = {  # each from its second method: closed forms of the symbolic storey, or 60 digits in mpmath
    "lambda-star": "0.0712172452489159804",
    "phi-star": "-0.0289794737869139599",
    "lambda-c": "0.0934003354313602414",
    "alpha-tilde": "0.0618751972700558969",
    "alpha-hat": "0.0277563773199464655",
    "saddle-node": "0.3781212525900902357",
    "doubling": "0.3712355025279195235",
    "symmetry-breaking": "0.2877854765031",
}


@pytest.mark.parametrize("name", KNOWN)
def test_each_name_is_located_and_certified(name):
    found = locate(name, 25, **SHAPES.get(name, {}))

    assert found.certified, found.checks
    assert found.value.startswith(KNOWN[name])
    assert float(found.radius) < 1e-25


def test_every_name_is_a_bifurcation_with_a_known_value_or_a_contact_of_manifolds():
    contacts = {"merging-crisis", "boundary-crisis", "symmetry-restoring", "band-merging", "interior-crisis"}
    contacts |= {f"{what}-{event}" for what in ("window", "family") for event in ("end", "merging")}

    assert set(NAMES) == set(KNOWN) | contacts


@pytest.mark.slow
@pytest.mark.parametrize(("name", "near"), [("merging-crisis", 0.44343), ("boundary-crisis", 0.6622)])
def test_a_crisis_is_an_estimate_and_says_so(name, near):
    """It is near the paper's plots, 0.4435 and 0.66, and near a bisection with 20 times the bounces."""
    found = locate(name, 8, alpha=ALPHA)

    assert not found.certified
    assert abs(float(found.value) - near) < 1e-4
    assert 0 < float(found.radius) < 1e-3


def test_more_digits_agree_with_fewer():
    few, many = (locate("lambda-star", digits) for digits in (20, 200))

    assert abs(float(few.value) - float(many.value)) < 1e-16
    assert many.value.startswith(few.value[:20])
    assert float(few.radius) > 0


def test_the_cascade_approaches_feigenbaums_ratio():
    members = cascade(ALPHA)
    values = [next(members).lam for _ in range(7)]
    gaps = [b - a for a, b in pairwise(values)]

    assert abs(gaps[-2] / gaps[-1] - 4.6692) < 1e-3  # converges like 4.67**-n


@pytest.mark.parametrize(
    ("name", "shape", "message"),
    [
        ("lambda", {}, "no value is called 'lambda'; accepted: lambda-star"),
        ("lamda-star", {}, "; did you mean lambda-star"),
        ("lambda-c", {"lam": Integer(0)}, "given lam; it takes no parameter"),
        ("doubling", {"alpha": ALPHA}, "it takes alpha, n"),
        ("doubling", {"alpha": ALPHA, "n": Integer(40)}, "n = 40 is out of range; accepted: 2 to 17"),
        ("doubling", {"alpha": ALPHA, "n": Integer(17)}, "accepted for n = 17: up to 61 digits"),
        ("doubling", {"alpha": ALPHA, "n": Integer(2)}, "alpha = 2/25 has no lambda_2"),
        ("doubling", {"alpha": ALPHA, "n": "5/2"}, "n = 5/2 is no integer"),
        ("saddle-node", {"alpha": 0.08}, "alpha = 0.08 is a rounded float; write it exactly"),
        ("saddle-node", {"alpha": Integer(0)}, "alpha = 0 is a circle"),
        ("saddle-node", {"alpha": Rational(1, 5)}, r"alpha must lie in \[0, 1/10\]"),
        ("alpha-tilde", {"lam": Integer(2)}, "lam = 2 is out of range"),
        ("window-end", {"alpha": ALPHA}, "given alpha; it takes alpha, period"),
        ("window-end", {"alpha": ALPHA, "period": Integer(7)}, "accepted: 6, 8, 9, 12, 14, 15, 18, 20"),
        ("band-merging", {"alpha": ALPHA, "period": Integer(3)}, "accepted: 4, 8, 16"),
        ("interior-crisis", {"alpha": ALPHA, "n": Integer(8)}, "accepted: 1, 2, 3"),
        ("lambda-c", {"law": Law("-lam*sin(eta)")}, "any law for tangencies of manifolds"),
        ("merging-crisis", {"alpha": ALPHA, "law": Law("-lam*eta + eta**2/99")}, "mirror images of orbits are no orb"),
    ],
)
def test_a_search_that_cannot_succeed_says_what_is_accepted(name, shape, message):
    with pytest.raises(ValueError, match=message):
        locate(name, 100 if shape.get("n") == 17 else 15, **shape)


SAID = {"alpha-tilde": {"lam": "1/3"}, "saddle-node": {"alpha": "0.08"}, "doubling": {"alpha": Fraction(2, 25), "n": 3}}


@pytest.mark.parametrize(("name", "shape"), SAID.items())
def test_a_number_may_be_text_or_a_fraction_and_what_is_located_is_saved(name, shape, tmp_path):
    found = locate(name, 19, **shape)
    found.save(tmp_path / "proof.json")

    assert found.value.startswith(KNOWN[name])
    assert check_file(tmp_path / "proof.json").proved
    with pytest.raises(ValueError, match=r"nowhere.* cannot be written"):
        found.save(tmp_path / "nowhere" / "proof.json")


def test_ends_where_a_bifurcation_degenerates_are_not_certified():
    elastic, slap = locate("alpha-tilde", 15, lam=Integer(1)), locate("alpha-hat", 15, lam=Integer(0))

    assert elastic.checks["simple_multiplier"] is None
    assert slap.checks["unique"] is None


def test_the_command_writes_the_contract_and_a_certificate_that_checks(tmp_path):
    certificate, result = tmp_path / "c.json", tmp_path / "r.json"
    arguments = ["saddle-node", "--alpha", "0.08", "--certificate", str(certificate), "--json", str(result)]
    done = run(locate_command, arguments)
    given = json.loads(result.read_text())

    assert done.return_value == 0
    assert {"name", "value", "radius", "digits", "certified", "checks", "seconds"} <= set(given)
    assert {"gmpy2", "newton"} <= set(given)
    assert given["certified"] is True
    assert run(check, [str(certificate)]).return_value == 0


def test_a_certificate_that_fails_exits_with_one(tmp_path):
    spoiled = locate("saddle-node", 20, alpha=ALPHA).proof.document() | {"digits": 60}
    (tmp_path / "c.json").write_text(json.dumps(spoiled))

    assert run(check, [str(tmp_path / "c.json")]).return_value == 1


def test_a_certificate_that_cannot_be_written_is_refused_before_the_work(tmp_path):
    nowhere = str(tmp_path / "none" / "c.json")
    with pytest.raises(ValueError, match="cannot be written; accepted: a file in a directory of yours"):
        run(locate_command, ["lambda-c", "--certificate", nowhere], catch_exceptions=False)


@pytest.mark.parametrize("digits", ["0", "1000000000", "-3", "many"])
def test_digits_out_of_range_are_refused(digits):
    done = CliRunner().invoke(locate_command, ["lambda-c", "--digits", digits])

    assert done.exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("merging-crisis circle --lam 0.1:0.3 --period 2", "accepted with circle: saddle-node, doubling, symmetry-br"),
        ("doubling circle --lam 0.1:0.3", "bifurcations of a table take --period and not --n"),
        ("doubling circle --period 2", "--lam is missing; accepted: LOW:HIGH"),
        (
            "doubling circle --lam 0.1 --period 2",
            "--lam 0.1: one parameter varies; accepted: LOW:HIGH, or a number and",
        ),
        ("doubling egg --alpha 0.08 --shape b=0:1 --lam 0.1 --period 2", "b = 0 is no shape parameter of this table"),
        ("doubling --alpha 0.08 --shape b=0:1", "--shape b=0:1 is for a table, and none is given"),
        ("doubling --alpha 0.08 --n 3 --law=-lam*sin(eta)", "accepted: -lam*eta, and any law for tangencies"),
        ("saddle-node --alpha 0.08 --K 4", "--K 4 needs a table; accepted: egg --K 4"),
        ("tangency", "locate tangency needs a table; accepted: egg --alpha 2/25 --lam 0.6:0.7 --period 3"),
        ("tangncy circle --lam 0.1:0.3 --period 2", "no value is called tangncy; accepted with circle: saddle-node"),
        ("tangency stadium --lam 0.1:0.3 --period 2", "its boundary has 4 pieces, and the map has kinks where they"),
        ("tangency cardioid --lam 0.1:0.3 --period 2", "its boundary has a cusp or a corner, where the map is not"),
        ("tangency circle --lam 0:0.3 --period 2", "lam from 0 to 3/10 is no interval of contractions; accepted: 0 <"),
        ("tangency egg --shape alpha=0.05:0.08 --lam 0.6 --period 3", "alpha varies; accepted: --lam LOW:HIGH"),
    ],
)
def test_what_cannot_be_asked_of_a_table_is_told_in_a_sentence(arguments, says):
    with pytest.raises(ValueError, match=re.escape(says)):
        run(locate_command, arguments.split(), catch_exceptions=False)


def test_a_bifurcation_of_a_table_s_cycles_is_located_and_its_certificate_checks(tmp_path, capsys):
    certificate = tmp_path / "c.json"
    given = ["doubling", "egg", "--alpha", "0.07", "--lam", "0.05:0.3", "--period", "2", "--searches", "1"]
    done = run(locate_command, [*given, "--certificate", str(certificate)])

    assert done.return_value == 0
    assert done.output.startswith("period doubling of period 2 in lam = 0.125678082249803028854")
    assert run(check, [str(certificate)]).return_value == 0


@pytest.mark.slow
def test_a_tangency_asked_of_a_radius_is_the_named_crisis_and_its_proof_stands(capsys):
    """The named crisis is located by its own contact and by the folds of a cycle that shadows it."""
    given = ["tangency", "--polar", "1 + 2*cos(3*theta)/25", "--lam", "0.655:0.67", "--period", "3", "--searches", "1"]
    done = run(locate_command, [*given, "--digits", "15", "--json", "-"])
    (found,) = json.loads(done.stdout)["found"]
    named = locate("boundary-crisis", 15, alpha=Rational(2, 25))

    assert done.return_value == 0
    assert found["certified"]
    assert abs(Fraction(found["value"]) - Fraction(named.value)) <= Fraction(found["radius"]) + Fraction(named.radius)


def test_several_certificates_are_checked_at_once_and_each_is_told(tmp_path):
    files = [str(tmp_path / f"{n}.json") for n in (3, 4)]
    for file, n in zip(files, (3, 4), strict=True):
        given = ["doubling", "--alpha", "0.08", "--n", str(n), "--digits", "20", "--certificate", file]
        assert run(locate_command, given).return_value == 0
    done = run(check, [*files, "--json", "-"])
    told = json.loads(done.stdout)["files"]
    changed = json.loads(Path(files[1]).read_text()) | {"name": "another"}
    Path(files[1]).write_text(json.dumps(changed))

    assert done.return_value == 0
    assert [each["file"] for each in told] == files
    assert all(each["certified"] for each in told)
    with pytest.raises(ValueError, match=r"4\.json: "):
        run(check, files, catch_exceptions=False)
