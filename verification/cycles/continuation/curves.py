"""Curves of bifurcations in two letters, and the points of codimension two on them.

    on a fold:   cusp                   the fold's own coefficient vanishes
                 1:1 resonance          the other multiplier is 1 too: Bogdanov-Takens
                 fold-flip              the other multiplier is -1
    on a flip:   generalised flip       the flip's own coefficient vanishes
                 1:2 resonance          the other multiplier is -1 too
                 fold-flip              the other multiplier is 1

At `lam = 1` the map keeps an area, so every fold that gets there ends in a 1:1 resonance and every
doubling in a 1:2 resonance, and the curve ends with it: contraction has no other side there.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise

import numpy as np

from verification.cycles.continuation import arc
from verification.cycles.continuation.arc import End, LostError, Path, Point, Steps
from verification.cycles.continuation.systems import Critical
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.recurrence import Array, Letters, Recurrence

Box = tuple[tuple[float, float], tuple[float, float]]
NOISE = 1e-10


class Special(Enum):
    """Points of codimension two."""

    CUSP = "cusp"
    ONE_ONE = "1:1 resonance (Bogdanov-Takens)"
    ONE_TWO = "1:2 resonance"
    FOLD_FLIP = "fold-flip"
    GENERALISED_FLIP = "generalised flip"


MEANING = {
    (BifurcationKind.FOLD, "bend"): Special.CUSP,
    (BifurcationKind.FOLD, "other_one"): Special.ONE_ONE,
    (BifurcationKind.FOLD, "other_minus_one"): Special.FOLD_FLIP,
    (BifurcationKind.FLIP, "bend"): Special.GENERALISED_FLIP,
    (BifurcationKind.FLIP, "other_one"): Special.FOLD_FLIP,
    (BifurcationKind.FLIP, "other_minus_one"): Special.ONE_TWO,
}


@dataclass(frozen=True)
class Degenerate:
    """A point of codimension two on a curve."""

    what: Special
    point: Point = field(repr=False)

    @property
    def letters(self) -> tuple[float, float]:
        """Where in the plane of the letters."""
        return float(self.point.z[-2]), float(self.point.z[-1])


@dataclass(frozen=True)
class Curve:
    """A curve of folds or flips, with the points of codimension two and how either end came about."""

    system: Critical
    points: tuple[Point, ...] = field(repr=False)
    special: tuple[Degenerate, ...]
    ends: tuple[tuple[End, str], tuple[End, str]]

    @property
    def plane(self) -> Array:
        """The curve in the plane of the letters, a row for each point."""
        return np.array([point.z[-2:] for point in self.points])

    def crossing(self, value: float) -> list[Array]:
        """The points of the curve whose first letter is `value`, each solved for."""
        found = []
        for a, b in pairwise(self.points):
            if (a.z[-2] - value) * (b.z[-2] - value) < 0 or b.z[-2] == value:
                row = np.append(np.zeros(len(a.z) - 2), [1.0, 0.0])
                share = (value - a.z[-2]) / (b.z[-2] - a.z[-2])
                guess = a.z + share * (b.z - a.z)
                found.append(arc.corrected(self.system.renewed(a.z), guess, row, value)[0])
        return found


def curve(
    ring: Recurrence,
    kind: BifurcationKind,
    x: Array,
    two: tuple[str, str],
    near: tuple[float, float],
    box: Box,
    fixed: Letters | None = None,
    steps: Steps | None = None,
    tick: Callable[[Point], None] | None = None,
) -> Curve:
    """The curve of `kind` through the critical cycle near `x`, at letters near `near`, both ways inside `box`.

    >>> from verification.cycles.recurrence.explicit import henon
    >>> flip, box = BifurcationKind.FLIP, ((0.0, 0.9), (0.0, 2.0))
    >>> found = curve(henon(1), flip, np.array([0.95]), ("b", "a"), (0.3, 0.37), box)
    >>> bool(np.allclose(found.plane[:, 1], 3 * (1 - found.plane[:, 0]) ** 2 / 4))
    True
    """
    z = np.append(np.asarray(x, dtype=float), near)
    system = Critical.near(ring, kind, two, z, fixed)
    row = np.zeros(len(z))
    row[-2] = 1.0
    try:
        z, _ = arc.corrected(system, z, row, near[0])
    except LostError:
        raise ValueError(f"{system.label}: there is none near {two[0]} = {near[0]}, {two[1]} = {near[1]}") from None
    system = system.renewed(z)
    tangent = arc.tangent_at(system, z, row)
    paths: list[Path] = []
    for way in (-1, 1):
        first = Point(z, way * tangent, 0.0, system.tests(z))
        limits = {len(z) - 2: box[0], len(z) - 1: box[1]}
        paths.append(arc.follow(system, first, limits, steps, tick))
        if paths[-1].end is End.CLOSED:
            break
    special = [found for path in paths for found in degenerate(system, path)]
    back, forth = paths[0], paths[-1]
    points = (*reversed(back.points[1:]), *forth.points) if len(paths) == 2 else back.points
    return Curve(system, tuple(points), tuple(special), ((back.end, back.why), (forth.end, forth.why)))


def degenerate(system: Critical, path: Path) -> list[Degenerate]:
    """The points of codimension two between neighbours of a path, and a resonance at its end."""
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
