"""Entries of certificate files, each by itself: what is written of a claim and read, names, limits and versions."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from flint import arb
from sympy import Rational

from symbolic.tables.formula import LENGTH
from verification.arithmetic.balls import working
from verification.named import files, tangency_entries
from verification.proofs.corner.corner_orbit import CornerClaim
from verification.proofs.manifolds import claim as manifolds
from verification.proofs.periodic.bifurcation import Claim

FOLDER = Path(__file__).parents[3] / "certificates"
OTHERS = ("tangency", "trapping region", "boundary crisis")
GIVEN = {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}
GIVEN = {name: given for name, given in GIVEN.items() if given["kind"] not in OTHERS}


def written(claim, checks=(), schema: int = files.SCHEMA) -> dict:
    """The document of a claim, as if proved, by way of JSON."""
    proof = SimpleNamespace(claim=claim, checks=dict(checks), certified=True)
    return json.loads(json.dumps(files.document(proof, schema)))


@pytest.mark.parametrize("name", GIVEN)
def test_what_is_read_of_a_committed_file_is_written_again(name):
    claim = files.claim_of(GIVEN[name])
    assert written(claim, GIVEN[name]["checks"]) == GIVEN[name]
    assert files.name_of(claim) == GIVEN[name]["name"]


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
    """The same box, of another kind, as half of a cycle, or of another table."""
    given = GIVEN[name] | {key: value for key, value in changed.items() if key != "K"}
    given |= {"scene": given["scene"] | {key: value for key, value in changed.items() if key == "K"}}
    assert files.name_of(files.claim_of(given)).startswith(called)


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
    claim = files.claim_of(GIVEN[name])
    centre = tuple(x + arb(by) for x, by in zip(claim.centre, moved, strict=True))
    assert files.name_of(replace(claim, centre=centre)) == called


@pytest.mark.parametrize("name", ["lambda-c", "alpha-tilde", "saddle-node"])
def test_a_box_has_the_name_of_a_value_where_it_may_hold_it_and_nowhere_else(name, monkeypatch):
    """Also one that is smaller than what is known of the value: some twenty digits more than are asked for."""
    claim, asked, closed_form = files.claim_of(GIVEN[name]), [], files.closed_form
    monkeypatch.setattr(files, "closed_form", lambda *given: asked.append(given[0]) or closed_form(*given))

    def called(last, radius):
        centre = (*(x + arb("0.1") for x in claim.centre[:-1]), last)
        return files.name_of(replace(claim, centre=centre, radius=radius))

    with working(claim.bits + 200):
        assert called(claim.centre[-1], claim.radius) == name
        true, unit = closed_form(asked[0], claim.digits + 50).mid(), arb(10) ** -claim.digits
        for off, radius in ((0, 0), (unit / 2, unit), (-unit / 2, unit), (1, 2)):
            assert called(true + off, arb(radius)) == name
        for off, radius in ((unit / 10**18, 0), (unit * 2, unit), (-unit * 2, unit), (2, 1)):
            assert called(true + off, arb(radius)).startswith(GIVEN[name]["kind"])


def test_a_file_bears_the_name_of_its_claim_and_no_other_nor_none():
    claim = files.claim_of(GIVEN["saddle-node"])
    files._rightly_named(GIVEN["saddle-node"], claim)
    for given in ({"schema": 4, "name": "saddle"}, {"schema": 4, "name": None}, {"schema": 4}):
        with pytest.raises(ValueError, match="is not what it states, which is 'saddle-node'"):
            files._rightly_named(given, claim)


def test_a_claim_of_another_kind_has_the_name_that_tangencies_have(monkeypatch):
    monkeypatch.setattr(tangency_entries, "name_of", lambda claim, schema: (claim, schema))
    assert files.name_of("a claim", 3) == ("a claim", 3)


@pytest.mark.parametrize("schema", [files.FIRST, files.SECOND, files.THIRD])
def test_what_the_format_holds_is_asked_of_its_last_version_alone(schema, monkeypatch):
    claim = files.claim_of(GIVEN["saddle-node"])
    monkeypatch.setattr(files, "_holds", lambda *_: pytest.fail("asked"))
    made = written(claim, schema=schema)
    assert (made["schema"], made["bits"]) == (schema, claim.bits)
    with pytest.raises(pytest.fail.Exception):
        written(claim)


def told(**changed):
    """A claim with the largest numbers that a file holds, and what is said of it; of no kind that may be mirrored."""
    claim = {"bits": files.LARGEST_BITS, "digits": files.LARGEST_DIGITS} | changed
    return SimpleNamespace(**claim), {
        "scene": {},
        "components": [0] * claim.pop("count", files.LONGEST),
        "mirror": True,
    }


def test_numbers_are_held_up_to_the_largest_and_no_further():
    files._holds(*told())
    for key, largest in (("bits", 200_000), ("digits", 60_000), ("count", 1024)):
        with pytest.raises(ValueError, match="is too much; accepted: up to 60000 digits, 200000 bits and 1024 bounces"):
            files._holds(*told(**{key: largest + 1}))


@pytest.mark.parametrize("name", ["own-mirror", "symmetry-breaking", "lambda-star", "saddle-node"])
def test_a_symmetry_is_looked_for_where_a_cycle_is_mirrored(name, monkeypatch):
    """In the formulas themselves where the table is one's own; a corner orbit's is the table's."""
    asked, claim = [], files.claim_of(GIVEN[name])
    monkeypatch.setattr(files, "seen_mirrored", lambda problem, own: asked.append((problem, own)))
    mirrored = name == "own-mirror" or (name == "symmetry-breaking" and GIVEN[name]["mirror"])
    if mirrored:
        with pytest.raises(ValueError, match="is a symmetry is proved, but not seen"):
            written(claim)
        assert asked == [(claim.problem, "table" not in GIVEN[name]["scene"])]
    else:
        written(claim)
        assert not asked
    monkeypatch.setattr(files, "seen_mirrored", lambda *_: True)
    written(claim)


