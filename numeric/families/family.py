"""What a family of tables is: fields of state, a flight, a reflection, and the tangent map.

Everything here runs on any arithmetic of `numeric.readers`. A *law* is `slap` (lam = 0, the exit
is the normal and is not stored), `elastic` (lam = 1) or `pinball`; a kernel is traced for one law.

Tangent vectors are carried as `(dp, omega)`: a change of boundary parameter, `ds = speed*dp`, and a
change of direction, `omega = K*ds + dphi`. In these the paper's derivative matrix needs one division:

    dp1 = -(N0*dp0 + t*omega0)/N1,    omega1 = (1 + lam)*bend1*dp1 - lam*omega0,

with `N0 = speed*cos(phi0)`, `N1 = speed*cos(eta1)`, `bend = K*speed`; its determinant is `lam*N0/N1`.
"""

from dataclasses import dataclass, field
from typing import Any

from numeric import plane
from numeric.plane import Pair

SLAP, ELASTIC, PINBALL = "slap", "elastic", "pinball"
GRAZE = 2.0**-50  # cos(eta) below this is a tangency
NEAR = 2.0**-50  # a landing closer than this to a join or a cusp is one


def law_of(lam_low: float, lam_high: float) -> str:
    """The law that serves every contraction between the two."""
    if lam_low == lam_high == 0:
        return SLAP
    return ELASTIC if lam_low == lam_high == 1 else PINBALL


@dataclass
class Landing:
    """Where a flight ends. `across` and `along` are `sin` and `cos` of the incidence, up to a common factor.

    `across` is the velocity's tangential part, `-sin(eta)`; `along` is positive. `code` names an
    outcome that stops the ball (0 none, else `Status`), or is None where a family has none.
    """

    position: list[Any]
    across: Any
    along: Any
    code: Any = None
    more: dict[str, Any] = field(default_factory=dict)


class Family:
    """Common ground. A subclass names its fields and defines the methods that raise here."""

    name = ""
    stops = True  # some landings are outcomes that stop the ball
    width = 32  # lanes: four registers of AVX-512 for every value, enough to hide latency and no more
    position: tuple[str, ...] = ()
    exit: tuple[str, ...] = ()

    def fly(self, ops: Any, shape: list[Any], law: str, position: list[Any], exit: list[Any]) -> Landing:
        """The landing of the ball that leaves `position` along `exit`."""
        raise NotImplementedError

    def leave(self, ops: Any, shape: list[Any], law: str, lam: Any, landing: Landing) -> list[Any]:
        """The exit fields after the reflection."""
        raise NotImplementedError

    def slapped(self, ops: Any, shape: list[Any], position: list[Any]) -> list[Any]:
        """The exit fields of a ball that leaves along the normal."""
        raise NotImplementedError

    def departure(self, ops: Any, shape: list[Any], position: list[Any], exit: list[Any]) -> Any:
        """`N0 = speed*cos(phi0)`."""
        raise NotImplementedError

    def point_at(self, ops: Any, shape: list[Any], position: list[Any]) -> Pair:
        """The Cartesian point, up to a shift; only differences are used."""
        raise NotImplementedError

    def length(self, ops: Any, start: Pair, end: Pair, exit: list[Any], landing: Landing) -> Any:
        """The length `t` of a flight."""
        return plane.dot((end[0] - start[0], end[1] - start[1]), landing.more["v"])

    def bend(self, ops: Any, shape: list[Any], landing: Landing) -> tuple[Any, Any]:
        """`K*speed` at the landing as a quotient, negative where the boundary focuses."""
        raise NotImplementedError

    def fields(self, law: str) -> tuple[str, ...]:
        """The names of a ball's state."""
        return self.position if law == SLAP else self.position + self.exit

    def bounce(self, ops: Any, law: str, shape: list[Any], lam: Any, state: list[Any]) -> tuple[list[Any], Any]:
        """One flight and one reflection: the new state, and the code of the outcome or None."""
        position, exit = self._split(ops, shape, law, state)
        landing = self.fly(ops, shape, law, position, exit)
        leaving = [] if law == SLAP else self.leave(ops, shape, law, lam, landing)
        return landing.position + leaving, landing.code

    def carried(self, ops: Any, shape: list[Any], law: str, state: list[Any]) -> list[Any]:
        """What the tangent map needs of a departure, kept from the landing before: `N0` and the point."""
        position, exit = self._split(ops, shape, law, state, whole=True)
        return [self.departure(ops, shape, position, exit), *self.point_at(ops, shape, position)]

    def bounce_with_tangent(
        self, ops: Any, law: str, shape: list[Any], lam: Any, state: list[Any], tangent: list[Any], carried: list[Any]
    ) -> tuple[list[Any], Any, list[Any], Any, list[Any]]:
        """As `bounce`, with the tangent vector and what is carried for it, and `N0/N1`."""
        position, exit = self._split(ops, shape, law, state, whole=True)
        landing = self.fly(ops, shape, law, position, exit)
        leaving = [] if law == SLAP else self.leave(ops, shape, law, lam, landing)
        (dp, omega), (n0, *start) = tangent, carried
        end = self.point_at(ops, shape, landing.position)
        t = self.length(ops, (start[0], start[1]), end, exit, landing)
        above, below = self.bend(ops, shape, landing)
        both = ops.number(1.0) / (landing.along * below)
        inverse = both * below
        moved = -((n0 * dp + t * omega) * inverse)
        turned = (ops.number(1.0) + lam) * (above * both * landing.along) * moved - lam * omega
        n1 = self.leaving_rate(ops, shape, landing, leaving)
        return landing.position + leaving, landing.code, [moved, turned], n0 * inverse, [n1, *end]

    def leaving_rate(self, ops: Any, shape: list[Any], landing: Landing, leaving: list[Any]) -> Any:
        """`departure` at a landing, whose frame is known already."""
        exit = leaving or self.slapped_with_unit(ops, shape, landing.position)
        return self.departure(ops, shape, landing.position, exit)

    def _split(
        self, ops: Any, shape: list[Any], law: str, state: list[Any], whole: bool = False
    ) -> tuple[list[Any], list[Any]]:
        count = len(self.position)
        position = state[:count]
        if law != SLAP:
            return position, state[count:]
        return position, self.slapped_with_unit(ops, shape, position) if whole else self.slapped(ops, shape, position)

    def slapped_with_unit(self, ops: Any, shape: list[Any], position: list[Any]) -> list[Any]:
        """As `slapped`, of length one; a flight alone may get along with any length."""
        return self.slapped(ops, shape, position)


def grazing(ops: Any, across: Any, along: Any) -> Any:
    """The mask of landings that are tangent, or no landings at all."""
    return ops.negated(ops.number(GRAZE) * abs(across) < along)
