"""After any write error in a sweep the store is whole, nothing is lost or done twice, and the result is the same.

`benchmarks/torture.py restarts` draws such faults for minutes.
"""

import errno
import os
import warnings
from pathlib import Path

import numpy as np
import pytest
from attacks.faults import interrupted, restarts
from stored import files

from numeric.sweeps.run import UnfinishedError, run
from numeric.sweeps.store import opened
from numeric.sweeps.sweep import Axis, Field, Sweep


def squares(part):
    x = part.values["x"]
    return {"square": x**2, "noise": np.random.default_rng(part.seed).random(x.size)}


def table(task=squares):
    axes = (Axis("x", np.arange(8.0), "1", "a number", 2),)
    fields = tuple(Field(name, ("x",), "float64", "1", f"the {name}") for name in ("square", "noise"))
    return Sweep("squares", "Squares", axes, fields, task, 1, "none", {"n": 8}, 8, lambda: None)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The files of a sweep that ran undisturbed."""
    store = tmp_path_factory.mktemp("whole") / "store"
    run(table(), store)
    return files(store)


@pytest.mark.parametrize("moment", range(0, 20, 3))
@pytest.mark.parametrize("where", ["before", "between"])
def test_a_fault_at_any_write_leaves_a_store_that_goes_on(whole, where, moment, tmp_path):
    """`before`: the disk is full. `between`: the process ends after the write and before the rename."""
    store = tmp_path / "store"
    hit = interrupted(lambda: run(table(), store, workers=1), where, moment)
    run(table(), store)

    assert hit or moment > 12  # 15 files: 7 of the store itself, two for each part
    assert files(store) == whole


def test_restarts_drawn_at_random_end_with_the_same_bits():
    assert restarts(6, seed=3).failed == 0


@pytest.mark.parametrize(
    "damage", [lambda old: old[:-3], lambda old: b"", lambda old: old[:5] + bytes([old[5] ^ 4]) + old[6:]],
    ids=["truncated", "empty", "flipped"],
)  # fmt: skip
def test_a_damaged_chunk_is_found_named_and_computed_again(whole, damage, tmp_path):
    run(table(), tmp_path)
    chunk = tmp_path / "noise" / "c" / "2"
    chunk.write_bytes(damage(chunk.read_bytes()))
    again = []
    with pytest.warns(UserWarning, match=f"1 damaged files are computed again, {chunk} among them"):
        run(table(lambda part: again.append(part.at) or squares(part)), tmp_path)

    assert again == [(2,)]
    assert files(tmp_path) == whole
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run(table(), tmp_path)


@pytest.mark.parametrize("number", ["EROFS", "EACCES", "EIO", "ENOSPC"])
def test_a_store_that_cannot_be_written_is_one_sentence(number, tmp_path, monkeypatch):
    with opened(table(), tmp_path / "store"):
        pass

    def refused(handle):
        raise OSError(getattr(errno, number), os.strerror(getattr(errno, number)))

    monkeypatch.setattr("os.fsync", refused)
    with pytest.raises(UnfinishedError, match=r"^the (store|disk) [a-z -]*; 0 of 4 parts are in "):
        run(table(), tmp_path / "store")
    assert list((tmp_path / "store").rglob("*.partial")) == []


def test_a_whole_store_is_read_where_nothing_can_be_written(tmp_path, monkeypatch):
    kept = run(table(), tmp_path / "store").load()

    def refused(*_, **__):
        raise OSError(errno.EROFS, "Read-only file system")

    for name in ("os.fsync", "os.unlink", "os.replace", "pathlib.Path.unlink", "pathlib.Path.replace"):
        monkeypatch.setattr(name, refused)

    assert run(table(), tmp_path / "store").identical(kept)


@pytest.mark.parametrize("address", ["memory://sweep", "s3://bucket/sweep"])
def test_an_object_store_is_refused_in_one_sentence(address, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match="an object store cannot rename a file in one step; accepted: a directory"):
        run(table(), Path(address))

    assert list(tmp_path.iterdir()) == []


def test_a_clock_that_is_set_back_changes_nothing(whole, tmp_path, monkeypatch):
    times = iter(range(10**9, 0, -3600))
    monkeypatch.setattr("time.time", lambda: float(next(times)))
    interrupted(lambda: run(table(), tmp_path / "store"), "before", 12)
    run(table(), tmp_path / "store")

    assert files(tmp_path / "store") == whole


def test_what_was_written_late_beside_a_store_that_could_not_be_made_goes_with_the_next(whole, tmp_path):
    """Zarr writes on after it reported a full disk, so a draft may reappear after it was removed."""
    store = tmp_path / "store"
    assert interrupted(lambda: run(table(), store, workers=1), "before", 1)
    for late in (tmp_path / f".store.{os.getpid()}.{k}" for k in (0, 10**6)):
        late.mkdir(exist_ok=True)
        (late / "zarr.json").write_text("{}")
    run(table(), store)

    assert files(store) == whole
    assert {path.name for path in tmp_path.iterdir()} <= {"store", ".store.lock"}  # some systems keep the lock's file


OWN = ("x/c/0", "x/zarr.json", "noise/zarr.json", "square/zarr.json")  # of a store before anything is computed


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("damage", ["cut", "flipped", "gone"])
def test_a_damaged_axis_or_description_is_found_said_and_written_again(whole, name, damage, tmp_path):
    """An axis has no checksum of Zarr's: a flipped bit would shift every label unnoticed."""
    store = tmp_path / "store"
    run(table(), store)
    text = bytearray((store / name).read_bytes())
    text[len(text) // 2] ^= 4
    (store / name).unlink()
    if damage != "gone":
        (store / name).write_bytes(text[: len(text) // 2] if damage == "cut" else text)
    with pytest.warns(UserWarning, match=f"1 damaged files are written again, .*{name} among them"):
        found = run(table(), store)

    assert found["x"].values.tolist() == list(range(8))
    assert files(store) == whole
