"""Runs the missing parts of a sweep, by threads, processes or a Dask cluster, into memory or into a store.

All executors give results as they come. Threads are used for kernels, which release the interpreter's lock. A task that
is mostly Python holds this lock, so its sweep asks for processes.
"""

import errno
import logging
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numeric.sweeps.store import Memory, Stored, kept, opened
from numeric.sweeps.sweep import Array, Sweep
from numeric.sweeps.workers import Lost, cores, in_processes

if TYPE_CHECKING:
    import xarray as xr


Index = tuple[int, ...]
Results = Generator[tuple[Index, dict[str, Array]], None, None]
AHEAD = 2  # parts handed out for each worker
ANSWER = 10.0  # seconds for a scheduler to answer
PATIENCE = 60.0  # seconds without any worker
LIVES = 3  # times that a part may lose its worker and be given to another


class UnfinishedError(Exception):
    """The error that a sweep could not be finished, with a one-sentence reason; finished parts are kept."""


def on_threads(sweep: Sweep, indices: Sequence[Index], workers: int) -> Results:
    """The results of each part, computed by threads of this process; kernels release the interpreter's lock."""
    waiting = iter(indices)
    with ThreadPoolExecutor(workers) as pool:
        running: dict[Future[dict[str, Array]], Index] = {}

        def hand_out() -> None:
            for index in islice(waiting, AHEAD * workers - len(running)):
                running[pool.submit(sweep.task, sweep.part(index))] = index

        try:
            hand_out()
            while running:
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    index = running.pop(future)
                    hand_out()  # before the answer is written
                    yield index, future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def in_memory(sweep: Sweep, workers: int) -> dict[str, Array]:
    """The fields of a sweep by name, computed by threads and kept nowhere else.

    >>> from numeric.sweeps.space import parameter_space
    >>> import numpy as np
    >>> int(in_memory(parameter_space(np.array([0.0]), np.array([0.5]), 3, 40, 40), 1)["chaotic"][0, 0])
    0
    """
    results = Memory(sweep)
    for index, arrays in on_threads(sweep, results.missing(), workers):
        results.write(index, arrays)
    return results.arrays


def on_processes(sweep: Sweep, indices: Sequence[Index], workers: int) -> Results:
    """The results of each part, computed by processes; `UnfinishedError` if a part's process dies each time."""
    tasks = ([sweep.part(index)] for index in indices)
    for part, found in in_processes(sweep.task, tasks, workers, [type(sweep.task).__module__], ahead=AHEAD - 1):
        if isinstance(found, Lost):
            raise UnfinishedError(f"the part at {part.at}: {found}")
        yield part.at, found


def connected(address: str) -> Any:
    """A client of the Dask scheduler at `address`; `ValueError` where none answers."""
    dask: Any = import_module("distributed")  # untyped
    try:
        if "://" not in address:
            raise ValueError
        return dask.Client(address, timeout=ANSWER)
    except (OSError, ValueError, TypeError):
        raise ValueError(
            f"--scheduler {address}: no Dask scheduler answers there; accepted: the address that "
            "`dask scheduler` prints, such as tcp://127.0.0.1:8786"
        ) from None


def on_cluster(sweep: Sweep, indices: Sequence[Index], address: str) -> Results:
    """The results of each part, computed by the workers of the Dask scheduler at `address`."""
    from distributed.comm.core import CommClosedError

    dask: Any = import_module("distributed")
    client = connected(address)
    with _quiet("distributed", "distributed.client", "distributed.core"):
        try:
            yield from _shared_out(dask, client, sweep, indices)
        except (CommClosedError, CancelledError):
            raise UnfinishedError(f"the Dask scheduler at {address} went away") from None
        finally:
            client.close(timeout=ANSWER)


@contextmanager
def _quiet(*names: str) -> Iterator[None]:
    """Silences the named loggers within the block, since this package reports each error once itself."""
    levels = {name: logging.getLogger(name).level for name in names}
    try:
        for name in names:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


def _shared_out(dask: Any, client: Any, sweep: Sweep, indices: Sequence[Index]) -> Results:
    waiting, running = iter(indices), dict[Any, Index]()
    lives = dict.fromkeys(indices, LIVES)
    seen = time.monotonic()
    while True:
        workers = sum(client.nthreads().values())
        for index in islice(waiting, max(0, AHEAD * workers - len(running))):
            running[_given(client, sweep, index)] = index
        seen = time.monotonic() if workers else seen
        if time.monotonic() - seen > PATIENCE:
            raise UnfinishedError(f"no Dask worker has been there for {PATIENCE:.0f} s")
        if not running and workers:
            return
        try:
            done = dask.wait(list(running), timeout=1, return_when="FIRST_COMPLETED").done if running else ()
        except TimeoutError:
            continue
        for future in done:
            index = running.pop(future)
            found = _found(future)
            if found is not None:
                yield index, found
                continue
            lives[index] -= 1
            if lives[index] == 0:
                raise UnfinishedError(f"the part at {index} lost its worker again and again")
            running[_given(client, sweep, index)] = index


def _given(client: Any, sweep: Sweep, index: Index) -> Any:
    return client.submit(sweep.task, sweep.part(index), pure=False)


def _found(future: Any) -> dict[str, Array] | None:
    """The result of a worker; None if the worker was lost."""
    from distributed import KilledWorker

    try:
        found: dict[str, Array] = future.result()
    except KilledWorker:
        return None
    return found


FULL = {
    getattr(errno, name): words
    for name, words in {
        "ENOSPC": "the disk is full",
        "EDQUOT": "the quota is used up",
        "EFBIG": "a file would be too large",
        "EROFS": "the store lies on a file system that is read-only",
        "EACCES": "the store may not be written",
        "EIO": "the disk does not answer",
    }.items()
    if hasattr(errno, name)
}
Tick = Callable[[int, int], None]


def run(
    sweep: Sweep,
    store: Path | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    tick: Tick | None = None,
) -> "xr.Dataset":
    """The results as a labelled Dataset; `tick(done, parts)` is called as parts come in.

    The other arguments are those of `carried_out`.
    """
    return carried_out(sweep, store, scheduler, workers, tick).dataset()


def carried_out(
    sweep: Sweep,
    store: Path | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    tick: Tick | None = None,
) -> Memory | Stored:
    """The results of a sweep, as arrays by name in `.arrays`; `.dataset()` labels them by xarray, whose import takes a
    second.

    With a `store`, parts that it already has are kept. If the run ends early, `UnfinishedError` or `KeyboardInterrupt`
    says how many parts are stored. The bits do not depend on `scheduler`, `workers`, or interruptions.
    """
    place: AbstractContextManager[Memory | Stored] = (
        nullcontext(Memory(sweep)) if store is None else opened(sweep, store)
    )
    with place as results:
        parts, missing = len(sweep.indices()), results.missing()
        done = parts - len(missing)
        if tick is not None:
            tick(done, parts)
        workers = min(workers or cores(), max(1, len(missing)))
        local = on_processes if sweep.python and workers > 1 else on_threads
        pool = on_cluster(sweep, missing, scheduler) if scheduler else local(sweep, missing, workers)
        try:
            for index, arrays in pool:
                results.write(index, arrays)
                done += 1
                if tick is not None:
                    tick(done, parts)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; {kept(store, done, parts)}") from None
        except UnfinishedError as stop:
            raise UnfinishedError(f"{stop}; {kept(store, done, parts)}") from None
        except OSError as error:
            reason = FULL.get(error.errno or 0, str(error))
            raise UnfinishedError(f"{reason}; {kept(store, done, parts)}") from None
        finally:
            pool.close()  # which lets the workers go
        return results
