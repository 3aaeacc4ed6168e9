"""What a family of tables is: which tables it serves, fields of state, a flight, a reflection, and the tangent map.

A new family is a module with a subclass of `Family` and a line in `numeric.flights.registry`. What it must define is
abstract there; the others have a general answer, from the table's `Boundary`.

Everything here runs on any arithmetic of `numeric.backends`. A *law* is `slap` (lam = 0, the exit
is the normal and is not stored), `elastic` (lam = 1) or `pinball`; a kernel is traced for one law.

Tangent vectors are carried as `(q, omega)`: a shift across the flight, `q = N0*ds/speed` with
`N0 = speed*cos(phi0)`, and a change of direction, `omega = K*ds + dphi`. A flight of length `t` turns `q`
into `q + t*omega`. With `K*speed = above/below` at the landing, `N1 = speed*cos(eta1)` and `N0` the next
departure's, the paper's derivative matrix then needs no division when the vector may grow by `below*N1` a bounce:

    below*N1*q1 = -(q + t*omega)*N0*below,    below*N1*omega1 = -(1 + lam)*above*(q + t*omega) - lam*below*N1*omega.

The determinant is `lam*N0/N1` of the next departure and this landing.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import ClassVar, Generic

import numpy as np
from numpy.typing import NDArray

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.backends.protocol import Frame as Frame
from numeric.backends.scalars import ArrayBackend
from numeric.lowering.program import LawIR, TableIR


class Status(Enum):
    """The outcome of a trajectory. All but `REGULAR` stop the particle, which keeps its last good state.

    `code` is the number that kernels use.

    >>> Status.CUSP.code, Status.CUSP.value
    (2, 'lands within rounding of a cusp, where the map is undefined')
    """

    code: int

    def __new__(cls, code: int, meaning: str) -> "Status":
        member = object.__new__(cls)
        member._value_, member.code = meaning, code
        return member

    REGULAR = 0, "every bounce is defined"
    JOIN = 1, "lands within rounding of a point where two components meet"
    CUSP = 2, "lands within rounding of a cusp, where the map is undefined"
    GRAZING = 3, "tangent to the boundary: there is no next bounce"
    LOST = 4, "no landing point was found; the table is not closed"


Array = NDArray[np.float64]
FINE = 4096  # points on which a boundary is examined


class Boundary:
    """The components of a table at one shape. What a flight is chosen by, and what every flight may fall back on."""

    def __init__(self, ir: TableIR, shape: list[float]) -> None:
        self.ir, self.shape, self.ops = ir, shape, ArrayBackend()
        self.numbers = [self.ops.number(x) for x in shape]
        self.ends = [(float(x), float(y)) for x, y in (part.ends(self.ops, *self.numbers) for part in ir.parts)]

    @property
    def closed(self) -> bool:
        """One component that runs round the table by a whole turn of its parameter."""
        return len(self.ends) == 1 and abs(self.ends[0][1] - self.ends[0][0] - 2 * np.pi) < 1e-12

    @cached_property
    def convex(self) -> bool:
        """No curvature of the wrong sign on a fine grid of a closed curve, up to rounding."""
        curvature = self.bending(np.zeros(FINE, dtype=np.int64), np.linspace(-np.pi, np.pi, FINE))[1]
        return bool(np.max(curvature) <= 1e-12 * np.max(np.abs(curvature)))

    def curve(self, component: NDArray[np.int64], theta: Array, count: int = 6) -> Array:
        """Rows `x, y`, first and second derivatives with respect to `theta`, so many of them."""
        rows = np.empty((count, *theta.shape))
        for index, part in enumerate(self.ir.parts):
            if not np.any(here := component == index):
                continue
            place = ... if np.all(here) else here  # a view in place of copies
            for i, values in enumerate(part.first(count)(self.ops, theta[place], *self.numbers)):
                rows[i, place] = values
        return rows

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        """Point and unit tangent."""
        x, y, dx, dy = self.curve(component, theta, 4)
        speed = np.hypot(dx, dy)
        return Frame(x, y, dx / speed, dy / speed)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        return np.asarray(np.hypot(*self.curve(component, theta, 4)[2:]))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dtheta`, and the paper's signed curvature, negative where the boundary focuses."""
        _, _, dx, dy, ax, ay = self.curve(component, theta)
        speed = np.hypot(dx, dy)
        return speed, -(dx * ay - dy * ax) / (speed * speed * speed)


