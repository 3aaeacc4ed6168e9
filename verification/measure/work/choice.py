"""What measured run times are used for: the cheapest arithmetic for a number of digits, and a comparison of two runs.

The table is `measured.json` beside this file, written by `benchmarks/work_precision.py`. A way counts for as many
digits as it promises, and only if it kept its promise where its answer was held against a certified ball. Seconds
are those of one machine; what carries over to others are their ratios.

An orbit is followed in float64 while enough of its digits survive, and beyond that by what the table says. A bounce
loses digits, as many as the decimal logarithm of what its derivative stretches by. The kernels say how many
an orbit loses; float64 keeps the rest of what one bounce promises.

Two runs are compared by ratios of times within each, so that machines and their load cancel. How much longer a run
took is the median over the rows of a question, and over the questions; reported is what differs from that. Lower
quartiles are compared, which other work on a machine disturbs least.
"""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from decimal import Decimal, InvalidOperation
from functools import cache
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from numeric import PinballMap
from numeric.pinball.sampling import Growth
from symbolic.tables import cardioid
from verification.measure.work.question import Question
from verification.measure.work.row import Row, duration, short, timed

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
    "lambda-star": _made("sought", "corner_orbit"),
    "fold-3": _made("cycles", "fold"),
    "doubling": _made("cycles", "doublings"),
    "exponent-cycle": _made("exponents", "of_a_cycle"),
    "exponent-chaos": _made("exponents", "of_chaos"),
    "arclength": _made("exponents", "lengths"),
    "arclength-inverse": _made("exponents", "parameters"),
    "slap-infimum": _made("sought", "slap_infimum"),
}


def question(name: str) -> Question:
    """The question called `name`.

    >>> question("lambda-star").name
    'lambda-star'
    """
    if name not in QUESTIONS:
        raise ValueError(f"QUESTION = {name} is none that is measured; accepted: {', '.join(QUESTIONS)}")
    return QUESTIONS[name]()


TABLE = Path(__file__).with_name("measured.json")


@dataclass(frozen=True)
class Entry:
    """A way that kept its promise: the digits that it promises, and its seconds for one answer."""

    method: str
    arithmetic: str
    setting: str
    digits: int
    seconds: float
    proved: bool


@dataclass(frozen=True)
class Choice:
    """What was picked for a number of digits, and why."""

    arithmetic: str
    method: str
    setting: str
    digits: int
    seconds: float
    why: str


def entries(rows: Iterable[Row]) -> list[Entry]:
    """The ways among some rows that can be picked: no textbook ones, none that was not held against the truth."""
    made = []
    for row in rows:
        if row.kept and row.promise and not row.textbook and row.method != "mpmath, no gmpy2":
            digits = row.digits or max(0, math.floor(-float(row.promise.log10())))
            made.append(Entry(row.method, row.arithmetic, row.setting, digits, row.seconds, row.proved))
    return made


def written(rows: Iterable[Row], machine: Mapping[str, str]) -> str:
    """The table of some rows as a file has it."""
    kept: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        kept.setdefault(row.question, []).extend(
            asdict(e) | {"seconds": float(f"{e.seconds:.3g}")} for e in entries([row])
        )
    lines = [
        f"  {json.dumps(name)}: [\n" + ",\n".join(f"   {json.dumps(each)}" for each in found) + "\n  ]"
        for name, found in kept.items()
    ]
    return f'{{\n "machine": {json.dumps(dict(machine))},\n "questions": {{\n' + ",\n".join(lines) + "\n }\n}\n"


@cache
def table() -> Mapping[str, tuple[Entry, ...]]:
    """The table as it was measured."""
    document = json.loads(TABLE.read_text(encoding="utf-8"))
    return {name: tuple(Entry(**each) for each in found) for name, found in document["questions"].items()}


def cheapest(question: str, digits: int, proof: bool = False, measured: Iterable[Entry] | None = None) -> Choice:
    """The cheapest way to answer `question` to `digits` decimal digits; with `proof` only ways that prove it.

    More digits than the table has are answered by what is cheapest at the most that it has.

    >>> kernel = Entry("kernel", "float64", "4 particles", 14, 1e-6, False)
    >>> ball = Entry("balls", "arb", "100 digits", 100, 1e-3, True)
    >>> cheapest("step-egg", 12, measured=[kernel, ball]).why
    'kernel promises 14 digits in 1 us; next is balls, 1e+03 times as long'
    >>> cheapest("step-egg", 12, proof=True, measured=[kernel, ball]).arithmetic
    'arb'
    """
    if digits < 1:
        raise ValueError(f"digits = {digits} is out of range; accepted: at least 1")
    known = _known(question) if measured is None else measured
    usable = [entry for entry in known if entry.proved or not proof]
    if not usable:
        raise ValueError(f"{question}: no way of the table has a proof; ask without")
    most = max(entry.digits for entry in usable)
    enough = sorted((e for e in usable if e.digits >= min(digits, most)), key=lambda e: e.seconds)
    best = enough[0]
    others = [entry for entry in enough if entry.method != best.method]
    why = f"{best.method} promises {best.digits} digits in {duration(best.seconds)}"
    if others:
        why += f"; next is {others[0].method}, {others[0].seconds / best.seconds:.3g} times as long"
    quick = min(usable, key=lambda e: e.seconds)
    reach = max(e.digits for e in usable if e.method == quick.method)
    if reach < min(digits, most):
        why += f"; {quick.method} is quicker and ends at {reach} digits"
    if digits > most:
        why += f"; the table ends at {most} digits"
    return Choice(best.arithmetic, best.method, best.setting, best.digits, best.seconds, why)


