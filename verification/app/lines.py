"""Bounces as lines for people, which fit the terminal that they are printed on."""

from collections.abc import Mapping, Sequence
from typing import Any

PLACES = range(6, 1, -1)  # decimals of float64, as many as fit


def of_bounces(entries: Sequence[Mapping[str, Any]], keys: Sequence[str], width: int) -> list[str]:
    """A line for each bounce, with all digits where `width` letters hold them.

    Elsewhere numbers of float64 are rounded, and a component or a status that all bounces share is said once.
    Numbers of more digits, which were asked for, have a line each.

    >>> rows = [{"component": "egg", "theta": x, "status": "regular"} for x in (0.1, -2.25)]
    >>> of_bounces(rows, ("component", "theta", "status"), 80)[1:]
    ['0       egg        0.1    regular', '1       egg        -2.25  regular']
    >>> print(*of_bounces(rows, ("component", "theta", "status"), 30), sep="\\n")
    component egg, status regular, throughout; rounded, --json FILE has all digits
    bounce  theta
    0       0.100000
    1       -2.250000
    >>> print(*of_bounces([{"component": "egg", "theta": "0.1234567"}], ("component", "theta"), 20), sep="\\n")
    bounce 0: egg
      theta  0.1234567
    """
    full = _table([[_exact(entry[key]) for key in keys] for entry in entries], keys)
    if _widest(full) <= width:
        return full
    if any(isinstance(entry[key], str) for entry in entries for key in keys if key not in ("component", "status")):
        return [line for i, entry in enumerate(entries) for line in _one(i, entry, keys)]
    same = [key for key in ("component", "status") if key in keys and len({entry[key] for entry in entries}) == 1]
    said = "".join(f"{key} {entries[0][key]}, " for key in same) + ("throughout; " if same else "")
    left = [key for key in keys if key not in same]
    for places in PLACES:
        short = _table([[_rounded(entry[key], places) for key in left] for entry in entries], left)
        if _widest(short) <= width:
            break
    return [f"{said}rounded, --json FILE has all digits", *short]


def _one(index: int, entry: Mapping[str, Any], keys: Sequence[str]) -> list[str]:
    """A bounce whose numbers have a line each."""
    words = [str(entry[key]) for key in ("component", "status") if key in keys]
    numbers = [key for key in keys if key not in ("component", "status") and entry[key] is not None]
    wide = max(len(key) for key in numbers)
    return [f"bounce {index}: {', '.join(words)}", *(f"  {key.ljust(wide)}  {_exact(entry[key])}" for key in numbers)]


def _table(rows: Sequence[Sequence[str]], keys: Sequence[str]) -> list[str]:
    """Rows under their names, each column as wide as its longest text."""
    texts = [["bounce", *keys], *([str(i), *row] for i, row in enumerate(rows))]
    wide = [max(len(text) for text in column) + 2 for column in zip(*texts, strict=True)]
    return ["".join(text.ljust(width) for text, width in zip(row, wide, strict=True)).rstrip() for row in texts]


def _widest(lines: Sequence[str]) -> int:
    return max(map(len, lines))


def _exact(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.16g}" if isinstance(value, float) else str(value)


def _rounded(value: Any, places: int) -> str:
    return f"{value:.{places}f}" if isinstance(value, float) else _exact(value)
