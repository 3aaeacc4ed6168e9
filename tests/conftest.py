"""Settings of property tests: derandomised and without deadline, with 25 examples unless a test says otherwise.

`pytest --hypothesis-profile long` draws 500 examples, different ones in each run.
"""

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

FOR_ALL = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("ci", derandomize=True, max_examples=25, **FOR_ALL)
settings.register_profile("long", max_examples=500, **FOR_ALL)
settings.load_profile("ci")


for name in ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "NPY_ENABLE_CPU_FEATURES", "GLIBC_TUNABLES"):
    os.environ.pop(name, None)  # what tests start has all instructions of the machine, unless they say otherwise
WIDE = ("AVX512", "X86_V4")  # what begins the names of all that needs registers of 512 bits
USED = {name: name.startswith(WIDE) for name in np._core._multiarray_umath.__cpu_dispatch__}  # other ones every year


@pytest.fixture(scope="session")
def fewer():
    """Environments in which NumPy and OpenBLAS do not use AVX-512, or no instructions that some x86-64 lacks."""
    return {
        "AVX-512": {
            "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in USED if USED[name]), "OPENBLAS_CORETYPE": "Haswell"
        },
        "AVX2": {"NPY_DISABLE_CPU_FEATURES": " ".join(USED), "OPENBLAS_CORETYPE": "Prescott"},
    }  # fmt: skip
