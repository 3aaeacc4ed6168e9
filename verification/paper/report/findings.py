r"""The summary of the report: main findings, graded errata, LaTeX tables, and a letter to the authors.

`findings.toml` in a paper's folder, if it exists, has the sentences of the findings, and how grave each erratum is. A
finding is shown when all its claims were judged and none is open.
"""

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cache, lru_cache
from itertools import chain, groupby, takewhile
from pathlib import Path
from typing import Any

from markupsafe import Markup
from sympy import Rational

from symbolic.tables.formula import parse
from verification.arithmetic.balls import enclose
from verification.paper.claims.claim import LETTERS
from verification.paper.claims.folder import Paper
from verification.paper.report.mathml import formula, formulas, pieces, remark
from verification.paper.report.report import Result, counts, errata, place

GRADES = {
    "substantial": "what is said is not so, and something else is true",
    "range": "true but at an end or an exceptional value of the range that is stated",
    "misprint": "a sign, a digit, a letter or a word",
}


@dataclass(frozen=True)
class ReportFinding:
    """A main finding: its kind (`holds` or `new`), its sentence, its claims and its figure."""

    kind: str
    text: str
    claims: tuple[str, ...]
    figure: str


@dataclass(frozen=True)
class Erratum:
    """A correction, how grave it is, and the claims that it concerns."""

    text: str
    grade: str
    claims: tuple[Result, ...]


@cache
def _document(folder: Path) -> dict[str, Any]:
    path = folder / "findings.toml"
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def findings(results: Iterable[Result], about: Paper) -> dict[str, list[ReportFinding]]:
    """The findings whose claims were all judged and none of which is open, by kind (`holds` and `new`)."""
    settled = {result.id for result in results if result.verdict.value != "open"}
    known = [
        ReportFinding(**{**each, "claims": tuple(each["claims"])})
        for each in _document(about.folder).get("finding", [])
    ]
    shown = [each for each in known if settled.issuperset(each.claims)]
    return {kind: [each for each in shown if each.kind == kind] for kind in ("holds", "new")}


def grade(name: str, about: Paper) -> str:
    """How grave the erratum of a claim is; `substantial` if nothing is given.

    >>> from verification.paper.claims.folder import paper
    >>> grade("egg.doubling.3", paper())
    'misprint'
    """
    grades = _document(about.folder).get("grades", {})
    return next((each for each in GRADES if name in grades.get(each, ())), "substantial")


def graded(results: Iterable[Result], about: Paper) -> dict[str, list[Erratum]]:
    """The errata by gravity, in the order of the paper; claims with the same erratum share one entry."""
    found: dict[tuple[str, str], list[Result]] = {}
    for result in errata(results, about.sections):
        found.setdefault((grade(result.id, about), result.erratum or result.derived), []).append(result)
    whole = [Erratum(text, name, tuple(claims)) for (name, text), claims in found.items()]
    return {name: [each for each in whole if each.grade == name] for name in GRADES}


DECIMAL = re.compile(r"-?\d+\.\d+")
ALIKE = 0.6  # the least share of common words for which the others are marked
MARK = Markup("<mark>{}</mark>")


def compared(result: Result) -> tuple[Markup, Markup]:
    """The printed and the true text as HTML; the differences are marked if the texts are similar."""
    wrong = result.verdict.value in ("corrected", "refuted")
    witness = tuple(result.witness.items()) if wrong and result.printed.startswith("[[") else ()
    return _compared(result.printed, result.derived, wrong, witness)


@lru_cache(maxsize=4096)
def _compared(printed: str, true: str, wrong: bool, witness: tuple[tuple[str, str], ...]) -> tuple[Markup, Markup]:
    plain = formula(printed) or remark(printed), formula(true) or remark(true)
    if not wrong:
        return plain
    if DECIMAL.fullmatch(printed) and DECIMAL.match(true):
        same = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(printed, true, strict=False)))
        start, end = true[:same], len(printed)
        tail = MARK.format(true[same:end]) + true[end:].replace("...", "\u2026")
        return start + MARK.format(printed[same:]), Markup(start) + tail
    if printed.startswith("[[") and "[[" in true:
        before, matrix = true[: true.index("[[")], true[true.index("[[") :]
        left, right = formula(printed), formula(matrix)
        if left is not None and right is not None:
            differing = _differing(printed, matrix, witness)
            return _cells(left, differing), remark(before) + _cells(right, differing)
    return _worded(printed, true) if formula(printed) is None else plain


