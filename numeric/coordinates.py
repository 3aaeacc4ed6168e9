"""A ball's state in people's coordinates: boundary parameter, angle, arc length, Cartesian point; and back.

`States` translate between the fields a kernel bounces and `(component, theta, phi)`. They run on
NumPy arrays, once per question and not once per bounce.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.blueprint import Blueprint
from numeric.families.family import SLAP, Family
from numeric.readers.arrays import Arrays

Array = NDArray[np.float64]
WALL = 0.25


class States:
    """The translation for one table with its shape."""

    def __init__(self, blueprint: Blueprint, family: Family, shape: list[float]) -> None:
        self.blueprint, self.family, self.shape = blueprint, family, shape
        self.ops = Arrays()
        self.ends = [tuple(float(x) for x in part.ends(self.ops, *shape)) for part in blueprint.parts]

    # ---- the boundary

    def curve(self, component: NDArray[np.int64], theta: Array) -> Array:
        """Rows `x, y`, first and second derivatives with respect to `theta`."""
        rows = np.empty((6, *theta.shape))
        for index, part in enumerate(self.blueprint.parts):
            here = component == index
            if np.any(here):
                values = part.curve(self.ops, theta[here], *self.shape)
                for i, value in enumerate(values):
                    rows[i, here] = value
        return rows

    def tangent(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The unit tangent, in closed form where the table has one without cancellation."""
        if self.family.name in ("cardioid", "cuspless"):
            x, y = -np.sin(1.5 * theta), np.cos(1.5 * theta)
            return np.where(component == 1, 0.0, x), np.where(component == 1, -1.0, y)
        _, _, dx, dy, _, _ = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return dx / speed, dy / speed

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        if self.family.name in ("cardioid", "cuspless"):
            return np.where(component == 1, 1.0, 2 * np.cos(theta / 2))
        _, _, dx, dy, _, _ = self.curve(component, theta)
        return np.asarray(np.hypot(dx, dy))

    def rate(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dp` for the parameter `p` of the family's tangent vectors: `theta`, or arc length itself."""
        if self.family.name in ("cardioid", "cuspless"):
            return np.ones(np.shape(theta))
        return self.speed(component, theta)

    def curvature(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The paper's signed curvature, negative where the boundary focuses."""
        if self.family.name in ("cardioid", "cuspless"):
            return np.where(component == 1, 0.0, -0.75 / np.cos(theta / 2))
        _, _, dx, dy, ax, ay = self.curve(component, theta)
        return np.asarray(-(dx * ay - dy * ax) / np.hypot(dx, dy) ** 3)

    # ---- fields of the kernels

    def enter(self, component: NDArray[np.int64], theta: Array, phi: Array, law: str) -> list[Array]:
        """The kernel's fields of a ball at `theta` that leaves at the exit angle `phi`."""
        name = self.family.name
        half = np.cos(theta / 2), np.sin(theta / 2)
        leaving = [np.cos(phi), np.sin(phi)]
        if name == "circle":
            fields, leaving = [theta], [phi]
        elif name == "cardioid":
            fields = [*half]
        elif name == "cuspless":
            wall = component == 1
            fields = [wall.astype(float), np.where(wall, -theta, half[0]), np.where(wall, 0.0, half[1])]
        else:
            tx, ty = self.tangent(component, theta)
            fields = [np.cos(theta), np.sin(theta)] if name != "general" else [component.astype(float), theta]
            c, s = leaving
            leaving = [s * tx - c * ty, s * ty + c * tx]
        return [np.array(field, dtype=float) for field in (fields if law == SLAP else fields + leaving)]

    def place(self, rows: Any) -> tuple[NDArray[np.int64], Array]:
        """Component and parameter of kernel fields."""
        name = self.family.name
        if name == "circle":
            return np.zeros(rows[0].shape, dtype=np.int64), rows[0]
        if name == "cardioid":
            return np.zeros(rows[0].shape, dtype=np.int64), 2 * np.arctan2(rows[1], rows[0])
        if name == "cuspless":
            wall = rows[0] > 0.5
            return wall.astype(np.int64), np.where(wall, -rows[1], 2 * np.arctan2(rows[2], rows[1]))
        if name == "general":
            return np.rint(rows[0]).astype(np.int64), rows[1]
        return np.zeros(rows[0].shape, dtype=np.int64), np.arctan2(rows[1], rows[0])

    def exit(self, component: NDArray[np.int64], theta: Array, rows: Any, law: str) -> Array:
        """The exit angle of kernel fields, in radians."""
        if law == SLAP:
            return np.zeros_like(theta)
        if self.family.name == "circle":
            return np.asarray(rows[1])
        x, y = rows[len(self.family.position) :][:2]
        if self.family.name in ("cardioid", "cuspless"):
            return np.asarray(np.arctan2(y, x))
        return self.angle_to_normal(component, theta, x, y)

    def angle_to_normal(self, component: NDArray[np.int64], theta: Array, vx: Array, vy: Array) -> Array:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        tx, ty = self.tangent(component, theta)
        return np.asarray(np.arctan2(vx * tx + vy * ty, vy * tx - vx * ty))

    def direction(self, component: NDArray[np.int64], theta: Array, phi: Array) -> tuple[Array, Array]:
        """The unit direction of exit angle `phi`."""
        tx, ty = self.tangent(component, theta)
        c, s = np.cos(phi), np.sin(phi)
        return s * tx - c * ty, s * ty + c * tx

    def point(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The Cartesian point; relative accuracy near the cardioid's cusp."""
        if self.family.name in ("cardioid", "cuspless"):
            radius = 2 * np.cos(theta / 2) ** 2
            wall = component == 1
            return np.where(wall, -WALL, radius * np.cos(theta)), np.where(wall, -theta, radius * np.sin(theta))
        x, y = self.curve(component, theta)[:2]
        return x, y
