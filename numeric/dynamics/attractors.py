"""Attractors and the symmetries of their table: images joined to families, each with its stabiliser.

The attractors of a map: found from many starts, told apart, and every particle labelled with the one it reaches.

A cycle is polished (`numeric.dynamics.recognition`) and then recognised by nearness; what settles on no cycle
and spreads is chaotic when no particle leaves it for a whole round of bounces, and then falls into the sets
that its orbits join (`numeric.dynamics.phase_points`). Whatever is still leaving at the end is unsettled.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.phase_points import Array, PhasePoints, gathered, phase_points, together
from numeric.dynamics.recognition import (
    UNSETTLED,
    Attractor,
    Kind,
    Labels,
    Share,
    at_clouds,
    at_cycles,
    clouds,
    recognised,
    same,
    wilson,
)
from numeric.pinball.sampling import interior_starts
from numeric.pinball.states import STATUSES

PART = 0.1  # of an image's points

if TYPE_CHECKING:
    from symbolic.tables.geometry import Symmetry
    from symbolic.tables.law import Law


def moved(symmetry: "Symmetry", particles: PhasePoints) -> PhasePoints:
    """The particles' images: a reflection turns every exit angle round. Paper: section 6.4, opposite angles.

    >>> from symbolic.tables.geometry import group
    >>> from symbolic.tables import cuspless
    >>> from numeric.dynamics.phase_points import phase_points
    >>> image = moved(group(cuspless)[1], phase_points([1.0, 0.25], 0.5, [0, 1]))
    >>> image.component.tolist(), image.theta.tolist(), image.phi.tolist()
    ([0, 1], [-1.0, -0.25], [-0.5, -0.5])
    """
    shift = np.array([float(x) for x in symmetry.shift])[particles.component]
    theta = symmetry.sign * particles.theta + shift
    if len(symmetry.onto) == 1:
        theta = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
    return PhasePoints(np.array(symmetry.onto)[particles.component], theta, symmetry.sign * particles.phi)


def kept_by(law: "Law", symmetry: "Symmetry") -> bool:
    """Are images of orbits under a symmetry of the table orbits? A rotation needs a law that is the same everywhere,
    a mirror also an odd one."""
    return is_identity(symmetry) or (not law.placed and (symmetry.sign == 1 or law.odd))


def is_identity(symmetry: "Symmetry") -> bool:
    """Does it leave each point of the plane where it is?"""
    return symmetry.sign == 1 and bool(symmetry.angle == 0)


def symmetries_of(map: PinballMap) -> "tuple[Symmetry, ...]":
    """The symmetries of the table under which images of orbits are orbits, the identity first.

    >>> [g.sign for g in symmetries_of(PinballMap("cuspless", lam="0.09"))]
    [1, -1]
    """
    from numeric.lowering.lower import symmetries

    return tuple(g for g in symmetries(map.table) if kept_by(map.reflection, g))


def with_images(map: PinballMap, attractors: Sequence[Attractor]) -> list[Attractor]:
    """The attractors with their families and stabilisers under the table's symmetries; missing images come last."""
    group = symmetries_of(map)
    found = [replace(a, family=-1) for a in united(map, attractors, group)]
    at = families = 0
    while at < len(found):
        if found[at].family < 0:
            _join(map, found, at, families, group)
            families += 1
        at += 1
    return found


def united(map: PinballMap, attractors: Sequence[Attractor], group: "Sequence[Symmetry]") -> list[Attractor]:
    """The attractors, with chaotic ones made one when an image of a third lies on both.

    Just above a crisis that merges mirror images orbits change sides so seldom that one pair is seen to be one
    set and its image is not.
    """
    spread = [i for i, a in enumerate(attractors) if a.kind is Kind.CHAOTIC]
    leader, near = {i: i for i in spread}, clouds(map, attractors)
    for i in spread:
        for symmetry in group:
            if is_identity(symmetry):  # each point is nearest to itself
                continue
            label = near(moved(symmetry, attractors[i].points))
            counts = np.bincount(label[label >= 0], minlength=len(attractors))
            shared = [j for j in spread if counts[j] > PART * label.size]
            least = min((leader[j] for j in shared), default=i)
            merged = {leader[j] for j in shared}
            leader = {j: least if old in merged else old for j, old in leader.items()}
    return [_one(attractors, i, leader) for i in range(len(attractors)) if leader.get(i, i) == i]


def _one(attractors: Sequence[Attractor], at: int, leader: dict[int, int]) -> Attractor:
    """An attractor together with those that it leads."""
    parts = [attractors[j] for j, first in leader.items() if first == at] or [attractors[at]]
    shares = [a.share for a in parts if a.share]
    share = wilson(sum(x.count for x in shares), shares[0].of) if shares else None
    return replace(parts[0], points=together(*(a.points for a in parts)), share=share)


def _join(map: PinballMap, found: list[Attractor], at: int, family: int, group: "Sequence[Symmetry]") -> None:
    """Numbers an attractor and its images alike, in place."""
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


def image_of(map: PinballMap, found: list[Attractor], attractor: Attractor, symmetry: "Symmetry") -> int:
    """Where the attractor's image is in the list; an image that was not there comes last."""
    image = replace(attractor, points=moved(symmetry, attractor.points), share=None)
    index = _index(map, found, image)
    if index == len(found):
        found.append(image)
    return index


