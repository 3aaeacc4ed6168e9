"""All extreme cases in their groups, run one by one; the record of what they gave, and the page made from it.

The tests hold the kernels to the record, and `docs/extremes.md` is written from it, with what to do where a verdict
is not `STABLE`. Writing the page measures nothing: the record has every number, verdict and reason, so the page can
be written again at any time.
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
from verification.measure.extremes.near import SMALL, Finding, Stability
from verification.measure.extremes.orbits import SHORT, orbits
from verification.measure.extremes.orbits import findings as of_orbit

ADVICE = {
    (TEXTBOOK.name, Stability.UNSTABLE): "PinballMap: the root that is known is divided out",
}
STOPPED = {
    "JOIN": "`verification.proofs.corner.corner`: both reflections are followed",
    "CUSP": "nothing: the paper leaves the map undefined there",
    "GRAZING": "ExactMap with more digits",
    "division by zero": "ExactMap, which names the outcome CUSP",
}
Group = tuple[str, str, list[Finding]]


def rows(longer: bool = False, collisions: int = SHORT) -> Iterator[Group]:
    """Group, case and findings; with `longer`, what takes minutes too."""
    for case in CASES:
        yield case.group, case.name, [advised(found) for found in flights.findings(case)]
    for cycle in (*near.CYCLES, *(near.LONGER if longer else ())):
        yield cycle.group, cycle.name, near.findings(cycle)
    for product in (*products.PRODUCTS, *(products.LONGER if longer else ())):
        yield "Products and exponents", product.name, products.findings(product)
    for orbit in orbits(collisions):
        yield "Long orbits", orbit.name, of_orbit(orbit)


def advised(found: Finding) -> Finding:
    """With what to use in its place, where the kernel is not stable or stopped a particle."""
    advice = ADVICE.get((found.kernel, found.stability), "")
    said = [STOPPED[status] for status in found.status.split(", ") if status in STOPPED]
    return replace(found, instead="; ".join(text for text in (advice, *said) if text))


FLIGHTS = tuple(kernel.name for kernel in KERNELS)
RECORD, LONG = (Path(__file__).parent / name for name in ("recorded.json", "long.json"))
NUMBERS = ("forward", "backward", "condition", "ratio")


@dataclass(frozen=True)
class Line:
    """A finding as the record has it; numbers are None where there is no answer."""

    group: str
    case: str
    kernel: str
    verdict: Stability
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
        """The verdict, with the outcome that the kernel names and the reason."""
        named = f" ({self.stopped_by})" if self.stopped_by else ""
        return self.verdict.name.lower() + named + (f": {self.reason}" if self.reason else "")


def record(rows: Iterable[Group]) -> list[dict[str, Any]]:
    """Every finding as data: numbers with three digits, and strings where there is none."""
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
    """A record that was kept; nothing where there is none yet."""
    made: list[Line] = []
    if not path.exists():
        return made
    for one in json.loads(path.read_text()):
        numbers = {name: float(one[name]) if name in one else None for name in NUMBERS}
        made.append(Line(**(one | numbers | {"verdict": Stability[one["verdict"]]})))
    return made


def page(found: Sequence[Line], long: Sequence[Line]) -> str:
    """The whole page: the words on top, then the verdicts, then a table for each group, then what takes an hour."""
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
    rows = ["## Verdicts\n", "| method | cases | " + " | ".join(s.name.lower() for s in Stability)
            + " | largest backward error |", "|---" * 7 + "|"]  # fmt: skip
    for kernel in dict.fromkeys(one.kernel for one in found):
        own = [one for one in found if one.kernel == kernel]
        counts = [str(sum(one.verdict is verdict for one in own) or "") for verdict in Stability]
        worst = max((one.backward for one in own if one.backward is not None), default=0.0)
        rows.append(f"| {kernel} | {len(own)} | " + " | ".join(counts) + f" | {worst:.2g} |")
    meanings = "\n".join(f"- **{verdict.name.lower()}**: {verdict.value}." for verdict in Stability)
    return "\n".join(rows) + f"\n\n{meanings}\n"


def _exceptions(found: Sequence[Line]) -> str:
    """Who is not stable or stops particles, how often, and what to use."""
    kept: dict[tuple[str, str], list[Line]] = {}
    for one in found:
        if one.verdict is not Stability.STABLE or one.stopped_by:
            what = one.verdict.name.lower() + (f" ({one.stopped_by})" if one.stopped_by else "")
            kept.setdefault((what, one.instead), []).append(one)
    rows = ["## What a method cannot do well, and what to use in its place\n",
            "| verdict | methods | cases | instead |", "|---" * 4 + "|"]  # fmt: skip
    for (what, instead), several in kept.items():
        methods = "; ".join(dict.fromkeys(one.kernel for one in several))
        names = list(dict.fromkeys(one.case for one in several))
        cases = names[0] + (f", and {len(names) - 1} more" if len(names) > 1 else "")
        rows.append(f"| {what} | {methods} | {cases} | {instead} |")
    rows.append("\nA status beside `stable` names particles of the case that stopped; the others were right.")
    return "\n".join(rows) + "\n"


def _of_flights(found: Sequence[Line]) -> str:
    """One line a case: all four numbers of the LLVM kernel, the backward errors of the others, verdict and reason."""
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
    """The verdicts on all kernels: who they are is said only where they differ.

    >>> made = [Line("", "", name, Stability.STABLE, "", "", "") for name in ("llvm", "numpy")]
    >>> _of_all(made)
    'stable'
    >>> _of_all([*made, Line("", "", "textbook", Stability.UNSTABLE, "", "", "cancellation")])
    'stable; textbook unstable: cancellation'
    """
    kept: dict[str, list[str]] = {}
    for one in several:
        kept.setdefault(one.why, []).append(one.kernel)
    plain = Stability.STABLE.name.lower()
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
    return f"**{text}**" if found.verdict is Stability.UNSTABLE else text


def _short(x: float | None) -> str:
    """Two digits.

    >>> _short(0.4567), _short(3.4e16), _short(None)
    ('0.46', '3.4e+16', '')
    """
    return "" if x is None else f"{x:.2g}"


WORDS = f"""# Stiff and extreme cases

