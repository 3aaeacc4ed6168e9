"""Lyapunov exponents of many orbits, counted block by block, until their error is small enough.

Particles first run until they are where they end: those that a cycle attracts within its reach. Then growth is
counted in blocks. Particles are sorted by the attractor they reach, before the count and once more after it; nothing
is averaged across attractors. A run can be interrupted: what was counted stays. The paper (appendix A.2) counts with
two vectors, after [DellagoPoschHoover1996]; here one vector and the determinant do.

The angle between the two directions of an orbit: the one its past expands, the one its future contracts.

Dominated splitting [PujalsSambarino2009] keeps the two apart: on a compact set their angle has a positive lower
bound. Where orbits come near a tangency of a stable with an unstable manifold the angle has no such bound, and the
share of points with an angle below `x` falls like `x`. Paper: section 1.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import Attractor, Classified, classify
from numeric.dynamics.phase_points import Array, PhasePoints, advanced
from numeric.dynamics.recognition import Kind, at_cycles
from numeric.dynamics.statistics import Estimate, estimate
from numeric.pinball.sampling import Growth, Starts, interior_starts

Labels = NDArray[np.int64]
MOST = 1024  # blocks kept to an orbit
KEPT = 1 << 22  # numbers kept of each exponent
ALIGNED = 256  # bounces after which a tangent vector has turned to the direction of growth
PATIENCE = 8  # doublings of the wait for particles that are on their way
SINGLE, WATCHED = 1024, 32  # bounces and particles that are watched one by one, for the naive error
HEARD = 50_000_000  # bounces of all particles at a time
CHANGED = "reached another attractor while it was counted"


def nothing(_: float) -> None:
    """Says nothing."""


class Measured(NamedTuple):
    """Both exponents per bounce and their sum, each with its error; `lower` and `total` are None at `lam = 0`.

    `naive` is what the error of `upper` would be if single bounces were independent.
    """

    upper: Estimate | None
    lower: Estimate | None
    total: Estimate | None
    naive: float | None = None

    @property
    def tau(self) -> float | None:
        """The integrated autocorrelation time of the growth of single bounces, by batch means; 1/2 for none."""
        return None if not self.naive or self.upper is None else (self.upper.error / self.naive) ** 2 / 2


class Count:
    """What orbits grew by: blocks along the first axis, particles along the second, per bounce.

    Blocks begin with a single bounce; at `most` of them two become one. So there is an estimate at every moment, and
    a run of any length fits in memory. Of a run that will be `long` bounces, blocks have at once the length that they
    would come to, as far as an interruption is still heard.
    """

    def __init__(self, growth: Growth, most: int = MOST, long: int = 0) -> None:
        self.growth = growth
        self.most = max(2, min(most, KEPT // growth.theta.size // 2 * 2))
        heard = max(1, HEARD // growth.theta.size)
        self.length, self.blocks = 1 << min((long // self.most).bit_length(), heard.bit_length() - 1), 0
        self._rows = np.empty((2, self.most, growth.theta.size))

    @property
    def up(self) -> Array:
        """Growth of the tangent vectors."""
        return self._rows[0, : self.blocks]

    @property
    def volume(self) -> Array:
        """Growth of areas, without the factors `lam`."""
        return self._rows[1, : self.blocks]

    @property
    def bounces(self) -> int:
        """Counted so far, for each particle."""
        return self.length * self.blocks

    def until(self, bounces: int) -> Iterator[int]:
        """Counts on to as many bounces as whole blocks make, and yields their number after each block."""
        while self.bounces + self.length <= bounces:
            stretch, volume = self.growth.stretch, self.growth.volume
            self.growth.advance(self.length)
            self._rows[0, self.blocks] = (self.growth.stretch - stretch) / self.length
            self._rows[1, self.blocks] = (self.growth.volume - volume) / self.length
            self.blocks += 1
            if self.blocks == self.most:
                self._rows[:, : self.most // 2] = (self._rows[:, ::2] + self._rows[:, 1::2]) / 2
                self.blocks, self.length = self.most // 2, 2 * self.length
            yield self.bounces

    def measured(self, members: Labels, blocks: int | None = None) -> Measured:
        """The exponents over some of the particles, from all blocks or from the first few."""
        plus = self.up[:blocks, members]
        total = self.volume[:blocks, members] + self.growth.contraction[members]
        if np.any(np.isneginf(total)):
            return Measured(estimate(plus), None, None)
        minus = total - plus
        if np.mean(plus) < np.mean(minus):
            plus, minus = minus, plus
        return Measured(estimate(plus), estimate(minus), estimate(total))


class Group(NamedTuple):
    """Particles that share an attractor (None: they do not stay on one), and the exponents found along them."""

    kind: str
    attractor: Attractor | None
    members: Labels
    measured: Measured


@dataclass(frozen=True, eq=False)
class Survey:
    """The groups, largest first, with the count they come from and why it ended."""

    groups: tuple[Group, ...]
    count: Count
    transient: int
    ended: str

    @property
    def error(self) -> float:
        """The largest standard error of an exponent off cycles, whose multipliers give theirs."""
        sampled = [g for g in self.groups if g.attractor is None or g.attractor.kind is not Kind.CYCLE]
        return worst(tuple(group.measured for group in sampled))


def worst(measured: tuple[Measured, ...]) -> float:
    """The largest error of an exponent; 0 when there is none to speak of."""
    errors = [x.error for m in measured for x in (m.upper, m.lower) if x is not None]
    return float(np.nanmax([0.0, *errors])) if errors else 0.0


def surveyed(
    map: PinballMap,
    starts: Starts,
    bounces: int,
    transient: int,
    until: float | None = None,
    budget: int = 0,
    say: Callable[[float], None] = nothing,
) -> Survey:
    """The exponents along orbits from `starts`, by attractor. Paper: appendix; figures in sections 4.1 and 5.3.

    With `until` the count goes on, twice as long each time, until every error is at most that, or until `budget`
    bounces, of all particles together, are spent. `say` hears the part of the work that is done.

    >>> from numeric.pinball.sampling import interior_starts
    >>> ellipse = PinballMap("ellipse", a=2, lam="0.5")
    >>> found = surveyed(ellipse, interior_starts(ellipse, 20, seed=1), 1000, 1000)
    >>> [(group.attractor.period, round(group.measured.total.mean, 12)) for group in found.groups]  # log(1/2)
    [(2, -0.69314718056)]
    """
    growth = arrived(map, starts)
    skipped(growth, max(transient - ALIGNED, 0))
    classified = classify(map, growth.theta, growth.phi, growth.component)
    label, waited = _settled(map, growth, classified, max(transient, ALIGNED))
    classified, waited = classified._replace(label=label), waited + max(transient - ALIGNED, 0)
    growth.advance(min(transient, ALIGNED))
    count = Count(growth, long=bounces)
    goal = max(bounces, budget // growth.theta.size) if until is not None else bounces
    ended, target = "bounces", bounces
    cycles = {i for i, a in enumerate(classified.attractors) if a.kind is Kind.CYCLE}  # known from their multipliers
    sampled = [(members, _attractor(classified, i)) for i, members in _sorted(classified.label) if i not in cycles]
    try:
        while True:
            for counted in count.until(target):
                say(counted / goal)
            if until is None:
                break
            if worst(tuple(measured_on(count, *each) for each in sampled)) <= until:
                ended = "error"
                break
            if 2 * target > goal:
                ended = "budget"
                break
            target *= 2
    except KeyboardInterrupt:
        ended = "interrupted"
        if not count.bounces:
            raise
    return Survey(_groups(map, count, classified), count, waited + min(transient, ALIGNED), ended)


def arrived(map: PinballMap, starts: Starts) -> Growth:
    """Particles on their way from their starts; at `lam = 0` from their first landing: the slap map forgets phi."""
    if map.law == "slap":
        landed = map.step(starts.theta, starts.phi, starts.component)
        return Growth(map, landed.theta, 0.0 * landed.phi, landed.component)
    return Growth(map, starts.theta, starts.phi, starts.component)


def skipped(growth: Growth, bounces: int) -> None:
    """Moves particles on uncounted, a second's work at a time, so that an interruption is heard."""
    piece = max(1, HEARD // growth.theta.size)
    for done in range(0, bounces, piece):
        growth.skip(min(piece, bounces - done))


def _settled(map: PinballMap, growth: Growth, classified: Classified, wait: int) -> tuple[Labels, int]:
    """The cycle within whose reach each particle is, else what it was classified as, and how long was waited for that.

    After a long chaotic transient rounding decides which of several cycles a particle reaches; where it is counts.
    """
    waited = 0
    cyclic = np.isin(classified.label, [i for i, a in enumerate(classified.attractors) if a.kind is Kind.CYCLE])
    caught = _caught(map, growth, classified)
    for _ in range(PATIENCE):
        if np.all(caught[cyclic] >= 0):
            break
        skipped(growth, wait)
        waited, wait = waited + wait, 2 * wait
        caught = _caught(map, growth, classified)
    return np.where(caught >= 0, caught, classified.label), waited


def _caught(map: PinballMap, growth: Growth, classified: Classified) -> Labels:
    return at_cycles(map, PhasePoints(growth.component, growth.theta, growth.phi), classified.attractors)


def _sorted(label: Labels) -> list[tuple[int, Labels]]:
    return [(int(index), np.nonzero(label == index)[0]) for index in np.unique(label)]


def _groups(map: PinballMap, count: Count, classified: Classified) -> tuple[Group, ...]:
    """The particles sorted once more: one that is on a cycle now, and was not to reach it, changed on the way."""
    caught = _caught(map, count.growth, classified)
    cycle = np.array([a.kind is Kind.CYCLE for a in classified.attractors] + [False])
    changed = (caught != classified.label) & (cycle[caught] | cycle[classified.label]) & (count.growth.code == 0)
    stopped = count.growth.code > 0
    groups = []
    for index, members in _sorted(np.where(changed, -2, np.where(stopped, -3, classified.label))):
        attractor = _attractor(classified, index)
        found = measured_on(count, members, attractor)
        if attractor is not None and attractor.kind is Kind.CHAOTIC:
            found = _remembering(map, count, members, found)
        groups.append(Group(_kind(index, attractor), attractor, members, found))
    return tuple(sorted(groups, key=lambda group: -group.members.size))


def measured_on(count: Count, members: Labels, attractor: Attractor | None, blocks: int | None = None) -> Measured:
    """The exponents over the particles of an attractor, from all blocks or from the first few.

    Where vectors grow like a power of the time, `log(n)/n` is left of an exponent that is 0: the value is in its error.

    >>> from numeric.pinball.sampling import interior_starts
    >>> circle = PinballMap("circle", lam=1)
    >>> upper = surveyed(circle, interior_starts(circle, 4, seed=1), 256, 100).groups[0].measured.upper
    >>> 0 < upper.mean <= upper.error
    True
    """
    found = count.measured(members, blocks)
    if attractor is None or attractor.kind is not Kind.NEUTRAL or found.upper is None:
        return found
    left = abs(found.upper.mean)
    upper, lower = replace(found.upper, error=max(found.upper.error, left)), found.lower
    if lower is not None and found.total is not None:  # the sum less the upper one
        lower = replace(lower, error=max(lower.error, left + np.nan_to_num(found.total.error)))
    return found._replace(upper=upper, lower=lower)


def _attractor(classified: Classified, index: int) -> Attractor | None:
    return classified.attractors[index] if index >= 0 else None


def _kind(index: int, attractor: Attractor | None) -> str:
    if attractor is None:
        return {-2: CHANGED, -3: "stopped: the map is undefined there"}.get(index, "unsettled")
    if attractor.kind is Kind.CYCLE:
        theta, phi = attractor.points.theta[0], attractor.points.phi[0]
        return f"cycle of period {attractor.period} through ({theta:.4f}, {phi + 0.0:.4f})"
    if attractor.kind is Kind.STOPPED:
        return f"stopped: {attractor.status.name.lower()}"
    return attractor.kind.name.lower()


def _remembering(map: PinballMap, count: Count, members: Labels, found: Measured) -> Measured:
    """With the naive error, from the growth of single bounces of a few particles."""
    few, end = members[:WATCHED], count.growth
    watched = Growth(map.at(end.lam[few]), end.theta[few], end.phi[few], end.component[few])
    watched.advance(ALIGNED)
    track = np.empty((SINGLE + 1, few.size))
    track[0] = watched.stretch
    for bounce in range(1, SINGLE + 1):
        watched.advance(1)
        track[bounce] = watched.stretch
    steps = np.diff(track, axis=0)[:, watched.code == 0]
    if steps.size == 0:
        return found
    naive = float(np.std(steps) / np.sqrt(count.bounces * members.size))
    return found._replace(naive=naive)


SETTLING = 60  # bounces in which a vector turns to its direction


def angles(map: PinballMap, particles: PhasePoints, bounces: int, transient: int = 1000) -> Array:
    """The angle in `(s, phi)`, in radians from 0 to pi/2, at `bounces` points of every particle's orbit.

    >>> from numeric.dynamics.phase_points import phase_points
    >>> measured = angles(PinballMap("cuspless", lam="0.5"), phase_points([0.5, 0.7], 0.1), 50)
    >>> measured.size, bool(np.min(measured) > 0.3)
    (100, True)
    """
    begin = advanced(map, particles, transient).points
    steps = bounces + 2 * SETTLING
    orbit = map.orbit(begin.theta, begin.phi, steps, begin.component)
    slopes = map.derivative(orbit.theta[:-1], orbit.phi[:-1], orbit.component[:-1])
    expanded = _carried(slopes, np.array([0.6, 0.8]))
    contracted = _carried(_adjugate(slopes[::-1]), np.array([0.8, -0.6]))[::-1]
    e, f = expanded[SETTLING : SETTLING + bounces], contracted[SETTLING : SETTLING + bounces]
    sine = np.abs(e[..., 0] * f[..., 1] - e[..., 1] * f[..., 0])
    return np.asarray(elementary.arcsin(np.minimum(sine, 1.0))).ravel()


def _adjugate(slope: Array) -> Array:
    """The inverse matrices up to a factor, which turns no direction. LAPACK's last bit depends on the processor."""
    (a, b), (c, d) = np.moveaxis(slope, (-2, -1), (0, 1))
    return np.moveaxis(np.array([[d, -b], [-c, a]]), (0, 1), (-2, -1))


def _carried(slopes: Array, vector: Array) -> Array:
    """The unit vector before each step, of each particle; matrices by step and particle."""
    here = np.broadcast_to(vector, (slopes[0].shape[0], 2))
    rows = [here]
    for slope in slopes:
        here = np.einsum("nij,nj->ni", slope, here)
        here = here / np.linalg.norm(here, axis=1, keepdims=True)
        rows.append(here)
    return np.array(rows)


def slopes(map: PinballMap, count: int, seed: int, bounces: int = 600) -> tuple[Array, Array, Array]:
    """Arc length, exit angle and the slope `dphi/ds` of the expanded direction, at points of random orbits."""
    starts = interior_starts(map, count, seed)
    begin = advanced(map, PhasePoints(*starts[:3]), 1000).points
    orbit = map.orbit(begin.theta, begin.phi, bounces, begin.component)
    matrices = map.derivative(orbit.theta[:-1], orbit.phi[:-1], orbit.component[:-1])
    along = _carried(matrices, np.array([0.6, 0.8]))[SETTLING:]
    half = map.arclength.perimeter / 2
    s = np.remainder(map.arclength.s(orbit.theta[SETTLING:], orbit.component[SETTLING:]) + half, 2 * half) - half
    return s.ravel(), orbit.phi[SETTLING:].ravel(), (along[..., 1] / along[..., 0]).ravel()


def jump(s: Array, phi: Array, slope: Array, place: float, width: float = 0.01, near: float = 0.003) -> float:
    """The median difference of slopes right and left of a place of the boundary, at nearly equal exit angles.

    >>> s, phi = np.array([-0.001, 0.001]), np.zeros(2)
    >>> jump(s, phi, np.array([1.0, 3.0]), 0.0)
    2.0
    """
    left, right = (s > place - width) & (s < place), (s > place) & (s < place + width)
    if not np.any(left) or not np.any(right):
        return float("nan")
    order = np.argsort(phi[right])
    at = np.clip(np.searchsorted(phi[right][order], phi[left]), 0, order.size - 1)
    close = np.abs(phi[right][order][at] - phi[left]) < near
    return float(np.median((slope[right][order][at] - slope[left])[close])) if np.any(close) else float("nan")
