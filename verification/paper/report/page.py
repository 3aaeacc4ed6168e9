"""The report for people: one page of HTML that needs no network, and the same as Markdown.

Formulas are MathML; figures and script are inside the page, and the work-precision diagrams from what `pinball work
--json FILE` measured. The Markdown has the summary, the errata, then each claim by section of the paper.
"""

import base64
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from verification.paper.claims.folder import paper
from verification.paper.claims.sharing import sharing
from verification.paper.figures.catalogue import plain
from verification.paper.report.findings import GRADES, compared, findings, graded
from verification.paper.report.mathml import formula, prose, remark
from verification.paper.report.report import VERDICTS, by_section, counts, errata, place, summary

if TYPE_CHECKING:
    from verification.measure.work.row import Diagram
    from verification.paper.claims.claim import Claim
    from verification.paper.claims.folder import Paper
    from verification.paper.figures.catalogue import Picture as Figure
    from verification.paper.report.report import Result


FOLD = 48  # digits of a number before the rest is folded away
LONG = 300  # characters of a method before it is folded
OPENING = 120  # of which this many are shown


KINDS = {b"\x89PNG": "png", b"RIFF": "webp"}


def address(kind: str, content: bytes) -> str:
    """An address that holds the content whole."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


@dataclass(frozen=True)
class Picture:
    """A figure of the report: an image, its caption as printed and in our words, and its section of the paper."""

    name: str
    caption: str
    section: str
    image: bytes
    shows: str = ""

    @classmethod
    def of(cls, drawing: "Figure | Diagram", image: bytes) -> "Picture":
        """What was drawn, with its words."""
        return cls(drawing.name, drawing.caption, drawing.section, image, drawing.shows)

    @property
    def source(self) -> str:
        """The image as an address that holds it whole."""
        kind = next((kind for start, kind in KINDS.items() if self.image.startswith(start)), "svg+xml")
        return address(f"image/{kind}", self.image)

    @property
    def words(self) -> Markup:
        """Our caption, or else the paper's."""
        return prose(self.shows or self.caption)

    @property
    def alt(self) -> str:
        """The first sentence of the caption without what sets it."""
        return plain((self.shows or self.caption).partition(". ")[0])

    def stands_by(self, claims: "Sequence[Result]") -> str:
        """The first claim that quotes the caption, else the first of the section; empty when there is neither."""
        caption = _plain(self.caption)
        quoting = (c.id for c in claims if c.section == self.section and _plain(c.quote) in caption)
        return next(quoting, next((c.id for c in claims if c.section == self.section), ""))


def page(
    results: "Sequence[Result]",
    versions: Mapping[str, str],
    pictures: Sequence[Picture] = (),
    about: "Paper | None" = None,
) -> str:
    """The whole page. Two runs differ in the seconds only."""
    about = about or paper()
    sections = by_section(results, about.sections)
    ordered = [result for _, claims in sections for result in claims]
    beside: dict[str, list[Picture]] = {}
    for picture in pictures:
        beside.setdefault(picture.stands_by(ordered), []).append(picture)
    first = findings(results, about)
    shown = {each.figure for found in first.values() for each in found} & {picture.name for picture in pictures}
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"prose": prose, "remark": remark, "sentence": sentence, "opening": opening}
    template = environment.from_string(_text("page.html"))
    font = (files("verification.paper.report") / "math.woff2").read_bytes()
    return template.render(
        about=about,
        style=Markup(_text("page.css").replace("FONT", address("font/woff2", font))),
        script=Markup(_text("page.js")),
        summary=summary(results),
        counts=counts(results),
        meanings=VERDICTS,
        findings=first,
        pictures={picture.name: picture for picture in pictures},
        shown=shown,
        grades=GRADES,
        graded=graded(results, about),
        compared=compared,
        place=place,
        sections=[(name, claims, counts(claims)) for name, claims in sections],
        beside=beside,
        certificates=_certificates(results, about),
        home={claim.id: claim.home for claim in about.claims if not claim.home.endswith(".py")},
        together=_together(results, about),
        made=", ".join(f"{name} {number}" for name, number in versions.items()),
        seconds=sum(result.seconds for result in results),
        fold=FOLD,
        long=LONG,
    )


def set_claims(claims: "Iterable[Claim]") -> None:
    """Sets what is printed, ahead of the page, which then finds it set."""
    for claim in claims:
        prose(claim.quote)
        formula(claim.text) or remark(claim.text)


def set_result(result: "Result") -> None:
    """Sets what is said of a claim, ahead of the page, as soon as it is judged."""
    compared(result)
    for text in (result.erratum, result.unsettled, result.method):
        sentence(text)
    if len(result.method) > LONG:
        opening(result.method)


def _text(name: str) -> str:
    return (files("verification.paper.report") / name).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Certificate:
    """A certificate that claims rest on: its file, what it states, and its content as an address."""

    name: str
    statement: str
    address: str
    claims: tuple[str, ...]


