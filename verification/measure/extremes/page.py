"""All extreme cases, in groups, run one by one; the record of their results, and the page made from the record.

Tests compare the kernels with the record, and `docs/extremes.md` is written from it, with advice where a verdict is not
`STABLE`. The record has every number, verdict and reason, so that the page can be written without new measurements.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import isfinite
from pathlib import Path
from typing import Any

from verification.measure.extremes import flights, near
from verification.measure.extremes import kernels as products
from verification.measure.extremes.flights import CASES
from verification.measure.extremes.kernels import KERNELS, TEXTBOOK
from verification.measure.extremes.near import SMALL, Finding, StabilityVerdict
from verification.measure.extremes.orbits import SHORT, orbits
from verification.measure.extremes.orbits import findings as of_orbit

ADVICE = {
    (TEXTBOOK.name, StabilityVerdict.UNSTABLE): "PinballMap: the root that is known is divided out",
}
STOPPED = {
    "JOIN": "`verification.proofs.corner.corner`: both reflections are followed",
    "CUSP": "nothing: the paper leaves the map undefined there",
    "GRAZING": "ExactMap with more digits",
    "division by zero": "ExactMap, which names the outcome CUSP",
}
Group = tuple[str, str, list[Finding]]


def rows(longer: bool = False, collisions: int = SHORT) -> Iterator[Group]:
    """Yields group, case and findings of every case; with `longer`, also of cases that take minutes."""
    for case in CASES:
        yield case.group, case.name, [advised(found) for found in flights.findings(case)]
    for cycle in (*near.CYCLES, *(near.LONGER if longer else ())):
        yield cycle.group, cycle.name, near.findings(cycle)
    for product in (*products.PRODUCTS, *(products.LONGER if longer else ())):
        yield "Products and exponents", product.name, products.findings(product)
    for orbit in orbits(collisions):
        yield "Long orbits", orbit.name, of_orbit(orbit)


def advised(found: Finding) -> Finding:
    """The finding, with advice if the kernel is not stable or stopped a particle."""
    advice = ADVICE.get((found.kernel, found.stability), "")
    said = [STOPPED[status] for status in found.status.split(", ") if status in STOPPED]
    return replace(found, instead="; ".join(text for text in (advice, *said) if text))


FLIGHTS = tuple(kernel.name for kernel in KERNELS)
RECORD, LONG = (Path(__file__).parent / name for name in ("recorded.json", "long.json"))
NUMBERS = ("forward", "backward", "condition", "ratio")


@dataclass(frozen=True)
class Line:
    """A finding as a line of the record; its numbers are None if the kernel gave no answer."""

    group: str
    case: str
    kernel: str
    verdict: StabilityVerdict
    stopped_by: str
    instead: str
    reason: str
    command: str = ""
    forward: float | None = None
    backward: float | None = None
    condition: float | None = None
    ratio: float | None = None

    @property
    def why(self) -> str:
        """The verdict in words, the outcome that the kernel reports, and the reason for the verdict."""
        named = f" ({self.stopped_by})" if self.stopped_by else ""
        return self.verdict.name.lower() + named + (f": {self.reason}" if self.reason else "")


def record(rows: Iterable[Group]) -> list[dict[str, Any]]:
    """Every finding as JSON; finite numbers have three digits, infinite ones are texts."""
    return [
        {
            "group": group,
            "case": found.case,
            "kernel": found.kernel,
            "verdict": found.stability.name,
            "stopped_by": found.status,
            "instead": found.instead,
            "reason": found.reason,
        }
        | _numbers(found)
        for group, _, several in rows
        for found in several
    ]


def lines(path: Path) -> list[Line]:
    """The lines of a record file; empty if the file is missing."""
    made: list[Line] = []
    if not path.exists():
        return made
    for one in json.loads(path.read_text()):
        numbers = {name: float(one[name]) if name in one else None for name in NUMBERS}
        made.append(Line(**(one | numbers | {"verdict": StabilityVerdict[one["verdict"]]})))
    return made


def page(found: Sequence[Line], long: Sequence[Line]) -> str:
    """The whole page: an introduction, the verdicts, a table for each group, and the tests that take an hour."""
    parts = [WORDS, _verdicts(found), _exceptions(found)]
    for group, members in groupby(found, key=lambda line: line.group):
        several = list(members)
        flights = {one.kernel for one in several} >= set(FLIGHTS)
        parts.append(f"## {group}\n\n" + (_of_flights(several) if flights else _of_others(several)))
    for command, members in groupby(long, key=lambda line: line.command):
        parts.append(f"`{command}`, measured once:\n\n" + _of_others(list(members)))
    return "\n".join(parts)


def _numbers(found: Finding) -> dict[str, Any]:
    if found.measured is None:
        return {}
    m = found.measured
    names = {"forward": m.forward, "backward": m.backward, "condition": m.condition, "ratio": m.ratio}
    return {name: float(f"{x:.3g}") if isfinite(x) else str(x) for name, x in names.items()}


def _verdicts(found: Sequence[Line]) -> str:
    rows = ["## Verdicts\n", "| method | cases | " + " | ".join(s.name.lower() for s in StabilityVerdict)
            + " | largest backward error |", "|---" * 7 + "|"]  # fmt: skip
    for kernel in dict.fromkeys(one.kernel for one in found):
        own = [one for one in found if one.kernel == kernel]
        counts = [str(sum(one.verdict is verdict for one in own) or "") for verdict in StabilityVerdict]
        worst = max((one.backward for one in own if one.backward is not None), default=0.0)
        rows.append(f"| {kernel} | {len(own)} | " + " | ".join(counts) + f" | {worst:.2g} |")
    meanings = "\n".join(f"- **{verdict.name.lower()}**: {verdict.value}." for verdict in StabilityVerdict)
    return "\n".join(rows) + f"\n\n{meanings}\n"


def _exceptions(found: Sequence[Line]) -> str:
    """A table of the methods that are not stable or stop particles, how often they do, and what to use instead."""
    kept: dict[tuple[str, str], list[Line]] = {}
    for one in found:
        if one.verdict is not StabilityVerdict.STABLE or one.stopped_by:
            what = one.verdict.name.lower() + (f" ({one.stopped_by})" if one.stopped_by else "")
            kept.setdefault((what, one.instead), []).append(one)
    rows = ["## What a method cannot do well, and what to use instead\n",
            "| verdict | methods | cases | instead |", "|---" * 4 + "|"]  # fmt: skip
    for (what, instead), several in kept.items():
        methods = "; ".join(dict.fromkeys(one.kernel for one in several))
        names = list(dict.fromkeys(one.case for one in several))
        cases = names[0] + (f", and {len(names) - 1} more" if len(names) > 1 else "")
        rows.append(f"| {what} | {methods} | {cases} | {instead} |")
    rows.append("\nA status beside `stable` means that some particles of the case stopped; the others are accurate.")
    return "\n".join(rows) + "\n"


def _of_flights(found: Sequence[Line]) -> str:
    """A table with a row for each case: condition and forward error (LLVM kernel), all backward errors, verdict."""
    others = [*FLIGHTS[1:], TEXTBOOK.name]
    rows = ["| case | condition | forward | error/(cond*eps) | backward: llvm | " + " | ".join(others)
            + " | verdict |", "|---" * (6 + len(others)) + "|"]  # fmt: skip
    for case, members in groupby(found, key=lambda line: line.case):
        by = {one.kernel: one for one in members}
        own = by[FLIGHTS[0]]
        first = [_short(x) for x in (own.condition, own.forward, own.ratio)]
        backward = [_backward(by.get(name)) for name in (FLIGHTS[0], *others)]
        rows.append(f"| {case} | " + " | ".join([*first, *backward, _of_all(by.values())]) + " |")
    return "\n".join(rows) + "\n"


def _of_all(several: Iterable[Line]) -> str:
    """The verdicts of several kernels on one case, as one text; kernels are named only if their verdicts differ.

    >>> made = [Line("", "", name, StabilityVerdict.STABLE, "", "", "") for name in ("llvm", "numpy")]
    >>> _of_all(made)
    'stable'
    >>> _of_all([*made, Line("", "", "textbook", StabilityVerdict.UNSTABLE, "", "", "cancellation")])
    'stable; textbook unstable: cancellation'
    """
    kept: dict[str, list[str]] = {}
    for one in several:
        kept.setdefault(one.why, []).append(one.kernel)
    plain = StabilityVerdict.STABLE.name.lower()
    if len(kept) == 1:
        return next(iter(kept))
    first = [plain] if plain in kept else []
    return "; ".join([*first, *(f"{', '.join(who)} {why}" for why, who in kept.items() if why != plain)])


def _of_others(found: Sequence[Line]) -> str:
    rows = ["| case | method | condition | forward | error/(cond*eps) | backward | verdict |", "|---" * 7 + "|"]
    for one in found:
        numbers = [_short(x) for x in (one.condition, one.forward, one.ratio, one.backward)]
        rows.append(f"| {one.case} | {one.kernel} | " + " | ".join([*numbers, one.why]) + " |")
    return "\n".join(rows) + "\n"


def _backward(found: Line | None) -> str:
    if found is None:
        return ""
    if found.backward is None:
        return "stopped"
    text = _short(found.backward)
    return f"**{text}**" if found.verdict is StabilityVerdict.UNSTABLE else text


def _short(x: float | None) -> str:
    """A number with two digits.

    >>> _short(0.4567), _short(3.4e16), _short(None)
    ('0.46', '3.4e+16', '')
    """
    return "" if x is None else f"{x:.2g}"


WORDS = rf"""# Stiff and extreme cases