SLAP, ELASTIC, PINBALL, FORMULA = "slap", "elastic", "pinball", "formula"  # lam = 0, 1, between; any other law
GRAZE = 2.0**-50  # cos(eta) below this is a tangency
NEAR = 2.0**-50  # on the paper's tables a landing closer than this to a join or a cusp is one


def law_of(lam_low: float, lam_high: float) -> str:
    """The law that serves every contraction between the two."""
    return SLAP if lam_low == lam_high == 0 else ELASTIC if lam_low == lam_high == 1 else PINBALL


@dataclass
class Landing(Generic[N]):
    """Where a flight ends. `across` and `along` are `sin` and `cos` of the incidence, up to a common factor.

    `across` is the velocity's tangential part, `-sin(eta)`; `along` is positive. `code` names an outcome that stops the
    particle (0 none, else `Status`), or is None. `vectors` and `numbers` are what the family's own methods need again.
    """

    position: list[N]
    across: N
    along: N
    code: N | None = None
    vectors: dict[str, Pair[N]] = field(default_factory=dict)
    numbers: dict[str, N] = field(default_factory=dict)


class Family(ABC):
    """A subclass names its fields and defines the abstract methods; the others have an answer here."""

    name = ""  # a label for files and tables; nobody decides by it
    path = ""  # how flights are computed, in words
    cusped: ClassVar[bool] = False  # a boundary point without a normal, at cos(theta/2) = 0
    pairs: ClassVar[tuple[int, ...]] = ()  # where the pairs of fields begin that have length one
    stops = True  # some landings are outcomes that stop the particle
    tells = False  # kernels tell orbits in people's coordinates, by `framed` and `curving`
    renormalise_every = 8  # bounces between looks at the size of a tangent vector: none grows it by more than 2**100
    width = 32  # lanes: four registers of AVX-512 for every value, enough to hide latency and no more
    narrow = 16  # where there are half as many registers, half as long: more would be kept in memory all the time
    order = ""  # of instructions there: for this kind of processor, where that proved faster than for the one at hand
    position: tuple[str, ...] = ()
    direction: tuple[str, ...] = ()
    boundary: Boundary
    formula: LawIR | None = None  # of the law that is called FORMULA

    def __init__(self, boundary: Boundary | None = None) -> None:
        if boundary is not None:  # a flight alone gets along without
            self.boundary = boundary

    @classmethod
    @abstractmethod
    def matches(cls, boundary: Boundary) -> bool:
        """Does this family serve the table?"""

    @property
    def identity(self) -> str:
        """What kernels depend on besides the table's programs and this package's text."""
        return ""

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        """Points and unit tangents; a closed form without cancellation where there is one."""
        return self.boundary.frame(component, theta)

    def cartesian(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The points of `frame`."""
        x, y = self.boundary.curve(component, theta, 2)
        return x, y

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """`ds/dtheta`."""
        return self.boundary.speed(component, theta)

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dp` for the parameter `p` of this family's tangent vectors, `theta` or arc length; and the curvature."""
        return self.boundary.bending(component, theta)

    @abstractmethod
    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        """The position fields of a boundary point."""

    @abstractmethod
    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        """Component, as a number, and parameter of position fields."""

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N] | None:
        """The frame at position fields, on any number system; for a family whose kernels tell orbits."""
        return None

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        """As `bending`, at position fields; beside `framed`."""
        raise NotImplementedError(self.name)

    def aim(self, ops: Backend[N, M], frame: Frame[N], phi: N) -> list[N]:
        """The exit fields of the exit angle `phi`."""
        return [*frame.direction(ops, phi)]

    def exit(self, ops: Backend[N, M], frame: Frame[N], leaving: Fields[N]) -> N:
        """The exit angle of exit fields, in radians."""
        return frame.angle(ops, *leaving)

    def heading(self, ops: Backend[N, M], frame: Frame[N], phi: N, leaving: Fields[N]) -> Pair[N]:
        """The unit direction of the flight that begins: the one that is kept as a field, if one is."""
        return leaving[0], leaving[1]

    def distance(self, ops: Backend[N, M], fields: Fields[N], others: Fields[N]) -> N:
        """How far two states of the same component are apart, in the numbers that are kept as fields."""
        total = sum(((x - y) * (x - y) for x, y in zip(fields[1:], others[1:], strict=True)), start=ops.number(0.0))
        return ops.sqrt(total + (fields[0] - others[0]) * (fields[0] - others[0]))

    def arclength(self, ops: Backend[N, M], component: int, theta: N) -> N | None:
        """Arc length from `theta = 0` in elementary functions, or None where there is no such form."""
        return None

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        """As `arclength`, with its offset, at position fields; beside `framed`."""
        raise NotImplementedError(self.name)

    def elliptic(self) -> float | None:
        """The parameter `m` for which arc length from `theta = 0` is the elliptic integral `E(theta | m)`, if any."""
        return None

    def parameter(self, component: int, s: Array) -> Array | None:
        """The inverse of `arclength` in closed form, or None."""
        return None

    # ---- a bounce

    @abstractmethod
    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        """The landing of the particle that leaves `position` along `exit`."""

    @abstractmethod
    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        """The exit fields after the reflection."""

    def incidence(self, ops: Backend[N, M], landing: Landing[N]) -> N:
        """Minus the incidence angle, in radians."""
        return ops.angle(landing.across, landing.along)

    def exit_angle(self, ops: Backend[N, M], law: str, lam: N, landing: Landing[N]) -> N:
        """The exit angle after the reflection."""
        incidence = self.incidence(ops, landing)
        if law != FORMULA:
            return lam * incidence
        return self._known(law).exit(ops, -incidence, lam, *self._landing_place(ops, landing))[0]

    def slopes(self, ops: Backend[N, M], law: str, lam: N, landing: Landing[N]) -> tuple[N, list[N]]:
        """Minus the derivative of the exit angle by the incidence angle; then those by `theta` and `s`, if any."""
        if law != FORMULA:
            return lam, []
        formula, place = self._known(law), self._landing_place(ops, landing)
        slope, *drift = formula.slopes(ops, -self.incidence(ops, landing), lam, *place)
        return slope, drift if formula.placed else []

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        """`drift` for a tangent vector's own parameter in the place of `theta`, times `below` of `bend`."""
        return drift * below

    def drifting_by_length(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        """The same in the place of arc length."""
        d = landing.vectors["d"]
        return drift * below * ops.sqrt(plane.dot(d, d))

    def arc(self, ops: Backend[N, M], position: Fields[N], component: N, theta: N, law: LawIR) -> N:
        """Arc length from the table's origin, for a law that speaks of it."""
        if law.lengths:  # a circle that its formula does not show, as that of any radius
            return law.length(ops, 0, theta)
        how, numbers = law.series or (plane.CLOSED, ())
        return self.along(ops, position, theta, how, [ops.number(x) for x in numbers])

    def _known(self, law: str) -> LawIR:
        assert self.formula is not None, law
        return self.formula

    def _landing_place(self, ops: Backend[N, M], landing: Landing[N]) -> list[N]:
        law = self._known(FORMULA)
        if not law.placed:
            return [ops.number(0.0)]
        component, theta = self.place(ops, landing.position)
        return [theta, self.arc(ops, landing.position, component, theta, law)] if law.measured else [theta]

    @abstractmethod
    def slapped(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """The exit fields of a particle that leaves along the normal."""

    @abstractmethod
    def departure(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        """`N0 = speed*cos(phi0)`."""

    def kept(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """What `length` needs of either end of a flight, kept from one bounce to the next: often nothing."""
        return []

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        """The length `t` of a flight, from `N0` and what was `kept` at its ends."""
        return plane.dot((end[0] - start[0], end[1] - start[1]), landing.vectors["v"])

    @abstractmethod
    def bend(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        """`K*speed` at the landing as a quotient, negative where the boundary focuses; `below` is positive."""

    def fields(self, law: str) -> tuple[str, ...]:
        """The names of a particle's state."""
        return self.position if law == SLAP else self.position + self.direction

    def bounce(
        self, ops: Backend[N, M], law: str, shape: Fields[N], lam: N, state: Fields[N]
    ) -> tuple[list[N], N | None]:
        """One flight and one reflection: the new state, and the code of the outcome or None."""
        landing, leaving = self.flown(ops, law, shape, lam, state)
        return landing.position + leaving, landing.code

    def flown(
        self, ops: Backend[N, M], law: str, shape: Fields[N], lam: N, state: Fields[N]
    ) -> tuple[Landing[N], list[N]]:
        """As `bounce`: the landing, and the exit fields after it."""
        landing = self.fly(ops, shape, law, *self._split(ops, shape, law, state))
        return landing, [] if law == SLAP else self.leave(ops, shape, law, lam, landing)

    def rate(self, ops: Backend[N, M], shape: Fields[N], law: str, state: Fields[N]) -> N:
        """`N0` of a particle that is about to leave."""
        return self.departure(ops, shape, *self._split(ops, shape, law, state, whole=True))

    def bounce_with_tangent(
        self,
        ops: Backend[N, M],
        law: str,
        shape: Fields[N],
        lam: N,
        state: Fields[N],
        tangent: Fields[N],
        kept: Fields[N],
    ) -> tuple[list[N], N | None, list[N], list[N]]:
        """As `bounce`, with the rows `numeric.kernels.machine.TANGENT`, and what is kept for the next flight.

        The vector is turned round, and grows by `below*N1` too much: `down` counts that, and `up` counts `below*N0`,
        with the slope of a law that is no uniform contraction.
        """
        position, exit = self._split(ops, shape, law, state, whole=True)
        landing = self.fly(ops, shape, law, position, exit)
        q, omega, growth, up, down, volume, n0 = tangent
        end = self.kept(ops, shape, landing.position)
        moved = self.length(ops, shape, n0, kept, end, landing) * omega + q
        above, below = self.bend(ops, shape, landing)
        fall = landing.along * below
        slope, drift = self.slopes(ops, law, lam, landing)
        turned = (ops.number(1.0) + slope) * above * moved + slope * omega * fall
        for taken, change in zip((self.drifting, self.drifting_by_length), drift, strict=False):
            turned = turned + taken(ops, landing, below, change) * moved
        down = down * fall
        ops.settle(moved, turned, down, below)
        leaving = [] if law == SLAP else self.leave(ops, shape, law, lam, landing)
        n0 = self.leaving_rate(ops, shape, landing, leaving)
        rise = n0 * below
        counted = up * rise if law != FORMULA else up * rise * modulus(slope)
        return landing.position + leaving, landing.code, [moved * rise, turned, growth, counted, down, volume, n0], end

    def leaving_rate(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N], leaving: Fields[N]) -> N:
        """`departure` at a landing, whose frame is known already."""
        exit = leaving or self.slapped_with_unit(ops, shape, landing.position)
        return self.departure(ops, shape, landing.position, exit)

    def _split(
        self, ops: Backend[N, M], shape: Fields[N], law: str, state: Fields[N], whole: bool = False
    ) -> tuple[list[N], list[N]]:
        count = len(self.position)
        position = list(state[:count])
        if law != SLAP:
            return position, list(state[count:])
        return position, self.slapped_with_unit(ops, shape, position) if whole else self.slapped(ops, shape, position)

    def slapped_with_unit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """As `slapped`, of length one; a flight alone may get along with any length."""
        return self.slapped(ops, shape, position)


def grazing(ops: Backend[N, M], across: N, along: N) -> M:
    """The mask of landings that are tangent, or no landings at all."""
    return ops.negated(ops.number(GRAZE) * modulus(across) < along)


def reflected(family: Family, ops: Backend[N, M], law: str, lam: N, landing: Landing[N]) -> list[N]:
    """The unit direction after a reflection, from the flight's direction `v` and the boundary's velocity `d`."""
    v, d = landing.vectors["v"], landing.vectors["d"]
    if law == ELASTIC:
        inverse = ops.number(1.0) / plane.dot(d, d)
        x, y = plane.times(plane.squared(d), plane.conjugate(v))
        return list(plane.unit(ops, (x * inverse, y * inverse)))
    c, s = ops.turn(family.exit_angle(ops, law, lam, landing) + family.incidence(ops, landing))
    return list(plane.unit(ops, plane.times((-v[0], -v[1]), (c, -s))))
