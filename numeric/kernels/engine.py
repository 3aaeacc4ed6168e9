"""Running trajectories: rows are padded to whole blocks, blocks are shared out to threads, or NumPy does it all.

Every lane computes what it would compute alone, so results depend neither on threads nor on blocks.
"""

import itertools
import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.scalars import ArrayBackend
from numeric.flights.family import Family
from numeric.kernels import machine
from numeric.kernels.machine import START, KernelSpec, fields, rescaled

Array = NDArray[np.float64]
PART = 1 << 17  # doubles recorded at a time: a page that stays in the cache
ALONE = 4  # particles that are run in narrow blocks: it takes less long to wait for
WORTH_A_THREAD = 2_000_000  # bounces; below about 10 ms a second thread costs more than it brings


class Result(NamedTuple):
    """Rows of the final state by name, and the recorded rows: bounce, field, particle."""

    rows: dict[str, Array]
    record: Array | None


class Engine(NamedTuple):
    """The runner of one family on one table IR; `kernels` is False where NumPy was asked for."""

    family: Family
    identity: str
    names: Sequence[str]
    kernels: bool = True
    lanes: int = 0  # how many to a block; 0 for what suits the family

    @property
    def width(self) -> int:
        """Lanes to a block."""
        return self.lanes or self.family.width

    def run(
        self,
        spec: KernelSpec,
        own: Sequence[Array],
        lam: Array,
        shape: Sequence[float],
        bounces: int,
        tangent: Sequence[Array] = (),
        threads: int | None = None,
        outcome: Sequence[Array] = (),
    ) -> Result:
        """Bounce every particle `bounces` times. `own` and `tangent` are the starting rows, `outcome` code and lost."""
        names = fields(self.family, spec)
        count = own[0].size
        width = -(-count // self.width) * self.width
        none: list[Array | float] = [0.0, 0.0] if self.family.stops else []
        start: list[Array | float] = [*own, *(outcome or none), *tangent]
        state = np.empty((len(names), width))
        for row, values in zip(state, start, strict=True):
            row[:count] = values
            row[count:] = values[-1] if isinstance(values, np.ndarray) else values
        contraction = np.empty(width)
        contraction[:count], contraction[count:] = lam, lam[-1]
        record = np.empty((bounces, len(own), count)) if spec.record else None
        most = min(bounces, max(1, PART // (len(own) * width))) if spec.record else bounces
        page = np.empty((most, len(own), width)) if spec.record else None
        for done in range(0, bounces, most):
            part = min(most, bounces - done)
            told = page[:part] if page is not None else None
            self._advance(spec, state, contraction, shape, part, told, threads)
            if record is not None and told is not None:
                record[done : done + part] = told[:, :, :count]
        rows = {name: row[:count] for name, row in zip(names, state, strict=True)}
        return Result(rows, record)

    def course(
        self, law: str, told: Sequence[str], start: Sequence[Array], lam: Array, shape: Sequence[float]
    ) -> "Course | None":
        """Particles that start at component, parameter and exit angle, told by kernels; None where there are none."""
        if not self.kernels or type(self.family).framed is Family.framed:
            return None
        width = ALONE if start[0].size <= ALONE else self.width
        found = Course(self, law, tuple(told), width, start, lam, shape)
        return found if found.kernel(starts=True) is not None else None

    def _advance(
        self,
        spec: KernelSpec,
        state: Array,
        contraction: Array,
        shape: Sequence[float],
        bounces: int,
        page: Array | None,
        threads: int | None,
    ) -> None:
        """Bounce all columns of `state` in place."""
        function = None
        if self.kernels:
            function = machine.compiled(self.family, self.identity, self.names, spec, self.width)
        if function is None:
            _run_arrays(self.family, spec, state, contraction, list(shape), bounces, page)
            return
        parameters = np.array([*shape, 0.0])
        pointers = [x.ctypes.data if x is not None else None for x in (state, contraction, parameters, page)]
        shared(function, pointers, state.shape[1], self.width, bounces, threads)


class Course:
    """Particles on their way: `advance` bounces them on and tells each bounce, where their state is at hand."""

    def __init__(
        self,
        engine: Engine,
        law: str,
        told: tuple[str, ...],
        width: int,
        start: Sequence[Array],
        lam: Array,
        shape: Sequence[float],
    ) -> None:
        self.engine, self.law, self.told, self.width, self.count = engine, law, told, width, lam.size
        columns = -(-self.count // width) * width
        self.names = fields(engine.family, KernelSpec(law))
        self.state = np.empty((len(self.names) + len(START), columns))
        self.state[len(engine.family.fields(law)) : -len(START)] = 0.0  # no outcome yet
        self.lam, self.shape = np.empty(columns), np.array([*shape, 0.0])
        for row, values in zip((*self.state[-len(START) :], self.lam), (*start, lam), strict=True):
            row[: self.count], row[self.count :] = values, values[-1]
        self.begun = False

    @property
    def rows(self) -> dict[str, Array]:
        """The rows of the state, by name."""
        return {name: row[: self.count] for name, row in zip(self.names, self.state, strict=False)}

    def kernel(self, starts: bool = False, told: bool = True) -> machine.Run | None:
        """The kernel that starts or goes on, and tells or does not."""
        engine = self.engine
        spec = KernelSpec(self.law, told=self.told if told else (), starts=starts)
        return machine.compiled(engine.family, engine.identity, engine.names, spec, self.width)

    def advance(
        self, bounces: int, out: Mapping[str, Array], top: int, every: int = 1, threads: int | None = 1
    ) -> None:
        """Bounces all particles, and writes what is told of every so many-th bounce into rows from `top` on."""
        columns = self.lam.size
        most = 1 if every > 1 else min(bounces, max(1, PART // (max(1, len(self.told)) * columns)))
        page = np.empty((most, len(self.told), columns))
        for done in range(0, bounces // every, most):
            part = min(most, bounces // every - done)
            if every > 1:
                self._run(every - 1, None, threads)
            self._run(part, page[:part], threads)
            for i, name in enumerate(self.told):
                out[name][top + done : top + done + part] = page[:part, i, : self.count]

    def start(self) -> "Course":
        """Makes the fields of the state, unless they are made."""
        if not self.begun:
            self._call(self.kernel(starts=True, told=False), 0, None, 1)
        return self

    def _run(self, bounces: int, page: Array | None, threads: int | None) -> None:
        """Bounces all particles, and tells each bounce if there is a page for it."""
        told = page is not None and bool(self.told)
        if not told:
            self.start()
        self._call(self.kernel(starts=not self.begun, told=told), bounces, page, threads)

    def _call(self, run: machine.Run | None, bounces: int, page: Array | None, threads: int | None) -> None:
        assert run is not None
        self.begun = True
        pointers = [x.ctypes.data if x is not None else None for x in (self.state, self.lam, self.shape, page)]
        shared(run, pointers, self.lam.size, self.width, bounces, threads)


def shared(
    run: machine.Run, pointers: Sequence[int | None], columns: int, width: int, bounces: int, threads: int | None
) -> None:
    """A kernel on all columns, shared out to threads."""
    pieces = _pieces(columns // width, columns * bounces, threads)
    calls = [(*pointers, columns, first * width, last * width, bounces) for first, last in pieces]
    if len(calls) == 1:
        run(*calls[0])
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(len(calls)) as pool:
        list(pool.map(lambda call: run(*call), calls))


def _pieces(blocks: int, work: int, threads: int | None) -> list[tuple[int, int]]:
    """Consecutive ranges of blocks, one for each thread."""
    wanted = 1 + work // WORTH_A_THREAD if threads is None else threads
    if threads is None and wanted > 1:
        wanted = min(wanted, os.cpu_count() or 1)
    wanted = max(1, min(wanted, blocks))
    cuts = [blocks * i // wanted for i in range(wanted + 1)]
    return list(itertools.pairwise(cuts))


def _run_arrays(
    family: Family,
    spec: KernelSpec,
    state: Array,
    lam: Array,
    shape: list[float],
    bounces: int,
    record: Array | None,
) -> None:
    """The kernel's loop on NumPy arrays: the same step, the same rows."""
    ops = ArrayBackend()
    own = len(family.fields(spec.law))
    extra = own + (2 if family.stops else 0)
    with np.errstate(all="ignore"):
        kept = family.kept(ops, shape, list(state[: len(family.position)])) if spec.exponents else []
        for bounce in range(bounces):
            particle = [row.copy() for row in state[:own]]
            if spec.exponents:
                vector = [row.copy() for row in state[extra:]]
                new, code, more, kept = family.bounce_with_tangent(ops, spec.law, shape, lam, particle, vector, kept)
                if bounce % family.renormalise_every == family.renormalise_every - 1 or bounce == bounces - 1:
                    more = rescaled(ops, more)
            else:
                new, code = family.bounce(ops, spec.law, shape, lam, particle)
                more = []
            going = np.ones(state.shape[1], dtype=bool)
            if family.stops and code is not None:
                going = ~(np.broadcast_to(code, going.shape) > 0.5)
                state[own] = np.where(going, state[own], code)
                state[own + 1] += ~going
            for row, values in zip([*state[:own], *state[extra:]], [*new, *more], strict=True):
                np.copyto(row, values, where=going)
            if record is not None:
                record[bounce] = state[:own]
