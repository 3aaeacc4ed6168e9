"""Stores of results: a Zarr store that grows part by part and is valid at any time, or plain memory.

A part is done when the file of each of its fields exists and has the right checksum; a file appears as a whole or not
at all. So there is no journal, and incomplete parts of a killed sweep are computed again. A part has the same bits
whichever process computes it. A lock keeps a second process out; without a lock two processes would only waste time.
"""

import glob
import itertools
import json
import os
import re
import shutil
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from numeric.lowering.files import PARTIAL, write_whole
from numeric.sweeps.sweep import Array, Field, Sweep, missing_value
from numeric.sweeps.workers import undisturbed

if TYPE_CHECKING:
    import xarray as xr

Index = tuple[int, ...]
ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/")  # of an object store; a path made of it has lost a slash
SHORT = 80  # letters of a value up to which it is shown where two differ
_written = itertools.count()


class Memory:
    """Results in memory, for a sweep that is small enough not to need a store."""

    def __init__(self, sweep: Sweep) -> None:
        self.sweep = sweep
        self.arrays = {f.name: np.full(sweep.shape(f), missing_value(f.dtype), f.dtype) for f in sweep.fields}

    def missing(self) -> list[Index]:
        """All parts, since none is stored."""
        return self.sweep.indices()

    def write(self, index: Index, arrays: dict[str, Array]) -> None:
        """Keeps the results of a part."""
        for field in self.sweep.fields:
            self.arrays[field.name][self.sweep.where(field, index)] = arrays[field.name]

    def dataset(self) -> "xr.Dataset":
        """All results as a labelled Dataset."""
        import xarray as xr

        sweep = self.sweep
        return xr.Dataset(
            {f.name: (f.dims, self.arrays[f.name], {"units": f.units, "long_name": f.about}) for f in sweep.fields},
            {a.name: (a.name, a.values, {"units": a.units, "long_name": a.about}) for a in sweep.axes},
            sweep.attributes(),
        )


class Stored:
    """Results in an existing Zarr store at `path`; `opened` creates the store, for one process at a time."""

    @undisturbed()
    def __init__(self, sweep: Sweep, path: Path) -> None:
        import zarr

        self.sweep, self.path = sweep, path
        with zarr.config.set({"array.write_empty_chunks": True}):
            self.group: Any = zarr.open_group(_whole_files()(path), mode="r+", use_consolidated=False)
            self.arrays: dict[str, Any] = {field.name: self.group[field.name] for field in sweep.fields}

    def missing(self) -> list[Index]:
        """The parts that are missing or damaged; a warning names damaged files."""
        damaged: list[Path] = []
        missing = []
        for index in self.sweep.indices():
            there = [self._has(field, index, damaged) for field in self.sweep.fields]
            missing += [] if all(there) else [index]
        if damaged:
            first, count = damaged[0], len(damaged)
            warnings.warn(f"{count} damaged files are computed again, {first} among them", stacklevel=3)
        return missing

    @undisturbed()
    def write(self, index: Index, arrays: dict[str, Array]) -> None:
        """Writes the results of a part; if the disk is full, raises `OSError`, and the part is still missing."""
        for field in self.sweep.fields:
            values = np.asarray(arrays[field.name], field.dtype)
            self.arrays[field.name][self.sweep.where(field, index)] = values

    @undisturbed()
    def dataset(self) -> "xr.Dataset":
        """All results as a labelled Dataset, read on demand."""
        import xarray as xr

        found: xr.Dataset = xr.open_zarr(self.path)
        return found

    @undisturbed()
    def _has(self, field: Field, index: Index, damaged: list[Path]) -> bool:
        at = dict(zip(self.sweep.axis, index, strict=True))
        array = self.arrays[field.name]
        key = array.metadata.encode_chunk_key(tuple(at[name] for name in field.dims))
        file = self.path / field.name / key
        if not file.is_file():
            return False
        try:
            array[self.sweep.where(field, index)]
        except Exception:  # whatever a codec says of a damaged file
            damaged.append(file)
            return False
        return True


