r"""The report on the paper: for people as a page and as Markdown, for programs as JSON, for LaTeX as tables.

The page is one file that needs no network; a result is shown in each form from the same `Result`.

The report as LaTeX tables, to be brought into a document by `\input`.
"""

import platform
from collections import Counter
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from itertools import groupby
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verification.paper.report.verdicts import Result

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verification.paper.report.verdicts import Result


VERDICTS = {
    "confirmed": "proved, and as printed",
    "corrected": "proved to differ from what is printed, and the right form is proved",
    "refuted": "proved false",
    "supported": "agrees within a stated error, not proved",
    "open": "not settled",
}


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
    """The versions that a result depends on, the type of machine, and the seed of all that is drawn at random."""
    found = {"python": platform.python_version()}
    for package in ("sympy", "mpmath", "gmpy2", "python-flint", "numpy"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found | {"machine": platform.machine() or "unknown", "seed": "1"}


def by_section(results: Iterable["Result"]) -> list[tuple[str, list["Result"]]]:
    """The results of each section, sections in the order of the paper."""
    ordered = sorted(results, key=lambda result: section_order(result.section))
    return [(name, list(claims)) for name, claims in groupby(ordered, key=lambda result: result.section)]


def errata(results: Iterable["Result"]) -> list["Result"]:
    """What is wrong in the paper, in its order."""
    wrong = [result for result in results if result.verdict.value in ("corrected", "refuted")]
    return sorted(wrong, key=lambda result: section_order(result.section))


def place(result: "Result") -> str:
    """Where a claim stands, in words."""
    return result.section if result.section == "Abstract" else f"Section {result.section}"


def section_order(section: str) -> tuple[int, ...]:
    """Where a section stands in the paper: the abstract, the numbered sections, the appendix.

    >>> sorted(["A.1 Lyapunov", "10 End", "6.2 Slap", "6 Egg", "Abstract"], key=section_order)
    ['Abstract', '6 Egg', '6.2 Slap', '10 End', 'A.1 Lyapunov']
    """
    label = section.split(" ")[0].split(".")
    if label[0].isdigit():
        return (1, *(int(part) for part in label if part.isdigit()))
    return (2, *(int(part) for part in label[1:] if part.isdigit())) if len(label[0]) == 1 else (0,)


SPECIAL = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "_": r"\_",
    "%": r"\%",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
}
BREAKS = "*/+,=_"  # a long formula may be broken after these


def tables(results: Sequence["Result"]) -> str:
    """Three tables: the counts, the errata, and every claim; they need the packages longtable and booktabs."""
    parts = [
        "% \\usepackage{booktabs,longtable}",
        _table("lr", ("verdict", "claims"), [[name, str(number)] for name, number in counts(results).items()]),
        _table(r"p{.24\linewidth}p{.68\linewidth}", ("claim", "erratum"), [_erratum(r) for r in errata(results)]),
        _table(
            r"p{.28\linewidth}p{.13\linewidth}p{.49\linewidth}",
            ("claim", "verdict", "what is true"),
            [[_code(r.id), r.verdict.value, _words(r.value or r.derived or "--")] for r in results],
        ),
    ]
    return "\n\n".join(parts) + "\n"


def escaped(text: str) -> str:
    """`text` with every character that LaTeX would act on made plain.

    >>> print(escaped("50 % of a_1"))
    50 \\% of a\\_1
    """
    return "".join(SPECIAL.get(letter, letter) for letter in text)


def _erratum(result: "Result") -> list[str]:
    return [_code(result.id), _words(result.erratum)]


def _code(text: str) -> str:
    return rf"\texttt{{{_breakable(text, '._')}}}"


def _words(text: str) -> str:
    words = " ".join(text.split()).split(" ")
    return " ".join(_breakable(word, BREAKS) if len(word) > 24 else escaped(word) for word in words)


def _breakable(text: str, where: str) -> str:
    digits = text.replace(".", "").replace("-", "").isdigit()
    return "".join(
        escaped(letter) + (r"\allowbreak{}" if letter in where or (digits and i % 10 == 9) else "")
        for i, letter in enumerate(text)
    )


def _table(columns: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    body = "\n".join(" & ".join(row) + r" \\" for row in rows)
    head = " & ".join(heads)
    return "\n".join(
        [
            rf"\begin{{longtable}}{{{columns}}}",
            rf"\toprule {head} \\ \midrule \endhead",
            *([body] if rows else []),
            r"\bottomrule",
            r"\end{longtable}",
        ]
    )
