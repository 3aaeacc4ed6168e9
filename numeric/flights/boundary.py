"""The boundary of a table with its shape, in people's coordinates: ends of components, points, tangents, curvature."""

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.arrays import Arrays
from numeric.lowering.table_ir import Blueprint

Array = NDArray[np.float64]
FINE = 4096  # points on which a boundary is examined


class Frame(NamedTuple):
    """Points of the boundary with the unit tangent there; the normal to its left points into the table."""

    x: Any
    y: Any
    tx: Any
    ty: Any

    def direction(self, ops: Any, phi: Any) -> tuple[Any, Any]:
        """The unit direction of exit angle `phi`."""
        c, s = ops.cos(phi), ops.sin(phi)
        return s * self.tx - c * self.ty, s * self.ty + c * self.tx

    def angle(self, ops: Any, vx: Any, vy: Any) -> Any:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return ops.atan2(vx * self.tx + vy * self.ty, vy * self.tx - vx * self.ty)


class Boundary:
    """The components of a table at one shape. What a flight is chosen by, and what every flight may fall back on."""

    def __init__(self, blueprint: Blueprint, shape: list[float]) -> None:
        self.blueprint, self.shape, self.ops = blueprint, shape, Arrays()
        self.ends = [tuple(float(x) for x in part.ends(self.ops, *shape)) for part in blueprint.parts]

    @property
    def closed(self) -> bool:
        """One component that runs round the table by a whole turn of its parameter."""
        return len(self.ends) == 1 and abs(self.ends[0][1] - self.ends[0][0] - 2 * np.pi) < 1e-12

    @cached_property
    def convex(self) -> bool:
        """No curvature of the wrong sign on a fine grid of a closed curve, up to rounding."""
        theta = np.linspace(-np.pi, np.pi, FINE)
        curvature = self.bending(np.zeros(theta.size, dtype=np.int64), theta)[1]
        return bool(np.max(curvature) <= 1e-12 * np.max(np.abs(curvature)))

    def curve(self, component: NDArray[np.int64], theta: Array) -> Array:
        """Rows `x, y`, first and second derivatives with respect to `theta`."""
        rows = np.empty((6, *theta.shape))
        for index, part in enumerate(self.blueprint.parts):
            here: Any = component == index
            if not np.any(here):
                continue
            if np.all(here):
                here = ...  # a view in place of copies
            for i, values in enumerate(part.curve(self.ops, theta[here], *self.shape)):
                rows[i, here] = values
        return rows

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame:
        """Point and unit tangent."""
        x, y, dx, dy, _, _ = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return Frame(x, y, dx / speed, dy / speed)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        _, _, dx, dy, _, _ = self.curve(component, theta)
        return np.asarray(np.hypot(dx, dy))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dtheta`, and the paper's signed curvature, negative where the boundary focuses."""
        _, _, dx, dy, ax, ay = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return speed, -(dx * ay - dy * ax) / speed**3
