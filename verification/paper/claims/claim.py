"""A claim of a paper as printed, what came of judging it, and the list of the paper's sentences.

Each sentence that a folder lists is quoted by a claim, or is prose with a reason. The paper itself is not kept: the
list has its sentences in order, each by its section, its opening words and a digest of its text; with the paper's LaTeX
source at hand, `differences` compares.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from hashlib import sha256
from itertools import zip_longest
from typing import Any, Protocol, TypeAlias

from flint import arb
from sympy import Expr, Interval, Matrix, Symbol, oo

from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables import table as symbols
from symbolic.tables.formula import parse

LETTERS: dict[str, Symbol] = {name: value for name, value in vars(symbols).items() if isinstance(value, Symbol)}

Number: TypeAlias = Expr | Callable[[int], arb]
Printed = str | list[str] | list[list[str]]


class Verdict(Enum):
    """What can be said of a claim."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    SUPPORTED = "supported"
    OPEN = "open"


class Costing(Protocol):
    """A claim to be judged or a picture to be drawn."""

    @property
    def seconds(self) -> float:
        """What that is said to take."""


def seconds(items: Iterable[Costing]) -> float:
    """What judging claims and drawing pictures is said to take."""
    return sum(each.seconds for each in items)


@dataclass(frozen=True)
class Claim:
    """One sentence of a paper, transcribed with its misprints.

    `letters` are those of the paper's formulas beside the letters of tables and laws; `home` is the module that judges
    it, by its dotted name or, outside this package, by its path. What judging takes, and the seconds that it spares
    others by its results, say who does what first. `unsettled` says why it is not settled, as long as it is not.
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
        """The letters that its formulas may have."""
        return LETTERS | {name: Symbol(name, real=True) for name in self.letters}

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
            return parse(self.printed, self.names)
        rows = [[row] if isinstance(row, str) else row for row in self.printed]
        return Matrix([[parse(entry, self.names) for entry in row] for row in rows])

    @cached_property
    def box(self) -> dict[Symbol, Interval]:
        """The range that the paper states, for the letters whose range is a plain interval or a point."""
        found = {}
        for name, text in self.over:
            interval = parse_interval(text)
            if name in self.names and interval is not None:
                found[self.names[name]] = interval
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
            return Verdict.CORRECTED if self.mended else Verdict.REFUTED
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


LEFT_OUT = re.compile(r"\s*(?:\\label\{[^}]*\}|\\(?:begin|end)\{(?:equation|eqnarray)\}|\\fl\b|\\ams\{.*\})\s*")
COMMENT = re.compile(r"(?<!\\)%.*\n?")
FIGURE = re.compile(r"\\begin\{figure\}(.*?)\\end\{figure\}", re.DOTALL)
HEADING = re.compile(r"\\(section|subsection|appendix|ack|begin\{abstract\})(?:\{((?:[^{}]|\{[^{}]*\})*)\})?")
ENDS = re.compile(r"(?<=[.?!])\)?\s+|\n\s*\n")


@dataclass(frozen=True)
class Sentence:
    """One sentence of the paper, by its opening words, and what becomes of it: exactly one of the last three."""

    section: str
    opens: str
    digest: str
    claims: tuple[str, ...] = ()
    repeats: tuple[str, ...] = ()
    prose: str = ""

    @property
    def fates(self) -> int:
        """How many of its fates are given: it must be one."""
        return sum(map(bool, (self.claims, self.repeats, self.prose)))

    @classmethod
    def from_dict(cls, entry: dict[str, Any]) -> "Sentence":
        """A table of a folder's list."""
        named = {key: tuple(entry.get(key, ())) for key in ("claims", "repeats")}
        return cls(**{**entry, **named})


def normalised(text: str) -> str:
    r"""A text without comments, labels and figures, on one line.

    >>> normalised("a table % not this\n with   $a=1$.\\label{eq:x}")
    'a table with $a=1$.'
    """
    return " ".join(LEFT_OUT.sub(" ", COMMENT.sub("", text)).split())


def digest(sentence: str) -> str:
    """The first twelve hexadecimal digits of the SHA-256 of a normalised sentence."""
    return sha256(normalised(sentence).encode()).hexdigest()[:12]


