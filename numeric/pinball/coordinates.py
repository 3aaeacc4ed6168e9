"""A ball's state in people's coordinates: boundary parameter, angle, arc length, Cartesian point; and back.

`States` translate between the fields a kernel bounces and `(component, theta, phi)`. They run on
NumPy arrays, once per question and not once per bounce; of a recorded orbit, a tile at a time.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.arrays import Arrays
from numeric.flights.family import SLAP, Family
from numeric.lowering.table_ir import Blueprint

Array = NDArray[np.float64]
WALL = 0.25
TILE = 1 << 13  # points of orbits translated at a time


class Frame(NamedTuple):
    """Points of the boundary with the unit tangent there; the normal to its left points into the table."""

    x: Array
    y: Array
    tx: Array
    ty: Array

    def direction(self, phi: Array) -> tuple[Array, Array]:
        """The unit direction of exit angle `phi`."""
        c, s = np.cos(phi), np.sin(phi)
        return s * self.tx - c * self.ty, s * self.ty + c * self.tx

    def angle(self, vx: Array, vy: Array) -> Array:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return np.asarray(np.arctan2(vx * self.tx + vy * self.ty, vy * self.tx - vx * self.ty))


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
            here: Any = component == index
            if not np.any(here):
                continue
            if np.all(here):
                here = ...  # a view in place of copies
            for i, values in enumerate(part.curve(self.ops, theta[here], *self.shape)):
                rows[i, here] = values
        return rows

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame:
        """Point and tangent, in closed form where the table has one without cancellation."""
        if self.family.name in ("cardioid", "cuspless"):  # relative accuracy near the cusp
            wall, radius = component == 1, 2 * np.cos(theta / 2) ** 2
            x, y = np.where(wall, -WALL, radius * np.cos(theta)), np.where(wall, -theta, radius * np.sin(theta))
            tx, ty = np.where(wall, 0.0, -np.sin(1.5 * theta)), np.where(wall, -1.0, np.cos(1.5 * theta))
            return Frame(x, y, tx, ty)
        x, y, dx, dy, _, _ = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return Frame(x, y, dx / speed, dy / speed)

    def point(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The Cartesian point."""
        return self.frame(component, theta)[:2]

    def tangent(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The unit tangent."""
        return self.frame(component, theta)[2:]

    def direction(self, component: NDArray[np.int64], theta: Array, phi: Array) -> tuple[Array, Array]:
        """The unit direction of exit angle `phi`."""
        return self.frame(component, theta).direction(phi)

    def angle_to_normal(self, component: NDArray[np.int64], theta: Array, vx: Array, vy: Array) -> Array:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return self.frame(component, theta).angle(vx, vy)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        if self.family.name in ("cardioid", "cuspless"):
            return np.where(component == 1, 1.0, 2 * np.cos(theta / 2))
        _, _, dx, dy, _, _ = self.curve(component, theta)
        return np.asarray(np.hypot(dx, dy))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dp` for the parameter `p` of the family's tangent vectors, `theta` or arc length; and the curvature."""
        if self.family.name in ("cardioid", "cuspless"):
            return np.ones(np.shape(theta)), np.where(component == 1, 0.0, -0.75 / np.cos(theta / 2))
        _, _, dx, dy, ax, ay = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return speed, -(dx * ay - dy * ax) / speed**3

    def curvature(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The paper's signed curvature, negative where the boundary focuses."""
        return self.bending(component, theta)[1]

    # ---- fields of the kernels

    def enter(
        self, component: NDArray[np.int64], theta: Array, phi: Array, law: str, frame: Frame | None = None
    ) -> list[Array]:
        """The kernel's fields of a ball at `theta` that leaves at the exit angle `phi`; its frame, if it is known."""
        name = self.family.name
        if name == "circle":
            fields, leaving = [theta], [phi]
        elif name in ("cardioid", "cuspless"):
            fields, leaving = [np.cos(theta / 2), np.sin(theta / 2)], [np.cos(phi), np.sin(phi)]
            if name == "cuspless":
                wall = component == 1
                fields = [wall.astype(float), np.where(wall, -theta, fields[0]), np.where(wall, 0.0, fields[1])]
        else:
            fields = [np.cos(theta), np.sin(theta)] if name != "general" else [component.astype(float), theta]
            leaving = [*(frame or self.frame(component, theta)).direction(phi)]
        return [np.array(field, dtype=float) for field in (fields if law == SLAP else fields + leaving)]

    def departure(self, own: list[Array], law: str) -> Array:
        """`N0 = speed*cos(phi)` of balls that are about to leave, from their fields."""
        with np.errstate(all="ignore"):
            return np.asarray(self.family.rate(self.ops, self.shape, law, own) + np.zeros(own[0].size))

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

    def exit(
        self, component: NDArray[np.int64], theta: Array, rows: Any, law: str, frame: Frame | None = None
    ) -> Array:
        """The exit angle of kernel fields, in radians; the frame of their place, if it is known."""
        if law == SLAP:
            return np.zeros_like(theta)
        if self.family.name == "circle":
            return np.asarray(rows[1])
        x, y = self.kept(rows)
        if self.family.name in ("cardioid", "cuspless"):
            return np.asarray(np.arctan2(y, x))
        return (frame or self.frame(component, theta)).angle(x, y)

    def leaving(self, frame: Frame, phi: Array, rows: Any, law: str) -> tuple[Array, Array]:
        """The unit direction of the flight that begins: the one that the kernel keeps, if it keeps one."""
        if law == SLAP or self.family.name in ("circle", "cardioid", "cuspless"):
            return frame.direction(phi)
        return self.kept(rows)

    def kept(self, rows: Any) -> tuple[Array, Array]:
        """The two rows of the exit, which follow those of the place."""
        x, y, *_ = rows[len(self.family.position) :]
        return x, y

    def told(
        self, record: Array, start: tuple[Any, ...], begun: Frame, own: list[Array], lam: Array, law: str
    ) -> list[Any]:
        """Component, parameter, exit angle, incidence angle and point, at the start and after each recorded bounce.

        A tile at a time, so that what is worked on stays in the processor's cache.
        """
        where, theta, phi = start
        told: list[Any] = [np.empty((len(record) + 1, lam.size), dtype=kind) for kind in (np.int64, *[float] * 5)]
        for rows, first in zip(told, (where, theta, phi, np.nan, begun.x, begun.y), strict=True):
            rows[0] = first
        across = min(lam.size, TILE)
        down = TILE // across
        for left in range(0, lam.size, across):
            ball = slice(left, left + across)
            frame = Frame(*(side[ball] for side in begun))
            flight = self.leaving(frame, phi[ball], [field[ball] for field in own], law)
            for top in range(0, len(record), down):
                fields = list(record[top : top + down, :, ball].swapaxes(0, 1))
                component, at = self.place(fields)
                frame = self.frame(component, at)
                exit = self.exit(component, at, fields, law, frame)
                exit = exit * (lam[ball] != 0)  # the normal, whatever atan2 rounds to
                leaving = self.leaving(frame, exit, fields, law)
                vx, vy = (np.concatenate([v[None], later[:-1]]) for v, later in zip(flight, leaving, strict=True))
                flight = leaving[0][-1], leaving[1][-1]
                found = component, at, exit, frame.angle(-vx, -vy), frame.x, frame.y
                for rows, part in zip(told, found, strict=True):
                    rows[top + 1 : top + 1 + down, ball] = part
        return told
