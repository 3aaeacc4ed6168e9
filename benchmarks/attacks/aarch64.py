"""Attack: kernels of every kind of table, compiled for AArch64, have the same bits there or in QEMU as here.

Where the compiler or the emulator is missing, nothing is tried, and the sentence says what is needed.
"""

import math
import platform
import shutil
import struct
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from attacks.outcome import Outcome

COMPILER, EMULATOR = "aarch64-linux-gnu-gcc", "qemu-aarch64"  # Debian: gcc-aarch64-linux-gnu, qemu-user
DRIVER = r"""
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
void run(double *, const double *, const double *, double *, int64_t, int64_t, int64_t, int64_t);
static double *taken(int64_t count) {
    double *place = aligned_alloc(64, 64 + (8 * count + 63) / 64 * 64);
    if (!place) exit(2);
    return place;
}
static double *read_in(int64_t count) {
    double *place = taken(count);
    if (fread(place, 8, count, stdin) != (size_t)count) exit(3);
    return place;
}
int main(void) {
    int64_t head[5]; /* rows, width, numbers of the shape, rows told, bounces */
    if (fread(head, 8, 5, stdin) != 5) return 4;
    double *state = read_in(head[0] * head[1]), *lam = read_in(head[1]), *shape = read_in(head[2]);
    double *record = taken(head[3] * head[1] * head[4]);
    run(state, lam, shape, record, head[1], 0, head[1], head[4]);
    fwrite(state, 8, head[0] * head[1], stdout);
    fwrite(record, 8, head[3] * head[1] * head[4], stdout);
    return 0;
}
"""


def scenes() -> dict[str, Callable[[], Any]]:
    """A table for each method to find the next bounce."""
    from numeric import PinballMap
    from symbolic import tables

    def made(table: Any, lam: float = 0.7, **shape: Any) -> Callable[[], Any]:
        return lambda: PinballMap(table, lam=lam, **shape)

    angles = [math.tau * k / 12 for k in range(12)]
    curve = [((2 + math.cos(3 * a)) * math.cos(a), (2 + math.cos(3 * a)) * math.sin(a)) for a in angles]
    ring = [(f"{x:.6f}", f"{y:.6f}") for x, y in curve]
    return {
        "circle": made("circle"),
        "ellipse": made("ellipse", a="3/2"),
        "cardioid": made("cardioid"),
        "cuspless": made("cuspless"),
        "egg": made("egg", alpha="0.08"),
        "five harmonics": made(tables.polar("1 + cos(5*theta)/40")),
        "quotient": made(tables.polar("1/(2 + cos(theta))")),
        "parametric": made(tables.parametric("2*cos(theta)", "sin(theta) + sin(2*theta)/20")),
        "square": made(tables.square()),
        "stadium": made(tables.stadium()),
        "reuleaux": made(tables.reuleaux()),
        "sinai": made(tables.sinai()),
        "lemon": made(tables.lemon()),
        "spline": made(tables.from_points(ring)),
    }


def missing() -> str:
    """The compiler or emulator that this machine lacks, in a sentence; empty when kernels can be run."""
    if platform.machine().lower() in ("aarch64", "arm64"):
        return "this machine is an AArch64 itself: the suite runs its kernels"
    lacks = [name for name in (COMPILER, EMULATOR) if shutil.which(name) is None]
    if lacks:
        return f"needs {' and '.join(lacks)} (Debian: gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and qemu-user)"
    return ""


def program(text: str, folder: Path) -> Path:
    """An executable for AArch64 with this kernel."""
    from numeric.kernels import machine

    llvm = machine._llvm()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple("aarch64-unknown-linux-gnu").create_target_machine(opt=3, reloc="pic")
    code, driver, made = folder / "kernel.o", folder / "driver.c", folder / "kernel"
    code.write_bytes(machine.object_code(text, target))
    driver.write_text(DRIVER)
    subprocess.run([COMPILER, "-O1", "-static", "-o", made, driver, code, "-lm"], check=True)
    return made


def differing(map: Any, particles: int, bounces: int, exponents: bool, seed: int) -> tuple[int, int]:
    """The number of values that both machines computed for the same particles, and of those that differ in a bit."""
    import numpy as np

    from numeric.kernels import machine
    from numeric.kernels.machine import KernelSpec, starting
    from numeric.kernels.text import kernel_text
    from numeric.pinball.sampling import interior_starts

    starts, engine = interior_starts(map, particles, seed=seed), map.engine
    own = [np.asarray(row) for row in map.states.enter(starts.component, starts.theta, starts.phi, map.law)]
    one = np.ones(particles)
    spec = KernelSpec(map.law, record=True, exponents=exponents)
    tangent = starting(one, 0.5 * one, one) if exponents else ()
    rows = [*own, *([0 * one, 0 * one] if engine.family.stops else []), *tangent]
    width = -(-particles // engine.width) * engine.width
    state = np.array([np.concatenate([row, np.full(width - particles, row[-1])]) for row in rows])
    lam, shape = np.full(width, float(map.lam)), np.array([*map.shape, 0.0])
    with tempfile.TemporaryDirectory() as folder:
        text = kernel_text(engine.family, engine.names, spec, engine.width, processor="aarch64")
        made = program(text, Path(folder))
        head = struct.pack("<5q", len(rows), width, shape.size, len(own), bounces)
        given = head + state.tobytes() + lam.tobytes() + shape.tobytes()
        said = subprocess.run([EMULATOR, made], input=given, capture_output=True, check=True).stdout
    record = np.empty((bounces, len(own), width))
    here = machine.compiled(engine.family, engine.identity, engine.names, spec, engine.width)
    assert here is not None
    pointers = [x.ctypes.data for x in (state, lam, shape, record)]
    here(*pointers, width, 0, width, bounces)
    there = np.frombuffer(said, np.uint64)
    found = np.concatenate([state.ravel(), record.ravel()]).view(np.uint64)
    assert there.size == found.size
    numbers = ~(np.isnan(found.view(float)) & np.isnan(there.view(float)))  # whose bits no standard says
    return found.size, int(np.sum((there != found) & numbers))


FEW, AT_REST = 16, 4000  # particles, and bounces after which many lie below the smallest normal numbers


def aarch64(particles: int, bounces: int = 100, seed: int = 1) -> Outcome:
    """Orbits and exponents on every kind of table: how many numbers differ in any bit.

    Many particles make some bounces; a few continue until their distances from a cycle are flushed to zero.
    """
    if lacks := missing():
        return Outcome(0, 0, lacks)
    tried, failed, said = 0, 0, []
    for name, made in scenes().items():
        for exponents in (False, True):
            found = [differing(made(), *how, exponents, seed) for how in ((particles, bounces), (FEW, AT_REST))]
            count, wrong = map(sum, zip(*found, strict=True))
            tried, failed = tried + count, failed + wrong
            if wrong:
                said.append(f"{wrong} of {count} in the {name}{' with exponents' if exponents else ''}")
    version = subprocess.run([EMULATOR, "--version"], capture_output=True, text=True, check=True).stdout.split("\n")[0]
    return Outcome(tried, failed, ", ".join(said) or f"{len(scenes())} tables, the same bits; {version}")
