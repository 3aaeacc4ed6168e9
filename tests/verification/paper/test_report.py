"""The report: complete, in the paper's order, reproducible, and legible."""

import json
from dataclasses import dataclass, field
from enum import Enum

from verification.app.commands.verify import write_report
from verification.paper.report.page import markdown
from verification.paper.report.report import VERDICTS, document

VERSIONS = {"python": "3.11.0", "sympy": "1.13", "machine": "abacus"}
Verdict = Enum("Verdict", {name.upper(): name for name in VERDICTS})


@dataclass(frozen=True)
class Result:
    """A stand-in for the package's `Result`."""

    id: str = "ellipse.P1"
    section: str = "3.3 Stability"
    quote: str = "the period-$2$ orbit has $P_1 = 1$"
    printed: str = "1 + lam"
    derived: str = "1 - lam"
    verdict: Verdict = field(default_factory=lambda: Verdict("confirmed"))
    value: str | None = None
    radius: str | None = None
    method: str = "both sides reduce to the same polynomial"
    seconds: float = 0.25
    erratum: str = ""
    unsettled: str = ""

    def to_dict(self):
        return {**self.__dict__, "verdict": self.verdict.value}


WRONG = Result(
    id="egg.mu",
    section="6.3 Period-2 orbits",
    verdict=Verdict("corrected"),
    erratum="the sign of lam is wrong",
)


def test_what_is_wrong_in_the_paper_is_listed_first_and_ready_to_be_sent():
    text = markdown([Result(), WRONG], VERSIONS)

    errata, claims = text.split("## 3.3 Stability")
    assert "1. Section 6.3 Period-2 orbits (`egg.mu`). The sign of lam is wrong." in errata
    assert "\n\n   > the period-$2$ orbit has $P_1 = 1$\n\n   - printed: `1 + lam`\n   - derived: `1 - lam`" in errata
    assert "ellipse.P1" not in errata
    assert "### `ellipse.P1`: confirmed" in claims


def test_claims_stand_in_the_order_of_the_paper_whatever_order_they_are_judged_in():
    results = [Result(section=s) for s in ("A.1 Trajectories", "6.2 Slap", "10 End", "Abstract", "6 Egg")]

    headings = [line for line in markdown(results, VERSIONS).splitlines() if line.startswith("## ")]
    assert headings == ["## Errata", "## Abstract", "## 6 Egg", "## 6.2 Slap", "## 10 End", "## A.1 Trajectories"]


def test_a_long_number_is_folded_without_losing_a_digit():
    digits = "0." + "1234567890" * 20
    text = markdown([Result(value=digits, radius="1e-200")], VERSIONS)

    assert digits in text.replace("\n    ", "").replace("\n  ", "")
    assert max(len(line) for line in text.splitlines()) < 140
    assert "- within: 1e-200" in text


def test_words_are_not_taken_for_markdown():
    text = markdown([Result(derived="the area is a*b*pi for 1 < a <b [note](x)")], VERSIONS)

    assert r"- derived: the area is a\*b\*pi for 1 < a \<b [note\](x)" in text


def test_the_report_says_what_it_was_made_with():
    assert markdown([], VERSIONS).endswith("Made with python 3.11.0, sympy 1.13, machine abacus.\n")


def test_json_has_the_keys_of_the_contract_in_order():
    claim = document([WRONG])["claims"][0]

    assert list(claim) == [
        "id", "section", "quote", "printed", "derived", "verdict", "value", "radius", "method", "seconds", "erratum",
        "unsettled",
    ]  # fmt: skip


def test_the_report_and_the_letter_are_written_and_nothing_else(tmp_path):
    write_report(tmp_path, [Result(), WRONG])

    written = ["letter.tex", "report.html", "report.json", "report.md", "report.tex"]
    assert sorted(path.name for path in tmp_path.iterdir()) == written
    written = json.loads((tmp_path / "report.json").read_text())
    assert written["schema"] == 1
    assert {"python", "sympy", "mpmath", "python-flint", "numpy", "machine", "seed"} <= set(written["made_with"])
