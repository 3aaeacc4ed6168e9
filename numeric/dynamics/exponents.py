"""Lyapunov exponents of many orbits, counted block by block, until their error is small enough.

Particles first run until each one that a cycle attracts is near that cycle. Then growth is counted in blocks. Particles
are grouped by the attractor they reach, before the count and once more after it; nothing is averaged across
attractors. When a run is interrupted, the blocks counted so far are kept.

`angles` measures the angle between the two directions of an orbit: the one that its past expands and the one that its
future contracts. Where there is a dominated splitting [PujalsSambarino2009] on a compact set this angle has a positive
lower bound; where orbits come near a tangency of a stable with an unstable manifold the angle has no such bound, and
the share of points with an angle below `x` falls like `x`. Paper: section 1.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import Attractor, Classified, classify, with_images
from numeric.dynamics.estimator import Count, ExponentEstimates, arrived, measured_on, skipped
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, advanced
from numeric.dynamics.recognition import Kind, at_cycles
from numeric.pinball.sampling import ALIGNED, Growth, Starts, interior_starts

PATIENCE = 8  # doublings of the wait for particles that have not reached their cycle yet
SINGLE, WATCHED = 1024, 32  # bounces and particles that are watched one by one, for the naive error
CHANGED = "reached another attractor while it was counted"


def nothing(_: float) -> None:
    """A progress callback that does nothing."""


class Group(NamedTuple):
    """The indices of particles that share an attractor, and their exponents; `attractor` is None if they do not stay on
    one.
    """

    kind: str
    attractor: Attractor | None
    members: Labels
    measured: ExponentEstimates


@dataclass(frozen=True, eq=False)
class Survey:
    """The groups of particles, largest first, and the `count` from which their exponents come.

    `transient` is the number of bounces before the count, and `ended` says why the count ended.
    """

    groups: tuple[Group, ...]
    count: Count
    transient: int
    ended: str

    @property
    def error(self) -> float:
        """The largest standard error of an exponent, except those of cycles, which come from their multipliers."""
        sampled = [g for g in self.groups if g.attractor is None or g.attractor.kind is not Kind.CYCLE]
        return worst(tuple(group.measured for group in sampled))


def worst(measured: tuple[ExponentEstimates, ...]) -> float:
    """The largest error of an exponent; 0 when there is none."""
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

    With `until`, the count goes on, twice as long each time, until every error is at most `until`, or until `budget`
    bounces, of all particles together, are made. `say` is called with the fraction of the work that is done.

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
    growth.settle(ALIGNED)
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
    return Survey(_groups(map, count, classified), count, waited + ALIGNED, ended)


def with_families(map: PinballMap, survey: Survey) -> Survey:
    """The survey, with one family number for attractors that are symmetry images of each other."""
    found = [group.attractor for group in survey.groups if group.attractor is not None]
    if len(found) < 2:
        return survey
    joined = iter(with_images(map, found))
    groups = [one if one.attractor is None else one._replace(attractor=next(joined)) for one in survey.groups]
    return replace(survey, groups=tuple(groups))


def _settled(map: PinballMap, growth: Growth, classified: Classified, wait: int) -> tuple[Labels, int]:
    """The label of each particle: the cycle that it has reached, or else its class; and the number of bounces made.

    After a long chaotic transient rounding decides which of several cycles a particle reaches. So the label tells where
    the particle is now, not where the classification found it.
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
    """The groups of particles after the count. Those now on another cycle than their label's form one more group."""
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


def _remembering(map: PinballMap, count: Count, members: Labels, found: ExponentEstimates) -> ExponentEstimates:
    """`found` completed by its naive error, as if bounces were independent, from single bounces of a few particles."""
    few, end = members[:WATCHED], count.growth
    watched = Growth(map.at(end.lam[few]), end.theta[few], end.phi[few], end.component[few])
    watched.settle(ALIGNED)
    track = watched.advance_blocks([1] * SINGLE)[0]
    steps = np.diff(track, axis=0)[:, watched.code == 0]
    if steps.size == 0:
        return found
    naive = float(np.std(steps) / np.sqrt(count.bounces * members.size))
    return found._replace(naive=naive)


SETTLING = 60  # bounces in which a vector turns to its direction


def angles(map: PinballMap, particles: PhasePoints, bounces: int, transient: int = 1000) -> Array:
    """The angles, up to pi/2, between the expanding and contracting directions in `(s, phi)` along every orbit.

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
    """The adjugates, inverses up to a factor; without LAPACK, whose last bit depends on the processor."""
    (a, b), (c, d) = np.moveaxis(slope, (-2, -1), (0, 1))
    return np.moveaxis(np.array([[d, -b], [-c, a]]), (0, 1), (-2, -1))


def _carried(slopes: Array, vector: Array) -> Array:
    """The images of a vector along each orbit under the matrices `slopes`, normalised: at the start and after each
    step.
    """
    here = np.broadcast_to(vector, (slopes[0].shape[0], 2))
    rows = [here]
    for slope in slopes:
        here = np.einsum("nij,nj->ni", slope, here)
        here = here / np.linalg.norm(here, axis=1, keepdims=True)
        rows.append(here)
    return np.array(rows)


def slopes(map: PinballMap, count: int, seed: int, bounces: int = 600) -> tuple[Array, Array, Array]:
    """The arc length, the exit angle, and the slope `dphi/ds` of the expanded direction, at points of random orbits."""
    starts = interior_starts(map, count, seed)
    begin = advanced(map, PhasePoints(*starts[:3]), 1000).points
    orbit = map.orbit(begin.theta, begin.phi, bounces, begin.component)
    matrices = map.derivative(orbit.theta[:-1], orbit.phi[:-1], orbit.component[:-1])
    along = _carried(matrices, np.array([0.6, 0.8]))[SETTLING:]
    half = map.arclength.perimeter / 2
    s = np.remainder(map.arclength.s(orbit.theta[SETTLING:], orbit.component[SETTLING:]) + half, 2 * half) - half
    return s.ravel(), orbit.phi[SETTLING:].ravel(), (along[..., 1] / along[..., 0]).ravel()


def jump(s: Array, phi: Array, slope: Array, place: float, width: float = 0.01, near: float = 0.003) -> float:
    """The median difference of slopes right and left of the boundary point `place`, at nearly equal exit angles.

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
