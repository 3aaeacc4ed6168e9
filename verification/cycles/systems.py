"""What is followed: a cycle in one parameter, or a bifurcating cycle in two; and the part of a symmetric cycle.

A cycle has as many rules as bounces, so one free parameter makes a branch. Where it bifurcates, a vector `v` comes
back unchanged (fold) or negated (flip), `A v = 0`. Bordered by two fixed vectors `b` and `c` the matrix is regular,
and the last entry `g` of the solution of `[A b; c 0] (v, g) = (0, 1)` is 0 exactly there: one equation more for one
parameter more. Its derivative is `dg = -w dA v` with the left vector `w`.

A rotation by `2*pi/k`, or the mirror `theta -> -theta`, that maps the boundary to itself maps cycles to cycles. A
cycle that is its own image after `m` of its `n` bounces is a ring of `m` bounces that closes by the symmetry. Where
such a cycle has the multiplier 1 without a fold, two cycles branch off that lack the symmetry: a pitchfork, at which
the part flips.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from math import pi, remainder
from typing import Any

import numpy as np

from symbolic.tables.geometry import boundary_coefficients, group
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import FLOAT64
from verification.cycles.cells import Spectrum, beside, dense, null_vectors, ring_matrix, solved, spectrum
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
    """The rules along curves through a cycle, as `expanded` gives them."""
    return lambda directions: expanded(ring, FLOAT64, [float(v) for v in x], at, kind.multiplier, directions)


def coefficients(ring: Recurrence, x: Array, at: Parameters, kind: BifurcationKind, parameter: str) -> NormalForm:
    """The normal form of a cycle where it folds or flips in `parameter`; its vectors have the root mean square 1."""
    terms = ring.terms(x, at, 2)
    v, w = (list(x) for x in null_vectors(ring_matrix(terms, ring.closure, kind.multiplier)))
    solve = inverse(terms, ring.closure)
    return normal_form(kind, parameter, terms, ring.closure, v, w, series_of(ring, x, at, kind), solve)


def inverse(terms: Terms[Array], closure: Closure) -> Callable[[Any], Any]:
    """What solves with the linearised rules of a cycle, with pivoting."""
    return lambda right: solved(ring_matrix(terms, closure), np.asarray(right))


SAME = 1e-7  # radians
OPPOSITE = 0.1  # of two gaps: what is left where they should cancel
ROUND = 12  # turns of a circle about the origin that are counted, of infinitely many


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
    """The symmetries but the identity, as `theta -> turn*theta + shift`; mirrors first, which an odd law alone has."""
    if law.placed:
        return ()
    k = rotations(table)
    turns = [(j, k) if j else (0, 1) for j in range(k)]
    mirror = law.odd and all(mirrored(component) for component in table.components)
    return tuple([Closure(-1, s) for s in turns] if mirror else []) + tuple(Closure(1, s) for s in turns[1:])


def parts(ring: Chords, x: Array) -> list[tuple[Chords, Array]]:
    """The rings, shorter than this one, that make up a full cycle by a symmetry; the shortest first.

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
    """How far the bounce `m` later is from a bounce's image."""
    gap = float(x[(i + m) % ring.period] - g.carried(x[i], g.radians, 1))
    return remainder(gap, 2 * pi) if len(ring.table.components) == 1 else gap


def repeats(ring: Recurrence, x: Array) -> bool:
    """Is the cycle a shorter one run through again, or its own image under a symmetry some bounces later?"""
    if not isinstance(ring, Chords) or ring.closure != IDENTITY:
        return False
    n = ring.period
    again = any(all(_maps(ring, IDENTITY, x, i, m) for i in range(n)) for m in range(1, n) if n % m == 0)
    return again or bool(parts(ring, x))


