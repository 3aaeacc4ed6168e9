"""Points of phase space by the hundred thousand: carried along orbits, told apart by distance, gathered to sets.

Two particles are on the same set when their orbits meet in a cell, or through a chain of particles that do. The
cells are fine, so sets that are near are not taken for one; the orbits are long, so that those that are
one meet.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.pinball.sampling import Growth

Array = NDArray[np.float64]


class PhasePoints(NamedTuple):
    """Components, parameters and exit angles: particles about to leave, or the points of an attractor."""

    component: NDArray[np.int64]
    theta: Array
    phi: Array

    def only(self, which: NDArray[np.bool_] | NDArray[np.int64] | slice) -> "PhasePoints":
        """Some of them."""
        return PhasePoints(self.component[which], self.theta[which], self.phi[which])

    def turned(self, bounces: int) -> "PhasePoints":
        """The same cycle, begun `bounces` later."""
        return PhasePoints(*(np.roll(row, -bounces) for row in self))  # type: ignore[arg-type]  # rows keep their kinds

    @property
    def size(self) -> int:
        """How many."""
        return int(self.theta.size)


class Advanced(NamedTuple):
    """Where particles came, and the code of what stopped them: 0 for nothing, see `numeric.Status`."""

    points: PhasePoints
    code: NDArray[np.int64]


def phase_points(theta: ArrayLike, phi: ArrayLike, component: ArrayLike = 0) -> PhasePoints:
    """Phase points from numbers or arrays of any shape, in one row.

    >>> phase_points([0.0, 1.0], 0.0).component.tolist()
    [0, 0]
    """
    index, angle, exit = np.broadcast_arrays(component, theta, phi)
    return PhasePoints(index.ravel().astype(np.int64), angle.ravel().astype(float), exit.ravel().astype(float))


def together(*parts: PhasePoints) -> PhasePoints:
    """One row after the other."""
    component, theta, phi = (np.concatenate(rows) for rows in zip(*parts, strict=True))
    return PhasePoints(component, theta, phi)


def advanced(map: PinballMap, particles: PhasePoints, bounces: int) -> Advanced:
    """The particles `bounces` bounces later: the kernel's own time, nothing recorded."""
    if particles.size == 0 or bounces < 1:
        return Advanced(particles, np.zeros(particles.size, dtype=np.int64))
    growth = Growth(map, particles.theta, particles.phi, particles.component)
    growth.skip(bounces)
    return Advanced(PhasePoints(growth.component, growth.theta, growth.phi), growth.code)


def embedded(map: PinballMap, particles: PhasePoints) -> Array:
    """Rows `x, y, sin(phi)`, in which distances are measured: no angle has an end there.

    >>> embedded(PinballMap("circle"), phase_points([0.0], [0.0])).tolist()
    [[1.0, 0.0, 0.0]]
    """
    x, y = map.states.point(particles.component, particles.theta)
    return np.stack([x, y, np.sin(particles.phi)], axis=1)


CELL = 1 / 512  # in x, y and sin(phi)
WIDE = 1 << 20  # more cells than there are in a row
PARTICLES = 48  # at most, whose orbits are compared
ORBIT = 4096  # bounces of each
KEPT = 8192  # points of a cloud
Labels = NDArray[np.int64]


class Gathered(NamedTuple):
    """The particles looked at, the set each is on, and the sets: those given come first, and keep their points."""

    looked: Labels
    member: Labels
    sets: list[PhasePoints]


def gathered(map: PinballMap, particles: PhasePoints, known: Sequence[PhasePoints] = ()) -> Gathered:
    """The sets on which the orbits of a few of the particles lie, sets known before among them.

    >>> found = gathered(PinballMap("cardioid", lam="0.5"), phase_points([0.5, -0.5, 1.0], 0.1))
    >>> found.member.tolist(), len(found.sets)
    ([0, 0, 0], 1)
    """
    looked = np.linspace(0, particles.size - 1, min(particles.size, PARTICLES)).astype(int)
    some = particles.only(looked)
    orbit = map.orbit(some.theta, some.phi, ORBIT, some.component)
    along = PhasePoints(orbit.component[1:].T, orbit.theta[1:].T, orbit.phi[1:].T)
    before = [np.full(points.size, i) for i, points in enumerate(known)]
    owner = np.concatenate([*before, len(known) + np.repeat(np.arange(looked.size), ORBIT)])
    group = joined(owner, cells(map, together(*known, phase_points(along.theta, along.phi, along.component))))
    old = {int(group[i]): i for i in reversed(range(len(known)))}
    sets, new = list(known), group[len(known) :]
    for number in dict.fromkeys(int(x) for x in new):
        if number not in old:
            old[number] = len(sets)
            part = along.only(new == number)
            points = phase_points(part.theta, part.phi, part.component)
            sets.append(points.only(np.linspace(0, points.size - 1, min(points.size, KEPT)).astype(int)))
    return Gathered(looked, np.array([old[int(x)] for x in new], dtype=np.int64), sets)


def cells(map: PinballMap, points: PhasePoints) -> Labels:
    """The number of the cell of each point."""
    x, y, z = np.floor(embedded(map, points).T / CELL).astype(np.int64)
    return np.asarray(np.unique((x * WIDE + y) * WIDE + z, return_inverse=True)[1], dtype=np.int64)


def joined(owner: Labels, cell: Labels) -> Labels:
    """The group of each owner of points, when owners with points in one cell belong together.

    >>> joined(np.array([0, 0, 1, 1, 2, 2]), np.array([0, 1, 2, 3, 1, 4])).tolist()
    [0, 1, 0]
    """
    from scipy.sparse import coo_array  # a quarter of a second that cycles do without
    from scipy.sparse.csgraph import connected_components

    count, room = int(owner.max()) + 1, int(cell.max()) + 1
    links = coo_array((np.ones(owner.size), (owner, count + cell)), shape=(count + room, count + room))
    group = connected_components(links, directed=False)[1][:count]
    return np.asarray(np.unique(group, return_inverse=True)[1], dtype=np.int64)
