"""The catalogue of figures: the paper's caption of each, and the functions that compute and draw it."""

import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from verification.plots.sheet import Panels

DRAFT, FULL = 1.0, 8.0  # resolutions
LINES, HEAVY = 2000, 100_000  # the most points drawn as SVG lines, and the most bytes of such a file
WORDS = {"pm": "+-", "times": "x", "defeq": ":="}  # LaTeX commands as text; others keep their names


class FigureSource(Protocol):
    """A picture to be drawn on demand: a figure of the paper, or a diagram of a measurement."""

    @property
    def name(self) -> str:
        """The name of the picture."""

    @property
    def seconds(self) -> float:
        """The estimated time to draw the picture, in seconds."""

    @property
    def module(self) -> str:
        """The module that draws the picture."""

    def drawn(self) -> bytes:
        """The image, as the bytes of a file in a format that HTML pages show."""


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper: its name, the function that computes its data, and its place in the paper.

    `labels` are those of the paper, empty for a figure that the paper only mentions. The caption is quoted with its
    misprints; `shows` describes the picture. A draft takes about `seconds` to compute.
    """

    name: str
    made_by: str
    labels: tuple[str, ...]
    section: str
    caption: str
    shows: str
    seconds: float = 0.2

    @cached_property
    def _pair(self) -> tuple[Callable[[float], "Panels"], Callable[["Panels"], Any]]:
        found, function = import_module(self.module), self.made_by.rpartition(".")[2]
        return getattr(found, function), getattr(found, f"draw_{function}")

    @property
    def module(self) -> str:
        """The module that computes and draws the figure."""
        return f"verification.paper.figures.{self.made_by.partition('.')[0]}"

    def data(self, fine: float = DRAFT) -> "Panels":
        """The panels at the resolution `fine`, which is 1 for a draft."""
        return self._pair[0](fine)

    def image(self, panels: "Panels", ending: str) -> bytes:
        """The drawn panels as the bytes of a file in the format of `ending`; equal panels give equal bytes."""
        from verification.plots.sheet import image, styled

        with styled():
            return image(self._pair[1](panels), ending)

    def drawn(self) -> bytes:
        """A draft for a page with transparent background: SVG for lines, WebP for many points."""
        from verification.plots.sheet import SMALL

        panels = self.data()
        count = sum(curve.x.size for panel in panels for curve in panel.curves.values())
        if count <= LINES and all(panel.raster is None for panel in panels):
            lines = self._saved(panels, ".svg")
            if len(lines) <= HEAVY:
                return lines
        return self._saved(panels, ".webp", dpi=140, **SMALL)

    def _saved(self, panels: "Panels", ending: str, **form: Any) -> bytes:
        from verification.plots.sheet import encoded, styled

        with styled():
            return encoded(self._pair[1](panels), ending, transparent=True, **form)

    def document(self, panels: "Panels", fine: float) -> dict[str, Any]:
        """The data of the panels, as a JSON object."""
        about = {"figure": self.name, "labels": list(self.labels), "caption": self.caption, "resolution": fine}
        return {**about, "panels": [panel.document() for panel in panels]}

    @property
    def sentence(self) -> str:
        """The first sentence of the caption, for a terminal.

        >>> pictures()["egg-slap"].sentence[:28]
        'Iterates up to the fourth of'
        """
        return plain(self.caption.partition(". ")[0].removesuffix(".") + ".")


def plain(text: str) -> str:
    """LaTeX turned into plain text.

    >>> plain(r"$s_0 \\defeq -\\sqrt{3}/4$ and $\\mu_{\\pm}$ at $\\lambda = 0.3$")
    's_0 := -sqrt(3)/4 and mu_+- at lambda = 0.3'
    """
    text = re.sub(r"\\sqrt\{(\w+)\}", r"sqrt(\1)", text)
    text = re.sub(r"\\([a-z]+)", lambda found: WORDS.get(found[1], found[1]), text)
    return re.sub(r"[${}]", "", text)


@cache
def pictures() -> Mapping[str, PaperFigure]:
    """All figures by name, in the order of the paper.

    >>> pictures()["ellipse-slap"].labels
    ('fig:slap-ellipse',)
    """
    text = (files("verification.paper.figures") / "captions.toml").read_text(encoding="utf-8")
    entries = tomllib.loads(text)["figure"]
    return {entry["name"]: PaperFigure(**{**entry, "labels": tuple(entry["labels"])}) for entry in entries}


def ending(path: Path) -> str:
    """The ending of `path` in lower case; `ValueError` for a format that cannot be written.

    >>> ending(Path("slap.PDF"))
    '.pdf'
    """
    from verification.plots.sheet import FORMATS

    if path.suffix.lower() not in FORMATS:
        known = ", ".join(FORMATS)
        raise ValueError(f"--out = {path} has the ending {path.suffix or 'none'!r}; accepted endings: {known}")
    return path.suffix.lower()
