"""A cycle as a ring of three-term rules: what a branch is followed on, a billiard's or any other map's.

At each bounce one equation `R(before, here, after, letters) = 0` ties three neighbours. Around the end
`x[n] = turn*x[0] + shift`: a full cycle has `turn = 1`, `shift = 0`; half of a mirror-symmetric one has
`turn = -1`, and one bounce of a polygon has `shift = 2*pi*p/q`. The linear part along the ring is that
of the map, so its multipliers come from three diagonals and no derivative of the map is needed.

Maps whose bifurcations are published: the engine that follows billiards must find them too.

Logistic, `x -> r*x*(1 - x)` [May1976]. Henon, `x -> 1 - a*x**2 + y`, `y -> b*x`, as one rule in three
successive `x` [Henon1976]. Delayed logistic, `x -> r*x*(1 - y)`, `y -> x` [MaynardSmith1968], for its torus.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations_with_replacement
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Symbol, diff

from symbolic.generation.text import Kernel, kernel, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables.table import Table
from verification.arithmetic.series import Jet
from verification.arithmetic.words import ARRAYS, Arithmetic
from verification.cycles.recurrence.closure import IDENTITY, Closure
from verification.maps.admissible import convex

Array = NDArray[np.float64]
Letters = Mapping[str, float]
Pair = tuple[int, int]


@dataclass(frozen=True)
class Terms:
    """The rule along a ring, an entry for each bounce; derivatives by (before, here, after) and by letters."""

    value: Array
    slope: tuple[Array, Array, Array]
    by: dict[str, Array]
    bend: dict[Pair, Array]
    slope_by: dict[str, tuple[Array, Array, Array]]


def around(closure: Closure, x: Array) -> Array:
    """`x` with a neighbour at either end."""
    return np.array(closure.padded(x, closure.radians))  # type: ignore[arg-type]  # an array is a sequence here


class Recurrence(Protocol):
    """What can be followed: `terms` at a ring, and `rule` on other kinds of number."""

    @property
    def label(self) -> str:
        """What messages call it."""

    @property
    def period(self) -> int:
        """Bounces of the ring."""

    @property
    def closure(self) -> Closure:
        """How it closes."""

    @property
    def letters(self) -> tuple[str, ...]:
        """The letters that it can be followed in."""

    def terms(self, x: Array, at: Letters, order: int) -> Terms:
        """The rule and its derivatives up to `order`."""

    def rule(self, arithmetic: Arithmetic, ring: tuple[Any, Any, Any], at: Letters) -> Any:
        """The rule at `(before, here, after)`."""

    def doubled(self) -> "Recurrence":
        """The ring run through twice."""

    def obstacle(self, x: Array, at: Letters) -> str:
        """Why `x` is no cycle although the rules hold; empty when nothing is in the way."""


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
                angle = _loaded_chord(self.table, *pair, 0, arithmetic)
                pair_of = (Jet(*(c[chosen] for c in x.c)) for x in (here, other))
                for row, value in zip(total, angle(*pair_of, *shape)[0].c, strict=True):
                    row[chosen] += factor * value
        return Jet(*total)

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
        names = chord_kernel(self.table, 0, 0, order).results
        found = {name: np.empty(len(parts)) for name in names}
        with np.errstate(all="ignore"):
            for pair in set(zip(parts, others, strict=True)):
                chosen = np.array([p == pair for p in zip(parts, others, strict=True)])
                values = _loaded_chord(self.table, *pair, order, arithmetic)(here[chosen], there[chosen], *shape)
                for name, value in zip(names, values, strict=True):
                    found[name][chosen] = value
        return found


@cache
def _map_of(table: Table, maker: Any) -> Any:
    return maker(table, lam=1)


_CHORDS: dict[tuple[Any, ...], Any] = {}


def _loaded_chord(table: Table, here: int, there: int, order: int, arithmetic: Arithmetic) -> Any:
    """The chord angle on the numbers of `arithmetic`, loaded once for each."""
    key = table, here, there, order, id(arithmetic)
    if key not in _CHORDS:
        _CHORDS[key] = arithmetic, load(chord_kernel(table, here, there, order), arithmetic)
    return _CHORDS[key][1]


BEFORE, HERE, AFTER = (Symbol(name, real=True) for name in ("before", "here", "after"))


@dataclass(frozen=True)
class Explicit:
    """Cycles of a map given by a formula: `residual` in `BEFORE`, `HERE`, `AFTER` and `parameters`."""

    name: str
    residual: Expr
    parameters: tuple[Symbol, ...]
    period: int
    closure: Closure = IDENTITY

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{self.name}, period {self.period}"

    @property
    def letters(self) -> tuple[str, ...]:
        """The parameters' names."""
        return tuple(p.name for p in self.parameters)

    def terms(self, x: Array, at: Letters, order: int) -> Terms:
        """The rule and its derivatives up to second order, whatever `order` is."""
        ring, values = around(self.closure, x), [at[name] for name in self.letters]
        made = load(_explicit(self.residual, self.parameters), ARRAYS)(ring[:-2], ring[1:-1], ring[2:], *values)
        full = [np.broadcast_to(np.asarray(v, dtype=float), x.shape) for v in made]
        n = len(self.parameters)
        pairs = list(combinations_with_replacement(range(3), 2))
        by = dict(zip(self.letters, full[4 : 4 + n], strict=True))
        bend = dict(zip(pairs, full[4 + n : 10 + n], strict=True))
        rest = full[10 + n :]
        mixed = {name: (rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]) for i, name in enumerate(self.letters)}
        return Terms(full[0], (full[1], full[2], full[3]), by, bend, mixed)

    def rule(self, arithmetic: Arithmetic, ring: tuple[Any, Any, Any], at: Letters) -> Any:
        """The rule at `(before, here, after)`."""
        return load(_plain(self.residual, self.parameters), arithmetic)(*ring, *(at[name] for name in self.letters))[0]

    def doubled(self) -> "Explicit":
        """The ring run through twice."""
        return replace(self, period=2 * self.period, closure=self.closure.twice())

    def obstacle(self, x: Array, at: Letters) -> str:
        """Nothing is ever in the way of a formula."""
        return ""


