"""Attack: sweeps whose writes are killed, refused, damaged or hit a full disk end with the same bytes."""

import errno
import os
import random
import subprocess
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from attacks.outcome import Outcome


class Gone(BaseException):
    """Raised where the process would be killed: no handler for ordinary exceptions cleans up."""


def interrupted(work: Callable[[], object], where: str, moment: int) -> bool:
    """Runs `work` with a failure at its write number `moment`; returns whether that was reached.

    `before`: the disk is full when the file is written. `between`: the process ends after the write and before the
    rename, so that the temporary file stays.
    """
    count, fsync, replace, unlink = [0], os.fsync, Path.replace, Path.unlink

    def written(handle: int) -> None:
        count[0] += 1
        if where == "before" and count[0] > moment:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(handle)

    def renamed(self: Path, target: Path) -> Path:
        if where == "between" and count[0] > moment and self.name.endswith(".partial"):
            raise Gone
        return replace(self, target)

    def kept(self: Path, missing_ok: bool = False) -> None:
        if not (where == "between" and count[0] > moment):
            unlink(self, missing_ok)

    os.fsync, Path.replace, Path.unlink = written, renamed, kept  # type: ignore[method-assign, assignment]
    try:
        work()
    except (Gone, OSError):
        return True
    except Exception as stop:
        if type(stop).__name__ in ("UnfinishedError", "ValueError"):  # one sentence, as a user sees it
            return True
        raise
    finally:
        os.fsync, Path.replace, Path.unlink = fsync, replace, unlink  # type: ignore[method-assign]
    return False


def _files(store: Path) -> dict[str, bytes]:
    return {str(file.relative_to(store)): file.read_bytes() for file in store.rglob("*") if file.is_file()}


def squares(size: int, cut: int, number: int, done: list[tuple[int, ...]]) -> Any:
    """A sweep over a grid of numbers and random ones; the parts that are computed are added to `done`."""
    import numpy as np

    from numeric.sweeps.sweep import Axis, Field, Sweep

    def task(part: Any) -> dict[str, Any]:
        done.append(part.at)
        x = part.values["x"]
        return {"square": x**2, "noise": np.random.default_rng(part.seed).random(x.size)}

    axes = (Axis("x", np.arange(float(size)), "1", "a number", cut),)
    made = tuple(Field(name, ("x",), "float64", "1", name) for name in ("square", "noise"))
    return Sweep("squares", "Squares", axes, made, task, number, "none", {}, size, lambda: None)


def _parts(store: Path, whole: Path) -> set[str]:
    """The parts for which the files of both fields have the bytes of an undisturbed sweep."""
    found, right = _files(store), _files(whole)
    names = [{name for name in found if name.startswith(f"{field}/c/")} for field in ("square", "noise")]
    same = [{name[name.index("c/") :] for name in each if found[name] == right.get(name)} for each in names]
    return same[0] & same[1]


def restarts(sweeps: int, seed: int = 1) -> Outcome:
    """Sweeps of random grids, each interrupted at random writes and damaged between its runs, until it is done.

    At the end every byte equals that of an undisturbed sweep, and no intact part was computed again.
    """
    from numeric.sweeps.run import run

    chance, failed, runs = random.Random(seed), 0, 0
    for number in range(sweeps):
        done: list[tuple[int, ...]] = []
        sweep = squares(chance.randint(3, 12), chance.randint(1, 4), number, done)
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of damaged files
            run(sweep, Path(folder) / "whole", workers=1)
            store, damaged = Path(folder) / "store", 0
            done.clear()
            while True:
                runs += 1
                where, moment = chance.choice(("before", "between")), chance.randint(6, 20)
                before = _parts(store, Path(folder) / "whole")
                done.clear()
                if not interrupted(lambda: run(sweep, store, workers=1), where, moment):  # noqa: B023
                    break
                failed += bool(before & {f"c/{at[0]}" for at in done})
                if chance.random() < 0.3 and (chunks := sorted(store.rglob("c/*"))):
                    victim, damaged = chance.choice(chunks), damaged + 1
                    whole = victim.read_bytes()
                    victim.write_bytes(whole[: chance.randrange(len(whole))])
            failed += _files(store) != _files(Path(folder) / "whole")
    return Outcome(sweeps, failed, f"{runs} starts")


def disks(pages: int, seed: int = 1) -> Outcome:
    """Sweeps onto disks in memory of one page, two pages, ...: each stops with a sentence, and continues with room.

    At the end every byte equals that of an undisturbed sweep. Only root may mount such a disk.
    """
    from numeric.sweeps.run import UnfinishedError, run

    if os.geteuid() != 0:
        return Outcome(0, 0, "only root may mount a disk of memory")
    failed = full = 0
    with tempfile.TemporaryDirectory() as folder:
        run(squares(8, 2, seed, []), Path(folder) / "whole", workers=1)
        whole, disk = _files(Path(folder) / "whole"), Path(folder) / "disk"
        disk.mkdir()
        for page in range(1, pages + 1):
            mount = ["mount", "-t", "tmpfs", "-o", f"size={page * os.sysconf('SC_PAGE_SIZE')}", "tmpfs", str(disk)]
            if subprocess.run(mount, check=False, capture_output=True).returncode:
                return Outcome(0, 0, "no disk of memory may be mounted here")
            try:
                try:
                    run(squares(8, 2, seed, []), disk / "store", workers=1)
                except (UnfinishedError, ValueError) as stop:  # one sentence, as a user sees it
                    full += 1
                    failed += "\n" in str(stop)
                subprocess.run(["mount", "-o", "remount,size=4m", str(disk)], check=True)
                run(squares(8, 2, seed, []), disk / "store", workers=1)
                failed += _files(disk / "store") != whole
            finally:
                subprocess.run(["umount", str(disk)], check=True)
    return Outcome(pages, failed, f"{full} of the disks were full")
