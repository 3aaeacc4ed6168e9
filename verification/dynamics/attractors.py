"""The attractors of a map: found from many starts, told apart, and every ball labelled with the one it reaches.

A cycle is polished (`verification.dynamics.cycles`) and then recognised by nearness; what settles on no cycle
and spreads is chaotic when no ball leaves it for a whole round of bounces, and then falls into the sets
that its orbits join (`verification.dynamics.clouds`). Whatever is still leaving at the end is unsettled.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from numeric import PinballMap, Status
from verification.dynamics.clouds import clouds
from verification.dynamics.cycles import Cycle, multipliers, polished
from verification.dynamics.places import Array, Places, advanced, embedded, places, together

UNSETTLED = -1
LONGEST = 256  # period that is looked for
RETURN, LOOSE = 1e-9, 1e-2  # of a ball to where it was: it is a cycle; it may be near one
SAMPLE = 64  # balls looked at for new cycles
ROUNDS = 6
REACHES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # radii tried for a cycle's neighbourhood
UNIT = 1e-7  # how near 1 a multiplier is that counts as 1
Labels = NDArray[np.int64]


class Kind(Enum):
    """What a ball ends on."""

    CYCLE = "an attracting cycle"
    CHAOTIC = "a chaotic set: an attractor when lam < 1"
    NEUTRAL = "cycles or curves that neither attract nor repel"
    STOPPED = "no attractor: the map is undefined there"


@dataclass(frozen=True, eq=False)
class Attractor:
    """An attractor: its points (a cycle's in order, a cloud of others), and what was measured of it.

    `reach` is the distance in `(x, y, sin(phi))` within which balls are taken to be caught: sampled, not proved.
    `stay` bounds the mean number of bounces before a ball leaves a chaotic attractor from below, with 95 per
    cent confidence: none of the balls seen left.
    """

    kind: Kind
    period: int
    points: Places
    multipliers: tuple[complex, complex] | None = None
    nu_plus: float = float("nan")
    nu_minus: float = float("nan")
    reach: float = 0.0
    stay: float = float("inf")
    status: Status = Status.REGULAR


class Classified(NamedTuple):
    """The index of each ball's attractor, -1 where it did not settle, and the attractors."""

    label: Labels
    attractors: tuple[Attractor, ...]


def classify(
    map: PinballMap,
    component: ArrayLike,
    theta: ArrayLike,
    phi: ArrayLike,
    transient: int = 1000,
    known: Sequence[Attractor] = (),
    rounds: int = ROUNDS,
) -> Classified:
    """The attractor that each ball reaches. Attractors already `known` keep their index; new ones follow.

    >>> ellipse = PinballMap("ellipse", a=2, lam="0.5")
    >>> found = classify(ellipse, 0, [0.1, 1.0, 2.0], 0.2)
    >>> found.label.tolist(), [(a.kind.name, a.period) for a in found.attractors]
    ([0, 0, 0], [('CYCLE', 2)])
    """
    return _Sorting(map, places(component, theta, phi), list(known)).sorted(transient, rounds)


@dataclass
class _Sorting:
    """Balls on their way to attractors; the ones in `going` have not been recognised yet."""

    map: PinballMap
    balls: Places
    attractors: list[Attractor]
    label: Labels = field(init=False)
    going: Labels = field(init=False)
    growth: Array = field(init=False)

    def __post_init__(self) -> None:
        self.label = np.full(self.balls.size, UNSETTLED)
        self.going = np.arange(self.balls.size)

    def sorted(self, transient: int, rounds: int) -> Classified:
        """Rounds of bounces, each twice as long, until one goes by in which no ball is recognised."""
        self._advance(transient)
        if self.map.law == "elastic":
            self._conserved(transient)
        self._catch()
        bounces, leaving = transient, True
        for _ in range(rounds):
            before = self.going.size
            if before == 0:
                break
            self._advance(bounces)
            self._catch()
            leaving = self.going.size < before
            if not leaving and np.all(self.growth > 0):
                break
            bounces *= 2
        if not leaving:
            self._spread(bounces)
        return Classified(self.label, tuple(self.attractors))

    def _advance(self, bounces: int) -> None:
        """Moves those that are going, and keeps how fast their neighbourhoods grow; the ones that stop are labelled."""
        here = self.balls.only(self.going)
        end = self.map.exponents(here.theta, here.phi, bounces, 0, here.component)
        for rows, new in zip(self.balls, (end.component, end.theta, end.phi), strict=True):
            rows[self.going] = new
        for code in np.unique(end.code[end.code > 0]):
            at = end.code == code
            status = list(Status)[code]
            index = self._entered(Attractor(Kind.STOPPED, 0, here.only(at).only(slice(0, 1)), status=status))
            self.label[self.going[at]] = index
        self._keep(end.code == 0, end.nu_plus)

    def _keep(self, which: NDArray[np.bool_], growth: Array) -> None:
        self.going, self.growth = self.going[which], growth[which]

    def _entered(self, new: Attractor) -> int:
        """The index of an attractor, in the list if it was not there."""
        for index, old in enumerate(self.attractors):
            if (old.kind, old.period, old.status) == (new.kind, new.period, new.status) and _same(self.map, old, new):
                return index
        self.attractors.append(new)
        return len(self.attractors) - 1

    def _catch(self) -> None:
        """Labels the balls that are at a cycle, and looks for new cycles among the others."""
        while self.going.size:
            caught = at_cycles(self.map, self.balls.only(self.going), self.attractors)
            self.label[self.going] = caught
            self._keep(caught == UNSETTLED, self.growth)
            known, calm = len(self.attractors), np.argsort(self.growth)[:SAMPLE]
            for cycle in recognised(self.map, self.balls.only(self.going[calm]), self.growth[calm] < 0):
                self._entered(cycle)
            if len(self.attractors) == known:
                break

    def _conserved(self, bounces: int) -> None:
        """At `lam = 1` nothing attracts: a ball spreads like a power of the time, or exponentially."""
        regular = self.growth < 3 * np.log(bounces + 1) / bounces
        if np.any(regular):
            points = self.balls.only(self.going[regular])
            self.label[self.going[regular]] = self._entered(Attractor(Kind.NEUTRAL, 0, points))
            self._keep(~regular, self.growth)

    def _spread(self, bounces: int) -> None:
        """Shares out the balls that spread among the chaotic attractors; new ones are made for those near none."""
        stay = self.going.size * bounces / 3
        self._keep(self.growth > 0, self.growth)
        while self.going.size:
            near = at_clouds(self.map, self.balls.only(self.going), self.attractors)
            self.label[self.going] = near
            self._keep(near == UNSETTLED, self.growth)
            if self.going.size:
                for points in clouds(self.map, self.balls.only(self.going)):
                    self.attractors.append(Attractor(Kind.CHAOTIC, 0, points, stay=stay))


def _same(map: PinballMap, old: Attractor, new: Attractor) -> bool:
    if old.kind is not Kind.CYCLE:
        return True
    first = embedded(map, new.points.only(slice(0, 1)))
    return bool(np.min(np.linalg.norm(embedded(map, old.points) - first, axis=1)) < RETURN**0.5 / 10)


def at_cycles(map: PinballMap, balls: Places, attractors: Sequence[Attractor]) -> Labels:
    """The cycle within whose reach each ball is, or the neutral family to which it belongs; -1 for none."""
    found = np.full(balls.size, UNSETTLED)
    cycles = [i for i, a in enumerate(attractors) if a.kind is Kind.CYCLE]
    if cycles:
        owner = np.repeat(cycles, [attractors[i].period for i in cycles])
        tree = cKDTree(embedded(map, together(*(attractors[i].points for i in cycles))))
        reach = np.array([attractors[i].reach for i in owner])
        distance, nearest = tree.query(embedded(map, balls), distance_upper_bound=2 * REACHES[0])
        near = distance < np.append(reach, 0.0)[nearest]
        found[near] = owner[nearest[near]]
    for index, attractor in enumerate(attractors):
        left = np.nonzero(found == UNSETTLED)[0]
        if attractor.kind is Kind.NEUTRAL and attractor.period and left.size:
            here = balls.only(left)
            there = advanced(map, here, attractor.period).places
            back = np.linalg.norm(embedded(map, there) - embedded(map, here), axis=1) < RETURN
            found[left[back]] = index
    return found


def at_clouds(map: PinballMap, balls: Places, attractors: Sequence[Attractor]) -> Labels:
    """The chaotic attractor nearest to each ball; -1 when it is not near any."""
    chaotic = [i for i, a in enumerate(attractors) if a.kind is Kind.CHAOTIC]
    if not chaotic:
        return np.full(balls.size, UNSETTLED)
    owner = np.repeat(chaotic, [attractors[i].points.size for i in chaotic])
    tree = cKDTree(embedded(map, together(*(attractors[i].points for i in chaotic))))
    distance, nearest = tree.query(embedded(map, balls))
    return np.where(distance < 0.1, owner[nearest], UNSETTLED)


def recognised(map: PinballMap, balls: Places, calm: NDArray[np.bool_]) -> list[Attractor]:
    """The cycles on which some of the balls are, or near which one of the `calm` ones is: they still draw nearer."""
    if balls.size == 0:
        return []
    orbit = map.orbit(balls.theta, balls.phi, LONGEST, balls.component)
    track = np.stack([orbit.x, orbit.y, np.sin(orbit.phi)], axis=-1)
    gaps = np.linalg.norm(track[1:] - track[:1], axis=-1)
    found: list[Attractor] = []
    for i in range(balls.size):
        period = _period(gaps[:, i], LOOSE if calm[i] else RETURN)
        if period == 0 or any(_at(map, attractor, track[0, i]) for attractor in found):
            continue
        points = Places(orbit.component[:period, i], orbit.theta[:period, i], orbit.phi[:period, i])
        attractor = _attractor(map, points, float(gaps[period - 1, i]))
        if attractor is not None:
            found.append(attractor)
    return found


def _period(gaps: Array, loose: float) -> int:
    """The bounces after which a ball is back, or else comes nearest within `loose`; 0 for never."""
    back = np.nonzero(gaps < RETURN)[0]
    if back.size:
        return int(back[0]) + 1
    nearest = int(np.argmin(gaps))
    return nearest + 1 if gaps[nearest] < loose else 0


def _at(map: PinballMap, attractor: Attractor, point: Array) -> bool:
    return bool(np.min(np.linalg.norm(embedded(map, attractor.points) - point, axis=1)) < attractor.reach)


def _attractor(map: PinballMap, points: Places, miss: float) -> Attractor | None:
    """The attracting or neutral cycle that runs near the points, which return with a gap of `miss`."""
    if miss < RETURN and abs(abs(multipliers(map, points)[0]) - 1) < UNIT:
        return Attractor(Kind.NEUTRAL, points.size, points, multipliers(map, points), 0.0)
    cycle = polished(map, points)
    if cycle is None or abs(cycle.multipliers[0]) >= 1 - UNIT:
        return None
    with np.errstate(divide="ignore"):
        nu = np.log(np.abs(cycle.multipliers)) / cycle.period
    new = Attractor(Kind.CYCLE, cycle.period, cycle.points, cycle.multipliers, float(nu[0]), float(nu[1]))
    return replace(new, reach=reach(map, cycle))


def reach(map: PinballMap, cycle: Cycle, seed: int = 0) -> float:
    """The largest radius tried such that balls that far from the cycle all come ten times nearer: sampled.

    >>> cycle = polished(PinballMap("ellipse", a=2, lam="0.5"), places(0, [1.5, -1.6], 0.0))
    >>> reach(PinballMap("ellipse", a=2, lam="0.5"), cycle)
    0.01
    """
    rng, tree = np.random.default_rng(seed), cKDTree(embedded(map, cycle.points))
    many = together(*[cycle.points] * (1 + 63 // cycle.period))
    speed = map.states.speed(many.component, many.theta)
    size = max(abs(cycle.multipliers[0]), 1e-3)
    turns = min(int(np.ceil(np.log(0.03) / np.log(size))) + 4, 20_000 // cycle.period + 1)
    ends = np.array(map.states.ends)[many.component]
    for radius in REACHES:
        angle = rng.uniform(0, 2 * np.pi, many.size)
        theta = many.theta + radius * np.cos(angle) / speed
        if len(map.states.ends) > 1:
            theta = np.clip(theta, ends[:, 0], ends[:, 1])
        phi = np.clip(many.phi + radius * np.sin(angle), -1.57, 1.57)
        end = advanced(map, Places(many.component, theta, phi), turns * cycle.period)
        distance = tree.query(embedded(map, end.places))[0]
        if np.max(distance) < radius / 10 and not np.any(end.code):
            return radius
    return REACHES[-1]
