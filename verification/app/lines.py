"""Tables and sentences for people, which fit the terminal that they are printed on."""

import re
import textwrap
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from rich.console import Console

FAR = 1e9  # from here on a number is shown with a power of ten
PLACES = range(6, 1, -1)  # decimals of float64, as many as fit


def console(width: int) -> "Console":
    """A console for people: a terminal breaks lines at words, a file has each sentence on one line."""
    from rich.console import Console

    class Lines(Console):
        def print(self, *objects: Any, **options: Any) -> None:
            if self.is_terminal:
                objects = tuple(wrapped(each, self.width) if isinstance(each, str) else each for each in objects)
            super().print(*objects, **options)

    return Lines(highlight=False, markup=False, soft_wrap=True, width=width)


def on_terminal(text: str, stream: TextIO, width: int) -> str:
    """The text; if the stream is a terminal, it is broken into lines of `width` letters."""
    return wrapped(text, width) if stream.isatty() else text


def wrapped(text: str, width: int) -> str:
    """The text with long lines broken at words; continuation lines are indented, in a table to its last column.

    >>> print(wrapped("egg   a table with three points that is convex", 30))
    egg   a table with three
          points that is convex
    >>> print(wrapped("  proved: one cycle of period 2", 20))
      proved: one cycle
        of period 2
    """
    return "\n".join(part for line in text.split("\n") for part in _wrap_line(line, width))


def _wrap_line(line: str, width: int) -> list[str]:
    if len(line) <= width:
        return [line]
    places = [found.end() for found in re.finditer(r"(?<=\S)  +(?=\S)", line) if found.end() <= width // 2]
    begin = places[-1] if places else len(line) - len(line.lstrip())
    below = " " * (begin if places else begin + 2)
    return textwrap.wrap(
        line[begin:],
        width,
        initial_indent=line[:begin],
        subsequent_indent=below,
        break_long_words=False,
        break_on_hyphens=False,
    )


def table(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table: the names above the rows, each column as wide as its longest text.

    >>> table(("cycle", "stable"), (("2", "yes"), ("12", "no")))
    ['cycle  stable', '2      yes', '12     no']
    """
    wide = [max(map(len, column)) + 2 for column in zip(names, *rows, strict=True)]
    return ["".join(text.ljust(w) for text, w in zip(row, wide, strict=True)).rstrip() for row in (names, *rows)]


def widest(lines: Sequence[str]) -> int:
    """The length of the longest line."""
    return max(map(len, lines), default=0)


def of_bounces(entries: Sequence[Mapping[str, Any]], keys: Sequence[str], width: int) -> list[str]:
    """Lines of text for bounces: one line per bounce with all digits, if that fits `width` letters.

    Otherwise float64 numbers are rounded, and a component or status that all bounces share is printed once; numbers
    with more digits get a line each.

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
    sizes = {key: max((abs(e[key]) for e in entries if isinstance(e[key], float)), default=0.0) for key in left}
    for places in PLACES:
        rows = _numbered([[short(entry[key], places, sizes[key]) for key in left] for entry in entries], left)
        if widest(rows) <= width:
            break
    return [f"{said}rounded, --json FILE has all digits", *rows]


def _one(index: int, entry: Mapping[str, Any], keys: Sequence[str]) -> list[str]:
    """The lines for a bounce whose numbers are printed on one line each."""
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


def short(value: Any, places: int = 6, size: float | None = None) -> str:
    """A number with `places` decimals, or in scientific notation if too small or large; other values as text.

    `size` is the number that decides on the notation, such as the largest of a column; by default the number itself.

    >>> short(0.25), short(-1.5e-9), short(2.5e12), short(0.0), short(None)
    ('0.250000', '-1.50e-09', '2.50e+12', '0.000000', '-')
    """
    if not isinstance(value, float):
        return _exact(value)
    size = abs(value) if size is None else size
    small = size != 0 and not 10.0 ** (1 - places) <= size < FAR
    return f"{value:.{max(places - 4, 0)}e}" if small and isfinite(value) else f"{value:.{places}f}"
