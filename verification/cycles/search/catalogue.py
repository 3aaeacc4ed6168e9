"""Cycles as a set: each once, whatever bounce it is given from, with what the counts need to know of it."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import pi

import numpy as np

from symbolic.tables.table import Table
from verification.cycles.continuation.linear import Spectrum, spectrum
from verification.cycles.recurrence.chords import Chords
from verification.cycles.search.newton import Array

SAME = 1e-7
FAMILY = 1e-7  # of det(M - 1): a cycle so near the multiplier 1 is one of a family, or bifurcates


@dataclass(frozen=True)
class Found:
    """A cycle of minimal period, its multipliers, and how often it runs around the boundary in one period."""

    components: tuple[int, ...]
    theta: tuple[float, ...]
    phi: tuple[float, ...]
    spectrum: Spectrum
    winding: int

    @property
    def period(self) -> int:
        """Bounces."""
        return len(self.theta)

    def index(self, n: int) -> int:
        """The fixed-point index of `T**n` at a bounce: the sign of `det(1 - M**(n/period))`."""
        one, two = self.spectrum.multipliers
        power = n // self.period
        if power == 1:
            return int(np.sign(self.spectrum.at_one))
        return int(np.sign(((1 - one**power) * (1 - two**power)).real))


@dataclass
class Catalogue:
    """The cycles found so far at one contraction; `degenerate` counts those with the multiplier 1, not filed."""

    table: Table
    lam: float
    cycles: list[Found] = field(default_factory=list)
    marks: dict[int, list[Array]] = field(default_factory=dict)
    degenerate: int = 0

    def add(self, components: tuple[int, ...], x: Array, phi: Array) -> bool:
        """Files a cycle; False when it was there already, or only repeats a shorter one that was."""
        components, x, phi = _minimal(components, x, phi)
        n = len(x)
        mark = _mark(components, x, phi)
        if any(np.max(np.abs(mark - known)) < SAME * n for known in self.marks.get(n, [])):
            return False
        ring = Chords(self.table, components)
        found = spectrum(ring.terms(x, {"lam": self.lam}, 1), ring.closure)
        if abs(found.at_one) < FAMILY:
            self.degenerate += 1
            return False
        self.marks.setdefault(n, []).append(mark)
        theta = np.mod(x + pi, 2 * pi) - pi if len(self.table.components) == 1 else x
        self.cycles.append(
            Found(components, tuple(map(float, theta)), tuple(map(float, phi)), found, _winding(self.table, x))
        )
        return True

    def of(self, n: int) -> Iterator[Found]:
        """The cycles whose bounces are fixed points of `T**n`."""
        return (cycle for cycle in self.cycles if n % cycle.period == 0)

    def rows(self, n: int) -> Array:
        """The cycles that close after `n` bounces, a row of parameters for each bounce they can be begun with."""
        rows = [np.roll(np.tile(c.theta, n // c.period), -k) for c in self.of(n) for k in range(c.period)]
        return np.array(rows).reshape(len(rows), n)

    def count(self, n: int) -> int:
        """The number of cycles of minimal period `n`."""
        return sum(1 for cycle in self.cycles if cycle.period == n)

    def index_sums(self, n: int) -> dict[int, int]:
        """The sum of the indices of the fixed points of `T**n`, for each number of turns around the boundary.

        On a smooth convex table `T` maps the closed annulus of phase points into itself, with degree 1, so
        by Lefschetz every sum is 0: saddles and the other cycles come in equal numbers in each class.
        """
        sums: dict[int, int] = {}
        for cycle in self.of(n):
            turns = cycle.winding * (n // cycle.period)
            sums[turns] = sums.get(turns, 0) + cycle.period * cycle.index(n)
        return sums


def _minimal(components: tuple[int, ...], x: Array, phi: Array) -> tuple[tuple[int, ...], Array, Array]:
    n = len(x)
    for m in (m for m in range(1, n) if n % m == 0):
        same = components == components[m:] + components[:m]
        away = np.abs(np.sin((np.roll(x, -m) - x) / 2)) + np.abs(np.roll(phi, -m) - phi)
        if same and np.max(away) < 1e-6:
            return components[:m], x[:m], phi[:m]
    return components, x, phi


def _mark(components: tuple[int, ...], x: Array, phi: Array) -> Array:
    """Numbers that do not depend on where the cycle is begun, and tell cycles apart."""
    parts, forth = np.array(components), np.roll(x, -1)
    of_place = [np.sum(np.cos(m * x + 0.4) + np.sin(0.7 + m * parts)) for m in (1, 2, 3, 4, 5, 7)]  # symmetric cycles
    of_angle = [np.sum(np.sin(m * phi + 0.3)) for m in (1, 2)]  # cancel all sums but those of their own order
    of_order = [np.sum(np.sin(forth - x)), np.sum(np.cos(x - 0.3) * np.sin(phi)), np.sum(np.cos(x) * np.cos(2 * forth))]
    return np.array([*of_place, *of_angle, *of_order])


def _winding(table: Table, x: Array) -> int:
    """Turns around the boundary in one period, each chord counted by the boundary to its right."""
    if len(table.components) > 1:
        return 0
    return round(float(np.sum(np.mod(np.roll(x, -1) - x, 2 * pi))) / (2 * pi))
