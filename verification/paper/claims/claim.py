"""A claim of a paper as printed, and the judgement on it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import Protocol, TypeAlias

from flint import arb
from sympy import Expr, Interval, Matrix, Symbol, oo

from symbolic.expressions.signs import Outcome, SignFinding
from symbolic.tables import table as symbols
from symbolic.tables.formula import parse

LETTERS: dict[str, Symbol] = {name: value for name, value in vars(symbols).items() if isinstance(value, Symbol)}

Number: TypeAlias = Expr | Callable[[int], arb]
Printed = str | list[str] | list[list[str]]


class Verdict(Enum):
    """The verdict on a claim: proved as printed, corrected, refuted, supported by evidence, or open."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    SUPPORTED = "supported"
    OPEN = "open"


class Costing(Protocol):
    """Anything with an estimate of its computing time: a claim or a picture."""

    @property
    def seconds(self) -> float:
        """The estimated time to judge the claim or draw the picture."""


def seconds(items: Iterable[Costing]) -> float:
    """The estimated seconds to judge claims and draw pictures, in total."""
    return sum(each.seconds for each in items)


@dataclass(frozen=True)
class Claim:
    """One sentence of a paper, transcribed with its misprints.

    `letters` are the symbols of the paper's formulas besides those of tables and laws. `home` is the module that judges
    the claim, as a dotted name or, outside this package, as a path. `seconds` is the time to judge it, and `spares` the
    time that its results save other claims; both serve to order the work. `unsettled` is the reason why the claim is
    not settled.
    """

    id: str
    section: str
    quote: str
    kind: str
    printed: Printed
    over: tuple[tuple[str, str], ...] = ()
    base: str = ""
    letters: tuple[str, ...] = ()
    home: str = field(default="", repr=False)
    seconds: float = field(default=1.0, repr=False, compare=False)
    spares: tuple[tuple[str, float], ...] = field(default=(), repr=False, compare=False)
    unsettled: str = field(default="", repr=False, compare=False)

    @cached_property
    def names(self) -> dict[str, Symbol]:
        """The symbols that the formulas may contain, by name."""
        return LETTERS | {name: Symbol(name, real=True) for name in self.letters}

    @property
    def text(self) -> str:
        """The printed text on one line."""
        if isinstance(self.printed, str):
            return self.printed
        return "[" + ", ".join(row if isinstance(row, str) else f"[{', '.join(row)}]" for row in self.printed) + "]"

    @cached_property
    def formula(self) -> Expr | Matrix:
        """The printed text as a formula; a list or a table of formulas as a matrix."""
        if isinstance(self.printed, str):
            return parse(self.printed, self.names)
        rows = [[row] if isinstance(row, str) else row for row in self.printed]
        return Matrix([[parse(entry, self.names) for entry in row] for row in rows])

    @cached_property
    def box(self) -> dict[Symbol, Interval]:
        """The range that the paper states for each symbol, if it is a plain interval or a point."""
        found = {}
        for name, text in self.over:
            interval = parse_interval(text)
            if name in self.names and interval is not None:
                found[self.names[name]] = interval
        return found


@dataclass(frozen=True)
class Judgement:
    """The finding on the printed claim, the derived statement, and the finding on the corrected claim (`mended`).

    `value` is the number of a claim about digits: exact, or a function from a number of digits to a ball. `evidence` is
    a sentence that supports a claim which is not proved.
    """

    printed: SignFinding
    derived: str
    mended: SignFinding | None = None
    erratum: str = ""
    value: Number | None = None
    evidence: str = ""

    @property
    def verdict(self) -> Verdict:
        """The verdict; `corrected` requires that the printed claim is refuted and the derived one proved."""
        if self.printed.outcome is Outcome.PROVED:
            return Verdict.CONFIRMED
        if self.printed.outcome is Outcome.REFUTED:
            return Verdict.CORRECTED if self.mended else Verdict.REFUTED
        return Verdict.SUPPORTED if self.evidence else Verdict.OPEN

    def witness(self, claim: Claim) -> dict[Symbol, Expr]:
        """A counterexample to a corrected or refuted claim: a value for each symbol; empty for other verdicts.

        A symbol whose printed range is one point has this value.
        """
        if self.verdict not in (Verdict.CORRECTED, Verdict.REFUTED):
            return {}
        fixed = {x: next(iter(r)) for x, r in claim.box.items() if not isinstance(r, Interval)}
        return fixed | dict(self.printed.at)


def parse_interval(text: str) -> Interval | None:
    """The interval of a text such as `"[0, 1)"` or of a single number; None for any other text.

    >>> parse_interval("[1, oo)"), parse_interval("0.08")
    (Interval(1, oo), {2/25})
    """
    try:
        if text[:1] in "[(" and text[-1:] in "])" and text.count(",") == 1:
            low, high = (end.strip() for end in text[1:-1].split(","))
            top = oo if high == "oo" else parse(high, {})
            return Interval(parse(low, {}), top, text[0] == "(", text[-1] == ")")
        point = parse(text, {})
        return Interval(point, point)
    except ValueError:
        return None
