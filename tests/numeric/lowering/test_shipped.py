"""The shipped table IRs are those that SymPy makes from the exact tables, and serve only these sources."""

import json
import subprocess
import sys
from pathlib import Path

from numeric.lowering import cache, shipped
from numeric.lowering.program import SOURCES

MADE = json.loads(Path(shipped.HOME).read_text(encoding="utf-8"))


def test_they_are_what_is_derived():
    assert MADE["tables"] == shipped.derived()


def test_other_sources_are_served_by_derivation():
    assert shipped.shipped("ellipse", MADE["sources"]) == MADE["tables"]["ellipse"]
    assert shipped.shipped("ellipse", "other") is None


def test_the_first_result_asks_no_sympy(tmp_path, monkeypatch):
    """With an empty cache and a shipped file made from the current sources, as `make test` ensures first."""
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path / "cache"))
    program = (
        "import sys; from numeric import PinballMap; PinballMap('stadium', lam=0.95).orbit(0.3, 0.2, 10); "
        "print('sympy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == str(MADE["sources"] != cache.sources(*SOURCES))