@pytest.mark.parametrize("key", ["polar", "law", "parametric 0", "parametric 1", "x", "y", "from", "to"])
def test_a_scene_has_formulas_up_to_a_length_wherever_they_stand(key):
    def scene(text):
        if key.startswith("parametric"):
            return {"parametric": [text, "1"] if key.endswith("0") else ["1", text]}
        if key in ("polar", "law"):
            return {key: text}
        return {"component": [{"x": "1", "y": "1", "from": "0", "to": "1"} | {key: text, "name": "9" * 3000}]}

    files._scene_held(scene("1" * LENGTH))
    with pytest.raises(ValueError, match=f"a formula of {LENGTH + 1} characters is too long; accepted: {LENGTH}"):
        files._scene_held(scene("1" * (LENGTH + 1)))


def test_the_longest_of_too_long_formulas_is_told_and_points_up_to_a_thousand():
    with pytest.raises(ValueError, match="a formula of 2009 characters"):
        files._scene_held({"parametric": ["1" * 2005, "1" * 2009]})
    files._scene_held({"table": "egg", "K": 1000})
    with pytest.raises(ValueError, match="K = 1001 is too much; accepted: up to 1000"):
        files._scene_held({"table": "egg", "K": 1001})


PAIR = ["1", "-9"]


@pytest.mark.parametrize(
    ("name", "changed", "why"),
    [
        ("saddle-node", {"schema": 0}, "schema = 0 is unknown; this version reads 1 to 4"),
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
        files.claim_of(GIVEN[name] | changed)


def test_entries_are_read_up_to_their_limits(monkeypatch):
    for bits in (16, 200_000):
        assert files.claim_of(GIVEN["saddle-node"] | {"bits": bits}).bits == bits
    for digits in (1, 200_000):
        assert files.claim_of(GIVEN["saddle-node"] | {"digits": digits}).digits == digits
    for exponent in ("400000", "-400000"):
        assert files._ball(["3", exponent]) == arb((3, int(exponent)))
    monkeypatch.setattr(files, "LARGEST_PERIOD", 3)
    files.claim_of(GIVEN["egg-triangle"])
    for key in ("saddle-node", "lambda-c"):
        assert isinstance(files.claim_of(GIVEN[key]), Claim)
    with pytest.raises(ValueError, match="4 bounces are out of range; accepted: 2 to 3"):
        files.claim_of(GIVEN["egg-triangle"] | {"components": [0] * 4})


@pytest.mark.parametrize(("lam", "read"), [("0", True), ("1", True), ("1/2", True), ("-1/9", False), ("3/2", False)])
def test_a_contraction_is_from_0_to_1(lam, read):
    given = GIVEN["egg-triangle"] | {"scene": GIVEN["egg-triangle"]["scene"] | {"lam": lam}}
    if read:
        assert files.claim_of(given).problem.lam == Rational(lam)
    else:
        with pytest.raises(ValueError, match=f"lam = {lam} is no contraction"):
            files.claim_of(given)


def test_half_of_a_cycle_closes_by_the_mirror_image_and_a_whole_one_by_itself():
    for mirror, sign in ((True, -1), (False, 1)):
        problem = files.claim_of(GIVEN["alpha-tilde"] | {"mirror": mirror}).problem
        assert problem.mirror is mirror
        assert problem.closure == type(problem.closure)(sign)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"kind": "special", "value": "lam", "lam": None},
            {"kind": "corner", "free": "lam", "mirror": True, "scene": {"table": "cuspless"}, "components": [0, 0]},
        ),
        (
            {"kind": "special", "value": "alpha", "lam": "1/3"},
            {"kind": "focus", "free": "alpha", "mirror": False, "scene": {"table": "egg", "lam": "1/3"},
             "components": [0, 0]},
        ),
        (
            {"kind": "flip", "table": "egg", "points": 3, "shape": {}, "lam": "1/3", "free": "alpha"},
            {"kind": "flip", "free": "alpha", "scene": {"table": "egg", "lam": "1/3"}},
        ),
        (
            {"kind": "fold", "table": "egg", "points": 5, "shape": {"alpha": "1/50"}, "lam": None},
            {"kind": "fold", "scene": {"table": "egg", "K": 5, "shape": {"alpha": "1/50"}}},
        ),
        (
            {"kind": "cycle", "table": "ellipse", "points": 0, "shape": {"a": "2"}, "lam": "1/2"},
            {"kind": "cycle", "scene": {"table": "ellipse", "shape": {"a": "2"}, "lam": "1/2"}},
        ),
        ({"kind": "cycle", "table": "egg", "points": 1, "shape": {}, "lam": None},
         {"kind": "cycle", "scene": {"table": "egg", "K": 1}}),
    ],
)  # fmt: skip
def test_files_of_the_first_version_say_the_scene_in_several_entries(given, said):
    found = files._of_first(given)
    assert {key: found[key] for key in said} == said


