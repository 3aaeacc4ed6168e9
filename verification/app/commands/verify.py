"""The paper, judged: `pinball verify` goes through its claims and writes the report.

`pinball figure` draws its figures, and `pinball explore` opens a table to play with on a local page.
"""

import json
import os
import socket
from collections.abc import Collection, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from verification.app.cli import DONE, FAILED, Output, json_option, write_whole
from verification.paper.report import report

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.console import Console

    from verification.paper.figures.catalogue import Picture as Figure
    from verification.paper.report.page import Picture
    from verification.paper.report.report import Result


@click.command(epilog="Example: pinball figure egg-slap --out egg-slap.pdf")
@click.argument("name", required=False)
@click.option("--out", metavar="FILE", help="A .png, .pdf or .svg file; NAME.png in the current folder if left out.")
@click.option("--full", is_flag=True, help="In print quality: minutes, where a draft takes seconds.")
@click.option("--list", "listing", is_flag=True, help="The names, each with the first sentence of its caption.")
@click.option("--all", "everything", is_flag=True, help="Every figure, as PNG files in the folder --out.")
@json_option
def figure_command(
    name: str | None, out: str | None, full: bool, listing: bool, everything: bool, output: Output
) -> int:
    """One of the paper's figures, computed and drawn.

    With --json and without --out only the data are written, and Matplotlib is not needed.
    """
    from verification.paper.figures.catalogue import DRAFT, FULL, pictures

    known = pictures()
    if listing:
        output.write(
            {"figures": [{"name": p.name, "labels": list(p.labels), "caption": p.caption} for p in known.values()]}
        )
        show_figure(output.console, known)
        return DONE
    if everything and name is not None:
        raise ValueError(f"{name} and --all: name one figure, or ask for all")
    chosen = list(known.values()) if everything else [_picture(known, name)]
    files = _files(chosen, out, everything, drawn=out is not None or output.path is None)
    documents: list[dict[str, Any]] = []
    with output.progress("Drawing", len(chosen)) as step:
        for picture in chosen:
            panels = picture.data(FULL if full else DRAFT)
            if picture.name in files:
                path, ending = files[picture.name]
                _write(path, picture.image(panels, ending))
                output.console.print(f"{path}: {picture.sentence}")
            if output.path is not None:
                documents.append(picture.document(panels, FULL if full else DRAFT))
            step(picture.name)
    output.write({"figures": documents} if everything else documents[0] if documents else {})
    return DONE


def show_figure(console: "Console", known: "Mapping[str, Figure]") -> None:
    """A line for each figure."""
    for picture in known.values():
        console.print(f"{picture.name:<24}{picture.sentence}")


def _picture(known: "Mapping[str, Figure]", name: str | None) -> "Figure":
    if name is None or name not in known:
        raise ValueError(f"NAME = {name or 'missing'} is no figure; accepted: {', '.join(known)}")
    return known[name]


def _files(chosen: "list[Figure]", out: str | None, folder: bool, drawn: bool) -> dict[str, tuple[Path, str]]:
    """Where each figure goes, and as what; refused before anything is computed."""
    from verification.paper.figures.catalogue import ending
    from verification.plots.sheet import styled

    if not drawn:
        return {}
    with styled():  # is Matplotlib there?
        pass
    target = Path(out or ".") if folder else Path(out or f"{chosen[0].name}.png")
    home = target if folder else target.parent
    if not home.is_dir():
        raise ValueError(f"--out = {out}: there is no folder {str(home)!r}; create it first")
    paths = [target / f"{picture.name}.png" for picture in chosen] if folder else [target]
    return {picture.name: (path, ending(path)) for picture, path in zip(chosen, paths, strict=True)}


def _write(path: Path, image: bytes) -> None:
    try:
        path.write_bytes(image)
    except OSError as error:
        raise ValueError(f"--out = {path} cannot be written: {error.strerror or error}") from None


LOOPBACK = "127.0.0.1"


@click.command(epilog="Example: pinball explore --port 5006")
@click.option("--port", type=click.IntRange(0, 65535), default=0, show_default=True, help="0 for any that is free.")
@click.option("--open/--no-open", "show", default=True, show_default=True, help="Open a browser.")
@json_option
def explore_command(port: int, show: bool, output: Output) -> int:
    """A live table on a page of this machine: drag the particle, move the contraction, find cycles.

    The page is served on 127.0.0.1 only, until Ctrl-C. It needs pip install 'pinball-billiards[explore]'.
    """
    from verification.app.live import serve

    port = _free(port)
    output.write({"address": f"http://{LOOPBACK}:{port}/"})
    output.console.print(f"The table is at http://{LOOPBACK}:{port}/ until Ctrl-C.")
    serve(port, show)
    return DONE


def _free(port: int) -> int:
    """`port`, or any free one for 0; `ValueError` when it is taken."""
    with socket.socket() as probe:
        try:
            probe.bind((LOOPBACK, port))
        except OSError as error:
            raise ValueError(f"--port {port} cannot be used ({error.strerror}); accepted: a free one, or 0") from None
        return int(probe.getsockname()[1])


@click.command(epilog="Example: pinball verify --only 'egg.*' --digits 30")
@click.option("--only", metavar="GLOB", default="*", show_default=True, help="Judge the claims whose id matches.")
@click.option("--digits", type=click.IntRange(1, 10_000), default=15, show_default=True, help="Digits of the values.")
@click.option("--report", "folder", metavar="DIR", default="report", show_default=True, help="Where the report goes.")
@click.option("--figures/--no-figures", default=True, show_default=True, help="Draw the paper's figures in the report.")
@click.option("--work", metavar="FILE", help="Show the diagrams of what `pinball work --json FILE` measured.")
@json_option
def command(only: str, digits: int, folder: str, figures: bool, work: str | None, output: Output) -> int:
    """Is each claim of the paper true? Exit status 1 when one is open."""
    from verification.paper.report.page import diagrams

    wanted = matching(only, [claim.id for claim in report.catalogue()])
    directory = prepared(folder)
    measured = diagrams(Path(work)) if work is not None else []
    results = []
    with output.progress("Judging", len(wanted)) as step:
        for result in report.verify(only, digits):
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
    from verification.paper.report.page import markdown, page
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