def _differing(left: str, right: str, witness: Sequence[tuple[str, str]]) -> list[int]:
    """The indices of the entries in which two matrices differ at the point `witness`."""
    values = {LETTERS[name]: parse(text, {}) for name, text in witness if name in LETTERS}
    pairs = zip(_entries(left), _entries(right), strict=True)
    return [n for n, (a, b) in enumerate(pairs) if _unequal(a, b, values)]


def _unequal(a: str, b: str, values: Any) -> bool:
    difference = parse(a, LETTERS) - parse(b, LETTERS)
    point = {x: Rational(2, 7 + n) for n, x in enumerate(sorted(difference.free_symbols, key=str))}
    return not enclose(difference, point | {x: v for x, v in values.items() if x in point}).contains(0)


def _entries(matrix: str) -> list[str]:
    rows = matrix.strip()[2:-2].split("], [")
    return list(chain.from_iterable(row.split(", ") for row in rows))


def _cells(matrix: Markup, marked: Sequence[int]) -> Markup:
    parts = str(matrix).split("<mtd>")
    shown = (f"<mtd{' class=differs' if n in marked else ''}>{part}" for n, part in enumerate(parts[1:]))
    return Markup(parts[0] + "".join(shown))


def _worded(printed: str, true: str) -> tuple[Markup, Markup]:
    """Two sentences as HTML; if most of their words agree, the words that differ are marked."""
    sides = [[piece for raw, shown in pieces(text) for piece in _split(raw, shown)] for text in (printed, true)]
    keys = [[raw.casefold().strip(".,;:") for raw, _ in side] for side in sides]
    matcher = SequenceMatcher(None, keys[0], keys[1], autojunk=False)
    if matcher.ratio() < ALIKE:
        return remark(printed), remark(true)
    alone: tuple[set[int], set[int]] = set(), set()
    for kind, a0, a1, b0, b1 in matcher.get_opcodes():
        if kind != "equal":
            alone[0].update(range(a0, a1))
            alone[1].update(range(b0, b1))
    return _marked(sides[0], alone[0]), _marked(sides[1], alone[1])


def _marked(words: Sequence[tuple[str, Markup]], alone: set[int]) -> Markup:
    runs = groupby(range(len(words)), key=lambda n: n in alone)
    texts = ((marks, Markup(" ").join(words[n][1] for n in run)) for marks, run in runs)
    return Markup(" ").join(MARK.format(text) if marks else text for marks, text in texts)


def _split(raw: str, shown: Markup) -> list[tuple[str, Markup]]:
    """A text in pieces, each with its HTML: a formula is one piece, other text is split into words."""
    return [(raw, shown)] if "<math" in shown else [(word, remark(word)) for word in raw.split()]


def letter(results: Sequence[Result], about: Paper) -> str:
    """A letter to the authors in LaTeX; substantial errata have the printed text, the others one line each."""
    by_grade = graded(results, about)
    items = [
        rf"\item {_where(each)} ``{_quoted(each.claims[0].quote)}'' -- {_set(each.text)}"
        for each in by_grade["substantial"]
    ]
    lines = {name: [rf"\item {_where(each)} {_set(each.text)}" for each in by_grade[name]] for name in by_grade}
    others = [
        "\n".join([rf"\paragraph{{{title}}}", r"\begin{itemize}", *lines[name], r"\end{itemize}"])
        for name, title in (("misprint", "Misprints."), ("range", "Ends of ranges."))
        if lines[name]
    ]
    counted = f"{len(results)} sentences, {sum(map(len, by_grade.values()))} corrections"
    listed = [r"\begin{enumerate}", *items, r"\end{enumerate}"] if items else []
    whole = LETTER
    body = "\n".join([*listed, *others]) or "We found nothing to correct."
    written = {"TITLE": escaped(about.title), "COUNTED": counted, "BODY": body}
    for word, text in written.items():
        whole = whole.replace(word, text)
    return whole


LETTER = r"""\documentclass[10pt,a4paper]{article}
\usepackage[T1]{fontenc}
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{}
\usepackage{amsmath}
\usepackage[margin=12mm,footskip=6mm]{geometry}
\linespread{0.95}
\usepackage{enumitem}
\setlist{nosep,leftmargin=*}
\setlength{\parindent}{0pt}
\setlength{\parskip}{2pt}
\emergencystretch=2em
\providecommand{\defeq}{:=}
\providecommand{\nn}{\mathbf{n}}
\providecommand{\vv}{\mathbf{v}}
\begin{document}
Dear authors,

we derived anew each sentence of \emph{TITLE} that can be judged (COUNTED). Most of it is true as printed.
What follows is what we would correct: each item is proved, or has a witness, and the report names the command that
shows it again. Numbers in brackets are sections; quotation marks hold what is printed.

BODY

\medskip
With kind regards
\end{document}
"""
QUOTED = 190  # the most characters of a quotation


