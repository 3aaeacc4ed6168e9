"""What a sweep will cost, before it begins: seconds, bytes of results, and memory.

Its own task is run on thinned parts, spread over the grid: at two sizes each, so that what a part costs whatever its
size is told from what each coordinate adds, and a first time, when its map is made. Measured is the processor's time,
which other work hardly lengthens.
"""

import time
import tracemalloc
from math import prod
from typing import Any, NamedTuple

import numpy as np

from numeric.pinball.map import PinballMap
from numeric.sweeps.run import AHEAD
from numeric.sweeps.sweep import Part, Sweep, cores

PROBES, RUNS = 5, 2  # parts that are looked at, and how often each is run
ENOUGH = 1_500_000  # bounces of a thinned part: some hundredths of a second
MOST = 20_000_000  # of the smallest thinned part; beyond, only the kernel's speed is measured
PATIENCE = 3.0  # seconds, after which no other part is looked at
PARTICLES, BOUNCES = 1024, 400


class Cost(NamedTuple):
    """`nanoseconds` are the processor's, for a bounce with all that goes with it; `memory` is in bytes, at most, about.

    At no time more than `workers` parts are worked on, so memory does not grow with the grid, but for results that go
    into no store.
    """

    parts: int
    collisions: int
    nanoseconds: float
    workers: int
    bytes: int
    memory: int

    @property
    def seconds(self) -> float:
        """How long it takes with `workers` cores like this one."""
        return self.collisions * self.nanoseconds * 1e-9 / self.workers

    def as_data(self) -> dict[str, Any]:
        """The keys of the JSON document."""
        return {**self._asdict(), "seconds": self.seconds}

    def lines(self) -> list[str]:
        """The estimate, for people."""
        return [
            f"{self.parts} parts, {self.collisions:.3g} bounces",
            f"about {duration(self.seconds)}: {self.nanoseconds:.1f} ns a bounce, measured, on {self.workers} cores",
            f"{size(self.bytes)} of results before compression",
            f"{size(self.memory)} of memory at most, about, for {self.workers} parts at a time",
        ]


def duration(seconds: float) -> str:
    """A time, for people."""
    if seconds < 90:
        return f"{seconds:.2g} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def size(count: int) -> str:
    """Bytes, for people."""
    for unit, least in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= least:
            return f"{count / least:.3g} {unit}"
    return f"{count} bytes"


def cost(sweep: Sweep, workers: int | None = None, stored: bool = True) -> Cost:
    """The cost of all parts of a sweep, whose results go into a store or stay in memory."""
    workers = workers or cores()
    indices = sweep.indices()
    each, length = sweep.collisions / len(indices), prod(_cut(sweep).values())
    few = max(1, min(length, round(length * ENOUGH / max(each, 1.0))))
    more = min(length, 2 * few)
    kept = AHEAD * workers * sweep.size // len(indices) + (0 if stored else sweep.size)
    if each * few / length > MOST:
        return Cost(len(indices), sweep.collisions, speed(sweep.map()), workers, sweep.size, kept)
    chosen = [indices[len(indices) * (2 * i + 1) // (2 * PROBES)] for i in range(min(PROBES, len(indices)))]
    ends = [(_thinned(sweep, at, few), _thinned(sweep, at, more)) for at in chosen]
    if (
        sweep.settings.get("attractors") == []
    ):  # they are looked for later; to compare with none of them is another task
        peak = _line(few, more, length, *(float(_peak(sweep, part)) for part in ends[0]))
        return Cost(len(indices), sweep.collisions, speed(sweep.map()), workers, sweep.size, kept + int(workers * peak))
    begun, first = time.process_time(), _seconds(sweep, ends[0][0])  # which compiles
    found, once = list[float](), [0.0]
    for small, large in ends:
        if found and time.process_time() - begun > PATIENCE:
            break
        news, again = _seconds(sweep, small), min(_seconds(sweep, small) for _ in range(RUNS))
        found.append(_line(few, more, length, again, min(_seconds(sweep, large) for _ in range(RUNS))))
        once += [max(0.0, news - again)] if len(found) > 1 else []
    total = float(np.mean(found)) * len(indices) + float(np.median(once[1:] or once)) * _scenes(sweep)
    peak = _line(few, more, length, *(float(_peak(sweep, part)) for part in ends[0])) if first < PATIENCE else 0.0
    nanoseconds = total / max(sweep.collisions, 1) * 1e9
    return Cost(len(indices), sweep.collisions, nanoseconds, workers, sweep.size, kept + int(workers * peak))


def _scenes(sweep: Sweep) -> int:
    """How many times a part meets values of which it must prepare the map first: those taken one at a time."""
    return prod(axis.size for axis in sweep.axes if axis.part == 1)


def speed(map: PinballMap) -> float:
    """Nanoseconds for a bounce with exponents, on one core."""
    low, high = map.states.ends[0]
    theta = low + (high - low) * (np.arange(PARTICLES) + 0.5) / PARTICLES
    map.exponents(theta, 0.0 * theta, 1, threads=1)
    times = []
    for _ in range(RUNS + 1):
        begun = time.process_time()
        map.exponents(theta, 0.0 * theta, BOUNCES, threads=1)
        times.append(time.process_time() - begun)
    return float(min(times) / PARTICLES / BOUNCES * 1e9)


def _cut(sweep: Sweep) -> dict[str, int]:
    """The axes of which a part takes several values but not all that there are: how many."""
    return {axis.name: min(axis.part, axis.size) for axis in sweep.axes if axis.part > 1}


def _thinned(sweep: Sweep, index: tuple[int, ...], count: int) -> Part:
    """A part with about so many coordinates: the middle ones of as many equal shares."""
    part, values = sweep.part(index), {}
    for name in _cut(sweep):
        here = part.values[name]
        kept = max(1, min(len(here), count))
        values[name] = here[(np.arange(kept) * 2 + 1) * len(here) // (2 * kept)]
        count //= kept
    return part._replace(values={**part.values, **values})


def _line(few: int, more: int, length: int, small: float, large: float) -> float:
    """What a whole part takes, from what two thinned ones take."""
    if more == few:
        return large * length / more
    rise = max(0.0, large - small) / (more - few)
    return large + rise * (length - more)


def _seconds(sweep: Sweep, part: Part) -> float:
    begun = time.process_time()
    sweep.task(part)
    return time.process_time() - begun


def _peak(sweep: Sweep, part: Part) -> int:
    """Bytes at once."""
    watched = tracemalloc.is_tracing()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    sweep.task(part)
    peak = tracemalloc.get_traced_memory()[1] - before
    if not watched:
        tracemalloc.stop()
    return peak
