"""Attractors: their kinds and data, the refinement of cycles, and the recognition of the one that a particle is on.

A cycle is refined in float64 by multiple shooting: all bounces are unknowns at once, so that errors do not multiply
along the cycle. So a cycle of period 256 can be told from one of 128 close to the accumulation point of period
doublings. For more digits, and for proofs, see the chord system in `verification.cycles`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from math import copysign, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from numeric import Orbit, PinballMap, Status
from numeric.backends import elementary
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, advanced, embedded, phase_points, together

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


class Kind(Enum):
    """The kinds of sets on which a particle can end."""

    CYCLE = "an attracting cycle"
    CHAOTIC = "a chaotic set: an attractor when lam < 1"
    NEUTRAL = "cycles or curves that neither attract nor repel"
    STOPPED = "no attractor: the map is undefined there"


@dataclass(frozen=True)
class Share:
    """A share of the starts: the number of starts in it, and the 95 per cent interval of the true share."""

    count: int
    of: int
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:.1%} to {self.high:.1%}"


@dataclass(frozen=True, eq=False, repr=False)
class Attractor:
    """An attractor: its points (in order on a cycle, a cloud on any other), and what was measured of it.

    `nu_plus` and `nu_minus` are per bounce, with standard errors (0 for a cycle, whose multipliers they come from).
    `reach` is the distance in `(x, y, sin(phi))` within which particles are taken to be caught, or to be on a chaotic
    set: sampled, not proved. `stay` is a lower bound, with 95 per cent confidence, of the mean number of bounces before
    a particle leaves a chaotic attractor: no observed particle left. `family` is one number for attractors that are
    symmetry images of each other; `symmetry` is the attractor's own group, such as `D1`. `doubt` is the reason why a
    chaotic attractor may be several sets; it is empty if there is no such reason.
    """

    kind: Kind
    period: int
    points: PhasePoints
    multipliers: tuple[complex, complex] | None = None
    nu_plus: float = float("nan")
    nu_minus: float = float("nan")
    errors: tuple[float, float] = (0.0, 0.0)
    reach: float = 0.0
    stay: float = float("inf")
    status: Status = Status.REGULAR
    share: Share | None = None
    family: int = -1
    symmetry: str = ""
    doubt: str = ""

    @property
    def name(self) -> str:
        """The kind in words, such as `period 2`."""
        return f"period {self.period}" if self.period else self.kind.name.lower()

    @property
    def exponent(self) -> str:
        """`nu_plus` in words, with its standard error."""
        return f"{self.nu_plus:.6g} +- {self.errors[0]:.1g}"

    def __repr__(self) -> str:
        share = f", {self.share} of the starts" if self.share else ""
        return f"Attractor({self.name}{share}, nu_plus = {self.exponent}{self.symmetry and f', {self.symmetry}'})"


def wilson(count: int, of: int, z: float = 1.96) -> Share:
    """The share with Wilson's interval [Wilson1927], which lies in [0, 1] and has positive length even at 0 and 1.

    >>> share = wilson(0, 100)
    >>> share.low, round(share.high, 4)
    (0.0, 0.037)
    """
    p, w = count / of, z * z / of
    middle, half = (p + w / 2) / (1 + w), z * sqrt(p * (1 - p) / of + w / (4 * of)) / (1 + w)
    return Share(count, of, float(middle - half) if count else 0.0, float(middle + half) if count < of else 1.0)


STEPS = 30
ROUNDING = 1e-11  # of Newton's last correction
SAME = 1e-7  # a cycle whose points return earlier within this distance has a shorter period


@dataclass(frozen=True, eq=False)
class Cycle:
    """The bounces of a cycle in order, from the first one by `(component, theta)`, and both multipliers."""

    points: PhasePoints
    multipliers: tuple[complex, complex]
    volume: float  # the mean of log |det DT| along it

    @property
    def period(self) -> int:
        """The number of bounces."""
        return self.points.size

    @property
    def exponents(self) -> tuple[float, float]:
        """Both Lyapunov exponents, per bounce; their sum is exactly the mean of `log |det DT|`."""
        with np.errstate(divide="ignore"):
            plus = float(elementary.log(abs(self.multipliers[0])) / self.period)
        return plus, self.volume - plus


def polished(map: PinballMap, near: PhasePoints) -> Cycle | None:
    """The cycle with bounces near the given ones, in order; None if Newton's method does not converge near them.

    >>> axis = polished(PinballMap("ellipse", a=2, lam="0.5"), phase_points([1.5, -1.6], [0.01, 0.0]))
    >>> axis.period, axis.points.theta.round(12).tolist()
    (2, [-1.570796326795, 1.570796326795])
    """
    here = near
    for _ in range(STEPS):
        image = map.step(here.theta, here.phi, here.component)
        after = here.turned(1)
        if np.any(image.code):
            return None
        miss = np.stack([beyond(map, image, after), image.phi - after.phi], axis=1)
        if not np.all(np.isfinite(miss)):
            return None
        try:
            step = round_the_cycle(by_parameter(map, here, after), miss)
        except np.linalg.LinAlgError:
            return None
        size = float(np.max(np.abs(step)))
        if not size < 0.5:
            return None
        moved = _moved(map, here, step)
        if moved is None or size < ROUNDING:
            return None if moved is None else shortest(map, moved)
        here = moved
    return None


def round_the_cycle(slopes: Array, right: Array) -> Array:
    """The vectors `d` with `slopes[i] @ d[i] - d[i + 1] = right[i]`, where the last is followed by the first.

    Unknowns are ordered from both ends of the ring, so that the matrix is a band and the work grows like the period. It
    raises `LinAlgError` if the matrix is singular.

    >>> round_the_cycle(np.array([[[3.0, 0.0], [0.0, 0.5]]] * 2), np.array([[1.0, 1.0], [5.0, 1.0]])).tolist()
    [[1.0, -2.0], [2.0, -2.0]]
    """
    from scipy.linalg import solve_banded

    n = len(slopes)
    i = np.arange(n)
    place = 2 * np.where(2 * i < n, 2 * i, 2 * (n - i) - 1)[:, None] + np.arange(2)  # of both unknowns of a bounce
    after = np.roll(place, -1, axis=0)
    band = np.zeros((11, 2 * n))
    rows, columns = place[:, :, None], place[:, None, :]
    band[5 + rows - columns, columns] += slopes
    band[5 + place - after, after] -= 1
    folded = np.empty(2 * n)
    folded[place] = right
    return np.asarray(solve_banded((5, 5), band, folded, check_finite=False)[place], dtype=float)


def shortest(map: PinballMap, cycle: PhasePoints) -> Cycle:
    """The cycle run through once, from its first point, with its multipliers."""
    n = cycle.size
    for period in (d for d in range(1, n + 1) if n % d == 0):
        turned = cycle.turned(period)
        apart = np.abs(gap(map, cycle.theta, turned.theta)) + np.abs(cycle.phi - turned.phi)
        if np.all(cycle.component == turned.component) and np.max(apart) < SAME:
            break
    once = cycle.only(slice(0, period))
    order = np.lexsort((np.round(once.phi, 6), np.round(once.theta, 6), once.component))
    once = once.turned(int(order[0]))
    slopes = map.derivative(once.theta, once.phi, once.component)
    with np.errstate(divide="ignore"):
        volume = float(np.mean(elementary.log(np.abs(determinants(slopes))))) if map.law != "slap" else -np.inf
    return Cycle(once, eigenvalues(slopes), volume)


def multipliers(map: PinballMap, cycle: PhasePoints) -> tuple[complex, complex]:
    """The eigenvalues of the derivative along a cycle, the larger one first. Paper: section 2.1."""
    return eigenvalues(map.derivative(cycle.theta, cycle.phi, cycle.component))


def eigenvalues(slopes: Array) -> tuple[complex, complex]:
    """The eigenvalues of the product of the matrices, the larger first, from its trace and from the product of
    determinants.

    >>> [mu.real for mu in eigenvalues(np.array([[[2.0, 0.0], [0.0, 1.0]], [[4.0, 0.0], [0.0, 0.5]]]))]
    [8.0, 0.5]
    >>> eigenvalues(np.array([[[0.0, -1.0], [1.0, 0.0]]]))
    (1j, -1j)
    """
    product = np.eye(2)
    for matrix in slopes:
        product = np.sum(matrix[:, :, None] * product, axis=1)
    half, determinant = float(product[0, 0] + product[1, 1]) / 2, float(np.prod(determinants(slopes)))
    size = max(abs(half), sqrt(abs(determinant))) or 1.0  # nothing overflows, however long the cycle
    mean = half / size
    discriminant = mean * mean - determinant / size / size
    if discriminant < 0:
        first = complex(half, size * sqrt(-discriminant))
        return first, first.conjugate()
    larger = size * (mean + copysign(sqrt(discriminant), mean))
    return complex(larger), complex(determinant / larger if larger else 0.0)


def determinants(slopes: Array) -> Array:
    """The determinants of 2 by 2 matrices. LAPACK is not used, as its last bit depends on the processor."""
    return np.asarray(slopes[..., 0, 0] * slopes[..., 1, 1] - slopes[..., 0, 1] * slopes[..., 1, 0])


def by_parameter(map: PinballMap, here: PhasePoints, after: PhasePoints) -> Array:
    """The derivative of the map in `(theta, phi)`, a matrix for each particle; `after` is where they land."""
    slope = map.derivative(here.theta, here.phi, here.component)
    slope[:, :, 0] *= map.states.speed(here.component, here.theta)[:, None]
    slope[:, 0, :] /= map.states.speed(after.component, after.theta)[:, None]
    return np.asarray(slope)


def gap(map: PinballMap, left: Array, right: Array) -> Array:
    """The difference of parameters, `left - right`; modulo a whole turn on a table of one closed component."""
    if len(map.states.ends) > 1:
        return left - right
    return np.asarray(np.remainder(left - right + np.pi, 2 * np.pi) - np.pi)


def beyond(map: PinballMap, image: Orbit, after: PhasePoints) -> Array:
    """The parameter of the images minus that of the phase points `after`; nan where a corner lies between the two.

    Across a smooth join the difference is measured along the tangent; there it is exact only where it is 0.
    """
    found, other = gap(map, image.theta, after.theta), image.component != after.component
    if np.any(other):
        part, theta = after.component[other], after.theta[other]
        way = np.array(map.states.tangent(part, theta))
        between = np.array([image.x[other], image.y[other]]) - map.states.point(part, theta)
        near = np.hypot(*between) < LOOSE * map.states.size
        along = np.sum(way * between, axis=0) / map.states.speed(part, theta)
        corner = np.array(map.family.boundary.corners)[part, (along > 0).astype(int)]
        found[other] = np.where(near & ~corner, along, np.nan)
    return found


def _moved(map: PinballMap, here: PhasePoints, step: Array) -> PhasePoints | None:
    theta, phi = here.theta - step[:, 0], here.phi - step[:, 1]
    if len(map.states.ends) > 1:
        low, high = np.array(map.states.ends)[here.component].T
        first, last = np.array(map.family.boundary.corners)[here.component].T
        if np.any((first & (theta <= low)) | (last & (theta >= high))):
            return None
        theta = np.clip(theta, low, high)  # at most to a smooth join, on which a cycle may lie
    else:
        theta = theta - 2 * np.pi * np.rint(theta / (2 * np.pi))
    if np.any(np.abs(phi) >= np.pi / 2):
        return None
    return phase_points(theta, phi, here.component)


UNSETTLED = -1
LONGEST = 256  # longest period that is searched for
RETURN, LOOSE = 1e-9, 1e-2  # distance of a particle from where it was: it is on a cycle; it may be near one
REACHES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # radii tried for a cycle's neighbourhood
SAME_POINT = 1e-6  # between cycles
UNIT = 1e-7  # distance from 1 of a multiplier that counts as 1
NEAR = 0.1  # largest distance from a cloud of a particle that is on it
VOTES = 16  # bounces that decide on which cloud a particle is


def same(map: PinballMap, old: Attractor, new: Attractor) -> bool:
    """Are two attractors the same cycle, the same neutral family, or the same outcome that stops particles?"""
    if (old.kind, old.period, old.status) != (new.kind, new.period, new.status):
        return False
    if old.kind is not Kind.CYCLE:
        return old.kind is not Kind.CHAOTIC
    first = embedded(map, new.points.only(slice(0, 1)))
    return bool(np.min(np.linalg.norm(embedded(map, old.points) - first, axis=1)) < SAME_POINT)


def at_cycles(map: PinballMap, particles: PhasePoints, attractors: Sequence[Attractor]) -> Labels:
    """The index of the cycle within whose reach each particle is, or of the neutral family it is in; -1 for none."""
    found = np.full(particles.size, UNSETTLED)
    cycles = [i for i, a in enumerate(attractors) if a.kind is Kind.CYCLE]
    if cycles:
        owner = np.repeat(cycles, [attractors[i].period for i in cycles])
        tree = tree_of(embedded(map, together(*(attractors[i].points for i in cycles))))
        reach = np.array([attractors[i].reach for i in owner])
        distance, nearest = tree.query(embedded(map, particles), distance_upper_bound=2 * REACHES[0])
        near = distance < np.append(reach, 0.0)[nearest]
        found[near] = owner[nearest[near]]
    for index, attractor in enumerate(attractors):
        left = np.nonzero(found == UNSETTLED)[0]
        if attractor.kind is Kind.NEUTRAL and attractor.period and left.size:
            here = particles.only(left)
            there = advanced(map, here, attractor.period).points
            back = np.linalg.norm(embedded(map, there) - embedded(map, here), axis=1) < RETURN
            found[left[back]] = index
    return found


def tree_of(points: Array) -> "cKDTree":
    """The points sorted for the search of nearest ones."""
    from scipy.spatial import cKDTree  # a third of a second that other questions do without

    return cKDTree(points)


def at_clouds(map: PinballMap, particles: PhasePoints, attractors: Sequence[Attractor]) -> Labels:
    """The index of the chaotic attractor nearest to each particle; -1 when it is not near any."""
    return clouds(map, attractors)(particles)


def clouds(map: PinballMap, attractors: Sequence[Attractor]) -> Callable[[PhasePoints], Labels]:
    """`at_clouds` as a function of the particles, for repeated use: the attractors' points are sorted once."""
    chaotic = [i for i, a in enumerate(attractors) if a.kind is Kind.CHAOTIC]
    if not chaotic:
        return lambda particles: np.full(particles.size, UNSETTLED)
    owner = np.repeat(chaotic, [attractors[i].points.size for i in chaotic])
    tree = tree_of(embedded(map, together(*(attractors[i].points for i in chaotic))))
    reach = np.array([attractors[i].reach or NEAR for i in owner])

    def nearest_to(particles: PhasePoints) -> Labels:
        distance, nearest = tree.query(embedded(map, particles), distance_upper_bound=NEAR)  # none: one past the last
        return np.where(distance < np.append(reach, 0.0)[nearest], np.append(owner, UNSETTLED)[nearest], UNSETTLED)

    return nearest_to


