"""Single entries of certificate files: how claims are written and read, names, limits and versions."""

import json
from dataclasses import replace

import pytest
from committed import FOLDER
from flint import arb

from symbolic.tables.formula import LENGTH
from verification.named.theorems import checked, theorem_class

OTHERS = ("tangency", "trapping region", "boundary crisis")
GIVEN = {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}
GIVEN = {name: given for name, given in GIVEN.items() if given["kind"] not in OTHERS}


def stated(given):
    """The theorem of a document, before its texts are checked."""
    return theorem_class(given["kind"]).from_dict(given)


@pytest.mark.parametrize("name", GIVEN)
def test_what_is_read_of_a_committed_file_is_written_again(name):
    assert json.loads(json.dumps(stated(GIVEN[name]).to_dict() | {"checks": GIVEN[name]["checks"]})) == GIVEN[name]


@pytest.mark.parametrize(
    ("name", "changed", "called"),
    [
        ("lambda-c", {"kind": "fold"}, "fold of a cycle of period 2 in lam: cuspless"),
        ("lambda-c", {"mirror": True}, "flip of half of a symmetric cycle, of period 2 in lam: cuspless"),
        ("alpha-tilde", {"kind": "fold"}, "fold of a cycle of period 2 in alpha: egg, lam = "),
        ("alpha-tilde", {"mirror": True}, "flip of half of a symmetric cycle, of period 2 in alpha: egg, lam = "),
        ("alpha-tilde", {"K": 5}, "flip of a cycle of period 2 in alpha: egg of 5 points, lam = "),
        ("saddle-node", {"kind": "flip"}, "flip of a cycle of period 3 in lam: egg, alpha = 2/25"),
        ("saddle-node", {"mirror": True}, "fold of half of a symmetric cycle, of period 3 in lam: egg, alpha = 2/25"),
    ],
)
def test_a_value_has_its_name_by_all_that_is_said_of_it(name, changed, called):
    """The same box gets another name for another kind, for half of a cycle, or for another table."""
    given = GIVEN[name] | {key: value for key, value in changed.items() if key != "K"}
    given |= {"scene": given["scene"] | {key: value for key, value in changed.items() if key == "K"}}
    assert stated(given).name.startswith(called)


@pytest.mark.parametrize(
    ("name", "moved", "called"),
    [
        ("lambda-star", ("0.0009", "0"), "lambda-star"),
        ("lambda-star", ("0", "-0.0009"), "lambda-star"),
        ("lambda-star", ("0.0011", "0"), "an orbit through both corners"),
        ("lambda-star", ("0", "-0.0011"), "an orbit through both corners"),
        ("phi-star", ("0.0009", "0.0009"), "phi-star"),
        ("phi-star", ("0.0011", "0"), "an orbit through both corners"),
        ("alpha-hat", ("0", "0", "0"), "alpha-hat"),
        ("alpha-hat", ("0", "0", "0.0001"), "equal multipliers"),
        ("alpha-hat", ("0.0001", "0.0001", "0"), "alpha-hat"),
    ],
)
def test_a_corner_orbit_and_equal_multipliers_have_names_near_the_known_ones_alone(name, moved, called):
    claim = stated(GIVEN[name])
    centre = tuple(x + arb(by) for x, by in zip(claim.centre, moved, strict=True))
    assert replace(claim, centre=centre).name == called


PAIR = ["1", "-9"]


@pytest.mark.parametrize(
    ("name", "changed", "why"),
    [
        ("saddle-node", {"schema": 0}, "schema = 0 is unknown; this version reads 4"),
        ("saddle-node", {"schema": 5}, "schema = 5 is unknown"),
        ("saddle-node", {"bits": 15}, "bits = 15 or digits"),
        ("saddle-node", {"bits": 200_001}, "bits = 200001 or"),
        ("saddle-node", {"digits": 0}, "or digits = 0 is out of range"),
        ("saddle-node", {"digits": 200_001}, "or digits = 200001 is out of range"),
        ("saddle-node", {"centre": []}, "centre has no unknowns"),
        ("saddle-node", {"centre": [PAIR] * 3}, "centre has 3 entries for 4 unknowns"),
        ("saddle-node", {"centre": [PAIR] * 5}, "centre has 5 entries for 4 unknowns"),
        ("egg-triangle", {"centre": [PAIR] * 4}, "centre has 4 entries for 3 unknowns"),
        ("lambda-star", {"centre": [PAIR] * 3}, "centre has 3 entries for 2 unknowns"),
        ("lambda-star", {"centre": [PAIR]}, "centre has 1 entries for 2 unknowns"),
        ("alpha-hat", {"centre": [PAIR] * 2}, "centre has 2 entries for 3 unknowns"),
        ("alpha-hat", {"centre": [PAIR] * 4}, "centre has 4 entries for 3 unknowns"),
        ("lambda-star", {"components": [0, 1]}, "is not that of a corner"),
        ("lambda-star", {"mirror": False}, "is not that of a corner"),
        ("lambda-star", {"scene": {"table": "cardioid"}}, "is not that of a corner"),
        ("alpha-hat", {"mirror": True}, "is not that of a focus"),
        ("egg-triangle", {"components": [0]}, "1 bounces are out of range; accepted: 2 to"),
        ("egg-triangle", {"components": [0, 0, 1]}, "has components 0 to 0 only"),
        ("egg-triangle", {"components": [0, 0, -1]}, "has components 0 to 0 only"),
        ("egg-triangle", {"radius": ["1", "400001"]}, "the exponent 400001 is out of range"),
        ("egg-triangle", {"radius": ["1", "-400001"]}, "the exponent -400001 is out of range"),
    ],
)
def test_an_entry_that_is_none_is_named(name, changed, why):
    with pytest.raises(ValueError, match=why):
        stated(GIVEN[name] | changed)


def test_half_of_a_cycle_closes_by_the_mirror_image_and_a_whole_one_by_itself():
    for mirror, sign in ((True, -1), (False, 1)):
        problem = stated(GIVEN["alpha-tilde"] | {"mirror": mirror}).problem
        assert problem.mirror is mirror
        assert problem.closure == type(problem.closure)(sign)


@pytest.mark.parametrize("schema", [0, 5])
def test_a_tangency_of_an_unknown_version_is_refused(schema):
    with pytest.raises(ValueError, match=f"schema = {schema} is unknown"):
        checked({"kind": "tangency", "schema": schema})


def test_a_file_holds_formulas_of_2000_characters():
    given = GIVEN["egg-triangle"]
    for scene in ({"polar": "1" * (LENGTH + 1)}, {"parametric": ["1", "1" * (LENGTH + 1)]}):
        with pytest.raises(ValueError, match=f"{LENGTH + 1} characters; at most {LENGTH} are accepted"):
            stated(given | {"scene": scene | {"lam": "1/2"}})
