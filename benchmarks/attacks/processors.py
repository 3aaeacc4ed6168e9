"""Attack: the whole report is the same, byte by byte, with fewer processor instructions.

`pinball verify --report` runs with all instructions; without AVX-512, in kernels (LLVM), NumPy, OpenBLAS and the C
library; and with the C library's functions for processors without fused multiply-add, whose last bits differ. Only
seconds are left out of the comparison. It says `same`, or which files and claims differ; a difference without AVX-512
is a failure, as docs/trust.md says that there is none.
"""

import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from attacks.outcome import Outcome

ROOT = Path(__file__).parents[2]
WIDE = ("AVX512", "X86_V4")  # what begins NumPy's names of all that needs registers of 512 bits
USED = tuple(np._core._multiarray_umath.__cpu_dispatch__)
PROCESSORS = {  # LLVM's name of a processor, and the environment
    "all that there is": ("", {}),
    "without AVX-512": (
        "haswell",
        {
            "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in USED if name.startswith(WIDE)),
            "OPENBLAS_CORETYPE": "Haswell",
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL",
        },
    ),
    "a C library without fused multiply-add": ("", {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-FMA4"}),
}
PROGRAM = """
import sys
from numeric.kernels import machine
llvm, processor = machine._llvm(), sys.argv.pop(1)
if processor:
    target = llvm.Target.from_default_triple()
    machine._target = lambda: target.create_target_machine(cpu=processor, features="", opt=3)
from verification.app.cli import main
sys.exit(main(sys.argv[1:]))
"""
SECONDS = r'^ *"seconds": .*$|^- seconds: .*$|\b[\d.]+ s\b|took \d+ seconds'


def held() -> dict[str, str]:
    """The environment without variables that restrict a library to fewer instructions."""
    names = {name for _, more in PROCESSORS.values() for name in more}
    return {name: value for name, value in os.environ.items() if name not in names}


def report(folder: Path, processor: str, environment: dict[str, str], only: str) -> dict[str, str]:
    """The files of a report by name, without seconds, judged in one process."""
    around = held() | environment | {"PYTHONPATH": str(ROOT), "PINBALL_CACHE": str(folder / "cache")}
    asked = ["verify", "--only", only, "--jobs", "1", "--report", str(folder / "report")]
    asked += ["--no-figures"] * (only != "*")  # the figures are as many whatever is asked
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", PROGRAM, processor, *asked],
        env=around, cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode > 1:
        raise RuntimeError(done.stderr)
    files = sorted(path for path in (folder / "report").rglob("*") if path.is_file())
    texts = {str(path.relative_to(folder)): path.read_bytes().decode("utf-8", "surrogateescape") for path in files}
    return {name: re.sub(SECONDS, "", text, flags=re.MULTILINE) for name, text in texts.items()}


def claims(files: dict[str, str]) -> dict[str, object]:
    """The claims of a report, without their seconds, by their ids."""
    text = re.sub(r",(\s*)}", r"\1}", files["report/report.json"])  # where the seconds came last
    return {claim["id"]: claim for claim in json.loads(text)["claims"]}


def compared(only: str = "*") -> dict[str, list[str]]:
    """For each processor but the first: the files and the claims that differ."""
    said: dict[str, dict[str, str]] = {}
    for name, (processor, environment) in PROCESSORS.items():
        with tempfile.TemporaryDirectory() as folder:
            said[name] = report(Path(folder), processor, environment, only)
    first, *others = said.values()
    found = {}
    for name, other in zip([*PROCESSORS][1:], others, strict=True):
        files = sorted(key for key in {*first, *other} if first.get(key) != other.get(key))
        old, new = claims(first), claims(other)
        found[name] = files + [key for key in old if old[key] != new.get(key)]
    return found


def processors(only: str) -> Outcome:
    """Claims whose reports are compared; those that differ without AVX-512 failed."""
    if (platform.machine(), sys.platform) != ("x86_64", "linux"):
        return Outcome(0, 0, "not x86-64 on Linux: nothing is compared")
    found = compared(only)
    said = "; ".join(f"{name}: {', '.join(differs) or 'same'}" for name, differs in found.items())
    return Outcome(len(found), len(found["without AVX-512"]), said)
