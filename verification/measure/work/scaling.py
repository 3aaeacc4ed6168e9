"""How well a sweep keeps several workers busy, and whether what it costs was foretold: rows of `pinball bench`.

A worker loses time where it stands still between tasks, or within one for the interpreter's lock; where it only waits
for a core that other work has, Linux says how long, and that is no loss. So a busy machine shows the efficiency too.
"""

import threading
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from numeric.sweeps.cost import cost
from numeric.sweeps.fields import parameter_space
from numeric.sweeps.run import Results, on_cluster, on_processes, on_threads, run
from numeric.sweeps.sweep import Array, Field, Part, Sweep, Task
from verification.measure.work.calls import Call

TASKS, PARTICLES, WORTH = 8, 2000, 1.2  # tasks, particles of each, and seconds that it takes at least
LENGTHS = 400, 2000  # bounces, to measure how many take that long
EFFICIENCY, FORETOLD = 0.9, 1.2
NAMES = ("worker", "began", "ended", "waited before", "waited", "spent")


def waited() -> float:
    """Seconds for which this thread had work and no core, since it began; 0 where the system does not tell."""
    try:
        text = Path(f"/proc/self/task/{threading.get_native_id()}/schedstat").read_text()
    except OSError:
        return 0.0
    return int(text.split()[1]) * 1e-9


@dataclass(frozen=True)
class Watched:
    """A task, with who did it, from when to when, how long it had no core, and the processor's seconds."""

    task: Task

    def __call__(self, part: Part) -> dict[str, Array]:
        began, before, spent = time.time(), waited(), time.thread_time()
        found = self.task(part)
        ended = threading.get_native_id(), began, time.time(), before, waited(), time.thread_time() - spent
        return found | {name: np.array([value]) for name, value in zip(NAMES, ended, strict=True)}


class Busy(NamedTuple):
    """Seconds of all workers from their first task to their last, but for waiting; and the processor's, for tasks."""

    seconds: float
    spent: float
    tasks: int


def busy(results: Results) -> Busy:
    """What workers did with their time, each from the end of its first task on, which loads and makes what it needs."""
    rows = np.array([[float(found[name][0]) for name in NAMES] for _, found in results])
    seconds, spent, tasks = 0.0, 0.0, 0
    for worker in np.unique(rows[:, 0]):
        own = rows[rows[:, 0] == worker]
        own = own[np.argsort(own[:, 1])]
        seconds += (own[-1, 2] - own[0, 2]) - (own[-1, 4] - own[0, 4])
        spent += float(np.sum(own[1:, 5]))
        tasks += len(own) - 1
    return Busy(seconds, spent, tasks)


def watched(bounces: int) -> Sweep:
    """A small parameter space of the egg, of tasks that take equally long and are watched."""
    plain = parameter_space(np.linspace(0.08, 0.0801, TASKS), np.linspace(0, 1, 20), PARTICLES // 20, bounces, 0)
    extra = tuple(Field(name, ("alpha",), "float64", "s", "of the worker") for name in NAMES)
    return replace(plain, task=Watched(plain.task), fields=(*plain.fields, *extra))


def sweep_rows() -> Iterable[Call]:
    """A sweep by two threads, by processes and by workers of Dask; and its seconds beside those that were foretold."""
    short, long = (busy(on_threads(watched(bounces), watched(bounces).indices(), 1)).spent for bounces in LENGTHS)
    rise = max((long - short) / (TASKS - 1) / (LENGTHS[1] - LENGTHS[0]), 1e-9)
    sweep = watched(round(WORTH / rise / 4) * 4)
    indices = sweep.indices()
    alone = busy(on_threads(sweep, indices, 1))

    def row(name: str, results: Results) -> Call:
        found, bar = busy(results), 1 / EFFICIENCY
        reference = alone.spent / alone.tasks
        return Call("sweep", f"a task by one of {name}", found.seconds / found.tasks, "one worker", reference, bar)

    yield row("2 threads", on_threads(sweep, indices, 2))
    yield row("2 processes", on_processes(sweep, indices, 2))
    yield from clustered(partial(row, "2 workers of Dask"), sweep)
    yield foretold()


def clustered(row: "partial[Call]", sweep: Sweep) -> Iterable[Call]:
    """By a Dask cluster on this machine, where Dask is installed."""
    try:
        dask: Any = import_module("distributed")  # untyped
    except ImportError:
        return
    with dask.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        yield row(on_cluster(sweep, sweep.indices(), cluster.scheduler_address))


def foretold() -> Call:
    """The larger of the seconds that a sweep was to take and those that it took, beside the smaller."""
    grid = np.linspace(0, 1, 60)
    sweep = parameter_space((grid / 10).round(9), grid, 20, 1000, 1000)
    expected, begun = cost(sweep, 1, stored=False).seconds, time.process_time()
    run(sweep, workers=1)
    taken = time.process_time() - begun
    words = "60 x 60 pairs, foretold against taken"
    return Call("sweep", words, max(expected, taken), "the lesser of both", min(expected, taken), FORETOLD)
