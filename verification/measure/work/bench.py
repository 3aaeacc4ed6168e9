"""The measurements of `pinball bench`: error and time of every arithmetic and every kernel, with a baseline.

The baseline is one particle at a time in numba, in the benchmark folder. It is not part of the installed package, and
needs a checkout or the source distribution. Without it, or without numba, the benchmark runs with the package's own
rows only, and prints a note.
"""

import importlib.util
import time
from collections.abc import Callable, Iterable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from flint import arb
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, starting
from numeric.kernels.text import kernel_text, operations
from numeric.pinball.sampling import phase_starts
from verification.arithmetic.balls import bits_of
from verification.maps.enclosed import EnclosedMap
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.orbits import DIGITS, SCENES, scene
from verification.measure.work.question import distance
from verification.measure.work.row import MethodResult, written

Array = NDArray[np.float64]
PINBALL = "19/20"
LAWS: dict[str, str | float] = {"slap": 0, "pinball": PINBALL, "elastic": 1}
FORMULAS = ("-lam*eta*(1 - eta**2/8)", "-lam*eta - sin(2*eta)/50")  # two further laws: a polynomial, and one sine
PARTICLES, BOUNCES, RUNS = 4096, 1000, 5
WORTH_A_THREAD = 0.2  # seconds of work below which a second thread does not pay
CHECKED = 24  # particles whose errors are measured
FEW = 8  # particles in multiprecision
MORE = 30  # extra digits of the reference
UNIT = "2**-52, largest of position and direction"


def timing(
    scene: str, kernel: str, error: Decimal | None, seconds: float, runs: int, lam: Any = PINBALL, word: str = "float64"
) -> MethodResult:
    """One method for a bounce in one scene: its largest error in units of 2**-52, and its least time per bounce.

    The setting is the contraction; `word` names the arithmetic.
    """
    return MethodResult(scene, kernel, word, f"lam = {lam}", error, None, seconds, (seconds, seconds), runs)


def as_data(row: MethodResult) -> dict[str, Any]:
    """A row as JSON; an error outside the range of floats is a decimal string."""
    said = {"scene": row.question, "arithmetic": row.arithmetic, "kernel": row.method}
    return said | {
        "seconds_per_bounce": row.seconds,
        "runs": row.runs,
        "error": written(row.error),
        "error_unit": UNIT,
    }


def best(action: Callable[[], object], runs: int = RUNS, clock: Callable[[], float] = time.process_time) -> float:
    """The least processor time in seconds of `runs` runs of an action; other work on the machine hardly affects it."""
    times = []
    for _ in range(runs):
        start = clock()
        action()
        times.append(clock() - start)
    return max(min(times), 1e-9)  # for a clock that did not advance


def kernel_rows(name: str, runs: int = RUNS) -> Iterable[MethodResult]:
    """Timings of the LLVM kernels, plain and with exponents; on the paper's tables also of other ways to run them.

    These are two threads, whole orbits, the same step on NumPy, and other contractions and laws.
    """
    map = scene(name)
    own, nought = attracted(map, PARTICLES), np.zeros(PARTICLES)
    error = worst(map, own)
    tangent = tuple(starting(nought + 1, nought, nought + 1))
    alone = running(map, own, runs)
    yield timing(name, "llvm", error, alone, runs)
    yield timing(name, "llvm, exponents", error, running(map, own, runs, tangent=tangent), runs)
    if name not in SCENES:
        return
    copies = 1 + int(WORTH_A_THREAD / (alone * PARTICLES * BOUNCES))  # not more bounces, which would underflow
    both = running(map, [np.tile(field, copies) for field in own], runs, threads=2)
    yield timing(name, "llvm, 2 threads", error, both, runs)
    yield timing(name, "llvm, whole orbits kept", error, running(map, own, runs, 100, record=True), runs)
    component, theta = map.states.place(own)
    phi = map.states.exit(component, theta, own, map.law)

    def orbits() -> object:
        return map.orbit(theta, phi, 100, component, threads=1)

    orbits()
    yield timing(name, "llvm, orbits as angles and points", None, best(orbits, runs) / 100 / PARTICLES, runs)
    others: list[tuple[str, PinballMap, int, int]] = [
        ("numpy", PinballMap(map.scene, kernels=False), 100, 10),
        *((f"llvm, lam = {LAWS[law]}", scene(name, LAWS[law]), 1, BOUNCES) for law in ("slap", "elastic")),
    ]
    for formula in FORMULAS if name == "egg" else ():
        other = PinballMap(name, lam=PINBALL, law=formula, **SCENES[name])
        others.append((f"llvm, phi = {formula}", other, 100, BOUNCES))
    for kernel, other, transient, bounces in others:
        own = attracted(other, PARTICLES, transient)
        seconds = running(other, own, runs, bounces)
        yield timing(name, kernel, worst(other, own), seconds, runs, other.scene.lam)


