"""A periodic orbit as a ring of three-term rules: what every question is asked of, a billiard's or any other map's.

At each bounce one equation `R(before, here, after) = 0` ties three neighbours, and the ring closes by a symmetry
(`closure`). The derivatives of the rules by the three neighbours are the linearised map, so its multipliers come from
three diagonals and no derivative of the map is needed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic.words import Arithmetic
from verification.cycles.recurrence.closure import Closure

Array = NDArray[np.float64]
Letters = Mapping[str, float]
Pair = tuple[int, int]
Slopes = tuple[Any, Any, Any]


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


class Rule(Protocol):
    """The rule at single bounces, over one kind of number."""

    def __call__(self, i: int, near: Sequence[Any], at: Mapping[str, Any]) -> tuple[Any, Slopes]:
        """At bounce `i` with its neighbours, the value and its derivatives by `(before, here, after)`."""


class Recurrence(Protocol):
    """A ring of rules: `terms` in float64 with further derivatives, `over` any kind of number."""

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
        """The rule at `(before, here, after)`, arrays of all bounces or series of such arrays."""

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The rule at one bounce at a time, over any kind of number."""

    def doubled(self) -> "Recurrence":
        """The ring run through twice."""

    def obstacle(self, x: Array, at: Letters) -> str:
        """Why `x` is no cycle although the rules hold; empty when nothing is in the way."""
