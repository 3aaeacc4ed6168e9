"""The sets on which random starts end at many values of a parameter: cycles, chaos, neutral orbits, corners.

Every start runs at the kernel's own speed, so that hundreds of starts at hundreds of values take seconds. A cycle is
identified by its period and by `MARKS` numbers that are the same for its images under the symmetries of the table:
means of distances between bounces. A start that ends on no cycle is chaotic if its exponent is above `calm`, else
neutral. Where areas shrink slowly, a long chaotic transient may end on a cycle; so an orbit counts as chaotic only
after areas have shrunk by the factor `exp(-LASTING)`.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.attractors import calm
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, phase_points
from numeric.dynamics.recognition import LOOSE, RETURN, Kind
from numeric.sweeps.space import returns
from numeric.sweeps.sweep import spread_over

LONGEST = 128  # longest period that is recognised
MARKS = 5
UNIT = 1e-6  # distance from 1 of a multiplier that counts as 1
SPIRAL = 1e3  # times the nearest return: a particle that spirals in comes back to itself better later on
TOGETHER = 10_000  # particles that run at once
STAGES = ((200, 400), (2000, 2000), (6000, 2000), (30_000, 2000), (100_000, 20_000))  # left out; of the exponent
LASTING = 100  # of the logarithm of the area: chaos that lasts so long is taken for an attractor
NOISE = 5  # of that logarithm, which is that of a start and an end
CYCLE, CHAOTIC, NEUTRAL, STOPPED, UNSETTLED = range(5)  # in the order of `Kind`, and one more


@dataclass(frozen=True, eq=False)
class Endings:
    """Where all starts end at one value of the parameter: arrays with one entry for each start."""

    value: float
    kind: Labels
    period: Labels
    marks: Array
    gap: Array
    points: PhasePoints

    @property
    def starts(self) -> int:
        """The number of starts."""
        return int(self.kind.size)

    def count(self, kind: Kind) -> int:
        """The number of starts that end on this kind of set."""
        return int(np.sum(self.kind == list(Kind).index(kind)))


def endings(
    scene: str,
    parameter: str,
    values: Array,
    lam: float,
    starts: int,
    seed: int,
    heard: Callable[[], None] = lambda: None,
    stages: int = len(STAGES),
) -> list[Endings]:
    """Where `starts` random starts end, for each value of the parameter; `lam` is the contraction if it does not vary.

    `heard` is called before each run of the particles, and may end the work with an exception. With fewer `stages`,
    some chaotic and slow starts stay unsettled.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.sweep import text_of
    >>> (found,) = endings(text_of(Scene("ellipse", a=2)), "lam", np.array([0.5]), 1.0, starts=10, seed=1)
    >>> found.count(Kind.CYCLE), np.unique(found.period).tolist()
    (10, [2])
    """
    found: list[Endings] = []
    each = max(1, TOGETHER // starts)
    for first in range(0, len(values), each):
        some = np.asarray(values[first : first + each], dtype=float)
        for _, map, begun in spread_over(scene, parameter, some, lam, starts, seed + first):
            kind, period, marks, gap, points = _of(map, begun.theta, begun.phi, begun.component, heard, stages)
            at = np.arange(kind.size).reshape(-1, starts)
            own = some if parameter == "lam" else some[len(found) - first :][:1]
            for value, rows in zip(own, at, strict=True):
                row = kind[rows], period[rows], marks[rows], gap[rows], points.only(rows)
                found.append(Endings(float(value), *row))
    return found


def _of(
    map: PinballMap, theta: Array, phi: Array, component: Labels, heard: Callable[[], None], stages: int
) -> tuple[Labels, Labels, Array, Array, PhasePoints]:
    """Kind, period, marks and gap of each particle, and its last phase point.

    Particles that approach a cycle slowly are followed for longer.
    """
    points = phase_points(theta, np.zeros_like(theta) if map.law == "slap" else phi, component)
    size = points.size
    kind, period = np.full(size, UNSETTLED), np.zeros(size, dtype=np.int64)
    marks, gap, growth, area = np.zeros((size, MARKS)), np.full(size, np.inf), np.zeros(size), np.zeros(size)
    going, limit, before = np.arange(size), np.inf, 0
    for transient, bounces in STAGES[:stages]:
        heard()
        here = _at(map, going)
        end = here.exponents(points.theta[going], points.phi[going], bounces, transient, points.component[going])
        new = end.component, end.theta, end.phi, end.nu_plus, end.nu_plus + end.nu_minus
        for rows, row in zip((*points, growth, area), new, strict=True):
            rows[going] = row
        kind[going[end.code > 0]] = STOPPED
        going, limit, before = going[end.code == 0], calm(bounces), before + transient + bounces
        here, nu = _at(map, going), growth[going]
        period[going], marks[going], gap[going] = _returns(here, points.only(going), nu < 0)
        neutral = (gap[going] < RETURN) & (nu > -limit)  # a larger growth belongs to the approach
        if np.any(neutral):
            trace, det = returns(_at(map, going[neutral]), points.only(going[neutral]), period[going[neutral]])
            neutral[neutral] = np.abs(1 - trace + det) < UNIT  # of a family, that attracts nothing
        _, group = np.unique(np.broadcast_to(map.lam, size)[going], return_inverse=True)
        mean = (np.bincount(group, area[going]) / np.bincount(group))[group]  # of starts at one contraction
        lasts = (-mean * before > LASTING) | ((bounces == STAGES[-1][1]) & (mean > -NOISE / bounces))
        chaos = (period[going] == 0) & (nu > limit) & lasts & (before > STAGES[1][0])
        kind[going] = np.select([neutral, chaos, period[going] > 0], [NEUTRAL, CHAOTIC, CYCLE], UNSETTLED)
        going = going[(kind[going] == UNSETTLED) | ((kind[going] == CYCLE) & (gap[going] > RETURN))]
        if not going.size:
            break
    slow = (area < -limit) & (growth < area / 4)  # a growth that is half of that of areas is a cycle's
    kind[(kind == UNSETTLED) & (np.abs(growth) < limit) & ~slow] = NEUTRAL
    return kind, period, marks, gap, points


def _at(map: PinballMap, which: Labels) -> PinballMap:
    """The map at the contractions of some particles."""
    lam = np.asarray(map.lam, dtype=float)
    return map if lam.ndim == 0 else map.at(lam[which])


def _returns(map: PinballMap, points: PhasePoints, drawn: NDArray[np.bool_]) -> tuple[Labels, Array, Array]:
    """The number of bounces after which each particle returns, the marks of its cycle, and the distance at the return.

    A larger distance is accepted for particles in the mask `drawn`, which still approach their cycle.
    """
    orbit = map.orbit(points.theta, points.phi, LONGEST + 1, points.component)
    bad = np.any(orbit.code != 0, axis=0)
    place = np.stack([orbit.x, orbit.y])
    track = np.concatenate([place / map.states.size, np.sin(orbit.phi)[None]])
    gaps = np.linalg.norm(track[:, 1 : LONGEST + 1] - track[:, :1], axis=0)
    gaps[:, bad] = np.inf
    nearest = np.min(gaps, axis=0)
    period = np.argmax((gaps < RETURN) | (gaps <= SPIRAL * nearest), axis=0) + 1
    gap = np.take_along_axis(gaps, period[None] - 1, axis=0)[0]
    period[(gap > LOOSE) | ((gap > RETURN) & ~drawn)] = 0
    return period, marks_of(place, period), gap


def marks_of(place: Array, period: Labels | None = None) -> Array:
    """Numbers that identify cycles, one row for each: mean distances of bounces, equal for images under a symmetry.

    `place` has x and y along the first axis, bounces along the second one and cycles along the third; without a
    `period` each cycle closes after its last bounce.
    """
    if period is None:
        once, twice = (np.linalg.norm(np.roll(place, -k, axis=1) - place, axis=0) for k in (1, 2))
        after = np.roll(once, -1, axis=0)
    else:
        once = np.linalg.norm(place[:, 1:] - place[:, :-1], axis=0)
        after, twice = once[1:], np.linalg.norm(place[:, 2:] - place[:, :-2], axis=0)
        once = once[:-1]
    sums = np.cumsum([once, once**2, twice, twice**2, once * after], axis=1)
    last = np.full(place.shape[2], place.shape[1]) if period is None else np.maximum(period, 1)
    means = np.take_along_axis(sums, last[None, None, :] - 1, axis=1)[:, 0].T / last[:, None]
    means[:, [1, 3, 4]] = np.sqrt(means[:, [1, 3, 4]])  # all of them lengths
    return np.asarray(means)
