"""Points of phase space by the hundred thousand: carried along orbits, and told apart by their distance."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap

Array = NDArray[np.float64]


class Places(NamedTuple):
    """Components, parameters and exit angles: balls about to leave, or the points of an attractor."""

    component: NDArray[np.int64]
    theta: Array
    phi: Array

    def only(self, which: NDArray[np.bool_] | NDArray[np.int64] | slice) -> "Places":
        """Some of them."""
        return Places(self.component[which], self.theta[which], self.phi[which])

    def turned(self, bounces: int) -> "Places":
        """The same cycle, begun `bounces` later."""
        return Places(*(np.roll(row, -bounces) for row in self))  # type: ignore[arg-type]  # rows keep their kinds

    @property
    def size(self) -> int:
        """How many."""
        return int(self.theta.size)


class Advanced(NamedTuple):
    """Where balls came, and the code of what stopped them: 0 for nothing, see `numeric.Status`."""

    places: Places
    code: NDArray[np.int64]


def places(component: ArrayLike, theta: ArrayLike, phi: ArrayLike) -> Places:
    """Places from numbers or arrays of any shape, in one row.

    >>> places(0, [0.0, 1.0], 0.0).component.tolist()
    [0, 0]
    """
    index, angle, exit = np.broadcast_arrays(component, theta, phi)
    return Places(index.ravel().astype(np.int64), angle.ravel().astype(float), exit.ravel().astype(float))


def together(*parts: Places) -> Places:
    """One row after the other."""
    component, theta, phi = (np.concatenate(rows) for rows in zip(*parts, strict=True))
    return Places(component, theta, phi)


def advanced(map: PinballMap, balls: Places, bounces: int) -> Advanced:
    """The balls `bounces` bounces later: the kernel's own time, nothing recorded."""
    if balls.size == 0 or bounces < 1:
        return Advanced(balls, np.zeros(balls.size, dtype=np.int64))
    end = map.exponents(balls.theta, balls.phi, 1, bounces - 1, balls.component)
    return Advanced(Places(end.component, end.theta, end.phi), end.code)


def embedded(map: PinballMap, balls: Places) -> Array:
    """Rows `x, y, sin(phi)`, in which distances are measured: no angle has an end there.

    >>> embedded(PinballMap("circle"), places(0, [0.0], [0.0])).tolist()
    [[1.0, 0.0, 0.0]]
    """
    x, y = map.states.point(balls.component, balls.theta)
    return np.stack([x, y, np.sin(balls.phi)], axis=1)
