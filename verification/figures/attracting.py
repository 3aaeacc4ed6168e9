"""Attractors as a figure shows them: cycles as closed polygons or a few marks, chaotic sets as one long orbit."""

import numpy as np

from numeric import Orbit, PinballMap
from verification.dynamics.attractors import find
from verification.dynamics.kinds import Attractor, Kind
from verification.figures.panel import Curve
from verification.figures.phase import SEED

STARTS = 200  # random starts among which attractors are looked for


def found(map: PinballMap, starts: int = STARTS) -> dict[str, Attractor]:
    """The attractors by name: `period 3`, `period 3, second`, `chaotic` and so on, the most visited first.

    >>> list(found(PinballMap("egg", lam="0.7", alpha="0.08"), 50))
    ['period 3', 'period 3 (2)']
    """
    named: dict[str, Attractor] = {}
    for attractor in find(map, starts, SEED):
        if attractor.kind in (Kind.CYCLE, Kind.CHAOTIC):
            base = f"period {attractor.period}" if attractor.kind is Kind.CYCLE else "chaotic"
            count = sum(name.startswith(base) and name[len(base) :][:1] in ("", " ") for name in named)
            named[base + (f" ({count + 1})" if count else "")] = attractor
    return named


def orbit_on(map: PinballMap, attractor: Attractor, bounces: int) -> Orbit:
    """An orbit on the attractor, as one column; of a cycle, once round and closed."""
    first, turns = attractor.points, attractor.period or bounces
    return map.orbit(first.theta[:1], first.phi[:1], turns, first.component[:1])


def cycle_points(map: PinballMap, attractor: Attractor) -> tuple[Curve, Curve]:
    """A cycle's bounces in `(theta, sin(phi))`, and its closed polygon in the plane."""
    where, theta, phi = attractor.points
    x, y = map.states.point(where, theta)
    return Curve(np.arctan2(y, x), np.sin(phi)), Curve(np.append(x, x[0]), np.append(y, y[0]))


def shares(named: dict[str, Attractor]) -> dict[str, float]:
    """The share of the starts that each attractor draws."""
    return {f"share of {name}": a.share.count / a.share.of for name, a in named.items() if a.share is not None}
