"""Times of whole calls, as users make them, relative to the kernel that they use; times of tables, relative to the egg.

Each ratio has an upper limit. Seconds differ between machines, ratios hardly: the two times of a ratio are the best of
alternating runs, in processor time, which other work does not lengthen. All run on one thread.
"""

from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import TOLD, KernelSpec, starting
from numeric.pinball.sampling import phase_starts
from symbolic import tables
from verification.measure.extremes.by_hand import discs, outline, spikes
from verification.measure.extremes.orbits import SCENES, scene
from verification.measure.work.bench import (
    FORMULAS,
    PARTICLES,
    SCALAR,
    attracted,
    best,
    module,
    scalar_way,
    timing,
)
from verification.measure.work.row import MethodResult

LOOP, LONG, MANY, WIDE = 100, 100_000, 100_000, 1_000  # calls in a loop, bounces, particles, both
REST = 512, 1_000, 100_000  # particles at rest: how many, bounces of a short run, of a long one
FEW_AT_REST = 64, 4_000, 40_000  # the same, where a bounce takes ten times as long

WANDERING = "999999/1000000"
KERNEL = "llvm, lam = 0.999999"
IN_TURN, SCALAR_PARTICLES = 50, 512  # bounces of one of the alternating runs, and its particles in numba
BARS: dict[str, tuple[str, float | None]] = {  # table: the one that its bounce is compared with, and the largest ratio
    "egg": ("egg", None),
    "square": ("egg", 0.6),
    "triangle": ("egg", 0.6),
    "stadium": ("egg", 1.0),
    "sinai": ("egg", 1.0),
    "regular100": ("square", 6.0),
    "limacon": ("egg", 6.0),
    "star": ("egg", 12.0),
    "peanut": ("egg", 8.0),
    "conic": ("egg", 8.0),
    "egg_polynomial": ("egg", 1.15),
    "egg_sine": ("egg", 1.5),
    "spline30": ("egg", 12.0),
    "dented30": ("egg", 12.0),
    "discs36": ("square", None),
    "discs100": ("square", None),
    "spikes40": ("square", None),
    "spikes100": ("square", None),
}


class Call(NamedTuple):
    """The time of a call and of its reference, in seconds per bounce; `bar` is the largest accepted ratio."""

    scene: str
    call: str
    seconds: float
    against: str
    reference: float
    bar: float

    @property
    def ratio(self) -> float:
        """The time of the call divided by that of its reference.

        >>> Call("egg", "a call", 3e-9, "the kernel", 2e-9, 2.0).ratio
        1.5
        """
        return self.seconds / self.reference

    def as_data(self) -> dict[str, Any]:
        """The row as JSON."""
        return self._asdict() | {"ratio": self.ratio}


def taking_turns(one: Callable[[], object], other: Callable[[], object], runs: int) -> tuple[float, float]:
    """The shortest times of two actions, whose runs alternate."""
    times = [(best(one, 1), best(other, 1)) for _ in range(runs)]
    return min(first for first, _ in times), min(second for _, second in times)


def call_rows(name: str, runs: int) -> Iterable[Call]:
    """Timed calls on one of the paper's tables; on another table, only those for particles that come to rest."""
    if name not in SCENES:
        yield at_rest(name, min(runs, 3), FEW_AT_REST)
        return
    yield from single_rows(name, runs)
    yield from batch_rows(name, runs)
    yield at_rest(name, min(runs, 3))


def single_rows(name: str, runs: int) -> Iterable[Call]:
    """Timed calls for one particle, in microseconds, and for its orbit, relative to the kernel."""
    map = scene(name)
    starts = phase_starts(map, 1, seed=1)
    one = float(starts.theta[0]), float(starts.phi[0]), int(starts.component[0])
    for call, action, bar in (("step", map.step, 8.0), ("derivative", map.derivative, 10.0)):
        action(*one)
        seconds = best(lambda action=action: [action(*one) for _ in range(LOOP)], 20 * runs) / LOOP  # type: ignore[misc]
        yield Call(name, f"{call} of one, in a Python loop", seconds, "a microsecond", 1e-6, bar)
    yield Call(name, "PinballMap, made again", best(lambda: scene(name), 5 * runs), "a millisecond", 1e-3, 1.0)
    if name == "circle":  # a bounce is two sums and a product: angles and points cost more
        return
    own = map.states.enter(starts.component, starts.theta, starts.phi, map.law)
    lam = np.full(1, float(map.lam))

    def told() -> object:
        return map.orbit(one[0], one[1], LONG, one[2])

    def alone() -> object:
        return map.engine.run(KernelSpec(map.law), own, lam, map.shape, LONG, threads=1)

    told(), alone()
    seconds, reference = taking_turns(told, alone, runs)
    yield Call(name, f"orbit of one x {LONG:,}", seconds / LONG, "its kernel, a bounce", reference / LONG, 1.3)


