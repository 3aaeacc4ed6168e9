"""The cache folder is never required: when it is read-only, full, truncated or shared, the results are the same."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from numeric.kernels import machine
from numeric.lowering import cache, program

PROGRAM = """
import sys
from numeric import PinballMap
step = PinballMap("semi_ellipse", lam=0.5, a=3).step(0.3, 0.2)  # not one that comes with the package
print(float(step.theta).hex(), "sympy" in sys.modules)
"""


def run(folder, program=PROGRAM):
    environment = os.environ | {"PINBALL_CACHE": str(folder)}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split(), done.stderr


@pytest.mark.slow
def test_the_second_run_needs_no_sympy(tmp_path):
    cold, warm = run(tmp_path)[0], run(tmp_path)[0]

    assert cold[0] == warm[0]
    assert (cold[1], warm[1]) == ("True", "False")
    assert {path.name.split("-")[0] for path in tmp_path.iterdir()} - {"sources"} == {"table_ir", "kernel"}


@pytest.mark.slow
def test_damaged_files_are_written_again(tmp_path):
    (whole, _), _ = run(tmp_path)
    for path in tmp_path.iterdir():
        path.write_bytes(path.read_bytes()[:-7])
    (again, _), _ = run(tmp_path)
    warm, _ = run(tmp_path)

    assert again == whole
    assert warm == [whole, "False"]


@pytest.mark.slow
def test_a_folder_that_cannot_be_used_is_named_once(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("a file where a folder should be")
    (found, _), told = run(blocked / "cache")

    assert found == run(tmp_path)[0][0]
    assert told.count("cannot be written") == 1


@pytest.mark.slow
def test_the_cache_can_be_switched_off(tmp_path):
    environment = os.environ | {"PINBALL_CACHE": "", "HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True, capture_output=True)

    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_processes_that_write_at_once_do_not_mix(tmp_path):
    environment = os.environ | {"PINBALL_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", PROGRAM]
    running = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    answers = {process.communicate()[0].split()[0] for process in running}

    assert len(answers) == 1
    assert run(tmp_path)[0] == [answers.pop(), "False"]


WITHOUT_LLVM = "import sys; sys.modules['llvmlite'] = sys.modules['llvmlite.binding'] = None\n"
FULL = "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
FULL += "resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"


@pytest.mark.slow
@pytest.mark.parametrize("fault", [WITHOUT_LLVM, FULL], ids=["no compiler", "full disk"])
def test_without_a_compiler_and_on_a_full_disk_the_landing_is_the_same(fault, tmp_path):
    (usual, _), _ = run(tmp_path / "usual")
    (found, _), told = run(tmp_path / "other", fault + PROGRAM)

    assert abs(float.fromhex(found) - float.fromhex(usual)) < 1e-14
    assert told.count("Warning") <= 2
    assert "Traceback" not in told


@pytest.mark.parametrize(
    "damage", [lambda old: old[:-1], lambda old: old + b"x", lambda old: b"", lambda old: b"\0" + old[1:]]
)
def test_a_damaged_entry_is_none(damage, tmp_path, monkeypatch):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    cache.write("kernel", "a", b"content")
    (path,) = tmp_path.iterdir()
    path.write_bytes(damage(path.read_bytes()))

    assert cache.read("kernel", "a") is None


def test_the_folder_is_the_one_that_was_chosen(tmp_path, monkeypatch):
    for name in ("PINBALL_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache.folder() == str(tmp_path / ".cache" / "pinball-billiards")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.folder() == str(tmp_path / "xdg" / "pinball-billiards")
    monkeypatch.setenv("PINBALL_CACHE", "here")
    assert cache.folder() == "here"
    monkeypatch.setenv("PINBALL_CACHE", "")
    assert cache.folder() is None
    cache.write("kernel", "a", b"content")
    assert cache.read("kernel", "a") is None
    monkeypatch.delenv("PINBALL_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "~nobody/cache")
    assert cache.folder() is None


TYPES = "symbolic.expressions.numbers"  # protocols, of which no digit and no instruction depends


@pytest.mark.parametrize(
    ("module", "folders", "besides"),
    [
        # what a table IR is made of and by is in a kernel's key, since the IR itself is
        (
            "numeric.kernels.text",
            machine.SOURCES,
            {TYPES, "numeric.lowering.lower", "symbolic.tables.table", "symbolic.tables.scene"},
        ),
        ("numeric.lowering.lower", program.SOURCES, {TYPES}),
    ],
    ids=["kernel", "table IR"],
)
def test_digests_hold_every_file_that_an_entry_depends_on(module, folders, besides):
    """The modules that the maker of an entry imports, directly or through others, lazily or not."""
    root, waiting, seen = Path(cache.__file__).parents[2], [module], set()
    while waiting:
        name = waiting.pop()
        path = root.joinpath(*name.split(".")).with_suffix(".py")
        if name in seen | besides or not path.is_file():
            continue
        seen.add(name)
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in ("numeric", "symbolic"):
                waiting += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]

    assert len(seen) > 5
    assert {name for name in seen if not name.replace(".", "/").startswith(folders)} == set()
