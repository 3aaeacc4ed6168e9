"""Kernels that are loaded without LLVM are the kernels that LLVM loads."""

import ctypes

import numpy as np
import pytest

from numeric import PinballMap, machine
from numeric.image import MAGIC, entered, image
from numeric.kernel import kernel_text
from numeric.question import Question


def bounced(address, rows, lam, bounces):
    """The rows after some bounces, called as the engine calls a kernel."""
    state, nothing = np.array(rows), np.zeros(1)
    pointer, number = ctypes.c_void_p, ctypes.c_int64
    run = ctypes.CFUNCTYPE(None, *[pointer] * 4, *[number] * 4)(address)
    width = state.shape[1]
    run(state.ctypes.data, lam.ctypes.data, nothing.ctypes.data, None, width, 0, width, bounces)
    return state


def test_an_image_runs_as_the_object_file_it_was_made_of():
    map = PinballMap("cardioid", lam=0.9)
    code = machine.object_code(kernel_text(map.family, map.engine.names, Question(map.law)))
    theta = np.linspace(-3, 3, map.family.width)
    rows = [np.cos(theta / 2), np.sin(theta / 2), np.cos(theta / 3), np.sin(theta / 3), 0 * theta, 0 * theta]
    (address, _owner), lam = machine._entered(code), np.full(theta.size, 0.9)
    expected = bounced(address, rows, lam, 50)
    flat = image(code)

    if flat is None:  # another machine: LLVM loads the file, as it just did
        assert code[:4] != b"\x7fELF" or code[18:20] != b"\x3e\x00"
    else:
        address, _memory = entered(flat)
        assert np.array_equal(bounced(address, rows, lam, 50), expected)


@pytest.mark.parametrize(
    "code", [b"", b"MZ" + bytes(200), b"\x7fELF\x02\x01" + bytes(200)], ids=["none", "coff", "empty"]
)
def test_what_is_no_object_file_of_this_kind_is_no_image(code):
    assert image(code) is None


def test_an_image_that_cannot_be_mapped_is_left_to_the_compiler():
    assert entered(MAGIC + bytes(12)) is None
