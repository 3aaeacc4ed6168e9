"""Curves of events in the plane of two parameters: their computation for a report, and their tables."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from symbolic.tables.definition import exact
from verification.cycles.arc import LostError, Steps
from verification.cycles.branch import Branch
from verification.named.events import EventCurve, Plane, curves_along
from verification.named.questions import Tick, follow
from verification.reports.asked import Asked
from verification.reports.blocks import Block, Cell, Certificate, Effort, Known, Listing, Paragraph, ShownNumber, solved
from verification.reports.lives import MOST, Document, Made, followed, orbit_of, start_of

STEPS = Steps(largest=0.2, most=150)  # of a curve
PLACED = 6  # digits of a point on a curve


def plane_of(asked: Asked) -> Plane:
    """The plane of a report in two parameters."""
    assert asked.second is not None
    name, low, high = asked.second
    return Plane.of(asked.scene, name, (low, high), (asked.low, asked.high))


def curves(
    asked: Asked, said: Document, number: int, known: Sequence[Document], heard: Tick = lambda said: None
) -> Made:
    """The curves in both parameters of events on a family, including those met when the second parameter varies.

    Curves that are in `known` are left out.
    """
    plane, found = plane_of(asked), list[Document]()
    for branch, other, options in _lines(asked, said):
        heard(options)
        seen = [EventCurve(**each) for each in (*known, *found)]
        for curve in curves_along(branch, plane, other, seen, STEPS, lambda point: heard("curve")):
            deeper = f" --switch {curve.depth}" if curve.depth else ""
            found.append(curve.document() | {"command": asked.command("follow", f"{options}{deeper}")})
    return [], [Effort(f"curves of cycle {number}", f"{len(found)} curves", 0.0)], {"curves": found}


def _lines(asked: Asked, said: Document) -> Iterator[tuple[Branch, float, str]]:
    """A cycle's branch in the contraction, and its branches in the second parameter at the contractions `at`.

    Each comes with the value of the fixed parameter, and the command-line options that follow it again.
    """
    assert asked.second is not None
    letter, low, high = asked.second
    here = orbit_of(asked.scene.at(lam=said["at"]), said["cycle"])
    branch = followed(asked, here)
    over = f"--lam {asked.low}:{asked.high} --at {said['at']} --curves {letter}={low}:{high}"
    yield branch, asked.own, f"{over} {start_of(asked, here)}"
    for text in asked.at:
        lam = float(exact("--at", text))
        try:
            places = branch.at(lam)
        except LostError:
            continue
        for z in places:
            orbit = replace(here, scene=asked.scene.at(lam=text), theta=tuple(z[:-1].tolist()))
            over = f"--lam {text} --shape {letter}={low}:{high} --curves lam={asked.low}:{asked.high}"
            interval: dict[str, Any] = {letter: (low, high)}
            try:
                other = follow(orbit, points=MOST, **interval).branch
            except ValueError:  # a cycle of a family, or at a bifurcation
                continue
            yield other, lam, f"{over} {start_of(asked, orbit)}"


def curve_blocks(asked: Asked, found: Sequence[Document]) -> list[Block]:
    """A table for each curve: its kind, its ends and special points, and the command that follows it."""
    assert asked.second is not None
    letter = asked.second[0]
    blocks: list[Block] = []
    for number, curve in enumerate(found, 1):
        place, ends = "({:.6g}, {:.6g})", (curve["points"][0], curve["points"][-1])
        rows: list[tuple[Cell, ...]] = [
            (
                f"end: {why.removesuffix(' was reached')}",
                *(solved(x, PLACED) for x in np.round(point[:2], 9) + 0.0),
            )
            for why, point in zip(curve["ends"], ends, strict=True)
        ]
        rows += [(what, *(solved(x, PLACED) for x in np.round(point, 9) + 0.0)) for what, *point in curve["special"]]
        rows += [
            ("proved there", ShownNumber(text), ShownNumber(value, radius, Known.PROVED))
            for text, value, radius in curve["proved"]
        ]
        caption = (
            f"Curve {number}: {curve['kind']} of period {curve['period']}, through ({letter}, lambda) = "
            f"{place.format(*curve['near'])}; {len(curve['points'])} points, each solved for in float64."
        )
        blocks.append(Listing(caption, ("what", letter, "lambda"), tuple(rows), curve["command"]))
        for point, document in enumerate(curve["certificates"], 1):
            blocks.append(Certificate(f"curve-{number}-{point}", document))
    if not found:
        blocks.append(
            Paragraph("No curve: the cycles that were followed met no fold, doubling or pitchfork on their way.")
        )
    return blocks
