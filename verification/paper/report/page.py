"""The report as one HTML page that needs no network, and as Markdown.

Formulas are MathML; figures and script are inside the page, as are the work-precision diagrams from the file of
`pinball work --json FILE`. The Markdown has the summary, the errata, and each claim by section of the paper.
"""

import base64
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from textwrap import fill, wrap
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from verification.paper.claims.folder import paper
from verification.paper.claims.sharing import sharing
from verification.paper.figures.catalogue import plain
from verification.paper.report.findings import GRADES, compared, findings, graded
from verification.paper.report.mathml import font_style, formula, prose, remark
from verification.paper.report.report import VERDICTS, by_section, counts, errata, place, summary

if TYPE_CHECKING:
    from verification.measure.work.row import WorkDiagram
    from verification.paper.claims.claim import Claim
    from verification.paper.claims.folder import Paper
    from verification.paper.figures.catalogue import PaperFigure as Figure
    from verification.paper.report.report import Result


FOLD = 48  # digits of a number after which the rest is folded
LONG = 300  # characters of a method from which it is folded
OPENING = 120  # characters shown of a folded method


KINDS = {b"\x89PNG": "png", b"RIFF": "webp"}


def address(kind: str, content: bytes) -> str:
    """A data URL that contains `content`."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


@dataclass(frozen=True)
class ReportFigure:
    """A figure of the report: an image, its caption as printed and in our words, and its section of the paper."""

    name: str
    caption: str
    section: str
    image: bytes
    shows: str = ""

    @classmethod
    def of(cls, drawing: "Figure | WorkDiagram", image: bytes) -> "ReportFigure":
        """The report's figure from a drawing and its image, with the captions."""
        return cls(drawing.name, drawing.caption, drawing.section, image, drawing.shows)

    @property
    def source(self) -> str:
        """The image as a data URL."""
        kind = next((kind for start, kind in KINDS.items() if self.image.startswith(start)), "svg+xml")
        return address(f"image/{kind}", self.image)

    @property
    def words(self) -> Markup:
        """Our caption as HTML, or the paper's caption if there is none."""
        return prose(self.shows or self.caption)

    @property
    def alt(self) -> str:
        """The first sentence of the caption as plain text."""
        return plain((self.shows or self.caption).partition(". ")[0])

    def stands_by(self, claims: "Sequence[Result]") -> str:
        """The id of the first claim that quotes the caption; else of the first claim in its section; else empty."""
        caption = _plain(self.caption)
        quoting = (c.id for c in claims if c.section == self.section and _plain(c.quote) in caption)
        return next(quoting, next((c.id for c in claims if c.section == self.section), ""))


