"""Homoclinic tangencies near contractions at which the sampled attractor suddenly changes.

A crisis is such a tangency. Each tangency is found in float64 and then proved in balls. Only samples show that the
attractor changes at this contraction and not beside it, so a tangency is not called a crisis here. The boundary has to
be one smooth formula; if it is not convex, each flight is proved to meet no other part of it. For other tables only the
changes are reported (`parted`).
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import starmap
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.sweeps.fields import bifurcation
from numeric.sweeps.run import run
from numeric.sweeps.sweep import text_of
from verification.arithmetic.balls import decimal
from verification.named import tangencies
from verification.named.questions import PeriodicOrbit, Tick
from verification.named.tangencies import LEAST, SAME, near, objection_of
from verification.proofs.manifolds.certificate import contact_of, contact_said
from verification.proofs.manifolds.proof import LEAST_DIGITS
from verification.proofs.manifolds.tangency import Touch
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Block, Certificate, Effort, Known, Listing, Paragraph, ShownNumber, sampled
from verification.reports.dynamics import density
from verification.reports.parted import near_changes, told_of

Found = tuple[list[Block], list[Effort], dict[str, Any]]
Document = dict[str, Any]
GROWN = 0.15  # part of the cells that an attractor meets, gained or lost from one contraction to the next
MOST = 3  # changes that are examined, at most
COLUMNS, ORBITS, POINTS, LONG = 25, 16, 512, 20_000  # of the finer scan: contractions, particles, bounces, transient
NEAR = 4  # steps of that scan within which a tangency belongs to a change
SHOWN = 5e-6  # relative error of a multiplier: half a unit of its last digit
DIGITS = 10  # of a multiplier


def crises(asked: Asked, parts: Parts, heard: Tick = lambda said: None) -> Found:
    """The tangencies near the changes in the diagram, found in float64 and not yet proved, with the cost."""
    arrays = parts.arrays("diagram-0")
    changes = changed(arrays["counts"], arrays["chaotic"])
    if objection_of(asked.scene):
        rows = near_changes(asked, [closer(asked, parts, arrays["values"], j) for j in changes])
        return [told_of(asked, rows)], [Effort("changes of attractors", f"{len(rows)} changes", 0.0)], {"parted": rows}
    found: list[Document] = []
    for j in changes:
        low, high = closer(asked, parts, arrays["values"], j)
        ends = _about(low, high)
        here = asked.scene.at(lam=repr(round(sum(ends) / 2, 9)))
        for touch, cycle in near(here, ends, asked.period, asked.seed, heard):
            if all(abs(touch.parameter - other["value"]) > SAME for other in found):
                found.append(_touched(touch, cycle, (low, high)))
    found.sort(key=lambda said: float(said["value"]))
    size = f"{len(changes)} changes, {len(found)} tangencies"
    return [], [Effort("tangencies", size, 0.0)], {"touches": found, "changes": len(changes)}


def _about(low: float, high: float) -> tuple[float, float]:
    """The interval of contractions in which a tangency is attributed to a change between `low` and `high`."""
    reach = min(NEAR * (high - low), (low + high) / 2 - SAME, 1 - (low + high) / 2)
    return (low + high) / 2 - reach, (low + high) / 2 + reach


def proved(asked: Asked, said: Document, number: int) -> Found:
    """The proof of a tangency: an enclosure of the contraction, the checklist, the certificate; with its cost."""
    effort = Effort(f"tangency {number}", f"{max(asked.digits, LEAST_DIGITS)} digits", 0.0)
    made = tangencies.proved(asked.scene, contact_of(said["contact"]), asked.digits)
    if isinstance(made, str):
        return [], [effort], {"open": made}
    if not made.proved:
        return [], [effort], {"open": ", ".join(made.open)}
    ball = dict(zip(("value", "radius"), decimal(made.value, asked.digits + 1), strict=True))
    multipliers = [decimal(x, DIGITS) for x in reversed(made.strange.multipliers)]
    found = ball | {"multipliers": multipliers, "items": len(made.checks)}
    with suppress(ValueError, ArithmeticError):  # a tangency that has no certificate file
        found["certificate"] = made.document()
    return [], [replace(effort, error=ball["radius"])], found


@dataclass(frozen=True)
class Told:
    """The report on tangencies: blocks of a section, lines for the diagram, and events for JSON."""

    blocks: list[Block]
    lines: list[list[Any]]
    events: list[Document]


NOTHING = Told([], [], [])


def told(asked: Asked, made: Mapping[str, Document]) -> Told:
    """The report on the tangencies found, each with its proof if it has been proved."""
    said = made["crises"]["data"]
    if "touches" not in said:
        return NOTHING
    proofs = [made.get(f"tangency-{i}", {"data": {}})["data"] for i in range(len(said["touches"]))]
    pairs = list(zip(said["touches"], proofs, strict=True))
    lines = [[float(touch["value"]), "tangency"] for touch, _ in pairs]
    table: Block = _table(asked, said["changes"], pairs)
    files = [(f"tangency-{i}", proof["certificate"]) for i, proof in enumerate(proofs) if "certificate" in proof]
    return Told([table, *starmap(Certificate, files)], lines, [_document(*pair) for pair in pairs])


def changed(counts: NDArray[Any], chaotic: NDArray[Any]) -> list[int]:
    """The columns after which the chaotic attractor gains or loses the most cells, by fraction, largest first.

    >>> changed(np.array([[1, 1, 1, 1], [1, 1, 0, 0], [1, 1, 0, 0]]), np.array([1, 1, 0, 0]))
    [1]
    """
    met = np.count_nonzero(counts, axis=0)
    part = np.abs(np.diff(met)) / np.maximum(1, np.maximum(met[:-1], met[1:]))
    part[~((chaotic[:-1] > 0) | (chaotic[1:] > 0))] = 0
    kept: list[int] = []
    for j in np.argsort(-part):
        if part[j] > GROWN and len(kept) < MOST and all(abs(j - other) > 1 for other in kept):
            kept.append(int(j))
    return kept


def closer(asked: Asked, parts: Parts, values: NDArray[Any], j: int) -> tuple[float, float]:
    """Two contractions closer to the change after column `j`, from a finer scan with a longer transient."""
    first, last = max(0, j - 2), min(len(values) - 1, j + 3)
    finer = np.linspace(values[first], values[last], COLUMNS)
    sweep = bifurcation(text_of(asked.scene), finer, ORBITS, POINTS, POINTS, LONG, asked.seed)
    seen = run(sweep, scheduler=parts.scheduler)
    half = PinballMap(asked.scene).arclength.perimeter / 2
    counts = density(seen.s.values, half)
    k = next(iter(changed(counts, seen.chaotic.values.mean(axis=1))), COLUMNS // 2)
    return float(finer[k]), float(finer[k + 1])


def _touched(touch: Touch, cycle: PeriodicOrbit, change: tuple[float, float]) -> Document:
    """A tangency in float64 as plain data."""
    parameter, error = float(touch.parameter), max(touch.error, LEAST)
    return {
        "value": parameter,
        "error": error,
        "period": cycle.period,
        "multipliers": [touch.multipliers[1], touch.multipliers[0]],
        "change": list(change),
        "contact": contact_said(touch.contact),
    }


def _row(said: Document, proof: Document) -> tuple[Any, ...]:
    low, high = said["change"]
    if "value" in proof:
        where = ShownNumber(proof["value"], proof["radius"], Known.PROVED)
        stretch = [ShownNumber(value, radius, Known.PROVED) for value, radius in proof["multipliers"]]
        checks = f"all {proof['items']} items hold" + ("" if "certificate" in proof else "; no file")
    else:
        where = ShownNumber(f"{said['value']:.12f}", f"{said['error']:.0e}", Known.FLOAT)
        stretch = [ShownNumber(f"{x:.6g}", f"{SHOWN * abs(x):.0e}", Known.FLOAT) for x in said["multipliers"]]
        checks = f"open: {proof['open']}" if "open" in proof else "left for more time"
    middle = sampled((low + high) / 2, (high - low) / 2)
    return where, str(said["period"]), *stretch, str(said["contact"]["bounces"]), checks, middle


def _document(said: Document, proof: Document) -> Document:
    exact = "value" in proof
    return {
        "kind": "homoclinic_tangency",
        "period": said["period"],
        "parameter": "lam",
        "value": proof["value"] if exact else f"{said['value']:.12f}",
        "radius": proof["radius"] if exact else f"{said['error']:.0e}",
        "certified": "certificate" in proof,
    }


COLUMN = "lam", "period", "multiplier of a round, out", "in", "bounces", "checklist", "sampling sees it at"


def _table(asked: Asked, changes: int, pairs: list[tuple[Document, Document]]) -> Block:
    if not changes:
        return Paragraph("The diagram shows no contraction at which a chaotic attractor gains or loses much at once.")
    if not pairs:
        where = "one contraction" if changes == 1 else f"{changes} contractions"
        return Paragraph(
            f"At {where} of the diagram a chaotic attractor gains or loses much at once; no tangency of the manifolds "
            f"of a cycle up to period {asked.period} was found near by."
        )
    caption = (
        "Homoclinic tangencies near the contractions at which the diagram shows a chaotic attractor to gain or lose "
        f"much at once: the manifolds of a saddle touch, among cycles up to period {asked.period}. A crisis is such a "
        "tangency. Each was sought in float64; one that is proved is quadratic, alone within its radius, and passes "
        "with a speed that is not 0. That the attractor changes there is sampled: the last column has the middle of "
        "two contractions between which it was seen, and half their distance; where chaos lasts long and then ends, "
        "it is seen too late."
    )
    rows = tuple(_row(*pair) for pair in pairs)
    return Listing(caption, COLUMN, rows, "; ".join(_commands(asked, [said["change"] for said, _ in pairs])))


def _commands(asked: Asked, changes: list[list[float]]) -> Iterator[str]:
    """For each change, the command that searches for tangencies near it and proves them."""
    for low, high in {tuple(change): None for change in changes}:
        (first, last), options = _about(low, high), f"--period {asked.period} --digits {asked.digits} --searches 1"
        yield asked.command("locate tangency", f"--lam {first:.9f}:{last:.9f} {options}")
