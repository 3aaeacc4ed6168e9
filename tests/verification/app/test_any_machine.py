"""The same results on unusual machines: few instructions, no assertions or locale or home, little memory, threads."""

import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PROGRAM = """
import sys
import numpy as np
from numeric import PinballMap
from verification.app.cli import main
BEFORE
map = PinballMap("egg", lam=0.7, alpha="0.08")
theta = np.linspace(-3, 3, 640)
orbit = map.orbit(theta, 0 * theta, 20, threads=THREADS)
print(orbit.theta[-1].tobytes().hex()[:400], float(np.sum(orbit.x)).hex())
AFTER
sys.exit(main(["locate", "lambda-c", "--digits", "20", "--json", "-"]))
"""
PROCESSOR = """
from numeric.kernels import machine
llvm = machine._llvm()
if llvm.get_process_triple().startswith("x86_64"):
    target = llvm.Target.from_default_triple()
    machine._target = lambda: target.create_target_machine(cpu="{}", features="", opt=3)
"""
WITHOUT = {"AVX-512": PROCESSOR.format("haswell"), "AVX2": PROCESSOR.format("x86-64")}
FORK = """
import os
child = os.fork()
if child == 0:
    again = map.orbit(theta, 0 * theta, 20, threads=2)
    os._exit(0 if again.theta.tobytes() == orbit.theta.tobytes() else 1)
if os.waitpid(child, 0)[1] != 0:
    sys.exit(3)
"""


def answers(threads=2, before="", after="", prepare=None, without=(), **environment):
    """The program's output without the seconds, and its exit status."""
    known = {name: value for name, value in os.environ.items() if name not in without}
    with tempfile.TemporaryDirectory() as folder:
        known |= {"PYTHONPATH": str(ROOT), "PINBALL_CACHE": folder} | environment
        known = {name: value for name, value in known.items() if name not in without}
        text = PROGRAM.replace("THREADS", str(threads)).replace("BEFORE", before).replace("AFTER", after)
        done = subprocess.run(
            [sys.executable, "-W", "ignore::DeprecationWarning", "-c", text], cwd=folder, env=known, text=True,
            capture_output=True, preexec_fn=prepare, check=False,
        )  # fmt: skip
    said = [line for line in done.stdout.splitlines() if "seconds" not in line]
    return done.returncode, said, done.stderr


@pytest.fixture(scope="module")
def usual():
    status, said, error = answers()
    assert status == 0, error
    assert len(said) > 5
    return said


MACHINES = {
    "without assertions, docstrings, a locale and a home": {
        "PYTHONOPTIMIZE": "2", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0",
        "without": ("HOME", "XDG_CACHE_HOME", "USER", "LOGNAME"),
    },
    "no registers of 512 bits, in kernels, NumPy and OpenBLAS": {"fewer": "AVX-512"},
    "the instructions of every x86-64 and no more, in kernels, NumPy and OpenBLAS": {"fewer": "AVX2"},
    "64 threads, and a fork after them": {"threads": 64, "after": FORK},
    "2 GB of addresses": {"prepare": lambda: resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))},
    "read-only Python": {"PYTHONDONTWRITEBYTECODE": "1", "PINBALL_CACHE": "/proc/nowhere"},
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("machine", MACHINES)
def test_the_answers_are_the_same(machine, usual, fewer):
    around = dict(MACHINES[machine])
    if (less := around.pop("fewer", None)) is not None:
        around |= {"before": WITHOUT[less]} | fewer[less]
    status, said, error = answers(**around)

    assert status == 0, error
    assert said == usual
    assert "Traceback" not in error


DISPATCHED = """
import numpy as np
umath = np._core._multiarray_umath
print(*(name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]))
"""


@pytest.mark.parametrize("less", WITHOUT)
def test_what_numpy_is_told_to_do_without_it_does_without(less, fewer):
    """NumPy ignores an unknown feature name with an unseen warning, which has happened after names changed."""
    done = subprocess.run(
        [sys.executable, "-c", DISPATCHED], env=os.environ | fewer[less], text=True, capture_output=True, check=True
    )

    assert not [name for name in done.stdout.split() if less == "AVX2" or name.startswith(("AVX512", "X86_V4"))]


def completed(folder, shell, *words):
    """The completions that `pinball` offers to a shell, requested as the shell's completion script does."""
    typed = {"COMP_WORDS": " ".join(words), "COMP_CWORD": words[-1] if shell == "fish" else str(len(words) - 1)}
    known = os.environ | {"PYTHONPATH": str(ROOT), "_PINBALL_COMPLETE": f"{shell}_complete"} | typed
    command = [sys.executable, "-m", "verification"]
    done = subprocess.run(command, cwd=folder, env=known, text=True, capture_output=True, check=True)
    return re.split(r"[\s,]+", done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_commands_and_options_are_completed_for_each_shell(shell, tmp_path):
    assert "report" in completed(tmp_path, shell, "pinball", "repo")
    assert "--minutes" in completed(tmp_path, shell, "pinball", "report", "stadium", "--min")
    assert "saddle-node" in completed(tmp_path, shell, "pinball", "locate", "sadd")


def test_a_real_shell_completes_after_the_line_that_the_page_gives(tmp_path):
    """In bash, with the line from the page's table, and the words set as readline sets them."""
    program = tmp_path / "pinball"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m verification "$@"\n')
    program.chmod(0o755)
    (line,) = re.findall(r"\| bash \| `(.*)` \|", (ROOT / "docs" / "command_line.md").read_text())
    known = os.environ | {"PYTHONPATH": str(ROOT), "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    asked = 'COMP_WORDS=(pinball repo); COMP_CWORD=1; _pinball_completion pinball; echo "${COMPREPLY[@]}"'
    script = ["bash", "--noprofile", "--norc", "-c", f"{line}; complete -p pinball; {asked}"]
    done = subprocess.run(script, cwd=tmp_path, env=known, text=True, capture_output=True, check=False)

    said = done.stdout.splitlines()
    assert done.stderr == ""
    assert said[0].endswith("-F _pinball_completion pinball")
    assert said[1:] == ["report"]
