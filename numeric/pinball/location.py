"""From Cartesian coordinates to the boundary: the component and the parameter of a point on it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.pinball.coordinates import States

Array = NDArray[np.float64]
ON = 1e-9  # a point farther from the boundary than this, in units of the table's size, is not on it
GRID = 2048


def located(states: States, x: Array, y: Array) -> tuple[NDArray[np.int64], Array]:
    """Component and parameter of each point; a point off the boundary is refused."""
    x, y = np.broadcast_arrays(x, y)
    if x.size == 0:
        raise ValueError("x and y are empty; give at least one point")
    best = np.full(x.shape, np.inf)
    component, theta = np.zeros(x.shape, dtype=np.int64), np.zeros(x.shape)
    size = 0.0
    for index, (low, high) in enumerate(states.ends):
        grid = np.linspace(low, high, GRID + 1)
        px, py = states.point(np.full(grid.shape, index), grid)
        size = max(size, float(np.max(np.hypot(px, py))))
        nearest = np.argmin(np.hypot(x[..., None] - px, y[..., None] - py), axis=-1)
        at = _polished(states, index, grid[nearest], x, y, low, high)
        gap = _gap(states, index, at, x, y)
        better = gap < best
        best, component, theta = (np.where(better, *pair) for pair in ((gap, best), (index, component), (at, theta)))
    off = best > ON * size
    if np.any(off):
        point = f"({x[off].flat[0]}, {y[off].flat[0]})"
        raise ValueError(f"the point {point} is not on the boundary; it is {best[off].flat[0]:.3g} away from it")
    return component, theta


def _gap(states: States, index: int, theta: Array, x: Array, y: Array) -> Any:
    px, py = states.point(np.full(theta.shape, index), theta)
    return np.hypot(x - px, y - py)


def _polished(states: States, index: int, theta: Array, x: Array, y: Array, low: float, high: float) -> Array:
    """Gauss and Newton's way to the nearest point: the step along the tangent."""
    where = np.full(theta.shape, index)
    for _ in range(8):
        px, py = states.point(where, theta)
        tx, ty = states.tangent(where, theta)
        speed = np.maximum(states.speed(where, theta), 1e-300)
        step = ((x - px) * tx + (y - py) * ty) / speed
        theta = np.clip(theta + np.clip(step, -0.1, 0.1), low, high)
    return np.asarray(theta)
