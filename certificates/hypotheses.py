"""Does a test notice when the second reader leaves a hypothesis out? `python certificates/hypotheses.py [NAME...]`.

Each condition of a `need` in check.py and the files beside it is taken for true, one at a time, in a copy of this
folder and its tests; the quick ones of tests/certificates are run on it. One line for each: killed or SURVIVED.
"""

import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
READER = ("check", "boundaries", "corner", "crisis", "curves", "formulas", "region", "tangency")
TESTS = (
    "test_crisis",
    "test_hypotheses",
    "test_region",
    "test_second_reader",
    "test_own_tables",
    "test_simple_curves",
    "test_two_arithmetics",
)
OWN = {
    "boundaries": "own_tables",
    "crisis": "crisis",
    "curves": "simple_curves",
    "formulas": "own_tables",
    "region": "region",
}  # asked first
SLOW = ("bytes", "again", "empty_folder", "bay", "line_of_the_package", "short", "generated", "written")


def conditions(text: str) -> Iterator[tuple[ast.Call, ast.expr]]:
    """Each call of `need` that says why, with its condition."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "need" and len(node.args) > 1:
            yield node, node.args[0]


def without(text: str, condition: ast.expr) -> str:
    """The text with `True` for a condition."""
    lines = [line.encode() for line in text.splitlines(keepends=True)]
    starts = [sum(map(len, lines[:k])) for k in range(len(lines))]
    first = starts[condition.lineno - 1] + condition.col_offset
    last = starts[(condition.end_lineno or 1) - 1] + (condition.end_col_offset or 0)
    whole = b"".join(lines)
    return (whole[:first] + b"True" + whole[last:]).decode()


def main() -> None:
    """Counts, file by file."""
    for name in sys.argv[1:] or READER:
        text = (ROOT / "certificates" / f"{name}.py").read_text(encoding="utf-8")
        for call, condition in conditions(text):
            with tempfile.TemporaryDirectory() as folder:
                for part in ("certificates", "tests/certificates"):
                    shutil.copytree(ROOT / part, Path(folder) / part)
                (Path(folder) / "certificates" / f"{name}.py").write_text(without(text, condition), encoding="utf-8")
                first = f"test_{OWN.get(name, 'second_reader')}"
                tests = [f"tests/certificates/{test}.py" for test in (first, *(t for t in TESTS if t != first))]
                chosen = " and ".join(f"not {word}" for word in SLOW)
                command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests, "-k", chosen]
                around = os.environ | {"PYTHONPATH": str(ROOT)}
                done = subprocess.run(command, cwd=folder, env=around, capture_output=True, check=False)
            said = (ast.get_source_segment(text, call) or "").replace("\n", " ")[:90]
            sys.stdout.write(f"{'killed' if done.returncode else 'SURVIVED'} {name}:{call.lineno} {said}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
