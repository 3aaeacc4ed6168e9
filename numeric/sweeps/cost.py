"""The cost of a sweep, estimated before it begins: seconds, bytes of results, and memory.

The sweep's task is timed on some of its parts, spread over the grid, until the mean is known. Short parts are timed
whole; long ones are thinned to two sizes, from which the fixed cost and the cost of each coordinate follow. The first
run of a part also makes its map; its additional time is the cost of a map. What is measured is processor time, which
other programs hardly lengthen.
"""

import time
import tracemalloc
from collections.abc import Callable, Iterator
from math import prod
from typing import Any, NamedTuple

import numpy as np

from numeric.pinball.map import PinballMap
from numeric.sweeps.run import AHEAD
from numeric.sweeps.sweep import Sweep, SweepPart
from numeric.sweeps.workers import cores

LEAST, CLOSE = 6, 0.03  # parts that are timed, and the relative standard error of their mean that is enough
ENOUGH = 1_500_000  # bounces of the first thinned part, which says how long they take: some hundredths of a second
MOST = 20_000_000  # of the smallest thinned part; beyond, only the kernel's speed is measured
SPAN = 0.1  # seconds of a part that is run whole, about
SHARE, PATIENCE = 0.02, (0.3, 20.0)  # of all the seconds, at least and at most so many are spent on timing
PARTICLES, BOUNCES, TURNS = 1024, 400, 3  # to measure the kernel's speed
GOLDEN = (5**0.5 - 1) / 2  # its multiples are spread evenly over the unit interval, however many there are
Clock = Callable[[], float]


class Cost(NamedTuple):
    """The estimated cost of a sweep: processor time per bounce in `nanoseconds`, all included, and at most `memory`
    bytes.

    `error` is the relative standard error of the seconds, from the differences between the `looked` parts that were
    timed; it is None if only the kernel's speed was measured. `memory` comes on top of that of the program and its
    libraries. At most `workers` parts are worked on at a time, so `memory` does not grow with the grid, unless the
    results are kept in memory and not in a store.
    """

    parts: int
    collisions: int
    nanoseconds: float
    workers: int
    bytes: int
    memory: int
    looked: int = 0
    error: float | None = None

    @property
    def seconds(self) -> float:
        """The seconds that the sweep takes with `workers` cores like this one."""
        return self.collisions * self.nanoseconds * 1e-9 / self.workers

    def as_data(self) -> dict[str, Any]:
        """The entries of the JSON document."""
        return {**self._asdict(), "seconds": self.seconds}

    def lines(self) -> list[str]:
        """The estimate as lines of text."""
        known = "the kernel alone" if self.error is None else f"+- {self.error:.0%}, from {self.looked} parts"
        return [
            f"{self.parts} parts, {self.collisions:.3g} bounces",
            f"about {duration(self.seconds)} on {self.workers} cores: {self.nanoseconds:.1f} ns a bounce, measured "
            f"({known})",
            f"{size(self.bytes)} of results before compression",
            f"{size(self.memory)} of memory at most, about, for {self.workers} parts at a time",
        ]


def duration(seconds: float) -> str:
    """A time as text, in seconds, minutes or hours."""
    if seconds < 90:
        return f"{seconds:.2g} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def size(count: int) -> str:
    """A number of bytes as text."""
    for unit, least in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= least:
            return f"{count / least:.3g} {unit}"
    return f"{count} bytes"


