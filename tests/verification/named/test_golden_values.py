"""What the commands print about periodic orbits is what they printed before: the quick ones, to the last digit.

`benchmarks/golden_values.py --check` asks the others too.
"""

import importlib.util
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
spec = importlib.util.spec_from_file_location("golden_values", ROOT / "benchmarks" / "golden_values.py")
assert spec is not None
assert spec.loader is not None
golden = importlib.util.module_from_spec(spec)
spec.loader.exec_module(golden)

QUICK = [
    "locate lambda-star --digits 60",
    "locate lambda-c --digits 40",
    "locate saddle-node --alpha 0.08 --digits 40",
    "locate doubling --alpha 0.08 --n 4 --digits 30",
    "follow ellipse --a 1.5 --cycle minor-axis --lam 0:1",
    "cycles ellipse --a 1.5 --lam 0.9 --period 4",
]


@pytest.mark.parametrize("command", QUICK)
def test_a_command_prints_the_digits_that_it_printed(command):
    kept = json.loads(golden.KEPT.read_text())

    assert golden.differences({command: kept[command]}, {command: golden.answer(command)}) == []


def test_a_digit_that_moves_is_told():
    kept = {"locate x": {"exit": 0, "says": {"value": "0.5001", "multipliers": [0.25]}}}
    moved = {"locate x": {"exit": 0, "says": {"value": "0.5002", "multipliers": [0.25]}}}

    assert golden.differences(kept, kept) == []
    assert golden.differences(kept, moved) == ["locate x"]
