"""The one way in which this package writes a file: a reader finds the old content or the new, and never half of either.

The content goes to a temporary file in the same folder, then to the disk, and then takes the place of the old file. So
neither Ctrl-C nor a full disk breaks a file that was there. (Entries of the cache are written by
`numeric.lowering.cache`, since they may be lost.)
"""

import itertools
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import IO, Any

PARTIAL = ".partial"  # at the end of the name of a file that is being written
_numbers = itertools.count()


@contextmanager
def replacing(path: str | Path) -> Iterator[IO[bytes]]:
    """A binary file to write to, which takes the place of `path` when the block ends without an error.

    A link keeps pointing to its file, and a file keeps its permissions. Pipes and devices are written to directly.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "orbit.csv"
    ...     write_whole(path, "old")
    ...     try:
    ...         with replacing(path) as file:
    ...             _ = file.write(b"half of the n")
    ...             raise OSError("no space left on device")
    ...     except OSError:
    ...         path.read_text(), len(list(path.parent.iterdir()))
    ('old', 1)
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        with path.open("wb") as file:
            yield file
        return
    path = path.resolve()
    partial = path.with_name(f".{path.name[:100]}.{os.getpid()}.{next(_numbers)}{PARTIAL}")
    try:
        with partial.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        with suppress(OSError):
            shutil.copymode(path, partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Writes a file, with text in UTF-8; if writing fails, the old content of the file remains."""
    with replacing(path) as file:
        file.write(content.encode() if isinstance(content, str) else content)


def json_text(document: Any, indent: int | None = None) -> str:
    """A document as JSON, in which null stands for each number that is not finite: JSON has no such numbers.

    >>> json_text({"nu": (0.5, float("nan"), -float("inf"))})
    '{"nu": [0.5, null, null]}'
    """
    try:
        return json.dumps(document, indent=indent, allow_nan=False)
    except ValueError:
        return json.dumps(_finite(document), indent=indent, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not isfinite(value) else value
