"""`pinball report`: one page on the dynamics of a table, which is soon useful, and refined in the time given."""

from functools import wraps
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from numeric.lowering.files import json_text, write_whole
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, EXTRAS, FAILED, Output, Whole, json_option
from verification.app.scene import Command, varied_options

STEPS = 45  # about, of the progress bar
NEEDED = "matplotlib", "xarray"  # by its pictures and grids, which come after some work


def as_shape(command: Command) -> Command:
    """Decorator that takes `--vary NAME=LOW:HIGH` as another way to write `--shape NAME=LOW:HIGH`."""

    @wraps(command)
    def called(vary: str | None, given: tuple[str, ...], **others: Any) -> Any:
        return command(given=given if vary is None else (*given, vary), **others)

    return called


def varied(text: str) -> tuple[str, str, str]:
    """The parameter that varies, and the ends of its interval, as text.

    >>> varied("b=0:1/30")
    ('b', '0', '1/30')
    """
    name, equals, ends = (part.strip() for part in text.partition("="))
    low, colon, high = (part.strip() for part in ends.partition(":"))
    if not equals or not colon or ":" in high:
        raise ValueError(f"--vary {text} is no interval; accepted: NAME=LOW:HIGH")
    return name, low, high


def needed() -> None:
    """Raises `ValueError`, before any work, if a package that a report needs is missing, and says how to install it."""
    absent = [name for name in NEEDED if find_spec(name) is None]
    if absent:
        extras = ",".join(EXTRAS[name] for name in NEEDED)
        are = f"{' and '.join(absent)} {'is' if len(absent) == 1 else 'are'} missing"
        raise ValueError(f"report: {are}; install what it needs with: pip install '.[{extras}]' in a checkout")


@click.command(epilog="Example: pinball report --polar '1 + cos(5*theta)/40' --minutes 2 --out flower.html")
@click.option(
    "--vary",
    metavar="NAME=LOW:HIGH",
    help="Vary a parameter of the table or law, with the contractions of --lam or at one contraction.",
)
@as_shape
@varied_options
@click.option(
    "--out",
    default="report",
    show_default=True,
    metavar="PATH",
    help="The page, FILE.html; or a folder for report.html, report.json, report.tex. Parts are kept beside the page.",
)
@click.option("--minutes", type=float, default=2.0, show_default=True, help="Time for all; asked again, it goes on.")
@click.option(
    "--lam", "interval", default="0:1", show_default=True, metavar="LOW:HIGH", help="Contractions; or one, with --vary."
)
@click.option(
    "--at", default="1/10,1/2,9/10", show_default=True, metavar="LAM,...", help="Where portraits and censuses are made."
)
@click.option(
    "--period",
    type=Whole(2, 12),
    default=3,
    show_default=True,
    help="The longest of saddles whose tangencies are sought.",
)
@click.option("--digits", type=Whole(5, 200), default=20, show_default=True, help="Of certified events.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--latex", metavar="FILE", help="The same as a LaTeX article.")
@click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do the grids, or else all cores.")
@json_option
def command(
    scene: Scene,
    axis: str | None,
    out: str,
    minutes: float,
    interval: str,
    at: str,
    period: int,
    digits: int,
    seed: int,
    latex: str | None,
    scheduler: str | None,
    output: Output,
) -> int:
    """What becomes of this table as the contraction varies? One page of HTML that needs no network.

    Every family of cycles that attracts random starts, from birth to death, with events and certificates; attractors
    with basins; what may be missing; the table and what is proved about it, slap map, portraits. With --vary
    NAME=LOW:HIGH also the plane of that parameter and the contraction, shaded by exponent, with the curves of events.
    The same command resumes a report that was stopped.
    """
    needed()
    from numeric.sweeps.run import UnfinishedError
    from verification.reports.page import further
    from verification.reports.report import report

    page, folder = Path(out), Path(out).suffix != ".html"
    for path in (page, Path(latex) if latex else page):
        if not path.parent.is_dir() or (path.is_dir() and not (folder and path == page)):
            raise ValueError(f"{path} cannot be written; accepted: a file in a directory that is there")
    if folder:
        if page.is_file():
            raise ValueError(f"--out {page} is a file; accepted: a folder, or a page whose name ends in .html")
        page, latex = page / "report.html", latex or str(page / "report.tex")
    single = axis is not None and ":" not in interval
    if not single and interval.count(":") != 1:
        raise ValueError(
            f"--lam {interval} is no interval; accepted: LOW:HIGH such as 0:1; with --vary, one number too"
        )
    lams = interval.strip() if single else tuple(end.strip() for end in interval.split(":"))
    places = tuple(text.strip() for text in at.split(","))
    with output.progress("Reporting", STEPS) as step:
        try:
            made = report(
                scene,
                page,
                minutes=minutes,
                lam=lams,
                vary=None if axis is None else varied(axis),
                at=places,
                period=period,
                digits=digits,
                seed=seed,
                latex=latex,
                scheduler=scheduler,
                tick=step,
            )
        except (UnfinishedError, KeyboardInterrupt) as stop:
            reason = str(stop).partition(";")[0] or "interrupted"  # the rest is about sweeps without a store
            said = f"{reason}; what was done is in {page}, and the same command goes on"
            if isinstance(stop, KeyboardInterrupt):
                raise KeyboardInterrupt(said) from None
            click.echo(f"pinball: {said}", err=True)
            return FAILED
    output.write(made.document())
    if folder:
        write_whole(page.with_suffix(".json"), json_text(made.document(), indent=1))
    output.console.print(f"{page}: {len(made.sections)} sections, {made.seconds:.0f} s of work")
    if made.left:
        words = further(made.left)
        output.console.print(f"left for more time, or to be refined: {words}; the same command continues")
    return DONE
