"""The paper, judged: `pinball verify` goes through its claims and writes the report.

`pinball figure` draws its figures, and `pinball explore` opens a table to play with on a local page.
"""

import base64
import json
import os
import re
import socket
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from numeric.lowering.files import write_whole
from symbolic.tables.definition import like
from verification.app.cli import DONE, FAILED, Output, Whole, json_option
from verification.paper.claims.claim import seconds
from verification.paper.report import report
from verification.paper.report.report import codes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.console import Console

    from verification.measure.work.row import WorkDiagram
    from verification.paper.claims.claim import Claim
    from verification.paper.claims.folder import Paper
    from verification.paper.figures.catalogue import PaperFigure as Figure
    from verification.paper.report.page import ReportFigure
    from verification.paper.report.report import Result


@click.command(epilog="Example: pinball figure egg-slap --out egg-slap.pdf")
@click.argument("name", required=False)
@click.option("--out", metavar="FILE", help="A .png, .pdf, .svg or .webp file; or NAME.png in the current folder.")
@click.option("--full", is_flag=True, help="In print quality: minutes, where a draft takes seconds.")
@click.option("--list", "listing", is_flag=True, help="The names, each with the first sentence of its caption.")
@click.option("--all", "everything", is_flag=True, help="Every figure, as PNG files in the folder --out.")
@json_option
def figure_command(
    name: str | None, out: str | None, full: bool, listing: bool, everything: bool, output: Output
) -> int:
    """Computes and draws one of the paper's figures.

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
    """Prints a line for each figure."""
    for picture in known.values():
        console.print(f"{picture.name:<24}{picture.sentence}")


def _picture(known: "Mapping[str, Figure]", name: str | None) -> "Figure":
    if name is None or name not in known:
        wrong = "NAME is missing" if name is None else f"NAME = {name} is no figure"
        raise ValueError(f"{wrong}; accepted: {', '.join(known)}{like(name or '', known)}")
    return known[name]


def _files(chosen: "list[Figure]", out: str | None, folder: bool, drawn: bool) -> dict[str, tuple[Path, str]]:
    """Path and format of each figure's file; a missing folder is refused before anything is computed."""
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
        write_whole(path, image)
    except OSError as error:
        raise ValueError(f"--out = {path} cannot be written: {error.strerror or error}") from None


LOOPBACK = "127.0.0.1"


@click.command(epilog="Example: pinball explore --port 5006")
@click.option("--port", type=Whole(0, 65535), default=0, show_default=True, help="0 for any that is free.")
@click.option("--open/--no-open", "show", default=True, show_default=True, help="Open a browser.")
@json_option
def explore_command(port: int, show: bool, output: Output) -> int:
    """A live table on a page of this machine: drag the particle, move the contraction, find cycles.

    The page is served on 127.0.0.1 only, until Ctrl-C. It needs pip install '.[explore]' in a checkout.
    """
    from verification.app.live import serve

    port = _free(port)
    output.write({"address": f"http://{LOOPBACK}:{port}/"})
    output.console.print(f"The table is at http://{LOOPBACK}:{port}/ until Ctrl-C.")
    serve(port, show)
    return DONE


def _free(port: int) -> int:
    """`port`, or a free port if it is 0; `ValueError` if the port is taken."""
    with socket.socket() as probe:
        try:
            probe.bind((LOOPBACK, port))
        except OSError as error:
            raise ValueError(f"--port {port} cannot be used ({error.strerror}); accepted: a free one, or 0") from None
        return int(probe.getsockname()[1])


@click.command(epilog="Example: pinball claims new my_paper, then pinball verify --claims my_paper")
@click.argument("what", metavar="new|list", type=click.Choice(["new", "list"]))
@click.argument("folder", metavar="[DIR]", required=False)
@click.option("--section", metavar="LABEL", help="List the claims of a section, such as 6.3, 6 or Abstract.")
@json_option
def claims_command(what: str, folder: str | None, section: str | None, output: Output) -> int:
    """Lists the claims of a paper, or creates a folder for those of another paper.

    `list` prints the id and the sentence of each claim, of the paper or of the one in DIR. `new` writes DIR with one
    sentence and its judge as an example to replace: paper.toml (title, authors, where it was printed, its sections, its
    sentences as printed) and judges.py.
    """
    from verification.paper.claims.folder import OWN, begin, paper

    if what == "list":
        claims = chosen((), section, paper(folder or OWN))
        output.write({"claims": [{"id": each.id, "section": each.section, "quote": each.quote} for each in claims]})
        wide = max(len(claim.id) for claim in claims)
        for claim in claims:
            output.console.print(f"{claim.id:<{wide}}  {' '.join(claim.quote.split())}")
        return DONE
    if folder is None or section is not None:
        wrong = "DIR is missing" if folder is None else f"--section {section} is for pinball claims list"
        raise ValueError(f"{wrong}; accepted: pinball claims new DIR")
    written = [str(path) for path in begin(Path(folder))]
    output.write({"written": written})
    output.console.print(f"{' and '.join(written)} are written; pinball verify --claims {folder} judges what they say.")
    return DONE


