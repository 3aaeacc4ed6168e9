"""Recognising attractors: the cycle that a ball is at, the cloud it lies in, the new cycle it is on."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from numeric import PinballMap
from numeric.dynamics.cycles import Cycle, multipliers, polished
from numeric.dynamics.kinds import Attractor, Kind
from numeric.dynamics.phase_points import Array, Places, advanced, embedded, together

UNSETTLED = -1
LONGEST = 256  # period that is looked for
RETURN, LOOSE = 1e-9, 1e-2  # of a ball to where it was: it is on a cycle; it may be near one
REACHES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # radii tried for a cycle's neighbourhood
SAME = 1e-6  # between cycles
UNIT = 1e-7  # how near 1 a multiplier is that counts as 1
NEAR = 0.1  # of a cloud
Labels = NDArray[np.int64]


def same(map: PinballMap, old: Attractor, new: Attractor) -> bool:
    """Are two the same cycle, the same neutral family, the same way to stop?"""
    if (old.kind, old.period, old.status) != (new.kind, new.period, new.status):
        return False
    if old.kind is not Kind.CYCLE:
        return old.kind is not Kind.CHAOTIC
    first = embedded(map, new.points.only(slice(0, 1)))
    return bool(np.min(np.linalg.norm(embedded(map, old.points) - first, axis=1)) < SAME)


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
    return np.where(distance < NEAR, owner[nearest], UNSETTLED)


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
    new = Attractor(Kind.CYCLE, cycle.period, cycle.points, cycle.multipliers, *cycle.exponents)
    return replace(new, reach=reach(map, cycle))


def reach(map: PinballMap, cycle: Cycle, seed: int = 0) -> float:
    """The largest radius tried such that balls that far from the cycle all come ten times nearer: sampled.

    >>> from numeric.dynamics.phase_points import places
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
