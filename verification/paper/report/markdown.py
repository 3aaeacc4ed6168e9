"""The report as Markdown: summary, errata, then each claim by section of the paper."""

import re
from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING

from verification.paper.report.report import VERDICTS, by_section, counts, errata, place, summary

if TYPE_CHECKING:
    from verification.paper.report.verdicts import Result

SHORT = 90  # characters that stay inside a line
PARAGRAPH = 400  # characters of a proof that are read as a sentence
DIGITS = 60  # digits of a number on a line
WORDS = re.compile(r"[A-Za-z]{2,},? [A-Za-z]{2,}")  # two in a row make a text, not a formula


def markdown(results: Sequence["Result"], versions: Mapping[str, str]) -> str:
    """The whole report: summary, errata, then each claim by section of the paper.

    Two runs differ in the seconds only.
    """
    parts = ["# What the paper says, and what is true", summary(results), _legend(results), *_errata(results)]
    for section, claims in by_section(results):
        parts += [f"## {section}", *(_claim(result) for result in claims)]
    made = ", ".join(f"{name} {number}" for name, number in versions.items())
    parts += ["---", f"Made with {made}."]
    return "\n\n".join(parts) + "\n"


def _legend(results: Sequence["Result"]) -> str:
    rows = [f"| {verdict} | {number} | {VERDICTS[verdict]} |" for verdict, number in counts(results).items()]
    return "\n".join(["| verdict | claims | meaning |", "|---|---:|---|", *rows])


def _errata(results: Iterable["Result"]) -> list[str]:
    wrong = errata(results)
    if not wrong:
        return ["## Errata", "None found."]
    return ["## Errata", *(_erratum(f"{n}. ", result) for n, result in enumerate(wrong, 1))]


def _erratum(marker: str, result: "Result") -> str:
    parts = [f"{place(result)} (`{result.id}`). {_sentence(result.erratum)}", _quote(result.quote), _comparison(result)]
    return marker + _indented("\n\n".join(parts), len(marker)).lstrip()


def _claim(result: "Result") -> str:
    facts = [_comparison(result)]
    if result.value is not None:
        facts.append(_item("value", result.value))
    if result.radius is not None:
        facts.append(f"- within: {result.radius}")
    if result.erratum:
        facts.append(f"- erratum: {_sentence(result.erratum)}")
    facts += [_long("method", result.method), f"- seconds: {result.seconds:.2f}"]
    return "\n\n".join([f"### `{result.id}`: {result.verdict.value}", _quote(result.quote), "\n".join(facts)])


def _comparison(result: "Result") -> str:
    return "\n".join([_item("printed", result.printed), _item("derived", result.derived)])


def _quote(text: str) -> str:
    """The paper's words as a quotation; a bare formula as the LaTeX it is."""
    if "\\" in text and "$" not in text:
        rows = text.replace("\\\\", "\\\\\n").splitlines()
        return _fenced("\n".join(row.strip() for row in rows), "latex")
    return "> " + " ".join(text.split())


def _item(label: str, text: str) -> str:
    """A list item: words as they are, a formula as code, and a long one folded into a block."""
    if not text:
        return f"- {label}: not given"
    if WORDS.search(text):
        return f"- {label}: {_plain(text)}"
    if len(text) <= SHORT:
        fence = "``" if "`" in text else "`"
        return f"- {label}: {fence}{text}{fence}"
    if text.lstrip("+-").replace(".", "", 1).isdigit():
        lines = [text[i : i + DIGITS] for i in range(0, len(text), DIGITS)]
    else:
        lines = _lines(text)
    return _block(label, lines)


def _long(label: str, text: str) -> str:
    """A list item with a sentence; a proof that quotes its polynomials is a block of its own."""
    return f"- {label}: {_sentence(text)}" if len(text) <= PARAGRAPH else _block(label, _lines(text))


def _block(label: str, lines: Iterable[str]) -> str:
    return f"- {label}:\n\n" + _indented(_fenced("\n".join(lines), "text"), 2)


def _lines(text: str) -> list[str]:
    return wrap(text, SHORT, break_long_words=False, break_on_hyphens=False)


def _fenced(text: str, language: str) -> str:
    return f"```{language}\n{text}\n```"


def _indented(text: str, by: int) -> str:
    return "\n".join(" " * by + line if line else line for line in text.split("\n"))


def _plain(text: str) -> str:
    """`text` on one line, with what Markdown would take for emphasis, HTML or a link made plain."""
    return re.sub(r"([*`]|<(?=[A-Za-z/!?])|\](?=\())", r"\\\1", " ".join(text.split()))


def _sentence(text: str) -> str:
    """`text` as a sentence: plain, begun with a capital when it begins with a word, ended by a full stop."""
    text = _plain(text)
    text = text[:1].upper() + text[1:] if re.match(r"[a-z]+ ", text) else text
    return text if text.endswith(".") or not text else f"{text}."
