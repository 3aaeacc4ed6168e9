"""Uses of measured run times: the cheapest arithmetic for a number of digits, and a comparison of two runs.

The table is `measured.json` beside this file, written by `benchmarks/work_precision.py`. A method counts for as many
digits as it promises, and only if it kept its promise where its answer was compared with a certified ball. Seconds are
those of one machine; their ratios carry over to others.

An orbit is followed in float64 while enough of its digits survive, and otherwise as the table says. A bounce loses as
many digits as the decimal logarithm of the factor by which its derivative stretches. The kernels compute how many an
orbit loses in all; this is subtracted from the digits that float64 promises for one bounce.

Two runs are compared by ratios of times within each, so that machines and their load cancel. The slowdown of a run is
the median over the rows of each question, and over the questions; deviations from it are reported. The lower quartiles
of times are compared, as other work on a machine disturbs them least.
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
from verification.measure.work.row import MethodResult, duration, short, timed

MOVED = 1.5  # from this factor on a change of time is reported
WORSE = 10  # from this factor on a growth of an error is reported
Rows = dict[tuple[str, str], MethodResult]


def moved(before: Sequence[MethodResult], after: Sequence[MethodResult]) -> list[str]:
    """A sentence for each row or whole question whose time changed by a factor above 1.5, relative to the others.

    Changes within the quartiles of both runs are not reported. Errors that grew tenfold, and lost answers, are
    reported.
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


def changes(old: MethodResult, new: MethodResult, unit: float) -> list[str]:
    """Sentences on what changed in a row; times are compared after a general slowdown by the factor `unit`."""
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


def _of(rows: Sequence[MethodResult], name: str) -> Rows:
    return {(row.method, row.setting): row for row in rows if row.question == name}


def _unit(old: Rows, new: Rows) -> float:
    """The median factor by which times changed, over the rows that both runs have."""
    ratios = [new[key].quartiles[0] / old[key].quartiles[0] for key in new if key in old and old[key].quartiles[0]]
    return median(ratios) if ratios else 1.0


def of_bench(rows: Iterable[Mapping[str, Any]]) -> list[MethodResult]:
    """The rows in a JSON document of `pinball bench`: each table is a question, each kernel a method."""
    return [
        timed(
            row["scene"],
            f"{row['arithmetic']} {row['kernel']}",
            [row["seconds_per_bounce"]],
            error=None if row["error"] is None else Decimal(str(row["error"])),
        )
        for row in rows
    ]


def earlier(path: Path) -> list[MethodResult]:
    """The rows in a JSON file of `pinball bench`."""
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
    """The benchmark question of this name.

    >>> question("lambda-star").name
    'lambda-star'
    """
    if name not in QUESTIONS:
        raise ValueError(f"QUESTION = {name} is none that is measured; accepted: {', '.join(QUESTIONS)}")
    return QUESTIONS[name]()


TABLE = Path(__file__).with_name("measured.json")


@dataclass(frozen=True)
class MeasuredWay:
    """A method that kept its promise: its arithmetic and setting, the digits promised, the seconds for one answer.

    Of a method that was chosen, `why` is the reason.
    """

    method: str
    arithmetic: str
    setting: str
    digits: int
    seconds: float
    proved: bool
    why: str = ""


def entries(rows: Iterable[MethodResult]) -> list[MeasuredWay]:
    """The methods in some rows that may be chosen: those that kept a promise, but no textbook methods."""
    made = []
    for row in rows:
        if row.kept and row.promise and not row.textbook:
            digits = row.digits or max(0, math.floor(-float(row.promise.log10())))
            made.append(MeasuredWay(row.method, row.arithmetic, row.setting, digits, row.seconds, row.proved))
    return made


def written(rows: Iterable[MethodResult], machine: Mapping[str, str]) -> str:
    """The methods in some rows that may be chosen, as the text of a JSON file."""
    kept: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        for entry in map(asdict, entries([row])):
            del entry["why"]
            kept.setdefault(row.question, []).append(entry | {"seconds": float(f"{entry['seconds']:.3g}")})
    lines = [
        f"  {json.dumps(name)}: [\n" + ",\n".join(f"   {json.dumps(each)}" for each in found) + "\n  ]"
        for name, found in kept.items()
    ]
    return f'{{\n "machine": {json.dumps(dict(machine))},\n "questions": {{\n' + ",\n".join(lines) + "\n }\n}\n"


