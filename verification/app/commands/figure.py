"""`pinball figure`: one of the paper's figures, or the data behind it.

`pinball explore`: a table to play with, on a local page.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from verification.app.shell.cli import DONE
from verification.app.shell.output import Output, json_option

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.console import Console

    from verification.paper.figures.catalogue import Picture

import socket


@click.command(epilog="Example: pinball figure egg-slap --out egg-slap.pdf")
@click.argument("name", required=False)
@click.option("--out", metavar="FILE", help="A .png, .pdf or .svg file; NAME.png in the current folder if left out.")
@click.option("--full", is_flag=True, help="In print quality: minutes, where a draft takes seconds.")
@click.option("--list", "listing", is_flag=True, help="The names, each with the first sentence of its caption.")
@click.option("--all", "everything", is_flag=True, help="Every figure, as PNG files in the folder --out.")
@json_option
def command(name: str | None, out: str | None, full: bool, listing: bool, everything: bool, output: Output) -> int:
    """One of the paper's figures, computed and drawn.

    With --json and without --out only the data are written, and Matplotlib is not needed.
    """
    from verification.paper.figures.catalogue import DRAFT, FULL, pictures

    known = pictures()
    if listing:
        output.write(
            {"figures": [{"name": p.name, "labels": list(p.labels), "caption": p.caption} for p in known.values()]}
        )
        show(output.console, known)
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


def show(console: "Console", known: "Mapping[str, Picture]") -> None:
    """A line for each figure."""
    for picture in known.values():
        console.print(f"{picture.name:<24}{picture.sentence}")


def _picture(known: "Mapping[str, Picture]", name: str | None) -> "Picture":
    if name is None or name not in known:
        raise ValueError(f"NAME = {name or 'missing'} is no figure; accepted: {', '.join(known)}")
    return known[name]


def _files(chosen: "list[Picture]", out: str | None, folder: bool, drawn: bool) -> dict[str, tuple[Path, str]]:
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
    """A live table on a page of this machine: drag the ball, move the contraction, find cycles.

    The page is served on 127.0.0.1 only, until Ctrl-C. It needs pip install 'pinball-billiards[explore]'.
    """
    from verification.app.live.page import serve

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
