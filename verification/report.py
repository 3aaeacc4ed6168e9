"""The report on the paper, as Markdown for people and JSON for programs."""

import platform
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from itertools import groupby
from textwrap import wrap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verification.claims import Result

VERDICTS = {
    "confirmed": "proved, and as printed",
    "corrected": "proved to differ from what is printed, and the right form is proved",
    "refuted": "proved false",
    "supported": "agrees within a stated error, not proved",
    "open": "not settled",
}
SHORT = 90  # characters that stay inside a line
DIGITS = 60  # digits of a number on a line


def document(results: Iterable["Result"]) -> dict[str, Any]:
    """The results under the JSON schema of `pinball verify`."""
    return {"schema": 1, "claims": [result.to_dict() for result in results]}


def counts(results: Iterable["Result"]) -> dict[str, int]:
    """How many claims have each verdict, every verdict listed."""
    found = Counter(result.verdict.value for result in results)
    return {verdict: found[verdict] for verdict in VERDICTS}


def summary(results: Sequence["Result"]) -> str:
    """One line: so many claims, so many of each verdict."""
    parts = ", ".join(f"{number} {verdict}" for verdict, number in counts(results).items())
    return f"{len(results)} claims: {parts}."


def made_with() -> dict[str, str]:
    """The versions that a result depends on, and the type of machine."""
    found = {"python": platform.python_version()}
    for package in ("sympy", "mpmath", "python-flint"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found | {"machine": platform.machine() or "unknown"}


def markdown(results: Sequence["Result"], versions: Mapping[str, str]) -> str:
    """The whole report: summary, errata, then each claim by section of the paper.

    Two runs differ in the seconds only.
    """
    ordered = sorted(results, key=lambda result: section_order(result.section))
    parts = ["# What the paper says, and what is true", summary(results), _legend(results), *_errata(ordered)]
    for section, claims in groupby(ordered, key=lambda result: result.section):
        parts += [f"## {section}", *(_claim(result) for result in claims)]
    made = ", ".join(f"{name} {number}" for name, number in versions.items())
    parts += ["---", f"Made with {made}."]
    return "\n\n".join(parts) + "\n"


def section_order(section: str) -> tuple[int, ...]:
    """Where a section stands in the paper: the abstract, the numbered sections, the appendix.

    >>> sorted(["A.1 Lyapunov", "10 End", "6.2 Slap", "6 Egg", "Abstract"], key=section_order)
    ['Abstract', '6 Egg', '6.2 Slap', '10 End', 'A.1 Lyapunov']
    """
    label = section.split(" ")[0].split(".")
    if label[0].isdigit():
        return (1, *(int(part) for part in label if part.isdigit()))
    return (2, *(int(part) for part in label[1:] if part.isdigit())) if len(label[0]) == 1 else (0,)


def _legend(results: Sequence["Result"]) -> str:
    rows = [f"| {verdict} | {number} | {VERDICTS[verdict]} |" for verdict, number in counts(results).items()]
    return "\n".join(["| verdict | claims | meaning |", "|---|---:|---|", *rows])


def _errata(results: Iterable["Result"]) -> list[str]:
    wrong = [result for result in results if result.verdict.value in ("corrected", "refuted")]
    if not wrong:
        return ["## Errata", "None found."]
    listed = [
        "\n".join(
            [
                f"{number}. Section {result.section} (`{result.id}`). {_sentence(result.erratum)}",
                _indented(_code("printed", result.printed)),
                _indented(_code("derived", result.derived)),
            ]
        )
        for number, result in enumerate(wrong, 1)
    ]
    return ["## Errata", *listed]


def _claim(result: "Result") -> str:
    lines = [
        f"### `{result.id}`: {result.verdict.value}",
        "",
        _quote(result.quote),
        "",
        _code("printed", result.printed),
        _code("derived", result.derived),
    ]
    if result.value is not None:
        lines.append(_code("value", result.value))
    if result.radius is not None:
        lines.append(f"- within: {result.radius}")
    if result.erratum:
        lines.append(f"- erratum: {_sentence(result.erratum)}")
    lines += [f"- method: {_sentence(result.method)}", f"- seconds: {result.seconds:.2f}"]
    return "\n".join(lines)


def _quote(text: str) -> str:
    """The paper's words as a quotation; a bare formula as the LaTeX it is."""
    if "\\" in text and "$" not in text:
        return _fenced("\n".join(part.strip() for part in text.replace("\\\\", "\\\\\n").split("\n")), "latex")
    return "> " + " ".join(text.split())


def _code(label: str, text: str) -> str:
    """A list item with a formula in it; a long formula or a long number is folded into a block."""
    if not text:
        return f"- {label}: not given"
    if text.endswith(".") and " " in text:
        return f"- {label}: {text}"
    if len(text) <= SHORT:
        fence = "``" if "`" in text else "`"
        return f"- {label}: {fence}{text}{fence}"
    if text.lstrip("+-").replace(".", "", 1).isdigit():
        folded = [text[i : i + DIGITS] for i in range(0, len(text), DIGITS)]
    else:
        folded = wrap(text, SHORT, break_long_words=False, break_on_hyphens=False)
    return f"- {label}:\n\n" + _indented(_fenced("\n".join(folded), "text"), "  ") + "\n"


def _fenced(text: str, language: str) -> str:
    return f"```{language}\n{text}\n```"


def _indented(text: str, by: str = "   ") -> str:
    return "\n".join(by + line if line else line for line in text.split("\n"))


def _sentence(text: str) -> str:
    """`text` on one line, ended by a full stop."""
    text = " ".join(text.split())
    return text if text.endswith(".") or not text else f"{text}."
