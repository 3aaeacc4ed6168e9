"""Files kept between runs: scenes, table IRs and machine code. The program works without them.

An entry is found by a key that contains everything it depends on. It is written to a temporary file and renamed, so
that two processes cannot mix. It carries a digest of its name and content, so that a truncated or renamed file is not
accepted. A digest protects from accidents, not from people. Therefore the folder is made for the user alone, and a
folder or an entry that belongs to another user, or that others can write, is not used. If the folder cannot be used,
the program goes on without it, after one warning.
"""
# Every warm start passes here, and pathlib alone takes 3 ms to import.
# ruff: noqa: PTH103, PTH105, PTH108, PTH111, PTH116, PTH118, PTH120, PTH123

import os
import stat
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import cache as memoised

try:
    from _blake2 import blake2b  # hashlib takes 3 ms to import: it asks OpenSSL what else there is
except ImportError:
    from hashlib import blake2b

FOLDER = "PINBALL_CACHE"  # the environment variable that moves the folder; empty switches it off
LIMIT = 256 << 20  # bytes kept; a kernel takes 10 to 100 kB
KINDS = ("scene", "table_ir", "kernel", "sources")
SETTLED = 2.0  # seconds after which a file that changes again has another time
TEMPORARY = ".new-"  # a file before it is renamed
FOR_OTHERS = stat.S_IWGRP | stat.S_IWOTH
_said: set[str] = set()
_sizes: dict[str, int] = {}  # bytes in a folder when it was last listed, and what this process has written since


def folder() -> str | None:
    """The folder of the cache's files; None if the user has switched the cache off."""
    chosen = os.environ.get(FOLDER)
    if chosen is not None:
        return chosen or None
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return None if base.startswith("~") else os.path.join(base, "pinball-billiards")  # no home folder is known


def distrust(place: str) -> str | None:
    """The reason to distrust a folder, because others could have written in it; None if only the user can.

    The result is None too for a folder that does not exist, and on systems where files have no owners (Windows).
    """
    try:
        found = os.stat(place)
    except OSError:
        return None
    return _foreign(found)


def _foreign(found: os.stat_result) -> str | None:
    """The reason why others may have written to a file or folder; None if only the user can."""
    if not hasattr(os, "geteuid"):
        return None
    if found.st_uid != os.geteuid():
        return f"it belongs to the user with the number {found.st_uid}"
    if found.st_mode & FOR_OTHERS:
        return f"others can write in it (mode {stat.S_IMODE(found.st_mode):04o}; chmod 700 mends that)"
    return None


@memoised
def sources(*packages: str) -> str:
    """A digest of the source text of some of this project's packages, each given by a path such as `numeric/flights`.

    The text is read once. As long as all lengths and times of the files are unchanged, the stored digest is returned.
    """
    root = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
    found = sorted(path for package in packages for path in _files(os.path.join(root, package)))
    stamps = "\n".join(f"{path} {at.st_size} {at.st_mtime_ns} {at.st_ctime_ns}" for path, at in found)
    kept = read("sources", stamps)
    if kept is not None:
        return kept.decode()
    digest = blake2b(digest_size=32)
    for path, _ in found:
        with open(path, "rb", buffering=0) as file:
            digest.update(os.path.relpath(path, root).encode() + b"\0" + file.readall() + b"\0")
    if max(at.st_ctime for _, at in found) < time.time() - SETTLED:  # else it could change within a tick of its clock
        write("sources", stamps, digest.hexdigest().encode())
    return digest.hexdigest()


def _files(place: str) -> Iterator[tuple[str, os.stat_result]]:
    """The Python files in a folder and its subfolders, with their lengths and times."""
    with os.scandir(place) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield entry.path, entry.stat()
            elif entry.is_dir():
                yield from _files(entry.path)


def key_of(*parts: str) -> str:
    """A digest of several texts, separated by zero bytes."""
    return blake2b("\0".join(parts).encode(), digest_size=16).hexdigest()