def cost(sweep: Sweep, workers: int | None = None, stored: bool = True, clock: Clock = time.process_time) -> Cost:
    """The cost of all parts of a sweep. `stored` is true if results go into a store; `clock` returns seconds."""
    workers, parts = workers or cores(), len(sweep.indices())
    kept = AHEAD * workers * sweep.size // parts + (0 if stored else sweep.size)
    each, length = max(sweep.collisions / parts, 1.0), prod(_cut(sweep).values())
    few = max(1, min(length, round(length * ENOUGH / each)))
    order = _spread(sweep)
    only_speed = each * few / length > MOST
    # the attractors of basins are found later; without them the task is another one
    if only_speed or sweep.settings.get("attractors") == []:
        peak = 0.0 if only_speed else _largest(sweep, next(order), few, min(length, 2 * few), length)
        return Cost(parts, sweep.collisions, speed(sweep.map()), workers, sweep.size, kept + int(workers * peak))

    def seconds(part: SweepPart) -> float:
        begun = clock()
        sweep.task(part)
        return clock() - begun

    whole = prod(axis.size for axis in sweep.axes if axis.part > 1) * _scenes(sweep)
    begun, first = clock(), next(order)
    start = _thinned(sweep, first, few)
    compiling = seconds(start)
    short = max(seconds(start), 1e-9)
    more = min(length, max(few, int(few * SPAN / short)))
    few = more if more == length else max(1, more // 2)
    found, once, places, total = list[float](), list[float](), list[int](), 0.0
    for at in (first, *order):
        small, large = _thinned(sweep, at, few), _thinned(sweep, at, more)
        made = [] if at == first else [seconds(small)]  # with its map, which the first part has
        again = seconds(small)
        most = again if few == more else seconds(large)
        places.append(_places(sweep, sweep.part(at)))
        found.append(_line(few, more, places[-1], again, most))
        once += [max(0.0, new - again) for new in made]
        total = sum(found) / sum(places) * whole + float(np.median(once or [0.0])) * _scenes(sweep)
        error = _error(found, places, parts)
        patience = min(max(PATIENCE[0], SHARE * total), PATIENCE[1])
        if (len(found) >= LEAST and error < CLOSE) or clock() - begun - compiling > patience:
            break
    peak = _largest(sweep, first, few, more, length) if compiling < PATIENCE[1] else 0.0
    nanoseconds, memory = total / max(sweep.collisions, 1) * 1e9, kept + int(workers * peak)
    return Cost(parts, sweep.collisions, nanoseconds, workers, sweep.size, memory, len(found), error)


def _spread(sweep: Sweep) -> Iterator[tuple[int, ...]]:
    """Yields every part once, in an order in which each part is far from those before it."""
    indices = sweep.indices()
    seen: set[int] = set()
    for i in range(8 * len(indices)):
        at = int((0.5 + i * GOLDEN) % 1.0 * len(indices))
        if at not in seen:
            seen.add(at)
            yield indices[at]


def _error(found: list[float], places: list[int], parts: int) -> float:
    """The relative standard error of the time per grid point, from measured parts; 0 if all `parts` were measured."""
    count = len(found)
    if count >= parts:
        return 0.0
    if count < 2:
        return 1.0
    beyond = np.array(found) - sum(found) / sum(places) * np.array(places)
    return float(np.sqrt(np.sum(beyond**2) / (count - 1) * count * (1 - count / parts)) / sum(found))


def _scenes(sweep: Sweep) -> int:
    """The number of maps to prepare: one for each combination of values on the axes where a part has a single value."""
    return prod(axis.size for axis in sweep.axes if axis.part == 1)


def _places(sweep: Sweep, part: SweepPart) -> int:
    """The number of grid points of a part along the axes on which a part has several values."""
    return prod(len(part.values[name]) for name in _cut(sweep))


def speed(map: PinballMap) -> float:
    """Nanoseconds for a bounce with exponents, on one core."""
    low, high = map.states.ends[0]
    theta = low + (high - low) * (np.arange(PARTICLES) + 0.5) / PARTICLES
    map.exponents(theta, 0.0 * theta, 1, threads=1)
    times = []
    for _ in range(TURNS):
        begun = time.process_time()
        map.exponents(theta, 0.0 * theta, BOUNCES, threads=1)
        times.append(time.process_time() - begun)
    return float(min(times) / PARTICLES / BOUNCES * 1e9)


def _cut(sweep: Sweep) -> dict[str, int]:
    """The axes along which a part takes several values, with the number of values."""
    return {axis.name: min(axis.part, axis.size) for axis in sweep.axes if axis.part > 1}


def _thinned(sweep: Sweep, index: tuple[int, ...], count: int) -> SweepPart:
    """A part thinned to about `count` coordinates, equally spaced along its axes."""
    part, values = sweep.part(index), {}
    for name in _cut(sweep):
        here = part.values[name]
        kept = max(1, min(len(here), count))
        values[name] = here[(np.arange(kept) * 2 + 1) * len(here) // (2 * kept)]
        count //= kept
    return part._replace(values={**part.values, **values})


def _line(few: int, more: int, length: int, small: float, large: float) -> float:
    """The cost of a whole part, extrapolated from the costs `small` and `large` of two thinned parts."""
    if more == few:
        return large * length / more
    rise = max(0.0, large - small) / (more - few)
    return large + rise * (length - more)


def _largest(sweep: Sweep, at: tuple[int, ...], few: int, more: int, length: int) -> float:
    """The largest number of bytes that a whole part takes at once, extrapolated from thinned parts."""
    ends = [_peak(sweep, _thinned(sweep, at, count)) for count in (few, more)[: 1 + (few < more)]]
    return _line(few, more, length, float(ends[0]), float(ends[-1]))


def _peak(sweep: Sweep, part: SweepPart) -> int:
    """The largest number of bytes that a part takes at once."""
    watched = tracemalloc.is_tracing()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    sweep.task(part)
    peak = tracemalloc.get_traced_memory()[1] - before
    if not watched:
        tracemalloc.stop()
    return peak
