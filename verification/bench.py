"""What `pinball bench` measures: error and time of every arithmetic and every kernel, and what a kernel leaves out."""

import platform
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap, machine
from numeric.kernel import kernel_text, operations
from numeric.question import Question, starting
from numeric.sampling import phase_starts
from verification.exact_map import ExactMap
from verification.truth import errors

Array = NDArray[np.float64]
SCENES: dict[str, dict[str, str]] = {
    "circle": {},
    "ellipse": {"a": "3/2"},
    "cardioid": {},
    "cuspless": {},
    "egg": {"alpha": "2/25"},
}
LAWS = {"slap": 0, "pinball": "19/20", "elastic": 1}
BALLS, RUNS = 4096, 5
WORTH_A_THREAD = 0.2  # seconds of work; less of it stays on one core
CHECKED = 24  # balls whose errors are measured
UNIT = "2**-52, largest of position and direction"


@dataclass(frozen=True)
class Row:
    """One way to bounce one scene: its largest error over random balls, and its time for one bounce."""

    scene: str
    arithmetic: str
    kernel: str
    error: float | None
    seconds_per_bounce: float
    runs: int
    error_unit: str = UNIT

    def as_data(self) -> dict[str, Any]:
        """The row as contract.md has it."""
        names = ("scene", "arithmetic", "kernel", "error", "error_unit", "seconds_per_bounce", "runs")
        return {name: getattr(self, name) for name in names}


def machine_facts() -> dict[str, str]:
    """The machine and the versions, for a footer."""
    import llvmlite
    import scipy

    facts = {"python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    facts |= {"numpy": np.__version__, "scipy": scipy.__version__, "llvmlite": llvmlite.__version__}
    if machine.available():
        import llvmlite.binding as llvm

        facts["processor"] = llvm.get_host_cpu_name()
    return facts


def best(action: Callable[[], object], runs: int = RUNS) -> float:
    """The shortest of some runs, in seconds: the one that was disturbed least."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def kernel_rows(name: str, runs: int = RUNS) -> Iterable[Row]:
    """LLVM kernels, with and without exponents and with two threads, and the same step on NumPy arrays."""
    for kernels, kernel, balls, bounces in ((True, "llvm", BALLS, 1000), (False, "numpy", BALLS, 10)):
        map = PinballMap(name, lam=LAWS["pinball"], kernels=kernels, **_shape(name))
        own = attracted(map, balls)
        lam = np.full(balls, float(map.lam))
        error = worst(map, own)

        def run(
            question: Question,
            tangent: tuple[Array, ...] = (),
            threads: int = 1,
            map: PinballMap = map,
            own: list[Array] = own,
            lam: Array = lam,
            bounces: int = bounces,
        ) -> float:
            def once() -> object:
                return map.engine.run(question, own, lam, map.shape, bounces, tangent, threads)

            once()
            return best(once, runs) / bounces / own[0].size

        nought = np.zeros(balls)
        alone = run(Question(map.law))
        yield Row(name, "float64", kernel, error, alone, runs)
        if kernels:
            copies = 1 + int(WORTH_A_THREAD / (alone * balls * bounces))  # more balls, for more bounces would underflow
            many = [np.tile(field, copies) for field in own]
            tangent = tuple(starting(nought + 1, nought, nought + 1))
            yield Row(name, "float64", "llvm, exponents", error, run(Question(map.law, exponents=True), tangent), runs)
            both = run(Question(map.law), threads=2, own=many, lam=np.tile(lam, copies))
            yield Row(name, "float64", "llvm, 2 threads", error, both, runs)


def multiprecision_rows(name: str, digits: Iterable[int], runs: int = 1) -> Iterable[Row]:
    """mpmath and balls; their error is what their digits promise, in the same unit."""
    from verification.orbits import in_balls, in_multiprecision

    map = PinballMap(name, lam=LAWS["pinball"], **_shape(name))
    for wanted in digits:
        for arithmetic, follow in (("mpmath", in_multiprecision), ("arb", in_balls)):
            start, lam = (0, 0.3, 0.2), map.lam.flat[0].item()

            def once(follow: Any = follow, start: Any = start, lam: Any = lam, wanted: int = wanted) -> object:
                return follow(map, lam, start, 3, wanted, lambda step: None)

            error = 10.0 ** (15.65 - wanted) if wanted < 300 else 0.0
            yield Row(name, arithmetic, f"{wanted} digits", error, best(once, runs) / 3, runs)


def attracted(map: PinballMap, balls: int, transient: int = 100) -> list[Array]:
    """Fields of random balls after some bounces."""
    starts = phase_starts(map, balls, seed=1)
    own = map.states.enter(starts.component, starts.theta, starts.phi, map.law)
    rows = map.engine.run(Question(map.law), own, np.full(balls, float(map.lam)), map.shape, transient).rows
    return [np.ascontiguousarray(rows[field]) for field in map.family.fields(map.law)]


def worst(map: PinballMap, own: list[Array]) -> float:
    """The largest error of one bounce over the first balls, in units of 2**-52, against 40 digits."""
    first = [field[:CHECKED].copy() for field in own]
    lam = np.full(CHECKED, float(map.lam))
    after = map.engine.run(Question(map.law, record=True), first, lam, map.shape, 1).record
    assert after is not None
    position, direction = errors(map, ExactMap(map, 40), first, list(after[0]))
    return float(max(position.max(), direction.max()))


def frontier(rows: list[Row]) -> set[int]:
    """The rows that no other beats in both error and time: the Pareto front.

    >>> row = lambda error, seconds: Row("s", "a", "k", error, seconds, 1)
    >>> sorted(frontier([row(1, 1.0), row(2, 2.0), row(0, 3.0)]))
    [0, 2]
    """
    front = set()
    for i, row in enumerate(rows):
        if row.error is not None and not any(
            other.error is not None
            and other.error <= row.error
            and other.seconds_per_bounce <= row.seconds_per_bounce
            and (other.error, other.seconds_per_bounce) != (row.error, row.seconds_per_bounce)
            for other in rows
        ):
            front.add(i)
    return front


def operation_table() -> str:
    """The vector instructions of one bounce, for every scene and question, as a table in Markdown."""
    lines = ["| scene | law | question | fma | add | mul | div | sqrt | compare | select |", "|" + "---|" * 10]
    for name in SCENES:
        for law, lam in LAWS.items():
            map = PinballMap(name, lam=lam, **_shape(name))
            for question in (Question(law), Question(law, record=True), Question(law, exponents=True)):
                counts = operations(kernel_text(map.family, map.engine.names, question))
                asked = question.text.partition("-")[2] or "end"
                lines.append(f"| {name} | {law} | {asked} | " + " | ".join(map_str(counts.values())) + " |")
    return "\n".join(lines) + "\n"


def map_str(numbers: Iterable[int]) -> list[str]:
    """Numbers as text."""
    return [str(number) for number in numbers]


def _shape(name: str) -> dict[str, Any]:
    return dict(SCENES[name])