How the arithmetic behaves where it is hard. Every kernel runs every labelled case (`verification/measure/extremes/`)
from the same rounded state, and is compared with a reference of 100 digits: a ball proved to enclose the first hit or,
if balls cannot decide, the definition of the map in mpmath. `python benchmarks/extremes.py --longer` measures the cases
and writes this page; `tests/verification/measure/test_extremes.py` compares every verdict with its record.

Let the data be $x$, the true value $f(x)$ and the computed one $y$. The **forward error** is $\lvert y - f(x) \rvert$.
The **backward error** is the smallest $(\delta x, \delta y)$ with $y + \delta y = f(x + \delta x)$, to first order (the
mixed error of {{cite:p}}`Higham2002`). The **condition number** is the largest factor by which the forward error can
exceed the backward error, from difference quotients of the reference. Errors are absolute, in units of $2^{{-52}}$
(80-bit floats: $2^{{-63}}$), of the landing's parameter and the direction of flight. A method is called stable if no
backward error is above {SMALL}. A stable method is called sensitive if a backward error of {SMALL} costs half of 15
digits, which happens from a condition number of 9e+06 on. Each line shows the worst start of its case. `llvm`, `numpy`,
`longdouble` and `mpmath, 16 digits` run the same step; `textbook discriminant` is the quadratic formula, from which the
known root is not divided out.

