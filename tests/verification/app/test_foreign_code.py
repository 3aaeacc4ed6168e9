"""No process that the package starts runs a file of the user's current folder."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
STARTS = {"Popen", "run", "call", "check_call", "check_output", "create_subprocess_exec", "create_subprocess_shell"}
CHILDREN = {
    "a formula of the live table": """
import asyncio
from verification.app.cli import refusal
assert asyncio.run(refusal(["orbit", "circle", "--lam", "1/2", "--start", "0,0.1", "--bounces", "2"], 60)) is None
""",
    "workers": """
import operator
from numeric.sweeps.workers import in_processes
assert list(in_processes(abs, [[-1]], 1, ["json"])) == [(-1, 1)]
""",
}


@pytest.mark.slow
@pytest.mark.parametrize("child", CHILDREN)
def test_files_of_the_current_folder_are_not_run(tmp_path, child):
    """The folder contains a file named after each module of the standard library."""
    for name in (*sys.stdlib_module_names, "numpy", "mpmath", "click", "verification"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'RAN')!r}, 'a').write({name!r})\nraise SystemExit")
    own = os.environ | {"PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-P", "-c", CHILDREN[child]]
    done = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, check=False, timeout=120)

    assert not (tmp_path / "RAN").exists(), (tmp_path / "RAN").read_text()
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_every_child_process_is_started_by_the_one_command():
    """Code that starts Python never names the executable; only the workers use multiprocessing."""
    starting = set()
    for storey in ("symbolic", "numeric", "verification"):
        for path in (ROOT / storey).rglob("*.py"):
            text = path.read_text()
            calls = [node.func for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
            named = [func for func in calls if isinstance(func, ast.Attribute) and func.attr in STARTS]
            if any(ast.unparse(func.value) in ("subprocess", "asyncio", "asyncio.subprocess") for func in named):
                starting.add(path.relative_to(ROOT).as_posix())
                assert "own_command" in text
                assert "sys.executable" not in text
            if "get_context" in text or "ProcessPoolExecutor" in text or "os.fork" in text:
                assert path.name == "workers.py"

    assert starting == {"verification/app/cli.py", "verification/measure/work/plain.py"}
