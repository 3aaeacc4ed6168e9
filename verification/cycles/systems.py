"""The systems for continuation: a cycle in one parameter or a bifurcating cycle in two; and parts of symmetric cycles.

A cycle has as many rules as bounces, so one free parameter makes a branch. Where it bifurcates, a vector `v` comes back
unchanged (fold) or negated (flip), `A v = 0`. Bordered by two fixed vectors `b` and `c` the matrix is regular, and the
last entry `g` of the solution of `[A b; c 0] (v, g) = (0, 1)` is 0 exactly where it bifurcates. This is one more
equation, for one more parameter. Its derivative is `dg = -w dA v` with the left vector `w`.

A rotation by `2*pi/k`, or the mirror `theta -> -theta`, that maps the boundary to itself maps cycles to cycles. A cycle
that is its own image after `m` of its `n` bounces is a ring of `m` bounces that closes by the symmetry. Where such a
cycle has the multiplier 1 without a fold, two cycles branch off that lack the symmetry: a pitchfork, at which the ring
of `m` bounces has the multiplier -1.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from math import inf, pi, remainder
from typing import Any

import numpy as np

from symbolic.tables.geometry import boundary_coefficients, group
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import FLOAT64
from verification.cycles.cells import MonodromyDeterminants, beside, dense, null_vectors, ring_matrix, solved, spectrum
from verification.cycles.chords import Chords
from verification.cycles.problem import (
    NormalForm,
    Series,
    bend_of,
    bordering_slopes,
    expanded,
    mirrored,
    normal_form,
)
from verification.cycles.recurrence import (
    IDENTITY,
    Array,
    BifurcationKind,
    Closure,
    Parameters,
    Recurrence,
    Terms,
)


def series_of(ring: Recurrence, x: Array, at: Parameters, kind: BifurcationKind) -> Series:
    """`expanded` for the cycle `x`: a function of `directions` that gives the rules as jets on a curve through it."""
    return lambda directions: expanded(ring, FLOAT64, [float(v) for v in x], at, kind.multiplier, directions)


def coefficients(ring: Recurrence, x: Array, at: Parameters, kind: BifurcationKind, parameter: str) -> NormalForm:
    """The normal form of a cycle that folds or flips in `parameter`, from vectors normalised to root mean square 1."""
    terms = ring.terms(x, at, 2)
    v, w = (list(x) for x in null_vectors(ring_matrix(terms, ring.closure, kind.multiplier)))
    solve = inverse(terms, ring.closure)
    return normal_form(kind, parameter, terms, ring.closure, v, w, series_of(ring, x, at, kind), solve)


def inverse(terms: Terms[Array], closure: Closure) -> Callable[[Any], Any]:
    """A function that solves the linearised rules of a cycle for a given right side, with pivoting."""
    return lambda right: solved(ring_matrix(terms, closure), np.asarray(right))


SAME = 1e-7  # radians
OPPOSITE = 0.1  # relative rest where two gaps should cancel
ROUND = 12  # rotations counted for a circle about the origin, which has infinitely many


@cache
def rotations(table: Table) -> int:
    """The largest `k` such that a turn by `2*pi/k` is proved to map the table to itself; `ROUND` for a circle.

    >>> from symbolic.tables import cuspless, egg
    >>> rotations(egg(3)), rotations(cuspless)
    (3, 1)
    """
    if len(table.components) > 1:
        return 1
    waves = boundary_coefficients(table.components[0])
    if waves is not None and len(waves) == 1:
        return ROUND
    return sum(symmetry.sign > 0 for symmetry in group(table))


def reflected(table: Table) -> bool:
    """Is `theta -> -theta` proved to be a symmetry of the table?

    >>> from symbolic.tables import egg
    >>> reflected(egg(3).at(alpha="2/25"))
    True
    """
    return any(symmetry.sign < 0 and symmetry.shift[0] == 0 for symmetry in group(table))


@cache
def symmetries(table: Table, law: Law = PAPERS_LAW) -> tuple[Closure, ...]:
    """Symmetries other than the identity, as `theta -> turn*theta + shift`: mirrors, if the law is odd, then turns."""
    if law.placed:
        return ()
    k = rotations(table)
    turns = [(j, k) if j else (0, 1) for j in range(k)]
    mirror = law.odd and all(mirrored(component) for component in table.components)
    return tuple([Closure(-1, s) for s in turns] if mirror else []) + tuple(Closure(1, s) for s in turns[1:])


def parts(ring: Chords, x: Array) -> list[tuple[Chords, Array]]:
    """Shorter rings, with their bounces, that make up the cycle `x` by a symmetry, in order of length.

    >>> from symbolic.tables import egg
    >>> triangle = Chords(egg(3).at(alpha="2/25"), (0, 0, 0))
    >>> [(ring.period, ring.closure.turn) for ring, _ in parts(triangle, np.pi / 3 * np.array([1.0, 3.0, 5.0]))]
    [(1, 1)]
    """
    n, found = ring.period, []
    if ring.closure != IDENTITY:
        return []
    for m in (m for m in range(1, n) if n % m == 0):
        for g in symmetries(ring.table, ring.law):
            if all(_maps(ring, g, x, i, m) for i in range(n)):
                found.append((replace(ring, components=ring.components[:m], closure=g), x[:m].copy()))
    return found


def _maps(ring: Chords, g: Closure, x: Array, i: int, m: int) -> bool:
    return ring.components[(i + m) % ring.period] == ring.components[i] and abs(_gap(ring, g, x, i, m)) < SAME


def _gap(ring: Chords, g: Closure, x: Array, i: int, m: int) -> float:
    """The difference between bounce `i + m` and the image under `g` of bounce `i`."""
    gap = float(x[(i + m) % ring.period] - g.carried(x[i], g.radians, 1))
    return remainder(gap, _turn(ring.table))


def _turn(table: Table) -> float:
    """The period of the boundary parameter; infinite for a table with several components."""
    return 2 * pi if len(table.components) == 1 else inf


def images(ring: Recurrence, x: Array, y: Array, within: float) -> bool:
    """Are two cycles of one ring the same, up to the choice of the first bounce and a symmetry of the table?

    >>> from symbolic.tables import ellipse
    >>> axis = Chords(ellipse.at(a=2), (0, 0))
    >>> images(axis, np.array([0.0, np.pi]), np.array([-np.pi, 0.0]), 1e-9)
    True
    """
    if not isinstance(ring, Chords) or ring.closure != IDENTITY:
        return bool(np.max(np.abs(x - y)) < within)
    n, turn = ring.period, _turn(ring.table)
    for g in (IDENTITY, *symmetries(ring.table, ring.law)):
        image = g.carried(x, g.radians, 1)
        for m in (m for m in range(n) if ring.components == ring.components[m:] + ring.components[:m]):
            if all(abs(remainder(float(gap), turn)) < within for gap in np.roll(image, -m) - y):
                return True
    return False


def repeats(ring: Recurrence, x: Array) -> bool:
    """Does the cycle repeat a shorter one, or is it its own image under a symmetry up to a shift of its bounces?"""
    if not isinstance(ring, Chords) or ring.closure != IDENTITY:
        return False
    n = ring.period
    again = any(all(_maps(ring, IDENTITY, x, i, m) for i in range(n)) for m in range(1, n) if n % m == 0)
    return again or bool(parts(ring, x))


def crossed(ring: Recurrence, a: Array, b: Array) -> list[tuple[Chords, Array, float]]:
    """Repeating or symmetric cycles between the cycles `a` and `b`: ring and bounces of a part, fraction of the way.

    The gaps between bounces and their images have opposite signs in `a` and `b`, so they vanish in between.
    """
    found: list[tuple[Chords, Array, float]] = []
    if not isinstance(ring, Chords) or ring.closure != IDENTITY:
        return found
    n = ring.period
    for m in (m for m in range(1, n) if n % m == 0 and ring.components == ring.components[:m] * (n // m)):
        for g in (IDENTITY, *symmetries(ring.table, ring.law)):
            first, last = (np.array([_gap(ring, g, x, i, m) for i in range(n)]) for x in (a, b))
            sizes = float(np.linalg.norm(first)), float(np.linalg.norm(last))
            share = sizes[0] / (sum(sizes) or 1.0)
            if np.linalg.norm(first + share * (last - first)) < OPPOSITE * min(sizes):
                part = replace(ring, components=ring.components[:m], closure=g)
                found.append((part, (a + share * (b - a))[:m], share))
    return found


def whole(part: Chords, x: Array, n: int) -> tuple[Chords, Array]:
    """The full cycle of `n` bounces, with its bounces, from a part and its images under the closing symmetry."""
    pieces, piece = [x], x
    while len(pieces) * part.period < n:
        piece = part.closure.carried(piece, part.closure.radians, 1)
        pieces.append(piece)
    return replace(part, components=part.components * len(pieces), closure=IDENTITY), np.concatenate(pieces)


PARAMETER = 4.0  # a parameter counts as much as an angle of this many radians moved by every bounce
SHAPE = 0.1  # how far the egg's shape varies


@dataclass(frozen=True)
class Cycles:
    """Cycles of a recurrence in one free parameter; unknowns are the bounces, then the parameter."""

    recurrence: Recurrence
    parameter: str
    fixed: Parameters = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The name used in messages."""
        return self.recurrence.label

    @cached_property
    def weights(self) -> Array:
        """Weights of the arc length: the bounces count by their mean square, the parameter in full."""
        n = self.recurrence.period
        return np.append(np.full(n, 1.0 / n), PARAMETER**2)

    def at(self, z: Array) -> dict[str, float]:
        """The values of all parameters by name, at the solution `z`."""
        return {**self.fixed, self.parameter: float(z[-1])}

    def terms(self, z: Array, order: int = 1) -> Terms[Array]:
        """The rule and its derivatives at all bounces of the cycle, at the solution `z`."""
        return self.recurrence.terms(z[:-1], self.at(z), order)

    def linear(self, z: Array) -> tuple[Array, Any]:
        """Values of the rules, and the matrix of their derivatives by the bounces and the parameter."""
        terms = self.terms(z)
        matrix = ring_matrix(terms, self.recurrence.closure)
        return terms.value, beside(matrix, terms.by[self.parameter])

    def spectrum(self, z: Array) -> MonodromyDeterminants:
        """The determinants from which the multipliers of the cycle follow."""
        return spectrum(self.terms(z), self.recurrence.closure)

    def tests(self, z: Array) -> dict[str, float]:
        """The test functions `det(M - 1)`, `det(M + 1)` and `det M - 1`; the last is set to 0 if the law is elastic."""
        found, ring = self.spectrum(z), self.recurrence
        elastic = isinstance(ring, Chords) and ring.law.uniform and self.at(z)["lam"] == 1
        volume = 0.0 if elastic else found.determinant - 1
        return {"one": found.at_one, "minus_one": found.at_minus_one, "volume": volume}

    def obstacle(self, z: Array) -> str:
        """The reason why the bounces at `z` do not form a cycle; empty if they do."""
        return self.recurrence.obstacle(z[:-1], self.at(z))

    def renewed(self, z: Array) -> "Cycles":
        """The same system, as nothing in it depends on the point."""
        return self


