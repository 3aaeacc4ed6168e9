"""Tables and sentences for people, which fit the terminal that they are printed on."""

import re
import shutil
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from rich.console import Console

PLACES = range(6, 1, -1)  # decimals of float64, as many as fit


def console(stderr: bool = False) -> "Console":
    """Where people read: a terminal, whose lines break at words, or a file, with one line for each sentence."""
    from rich.console import Console

    class Lines(Console):
        def print(self, *objects: Any, **options: Any) -> None:
            if self.is_terminal:
                objects = tuple(wrapped(each, self.width) if isinstance(each, str) else each for each in objects)
            super().print(*objects, **options)

    return Lines(stderr=stderr, highlight=False, markup=False, soft_wrap=True)


def on_terminal(text: str, stream: TextIO) -> str:
    """The text, in lines that fit where the stream is a terminal."""
    return wrapped(text, shutil.get_terminal_size().columns) if stream.isatty() else text


def wrapped(text: str, width: int) -> str:
    """The text with its long lines broken at words; what follows stands below a line's last column, or is indented.

    >>> print(wrapped("egg   a table with three points that is convex", 30))
    egg   a table with three
          points that is convex
    >>> print(wrapped("  proved: one cycle of period 2", 20))
      proved: one cycle
        of period 2
    """
    return "\n".join(part for line in text.split("\n") for part in _broken(line, width))


def _broken(line: str, width: int) -> list[str]:
    if len(line) <= width:
        return [line]
    columns = [found.end() for found in re.finditer(r"(?<=\S)  +(?=\S)", line) if found.end() <= width // 2]
    begin = columns[-1] if columns else len(line) - len(line.lstrip())
    below = " " * (begin if columns else begin + 2)
    return textwrap.wrap(
        line[begin:],
        width,
        initial_indent=line[:begin],
        subsequent_indent=below,
        break_long_words=False,
        break_on_hyphens=False,
    )


def table(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows under their names, each column as wide as its longest text.

    >>> table(("cycle", "stable"), (("2", "yes"), ("12", "no")))
    ['cycle  stable', '2      yes', '12     no']
    """
    wide = [max(map(len, column)) + 2 for column in zip(names, *rows, strict=True)]
    return ["".join(text.ljust(w) for text, w in zip(row, wide, strict=True)).rstrip() for row in (names, *rows)]


def widest(lines: Sequence[str]) -> int:
    """The length of the longest line."""
    return max(map(len, lines), default=0)


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
    full = _numbered([[_exact(entry[key]) for key in keys] for entry in entries], keys)
    if widest(full) <= width:
        return full
    if any(isinstance(entry[key], str) for entry in entries for key in keys if key not in ("component", "status")):
        return [line for i, entry in enumerate(entries) for line in _one(i, entry, keys)]
    same = [key for key in ("component", "status") if key in keys and len({entry[key] for entry in entries}) == 1]
    said = "".join(f"{key} {entries[0][key]}, " for key in same) + ("throughout; " if same else "")
    left = [key for key in keys if key not in same]
    for places in PLACES:
        short = _numbered([[_rounded(entry[key], places) for key in left] for entry in entries], left)
        if widest(short) <= width:
            break
    return [f"{said}rounded, --json FILE has all digits", *short]


def _one(index: int, entry: Mapping[str, Any], keys: Sequence[str]) -> list[str]:
    """A bounce whose numbers have a line each."""
    words = [str(entry[key]) for key in ("component", "status") if key in keys]
    numbers = [key for key in keys if key not in ("component", "status") and entry[key] is not None]
    wide = max(len(key) for key in numbers)
    return [f"bounce {index}: {', '.join(words)}", *(f"  {key.ljust(wide)}  {_exact(entry[key])}" for key in numbers)]


def _numbered(rows: Sequence[Sequence[str]], keys: Sequence[str]) -> list[str]:
    return table(("bounce", *keys), [[str(i), *row] for i, row in enumerate(rows)])


def _exact(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.16g}" if isinstance(value, float) else str(value)


def _rounded(value: Any, places: int) -> str:
    return f"{value:.{places}f}" if isinstance(value, float) else _exact(value)
