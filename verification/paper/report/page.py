"""The report as one page of HTML that needs no network: formulas in MathML, figures and script inside it.

The work-precision diagrams of the report, from what `pinball work --json FILE` measured.
"""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from verification.paper.report.mathml import formula, prose, remark
from verification.paper.report.report import VERDICTS, by_section, counts, errata, place, summary

if TYPE_CHECKING:
    from verification.paper.report.verdicts import Result

import json
from pathlib import Path
from typing import Any

FOLD = 48  # digits of a number before the rest is folded away
LONG = 300  # characters of a method before it is folded
OPENING = 120  # of which this many are shown


@dataclass(frozen=True)
class Picture:
    """A figure of the report: a PNG image, its caption as printed, and its section of the paper."""

    name: str
    caption: str
    section: str
    image: bytes

    @property
    def source(self) -> str:
        """The image as an address that holds it whole."""
        return f"data:image/png;base64,{base64.b64encode(self.image).decode('ascii')}"

    def stands_by(self, claims: "Sequence[Result]") -> str:
        """The first claim that quotes the caption, else the first of the section; empty when there is neither."""
        caption = _plain(self.caption)
        quoting = (c.id for c in claims if c.section == self.section and _plain(c.quote) in caption)
        return next(quoting, next((c.id for c in claims if c.section == self.section), ""))


def page(results: "Sequence[Result]", versions: Mapping[str, str], pictures: Sequence[Picture] = ()) -> str:
    """The whole page. Two runs differ in the seconds only."""
    sections = by_section(results)
    ordered = [result for _, claims in sections for result in claims]
    beside: dict[str, list[Picture]] = {}
    for picture in pictures:
        beside.setdefault(picture.stands_by(ordered), []).append(picture)
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"prose": prose, "said": said, "sentence": sentence, "opening": opening}
    template = environment.from_string((files("verification.paper.report") / "page.html").read_text(encoding="utf-8"))
    return template.render(
        summary=summary(results),
        counts=counts(results),
        meanings=VERDICTS,
        errata=errata(results),
        place=place,
        sections=sections,
        beside=beside,
        made=", ".join(f"{name} {number}" for name, number in versions.items()),
        seconds=sum(result.seconds for result in results),
        fold=FOLD,
        long=LONG,
    )


def said(text: str) -> Markup:
    """A formula as MathML, anything else in words."""
    return formula(text) or remark(text)


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


def diagrams(path: Path) -> list[Picture]:
    """A picture for each question in the file, with its machine in the footer; `ValueError` when it is no such file."""
    from verification.measure.work.figure import drawn, image
    from verification.measure.work.row import Row

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
    found = []
    for name, title, answers, unit in titles:
        figure = drawn(title, unit, [row for row in rows if row.question == name], known)
        found.append(Picture(f"work-{name}", f"{title}: {answers}.", "", image(figure, "png")))
    return found


def _listed(questions: Any) -> list[dict[str, str]]:
    return list(questions.values()) if isinstance(questions, dict) else list(questions)
