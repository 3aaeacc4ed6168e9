"""Which orbits lie on the same chaotic set: compared at several resolutions, over several lengths, and under
symmetries.

Space, with coordinates `x`, `y` (over a quarter of the perimeter) and `sin(phi)`, is cut into cells of side
`2**-level`. An orbit is cut into quarters. It *recurs* at a level when at least the share `RECURS` of a quarter lies in
cells that the quarter before has visited. Two orbits are compared at the finest level at which both recur: the share of
a quarter that lies in cells of the other orbit is divided by the share that lies in cells of the quarter before. On one
set this ratio is near 1 or larger; for two sets it tends to 0, even if they touch. Two orbits are joined where the
ratio is at least `JOINED`, or where a chain of such pairs links them. A ratio between `APART` and `JOINED` decides
nothing. An orbit's image under a symmetry of the table lies on a single set too, so sets that share an image are one.

The comparison is repeated with orbits four times as long until two successive lengths give the same sets, every ratio
decides, and orbits no longer spread: then the cells visited do not depend on time. Sets that cannot be distinguished in
this way are listed as one, with the reason. At `lam = 1` orbits stick for long times, and as long as most orbits of a
set spread, no sets are distinguished.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, embedded, phase_points, together
from numeric.dynamics.symmetries import is_identity, moved, symmetries_of

PARTICLES = 32  # at most, whose orbits are compared
LENGTHS = (4096, 16384, 65536)  # bounces of each, until two agree
KEPT = 8192  # points of a cloud
FINEST, COARSEST = 18, 2  # levels
SPREADING = (  # the bits of a coordinate, three places apart: shifts, and what is kept after each
    (32, 0x1F00000000FFFF),
    (16, 0x1F0000FF0000FF),
    (8, 0x100F00F00F00F00F),
    (4, 0x10C30C30C30C30C3),
    (2, 0x1249249249249249),
)
RECURS = 0.05  # of a quarter's points
JOINED, APART = 0.25, 0.02  # of what an orbit shares with itself
SPREADS = 0.5  # an orbit spreads if its first and last quarters share less than this part of what neighbours share
IMAGES = 8192  # points of an orbit's images under all symmetries
FEWEST = 64  # of each image


class Gathered(NamedTuple):
    """The chaotic sets of a few orbits: `looked` has the indices of the particles, and `member` the set of each.

    `known[i]` is the set to which the `i`-th set known before belongs. In `sets` the known ones come first, with points
    of new orbits added; if two of them turn out to be the same, both have the index of the earlier one. The doubt of a
    set is the reason why it may be several sets; it is empty if there is no such reason.
    """

    looked: Labels
    member: Labels
    known: Labels
    sets: list[PhasePoints]
    doubts: list[str]


def gathered(map: PinballMap, particles: PhasePoints, known: Sequence[PhasePoints] = ()) -> Gathered:
    """The sets on which the orbits of a few particles lie; those of `known` come first.

    >>> found = gathered(PinballMap("cardioid", lam="0.5"), phase_points([0.5, -0.5, 1.0], 0.1))
    >>> found.member.tolist(), len(found.sets), found.doubts
    ([0, 0, 0], 1, [''])
    """
    looked = np.linspace(0, particles.size - 1, min(particles.size, PARTICLES)).astype(int)
    some = together(*(points.only(slice(0, 1)) for points in known), particles.only(looked))
    found: SetLabels | None = None
    before: SetLabels | None = None
    for bounces in LENGTHS:
        orbit = map.orbit(some.theta, some.phi, bounces, some.component)
        along = PhasePoints(orbit.component[1:].T, orbit.theta[1:].T, orbit.phi[1:].T)
        before, found = found, divided(map, along)
        if before is not None and found.decided and np.array_equal(found.group, before.group):
            break
    assert found is not None
    assert before is not None  # LENGTHS has more than one
    group, reasons = with_doubts(found, before.group, map.law == "elastic")
    sets, doubts = list(known), [""] * len(known)
    place: dict[int, int] = {}
    for owner, number in enumerate(group.tolist()):
        if number not in place:
            place[number] = owner if owner < len(known) else len(sets)
            on = group == number
            points = phase_points(along.theta[on], along.phi[on], along.component[on])
            points = points.only(drawn(points.size, KEPT))
            if owner < len(known):
                sets[owner], doubts[owner] = together(known[owner], points), reasons[number]
            else:
                sets.append(points)
                doubts.append(reasons[number])
    on = np.array([place[number] for number in group.tolist()], dtype=np.int64)
    return Gathered(looked, on[len(known) :], on[: len(known)], sets, doubts)


def drawn(size: int, count: int) -> Labels:
    """`count` of the indices below `size`, drawn at random: regular steps could miss pieces that are visited
    periodically.

    >>> drawn(5, 9).tolist()
    [0, 1, 2, 3, 4]
    """
    return np.sort(np.random.default_rng(0).choice(size, min(size, count), replace=False))


class SetLabels(NamedTuple):
    """The set of each orbit: `group` if ratios from `JOINED` on join orbits, `coarser` if ratios from `APART` on do.

    `spreads` tells which orbits still spread.
    """

    group: Labels
    coarser: Labels
    spreads: NDArray[np.bool_]

    @property
    def decided(self) -> bool:
        """Do both thresholds give the same sets, and is there one set only, or no set whose orbits mostly spread?"""
        whole = self.group.max() == 0
        return np.array_equal(self.group, self.coarser) and (bool(whole) or not np.any(self.spreading()))

    def spreading(self) -> NDArray[np.bool_]:
        """For each set: do most of its orbits still spread?"""
        return np.asarray(2 * np.bincount(self.group, self.spreads) > np.bincount(self.group))


def with_doubts(found: SetLabels, before: Labels, elastic: bool = False) -> tuple[Labels, list[str]]:
    """The set of each orbit, where undistinguished sets are joined, and for each set why it may be several (empty if
    not).

    >>> one, two, calm = np.array([0, 0, 1]), np.array([0, 1, 2]), np.zeros(3, dtype=bool)
    >>> with_doubts(SetLabels(one, one, calm), two)[1], with_doubts(SetLabels(two, one, calm), two)[1]
    (['', ''], ['its orbits lie on 1 to 2 sets, those a quarter as long on 2', ''])
    """
    spreading = found.spreading()[found.group] & (found.group.max() > 0)
    apart = np.where(spreading | (elastic & np.any(spreading)), -1, found.group)  # all that spread may be on one
    group = coarsest(found.coarser, before, apart)
    reasons = []
    for number in range(int(group.max()) + 1):
        on = group == number
        most, least, then = (np.unique(labels[on]).size for labels in (found.group, found.coarser, before))
        if np.any(spreading[on]):
            reasons.append(f"its orbits still spread after {LENGTHS[-1]} bounces")
        else:
            reasons.append(
                "" if most == 1 else f"its orbits lie on {least} to {most} sets, those a quarter as long on {then}"
            )
    return group, reasons


def coarsest(*labels: Labels) -> Labels:
    """The finest partition that is coarser than each of the given partitions.

    >>> coarsest(np.array([0, 0, 1, 2]), np.array([0, 1, 1, 3])).tolist()
    [0, 0, 0, 1]
    """
    return linked(np.any([each[:, None] == each for each in labels], axis=0))


def linked(near: NDArray[np.bool_]) -> Labels:
    """The set of each orbit, numbered from 0: the connected components of the relation `near`.

    >>> linked(np.array([[True, False, True], [False, True, False], [False, False, True]])).tolist()
    [0, 1, 0]
    """
    from scipy.sparse.csgraph import connected_components  # a quarter of a second that cycles do without

    group = connected_components(near, directed=False)[1]
    return np.asarray(np.unique(group, return_inverse=True)[1], dtype=np.int64)


def divided(map: PinballMap, along: PhasePoints) -> SetLabels:
    """The sets on which orbits lie; in `along`, particles run along the first axis and bounces along the second."""
    owners, bounces = along.theta.shape
    first = np.min(embedded(map, phase_points(along.theta.ravel(), along.phi.ravel(), along.component.ravel())), axis=0)
    corner, size = np.array([*first[:2], -1.0]), map.arclength.perimeter / map.states.size / 4

    def places(points: PhasePoints) -> Labels:
        flat = embedded(map, phase_points(points.theta, points.phi, points.component))
        scaled = np.floor((flat - corner) / np.array([size, size, 1.0]) * 2.0**FINEST)
        return codes(*scaled.astype(np.int64).T.reshape(3, *points.theta.shape))

    here = np.sort(places(along).reshape(owners, 4, bounces // 4))
    each = (_recurrence(quarters) for quarters in here)
    recurring = RecurrenceLevels(*(np.array(rows) for rows in zip(*each, strict=True)))
    ratio = ratios(here, here.reshape(4 * owners, -1), np.repeat(np.arange(owners), 4), recurring)
    ratio = np.max(ratio.reshape(owners, 4, owners), axis=1)
    ratio = np.maximum(ratio, ratio.T)
    near, perhaps = ratio >= JOINED, ratio >= APART
    group = [] if linked(near).max() == 0 else [g for g in symmetries_of(map) if not is_identity(g)]
    few = drawn(bounces, max(FEWEST, IMAGES // max(len(group), 1)))
    for symmetry in group:
        image = moved(symmetry, PhasePoints(along.component[:, few], along.theta[:, few], along.phi[:, few]))
        shared = ratios(here, np.sort(places(image)), np.arange(owners), recurring)
        near, perhaps = (both | _together(shared >= least) for both, least in ((near, JOINED), (perhaps, APART)))
    return SetLabels(linked(near), linked(perhaps), recurring.spreads)


def _together(on: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """For each pair of orbits: is there an image close to both? Images run along the rows of `on`."""
    return np.asarray(on.T.astype(float) @ on.astype(float) > 0)


def codes(*places: Labels) -> Labels:
    """One integer for three coordinates, by interleaved bits [Morton1966]: a cell at a level is a range of integers.

    >>> codes(np.array([1]), np.array([2]), np.array([3])).tolist()  # bits 001, 010, 011
    [29]
    """
    found = np.zeros(places[0].shape, dtype=np.int64)
    for place in places:
        apart = place
        for shift, kept in SPREADING:
            apart = (apart | apart << shift) & kept
        found = found << 1 | apart
    return found


def finest(early: Labels, late: Labels) -> Labels:
    """The finest level at which each point of `late` lies in a cell of one of `early`, where both are sorted codes (see
    `codes`).

    Codes of one cell are consecutive, so only the code before and the one after can share the longest prefix.

    >>> finest(np.array([0, 64]), np.array([0, 7, 8])).tolist()
    [18, 17, 16]
    """
    at = np.searchsorted(early, late)
    apart = np.minimum(late ^ early[np.maximum(at - 1, 0)], late ^ early[np.minimum(at, early.size - 1)])
    return np.asarray(FINEST - (np.frexp(apart.astype(float))[1] + 2) // 3, dtype=np.int64)


class RecurrenceLevels(NamedTuple):
    """How orbits recur: `level` is the finest level at which each orbit does.

    `own` has, by level, the largest share of a quarter that lies in cells of the quarter before. An orbit `spreads` if
    neighbouring quarters still have clearly more in common than the first and the last.
    """

    level: Labels
    own: Array
    spreads: NDArray[np.bool_]


def _recurrence(quarters: Labels) -> tuple[int, Array, bool]:
    """The level, shares and spreading of one orbit, as in `RecurrenceLevels`, from sorted codes of its quarters."""
    early, late = (0, 1, 2, 0), (1, 2, 3, 3)
    met = [np.maximum(finest(quarters[i], quarters[k]), -1) for i, k in zip(early, late, strict=True)]
    counts = np.array([np.bincount(each + 1, minlength=FINEST + 2) for each in met])
    shares = np.cumsum(counts[:, :0:-1], axis=1)[:, ::-1] / met[0].size  # by level, of the points that reach it
    own = np.max(shares[:3], axis=0)
    level = max(COARSEST, int(np.max(np.nonzero(own >= RECURS)[0], initial=COARSEST)))
    return level, own, bool(shares[3, level] < SPREADS * np.mean(shares[:3, level]))


def ratios(here: Labels, points: Labels, of: Labels, recurring: RecurrenceLevels) -> Array:
    """For each row of points and each orbit: the row's share in the orbit's cells, divided by the orbits' own share.

    Row `i` belongs to orbit `of[i]` or to its image, and is sorted. An orbit's own share is that of a quarter in the
    cells of the quarter before; of the values of both orbits the smaller is taken.
    """
    found, level = np.zeros((len(points), len(here))), recurring.level
    for one in np.unique(level):
        columns, rows = np.nonzero(level >= one)[0], np.nonzero(level[of] >= one)[0]
        least = np.minimum.outer(recurring.own[of[rows], one], recurring.own[columns, one])
        shift = 3 * (FINEST - one)
        share = visits(here[columns].reshape(columns.size, -1) >> shift, points[rows] >> shift)
        at = np.minimum.outer(level[of[rows]], level[columns]) == one
        found[np.ix_(rows, columns)] = np.where(at, share / np.maximum(least, 1e-9), found[np.ix_(rows, columns)])
    return found


def visits(first: Labels, points: Labels) -> Array:
    """The share of each row of `points` that lies in the cells of each row of `first`; both hold numbers of cells."""
    from scipy.sparse import coo_array

    names = np.sort(first, axis=None)
    names = names[np.diff(names, prepend=names[0] - 1) > 0]
    owner = np.repeat(np.arange(len(first)), first.shape[1])
    cell = np.searchsorted(names, first).ravel()
    inside = coo_array((np.ones(owner.size), (owner, cell)), shape=(len(first), names.size)).tocsr()
    inside.data[:] = 1
    place = np.minimum(np.searchsorted(names, points), names.size - 1)
    row, column = np.nonzero(names[place] == points)
    hits = coo_array((np.ones(row.size), (row, place[row, column])), shape=(len(points), names.size)).tocsr()
    return np.asarray((hits @ inside.T).toarray() / points.shape[1])