def running(
    map: PinballMap,
    own: list[Array],
    runs: int,
    bounces: int = BOUNCES,
    tangent: tuple[Array, ...] = (),
    threads: int = 1,
    record: bool = False,
) -> float:
    """Seconds per bounce of a run of the kernel; of several threads it is the time on the wall."""
    lam, spec = np.full(own[0].size, float(map.lam)), KernelSpec(map.law, record=record, exponents=bool(tangent))

    def once() -> object:
        return map.engine.run(spec, own, lam, map.shape, bounces, tangent, threads)

    once()
    clock = time.process_time if threads == 1 else time.perf_counter
    return best(once, runs, clock) / bounces / own[0].size


def multiprecision_rows(name: str, digits: Iterable[int], runs: int = 1) -> Iterable[MethodResult]:
    """Timings and errors of mpmath and balls with given digits; errors are against an enclosure with 30 digits more."""
    map, lam = scene(name), Fraction(PINBALL)
    component, theta, phi, *_ = phase_starts(map, FEW, seed=3)
    particles = [(float(t), float(p), int(c)) for c, t, p in zip(component, theta, phi, strict=True)]
    for wanted in digits:
        truth = EnclosedMap(map, lam, bits_of(wanted + MORE, 64))
        landed = [truth.bounce(truth.start(*particle)) for particle in particles]
        ways = (("mpmath", ExactMap(map, wanted, lam)), ("arb", EnclosedMap(map, lam, bits_of(wanted, 64))))
        for arithmetic, way in ways:
            starts = [way.start(*particle) for particle in particles]
            found = [way.bounce(start) for start in starts]
            error = max(landing_error(one, two, wanted) for one, two in zip(found, landed, strict=True))

            def all_of_them(way: Any = way, starts: Any = starts) -> object:
                return [way.bounce(start) for start in starts]

            seconds = best(all_of_them, runs) / FEW
            yield timing(name, f"{wanted} digits", error, seconds, runs, word=arithmetic)


def landing_error(found: Any, truth: Any, digits: int) -> Decimal:
    """The largest error of parameter and exit angle, rounded to `digits`, against balls `truth`, in units of 2**-52."""
    written = [
        one.mid().str(digits, radius=False) if isinstance(one, arb) else mpmath.nstr(one, digits)
        for one in (found.theta, found.phi)
    ]
    _, largest = distance(written, [truth.theta, truth.phi], digits + 2 * MORE)
    assert largest is not None
    return Decimal(f"{largest * 2**52:.3g}")


def attracted(map: PinballMap, particles: int, transient: int = 100) -> list[Array]:
    """Kernel fields of random particles after `transient` bounces."""
    starts = phase_starts(map, particles, seed=1)
    own = map.states.enter(starts.component, starts.theta, starts.phi, map.law)
    rows = map.engine.run(KernelSpec(map.law), own, np.full(particles, float(map.lam)), map.shape, transient).rows
    return [np.ascontiguousarray(rows[field]) for field in map.family.fields(map.law)]


