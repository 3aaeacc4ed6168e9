"""Runs many trajectories: by kernels on whole blocks of lanes, divided among threads; or else by NumPy.

Every lane computes independently of the others, so results depend neither on threads nor on blocks.
"""

import itertools
import os
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.functions import CLOSED, Series
from numeric.backends.scalars import ArrayBackend
from numeric.flights.family import Family
from numeric.kernels import machine
from numeric.kernels.machine import LINE, START, KernelSpec, fields, rescaled

Array = NDArray[np.float64]
PART = 1 << 16  # doubles recorded at a time: a page that stays in the cache
STRETCH = 1 << 17  # bounces recorded at a time in the caller's arrays: rows written together lie near each other
STREAM = 1 << 23  # records of so many bytes, more than a processor's cache holds, bypass the cache, which is faster
ALONE = 4  # up to so many particles run in narrow blocks, which end sooner
WORTH_A_THREAD = 2_000_000  # bounces; below about 10 ms a second thread costs more than it brings


class EngineResult(NamedTuple):
    """Rows of the final state by name, and the recorded rows: an array with axes bounce, field, particle."""

    rows: dict[str, Array]
    record: Array | None


class Engine(NamedTuple):
    """Runs flights of one family on one table, by compiled kernels or, if `kernels` is False, on NumPy arrays."""

    family: Family
    identity: str
    names: Sequence[str]
    kernels: bool = True
    lanes: int = 0  # in a block; 0 for what suits the family

    @property
    def width(self) -> int:
        """The number of lanes in a block."""
        width = self.family.width
        return self.lanes or (width if not self.kernels or machine.wide() else min(width, self.family.narrow))

    @property
    def can_record(self) -> bool:
        """Are kernels used, and can those of the family record orbits?"""
        return self.kernels and self.family.can_record

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
    ) -> EngineResult:
        """Advances every particle by `bounces` bounces, from the rows `own`, `tangent` and `outcome` (code, lost)."""
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
        return EngineResult(rows, record)

    def batch(
        self,
        law: str,
        told: Sequence[str],
        count: int,
        shape: Sequence[float],
        length: tuple[Series, Sequence[float]] = (CLOSED, ()),
    ) -> "BatchRun | None":
        """A batch for up to `count` particles that records the fields `told`; None if no kernel can do it."""
        if not self.can_record:
            return None
        found = BatchRun(self, law, tuple(told), count, shape, length)
        return found if found.kernel(starts=True) is not None else None

    def once(
        self,
        law: str,
        start: Sequence[NDArray[Any]],
        lam: Array,
        shape: Sequence[float],
        out: Mapping[str, NDArray[Any]],
        length: tuple[Series, Sequence[float]] = (CLOSED, ()),
        threads: int | None = None,
    ) -> Array | None:
        """One bounce from the arrays `start` into the arrays `out`; returns the codes of the outcomes.

        The result is None if no kernel can do it.
        """
        if not self.can_record:
            return None
        spec = KernelSpec(law, told=tuple(out), once=True, length=length[0])
        width = ALONE if lam.size <= ALONE else self.width
        run = machine.compiled(self.family, self.identity, self.names, spec, width)
        if run is None:
            return None
        numbers, code = np.array([*shape, *length[1], 0.0]), np.zeros(lam.size)
        given = [np.ascontiguousarray(x, dtype=np.float64) for x in (*start, lam)]
        wanted = [row if row.dtype == np.float64 else np.empty(row.size) for row in out.values()]

        def call(lam: Array, particles: Sequence[Array], goals: Sequence[Array]) -> None:
            tables = [np.array([*(row.ctypes.data for row in rows), 0]) for rows in (particles, goals)]
            columns = lam.size // width * width
            pointers = [x.ctypes.data for x in (tables[0], lam, numbers, tables[1])]
            shared(run, pointers, columns, (0, columns), width, 1, threads)

        call(given[3], [*given[:3], code], wanted)  # the whole blocks of lanes
        if rest := lam.size % width:
            last = [np.full(width, x[-1]) for x in (*given, code, *wanted)]
            for row, values in zip(last, given, strict=False):
                row[:rest] = values[-rest:]
            call(last[3], [*last[:3], last[4]], last[5:])
            for row, values in zip((code, *wanted), last[4:], strict=True):
                row[-rest:] = values[:rest]
        for row, values in zip(out.values(), wanted, strict=True):
            if row is not values:
                row[:] = values
        return code

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
        """Advances all columns of `state` by `bounces` bounces, in place."""
        function = None
        if self.kernels:
            function = machine.compiled(self.family, self.identity, self.names, spec, self.width)
        if function is None:
            _run_arrays(self.family, spec, state, contraction, list(shape), bounces, page)
            return
        parameters = np.array([*shape, 0.0])
        pointers = [x.ctypes.data if x is not None else None for x in (state, contraction, parameters, page)]
        shared(function, pointers, state.shape[1], (0, state.shape[1]), self.width, bounces, threads)