@dataclass(frozen=True)
class CriticalCycles:
    """Cycles at a fold or a flip, in two parameters; unknowns are the bounces, then the parameters.

    `unit` is the range of a shape parameter; the lengths of steps along a curve are proportional to it.
    """

    recurrence: Recurrence
    kind: BifurcationKind
    two: tuple[str, str]
    borders: tuple[Array, Array] = field(repr=False)
    fixed: Parameters = field(default_factory=dict)
    unit: float = SHAPE

    @classmethod
    def near(
        cls,
        recurrence: Recurrence,
        kind: BifurcationKind,
        two: tuple[str, str],
        z: Array,
        fixed: Parameters | None = None,
        unit: float = SHAPE,
    ) -> "CriticalCycles":
        """The system for a critical cycle near `z`, bordered by the singular vectors there."""
        none = np.zeros(recurrence.period)
        return cls(recurrence, kind, two, (none, none), fixed or {}, unit).bordered_at(z, None)

    def bordered_at(self, z: Array, before: tuple[Array, Array] | None) -> "CriticalCycles":
        """The system bordered by the singular vectors at `z`, signed so that they agree in direction with `before`."""
        right, left = null_vectors(self._matrix(self.terms(z)))
        if before is not None:
            right, left = (x if x @ old >= 0 else -x for x, old in zip((right, left), before, strict=True))
        n = len(right)
        return replace(self, borders=(right / n, left / n))

    @property
    def label(self) -> str:
        """The name used in messages."""
        return f"{self.kind.name.lower()} of {self.recurrence.label}"

    @cached_property
    def weights(self) -> Array:
        """Weights of the arc length: bounces count by their mean square; a `unit` of a shape counts as all of `lam`."""
        n = self.recurrence.period
        parameters = [(PARAMETER / (1 if name == "lam" else self.unit)) ** 2 for name in self.two]
        return np.append(np.full(n, 1.0 / n), parameters)

    def at(self, z: Array) -> dict[str, float]:
        """The values of all parameters by name, at the solution `z`."""
        return {**self.fixed, self.two[0]: float(z[-2]), self.two[1]: float(z[-1])}

    def terms(self, z: Array, order: int = 2) -> Terms[Array]:
        """The rule and its derivatives at all bounces of the cycle, at the solution `z`."""
        return self.recurrence.terms(z[:-2], self.at(z), order)

    def vectors(self, terms: Terms[Array]) -> tuple[Array, Array, float]:
        """`v`, `w` and `g` of the module docstring; `v` and `w` are null vectors where `g` is 0, at a bifurcation."""
        n = self.recurrence.period
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n] = dense(self._matrix(terms))
        whole[n, :n], whole[:n, n] = self.borders
        unit = np.append(np.zeros(n), 1.0)
        right, left = solved(whole, unit), solved(whole.T, unit)
        return right[:n], left[:n], float(right[n])

    def linear(self, z: Array) -> tuple[Array, Any]:
        """Values of the rules and of `g`, and the matrix of their derivatives."""
        terms = self.terms(z)
        v, w, g = self.vectors(terms)
        by_bounce, by_parameter = bordering_slopes(
            terms, self.recurrence.closure, list(v), list(w), self.kind.multiplier
        )
        n = self.recurrence.period
        matrix = np.zeros((n + 1, n + 2))
        matrix[:n, :n] = dense(ring_matrix(terms, self.recurrence.closure))
        for j, name in enumerate(self.two):
            matrix[:n, n + j] = terms.by[name]
            matrix[n, n + j] = -by_parameter[name]
        matrix[n, :n] = -np.asarray(by_bounce)
        return np.append(terms.value, g), matrix

    def tests(self, z: Array) -> dict[str, float]:
        """The test functions: a normal form coefficient, `det M - 1`, and the other multiplier minus 1, and plus 1."""
        terms = self.terms(z)
        v, w, _ = self.vectors(terms)
        found = spectrum(terms, self.recurrence.closure)
        other = found.determinant * self.kind.multiplier
        series = series_of(self.recurrence, z[:-2], self.at(z), self.kind)
        bend = float(bend_of(self.kind, list(w), v, series, inverse(terms, self.recurrence.closure)))
        return {"bend": bend, "volume": found.determinant - 1, "other_one": other - 1, "other_minus_one": other + 1}

    def obstacle(self, z: Array) -> str:
        """The reason why the bounces at `z` do not form a cycle; empty if they do."""
        return self.recurrence.obstacle(z[:-2], self.at(z))

    def renewed(self, z: Array) -> "CriticalCycles":
        """The system with borders for the neighbourhood of `z`."""
        return self.bordered_at(z, self.borders)

    def _matrix(self, terms: Terms[Array]) -> Any:
        return ring_matrix(terms, self.recurrence.closure, self.kind.multiplier)