def page(
    results: "Sequence[Result]",
    versions: Mapping[str, str],
    pictures: Sequence[ReportFigure] = (),
    about: "Paper | None" = None,
) -> str:
    """The whole HTML page; two runs differ only in computing times."""
    about = about or paper()
    sections = by_section(results, about.sections)
    ordered = [result for _, claims in sections for result in claims]
    beside: dict[str, list[ReportFigure]] = {}
    for picture in pictures:
        beside.setdefault(picture.stands_by(ordered), []).append(picture)
    first = findings(results, about)
    shown = {each.figure for found in first.values() for each in found} & {picture.name for picture in pictures}
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"prose": prose, "remark": remark, "sentence": sentence, "opening": opening}
    template = environment.from_string(_text("page.html"))
    return template.render(
        about=about,
        style=font_style() + Markup(_text("page.css")),
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
    """Typesets the printed texts of claims and stores them in the cache, before the page is made."""
    for claim in claims:
        prose(claim.quote)
        formula(claim.text) or remark(claim.text)


def set_result(result: "Result") -> None:
    """Typesets the texts of a judged claim and stores them in the cache, before the page is made."""
    compared(result)
    for text in (result.erratum, result.unsettled, result.method):
        sentence(text)
    if len(result.method) > LONG:
        opening(result.method)


def _text(name: str) -> str:
    return (files("verification.paper.report") / name).read_text(encoding="utf-8")


@dataclass(frozen=True)
class ReportCertificate:
    """A certificate of claims: its file name, its statement, its content as a data URL, and the claims."""

    name: str
    statement: str
    address: str
    claims: tuple[str, ...]


def _certificates(results: "Sequence[Result]", about: "Paper") -> list[ReportCertificate]:
    """The certificates of the judged claims, without repetition, in the order of the paper."""
    judged = {result.id for result in results}
    resting: dict[Path, list[str]] = {}
    for claim, paths in about.certificates().items():
        for path in paths if claim in judged else ():
            resting.setdefault(path, []).append(claim)
    contents = {path: path.read_bytes() for path in resting}
    return [
        ReportCertificate(
            path.stem, json.loads(text)["statement"], address("application/json", text), tuple(resting[path])
        )
        for path, text in contents.items()
    ]


def _together(results: "Sequence[Result]", about: "Paper") -> dict[str, tuple[int, float]]:
    """For each claim that shares results, the number of judged claims that share them, and their total seconds."""
    seconds = {result.id: result.seconds for result in results}
    found: dict[str, tuple[int, float]] = {}
    for group in sharing(about.claims) if len(results) > 1 else []:
        judged = [claim.id for claim in group if claim.id in seconds and len(group) > 1]
        found |= dict.fromkeys(judged, (len(judged), sum(seconds[name] for name in judged)))
    return found


def sentence(text: str) -> Markup:
    """Text as a sentence in HTML, with a capital at the beginning and a full stop at the end."""
    first = text.split(" ", 1)[0]
    text = text[:1].upper() + text[1:] if first.isalpha() and first.islower() else text
    return remark(text if text.endswith((".", "!", "?")) else f"{text}.")


def opening(text: str) -> Markup:
    """The first words of a long text, as HTML."""
    return sentence(text[: text.rindex(" ", 0, OPENING)].rstrip(".,:;") + ".")[:-1]


def _plain(text: str) -> str:
    """The text without markup characters and spaces, for comparisons."""
    return "".join(letter for letter in text if letter not in "${}\\ \n")


WANTED = "accepted: what `pinball work --json FILE` writes"


def diagrams(path: Path) -> "list[WorkDiagram]":
    """The diagrams of the questions in a file of `pinball work`; `ValueError` if it is another file."""
    from verification.measure.work.row import MethodResult, WorkDiagram

    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        questions = _listed(document["questions"])
        rows = [MethodResult.from_dict(each) for each in document["rows"]]
        known = dict(document["machine"])
        titles = [(each["name"], each["title"], each["answers"], each["unit"]) for each in questions]
    except OSError as error:
        raise ValueError(f"--work {str(path)!r} cannot be read ({error.strerror}); {WANTED}") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"--work {str(path)!r} is no such file ({type(error).__name__}: {error}); {WANTED}") from None
    return [
        WorkDiagram(
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


SHORT = 90  # the most characters of an item on one line
PARAGRAPH = 400  # the most characters of a proof that is shown as a sentence
DIGITS = 60  # the most digits of a number on one line
WORDS = re.compile(r"[A-Za-z]{2,},? [A-Za-z]{2,}")  # two in a row make a text, not a formula


def markdown(results: Sequence["Result"], versions: Mapping[str, str], about: "Paper | None" = None) -> str:
    """The whole report in Markdown: summary, errata, each claim by section; two runs differ only in computing times."""
    about = about or paper()
    head = f"*{about.title}*" + (f"\n({about.source})" if about.source else "")
    parts = ["# What the paper says, and what is true", head, summary(results), _legend(results)]
    parts += [
        fill(f"**{word[0].upper()}{word[1:]}** in this report: {text}", 110) for word, text in about.senses.items()
    ]
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
    """The paper's text as a quotation; a formula as LaTeX code."""
    if "\\" in text and "$" not in text:
        rows = text.replace("\\\\", "\\\\\n").splitlines()
        return _fenced("\n".join(row.strip() for row in rows), "latex")
    return "> " + " ".join(text.split())


def _item(label: str, text: str) -> str:
    """A list item: a formula as code, a long formula as a block, other text as it is."""
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
    """A list item with a sentence, or with a block if the text is long."""
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
    """The text on one line, with Markdown's special characters escaped."""
    return re.sub(r"([*`]|<(?=[A-Za-z/!?])|\](?=\())", r"\\\1", " ".join(text.split()))


def _sentence(text: str) -> str:
    """The text as a Markdown sentence: escaped, with an initial capital and a full stop."""
    text = _plain_markdown(text)
    text = text[:1].upper() + text[1:] if re.match(r"[a-z]+ ", text) else text
    return text if text.endswith(".") or not text else f"{text}."
