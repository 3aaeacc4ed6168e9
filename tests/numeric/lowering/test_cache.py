"""The cache folder is never needed: read-only, full, truncated or shared, the results are the same."""

import ast
import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from numeric import PinballMap, Status
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


def test_the_second_run_needs_no_sympy(tmp_path):
    cold, warm = run(tmp_path)[0], run(tmp_path)[0]

    assert cold[0] == warm[0]
    assert (cold[1], warm[1]) == ("True", "False")
    assert {path.name.split("-")[0] for path in tmp_path.iterdir()} - {"sources"} == {"table_ir", "kernel"}


def test_damaged_files_are_written_again(tmp_path):
    (whole, _), _ = run(tmp_path)
    for path in tmp_path.iterdir():
        path.write_bytes(path.read_bytes()[:-7])
    (again, _), _ = run(tmp_path)
    warm, _ = run(tmp_path)

    assert again == whole
    assert warm == [whole, "False"]


def test_a_folder_that_cannot_be_used_is_named_once(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("a file where a folder should be")
    (found, _), told = run(blocked / "cache")

    assert found == run(tmp_path)[0][0]
    assert told.count("cannot be written") == 1


def test_the_cache_can_be_switched_off(tmp_path):
    environment = os.environ | {"PINBALL_CACHE": "", "HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True, capture_output=True)

    assert list(tmp_path.iterdir()) == []


def test_processes_that_write_at_once_do_not_mix(tmp_path):
    environment = os.environ | {"PINBALL_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", PROGRAM]
    running = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    answers = {process.communicate()[0].split()[0] for process in running}

    assert len(answers) == 1
    assert run(tmp_path)[0] == [answers.pop(), "False"]


def test_a_full_disk_is_survived(tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    monkeypatch.setattr("os.fdopen", full)
    monkeypatch.setattr(cache, "_said", set())
    with pytest.warns(UserWarning, match="No space left on device"):
        cache.write("kernel", "a", b"content")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cache.write("kernel", "b", b"content")

    assert [path for path in tmp_path.iterdir() if not path.name.startswith(".")] == []


def test_without_llvmlite_numpy_does_the_work(monkeypatch, tmp_path):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))  # or compiled code is read from there
    monkeypatch.setattr(machine, "_loaded", {})
    monkeypatch.setattr(machine, "_llvm", lambda: None)
    step = PinballMap("ellipse", lam=0.5, a=2).step(0.3, 0.2)

    assert step.status == Status.REGULAR
    assert step.theta == PinballMap("ellipse", lam=0.5, a=2, kernels=False).step(0.3, 0.2).theta


def test_what_is_written_is_read_under_its_own_key_and_no_other(tmp_path, monkeypatch):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path / "deep" / "folder"))
    cache.write("kernel", "a", "b", b"content")

    assert cache.read("kernel", "a", "b") == b"content"
    assert [cache.read(*key) for key in (("kernel", "ab"), ("kernel", "a"), ("image", "a", "b"))] == [None] * 3
    cache.write("kernel", "a", "b", b"")
    assert cache.read("kernel", "a", "b") == b""
    assert len(list((tmp_path / "deep" / "folder").iterdir())) == 1


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


def test_keys_keep_their_parts_apart():
    keys = {cache.key_of(*parts) for parts in (("ab",), ("a", "b"), ("a", "b", ""), ("", "ab"))}

    assert len(keys) == 4
    assert {len(key) for key in keys} == {32}


def test_sources_depend_on_every_file_of_the_packages_and_on_nothing_else(tmp_path, monkeypatch):
    (tmp_path / "numeric" / "inside").mkdir(parents=True)
    file = tmp_path / "numeric" / "inside" / "one.py"
    file.write_text("x = 1")
    (tmp_path / "numeric" / "cache.py").write_text("")
    (tmp_path / "symbolic").mkdir()
    (tmp_path / "symbolic" / "two.py").write_text("")
    monkeypatch.setattr(cache, "__file__", str(tmp_path / "numeric" / "inside" / "cache.py"))
    digest = cache.sources.__wrapped__
    first, both = digest("numeric"), digest("symbolic", "numeric")
    (tmp_path / "numeric" / "notes.txt").write_text("no program")
    (tmp_path / "symbolic" / "two.py").write_text("y = 2")

    assert digest("numeric") == first != both
    assert digest("symbolic", "numeric") != both
    file.write_text("x = 2")
    assert digest("numeric") != first
    file.rename(file.with_name("two.py"))
    assert digest("numeric") not in (first, both)


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
    """The modules that the maker of an entry imports, and those that they import, lazy imports counted."""
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


def test_a_failed_write_leaves_nothing_and_names_the_folder_and_the_reason(tmp_path, monkeypatch):
    def refused(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    monkeypatch.setattr("os.replace", refused)
    monkeypatch.setattr(cache, "_said", set())
    with pytest.warns(
        UserWarning, match=rf"the cache folder {tmp_path} cannot be written \(Permission denied\); working"
    ):
        cache.write("kernel", "a", b"content")

    assert list(tmp_path.iterdir()) == []
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("PINBALL_CACHE", str(blocked / "below"))
    with pytest.warns(UserWarning, match="cannot be written"):
        cache.write("kernel", "a", b"content")
