"""What a sweep will cost, before anything runs: bounces, seconds at the speed measured here, bytes."""

import os
import time
from typing import Any, NamedTuple

import numpy as np

from verification.sweeps.sweep import Sweep

BALLS, BOUNCES, RUNS = 1024, 400, 3


class Cost(NamedTuple):
    """`seconds` is what the kernel needs for that many bounces with `workers` like this core."""

    parts: int
    collisions: int
    nanoseconds: float
    workers: int
    bytes: int

    @property
    def seconds(self) -> float:
        """The kernel's time."""
        return self.collisions * self.nanoseconds * 1e-9 / self.workers

    def as_data(self) -> dict[str, Any]:
        """The keys of the JSON document."""
        return {**self._asdict(), "seconds": self.seconds}


def cost(sweep: Sweep, workers: int | None = None) -> Cost:
    """The cost of all parts of a sweep; the speed of a bounce with exponents is measured in some milliseconds."""
    workers = workers or cores()
    return Cost(len(sweep.indices()), sweep.collisions, speed(sweep.map()), workers, sweep.size)


def cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def speed(map: Any) -> float:
    """Nanoseconds for a bounce with exponents, on one core: the fastest of a few runs."""
    low, high = map.states.ends[0]
    theta = low + (high - low) * (np.arange(BALLS) + 0.5) / BALLS
    best = np.inf
    for _ in range(RUNS):
        begun = time.perf_counter()
        map.exponents(theta, 0.0 * theta, BOUNCES, threads=1)
        best = min(best, time.perf_counter() - begun)
    return float(best / BALLS / BOUNCES * 1e9)
