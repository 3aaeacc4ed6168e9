"""The cardioid: the far end of a flight is a zero of a cubic, in an interval that one sign determines.

The state is `sigma = exp(i*theta/2)` and `exp(i*phi)`. The tangent is `i*sigma**3`, so no frame needs a root. With
`k = sin(theta0/2 - phi)` the particle passes the cusp at the distance `2*cos(theta0/2)**2*|k|`. Seen from the cusp, its
polar angle falls (`k > 0`) or grows towards the direction `psi` of the velocity `v`, and the particle stays inside the
table until it lands. The line behind the particle has the angles beyond `psi - pi`. So exactly one of the zeros of the
cubic in `S = cos(theta0/2)*tan(theta1/2)` lies between `theta0` and `psi`: with two more zeros there, the boundary
would have to bulge inwards. Paper: section 4; [BackerDullin1997].
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import ELASTIC, NEAR, SLAP, Array, Boundary, Family, Frame, Landing, Status, grazing


class Cardioid(Family):
    """The flight on the cardioid. Paper: section 4."""

    name = "cardioid"
    path = "cubic for the far end, its interval known from one sign"
    cusped = True
    pairs = 0, 2
    can_record = True
    position: tuple[str, ...] = ("p", "q")  # cos and sin of theta/2
    direction = ("cos_phi", "sin_phi")
    steps = 4, 1

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.same_as == "cardioid"

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        return Frame(*self.cartesian(component, theta), -np.sin(1.5 * theta), np.cos(1.5 * theta))

    def cartesian(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        radius = 2 * np.cos(theta / 2) ** 2  # relative accuracy near the cusp
        return radius * np.cos(theta), radius * np.sin(theta)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        return np.asarray(2 * np.cos(theta / 2))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        return np.ones(np.shape(theta)), np.asarray(-0.75 / np.cos(theta / 2))

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        half = theta * ops.number(0.5)
        return [ops.cos(half), ops.sin(half)]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        return ops.number(0.0), ops.number(2.0) * ops.atan2(position[1], position[0])

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N]:
        sigma = position[0], position[1]
        tx, ty = plane.times(sigma, plane.squared(sigma))
        return Frame(*self.point(ops, position), -ty, tx)

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        return ops.number(1.0), ops.number(-0.75) / position[0]

    def exit_fields(self, ops: Backend[N, M], frame: Frame[N], phi: N) -> list[N]:
        return [ops.cos(phi), ops.sin(phi)]

    def exit(self, ops: Backend[N, M], frame: Frame[N], leaving: Fields[N]) -> N:
        return ops.atan2(leaving[1], leaving[0])

    def unit_direction(self, ops: Backend[N, M], frame: Frame[N], phi: N, leaving: Fields[N]) -> Pair[N]:
        return frame.direction(ops, phi)

    def arclength(self, ops: Backend[N, M], component: int, theta: N) -> N:
        return ops.q(4, 1) * ops.sin(theta * ops.q(1, 2))

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        return ops.number(4.0) * position[1]

    def parameter(self, component: int, s: Array) -> Array | None:
        return np.asarray(2 * elementary.arcsin(np.clip(s / 4, -1, 1)))

    def cubic(self, ops: Backend[N, M], sigma: Pair[N], exit: Pair[N]) -> tuple[list[N], N, N, Pair[N]]:
        """The cubic in `S` whose zero is the landing, constant first, mirrored if `k < 0`; then `sin(theta0/2)`, `k`
        and `-v`.

        `S`, `k` and `v` are those of the module. The value `sin(theta0/2)` is mirrored too if `k < 0`.
        """
        p, q = sigma
        k = plane.exact_cross(ops, (q, p), (exit[1], exit[0]))
        back = plane.times(plane.squared(sigma), (plane.dot(sigma, exit), k))
        one, two = ops.number(1.0), ops.number(2.0)
        p2 = p * p
        twice = two * p2 + one
        first = back[1] * p * twice - two * q * back[0] * (p2 + one)
        last = back[1] * q * twice + two * back[0] * p * p2
        size, Q = modulus(k), ops.times_sign(q, k)
        return [p2 * last, ops.times_sign(p * first, k), size * Q, size], Q, k, back

    def interval(
        self, ops: Backend[N, M], cubic: Fields[N], Q: N, c: N, ahead: Pair[N]
    ) -> tuple[N, Callable[[], N], Callable[[N], M]]:
        """A first guess of the zero below `Q`, a lower bound of this zero, and a test that a number is above the bound.

        `Q` is `sin(theta0/2)`, mirrored as in `cubic`. The bound is `ahead[1]/ahead[0]`, the direction `psi`, unless
        the particle would have to cross the negative axis to get there. In `z = Q - S > 0` the cubic is
        `2*c - D*z + 4*k*Q*z**2 - k*z**3`, `D` its slope at `Q` and `c = cos(phi)`: where `D > 0` the zero lies near
        `z = c`, as for a circle, otherwise `z**2` is about `-D/k`, and for `z >= 8` with `z**2 >= 4*(c + |D|)/k` the
        cubic is negative.
        """
        D = ops.number(5.0) * cubic[2] * Q + cubic[1]
        far = ops.sqrt(ops.maximum((c - D) / cubic[3], ops.number(0.0)))
        free = Q * ahead[0] <= ahead[1]

        def low() -> N:
            bound = Q - ops.number(8.0) - ops.number(2.0) * ops.sqrt((c + modulus(D)) / cubic[3])
            return ops.select(free, bound, ahead[1] / ahead[0])

        return Q - ops.maximum(far, c), low, lambda S: free | (ahead[1] <= S * ahead[0])

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        sigma, leaving = (position[0], position[1]), (exit[0], exit[1])
        coefficients, Q, k, back = self.cubic(ops, sigma, leaving)
        ahead = ops.number(1.0) - back[0], -sigma[0] * ops.times_sign(back[1], k)
        start, low, accepts = self.interval(ops, coefficients, Q, leaving[0], ahead)
        S = ops.polynomial_zero(coefficients, start, low, Q, sigma[0], self.steps, None, accepts)
        landing = plane.normalised(ops, (sigma[0], ops.times_sign(S, k)))
        w = plane.times(plane.times(landing, plane.squared(landing)), plane.conjugate(back))
        code = ops.number(0.0)
        if law != SLAP:
            code = ops.select(grazing(ops, w[1], -w[0]), ops.number(float(Status.GRAZING.code)), code)
        aside = ops.number(0.0) < coefficients[3]  # else the flight meets the cusp itself, and there the map jumps
        code = ops.select(aside & (ops.number(NEAR) < landing[0]), code, ops.number(float(Status.CUSP.code)))
        return Landing(list(landing), w[1], -w[0], code, {"back": back})

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        if law == ELASTIC:
            return list(plane.unit(ops, (landing.along, landing.across)))
        return list(ops.turn(self.exit_angle(ops, law, lam, landing), 1))

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        return drift * ops.number(0.5)  # dtheta/ds = 1/(2*cos(theta/2)), and below = cos(theta/2)

    def drifting_by_length(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        return drift * below  # arc length is the parameter of tangent vectors

    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        return [ops.number(1.0), ops.number(0.0)]

    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        return exit[0]

    def kept(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        return list(self.point(ops, position))

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return plane.dot((start[0] - end[0], start[1] - end[1]), landing.vectors["back"])

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        return ops.number(-0.75), landing.position[0]

    def point(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        """The boundary point `2*cos(theta/2)**2*exp(i*theta)`."""
        radius = ops.number(2.0) * position[0] * position[0]
        x, y = plane.squared((position[0], position[1]))
        return radius * x, radius * y
