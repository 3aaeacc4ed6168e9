"""Attractors and the symmetries of their table: images joined to families, each with its stabiliser."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from numeric import PinballMap
from numeric.dynamics.kinds import Attractor, Kind, wilson
from numeric.dynamics.phase_points import Places, together
from numeric.dynamics.recognition import at_clouds, same

PART = 0.1  # of an image's points

if TYPE_CHECKING:
    from symbolic.tables.symmetry import Symmetry


def moved(symmetry: "Symmetry", balls: Places) -> Places:
    """The balls' images: a reflection turns every exit angle round. Paper: section 6.4, opposite angles.

    >>> from symbolic.tables.symmetry import group
    >>> from symbolic.tables import cuspless
    >>> from numeric.dynamics.phase_points import places
    >>> image = moved(group(cuspless)[1], places([0, 1], [1.0, 0.25], 0.5))
    >>> image.component.tolist(), image.theta.tolist(), image.phi.tolist()
    ([0, 1], [-1.0, -0.25], [-0.5, -0.5])
    """
    shift = np.array([float(x) for x in symmetry.shift])[balls.component]
    theta = symmetry.sign * balls.theta + shift
    if len(symmetry.onto) == 1:
        theta = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
    return Places(np.array(symmetry.onto)[balls.component], theta, symmetry.sign * balls.phi)


def with_images(map: PinballMap, attractors: Sequence[Attractor], group: "Sequence[Symmetry]") -> list[Attractor]:
    """The attractors with their families and stabilisers; images that were missing come last."""
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
    leader = {i: i for i in spread}
    for i in spread:
        for symmetry in group:
            label = at_clouds(map, moved(symmetry, attractors[i].points), attractors)
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
        image = replace(attractor, points=moved(symmetry, attractor.points), share=None)
        index = _index(map, found, image)
        if index == at:
            own.append(symmetry)
        if index == len(found):
            found.append(image)
        found[index] = replace(found[index], family=family)
    for index, member in enumerate(found):
        if member.family == family:
            found[index] = replace(member, symmetry=name(own))


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

    >>> from symbolic.tables.symmetry import group
    >>> from symbolic.tables import egg
    >>> name(group(egg(3).at(alpha="0.08")))
    'D3'
    """
    rotations = sum(symmetry.sign > 0 for symmetry in own)
    return f"{'D' if rotations < len(own) else 'C'}{rotations}"
