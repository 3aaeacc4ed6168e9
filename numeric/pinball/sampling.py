"""Random and regular starts of orbits, and the growth of a tangent vector and of areas along orbits.

Starts are random points of phase space, random points of the table, or a grid for pictures.

A start in the interior is the paper's: a point uniform in the table, with a uniform direction, moved to its first
collision, which is elastic. No flight from an interior point is computed. Instead a chord is drawn from the measure
`ds d(sin(phi))` of the elastic map, and kept with probability `t/diameter` for its length `t`. Points uniform on such
chords are uniform in the table, with uniform directions (Santalo), and the far end of the chord is the first collision.
This holds on every table, and uses only the flights of the table's own kernel.

All draws come from one seeded generator in one order: they depend neither on threads nor on batches.

A `Growth` is a set of particles on their way, each with a tangent vector. Sums of logarithms are kept from the start,
so that the growth between two moments is a difference of sums, and no digits are lost if it is read often.
"""

from collections.abc import Sequence
from copy import copy
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric.backends import elementary
from numeric.flights.family import FORMULA, SLAP
from numeric.kernels.machine import TANGENT, KernelSpec, starting
from numeric.pinball.states import counted, many

if TYPE_CHECKING:
    from numeric.pinball.map import PinballMap


Array = NDArray[np.float64]
BATCH = 1 << 14  # chords drawn at a time
FEWEST = 256  # chords that are placed at a time, at least
INSIDE = 1 - 1e-12  # share of a component and of the angles that starts fill: never an end
RULER = 512  # boundary points between which the diameter is measured


class Starts(NamedTuple):
    """Particles about to leave the boundary; `x, y` is the interior point they came from, else the boundary point."""

    component: NDArray[np.int64]
    theta: Array
    phi: Array
    x: Array
    y: Array

    def __repr__(self) -> str:
        return f"Starts({many(self.theta.size, 'particle')})"

    def only(self, which: NDArray[np.bool_] | NDArray[np.int64] | slice) -> "Starts":
        """The particles at these indices, or where a mask is true."""
        return Starts(*(row[which] for row in self))  # type: ignore[arg-type]  # rows keep their kinds


class PhaseGrid(NamedTuple):
    """Cell centres: `s` along the columns, `sin_phi` along the rows, and the particles there, row after row."""

    s: Array
    sin_phi: Array
    starts: Starts

    def __repr__(self) -> str:
        return f"PhaseGrid({self.s.size} x {self.sin_phi.size} cells)"


def phase_starts(map: "PinballMap", count: int, seed: int) -> Starts:
    """Random particles, uniform in arc length and `sin(phi)`: the elastic map's own measure.

    >>> from numeric import PinballMap
    >>> starts = phase_starts(PinballMap("circle", lam=1), 3, seed=0)
    >>> bool(np.all(np.abs(starts.phi) < np.pi / 2)), starts.component.tolist()
    (True, [0, 0, 0])
    """
    return _uniform(map, counted("count", count), np.random.default_rng(seed))


def interior_starts(map: "PinballMap", count: int, seed: int) -> Starts:
    """Random particles after their first collision: points uniform in the table, directions uniform.

    Paper: appendix. The first collision is elastic whatever `lam` is, so that every exit angle occurs, even at
    `lam = 0`. With the same seed, a shorter list is the beginning of a longer one.

    >>> from numeric import PinballMap
    >>> starts = interior_starts(PinballMap("circle", lam=0), 1000, seed=0)
    >>> bool(np.all(np.hypot(starts.x, starts.y) < 1))
    True
    """
    rng, elastic = np.random.default_rng(seed), map.uniform(lam=1)
    missing, diameter = counted("count", count), longest(map)
    batches: list[Starts] = []
    while missing > 0:
        index, s, phi = _drawn(map, BATCH, rng)
        drop, along = rng.uniform(0, diameter, BATCH), rng.uniform(0, 1, BATCH)
        first, before = 0, missing
        while missing > 0 and first < BATCH:  # of a whole batch only as many as are still missing become chords
            some = slice(first, first + max(FEWEST, 2 * missing))
            leaving, part = _placed(map, index[some], s[some], phi[some]), along[some]
            landing = elastic.step(leaving.theta, leaving.phi, leaving.component)
            t = np.hypot(landing.x - leaving.x, landing.y - leaving.y)
            kept = (drop[some] < t) & (landing.code == 0)
            x, y = leaving.x + part * (landing.x - leaving.x), leaving.y + part * (landing.y - leaving.y)
            batch = Starts(landing.component, landing.theta, landing.phi, x, y)
            batches.append(Starts(*(field[kept][:missing] for field in batch)))
            missing, first = missing - batches[-1].theta.size, some.stop
        if missing == before:
            raise ValueError(f"{map.ir.table}: no chord lands on its boundary; the table must be closed")
    return Starts(*(np.concatenate(fields) for fields in zip(*batches, strict=True)))


