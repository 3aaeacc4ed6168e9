"""The same bits on processors with fewer instructions, and code for other processors, as far as a compiler can tell."""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.kernels import machine
from numeric.kernels.machine import KernelSpec
from numeric.kernels.text import kernel_text

SCENES = {"circle": {}, "ellipse": {"a": "3/2"}, "cardioid": {}, "cuspless": {}, "egg": {"alpha": "0.08"}}


def orbit(name):
    """Some bounces of some particles."""
    map = PinballMap(name, lam=0.7, **SCENES[name])
    low, high = map.states.ends[0]
    theta = low + (high - low) * (np.arange(16) + 0.5) / 16
    return map.orbit(theta, np.linspace(-1.2, 1.2, 16), 12)


@pytest.mark.parametrize("processor", ["haswell", "nehalem"])
def test_processors_with_fewer_instructions_find_the_same_bits(processor, tmp_path, monkeypatch):
    """Nehalem has no fused multiply-add: LLVM calls the library's, and such an object file is no image."""
    llvm = machine._llvm()
    if not llvm.get_process_triple().startswith("x86_64"):
        return
    expected = {name: orbit(name) for name in ("cardioid", "egg")}
    target = llvm.Target.from_default_triple()
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    monkeypatch.setattr(machine, "_loaded", {})
    monkeypatch.setattr(machine, "_target", lambda: target.create_target_machine(cpu=processor, features="", opt=3))
    for name, known in expected.items():
        found = orbit(name)
        for field, values in zip(found._fields, found, strict=True):
            assert np.array_equal(values, getattr(known, field), equal_nan=values.dtype.kind == "f"), (name, field)


@pytest.mark.parametrize("features", ["-avx512f,-avx512vl", "-avx2,-fma,-avx512f"])
def test_wide_registers_that_are_switched_off_are_not_used(features):
    llvm = machine._llvm()
    if not llvm.get_process_triple().startswith("x86_64"):
        return
    map = PinballMap("egg", lam=0.7, alpha="0.08")
    target = llvm.Target.from_default_triple().create_target_machine(cpu="skylake-avx512", features=features, opt=3)
    text = str(
        target.emit_assembly(llvm.parse_assembly(kernel_text(map.family, map.engine.names, KernelSpec(map.law))))
    )

    assert "zmm" not in text
    assert ("vfmadd" in text) == ("-fma" not in features)


@pytest.mark.parametrize("name", SCENES)
def test_kernels_compile_for_aarch64(name):
    """As text and object file, on vector registers and without a call to any library; they are not run here."""
    llvm = machine._llvm()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    map = PinballMap(name, lam=0.7, **SCENES[name])
    module = llvm.parse_assembly(kernel_text(map.family, map.engine.names, KernelSpec(map.law)))
    target = llvm.Target.from_triple("aarch64-unknown-linux-gnu").create_target_machine(opt=3)
    text, code = str(target.emit_assembly(module)), target.emit_object(module)
    called = {line.split()[1] for line in text.splitlines() if line.split()[:1] == ["bl"]}

    assert ".2d" in text
    assert "fml" in text or name == "circle"  # whose bounce needs no product that is added to something
    assert called == set()
    assert code[18:20] == b"\xb7\x00"
    assert machine.image(bytes(code)) is None  # which LLVM loads there
