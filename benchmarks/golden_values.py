"""What the commands print about periodic orbits today, to the last digit, kept so that a change of the engine shows.

python benchmarks/golden_values.py            # writes tests/verification/golden/values.json
python benchmarks/golden_values.py --check    # compares; exit status 1 when a digit moved
"""

import json
import math
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from verification.app.cli import main

KEPT = Path(__file__).parents[1] / "tests" / "verification" / "golden" / "values.json"
EGG = "--alpha 0.08"
LOCATED = [
    "lambda-star --digits 60",
    "phi-star --digits 60",
    "lambda-c --digits 40",
    "alpha-tilde --lam 1/3 --digits 40",
    "alpha-hat --lam 1/3 --digits 40",
    f"saddle-node {EGG} --digits 40",
    f"symmetry-breaking {EGG} --digits 40",
    *(f"doubling {EGG} --n {n} --digits 30" for n in range(3, 9)),
    f"merging-crisis {EGG} --digits 20",
    f"boundary-crisis {EGG} --digits 20",
    f"symmetry-restoring {EGG} --digits 20",
    f"band-merging {EGG} --period 4 --digits 16",
    f"window-end {EGG} --period 15 --digits 16",
    f"family-end {EGG} --period 8 --digits 16",
]
FOLLOWED = [
    f"egg {EGG} --cycle triangle --lam 0.37:1 --digits 20",
    "cuspless --cycle horizontal --lam 0:1 --switch 2",
    "ellipse --a 1.5 --cycle minor-axis --lam 0:1",
    "egg --alpha 0.08 --lam 0.5 --cycle diameter --shape 0.01:0.1",
]
FOUND = [
    f"egg {EGG} --lam 0.5 --period 8 --count 4 --prove 3",
    f"egg {EGG} --lam 0.2 --period 6 --count 3 --prove 2",
    "cuspless --lam 0.09 --period 6",
    "ellipse --a 1.5 --lam 0.9 --period 4",
]
FLOATS = 1e-9
LEFT_OUT = ("seconds", "newton", "gmpy2", "points", "title", "resolution")  # the clock, the search, and words
COMMANDS = [
    *(f"locate {text}" for text in LOCATED),
    *(f"follow {text}" for text in FOLLOWED),
    *(f"cycles {text}" for text in FOUND),
]


def answer(command: str) -> object:
    """Exit status and JSON of a command, without what depends on the clock."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answer.json"
        status = main([*command.split(), "--json", str(path)])
        return {"exit": status, "says": timeless(json.loads(path.read_text())) if path.is_file() else None}


def timeless(said: object) -> object:
    """The same without seconds, and without how the search went."""
    if isinstance(said, dict):
        return {key: timeless(value) for key, value in said.items() if key not in LEFT_OUT}
    return [timeless(value) for value in said] if isinstance(said, list) else said


def close(kept: object, now: object) -> bool:
    """Equal, where floats may differ in their last digits: processors have libraries of their own."""
    if isinstance(kept, dict) and isinstance(now, dict):
        return kept.keys() == now.keys() and all(close(kept[key], now[key]) for key in kept)
    if isinstance(kept, list) and isinstance(now, list):
        return len(kept) == len(now) and all(map(close, kept, now))
    if isinstance(kept, float) and isinstance(now, float):
        return math.isclose(kept, now, rel_tol=FLOATS, abs_tol=FLOATS)
    return kept == now


def differences(kept: dict[str, object], now: dict[str, object]) -> list[str]:
    """One line for each command whose answer moved."""
    return [command for command in kept if not close(kept[command], now.get(command))]


def run() -> dict[str, object]:
    """Every command, two at a time; balls hold ambient state, so each has a process."""
    with ProcessPoolExecutor(2) as pool:
        return dict(zip(COMMANDS, pool.map(answer, COMMANDS), strict=True))


if __name__ == "__main__":
    now = run()
    if "--check" in sys.argv:
        moved = differences(json.loads(KEPT.read_text()), now)
        sys.stdout.write("\n".join(moved or ["every digit as kept"]) + "\n")
        sys.exit(bool(moved))
    KEPT.parent.mkdir(exist_ok=True)
    KEPT.write_text(json.dumps(now, indent=1, sort_keys=True) + "\n")
