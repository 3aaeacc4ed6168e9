"""A kernel contains only what its question needs."""

from pathlib import Path

import pytest

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec
from numeric.kernels.text import kernel_text, operations
from verification.measure.work.bench import SCENES, operation_table

PAGE = Path(__file__).parent.parent.parent.parent / "docs" / "kernels.md"


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
