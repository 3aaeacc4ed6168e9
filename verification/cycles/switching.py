"""Continuation from a bifurcation: the other branch that passes through it, or its curve in two parameters.

At a fold no other branch leaves: the branch itself goes on. At a period doubling and at a pitchfork the other branch
leaves along the null vector: the next cycle is sought in the plane that lies a small amplitude away, which the old
branch does not meet. At a border collision the bounce on the join is taken to lie on the neighbouring component.
Whether an admissible cycle exists there, and for which contractions, decides whether the cycle continues, ends, or ends
together with a second one.

On a curve of folds or flips in two parameters these points of codimension two are found:

    on a fold:   cusp                   the fold's own coefficient vanishes
                 1:1 resonance          the other multiplier is 1 too: Bogdanov-Takens
                 fold-flip              the other multiplier is -1
    on a flip:   generalised flip       the flip's own coefficient vanishes
                 1:2 resonance          the other multiplier is -1 too
                 fold-flip              the other multiplier is 1

At `lam = 1` the map preserves an area, so a curve of folds that gets there ends in a 1:1 resonance, and one of flips in
a 1:2 resonance.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import pairwise

import numpy as np

from verification.cycles import arc
from verification.cycles.arc import CurvePoint, End, LostError, Path, Steps
from verification.cycles.branch import Branch, Event, Interval, through
from verification.cycles.cells import null_vectors, ring_matrix
from verification.cycles.chords import Chords
from verification.cycles.crossing import beyond
from verification.cycles.recurrence import Array, BifurcationKind, Parameters, Recurrence
from verification.cycles.systems import SHAPE, CriticalCycles, Cycles, whole

AMPLITUDE = 0.003  # radians, root mean square: the first step away from the crossing
NEARBY = 0.2  # of det(M - 1), which is 0 at the crossing: a longer step may jump over the next event
Tick = Callable[[CurvePoint], object]


def switched(
    branch: Branch, event: Event, interval: Interval, steps: Steps | None = None, tick: Tick | None = None
) -> list[Branch]:
    """The branches that leave at `event`, in `interval`: both halves at a pitchfork, a single branch at a period
    doubling.

    At a birth the result is the branch of the cycle from which this one is born; that branch passes through the event.

    >>> from verification.cycles.branch import branch
    >>> from verification.cycles.recurrence import logistic
    >>> one = branch(logistic(1), np.array([0.6]), "r", 2.5, (2.0, 3.4))
    >>> (two,) = switched(one, one.events[0], (2.0, 3.6))
    >>> [(event.kind.value, round(event.value, 9)) for event in two.events]
    [('period doubling', 3.449489743)]
    """
    if event.birth:
        system, z = Cycles(event.ring, branch.system.parameter, branch.system.fixed), np.append(event.x, event.value)
        return [through(system, z, np.append(0.0 * event.x, 1.0), interval, steps, tick)]
    if event.kind in (BifurcationKind.FLIP, BifurcationKind.PITCHFORK):
        return _along_the_null_vector(branch, event, interval, steps, tick)
    if event.kind is BifurcationKind.BRANCH_POINT:
        return _across(branch, event, interval, steps, tick)
    if event.kind is BifurcationKind.BORDER_COLLISION:
        starts = beyond(branch.system, event)
        return [through(system, near, near - z, interval, steps, tick, ways=(1,)) for system, near, z in starts]
    return []


def _along_the_null_vector(
    branch: Branch, event: Event, interval: Interval, steps: Steps | None, tick: Tick | None
) -> list[Branch]:
    parameter, fixed = branch.system.parameter, branch.system.fixed
    part, x = event.ring, event.x
    at = {**fixed, parameter: event.value}
    v, _ = null_vectors(ring_matrix(part.terms(x, at, 1), part.closure, -1))
    ring, image = part.doubled(), part.closure.carried(x, part.closure.radians, 1)
    both, away = np.concatenate([x, image]), np.concatenate([v, -part.closure.turn * v])
    if isinstance(ring, Chords) and isinstance(part, Chords) and event.kind is BifurcationKind.PITCHFORK:
        n = branch.system.recurrence.period
        ring, both = whole(replace(part, closure=part.closure), x, n)
        away = _repeated(part, v, n)
    ways = (1, -1) if event.kind is BifurcationKind.PITCHFORK else (1,)
    system = Cycles(ring, parameter, fixed)
    z = np.append(both, event.value)
    return [_leaving(system, z, np.append(way * away, 0.0), interval, steps, tick) for way in ways]


def _repeated(part: Chords, v: Array, n: int) -> Array:
    """The null vector of the part that flips, continued along the whole cycle."""
    pieces, piece = [v], v
    while len(pieces) * part.period < n:
        piece = -part.closure.turn * piece
        pieces.append(piece)
    return np.concatenate(pieces)


def _leaving(
    system: Cycles, z: Array, away: Array, interval: Interval, steps: Steps | None, tick: Tick | None
) -> Branch:
    """The branch that leaves `z` in the direction `away`; the first point of the branch is `z` itself."""
    crossing = CurvePoint(z, away, 0.0, system.tests(z))
    size = AMPLITUDE
    for _ in range(8):
        try:
            near, _ = arc.arc(system, crossing, size)
            if abs(system.tests(near)["one"]) > NEARBY:
                size /= 3
                continue
            found = through(system, near, near - z, interval, steps, tick, ways=(1,))
        except LostError:
            size /= 3
            continue
        points = (crossing, *(replace(p, s=p.s + size) for p in found.points))
        events, births = (
            tuple(replace(event, point=replace(event.point, s=event.point.s + size)) for event in some)
            for some in (found.events, found.births)
        )
        return replace(found, points=points, events=events, births=births)
    raise LostError(f"{system.label}: no branch was found that leaves at {system.parameter} = {z[-1]:.9g}")


def _across(branch: Branch, event: Event, interval: Interval, steps: Steps | None, tick: Tick | None) -> list[Branch]:
    """The branches that leave in both directions along the null vector other than the branch's tangent."""
    system, z = branch.system, event.point.z
    matrix = ring_matrix(system.terms(z), system.recurrence.closure)
    v = np.append(null_vectors(matrix)[0], 0.0)
    own = event.point.tangent
    v = v - (v @ (system.weights * own)) * own
    v /= np.sqrt(v @ (system.weights * v))
    return [_leaving(system, z, way * v, interval, steps, tick) for way in (1, -1)]


