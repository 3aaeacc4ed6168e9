"""The page `docs/extremes.md`, and the record that the tests hold the kernels to."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from math import isfinite
from typing import Any

from verification.extremes.catalogue import Group
from verification.extremes.kernels import KERNELS, TEXTBOOK
from verification.extremes.stability import LOST, SMALL, Finding, Stability

FLIGHTS = tuple(kernel.name for kernel in KERNELS)


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
        }
        | _numbers(found)
        for group, _, several in rows
        for found in several
    ]


def page(rows: Sequence[Group], words: str) -> str:
    """The whole page: `words` on top, then the verdicts, then a table for each group."""
    found = [one for *_, several in rows for one in several]
    parts = [words, _verdicts(found), _exceptions(found)]
    for group, members in groupby(rows, key=lambda row: row[0]):
        several = list(members)
        flights = {one.kernel for *_, findings in several for one in findings} >= set(FLIGHTS)
        parts.append(f"## {group}\n\n" + (_of_flights(several) if flights else _of_others(several)))
    return "\n".join(parts)


def _numbers(found: Finding) -> dict[str, Any]:
    if found.measured is None:
        return {}
    m = found.measured
    names = {"forward": m.forward, "backward": m.backward, "condition": m.condition, "ratio": m.ratio}
    return {name: float(f"{x:.3g}") if isfinite(x) else str(x) for name, x in names.items()}


def _verdicts(found: list[Finding]) -> str:
    lines = ["## Verdicts\n", "| method | cases | " + " | ".join(s.name.lower() for s in Stability)
             + " | largest backward error |", "|---" * 7 + "|"]  # fmt: skip
    for kernel in dict.fromkeys(one.kernel for one in found):
        own = [one for one in found if one.kernel == kernel]
        counts = [str(sum(one.stability is verdict for one in own) or "") for verdict in Stability]
        worst = max((one.measured.backward for one in own if one.measured), default=0.0)
        lines.append(f"| {kernel} | {len(own)} | " + " | ".join(counts) + f" | {worst:.2g} |")
    meanings = "\n".join(f"- **{verdict.name.lower()}**: {verdict.value}." for verdict in Stability)
    return "\n".join(lines) + f"\n\n{meanings}\n"


def _exceptions(found: list[Finding]) -> str:
    """Who is not stable or stops balls, how often, and what to use."""
    kept: dict[tuple[str, str], list[Finding]] = {}
    for one in found:
        if one.stability is not Stability.STABLE or one.status:
            what = one.stability.name.lower() + (f" ({one.status})" if one.status else "")
            kept.setdefault((what, one.instead), []).append(one)
    lines = ["## What a method cannot do well, and what to use in its place\n",
             "| verdict | methods | cases | instead |", "|---" * 4 + "|"]  # fmt: skip
    for (what, instead), several in kept.items():
        methods = "; ".join(dict.fromkeys(one.kernel for one in several))
        names = list(dict.fromkeys(one.case for one in several))
        cases = names[0] + (f", and {len(names) - 1} more" if len(names) > 1 else "")
        lines.append(f"| {what} | {methods} | {cases} | {instead} |")
    lines.append("\nA status beside `stable` names balls of the case that stopped; the others were right.")
    return "\n".join(lines) + "\n"


def _of_flights(rows: list[Group]) -> str:
    """One line a case: all four numbers of the LLVM kernel, and the backward errors of the others."""
    others = [*FLIGHTS[1:], TEXTBOOK.name]
    lines = ["| case | condition | forward | error/(cond*eps) | backward: llvm | " + " | ".join(others)
             + " | stopped |", "|---" * (6 + len(others)) + "|"]  # fmt: skip
    for _, case, several in rows:
        by = {one.kernel: one for one in several}
        own = by[FLIGHTS[0]].measured
        first = [_short(x) for x in (own.condition, own.forward, own.ratio)] if own else ["", "", ""]
        backward = [_backward(by.get(name)) for name in (FLIGHTS[0], *others)]
        lines.append(f"| {case} | " + " | ".join([*first, *backward, by[FLIGHTS[0]].status]) + " |")
    return "\n".join(lines) + "\n"


def _of_others(rows: list[Group]) -> str:
    lines = ["| case | method | condition | forward | error/(cond*eps) | backward | verdict |", "|---" * 7 + "|"]
    for *_, several in rows:
        for one in several:
            m = one.measured
            numbers = [_short(x) for x in (m.condition, m.forward, m.ratio, m.backward)] if m else [""] * 4
            verdict = one.stability.name.lower()
            lines.append(f"| {one.case} | {one.kernel} | " + " | ".join([*numbers, verdict]) + " |")
    return "\n".join(lines) + "\n"


def _backward(found: Finding | None) -> str:
    if found is None or found.measured is None:
        return "" if found is None else "stopped"
    text = _short(found.measured.backward)
    return f"**{text}**" if found.stability is Stability.UNSTABLE else text


def _short(x: float) -> str:
    """Two digits.

    >>> _short(0.4567), _short(3.4e16)
    ('0.46', '3.4e+16')
    """
    return f"{x:.2g}"


WORDS = f"""# Stiff and extreme cases

Every case below is a labelled fixture (`verification/extremes/`), run by every kernel from the same rounded state
and held against a truth with 100 digits: a ball proved to enclose the first hit, or where balls refuse the
definition of the map in mpmath. `python benchmarks/extremes.py` writes this page;
`tests/verification/test_extremes.py` holds every verdict to its record.

With data `x`, truth `f(x)` and answer `y`: the **forward error** is `|y - f(x)|`; the **backward error** is the
smallest `(dx, dy)` with `y + dy = f(x + dx)`, to first order (Higham's mixed error); the **condition number** is
the largest factor between them, from difference quotients of the truth. Errors are absolute, in units of 2^-52
(80-bit floats: 2^-63), of the landing's parameter and the direction of flight. A method is called stable when no
backward error is above {SMALL}, sensitive when the condition number is above {LOST:g} besides. Each line shows the
worst start of its case. `llvm`, `numpy`, `longdouble` and `mpmath, 16 digits` run the same step; `textbook
discriminant` is the quadratic formula with nothing divided out.

A ball that stops is named by the kernel itself (`PinballMap.step(...).status`). Newton's method on cycles in
float64 raises "did not settle" where its corrections stay large (*stopped* below); where it settles next to a fold
or a flip it names nothing, and `verification.extremes.near.norm_of_inverse` tells the condition number. A
contraction that is a double comes no nearer to the triangle's fold than a few 1e-8 in the multiplier; the ellipse
and the egg come nearer by their shape. Orbits of 10^9 collisions on every table are in `docs/numerics.md`
(`benchmarks/soak.py`): no ball was lost or left its table, and of a chaotic orbit one cannot tell more; the lines
here are an invariant, and `--collisions 1e9` makes them as long.

The step on 80-bit floats is called unstable by its own unit, 2^-63. It was written for doubles: its sines and
arctangents are polynomials for 53 bits, and its Newton's method ends once a correction is below 2^-27. Which of the
two is to blame was not isolated. In units of 2^-52 its worst errors are 3.4 (flat points of the egg) and 2.6 (exits of
the egg that graze), at backward errors of 0.6: good for finding wrong zeros, not for judging the last bit of a double.
"""