def test_a_file_holds_an_object(tmp_path):
    path = tmp_path / "one.json"
    path.write_text('{"kind": "cycle"}')
    assert files.read(path) == {"kind": "cycle"}
    for text in ("[1]", "3", "null"):
        path.write_text(text)
        with pytest.raises(ValueError, match="holds no JSON object"):
            files.read(path)


@pytest.mark.parametrize("kind", ["cycle", "corner", "tangency"])
@pytest.mark.parametrize("schema", [1, 2, 3, 4])
def test_a_file_is_worked_through_by_its_kind_and_its_words_are_held_to_it_as_its_version_has_them(
    monkeypatch, kind, schema
):
    """Words came with the second version, and those of a tangency with the third."""
    asked = []
    claim = files.claim_of(GIVEN["lambda-star" if kind == "corner" else "saddle-node"])
    contact = SimpleNamespace()
    monkeypatch.setattr(files, "claim_of", lambda _: claim)
    monkeypatch.setattr(tangency_entries, "claim_of", lambda _: contact)
    for module, name in ((files, "corner_proved"), (files, "proved"), (manifolds, "worked_through")):
        monkeypatch.setattr(module, name, lambda given, name=name: asked.append((name, given)) or name)
    monkeypatch.setattr(files, "_rightly_named", lambda given, given_claim: asked.append(("named", given_claim)))
    monkeypatch.setattr(files, "_rightly_said", lambda given, true: asked.append(("said", true)))
    monkeypatch.setattr(files, "document", lambda proof, version: {"proof": proof, "version": version})

    of = {"cycle": ("proved", claim), "corner": ("corner_proved", claim), "tangency": ("worked_through", contact)}[kind]
    assert files.checked({"kind": kind, "schema": schema}) == of[0]
    said = schema >= 3 or (schema == 2 and kind != "tangency")
    assert asked == [("named", of[1]), of, *([("said", {"proof": of[0], "version": schema})] if said else [])]


