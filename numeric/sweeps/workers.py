"""Independent work in processes, on all cores: the claims of a report, its figures, or a sweep in Python.

Threads of Python wait for one another; moreover ball arithmetic and mpmath have global state, and SymPy has caches. So
workers are processes, started afresh. Results are yielded as they come. A process that dies is replaced, and the item
it worked on is tried once more.
"""

import gc
import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_all_start_methods, get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from pathlib import Path
from queue import SimpleQueue
from threading import Thread, current_thread, main_thread
from typing import Any, Generic, TypeVar

Item = TypeVar("Item")
Answer = TypeVar("Answer")
TRIES = 2  # processes that one item may cost
GRACE = 5.0  # seconds for a process to end


ROOT = str(Path(__file__).resolve().parents[2])  # the folder of this project's packages


def own_command(module: str, *arguments: str) -> tuple[list[str], dict[str, str]]:
    """The command and the environment that run a module of this package in a process of its own.

    It imports from the same folders as this process: Python's `-m` alone would search the current folder first, and run
    a file `json.py` that somebody left there.
    """
    return [sys.executable, "-P", "-m", module, *arguments], {**os.environ, **_paths()}


def _paths() -> dict[str, str]:
    """Environment variables with which a child process imports from the same folders as this one, and no others."""
    folders = [path or ROOT for path in sys.path]  # the empty one is the current folder
    folders += [] if ROOT in folders else [ROOT]
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": os.pathsep.join(folders)}


@contextmanager
def _same_paths() -> Iterator[None]:
    """Makes processes that are started within the block import from the same folders as this one, and no others."""
    before = {name: os.environ.get(name) for name in _paths()}
    os.environ.update(_paths())
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def cores() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Lost:
    """Takes the place of the answer for an item whose process died each time that it was tried."""

    status: int

    def __str__(self) -> str:
        ended = f"exit status {self.status}"
        if self.status < 0:
            ended = f"signal {-self.status} ({signal.strsignal(-self.status) or 'unknown'})"
        return f"the process that worked at it died {TRIES} times, at last of {ended}; it may have run out of memory"


@dataclass
class _Worker(Generic[Item]):
    """A worker process, this end of its pipe, and in order the items that it was given and has not yet answered."""

    process: BaseProcess
    pipe: Connection
    ready: bool = False
    waiting: deque[Item] = field(default_factory=deque)


def in_processes(
    work: Callable[[Item], Answer],
    tasks: Iterable[Sequence[Item]],
    jobs: int | None,
    modules: Sequence[str] = (),
    ahead: int = 0,
) -> Generator[tuple[Item, Answer | Lost], None, None]:
    """Yields pairs of an item and `work(item)`, as they are finished; one process does all items of a task, in order.

    There are `jobs` processes, or one for each core. With `ahead`, a process holds this many further items as long as
    there are more tasks than processes, so that no process waits while answers are written; the last tasks are given
    out singly. `work`, items and answers must be picklable. `modules` are those that every worker needs, imported once
    where the system can fork. An exception of `work` is raised here. However the generator ends, even by Ctrl-C, the
    workers end with it.
    """
    queue = deque(list(task) for task in tasks)
    context = _context(modules)
    workers: list[_Worker[Item]] = []
    tried: dict[int, int] = {}  # by identity: an item need not be hashable
    try:
        with _beginning():
            workers.extend(_started(context, work) for _ in range(min(jobs or cores(), len(queue))))
        while workers:
            for pipe in wait([each.pipe for each in workers]):
                worker = next(each for each in workers if each.pipe is pipe)
                try:
                    told = worker.pipe.recv()
                except (EOFError, OSError):
                    workers.remove(worker)
                    yield from _mourned(worker, queue, tried)
                    if queue:
                        with _beginning():
                            workers.append(_started(context, work))
                    continue
                if worker.ready and isinstance(told, BaseException):
                    raise told
                answered = [(worker.waiting.popleft(), told)] if worker.ready else []
                worker.ready = True
                while queue and len(worker.waiting) <= (ahead if len(queue) > len(workers) else 0):
                    worker.waiting.extend(queue[0])  # before the answer is used
                    worker.pipe.send(queue.popleft())
                yield from answered
                if not worker.waiting:
                    workers.remove(worker)
                    worker.pipe.close()  # which ends it
                    worker.process.join(GRACE)
    finally:
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join(GRACE)


