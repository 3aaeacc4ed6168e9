"""The attractors of a map: found from many starts, distinguished, and joined to families under the table's symmetries.

A cycle is refined by Newton's method (`numeric.dynamics.recognition`); further particles near it are counted as on it.
Particles that reach no cycle, and around which vectors grow exponentially, are taken to be on a chaotic set once none
of them joins a cycle during a whole run. Their orbits are then divided into sets (`numeric.dynamics.chaotic_sets`). If
some still join cycles in the last run, the others remain unsettled.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.chaotic_sets import gathered
from numeric.dynamics.estimator import Count, measured_on
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, phase_points
from numeric.dynamics.recognition import (
    NEAR,
    UNSETTLED,
    Attractor,
    Kind,
    Share,
    at_clouds,
    at_cycles,
    majority,
    on_clouds,
    recognised,
    same,
    spacing,
    wilson,
)
from numeric.dynamics.symmetries import moved, name, symmetries_of
from numeric.pinball.sampling import ALIGNED, Growth, interior_starts
from numeric.pinball.states import STATUSES

if TYPE_CHECKING:
    from numeric.lowering.program import TableSymmetry


def with_images(map: PinballMap, attractors: Sequence[Attractor]) -> list[Attractor]:
    """The attractors with their families and stabilisers under the table's symmetries; missing images come last."""
    group = symmetries_of(map)
    found = [replace(a, family=-1) for a in attractors]
    at = families = 0
    while at < len(found):
        if found[at].family < 0:
            _join(map, found, at, families, group)
            families += 1
        at += 1
    return found


def _join(map: PinballMap, found: list[Attractor], at: int, family: int, group: "Sequence[TableSymmetry]") -> None:
    """Gives an attractor and its images in `found` one family number, and the name of their symmetry group."""
    attractor = found[at]
    own = []
    for symmetry in group:
        index = image_of(map, found, attractor, symmetry)
        if index == at:
            own.append(symmetry)
        found[index] = replace(found[index], family=family)
    for index, member in enumerate(found):
        if member.family == family:
            found[index] = replace(member, symmetry=name(own))


def image_of(map: PinballMap, found: list[Attractor], attractor: Attractor, symmetry: "TableSymmetry") -> int:
    """The index of the attractor's image in the list `found`; a missing image is appended."""
    image = replace(attractor, points=moved(symmetry, attractor.points), share=None)
    index = _index(map, found, image)
    if index == len(found):
        found.append(image)
    return index


def _index(map: PinballMap, found: list[Attractor], image: Attractor) -> int:
    """The index of an image in the list; the list's length when it is not there."""
    if image.kind is Kind.CHAOTIC:
        owner = majority(at_clouds(map, image.points, found)[None])[0]
        return int(owner) if owner != UNSETTLED else len(found)
    for index, attractor in enumerate(found):
        if same(map, attractor, image):
            return index
    return len(found)


__all__ = ["UNSETTLED", "Attractor", "Classified", "Kind", "Share", "classify", "find", "wilson"]
SAMPLE = 64  # particles among which new cycles are searched for
ROUNDS = 6
WATCHED = 100_000  # bounces, of all particles together, in which none leaves a chaotic attractor
CHANCE = 1e-6  # probability of a difference between images, below which they are doubted
LEAST = 5  # starts of each, for chi square
ROUNDED = 1e-9  # smallest error of an exponent, for its rounding
MEASURED, BLOCKS = 64, 128  # particles whose exponents are averaged, and blocks of each at most


class Classified(NamedTuple):
    """The attractors, and for each particle the index of its attractor in `label`, -1 where it did not settle."""

    label: Labels
    attractors: tuple[Attractor, ...]


def classify(
    map: PinballMap,
    theta: ArrayLike,
    phi: ArrayLike,
    component: ArrayLike = 0,
    transient: int = 1000,
    known: Sequence[Attractor] = (),
    rounds: int = ROUNDS,
) -> Classified:
    """The attractor that each particle reaches. Attractors already `known` keep their index; new ones follow.

    >>> ellipse = PinballMap("ellipse", a=2, lam="0.5")
    >>> found = classify(ellipse, [0.1, 1.0, 2.0], 0.2)
    >>> found.label.tolist(), [(a.kind.name, a.period) for a in found.attractors]
    ([0, 0, 0], [('CYCLE', 2)])
    """
    return _Sorting(map, phase_points(theta, phi, component), list(known)).sorted(transient, rounds)


