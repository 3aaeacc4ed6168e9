"""A saddle: a cycle modulo a symmetry of the table, with its two multipliers.

After its bounces `x[0] ... x[p-1]` the cycle repeats as its image `x[i+p] = turn*x[i] + shift`: a
triangle is one bounce and a turn by a third, a chord between two mirror images one bounce and a mirror.
The multipliers are those of the map followed by that symmetry undone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from verification.cycles.recurrence.chain import trace_and_determinant
from verification.cycles.recurrence.closure import IDENTITY, Closure
from verification.cycles.shooting.small import solved
from verification.proofs.manifolds.plane_map import PlaneMap, largest

STEPS = 60


@dataclass(frozen=True)
class Orbit:
    """What identifies a cycle: starting values for its bounces, and how it repeats."""

    name: str
    start: tuple[float, ...]
    closure: Closure = IDENTITY


@dataclass(frozen=True)
class Saddle:
    """A cycle at one value of the letter; `stable` and `unstable` are its multipliers."""

    orbit: Orbit
    map: PlaneMap
    letter: Any
    points: tuple[Any, ...]
    stable: Any
    unstable: Any

    def around(self) -> list[Any]:
        """The points with a neighbour more on either side."""
        return padded(self.orbit, self.map, self.points)


def padded(orbit: Orbit, map: PlaneMap, points: Sequence[Any]) -> list[Any]:
    """`x[-1], x[0], ..., x[p]`."""
    return orbit.closure.padded(points, orbit.closure.angle(map.words))


def slopes(orbit: Orbit, map: PlaneMap, points: Sequence[Any], letter: Any) -> list[tuple[Any, Any, Any]]:
    """The derivatives of the rule at each point by the neighbour before, itself and the one after."""
    ring = padded(orbit, map, points)
    return [map.slopes(ring[i : i + 3], letter) for i in range(len(points))]


def matrix(orbit: Orbit, rows: Sequence[tuple[Any, Any, Any]], factor: Any = 1) -> list[list[Any]]:
    """The linearised rules on displacements that come back as `factor` times their image."""
    p = len(rows)
    entries: list[list[Any]] = [[0] * p for _ in range(p)]
    for i, (before, here, after) in enumerate(rows):
        entries[i][i - 1] += before * (1 if i else orbit.closure.turn / factor)
        entries[i][i] += here
        entries[i][(i + 1) % p] += after * (1 if i < p - 1 else orbit.closure.turn * factor)
    return entries


def saddle(orbit: Orbit, map: PlaneMap, letter: Any) -> Saddle:
    """The cycle near its starting values, by Newton's method in the numbers of the map.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> found = saddle(Orbit("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> print(f"{found.unstable:.6f} {found.stable:.6f}")
    -1.923739 0.155946
    """
    points = [letter * 0 + x for x in orbit.start]
    before = float("inf")
    for _ in range(STEPS):
        ring = padded(orbit, map, points)
        rule = [map.rule(ring[i : i + 3], letter) for i in range(len(points))]
        rows = matrix(orbit, slopes(orbit, map, points, letter))
        correction = solved([[*row, r] for row, r in zip(rows, rule, strict=True)])
        points = [x - d for x, d in zip(points, correction, strict=True)]
        size = max(largest(d) for d in correction)
        if size == 0 or (not size < before / 2 and before < 1e-10):
            stable, unstable = multipliers(orbit, map, points, letter)
            return Saddle(orbit, map, letter, tuple(points), stable, unstable)
        before = size
    raise ValueError(
        f"{map.label}: Newton's method did not find the {orbit.name} at {float(letter)} from {orbit.start}"
    )


def multipliers(orbit: Orbit, map: PlaneMap, points: Sequence[Any], letter: Any) -> tuple[Any, Any]:
    """The smaller and the larger multiplier in absolute value, of a cycle with real ones."""
    trace, determinant = trace_and_determinant(slopes(orbit, map, points, letter), orbit.closure.turn)
    square = trace * trace - 4 * determinant
    if not square > 0:
        raise ValueError(f"{map.label}: the {orbit.name} is no saddle at {float(letter)}; its multipliers are complex")
    larger = (trace + (1 if trace > 0 else -1) * map.words["sqrt"](square)) / 2
    return determinant / larger, larger
