"""Kernels on processors with fewer or other instructions, and results near the smallest normal number."""

import llvmlite.binding as llvm
import numpy as np
import pytest

from numeric import PinballMap
from numeric.kernels import machine
from numeric.kernels.machine import KernelSpec, starting
from numeric.kernels.text import kernel_text

llvm.initialize_native_target()
llvm.initialize_native_asmprinter()
SCENES = {"circle": {}, "ellipse": {"a": "3/2"}, "cardioid": {}, "cuspless": {}, "egg": {"alpha": "0.08"}}


@pytest.mark.slow
@pytest.mark.parametrize("features", ["-avx512f,-avx512vl", "-avx2,-fma,-avx512f"])
def test_wide_registers_that_are_switched_off_are_not_used(features):
    if not llvm.get_process_triple().startswith("x86_64"):
        return
    map = PinballMap("egg", lam=0.7, alpha="0.08")
    target = llvm.Target.from_default_triple().create_target_machine(cpu="skylake-avx512", features=features, opt=3)
    text = str(
        target.emit_assembly(llvm.parse_assembly(kernel_text(map.family, map.engine.names, KernelSpec(map.law))))
    )

    assert "zmm" not in text
    assert ("vfmadd" in text) == ("-fma" not in features)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_kernels_compile_for_aarch64(name):
    """They use vector registers and call no library; `benchmarks/torture.py aarch64` runs them."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    map = PinballMap(name, lam=0.7, **SCENES[name])
    module = llvm.parse_assembly(kernel_text(map.family, map.engine.names, KernelSpec(map.law), processor="aarch64"))
    target = llvm.Target.from_triple("aarch64-unknown-linux-gnu").create_target_machine(opt=3)
    text, code = str(target.emit_assembly(module)), target.emit_object(module)
    called = {line.split()[1] for line in text.splitlines() if line.split()[:1] == ["bl"]}

    assert ".2d" in text
    assert [line.split()[0] for line in text.lower().splitlines() if "fpcr" in line] == ["mrs", "msr", "msr"]
    assert "fml" in text or name == "circle"  # whose bounce needs no product that is added to something
    assert called == set()
    assert code[18:20] == b"\xb7\x00"
    assert machine.image(bytes(code)) is None  # which LLVM loads there


SMALLEST = 2.0**-1022  # normal number


def at_rest(name, lam=0.7):
    """Particles almost at rest on a cycle, at subnormal distances from it in each field."""
    map = PinballMap(name, lam=lam, **SCENES[name])
    own = map.states.enter(np.zeros(40, dtype=int), np.zeros(40), np.zeros(40), map.law)
    tiny = np.linspace(1, 900, 40) * 1e-310
    return map, [np.where(field == 0, tiny, field) for field in own]


def run(map, own, bounces, exponents=False, threads=None):
    """The rows of the fields after some bounces."""
    one = np.ones(40)
    tangent = starting(one, 0.5 * one, one) if exponents else ()
    spec = KernelSpec(map.law, exponents=exponents)
    return map.engine.run(spec, own, np.full(40, float(map.lam)), map.shape, bounces, tangent, threads).rows


@pytest.mark.parametrize("exponents", [False, True])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", ["circle", "ellipse", "egg"])
def test_no_state_holds_a_subnormal_number_and_the_caller_keeps_its_own(name, threads, exponents):
    map, own = at_rest(name)
    for bounces in (1, 64):
        for row in run(map, own, bounces, exponents, threads).values():
            assert not np.any((row != 0) & (np.abs(row) < SMALLEST))
    tiny = np.array([5e-324])

    assert (tiny * 3 / 3).tolist() == [5e-324]  # in this thread


def test_a_ball_that_converges_to_a_cycle_arrives_within_the_smallest_normal_numbers():
    """And at no extra cost: rounding to the nearest subnormal number would keep the ball off the cycle for ever."""
    map, own = at_rest("ellipse", lam=0.9)
    rest = run(map, [own[0] + 0.1, *own[1:]], 20_000)
    for x, y in ((rest["ux"], rest["uy"]), (rest["vx"], rest["vy"])):
        least = np.minimum(np.abs(x), np.abs(y))

        assert np.all((least == 0) | (least >= SMALLEST) & (least < 8 * SMALLEST))


@pytest.mark.parametrize("eta", [1e-7, 1e-9, 1e-12])
def test_exit_angles_below_the_smallest_normal_number_are_zero_and_no_further_off(eta):
    """With `lam = 1e-300`: the exit angle is `-lam*eta` to rounding above `2**-1022`, within that number below."""
    map = PinballMap("circle", lam=1e-300)
    phi = float(map.step(0.0, eta).phi)

    assert abs(phi - 1e-300 * eta) < max(SMALLEST, 4 * 2.0**-52 * 1e-300 * eta)
    assert phi == 0 or phi >= SMALLEST
