"""Basins of attraction: the label of every start, and starts where one wants them in phase space. Paper: appendix.

A plain function on arrays, so that a picture of any resolution is made piece by piece and in any order: the
label of a start does not depend on the others. All coordinates are the paper's, `s` and `sin(phi)`.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.pinball.sampling import boundary
from verification.dynamics.attractors import classify
from verification.dynamics.kinds import Attractor
from verification.dynamics.places import Array, Places, places
from verification.dynamics.recognition import UNSETTLED, Labels, at_clouds, at_cycles

TRANSIENT = 1000
PIECE = 1 << 16  # balls at a time


class Window(NamedTuple):
    """A rectangle of phase space; the ends of `s` may lie beyond a turn of the boundary."""

    s: tuple[float, float]
    sin_phi: tuple[float, float]


def whole(map: PinballMap) -> Window:
    """All of phase space.

    >>> whole(PinballMap("cardioid"))
    Window(s=(-4.0, 4.0), sin_phi=(-1.0, 1.0))
    """
    half = map.arclength.perimeter / 2
    return Window((-half, half), (-1.0, 1.0))


def starts_at(map: PinballMap, s: ArrayLike, sin_phi: ArrayLike) -> Places:
    """The balls at these coordinates; beyond grazing, `|sin(phi)| > 1`, the angle is mirrored back.

    >>> ball = starts_at(PinballMap("cardioid"), [2.0], [0.5])
    >>> [round(float(x[0]), 6) for x in (ball.theta, ball.phi)]
    [1.047198, 0.523599]
    """
    along, height = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(sin_phi, dtype=float))
    height = np.where(np.abs(height) > 1, np.sign(height) * 2 - height, height) * (1 - 1e-12)
    component, theta = boundary(map, along.ravel())
    return places(component, theta, np.arcsin(height.ravel()))


def labels(
    map: PinballMap, balls: Places, attractors: Sequence[Attractor], transient: int = TRANSIENT, sure: bool = False
) -> Labels:
    """The index of the attractor that each ball reaches, of those known; -1 where it reaches none of them.

    Quick: after `transient` bounces a ball within reach of a cycle is settled, and one on the cloud of a chaotic
    attractor too. With `sure`, as long as any ball is still leaving the cloud for a cycle, all go on.

    >>> from verification.dynamics.attractors import find
    >>> map = PinballMap("cuspless", lam="0.09")
    >>> found = find(map, 100, seed=1)
    >>> label = labels(map, places([1, 0], [0.0, 0.2], [0.0, -0.03]), found)
    >>> [found[i].kind.name for i in label]
    ['CYCLE', 'CHAOTIC']
    """
    found = np.full(balls.size, UNSETTLED)
    for first in range(0, balls.size, PIECE):
        part = balls.only(slice(first, first + PIECE))
        found[first : first + PIECE] = _settled(map, part, attractors, transient, sure)
    return found


def _settled(map: PinballMap, balls: Places, attractors: Sequence[Attractor], transient: int, sure: bool) -> Labels:
    end = map.exponents(balls.theta, balls.phi, transient, 0, balls.component)
    there = Places(end.component, end.theta, end.phi)
    found = at_cycles(map, there, attractors)
    going = np.nonzero((found == UNSETTLED) & (end.code == 0))[0]
    if not sure:
        spread = going[end.nu_plus[going] > 0]
        found[spread] = at_clouds(map, there.only(spread), attractors)
        going = np.nonzero((found == UNSETTLED) & (end.code == 0))[0]
    if going.size:
        here = there.only(going)
        late = classify(map, *here, transient=transient, known=attractors).label
        found[going] = np.where(late < len(attractors), late, UNSETTLED)
    return found


def random_points(window: Window, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Points of a window, uniform in `s` and `sin(phi)`."""
    return rng.uniform(*window.s, count), rng.uniform(*window.sin_phi, count)


def grid(window: Window, columns: int, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The centres of the cells of a window, row after row.

    >>> [x.tolist() for x in grid(Window((0.0, 1.0), (0.0, 1.0)), 2, 1)]
    [[0.25, 0.75], [0.5, 0.5]]
    """
    s = window.s[0] + (np.arange(columns) + 0.5) * (window.s[1] - window.s[0]) / columns
    height = window.sin_phi[0] + (np.arange(rows) + 0.5) * (window.sin_phi[1] - window.sin_phi[0]) / rows
    return np.tile(s, rows), np.repeat(height, columns)