class BatchRun:
    """A batch of particles: `begin` sets where they start, `advance` advances them and records each bounce.

    Whole blocks of lanes write records straight into the caller's arrays, a few bounces of all of them at a time,
    because a block's records of successive bounces lie far apart. For incomplete blocks, and for arrays that are not
    float64, a page of memory that stays in the cache is filled first and then copied.
    """

    def __init__(
        self,
        engine: Engine,
        law: str,
        told: tuple[str, ...],
        count: int,
        shape: Sequence[float],
        length: tuple[Series, Sequence[float]],
    ) -> None:
        self.engine, self.law, self.told, self.how = engine, law, told, length[0]
        self.width = ALONE if count <= ALONE else engine.width
        self.names, self.own = fields(engine.family, KernelSpec(law)), len(engine.family.fields(law))
        columns = -(-count // self.width) * self.width
        self.state, self.lam = np.zeros((len(self.names) + len(START), columns)), np.empty(columns)
        self.shape = np.array([*shape, *length[1], 0.0])
        self.pointers = [x.ctypes.data for x in (self.state, self.lam, self.shape)]
        self.page, self.begun = np.empty(0), False

    def begin(self, start: Sequence[NDArray[Any] | float], lam: Array) -> "BatchRun":
        """Sets the starts, at most as many as the batch has room for, by component, parameter and exit angle.

        Returns the batch.
        """
        self.count, self.begun = lam.size, False
        self.columns = -(-self.count // self.width) * self.width
        for row, values in zip((*self.state[-len(START) :], self.lam), (*start, lam), strict=True):
            row[: self.count] = values
            row[self.count : self.columns] = row[self.count - 1]
        self.state[self.own : -len(START)] = 0.0  # no outcome yet
        return self

    def restore(self, rows: Array) -> "BatchRun":
        """Sets the state to `rows`, as saved before, so that the run can go on from it; returns the batch."""
        self.state[: len(rows), : self.count] = rows
        self.state[: len(rows), self.count :] = rows[:, -1:]
        self.begun = True
        return self

    @property
    def rows(self) -> dict[str, Array]:
        """The rows of the state, by name."""
        return {name: row[: self.count] for name, row in zip(self.names, self.state, strict=False)}

    def kernel(self, starts: bool = False, told: bool = True, streams: bool = False) -> machine.Run | None:
        """The compiled kernel, which with `starts` begins from the starts, and with `told` records.

        With `streams` its records bypass the caches.
        """
        engine = self.engine
        told_of = self.told if told else ()
        spec = KernelSpec(self.law, told=told_of, starts=starts, length=self.how, streams=streams)
        return machine.compiled(engine.family, engine.identity, engine.names, spec, self.width)

    def advance(
        self, bounces: int, out: Mapping[str, Array], top: int, every: int = 1, threads: int | None = 1
    ) -> None:
        """Advances all particles, and stores every `every`-th bounce in the rows of `out`, from row `top` on."""
        rows = [out[name][top : top + bounces // every] for name in self.told]
        if not rows:
            self.start()._call(self.kernel(told=False), bounces // every * every, None, threads)
        elif every == 1:
            self._tell(rows, threads)
        else:
            for i in range(bounces // every):
                self.start()._call(self.kernel(told=False), every - 1, None, threads)
                self._tell([row[i : i + 1] for row in rows], threads)

    def start(self) -> "BatchRun":
        """Computes the state from the starts if that is not yet done; returns the batch."""
        if not self.begun:
            self._call(self.kernel(starts=True, told=False), 0, None, 1)
            self.begun = True
        return self

    def _tell(self, rows: list[Array], threads: int | None) -> None:
        """Makes one bounce for each row of the arrays `rows`, and stores the recorded fields there."""
        starts, self.begun = not self.begun, True
        step = rows[0].strides[0]
        alike = all(row.dtype == np.float64 and row.strides == (step, row.itemsize) for row in rows)
        whole = self.count // self.width * self.width if alike else 0
        if whole:
            self._where_wanted(starts, rows, whole, threads)
        if whole < self.count:
            self._through_a_page(starts, rows, whole, threads)

    def _where_wanted(self, starts: bool, rows: list[Array], whole: int, threads: int | None) -> None:
        """The part of `_tell` for whole blocks, which write straight into `rows`, a few bounces at a time."""
        bounces, apart = rows[0].shape[0], rows[0].strides[0]
        begin = np.array([*(row.ctypes.data for row in rows), 0])
        streams = sum(row.nbytes for row in rows) >= STREAM and not np.any(np.append(begin, apart) % LINE)
        most, done = max(1, STRETCH // whole), 0
        while done < bounces:
            first = starts and not done
            part = 1 if first and streams else min(most, bounces - done)
            table = begin + done * apart
            table[-1] = apart // rows[0].itemsize
            self._call(self.kernel(first, streams=streams and not first), part, table, threads, (0, whole))
            done += part

    def _through_a_page(self, starts: bool, rows: list[Array], left: int, threads: int | None) -> None:
        """The part of `_tell` for the particles from number `left` on, recorded in a page of memory and then copied."""
        columns, bounces = self.columns - left, len(rows[0])
        most = min(bounces, max(1, PART // (len(rows) * columns)))
        need = most * len(rows) * columns
        self.page = np.empty(need) if self.page.size < need else self.page
        page = self.page[:need].reshape(most, len(rows), columns)
        begin = page.ctypes.data - left * page.itemsize  # a kernel counts columns from the first particle
        table = np.array([*(begin + i * page.strides[1] for i in range(len(rows))), len(rows) * columns])
        first, on = self.kernel(starts), self.kernel() if bounces > most else None
        pairs = [(row[:, left:], page[:, i, : self.count - left]) for i, row in enumerate(rows)]
        for done in range(0, bounces, most):
            part = min(most, bounces - done)
            self._call(on if done else first, part, table, threads, (left, self.columns))
            for row, own in pairs:
                row[done : done + part] = own[:part]

    def _call(
        self,
        run: machine.Run | None,
        bounces: int,
        table: NDArray[np.int64] | None,
        threads: int | None,
        columns: tuple[int, int] | None = None,
    ) -> None:
        assert run is not None
        pointers = *self.pointers, None if table is None else table.ctypes.data
        shared(run, pointers, self.lam.size, columns or (0, self.columns), self.width, bounces, threads)


def shared(
    run: machine.Run,
    pointers: Sequence[int | None],
    row: int,
    columns: tuple[int, int],
    width: int,
    bounces: int,
    threads: int | None,
) -> None:
    """Runs a kernel on some columns of the arrays at `pointers`, divided among threads; `row` is the length of rows."""
    first, last = columns
    pieces = _pieces((last - first) // width, (last - first) * bounces, threads)
    calls = [(*pointers, row, first + one * width, first + other * width, bounces) for one, other in pieces]
    if len(calls) == 1:
        run(*calls[0])
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(len(calls)) as pool:
        list(pool.map(lambda call: run(*call), calls))


def _pieces(blocks: int, work: int, threads: int | None) -> list[tuple[int, int]]:
    """The blocks divided into consecutive ranges, one for each thread."""
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
    """The kernel's loop on NumPy arrays: with the same steps and the same rows."""
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