def begin(modules: Sequence[str]) -> None:
    """Starts the server that imports `modules` for later processes, where the system can fork; returns at once.

    `in_processes` with the same modules then waits only until the imports are finished.
    """
    if _context(modules).get_start_method() == "forkserver":
        from multiprocessing.forkserver import ensure_running

        with _beginning():
            ensure_running()


def _context(modules: Sequence[str]) -> BaseContext:
    """The context for processes that inherit nothing: forked from a server that has imported `modules`, or spawned."""
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload([__name__, *modules])
    return context


@contextmanager
def _beginning() -> Iterator[None]:
    """Makes processes that are started within the block import as this one does, and delays Ctrl-C until they run."""
    with _same_paths():
        resource_tracker.ensure_running()  # whose start, left to a later moment, lets Ctrl-C through
        with undisturbed():
            yield


@contextmanager
def undisturbed() -> Iterator[None]:
    """Delays Ctrl-C until the end of the block, for example while processes start or results are stored.

    A half started process would end with a traceback. Processes inherit the mask, so that from their first instruction
    on Ctrl-C goes to the process that started them. A mask binds one thread, and libraries have threads of their own
    that the signal may reach: the exception that it would raise is delayed as well.
    """
    usual = signal.getsignal(signal.SIGINT)
    if not hasattr(signal, "pthread_sigmask") or usual is None or current_thread() is not main_thread():
        yield
        return
    heard: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        signal.signal(signal.SIGINT, usual)
        if heard:
            signal.raise_signal(signal.SIGINT)


def _started(context: BaseContext, work: Callable[[Item], Answer]) -> _Worker[Item]:
    here, there = context.Pipe()
    process: BaseProcess = context.Process(target=_serve, args=(there, work, gc.get_threshold()), daemon=True)  # type: ignore[attr-defined]
    process.start()
    there.close()  # so that its death is heard
    return _Worker(process, here)


def _serve(pipe: "Connection", work: Callable[[Any], Any], rarely: tuple[int, int, int]) -> None:
    """The loop of a worker: it answers until the pipe closes, and leaves Ctrl-C to the process that started it.

    Garbage is collected as `rarely` as in the process that started it; imported objects are exempt.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.set_threshold(*rarely)
    gc.freeze()
    tasks: SimpleQueue[Any] = SimpleQueue()
    Thread(target=_received, args=(pipe, tasks), daemon=True).start()
    try:
        pipe.send(None)  # it has started
        while (task := tasks.get()) is not None:
            for item in task:
                try:
                    answer = work(item)
                except Exception as error:
                    answer = error
                pipe.send(answer)
    except (EOFError, OSError):
        return


def _received(pipe: "Connection", tasks: "SimpleQueue[Any]") -> None:
    """Reads tasks from the pipe as they come; otherwise both ends could wait for each other to read."""
    try:
        while True:
            tasks.put(pipe.recv())
    except (EOFError, OSError):
        tasks.put(None)


def _mourned(
    worker: _Worker[Item], queue: deque[list[Item]], tried: dict[int, int]
) -> Generator[tuple[Item, Answer | Lost], None, None]:
    """Puts the items of a dead worker back into the queue; yields `Lost` for an item that killed `TRIES` processes."""
    worker.process.join(GRACE)
    status = worker.process.exitcode or 0
    if not worker.ready:
        raise RuntimeError(f"a worker process ended at its start with exit status {status}; --jobs 1 needs none")
    if not worker.waiting:
        return
    item = worker.waiting.popleft()
    tried[id(item)] = tried.get(id(item), 0) + 1
    if worker.waiting:
        queue.appendleft(list(worker.waiting))
    if tried[id(item)] < TRIES:
        queue.appendleft([item])
    else:
        yield item, Lost(status)
