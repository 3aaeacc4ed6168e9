"""Periodic orbits of a billiard: the collision rule in the angles of the two chords that meet at each bounce."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache
from itertools import chain, product
from typing import Any

import numpy as np
from flint import arb
from sympy import srepr

from numeric.lowering.program import kept
from symbolic.expressions.parts import parted
from symbolic.expressions.text import Kernel, load
from symbolic.motion.chords import chord_kernel, ends_kernel, law_kernel, partials
from symbolic.tables.definition import table_boundary
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import ARRAYS, FLOAT64, Arithmetic, between
from verification.cycles.recurrence import IDENTITY, Array, Closure, Pair, Parameters, Rule, Terms, X, around
from verification.maps.first_hit import closes_smoothly, convex
from verification.maps.joins import Joins, joins, over_joins
from verification.maps.measured import arc_length, map_of

SWEEPS = 80  # bisections at most, between Newton steps, until a landing is found
CLOSE = 1e-13
ROUNDED = 1e-12  # of a component's range
Slopes = Mapping[str, Any]  # of a law, by name
Place = tuple[int, Any, Any]  # a component, a parameter on it, and its slope
End = tuple[int, int, Any]  # end of a chord: component, number of the bounce, parameter


@cache
def kept_chord_kernel(table: Table, here: int, there: int, order: int) -> Kernel:
    """The kernel `chord_kernel`, cached on disk: differentiating in SymPy takes as long as importing SymPy."""

    def read(text: str) -> Kernel:
        name, arguments, results, words, body = json.loads(text)
        return Kernel(name, tuple(arguments), tuple(results), tuple(words), body)

    ends = [(table.components[i].name, srepr(table.components[i].point)) for i in (here, there)]
    said = f"chord angle {here} {there} {order}, {ends}, {[p.symbol.name for p in table.shapes]}"
    return kept(said, lambda: json.dumps(astuple(chord_kernel(table, here, there, order))), read)


class ChordAngles:
    """Angle of a chord with the normal at its start, for any two components, in one arithmetic.

    >>> from symbolic.tables import circle
    >>> from verification.arithmetic.balls import FLOAT64
    >>> round(ChordAngles(circle, FLOAT64)(0, 0, 0)(0.0, 3.0)[0], 12)  # (pi - 3)/2
    0.070796326795
    """

    def __init__(self, table: Table, arithmetic: Arithmetic) -> None:
        self.table, self.arithmetic = table, arithmetic
        known = joins(table) if arithmetic in (ARRAYS, FLOAT64) and not closes_smoothly(table) else None
        self.joins = known if known is not None and known.any else None
        self.over_joins = None
        if len(table.components) > 1 and isinstance(arithmetic.pi, arb):
            self.over_joins = over_joins(table, arithmetic)
        self.loaded: dict[tuple[int, int, int], Callable[..., Any]] = {}
        self.in_parts: dict[tuple[int, int, int], tuple[Callable[..., Any], ...]] = {}

    def __call__(self, here: int, there: int, order: int) -> Callable[..., Any]:
        """The kernel from component `here` to `there`, with derivatives up to `order`; it is loaded only once.

        In float64 a parameter beyond the end of its component means a point on the next one, if the curvatures of both
        agree at the join (`verification.maps.joins`).
        """
        return (self._beyond_ends if self.joins else self._on)(here, there, order)

    def _on(self, here: int, there: int, order: int) -> Callable[..., Any]:
        key = here, there, order
        if key not in self.loaded:
            self.loaded[key] = load(kept_chord_kernel(self.table, *key), self.arithmetic)
        return self.loaded[key]

    def _beyond_ends(self, here: int, there: int, order: int) -> Callable[..., Any]:
        """The kernel, with chord ends moved to the components on which they lie; derivatives by the chain rule."""
        assert self.joins is not None
        place, powers = self.joins.place, [[name[6:].count(end) for end in "01"] for name in _places(self.table, order)]

        def angle(x: Any, y: Any) -> list[Any]:
            (i, u, a), (j, v, b) = place(here, x), place(there, y)
            if not np.ndim(i):
                values = self._on(int(i), int(j), order)(float(u), float(v))
            else:
                values = np.empty((len(powers), *i.shape))
                for p, q in {*zip(i.ravel().tolist(), j.ravel().tolist(), strict=True)}:
                    on = (i == p) & (j == q)
                    for row, value in zip(values, self._on(p, q, order)(u[on], v[on]), strict=True):
                        row[on] = value
            return [value * a**p * b**q for value, (p, q) in zip(values, powers, strict=True)]

        return angle

    def _hull(self, starts: Sequence[Place], ends: Sequence[Place], order: int) -> list[Any]:
        """Balls that hold the chord angle and its derivatives, for all components on which the ends may lie."""
        powers = [[name[6:].count(end) for end in "01"] for name in _places(self.table, order)]
        found: list[Any] = []
        for (i, u, a), (j, v, b) in product(starts, ends):
            values = [x * a**p * b**q for x, (p, q) in zip(self._on(i, j, order)(u, v), powers, strict=True)]
            found = [x.union(y) for x, y in zip(found, values, strict=True)] if found else values
        return found

    def between(self, order: int, shape: Sequence[Any]) -> Callable[[End, End], Sequence[Any]]:
        """A function for the angle of a chord from one bounce of an orbit to another.

        What depends on one end alone is computed once and kept under the number of the bounce, so the numbers must not
        be used again for other bounces.
        """
        known: dict[tuple[int, int, int, int], Any] = {}
        names = tuple(p.symbol.name for p in self.table.shapes)

        def angle(here: End, there: End) -> Sequence[Any]:
            key = here[0], there[0], order
            if self.over_joins and order < 2 and isinstance(here[2], arb):
                starts, ends = (self.over_joins(end[0], end[2]) for end in (here, there))
                if len(starts) > 1 or len(ends) > 1 or (starts[0][0], ends[0][0]) != key[:2]:
                    return self._hull(starts, ends, order)
            if self.arithmetic is FLOAT64 or self.joins:  # where a sine costs no more than looking it up
                return self(*key)(here[2], there[2], *shape)  # type: ignore[no-any-return]
            if key not in self.in_parts:
                parts = parted(kept_chord_kernel(self.table, *key), ("theta0", *names), ("theta1", *names))
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
    """Chord angles of a table; in float64, where they are needed most often, the same object is returned each time."""
    kept = arithmetic is ARRAYS or arithmetic is FLOAT64
    return _in_float64(table, arithmetic is ARRAYS) if kept else ChordAngles(table, arithmetic)


@cache
def _in_float64(table: Table, arrays: bool) -> ChordAngles:
    return ChordAngles(table, ARRAYS if arrays else FLOAT64)


@dataclass(frozen=True)
class Chords:
    """Cycles of a billiard by the collision rule; parameters are `lam`, free shape parameters, and the law's own."""

    table: Table
    components: tuple[int, ...]
    closure: Closure = IDENTITY
    law: Law = PAPERS_LAW

    @property
    def label(self) -> str:
        """The name used in messages."""
        return f"{self.table.name}, period {self.period}"

    @property
    def period(self) -> int:
        """The number of bounces."""
        return len(self.components)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters: `lam`, the free shape parameters, and the law's own."""
        return tuple(dict.fromkeys(("lam", *self.shapes, *self.law.parameters)))

    @property
    def shapes(self) -> tuple[str, ...]:
        """The names of the table's free shape parameters."""
        return tuple(p.symbol.name for p in self.table.shapes)

    def terms(self, x: Array, at: Parameters, order: int) -> Terms[Array]:
        """Values of the collision rule at all bounces and its derivatives up to `order`, in float64.

        >>> from symbolic.tables import ellipse
        >>> axis = Chords(ellipse.at(a=2), (0, 0))
        >>> bool(abs(axis.terms(np.array([np.pi / 2, -np.pi / 2]), {"lam": 0.5}, 1).value).max() < 1e-15)
        True
        """
        ring, shape = around(self.closure, x), [at[name] for name in self.shapes]
        ahead, back = self._angles(ring, shape, order)
        return self._terms(ahead, back, at["lam"], order, self._all_reflected(back[0], ring[1:-1], at, order))

    def _all_reflected(self, eta: Array, here: Array, at: Parameters, order: int) -> Slopes:
        """Exit angles by the law at all bounces, and derivatives; a law in arc length has a formula per component."""
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
        """The exit angle of a law other than `-lam*eta`, and its derivatives by name; empty for `-lam*eta`."""
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
        """Collision rule and its derivatives, from the angles of the chords ahead and back and their derivatives."""
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
        """Collision rule `A(next) - phi(A(previous))` with chord angles `A`, for a law `phi` other than `-lam*eta`."""
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
        """The collision rule at single bounces, as a function in the given arithmetic.

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
        """The rule at every bounce, with derivatives up to `order`; `padded` has one more bounce at either end."""
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

    def placed(self, x: "Sequence[float] | Array") -> "tuple[Chords, Array]":
        """The cycle with each bounce assigned to the component on which it lies; at a smooth join, to the following
        one.

        >>> from symbolic.tables import cuspless
        >>> ring, x = Chords(cuspless, (1, 0)).placed([0.0, 0.0])
        >>> ring.components, x.tolist()
        ((1, 0), [0.0, 0.0])
        """
        known = self._joins()
        if known is None:
            return self, np.array(x, dtype=float)
        parts, at = known.canonical(np.array(self.components), np.array(x, dtype=float))
        return replace(self, components=tuple(parts.tolist())), at

    def _joins(self) -> Joins | None:
        """The joins of the table; None for a single smooth curve, a free shape, or a law that depends on the place."""
        if self.table.shapes or self.law.placed or self.closure != IDENTITY or closes_smoothly(self.table):
            return None
        return joins(self.table)

    def doubled(self) -> "Chords":
        """The chord system of the cycle run through twice."""
        return replace(self, components=self.components * 2, closure=self.closure.twice())

    def angles(self, x: Array, at: Parameters) -> tuple[Array, Array]:
        """The exit angle and the angle of incidence at each bounce, in radians."""
        ring, shape = around(self.closure, x), [at[name] for name in self.shapes]
        out, into = self._angles(ring, shape, 0)
        return out[0], into[0]

    def obstacle(self, x: Array, at: Parameters) -> str:
        """Reason why `x` is no cycle, such as a bounce off its component or an obstructed chord; empty if it is one."""
        ring, x = self.placed(x)
        return ring._obstacle(x, at)

    def _obstacle(self, x: Array, at: Parameters) -> str:
        cut = self.law.measured and self.law.on(self.table, self.components[0]).measured  # where the law may jump
        if cut or not closes_smoothly(self.table):  # beyond its ends another formula runs on along no boundary
            ends, smooth = self.ends(at), joins(self.table).smooth
            for i, (part, value) in enumerate(zip(self.components, x, strict=True)):
                slack = ROUNDED * (ends[part][1] - ends[part][0]) * smooth[part]  # a cycle may stay on a join
                if not ends[part][0] - slack[0] <= value <= ends[part][1] + slack[1]:
                    return f"bounce {i} left the {self.table.components[part].name} at theta = {value:.6g}"
        ring, parts = around(self.closure, x), (*self.components, self.components[0])
        apart = np.abs(np.sin((ring[2:] - ring[1:-1]) / 2))
        for i in range(self.period):
            if parts[i] == parts[i + 1] and apart[i] < 1e-6:
                return f"bounces {i} and {i + 1} met at theta = {x[i]:.6g}, where no chord is left"
        return "" if _convex_throughout(self.table) else self._obstructed(x, at)

    def _obstructed(self, x: Array, at: Parameters) -> str:
        """A sentence on the first chord that meets the boundary on its way; empty if there is none."""
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
        """Start and end of each component's parameter, for a table with the shape `at`.

        >>> from symbolic.tables import cuspless
        >>> Chords(cuspless, (1, 0)).ends({})[1]  # the wall
        (-0.4330127018922193, 0.4330127018922193)
        """
        found = _ends(self.table)(*(at[name] for name in self.shapes))
        return list(zip(map(float, found[::2]), map(float, found[1::2]), strict=True))

    def nearest_joins(self, x: Array, at: Parameters) -> list[float | None]:
        """For each bounce the nearer end of its component at which a branch would end; None if there is no such end."""
        if len(self.table.components) == 1:
            return [None] * self.period
        known, runs_on = self.ends(at), joins(self.table).runs_on
        both = [[end for end, on in zip(known[i], runs_on[i], strict=True) if not on] for i in self.components]
        return [min(ends, key=lambda e: abs(e - value), default=None) for ends, value in zip(both, x, strict=True)]

    def _angles(self, ring: Array, shape: list[float], order: int) -> tuple[list[Array], list[Array]]:
        """Angles of the chords from each bounce to the next one and to the one before, and their derivatives."""
        parts, n = self.components, self.period
        here, there = np.tile(ring[1:-1], 2), np.concatenate([ring[2:], ring[:-2]])
        pairs = [(part, parts[(i + way) % n]) for way in (1, -1) for i, part in enumerate(parts)]
        angles = chord_angles(self.table, ARRAYS)
        found = np.empty((len(_places(self.table, order)), 2 * n))
        with np.errstate(all="ignore"):
            for pair in set(pairs):
                chosen = np.array([p == pair for p in pairs])
                for row, value in zip(found, angles(*pair, order)(here[chosen], there[chosen], *shape), strict=True):
                    row[chosen] = value
        return list(found[:, :n]), list(found[:, n:])


@cache
def _ends(table: Table) -> Callable[..., Any]:
    return load(ends_kernel(table), FLOAT64)


@cache
def _convex_throughout(table: Table) -> bool:
    """Is the table proved convex for all values of its free shape parameters?"""
    if not table.shapes or "table" in table_boundary(table)[0]:
        return bool(table.shapes) or convex(table) is True
    return convex(table, tuple(between(float(p.range.start), float(p.range.end)) for p in table.shapes)) is True


def landing(table: Table, here: Any, phi: Any, turns: int = 0) -> Any:
    """The parameter where the chord at angle `phi` lands, within a turn after `here + 2*pi*turns`, in float64.

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
