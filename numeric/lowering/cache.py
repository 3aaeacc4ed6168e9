"""Files kept between runs: blueprints and object code. Never needed, never trusted, never shouted about.

An entry is found by a key that contains everything it depends on. It is written to a temporary
file and renamed, so that two processes cannot mix; it carries its own digest, so that a truncated
file is no file. When the folder cannot be used the work is done without it, and one warning says so.
"""
# Every warm start passes here, and pathlib alone takes 3 ms to import.
# ruff: noqa: PTH103, PTH105, PTH108, PTH111, PTH118, PTH120, PTH123

import hashlib
import os
from contextlib import suppress
from functools import cache as memoised

FOLDER = "PINBALL_CACHE"  # the environment variable that moves the folder; empty switches it off
_said: set[str] = set()


def folder() -> str | None:
    """Where entries live, or None when the user has switched the cache off."""
    chosen = os.environ.get(FOLDER)
    if chosen is not None:
        return chosen or None
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return None if base.startswith("~") else os.path.join(base, "pinball-billiards")  # "~" where nobody is at home


@memoised
def sources(*packages: str) -> str:
    """A digest of the program text of some of this project's packages."""
    digest = hashlib.sha256()
    root = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
    for package in packages:
        for inside, folders, files in os.walk(os.path.join(root, package)):
            folders.sort()
            for name in sorted(files):
                if name.endswith(".py"):
                    path = os.path.join(inside, name)
                    with open(path, "rb", buffering=0) as file:
                        digest.update(os.path.relpath(path, root).encode() + b"\0" + file.readall() + b"\0")
    return digest.hexdigest()


def key_of(*parts: str) -> str:
    """A digest of several texts, of which no two runs together."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def read(kind: str, *parts: str) -> bytes | None:
    """The entry kept under this key, or None."""
    place = folder()
    if place is None:
        return None
    try:
        with open(os.path.join(place, f"{kind}-{key_of(*parts)}"), "rb", buffering=0) as file:
            found = file.readall()
    except OSError:
        return None
    digest, content = found[:32], found[32:]
    return content if hashlib.sha256(content).digest() == digest else None


def write(kind: str, *parts_and_content: str | bytes) -> None:
    """Keep an entry: the texts of its key, then its bytes."""
    *parts, content = parts_and_content
    assert isinstance(content, bytes)
    place = folder()
    if place is None:
        return
    import tempfile

    temporary = None
    try:
        os.makedirs(place, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=place, prefix=".new-")
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
        os.replace(temporary, os.path.join(place, f"{kind}-{key_of(*map(str, parts))}"))
    except OSError as reason:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)
        if place not in _said:
            _said.add(place)
            import warnings

            why = reason.strerror or reason
            warnings.warn(f"the cache folder {place} cannot be written ({why}); working without it", stacklevel=2)