Every case below is a labelled fixture (`verification/measure/extremes/`), run by every kernel from the same
rounded state and held against a truth with 100 digits: a ball proved to enclose the first hit, or where balls refuse
the definition of the map in mpmath. `python benchmarks/extremes.py --longer` measures it and writes this page;
`tests/verification/measure/test_extremes.py` holds every verdict to its record.

With data `x`, truth `f(x)` and answer `y`: the **forward error** is `|y - f(x)|`; the **backward error** is the
smallest `(dx, dy)` with `y + dy = f(x + dx)`, to first order (the mixed error of {{cite:p}}`Higham2002`); the
**condition number** is the largest factor between them, from difference quotients of the truth. Errors are
absolute, in units of 2^-52 (80-bit floats: 2^-63), of the landing's parameter and the direction of flight. A
method is called stable when no backward error is above {SMALL}, sensitive when such an error costs half of 15 digits
besides: from a condition number of 9e+06 on. Each line shows the worst start of its case. `llvm`, `numpy`,
`longdouble` and `mpmath, 16 digits` run the same step; `textbook discriminant` is the quadratic formula with
nothing divided out.

**What kernels say of themselves.** Where a flight cannot go on, the kernel names the reason
(`PinballMap.step(...).status`). A cycle found by Newton's method is a `Solution` with its `condition` number (an
estimate of the largest row sum of the inverse {{cite:p}}`Higham2002`, from the factors, in 0.2 ms when it is asked
for), the `digits_sure` that it leaves and a `conditioning`: SOUND, SENSITIVE next to a fold or a flip, REPEATED
for a shorter cycle run through several times; where float64 does not settle the error carries the same. `pinball
cycles` prints it. The verdicts of cycles below are read from there; a test holds them to what 100 digits measure.
`pinball follow` needs no such word: it goes by arc length, in a system that is regular at a fold. A contraction
that is a double comes no nearer to the triangle's fold than a few 1e-8 in the multiplier; nearer ones are reached
by the shape, given exactly.

**JOIN, CUSP and GRAZING are decided on the landing that a kernel computes.** JOIN where the line passes a join so
closely that rounding hides its side: the landing's distance from the join, times `cos(eta)`, is below 2^-50 of the way
from the start to there, twice the sine of half the difference of the parameters. (On the arc the distance itself
serves where it is the larger factor: the arc bends away from the line. A flight from the wall, which lands on the arc
wherever it goes, has to land within 4 units of tan(theta/2).) A computed line is off by 1.2 units of 2^-52. Next to
that border kernels may disagree, and the verdict column says how far off the true flight passes the join: both answers
are right for data that are off by a rounding.

**80 bits.** The step on 80-bit floats used to be called unstable at 24 cases. Which of its operations were to blame
was found by exchanging them one by one: 20 were due to sines and arctangents that are polynomials for 53 bits, 3 to
zeros that end at a correction below 2^-27, 1 to a shape (`sqrt(2)`) that reached it as a double. With the C library's
functions, zeros sharpened to the last bit (`verification/measure/extremes/kernels.py`) and the shape rounded to 80
bits its worst
backward error is the one in the table. It judges `benchmarks/adversarial.py` too, which says how far the judge itself
moves when its state is rounded once more: less than 0.2 units of a double, but 390 for particles aimed at the cusp, of
which 80 bits cannot judge the last bits; there 50 digits say at most 4 and 8.

**Exponents** are held against the product of the matrices along the kernel's own orbit. Along another orbit from the
same start the product is another number: on the cardioid at lam = 1e-2 the orbits in float64 and in 50 digits are 5e-10
apart after 40 bounces, 8e-4 after 80 and 3 after 100; the exponents of so many bounces differ by 2e-12, 6e-6 and 6e-3.

**Long orbits** end the page: invariants, closed forms, an attracting cycle proved in balls, mirror images, and means
over the elastic cardioid, which is ergodic {{cite:p}}`Szasz1992,Markarian1993`. Nothing drifts: the root mean square
change of the ellipse's invariant is 0.48, 0.48 and 0.47 units
times the root of the number of bounces, after 10^4, 4*10^6 and 10^9 of them.
Orbits of 10^9 collisions on every table are in [kernels](kernels.md) (`benchmarks/soak.py`).
"""
