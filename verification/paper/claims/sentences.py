"""The sentences of the paper, one by one: each is quoted by a claim, or listed as prose with a reason.

The paper itself is not part of this repository. `printed/sentences/*.toml` lists its sentences in order, each by its
section, its opening words and a digest of its text; with the paper's LaTeX source at hand, `differences` compares.
"""

import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from itertools import zip_longest
from typing import Any

from verification.paper.claims.claim import Claim

PARTS = (
    *("0_abstract", "1_introduction", "2_pinball", "3_ellipse", "4_cardioid"),
    *("5_cuspless", "6_egg", "7_discussion", "A_methods"),
)
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


def inventory() -> list[Sentence]:
    """Every sentence of the paper, in its order, as listed."""
    folder = files("verification.paper.claims") / "printed" / "sentences"
    texts = [(folder / f"{part}.toml").read_text(encoding="utf-8") for part in PARTS]
    return [_sentence(entry) for text in texts for entry in tomllib.loads(text)["sentence"]]


def _sentence(entry: dict[str, Any]) -> Sentence:
    named = {key: tuple(entry.get(key, ())) for key in ("claims", "repeats")}
    return Sentence(**{**entry, **named})


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
