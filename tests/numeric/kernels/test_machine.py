"""Kernels are compiled once, kept in memory and on disk, and looked for there first; else NumPy serves."""

import sys

import numpy as np
import pytest

from numeric import PinballMap
from numeric.kernels import machine
from numeric.kernels.machine import KernelSpec
from numeric.kernels.text import kernel_text

MAP = PinballMap("circle", lam=0.5)
QUESTION = KernelSpec("pinball")


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """Kernels of a folder and a memory of their own, and a list of what is compiled."""
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    monkeypatch.setattr(machine, "_loaded", {})
    made = []
    write = machine.object_code
    monkeypatch.setattr(machine, "object_code", lambda text: made.append(text) or write(text))

    def ask(question=QUESTION, identity="test", width=8, names=()):
        return machine.compiled(MAP.family, identity, names, question, width)

    ask.made, ask.folder = made, tmp_path
    return ask


def test_a_kernel_is_compiled_once_for_each_thing_it_depends_on(compiled):
    first = compiled()
    assert compiled() is first
    assert len(compiled.made) == 1
    others = [compiled(identity="x"), compiled(width=16), compiled(KernelSpec("elastic")), compiled(names=("b",))]

    assert len({*map(id, others), id(first)}) == 5
    assert len(compiled.made) == 5
    assert len(list(compiled.folder.iterdir())) == 5


def test_a_kernel_comes_from_disk_when_memory_has_none(compiled):
    run = compiled()
    machine._loaded.clear()
    again = compiled()
    state = np.array([[0.1] * 8, [0.2] * 8])
    other, lam = state.copy(), np.full(8, 0.5)
    for function, rows in ((run, state), (again, other)):
        function(rows.ctypes.data, lam.ctypes.data, lam.ctypes.data, None, 8, 0, 8, 3)

    assert len(compiled.made) == 1
    assert np.array_equal(state, other)
    assert state[1].tolist() == [0.2 / 8] * 8


def test_where_an_image_cannot_be_entered_the_object_file_is_kept(compiled, monkeypatch):
    monkeypatch.setattr(machine, "entered", lambda code: None)
    compiled()
    (kept,) = compiled.folder.iterdir()

    assert kept.read_bytes()[32:36] != machine.MAGIC
    machine._loaded.clear()
    compiled()
    assert len(compiled.made) == 1


@pytest.mark.parametrize("missing", ["_llvm", "_version", "_processor"])
def test_without_a_compiler_there_is_no_kernel(compiled, missing, monkeypatch):
    monkeypatch.setattr(machine, missing, lambda: None)

    assert compiled() is None
    assert machine.available() == (missing != "_llvm")


def test_an_object_file_needs_llvm(monkeypatch):
    monkeypatch.setattr(machine, "_llvm", lambda: None)

    assert machine._entered(b"no image") is None


def test_a_library_that_fails_is_named(monkeypatch):
    import llvmlite.binding as llvm

    def fails():
        raise RuntimeError("wrong machine")

    monkeypatch.setattr(llvm, "initialize_native_target", fails)
    with pytest.warns(UserWarning, match=r"llvmlite cannot be used \(wrong machine\); maps run on NumPy arrays"):
        assert machine._llvm.__wrapped__() is None
    assert machine._version() == __import__("llvmlite").__version__


def test_the_processor_is_told_by_linux_or_else_by_llvm(monkeypatch):
    import io

    facts = (
        b"processor: 0\nvendor_id: v\ncpu family: 1\nmodel: 2\nmodel name: n\nflags: fma\nbugs: none\n\nprocessor: 1\n"
    )
    told = ("vendor_id: v", "cpu family: 1", "model: 2", "model name: n", "flags: fma")
    processor = machine._processor.__wrapped__

    def read(content):
        monkeypatch.setattr(machine, "open", lambda *_, **__: io.BytesIO(content), raising=False)
        return processor()

    assert read(facts) == told
    asked = read(facts.replace(b"flags: fma\n", b""))
    assert len(asked) == 2
    assert asked == read(b"x" * 5000) == read(facts.replace(b"bugs: none", b"bugs: " + b"n" * 4096))
    monkeypatch.setattr(machine, "_llvm", lambda: None)
    assert read(b"") is None

    def gone(*_, **__):
        raise OSError

    monkeypatch.setattr(machine, "open", gone, raising=False)
    assert processor() is None


def test_a_kernel_can_be_read_as_assembly():
    text = kernel_text(MAP.family, (), QUESTION, 8)

    assert "run" in machine.assembly(text)
    assert "define void @run" in str(machine.optimised(text))


@pytest.mark.parametrize(("library", "version"), [(None, None), ("another llvm", "")])
def test_a_compiler_without_a_version_has_an_empty_one_and_none_has_none(library, version, monkeypatch):
    monkeypatch.setitem(sys.modules, "llvmlite", None)
    monkeypatch.setattr(machine, "_llvm", lambda: library)

    assert machine._version() == version


def test_a_kernel_that_is_too_long_to_compile_is_left_to_numpy(compiled, monkeypatch):
    monkeypatch.setattr(machine, "LONGEST", 1000)
    with pytest.warns(UserWarning, match="it runs on NumPy arrays"):
        assert compiled() is None

    assert compiled() is None  # and it is said once
    assert compiled.made == []