def batch_rows(name: str, runs: int) -> Iterable[Call]:
    """Timed calls for many particles, relative to the kernel; on the circle only `step`, as its bounce is so cheap."""
    map = scene(name)
    starts = phase_starts(map, MANY, seed=1)
    at, phi, where = starts.theta, starts.phi, starts.component
    few = at[:WIDE], phi[:WIDE], where[:WIDE]
    own, lam = attracted(map, WIDE), np.full(WIDE, float(map.lam))
    tangent = tuple(starting(np.ones(WIDE), np.zeros(WIDE), np.ones(WIDE)))

    def kernel(exponents: bool = False) -> object:
        spec = KernelSpec(map.law, exponents=exponents)
        return map.engine.run(spec, own, lam, map.shape, WIDE, tangent if exponents else (), threads=1)

    calls: tuple[tuple[str, Callable[[], object], int, bool, float], ...] = (
        (f"step of {MANY:,}", lambda: map.step(at, phi, where), MANY, False, 60.0),
        (f"derivative of {MANY:,}", lambda: map.derivative(at, phi, where), MANY, True, 3.0),
        ("orbits, parameter and angle", lambda: told(("theta", "phi")), WIDE**2, False, 3.0),
        ("orbits, angles and points", lambda: told(TOLD), WIDE**2, False, 3.0),
        ("orbits, with arc length", lambda: told((*TOLD, "s")), WIDE**2, False, 3.0),
    )

    def told(fields: tuple[str, ...]) -> object:
        return map.orbit(few[0], few[1], WIDE, few[2], threads=1, fields=fields)

    for call, action, count, exponents, bar in calls[:1] if name == "circle" else calls:
        action(), kernel(exponents)
        seconds, reference = taking_turns(action, lambda: kernel(exponents), runs)  # noqa: B023
        if bar > 10:
            yield Call(name, call, seconds / count, "a nanosecond", 1e-9, bar)
            continue
        against = "the kernel with exponents" if exponents else "the kernel"
        yield Call(name, call, seconds / count, against, reference / WIDE**2, bar)


def pieces_at_rest(runs: int) -> Iterable[Call]:
    """Timed calls for particles that come to rest, on tables with straight sides or discs."""
    for table in (tables.square(), tables.regular(6), discs(6)):
        yield at_rest(table.name, runs, FEW_AT_REST, PinballMap(table, lam="9/10"))


def at_rest(name: str, runs: int, sizes: tuple[int, int, int] = REST, map: PinballMap | None = None) -> Call:
    """Time per bounce in a long run of particles that come to rest, against a short run: tests for subnormals."""
    count, short, long = sizes
    map = map or scene(name, "9/10")
    starts = phase_starts(map, count, seed=1)

    def once(bounces: int) -> object:
        return map.exponents(starts.theta, starts.phi, bounces, component=starts.component, threads=1)

    once(1)
    seconds, reference = taking_turns(lambda: once(long), lambda: [once(short) for _ in range(10)], runs)
    made = f"exponents, {long:,} bounces"
    return Call(
        name, made, seconds / long / count, f"{short:,} bounces, lam = 9/10", reference / 10 / short / count, 1.1
    )


def compared(name: str, lam: Any = WANDERING) -> PinballMap:
    """The map that a key of `BARS` names: a table, or the egg with another law for `egg_...`.

    >>> compared("sinai").ir.table, compared("egg_sine").law
    ('sinai', 'formula')
    """
    laws = dict(zip(("egg_polynomial", "egg_sine"), FORMULAS, strict=True))
    if name in laws:
        return PinballMap("egg", lam=lam, law=laws[name], **SCENES["egg"])
    own: dict[str, Callable[[], tables.Table]] = {
        "square": tables.square,
        "triangle": tables.triangle,
        "stadium": tables.stadium,
        "sinai": tables.sinai,
        "regular100": partial(tables.regular, 100),
        "spline30": partial(outline, 30, 0.03, name),
        "dented30": partial(outline, 30, 0.2, name),
        "discs36": partial(discs, 6),
        "discs100": partial(discs, 10),
        "spikes40": partial(spikes, 40),
        "spikes100": partial(spikes, 100),
    }
    return PinballMap(own[name](), lam=lam) if name in own else scene(name, lam)


def table_rows(runs: int, baselines: bool = True, names: Iterable[str] = tuple(BARS)) -> Iterable[MethodResult]:
    """Timings of a bounce on every table in `BARS`, by a kernel and in scalar numba alternately.

    All are at one contraction close to 1; at a smaller one, particles settle between parallel walls and miss all
    obstacles. Without numba there are rows for the kernels only.
    """
    scalar, ways = module("scalar_numba") if baselines else None, dict[tuple[str, str], Callable[[], object]]()
    for name in names:
        map, lam = compared(name), np.full(PARTICLES, float(Fraction(WANDERING)))
        own = attracted(map, PARTICLES, 10)
        ways[name, KERNEL] = partial(map.engine.run, KernelSpec(map.law), own, lam, map.shape, IN_TURN, (), 1)
        if scalar is not None:
            component, theta, phi, *_ = phase_starts(map, SCALAR_PARTICLES, seed=1)
            ways[name, SCALAR] = partial(scalar_way(scalar, name, map), theta, phi, component, IN_TURN)
    times: dict[tuple[str, str], list[float]] = {way: [] for way in ways}
    for _ in range(runs + 1):  # the first compiles
        for way, once in ways.items():
            times[way].append(best(once, 1) / IN_TURN / (PARTICLES if way[1] == KERNEL else SCALAR_PARTICLES))
    for (name, kernel), spent in times.items():
        yield timing(name, kernel, None, min(spent[1:]), runs, WANDERING)