@pytest.mark.parametrize("schema", [0, 5])
def test_a_tangency_of_an_unknown_version_is_refused(schema):
    with pytest.raises(ValueError, match=f"schema = {schema} is unknown"):
        files.checked({"kind": "tangency", "schema": schema})


TRUE = {"kind": "cycle", "bits": 9, "checks": {"exists": True, "unique": None}}
CHAIN = dict.fromkeys(files.CHAIN, 0) | {"bits": 9}


@pytest.mark.parametrize(
    ("given", "true", "why"),
    [
        (TRUE, TRUE, ""),
        (TRUE | {"checks": {"exists": False, "unique": True}}, TRUE, ""),  # which is not believed anyhow
        (TRUE | {"bits": 8}, TRUE, "bits = 8 is not what its equations say, which is 9"),
        ({"kind": "fold"}, TRUE, "kind = 'fold' is not what its equations say, which is 'cycle'"),
        ({"kind": "cycle"}, TRUE, "bits = None is not what its equations say, which is 9"),
        (TRUE | {"checks": {"exists": True}}, TRUE, "checks must list just these: exists, unique"),
        (TRUE | {"checks": {"exists": 1, "unique": 1, "more": 1}}, TRUE, "checks must list just these"),
        (TRUE | {"checks": ["exists", "unique"]}, TRUE, "checks must list just these"),
        ({"kind": "cycle", "bits": 9}, TRUE, "checks must list just these"),
        (TRUE | {"more": 1, "also": 1}, TRUE, "the entry 'also' is unknown; accepted: kind, bits, checks"),
        (TRUE | {"orbit": 1}, TRUE, "the entry 'orbit' is unknown"),
        (TRUE | CHAIN | {"kind": "tangency"}, TRUE | {"kind": "tangency"}, ""),
        (TRUE | CHAIN | {"kind": "tangency", "x": 1}, TRUE | {"kind": "tangency"}, "the entry 'x' is unknown"),
    ],
)
def test_each_entry_is_that_of_the_proof_and_there_is_no_other(given, true, why):
    if why:
        with pytest.raises(ValueError, match=f"certificate: {why}"):
            files._rightly_said(given, true)
    else:
        files._rightly_said(given, true)


def test_a_corner_orbit_is_told_of_the_cuspless_table_and_a_focus_of_the_egg():
    ball = arb(0)
    for value, lam, scene in (
        ("lam", None, {"table": "cuspless"}),
        ("alpha", Rational(1, 3), {"table": "egg", "lam": "1/3"}),
    ):
        said = files._special(CornerClaim(value, (ball,) * 3, ball, 64, 10, lam))
        kind = "focus" if lam else "corner"
        assert said == {"kind": kind, "scene": scene, "free": value, "components": [0, 0], "mirror": not lam}


def test_of_a_tangency_the_orbit_is_told_where_it_is_proved(monkeypatch):
    claim = SimpleNamespace(chain=lambda: {"orbit": 1})
    monkeypatch.setattr(files, "name_of", lambda given, schema: f"name {schema}")
    monkeypatch.setattr(tangency_entries, "title", lambda _: "TITLE")
    monkeypatch.setattr(tangency_entries, "entries", lambda _: {"kind": "tangency", "scene": {"table": "egg"}})
    for certified in (True, False):
        found = files.document(SimpleNamespace(claim=claim, checks={"saddle": True}, certified=certified))
        wanted = {"schema": files.SCHEMA, "name": f"name {files.SCHEMA}", "kind": "tangency", "scene": {"table": "egg"}}
        wanted |= {"statement": files.WORDS["tangency"].format(scene="TITLE"), "checks": {"saddle": True}}
        assert found == wanted | ({"orbit": 1} if certified else {})
