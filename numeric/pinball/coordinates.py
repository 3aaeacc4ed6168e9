"""A ball's state in people's coordinates: boundary parameter, angle, arc length, Cartesian point; and back.

`States` translate between the fields a kernel bounces and `(component, theta, phi)`. They run on
NumPy arrays, once per question and not once per bounce; of a recorded orbit, a tile at a time.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.flights.boundary import Frame
from numeric.flights.family import SLAP, Family

Array = NDArray[np.float64]
TILE = 1 << 13  # points of orbits translated at a time


class States:
    """The translation for one table with its shape; what is particular to a family of tables is the family's answer."""

    def __init__(self, family: Family) -> None:
        self.family, self.boundary = family, family.boundary
        self.shape, self.ops, self.ends = self.boundary.shape, self.boundary.ops, self.boundary.ends

    # ---- the boundary

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame:
        """Point and tangent, in closed form where the table has one without cancellation."""
        return self.family.frame(component, theta)

    def point(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The Cartesian point."""
        return self.frame(component, theta)[:2]

    def tangent(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The unit tangent."""
        return self.frame(component, theta)[2:]

    def direction(self, component: NDArray[np.int64], theta: Array, phi: Array) -> tuple[Array, Array]:
        """The unit direction of exit angle `phi`."""
        return self.frame(component, theta).direction(self.ops, phi)

    def angle_to_normal(self, component: NDArray[np.int64], theta: Array, vx: Array, vy: Array) -> Array:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return np.asarray(self.frame(component, theta).angle(self.ops, vx, vy))

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        return self.family.speed(component, theta)

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dp` for the parameter `p` of the family's tangent vectors, `theta` or arc length; and the curvature."""
        return self.family.bending(component, theta)

    def curvature(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The paper's signed curvature, negative where the boundary focuses."""
        return self.bending(component, theta)[1]

    # ---- fields of the kernels

    def enter(
        self, component: NDArray[np.int64], theta: Array, phi: Array, law: str, frame: Frame | None = None
    ) -> list[Array]:
        """The kernel's fields of a ball at `theta` that leaves at the exit angle `phi`; its frame, if it is known."""
        fields = self.family.enter(self.ops, component.astype(float), theta)
        if law != SLAP:
            fields = fields + self.family.aim(self.ops, frame or self.frame(component, theta), phi)
        return [np.array(field, dtype=float) for field in fields]

    def departure(self, own: list[Array], law: str) -> Array:
        """`N0 = speed*cos(phi)` of balls that are about to leave, from their fields."""
        with np.errstate(all="ignore"):
            return np.asarray(self.family.rate(self.ops, self.shape, law, own) + np.zeros(own[0].size))

    def place(self, rows: Any) -> tuple[NDArray[np.int64], Array]:
        """Component and parameter of kernel fields."""
        component, theta = self.family.place(self.ops, list(rows[: len(self.family.position)]))
        return np.broadcast_to(np.rint(component).astype(np.int64), theta.shape), theta

    def exit(
        self, component: NDArray[np.int64], theta: Array, rows: Any, law: str, frame: Frame | None = None
    ) -> Array:
        """The exit angle of kernel fields, in radians; the frame of their place, if it is known."""
        if law == SLAP:
            return np.zeros_like(theta)
        return np.asarray(self.family.exit(self.ops, frame or self.frame(component, theta), self.kept(rows)))

    def leaving(self, frame: Frame, phi: Array, rows: Any, law: str) -> tuple[Array, Array]:
        """The unit direction of the flight that begins: the one that the kernel keeps, if it keeps one."""
        if law == SLAP:
            return frame.direction(self.ops, phi)
        return self.family.heading(self.ops, frame, phi, self.kept(rows))

    def kept(self, rows: Any) -> list[Array]:
        """The rows of the exit, which follow those of the place."""
        begin = len(self.family.position)
        return list(rows[begin : begin + len(self.family.direction)])

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
                found = component, at, exit, frame.angle(self.ops, -vx, -vy), frame.x, frame.y
                for rows, part in zip(told, found, strict=True):
                    rows[top + 1 : top + 1 + down, ball] = part
        return told