def _certificates(results: "Sequence[Result]", about: "Paper") -> list[Certificate]:
    """Those of the claims judged, each once, in the order of the paper."""
    judged = {result.id for result in results}
    resting: dict[Path, list[str]] = {}
    for claim, paths in about.certificates().items():
        for path in paths if claim in judged else ():
            resting.setdefault(path, []).append(claim)
    contents = {path: path.read_bytes() for path in resting}
    return [
        Certificate(path.stem, json.loads(text)["statement"], address("application/json", text), tuple(resting[path]))
        for path, text in contents.items()
    ]


def _together(results: "Sequence[Result]", about: "Paper") -> dict[str, tuple[int, float]]:
    """For claims that share results: how many judged here do, and the seconds of all of them."""
    seconds = {result.id: result.seconds for result in results}
    found: dict[str, tuple[int, float]] = {}
    for group in sharing(about.claims) if len(results) > 1 else []:
        judged = [claim.id for claim in group if claim.id in seconds and len(group) > 1]
        found |= dict.fromkeys(judged, (len(judged), sum(seconds[name] for name in judged)))
    return found


def sentence(text: str) -> Markup:
    """Words as a sentence: a capital at the beginning, a full stop at the end."""
    first = text.split(" ", 1)[0]
    text = text[:1].upper() + text[1:] if first.isalpha() and first.islower() else text
    return remark(text if text.endswith((".", "!", "?")) else f"{text}.")


def opening(text: str) -> Markup:
    """The first words of a long text."""
    return sentence(text[: text.rindex(" ", 0, OPENING)].rstrip(".,:;") + ".")[:-1]


def _plain(text: str) -> str:
    """Words and formulas without what sets them."""
    return "".join(letter for letter in text if letter not in "${}\\ \n")


WANTED = "accepted: what `pinball work --json FILE` writes"


def diagrams(path: Path) -> "list[Diagram]":
    """A diagram for each question in the file, with its machine in the footer; `ValueError` when it is no such file."""
    from verification.measure.work.row import Diagram, Row

    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        questions = _listed(document["questions"])
        rows = [Row.from_dict(each) for each in document["rows"]]
        known = dict(document["machine"])
        titles = [(each["name"], each["title"], each["answers"], each["unit"]) for each in questions]
    except OSError as error:
        raise ValueError(f"--work {str(path)!r} cannot be read ({error.strerror}); {WANTED}") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"--work {str(path)!r} is no such file ({type(error).__name__}: {error}); {WANTED}") from None
    return [
        Diagram(
            f"work-{name}",
            f"{title}: {answers}.",
            title,
            unit,
            tuple(row for row in rows if row.question == name),
            known,
        )
        for name, title, answers, unit in titles
    ]


def _listed(questions: Any) -> list[dict[str, str]]:
    return list(questions.values()) if isinstance(questions, dict) else list(questions)


SHORT = 90  # characters that stay inside a line
PARAGRAPH = 400  # characters of a proof that are read as a sentence
DIGITS = 60  # digits of a number on a line
WORDS = re.compile(r"[A-Za-z]{2,},? [A-Za-z]{2,}")  # two in a row make a text, not a formula


def markdown(results: Sequence["Result"], versions: Mapping[str, str], about: "Paper | None" = None) -> str:
    """The whole report: summary, errata, then each claim by section of the paper.

    Two runs differ in the seconds only.
    """
    about = about or paper()
    head = f"*{about.title}*" + (f"\n({about.source})" if about.source else "")
    parts = ["# What the paper says, and what is true", head, summary(results), _legend(results)]
    parts += _errata(results, about.sections)
    for section, claims in by_section(results, about.sections):
        source = about.sections.get(section, "")
        parts += [f"## {section}", *([source] if source else []), *(_claim(result) for result in claims)]
    made = ", ".join(f"{name} {number}" for name, number in versions.items())
    parts += ["---", f"Made with {made}."]
    return "\n\n".join(parts) + "\n"


def _legend(results: Sequence["Result"]) -> str:
    rows = [f"| {verdict} | {number} | {VERDICTS[verdict]} |" for verdict, number in counts(results).items()]
    return "\n".join(["| verdict | claims | meaning |", "|---|---:|---|", *rows])


def _errata(results: Iterable["Result"], sections: Iterable[str]) -> list[str]:
    wrong = errata(results, sections)
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
    if result.unsettled:
        facts.append(f"- why not settled: {_sentence(result.unsettled)}")
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
        return f"- {label}: {_plain_markdown(text)}"
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


def _plain_markdown(text: str) -> str:
    """`text` on one line, with what Markdown would take for emphasis, HTML or a link made plain."""
    return re.sub(r"([*`]|<(?=[A-Za-z/!?])|\](?=\())", r"\\\1", " ".join(text.split()))


def _sentence(text: str) -> str:
    """`text` as a sentence: plain, begun with a capital when it begins with a word, ended by a full stop."""
    text = _plain_markdown(text)
    text = text[:1].upper() + text[1:] if re.match(r"[a-z]+ ", text) else text
    return text if text.endswith(".") or not text else f"{text}."
