"""Who does the tasks: the threads of this machine, or the workers of a Dask cluster.

Both hand back results as they come, and hold no more tasks at a time than keeps everyone busy.
"""

import logging
import time
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from importlib import import_module
from itertools import islice
from typing import Any

from numeric.sweeps.sweep import Array, Sweep

Index = tuple[int, ...]
Results = Generator[tuple[Index, dict[str, Array]], None, None]
AHEAD = 2  # parts handed out for each worker
ANSWER = 10.0  # seconds for a scheduler to answer
PATIENCE = 60.0  # seconds without any worker
LIVES = 3  # times that a part may lose its worker and be given to another


class UnfinishedError(Exception):
    """A sweep that could not be finished, in one sentence; what is done is kept."""


def on_threads(sweep: Sweep, indices: Sequence[Index], workers: int) -> Results:
    """The results of each part, by the threads of this process: the kernels let others run beside them."""
    waiting = iter(indices)
    with ThreadPoolExecutor(workers) as pool:
        running: dict[Future[dict[str, Array]], Index] = {}
        try:
            while True:
                for index in islice(waiting, AHEAD * workers - len(running)):
                    running[pool.submit(sweep.task, sweep.part(index))] = index
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    yield running.pop(future), future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def on_cluster(sweep: Sweep, indices: Sequence[Index], address: str) -> Results:
    """The results of each part, by the workers of the Dask scheduler at `address`."""
    from distributed.comm.core import CommClosedError

    dask: Any = import_module("distributed")  # untyped
    try:
        if "://" not in address:
            raise ValueError
        client = dask.Client(address, timeout=ANSWER)
    except (OSError, ValueError, TypeError):
        raise ValueError(
            f"--scheduler {address}: no Dask scheduler answers there; accepted: the address that "
            "`dask scheduler` prints, such as tcp://127.0.0.1:8786"
        ) from None
    with _quiet("distributed", "distributed.client", "distributed.core"):
        try:
            yield from _shared_out(dask, client, sweep, indices)
        except (CommClosedError, CancelledError):
            raise UnfinishedError(f"the Dask scheduler at {address} went away") from None
        finally:
            client.close(timeout=ANSWER)


@contextmanager
def _quiet(*names: str) -> Iterator[None]:
    """What goes wrong is said once, by us, and not in a traceback by the loggers named."""
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
    """What a worker found; None when it was lost on the way."""
    from distributed import KilledWorker

    try:
        found: dict[str, Array] = future.result()
    except KilledWorker:
        return None
    return found
