"""The certificate format is the same on its page, in the schema and in both checkers."""

import copy
import json
import re
from pathlib import Path

import jsonschema
import pytest
from committed import FOLDER, document
from referencing import Registry, Resource

from symbolic.tables import egg
from verification.proofs.manifolds.certificate import STATEMENT, Tangency
from verification.proofs.manifolds.known import CONTACTS
from verification.proofs.periodic.cycle_in_box import STATEMENTS

ROOT = Path(__file__).parents[2]
SCHEMA, CELLS, CRISIS = (
    json.loads((FOLDER / "schema" / f"{name}.json").read_text())
    for name in ("version_4", "trapping_region_1", "boundary_crisis_1")
)
FILES = sorted(FOLDER.glob("*.json"))
SENTENCES = STATEMENTS | {"tangency": STATEMENT}
PAGE = (ROOT / "docs" / "certificate_format.md").read_text()


def valid(given: object) -> bool:
    """True if a document fits the schema of its kind."""
    kind = given.get("kind") if isinstance(given, dict) else None
    own, whole = {"trapping region": CELLS, "boundary crisis": CRISIS}, Resource.from_contents(SCHEMA)
    registry = Registry().with_resource("version_4.json", whole)  # which the others take the scene from
    return jsonschema.Draft202012Validator(own.get(kind, SCHEMA), registry=registry).is_valid(given)


def test_the_schemas_are_some():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.Draft202012Validator.check_schema(CELLS)
    jsonschema.Draft202012Validator.check_schema(CRISIS)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_committed_files_are_of_the_format(path):
    assert valid(json.loads(path.read_text()))


def test_the_folder_has_the_certificates_that_its_script_writes(make):
    assert {path.stem for path in FILES} == {*make.CERTIFICATES}


def test_the_page_on_trust_names_the_file_of_every_headline_and_no_other():
    """Names in the column of the independent checker are short: `-4` after `doubling-3` means `doubling-4`."""
    rows = [line.split("|") for line in (ROOT / "docs" / "trust.md").read_text().splitlines() if line.startswith("|")]
    results = [row for row in rows if len(row) == 8]
    said = [name.removesuffix(".json") for row in results for name in re.findall(r"`([\w.-]+)`", row[4])]
    named = {name if name[0] != "-" else f"doubling{name}" for name in said}
    examples = {"minor-axis", "cardioid", "egg-triangle", "five-waves"}  # a cycle each, and no result
    examples |= {"cardioid-period-9", "egg-period-3", "beside-8", "beside-12", "beside-16", "beside-24", "limacon-12"}
    examples |= {"limacon-24", "limacon-48"}  # of claims of the report, and of a report of a table of one's own
    examples |= {"law-in-all-words", "radius-in-words", "free-parameter", "marked-point", "own-mirror"}
    examples |= {"spline", "scatterer", "moved-waves", "law-parameter", "tangency-under-a-law"}
    examples |= {f"flower-tangency-{k}" for k in range(4)}  # of the same report

    assert len(results) - 2 >= 20  # without the header
    assert named - {"lam", "a"} == {path.stem for path in FILES} - examples


@pytest.mark.slow
def test_every_number_that_pages_and_reports_call_certified_has_a_certificate(printed, capsys, tmp_path):
    """A report of the paper is read where it exists; this one is made up, with a right and a wrong number."""
    made = tmp_path / "report.json"
    assert printed.main([str(made)]) == 0
    assert capsys.readouterr().out.endswith(" numbers, 0 without\n")

    said = [
        ("cuspless.lambda_star", "0.0712172452489160"),
        ("egg.doubling.4", "0.388761023460843"),
        ("new.claim", None),
    ]
    claims = [{"id": name, "value": value, "method": "certified"} for name, value in said]
    made.write_text(json.dumps({"claims": claims}))
    assert printed.main([str(made)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "egg.doubling.4: no certificate holds 0.388761023460843"
    assert lines[1] == "new.claim: no certificate holds a sentence that says certified"
    assert lines[2].endswith(" numbers, 2 without")


def test_a_printed_number_is_held_within_one_of_its_last_digit(printed):
    given = document("lambda-c")

    assert printed.holds(given, "0.09340")
    assert printed.holds(given, "0.0934003354313602")
    assert not printed.holds(given, "0.0934003354313604")
    assert printed.holds(document("phi-star"), "-0.02898")


@pytest.mark.parametrize("key", ["name", "statement", "scene", "radius", "checks", "kind"])
def test_the_schema_asks_for_every_entry_and_for_no_other(key):
    given = document("lambda-c")
    without = copy.deepcopy(given)
    del without[key]

    assert not valid(without)
    assert not valid(given | {"proved_by": "me"})
    assert not valid(given | {"checks": given["checks"] | {"unique": None}})


def test_a_tangency_that_is_not_proved_has_no_orbit_and_is_not_of_the_format():
    made = Tangency(CONTACTS["merging"], egg(3).at(alpha="2/25"), "0.44343525", 20).document()

    assert "orbit" not in made
    assert not valid(json.loads(json.dumps(made)))


def test_both_readers_have_the_same_sentences_and_the_page_has_them(check):
    """They are written three times on purpose: a checker does not import its statement."""
    marks = {"scene": "*scene*", "n": "*n*", "free": "*free*"}
    what = {kind: words.format(scene="S", n="N", free="F") for kind, words in SENTENCES.items()}
    read = {
        kind: words.format(scene="S", n="N", free="F", what=check.WHAT.get(kind)) for kind, words in check.SAYS.items()
    }

    assert {kind: what[kind] for kind in read} == read
    for words in SENTENCES.values():
        assert words.format(**marks) in PAGE


def test_the_page_names_every_kind_entry_and_item(check):
    items = {item for kind in check.KINDS.values() for item in kind} | {*Tangency.hypotheses()}
    parts = ("zero", "tangency", "scene", "manifold")
    entries = {name for part in parts for name in SCHEMA["$defs"][part]["properties"]}

    assert all(f"`{word}`" in PAGE for word in items | entries | set(check.KINDS) | set(check.PAPER))


def test_every_table_has_one_definition_in_both_readers(check):
    """The checker's five formulas at points, against the package's exact tables."""
    from symbolic import tables

    for name, (letter, _) in check.PAPER.items():
        shape = {"a": "3/2", "alpha": "2/25"}.get(letter)
        table = tables.named(name).at(**({letter: shape} if letter else {}))
        _, _, title = check.read_scene(
            {"table": name, "lam": "1"} | ({"shape": {letter: shape}} if letter else {}), "", 64
        )
        ours = check.read_scene({"table": name, "lam": "1"} | ({"shape": {letter: shape}} if letter else {}), "", 64)[0]

        assert title.startswith(name)
        for part, component in enumerate(table.components):
            low, high = ours.ends(part, 64)
            for given, true in ((low, component.start), (high, component.end)):
                assert abs(given.real() - float(true)) < 1e-15
            middle = (component.start * 3 + component.end) / 4
            place = (low * 3 + high) / 4
            x, y, *_ = ours.at(part, place, ours.letters, 64)
            assert (
                max(abs(check.I.of(a, 64).real() - float(b)) for a, b in zip((x, y), component.at(middle), strict=True))
                < 1e-14
            )
