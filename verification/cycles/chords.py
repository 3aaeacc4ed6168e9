"""Periodic orbits of a billiard: the collision rule in the angles of the two chords that meet at each bounce."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from symbolic.expressions.parts import parted
from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel, ends_kernel, law_kernel, partials
from symbolic.tables.definition import table_boundary
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import ARRAYS, FLOAT64, Arithmetic, between
from verification.cycles.lengths import arc_length, map_of
from verification.cycles.recurrence import IDENTITY, Array, Closure, Pair, Parameters, Rule, Terms, X, around
from verification.maps.first_hit import closes_smoothly, convex

SWEEPS = 80  # bisections at most, between Newton steps, until a landing is found
CLOSE = 1e-13
Slopes = Mapping[str, Any]  # of a law, by name
End = tuple[int, int, Any]  # of a chord: its component, the number of the bounce, and its parameter


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
        self.in_parts: dict[tuple[int, int, int], tuple[Callable[..., Any], ...]] = {}

    def __call__(self, here: int, there: int, order: int) -> Callable[..., Any]:
        """The kernel from component `here` to `there`, with derivatives up to `order`; loaded once."""
        key = here, there, order
        if key not in self.loaded:
            self.loaded[key] = load(chord_kernel(self.table, *key), self.arithmetic)
        return self.loaded[key]

    def between(self, order: int, shape: Sequence[Any]) -> Callable[[End, End], Sequence[Any]]:
        """The angle from one end of a chord to another, for an orbit's chords: what belongs to an end is computed once.

        Ends are told apart by their numbers, so one number is one end for as long as the function is kept.
        """
        known: dict[tuple[int, int, int, int], Any] = {}
        names = tuple(p.symbol.name for p in self.table.shapes)

        def angle(here: End, there: End) -> Sequence[Any]:
            key = here[0], there[0], order
            if self.arithmetic is FLOAT64:  # in which a sine costs no more than to look it up
                return self(*key)(here[2], there[2], *shape)  # type: ignore[no-any-return]
            if key not in self.in_parts:
                parts = parted(chord_kernel(self.table, *key), ("theta0", *names), ("theta1", *names))
                self.in_parts[key] = tuple(load(part, self.arithmetic) for part in parts)
            *alone, rest = self.in_parts[key]
            for k, (part, end) in enumerate(zip(alone, (here, there), strict=True)):
                if (k, end[1], here[0], there[0]) not in known:
                    known[k, end[1], here[0], there[0]] = part(end[2], *shape)
            both = (known[k, end[1], here[0], there[0]] for k, end in enumerate((here, there)))
            return rest(here[2], there[2], *shape, *chain.from_iterable(both))  # type: ignore[no-any-return]

        return angle


@cache
def _places(table: Table, order: int) -> dict[str, int]:
    return {name: i for i, name in enumerate(partials(tuple(p.symbol for p in table.shapes), order))}


def chord_angles(table: Table, arithmetic: Arithmetic) -> ChordAngles:
    """The chord angles of a table; in float64 the same each time, as those are asked for most often."""
    kept = arithmetic is ARRAYS or arithmetic is FLOAT64
    return _in_float64(table, arithmetic is ARRAYS) if kept else ChordAngles(table, arithmetic)


@cache
def _in_float64(table: Table, arrays: bool) -> ChordAngles:
    return ChordAngles(table, ARRAYS if arrays else FLOAT64)


@dataclass(frozen=True)
class Chords:
    """Cycles of a billiard by the collision rule; parameters are `lam`, the table's free shapes, and the law's own."""

    table: Table
    components: tuple[int, ...]
    closure: Closure = IDENTITY
    law: Law = PAPERS_LAW

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{self.table.name}, period {self.period}"

    @property
    def period(self) -> int:
        """Bounces of the ring."""
        return len(self.components)

    @property
    def parameters(self) -> tuple[str, ...]:
        """`lam`, the shapes, and what the law has besides."""
        return tuple(dict.fromkeys(("lam", *self.shapes, *self.law.parameters)))

    @property
    def shapes(self) -> tuple[str, ...]:
        """The table's free shapes."""
        return tuple(p.symbol.name for p in self.table.shapes)

    def terms(self, x: Array, at: Parameters, order: int) -> Terms[Array]:
        """The collision rule and its derivatives.

        >>> from symbolic.tables import ellipse
        >>> axis = Chords(ellipse.at(a=2), (0, 0))
        >>> bool(abs(axis.terms(np.array([np.pi / 2, -np.pi / 2]), {"lam": 0.5}, 1).value).max() < 1e-15)
        True
        """
        ring, shape = around(self.closure, x), [at[name] for name in self.shapes]
        ahead = self._angles(1, ring[1:-1], ring[2:], shape, order)
        back = self._angles(-1, ring[1:-1], ring[:-2], shape, order)
        return self._terms(ahead, back, at["lam"], order, self._all_reflected(back[0], ring[1:-1], at, order))

    def _all_reflected(self, eta: Array, here: Array, at: Parameters, order: int) -> Slopes:
        """The exit angles of a law at all bounces; one that speaks of arc length has a formula on each component."""
        if not self.law.measured:
            return self._reflected(ARRAYS, 0, eta, here, at, order)
        found: dict[str, Array] = {}
        for part in set(self.components):
            on = np.array(self.components) == part
            for name, value in self._reflected(ARRAYS, part, eta[on], here[on], at, order).items():
                found.setdefault(name, np.zeros(len(here)))[on] = value
        return found

    def _reflected(
        self, arithmetic: Arithmetic, part: int, eta: Any, here: Any, at: Mapping[str, Any], order: int
    ) -> Slopes:
        """The exit angle of a law that is no uniform contraction, and its derivatives by name; empty for that."""
        if self.law.uniform:
            return {}
        law = self.law.on(self.table, part)
        own, place = [at[name] for name in law.parameters], [here]
        if not law.measured:
            made = law_kernel(law, order)
        else:
            made, length = law_kernel(law, order, self.table.components[0]), arc_length(self.table)
            place = length.placed(arithmetic, here)
        return dict(zip(made.results, load(made, arithmetic)(eta, at["lam"], *place, *own), strict=True))

    def _terms(self, f: Sequence[X], b: Sequence[X], lam: Any, order: int, law: Slopes) -> Terms[X]:
        """The rule from the angles of the chords ahead and back, with derivatives as the kernels return them."""
        zero: Any = 0 * f[0]  # type: ignore[operator]  # of the same kind
        if law:
            return self._bent(f, b, order, law, zero)
        if not order:
            return Terms(f[0] + lam * b[0], (zero, zero, zero), {}, {}, {})
        k, shapes = _places(self.table, order), self.shapes
        by = {"lam": b[0]} | {s: f[k[f"angle_{s}"]] + lam * b[k[f"angle_{s}"]] for s in shapes}
        bend: dict[Pair, X] = {}
        slope_by: dict[str, tuple[X, X, X]] = {}
        if order > 1:
            hh, ho, oo = k["angle_00"], k["angle_01"], k["angle_11"]
            bend = {(0, 0): lam * b[oo], (0, 1): lam * b[ho], (1, 1): f[hh] + lam * b[hh], (1, 2): f[ho], (2, 2): f[oo]}
            slope_by = {"lam": (b[2], b[1], zero)}
            for s in shapes:
                h, o = k[f"angle_0_{s}"], k[f"angle_1_{s}"]
                slope_by[s] = lam * b[o], f[h] + lam * b[h], f[o]
        return Terms(f[0] + lam * b[0], (lam * b[2], f[1] + lam * b[1], f[2]), by, bend, slope_by)

    def _bent(self, f: Sequence[Any], b: Sequence[Any], order: int, law: Slopes, zero: Any) -> Terms[Any]:
        """`A(next) - phi(A(previous))`, with the derivatives of `phi(eta, theta, parameters)` by the chain rule."""
        value = f[0] - (zero + law["phi"])
        if not order:
            return Terms(value, (zero, zero, zero), {}, {}, {})
        k, slope, place = _places(self.table, order), law["phi_eta"], zero + law["phi_theta"]
        ahead = {p: f[k[f"angle_{p}"]] for p in self.shapes}
        back = {p: b[k[f"angle_{p}"]] for p in self.shapes}
        by = {p: ahead.get(p, zero) - (slope * back.get(p, zero) + law.get(f"phi_{p}", zero)) for p in self.parameters}
        bend: dict[Pair, Any] = {}
        slope_by: dict[str, tuple[Any, Any, Any]] = {}
        if order > 1:
            (h, o), (hh, ho, oo) = b[1:3], (k["angle_00"], k["angle_01"], k["angle_11"])
            curved, mixed = law["phi_eta_eta"], law["phi_eta_theta"]
            bend = {(0, 0): -(slope * b[oo] + curved * o * o), (0, 1): -(slope * b[ho] + curved * h * o + mixed * o)}
            here = slope * b[hh] + curved * h * h + 2 * mixed * h + law["phi_theta_theta"]
            bend |= {(1, 1): f[hh] - here, (1, 2): f[ho], (2, 2): f[oo]}
            for p in self.parameters:
                there, own = back.get(p, zero), (law.get(f"phi_eta_{p}", 0), law.get(f"phi_theta_{p}", 0))
                turned = {i: b[k[f"angle_{i}_{p}"]] if p in self.shapes else zero for i in (0, 1)}
                leaving = [f[k[f"angle_{i}_{p}"]] if p in self.shapes else zero for i in (0, 1)]
                before = slope * turned[1] + curved * o * there + own[0] * o
                at = slope * turned[0] + curved * h * there + own[0] * h + mixed * there + own[1]
                slope_by[p] = -before, leaving[0] - at, leaving[1]
        return Terms(value, (-(slope * b[2]), f[1] - (slope * b[1] + place), f[2]), by, bend, slope_by)

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The collision rule at single bounces.

        >>> from symbolic.tables import ellipse
        >>> from verification.arithmetic.balls import FLOAT64
        >>> low, high = -np.pi / 2, np.pi / 2
        >>> found = Chords(ellipse.at(a=2), (0, 0)).over(FLOAT64)(0, (low, high, low), {"lam": 0.5})
        >>> abs(found.value) < 1e-15
        True
        """
        angles = chord_angles(self.table, arithmetic)

        def rule(i: int, near: Sequence[Any], at: Mapping[str, Any], order: int = 1) -> Terms[Any]:
            angle = angles.between(order, [at[name] for name in self.shapes])
            return self._at_bounce(arithmetic, angle, i, near, at, order)

        return rule

    def bounces(self, arithmetic: Arithmetic, padded: Sequence[Any], at: Mapping[str, Any], order: int) -> Terms[Any]:
        """The collision rule at every bounce, of all with the neighbours at either end."""
        angle = chord_angles(self.table, arithmetic).between(order, [at[name] for name in self.shapes])
        near = (padded[i : i + 3] for i in range(self.period))
        return Terms.along([self._at_bounce(arithmetic, angle, i, x, at, order) for i, x in enumerate(near)])

    def _at_bounce(
        self, arithmetic: Arithmetic, angle: Any, i: int, near: Sequence[Any], at: Mapping[str, Any], order: int
    ) -> Terms[Any]:
        parts = self.components
        before, here, after = near
        own = parts[i], i, here
        f = angle(own, (parts[(i + 1) % len(parts)], i + 1, after))
        b = angle(own, (parts[i - 1], i - 1, before))
        return self._terms(f, b, at["lam"], order, self._reflected(arithmetic, parts[i], b[0], here, at, order))

    def doubled(self) -> "Chords":
        """The ring run through twice."""
        return replace(self, components=self.components * 2, closure=self.closure.twice())

    def angles(self, x: Array, at: Parameters) -> tuple[Array, Array]:
        """Exit and incidence angles at each bounce, in radians."""
        ring, shape = around(self.closure, x), [at[name] for name in self.shapes]
        out, into = (self._angles(way, ring[1:-1], end, shape, 0) for way, end in ((1, ring[2:]), (-1, ring[:-2])))
        return out[0], into[0]

    def obstacle(self, x: Array, at: Parameters) -> str:
        """A bounce beyond its component, or next to its neighbour."""
        cut = self.law.measured and self.law.on(self.table, self.components[0]).measured  # where the law may jump
        if cut or not closes_smoothly(self.table):  # beyond its ends another formula runs on along no boundary
            ends = self.ends(at)
            for i, (part, value) in enumerate(zip(self.components, x, strict=True)):
                if not ends[part][0] <= value <= ends[part][1]:
                    return f"bounce {i} left the {self.table.components[part].name} at theta = {value:.6g}"
        ring, parts = around(self.closure, x), (*self.components, self.components[0])
        apart = np.abs(np.sin((ring[2:] - ring[1:-1]) / 2))
        for i in range(self.period):
            if parts[i] == parts[i + 1] and apart[i] < 1e-6:
                return f"bounces {i} and {i + 1} met at theta = {x[i]:.6g}, where no chord is left"
        return "" if _convex_throughout(self.table) else self._obstructed(x, at)

    def _obstructed(self, x: Array, at: Parameters) -> str:
        """The first chord that meets the boundary on its way, in a table that need not be convex."""
        from numeric import PinballMap

        out, _ = self.angles(x, at)
        if np.max(np.abs(out)) >= np.pi / 2:
            return f"the chord from bounce {int(np.argmax(np.abs(out)))} does not point into the table"
        shape: dict[str, Any] = {name: at[name] for name in self.shapes}
        map = PinballMap(self.table, kernels=False, **shape) if shape else map_of(self.table, PinballMap)
        landed = map.step(x, out, np.array(self.components))
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

    def ends(self, at: Parameters) -> list[tuple[float, float]]:
        """Where the parameter of each component of the table starts and ends.

        >>> from symbolic.tables import cuspless
        >>> Chords(cuspless, (1, 0)).ends({})[1]  # the wall
        (-0.4330127018922193, 0.4330127018922193)
        """
        found = _ends(self.table)(*(at[name] for name in self.shapes))
        return list(zip(map(float, found[::2]), map(float, found[1::2]), strict=True))

    def nearest_joins(self, x: Array, at: Parameters) -> list[float | None]:
        """The nearer end of its component for each bounce; None without joins."""
        if len(self.table.components) == 1:
            return [None] * self.period
        known = self.ends(at)
        both = [known[part] for part in self.components]
        return [min(ends, key=lambda e: abs(e - value)) for ends, value in zip(both, x, strict=True)]

    def _angles(self, way: int, here: Array, there: Array, shape: list[float], order: int) -> list[Array]:
        parts = self.components
        pairs = [(part, parts[(i + way) % len(parts)]) for i, part in enumerate(parts)]
        angles = chord_angles(self.table, ARRAYS)
        found = np.empty((len(_places(self.table, order)), len(parts)))
        with np.errstate(all="ignore"):
            for pair in set(pairs):
                chosen = np.array([p == pair for p in pairs])
                for row, value in zip(found, angles(*pair, order)(here[chosen], there[chosen], *shape), strict=True):
                    row[chosen] = value
        return list(found)


@cache
def _ends(table: Table) -> Callable[..., Any]:
    return load(ends_kernel(table), FLOAT64)


@cache
def _convex_throughout(table: Table) -> bool:
    """Is the table proved convex, whatever the numbers of its free shape parameters?"""
    if not table.shapes or "table" in table_boundary(table)[0]:
        return bool(table.shapes) or convex(table) is True
    return convex(table, tuple(between(float(p.range.start), float(p.range.end)) for p in table.shapes)) is True


def landing(table: Table, here: Any, phi: Any, turns: int = 0) -> Any:
    """The parameter, at most a turn after `here + 2*pi*turns`, to which the chord makes the angle `phi`, in float64.

    For tables of one convex component: the angle falls from `pi/2` to `-pi/2` on the way round, so Newton's method is
    kept between bounds; `nan` beyond those angles. Numbers or arrays.

    >>> from symbolic.tables import circle
    >>> round(landing(circle, 0.0, 0.5), 12)  # pi - 2*phi
    2.14159265359
    """
    arrays = bool(np.ndim(here) or np.ndim(phi))
    angle = chord_angles(table, ARRAYS if arrays else FLOAT64)(0, 0, 1)
    pick: Callable[[Any, Any, Any], Any] = np.where if arrays else _either
    if not arrays and not abs(phi) < math.pi / 2:
        return math.nan
    low = here + 2 * math.pi * turns
    high = low + 2 * math.pi
    x = low + math.pi - 2 * phi
    with np.errstate(all="ignore"):
        x = pick((x > low) & (x < high), x, low + math.pi)
        for _ in range(SWEEPS):
            value, _, slope = angle(here, x)[:3]
            low, high = pick(value > phi, x, low), pick(value > phi, high, x)
            better = x - (value - phi) / slope
            better = pick((better > low) & (better < high), better, (low + high) / 2)
            moved, x = abs(better - x), better
            if np.max(moved, initial=0.0, where=np.isfinite(moved)) < CLOSE if arrays else moved < CLOSE:
                break
    return np.where(np.abs(phi) < math.pi / 2, x, math.nan) if arrays else x


def _either(condition: Any, yes: Any, no: Any) -> Any:
    return yes if condition else no
