"""Measures every work-precision diagram and writes the chapter: `python benchmarks/work_precision.py`.

It writes docs/work_precision.md, benchmarks/records/work_precision.json, docs/figures/work-*.svg, and the table from
which `verification.measure.work.choice` selects an arithmetic. `--question NAME` measures one question and keeps the
others; `--write` writes page and figures from the JSON without measuring. `--compare` writes nothing: it measures and
lists changes against the committed JSON, by ratios of times within each run.
"""

import argparse
import json
import sys
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from verification.measure.work.choice import QUESTIONS, TABLE, moved, question, written
from verification.measure.work.figure import drawn, image, paragraph
from verification.measure.work.question import measured
from verification.measure.work.row import MethodResult, baseline, facts, footer, front, markdown

ROOT = Path(__file__).resolve().parent.parent
DOCS, DATA = ROOT / "docs", ROOT / "benchmarks" / "records" / "work_precision.json"
PAGE, FIGURES = DOCS / "work_precision.md", DOCS / "figures"
HEAD = """# Error against run time, question by question

Which method is quickest for a given accuracy, and what does it cost? `pinball work NAME` draws one of these
diagrams on your machine. Your own table may be named after the question, as in `pinball work cycle egg --alpha 0.08
--lam 0.5`, and in Python {{py:func}}`~verification.measure.work.scenes.work_precision` does the same. The question
`cycle` then takes a cycle of the least period from 2 to 4 at which one is found, and of these one that attracts, if any
does.

Each diagram shows the error of an answer against the seconds it took, with one line for each method. The marks on a
line are the method's settings: numbers of digits, or tolerances. Errors are distances from a *certified ball*, so they
are known and not estimated. Full marks lie on the Pareto front, the grey step line: no other mark is both quicker and
more accurate. A cross marks an error that is larger than the method claims. Times are processor time of one core for
one answer, medians with quartiles as bars, after a first call that is not counted. All methods start from the same
values, rounded to a few decimals. *Certified* includes the whole proof, for example that each landing is the first hit
and the period the least. `benchmarks/work_precision.py` writes this page from `benchmarks/records/work_precision.json`,
which has every row.

Made with {footer}

Compare ratios, not seconds. [The dossier](numerics.md) has the time of a bounce on each table.
"""


def main():
    options = arguments()
    console = Console(stderr=True)
    before = json.loads(DATA.read_text()) if DATA.exists() else {"machine": {}, "questions": {}, "rows": []}
    names = [options.question] if options.question else list(QUESTIONS)
    if options.write:
        publish(before)
        return 0
    known, asked, rows = facts(), {}, []
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("Measuring", total=len(names))
        for name in names:
            bar.update(task, description=name)
            made = question(name)
            asked[name] = made.document()
            rows += measured(made, options.runs)
            bar.advance(task)
            if not console.is_terminal:
                console.print(name)
    if options.compare:
        changes = moved([MethodResult.from_dict(row) for row in before["rows"] if row["question"] in names], rows)
        sys.stdout.write("\n".join(changes or ["nothing moved by more than a factor 1.5"]) + "\n")
        return 1 if changes else 0
    others = [row for row in before["rows"] if row["question"] not in names]
    together = others + [row.to_dict() for row in rows]
    together.sort(key=lambda row: list(QUESTIONS).index(row["question"]))
    document = {"machine": known, "questions": before["questions"] | asked, "rows": together}
    DATA.write_text(text_of(document))
    publish(document)
    return 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--question", choices=list(QUESTIONS))
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--write", action="store_true")
    return parser.parse_args()


def text_of(document):
    """The JSON document with one row on each line, so that differences are readable."""
    rows = ",\n".join("  " + json.dumps(row) for row in document["rows"])
    head = json.dumps({key: document[key] for key in ("machine", "questions")}, indent=1)
    return head.removesuffix("\n}") + f',\n "rows": [\n{rows}\n ]\n}}\n'


def publish(document):
    """Writes the page, the figures and the table of choices, from the document alone."""
    known, rows = document["machine"], [MethodResult.from_dict(row) for row in document["rows"]]
    TABLE.write_text(written(rows, known))
    FIGURES.mkdir(exist_ok=True)
    for name, about in document["questions"].items():
        own = [row for row in rows if row.question == name]
        drawing = drawn(about["title"], about["unit"], own, known)
        (FIGURES / f"work-{name}.svg").write_bytes(image(drawing))
    PAGE.write_text(page(document))


def page(document):
    """The text of the chapter."""
    rows = [MethodResult.from_dict(row) for row in document["rows"]]
    parts = [HEAD.format(footer=footer(document["machine"]))]
    for name in QUESTIONS:
        if name in document["questions"]:
            parts.append(section(document["questions"][name], [row for row in rows if row.question == name]))
    return "\n".join(parts)


def section(about, rows):
    """The section of one question: its figure, its sentences, its front."""
    truth = (
        ""
        if about["certified"]
        else " No proof is known: the reference is a long run, and its error is taken as four standard errors."
    )
    unit = "in radians" if about["unit"] == "radians" else about["unit"]
    return (
        f"## {about['title']}\n\n`{about['name']}`: {about['answers']}; error {unit}.{truth}\n\n"
        f"![Error against seconds: {about['title']}](figures/work-{about['name']}.svg)\n\n{paragraph(rows)}\n\n"
        f"The Pareto front, quickest first:\n\n{markdown(front(rows), baseline(rows))}\n"
    )


if __name__ == "__main__":
    sys.exit(main())
