"""`pinball report`: what becomes of this table? One page, useful first and refined in the time given."""

from pathlib import Path

import click

from symbolic.tables.scene import Scene
from verification.app.cli import DONE, Output, json_option
from verification.app.scene import table_options

STEPS = 45  # about; of a bar


@click.command(epilog="Example: pinball report --polar '1 + cos(5*theta)/40' --minutes 2 --out flower.html")
@table_options
@click.option("--out", required=True, metavar="FILE", help="The page; what is kept lies beside it, in FILE.parts.")
@click.option("--minutes", type=float, default=2.0, show_default=True, help="Time for all; asked again, it goes on.")
@click.option("--lam", "interval", default="0:1", show_default=True, metavar="LOW:HIGH", help="The contractions.")
@click.option(
    "--at", default="1/10,1/2,9/10", show_default=True, metavar="LAM,...", help="Where portraits and censuses are made."
)
@click.option("--period", type=click.IntRange(2, 12), default=3, show_default=True, help="The longest searched for.")
@click.option("--digits", type=click.IntRange(5, 200), default=20, show_default=True, help="Of certified events.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--latex", metavar="FILE", help="The same as a LaTeX article.")
@json_option
def command(
    scene: Scene,
    out: str,
    minutes: float,
    interval: str,
    at: str,
    period: int,
    digits: int,
    seed: int,
    latex: str | None,
    output: Output,
) -> int:
    """What becomes of this table as the contraction varies? One page of HTML that needs no network.

    The table and what is proved of it, slap map, portraits, bifurcation diagram, attractors with basins, cycles from
    birth to death with certificates. A report that was stopped goes on when the same command is given again.
    """
    from verification.reports.report import report

    page = Path(out)
    for path in (page, Path(latex) if latex else page):
        if path.is_dir() or not path.parent.is_dir():
            raise ValueError(f"{path} cannot be written; accepted: a file in a directory that is there")
    ends = interval.split(":")
    if len(ends) != 2:
        raise ValueError(f"--lam {interval!r} is no interval; accepted: LOW:HIGH such as 0:1")
    places = tuple(text.strip() for text in at.split(","))
    with output.progress("Reporting", STEPS) as step:
        made = report(
            scene,
            page,
            minutes=minutes,
            lam=(ends[0], ends[1]),
            at=places,
            period=period,
            digits=digits,
            seed=seed,
            latex=latex,
            tick=step,
        )
    output.write(made.document())
    output.console.print(f"{page}: {len(made.sections)} sections, {made.seconds:.0f} s of work")
    if made.left:
        output.console.print(f"left for more time: {', '.join(made.left)}; the same command goes on from here")
    return DONE
