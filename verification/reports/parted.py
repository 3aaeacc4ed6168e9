"""Sudden changes of the sampled attractor on a table in pieces, and how close it comes to a tangency.

Manifolds that cross a join, a cusp or a corner break there and are not followed, so tangencies are not searched for.
But at a homoclinic tangency an expanded and a contracted direction are parallel, so the least angle between them over a
chaotic attractor shows whether a tangency can be near. If this angle stays away from 0, something else changes the
attractor, such as a corner that it meets in the cuspless table (paper: section 5.2).
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from numeric import PinballMap
from numeric.dynamics.exponents import angles
from numeric.dynamics.phase_points import PhasePoints
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.sweep import measured
from verification.reports.asked import Asked
from verification.reports.blocks import Block, Cell, Listing, Paragraph, sampled

PARTICLES, TRANSIENT, BOUNCES, WATCHED = 64, 5_000, 1_000, 400
NONE = (
    "The diagram shows no contraction at which a chaotic attractor gains or loses much at once, so there is none near "
    "which a tangency would be sought."
)
CAPTION = (
    "Contractions at which the diagram shows a chaotic attractor to gain or lose much at once. No tangency is sought "
    "there: manifolds that cross a join, a cusp or a corner are not followed, nor are those of laws of arc length. At "
    "a tangency an expanded and a contracted direction are parallel: the last column has the least angle between both "
    "over the chaotic particles, in radians, and its error is the difference of two halves of them. Where it stays "
    "away from 0 nothing that was sampled comes near a tangency."
)


def least_angle(asked: Asked, lam: float) -> tuple[float, float, int] | None:
    """The least angle between the expanded and the contracted direction, its error, and the number of points used.

    None if fewer than two particles are chaotic, or at contraction 0, where one direction vanishes.

    >>> from symbolic import Scene
    >>> angle, error, _ = least_angle(Asked(Scene("cuspless")), 0.5)  # a cone of directions is proved there
    >>> angle > 0.2 and error < 0.1
    True
    >>> least_angle(Asked(Scene("circle")), 0.5) is None
    True
    """
    if lam <= 0:
        return None
    map = PinballMap(asked.scene).at(lam)
    found = measured(map, interior_starts(map, PARTICLES, asked.seed), BOUNCES, TRANSIENT)
    chaotic = np.flatnonzero(found.chaotic)
    if chaotic.size < 2:
        return None
    seen = angles(map, PhasePoints(*found.ended(chaotic)[:3]), WATCHED, 0).reshape(WATCHED, -1)
    halves = [float(np.nanmin(seen[:, i::2])) for i in (0, 1)]
    return min(halves), abs(halves[0] - halves[1]), int(np.isfinite(seen).sum())


def near_changes(asked: Asked, pairs: Sequence[tuple[float, float]]) -> list[dict[str, Any]]:
    """For each change, the two contractions around it and the smaller of the least angles at these two."""
    rows = []
    for low, high in pairs:
        sides = [side for lam in (low, high) if (side := least_angle(asked, lam))]
        rows.append({"between": [low, high], "angle": list(min(sides)) if sides else None})
    return rows


def told_of(asked: Asked, rows: Sequence[Mapping[str, Any]]) -> Block:
    """A table of the changes, or a sentence that there are none."""
    if not rows:
        return Paragraph(NONE)
    cells: list[tuple[Cell, ...]] = []
    for row in rows:
        low, high = row["between"]
        where = sampled((low + high) / 2, (high - low) / 2)
        if row["angle"]:
            angle, error, count = row["angle"]
            cells.append((where, str(count), sampled(angle, error, 1e-12)))
        else:
            cells.append((where, "0", "chaos that ends: no attractor"))
    command = asked.command("bifurcation", f"--lams {asked.low}:{asked.high}:150")
    return Listing(CAPTION, ("lam", "points", "least angle"), tuple(cells), command)