def crossed(ring: Recurrence, a: Array, b: Array) -> list[tuple[Chords, Array, float]]:
    """The parts that repeat themselves somewhere between two cycles that do not, and which share of the way there.

    The bounces of one cycle are as far on one side of their images as those of the other are on the other side.
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
    """The full cycle of `n` bounces that a part makes up."""
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
        """What messages call it."""
        return self.recurrence.label

    @cached_property
    def weights(self) -> Array:
        """The mean square of the bounces, and the parameter."""
        n = self.recurrence.period
        return np.append(np.full(n, 1.0 / n), PARAMETER**2)

    def at(self, z: Array) -> dict[str, float]:
        """All parameters."""
        return {**self.fixed, self.parameter: float(z[-1])}

    def terms(self, z: Array, order: int = 1) -> Terms[Array]:
        """The rule along the ring."""
        return self.recurrence.terms(z[:-1], self.at(z), order)

    def linear(self, z: Array) -> tuple[Array, Any]:
        """The rules, and their derivatives by the bounces and the parameter."""
        terms = self.terms(z)
        matrix = ring_matrix(terms, self.recurrence.closure)
        return terms.value, beside(matrix, terms.by[self.parameter])

    def spectrum(self, z: Array) -> Spectrum:
        """The multipliers, as three numbers."""
        return spectrum(self.terms(z), self.recurrence.closure)

    def tests(self, z: Array) -> dict[str, float]:
        """`det(M - 1)`, `det(M + 1)` and `det M - 1`."""
        found = self.spectrum(z)
        return {"one": found.at_one, "minus_one": found.at_minus_one, "volume": found.determinant - 1}

    def obstacle(self, z: Array) -> str:
        """Why these bounces are no cycle."""
        return self.recurrence.obstacle(z[:-1], self.at(z))

    def renewed(self, z: Array) -> "Cycles":
        """Itself: nothing is kept from point to point."""
        return self


@dataclass(frozen=True)
class Critical:
    """Cycles at a fold or a flip, in two parameters; unknowns are the bounces, then the parameters.

    `unit` is how far a shape varies: a curve is stepped along in parts of it.
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
    ) -> "Critical":
        """The system whose borders fit a critical cycle near `z`."""
        none = np.zeros(recurrence.period)
        return cls(recurrence, kind, two, (none, none), fixed or {}, unit).bordered_at(z, None)

    def bordered_at(self, z: Array, before: tuple[Array, Array] | None) -> "Critical":
        """Borders from the singular vectors at `z`, on the side of those `before`."""
        right, left = null_vectors(self._matrix(self.terms(z)))
        if before is not None:
            right, left = (x if x @ old >= 0 else -x for x, old in zip((right, left), before, strict=True))
        n = len(right)
        return replace(self, borders=(right / n, left / n))

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{self.kind.name.lower()} of {self.recurrence.label}"

    @cached_property
    def weights(self) -> Array:
        """The mean square of the bounces, and the parameters: a `unit` of a shape counts as much as all of `lam`."""
        n = self.recurrence.period
        parameters = [(PARAMETER / (1 if name == "lam" else self.unit)) ** 2 for name in self.two]
        return np.append(np.full(n, 1.0 / n), parameters)

    def at(self, z: Array) -> dict[str, float]:
        """All parameters."""
        return {**self.fixed, self.two[0]: float(z[-2]), self.two[1]: float(z[-1])}

    def terms(self, z: Array, order: int = 2) -> Terms[Array]:
        """The rule along the ring."""
        return self.recurrence.terms(z[:-2], self.at(z), order)

    def vectors(self, terms: Terms[Array]) -> tuple[Array, Array, float]:
        """`v`, `w` and `g`."""
        n = self.recurrence.period
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n] = dense(self._matrix(terms))
        whole[n, :n], whole[:n, n] = self.borders
        unit = np.append(np.zeros(n), 1.0)
        right, left = solved(whole, unit), solved(whole.T, unit)
        return right[:n], left[:n], float(right[n])

    def linear(self, z: Array) -> tuple[Array, Any]:
        """The rules and `g`, with their derivatives."""
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
        """The normal form's coefficient, the volume, and the other multiplier against 1 and -1."""
        terms = self.terms(z)
        v, w, _ = self.vectors(terms)
        found = spectrum(terms, self.recurrence.closure)
        other = found.determinant * self.kind.multiplier
        series = series_of(self.recurrence, z[:-2], self.at(z), self.kind)
        bend = float(bend_of(self.kind, list(w), v, series, inverse(terms, self.recurrence.closure)))
        return {"bend": bend, "volume": found.determinant - 1, "other_one": other - 1, "other_minus_one": other + 1}

    def obstacle(self, z: Array) -> str:
        """Why these bounces are no cycle."""
        return self.recurrence.obstacle(z[:-2], self.at(z))

    def renewed(self, z: Array) -> "Critical":
        """Borders that fit the surroundings of `z`."""
        return self.bordered_at(z, self.borders)

    def _matrix(self, terms: Terms[Array]) -> Any:
        return ring_matrix(terms, self.recurrence.closure, self.kind.multiplier)
