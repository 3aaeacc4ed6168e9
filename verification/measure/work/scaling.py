"""How well a sweep keeps several workers busy, and whether what it costs was foretold: rows of `pinball bench`.

A worker loses time where it stands still between tasks, or within one for the interpreter's lock; where it only waits
for a core that other work has, Linux says how long, and that is no loss. So a busy machine shows the efficiency too.

More workers than cores are asked with tasks that only wait, for a second each, and hand back as much as others do: what
handing out, sending, gathering and writing into a store costs is then seen on a machine of any size.
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
from numeric.sweeps.sweep import Array, Field, Part, Sweep, Task
from verification.measure.work.calls import Call

TASKS, PARTICLES, WORTH = 8, 2000, 1.2  # tasks, particles of each, and seconds that it takes at least
LENGTHS = 400, 2000  # bounces, to measure how many take that long
EFFICIENCY, FORETOLD = 0.9, 1.2
WAIT, ROUNDS, WORKERS = 1.0, 4, 16  # seconds of a task that waits, how many each worker has, and workers
NOTES = 6  # of a task: its worker, when it began and ended, what its thread had waited by then, what it spent


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
        notes = np.zeros([len(values) for values in part.values.values()])
        ended = threading.get_native_id(), began, time.time(), before, waited(), time.thread_time() - spent
        notes.flat[:NOTES] = ended
        return found | {"notes": notes}


class Busy(NamedTuple):
    """Seconds of all workers from their first task to their last, but for waiting; and the processor's, for tasks."""

    seconds: float
    spent: float
    tasks: int


def busy(results: Results) -> Busy:
    """What workers did with their time, each from the end of its first task on, which loads and makes what it needs."""
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
    """A small parameter space of the egg, of tasks that take equally long and are watched."""
    return with_watch(
        parameter_space(np.linspace(0.08, 0.0801, TASKS), np.linspace(0, 1, 20), PARTICLES // 20, bounces, 0)
    )


def with_watch(plain: Sweep) -> Sweep:
    """The sweep, with what is noted of each task."""
    notes = Field("notes", tuple(axis.name for axis in plain.axes), "float64", "s", "of the worker")
    return replace(plain, task=Watched(plain.task), fields=(*plain.fields, notes))


@dataclass(frozen=True)
class Waiting:
    """A task that waits in place of computing, and hands back arrays of its fields."""

    fields: tuple[Field, ...]
    seconds: float

    def __call__(self, part: Part) -> dict[str, Array]:
        time.sleep(self.seconds)
        sizes = {name: len(values) for name, values in part.values.items()}
        return {f.name: np.zeros([sizes[dim] for dim in f.dims if dim in sizes], f.dtype) for f in self.fields}


def waiting(workers: int, python: bool = False, seconds: float = WAIT) -> Sweep:
    """A parameter space with `ROUNDS` tasks for each worker that wait, by processes where it is `python`."""
    alphas = np.linspace(0.08, 0.0801, ROUNDS * workers)
    plain = parameter_space(alphas, np.linspace(0, 1, 1000), 1, 400, 0)
    return with_watch(replace(plain, task=Waiting(plain.fields, seconds), python=python))


def by_waiting(sweep: Sweep, workers: int, scheduler: str | None = None) -> float:
    """Seconds for one task that waits, of a worker's time, by the whole way of a sweep into a store of its own."""
    with TemporaryDirectory() as folder:
        done = run(sweep, Path(folder) / "waiting.zarr", scheduler, workers)
        notes = np.asarray(done["notes"])
    found = busy(((i,), {"notes": row}) for i, row in enumerate(notes))
    return found.seconds / found.tasks


def waiting_rows(workers: int = WORKERS) -> Iterator[Call]:
    """What more workers than cores take for tasks that wait: by threads, by processes and by workers of Dask."""

    def row(name: str, seconds: float) -> Call:
        call = f"a task that waits by one of {workers} {name}"
        return Call("sweep", call, seconds, "a second", WAIT, 1 / EFFICIENCY)

    yield row("threads", by_waiting(waiting(workers), workers))
    yield row("processes", by_waiting(waiting(workers, python=True), workers))
    with clustered(workers) as address:
        if address is not None:
            yield row("workers of Dask", by_waiting(waiting(workers), workers, address))


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
    with clustered(2) as address:
        if address is not None:
            yield row("2 workers of Dask", on_cluster(sweep, indices, address))
    yield from waiting_rows()
    yield foretold()


@contextmanager
def clustered(workers: int) -> Iterator[str | None]:
    """The address of a Dask cluster on this machine, of so many processes; None where Dask is not installed."""
    try:
        dask: Any = import_module("distributed")  # untyped
    except ImportError:
        yield None
        return
    with dask.LocalCluster(workers, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        yield cluster.scheduler_address


def foretold() -> Call:
    """The larger of the seconds that a sweep was to take and those that it took, beside the smaller."""
    grid = np.linspace(0, 1, 60)
    sweep = parameter_space((grid / 10).round(9), grid, 20, 1000, 1000)
    expected, begun = cost(sweep, 1, stored=False).seconds, time.process_time()
    run(sweep, workers=1)
    taken = time.process_time() - begun
    words = "60 x 60 pairs, foretold against taken"
    return Call("sweep", words, max(expected, taken), "the lesser of both", min(expected, taken), FORETOLD)
