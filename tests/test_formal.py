"""The Coq theorems: generated files are fresh, nothing is admitted, and assumptions are those on record.

`make formal` checks the proofs themselves, where Coq is installed.
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORMAL = ROOT / "formal"


def script(name):
    spec = importlib.util.spec_from_file_location(f"formal_{name}", FORMAL / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


check = script("check")
ENCLOSURES = {"Fold", "Jets", "Checked", "Sentences", "Doublings", "Numbers"}
PROOFS = [FORMAL / f"{name}.v" for name in check.FILES]


def recorded():
    lines = [line for line in check.RECORD.read_text().splitlines() if not line.startswith("#")]
    return {name: groups.split() for name, groups in (line.split(": ") for line in lines)}


@pytest.mark.slow
def test_the_generated_definitions_are_what_sympy_and_the_printed_claims_give():
    assert script("generate").text() == (FORMAL / "Generated.v").read_text()


@pytest.mark.slow
def test_the_boxes_are_what_newtons_method_finds():
    assert script("boxes").text() == (FORMAL / "Boxes.v").read_text()


def test_every_file_of_the_folder_is_checked():
    assert sorted(FORMAL.glob("*.v")) == sorted(PROOFS)


@pytest.mark.parametrize("path", PROOFS, ids=lambda path: path.stem)
def test_nothing_is_admitted_or_postulated(path):
    code = re.sub(r"\(\*.*?\*\)", "", path.read_text(), flags=re.DOTALL)

    assert re.findall(r"\b(Admitted|admit|give_up|Axioms?|Parameters?|Conjecture|Unset|bypass_check)\b", code) == []


@pytest.mark.parametrize("path", PROOFS, ids=lambda path: path.stem)
def test_hypotheses_stand_in_sections_only(path):
    """Outside a section `Hypothesis` and `Variable` are axioms; inside they become premisses of each theorem."""
    depth, outside = 0, []
    for line in path.read_text().splitlines():
        depth += line.startswith("Section ") - bool(re.match(r"End \w+\.", line))
        if depth == 0 and re.match(r"\s*(Hypothes[ie]s|Variables?|Context)\b", line):
            outside.append(line)

    assert (depth, outside) == (0, [])


def test_every_file_with_theorems_is_in_the_record_of_assumptions():
    assert list(recorded()) == [name for name, _ in check.files()]


def test_theorems_assume_the_real_numbers_and_only_enclosures_the_machine():
    for name, groups in recorded().items():
        assert set(groups) <= {"reals", "classic", *(["machine"] if name in ENCLOSURES else [])}, name


def test_every_theorem_is_asked_for_its_assumptions():
    asked = check.questions()

    assert [name for file, names in check.files() for name in names if f"@Pinball.{file}.{name}," not in asked] == []


def test_an_axiom_of_no_group_is_printed_in_full():
    printed = "Cone:\nAxioms:\nSecret.axiom\n  : forall P : Prop, P\nClassical_Prop.classic : forall P, P\n"

    assert list(check.grouped(printed)) == ["Cone: Secret.axiom classic"]
    assert list(check.grouped("Cone:\nClosed under the global context\n")) == ["Cone: nothing"]


def test_without_coq_make_formal_says_in_one_sentence_what_it_needs(tmp_path):
    (tmp_path / "python3").symlink_to(sys.executable)
    make = shutil.which("make")
    for tool in ("sh", "env"):
        (tmp_path / tool).symlink_to(shutil.which(tool))
    result = subprocess.run(
        [make, "--no-print-directory", "formal"],
        cwd=ROOT,
        env={**os.environ, "PATH": str(tmp_path), "MAKEFLAGS": ""},
        capture_output=True,
        text=True,
    )

    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.splitlines()[0] == check.NEEDED


def test_the_page_names_every_theorem():
    page = (ROOT / "docs" / "formal.md").read_text()

    assert [name for file, names in check.files() for name in names if f"`{file}.{name}`" not in page] == []
