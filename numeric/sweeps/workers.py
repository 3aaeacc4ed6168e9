"""Independent work in worker processes, over all cores: the claims of a report, its figures, a sweep in Python.

Threads of Python wait for one another, balls and mpmath hold ambient state and SymPy its caches, so workers are
processes, started afresh. Answers come as they are found, whatever became of the process: one that
dies is replaced, and what it was at is tried once more.
"""

import gc
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_all_start_methods, get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from queue import SimpleQueue
from threading import Thread, current_thread, main_thread
from typing import Any, Generic, TypeVar

Item = TypeVar("Item")
Answer = TypeVar("Answer")
TRIES = 2  # processes that one item may cost
GRACE = 5.0  # seconds for a process to end


def cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Lost:
    """What came of an item whose process died, each time that it was tried."""

    status: int

    def __str__(self) -> str:
        ended = f"exit status {self.status}"
        if self.status < 0:
            ended = f"signal {-self.status} ({signal.strsignal(-self.status) or 'unknown'})"
        return f"the process that worked at it died {TRIES} times, at last of {ended}; it may have run out of memory"


@dataclass
class _Worker(Generic[Item]):
    """A process, this end of its pipe, and the items it was given and has not answered, in order."""

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
    """Each item with what `work` makes of it, as answers come; a task's items go to one process, in order.

    There are `jobs` processes, or one for each core. With `ahead` a process has so many more items in hand as long as
    there is more to do than processes: none stands still while answers are written, and the last are shared out singly.
    `work`, items and answers must be picklable; `modules` are those that every worker needs, imported once where the
    system can fork. What `work` raises is raised here. However this ends, by Ctrl-C as well, the workers end with it.
    """
    queue = deque(list(task) for task in tasks)
    context = _context(modules)
    workers: list[_Worker[Item]] = []
    tried: dict[int, int] = {}  # by identity: an item need not be hashable
    try:
        with _undisturbed():
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
                        with _undisturbed():
                            workers.append(_started(context, work))
                    continue
                if worker.ready and isinstance(told, BaseException):
                    raise told
                answered = [(worker.waiting.popleft(), told)] if worker.ready else []
                worker.ready = True
                while queue and len(worker.waiting) <= (ahead if len(queue) > len(workers) else 0):
                    worker.waiting.extend(queue[0])  # before the answer is looked at
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
    """Has the modules imported for processes to come, where the system can fork, while this process goes on.

    `in_processes` with the same modules then waits only for what is left of that.
    """
    if _context(modules).get_start_method() == "forkserver":
        from multiprocessing.forkserver import ensure_running

        with _undisturbed():
            ensure_running()


def _context(modules: Sequence[str]) -> BaseContext:
    """Processes that inherit nothing of this one: forked from a server that has imported `modules`, or spawned."""
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload([__name__, *modules])
    return context


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Ctrl-C waits until processes have started: a half started one would find nobody and die of a traceback.

    They inherit the mask, so that Ctrl-C goes to the one that asks, from their first instruction on. A mask binds one
    thread, and libraries have threads of their own that the signal may reach: what it then sets off waits as well.
    The tracker of multiprocessing's resources, where its start is left to a later moment, lets the signal through.
    """
    usual = signal.getsignal(signal.SIGINT)
    if not hasattr(signal, "pthread_sigmask") or usual is None or current_thread() is not main_thread():
        yield
        return
    resource_tracker.ensure_running()
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
    """What a worker does: answers until nobody asks. Ctrl-C is for the one that asks.

    Unused cycles of objects are searched for as `rarely` as in the process that asks, and not in what was imported.
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
    """Takes tasks from the pipe as they come: else each end might wait for the other to take what it sends."""
    try:
        while True:
            tasks.put(pipe.recv())
    except (EOFError, OSError):
        tasks.put(None)


def _mourned(
    worker: _Worker[Item], queue: deque[list[Item]], tried: dict[int, int]
) -> Generator[tuple[Item, Answer | Lost], None, None]:
    """The items of a worker that died go back to the queue, but for one that it died of once too often."""
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
