"""Arrays of phase points, which can be advanced along orbits, and embedded in a space with a distance."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.pinball.sampling import Growth

Array = NDArray[np.float64]
Labels = NDArray[np.int64]


class PhasePoints(NamedTuple):
    """Arrays of components, parameters `theta` and exit angles `phi`: departing particles, or an attractor's points."""

    component: NDArray[np.int64]
    theta: Array
    phi: Array

    def only(self, which: NDArray[np.bool_] | NDArray[np.int64] | slice) -> "PhasePoints":
        """The phase points at these indices, or where a mask is true."""
        return PhasePoints(self.component[which], self.theta[which], self.phi[which])

    def turned(self, bounces: int) -> "PhasePoints":
        """The points of a cycle in order, from its bounce number `bounces` on."""
        return PhasePoints(*(np.roll(row, -bounces) for row in self))  # type: ignore[arg-type]  # rows keep their kinds

    @property
    def size(self) -> int:
        """Number of phase points."""
        return int(self.theta.size)


class Advanced(NamedTuple):
    """Particles after some bounces, and for each the code of the outcome that stopped it (`numeric.Status`), or 0."""

    points: PhasePoints
    code: NDArray[np.int64]


def phase_points(theta: ArrayLike, phi: ArrayLike, component: ArrayLike = 0) -> PhasePoints:
    """Phase points from numbers or arrays of any shape, which are broadcast and flattened.

    >>> phase_points([0.0, 1.0], 0.0).component.tolist()
    [0, 0]
    """
    index, angle, exit = np.broadcast_arrays(component, theta, phi)
    return PhasePoints(index.ravel().astype(np.int64), angle.ravel().astype(float), exit.ravel().astype(float))


def together(*parts: PhasePoints) -> PhasePoints:
    """The phase points of all parts, in order."""
    component, theta, phi = (np.concatenate(rows) for rows in zip(*parts, strict=True))
    return PhasePoints(component, theta, phi)


def advanced(map: PinballMap, particles: PhasePoints, bounces: int) -> Advanced:
    """The particles after `bounces` bounces, of which none is recorded."""
    if particles.size == 0 or bounces < 1:
        return Advanced(particles, np.zeros(particles.size, dtype=np.int64))
    growth = Growth(map, particles.theta, particles.phi, particles.component)
    growth.skip(bounces)
    return Advanced(PhasePoints(growth.component, growth.theta, growth.phi), growth.code)


def embedded(map: PinballMap, particles: PhasePoints) -> Array:
    """Rows `x, y, sin(phi)` in units of the table's size: coordinates for distances, without the jump of an angle.

    >>> embedded(PinballMap("circle"), phase_points([0.0], [0.0])).tolist()
    [[1.0, 0.0, 0.0]]
    """
    x, y = map.family.cartesian(particles.component, particles.theta)
    size = map.states.size / map.unit.length
    return np.stack([x / size, y / size, np.sin(particles.phi)], axis=1)