def spacing(map: PinballMap, points: PhasePoints) -> float:
    """The distance within which nearly every further point of a chaotic attractor has a neighbour among `points`."""
    place = embedded(map, points)
    distance = tree_of(place[::2]).query(place[1::2])[0]
    return float(min(max(2 * np.quantile(distance, 0.999), SAME_POINT), NEAR))


def on_clouds(map: PinballMap, particles: PhasePoints, attractors: Sequence[Attractor]) -> Labels:
    """The index of the chaotic attractor near most of the next `VOTES` points of each particle's orbit; -1 for none."""
    if not any(a.kind is Kind.CHAOTIC for a in attractors):
        return np.full(particles.size, UNSETTLED)
    orbit = map.orbit(particles.theta, particles.phi, VOTES - 1, particles.component)
    near = at_clouds(map, phase_points(orbit.theta, orbit.phi, orbit.component), attractors)
    return majority(near.reshape(VOTES, particles.size).T)


def majority(votes: Labels) -> Labels:
    """The label that more than half of the entries of each row have; -1 where there is none.

    >>> majority(np.array([[0, 1, 1], [0, 1, 2], [-1, -1, 0]])).tolist()
    [1, -1, -1]
    """
    middle = np.sort(votes, axis=1)[:, votes.shape[1] // 2]
    return np.where(2 * np.sum(votes == middle[:, None], axis=1) > votes.shape[1], middle, UNSETTLED)


def recognised(map: PinballMap, particles: PhasePoints, calm: NDArray[np.bool_]) -> list[Attractor]:
    """The attracting or neutral cycles on which a particle is, or which a particle in the mask `calm` approaches."""
    if particles.size == 0:
        return []
    orbit = map.orbit(particles.theta, particles.phi, LONGEST, particles.component)
    flat = phase_points(*(np.ravel(rows) for rows in (orbit.theta, orbit.phi, orbit.component)))
    track = embedded(map, flat).reshape(*orbit.theta.shape, 3)
    gaps = np.linalg.norm(track[1:] - track[:1], axis=-1)
    found: list[Attractor] = []
    for i in range(particles.size):
        period = _period(gaps[:, i], LOOSE if calm[i] else RETURN)
        if period == 0 or any(_at(map, attractor, track[0, i]) for attractor in found):
            continue
        points = PhasePoints(orbit.component[:period, i], orbit.theta[:period, i], orbit.phi[:period, i])
        attractor = _attractor(map, points, float(gaps[period - 1, i]))
        if attractor is not None:
            found.append(attractor)
    return found


def _period(gaps: Array, loose: float) -> int:
    """The number of bounces after which a particle first returns within `RETURN`, or comes nearest to its start.

    The second counts only if the distance is below `loose`; otherwise the result is 0.
    """
    back = np.nonzero(gaps < RETURN)[0]
    if back.size:
        return int(back[0]) + 1
    nearest = int(np.argmin(gaps))
    return nearest + 1 if gaps[nearest] < loose else 0


def _at(map: PinballMap, attractor: Attractor, point: Array) -> bool:
    return bool(np.min(np.linalg.norm(embedded(map, attractor.points) - point, axis=1)) < attractor.reach)


def _attractor(map: PinballMap, points: PhasePoints, miss: float) -> Attractor | None:
    """The attracting or neutral cycle near these points, whose orbit returns with a gap of `miss`; None if there is
    none.
    """
    if miss < RETURN and abs(abs(multipliers(map, points)[0]) - 1) < UNIT:
        larger, smaller = multipliers(map, points)
        with np.errstate(divide="ignore"):
            lower = float(elementary.log(abs(smaller)) / points.size)
        return Attractor(Kind.NEUTRAL, points.size, points, (larger, smaller), 0.0, lower)
    cycle = polished(map, points)
    if cycle is None or abs(cycle.multipliers[0]) >= 1 - UNIT:
        return None
    new = Attractor(Kind.CYCLE, cycle.period, cycle.points, cycle.multipliers, *cycle.exponents)
    return replace(new, reach=reach(map, cycle))


def reach(map: PinballMap, cycle: Cycle, seed: int = 0) -> float:
    """The largest tried radius from which all sampled particles come ten times nearer to the cycle; else the least
    tried.

    >>> from numeric.dynamics.phase_points import phase_points
    >>> cycle = polished(PinballMap("ellipse", a=2, lam="0.5"), phase_points([1.5, -1.6], 0.0))
    >>> reach(PinballMap("ellipse", a=2, lam="0.5"), cycle)
    0.01
    """
    rng, tree = np.random.default_rng(seed), tree_of(embedded(map, cycle.points))
    many = together(*[cycle.points] * (1 + 63 // cycle.period))
    speed = map.states.speed(many.component, many.theta)
    size = max(abs(cycle.multipliers[0]), 1e-3)
    turns = min(int(np.ceil(elementary.log(0.03) / elementary.log(size))) + 4, 20_000 // cycle.period + 1)
    ends = np.array(map.states.ends)[many.component]
    for radius in REACHES:
        angle = rng.uniform(0, 2 * np.pi, many.size)
        theta = many.theta + radius * map.states.size * np.cos(angle) / speed
        if len(map.states.ends) > 1:
            theta = np.clip(theta, ends[:, 0], ends[:, 1])
        phi = np.clip(many.phi + radius * np.sin(angle), -1.57, 1.57)
        end = advanced(map, PhasePoints(many.component, theta, phi), turns * cycle.period)
        distance = tree.query(embedded(map, end.points))[0]
        if np.max(distance) < radius / 10 and not np.any(end.code):
            return radius
    return REACHES[-1]
