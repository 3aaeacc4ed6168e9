"""The cache folder is never needed: read-only, full, truncated or shared, the results are the same."""

import os
import subprocess
import sys
import warnings

import pytest

from numeric import PinballMap, Status, cache, machine

PROGRAM = """
import sys
from numeric import PinballMap
step = PinballMap("egg", lam=0.5, alpha="0.08").step(0.3, 0.2)
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
    assert len(list(tmp_path.iterdir())) == 2


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


def test_without_llvmlite_numpy_does_the_work(monkeypatch):
    monkeypatch.setattr(machine, "_llvm", lambda: None)
    step = PinballMap("ellipse", lam=0.5, a=2).step(0.3, 0.2)

    assert step.status == Status.REGULAR
    assert step.theta == PinballMap("ellipse", lam=0.5, a=2, kernels=False).step(0.3, 0.2).theta