@contextmanager
def opened(sweep: Sweep, path: Path) -> Iterator[Stored]:
    """The store of a sweep, new or to be resumed; `ValueError` if another sweep made it or another process uses it."""
    if ADDRESS.match(path.as_posix()):
        raise ValueError(
            f"--store {path}: an object store cannot rename a file in one step; accepted: a directory on a disk, which "
            "may be copied to an object store when the sweep is done"
        )
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        _made(sweep, path)
    _same(sweep, path)
    with _alone(path) as alone:
        for left in path.rglob(f".*{PARTIAL}") if alone else ():  # of a driver that was killed
            with suppress(OSError):
                left.unlink()
        _mended(sweep, path)
        yield Stored(sweep, path)


@contextmanager
def _alone(path: Path) -> Iterator[bool]:
    """Keeps other processes out by a lock that ends with its process; yields whether the file system has locks."""
    from filelock import FileLock, Timeout

    lock = FileLock(path.with_name(f".{path.name}.lock"), blocking=False)
    try:
        lock.acquire()
    except Timeout:
        raise ValueError(f"--store {path}: another process is writing to it; wait for it or stop it") from None
    except (OSError, NotImplementedError):  # no locks there, or nothing to be written: two drivers do everything twice
        yield False
        return
    try:
        yield True
    finally:
        lock.release()


