"""Orbits that do not fit in memory: written piece by piece into a Zarr store, and resumed after an interruption.

The store is that of a sweep over bounces and particles whose parts depend on each other. Besides the fields it holds a
checkpoint, the state of the particles after the finished pieces. So an interrupted orbit continues with the same bits
as an uninterrupted one. Only one piece is in memory at a time; `memory` returns its size before anything runs.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from numeric.kernels.engine import PART
from numeric.kernels.machine import TOLD
from numeric.lowering.files import replacing
from numeric.pinball.map import PinballMap
from numeric.pinball.orbits import HUGE, LARGE, PIECE, OrbitRun
from numeric.pinball.states import MEANINGS, UNITS, counted
from numeric.sweeps.store import Stored, kept, opened
from numeric.sweeps.sweep import Axis, Field, Sweep, SweepPart
from numeric.sweeps.workers import undisturbed

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
    """Writes an orbit to the store at `path`, in pieces with `piece` numbers for each field; a second call continues
    it.

    The result is read from the store on demand: `bounce` counts from the start, and `particle` is in the order of the
    arguments. `tick(done, pieces)` is called after each piece.

    >>> import tempfile
    >>> egg = PinballMap("egg", lam=0.5, alpha=0.08)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = record(egg, Path(folder) / "orbit.zarr", [0.3, 0.4], 0.2, 100, fields=("theta", "s"), piece=50)
    ...     dict(found.sizes)
    {'bounce': 101, 'particle': 2}
    """
    run = OrbitRun(map, theta, phi, component, fields, every, dtype, keep=True)
    sweep = _sweep(run, counted("bounces", bounces), counted("piece", piece))
    with opened(sweep, Path(path)) as store:
        indices, missing = sweep.indices(), store.missing()
        done = _resumed(store, run, len(indices) - len(missing)) if missing else len(indices)
        try:
            for number in range(done, len(indices)):
                rows = sweep.within("bounce", number)
                length = (rows.stop - max(rows.start, 1)) * run.every
                told = run.advance(length, begin=number == 0, threads=threads)
                store.write(indices[number], told)
                _checkpoint(store, run, number + 1)
                del told  # before the next piece is there
                done = number + 1
                if tick is not None:
                    tick(done, len(indices))
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; {kept(Path(path), done, len(indices))}") from None
        if missing:
            del store.group[CHECKPOINT]
        return store.dataset()


def memory(map: PinballMap, particles: int, fields: Sequence[str] = ("theta", "phi"), piece: int = PIECE) -> int:
    """An upper bound of the bytes that `record` needs at a time.

    These are one piece of each field, two pieces that are being written, and the state. If no kernel records the orbit,
    a piece of each row of the state and of each converted field is added.

    >>> memory(PinballMap("egg", lam=0.5, alpha=0.08), particles=1000) // 10**6
    44
    """
    rows = max(2, piece // particles)
    told = 0 if map.engine.can_record else len(map.family.fields(map.law)) + len(TOLD)
    margins = 2 * HUGE * (len(fields) if 8 * rows * particles >= LARGE else 1)  # of fields that begin at large pages
    return 8 * (particles * (rows * (len(fields) + 2 + told) + ROWS) + PART) + margins + OTHERS


OTHERS = 1 << 20  # bytes that Zarr and Python take
ROWS = 64  # further numbers for each particle: starts, states, outcomes and the last record, with their copies


LINES = 10_000  # lines of a CSV file that are formatted at a time
COLUMNS = ("component", "theta", "s", "x", "y", "eta", "phi", "code")


def table_written(columns: Mapping[str, NDArray[Any]], path: Path) -> None:
    """Writes columns of equal length as a table, in the format of the file name: .csv, .npz or .parquet."""
    if path.suffix not in (".csv", ".npz", ".parquet"):
        raise ValueError(f"--out {path}: accepted: a name that ends in .csv, .npz, .parquet or .zarr")
    if not path.parent.is_dir():
        raise ValueError(f"--out {path}: there is no directory {str(path.parent)!r}; create it first")
    arrow: Any = import_module("pyarrow") if path.suffix == ".parquet" else None
    named: dict[str, Any] = dict(columns)
    try:
        with replacing(path) as file:
            if path.suffix == ".npz":
                np.savez(file, **named)
            elif path.suffix == ".parquet":
                import_module("pyarrow.parquet").write_table(arrow.table(named), file)
            else:
                file.write((",".join(named) + "\n").encode())
                for begin in range(0, len(next(iter(named.values()))), LINES):
                    part = zip(*(values[begin : begin + LINES].tolist() for values in named.values()), strict=True)
                    file.write("".join(",".join(map(repr, row)) + "\n" for row in part).encode())
    except OSError as error:
        raise ValueError(f"--out {path} cannot be written ({error.strerror or error})") from None


def _sweep(run: OrbitRun, bounces: int, piece: int) -> Sweep:
    """The grid of bounces and particles, cut into pieces of bounces."""
    size, rows = run.theta.size, bounces // run.every + 1
    kind = np.dtype(run.dtype).name
    starts = {"component": run.where, "theta": run.theta, "phi": run.phi, "lam": run.lam}
    map = run.map
    settings = {
        "table": map.engine.identity,
        "shape": [str(value) for value in map.exact_shape],
        "law": str(map.reflection),
        **{name: _label(np.asarray(given, dtype=np.float64)) for name, given in starts.items()},
        "bounces": bounces,
        "every": run.every,
        "fields": list(run.names),
    }
    return Sweep(
        name="orbit",
        about=f"Orbits of {size} particles in the {map.ir.table}",
        axes=(
            Axis("bounce", np.arange(rows) * run.every, "1", "bounces since the start", max(2, piece // size)),
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
            for name in run.names
        ),
        task=_in_order,
        seed=0,
        scene=map.ir.table,
        settings=settings,
        collisions=bounces * size,
        map=partial(map.at, map.lam),
    )


def _label(given: NDArray[np.float64]) -> float | str:
    """The number, if all particles have the same one; else a text with a digest of the numbers."""
    shared = given.size > 0 and bool(np.all(given == given.flat[0]))
    return float(given.flat[0]) if shared else f"numbers with digest {sha256(given.tobytes()).hexdigest()[:16]}"


def _in_order(part: SweepPart) -> dict[str, Any]:
    raise NotImplementedError(f"the piece at {part.at} needs the one before it; record computes them in order")


@undisturbed()
def _checkpoint(store: Stored, run: OrbitRun, done: int) -> None:
    """Stores the state after `done` pieces, in a single file that is replaced as a whole."""
    saved = run.saved()
    if CHECKPOINT not in store.group:
        shape = saved.shape[0] + 1, saved.shape[1]
        store.group.create_array(CHECKPOINT, shape=shape, chunks=shape, dtype="float64", fill_value=0.0)
    store.group[CHECKPOINT][:] = np.concatenate([np.full((1, saved.shape[1]), float(done)), saved])


def _resumed(store: Stored, run: OrbitRun, there: int) -> int:
    """The number of pieces that need not be computed again; `run` is set to continue after them."""
    if there == 0 or CHECKPOINT not in store.group:
        return 0
    rows = np.asarray(store.group[CHECKPOINT][:])
    done = int(rows[0, 0])
    if not 0 < done <= there:  # a piece before it was damaged
        return 0
    run.restore(rows[1:], int(store.sweep.within("bounce", done - 1).stop - 1) * run.every)
    return done
