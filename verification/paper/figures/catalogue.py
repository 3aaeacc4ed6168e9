"""The figures by name: what the paper prints below each, what computes it, and what draws it."""

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
LINES, HEAVY = 2000, 100_000  # points that may be small as lines, and bytes that are not
WORDS = {"pm": "+-", "times": "x", "defeq": ":="}  # of LaTeX; the others are named as they are


class Drawing(Protocol):
    """A picture that is still to be drawn: a figure of the paper, or a diagram of what was measured."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def seconds(self) -> float:
        """What drawing it is said to take."""

    @property
    def module(self) -> str:
        """What draws it, with all that it needs."""

    def drawn(self) -> bytes:
        """The image, of any kind that a page shows."""


@dataclass(frozen=True)
class Picture:
    """A figure: its name, the module and function that compute its data, and its place in the paper.

    `labels` are the paper's own, empty for a figure that it only speaks of; the caption is quoted with its misprints,
    and `shows` says what is to be seen here. A draft for a page takes some `seconds`.
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
        """The module that computes and draws it."""
        return f"verification.paper.figures.{self.made_by.partition('.')[0]}"

    def data(self, fine: float = DRAFT) -> "Panels":
        """The panels at a resolution, 1 for a draft."""
        return self._pair[0](fine)

    def image(self, panels: "Panels", ending: str) -> bytes:
        """The drawn panels as a file of that kind; the same panels give the same bytes."""
        from verification.plots.sheet import image, styled

        with styled():
            return image(self._pair[1](panels), ending)

    def drawn(self) -> bytes:
        """A draft for a page, on no ground so that it may be dark: lines as SVG, many points as WebP."""
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
        """The data as JSON has them."""
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
    """LaTeX as one would type it.

    >>> plain(r"$s_0 \\defeq -\\sqrt{3}/4$ and $\\mu_{\\pm}$ at $\\lambda = 0.3$")
    's_0 := -sqrt(3)/4 and mu_+- at lambda = 0.3'
    """
    text = re.sub(r"\\sqrt\{(\w+)\}", r"sqrt(\1)", text)
    text = re.sub(r"\\([a-z]+)", lambda found: WORDS.get(found[1], found[1]), text)
    return re.sub(r"[${}]", "", text)


@cache
def pictures() -> Mapping[str, Picture]:
    """Every figure, in the order of the paper.

    >>> pictures()["ellipse-slap"].labels
    ('fig:slap-ellipse',)
    """
    text = (files("verification.paper.figures") / "captions.toml").read_text(encoding="utf-8")
    entries = tomllib.loads(text)["figure"]
    return {entry["name"]: Picture(**{**entry, "labels": tuple(entry["labels"])}) for entry in entries}


def ending(path: Path) -> str:
    """What kind of file `path` names; `ValueError` for one that cannot be written.

    >>> ending(Path("slap.PDF"))
    '.pdf'
    """
    from verification.plots.sheet import FORMATS

    if path.suffix.lower() not in FORMATS:
        known = ", ".join(FORMATS)
        raise ValueError(f"--out = {path} has the ending {path.suffix or 'none'!r}; accepted endings: {known}")
    return path.suffix.lower()
