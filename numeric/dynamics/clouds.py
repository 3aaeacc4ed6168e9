"""Chaotic sets as clouds of points: which balls are on the same one.

Two balls are on the same set when their orbits meet in a cell, or through a chain of balls that do. The
cells are fine, so sets that are near are not taken for one; the orbits are long, so that those that are
one meet.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from numeric import PinballMap
from numeric.dynamics.phase_points import Places, embedded, places, together

CELL = 1 / 512  # in x, y and sin(phi)
WIDE = 1 << 20  # more cells than there are in a row
BALLS = 48  # at most, whose orbits are compared
ORBIT = 4096  # bounces of each
KEPT = 8192  # points of a cloud
Labels = NDArray[np.int64]


class Gathered(NamedTuple):
    """Which balls were looked at, the set each is on, and the sets: those given come first, and keep their points."""

    looked: Labels
    member: Labels
    sets: list[Places]


def gathered(map: PinballMap, balls: Places, known: Sequence[Places] = ()) -> Gathered:
    """The sets on which the orbits of a few of the balls lie, sets known before among them.

    >>> found = gathered(PinballMap("cardioid", lam="0.5"), places(0, [0.5, -0.5, 1.0], 0.1))
    >>> found.member.tolist(), len(found.sets)
    ([0, 0, 0], 1)
    """
    looked = np.linspace(0, balls.size - 1, min(balls.size, BALLS)).astype(int)
    some = balls.only(looked)
    orbit = map.orbit(some.theta, some.phi, ORBIT, some.component)
    along = Places(orbit.component[1:].T, orbit.theta[1:].T, orbit.phi[1:].T)
    before = [np.full(points.size, i) for i, points in enumerate(known)]
    owner = np.concatenate([*before, len(known) + np.repeat(np.arange(looked.size), ORBIT)])
    group = joined(owner, cells(map, together(*known, places(*along))))
    old = {int(group[i]): i for i in reversed(range(len(known)))}
    sets, new = list(known), group[len(known) :]
    for number in dict.fromkeys(int(x) for x in new):
        if number not in old:
            old[number] = len(sets)
            points = places(*along.only(new == number))
            sets.append(points.only(np.linspace(0, points.size - 1, min(points.size, KEPT)).astype(int)))
    return Gathered(looked, np.array([old[int(x)] for x in new], dtype=np.int64), sets)


def cells(map: PinballMap, points: Places) -> Labels:
    """The number of the cell of each point."""
    x, y, z = np.floor(embedded(map, points).T / CELL).astype(np.int64)
    return np.asarray(np.unique((x * WIDE + y) * WIDE + z, return_inverse=True)[1], dtype=np.int64)


def joined(owner: Labels, cell: Labels) -> Labels:
    """The group of each owner of points, when owners with points in one cell belong together.

    >>> joined(np.array([0, 0, 1, 1, 2, 2]), np.array([0, 1, 2, 3, 1, 4])).tolist()
    [0, 1, 0]
    """
    count, room = int(owner.max()) + 1, int(cell.max()) + 1
    links = coo_array((np.ones(owner.size), (owner, count + cell)), shape=(count + room, count + room))
    group = connected_components(links, directed=False)[1][:count]
    return np.asarray(np.unique(group, return_inverse=True)[1], dtype=np.int64)