def crossovers(question: str, proof: bool = False, measured: Iterable[Entry] | None = None) -> list[tuple[int, Choice]]:
    """From how many digits on each way is the cheapest: pairs of digits and what is picked from there on."""
    known = tuple(_known(question) if measured is None else measured)
    edges = sorted({1, *(entry.digits + 1 for entry in known)})
    most, found = max(entry.digits for entry in known), list[tuple[int, Choice]]()
    for digits in edges:
        if digits > most:
            break
        picked = cheapest(question, digits, proof, known)
        if not found or found[-1][1].method != picked.method:
            found.append((digits, picked))
    return found


def _known(question: str) -> tuple[Entry, ...]:
    if question not in table():
        raise ValueError(f"question = {question!r} was not measured; accepted: {', '.join(table())}")
    return table()[question]


WAYS = ("compiled kernel", "arb, certified")  # that say how many digits an orbit has left: mpmath's does not
LOOKS = 1000  # at an orbit
MOST_DIGITS = 10_000
HOPELESS = 400.0  # digits: an orbit that loses more is not followed to say how many


def for_orbit(
    map: PinballMap, start: tuple[float, float, int], bounces: int, digits: int, proof: bool = False
) -> Choice:
    """What to follow the particle from `start` (parameter, exit angle, component) with, to have `digits` at its end.

    >>> circle = PinballMap("circle", lam="0.5")
    >>> for_orbit(circle, (0.3, 0.2, 0), 10, 10).arithmetic, for_orbit(circle, (0.3, 0.2, 0), 10, 20).arithmetic
    ('float64', 'arb')
    """
    if bounces < 1:
        raise ValueError(f"bounces = {bounces} is out of range; accepted: at least 1")
    arc = cardioid.components[0].point
    name = "step-cardioid" if any(part.point == arc for part in map.table.components) else "step-egg"  # the most alike
    lost = digits_lost(map, start, bounces)
    known = [entry for entry in table()[name] if entry.method in WAYS]
    if math.isinf(lost):
        enough = [entry for entry in known if entry.arithmetic != "float64"]
        choice = cheapest(name, digits, proof, enough)
        return _saying(choice, f"in float64 the particle stops or loses every digit within {bounces} bounces")
    rounded = math.ceil(lost)
    near = [e for e in known if e.arithmetic != "float64" or e.digits >= digits + rounded]
    return _saying(cheapest(name, digits, proof, near), f"digits lost in {bounces} bounces: {rounded}")


def digits_lost(map: PinballMap, start: tuple[float, float, int], bounces: int) -> float:
    """The decimal digits that a rounding error grows by on an orbit, wherever it is made; all when the orbit stops.

    It is the largest rise of the logarithm of a tangent vector's length, looked at so often and no oftener.
    """
    growth = Growth(map, *start)
    sizes, block = [0.0], max(1, bounces // LOOKS)
    for done in range(0, bounces, block):
        growth.advance(min(block, bounces - done))
        sizes.append(float(growth.stretch[0]))
    if int(growth.code[0]) != 0 or not np.all(np.isfinite(sizes)):
        return math.inf
    lost = float(np.max(sizes - np.minimum.accumulate(sizes))) / math.log(10)
    return math.inf if lost > HOPELESS else lost


def digits_for(tolerance: Decimal | float | str) -> int:
    """The decimal digits that keep an error below a tolerance.

    >>> digits_for(1e-12), digits_for(Decimal("3e-1000"))
    (12, 1000)
    """
    try:
        given = Decimal(str(tolerance))
    except InvalidOperation:
        given = Decimal("NaN")
    if not (given.is_finite() and Decimal(10) ** -MOST_DIGITS <= given < 1):
        raise ValueError(f"tolerance = {tolerance} is out of range; accepted: numbers from 1e-{MOST_DIGITS} to below 1")
    return max(1, -given.adjusted())


def _saying(choice: Choice, more: str) -> Choice:
    return replace(choice, why=f"{choice.why}; {more}")
