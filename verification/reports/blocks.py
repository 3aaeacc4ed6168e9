"""What a report is made of: sections of words, formulas, tables, figures and certificates, as plain data.

A section is written once and shown three times: as a page, as JSON and as LaTeX. Every number says how it is known:
exactly, by a proof in balls, in float64, or from a sample with its error.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import Enum
from math import floor, log10
from typing import Any


class Known(Enum):
    """How a number is known."""

    EXACT = "exact"
    PROVED = "proved"
    FLOAT = "float64, not proved"
    SAMPLED = "sampled"


@dataclass(frozen=True)
class Number:
    """A value as it is shown, its error bar or radius if it has one, and how it is known.

    >>> Number("0.142", "1e-3", Known.SAMPLED).words
    '0.142 ± 1e-3'
    """

    value: str
    error: str = ""
    known: Known = Known.EXACT

    @property
    def words(self) -> str:
        """On one line."""
        return f"{self.value} ± {self.error}" if self.error else self.value


def solved(value: float, digits: int, error: float = 0.0) -> Number:
    """A number that was solved for in float64, to so many digits: it errs by half a unit of the last one, or by more.

    >>> solved(2 / 3, 4).words, solved(0.25, 4, 0.01).words
    ('0.6667 ± 5e-05', '0.25 ± 1e-02')
    """
    unit = 10.0 ** (floor(log10(abs(value))) + 1 - digits) if value else 10.0**-digits
    return Number(f"{value:.{digits}g}", f"{max(unit / 2, error):.0e}", Known.FLOAT)


Cell = str | Number


@dataclass(frozen=True)
class Words:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Formula:
    """A displayed formula in LaTeX, under a name."""

    name: str
    latex: str
    known: Known = Known.EXACT


@dataclass(frozen=True)
class Listing:
    """A table of cells, its caption, and the command that makes it again."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    command: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure: the name of its file among the parts of the report, what it shows, and the command that draws it.

    `values` are the numbers that it draws, where they are few.
    """

    name: str
    caption: str
    alt: str
    command: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Certificate:
    """A certificate file, as `pinball check` reads it."""

    name: str
    document: Mapping[str, Any]


Block = Words | Formula | Listing | Picture | Certificate
KINDS: dict[str, type[Block]] = {
    "words": Words,
    "formula": Formula,
    "table": Listing,
    "figure": Picture,
    "certificate": Certificate,
}


@dataclass(frozen=True)
class Effort:
    """What a question cost: its seconds, and the error that its answer was left with."""

    question: str
    size: str
    seconds: float
    error: str = ""


@dataclass(frozen=True)
class Section:
    """A section by name and title: its blocks in order, and what they cost."""

    name: str
    title: str
    blocks: tuple[Block, ...]
    efforts: tuple[Effort, ...] = ()

    def document(self) -> dict[str, Any]:
        """The section as JSON has it.

        >>> section = Section("scene", "The scene", (Listing("", ("x",), ((Number("1"),),)),))
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
        """The section of a document."""
        blocks = tuple(_block(block) for block in given["blocks"])
        return cls(given["name"], given["title"], blocks, tuple(Effort(**each) for each in given["efforts"]))


def costs(efforts: tuple[Effort, ...]) -> Listing:
    """What each question took in this run, and the error that its answer was left with."""
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
    return given if isinstance(given, str) else Number(given["value"], given["error"], Known(given["known"]))