def _where(erratum: Erratum) -> str:
    sections = dict.fromkeys(place(claim).removeprefix("Section ").split(" ")[0] for claim in erratum.claims)
    return f"{{[{escaped(', '.join(sections))}]}}"  # in braces, or LaTeX takes it as the item's label


def _quoted(quote: str) -> str:
    """The paper's LaTeX, cut after a word if it is long."""
    text = " ".join(quote.split())
    if "$" not in text and "\\" in text.replace(r"\emph", ""):
        return f"${text}$" if r"\begin" in text or "&" not in text else rf"$\begin{{matrix}}{text}\end{{matrix}}$"
    if len(text) <= QUOTED:
        return text
    kept = text[: text.rindex(" ", 0, QUOTED)]
    while kept.count("$") % 2 or kept.count("{") != kept.count("}"):
        kept = kept[: kept.rindex(" ")]
    return rf"{kept} \dots"


def _set(text: str) -> str:
    """Text in our notation, as a LaTeX sentence with formulas."""
    text = text[:1].upper() + text[1:] if text[:1].islower() and text[1:2].isalpha() else text
    text = text if text.endswith((".", "!", "?")) else f"{text}."
    return tex(text)


def tex(text: str) -> str:
    r"""Text in LaTeX: formulas typeset, special characters escaped, and names of variables as the paper's symbols.

    >>> print(tex("50 %: nu_plus for lambda = 1/2"))
    50 \%: $\nu_{+}$ for $\lambda = \frac{1}{2}$
    """
    shown, at = "", 0
    for start, end, latex in formulas(text):
        shown += _typed(text[at:start]) + f"${latex}$"
        at = end
    return shown + _typed(text[at:])


def _typed(text: str) -> str:
    """Text in LaTeX: variable names and operators become mathematics, and opening quotation marks are set."""
    parts = LETTER_OR_SIGN.split(re.sub(r"(?<![\w)])'(?=\w)", "`", text))
    return "".join(_symbol(part) if n % 2 else escaped(part) for n, part in enumerate(parts))


TYPED = {"<=": r"\le", ">=": r"\ge", "+-": r"\pm", "±": r"\pm", "->": r"\to", "oo": r"\infty", "-": "-", "*": r"\,"}
TYPED |= {"...": r"\dots", "... .": r"\dots."}
STEMS = "alpha|theta|kappa|lambda|delta|eta|phi|pi|mu|nu|lam"
LETTER_OR_SIGN = re.compile(
    rf"((?<!\w)(?<!\w-)(?:{STEMS})(?:_(?:plus|minus|\w|[+-])|\*(?!\())?(?!\w)|(?<!\w)[A-Za-z]_\w(?!\w)|<=|>="
    r"|\+-|±|->|\.\.\.(?: \.)?|(?<!\w)oo(?!\w)|(?<![\w)-])-(?=[\w.])|(?<=\w)\*(?=\())"
)


def _symbol(name: str) -> str:
    if name in TYPED:
        return f"${TYPED[name]}$"
    stem, _, below = name.rstrip("*").partition("_")
    below = {"plus": "+", "minus": "-"}.get(below, below)
    base = {"lam": r"\lambda", "phi": r"\varphi"}.get(stem, stem if len(stem) == 1 else rf"\{stem}")
    return f"${base}{f'_{{{below}}}' if below else ''}{'^*' if name.endswith('*') else ''}$"


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


def tables(results: Sequence[Result], sections: Iterable[str] = ()) -> str:
    """Three tables in LaTeX (the counts, the errata, and every claim), for the packages longtable and booktabs."""
    parts = [
        "% \\usepackage{booktabs,longtable}",
        _table("lr", ("verdict", "claims"), [[name, str(number)] for name, number in counts(results).items()]),
        _table(
            r"p{.24\linewidth}p{.68\linewidth}", ("claim", "erratum"), [_erratum(r) for r in errata(results, sections)]
        ),
        _table(
            r"p{.28\linewidth}p{.13\linewidth}p{.49\linewidth}",
            ("claim", "verdict", "what is true"),
            [[_code(r.id), r.verdict.value, _words(r.value or r.derived or "--")] for r in results],
        ),
    ]
    return "\n\n".join(parts) + "\n"


def escaped(text: str) -> str:
    """The text with LaTeX's special characters escaped.

    >>> print(escaped("50 % of a_1"))
    50 \\% of a\\_1
    """
    return "".join(SPECIAL.get(letter, letter) for letter in text)


def _erratum(result: Result) -> list[str]:
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
