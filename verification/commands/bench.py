"""`pinball bench`: error against run time, for every arithmetic and every kernel."""

from typing import TYPE_CHECKING, Any

import click

from verification.cli import DONE
from verification.commands.output import Output, json_option

if TYPE_CHECKING:
    from rich.console import Console

    from verification.bench import Row

WIDTH = 72  # characters of the diagram
HEIGHT = 16


@click.command(epilog="Example: pinball bench --scene egg --digits 20 --digits 100 --json bench.json")
@click.option("--scene", "scenes", multiple=True, metavar="TABLE", help="Only these tables; all five if left out.")
@click.option("--digits", multiple=True, type=click.IntRange(10, 1000), help="For mpmath and arb; 20, 100 and 1000.")
@click.option("--runs", type=click.IntRange(1, 1000), default=5, show_default=True, help="The best of how many.")
@click.option("--baselines/--no-baselines", default=True, show_default=True, help="The benchmark folder's own ways.")
@json_option
def command(scenes: tuple[str, ...], digits: tuple[int, ...], runs: int, baselines: bool, output: Output) -> int:
    """Error against run time: each way to bounce, timed for one bounce at lam = 0.95, errors against 40 digits."""
    from verification import bench
    from verification.baselines import baseline_rows

    unknown = [name for name in scenes if name not in bench.SCENES]
    if unknown:
        raise ValueError(f"--scene = {unknown[0]} is no table; accepted: {', '.join(bench.SCENES)}")
    rows: list[Row] = []
    chosen = scenes or tuple(bench.SCENES)
    with output.progress("Measuring", len(chosen)) as step:
        for name in chosen:
            rows += bench.kernel_rows(name, runs)
            rows += baseline_rows(name, runs) if baselines else []
            rows += bench.multiprecision_rows(name, digits or (20, 100, 1000))
            step(name)
    facts = bench.machine_facts()
    output.write({"machine": facts, "rows": [row.as_data() for row in rows]})
    for name in chosen:
        show(output.console, name, [row for row in rows if row.scene == name])
    output.console.print(
        "one core unless said otherwise; " + ", ".join(f"{key} {value}" for key, value in facts.items())
    )
    return DONE


def show(console: "Console", name: str, rows: "list[Row]") -> None:
    """A scene's rows, with ratios to the kernel and a mark on the Pareto front, and the diagram."""
    from verification.bench import frontier

    front, reference = frontier(rows), rows[0].seconds_per_bounce
    shape = ", ".join(f"{key} = {value}" for key, value in _shape(name).items())
    console.print(f"\n{name} {shape}".rstrip())
    console.print("     way                                   time a bounce   ratio     error / 2**-52")
    for i, row in enumerate(rows):
        letter, mark = chr(ord("a") + i), "*" if i in front else " "
        error = "-" if row.error is None else f"{row.error:.3g}"
        way = f"{row.arithmetic} {row.kernel}"
        ratio = row.seconds_per_bounce / reference
        console.print(f"{mark} {letter}  {way:<38}{duration(row.seconds_per_bounce):>13}{ratio:>10.3g}   {error}")
    console.print(diagram(rows))


def duration(seconds: float) -> str:
    """A time in the unit that suits it.

    >>> duration(7.5e-9), duration(2e-3)
    ('7.5 ns', '2 ms')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.2g} ns"


def diagram(rows: "list[Row]") -> str:
    """Letters at the error (upwards) and time (to the right) of each row, both logarithmic."""
    from math import log10

    points = [
        (log10(row.seconds_per_bounce), log10(max(row.error, 1e-40)), chr(ord("a") + i))
        for i, row in enumerate(rows)
        if row.error is not None
    ]
    if not points:
        return ""
    low, high = min(p[0] for p in points), max(p[0] for p in points)
    bottom, top = min(p[1] for p in points), max(p[1] for p in points)
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    for x, y, letter in points:
        column = round((x - low) / max(high - low, 1e-9) * (WIDTH - 1))
        line = round((top - y) / max(top - bottom, 1e-9) * (HEIGHT - 1))
        while canvas[line][column] != " " and column < WIDTH - 1:
            column += 1
        canvas[line][column] = letter
    body = "\n".join(f"  |{''.join(line).rstrip()}" for line in canvas)
    left, right = duration(10**low), duration(10**high)
    return f"  error (log)\n{body}\n  +{'-' * WIDTH}\n   {left}{right:>{WIDTH - len(left)}} a bounce (log)"


def _shape(name: str) -> dict[str, Any]:
    from verification.bench import SCENES

    return dict(SCENES[name])