def _index(map: PinballMap, found: list[Attractor], image: Attractor) -> int:
    """Where an image is in the list; its end when it is not there."""
    if image.kind is Kind.CHAOTIC:
        label = at_clouds(map, image.points, found)
        owner = int(np.argmax(np.bincount(label + 1))) - 1
        return owner if owner >= 0 else len(found)
    for index, attractor in enumerate(found):
        if same(map, attractor, image):
            return index
    return len(found)


def name(own: "Sequence[Symmetry]") -> str:
    """The group in Schoenflies' words: `Cn` for n rotations, `Dn` when there are reflections too.

    >>> from symbolic.tables.geometry import group
    >>> from symbolic.tables import egg
    >>> name(group(egg(3).at(alpha="0.08")))
    'D3'
    """
    rotations = sum(symmetry.sign > 0 for symmetry in own)
    return f"{'D' if rotations < len(own) else 'C'}{rotations}"


__all__ = ["UNSETTLED", "Attractor", "Classified", "Kind", "Share", "classify", "find", "wilson"]
SAMPLE = 64  # particles looked at for new cycles
ROUNDS = 6
WATCHED = 100_000  # bounces, of all particles together, in which none leaves a chaotic attractor
MEASURED = 64  # particles whose exponents are averaged


class Classified(NamedTuple):
    """The index of each particle's attractor, -1 where it did not settle, and the attractors."""

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
    """Particles on their way to attractors; the ones in `going` have not been recognised yet."""

    map: PinballMap
    particles: PhasePoints
    attractors: list[Attractor]
    label: Labels = field(init=False)
    going: Labels = field(init=False)
    growth: Array = field(init=False)

    def __post_init__(self) -> None:
        self.label = np.full(self.particles.size, UNSETTLED)
        self.going = np.arange(self.particles.size)

    def sorted(self, transient: int, rounds: int) -> Classified:
        """Rounds of bounces, each twice as long, until one goes by in which no particle is recognised."""
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
        return Classified(self.label, tuple(self.attractors))

    def _advance(self, bounces: int) -> None:
        """Moves those that are going, and keeps how fast their neighbourhoods grow; the ones that stop are labelled."""
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
        """The index of an attractor, in the list if it was not there."""
        for index, old in enumerate(self.attractors):
            if same(self.map, old, new):
                return index
        self.attractors.append(new)
        return len(self.attractors) - 1

    def _catch(self) -> None:
        """Labels the particles that are at a cycle, and looks for new cycles among the others."""
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
        """At `lam = 1` nothing attracts: a particle spreads like a power of the time, or exponentially."""
        regular = self.growth < calm(bounces)
        if np.any(regular):
            points = self.particles.only(self.going[regular])
            self.label[self.going[regular]] = self._entered(Attractor(Kind.NEUTRAL, 0, points))
            self._keep(~regular, self.growth)

    def _spread(self, bounces: int) -> None:
        """Shares out the particles that spread among the chaotic attractors; new ones are made for those near none."""
        stay = self.going.size * bounces / 3
        self._keep(self.growth > calm(bounces), self.growth)
        while self.going.size:
            near = at_clouds(self.map, self.particles.only(self.going), self.attractors)
            self.label[self.going] = near
            self._keep(near == UNSETTLED, self.growth)
            if self.going.size:
                self._gather(stay)

    def _gather(self, stay: float) -> None:
        """Labels a few of the particles with the set their orbits lie on, known or new."""
        spread = [i for i, a in enumerate(self.attractors) if a.kind is Kind.CHAOTIC]
        particles = self.particles.only(self.going)
        found = gathered(self.map, particles, [self.attractors[i].points for i in spread])
        for points in found.sets[len(spread) :]:
            spread.append(len(self.attractors))
            self.attractors.append(Attractor(Kind.CHAOTIC, 0, points, stay=stay))
        self.label[self.going[found.looked]] = np.array(spread)[found.member]
        self._keep(~np.isin(np.arange(particles.size), found.looked), self.growth)


def calm(bounces: int) -> float:
    """The exponent up to which a growth over so many bounces may be no more than a power of their number.

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

    Starts are those of the paper's appendix. With `images` those under the table's symmetries belong to the
    result, also those that no start has reached: their share is 0 out of `orbits`.

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
    found.sort(key=lambda a: -a.share.count if a.share else 0)
    order = list(dict.fromkeys(a.family for a in found))
    return tuple(replace(a, family=order.index(a.family)) for a in found)


def measured(map: PinballMap, attractor: Attractor, bounces: int) -> Attractor:
    """The attractor with the exponents of a chaotic one, and their standard errors over as many particles."""
    if attractor.kind is not Kind.CHAOTIC:
        return attractor
    points = attractor.points
    some = points.only(np.linspace(0, points.size - 1, MEASURED).astype(int))
    end = map.exponents(some.theta, some.phi, bounces, 100, some.component)
    good = end.code == 0
    plus, minus = end.nu_plus[good], end.nu_minus[good]
    root = np.sqrt(max(np.sum(good), 1))
    errors = float(np.std(plus) / root), float(np.std(minus) / root) if np.all(np.isfinite(minus)) else 0.0
    return replace(attractor, nu_plus=float(np.mean(plus)), nu_minus=float(np.mean(minus)), errors=errors)
