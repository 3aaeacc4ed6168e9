"""The unit circle: the state is `(theta, phi)`, and a bounce takes it to `(theta + pi - 2*phi, lam*phi)`."""

import numpy as np

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import SLAP, Boundary, Family, Frame, Landing


class Circle(Family):
    """The flight on the unit circle, in closed form. Paper: section 3.1."""

    name, path = "circle", "closed form in angles"
    stops, can_record, narrow = False, True, 32
    renormalise_every = 128  # a bounce grows no vector more than eightfold
    position = ("theta",)
    direction = ("phi",)

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.same_as == "circle" and boundary.ends[0][0] == -np.pi  # which is where its angles begin

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        return [theta]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        return ops.number(0.0), position[0]

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N]:
        x, y = ops.cos(position[0]), ops.sin(position[0])
        return Frame(x, y, -y, x)

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        return ops.number(1.0), ops.number(-1.0)

    def exit_fields(self, ops: Backend[N, M], frame: Frame[N], phi: N) -> list[N]:
        return [phi]

    def exit(self, ops: Backend[N, M], frame: Frame[N], leaving: Fields[N]) -> N:
        return leaving[0]

    def unit_direction(self, ops: Backend[N, M], frame: Frame[N], phi: N, leaving: Fields[N]) -> Pair[N]:
        return frame.direction(ops, phi)

    def distance(self, ops: Backend[N, M], fields: Fields[N], others: Fields[N]) -> N:
        half = (fields[0] - others[0]) * ops.number(0.5)  # angles are compared modulo a whole turn
        return modulus(ops.number(2.0) * ops.atan2(ops.sin(half), ops.cos(half)))

    def arclength(self, ops: Backend[N, M], component: int, theta: N) -> N:
        return theta

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        return theta

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        (theta,), (phi,) = position, exit
        turned = theta - (phi + phi) if law != SLAP else theta
        half_turn = ops.with_sign(ops.pi, turned)
        low = ops.with_sign(ops.pi_low, turned)
        return Landing([(turned - half_turn) - low], phi, ops.number(1.0))

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return [self.exit_angle(ops, law, lam, landing)]

    def incidence(self, ops: Backend[N, M], landing: Landing[N]) -> N:
        return landing.across

    def drifting_by_length(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        return drift

    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        return [ops.number(0.0)]

    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        return ops.number(1.0)

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return ops.number(2.0)  # times cos(phi), which `exit_normal_speed` and `along` leave out as well

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        return ops.number(-1.0), ops.number(1.0)
