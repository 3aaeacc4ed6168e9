r"""The report as a LaTeX article that stands alone; its pictures are the PDF files among the parts."""

import re

from verification.paper.report.report import escaped
from verification.reports.asked import Parts
from verification.reports.blocks import Block, Certificate, Formula, Listing, Number, Picture, Words
from verification.reports.report import Report

HEAD = r"""\documentclass{article}
\usepackage[a4paper,margin=2.2cm]{geometry}
\usepackage{amsmath,graphicx,longtable,xurl}
\usepackage[T1]{fontenc}
\usepackage{textcomp}
\setlength{\parindent}{0pt}\setlength{\parskip}{4pt}
"""
GREEK = re.compile(r"(?<![A-Za-z\\])(lambda|lam|theta|alpha|phi|eta|kappa|nu)(?![A-Za-z])")


def latex(report: Report, parts: Parts) -> str:
    """The whole document."""
    asked = report.asked
    lines = [HEAD, r"\begin{document}", rf"\section*{{What becomes of {words(asked.title)}}}"]
    lines += [rf"\url{{{_address(asked.scene.text)}}}", ""]
    for section in report.sections:
        lines += [rf"\section{{{words(section.title)}}}", *(block(each, parts) for each in section.blocks)]
    made = ", ".join(f"{name} {number}" for name, number in report.versions.items())
    lines += [words(f"Made in {report.seconds:.0f} s with {made}; seed {asked.seed}."), r"\end{document}"]
    return "\n\n".join(lines) + "\n"


def words(text: str) -> str:
    r"""Text with its special signs escaped and the code's letters as the paper's.

    >>> words("lambda = 1/2, 50 %")
    '$\\lambda$ = 1/2, 50 \\%'
    """
    safe = escaped(text).replace("±", r"$\pm$")
    return GREEK.sub(lambda found: rf"$\{ {'lam': 'lambda', 'phi': 'varphi'}.get(found[1], found[1]) }$", safe)


def block(given: Block, parts: Parts) -> str:
    """A block in LaTeX."""
    if isinstance(given, Words):
        return words(given.text)
    if isinstance(given, Formula):
        return rf"\emph{{{words(given.name)}}} ({given.known.value})" + f"\n\\[ {given.latex} \\]"
    if isinstance(given, Listing):
        width = rf"p{{{0.92 / len(given.columns):.3f}\linewidth}}" * len(given.columns)
        rows = " \\\\\n".join(" & ".join(_cell(cell) for cell in row) for row in (given.columns, *given.rows))
        table = rf"{{\small\begin{{longtable}}{{{width}}}" + "\n" + rows + "\n" + r"\end{longtable}}"
        return f"{words(given.caption)}\n\n{table}{_command(given.command)}"
    if isinstance(given, Picture):
        path = (parts.folder / f"{given.name}.pdf").resolve()
        image = rf"\includegraphics[width=\linewidth,height=.4\textheight,keepaspectratio]{{{path}}}"
        return f"\\begin{{center}}{image}\\end{{center}}\n{words(given.caption)}{_command(given.command)}"
    return _certificate(given)


def _certificate(given: Certificate) -> str:
    return rf"\texttt{{{words(given.name)}.json}}: {words(str(given.document['name']))}"


def _cell(cell: str | Number) -> str:
    if isinstance(cell, str):
        return words(cell)
    return rf"{words(cell.words)} \emph{{\footnotesize {cell.known.value.split(',')[0]}}}"


def _command(text: str) -> str:
    return rf"\par{{\footnotesize\url{{{_address(text)}}}}}" if text else ""


def _address(text: str) -> str:
    r"""What `\url` takes: a per cent sign or a brace would be read by TeX."""
    return text.replace("%", r"\%").replace("{", r"\{").replace("}", r"\}")
