"""Chaotic sets as clouds of points: which balls are on the same one.

Two balls are on the same set when their orbits meet in a cell, or through a chain of balls that do. The
cells are fine, so sets that are near are not taken for one; the orbits are long, so that those that are
one meet.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from numeric import PinballMap
from verification.dynamics.places import Places, embedded, places

CELL = 1 / 512  # in x, y and sin(phi)
WIDE = 1 << 20  # more cells than there are in a row
BALLS = 48  # at most, whose orbits are compared
ORBIT = 4096  # bounces of each
KEPT = 8192  # points of a cloud


def clouds(map: PinballMap, balls: Places) -> list[Places]:
    """The sets on which the orbits of a few of the balls lie, the most visited first.

    >>> len(clouds(PinballMap("cardioid", lam="0.5"), places(0, [0.5, -0.5, 1.0], 0.1)))
    1
    """
    some = balls.only(np.linspace(0, balls.size - 1, min(balls.size, BALLS)).astype(int))
    orbit = map.orbit(some.theta, some.phi, ORBIT, some.component)
    along = Places(orbit.component[1:].T, orbit.theta[1:].T, orbit.phi[1:].T)
    members = joined(cells(map, along))
    found = []
    for group in range(members.max() + 1):
        points = places(*along.only(members == group))
        found.append(points.only(np.linspace(0, points.size - 1, min(points.size, KEPT)).astype(int)))
    return sorted(found, key=lambda points: -points.size)


def cells(map: PinballMap, along: Places) -> NDArray[np.int64]:
    """The number of the cell of each point, orbits along the rows."""
    flat = places(*along)
    x, y, z = np.floor(embedded(map, flat).T / CELL).astype(np.int64)
    _, number = np.unique((x * WIDE + y) * WIDE + z, return_inverse=True)
    return np.asarray(number).reshape(along.theta.shape)


def joined(number: NDArray[np.int64]) -> NDArray[np.int64]:
    """The group of each row, when rows that share a number belong together.

    >>> joined(np.array([[0, 1], [2, 3], [1, 4]])).tolist()
    [0, 1, 0]
    """
    balls, count = number.shape[0], int(number.max()) + 1
    row = np.repeat(np.arange(balls), number.shape[1])
    links = coo_array((np.ones(row.size), (row, balls + number.ravel())), shape=(balls + count, balls + count))
    group = connected_components(links, directed=False)[1][:balls]
    return np.asarray(np.unique(group, return_inverse=True)[1], dtype=np.int64)
