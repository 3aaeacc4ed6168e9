"""The certificate that a region holds at most one attractor: written, read, checked anew, and altered."""

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest
from referencing import Registry, Resource

from symbolic import Scene
from verification.app.cli import main
from verification.named.theorems import theorem
from verification.proofs.unstable_curves.certificate import AtMostOneAttractor

ROOT = Path(__file__).resolve().parents[4]
SADDLE = 0, 2.0382687, -0.0454335  # of period 4, at 0.13
OTHER = 0, -2.0382687, 0.0454335
MADE = AtMostOneAttractor(Scene("cuspless"), (Fraction(13, 100),) * 2, 1024, 8192, (SADDLE, OTHER), SADDLE, 4, 0.003)


def written(**altered):
    """The document after a round trip through JSON, with altered entries; an entry that is None is removed."""
    made = json.loads(json.dumps(MADE.to_dict())) | altered
    return {name: value for name, value in made.items() if value is not None}


def renamed(**altered):
    """The altered document, with the name that belongs to its new statement."""
    made = written(**altered)
    return made | {"name": AtMostOneAttractor.from_dict(made).name}


def test_a_document_states_the_same_when_it_is_read():
    assert AtMostOneAttractor.from_dict(written()) == MADE
    schema = json.loads((ROOT / "certificates/schema/no_two_attractors_1.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    scenes = json.loads((ROOT / "certificates/schema/version_4.json").read_text(encoding="utf-8"))
    registry = Registry().with_resource("version_4.json", Resource.from_contents(scenes))
    jsonschema.Draft202012Validator(schema, registry=registry).validate(written())


@pytest.mark.slow
def test_the_command_checks_it_anew(tmp_path, capsys):
    file = tmp_path / "region.json"
    file.write_text(json.dumps(written()), encoding="utf-8")
    assert main(["check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "at most one attractor" in said
    assert said.count("proved") == 5
    file.write_text(json.dumps(renamed(columns=64, rows=64)), encoding="utf-8")
    assert main(["check", str(file)]) == 1


OTHERWISE = {
    "schema": [2, "1"],
    "kind": ["trapping region", "boundary crisis"],
    "scene": [{}, Scene("egg", alpha="0.08").document],
    "lam": [["13/100", "131/1000"], ["1/10", "1/10"], ["1/5", "1/10"], ["13/100"], ["0/0", "1"]],
    "columns": [512, 0, 2.0, True, "1024", 1 << 21],
    "rows": [4096, -1, None],
    "points": [[list(SADDLE)], [list(OTHER)], [[1, 0.4, 0.05]], [], [[0, 2.0]], [[2, 0.0, 0.0]], [[0, 1e400, 0.0]]],
    "saddle": [[0, "x", 0.0], [0, 2.0], None, [True, 0.0, 0.0], [7, 2.0, 0.0]],
    "period": [0, 4.0, 1 << 20, None],
    "half": [0, -0.003, 1, "nan", 1e400, [], None],
    "name": ["at most one attractor", None, 3],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, some in OTHERWISE.items() for value in some])
def test_an_altered_entry_is_refused(name, value):
    """The name fixes the statement, and only entries that can prove it are read."""
    with pytest.raises(ValueError, match=r"certificate|lam|scene|range|name|law|Invalid literal|could not convert"):
        theorem(written(**{name: value}))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("altered", "missing"),
    [
        ({"saddle": [0, -2.0382687, 0.0454335]}, set()),  # the mirror image: the same statement
        ({"half": 0.004}, set()),
        ({"saddle": [0, 2.0382688, -0.0454335]}, set()),
        ({"saddle": [0, 2.05, -0.0454335]}, {"saddle", "crossing"}),
        ({"period": 3}, {"saddle", "crossing"}),
        ({"half": 0.05}, {"saddle", "crossing"}),
        ({"half": 1e-5}, {"saddle", "crossing"}),
    ],
)
def test_what_is_advice_may_prove_the_same_or_nothing(altered, missing):
    found = theorem(written(**altered))
    assert found.name == MADE.name
    assert {*found.open} == missing


@pytest.mark.slow
@pytest.mark.parametrize("altered", [{"points": [[0, 0.0, 0.0], [1, 0.0, 0.0]]}, {"lam": ["1/20", "1/20"]}])
def test_another_statement_is_not_proved_by_the_same_advice(altered):
    assert not theorem(renamed(**altered)).proved


def test_points_outside_of_the_strip_are_refused():
    with pytest.raises(ValueError, match="outside"):
        theorem(renamed(points=[[0, 2.0, 0.5]])).checks  # noqa: B018


@pytest.mark.parametrize("given", ["012", (0, 1.0, 0.0), [0, 1.0], [0, 1e400, 0.0], [0, 1.0, -1e400], [0, "nan", 0.0]])
@pytest.mark.parametrize("name", ["points", "saddle"])
def test_a_phase_point_is_a_list_of_a_component_and_two_finite_numbers(name, given):
    with pytest.raises(ValueError, match="is no phase point"):
        AtMostOneAttractor.from_dict(written() | {name: [given] if name == "points" else given})