@click.command(epilog="Example: pinball verify --only 'egg.*' --digits 30")
@click.option(
    "--claims", "source", metavar="DIR", help="Another paper: its folder, or polygons, elastic, laws. Runs its judges."
)
@click.option("--only", metavar="GLOB", multiple=True, help="Judge the claims whose id matches; may be given again.")
@click.option("--section", metavar="LABEL", help="Judge the claims of a section, such as 6.3, 6 or Abstract.")
@click.option("--changed", is_flag=True, help="Judge what depends on changed code; keep the rest of the last report.")
@click.option("--digits", type=Whole(1, 10_000), default=15, show_default=True, help="Digits of the values.")
@click.option("--report", "folder", metavar="DIR", default="report", show_default=True, help="Where the report goes.")
@click.option("--figures/--no-figures", default=True, show_default=True, help="Draw the paper's figures in the report.")
@click.option("--work", metavar="FILE", help="Show the diagrams of what `pinball work --json FILE` measured.")
@click.option("--jobs", type=Whole(1, 1024), help="Processes that judge and draw; one for each core.")
@click.option("-v", "--verbose", is_flag=True, help="A line for each claim as it is judged; so it is in a pipe too.")
@json_option
def command(
    source: str | None,
    only: tuple[str, ...],
    section: str | None,
    changed: bool,
    digits: int,
    folder: str,
    figures: bool,
    work: str | None,
    jobs: int | None,
    verbose: bool,
    output: Output,
) -> int:
    """Is each claim of the paper true? Exit status 1 when one is open.

    --claims DIR judges another paper, whose sentences and judges are in DIR; `pinball claims new DIR` begins one. The
    judges are Python code that this option runs, so use only folders that you trust. Nothing else loads them.

    The report does not depend on --jobs, except for its computing times.
    """
    from verification.paper.claims.folder import OWN, paper
    from verification.paper.report.page import ReportFigure, diagrams, set_claims, set_result

    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # NumPy is not loaded yet; it is the judges that share the cores
    about = paper(source or OWN)
    claims = chosen(only, section, about)
    directory = prepared(folder)
    measured = diagrams(Path(work)) if work is not None else []
    pictured = report.pictures(about) if figures or changed else []
    last = Last.read(directory, claims, digits, pictured) if changed else Last({}, {})
    found = {result.id: result for result in last.results.values()}
    missing = [claim for claim in claims if claim.id not in found]
    if changed:
        output.console.print(f"{len(missing)} of {len(claims)} claims depend on code that has changed.")
    images, sections = dict(last.images), {claim.section for claim in claims}
    wanted: list[Figure | WorkDiagram] = [
        *(each for each in pictured if figures and each.section in sections),
        *measured,
    ]
    drawings = [each for each in wanted if each.name not in images] if drawable(output, wanted) else []
    report.begin(missing, drawings, jobs)
    code = codes(claims, digits, pictured)
    set_claims(claims)
    each_line = verbose or len(claims) <= FEW or not output.console.is_terminal
    costs = {claim.id: claim.seconds for claim in claims} | {each.name: each.seconds for each in drawings}
    with (
        output.progress("Judging", seconds([*missing, *drawings])) as step,
        closing(report.answered(missing, drawings, digits, jobs)) as answers,
    ):
        for answer in answers:
            if isinstance(answer, report.DrawnPicture):
                images[answer.name] = answer.image
                step(f"{len(found)} of {len(claims)} sentences", costs[answer.name])
            else:
                found[answer.id] = answer
                set_result(answer)
                step(f"{len(found)} of {len(claims)} sentences", costs[answer.id])
                if each_line:
                    output.console.print(line_of(answer))
    results = [found[claim.id] for claim in claims]
    shown = [ReportFigure.of(each, images[each.name]) for each in wanted if each.name in images]
    write_report(directory, results, shown, code, about)
    output.write(report.document(results, about.about))
    show(output.console, results, about)
    output.console.print(
        f"The report is in {directory / 'report.html'} (and report.md, report.json, report.tex, letter.tex)."
    )
    return FAILED if report.counts(results)["open"] else DONE