def worst(map: PinballMap, own: list[Array]) -> Decimal:
    """The largest error of one bounce over the first few particles, against 50 digits, in units of 2**-52."""
    first = [field[:CHECKED].copy() for field in own]
    lam = np.full(CHECKED, float(map.lam))
    after = map.engine.run(KernelSpec(map.law, record=True), first, lam, map.shape, 1).record
    assert after is not None
    position, direction = errors(map, ExactMap(map, DIGITS), first, list(after[0]))
    return Decimal(f"{max(position.max(), direction.max()):.3g}")


def operation_table() -> str:
    """The vector instructions in one bounce, for every scene and type of result, as a table in Markdown."""
    lines = ["| scene | law | question | fma | add | mul | div | sqrt | compare | select |", "|" + "---|" * 10]
    for name in SCENES:
        for law, lam in LAWS.items():
            map = scene(name, lam)
            for question in (KernelSpec(law), KernelSpec(law, record=True), KernelSpec(law, exponents=True)):
                counts = operations(kernel_text(map.family, map.engine.names, question))
                asked = question.text.partition("-")[2] or "end"
                lines.append(
                    f"| {name} | {law} | {asked} | " + " | ".join(f"{count}" for count in counts.values()) + " |"
                )
    return "\n".join(lines) + "\n"


ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "benchmarks"
MISSING = "The baselines need a checkout, or the source distribution: benchmarks/ is no part of the installed package."
SCALAR = "numba, one particle at a time"


def is_checkout() -> bool:
    """True if the package runs from its source tree, next to the benchmark folder."""
    return (ROOT / "pyproject.toml").is_file() and FOLDER.is_dir()


def module(name: str) -> ModuleType | None:
    """A module of the benchmark folder; None if it is missing or cannot be imported."""
    path = FOLDER / f"{name}.py"
    if not is_checkout() or not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(found)
    except ImportError:
        return None
    return found


def scalar_way(scalar: ModuleType, name: str, map: PinballMap) -> Callable[..., tuple[Any, Any, Any]]:
    """A function that gives component, parameter and exit angle after a number of bounces in scalar numba.

    A table without a function of its own in `scalar` consists of straight sides, arcs and cubics.
    """
    own, lam = getattr(scalar, name, None), float(map.lam)
    given = float(map.shape[0]) if map.shape else 0.0
    numbers = None if own else scalar.numbers(map.table)

    def run(theta: Any, phi: Any, component: Any, bounces: int) -> tuple[Any, Any, Any]:
        k, at, out = component.copy(), theta.copy(), phi.copy()
        if own:
            scalar.every(own, at, out, lam, bounces, given)
        else:
            scalar.every_on_pieces(numbers, k, at, out, lam, bounces)
        return k, at, out

    return run


def baseline_rows(name: str, runs: int) -> Iterable[MethodResult]:
    """The timing of scalar numba on a scene; none without numba."""
    scalar, map = module("scalar_numba"), scene(name)
    if scalar is None:
        return
    rng, (low, high), count = np.random.default_rng(2), map.states.ends[0], 512
    theta, phi = rng.uniform(low * 0.99, high * 0.99, count), rng.uniform(-1.4, 1.4, count)
    compiled, nought = scalar_way(scalar, name, map), np.zeros(count, dtype=np.int64)
    _, at, out = compiled(theta[:CHECKED], phi[:CHECKED], nought[:CHECKED], 1)
    seconds = best(lambda: compiled(theta, phi, nought, 300), runs) / count / 300
    yield timing(name, SCALAR, _error(map, theta, phi, at, out), seconds, runs)


def _error(map: PinballMap, theta: Any, phi: Any, at: Any, out: Any) -> Decimal:
    """The largest error of parameter or exit angle over the first few particles, in units of 2**-52."""
    exact = ExactMap(map, DIGITS)
    mp, worst = exact.context, 0.0
    for i in range(CHECKED):
        truth = exact.bounce(exact.start(theta[i], phi[i]))
        gap = mp.mpf(float(at[i])) - truth.theta
        if truth.component == 0:
            gap -= 2 * mp.pi * mp.nint(gap / (2 * mp.pi))
        worst = max(worst, float(abs(gap)), float(abs(mp.mpf(float(out[i])) - truth.phi)))
    return Decimal(f"{worst * 2.0**52:.3g}")
