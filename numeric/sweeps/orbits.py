"""Orbits that do not fit in memory, written piece by piece into a Zarr store, and resumed where they were stopped.

The store is that of a sweep over bounces and particles whose parts depend on each other: beside the fields it holds a
checkpoint, the state of the particles after the pieces that are done, so an orbit that was stopped goes on to the
same bits. Memory is that of one piece; `memory` says how much before anything runs.
"""

from collections.abc import Callable, Sequence
from functools import partial
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from numeric.kernels.engine import PART
from numeric.kernels.machine import TOLD
from numeric.pinball.map import PinballMap
from numeric.pinball.orbits import HUGE, LARGE, PIECE, Course
from numeric.pinball.states import MEANINGS, STATUSES, UNITS, counted
from numeric.sweeps.store import Stored, opened
from numeric.sweeps.sweep import Axis, Field, Part, Sweep

if TYPE_CHECKING:
    import xarray as xr

CHECKPOINT = "checkpoint"
LABELS = ("component", "code")


def record(
    map: PinballMap,
    path: Path | str,
    theta: ArrayLike,
    phi: ArrayLike,
    bounces: int,
    component: ArrayLike = 0,
    threads: int | None = None,
    *,
    fields: Sequence[str] = ("theta", "phi"),
    every: int = 1,
    dtype: DTypeLike = np.float64,
    piece: int = PIECE,
    tick: Callable[[int, int], None] | None = None,
) -> "xr.Dataset":
    """Writes an orbit, `piece` numbers of a field at a time, into the store at `path`; the same call goes on with it.

    The result is read from the store when it is looked at: `bounce` counts from the start, `particle` in the order
    of the arguments. `tick(done, pieces)` is called after each piece.

    >>> import tempfile
    >>> egg = PinballMap("egg", lam=0.5, alpha=0.08)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = record(egg, Path(folder) / "orbit.zarr", [0.3, 0.4], 0.2, 100, fields=("theta", "s"), piece=50)
    ...     dict(found.sizes)
    {'bounce': 101, 'particle': 2}
    """
    course = Course(map, theta, phi, component, fields, every, dtype, keep=True)
    sweep = _sweep(course, counted("bounces", bounces), counted("piece", piece))
    with opened(sweep, Path(path)) as store:
        indices, missing = sweep.indices(), store.missing()
        done = _resumed(store, course, len(indices) - len(missing)) if missing else len(indices)
        for number in range(done, len(indices)):
            rows = sweep.within("bounce", number)
            told = course.advance((rows.stop - max(rows.start, 1)) * course.every, begin=number == 0, threads=threads)
            store.write(indices[number], told)
            _checkpoint(store, course, number + 1)
            del told  # before the next piece is there
            if tick is not None:
                tick(number + 1, len(indices))
        if missing:
            del store.group[CHECKPOINT]
        return store.dataset()


def memory(map: PinballMap, particles: int, fields: Sequence[str] = ("theta", "phi"), piece: int = PIECE) -> int:
    """Bytes that `record` takes at a time, at most: a piece of each field, two on their way to the disk, and states.

    Where no kernel tells the orbit, there are a piece of each row of the state, and of all that it is translated to.

    >>> memory(PinballMap("egg", lam=0.5, alpha=0.08), particles=1000) // 10**6
    44
    """
    rows = max(2, piece // particles)
    told = 0 if map.engine.tells else len(map.family.fields(map.law)) + len(TOLD)
    margins = 2 * HUGE * (len(fields) if 8 * rows * particles >= LARGE else 1)  # of fields that begin at large pages
    return 8 * (particles * (rows * (len(fields) + 2 + told) + ROWS) + PART) + margins + OTHERS


OTHERS = 1 << 20  # bytes that Zarr and Python take
ROWS = 64  # numbers for each particle besides: starts, states, outcomes and what was told last, with their copies


COLUMNS = ("component", "theta", "s", "x", "y", "eta", "phi", "code")


def written(map: PinballMap, start: tuple[float, float, int], bounces: int, path: Path) -> str:
    """Writes an orbit of one particle, a row for each bounce, in the format of the name; the status of the last one."""
    theta, phi, component = start
    if path.suffix == ".zarr":
        code = record(map, path, theta, phi, bounces, component, fields=COLUMNS).code.values[-1, 0]
    elif path.suffix in (".npz", ".parquet"):
        if not path.parent.is_dir():
            raise ValueError(f"--out {path}: there is no directory {str(path.parent)!r}; create it first")
        arrow: Any = import_module("pyarrow") if path.suffix == ".parquet" else None
        columns: dict[str, Any] = map.orbit(theta, phi, bounces, component, fields=COLUMNS)
        try:
            if path.suffix == ".npz":
                np.savez(path, **columns)
            else:
                import_module("pyarrow.parquet").write_table(arrow.table(columns), path)
        except OSError as error:
            raise ValueError(f"--out {path} cannot be written ({error.strerror or error})") from None
        code = columns["code"][-1]
    else:
        raise ValueError(f"--out {path}: accepted: a name that ends in .npz, .parquet or .zarr")
    return str(STATUSES[code].name.lower())


def _sweep(course: Course, bounces: int, piece: int) -> Sweep:
    """The grid of bounces and particles, cut into pieces of bounces."""
    size, rows = course.theta.size, bounces // course.every + 1
    kind = np.dtype(course.dtype).name
    digest = sha256()
    for given in (course.where, course.theta, course.phi, course.lam):
        digest.update(np.ascontiguousarray(given, dtype=np.float64).tobytes())
    map = course.map
    settings = {
        "table": map.engine.identity,
        "shape": [str(value) for value in map.exact_shape],
        "law": str(map.reflection),
        "starts": digest.hexdigest(),
        "bounces": bounces,
        "every": course.every,
    }
    return Sweep(
        name="orbit",
        about=f"Orbits of {size} particles in the {map.ir.table}",
        axes=(
            Axis("bounce", np.arange(rows) * course.every, "1", "bounces since the start", max(2, piece // size)),
            Axis("particle", np.arange(size), "1", "number of the particle"),
        ),
        fields=tuple(
            Field(
                name,
                ("bounce", "particle"),
                "int64" if name in LABELS else kind,
                UNITS.get(name, ""),
                MEANINGS.get(name, name),
            )
            for name in course.names
        ),
        task=_in_order,
        seed=0,
        scene=map.ir.table,
        settings=settings,
        collisions=bounces * size,
        map=partial(map.at, map.lam),
    )


def _in_order(part: Part) -> dict[str, Any]:
    raise NotImplementedError(f"the piece at {part.at} follows from the one before; record makes them in order")


def _checkpoint(store: Stored, course: Course, done: int) -> None:
    """Keeps the state in a file that appears at once, after the pieces that it stands for."""
    saved = course.saved()
    if CHECKPOINT not in store.group:
        shape = saved.shape[0] + 1, saved.shape[1]
        store.group.create_array(CHECKPOINT, shape=shape, chunks=shape, dtype="float64", fill_value=0.0)
    store.group[CHECKPOINT][:] = np.concatenate([np.full((1, saved.shape[1]), float(done)), saved])


def _resumed(store: Stored, course: Course, there: int) -> int:
    """The pieces that need not be made again; the course goes on after them."""
    if there == 0 or CHECKPOINT not in store.group:
        return 0
    rows = np.asarray(store.group[CHECKPOINT][:])
    done = int(rows[0, 0])
    if not 0 < done <= there:  # a piece before it was damaged
        return 0
    course.restore(rows[1:], int(store.sweep.within("bounce", done - 1).stop - 1) * course.every)
    return done
