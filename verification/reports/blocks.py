"""The content of a report: sections of words, formulas, tables, figures and certificates, as plain data.

A section is written once and shown in three forms: as a page, as JSON and as LaTeX. For every number it is stated how
it is known: exactly, by a proof in balls, in float64, or from a sample with its error.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import Enum
from math import ceil, floor, isfinite, log10
from typing import Any


class Known(Enum):
    """How a number is known: exactly, by a proof, in float64 or from a sample."""

    EXACT = "exact"
    PROVED = "proved"
    FLOAT = "float64, not proved"
    SAMPLED = "sampled"


@dataclass(frozen=True)
class ShownNumber:
    """A value as text, its error bar or radius if it has one, and how it is known.

    >>> ShownNumber("0.142", "1e-3", Known.SAMPLED).words
    '0.142 ± 1e-3'
    """

    value: str
    error: str = ""
    known: Known = Known.EXACT

    @property
    def words(self) -> str:
        """The value and its error as text."""
        return f"{self.value} ± {self.error}" if self.error else self.value


def solved(value: float, digits: int, error: float = 0.0) -> ShownNumber:
    """A number computed in float64 to `digits` digits; its error is half a unit of the last, or `error` if larger.

    >>> solved(2 / 3, 4).words, solved(0.25, 4, 0.01).words
    ('0.6667 ± 5e-05', '0.25 ± 1e-02')
    """
    unit = 10.0 ** (floor(log10(abs(value))) + 1 - digits) if value else 10.0**-digits
    return ShownNumber(f"{value:.{digits}g}", f"{max(unit / 2, error):.0e}", Known.FLOAT)


def sampled(value: float, error: float, least: float = 5e-6) -> ShownNumber:
    """A sampled number with one digit of its error, which counts as `least` if it is smaller, and no digit beyond.

    >>> sampled(0.57198, 0.03).words, sampled(-0.285951, 5e-17).words
    ('0.57 ± 3e-02', '-0.285951 ± 5e-06')
    """
    if not isfinite(error):
        return ShownNumber(f"{value:.5g}", known=Known.SAMPLED)
    error = float(f"{max(error, least):.0e}")
    return ShownNumber(f"{value:.{max(0, ceil(-log10(error)))}f}", f"{error:.0e}", Known.SAMPLED)


Cell = str | ShownNumber


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of text."""

    text: str


@dataclass(frozen=True)
class Formula:
    """A displayed formula in LaTeX, with a name."""

    name: str
    latex: str
    known: Known = Known.EXACT


@dataclass(frozen=True)
class Listing:
    """A table: caption, column names, rows of cells, and the command that computes it."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    command: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure: the name of its file in the report's folder, what it shows, and the command that draws it.

    `values` are the numbers that are drawn, if they are few.
    """

    name: str
    caption: str
    alt: str
    command: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Certificate:
    """The content of a certificate file, for `pinball check`; `words` or else its name say what it proves."""

    name: str
    document: Mapping[str, Any]
    words: str = ""

    @property
    def title(self) -> str:
        """What it proves."""
        return self.words or str(self.document["name"])


Block = Paragraph | Formula | Listing | Picture | Certificate
KINDS: dict[str, type[Block]] = {
    "words": Paragraph,
    "formula": Formula,
    "table": Listing,
    "figure": Picture,
    "certificate": Certificate,
}


@dataclass(frozen=True)
class Effort:
    """The cost of a question in seconds, and the remaining error of its answer."""

    question: str
    size: str
    seconds: float
    error: str = ""


@dataclass(frozen=True)
class Section:
    """A section: its name and title, its blocks in order, and their costs."""

    name: str
    title: str
    blocks: tuple[Block, ...]
    efforts: tuple[Effort, ...] = ()

    def document(self) -> dict[str, Any]:
        """The section as JSON.

        >>> section = Section("scene", "The scene", (Listing("", ("x",), ((ShownNumber("1"),),)),))
        >>> Section.read(section.document()) == section
        True
        """
        return {
            "name": self.name,
            "title": self.title,
            "blocks": [_said(block) for block in self.blocks],
            "efforts": [asdict(effort) for effort in self.efforts],
        }

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> "Section":
        """The section from its JSON."""
        blocks = tuple(_block(block) for block in given["blocks"])
        return cls(given["name"], given["title"], blocks, tuple(Effort(**each) for each in given["efforts"]))


def costs(efforts: tuple[Effort, ...]) -> Listing:
    """A table of the seconds that each question took in this run, and of the errors of the answers."""
    rows = tuple((each.question, each.size, f"{each.seconds:.2f}", each.error or "-") for each in efforts)
    caption = (
        "What each question cost on this machine, and the error that its answer is left with; later rows of a question "
        "are its refinements."
    )
    return Listing(caption, ("question", "size", "seconds", "error left"), rows)


def _said(block: Block) -> dict[str, Any]:
    kind = next(name for name, each in KINDS.items() if type(block) is each)
    said = {"kind": kind, **block.__dict__}
    if isinstance(block, Formula):
        said["known"] = block.known.value
    if isinstance(block, Listing):
        said["columns"] = list(block.columns)
        said["rows"] = [[_cell_said(cell) for cell in row] for row in block.rows]
    return said


def _cell_said(cell: Cell) -> Any:
    return cell if isinstance(cell, str) else {"value": cell.value, "error": cell.error, "known": cell.known.value}


def _block(given: Mapping[str, Any]) -> Block:
    said = {key: value for key, value in given.items() if key != "kind"}
    if given["kind"] == "formula":
        said["known"] = Known(said["known"])
    if given["kind"] == "table":
        said["columns"] = tuple(said["columns"])
        said["rows"] = tuple(tuple(_cell(cell) for cell in row) for row in said["rows"])
    return KINDS[given["kind"]](**said)


def _cell(given: Any) -> Cell:
    return given if isinstance(given, str) else ShownNumber(given["value"], given["error"], Known(given["known"]))
