"""The census of attractors of the egg: `python benchmarks/census.py [ALPHA] [STEPS] [STARTS] [SEED]`, as Markdown.

Twenty minutes on one core with the numbers that docs/dynamics.md quotes (0.08, 500, 1500, 1).
"""

import sys
from collections.abc import Sequence

import click
from rich.console import Console
from rich.progress import track

from numeric import PinballMap
from symbolic.tables import egg
from verification.named.attractors import Row, branches, row
from verification.named.branches import Branch, End, Event


def table_of_rows(rows: Sequence[Row]) -> str:
    """Ranges of the grid on which the same attractors were seen."""
    lines = ["| lam | attractors | what the starts reach |", "|---|---|---|"]
    first = last = rows[0]
    for here in [*rows[1:], None]:
        if here is not None and _kinds(here) == _kinds(first):
            last = here
            continue
        span = f"{first.lam:.4f}" if first is last else f"{first.lam:.4f} to {last.lam:.4f}"
        lines.append(f"| {span} | {first.attractors} | {_kinds(first)} |")
        if here is not None:
            first = last = here
    return "\n".join(lines)


def _kinds(here: Row) -> str:
    named = [
        f"{m.copies} x {'period ' + str(m.period) if m.period else m.kind.name.lower()} ({m.symmetry})"
        for m in sorted(here.members, key=lambda m: (-m.copies, m.period, m.symmetry))
    ]
    return ", ".join(named) + (", and starts that did not settle" if here.unsettled else "")


def table_of_branches(found: Sequence[Branch]) -> str:
    """Every branch with its ends."""
    lines = ["| period | symmetry | copies | from | event | to | event |", "|---|---|---|---|---|---|---|"]
    for b in sorted(found, key=lambda b: (b.low.lam, b.period)):
        ends = [f"{end.value} | {end.event.name.lower()}{_proof(end)}" for end in (b.low, b.high)]
        lines.append(f"| {b.period} | {b.symmetry} | {b.copies} | {ends[0]} | {ends[1]} |")
    return "\n".join(lines)


def _proof(end: End) -> str:
    return "" if end.proved or end.event is Event.EDGE else " (not proved)"


def main(alpha: str = "0.08", steps: str = "500", starts: str = "1500", seed: str = "1") -> None:
    """Prints both tables."""
    table, map = egg(3).at(alpha=alpha), PinballMap("egg", lam=0, alpha=alpha)
    console = Console(stderr=True)
    lams = [(k + 0.5) / int(steps) for k in range(int(steps))]
    rows = [row(map.at(lam), int(starts), int(seed)) for lam in track(lams, "starts", console=console)]
    click.echo(f"alpha = {alpha}, {steps} contractions, {starts} starts each, seed {seed}\n")
    click.echo(table_of_rows(rows) + "\n")
    click.echo(table_of_branches(list(branches(map, table, rows))))


if __name__ == "__main__":
    main(*sys.argv[1:])
