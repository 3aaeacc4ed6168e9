"""Maps whose bifurcations are published: the engine that follows billiards must find them too.

Logistic, `x -> r*x*(1 - x)` [May1976]. Henon, `x -> 1 - a*x**2 + y`, `y -> b*x`, as one rule in three
successive `x` [Henon1976]. Delayed logistic, `x -> r*x*(1 - y)`, `y -> x` [MaynardSmith1968], for its torus.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from sympy import Expr, Symbol, diff

from symbolic.generation.text import Kernel, kernel, load
from verification.arithmetic.words import ARRAYS, Arithmetic
from verification.cycles.recurrence.closure import IDENTITY, Closure
from verification.cycles.recurrence.recurrence import Array, Letters, Rule, Slopes, Terms, around

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

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The rule at one bounce, the same at each.

        >>> from fractions import Fraction
        >>> henon(1).over({"q": Fraction})(0, (1, 2, 3), {"a": 1, "b": 5})
        (1, (-5, 4, 1))
        """
        residual = load(_sloped(self.residual, self.parameters), arithmetic)

        def rule(i: int, near: Sequence[Any], at: Mapping[str, Any]) -> tuple[Any, Slopes]:
            value, *slopes = residual(*near, *(at[name] for name in self.letters))
            before, here, after = slopes
            return value, (before, here, after)

        return rule

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
def _sloped(residual: Expr, parameters: tuple[Symbol, ...]) -> Kernel:
    slopes = {f"d_{s}": diff(residual, s) for s in (BEFORE, HERE, AFTER)}
    return kernel("rule_and_slopes", [BEFORE, HERE, AFTER, *parameters], {"residual": residual} | slopes)


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