@undisturbed()
def _made(sweep: Sweep, path: Path) -> None:
    """Creates an empty store, which becomes visible only when it is complete."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        own = f".{path.name}.{os.getpid()}"
        for late in path.parent.glob(f"{glob.escape(own)}.*"):  # of Zarr's writes when the disk was full
            shutil.rmtree(late, ignore_errors=True)
        draft = path.with_name(f"{own}.{next(_written)}")
        try:
            _laid_out(sweep, _whole_files()(draft))
            draft.replace(path)
        finally:
            shutil.rmtree(draft, ignore_errors=True)
    except OSError as error:
        if path.is_dir() and any(path.iterdir()):
            return  # another process was quicker
        raise ValueError(f"--store {path} cannot be made: {error.strerror or error}") from None


def _laid_out(sweep: Sweep, place: Any) -> None:
    """Writes axes, fields without values, and their descriptions into a Zarr store."""
    import zarr

    group = zarr.create_group(place, zarr_format=3, attributes=sweep.attributes())
    for axis in sweep.axes:
        labels: dict[str, Any] = {"units": axis.units, "long_name": axis.about}
        array = group.create_array(
            axis.name,
            shape=axis.values.shape,
            dtype=axis.values.dtype,
            chunks=(max(1, axis.size),),
            dimension_names=(axis.name,),
            attributes=labels,
        )
        array[:] = axis.values
    for field in sweep.fields:
        _field(group, sweep, field)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Zarr's, that version 3 has no rule for it; xarray asks for it
        zarr.consolidate_metadata(group.store)


@undisturbed()
def _mended(sweep: Sweep, path: Path) -> None:
    """Writes the files of an empty store again if they are damaged, also those of the axes, which have no checksum."""
    from zarr.storage import MemoryStore

    own: dict[str, Any] = {}
    _laid_out(sweep, MemoryStore(own))
    damaged: list[Path] = []
    for name, value in own.items():
        try:
            if (path / name).read_bytes() == value.to_bytes():
                continue
        except OSError:
            pass
        damaged.append(path / name)
        try:
            (path / name).parent.mkdir(parents=True, exist_ok=True)
            write_whole(path / name, value.to_bytes())
        except OSError as error:
            reason = error.strerror or error
            raise ValueError(f"--store {path}: {path / name} is damaged and cannot be mended: {reason}") from None
    if damaged:
        warnings.warn(f"{len(damaged)} damaged files are written again, {damaged[0]} among them", stacklevel=4)


def _field(group: Any, sweep: Sweep, field: Field) -> None:
    from zarr.codecs import Crc32cCodec, ZstdCodec

    group.create_array(
        field.name,
        shape=sweep.shape(field),
        dtype=field.dtype,
        chunks=tuple(sweep.axis[name].length for name in field.dims),
        dimension_names=field.dims,
        fill_value=missing_value(field.dtype),
        compressors=[ZstdCodec(), Crc32cCodec()],
        attributes={"units": field.units, "long_name": field.about},
    )


def _same(sweep: Sweep, path: Path) -> None:
    """Raises `ValueError`, which names the differences, unless the store was made for this sweep."""
    try:
        found = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
        found["sweep"]
    except (OSError, ValueError, KeyError, TypeError):
        raise ValueError(
            f"--store {path} is not a sweep of ours; accepted: a new directory, or one to be resumed"
        ) from None
    own = sweep.attributes()
    if differing := _differing(_named(found), _named(own)) or _other_axes(sweep, path, found):
        said = ", ".join(differing)
        raise ValueError(f"--store {path} holds a sweep with {said}; resume it as it was begun, or name another")
    if found.get("versions") != own["versions"]:
        raise ValueError(
            f"--store {path} was begun with {_listed(found.get('versions'))}, and here are {_listed(own['versions'])}, "
            "which may differ in the last bits; install those versions to go on, or name another store"
        )


def _named(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """The values on which the results of a sweep depend, by the names of the options: kind, scene, settings and seed.

    >>> _named({"sweep": "basins", "scene": 'scene = { table = "circle" }', "settings": '{"lam": 0.5}', "seed": 1})
    {'sweep': 'basins', 'seed': 1, 'table': 'circle', 'lam': 0.5}
    """
    try:
        scene = dict(tomllib.loads(str(attributes.get("scene")))["scene"])
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError):
        scene = {"scene": attributes.get("scene")}
    try:
        settings = dict(json.loads(str(attributes.get("settings"))))
    except (TypeError, ValueError):
        settings = {"settings": attributes.get("settings")}
    shape = scene.pop("shape", {})
    named = {"sweep": attributes.get("sweep"), "seed": attributes.get("seed")}
    return named | scene | (shape if isinstance(shape, dict) else {}) | settings


def _differing(was: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    """The values that differ, as text; both values are shown where they are short."""
    names = [name for name in {**here, **was} if was.get(name) != here.get(name)]
    short = [
        f"{name} = {was.get(name, 'none')} and not {here.get(name, 'none')}"
        for name in names
        if max(len(str(each.get(name, ""))) for each in (was, here)) <= SHORT
    ]
    return short or [f"another {name}" for name in names]


def _other_axes(sweep: Sweep, path: Path, found: Mapping[str, Any]) -> list[str]:
    """The axes whose coordinates are not those of the store."""
    import zarr

    if found.get("grid") == sweep.grid():
        return []
    different = []
    group: Any = zarr.open_group(path, mode="r", use_consolidated=False)
    for axis in sweep.axes:
        try:
            values = np.asarray(group[axis.name][:])
        except Exception:  # whatever a codec says of a damaged file
            continue
        if values.shape != axis.values.shape or not np.array_equal(values, axis.values):
            old, new = (f"{x.size} values from {x.min():g} to {x.max():g}" for x in (values, axis.values))
            different.append(f"{axis.name} = {old} and not {new}")
    return different or ["parts of another size"]


def _listed(versions: Any) -> str:
    """Packages with their versions as text."""
    try:
        return ", ".join(f"{name} {number}" for name, number in json.loads(versions).items())
    except (TypeError, ValueError, AttributeError):
        return "versions that it does not say"


def _whole_files() -> Any:
    """A Zarr store on disk in which a file appears as a whole or not at all, in every version of Zarr."""
    from zarr.storage import LocalStore

    class WholeFiles(LocalStore):  # type: ignore[misc, unused-ignore]
        """A local store that writes each value whole."""

        async def set(self, key: str, value: Any) -> None:
            place = Path(self.root) / key
            place.parent.mkdir(parents=True, exist_ok=True)
            write_whole(place, value.to_bytes())

    return WholeFiles


def kept(store: Path | None, done: int, parts: int) -> str:
    """A sentence with the number of stored parts of an interrupted sweep."""
    if store is None:
        return f"{done} of {parts} parts were done and are lost; with --store DIR they would be kept"
    return f"{done} of {parts} parts are in {store}, and the same command goes on from there"
