"""What moved between two runs, by ratios of times within each run, so that machines and their load cancel.

How much longer a run took is the median over the rows of a question, and over the questions; what is told is what
differs from that. Lower quartiles are compared, which other work on a machine disturbs least.

The questions of the work-precision diagrams, by name; each is made when it is asked.
"""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import Decimal
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

from verification.measure.speed.baselines import duration
from verification.measure.work.question import Question
from verification.measure.work.row import Row, short, timed

MOVED = 1.5  # the factor from which on a change is told
WORSE = 10  # times the error is told as well
Rows = dict[tuple[str, str], Row]


def moved(before: Sequence[Row], after: Sequence[Row]) -> list[str]:
    """A sentence for each row, or question as a whole, whose time changed by more than a factor 1.5 beside the others.

    Changes within the quartiles of both runs are not told; errors that grew tenfold, and answers lost, are.
    """
    pairs = {name: (_of(before, name), _of(after, name)) for name in dict.fromkeys(row.question for row in after)}
    units = {name: _unit(old, new) for name, (old, new) in pairs.items()}
    whole = median(units.values()) if units else 1.0
    said = []
    for name, (old, new) in pairs.items():
        said += [f"{name}: {' '.join(key)} is gone" for key in old if key not in new]
        said += [f"{name}: {' '.join(key)} is new" for key in new if key not in old]
        said += [f"{name}: as a whole it is {way}" for way in _ways(units[name] / whole)]
        for key in new.keys() & old.keys():
            said += [f"{name}: {' '.join(key)} {change}" for change in changes(old[key], new[key], units[name])]
    return sorted(said)


def changes(old: Row, new: Row, unit: float) -> list[str]:
    """What changed in a row, when everything took `unit` times as long."""
    if old.error is not None and new.error is None:
        return [f"has no answer any more: {new.failure}"]
    told = []
    if old.error and new.error and new.error > WORSE * old.error:
        told.append(f"is off by {short(new.error)}, it was {short(old.error)}")
    apart = new.quartiles[0] > old.quartiles[1] * unit or new.quartiles[1] < old.quartiles[0] * unit
    if apart and old.quartiles[0]:
        told += [f"is {way}: {duration(new.seconds)}" for way in _ways(new.quartiles[0] / old.quartiles[0] / unit)]
    return told


def _ways(factor: float) -> list[str]:
    if 1 / MOVED <= factor <= MOVED:
        return []
    return [f"{max(factor, 1 / factor):.2g} times {'slower' if factor > 1 else 'quicker'}"]


def _of(rows: Sequence[Row], name: str) -> Rows:
    return {(row.method, row.setting): row for row in rows if row.question == name}


def _unit(old: Rows, new: Rows) -> float:
    """How many times as long the rows took that both have, in the median."""
    ratios = [new[key].quartiles[0] / old[key].quartiles[0] for key in new if key in old and old[key].quartiles[0]]
    return median(ratios) if ratios else 1.0


def of_bench(rows: Iterable[Mapping[str, Any]]) -> list[Row]:
    """The rows of a document of `pinball bench`: a question for each table, a method for each way to bounce."""
    return [
        timed(
            row["scene"],
            f"{row['arithmetic']} {row['kernel']}",
            [row["seconds_per_bounce"]],
            error=None if row["error"] is None else Decimal(str(row["error"])),
        )
        for row in rows
    ]


def earlier(path: Path) -> list[Row]:
    """The rows of a document that `pinball bench --json` wrote before."""
    try:
        return of_bench(json.loads(path.read_text(encoding="utf-8"))["rows"])
    except (OSError, ValueError, KeyError, TypeError, ArithmeticError) as why:
        raise ValueError(
            f"--compare = {path} cannot be read ({why}); accepted: a file of pinball bench --json"
        ) from why


def _made(module: str, maker: str, *arguments: str) -> Callable[[], Question]:
    def make() -> Question:
        found: Question = getattr(import_module(f"verification.measure.work.{module}"), maker)(*arguments)
        return found

    return make


QUESTIONS: Mapping[str, Callable[[], Question]] = {
    "step-egg": _made("flights", "steps", "egg"),
    "step-cardioid": _made("flights", "steps", "cardioid"),
    "jacobian": _made("flights", "jacobians"),
    "cycle-2": _made("cycles", "period_2"),
    "cycle-3": _made("cycles", "period_3"),
    "cycle-64": _made("cycles", "period_64"),
    "lambda-star": _made("values", "corner_orbit"),
    "fold-3": _made("cycles", "fold"),
    "doubling": _made("cycles", "doublings"),
    "exponent-cycle": _made("exponents", "of_a_cycle"),
    "exponent-chaos": _made("exponents", "of_chaos"),
    "arclength": _made("lengths", "lengths"),
    "arclength-inverse": _made("lengths", "parameters"),
    "slap-infimum": _made("values", "slap_infimum"),
}


def question(name: str) -> Question:
    """The question called `name`.

    >>> question("lambda-star").name
    'lambda-star'
    """
    if name not in QUESTIONS:
        raise ValueError(f"QUESTION = {name} is none that is measured; accepted: {', '.join(QUESTIONS)}")
    return QUESTIONS[name]()
