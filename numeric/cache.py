"""Files kept between runs: blueprints and object code. Never needed, never trusted, never shouted about.

An entry is found by a key that contains everything it depends on. It is written to a temporary
file and renamed, so that two processes cannot mix; it carries its own digest, so that a truncated
file is no file. When the folder cannot be used the work is done without it, and one warning says so.
"""

import hashlib
import os
from contextlib import suppress
from functools import cache as memoised
from pathlib import Path

FOLDER = "PINBALL_CACHE"  # the environment variable that moves the folder; empty switches it off
_said: set[str] = set()


def folder() -> Path | None:
    """Where entries live, or None when the user has switched the cache off."""
    chosen = os.environ.get(FOLDER)
    if chosen is not None:
        return Path(chosen) if chosen else None
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # nobody's home
        return None
    return base / "pinball-billiards"


@memoised
def sources(*packages: str) -> str:
    """A digest of the program text of some of this project's packages."""
    digest = hashlib.sha256()
    root = Path(__file__).resolve().parent.parent
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
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
        found = (place / f"{kind}-{key_of(*parts)}").read_bytes()
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
        place.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=place, prefix=".new-")
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
        Path(temporary).replace(place / f"{kind}-{key_of(*map(str, parts))}")
    except OSError as reason:
        if temporary is not None:
            with suppress(OSError):
                Path(temporary).unlink()
        if str(place) not in _said:
            _said.add(str(place))
            import warnings

            why = reason.strerror or reason
            warnings.warn(f"the cache folder {place} cannot be written ({why}); working without it", stacklevel=2)