def split(paper: str) -> Iterator[tuple[str, str]]:
    r"""Section numbers and sentences of a LaTeX source, in order; a caption counts as a paragraph.

    A sentence ends at a full stop before a space that is not `\ `, or with its paragraph.

    >>> list(split(r"\begin{abstract}One, i.e.\ 1. Two.\end{abstract} \section{A} Three. \subsection{B} Four"))
    [('Abstract', 'One, i.e.\\ 1.'), ('Abstract', 'Two.'), ('1', 'Three.'), ('1.1', 'Four')]
    """
    body = paper[paper.index(r"\begin{abstract}") :].partition(r"\section*")[0]
    section, number, letters = "", [0, 0], False
    found = list(HEADING.finditer(body))
    for heading, following in zip_longest(found, found[1:]):
        kind = heading[1]
        if kind == "appendix":
            number, letters = [0, 0], True
            continue
        if kind in ("section", "subsection"):
            number = [number[0] + 1, 0] if kind == "section" else [number[0], number[1] + 1]
            first = "ABC"[number[0] - 1] if letters else str(number[0])
            section = f"{first}.{number[1]}" if number[1] else first
        else:
            section = "Acknowledgements" if kind == "ack" else "Abstract"
        text = body[heading.end() : following.start() if following else len(body)]
        for sentence in _sentences(text):
            yield section, sentence


def _sentences(text: str) -> Iterator[str]:
    """The sentences of a section; a displayed formula belongs to its sentence, unless a capital letter follows."""
    text = FIGURE.sub(lambda figure: f"\n\n{caption(figure[1])}\n\n", COMMENT.sub("", text))
    text = re.sub(r"\\(begin|end)\{(abstract|document)\}", "", text)
    text = re.sub(r"\\end\{(equation|eqnarray)\}\s*(?=[A-Z])", "\n\n", text)
    for piece in ENDS.sub(lambda end: f"{end[0].strip()}\n\n", LEFT_OUT.sub(" ", text)).split("\n\n"):
        if re.search(r"[A-Za-z]", piece):
            yield normalised(piece)


def caption(figure: str) -> str:
    r"""The text of a figure's caption, between balanced braces.

    >>> caption(r"\includegraphics{x.pdf} \caption{The map $T_{0}$.} \label{fig:x}")
    'The map $T_{0}$.'
    """
    start = figure.index(r"\caption{") + len(r"\caption{")
    depth, end = 1, start
    while depth:
        depth += {"{": 1, "}": -1}.get(figure[end], 0)
        end += 1
    return figure[start : end - 1]


def defects(listed: list[Sentence], claims: list[Claim]) -> list[str]:
    """What is wrong with the list by itself, without the paper; nothing, when it is in order."""
    known = {claim.id: claim for claim in claims}
    quoted = {name for sentence in listed for name in sentence.claims}
    found = [f"{name} stands under no sentence" for name in known if name not in quoted]
    for sentence in listed:
        where = f"{sentence.section}: {sentence.opens!r}"
        if sentence.fates != 1:
            found.append(f"{where} needs one of claims, repeats, prose, not {sentence.fates}")
        found += [f"{where} names {name}, which is no claim" for name in _named(sentence) if name not in known]
        strangers = [name for name in sentence.claims if name in known and not _within(known[name], sentence)]
        found += [f"{where} lists {name}, which quotes another section" for name in strangers]
    return found


def _named(sentence: Sentence) -> Iterable[str]:
    return (*sentence.claims, *sentence.repeats)


def _within(claim: Claim, sentence: Sentence) -> bool:
    """A claim says its section by number and title, a sentence by number alone."""
    return claim.section.split()[0] == sentence.section


def differences(paper: str, listed: list[Sentence], claims: list[Claim]) -> list[str]:
    """Where the list and the paper part: a sentence too many, one too few, another text, a quote that is not there."""
    found, texts = [], []
    for printed, sentence in zip_longest(split(paper), listed):
        if printed is None or sentence is None:
            found.append(f"no sentence {sentence.opens!r}" if sentence else f"not listed: {printed[1][:60]!r}")
            continue
        section, text = printed
        texts.append(text)
        if (section, digest(text)) != (sentence.section, sentence.digest) or not text.startswith(sentence.opens):
            found.append(f"{section}: {text[:60]!r} is not the sentence listed, {sentence.opens!r}")
    return found or [problem for claim in claims if (problem := _misquoted(claim, texts, listed))]


def _misquoted(claim: Claim, texts: list[str], listed: list[Sentence]) -> str:
    """A quote may leave words out (` ... `) and run over sentences; each sentence listed must hold a piece of it."""
    under = [text for text, sentence in zip(texts, listed, strict=True) if claim.id in sentence.claims]
    starts = [sum(len(text) + 1 for text in under[:n]) for n in range(len(under))]
    whole, at, spans = " ".join(under), 0, []
    for piece in map(normalised, claim.quote.split(" ... ")):
        at = whole.find(piece, at)
        if at < 0:
            return f"{claim.id}: {piece!r} is not in the sentences that it is listed under"
        spans.append((at, at + len(piece)))
        at += len(piece)
    for start, text in zip(starts, under, strict=True):
        if not any(low < start + len(text) and start < high for low, high in spans):
            return f"{claim.id} quotes nothing of {text[:60]!r}"
    return ""
