"""The cheapest arithmetic for a number of digits, from a table that was measured, and why it was picked.

The table is `measured.json` beside this file, written by `benchmarks/work_precision.py`. A way counts for as many
digits as it promises, and only if it kept its promise where its answer was held against a certified ball. Seconds
are those of one machine; what carries over to others are their ratios.
"""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from verification.diagram import duration
from verification.work.row import Row

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

    >>> kernel = Entry("kernel", "float64", "4 balls", 14, 1e-6, False)
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