@cache
def _plain(residual: Expr, parameters: tuple[Symbol, ...]) -> Kernel:
    return kernel("rule", [BEFORE, HERE, AFTER, *parameters], {"residual": residual})


@cache
def _explicit(residual: Expr, parameters: tuple[Symbol, ...]) -> Kernel:
    ring = (BEFORE, HERE, AFTER)
    values = {"residual": residual} | {f"d_{s}": diff(residual, s) for s in (*ring, *parameters)}
    values |= {f"d_{r}_{s}": diff(residual, r, s) for r, s in combinations_with_replacement(ring, 2)}
    values |= {f"d_{p}_{s}": diff(residual, p, s) for p in parameters for s in ring}
    return kernel("rule_and_derivatives", [BEFORE, HERE, AFTER, *parameters], values)


r, a, b = (Symbol(name, real=True) for name in "rab")


def logistic(period: int) -> Explicit:
    """Cycles of the logistic map; the letter is `r`."""
    return Explicit("logistic", AFTER - r * HERE * (1 - HERE), (r,), period)


def henon(period: int) -> Explicit:
    """Cycles of the Henon map; the letters are `a` and `b`."""
    return Explicit("Henon", AFTER - 1 + a * HERE**2 - b * BEFORE, (a, b), period)


def delayed(period: int) -> Explicit:
    """Cycles of the delayed logistic map; the letter is `r`."""
    return Explicit("delayed logistic", AFTER - r * HERE * (1 - BEFORE), (r,), period)


def cubic(period: int) -> Explicit:
    """Cycles of `x -> r*x - x**3`; the letter is `r`."""
    return Explicit("cubic", AFTER - r * HERE + HERE**3, (r,), period)
