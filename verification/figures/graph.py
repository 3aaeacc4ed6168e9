"""Graphs of the slap map, with gaps where it jumps. Paper: sections 2.2, 3.4, 4.2, 5.4 and 6.2."""

from collections.abc import Callable

import numpy as np

from numeric import PinballMap
from numeric.pinball.sampling import boundary
from verification.figures.panel import Array, Curve
from verification.figures.phase import arc_length, polar

FINEST = 1e-9  # of the abscissa: a jump that survives is no slope
JUMP = 0.02  # of the range of the values: larger steps are halved
MOST = 200_000  # points of a graph


def graph(f: Callable[[Array], Array], low: float, high: float, points: int) -> Curve:
    """`f` over the open interval, halved until its steps are small; a gap where one stays large.

    >>> stairs = graph(np.floor, 0.0, 2.0, 5)
    >>> int(np.isnan(stairs.y).sum()), np.unique(stairs.y[~np.isnan(stairs.y)]).tolist()
    (1, [0.0, 1.0])
    """
    x = low + (high - low) * (np.arange(points) + 0.5) / points
    y = f(x)
    extent = float(np.nanmax(y) - np.nanmin(y)) or 1.0
    while x.size < MOST:
        wide = (np.abs(np.diff(y)) > JUMP * extent) & (np.diff(x) > FINEST * (high - low))
        if not np.any(wide):
            break
        at = np.flatnonzero(wide)
        middle = (x[at] + x[at + 1]) / 2
        x, y = np.insert(x, at + 1, middle), np.insert(y, at + 1, f(middle))
    gaps = np.flatnonzero(np.abs(np.diff(y)) > JUMP * extent) + 1
    return Curve(np.insert(x, gaps, x[gaps]), np.insert(y, gaps, np.nan))


def by_arc_length(map: PinballMap, iterate: int, points: int) -> Curve:
    """The slap map's iterate, arc length against arc length."""
    half = map.arclength.perimeter / 2

    def image(s: Array) -> Array:
        component, theta = boundary(map, s)
        orbit = map.slap(theta, iterate, component)
        return np.where(orbit.code[-1] == 0, arc_length(map, orbit.component[-1], orbit.theta[-1]), np.nan)

    return graph(image, -half, half, points)


def by_angle(map: PinballMap, iterate: int, points: int) -> Curve:
    """The slap map's iterate, polar angle against polar angle, in [-pi, pi); for tables of one component."""

    def image(theta: Array) -> Array:
        return polar(map, map.slap(theta, iterate).theta[-1])

    found = graph(image, -np.pi, np.pi, points)
    return Curve(polar(map, found.x), found.y)
