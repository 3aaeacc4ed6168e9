"""The measurements of `pinball bench`: error and time of every arithmetic and every kernel, with baselines.

The baselines of the benchmark folder are naive NumPy + lambdify, scalar numba, and the paper's own algorithms in a
first version. They are not part of the installed package, and need a checkout or the source distribution. Without them,
or without numba, the benchmark runs with the package's own rows only, and prints a note.
"""

import importlib.util
import os
import platform
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import flint
import mpmath
import numpy as np
from flint import arb
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.kernels import machine
from numeric.kernels.machine import KernelSpec, starting
from numeric.kernels.text import kernel_text, operations
from numeric.pinball.sampling import phase_starts
from verification.arithmetic.balls import bits_of, working
from verification.maps.enclosed import EnclosedMap
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.orbits import DIGITS, RADII, SCENES, scene

Array = NDArray[np.float64]
LAWS: dict[str, str | float] = {"slap": 0, "pinball": "19/20", "elastic": 1}
FORMULAS = ("-lam*eta*(1 - eta**2/8)", "-lam*eta - sin(2*eta)/50")  # two further laws: a polynomial, and one sine
PARTICLES, RUNS = 4096, 5
WORTH_A_THREAD = 0.2  # seconds of work below which a second thread does not pay
CHECKED = 24  # particles whose errors are measured
FEW = 8  # particles in multiprecision
MORE = 30  # extra digits of the reference
SMALLEST = Decimal("1e-300")  # smallest error written as a float
UNIT = "2**-52, largest of position and direction"


@dataclass(frozen=True)
class SceneTiming:
    """One method for a bounce in one scene: its largest error over random particles, and its time per bounce.

    Errors are decimals, as they can be smaller than all floats. `lam` is not in the JSON, but part of `kernel` if
    unusual.
    """

    scene: str
    arithmetic: str
    kernel: str
    error: Decimal | None
    seconds_per_bounce: float
    runs: int
    lam: Any = LAWS["pinball"]

    def as_data(self) -> dict[str, Any]:
        """The row as JSON; an error outside the range of floats is a decimal string."""
        small = self.error is not None and 0 < self.error < SMALLEST
        error = None if self.error is None else str(self.error) if small else float(self.error)
        names = ("scene", "arithmetic", "kernel", "seconds_per_bounce", "runs")
        return {name: getattr(self, name) for name in names} | {"error": error, "error_unit": UNIT}


