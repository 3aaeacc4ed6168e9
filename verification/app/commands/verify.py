"""`pinball verify`: judge the claims of the paper, and write the report."""

import json
import os
from collections.abc import Collection, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from verification.app.shell.cli import DONE, FAILED
from verification.app.shell.output import Output, json_option, write_whole
from verification.paper.report import report

if TYPE_CHECKING:
    from rich.console import Console

    from verification.paper.report.page import Picture
    from verification.paper.report.verdicts import Result


@click.command(epilog="Example: pinball verify --only 'egg.*' --digits 30")
@click.option("--only", metavar="GLOB", default="*", show_default=True, help="Judge the claims whose id matches.")
@click.option("--digits", type=click.IntRange(1, 10_000), default=15, show_default=True, help="Digits of the values.")
@click.option("--report", "folder", metavar="DIR", default="report", show_default=True, help="Where the report goes.")
@click.option("--figures/--no-figures", default=True, show_default=True, help="Draw the paper's figures in the report.")
@click.option("--work", metavar="FILE", help="Show the diagrams of what `pinball work --json FILE` measured.")
@json_option
def command(only: str, digits: int, folder: str, figures: bool, work: str | None, output: Output) -> int:
    """Is each claim of the paper true? Exit status 1 when one is open."""
    from verification.paper.report import verdicts as claims
    from verification.paper.report.page import diagrams

    wanted = matching(only, [claim.id for claim in claims.catalogue()])
    directory = prepared(folder)
    measured = diagrams(Path(work)) if work is not None else []
    results = []
    with output.progress("Judging", len(wanted)) as step:
        for result in claims.verify(only, digits):
            results.append(result)
            step(result.id)
    pictures = drawn({result.section for result in results}, output) if figures else []
    write_report(directory, results, [*pictures, *measured])
    output.write(report.document(results))
    show(output.console, results)
    output.console.print(f"The report is in {directory / 'report.html'} (and report.md, report.json, report.tex).")
    return FAILED if report.counts(results)["open"] else DONE


def matching(only: str, ids: Sequence[str]) -> list[str]:
    """The ids that match the glob `only`; `ValueError` with the nearest ones when none does.

    >>> matching("egg.*", ["egg.mu", "ellipse.mu"])
    ['egg.mu']
    """
    found = [each for each in ids if fnmatchcase(each, only)]
    if not found:
        near = ", ".join(get_close_matches(only.strip("*"), ids, 3, 0))
        raise ValueError(f"--only {only!r} matches no claim; the nearest are: {near}")
    return found


def prepared(folder: str) -> Path:
    """The report's directory, made; refused before any work is done for it."""
    directory = Path(folder)
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--report {folder!r} cannot be made ({error.strerror}); accepted: a directory") from None
    if not os.access(directory, os.W_OK):
        raise ValueError(f"--report {folder!r} may not be written in; accepted: a directory of yours")
    return directory


def drawn(sections: Collection[str], output: Output) -> "list[Picture]":
    """The figures of those sections, as drafts; none where Matplotlib is missing."""
    from verification.paper.figures.catalogue import pictures
    from verification.paper.report.page import Picture

    if find_spec("matplotlib") is None:
        output.console.print("The report has no figures: Matplotlib is missing; install pinball-billiards[plot].")
        return []
    wanted = [picture for picture in pictures().values() if picture.section in sections]
    found = []
    with output.progress("Drawing", len(wanted)) as step:
        for picture in wanted:
            image = picture.image(picture.data(), ".png")
            found.append(Picture(picture.name, picture.caption, picture.section, image))
            step(picture.name)
    return found


def write_report(directory: Path, results: Sequence["Result"], pictures: "Sequence[Picture]" = ()) -> None:
    """Writes the report as `report.html`, `report.md`, `report.json` and `report.tex`, each at once."""
    from verification.paper.report.markdown import markdown
    from verification.paper.report.page import page
    from verification.paper.report.report import tables

    versions = report.made_with()
    whole = report.document(results) | {"made_with": versions}
    write_whole(directory / "report.html", page(results, versions, pictures))
    write_whole(directory / "report.md", markdown(results, versions))
    write_whole(directory / "report.tex", tables(results))
    write_whole(directory / "report.json", json.dumps(whole, indent=2) + "\n")


def show(console: "Console", results: Sequence["Result"]) -> None:
    """A table of the verdicts, and a line for each claim that is not confirmed."""
    from rich.table import Table

    table = Table("verdict", "claims", "meaning")
    for verdict, number in report.counts(results).items():
        table.add_row(verdict, str(number), report.VERDICTS[verdict])
    console.print(table)
    for result in results:
        if result.verdict.value != "confirmed":
            console.print(f"{result.verdict.value:9}  {result.id}: {result.erratum or result.method}")
