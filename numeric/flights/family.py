"""Families of tables: each has its own state of a particle (the *fields*), flight, reflection and tangent map.

A new family is a module with a subclass of `Family` and a line in `numeric.flights.registry`. The methods that it must
define are abstract there; the others have general ones, from the table's `Boundary`.

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
from collections.abc import Sequence
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
STOPS = "CORNER", "CUSP"  # contacts of two components at which there is no next bounce
FAR = 2.0**100  # farther than anything on a table


class Boundary:
    """The components of a table at one shape: they decide its flight method, and general methods compute on them."""

    def __init__(self, ir: TableIR, shape: list[float]) -> None:
        self.ir, self.shape, self.ops = ir, shape, ArrayBackend()
        self.numbers = [self.ops.number(x) for x in shape]
        self.ends = [(float(x), float(y)) for x, y in (part.ends(self.ops, *self.numbers) for part in ir.parts)]

    @property
    def following(self) -> list[int]:
        """For each component, the index of the component that begins where it ends."""
        return [after for after, *_ in self.ir.joins]

    @property
    def corners(self) -> list[tuple[bool, bool]]:
        """Is the start of each component a corner or a cusp, and is its end?"""
        ends = [contact in STOPS for _, contact, _ in self.ir.joins]
        starts = dict(zip(self.following, ends, strict=True))
        return [(starts[j], end) for j, end in enumerate(ends)]

    @property
    def corner_parameters(self) -> list[tuple[float, float]]:
        """The ends of each component's parameter; a smooth end is replaced by a parameter far away."""
        known = zip(self.ends, self.corners, strict=True)
        return [(low if first else -FAR, high if last else FAR) for (low, high), (first, last) in known]

    @property
    def closed(self) -> bool:
        """Is there one component only, which runs round the table by a whole turn of its parameter?"""
        return len(self.ends) == 1 and abs(self.ends[0][1] - self.ends[0][0] - 2 * np.pi) < 1e-12

    @property
    def runs_on(self) -> bool:
        """Is there one component only, whose formula runs on along the boundary beyond its ends? Not over a corner."""
        return len(self.ends) == 1 and self.ir.joins[0][1] != "CORNER"

    @cached_property
    def convex(self) -> bool:
        """Is the curvature of a closed curve nowhere of the dispersing sign on a fine grid, up to rounding?"""
        curvature = self.bending(np.zeros(FINE, dtype=np.int64), np.linspace(-np.pi, np.pi, FINE))[1]
        return bool(np.max(curvature) <= 1e-12 * np.max(np.abs(curvature)))

    def curve_on(self, index: int, theta: Array, count: int = 6) -> Array:
        """Rows with the values of `curve` at the parameters `theta` of the component `index`."""
        values = self.ir.parts[index].first(count)(self.ops, theta, *self.numbers)
        return np.array(np.broadcast_arrays(theta, *values)[1:], dtype=float)

    def curve(self, component: NDArray[np.int64], theta: Array, count: int = 6) -> Array:
        """Rows with the first `count` of these six: `x`, `y`, and their first and second derivatives by `theta`."""
        rows = np.empty((count, *theta.shape))
        for index in np.unique(component):  # of hundreds of parts most calls ask for one
            here, part = component == index, self.ir.parts[index]
            place = ... if np.all(here) else here  # a view in place of copies
            for i, values in enumerate(part.first(count)(self.ops, theta[place], *self.numbers)):
                rows[i, place] = values
        return rows

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        """Points and unit tangents."""
        x, y, dx, dy = self.curve(component, theta, 4)
        speed = np.hypot(dx, dy)
        return Frame(x, y, dx / speed, dy / speed)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The speed of the boundary point, `ds/dtheta`."""
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
    """The word for the law that serves all contractions between `lam_low` and `lam_high`: slap, elastic or pinball."""
    return SLAP if lam_low == lam_high == 0 else ELASTIC if lam_low == lam_high == 1 else PINBALL


@dataclass
class Landing(Generic[N]):
    """Where a flight ends. `across` and `along` are `sin` and `cos` of the incidence angle, up to a common factor.

    `across` is the velocity's tangential part, `-sin(eta)`; `along` is positive. `code` is 0, or the code of the
    `Status` that stops the particle; it is None for families without outcomes. `vectors` and `numbers` hold values that
    the family's other methods use.
    """

    position: list[N]
    across: N
    along: N
    code: N | None = None
    vectors: dict[str, Pair[N]] = field(default_factory=dict)
    numbers: dict[str, N] = field(default_factory=dict)


class Family(ABC):
    """A method for finding the next bounce; a subclass names its fields and defines the abstract methods."""

    name = ""  # a label for files and tables; no code depends on it
    path = ""  # how flights are computed, in words
    slow: ClassVar[bool] = False  # takes a bounce ten times as long as on other tables
    cusped: ClassVar[bool] = False  # a boundary point without a normal, at cos(theta/2) = 0
    pairs: ClassVar[tuple[int, ...]] = ()  # where the pairs of fields begin that have length one
    stops = True  # some landings are outcomes that stop the particle
    can_record = False  # kernels record orbits in users' coordinates, by `framed` and `curving`
    renormalise_every = 8  # bounces between looks at the size of a tangent vector: none grows it by more than 2**100
    width = 32  # lanes: four registers of AVX-512 for every value, enough to hide latency and no more
    narrow = 16  # for processors with half as many registers, which would keep more in memory
    order = ""  # for those: the processor for which LLVM orders instructions, where that proved faster
    standing: Sequence[tuple[int, float, float]] = ()  # stretches of a component's parameter on which the point stays
    unit = 1.0  # a law's unit of length, in that of this table
    position: tuple[str, ...] = ()
    direction: tuple[str, ...] = ()
    boundary: Boundary
    formula: LawIR | None = None  # of the law that is called FORMULA

    def __init__(self, boundary: Boundary | None = None) -> None:
        if boundary is not None:  # a flight alone needs none
            self.boundary = boundary

    @classmethod
    @abstractmethod
    def matches(cls, boundary: Boundary) -> bool:
        """Does this family serve the table?"""

    @property
    def identity(self) -> str:
        """A text that determines the kernels, together with the table's programs and this package's sources."""
        return ""

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        """Points and unit tangents; a closed form without cancellation where there is one."""
        return self.boundary.frame(component, theta)

    def cartesian(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """The Cartesian coordinates of boundary points, the same as in `frame`."""
        x, y = self.boundary.curve(component, theta, 2)
        return x, y

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        """The speed of the boundary point, `ds/dtheta`."""
        return self.boundary.speed(component, theta)

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        """`ds/dp` for the parameter `p` of this family's tangent vectors, `theta` or arc length; and the curvature."""
        return self.boundary.bending(component, theta)

    @abstractmethod
    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        """The position of a boundary point, as the numbers (fields) that the family's flights use."""

    @abstractmethod
    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        """The component, as a number, and the parameter `theta` of a position in the family's fields."""

    def ranged(self, ops: Backend[N, M], theta: N) -> N:
        """The parameter, given as an angle from `-pi` to `pi`, moved by whole turns into its range on the boundary."""
        low = self.boundary.ends[0][0]
        if low == -np.pi:
            return theta
        theta = theta + ops.number(2 * np.pi * np.floor((low + np.pi) / (2 * np.pi)))
        return ops.select(theta < ops.number(low), theta + ops.number(2 * np.pi), theta)

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N] | None:
        """The frame at a position in the family's fields, in any number system; for kernels that record orbits."""
        return None

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        """`ds/dp` and curvature (as `bending`) at a position in the family's fields; defined together with `framed`."""
        raise NotImplementedError(self.name)

    def exit_fields(self, ops: Backend[N, M], frame: Frame[N], phi: N) -> list[N]:
        """The direction of a particle that leaves at the exit angle `phi`, in the family's fields."""
        return [*frame.direction(ops, phi)]

    def exit(self, ops: Backend[N, M], frame: Frame[N], leaving: Fields[N]) -> N:
        """The exit angle, in radians, of a direction in the family's fields."""
        return frame.angle(ops, *leaving)

    def unit_direction(self, ops: Backend[N, M], frame: Frame[N], phi: N, leaving: Fields[N]) -> Pair[N]:
        """The unit direction of a departing flight, taken from the exit fields where these contain it."""
        return leaving[0], leaving[1]

    def distance(self, ops: Backend[N, M], fields: Fields[N], others: Fields[N]) -> N:
        """The distance between two states on the same component, in the family's fields."""
        total = sum(((x - y) * (x - y) for x, y in zip(fields[1:], others[1:], strict=True)), start=ops.number(0.0))
        return ops.sqrt(total + (fields[0] - others[0]) * (fields[0] - others[0]))

    def arclength(self, ops: Backend[N, M], component: int, theta: N) -> N | None:
        """Arc length from `theta = 0` in elementary functions, or None where there is no such form."""
        return None

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        """Arc length, with its offset, at a position in the family's fields; defined together with `framed`."""
        raise NotImplementedError(self.name)

    def elliptic(self) -> float | None:
        """The parameter `m` if arc length from `theta = 0` is the elliptic integral `E(theta | m)`, else None."""
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
        """The direction after the reflection, in the family's fields."""

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
        """Minus the derivative of the exit angle with respect to the incidence angle, and a list for other dependences.

        The list has minus the derivatives with respect to `theta` and `s` of the landing, as far as the law depends on
        them.
        """
        if law != FORMULA:
            return lam, []
        formula, place = self._known(law), self._landing_place(ops, landing)
        slope, *drift = formula.slopes(ops, -self.incidence(ops, landing), lam, *place)
        return slope, drift if formula.placed else []

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        """`below` times the derivative of the law by `theta`, converted to the parameter of the tangent vector."""
        return drift * below

    def drifting_by_length(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        """`below` times the derivative of the law by arc length, converted to the parameter of the tangent vector."""
        d = landing.vectors["d"]
        return drift * below * ops.sqrt(plane.dot(d, d))

    def arc(self, ops: Backend[N, M], position: Fields[N], component: N, theta: N, law: LawIR) -> N:
        """Arc length from the table's origin, for a law that depends on it."""
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
    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """The direction, in the family's fields, of a particle that leaves along the normal."""

    @abstractmethod
    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        """`N0 = speed*cos(phi0)` of a particle that leaves; `speed` is the length of the boundary's derivative."""

    def kept(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """Values at one end of a flight that `length` uses, and which are kept for the next bounce; often none."""
        return []

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        """The length of a flight, from its `exit_normal_speed` `n0` and the values of `kept` at `start` and `end`."""
        return plane.dot((end[0] - start[0], end[1] - start[1]), landing.vectors["v"])

    @abstractmethod
    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        """Two numbers: `above/below` is curvature times speed at a landing, negative if focusing, and `below > 0`."""

    def fields(self, law: str) -> tuple[str, ...]:
        """The names of the numbers (fields) that make up a particle's state under this law."""
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
        """The landing of one flight, and the direction after its reflection in the family's fields."""
        landing = self.fly(ops, shape, law, *self._split(ops, shape, law, state))
        return landing, [] if law == SLAP else self.leave(ops, shape, law, lam, landing)

    def rate(self, ops: Backend[N, M], shape: Fields[N], law: str, state: Fields[N]) -> N:
        """`N0 = speed*cos(phi0)` (`exit_normal_speed`) of a particle that leaves in this state."""
        return self.exit_normal_speed(ops, shape, *self._split(ops, shape, law, state, whole=True))

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
        """One bounce of a particle with a tangent vector, whose rows are those of `numeric.kernels.machine.TANGENT`.

        Returns the new state, the code of the outcome or None, the new rows, and the values that the next flight uses.
        To avoid divisions, the vector is not normalised: it changes sign and grows by the factor `below*N1` too much,
        which `down` accumulates. `up` accumulates `below*N0`, times the slope of a law that is no uniform contraction.
        """
        position, exit = self._split(ops, shape, law, state, whole=True)
        landing = self.fly(ops, shape, law, position, exit)
        q, omega, growth, up, down, volume, n0 = tangent
        end = self.kept(ops, shape, landing.position)
        moved = self.length(ops, shape, n0, kept, end, landing) * omega + q
        above, below = self.scaled_curvature(ops, shape, landing)
        fall = landing.along * below
        slope, drift = self.slopes(ops, law, lam, landing)
        turned = (ops.number(1.0) + slope) * above * moved + slope * omega * fall
        if self.unit != 1 and drift[1:]:
            drift = [drift[0], drift[1] * ops.number(self.unit)]
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
        """`N0 = speed*cos(phi0)` of a particle that leaves after a landing, whose frame may be known already."""
        exit = leaving or self.normal_exit_of_unit_length(ops, shape, landing.position)
        return self.exit_normal_speed(ops, shape, landing.position, exit)

    def _split(
        self, ops: Backend[N, M], shape: Fields[N], law: str, state: Fields[N], whole: bool = False
    ) -> tuple[list[N], list[N]]:
        count = len(self.position)
        position = list(state[:count])
        if law != SLAP:
            return position, list(state[count:])
        return position, self.normal_exit_of_unit_length(ops, shape, position) if whole else self.normal_exit(
            ops, shape, position
        )

    def normal_exit_of_unit_length(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        """The direction along the normal, of length one; that of `normal_exit` may have any length."""
        return self.normal_exit(ops, shape, position)


def grazing(ops: Backend[N, M], across: N, along: N) -> M:
    """The mask of flights that end tangent to the boundary, or that do not meet it."""
    return ops.negated(ops.number(GRAZE) * modulus(across) < along)


def reflected(family: Family, ops: Backend[N, M], law: str, lam: N, landing: Landing[N]) -> list[N]:
    """The unit direction after a reflection, from the flight's direction `v` and the boundary's tangent `d`."""
    v, d = landing.vectors["v"], landing.vectors["d"]
    if law == ELASTIC:
        inverse = ops.number(1.0) / plane.dot(d, d)
        x, y = plane.times(plane.squared(d), plane.conjugate(v))
        return list(plane.unit(ops, (x * inverse, y * inverse)))
    c, s = ops.turn(family.exit_angle(ops, law, lam, landing) + family.incidence(ops, landing))
    return list(plane.unit(ops, plane.times((-v[0], -v[1]), (c, -s))))
