"""Machine code is loaded only from a folder that nobody else can write, and the folder's size is bounded."""

import os
import subprocess
import sys
import time
import warnings

import pytest

from numeric.lowering import cache


@pytest.fixture
def place(tmp_path, monkeypatch):
    """The path of a cache folder that does not exist yet."""
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_the_folder_and_its_entries_are_made_for_the_user_alone(place):
    before = os.umask(0)
    try:
        cache.write("kernel", "a", b"content")
    finally:
        os.umask(before)

    assert place.stat().st_mode & 0o777 == 0o700
    assert [path.stat().st_mode & 0o777 for path in place.iterdir()] == [0o600]


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o720, 0o702])
def test_a_folder_that_others_can_write_is_not_used_and_named_once(place, mode):
    cache.write("kernel", "a", b"content")
    place.chmod(mode)
    with pytest.warns(
        UserWarning, match=rf"the cache folder {place} is not used: others can write in it \(mode 0{mode:o}"
    ):
        assert cache.read("kernel", "a") is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cache.write("kernel", "b", b"content")
        assert cache.read("kernel", "b") is None

    assert len(list(place.iterdir())) == 1
    place.chmod(0o700)
    assert cache.read("kernel", "a") == b"content"


def test_what_belongs_to_another_user_is_not_used(place, monkeypatch):
    cache.write("kernel", "a", b"content")
    monkeypatch.setattr("os.geteuid", lambda: place.stat().st_uid + 1)
    with pytest.warns(UserWarning, match=f"it belongs to the user with the number {place.stat().st_uid}"):
        assert cache.read("kernel", "a") is None
    with pytest.raises(ValueError, match="is not cleared: it belongs to"):
        cache.clear()


def test_an_entry_that_others_can_write_is_not_used_and_said_once(place):
    cache.write("kernel", "a", b"content")
    (entry,) = place.iterdir()
    entry.chmod(0o666)
    with pytest.warns(UserWarning, match=f"an entry of the cache folder {place} is not used: others can write") as told:
        assert [cache.read("kernel", "a") for _ in range(3)] == [None] * 3

    assert len(told) == 1


def test_an_entry_of_another_key_or_a_link_is_no_entry(place):
    cache.write("kernel", "a", b"content")
    (entry,) = place.iterdir()
    other = place / f"kernel-{cache.key_of('b')}"
    entry.rename(other)
    assert cache.read("kernel", "b") is None
    other.rename(place / "elsewhere")
    entry.symlink_to(place / "elsewhere")
    assert cache.read("kernel", "a") is None


def test_systems_without_owners_use_the_folder(place, monkeypatch):
    cache.write("kernel", "a", b"content")
    place.chmod(0o777)
    monkeypatch.delattr("os.geteuid")

    assert cache.read("kernel", "a") == b"content"


def test_the_oldest_entries_go_when_there_is_too_much(place):
    """Large entries are sparse files, which take no space. The folder is listed at the first write of a process."""
    now = time.time()
    for i in range(8):
        cache.write("kernel", str(i), b"content")
        os.utime(place / f"kernel-{cache.key_of(str(i))}", (now - 100 + i, now - 100 + i))
    (place / "notes.txt").write_text("the user's own")
    for path in place.glob("kernel-*"):
        before = path.stat()
        os.truncate(path, cache.LIMIT // 7)
        os.utime(path, (before.st_atime, before.st_mtime))
    last = "from numeric.lowering import cache; cache.write('kernel', 'last', b'content')"
    subprocess.run([sys.executable, "-c", last], check=True)

    left = {path.name for path in place.iterdir()}
    assert left == {"notes.txt", *(f"kernel-{cache.key_of(x)}" for x in ("3", "4", "5", "6", "7", "last"))}
    assert sum(size for _, size, _ in cache.entries()) <= cache.LIMIT * 3 // 4


def test_clearing_takes_what_is_ours_and_nothing_else(place):
    assert (cache.clear(), cache.entries()) == ((0, 0), [])
    cache.write("kernel", "a", b"content")
    cache.write("table_ir", "a", b"")
    (place / ".new-left").write_bytes(b"xyz")
    (place / "kernel-notes").write_text("the user's own")

    assert cache.clear() == (3, 32 + 7 + 32 + 3)
    assert [path.name for path in place.iterdir()] == ["kernel-notes"]


def test_the_command_says_where_and_clears(place, capsys):
    from verification.app.cli import main

    cache.write("kernel", "a", b"content")
    assert (main(["cache", "--where"]), capsys.readouterr().out) == (0, f"{place}\n")
    assert main(["cache"]) == 0
    assert f"{place}: 1 files" in capsys.readouterr().out
    assert main(["cache", "--clear"]) == 0
    assert "1 files removed" in capsys.readouterr().out
    assert list(place.iterdir()) == []
    place.chmod(0o777)
    assert main(["cache"]) == 1
    assert "is not used: others can write in it (mode 0777; chmod 700 mends that)" in capsys.readouterr().out