def phase_grid(map: "PinballMap", columns: int, rows: int) -> PhaseGrid:
    """A particle at the centre of each cell of phase space, in `s` from `-L/2` to `L/2` and `sin(phi)` from -1 to 1.

    `L` is the perimeter; `s` is the paper's arc length. The first row is the lowest.

    >>> from numeric import PinballMap
    >>> grid = phase_grid(PinballMap("cardioid", lam=1), 4, 2)
    >>> grid.s.tolist(), grid.sin_phi.tolist(), grid.starts.theta.size
    ([-3.0, -1.0, 1.0, 3.0], [-0.5, 0.5], 8)
    """
    columns, rows = counted("columns", columns), counted("rows", rows)
    s = (np.arange(columns, dtype=np.float64) + 0.5 - columns / 2) * (map.arclength.perimeter / columns)
    sin_phi = (2 * np.arange(rows, dtype=np.float64) + 1 - rows) / rows
    component, theta = boundary(map, s)
    x, y = map.states.point(component, theta)
    across = (np.tile(field, rows) for field in (x, y))
    phi = np.repeat(elementary.arcsin(sin_phi), columns)
    return PhaseGrid(s, sin_phi, Starts(np.tile(component, rows), np.tile(theta, rows), phi, *across))


def boundary(map: "PinballMap", s: Array) -> tuple[NDArray[np.int64], Array]:
    """Component and parameter at arc length `s`, taken modulo the perimeter.

    >>> from numeric import PinballMap
    >>> component, theta = boundary(PinballMap("cuspless"), np.array([0.0, 9 * 3**0.5 / 4]))
    >>> component.tolist(), (abs(theta.round(12)) + 0.0).tolist()
    ([1, 0], [0.0, 0.0])
    """
    low, high = _spans(map)
    first = float(np.min(low))
    turned = first + np.mod(s - first, map.arclength.perimeter)
    order = np.argsort(low)
    component = order[np.searchsorted(low[order], turned, side="right") - 1]
    inside = np.clip(turned, low[component], high[component])
    return component, map.arclength.theta(inside, component)


WALLS = (1 << 10, 1 << 14, 1 << 18)  # boundary points between which a line is followed, finer where that is too coarse
NEARLY = 1e-12  # of the table's size: a point so near the wall lies on it


def flight_through(map: "PinballMap", x: float, y: float, vx: float, vy: float) -> tuple[float, float, int]:
    """The flight from wall to wall that passes an interior point in a direction: its `theta`, `phi` and component.

    Its landing is the first wall that a particle from the point meets. The wall behind the point is searched for on a
    grid; the map's own flight from there, which passes the point, shows that no wall lies between.

    >>> from numeric import PinballMap
    >>> theta, phi, component = flight_through(PinballMap("circle"), 0.5, 0.0, 0.0, 2.0)
    >>> round(theta, 12), round(phi, 12)
    (-1.047197551197, 0.523598775598)
    """
    length = float(np.hypot(vx, vy))
    if not np.isfinite([x, y, length]).all() or length == 0:
        raise ValueError(f"({vx}, {vy}) at ({x}, {y}) is no direction; give finite numbers, not both of them 0")
    vx, vy = vx / length, vy / length
    size = longest(map)
    for points in WALLS:
        component, theta, along = _crossings(map, x, y, vx, vy, points)
        if np.any(np.abs(along) < NEARLY * size):
            raise ValueError(f"({x}, {y}) lies on the wall; give a point inside, or a start on the boundary")
        nearest = np.max(along, where=along < 0, initial=-np.inf)
        for k in np.flatnonzero((along < 0) & (along > nearest - NEARLY * size)):  # two, where the line meets a join
            where, at = component[k : k + 1], theta[k : k + 1]
            phi = map.states.angle_to_normal(where, at, np.array([vx]), np.array([vy]))
            if not abs(phi[0]) < np.pi / 2:  # the point lies outside of this wall
                continue
            landed = map.step(at, phi, where)
            if landed.code[0] or (landed.x[0] - x) * vx + (landed.y[0] - y) * vy > 0:
                return float(at[0]), float(phi[0]), int(where[0])
    raise ValueError(f"({x}, {y}) is not inside of the table")


