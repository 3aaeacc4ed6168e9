"""`pinball bench`: error against run time, for every arithmetic and every kernel."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from verification.app.shell.cli import DONE, FAILED
from verification.app.shell.output import Output, json_option

if TYPE_CHECKING:
    from rich.console import Console

    from verification.measure.speed.bench import Row
    from verification.measure.speed.labelled import Accuracy

HEAD = f"     {'way':<38}{'time a bounce':>13}{'ratio':>10}   error / 2**-52"
CASES = f"{'case':<40}{'balls':>6}{'position':>10}{'direction':>11}{'/condition':>19}"


@click.command(epilog="Example: pinball bench --scene egg --digits 20 --digits 100 --json bench.json")
@click.option("--scene", "scenes", multiple=True, metavar="TABLE", help="Only these tables; all five if left out.")
@click.option("--digits", multiple=True, type=click.IntRange(10, 1000), help="For mpmath and arb; 20, 100 and 1000.")
@click.option("--runs", type=click.IntRange(1, 1000), default=5, show_default=True, help="The best of how many.")
@click.option("--baselines/--no-baselines", default=True, show_default=True, help="The benchmark folder's own ways.")
@click.option("--accuracy/--no-accuracy", default=True, show_default=True, help="The errors of labelled hard cases.")
@click.option("--compare", metavar="FILE", help="Say what moved since a run of which FILE is the --json.")
@json_option
def command(
    scenes: tuple[str, ...],
    digits: tuple[int, ...],
    runs: int,
    baselines: bool,
    accuracy: bool,
    compare: str | None,
    output: Output,
) -> int:
    """Error against run time: each way to bounce, timed for one bounce at lam = 0.95.

    Errors of float64 are measured against 50 digits, those of mpmath and arb against a proved enclosure with 30
    digits more than theirs. In the diagrams time grows to the right and error upwards; a capital letter is on the
    Pareto front: no other way is both faster and more exact. With --compare the exit status is 1 when a time, beside
    the others of its run, changed by more than a factor 1.5, or an error grew tenfold.
    """
    from verification.measure.speed import bench, labelled
    from verification.measure.speed.baselines import MISSING, baseline_rows, is_checkout
    from verification.measure.work.compare import earlier, moved, of_bench

    before = earlier(Path(compare)) if compare else []
    unknown = [name for name in scenes if name not in labelled.SCENES]
    if unknown:
        raise ValueError(f"--scene = {unknown[0]} is no table; accepted: {', '.join(labelled.SCENES)}")
    rows: list[Row] = []
    cases: list[Accuracy] = []
    chosen = scenes or tuple(labelled.SCENES)
    with output.progress("Measuring", 3 * len(chosen)) as step:
        for name in chosen:
            step(f"{name}, float64")
            rows += bench.kernel_rows(name, runs)
            rows += baseline_rows(name, runs) if baselines else []
            step(f"{name}, multiprecision")
            rows += bench.multiprecision_rows(name, digits or (20, 100, 1000), runs)
            step(f"{name}, hard cases")
            cases += labelled.accuracy(name) if accuracy else []
    facts = bench.machine_facts()
    measured = [row.as_data() for row in rows]
    changes = moved([row for row in before if row.question in chosen], of_bench(measured)) if compare else []
    document = {"machine": facts, "rows": measured}
    document |= {"accuracy": [case._asdict() | {"error_unit": "2**-52"} for case in cases]}
    output.write(document | ({"moved": changes} if compare else {}))
    for name in chosen:
        show(output.console, name, [row for row in rows if row.scene == name])
    if baselines and not is_checkout():
        output.console.print(f"\n{MISSING}")
    if cases:
        show_cases(output.console, cases)
    output.console.print(
        "\none core unless said otherwise; " + ", ".join(f"{key} {value}" for key, value in facts.items())
    )
    if compare:
        output.console.print(f"\nsince {compare}: " + ("; ".join(changes) or "nothing moved by more than a factor 1.5"))
    return FAILED if changes else DONE


def show(console: "Console", name: str, rows: "list[Row]") -> None:
    """A scene's rows, with ratios to the kernel and a mark on the Pareto front, and two diagrams."""
    from verification.measure.speed.baselines import diagram, duration
    from verification.measure.speed.bench import frontier
    from verification.measure.speed.labelled import SCENES

    front, reference = frontier(rows), rows[0].seconds_per_bounce
    shape = ", ".join(f"{key} = {value}" for key, value in SCENES[name].items())
    console.print(f"\n{name} {shape}".rstrip())
    console.print(HEAD)
    for i, row in enumerate(rows):
        letter, mark = chr(ord("a") + i), "*" if i in front else " "
        error = "-" if row.error is None else f"{row.error:.3g}"
        way, ratio = f"{row.arithmetic} {row.kernel}", row.seconds_per_bounce / reference
        console.print(f"{mark} {letter}  {way:<38}{duration(row.seconds_per_bounce):>13}{ratio:>10.3g}   {error}")
    for title, kept in (("every arithmetic", rows), ("float64 alone", [r for r in rows if r.arithmetic == "float64"])):
        console.print(f"  {title}: error of one bounce (upwards) against its time")
        console.print(diagram([(row.seconds_per_bounce, row.error) for row in kept], front))


def show_cases(console: "Console", cases: "Sequence[Accuracy]") -> None:
    """The errors of the hard cases, and which are beyond 4 and 8 units."""
    console.print("\naccuracy of one bounce in float64, largest errors in units of 2**-52; beyond 4 and 8 marked")
    console.print(CASES)
    for case in cases:
        beyond = case.position > 4 or case.direction > 8
        label = f"{case.scene}, {case.case}"
        errors = f"{case.position:>10.3g}{case.direction:>11.3g}"
        shares = f"{case.position_by_condition:>10.2g}{case.direction_by_condition:>9.2g}"
        console.print(f"{label:<40}{case.balls:>6}{errors}{shares}{' *' if beyond else ''}".rstrip())
