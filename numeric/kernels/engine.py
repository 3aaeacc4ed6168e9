"""Running trajectories: rows are padded to whole blocks, blocks are shared out to threads, or NumPy does it all.

Every lane computes what it would compute alone, so results depend neither on threads nor on blocks.
"""

import itertools
import os
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.scalars import ArrayBackend
from numeric.flights.family import Family
from numeric.kernels import machine
from numeric.kernels.machine import KernelSpec, fields, rescaled

Array = NDArray[np.float64]
PART = 1 << 17  # doubles recorded at a time: a page that stays in the cache
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
    ) -> Result:
        """Bounce every particle `bounces` times. `own` and `tangent` are the starting rows."""
        names = fields(self.family, spec)
        count = own[0].size
        width = -(-count // self.width) * self.width
        start: list[Array | float] = [*own, *([0.0, 0.0] if self.family.stops else []), *tangent]
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
        width = state.shape[1]
        parameters = np.array([*shape, 0.0])
        pointers = [x.ctypes.data if x is not None else None for x in (state, contraction, parameters, page)]
        pieces = _pieces(width // self.width, width * bounces, threads)
        calls = [(*pointers, width, first * self.width, last * self.width, bounces) for first, last in pieces]
        if len(calls) == 1:
            function(*calls[0])
            return
        from concurrent.futures import ThreadPoolExecutor

        with ThreadPoolExecutor(len(calls)) as pool:
            list(pool.map(lambda call: function(*call), calls))


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
