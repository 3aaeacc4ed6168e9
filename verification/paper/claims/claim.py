"""A claim of the paper as printed, and what came of judging it."""

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from importlib.resources import files
from typing import Any, TypeAlias

from flint import arb
from sympy import Expr, Interval, Matrix, Symbol, oo

from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables import table as symbols
from symbolic.tables.formula import parse

LETTERS: dict[str, Symbol] = {name: value for name, value in vars(symbols).items() if isinstance(value, Symbol)}
LETTERS |= {name: Symbol(name, real=True) for name in ("P1", "P2", "rho", "rho1", "rho2")}

Number: TypeAlias = Expr | Callable[[int], arb]
Printed = str | list[str] | list[list[str]]


class Verdict(Enum):
    """What can be said of a claim."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    SUPPORTED = "supported"
    OPEN = "open"


@dataclass(frozen=True)
class Claim:
    """One sentence of the paper, transcribed with its misprints."""

    id: str
    section: str
    quote: str
    kind: str
    printed: Printed
    over: tuple[tuple[str, str], ...] = ()
    base: str = ""

    @property
    def text(self) -> str:
        """What is printed, on one line."""
        if isinstance(self.printed, str):
            return self.printed
        return "[" + ", ".join(row if isinstance(row, str) else f"[{', '.join(row)}]" for row in self.printed) + "]"

    @cached_property
    def formula(self) -> Expr | Matrix:
        """What is printed, as an expression; a list or a table of formulas as a matrix."""
        if isinstance(self.printed, str):
            return parse(self.printed, LETTERS)
        rows = [[row] if isinstance(row, str) else row for row in self.printed]
        return Matrix([[parse(entry, LETTERS) for entry in row] for row in rows])

    @cached_property
    def box(self) -> dict[Symbol, Interval]:
        """The range that the paper states, for the letters whose range is a plain interval or a point."""
        found = {}
        for name, text in self.over:
            interval = parse_interval(text)
            if name in LETTERS and interval is not None:
                found[LETTERS[name]] = interval
        return found


@dataclass(frozen=True)
class Judgement:
    """A finding on what is printed, what is true in its place, and the finding on that.

    `value` is the number of a claim about digits, exact or as balls of as many digits as asked for;
    `evidence` is a sentence that supports a claim which is not proved.
    """

    printed: Finding
    derived: str
    mended: Finding | None = None
    erratum: str = ""
    value: Number | None = None
    evidence: str = ""

    @property
    def verdict(self) -> Verdict:
        """`corrected` needs both halves: what is printed refuted, what is derived proved."""
        if self.printed.outcome is Outcome.PROVED:
            return Verdict.CONFIRMED
        if self.printed.outcome is Outcome.REFUTED:
            return Verdict.CORRECTED if self.mended is not None and self.mended else Verdict.REFUTED
        return Verdict.SUPPORTED if self.evidence else Verdict.OPEN

    def witness(self, claim: Claim) -> dict[Symbol, Expr]:
        """Where a claim that is corrected or refuted fails: a value for each of its letters; else nothing.

        A letter whose printed range is one point has that value, and needs no other mention.
        """
        if self.verdict not in (Verdict.CORRECTED, Verdict.REFUTED):
            return {}
        fixed = {x: next(iter(r)) for x, r in claim.box.items() if not isinstance(r, Interval)}
        return fixed | dict(self.printed.at)


def parse_interval(text: str) -> Interval | None:
    """`"[0, 1)"` or a single number as an interval; None for anything else.

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


def load(table: str) -> list[Claim]:
    """The claims that the paper makes on one table, in its order."""
    text = (files("verification.paper.claims") / "printed" / f"{table}.toml").read_text(encoding="utf-8")
    return [_claim(entry) for entry in tomllib.loads(text)["claim"]]


def _claim(entry: dict[str, Any]) -> Claim:
    return Claim(**{**entry, "over": tuple(entry.get("over", {}).items())})
