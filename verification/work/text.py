"""Rows as a table in text or Markdown, and the facts of a run for its footer."""

import os
from collections.abc import Sequence
from decimal import Decimal

from verification.diagram import duration
from verification.work.row import Row, front

HEAD = ("", "method", "setting", "error", "claims", "time", "spread", "ratio", "")
MARKS = {True: "", False: "!", None: ""}


def table(rows: Sequence[Row], base: Row | None = None) -> list[tuple[str, ...]]:
    """A line for each row: `*` on the Pareto front, `!` where a claim is not kept; ratios to the time of `base`."""
    best, base = front(rows), base or baseline(rows)
    lines: list[tuple[str, ...]] = []
    for row in rows:
        ratio = f"{row.seconds / base.seconds:.3g}" if base and base.seconds else "-"
        claims = "-" if row.promise is None else short(row.promise)
        said = row.failure if row.error is None else short(row.error)
        times = duration(row.seconds), f"{row.spread:.2f}" if row.runs > 1 else "once", ratio
        lines.append(("*" if row in best else "", row.method, row.setting, said, claims, *times, MARKS[row.kept]))
    return lines


def plain(rows: Sequence[Row]) -> str:
    """The table with columns that line up.

    >>> from verification.work.row import timed
    >>> print(plain([timed("q", "kernel", [2e-9], error=Decimal("1e-16"), promise=Decimal("1e-17"), setting="s")]))
       method  setting  error  claims  time  spread  ratio
    *  kernel  s        1e-16  1e-17   2 ns  once    -      !
    """
    lines = [HEAD, *table(rows)]
    wide = [max(len(line[i]) for line in lines) for i in range(len(HEAD))]
    wide[3] = min(wide[3], 48)
    return "\n".join(
        "  ".join(text[:48].ljust(width) for text, width in zip(line, wide, strict=True)).rstrip() for line in lines
    )


def markdown(rows: Sequence[Row], base: Row | None = None) -> str:
    """The same as a table in Markdown."""
    lines = [HEAD, ("---",) * len(HEAD), *table(rows, base)]
    return "\n".join(
        "| " + " | ".join(text.replace("|", "/").replace("*", "\\*") for text in line) + " |" for line in lines
    )


def baseline(rows: Sequence[Row]) -> Row | None:
    """The row that times are compared with: the quickest float64 of this package, at its finest setting."""
    own = [row for row in rows if row.arithmetic == "float64" and not row.textbook and row.error is not None]
    return [row for row in own if row.method == own[0].method][-1] if own else None


def short(number: Decimal) -> str:
    """Two digits of a number that may be no float.

    >>> short(Decimal("1.234e-1000")), short(Decimal("0.02"))
    ('1.2e-1000', '2e-2')
    """
    if number == 0:
        return "0"
    lead, exponent = f"{number:.1e}".split("e")
    return f"{lead.removesuffix('.0')}e{int(exponent)}"


def facts() -> dict[str, str]:
    """Machine, versions, and how busy the machine was, for a footer."""
    from verification.bench import machine_facts

    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    return machine_facts() | {"load": load}


def footer(known: dict[str, str]) -> str:
    """These on one line."""
    return ", ".join(f"{key} {value}" for key, value in known.items())