@cache
def table() -> Mapping[str, tuple[MeasuredWay, ...]]:
    """The table of measured methods: for each question, those that kept their promise."""
    document = json.loads(TABLE.read_text(encoding="utf-8"))
    return {name: tuple(MeasuredWay(**each) for each in found) for name, found in document["questions"].items()}


def cheapest(
    question: str, digits: int, proof: bool = False, measured: Iterable[MeasuredWay] | None = None
) -> MeasuredWay:
    """The cheapest method for `question` with `digits` decimal digits; with `proof`, the cheapest one that is proved.

    If no method has so many digits, the cheapest one with the most digits is taken.

    >>> kernel = MeasuredWay("kernel", "float64", "4 particles", 14, 1e-6, False)
    >>> ball = MeasuredWay("balls", "arb", "100 digits", 100, 1e-3, True)
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
        raise ValueError(f"{question}: no method in the table is proved; ask without a proof")
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
    return replace(best, why=why)


def crossovers(
    question: str, proof: bool = False, measured: Iterable[MeasuredWay] | None = None
) -> list[tuple[int, MeasuredWay]]:
    """Pairs of a number of digits, and the method that is the cheapest from this number of digits on."""
    known = tuple(_known(question) if measured is None else measured)
    edges = sorted({1, *(entry.digits + 1 for entry in known)})
    most, found = max(entry.digits for entry in known), list[tuple[int, MeasuredWay]]()
    for digits in edges:
        if digits > most:
            break
        picked = cheapest(question, digits, proof, known)
        if not found or found[-1][1].method != picked.method:
            found.append((digits, picked))
    return found


def _known(question: str) -> tuple[MeasuredWay, ...]:
    if question not in table():
        raise ValueError(f"question = {question!r} was not measured; accepted: {', '.join(table())}")
    return table()[question]


WAYS = ("compiled kernel", "arb, certified")  # they show how many digits an orbit has left; mpmath does not
LOOKS = 1000  # at most so many samples of the growth along an orbit
MOST_DIGITS = 10_000
HOPELESS = 400.0  # digits: an orbit that loses more counts as losing all


def for_orbit(
    map: PinballMap, start: tuple[float, float, int], bounces: int, digits: int, proof: bool = False
) -> MeasuredWay:
    """A method to follow a particle from `start` (parameter, exit angle, component) that leaves `digits` at the end.

    >>> circle = PinballMap("circle", lam="0.5")
    >>> for_orbit(circle, (0.3, 0.2, 0), 10, 10).arithmetic, for_orbit(circle, (0.3, 0.2, 0), 10, 20).arithmetic
    ('float64', 'arb')
    """
    if bounces < 1:
        raise ValueError(f"bounces = {bounces} is out of range; accepted: at least 1")
    arc = cardioid.components[0].point
    name = "step-cardioid" if any(part.point == arc for part in map.table.components) else "step-egg"  # the more alike
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
    """The number of digits that rounding errors made anywhere on an orbit can cost; infinite if the orbit stops.

    This is the largest rise of the logarithm of a tangent vector's length, sampled at most `LOOKS` times.
    """
    growth = Growth(map, *start)
    block = max(1, bounces // LOOKS)
    sizes = growth.advance_blocks([min(block, bounces - done) for done in range(0, bounces, block)])[0, :, 0]
    if int(growth.code[0]) != 0 or not np.all(np.isfinite(sizes)):
        return math.inf
    lost = float(np.max(sizes - np.minimum.accumulate(sizes))) / math.log(10)
    return math.inf if lost > HOPELESS else lost


def digits_for(tolerance: Decimal | float | str) -> int:
    """The number of decimal digits that are needed for an error below `tolerance`.

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


def _saying(choice: MeasuredWay, more: str) -> MeasuredWay:
    return replace(choice, why=f"{choice.why}; {more}")
