"""Periodic orbits as rings of three-term rules, over any kind of number; and the bifurcations, with their equations.

    fold                 det(M - 1) = 0 and the branch turns in the parameter
    pitchfork            det(M - 1) = 0, the branch goes straight on, half of the cycle flips
    branch point         det(M - 1) = 0, the branch goes straight on, no half of the cycle flips
    period doubling      det(M + 1) = 0
    Neimark-Sacker       det M = 1 with multipliers on the unit circle
    neutral saddle       det M = 1 with real multipliers: no bifurcation
    border collision     a bounce meets a join of the boundary

`M` is the monodromy matrix. A bifurcating cycle solves one equation more than it has bounces, for one parameter more:
`bordering` is 0. `verification.cycles.critical` solves for any of them, and for several at once.

A periodic orbit is a ring: at each bounce one equation `R(before, here, after) = 0` ties three neighbours, and the ring
closes by the identity or by a symmetry that carries a part of the orbit to the next. The derivatives of the rules by
the three neighbours are the linearised map, so the multipliers come from three diagonals, and no derivative of the map
itself is needed. Billiards are such rings (`verification.cycles.chords`).

So are maps whose bifurcations are published, with which the engine is tested: the logistic map, `x -> r*x*(1 - x)`
[May1976]; Henon's, `x -> 1 - a*x**2 + y`, `y -> b*x`, as one rule in three successive `x` [Henon1976]; and the delayed
logistic map, `x -> r*x*(1 - y)`, `y -> x` [MaynardSmith1968], for its torus.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache
from itertools import combinations_with_replacement
from math import pi
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Symbol, diff

from symbolic.expressions.text import Kernel, kernel, load
from verification.arithmetic.balls import ARRAYS, Arithmetic
from verification.cycles.chain import Chain, Elimination, trace_and_determinant


class BifurcationKind(Enum):
    """Bifurcations of a cycle as a parameter varies; the value is the usual name."""

    FOLD = "fold"
    PITCHFORK = "pitchfork"
    BRANCH_POINT = "branch point"
    FLIP = "period doubling"
    TORUS = "Neimark-Sacker"
    NEUTRAL_SADDLE = "neutral saddle"
    BORDER_COLLISION = "border collision"

    @property
    def multiplier(self) -> int:
        """The critical multiplier, 1 or -1, of the ring to solve for; for a pitchfork that of the part that flips.

        >>> BifurcationKind.FOLD.multiplier, BifurcationKind.PITCHFORK.multiplier
        (1, -1)
        """
        return -1 if self.solved is BifurcationKind.FLIP else 1

    @property
    def solved(self) -> "BifurcationKind | None":
        """The kind whose equations are solved: for a pitchfork the flip of a part; None if it has no equations."""
        return SOLVED.get(self)

    def bordering(self, rows: Sequence[tuple[Any, Any, Any]], turn: int) -> Any:
        """The quantity that vanishes at the bifurcation, from the rule's three derivatives at each bounce.

        `turn` is 1, or -1 where the ring closes by a mirror.

        >>> rows = [(2, -3, 1), (2, -3, 1)]  # multipliers 1 and 4: det(M + 1) is 10
        >>> [kind.bordering(rows, 1) for kind in (BifurcationKind.FOLD, BifurcationKind.FLIP, BifurcationKind.TORUS)]
        [0.0, -3.3333333333333335, 3.0]
        """
        if self in (BifurcationKind.TORUS, BifurcationKind.NEUTRAL_SADDLE):
            return trace_and_determinant(rows, turn)[1] - 1
        if self.solved is None:
            raise ValueError(f"a {self.value} is not given by one equation for the multipliers")
        lower, diagonal, upper = zip(*rows, strict=True)
        return Elimination(Chain(lower, diagonal, upper, turn * self.multiplier)).bordering


SOLVED = {
    BifurcationKind.FOLD: BifurcationKind.FOLD,
    BifurcationKind.FLIP: BifurcationKind.FLIP,
    BifurcationKind.PITCHFORK: BifurcationKind.FLIP,
}


@dataclass(frozen=True)
class Closure:
    """How a ring closes: by `x[n] = turn*x[0] + 2*pi*p/q` with `shift = (p, q)`.

    A whole cycle closes by the identity, half of a mirror-symmetric cycle with `turn = -1`, and one bounce of a polygon
    by a turn of `p/q`.
    """

    turn: int = 1
    shift: tuple[int, int] = (0, 1)

    @property
    def radians(self) -> float:
        """The shift in radians, in float64."""
        p, q = self.shift
        return 2 * pi * p / q

    def angle(self, words: Arithmetic) -> Any:
        """The shift in radians, in the given arithmetic."""
        p, q = self.shift
        return 2 * words.pi * words.q(p, q) if p else 0

    def padded(self, x: Sequence[Any], angle: Any) -> list[Any]:
        """`x` with a neighbour at each end, `x[-1]` and `x[n]`; `angle` is the shift in radians, of the same kind.

        >>> Closure(-1).padded([1, 2], 0)
        [-2, 1, 2, -1]
        """
        return [self.turn * (x[-1] - angle), *x, self.turn * x[0] + angle]

    def carried(self, x: Any, angle: Any, rounds: int) -> Any:
        """The image of `x` under `rounds` closing symmetries, or under their inverses if `rounds` is negative."""
        for _ in range(abs(rounds)):
            x = self.turn * x + angle if rounds > 0 else self.turn * (x - angle)
        return x

    def twice(self) -> "Closure":
        """The closure of the orbit run through twice.

        >>> Closure(-1, (2, 3)).twice(), Closure(1, (1, 3)).twice()
        (Closure(turn=1, shift=(0, 1)), Closure(turn=1, shift=(2, 3)))
        """
        p, q = self.shift
        return IDENTITY if self.turn == -1 or p == 0 else Closure(1, (2 * p, q))


IDENTITY, MIRROR = Closure(), Closure(-1)


Array = NDArray[np.float64]
Parameters = Mapping[str, float]
Pair = tuple[int, int]
X = TypeVar("X")


@dataclass(frozen=True)
class Terms(Generic[X]):
    """The value `R(before, here, after)` of a rule and its derivatives, at one bounce, or at all of a ring as arrays.

    `slope` has the derivatives by the three neighbours, `by` those by parameters. The second derivatives are `bend[i,
    j]`, by the neighbours `i` and `j`, and `slope_by`, those of `slope` by parameters; both are empty if not requested.
    """

    value: X
    slope: tuple[X, X, X]
    by: dict[str, X]
    bend: dict[Pair, X]
    slope_by: dict[str, tuple[X, X, X]]

    @property
    def rows(self) -> list[tuple[Any, Any, Any]]:
        """The three derivatives at each bounce of a ring, as tuples."""
        return list(zip(*self.slope, strict=True))  # type: ignore[call-overload]  # rows of numbers

    def listed(self) -> "Terms[list[Any]]":
        """The terms along a ring, with lists in place of arrays."""
        rows: Any = self
        shape = np.shape(rows.value)

        def slope(own: tuple[Any, Any, Any]) -> tuple[list[Any], list[Any], list[Any]]:
            before, here, after = ([*np.broadcast_to(row, shape).tolist()] for row in own)
            return before, here, after

        by, bend = ({key: row.tolist() for key, row in each.items()} for each in (rows.by, rows.bend))
        turned = {name: slope(each) for name, each in self.slope_by.items()}
        return Terms(rows.value.tolist(), slope(self.slope), by, bend, turned)

    @staticmethod
    def along(bounces: "Sequence[Terms[Any]]") -> "Terms[list[Any]]":
        """The terms of single bounces, joined to lists along their ring."""
        first = bounces[0]
        return Terms(
            [terms.value for terms in bounces],
            _columns([terms.slope for terms in bounces]),
            {name: [terms.by[name] for terms in bounces] for name in first.by},
            {pair: [terms.bend[pair] for terms in bounces] for pair in first.bend},
            {name: _columns([terms.slope_by[name] for terms in bounces]) for name in first.slope_by},
        )


def _columns(rows: Sequence[tuple[Any, Any, Any]]) -> tuple[list[Any], list[Any], list[Any]]:
    before, here, after = (list(column) for column in zip(*rows, strict=True))
    return before, here, after


def around(closure: Closure, x: Array) -> Array:
    """The bounces `x` with one more neighbour at either end."""
    return np.array(closure.padded(x, closure.radians))  # type: ignore[arg-type]  # an array is a sequence here


class Rule(Protocol):
    """A function for the rule at a single bounce, in one arithmetic."""

    def __call__(self, i: int, near: Sequence[Any], at: Mapping[str, Any], order: int = 1) -> Terms[Any]:
        """The rule at bounce `i` from three neighbouring bounces `near`, with derivatives up to `order`, at most 2."""


class Recurrence(Protocol):
    """A ring of rules: `over` gives them at single bounces in any arithmetic, `terms` at all bounces in float64."""

    @property
    def label(self) -> str:
        """The name used in messages."""

    @property
    def period(self) -> int:
        """The number of bounces."""

    @property
    def closure(self) -> Closure:
        """How the ring closes: by the identity or by a symmetry."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""

    def terms(self, x: Array, at: Parameters, order: int) -> Terms[Array]:
        """The rule at all bounces and its derivatives up to `order`, in float64."""

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The rule at single bounces, as a function in the given arithmetic."""

    def doubled(self) -> "Recurrence":
        """The recurrence of the cycle run through twice."""

    def obstacle(self, x: Array, at: Parameters) -> str:
        """Reason why a solution `x` of the rules is no cycle; empty when it is one."""


BEFORE, HERE, AFTER = (Symbol(name, real=True) for name in ("before", "here", "after"))


@dataclass(frozen=True)
class Explicit:
    """Cycles of a map given by a formula `residual = 0` in `BEFORE`, `HERE`, `AFTER` and parameters."""

    name: str
    residual: Expr
    symbols: tuple[Symbol, ...]
    period: int
    closure: Closure = IDENTITY

    @property
    def label(self) -> str:
        """The name used in messages."""
        return f"{self.name}, period {self.period}"

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(p.name for p in self.symbols)

    def terms(self, x: Array, at: Parameters, order: int) -> Terms[Array]:
        """The rule at all bounces and its derivatives up to `order`, in float64."""
        ring = around(self.closure, x)
        return self.over(ARRAYS)(0, (ring[:-2], ring[1:-1], ring[2:]), at, order)

    def over(self, arithmetic: Arithmetic) -> Rule:
        """The rule at single bounces, as a function; derivatives that are constant become numbers of the same kind.

        >>> from fractions import Fraction
        >>> from types import SimpleNamespace
        >>> found = henon(1).over(SimpleNamespace(q=Fraction))(0, (1, 2, 3), {"a": 1, "b": 5})
        >>> found.value, found.slope
        (1, (-5, 4, 1))
        """

        def rule(i: int, near: Sequence[Any], at: Mapping[str, Any], order: int = 1) -> Terms[Any]:
            values = [at[name] for name in self.parameters]
            zero = 0 * near[1]
            found = [x + zero for x in load(_kernel(self.residual, self.symbols, order), arithmetic)(*near, *values)]
            value, *first = found[: 4 + len(values)]
            second = found[4 + len(values) :]
            bend, mixed = second[:6], iter(second[6:])
            return Terms(
                value,
                (first[0], first[1], first[2]) if first else (zero, zero, zero),
                dict(zip(self.parameters, first[3:], strict=bool(first))),
                dict(zip(combinations_with_replacement(range(3), 2), bend, strict=bool(bend))),
                dict(zip(self.parameters, zip(mixed, mixed, mixed, strict=True), strict=bool(bend))),
            )

        return rule

    def doubled(self) -> "Explicit":
        """The recurrence of the cycle run through twice."""
        return replace(self, period=2 * self.period, closure=self.closure.twice())

    def obstacle(self, x: Array, at: Parameters) -> str:
        """Always empty: every solution of a formula is a cycle."""
        return ""


@cache
def _kernel(residual: Expr, symbols: tuple[Symbol, ...], order: int) -> Kernel:
    ring, values = (BEFORE, HERE, AFTER), {"residual": residual}
    if order > 0:
        values |= {f"d_{s}": diff(residual, s) for s in (*ring, *symbols)}
    if order > 1:
        values |= {f"d_{r}_{s}": diff(residual, r, s) for r, s in combinations_with_replacement(ring, 2)}
        values |= {f"d_{p}_{s}": diff(residual, p, s) for p in symbols for s in ring}
    return kernel(f"rule_to_order_{order}", [*ring, *symbols], values)


r, a, b = (Symbol(name, real=True) for name in "rab")


def logistic(period: int) -> Explicit:
    """Cycles of the logistic map; the parameter is `r`."""
    return Explicit("logistic", AFTER - r * HERE * (1 - HERE), (r,), period)


def henon(period: int) -> Explicit:
    """Cycles of the Henon map; the parameters are `a` and `b`."""
    return Explicit("Henon", AFTER - 1 + a * HERE**2 - b * BEFORE, (a, b), period)


def delayed(period: int) -> Explicit:
    """Cycles of the delayed logistic map; the parameter is `r`."""
    return Explicit("delayed logistic", AFTER - r * HERE * (1 - BEFORE), (r,), period)


def cubic(period: int) -> Explicit:
    """Cycles of `x -> r*x - x**3`; the parameter is `r`."""
    return Explicit("cubic", AFTER - r * HERE + HERE**3, (r,), period)
