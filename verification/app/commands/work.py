"""`pinball work`: error against run time for a whole question, as a table and a diagram."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from verification.app.shell.cli import DONE
from verification.app.shell.output import Output, json_option

if TYPE_CHECKING:
    from verification.measure.work.question import Question
    from verification.measure.work.row import Row

ENDINGS = (".png", ".pdf", ".svg")


@click.command(epilog="Example: pinball work lambda-star --most-digits 100 --out lambda-star.png")
@click.argument("question", required=False)
@click.option("--out", metavar="FILE", help="The diagram, a .png, .pdf or .svg file; for one question.")
@click.option("--runs", type=click.IntRange(1, 1000), default=5, show_default=True, help="The median of how many.")
@click.option("--most-digits", type=click.IntRange(16, 1000), default=1000, show_default=True, help="For mpmath, arb.")
@json_option
def command(question: str | None, out: str | None, runs: int, most_digits: int, output: Output) -> int:
    """Error against run time for a whole question: every arithmetic, and the ways that one would write first.

    QUESTION is step-egg, step-cardioid, jacobian, cycle-2, cycle-3, cycle-64, lambda-star, fold-3, doubling,
    exponent-cycle, exponent-chaos, arclength, arclength-inverse or slap-infimum; all of them if left out. Errors
    are distances from a certified ball. In the table `*` marks the Pareto front: nothing else is both quicker
    and more exact; `!` marks a method whose error is larger than it claims.
    """
    from verification.measure.speed.baselines import MISSING, is_checkout
    from verification.measure.work.compare import QUESTIONS
    from verification.measure.work.compare import question as asked
    from verification.measure.work.question import measured
    from verification.measure.work.row import facts, footer, plain

    path = _target(question, out)
    names = list(QUESTIONS) if question is None else [question]
    if question is not None and question not in QUESTIONS:
        asked(question)  # refuses it in one sentence
    known, questions, rows = facts(), list["Question"](), list["Row"]()
    with output.progress("Measuring", len(names)) as step:
        for name in names:
            step(name)
            questions.append(asked(name))
            rows += measured(questions[-1], runs, most_digits)
    output.write(
        {"machine": known, "questions": [described(q) for q in questions], "rows": [r.to_dict() for r in rows]}
    )
    for each in questions:
        own = [row for row in rows if row.question == each.name]
        sure = "a certified ball" if each.certified else "a long run with its error bar, not a proof"
        output.console.print(f"\n{each.title}: {each.answers}\nerror {each.unit}, against {sure}")
        output.console.print(plain(own))
    if not is_checkout():
        output.console.print(f"\n{MISSING}")
    if path is not None:
        from verification.measure.work.figure import drawn, image

        (only,) = questions
        path.write_bytes(image(drawn(only.title, only.unit, rows, known), path.suffix[1:]))
        output.console.print(f"{path}: the diagram")
    output.console.print(f"\none core; {footer(known)}")
    return DONE


def described(question: "Question") -> dict[str, str | bool]:
    """What a question is, for the JSON document."""
    return {name: getattr(question, name) for name in ("name", "title", "answers", "unit", "certified")}


def _target(question: str | None, out: str | None) -> Path | None:
    """The file of the diagram; refused before anything is measured."""
    if out is None:
        return None
    path = Path(out)
    if question is None:
        raise ValueError(f"--out {out} needs one QUESTION; a diagram shows one")
    if path.suffix not in ENDINGS or not path.parent.is_dir():
        raise ValueError(
            f"--out = {out} cannot be written; accepted: {', '.join(ENDINGS)} files in a folder that is there"
        )
    return path
