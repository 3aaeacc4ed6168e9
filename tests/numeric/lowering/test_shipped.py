"""The table IRs that come with the package are what SymPy makes of the exact tables, and serve no other sources."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from numeric.lowering import cache, shipped
from numeric.lowering.program import SOURCES, table_ir

MADE = json.loads(Path(shipped.HOME).read_text(encoding="utf-8"))


def test_they_are_what_is_derived():
    assert MADE["tables"] == shipped.derived()


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """A file of one's own in the place of the package's, and an empty cache."""
    home = tmp_path / "shipped.json"
    monkeypatch.setattr(shipped, "HOME", str(home))
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path / "cache"))
    return home


def test_other_sources_are_served_by_derivation(elsewhere):
    wrong = dict.fromkeys(MADE["tables"], MADE["tables"]["circle"])
    elsewhere.write_text(json.dumps({"sources": "other", "tables": wrong}))

    assert shipped.shipped("ellipse", cache.sources(*SOURCES)) is None
    assert table_ir("ellipse").as_text() == MADE["tables"]["ellipse"]


@pytest.mark.parametrize("damaged", ["", "{", "[]", '{"tables": {}}', '{"sources": 1}'])
def test_a_damaged_or_missing_file_is_as_good_as_none(elsewhere, damaged):
    assert shipped.shipped("circle", "x") is None
    elsewhere.write_text(damaged)
    assert shipped.shipped("circle", "x") is None


def test_written_when_the_sources_changed_and_not_again(elsewhere):
    assert shipped.ship()
    made = elsewhere.read_text()

    assert json.loads(made)["tables"] == MADE["tables"]
    assert not shipped.ship()
    assert elsewhere.read_text() == made


def test_the_first_result_asks_no_sympy(elsewhere):
    """In an empty cache; the file is made for these sources first, as `make test` does."""
    shipped.ship()
    program = (
        f"from numeric.lowering import shipped; shipped.HOME = {str(elsewhere)!r}; import sys; "
        "from numeric import PinballMap; PinballMap('stadium', lam=0.95).orbit(0.3, 0.2, 10); "
        "print('sympy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == "False"