def machine_facts() -> dict[str, str]:
    """The machine and the versions of packages, by name."""
    import llvmlite
    import scipy

    facts = {"python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    facts |= {"numpy": np.__version__, "scipy": scipy.__version__, "llvmlite": llvmlite.__version__}
    facts |= {
        "mpmath": mpmath.__version__,
        "mpmath's integers": mpmath.libmp.BACKEND,
        "python-flint": flint.__version__,
    }
    if machine.available():
        import llvmlite.binding as llvm

        facts["processor"] = llvm.get_host_cpu_name()
    return facts | {"processors": str(os.cpu_count())}


def best(action: Callable[[], object], runs: int = RUNS, clock: Callable[[], float] = time.process_time) -> float:
    """The least processor time in seconds of `runs` runs of an action; other work on the machine hardly affects it."""
    times = []
    for _ in range(runs):
        start = clock()
        action()
        times.append(clock() - start)
    return max(min(times), 1e-9)  # for a clock that did not advance


def kernel_rows(name: str, runs: int = RUNS) -> Iterable[SceneTiming]:
    """Timings of the LLVM kernels (plain, with exponents, with two threads), and of the same step on NumPy."""
    for kernels, kernel, particles, bounces in ((True, "llvm", PARTICLES, 1000), (False, "numpy", PARTICLES, 10)):
        map = PinballMap(name, lam=LAWS["pinball"], kernels=kernels, **_shape(name))
        own = attracted(map, particles)
        lam = np.full(particles, float(map.lam))
        error = worst(map, own)

        def run(
            question: KernelSpec,
            tangent: tuple[Array, ...] = (),
            threads: int = 1,
            map: PinballMap = map,
            own: list[Array] = own,
            lam: Array = lam,
            bounces: int = bounces,
            clock: Callable[[], float] = time.process_time,
        ) -> float:
            def once() -> object:
                return map.engine.run(question, own, lam, map.shape, bounces, tangent, threads)

            once()
            return best(once, runs, clock) / bounces / own[0].size

        nought = np.zeros(particles)
        alone = run(KernelSpec(map.law))
        yield SceneTiming(name, "float64", kernel, error, alone, runs)
        if kernels:
            copies = 1 + int(WORTH_A_THREAD / (alone * particles * bounces))  # not more bounces, which would underflow
            many = [np.tile(field, copies) for field in own]
            tangent = tuple(starting(nought + 1, nought, nought + 1))
            yield SceneTiming(
                name, "float64", "llvm, exponents", error, run(KernelSpec(map.law, exponents=True), tangent), runs
            )
            both = run(KernelSpec(map.law), threads=2, own=many, lam=np.tile(lam, copies), clock=time.perf_counter)
            yield SceneTiming(name, "float64", "llvm, 2 threads", error, both, runs)
            recorded = run(KernelSpec(map.law, record=True), bounces=100)
            yield SceneTiming(name, "float64", "llvm, whole orbits kept", error, recorded, runs)
            yield SceneTiming(
                name, "float64", "llvm, orbits as angles and points", None, _told(map, own, 100, runs), runs
            )
    for law in ("slap", "elastic"):
        map = PinballMap(name, lam=LAWS[law], **_shape(name))
        own, lam = attracted(map, PARTICLES, 1), np.full(PARTICLES, float(map.lam))
        alone = run(KernelSpec(law), map=map, own=own, lam=lam, bounces=1000)
        yield SceneTiming(name, "float64", f"llvm, lam = {LAWS[law]}", worst(map, own), alone, runs, LAWS[law])
    for formula in FORMULAS if name == "egg" else ():
        map = PinballMap(name, lam=LAWS["pinball"], law=formula, **_shape(name))
        own, lam = attracted(map, PARTICLES), np.full(PARTICLES, float(map.lam))
        alone = run(KernelSpec(map.law), map=map, own=own, lam=lam, bounces=1000)
        yield SceneTiming(name, "float64", f"llvm, phi = {formula}", worst(map, own), alone, runs)


def own_rows(name: str, runs: int = RUNS) -> Iterable[SceneTiming]:
    """Timings of the kernels, with and without exponents, on a table that is not in the paper."""
    map = scene(name)
    own, lam, nought = attracted(map, PARTICLES), np.full(PARTICLES, float(map.lam)), np.zeros(PARTICLES)
    error = worst(map, own)
    for kernel, spec in (("llvm", KernelSpec(map.law)), ("llvm, exponents", KernelSpec(map.law, exponents=True))):
        tangent = tuple(starting(nought + 1, nought, nought + 1)) if spec.exponents else ()

        def once(spec: KernelSpec = spec, tangent: tuple[Array, ...] = tangent) -> object:
            return map.engine.run(spec, own, lam, map.shape, 300, tangent, 1)

        once()
        yield SceneTiming(name, "float64", kernel, error, best(once, runs) / 300 / PARTICLES, runs)


def _told(map: PinballMap, own: list[Array], bounces: int, runs: int) -> float:
    """Seconds per bounce of `PinballMap.orbit`, which returns all bounces and not only the last."""
    component, theta = map.states.place(own)
    phi = map.states.exit(component, theta, own, map.law)

    def once() -> object:
        return map.orbit(theta, phi, bounces, component, threads=1)

    once()
    return best(once, runs) / bounces / theta.size


def multiprecision_rows(name: str, digits: Iterable[int], runs: int = 1) -> Iterable[SceneTiming]:
    """Timings and errors of mpmath and balls with given digits; errors are against an enclosure with 30 digits more."""
    map, lam = PinballMap(name, lam=LAWS["pinball"], **_shape(name)), Fraction(str(LAWS["pinball"]))
    component, theta, phi, *_ = phase_starts(map, FEW, seed=3)
    particles = [(float(t), float(p), int(c)) for c, t, p in zip(component, theta, phi, strict=True)]
    for wanted in digits:
        truth = EnclosedMap(map, lam, bits_of(wanted + MORE, 64))
        landed = [truth.bounce(truth.start(*particle)) for particle in particles]
        ways = (("mpmath", ExactMap(map, wanted, lam)), ("arb", EnclosedMap(map, lam, bits_of(wanted, 64))))
        for arithmetic, way in ways:
            starts = [way.start(*particle) for particle in particles]
            found = [way.bounce(start) for start in starts]
            error = max(distance(one, two, wanted) for one, two in zip(found, landed, strict=True))

            def all_of_them(way: Any = way, starts: Any = starts) -> object:
                return [way.bounce(start) for start in starts]

            yield SceneTiming(name, arithmetic, f"{wanted} digits", error, best(all_of_them, runs) / FEW, runs)


def distance(found: Any, truth: Any, digits: int) -> Decimal:
    """The largest error of parameter and exit angle, rounded to `digits`, against balls `truth`, in units of 2**-52."""
    largest = arb(0)
    with working(bits_of(digits + 2 * MORE)):
        for one, two in ((found.theta, truth.theta), (found.phi, truth.phi)):
            written = one.mid().str(digits, radius=False) if isinstance(one, arb) else mpmath.nstr(one, digits)
            largest = largest.max(arb(abs(arb(written) - two).upper()))
        return Decimal((largest * 2**52).upper().str(3, radius=False))


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


def frontier(rows: list[SceneTiming]) -> set[int]:
    """Indices of the rows on the Pareto front: no row at the same contraction has both less error and less time.

    >>> row = lambda error, seconds: SceneTiming("s", "a", "k", Decimal(error), seconds, 1)
    >>> sorted(frontier([row(1, 1.0), row(2, 2.0), row(0, 3.0)]))
    [0, 2]
    """
    front = set()
    for i, row in enumerate(rows):
        if (
            row.error is not None
            and row.lam == LAWS["pinball"]
            and not any(
                other.error is not None
                and other.lam == row.lam
                and other.error <= row.error
                and other.seconds_per_bounce <= row.seconds_per_bounce
                and (other.error, other.seconds_per_bounce) != (row.error, row.seconds_per_bounce)
                for other in rows
            )
        ):
            front.add(i)
    return front


def operation_table() -> str:
    """The vector instructions in one bounce, for every scene and type of result, as a table in Markdown."""
    lines = ["| scene | law | question | fma | add | mul | div | sqrt | compare | select |", "|" + "---|" * 10]
    for name in SCENES:
        for law, lam in LAWS.items():
            map = PinballMap(name, lam=lam, **_shape(name))
            for question in (KernelSpec(law), KernelSpec(law, record=True), KernelSpec(law, exponents=True)):
                counts = operations(kernel_text(map.family, map.engine.names, question))
                asked = question.text.partition("-")[2] or "end"
                lines.append(f"| {name} | {law} | {asked} | " + " | ".join(map_str(counts.values())) + " |")
    return "\n".join(lines) + "\n"


def map_str(numbers: Iterable[int]) -> list[str]:
    """The numbers as text."""
    return [str(number) for number in numbers]


def _shape(name: str) -> dict[str, Any]:
    return dict(SCENES[name])


ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "benchmarks"
MISSING = "The baselines need a checkout, or the source distribution: benchmarks/ is no part of the installed package."
MEASURED = 24  # particles whose errors are measured
LAM = 0.95
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


def baseline_rows(name: str, runs: int) -> Iterable[SceneTiming]:
    """Timings of the three baselines on a scene; only of the first for a table that is not in the paper."""
    rng = np.random.default_rng(2)
    shape: dict[str, Any] = dict(SCENES.get(name, {}))
    map = scene(name)
    low, high = map.states.ends[0]
    theta, phi = rng.uniform(low * 0.99, high * 0.99, 2048), rng.uniform(-1.4, 1.4, 2048)
    scalar, nought = module("scalar_numba"), np.zeros(2048, dtype=np.int64)
    if scalar is not None:
        compiled = scalar_way(scalar, name, map)

        def looped() -> None:
            compiled(theta[:512], phi[:512], nought[:512], 300)

        _, at, out = compiled(theta[:MEASURED], phi[:MEASURED], nought[:MEASURED], 1)
        error = _error(map, theta, phi, at, out)
        yield SceneTiming(name, "float64", SCALAR, error, best(looped, runs) / 512 / 300, runs)
    if name in RADII:
        return
    arrays = module("arrays_lambdify")
    naive = arrays.baseline(name, shape) if arrays is not None else None
    if naive is not None:
        with np.errstate(all="ignore"):
            error = _error(map, theta, phi, *naive.bounce(theta[:MEASURED], phi[:MEASURED], LAM))

            def lambdified() -> None:
                at, out = theta, phi
                for _ in range(10):
                    at, out = naive.bounce(at, out, LAM)

            yield SceneTiming(
                name, "float64", "numpy + lambdify", error, best(lambdified, runs) / theta.size / 10, runs
            )
    ways = module("paper_ways")
    if ways is not None:
        way = getattr(ways, name)

        def papers() -> Any:
            return [
                way(0, a, b, LAM, *map.shape)
                for a, b in zip(theta[:MEASURED].tolist(), phi[:MEASURED].tolist(), strict=True)
            ]

        _, at, out = (np.array(column, dtype=float) for column in zip(*papers(), strict=True))
        error = _error(map, theta, phi, at, out)
        yield SceneTiming(name, "float64", "the paper's way, in Python", error, best(papers, runs) / MEASURED, runs)


def _error(map: PinballMap, theta: Any, phi: Any, at: Any, out: Any) -> Decimal:
    """The largest error of parameter or exit angle over the first few particles, in units of 2**-52."""
    exact = ExactMap(map, DIGITS)
    mp, worst = exact.context, 0.0
    for i in range(MEASURED):
        truth = exact.bounce(exact.start(theta[i], phi[i]))
        gap = mp.mpf(float(at[i])) - truth.theta
        if truth.component == 0:
            gap -= 2 * mp.pi * mp.nint(gap / (2 * mp.pi))
        worst = max(worst, float(abs(gap)), float(abs(mp.mpf(float(out[i])) - truth.phi)))
    return Decimal(f"{worst * 2.0**52:.3g}")
