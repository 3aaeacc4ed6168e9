"""Doing a sweep: what is missing, by threads or by a cluster, into memory or into a store."""

import errno
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from numeric.sweeps.pools import UnfinishedError, on_cluster, on_threads
from numeric.sweeps.store import Memory, Stored, opened
from numeric.sweeps.sweep import Sweep, cores

if TYPE_CHECKING:
    import xarray as xr

FULL = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the quota is used up",
    errno.EFBIG: "a file would be too large",
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

    With a `store` the parts that are there already are kept, and `UnfinishedError` or `KeyboardInterrupt` says how many
    there are when it ends early. The bits do not depend on `scheduler`, `workers`, or how often it was stopped.
    """
    place: AbstractContextManager[Memory | Stored] = (
        nullcontext(Memory(sweep)) if store is None else opened(sweep, store)
    )
    with place as results:
        parts, missing = len(sweep.indices()), results.missing()
        done = parts - len(missing)
        if tick is not None:
            tick(done, parts)
        pool = on_cluster(sweep, missing, scheduler) if scheduler else on_threads(sweep, missing, workers or cores())
        try:
            for index, arrays in pool:
                results.write(index, arrays)
                done += 1
                if tick is not None:
                    tick(done, parts)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; {_kept(store, done, parts)}") from None
        except UnfinishedError as stop:
            raise UnfinishedError(f"{stop}; {_kept(store, done, parts)}") from None
        except OSError as error:
            reason = FULL.get(error.errno or 0, str(error))
            raise UnfinishedError(f"{reason}; {_kept(store, done, parts)}") from None
        finally:
            pool.close()  # which lets the workers go
        return results.dataset()


def _kept(store: Path | None, done: int, parts: int) -> str:
    if store is None:
        return f"{done} of {parts} parts were done and are lost; with --store DIR they would be kept"
    return f"{done} of {parts} parts are in {store}, and the same command goes on from there"
