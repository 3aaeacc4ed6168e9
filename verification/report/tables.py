"""The report as LaTeX tables, to be brought into a document by `\\input`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from verification.report import counts, errata

if TYPE_CHECKING:
    from verification.claims import Result

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