**What kernels report.** If a flight cannot continue, the kernel names the reason (`PinballMap.step(...).status`). A
cycle found by Newton's method is a `Solution` with its `condition` number (an estimate of the largest row sum of the
inverse {{cite:p}}`Higham2002`) and `digits_sure`, the digits that are then certain. Its `conditioning`, which
`pinball cycles` prints, is SOUND, SENSITIVE next to a fold or a flip, or REPEATED for a repetition of a shorter cycle.
`pinball follow` steps by arc length, in a system that is regular at a fold.

**JOIN, CUSP and GRAZING are decided on the landing that a kernel computes.** The outcome is JOIN if the line passes a
join so closely that rounding hides its side: the landing's distance from the join, times $\cos\eta$, is below
$2^{{-50}}$ of the distance from the start to the join. (On the arc, which bends away from the line, the distance itself
replaces $\cos\eta$ if it is larger. A flight from the wall has to land within 4 units of $\tan(\theta/2)$.) Next to
this limit kernels may disagree: each answer is right for data that differ by a rounding. The verdict column states the
distance at which the true flight passes the join.

**80 bits.** `longdouble` is the step on 80-bit floats, with the C library's functions and zeros refined to the last
bit. It is also the reference of `benchmarks/adversarial.py`, which reports how far this reference moves if its state is
rounded once more: less than 0.2 units of a double, but 390 for particles aimed at the cusp; for these a reference of 50
digits is used.

**Exponents** are compared with the product of the matrices along the orbit that the kernel computed, since the product
depends on the orbit. On the cardioid at $\lambda = 0.01$ the orbits in float64 and in 50 digits are 5e-10 apart after
40 bounces, 8e-4 after 80 and 3 after 100; the exponents of so many bounces differ by 2e-12, 6e-6 and 6e-3.

**Long orbits** are at the end of the page: invariants, closed forms, an attracting cycle proved in balls, mirror
images, and means over the elastic cardioid, which is ergodic {{cite:p}}`Szasz1992,Markarian1993`. Nothing drifts: the
root mean square change of the ellipse's invariant is 0.48, 0.48 and 0.47 units times $\sqrt n$, after $n = 10^4$,
$4 \cdot 10^6$ and $10^9$ bounces. [Kernels](kernels.md) has orbits of $10^9$ collisions on every table.
"""
