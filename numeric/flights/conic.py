"""An ellipse given by its radius about a focus, however long: no digit is lost at its far end or at its tips.

A conic about the origin, `1/r = p + Q.n` with `n = (cos(theta), sin(theta))`, is an ellipse of which the origin is a
focus. Its flight is the ellipse's, in the eccentric parameter `E`; users see the polar angle. With `e = |Q|/p` and
angles from the direction of `Q`, `tan(theta/2) = sqrt((1 + e)/(1 - e))*tan(E/2)`.

At its tips the boundary turns `1/sqrt(1 - e*e)` times as fast as the parameter, 22 times at `e = 0.999`. So the
rounding of a landing would be magnified in the direction in which the particle leaves. Where this factor is above
`ROUND`, the chord is found with twice the digits, which takes no longer than on the egg. The tangent at the landing is
computed before the landing is rounded, so that both have no more than their own rounding error.
"""

from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends import functions as plane
from numeric.backends.doubled import Doubles
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import SLAP, Array, Boundary, Frame, Landing
from numeric.flights.harmonic import Ellipse

ROUND = 1.5  # the longer axis over the shorter


class Focus(NamedTuple, Generic[N]):
    """The numbers that describe a conic about the origin, in some arithmetic."""

    ahead: Pair[N]  # the direction of `Q`, from which its angles are counted
    p: N
    size: N  # of `Q`
    gap: N  # `p - |Q|` to its last bit
    ratio: N  # `sqrt((1 + e)/(1 - e))`


class Conic(Ellipse):
    """An ellipse given by its radius about a focus; no differences of the radius occur, which lose digits at the far
    tip.
    """

    name, path = "conic", "closed form in unit numbers of the eccentric parameter"

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.has("focus")

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.can_record = not boundary.shape  # `place` would make constants of the numbers of one shape
        ratio = self.focus(boundary.ops).ratio
        self.refines = bool(boundary.shape) or ratio + 1 / ratio > 2 * ROUND

    def elliptic(self) -> float | None:
        return None

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        """The landing of `Ellipse.fly`, found with twice the digits if the ellipse is so long that this is needed."""
        landing = super().fly(ops, shape, law, position, exit)
        if not self.refines or not ops.doubles:
            return landing
        words, v = Doubles(ops), (exit[0], exit[1])
        letters = [words.of(x) for x in shape]
        u0 = words.unit((position[0], position[1]))
        along = words.of(v[0]), words.of(v[1])
        if law == SLAP:  # along the normal, before that is rounded
            d0 = self.boundary.ir.program("velocity")(words, *u0, *letters)
            along = -d0[1], d0[0]
        M = self.support(words, along[1], -along[0], *letters)
        twice = M[0] * M[0] - M[1] * M[1], words.scaled(ops.number(2.0), M[0] * M[1])
        size = M[0] * M[0] + M[1] * M[1]
        x, y = (twice[0] * u0[0] + twice[1] * u0[1]) / size, (twice[1] * u0[0] - twice[0] * u0[1]) / size
        d = self.boundary.ir.program("velocity")(words, x, y, *letters)
        found = self.landed(ops, shape, law, (x.high, y.high), v, (d[0].high, d[1].high))
        found.numbers["inverse"] = landing.numbers["inverse"]
        return found

    def focus(self, ops: Backend[N, M]) -> Focus[N]:
        """The numbers that describe the conic, at the boundary's shape."""
        x, y, p, size, left = self.boundary.ir.program("focus")(
            ops, *(ops.number(float(a)) for a in self.boundary.shape)
        )
        return Focus((x, y), p, size, left / (p + size), (p + size) / ops.sqrt(left))

    def point(self, ops: Backend[N, M], *values: N) -> list[N]:
        """Boundary point relative to the focus, which keeps its digits at the near tip."""
        c, s, *shape = values
        x, y, p, size, left = self.boundary.ir.program("focus")(ops, *shape)
        one, half = ops.number(1.0), p / left  # the longer half axis
        ahead = one / (p + size) - half * (s * s / (one + modulus(c)))
        along = ops.select(ops.number(0.0) < c, ahead, half * c - size / left)
        return [*plane.times((x, y), (along, s / ops.sqrt(left)))]

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        focus = self.focus(ops)
        n = ops.cos(theta), ops.sin(theta)
        x, y = plane.half(ops, plane.dot(focus.ahead, n), plane.exact_cross(ops, focus.ahead, n))
        return list(plane.unit(ops, plane.squared(plane.normalised(ops, (focus.ratio * x, y)))))

    def unit_of_theta(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        focus = self.focus(ops)
        x, y = plane.half(ops, position[0], position[1])
        return plane.times(focus.ahead, plane.squared(plane.normalised(ops, (x, focus.ratio * y))))

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        n = self.unit_of_theta(ops, position)
        return ops.number(0.0), self.ranged(ops, ops.atan2(n[1], n[0]))

    def _seen(self, theta: Array) -> tuple[Array, Array, Pair[Array]]:
        """The values `1/r` at the polar angles `theta`, and the lengths and the directions of the normals `p*n + Q`.

        The letters are the module's.
        """
        ops, focus = self.boundary.ops, self.focus(self.boundary.ops)
        u = np.cos(theta), np.sin(theta)
        c, s = plane.dot(focus.ahead, u), plane.exact_cross(ops, focus.ahead, u)
        behind = c < 0
        short = s * s / (1 + np.abs(c))  # 1 + c behind the focus
        inverse = np.where(behind, focus.gap + focus.size * short, focus.p + focus.size * c)
        along = np.where(behind, focus.p * short - focus.gap, focus.p * c + focus.size)
        across = focus.p * s
        size = np.hypot(along, across)
        return inverse, size, plane.times(focus.ahead, (along / size, across / size))

    def cartesian(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        return self.frame(component, theta)[:2]

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        inverse, _, (x, y) = self._seen(theta)
        return Frame(np.cos(theta) / inverse, np.sin(theta) / inverse, -y, x)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        inverse, size, _ = self._seen(theta)
        return size / (inverse * inverse)

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        inverse, size, _ = self._seen(theta)
        u = self.enter(self.boundary.ops, component.astype(float), theta)
        rate = np.hypot(*self.velocity(self.boundary.ops, *u, *self.boundary.numbers))
        share = inverse / size
        return rate, -self.focus(self.boundary.ops).p * share * share * share

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        focus = self.focus(ops)  # a law that depends on the place: dtheta/dE = sqrt(1 - e*e)/(1 - e*cos E)
        e = focus.size / focus.p
        one = ops.number(1.0)
        rate: N = (one + e) / (focus.ratio * (one - e * landing.position[0]))
        return drift * below * rate