@dataclass
class _Sorting:
    """Particles that are followed to their attractors; those in `going` have no label yet."""

    map: PinballMap
    particles: PhasePoints
    attractors: list[Attractor]
    label: Labels = field(init=False)
    going: Labels = field(init=False)
    growth: Array = field(init=False)
    dropped: set[int] = field(default_factory=set)  # indices of attractors that are the same as an earlier one
    known: int = field(init=False)  # how many attractors there were before

    def __post_init__(self) -> None:
        self.known = len(self.attractors)
        self.label = np.full(self.particles.size, UNSETTLED)
        self.going = np.arange(self.particles.size)

    def sorted(self, transient: int, rounds: int) -> Classified:
        """Classifies all particles: runs them, each time twice as long, until a run in which none joins a cycle."""
        self._advance(transient)
        if self.map.law == "elastic":
            self._conserved(transient)
        self._catch()
        bounces, leaving = transient, True
        for turn in range(rounds):
            bounces, before = transient << turn, self.going.size
            if before == 0:
                break
            self._advance(bounces)
            self._catch()
            leaving = self.going.size < before
            if not leaving and before * bounces >= WATCHED and np.all(self.growth > calm(bounces)):
                break
        if not leaving:
            self._spread(bounces)
        return self._result()

    def _advance(self, bounces: int) -> None:
        """Advances the particles in `going`, stores the growth rates of vectors, and labels the particles that stop."""
        here = self.particles.only(self.going)
        end = self.map.exponents(here.theta, here.phi, bounces, 0, here.component)
        for rows, new in zip(self.particles, (end.component, end.theta, end.phi), strict=True):
            rows[self.going] = new
        for code in np.unique(end.code[end.code > 0]):
            at = end.code == code
            status = STATUSES[code]
            index = self._entered(Attractor(Kind.STOPPED, 0, here.only(at).only(slice(0, 1)), status=status))
            self.label[self.going[at]] = index
        self._keep(end.code == 0, end.nu_plus)

    def _keep(self, which: NDArray[np.bool_], growth: Array) -> None:
        self.going, self.growth = self.going[which], growth[which]

    def _entered(self, new: Attractor) -> int:
        """The index in the list of the attractor that equals `new`; `new` is appended if there is no such attractor."""
        for index, old in enumerate(self.attractors):
            if same(self.map, old, new):
                return index
        self.attractors.append(new)
        return len(self.attractors) - 1

    def _catch(self) -> None:
        """Labels the particles near a known cycle, and looks for new cycles near the others."""
        while self.going.size:
            caught = at_cycles(self.map, self.particles.only(self.going), self.attractors)
            self.label[self.going] = caught
            self._keep(caught == UNSETTLED, self.growth)
            known, calm = len(self.attractors), np.argsort(self.growth)[:SAMPLE]
            for cycle in recognised(self.map, self.particles.only(self.going[calm]), self.growth[calm] < 0):
                self._entered(cycle)
            if len(self.attractors) == known:
                break

    def _conserved(self, bounces: int) -> None:
        """At `lam = 1`, labels as neutral the particles around which vectors grow no faster than a power of time."""
        regular = self.growth < calm(bounces)
        if np.any(regular):
            points = self.particles.only(self.going[regular])
            self.label[self.going[regular]] = self._entered(Attractor(Kind.NEUTRAL, 0, points))
            self._keep(~regular, self.growth)

    def _spread(self, bounces: int) -> None:
        """Labels the particles around which vectors grow exponentially, by chaotic attractors near them or new ones."""
        stay = self.going.size * bounces / 3
        self._keep(self.growth > calm(bounces), self.growth)
        while self.going.size:
            near = on_clouds(self.map, self.particles.only(self.going), self.attractors)
            self.label[self.going] = near
            self._keep(near == UNSETTLED, self.growth)
            if self.going.size:
                self._gather(stay)

    def _gather(self, stay: float) -> None:
        """Divides a few orbits into chaotic sets, adds new sets with this `stay`, and labels their particles."""
        spread = [i for i, a in enumerate(self.attractors) if a.kind is Kind.CHAOTIC]
        particles = self.particles.only(self.going)
        found = gathered(self.map, particles, [self.attractors[i].points for i in spread])
        for place, (points, doubt) in enumerate(zip(found.sets, found.doubts, strict=True)):
            if place == len(spread):
                spread.append(len(self.attractors))
                self.attractors.append(Attractor(Kind.CHAOTIC, 0, points, stay=stay))
            old = self.attractors[spread[place]]
            reach = NEAR if doubt else spacing(self.map, points)
            self.attractors[spread[place]] = replace(old, points=points, reach=reach, doubt=doubt or old.doubt)
        for place, first in enumerate(found.known):
            self.label[self.label == spread[place]] = spread[first]
            if first != place:
                self.dropped.add(spread[place])
        left = ~np.isin(np.arange(particles.size), found.looked)
        doubtful = [i for i, doubt in zip(spread, found.doubts, strict=True) if doubt]
        if doubtful and self.map.law == "elastic":  # it may be all that spreads
            self.label[self.going[left]] = doubtful[0]
            left = np.zeros_like(left)
        self.label[self.going[found.looked]] = np.array(spread)[found.member]
        self._keep(left, self.growth)

    def _result(self) -> Classified:
        """The classification, without attractors that turned out to be the same as an earlier one."""
        kept = [i for i in range(len(self.attractors)) if i not in self.dropped or i < self.known]
        place = np.full(len(self.attractors) + 1, UNSETTLED)
        place[kept] = np.arange(len(kept))
        return Classified(place[self.label], tuple(self.attractors[i] for i in kept))


