"""The report as one page of HTML that needs no network, and as a LaTeX article.

The page embeds its pictures and certificates, and has formulas as MathML; the article's pictures are separate PDF
files.
"""

import json
from collections.abc import Iterable, Sequence
from functools import partial
from importlib.resources import files
from itertools import groupby

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from verification.paper.report.findings import escaped, tex
from verification.paper.report.mathml import font_style, formula, mathml, remark
from verification.paper.report.page import address
from verification.reports.asked import FILE, Parts
from verification.reports.blocks import Block, Certificate, Formula, Known, Listing, Paragraph, Picture, ShownNumber
from verification.reports.report import Report

MEANINGS = {
    Known.EXACT: "a closed form, or an exact fact",
    Known.PROVED: "enclosed in balls, with a proof; the radius is an upper bound",
    Known.FLOAT: "solved for in float64 to rounding, and not proved",
    Known.SAMPLED: "from random or gridded samples; the error is a standard error or half a 95 % interval",
}

STEPS = {  # in words
    "scene": "the scene",
    "slap": "the slap map",
    "portrait": "phase portraits",
    "diagram": "the bifurcation diagram",
    "plane": "the plane of both parameters",
    "census": "attractors and their basins",
    "derivation": "thresholds in closed form",
    "families": "families of cycles",
    "proofs": "proofs of events",
    "life": "pictures of families",
    "curves": "curves of events",
    "crises": "the search for tangencies",
    "tangency": "proofs of tangencies",
    "regions": "regions of coexistence",
    "chaos": "chaotic attractors told apart",
    "work": "error against run time",
}
FEW = 4  # certificates that are not folded
FRAME = '<div class="{}" tabindex="0" role="group" aria-label="{}">{}</div>'  # can be scrolled by keyboard


