"""Efficiency of sweeps with several workers, and accuracy of the predicted cost: rows of `pinball bench`.

A worker loses time when it is idle between tasks, or waits within a task for the interpreter's lock. Time in which
other processes have the core is measured by Linux and not counted as loss, so the efficiency can be measured on a busy
machine too.

More workers than cores are tested with tasks that only wait, a second each, and return as much data as real ones. This
shows the cost of distributing, sending, gathering and writing to a store on a machine of any size.
"""

import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from numeric.sweeps.cost import cost
from numeric.sweeps.run import Results, on_cluster, on_processes, on_threads, run
from numeric.sweeps.space import parameter_space
from numeric.sweeps.sweep import Array, Field, Sweep, SweepPart, Task
from verification.measure.work.calls import Call

TASKS, PARTICLES, WORTH = 8, 2000, 1.2  # tasks, particles of each, and seconds that it takes at least
LENGTHS = 400, 2000  # bounces of two runs, from which the number that takes WORTH is found
EFFICIENCY, FORETOLD = 0.9, 1.2
WAIT, ROUNDS, WORKERS = 1.0, 4, 16  # seconds of a waiting task, tasks of each worker, number of workers
NOTES = 6  # of a task: worker, begin, end, waiting time of its thread before and after, processor time


def waited() -> float:
    """Seconds for which this thread has been ready to run but had no core; 0 if the system does not tell."""
    try:
        text = Path(f"/proc/self/task/{threading.get_native_id()}/schedstat").read_text()
    except OSError:
        return 0.0
    return int(text.split()[1]) * 1e-9


@dataclass(frozen=True)
class Watched:
    """A task that also records its worker, its begin and end, how long it had no core, and its processor time."""

    task: Task

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        began, before, spent = time.time(), waited(), time.thread_time()
        found = self.task(part)
        notes = np.zeros([len(values) for values in part.values.values()])
        ended = threading.get_native_id(), began, time.time(), before, waited(), time.thread_time() - spent
        notes.flat[:NOTES] = ended
        return found | {"notes": notes}


class Busy(NamedTuple):
    """The workers' wall time (except waiting for a core), the processor time of their tasks, the number of tasks."""

    seconds: float
    spent: float
    tasks: int


def busy(results: Results) -> Busy:
    """The time of the workers, each from the end of its first task, since that task includes loading."""
    rows = np.array([found["notes"].flat[:NOTES] for _, found in results])
    seconds, spent, tasks = 0.0, 0.0, 0
    for worker in np.unique(rows[:, 0]):
        own = rows[rows[:, 0] == worker]
        own = own[np.argsort(own[:, 1])]
        seconds += (own[-1, 2] - own[0, 2]) - (own[-1, 4] - own[0, 4])
        spent += float(np.sum(own[1:, 5]))
        tasks += len(own) - 1
    return Busy(seconds, spent, tasks)


def watched(bounces: int) -> Sweep:
    """A sweep over a small parameter space of the egg; all tasks take equally long, and record their times."""
    return with_watch(
        parameter_space(np.linspace(0.08, 0.0801, TASKS), np.linspace(0, 1, 20), PARTICLES // 20, bounces, 0)
    )


def with_watch(plain: Sweep) -> Sweep:
    """The sweep, with an extra field for the record of each task's times."""
    notes = Field("notes", tuple(axis.name for axis in plain.axes), "float64", "s", "of the worker")
    return replace(plain, task=Watched(plain.task), fields=(*plain.fields, notes))


@dataclass(frozen=True)
class Waiting:
    """A task that waits instead of computing, and returns arrays for its fields."""

    fields: tuple[Field, ...]
    seconds: float

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        time.sleep(self.seconds)
        sizes = {name: len(values) for name, values in part.values.items()}
        return {f.name: np.zeros([sizes[dim] for dim in f.dims if dim in sizes], f.dtype) for f in self.fields}


def waiting(workers: int, python: bool = False, seconds: float = WAIT) -> Sweep:
    """A sweep with `ROUNDS` waiting tasks for each worker; if `python`, in processes."""
    alphas = np.linspace(0.08, 0.0801, ROUNDS * workers)
    plain = parameter_space(alphas, np.linspace(0, 1, 1000), 1, 400, 0)
    return with_watch(replace(plain, task=Waiting(plain.fields, seconds), python=python))


def by_waiting(sweep: Sweep, workers: int, scheduler: str | None = None) -> float:
    """The worker time per waiting task in seconds, in a sweep that writes to a store."""
    with TemporaryDirectory() as folder:
        done = run(sweep, Path(folder) / "waiting.zarr", scheduler, workers)
        notes = np.asarray(done["notes"])
    found = busy(((i,), {"notes": row}) for i, row in enumerate(notes))
    return found.seconds / found.tasks


def waiting_rows(workers: int = WORKERS) -> Iterator[Call]:
    """Times of waiting tasks with more workers than cores, as threads, as processes and as workers of Dask."""

    def row(name: str, seconds: float) -> Call:
        call = f"a task that waits by one of {workers} {name}"
        return Call("sweep", call, seconds, "a second", WAIT, 1 / EFFICIENCY)

    yield row("threads", by_waiting(waiting(workers), workers))
    yield row("processes", by_waiting(waiting(workers, python=True), workers))
    with clustered(workers) as address:
        if address is not None:
            yield row("workers of Dask", by_waiting(waiting(workers), workers, address))


def sweep_rows() -> Iterable[Call]:
    """Times of sweeps with two threads, two processes and two Dask workers; predicted against measured time."""
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
    with clustered(2) as address:
        if address is not None:
            yield row("2 workers of Dask", on_cluster(sweep, indices, address))
    yield from waiting_rows()
    yield foretold()


@contextmanager
def clustered(workers: int) -> Iterator[str | None]:
    """The address of a Dask cluster of `workers` processes on this machine; None if Dask is not installed."""
    try:
        dask: Any = import_module("distributed")  # untyped
    except ImportError:
        yield None
        return
    with dask.LocalCluster(workers, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        yield cluster.scheduler_address


def foretold() -> Call:
    """A sweep's predicted and measured seconds: the larger is reported as time, the smaller as its reference."""
    grid = np.linspace(0, 1, 60)
    sweep = parameter_space((grid / 10).round(9), grid, 20, 1000, 1000)
    expected, begun = cost(sweep, 1, stored=False).seconds, time.process_time()
    run(sweep, workers=1)
    taken = time.process_time() - begun
    words = "60 x 60 pairs, foretold against taken"
    return Call("sweep", words, max(expected, taken), "the lesser of both", min(expected, taken), FORETOLD)