def calm(bounces: int) -> float:
    """An upper bound of the exponents measured over `bounces` bounces where vectors grow like a power of time.

    >>> round(calm(1000), 4)
    0.0207
    """
    return float(3 * elementary.log(bounces + 1) / bounces)


def find(
    map: PinballMap,
    orbits: int,
    seed: int,
    transient: int = 1000,
    bounces: int = 4000,
    known: Sequence[Attractor] = (),
    images: bool = False,
) -> tuple[Attractor, ...]:
    """The attractors that random starts reach, the most visited first, each with the share of starts it attracts.

    Starts are those of the paper's appendix. With `images` the attractors' images under the table's symmetries belong
    to the result, also those that no start has reached: their share is 0 out of `orbits`.

    >>> found = find(PinballMap("egg", alpha="0.08", lam="0.7"), 200, seed=1, images=True)
    >>> [(a.kind.name, a.period, a.symmetry, a.family) for a in found]
    [('CYCLE', 3, 'C3', 0), ('CYCLE', 3, 'C3', 0)]
    """
    starts = interior_starts(map, orbits, seed)
    phi = np.zeros(orbits) if map.law == "slap" else starts.phi  # then every exit is along the normal
    label, attractors = classify(map, starts.theta, phi, starts.component, transient, known)
    found = [
        replace(measured(map, attractor, bounces), share=wilson(int(np.sum(label == i)), orbits))
        for i, attractor in enumerate(attractors)
    ]
    if images:
        found = [a if a.share else replace(a, share=wilson(0, orbits)) for a in with_images(map, found)]
        found = [replace(a, doubt=a.doubt or disagreement(a, found)) for a in found]
    found.sort(key=lambda a: -a.share.count if a.share else 0)
    order = list(dict.fromkeys(a.family for a in found))
    return tuple(replace(a, family=order.index(a.family)) for a in found)


def disagreement(one: Attractor, found: Sequence[Attractor]) -> str:
    """Reason to doubt that a chaotic attractor and its images are distinguished correctly; empty if none.

    Images have equal exponents and equal shares of the starts, which is tested by chi square.

    >>> sets = [Attractor(Kind.CHAOTIC, 0, phase_points(0.0, 0.0), share=wilson(k, 140), family=0) for k in (103, 37)]
    >>> disagreement(sets[0], sets)
    'images of it under the symmetries attract 103, 37 starts, which should be alike'
    """
    images = [a for a in found if a.family == one.family and a.share is not None]
    if one.kind is not Kind.CHAOTIC or len(images) < 2:
        return ""
    from scipy.special import chdtrc

    counts = np.array([a.share.count for a in images if a.share])
    mean = np.mean(counts)
    if mean >= LEAST and chdtrc(counts.size - 1, np.sum((counts - mean) ** 2) / mean) < CHANCE:
        many = ", ".join(str(count) for count in counts)
        return f"images of it under the symmetries attract {many} starts, which should be alike"
    nu, error = (np.array(list(each)) for each in zip(*((a.nu_plus, a.errors[0]) for a in images), strict=True))
    weight = 1 / np.maximum(error, ROUNDED) ** 2
    away = np.sum(weight * (nu - np.sum(weight * nu) / np.sum(weight)) ** 2)
    if chdtrc(nu.size - 1, away) < CHANCE:
        return f"exponents of its images, from {nu.min():.6g} to {nu.max():.6g}, differ by more than their errors"
    return ""


def measured(map: PinballMap, attractor: Attractor, bounces: int) -> Attractor:
    """The attractor; a chaotic one with exponents and errors from `MEASURED` particles over `bounces` bounces."""
    if attractor.kind is not Kind.CHAOTIC:
        return attractor
    points = attractor.points
    some = points.only(np.linspace(0, points.size - 1, MEASURED).astype(int))
    growth = Growth(map, some.theta, some.phi, some.component)
    growth.settle(ALIGNED)
    count = Count(growth, BLOCKS, long=bounces)
    for _ in count.until(bounces):
        pass
    found = measured_on(count, np.nonzero(growth.code == 0)[0], attractor)
    assert found.upper is not None
    lower, error = (-np.inf, 0.0) if found.lower is None else (found.lower.mean, found.lower.error)
    return replace(attractor, nu_plus=found.upper.mean, nu_minus=lower, errors=(found.upper.error, error))