def page(report: Report, parts: Parts) -> str:
    """The whole page as HTML. Two runs differ in computing times, and in how many steps they completed."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"remark": remark, "said": said, "further": further}
    environment.filters["together"] = partial(together, parts=parts)
    template = environment.from_string((files("verification.reports") / "page.html").read_text(encoding="utf-8"))
    asked = report.asked
    return template.render(
        title=asked.title,
        formulas=font_style(),
        scene=asked.scene.text,
        file=FILE,
        address=address("application/toml", asked.scene_file().encode()),
        report=report,
        asked=asked,
        meanings=[(tag(known), words) for known, words in MEANINGS.items()],
        made=", ".join(f"{name} {number}" for name, number in report.versions.items()),
        again=asked.command("report", *again(report)),
    )


def further(left: Iterable[str]) -> str:
    """The kinds of the steps for which there was no time, in words and without repetition.

    >>> further(("families-0", "families-1", "diagram-1"))
    'families of cycles, the bifurcation diagram'
    """
    return ", ".join(dict.fromkeys(STEPS[name.split("-")[0]] for name in left))


def said(text: str) -> Markup:
    """A formula as MathML, or any other text as words, in HTML."""
    return formula(text) or remark(text)


def again(report: Report) -> list[str]:
    """The options that produce the same report again."""
    asked = report.asked
    at = [f"--at {','.join(asked.at)}"] if asked.parameter == "lam" else []
    looked = [*at, f"--period {asked.period}", f"--digits {asked.digits}"]
    both = [asked.both] if asked.second else []
    return [asked.varied, *both, *looked, f"--seed {asked.seed}", "--out FILE.html"]


def tag(known: Known) -> Markup:
    """A mark in HTML, beside a number, that says how the number is known."""
    return Markup('<span class="known {}">{}</span>').format(known.name.lower(), known.value.split(",")[0])


def shown(block: Block, parts: Parts) -> Markup:
    """A block as HTML."""
    if isinstance(block, Paragraph):
        return Markup("<p>{}</p>").format(remark(block.text))
    if isinstance(block, Formula):
        head = Markup('<p class="name">{} {}</p>').format(remark(block.name), tag(block.known))
        return head + Markup(FRAME).format("formula", block.name, mathml(block.latex, display=True))
    if isinstance(block, Listing):
        return _table(block)
    if isinstance(block, Picture):
        return _figure(block, parts)
    return _certificate(block)


def together(blocks: Sequence[Block], parts: Parts) -> Markup:
    """The blocks of a section as HTML; several certificates in a row are folded into one line."""
    found = Markup("")
    for certificates, row in groupby(blocks, lambda block: isinstance(block, Certificate)):
        made = [shown(block, parts) for block in row]
        inside = Markup("").join(made)
        folded = Markup("<details><summary>{} certificates</summary>{}</details>").format(len(made), inside)
        found += folded if certificates and len(made) > FEW else inside
    return found


def _command(text: str) -> Markup:
    return Markup('<p class="command"><code>{}</code></p>').format(text) if text else Markup("")


def _table(block: Listing) -> Markup:
    head = Markup("").join(Markup('<th scope="col">{}</th>').format(remark(name)) for name in block.columns)
    rows = Markup("").join(
        Markup("<tr>{}</tr>").format(Markup("").join(Markup("<td>{}</td>").format(_cell(cell)) for cell in row))
        for row in block.rows
    )
    caption = Markup('<p class="caption">{}</p>').format(remark(block.caption))
    table = Markup("<table><thead><tr>{}</tr></thead><tbody>{}</tbody></table>").format(head, rows)
    return caption + Markup(FRAME).format("table", block.caption.split(":")[0][:60], table) + _command(block.command)


def _cell(cell: str | ShownNumber) -> Markup:
    if isinstance(cell, str):
        return remark(cell)
    shown = said(cell.value) if cell.known is Known.EXACT else remark(cell.words)
    return Markup("{} {}").format(shown, tag(cell.known))


def _figure(block: Picture, parts: Parts) -> Markup:
    path = parts.picture(block.name)
    if not path.exists():
        return Markup("<p>{}</p>").format(f"The picture {block.name} is not among the parts.")
    drawn = Markup('<img src="{}" alt="{}">').format(address("image/svg+xml", path.read_bytes()), block.alt)
    image = Markup(FRAME).format("picture", f"{block.alt}, picture", drawn)
    button = Markup('<button type="button" class="enlarge">enlarge</button>')
    caption = Markup("<figcaption>{}</figcaption>").format(remark(block.caption))
    return Markup('<figure id="figure-{}">{}</figure>').format(
        block.name, image + button + caption + _command(block.command)
    )


def _certificate(block: Certificate) -> Markup:
    document = json.dumps(dict(block.document), indent=1)
    return Markup(
        '<p class="certificate"><a download="{0}.json" href="{1}">certificate {0}.json</a>: {2} '
        "<code>pinball check {0}.json</code></p>"
    ).format(block.name, address("application/json", document.encode()), remark(block.title))


HEAD = r"""\documentclass{article}
\usepackage[a4paper,margin=2.2cm]{geometry}
\PassOptionsToPackage{obeyspaces,spaces}{url}
\usepackage{amsmath,array,graphicx,longtable,xurl}
\setlength{\LTleft}{0pt}
\usepackage[T1]{fontenc}
\usepackage{textcomp}
\setlength{\parindent}{0pt}\setlength{\parskip}{4pt}
"""
LEAST = 7.0  # letters of a column


def latex(report: Report, parts: Parts) -> str:
    """The whole report as a LaTeX document."""
    asked = report.asked
    lines = [HEAD, r"\begin{document}", rf"\section*{{What becomes of {tex(asked.title)}}}"]
    lines += [rf"\url{{{_tex_address(asked.scene.text)}}}", ""]
    for section in report.sections:
        lines += [rf"\section{{{tex(section.title)}}}", *(typeset(each, parts) for each in section.blocks)]
    made = ", ".join(f"{name} {number}" for name, number in report.versions.items())
    lines += [tex(f"Made in {report.seconds:.0f} s with {made}; seed {asked.seed}."), r"\end{document}"]
    return "\n\n".join(lines) + "\n"


def typeset(given: Block, parts: Parts) -> str:
    """A block in LaTeX."""
    if isinstance(given, Paragraph):
        return tex(given.text)
    if isinstance(given, Formula):
        return rf"\emph{{{tex(given.name)}}} ({given.known.value})" + f"\n\\[ {given.latex} \\]"
    if isinstance(given, Listing):
        whole = rf"\dimexpr(\linewidth-{2 * len(given.columns)}\tabcolsep)*"
        width = "".join(rf">{{\raggedright\arraybackslash}}p{{{whole}{x}/100\relax}}" for x in _shares(given))
        head, *rows = (" & ".join(_tex_cell(cell) for cell in row) + r" \\" for row in (given.columns, *given.rows))
        table = "\n".join([rf"{{\small\begin{{longtable}}{{{width}}}", head, r"\hline", *rows, r"\end{longtable}}"])
        return f"{tex(given.caption)}\n\n{table}{_tex_command(given.command)}"
    if isinstance(given, Picture):
        path = (parts.folder / f"{given.name}.pdf").resolve()
        image = rf"\includegraphics[width=\linewidth,height=.4\textheight,keepaspectratio]{{{path}}}"
        return f"\\begin{{center}}{image}\\end{{center}}\n{tex(given.caption)}{_tex_command(given.command)}"
    return _tex_certificate(given)


def _shares(given: Listing) -> list[int]:
    """The widths of a table's columns in per cent, from their longest words and texts."""
    columns = zip(given.columns, *given.rows, strict=True)
    texts = [[cell if isinstance(cell, str) else f"{cell.words} sampled" for cell in column] for column in columns]
    sizes = [max(max([len(text) / 3, *map(len, text.split())]) for text in column) for column in texts]
    return [int(100 * max(size, LEAST) / sum(max(size, LEAST) for size in sizes)) for size in sizes]


def _tex_certificate(given: Certificate) -> str:
    return rf"\texttt{{{escaped(given.name)}.json}}: {tex(given.title)}"


def _tex_cell(cell: str | ShownNumber) -> str:
    if isinstance(cell, str):
        return tex(cell)
    return rf"{tex(cell.words)} \emph{{\footnotesize {cell.known.value.split(',')[0]}}}"


def _tex_command(text: str) -> str:
    return rf"\par{{\footnotesize\url{{{_tex_address(text)}}}}}" if text else ""


def _tex_address(text: str) -> str:
    r"""Text for `\url`, with per cent signs escaped, as TeX would read them as comments."""
    return text.replace("%", r"\%")
