"""How near are the kernels to the machine's own bound? Peak rates measured in the same run.

    python benchmarks/fma_bound.py

LLVM loops of independent operations give the rates of fused multiply-adds, divisions and roots. The bound of a
kernel is `fma + add + mul` of its operations at the first rate; `in turn` adds its divisions and roots at theirs,
which a processor may hide behind the rest. Compares and selects are free in both; `every` counts them at the first
rate too, since they take the same units of a processor.
"""

import ctypes
import sys
import time

import llvmlite.binding as llvm
import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, wide
from numeric.kernels.text import kernel_text, operations
from verification.measure.extremes.orbits import SCENES
from verification.measure.work.bench import LAWS, PARTICLES, attracted

LANES, PASSES = 8, 20_000
CHAINS = 12 if wide() else 6  # vectors of eight doubles that the registers hold beside what they work with
BOUNCES, RUNS = 100, 100
STEPS = {
    "fma": "call {t} @llvm.fma.v8f64({t} {x}, {t} %a, {t} %b)",
    "div": "fdiv {t} %a, {x}",
    "sqrt": "call {t} @llvm.sqrt.v8f64({t} {x})",
}


def loop(step):
    """A loop that applies one operation to independent chains of vectors."""
    t = f"<{LANES} x double>"
    chains = range(CHAINS)
    phis = [f"  %x{i} = phi {t} [%s{i}, %entry], [%y{i}, %loop]" for i in chains]
    work = [f"  %y{i} = " + step.format(t=t, x=f"%x{i}") for i in chains]
    total = [f"  %t{i} = fadd {t} " + (f"%y{i}, %y0" if i == 1 else f"%t{i - 1}, %y{i}") for i in chains if i]
    starts = [f"  %s{i} = fadd {t} %a, splat (double {1.0 + i})" for i in chains]
    return "\n".join([
        "define void @run(ptr %p, i64 %n) #0 {", "entry:", f"  %a = load {t}, ptr %p, align 64",
        f"  %b = fsub {t} splat (double 1.5), %a", *starts, "  br label %loop", "loop:",
        "  %i = phi i64 [0, %entry], [%j, %loop]", *phis, *work, "  %j = add i64 %i, 1",
        "  %more = icmp slt i64 %j, %n", "  br i1 %more, label %loop, label %done", "done:", *total,
        f"  store {t} %t{CHAINS - 1}, ptr %p, align 64", "  ret void", "}",
        f"declare {t} @llvm.fma.v8f64({t}, {t}, {t})", f"declare {t} @llvm.sqrt.v8f64({t})",
        'attributes #0 = { nounwind "prefer-vector-width"="512" "min-legal-vector-width"="512" }',
    ])  # fmt: skip


def best(action, runs=RUNS):
    """The shortest run, in seconds of this thread's processor time."""
    times = []
    for _ in range(runs):
        start = time.thread_time()
        action()
        times.append(time.thread_time() - start)
    return min(times)


def rate(name):
    """Seconds for one such operation in one lane."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features, opt=2
    )
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(loop(STEPS[name])), target)
    engine.finalize_object()
    run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64)(engine.get_function_address("run"))
    memory = np.zeros(24)
    start = (-memory.ctypes.data % 64) // 8
    values = memory[start : start + LANES]

    def once():
        values[:] = 0.999
        run(values.ctypes.data, PASSES)

    once()
    return best(once) / PASSES / CHAINS / LANES


def say(text):
    """A line on standard output, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main():
    rates = {name: rate(name) for name in STEPS}
    say("one lane, ns: " + ", ".join(f"{name} {seconds * 1e9:.4f}" for name, seconds in rates.items()))
    say(f"{'scene':<10}{'law':<9}{'ns':>8}{'bound':>8}{'share':>7}{'in turn':>9}{'share':>7}{'every':>8}{'share':>7}")
    for name, shape in SCENES.items():
        for law, lam in LAWS.items():
            map = PinballMap(name, lam=lam, **shape)
            own, lams = attracted(map, PARTICLES, 20), np.full(PARTICLES, float(map.lam))
            question = KernelSpec(law)
            counts = operations(kernel_text(map.family, map.engine.names, question))

            def bounce(map=map, question=question, own=own, lams=lams):
                map.engine.run(question, own, lams, map.shape, BOUNCES, (), 1)

            bounce()
            measured = best(bounce) / PARTICLES / BOUNCES
            bound = (counts["fma"] + counts["add"] + counts["mul"]) * rates["fma"]
            in_turn = bound + counts["div"] * rates["div"] + counts["sqrt"] * rates["sqrt"]
            every = in_turn + (counts["compare"] + counts["select"]) * rates["fma"]
            figures = f"{measured * 1e9:>8.3f}{bound * 1e9:>8.3f}{bound / measured:>7.0%}"
            figures += f"{in_turn * 1e9:>9.3f}{in_turn / measured:>7.0%}{every * 1e9:>8.3f}{every / measured:>7.0%}"
            say(f"{name:<10}{law:<9}{figures}")


if __name__ == "__main__":
    main()
