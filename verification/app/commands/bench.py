"""Timing and caching: `pinball bench` times one bounce, `pinball work` a whole question, `pinball cache` shows or
clears the files kept between runs."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from numeric.lowering.files import write_whole
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, Whole, json_option
from verification.app.lines import table
from verification.app.scene import optional_scene_options

if TYPE_CHECKING:
    from rich.console import Console

    from verification.measure.extremes.orbits import Accuracy
    from verification.measure.work.calls import Call
    from verification.measure.work.question import Question
    from verification.measure.work.row import MethodResult


@click.command(epilog="Example: pinball bench --scene egg --digits 20 --digits 100 --json bench.json")
@click.option("--scene", "scenes", multiple=True, metavar="TABLE", help="Only these tables; all if left out.")
@click.option("--digits", multiple=True, type=Whole(10, 1000), help="For mpmath and arb; 20, 100 and 1000.")
@click.option("--runs", type=Whole(1, 1000), default=5, show_default=True, help="The best of how many.")
@click.option("--baselines/--no-baselines", default=True, show_default=True, help="Also the code in benchmarks/.")
@click.option("--accuracy/--no-accuracy", default=True, show_default=True, help="The errors of labelled hard cases.")
@click.option("--calls/--no-calls", default=True, show_default=True, help="Whole calls against the kernel inside.")
@click.option(
    "--questions/--no-questions",
    default=True,
    show_default=True,
    help="What users type, from start to last line, beside plain scripts; without --scene.",
)
@click.option("--compare", metavar="FILE", help="Compare with an earlier run: its --json FILE.")
@json_option
def command(
    scenes: tuple[str, ...],
    digits: tuple[int, ...],
    runs: int,
    baselines: bool,
    accuracy: bool,
    calls: bool,
    questions: bool,
    compare: str | None,
    output: Output,
) -> int:
    """Error against run time of each method that computes a bounce, at lam = 0.95.

    Errors of float64 are measured against 50 digits, those of mpmath and arb against a proved enclosure with 30 digits
    more than theirs. In the diagrams time grows to the right and error upwards; a capital letter is on the Pareto
    front: no other method is both faster and more exact. The times of whole calls, of questions, and of tables other
    than the egg are divided by reference times, and each ratio has a limit. The exit status is 1 when a ratio exceeds
    its limit or, with --compare, when a time changed by a factor of more than 1.5 against the other times of its run,
    or an error grew tenfold.
    """
    from verification.measure.extremes import orbits as labelled
    from verification.measure.work import bench
    from verification.measure.work.bench import MISSING, baseline_rows, is_checkout
    from verification.measure.work.calls import call_rows, pieces_at_rest, table_rows
    from verification.measure.work.choice import earlier, moved, of_bench
    from verification.measure.work.plain import QUESTIONS, asked_rows
    from verification.measure.work.row import machine_facts
    from verification.measure.work.scaling import sweep_rows

    before = earlier(Path(compare)) if compare else []
    known = (*labelled.SCENES, *labelled.RADII)
    unknown = [name for name in scenes if name not in known]
    if unknown:
        raise ValueError(f"--scene = {unknown[0]} is no table; accepted: {', '.join(known)}")
    rows: list[MethodResult] = []
    cases: list[Accuracy] = []
    whole: list[Call] = []
    asked: list[Call] = []
    chosen = scenes or known
    known_questions = QUESTIONS if questions and not scenes else ()
    with output.progress("Measuring", 3 * len(chosen) + 2 * (not scenes) + len(known_questions)) as step:
        for name in chosen:
            step(f"{name}, float64")
            rows += bench.kernel_rows(name, runs)
            rows += baseline_rows(name, runs) if baselines else []
            whole += call_rows(name, runs) if calls else []
            step(f"{name}, multiprecision")
            rows += bench.multiprecision_rows(name, digits or (20, 100, 1000), runs) if name in labelled.SCENES else []
            step(f"{name}, hard cases")
            cases += labelled.accuracy(name) if accuracy else []
        pieces: list[MethodResult] = []
        if not scenes:
            step("tables beside the egg")
            pieces = list(table_rows(runs, baselines))
            whole += pieces_at_rest(min(runs, 3)) if calls else []
            step("sweeps by several workers")
            whole += sweep_rows() if calls else []
        for question in known_questions:
            step(question.typed)
            asked += asked_rows(min(runs, 3), [question])
    facts = machine_facts()
    measured = [bench.as_data(row) for row in (*rows, *pieces)]
    changes = moved([row for row in before if row.question in chosen], of_bench(measured)) if compare else []
    document = {"machine": facts, "rows": measured, "calls": [call.as_data() for call in whole]}
    document["questions"] = [call.as_data() for call in asked]
    document |= {"accuracy": [case._asdict() | {"error_unit": "2**-52"} for case in cases]}
    output.write(document | ({"moved": changes} if compare else {}))
    for name in chosen:
        show(output.console, name, [row for row in rows if row.question == name])
    good = show_tables(output.console, pieces)
    show_calls(output.console, "whole calls, compared with the work inside", whole)
    show_calls(output.console, "questions as processes, compared with plain scripts", asked)
    if baselines and not is_checkout():
        output.console.print(f"\n{MISSING}")
    if cases:
        show_cases(output.console, cases)
    output.console.print(
        "\none core unless said otherwise; " + ", ".join(f"{key} {value}" for key, value in facts.items())
    )
    if compare:
        output.console.print(f"\nsince {compare}: " + ("; ".join(changes) or "nothing moved by more than a factor 1.5"))
    return FAILED if changes or not good or any(call.ratio > call.bar for call in (*whole, *asked)) else DONE


def show(console: "Console", name: str, rows: "list[MethodResult]") -> None:
    """Prints a scene's rows, with ratios to the kernel's time and marks on the Pareto front, and two diagrams."""
    from verification.measure.extremes.orbits import RADII, SCENES
    from verification.measure.work.row import diagram, duration, front

    best = front(row for row in rows if row.setting == rows[0].setting)
    on = {i for i, row in enumerate(rows) if row in best}
    shape = ", ".join(f"{key} = {value}" for key, value in SCENES.get(name, {"r(theta)": RADII.get(name)}).items())
    console.print(f"\n{name} {shape}".rstrip())
    lines = [
        (
            f"{'*' if i in on else ' '} {chr(ord('a') + i)}",
            f"{row.arithmetic} {row.method}",
            duration(row.seconds),
            f"{row.seconds / rows[0].seconds:.3g}",
            "-" if row.error is None else f"{row.error:.3g}",
        )
        for i, row in enumerate(rows)
    ]
    listed(console, ("", "way", "time a bounce", "ratio", "error / 2**-52"), lines)
    for title, kept in (("every arithmetic", rows), ("float64 alone", [r for r in rows if r.arithmetic == "float64"])):
        console.print(f"  {title}: error of one bounce (upwards) against its time")
        console.print(diagram([(row.seconds, row.error) for row in kept], on))


def listed(console: "Console", names: Sequence[str], lines: Sequence[Sequence[str]]) -> None:
    """Prints a table."""
    for line in table(names, lines):
        console.print(line)


def show_tables(console: "Console", rows: "Sequence[MethodResult]") -> bool:
    """Prints times of many tables as multiples of the egg's or the square's; False if a ratio exceeds its limit."""
    from verification.measure.work.bench import SCALAR
    from verification.measure.work.calls import BARS, KERNEL
    from verification.measure.work.row import duration

    times, good, lines = {(row.question, row.method): row.seconds for row in rows}, True, []
    names = [name for name, kernel in times if kernel == KERNEL]
    for name in names:
        against, bar = BARS[name]
        spent, scalar = times[name, KERNEL], times.get((name, SCALAR))
        ratio = spent / times[against, KERNEL]
        over = bar is not None and ratio > bar
        good = good and not over
        limit = f"{'-' if bar is None else f'{bar:g}'}{' *' if over else ''}"
        beside = (duration(scalar), f"{scalar / spent:.1f}") if scalar else ("-", "-")
        lines.append((name, f"{ratio:.2f}", limit, f"of the {against}", duration(spent), *beside))
    if names:
        console.print("\ntables at lam = 0.999999; * marks ratios above the bar")
        listed(console, ("table", "ratio", "bar", "", "time a bounce", "scalar numba", "times"), lines)
        if (names[0], SCALAR) not in times:
            console.print("scalar numba was not measured: it needs numba, and a checkout or the source distribution")
    return good


def show_calls(console: "Console", title: str, calls: "Sequence[Call]") -> None:
    """Prints the times of whole calls with the limits of their ratios, and marks those that exceed them."""
    from verification.measure.work.row import duration

    if not calls:
        return
    console.print(f"\n{title}; * marks ratios above the bar")
    lines = [
        (
            duration(one.seconds),
            f"{one.ratio:.3g}",
            f"{one.bar:.3g}{' *' if one.ratio > one.bar else ''}",
            f"{one.scene} {one.call.splitlines()[-1]}".strip(),
            one.against,
        )
        for one in calls
    ]
    listed(console, ("time", "ratio", "bar", "call", "against"), lines)


def show_cases(console: "Console", cases: "Sequence[Accuracy]") -> None:
    """Prints the errors of the hard cases; marks position errors above 4 units and direction errors above 8."""
    console.print(
        "\naccuracy of one bounce in float64, largest errors in units of 2**-52; * marks positions above 4, "
        "directions above 8"
    )
    lines = [
        (
            f"{case.scene}, {case.case}",
            str(case.particles),
            f"{case.position:.3g}",
            f"{case.direction:.3g}",
            f"{case.position_by_condition:.2g}",
            f"{case.direction_by_condition:.2g}",
            "*" if case.position > 4 or case.direction > 8 else "",
        )
        for case in cases
    ]
    listed(console, ("case", "particles", "position", "direction", "/condition", "/condition", ""), lines)


ENDINGS = (".png", ".pdf", ".svg")


@click.command(epilog="Example: pinball work step egg --alpha 0.08 --lam 0.5 --digits 100 --plot step.png")
@click.argument("question", required=False)
@optional_scene_options
@click.option("--plot", "--out", "out", metavar="FILE", help="The diagram, a .png, .pdf or .svg; of one question.")
@click.option("--runs", type=Whole(1, 1000), default=5, show_default=True, help="The median of how many.")
@click.option("--digits", "--most-digits", "digits", type=Whole(16, 1000), help="For mpmath, arb, at most.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of random particles; with a table.")
@json_option
def work_command(
    question: str | None,
    scene: Scene | None,
    bare: dict[str, Any],
    out: str | None,
    runs: int,
    digits: int | None,
    seed: int,
    output: Output,
) -> int:
    """Error against run time for a whole question, in every arithmetic and by plain scripts.

    With a table, QUESTION is step, jacobian, orbit, cycle, fold or exponent, for that scene; the cycle is one of the
    least period from 2 to 4 at which one is found, attracting if possible. Without a table it is step-egg,
    step-cardioid, jacobian, cycle-2, cycle-3, cycle-64, lambda-star, fold-3, doubling, exponent-cycle, exponent-chaos,
    arclength, arclength-inverse or slap-infimum, and all of these if left out. Errors are distances from a certified
    ball. In the printed table `*` marks the Pareto front: no method is both quicker and more exact; `!` marks a method
    whose error is larger than it claims.
    """
    from verification.measure.work.bench import MISSING, is_checkout
    from verification.measure.work.choice import QUESTIONS
    from verification.measure.work.choice import question as asked
    from verification.measure.work.question import measured
    from verification.measure.work.row import facts, footer, plain
    from verification.measure.work.scenes import QUESTIONS as OF_SCENES

    path = _target(question, out, QUESTIONS if scene is None else OF_SCENES)
    for option, value in bare.items():
        if scene is None and value is not None:
            raise ValueError(f"--{option} {value} is for a table, and none is given")
    makers: list[Callable[[], Question]] = [partial(asked, name) for name in QUESTIONS]
    if scene is not None:
        if question not in OF_SCENES:
            raise ValueError(f"QUESTION = {question} is no question about a scene; accepted: {', '.join(OF_SCENES)}")
        makers = [partial(OF_SCENES[question], scene, seed)]
    elif question in OF_SCENES and question not in QUESTIONS:
        raise ValueError(f"{question} needs a table, as in pinball work {question} circle --lam 0.5")
    elif question is not None:
        if question not in QUESTIONS:
            asked(question)  # refuses it in one sentence
        makers = [partial(asked, question)]
    known, questions, rows = facts(), list["Question"](), list["MethodResult"]()
    with output.progress("Measuring", len(makers)) as step:
        for make in makers:
            questions.append(make())
            step(questions[-1].title)
            rows += measured(questions[-1], runs, digits or (1000 if scene is None else 100))
    output.write(
        {"machine": known, "questions": [q.document() for q in questions], "rows": [r.to_dict() for r in rows]}
    )
    for each in questions:
        own = [row for row in rows if row.question == each.name]
        sure = "a certified ball" if each.certified else "a long run with its error bar, not a proof"
        output.console.print(
            f"\n{each.title}: {each.answers}\nvalue {each.values()}\nerror {each.unit}, against {sure}"
        )
        output.console.print(plain(own))
    if scene is None and not is_checkout():
        output.console.print(f"\n{MISSING}")
    if path is not None:
        from verification.measure.work.figure import drawn, image

        (only,) = questions
        write_whole(path, image(drawn(only.title, only.unit, rows, known), path.suffix[1:]))
        output.console.print(f"{path}: the diagram")
    output.console.print(f"\none core; {footer(known)}")
    return DONE


def _target(question: str | None, out: str | None, known: Iterable[str]) -> Path | None:
    """The path of the diagram, or None; a path that cannot be written is refused before anything is measured."""
    if out is None:
        return None
    path = Path(out)
    if question is None:
        raise ValueError(f"--plot {out} needs one QUESTION, as a diagram shows one; accepted: {', '.join(known)}")
    if path.suffix not in ENDINGS or not path.parent.is_dir():
        raise ValueError(
            f"--plot = {out} cannot be written; accepted: {', '.join(ENDINGS)} files in a folder that is there"
        )
    return path


@click.command(epilog="Example: pinball cache --clear")
@click.option("--where", is_flag=True, help="Print the folder and nothing else.")
@click.option("--clear", is_flag=True, help="Remove the kept tables and kernels; they are made again when needed.")
@json_option
def cache_command(where: bool, clear: bool, output: Output) -> int:
    """Shows in which folder tables and compiled kernels are kept between runs, and the folder's size.

    PINBALL_CACHE names another folder, and an empty PINBALL_CACHE switches the cache off. The folder is for its user
    alone: one that belongs to somebody else, or that others can write, is not used, and the exit status is 1.
    """
    from numeric.lowering import cache

    folder = cache.folder()
    removed, freed = cache.clear() if clear else (0, 0)
    kept = cache.entries()
    size, why = sum(entry[1] for entry in kept), None if folder is None else cache.distrust(folder)
    document = {"folder": folder, "entries": len(kept), "bytes": size, "limit": cache.LIMIT, "not_used_because": why}
    output.write(document | {"removed": removed, "removed_bytes": freed})
    if where:
        output.console.print(folder or "")
    elif folder is None:
        output.console.print("the cache is switched off: PINBALL_CACHE is empty, or there is no home folder")
    else:
        if clear:
            output.console.print(f"{removed} files removed, {freed / 1e6:.1f} MB")
        holds = f"{len(kept)} files, {size / 1e6:.1f} of at most {cache.LIMIT / 1e6:.0f} MB"
        output.console.print(f"{folder}: {holds}" if why is None else f"{folder} is not used: {why}")
    return DONE if why is None else FAILED