def read(kind: str, *parts: str) -> bytes | None:
    """The bytes of the entry kept under this key, or None if there is no trusted entry."""
    place = _trusted()
    if place is None:
        return None
    name = f"{kind}-{key_of(*parts)}"
    try:
        handle = os.open(os.path.join(place, name), os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0))
        with open(handle, "rb", buffering=0) as file:
            known = os.fstat(handle)
            if not stat.S_ISREG(known.st_mode):
                return None
            why = _foreign(known)
            if why is not None:
                _say(place, f"an entry of the cache folder {place} is not used: {why}")
                return None
            found = file.readall()
    except OSError:
        return None
    digest, content = found[:32], found[32:]
    return content if _digest(name, content) == digest else None


def write(kind: str, *parts_and_content: str | bytes) -> None:
    """Keeps an entry, given by the texts of its key and then its bytes; above `LIMIT` bytes removes the oldest ones."""
    *parts, content = parts_and_content
    assert isinstance(content, bytes)
    place = _trusted()
    if place is None:
        return
    import tempfile

    temporary = None
    name = f"{kind}-{key_of(*map(str, parts))}"
    try:
        os.makedirs(place, mode=0o700, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=place, prefix=TEMPORARY)  # for the user alone
        with os.fdopen(handle, "wb") as file:
            file.write(_digest(name, content) + content)
        os.replace(temporary, os.path.join(place, name))
        _bound(place, len(content))
    except OSError as reason:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)
        _say(place, f"the cache folder {place} cannot be written ({reason.strerror or reason}); working without it")


def entries() -> list[tuple[str, int, float]]:
    """The files that this package keeps: path, bytes and time of writing, oldest first. Other files are not listed."""
    place = folder()
    return sorted(_entries(place), key=lambda entry: entry[2]) if place is not None else []


def clear() -> tuple[int, int]:
    """Removes all entries, and files that an interrupted run left; returns the number of files and of bytes."""
    place, removed, size = folder(), 0, 0
    why = None if place is None else distrust(place)
    if why is not None:
        raise ValueError(f"{FOLDER} = {place} is not cleared: {why}")
    for path, length, _ in entries():
        with suppress(FileNotFoundError):  # another process was faster
            os.unlink(path)
            removed, size = removed + 1, size + length
    return removed, size


def _entries(place: str) -> Iterator[tuple[str, int, float]]:
    try:
        found = list(os.scandir(place))
    except OSError:
        return
    for file in found:
        kind, _, key = file.name.partition("-")
        ours = kind in KINDS and len(key) == 32 and set(key) <= set("0123456789abcdef")
        with suppress(OSError):
            if (ours or file.name.startswith(TEMPORARY)) and file.is_file(follow_symlinks=False):
                known = file.stat(follow_symlinks=False)
                yield file.path, known.st_size, known.st_mtime


def _bound(place: str, written: int) -> None:
    """Removes the oldest entries, if all have more than `LIMIT` bytes, until three quarters of `LIMIT` are left.

    `written` is the number of new bytes. The folder is listed only if their sum shows that it may be too full.
    """
    _sizes[place] = _sizes.get(place, LIMIT) + written
    if _sizes[place] <= LIMIT:
        return
    kept = sorted(_entries(place), key=lambda entry: entry[2])
    size = sum(length for _, length, _ in kept)
    for path, length, _ in kept if size > LIMIT else ():
        if size <= LIMIT * 3 // 4:
            break
        with suppress(OSError):
            os.unlink(path)
        size -= length
    _sizes[place] = size


def _trusted() -> str | None:
    """The cache folder; None, with one warning, if others can write in it."""
    place = folder()
    why = None if place is None else distrust(place)
    if place is None or why is None:
        return place
    _say(place, f"the cache folder {place} is not used: {why}; working without it")
    return None


def _digest(name: str, content: bytes) -> bytes:
    return blake2b(name.encode() + b"\0" + content, digest_size=32).digest()


def _say(place: str, what: str) -> None:
    """Warns once about a folder."""
    if place not in _said:
        _said.add(place)
        import warnings

        warnings.warn(what, stacklevel=3)
