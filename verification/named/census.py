"""Which attractors coexist at each contraction, from where to where each lives, and what begins and ends it.

Two methods that check each other: random starts on a grid of contractions, and each cycle they find followed
to both ends of its life, where its event is proved, and past them to the cycles born there. What is listed
is proved to exist; that nothing else attracts is not, and cannot be by sampling: a basin below about
`3/starts` of the table is likely to be missed at any one contraction.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, Share, classify, find, wilson
from numeric.dynamics.cycles import polished, shortest
from numeric.dynamics.phase_points import Places
from numeric.dynamics.symmetry import moved, name
from symbolic.tables.symmetry import Symmetry, group
from symbolic.tables.table import Table
from verification.named.branches import Branch, Event, alike, ends, own

FOLLOWED = 64  # the longest period whose branch is followed
BEYOND = 0.1  # of a branch's length past its end: where its successor is looked for


@dataclass(frozen=True, eq=False)
class Member:
    """The attractors of one family at one contraction: `copies` images of each other, and their joint share."""

    kind: Kind
    period: int
    symmetry: str
    copies: int
    share: Share
    nu_plus: float
    first: Attractor


@dataclass(frozen=True, eq=False)
class Row:
    """What the starts reached at one contraction; `unsettled` of them reached nothing in the time given."""

    lam: float
    members: tuple[Member, ...]
    unsettled: int

    @property
    def attractors(self) -> int:
        """How many coexist, as far as the starts saw."""
        return sum(member.copies for member in self.members)


def row(map: PinballMap, table: Table, starts: int, seed: int) -> Row:
    """The row at the map's contraction.

    >>> from symbolic.tables import egg
    >>> found = row(PinballMap("egg", alpha="0.08", lam=0.2), egg(3).at(alpha="0.08"), 100, 1)
    >>> [(m.kind.name, m.period, m.symmetry, m.copies) for m in found.members], found.attractors
    ([('CYCLE', 4, 'D1', 3)], 3)
    """
    found = find(map, starts, seed, table)
    members = []
    for family in sorted({a.family for a in found}):
        images = [a for a in found if a.family == family]
        count = sum(a.share.count for a in images if a.share)
        first = images[0]
        share = wilson(count, starts)
        members.append(Member(first.kind, first.period, first.symmetry, len(images), share, first.nu_plus, first))
    return Row(float(map.lam.flat[0]), tuple(members), starts - sum(m.share.count for m in members))


def branches(map: PinballMap, table: Table, rows: Sequence[Row], longest: int = FOLLOWED) -> Iterator[Branch]:
    """Every branch of cycles up to a period that the rows or the ends of other branches lead to, each once.

    >>> from symbolic.tables import cuspless
    >>> map = PinballMap("cuspless", lam=0.05)
    >>> [(b.period, b.low.event.name, b.high.value) for b in branches(map, cuspless, [row(map, cuspless, 50, 1)])]
    [(2, 'EDGE', '0.09340033543136')]
    """
    symmetries = group(table)
    known: list[Branch] = []
    for here in rows:
        for member in here.members:
            cycle = member.kind is Kind.CYCLE and member.period <= longest
            queue = [(here.lam, member.first.points)] if cycle else []
            while queue:
                new = _followed(map, table, symmetries, known, *queue.pop())
                if new is not None:
                    known.append(new)
                    queue += _successors(map, new, longest)
                    yield new


def _followed(
    map: PinballMap, table: Table, symmetries: Sequence[Symmetry], known: Sequence[Branch], lam: float, near: Places
) -> Branch | None:
    """The branch through a cycle, unless it is known."""
    there = map.at(lam)
    cycle = shortest(there, near)
    kept = own(there, cycle.points, symmetries)
    if any(_on(there, branch, cycle.points, symmetries) for branch in known):
        return None
    low, high = ends(there, table, symmetries, cycle, lam)
    return Branch(cycle.period, name(kept), len(symmetries) // len(kept), low, high)


def _on(map: PinballMap, branch: Branch, points: Places, symmetries: Sequence[Symmetry]) -> bool:
    """Is the branch's cycle at this contraction the given one, or an image of it?"""
    lam = float(map.lam.flat[0])
    if branch.period != points.size or not branch.low.lam <= lam <= branch.high.lam:
        return False
    here = polished(map, branch.nearest(lam))
    return here is not None and any(alike(map, here.points, moved(s, points)) < 1e-6 for s in symmetries)


def _successors(map: PinballMap, branch: Branch, longest: int) -> list[tuple[float, Places]]:
    """Cycles of at most twice the period that attract just past an end at which the branch hands over."""
    found = []
    for end, way in ((branch.low, -1), (branch.high, 1)):
        lam = end.lam + way * BEYOND * (branch.high.lam - branch.low.lam)
        if end.event not in (Event.FLIP, Event.PITCHFORK, Event.HALVED) or not 0 <= lam < 1:
            continue
        first = end.cycle.points.only(slice(0, 1))
        there = map.at(lam)
        for nudge in (1e-5, -1e-5):
            label, attractors = classify(there, first.component, first.theta + nudge, first.phi, transient=20_000)
            near = [attractors[i] for i in label[label >= 0]]
            found += [(lam, a.points) for a in near if a.kind is Kind.CYCLE and a.period <= longest]
    return found


def coexisting(branches: Sequence[Branch], lam: float) -> list[Branch]:
    """The branches that attract at a contraction."""
    return [branch for branch in branches if branch.low.lam < lam < branch.high.lam]
