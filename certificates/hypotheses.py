"""Does a test notice when the second reader leaves a hypothesis out? `python certificates/hypotheses.py [NAME...]`.

In a copy of this folder and its tests one thing at a time is taken for true, and the tests are run on it: each
condition of a `need` in check.py and the files beside it; each verdict, which is what is assigned to one of `VERDICTS`
or returned by a function `settled`, and each of several conditions that have to hold together; and each call of a
function that proves or refuses something and gives nothing back. What `settled` excludes first is taken for false.
One line for each: killed or SURVIVED. A reader that does not end where it ended before is killed as well.
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
READER = ("check", "boundaries", "corner", "crisis", "curves", "formulas", "long", "region", "tangency")
TESTS = (
    "test_crisis",
    "test_hypotheses",
    "test_region",
    "test_second_reader",
    "test_own_tables",
    "test_long_cycles",
    "test_simple_curves",
    "test_tangencies",
    "test_two_arithmetics",
    "steps/test_cells_of_regions",
    "steps/test_contacts_by_hand",
    "steps/test_long_steps",
    "steps/test_pieces_of_curves",
    "steps/test_words_by_hand",
)
OWN = {
    "boundaries": "own_tables",
    "crisis": "crisis",
    "curves": "simple_curves",
    "formulas": "own_tables",
    "long": "long_cycles",
    "region": "region",
    "tangency": "tangencies",
}  # asked first
SLOW = ("bytes", "again", "empty_folder", "bay", "of_a_report", "line_of_the_package", "short", "generated", "written")


VERDICTS = ("done", "seen", "fit", "fits", "fair", "grows", "whole")  # names in the reader
LONG = 400  # seconds
PROVES = ("Proves", "Refuses")  # how the docstring begins of a function that gives nothing back


def conditions(text: str) -> Iterator[tuple[ast.expr, str]]:
    """What is left out, each with what it is taken for."""
    tree = ast.parse(text)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    provers = {node.name for node in functions if (ast.get_docstring(node) or "").startswith(PROVES)}
    settling = [line for node in functions if node.name == "settled" for line in ast.walk(node)]
    for node in ast.walk(tree):
        verdict: ast.expr | None = None
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "need" and len(node.args) > 1:
            verdict = node.args[0]
        elif isinstance(node, ast.Return) and node in settling:
            verdict = node.value
        elif isinstance(node, ast.Assign):
            verdict = node.value if getattr(node.targets[0], "id", "") in VERDICTS else None
        elif isinstance(node, ast.If) and node in settling:
            verdict = node.test if ast.unparse(node.body[0]) == "return True" else None
            yield from [] if verdict else [(node.test, "False")]
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            called = node.value.func
            yield from [(node.value, "None")] if getattr(called, "id", getattr(called, "attr", "")) in provers else []
        yield from ((part, "True") for part in together(verdict))


def together(verdict: ast.expr | None) -> Iterator[ast.expr]:
    """A verdict, and each of several conditions of it that have to hold together; none of one that is said outright."""
    if verdict and not isinstance(verdict, ast.Constant):
        yield verdict
    if isinstance(verdict, ast.BoolOp):
        for part in verdict.values:
            yield from (part,) if isinstance(verdict.op, ast.And) else ()
            yield from (inner for inner in together(part) if inner is not part)


def without(text: str, condition: ast.expr, taken: str = "True") -> str:
    """The text with `True`, or what else a condition is taken for, in its place."""
    lines = [line.encode() for line in text.splitlines(keepends=True)]
    starts = [sum(map(len, lines[:k])) for k in range(len(lines))]
    first = starts[condition.lineno - 1] + condition.col_offset
    last = starts[(condition.end_lineno or 1) - 1] + (condition.end_col_offset or 0)
    whole = b"".join(lines)
    return (whole[:first] + taken.encode() + whole[last:]).decode()


def verdict_on(name: str, text: str) -> str:
    """What the tests say of a reader one of whose files has this text; those of the file itself are asked first."""
    first = f"test_{OWN.get(name, 'second_reader')}"
    tests = [f"tests/certificates/{test}.py" for test in (first, *(t for t in TESTS if t != first))]
    chosen = " and ".join(f"not {word}" for word in SLOW)
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests, "-k", chosen]
    around = os.environ | {"PYTHONPATH": str(ROOT)}
    with tempfile.TemporaryDirectory() as folder:
        for part in ("certificates", "tests/certificates"):
            shutil.copytree(ROOT / part, Path(folder) / part)
        (Path(folder) / "certificates" / f"{name}.py").write_text(text, encoding="utf-8")
        try:
            run = subprocess.run(command, cwd=folder, env=around, capture_output=True, check=False, timeout=LONG)
        except subprocess.TimeoutExpired:
            return "killed, does not end:"
    return "killed" if run.returncode else "SURVIVED"


def main() -> None:
    """A line for each hypothesis, file by file."""
    for name in sys.argv[1:] or READER:
        text = (ROOT / "certificates" / f"{name}.py").read_text(encoding="utf-8")
        if verdict_on(name, text) != "SURVIVED":
            sys.exit(f"{name}: the tests fail, or take more than {LONG} s, with every hypothesis in its place")
        for condition, taken in conditions(text):
            said = " ".join((ast.get_source_segment(text, condition) or "").split())[:90]
            found = verdict_on(name, without(text, condition, taken))
            sys.stdout.write(f"{found} {name}:{condition.lineno} {said}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
