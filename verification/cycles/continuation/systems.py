"""What is followed: a cycle in one letter, or a bifurcating cycle in two.

A cycle has as many rules as bounces, so one letter makes a branch. Where it bifurcates, a vector `v`
comes back unchanged (fold) or negated (flip), `A v = 0`; bordered by two fixed vectors `b`, `c` the
matrix is regular, and the last entry `g` of the solution of `[A b; c 0] (v, g) = (0, 1)` is 0 exactly
there. `g = 0` is the one equation more for one letter more, and `dg = -w dA v` with the left vector.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from verification.cycles.continuation.linear import (
    Spectrum,
    along,
    beside,
    dense,
    null_vectors,
    ring_matrix,
    solved,
    spectrum,
)
from verification.cycles.continuation.normal import bend_of
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.recurrence import Array, Letters, Recurrence, Terms

PARAMETER = 4.0  # a letter counts as much as an angle of this many radians moved by every bounce


@dataclass(frozen=True)
class Cycles:
    """Cycles of a recurrence in one free letter; unknowns are the bounces, then the letter."""

    recurrence: Recurrence
    letter: str
    fixed: Letters = field(default_factory=dict)

    @property
    def label(self) -> str:
        """What messages call it."""
        return self.recurrence.label

    @cached_property
    def weights(self) -> Array:
        """The mean square of the bounces, and the letter."""
        n = self.recurrence.period
        return np.append(np.full(n, 1.0 / n), PARAMETER**2)

    def at(self, z: Array) -> dict[str, float]:
        """All letters."""
        return {**self.fixed, self.letter: float(z[-1])}

    def terms(self, z: Array, order: int = 1) -> Terms:
        """The rule along the ring."""
        return self.recurrence.terms(z[:-1], self.at(z), order)

    def linear(self, z: Array) -> tuple[Array, Any]:
        """The rules, and their derivatives by the bounces and the letter."""
        terms = self.terms(z)
        matrix = ring_matrix(terms, self.recurrence.closure)
        return terms.value, beside(matrix, terms.by[self.letter])

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
    """Cycles at a fold or a flip, in two letters; unknowns are the bounces, then the letters."""

    recurrence: Recurrence
    kind: BifurcationKind
    two: tuple[str, str]
    borders: tuple[Array, Array] = field(repr=False)
    fixed: Letters = field(default_factory=dict)

    @classmethod
    def near(
        cls, recurrence: Recurrence, kind: BifurcationKind, two: tuple[str, str], z: Array, fixed: Letters | None = None
    ) -> "Critical":
        """The system whose borders fit a critical cycle near `z`."""
        none = np.zeros(recurrence.period)
        return cls(recurrence, kind, two, (none, none), fixed or {}).bordered_at(z, None)

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
        """The mean square of the bounces, and the letters: a shape counts tenfold."""
        n = self.recurrence.period
        letters = [PARAMETER**2 * (1 if name == "lam" else 100) for name in self.two]
        return np.append(np.full(n, 1.0 / n), letters)

    def at(self, z: Array) -> dict[str, float]:
        """All letters."""
        return {**self.fixed, self.two[0]: float(z[-2]), self.two[1]: float(z[-1])}

    def terms(self, z: Array, order: int = 2) -> Terms:
        """The rule along the ring."""
        return self.recurrence.terms(z[:-2], self.at(z), order)

    def vectors(self, terms: Terms) -> tuple[Array, Array, float]:
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
        by_bounce, by_letter = along(terms, self.recurrence.closure, v, w, self.kind.multiplier)
        n = self.recurrence.period
        matrix = np.zeros((n + 1, n + 2))
        matrix[:n, :n] = dense(ring_matrix(terms, self.recurrence.closure))
        for j, name in enumerate(self.two):
            matrix[:n, n + j] = terms.by[name]
            matrix[n, n + j] = -by_letter[name]
        matrix[n, :n] = -by_bounce
        return np.append(terms.value, g), matrix

    def tests(self, z: Array) -> dict[str, float]:
        """The normal form's coefficient, the volume, and the other multiplier against 1 and -1."""
        terms = self.terms(z)
        v, w, _ = self.vectors(terms)
        found = spectrum(terms, self.recurrence.closure)
        other = found.determinant * self.kind.multiplier
        bend = bend_of(self.recurrence, z[:-2], self.at(z), self.kind, v, w)
        return {"bend": bend, "volume": found.determinant - 1, "other_one": other - 1, "other_minus_one": other + 1}

    def obstacle(self, z: Array) -> str:
        """Why these bounces are no cycle."""
        return self.recurrence.obstacle(z[:-2], self.at(z))

    def renewed(self, z: Array) -> "Critical":
        """Borders that fit the surroundings of `z`."""
        return self.bordered_at(z, self.borders)

    def _matrix(self, terms: Terms) -> Any:
        return ring_matrix(terms, self.recurrence.closure, self.kind.multiplier)
