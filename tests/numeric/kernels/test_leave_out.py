"""A kernel holds what its question needs and nothing else; a run imports what it needs and nothing else."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, fields
from numeric.kernels.text import alive, kernel_text, operations
from verification.measure.work.bench import SCENES, operation_table

PAGE = Path(__file__).parent.parent.parent.parent / "docs" / "kernels.md"
HEAVY = ("sympy", "mpmath", "flint", "matplotlib", "scipy", "numba", "hypothesis", "click", "rich")


def counts(name, lam, **asked):
    map = PinballMap(name, lam=lam, **SCENES[name])
    return operations(kernel_text(map.family, map.engine.names, KernelSpec(map.law, **asked)))


def test_the_page_holds_the_table_of_operations():
    text = PAGE.read_text()

    assert text.split("<!-- operations -->\n")[1] == operation_table()


@pytest.mark.parametrize("name", SCENES)
def test_no_reflection_arithmetic_at_the_ends(name):
    slap, pinball, elastic = (counts(name, lam) for lam in (0, "1/2", 1))

    assert sum(elastic.values()) < sum(pinball.values())
    assert sum(slap.values()) < sum(pinball.values())
    assert slap["compare"] <= elastic["compare"] <= pinball["compare"]


@pytest.mark.parametrize("name", SCENES)
def test_recording_costs_no_arithmetic_and_is_only_there_when_asked(name):
    map = PinballMap(name, lam="1/2", **SCENES[name])
    plain, recording = (
        kernel_text(map.family, map.engine.names, KernelSpec(map.law, record=record)) for record in (False, True)
    )

    assert operations(plain) == operations(recording)
    assert plain.count("store ") < recording.count("store ")


@pytest.mark.parametrize("name", SCENES)
def test_the_state_holds_no_tangent_vector_unless_exponents_are_asked_for(name):
    map = PinballMap(name, lam="1/2", **SCENES[name])

    assert "omega" not in fields(map.family, KernelSpec(map.law))
    assert "omega" in fields(map.family, KernelSpec(map.law, exponents=True))


def test_the_state_of_the_slap_map_is_a_place():
    egg = PinballMap("egg", lam=0, alpha="0.08")

    assert egg.family.fields(egg.law) == ("ux", "uy")


def test_one_component_needs_no_index():
    egg, cuspless = PinballMap("egg", lam=1, alpha="0.08"), PinballMap("cuspless", lam=1)

    assert "wall" not in egg.family.fields(egg.law)
    assert "wall" in cuspless.family.fields(cuspless.law)


def test_dead_lines_are_left_out():
    assert alive(["  %a = fadd double 1.0, 2.0", "  ret void"]) == ["  ret void"]


@pytest.mark.parametrize("name", SCENES)
def test_a_warm_run_imports_numpy_and_no_compiler(name, tmp_path):
    shape = ", ".join(f"{key}={value!r}" for key, value in SCENES[name].items())
    program = f"""
import sys
from numeric import PinballMap
map = PinballMap({name!r}, lam=0.5, {shape})
map.orbit(0.3, 0.2, 5)
map.exponents(0.3, 0.2, 5)
print([x for x in {HEAVY!r} if x in sys.modules], "llvmlite.binding" in sys.modules)
"""
    environment = os.environ | {"PINBALL_CACHE": str(tmp_path)}
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
        )

    assert done.stdout.split(" ", 1)[0] == "[]"
    images = sys.platform == "linux" and platform.machine() == "x86_64"  # elsewhere LLVM loads what it wrote
    assert done.stdout.split()[-1] == str(not images)