Box = tuple[tuple[float, float], tuple[float, float]]
NOISE = 1e-10


class CodimensionTwo(Enum):
    """The kinds of points of codimension two."""

    CUSP = "cusp"
    ONE_ONE = "1:1 resonance (Bogdanov-Takens)"
    ONE_TWO = "1:2 resonance"
    FOLD_FLIP = "fold-flip"
    GENERALISED_FLIP = "generalised flip"


MEANING = {
    (BifurcationKind.FOLD, "bend"): CodimensionTwo.CUSP,
    (BifurcationKind.FOLD, "other_one"): CodimensionTwo.ONE_ONE,
    (BifurcationKind.FOLD, "other_minus_one"): CodimensionTwo.FOLD_FLIP,
    (BifurcationKind.FLIP, "bend"): CodimensionTwo.GENERALISED_FLIP,
    (BifurcationKind.FLIP, "other_one"): CodimensionTwo.FOLD_FLIP,
    (BifurcationKind.FLIP, "other_minus_one"): CodimensionTwo.ONE_TWO,
}


@dataclass(frozen=True)
class Degenerate:
    """A point of codimension two on a curve, with its kind."""

    kind: CodimensionTwo
    point: CurvePoint = field(repr=False)

    @property
    def parameters(self) -> tuple[float, float]:
        """The values of the two parameters."""
        return float(self.point.z[-2]), float(self.point.z[-1])


@dataclass(frozen=True)
class CodimensionOneCurve:
    """A curve of folds or flips, with its points of codimension two and the reasons why it ends at either end."""

    system: CriticalCycles
    points: tuple[CurvePoint, ...] = field(repr=False)
    special: tuple[Degenerate, ...]
    ends: tuple[tuple[End, str], tuple[End, str]]

    @property
    def plane(self) -> Array:
        """The points of the curve in the plane of the two parameters, one row per point."""
        return np.array([point.z[-2:] for point in self.points])

    def crossing(self, value: float) -> list[Array]:
        """The points of the curve whose first parameter is `value`, each corrected by Newton's method."""
        return arc.passing(self.system, self.points, -2, value)


def curve(
    ring: Recurrence,
    kind: BifurcationKind,
    x: Array,
    two: tuple[str, str],
    near: tuple[float, float],
    box: Box,
    fixed: Parameters | None = None,
    steps: Steps | None = None,
    tick: Tick | None = None,
    unit: float = SHAPE,
) -> CodimensionOneCurve:
    """The curve of cycles with the bifurcation `kind`, through the one near `x` and `near`, in both directions inside
    `box`.

    `unit` is the range of a shape parameter; the lengths of steps are proportional to it.

    >>> from verification.cycles.recurrence import henon
    >>> flip, box = BifurcationKind.FLIP, ((0.0, 0.9), (0.0, 2.0))
    >>> found = curve(henon(1), flip, np.array([0.95]), ("b", "a"), (0.3, 0.37), box)
    >>> bool(np.allclose(found.plane[:, 1], 3 * (1 - found.plane[:, 0]) ** 2 / 4))
    True
    """
    z = np.append(np.asarray(x, dtype=float), near)
    system = CriticalCycles.near(ring, kind, two, z, fixed, unit)
    row = np.zeros(len(z))
    row[-2] = 1.0
    try:
        z, _ = arc.corrected(system, z, row, near[0])
    except LostError:
        raise ValueError(
            f"{system.label}: no such cycle is found near {two[0]} = {near[0]}, {two[1]} = {near[1]}"
        ) from None
    system = system.renewed(z)
    tangent = arc.tangent_at(system, z, row)
    paths: list[Path] = []
    for way in (-1, 1):
        first = CurvePoint(z, way * tangent, 0.0, system.tests(z))
        limits = {len(z) - 2: box[0], len(z) - 1: box[1]}
        paths.append(arc.follow(system, first, limits, steps, tick))
        if paths[-1].end is End.CLOSED:
            break
    special = [found for path in paths for found in degenerate(system, path)]
    back, forth = paths[0], paths[-1]
    points = (*reversed(back.points[1:]), *forth.points) if len(paths) == 2 else back.points
    return CodimensionOneCurve(system, tuple(points), tuple(special), ((back.end, back.why), (forth.end, forth.why)))


def degenerate(system: CriticalCycles, path: Path) -> list[Degenerate]:
    """The points of codimension two between neighbouring points of a path, and a resonance at its end."""
    found = []
    for a, b in pairwise(path.points):
        for name in ("bend", "other_one", "other_minus_one"):
            before, after = a.tests[name], b.tests[name]
            if before * after < 0 and min(abs(before), abs(after)) > NOISE:
                try:
                    found.append(Degenerate(MEANING[system.kind, name], arc.zero(system.renewed(a.z), a, b, name)))
                except ValueError:
                    continue
    last = path.points[-1]
    for name in ("other_one", "other_minus_one"):
        if path.end is End.INTERVAL and abs(last.tests[name]) < 1e-7:
            found.append(Degenerate(MEANING[system.kind, name], last))
    return found
