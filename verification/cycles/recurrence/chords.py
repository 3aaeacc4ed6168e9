"""Periodic orbits of a billiard: the collision rule in the angles of the two chords that meet at each bounce."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel
from symbolic.tables.table import Table
from verification.arithmetic.balls import ARRAYS, FLOAT64, Arithmetic
from verification.arithmetic.series import Jet
from verification.cycles.recurrence.recurrence import IDENTITY, Array, Closure, Letters, Rule, Slopes, Terms, around
from verification.maps.first_hit import convex


class ChordAngles:
    """The angle of a chord with the normal at its start, between any two components, over one kind of number.

    >>> from symbolic.tables import circle
    >>> from verification.arithmetic.balls import FLOAT64
    >>> round(ChordAngles(circle, FLOAT64)(0, 0, 0)(0.0, 3.0)[0], 12)  # (pi - 3)/2
    0.070796326795
    """

    def __init__(self, table: Table, arithmetic: Arithmetic) -> None:
        self.table, self.arithmetic = table, arithmetic
        self.loaded: dict[tuple[int, int, int], Callable[..., Any]] = {}

    def __call__(self, here: int, there: int, order: int) -> Callable[..., Any]:
        """The kernel from component `here` to `there`, with derivatives up to `order`; loaded once."""
        key = here, there, order
        if key not in self.loaded:
            self.loaded[key] = load(chord_kernel(self.table, *key), self.arithmetic)
        return self.loaded[key]

    def places(self, order: int) -> dict[str, int]:
        """Where a kernel returns each derivative."""
        return {name: i for i, name in enumerate(chord_kernel(self.table, 0, 0, order).results)}


def chord_angles(table: Table, arithmetic: Arithmetic) -> ChordAngles:
    """The chord angles of a table; in float64 the same each time, as those are asked for most often."""
    kept = arithmetic is ARRAYS or arithmetic is FLOAT64
    return _in_float64(table, arithmetic is ARRAYS) if kept else ChordAngles(table, arithmetic)


@cache
def _in_float64(table: Table, arrays: bool) -> ChordAngles:
    return ChordAngles(table, ARRAYS if arrays else FLOAT64)


@dataclass(frozen=True)
class Chords:
    """Cycles of a billiard by the collision rule; letters are `lam` and the table's free shapes."""

    table: Table
    components: tuple[int, ...]
    closure: Closure = IDENTITY

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{self.table.name}, period {self.period}"

    @property
    def period(self) -> int:
        """Bounces of the ring."""
        return len(self.components)

    @property
    def letters(self) -> tuple[str, ...]:
        """`lam` and the shapes."""
        return "lam", *(p.symbol.name for p in self.table.shapes)

    def terms(self, x: Array, at: Letters, order: int) -> Terms:
        """The collision rule and its derivatives.

        >>> from symbolic.tables import ellipse
        >>> axis = Chords(ellipse.at(a=2), (0, 0))
        >>> bool(abs(axis.terms(np.array([np.pi / 2, -np.pi / 2]), {"lam": 0.5}, 1).value).max() < 1e-15)
        True
        """
        lam, ring = at["lam"], around(self.closure, x)
        shape = [at[name] for name in self.letters[1:]]
        f = self._angles(ARRAYS, 1, ring[1:-1], ring[2:], shape, order)
        b = self._angles(ARRAYS, -1, ring[1:-1], ring[:-2], shape, order)
        none = np.zeros(self.period)
        by, slope_by, bend = {"lam": b["angle"]}, {}, {}
        for s in self.letters[1:]:
            by[s] = f[f"angle_{s}"] + lam * b[f"angle_{s}"]
        if order > 1:
            bend = {
                (0, 0): lam * b["angle_11"],
                (0, 1): lam * b["angle_01"],
                (1, 1): f["angle_00"] + lam * b["angle_00"],
                (1, 2): f["angle_01"],
                (2, 2): f["angle_11"],
            }
            slope_by = {"lam": (b["angle_1"], b["angle_0"], none)}
            for s in self.letters[1:]:
                own = f[f"angle_0_{s}"] + lam * b[f"angle_0_{s}"]
                slope_by[s] = lam * b[f"angle_1_{s}"], own, f[f"angle_1_{s}"]
        slope = lam * b["angle_1"], f["angle_0"] + lam * b["angle_0"], f["angle_1"]
        return Terms(f["angle"] + lam * b["angle"], slope, by, bend, slope_by)

    def rule(self, arithmetic: Arithmetic, ring: tuple[Any, Any, Any], at: Letters) -> Any:
        """The rule at `(before, here, after)`, Taylor series of arrays."""
        before, here, after = ring
        shape = [at[name] for name in self.letters[1:]]
        parts, total = self.components, [np.zeros(self.period) for _ in here.c]
        for way, other, factor in ((1, after, 1.0), (-1, before, at["lam"])):
            pairs = list(zip(parts, (parts[(i + way) % len(parts)] for i in range(len(parts))), strict=True))
            for pair in set(pairs):
                chosen = np.array([p == pair for p in pairs])
                angle = chord_angles(self.table, arithmetic)(*pair, 0)
                pair_of = (Jet(*(c[chosen] for c in x.c)) for x in (here, other))
                for row, value in zip(total, angle(*pair_of, *shape)[0].c, strict=True):
                    row[chosen] += factor * value
        return Jet(*total)

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The collision rule at single bounces.

        >>> from symbolic.tables import ellipse
        >>> from verification.arithmetic.balls import FLOAT64
        >>> low, high = -np.pi / 2, np.pi / 2
        >>> value, _ = Chords(ellipse.at(a=2), (0, 0)).over(FLOAT64)(0, (low, high, low), {"lam": 0.5})
        >>> abs(value) < 1e-15
        True
        """
        angles, parts = chord_angles(self.table, arithmetic), self.components

        def rule(i: int, near: Sequence[Any], at: Mapping[str, Any]) -> tuple[Any, Slopes]:
            (before, here, after), lam = near, at["lam"]
            shape = [at[name] for name in self.letters[1:]]
            f = angles(parts[i], parts[(i + 1) % len(parts)], 1)(here, after, *shape)
            b = angles(parts[i], parts[i - 1], 1)(here, before, *shape)
            return f[0] + lam * b[0], (lam * b[2], f[1] + lam * b[1], f[2])

        return rule

    def doubled(self) -> "Chords":
        """The ring run through twice."""
        return replace(self, components=self.components * 2, closure=self.closure.twice())

    def angles(self, x: Array, at: Letters) -> tuple[Array, Array]:
        """Exit and incidence angles at each bounce, in radians."""
        ring, shape = around(self.closure, x), [at[name] for name in self.letters[1:]]
        out = self._angles(ARRAYS, 1, ring[1:-1], ring[2:], shape, 0)["angle"]
        return out, self._angles(ARRAYS, -1, ring[1:-1], ring[:-2], shape, 0)["angle"]

    def obstacle(self, x: Array, at: Letters) -> str:
        """A bounce beyond its component, or next to its neighbour."""
        if len(self.table.components) > 1:
            for i, (part, value) in enumerate(zip(self.components, x, strict=True)):
                component = self.table.components[part]
                if not float(component.start) <= value <= float(component.end):
                    return f"bounce {i} left the {component.name} at theta = {value:.6g}"
        ring, parts = around(self.closure, x), (*self.components, self.components[0])
        apart = np.abs(np.sin((ring[2:] - ring[1:-1]) / 2))
        for i in range(self.period):
            if parts[i] == parts[i + 1] and apart[i] < 1e-6:
                return f"bounces {i} and {i + 1} met at theta = {x[i]:.6g}, where no chord is left"
        return "" if self.table.shapes or convex(self.table) is True else self._obstructed(x, at)

    def _obstructed(self, x: Array, at: Letters) -> str:
        """The first chord that meets the boundary on its way, in a table that need not be convex."""
        from numeric import PinballMap

        out, _ = self.angles(x, at)
        if np.max(np.abs(out)) >= np.pi / 2:
            return f"the chord from bounce {int(np.argmax(np.abs(out)))} does not point into the table"
        landed = _map_of(self.table, PinballMap).step(x, out, np.array(self.components))
        after = np.roll(np.array(self.components), -1)
        expected = around(self.closure, x)[2:]
        for i in range(self.period):
            if landed.code[i]:
                return f"the flight from bounce {i} ends at a {landed.status[i].name.lower()}"
            gap = expected[i] - landed.theta[i]
            gap = np.sin(gap / 2) if len(self.table.components) == 1 else gap
            if landed.component[i] != after[i] or abs(gap) > 1e-6:
                return f"the chord from bounce {i} meets the boundary on its way, at theta = {landed.theta[i]:.6g}"
        return ""

    def nearest_joins(self, x: Array) -> list[float | None]:
        """The nearer end of its component for each bounce; None without joins."""
        if len(self.table.components) == 1:
            return [None] * self.period
        parts = [self.table.components[part] for part in self.components]
        both = [(float(c.start), float(c.end)) for c in parts]
        return [min(ends, key=lambda e: abs(e - value)) for ends, value in zip(both, x, strict=True)]

    def _angles(
        self, arithmetic: Arithmetic, way: int, here: Array, there: Array, shape: list[float], order: int
    ) -> dict[str, Array]:
        parts = self.components
        others = tuple(parts[(i + way) % len(parts)] for i in range(len(parts)))
        angles = chord_angles(self.table, arithmetic)
        names = angles.places(order)
        found = {name: np.empty(len(parts)) for name in names}
        with np.errstate(all="ignore"):
            for pair in set(zip(parts, others, strict=True)):
                chosen = np.array([p == pair for p in zip(parts, others, strict=True)])
                values = angles(*pair, order)(here[chosen], there[chosen], *shape)
                for name, value in zip(names, values, strict=True):
                    found[name][chosen] = value
        return found


@cache
def _map_of(table: Table, maker: Any) -> Any:
    return maker(table, lam=1)
