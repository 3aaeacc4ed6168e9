"""Property tests are the same on every machine: derandomised, and not judged by the clock.

The examples are the same in every run, so that more of them find nothing new on a second day: 25 unless a test says
another number. `pytest --hypothesis-profile long` draws 500, other ones every time.

`slow.txt` has the seconds of each test that takes more than a tenth of one. A test that is not in it is `quick`; one
that takes more than `DEAR` is `slow`. `make quick` runs what is quick, `make test` all but what is slow, `make slow`
the rest. They go file by file: what a file computes for several tests is computed once, and the dearest files begin.
"""

import os
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

FOR_ALL = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("ci", derandomize=True, max_examples=25, **FOR_ALL)
settings.register_profile("long", max_examples=500, **FOR_ALL)
settings.load_profile("ci")

HERE = Path(__file__).parent
LINES = (HERE / "slow.txt").read_text(encoding="utf-8").splitlines()
SECONDS = {name: float(seconds) for seconds, name in (line.split() for line in LINES)}
DEAR = 1.5  # seconds of one processor: what takes no more is five minutes of two
LEVELS = ("quick", "slow")


def marks(name):
    """The marks of a test: `quick`, `slow`, or none."""
    if name not in SECONDS:
        return ["quick"]
    return ["slow"] if SECONDS[name] > DEAR else []


def pytest_ignore_collect(collection_path, config):
    """A file without a test of the level that is asked for is not imported: that takes longer than what is quick."""
    level, path = config.getoption("markexpr"), collection_path
    if level not in LEVELS or not (path.name.startswith("test_") and path.suffix == ".py"):
        return None
    text, file = path.read_text(encoding="utf-8"), path.relative_to(HERE.parent).as_posix()
    tests = [f"{file}::{name}" for name in re.findall(r"^def (test_\w+)", text, re.MULTILINE)]
    return True if ">>>" not in text and not any(level in marks(name) for name in tests) else None


for name in ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "NPY_ENABLE_CPU_FEATURES", "GLIBC_TUNABLES"):
    os.environ.pop(name, None)  # what tests start has all instructions of the machine, unless they say otherwise
WIDE = ("AVX512", "X86_V4")  # what begins the names of all that needs registers of 512 bits
USED = {name: name.startswith(WIDE) for name in np._core._multiarray_umath.__cpu_dispatch__}  # other ones every year


@pytest.fixture(scope="session")
def fewer():
    """Environments in which NumPy and OpenBLAS do without AVX-512, and without all that not every x86-64 has."""
    return {
        "AVX-512": {
            "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in USED if USED[name]), "OPENBLAS_CORETYPE": "Haswell"
        },
        "AVX2": {"NPY_DISABLE_CPU_FEATURES": " ".join(USED), "OPENBLAS_CORETYPE": "Prescott"},
    }  # fmt: skip


@pytest.hookimpl(tryfirst=True)  # before what is marked is left out
def pytest_collection_modifyitems(items):
    names = {item: item.nodeid.partition("[")[0] for item in items}
    files = Counter()
    for name in dict.fromkeys(names.values()):  # in one order, so that workers agree
        files[name.partition("::")[0]] += SECONDS.get(name, 0.0)
    for item, name in names.items():
        for mark in marks(name):
            item.add_marker(mark)
    items.sort(key=lambda item: -files[names[item].partition("::")[0]])