@dataclass(frozen=True)
class Last:
    """The results and images of the last report that still hold, as their code has not changed since."""

    results: "Mapping[str, Result]"
    images: "Mapping[str, bytes]"

    @classmethod
    def read(cls, directory: Path, claims: "Sequence[Claim]", digits: int, figures: "Sequence[Figure]" = ()) -> "Last":
        """The results and images in the directory's report that still hold; empty if it has no report."""
        path = directory / "report.json"
        if not path.is_file():
            return cls({}, {})
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
            before = dict(document.get("code", {}))
            told = {each["id"]: report.Result.from_dict(each) for each in document["claims"]}
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise ValueError(
                f"--changed: {path} is no report ({type(error).__name__}); remove it, or judge without --changed"
            ) from None
        same = {name for name, code in codes(claims, digits, figures).items() if before.get(name) == code}
        page = directory / "report.html"
        shown = IMAGE.findall(page.read_text(encoding="utf-8")) if page.is_file() else []
        images = {name: base64.b64decode(data) for data, name in shown if f"figure {name}" in same}
        return cls({name: result for name, result in told.items() if name in same}, images)


IMAGE = re.compile(r'<img src="data:image/[^;]*;base64,([^"]*)" data-figure="([^"]*)"')


def chosen(only: Sequence[str], section: str | None, about: "Paper") -> "list[Claim]":
    """The claims that --only and --section select; `ValueError` with the accepted ids or sections if there is none."""
    claims = list(about.claims)
    if section is not None:
        known = dict.fromkeys(claim.section for claim in claims)
        there = [name for name in known if within(name, section)]
        if not there:
            labels = ", ".join(label(name) for name in about.sections if name in known)
            raise ValueError(f"--section {section!r} has no claim; accepted: {labels}")
        claims = [claim for claim in claims if claim.section in there]
    ids = [claim.id for claim in claims]
    wanted = {name for glob in only or ("*",) for name in report.matching(glob, ids, "--only")}
    return [claim for claim in claims if claim.id in wanted]


def within(name: str, section: str) -> bool:
    """True if the section called `name` is `section`, or a part of it.

    >>> within("6.3 Period-2 orbits", "6"), within("10 End", "1"), within("Abstract", "abstract")
    (True, False, True)
    """
    number, asked = label(name).lower(), section.strip().lower()
    return asked in (number, name.lower()) or number.startswith(f"{asked}.")


def label(name: str) -> str:
    """The number at the start of a section's name; the whole name if it has no number.

    >>> label("6.3 Period-2 orbits"), label("Abstract"), label("Of the square")
    ('6.3', 'Abstract', 'Of the square')
    """
    return name.split(" ")[0] if report.section_order(name) > (0,) else name


def prepared(folder: str) -> Path:
    """The report's directory, created if missing; `ValueError`, before any work, if it cannot be written."""
    directory = Path(folder)
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--report {folder!r} cannot be made ({error.strerror}); accepted: a directory") from None
    if not os.access(directory, os.W_OK):
        raise ValueError(f"--report {folder!r} may not be written in; accepted: a directory of yours")
    return directory


def drawable(output: Output, wanted: "Sequence[object]") -> bool:
    """True if Matplotlib is installed; if it is not, but pictures are wanted, prints a line that says so."""
    if not wanted or find_spec("matplotlib") is not None:
        return True
    output.console.print(
        "The report has no figures: Matplotlib is missing; install it with: pip install '.[plot]' in a checkout."
    )
    return False


def write_report(
    directory: Path,
    results: Sequence["Result"],
    pictures: "Sequence[ReportFigure]" = (),
    code: "Mapping[str, str] | None" = None,
    about: "Paper | None" = None,
) -> None:
    """Writes `report.html`, `report.md`, `report.json`, `report.tex` and `letter.tex`, each replaced as a whole.

    `code` has digests of the code on which the results depend, for a later run with `--changed`.
    """
    from verification.paper.claims.folder import paper
    from verification.paper.report.findings import letter, tables
    from verification.paper.report.page import markdown, page

    versions, about = report.made_with(), about or paper()
    whole = report.document(results, about.about) | {"made_with": versions, "code": dict(code or {})}
    write_whole(directory / "report.html", page(results, versions, pictures, about))
    write_whole(directory / "report.md", markdown(results, versions, about))
    write_whole(directory / "report.tex", tables(results, about.sections))
    write_whole(directory / "letter.tex", letter(results, about))
    write_whole(directory / "report.json", json.dumps(whole, indent=2) + "\n")


FEW = 12  # up to so many claims, each has a line
SHOWN = 6  # substantial corrections on the terminal


def line_of(result: "Result") -> str:
    """The line for a claim: its verdict, and what is wrong with the claim or why it is not proved."""
    said = "" if result.verdict.value == "confirmed" else f": {result.erratum or result.method}"
    return f"{result.verdict.value:9}  {result.id}{said}"


def show(console: "Console", results: Sequence["Result"], about: "Paper") -> None:
    """Prints how many claims have each verdict, and the first substantial corrections as sentences."""
    from verification.paper.report.findings import graded

    console.print(report.summary(results))
    grave = [each.text for each in graded(results, about)["substantial"]] if len(results) > FEW else []
    for text in grave[:SHOWN]:
        console.print(f"- {text}")
    if len(grave) > SHOWN:
        console.print(f"- and {len(grave) - SHOWN} more substantial corrections")