def _crossings(
    map: "PinballMap", x: float, y: float, vx: float, vy: float, points: int
) -> tuple[NDArray[np.int64], Array, Array]:
    """Where a line meets the boundary, by a search on `points` points: component, parameter, and place on the line."""
    ends = np.array(map.states.ends)
    each = max(4, points // len(ends))
    share = np.linspace(0, 1, each + 1)
    component = np.repeat(np.arange(len(ends)), each + 1)
    theta = (ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * share).ravel()

    def offset(where: NDArray[np.int64], at: Array) -> Array:
        px, py = map.states.point(where, at)
        return np.asarray((px - x) * vy - (py - y) * vx)

    value = offset(component, theta)
    found = np.flatnonzero((value[:-1] < 0) != (value[1:] < 0))
    found = found[component[found] == component[found + 1]]
    where, low, high, negative = component[found], theta[found], theta[found + 1], value[found] < 0
    for _ in range(60):
        middle = (low + high) / 2
        same = (offset(where, middle) < 0) == negative
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    first, last = theta.reshape(len(ends), -1)[:, 0], theta.reshape(len(ends), -1)[:, -1]
    index = np.arange(len(ends))
    (x0, y0), (x1, y1) = map.states.point(index, first), map.states.point(index, last)
    after = np.argmin(np.hypot(x0 - x1[:, None], y0 - y1[:, None]), axis=1)  # the component that begins where one ends
    joined = np.flatnonzero((value.reshape(len(ends), -1)[:, -1] < 0) != (value.reshape(len(ends), -1)[after, 0] < 0))
    where = np.concatenate([where, joined, after[joined]])
    low = np.concatenate([low, last[joined], first[after[joined]]])
    px, py = map.states.point(where, low)
    return where, low, (px - x) * vx + (py - y) * vy


def longest(map: "PinballMap") -> float:
    """An upper bound of the table's diameter: the largest distance of `RULER` boundary points, plus their spacing."""
    s = np.arange(RULER, dtype=np.float64) * (map.arclength.perimeter / RULER)
    x, y = map.states.point(*boundary(map, s))
    measured = np.max(np.hypot(x[:, None] - x, y[:, None] - y))
    return float(measured) + map.arclength.perimeter / RULER


def _uniform(map: "PinballMap", count: int, rng: "np.random.Generator") -> Starts:
    return _placed(map, *_drawn(map, count, rng))


def _drawn(map: "PinballMap", count: int, rng: "np.random.Generator") -> tuple[NDArray[np.int64], Array, Array]:
    """Random components, arc lengths and exit angles, by the elastic map's measure."""
    low, high = _spans(map)
    if not np.all(np.isfinite(high - low)):
        raise ValueError(f"{map.ir.table}: its arc length is beyond what float64 holds; scale the table")
    component = rng.choice(np.arange(low.size), size=count, p=(high - low) / np.sum(high - low))
    s = low[component] + (high - low)[component] * rng.uniform(1 - INSIDE, INSIDE, count)
    return component, s, elementary.arcsin(rng.uniform(-1, 1, count) * INSIDE)


def _placed(map: "PinballMap", component: NDArray[np.int64], s: Array, phi: Array) -> Starts:
    theta = map.arclength.theta(s, component)
    return Starts(component, theta, phi, *map.states.point(component, theta))


def _spans(map: "PinballMap") -> tuple[Array, Array]:
    """Arc length at both ends of every component."""
    ends = np.array(map.states.ends)
    index = np.arange(len(ends))
    return map.arclength.s(ends[:, 0], index), map.arclength.s(ends[:, 1], index)


GENERIC = 0.8, 0.6  # a first tangent vector (ds, dphi), of length 1
TOGETHER = 1 << 15  # particles times blocks whose growth is computed together
ALIGNED = 256  # bounces in which a tangent vector turns to the direction of growth


class Growth:
    """Particles, each with a tangent vector in the coordinates `(s, phi)`; `advance` moves all of them.

    `stretch` is the logarithm of the vector's length, `volume` that of `|det|` without the `contraction` of each
    bounce, both since the start; `bounces` is the number of bounces that each particle made before it possibly stopped.

    >>> import numpy as np
    >>> from numeric import PinballMap
    >>> growth = Growth(PinballMap("cardioid", lam=0), np.pi / 3, 0.0)  # T0' = 1 - t*|K| = -5/4 there
    >>> growth.advance(2)
    >>> growth.advance(2)
    >>> bool(abs(growth.stretch[0] / 4 - np.log(5 / 4)) < 1e-14), int(growth.bounces[0])
    (True, 4)
    """

    def __init__(self, map: "PinballMap", theta: ArrayLike, phi: ArrayLike, component: ArrayLike = 0) -> None:
        self.map = map
        where, at, angle = map._start(theta, phi, component)
        self.component, self.theta, self.phi = where.ravel(), at.ravel(), angle.ravel()
        self.law, self.lam = map._law(angle), map._lams(at)
        self.own = map._entered((self.component, self.theta, self.phi), self.law, self.lam)
        self.bounces: NDArray[np.int64] = np.zeros(at.size, dtype=np.int64)
        self.code: NDArray[np.int64] = np.zeros(at.size, dtype=np.int64)
        self.began()

    @property
    def contraction(self) -> Array:
        """The contraction of angles, `log(lam)`, which is the term of each bounce that `volume` leaves out.

        For any law but the uniform contraction it is 0: there `volume` contains the slopes.
        """
        with np.errstate(divide="ignore"):
            return np.zeros_like(self.lam) if self.law == FORMULA else elementary.log(self.lam)

    def only(self, which: NDArray[np.int64]) -> "Growth":
        """A `Growth` of some of the particles, in their present state.

        >>> from numeric import PinballMap
        >>> growth = Growth(PinballMap("cardioid", lam=0.5), [0.5, 1.0], 0.1)
        >>> growth.advance(3)
        >>> alone = growth.only(np.array([1]))
        >>> growth.advance(3), alone.advance(3)
        (None, None)
        >>> bool(alone.theta[0] == growth.theta[1]), bool(alone.stretch[0] == growth.stretch[1])
        (True, True)
        """
        some = copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(some, name, value[which])
        some.own, some.tangent = [row[which] for row in self.own], [row[which] for row in self.tangent]
        return some

    def began(self) -> None:
        """Sets the sums to 0; tangent vectors are made when they are needed."""
        self.tangent: list[Array] = []
        self.stretch, self.volume = np.zeros(self.theta.size), np.zeros(self.theta.size)
        self.origin = np.zeros((self.theta.size, 2))  # of both sums
        self.misalignment = np.ones(self.theta.size)

    def settle(self, bounces: int, threads: int | None = None) -> None:
        """Moves particles without counting; during the last `ALIGNED` bounces their vectors turn to the direction of
        growth.

        Later calls of `advance` go on with these vectors. `misalignment` is set to the ratio of the singular values of
        the derivative of those bounces, which is about the vector's angle to the direction of growth; it is 1 for a new
        vector.

        >>> from numeric import PinballMap
        >>> growth = Growth(PinballMap("cardioid", lam=0.5), 0.3, 0.2)
        >>> growth.settle(100)
        >>> float(growth.stretch[0]), bool(growth.misalignment[0] < 1e-30)
        (0.0, True)
        """
        turning = min(bounces, ALIGNED)
        self.skip(bounces - turning, threads)
        self.advance(turning, threads)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            ratio = elementary.exp(self.volume + self.contraction * turning - 2 * self.stretch)
        self.misalignment = np.fmin(ratio, 1.0) if turning else self.misalignment
        self.origin += np.stack([self.stretch, self.volume], axis=1)
        self.stretch, self.volume = np.zeros(self.theta.size), np.zeros(self.theta.size)
        self.bounces = np.zeros_like(self.bounces)

    def _vectors(self) -> list[Array]:
        """The rows of the generic tangent vector at each particle."""
        self.speed, curvature = self.map.states.bending(self.component, self.theta)
        ds, dphi = (1.0, 0.0) if self.law == SLAP else GENERIC
        self.n0 = self.map.states.exit_normal_speed(self.own, self.law)
        omega = curvature * ds + dphi
        return starting(self.n0 * (ds / self.speed), omega, self.n0)

    def skip(self, bounces: int, threads: int | None = None) -> None:
        """Moves the particles without tangent vectors and sets the sums to 0: these bounces do not count."""
        if bounces and self.theta.size:
            self._stop(self._run(KernelSpec(self.law), bounces, (), threads))
            self._arrive(*self.map.states.place(self.own))
            self.began()

    def advance(self, bounces: int, threads: int | None = None) -> None:
        """Moves particles and tangent vectors by `bounces` bounces, and adds their growth to the sums."""
        self.advance_blocks([bounces] if bounces else [], threads)

    def advance_blocks(self, sizes: Sequence[int], threads: int | None = None) -> Array:
        """Moves particles and vectors by blocks of bounces; returns `stretch` and `volume` before and after each block.

        The shape is `(2, blocks + 1, particles)`. The kernel runs once for each block; what follows from its rows is
        computed for many blocks together.
        """
        reached = np.empty((2, len(sizes) + 1, self.theta.size))
        reached[:, 0] = self.stretch, self.volume
        if self.theta.size:
            most = max(1, TOGETHER // self.theta.size)
            for first in range(0, len(sizes), most):
                reached[:, first + 1 : first + most + 1] = self._some_blocks(sizes[first : first + most], threads)
        return reached

    def _some_blocks(self, sizes: Sequence[int], threads: int | None) -> Array:
        self.tangent = self.tangent or self._vectors()
        spec, runs = KernelSpec(self.law, exponents=True), []
        for size in sizes:
            runs.append(self._run(spec, size, self.tangent, threads))
            self.tangent = [runs[-1][name] for name in TANGENT]
        rows = {name: np.concatenate([run[name] for run in runs]) for name in runs[0]}
        component, theta = self.map.states.place([rows[name] for name in self.map.family.fields(self.law)])
        speed, curvature = self.map.states.bending(component, theta)
        moved = rows["shift"] / rows["n0"] * speed
        turned = rows["omega"] - curvature * moved
        shape = len(sizes), self.theta.size
        with np.errstate(divide="ignore"):
            stretch = elementary.log(np.hypot(moved, turned) / rows["down"]) + rows["growth"] * elementary.log(2.0)
            begun = [np.tile(values, len(sizes)) for values in (self.speed, self.n0)]
            ends = elementary.log(speed / begun[0]) + elementary.log(begun[1] / rows["n0"])
            volume = elementary.log(rows["up"] / rows["down"]) + rows["volume"] * elementary.log(2.0) + ends
        reached = np.stack([x.reshape(shape) for x in (stretch, volume)]) - self.origin.T[:, None]
        for i, (size, run) in enumerate(zip(sizes, runs, strict=True)):
            going = self.code == 0
            self.stretch, self.volume = reached[:, i] = np.where(going, reached[:, i], [self.stretch, self.volume])
            made = size - (run["lost"].astype(np.int64) if "lost" in run else 0)
            self.bounces = self.bounces + np.where(going, made, 0)
            self._stop(run)
        self._arrive(component[-shape[1] :], theta[-shape[1] :])
        return reached

    def _run(self, spec: KernelSpec, bounces: int, tangent: Sequence[Array], threads: int | None) -> dict[str, Array]:
        map = self.map
        rows = map.engine.run(spec, self.own, self.lam, map.shape, bounces, tangent, threads).rows
        self.own = [rows[name] for name in map.family.fields(self.law)]
        return rows

    def _stop(self, rows: dict[str, Array]) -> None:
        """Stores the outcomes of the particles that a run has stopped."""
        if "code" in rows:
            self.code = np.where(self.code == 0, rows["code"].astype(np.int64), self.code)

    def _arrive(self, component: NDArray[np.int64], theta: Array) -> None:
        """Stores where the particles are after a run."""
        self.component, self.theta = component, theta
        self.phi = self.map.states.exit(component, theta, self.own, self.law)
