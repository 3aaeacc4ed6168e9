"""`pinball figure`: one of the paper's figures, or the data behind it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from verification.cli import DONE
from verification.commands.output import Output, json_option

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.console import Console

    from verification.figures.catalogue import Picture


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
    from verification.figures.catalogue import DRAFT, FULL, pictures

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
    from verification.figures.catalogue import ending
    from verification.figures.sheet import styled

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
