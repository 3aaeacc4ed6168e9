"""Orbits recorded bounce by bounce in users' coordinates: by kernels, or translated from recorded states.

For the paper's tables, other ellipses and finite Fourier sums, kernels record the wanted fields themselves: component,
parameter, angles, point and arc length. For other tables, and without kernels, the recorded states are translated. Then
arc length is computed from the parameter, as it always is on a table where its series would have too many terms.
"""

import ctypes
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from numeric.backends.functions import CLOSED
from numeric.flights.family import NEAR, SLAP, Family
from numeric.kernels.engine import ALONE, BatchRun
from numeric.kernels.machine import MATRIX, START, TOLD, KernelSpec
from numeric.lowering.program import LawIR
from numeric.pinball.states import Orbit, counted

if TYPE_CHECKING:
    from numeric.pinball.map import PinballMap

Array = NDArray[np.float64]
HALF_PI = math.pi / 2
SIDE_BY_SIDE = 1 << 12  # particles at a time: their state stays in the processor's second cache
HUGE, LARGE = 1 << 21, 1 << 22  # bytes of a large page of memory; of a field that gets memory of its own
PIECE = 1 << 20  # numbers of a field in a piece of an orbit
FIELDS = (*Orbit._fields, "s")


class OrbitRun:
    """Advances particles piece by piece: `advance` returns the fields `names` of every `every`-th bounce."""

    def __init__(
        self,
        map: "PinballMap",
        theta: ArrayLike,
        phi: ArrayLike,
        component: ArrayLike,
        names: Sequence[str],
        every: int = 1,
        dtype: DTypeLike = np.float64,
        keep: bool = False,
    ) -> None:
        """Prepares the run; `keep` must be set if `advance` is to be called more than once."""
        where, at, angle = map._start(theta, phi, component)
        self.map, self.shape, self.law = map, at.shape, map._law(angle)
        self.where, self.theta, self.phi = where.ravel(), at.ravel(), angle.ravel()
        self.lam, self.names, self.every, self.dtype = (
            map._lams(at),
            _known(names),
            counted("every", every),
            _real(dtype),
        )
        self.length = map.arclength.series if "s" in self.names and map.engine.can_record else None
        needed = {*self.names, *(("component", "theta") if "s" in self.names and self.length is None else ())}
        if len(map.states.ends) == 1:
            needed -= {"component"}
        self.needed = tuple(name for name in (*TOLD, "s") if name in needed and (name != "s" or self.length))
        self.done, self.last = 0, dict[str, NDArray[Any]]()
        self.keep, self.kernels = keep, dict[int, BatchRun | None]()
        self.own: list[Array] = []
        self.code: NDArray[np.int64] = np.zeros(self.lam.size, dtype=np.int64)
        self.bad = np.zeros(self.lam.size, dtype=np.int64)  # the first bounce that a particle did not make

    def advance(self, bounces: int, begin: bool = False, threads: int | None = None) -> dict[str, NDArray[Any]]:
        """The fields of the next bounces, preceded by those of the start if `begin`."""
        rows, top = bounces // self.every + begin, int(begin)
        kinds = {"component": np.dtype(np.int64)}
        out = room((rows, self.lam.size), {name: kinds.get(name, self._kind(name)) for name in self.needed})
        for name, values in out.items() if begin else ():
            values[0] = self._first()[name]
        code, lost = self._advanced(bounces, out, top, threads)
        made = self.done + (1 - top + np.arange(rows)) * self.every  # bounces before each row
        if np.any(code):
            self._stopped(code, lost, bounces, out, made)
        self.done += bounces
        self.last = {name: values[-1].copy() for name, values in out.items()} if rows and self.keep else self.last
        return self._chosen(out, made)

    def saved(self) -> Array:
        """The state from which the orbit can go on, in addition to its start: rows with a number for each particle."""
        if self.kernels:
            known = [kernel.rows for kernel in self.kernels.values() if kernel is not None]
            own = [np.concatenate([rows[name] for rows in known]) for name in known[0]]
        else:
            own = [*self.own, *self.rest]
        first = self._first()
        return np.array([self.where, self.theta, self.phi, self.bad, *own, *(first[name] for name in self.needed)])

    def restore(self, saved: Array, done: int) -> None:
        """Restores a state that was `saved` after `done` bounces."""
        own, told = saved[4 : len(saved) - len(self.needed)], saved[len(saved) - len(self.needed) :]
        self.where, self.theta, self.phi, self.bad, self.done = saved[0].astype(int), saved[1], saved[2], saved[3], done
        self.bad = self.bad.astype(np.int64)
        kinds = {"component": np.int64}
        self.last = {name: row.astype(kinds.get(name, np.float64)) for name, row in zip(self.needed, told, strict=True)}
        count = len(self.map.family.fields(self.law))
        self.own, self.rest = list(own[:count]), list(own[count:])
        self.code = self.rest[0].astype(np.int64) if self.rest else self.code
        for left in range(0, self.lam.size, SIDE_BY_SIDE):
            part = slice(left, left + SIDE_BY_SIDE)
            if (kernel := self._kernel(part, None)) is not None:
                self.kernels[left] = kernel.restore(own[:, part])

    # ---- within

    def _kind(self, name: str) -> np.dtype[Any]:
        return np.dtype(np.float64) if name == "theta" and "s" in self.names and not self.length else self.dtype

    def _first(self) -> dict[str, NDArray[Any]]:
        """The fields of the start, or the last ones recorded; `eta` is nan at a start, since nothing has landed."""
        if self.last:
            return self.last
        known: dict[str, NDArray[Any]] = {"component": self.where, "theta": self.theta, "phi": self.phi}
        if {"x", "y"} & {*self.needed}:
            known["x"], known["y"] = self.map.states.point(self.where, self.theta)
        if "s" in self.needed:
            known["s"] = self.map.arclength.s(self.theta, self.where)
        self.last = known | {"eta": np.full(self.lam.size, np.nan)}
        return self.last

    def _advanced(
        self, bounces: int, out: dict[str, NDArray[Any]], top: int, threads: int | None
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Advances all particles, some thousand at a time, so that they stay in the cache.

        Returns the codes of the outcomes, and the number of bounces that each particle missed.
        """
        if bounces == 1 and not (self.keep or self.done):
            given, rows = (self.where, self.theta, self.phi), {name: values[top] for name, values in out.items()}
            length = self.length or (CLOSED, ())
            code = self.map.engine.once(self.law, given, self.lam, self.map.shape, rows, length, threads)
            self.map.unit.restore(rows)
            if code is not None:
                return code, np.asarray(code != 0)
        ends: tuple[NDArray[Any], NDArray[Any]] = np.zeros(self.lam.size), np.zeros(self.lam.size)
        kernel = None
        for left in range(0, self.lam.size, SIDE_BY_SIDE):
            part = slice(left, left + SIDE_BY_SIDE)
            kernel = self.kernels[left] if left in self.kernels else self._kernel(part, kernel)
            if kernel is None:
                rows = self._translated(bounces, out, top, threads)
                return (rows["code"], rows["lost"]) if "code" in rows else ends
            if self.keep:
                self.kernels[left] = kernel
            kernel.advance(bounces, {name: values[:, part] for name, values in out.items()}, top, self.every, threads)
            self.map.unit.restore({name: values[top:, part] for name, values in out.items()})
            rows = kernel.rows
            if "code" in rows:
                ends[0][part], ends[1][part] = rows["code"], rows["lost"]
        return ends

    def _kernel(self, part: slice, other: BatchRun | None) -> BatchRun | None:
        """A batch with the particles of `part`; it may reuse `other`, a batch whose particles are finished."""
        if other is None or self.keep:
            count = min(self.lam.size - part.start, SIDE_BY_SIDE)
            length = self.length or (CLOSED, ())
            other = self.map.engine.batch(self.law, self.needed, count, self.map.shape, length)
        return other and other.begin((self.where[part], self.theta[part], self.phi[part]), self.lam[part])

    def _stopped(
        self,
        code: NDArray[Any],
        lost: NDArray[Any],
        bounces: int,
        out: dict[str, NDArray[Any]],
        made: NDArray[np.int64],
    ) -> None:
        """Gives each particle that stopped the fields of its last regular bounce, and nan for the incidence angle."""
        self.code = code.astype(np.int64)
        missed = np.flatnonzero(self.code)
        self.bad[missed] = self.done + bounces + 1 - lost[missed].astype(np.int64)
        first = self._first()
        for particle in missed:
            row = int(np.searchsorted(made, self.bad[particle]))
            for name, values in out.items():
                kept = values[row - 1, particle] if row else first[name][particle]
                values[row:, particle] = np.nan if name == "eta" else kept

    def _translated(
        self, bounces: int, out: dict[str, NDArray[Any]], top: int, threads: int | None
    ) -> dict[str, Array]:
        """Records the states of the next bounces, and translates them into the rows of `out`."""
        map, states = self.map, self.map.states
        frame = states.frame(self.where, self.theta)
        if not self.own:
            self.own = states.enter(self.where, self.theta, self.phi, self.law, frame)
            self.rest = [np.zeros(self.lam.size)] * (2 * map.family.stops)
        engine, spec = map.engine, KernelSpec(self.law, record=True)
        result = engine.run(spec, self.own, self.lam, map.shape, bounces, threads=threads, outcome=self.rest)
        assert result.record is not None
        told = states.told(result.record, (self.where, self.theta, self.phi), frame, self.own, self.lam, self.law)
        for name, values in zip(TOLD, told, strict=True):
            if name in out:
                out[name][top:] = values[self.every :: self.every]
        self.own = [result.rows[name] for name in map.family.fields(self.law)]
        self.rest = [result.rows[name] for name in ("code", "lost") if name in result.rows]
        self.where, self.theta, self.phi = (values[-1] for values in told[:3])
        return result.rows

    def _chosen(self, out: dict[str, NDArray[Any]], made: NDArray[np.int64]) -> dict[str, NDArray[Any]]:
        """The fields `names` of the run, in this order; `out` has the recorded ones, `made` the bounce of each row."""
        shape = len(made), self.lam.size
        if "component" not in out and {"component", "s"} & {*self.names}:
            out["component"] = np.zeros(shape, dtype=np.int64)
        if "code" in self.names:
            out["code"] = np.zeros(shape, dtype=np.int64)
            for particle in np.flatnonzero(self.code):
                out["code"][np.searchsorted(made, self.bad[particle]) :, particle] = self.code[particle]
        if "s" in self.names and "s" not in out:
            out["s"] = self.map.arclength.s(out["theta"], out["component"]).astype(self.dtype, copy=False)
        return {n: out[n] if n in ("component", "code") else out[n].astype(self.dtype, copy=False) for n in self.names}


def room(shape: tuple[int, int], kinds: Mapping[str, np.dtype[Any]]) -> dict[str, NDArray[Any]]:
    """Empty arrays by name, in pages of two megabytes: clearing many small pages would take longer than filling them.

    A large field has memory of its own, so that it may be kept without the others; small ones share theirs.
    """
    sizes = {name: shape[0] * shape[1] * kind.itemsize for name, kind in kinds.items()}
    shared = max(sizes.values(), default=0) < LARGE
    blocks = [list(kinds)] if shared else [[name] for name in kinds]
    found: dict[str, NDArray[Any]] = {}
    for names in blocks:
        total = sum(sizes[name] for name in names)
        if total < HUGE:
            found |= {name: np.empty(shape, kinds[name]) for name in names}
            continue
        memory = np.empty((total // HUGE + 2) * HUGE, np.uint8)  # NumPy asks for huge pages, which begin at multiples
        at = -memory.ctypes.data % HUGE
        for name in names:
            found[name] = memory[at : at + sizes[name]].view(kinds[name]).reshape(shape)
            at += sizes[name]
    return found


def _known(names: Sequence[str]) -> tuple[str, ...]:
    """Names of fields as a tuple; `ValueError` for an unknown one."""
    names = (names,) if isinstance(names, str) else tuple(names)
    for name in names:
        if name not in FIELDS:
            raise ValueError(f"no field is called {name!r}; an orbit has: {', '.join(FIELDS)}")
    return names


def _real(dtype: DTypeLike) -> np.dtype[Any]:
    """`dtype`, which must be float64 or float32; otherwise `ValueError`."""
    if (found := np.dtype(dtype)) not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ValueError(f"dtype = {found} is not possible; give float64 or float32")
    return found


def derivatives(map: "PinballMap", law: str, start: tuple[NDArray[np.int64], Array, Array], lam: Array) -> Array | None:
    """The derivative of one bounce of each particle, by kernels; None if there is no kernel, or if a particle stops."""
    found = room((4, lam.size), {"": np.dtype(float)})[""].reshape(2, 2, -1)
    out = dict(zip(MATRIX, found.reshape(4, -1), strict=True))
    code = map.engine.once(law, start, lam, map.shape, out)
    return None if code is None or code.any() else np.moveaxis(found, 2, 0)


REALS, WHOLES = frozenset({float, int, np.float64}), frozenset({int, np.int64})


class SingleBounce:
    """One bounce of one particle in some microseconds: everything that does not depend on the particle is prepared.

    `told` returns None where the general method is needed: if a particle stops, if the input is bad, or if an angle
    exceeds a whole turn. Buffers are taken from a list and put back, so that concurrent and nested calls use different
    ones.
    """

    def __init__(self, map: "PinballMap", law: str, names: tuple[str, ...]) -> None:
        self.lam, self.reflection, self.law, self.names = map.lam, map.reflection, law, names
        self.ends, self.cusped = map.states.ends, map.family.cusped
        low, high = self.ends[0]
        batch = map.engine.batch(law, names, 1, map.shape) if map.lam.size == 1 else None
        if batch is not None:
            batch.begin((0.0, 0.4 * low + 0.6 * high, 0.1 * (law != SLAP)), np.array([float(map.lam.flat[0])]))
        self.batch, self.run = batch, batch.kernel(starts=True) if batch is not None else None
        self.free: list[Any] = []

    def serves(self, map: "PinballMap") -> bool:
        """Was this bounce prepared for the map as it is now?"""
        return self.lam is map.lam and self.reflection is map.reflection

    def told(self, theta: Any, phi: Any, component: Any) -> list[float] | None:
        """The values that the kernel records of the bounce, in the order of the names; None for the general method."""
        if not (self.run is not None and type(theta) in REALS and type(phi) in REALS and type(component) in WHOLES):
            return None
        if not (-HALF_PI < phi < HALF_PI and 0 <= component < len(self.ends)):
            return None
        low, high = self.ends[component]
        if not low <= theta <= high or (self.cusped and math.cos(theta / 2) < NEAR) or (self.law == SLAP and phi != 0):
            return None
        free = self.free
        buffer = free.pop() if free else self._buffer()
        arguments, state, record, _, first, code = buffer
        state[first], state[first + ALONE], state[first + 2 * ALONE] = component, theta, phi
        self.run(*arguments)
        if code and state[code] != 0:
            return None  # and the buffer is thrown away
        found: list[float] = record[::ALONE]
        free.append(buffer)
        return found

    def _buffer(self) -> tuple[tuple[int, ...], Any, Any, Any, int, int]:
        """A new buffer: the kernel's arguments, state, record and table, and the offsets of start and outcome."""
        assert self.batch is not None
        rows, code = self.batch.state.shape[0], "code" in self.batch.names
        state = (ctypes.c_double * (rows * ALONE))(*self.batch.state.ravel())
        record = (ctypes.c_double * (len(self.names) * ALONE))()
        first, row = ctypes.addressof(record), ALONE * ctypes.sizeof(ctypes.c_double)
        table = (ctypes.c_int64 * (len(self.names) + 1))(*(first + i * row for i in range(len(self.names))), ALONE)
        kept = self.batch.lam.ctypes.data, self.batch.shape.ctypes.data
        arguments = ctypes.addressof(state), *kept, ctypes.addressof(table), ALONE, 0, ALONE, 1
        place = self.batch.names.index("code") * ALONE if code else 0
        return arguments, state, record, table, (rows - len(START)) * ALONE, place


def lowered_law(map: "PinballMap") -> LawIR:
    """The programs of a map's law, with the series of the arc length if the law depends on it."""
    from numeric.lowering.lower import lower_law

    law = lower_law(map.reflection, lambda: map.table)
    if not law.measured or law.lengths:
        return law
    series = map.arclength.series
    if series is None or type(map.family).along is Family.along:
        raise ValueError(f"law = {law.text}: no kernel knows the arc length s of {map.ir.table}; write it in theta")
    return law._replace(series=(series[0], tuple(series[1])))
