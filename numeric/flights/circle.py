"""The unit circle: angles are the state, and a bounce is `theta + pi - 2*phi`, `lam*phi`."""

from typing import Any

from numeric.flights.family import SLAP, Boundary, Family, Frame, Landing


class Circle(Family):
    """Paper: section 3.1."""

    name, path = "circle", "closed form in angles"
    stops = False
    renormalise_every = 128  # a bounce grows no vector more than eightfold
    position = ("theta",)
    direction = ("phi",)

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.same_as == "circle"

    def enter(self, ops: Any, component: Any, theta: Any) -> list[Any]:
        return [theta]

    def place(self, ops: Any, position: list[Any]) -> tuple[Any, Any]:
        return ops.number(0.0), position[0]

    def aim(self, ops: Any, frame: Frame, phi: Any) -> list[Any]:
        return [phi]

    def exit(self, ops: Any, frame: Frame, leaving: list[Any]) -> Any:
        return leaving[0]

    def heading(self, ops: Any, frame: Frame, phi: Any, leaving: list[Any]) -> tuple[Any, Any]:
        return frame.direction(ops, phi)

    def distance(self, ops: Any, fields: list[Any], others: list[Any]) -> Any:
        half = (fields[0] - others[0]) * ops.number(0.5)  # angles are compared modulo a whole turn
        return abs(ops.number(2.0) * ops.atan2(ops.sin(half), ops.cos(half)))

    def arclength(self, ops: Any, component: int, theta: Any) -> Any:
        return theta

    def fly(self, ops: Any, shape: list[Any], law: str, position: list[Any], exit: list[Any]) -> Landing:
        (theta,), (phi,) = position, exit
        turned = theta - (phi + phi) if law != SLAP else theta
        half_turn = ops.with_sign(ops.pi(), turned)
        low = ops.with_sign(ops.pi_low(), turned)
        return Landing([(turned - half_turn) - low], phi, ops.number(1.0))

    def leave(self, ops: Any, shape: list[Any], law: str, lam: Any, landing: Landing) -> list[Any]:
        return [lam * landing.across]

    def slapped(self, ops: Any, shape: list[Any], position: list[Any]) -> list[Any]:
        return [ops.number(0.0)]

    def departure(self, ops: Any, shape: list[Any], position: list[Any], exit: list[Any]) -> Any:
        return ops.number(1.0)

    def length(self, ops: Any, shape: list[Any], n0: Any, start: list[Any], end: list[Any], landing: Landing) -> Any:
        return ops.number(2.0)  # times cos(phi), which `departure` and `along` leave out as well

    def bend(self, ops: Any, shape: list[Any], landing: Landing) -> tuple[Any, Any]:
        return ops.number(-1.0), ops.number(1.0)
