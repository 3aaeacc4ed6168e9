"""Planar maps as one equation in three successive points of an orbit, for the computation of invariant manifolds.

Along every orbit `rule(previous, here, following, parameter) = 0`. Solved for `following` the rule gives the map, and
solved for `previous` its inverse. The parameter is the contraction of the pinball map, or `a` of the Henon map. A map
object works over one kind of number: floats, arrays, mpmath numbers or balls, or jets of these.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, lru_cache
from typing import Any, ClassVar, Protocol, Self, cast

import numpy as np
from sympy import Expr

from numeric import PinballMap
from numeric.dynamics.phase_points import advanced, phase_points
from symbolic.expressions.text import load
from symbolic.motion.chords import law_kernel
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import ARRAYS, Arithmetic
from verification.arithmetic.iteration import Stop, Vector, iterated, largest
from verification.arithmetic.series import SERIES, Jet, along, in_series, jets
from verification.cycles.chords import Chords, chord_angles, landing
from verification.cycles.recurrence import Array, Recurrence, Rule, henon
from verification.cycles.systems import rotations
from verification.maps.first_hit import convex

NEWTON = Stop(small=1e-13, steps=60)  # from a landing in float64 to other numbers, and order by order in jets
HALVINGS = 54  # halvings of the incidence angles


class PlaneMap(Protocol):
    """A map of the plane over one kind of number, given by a rule for three successive points."""

    @property
    def words(self) -> Arithmetic:
        """The arithmetic functions for the kind of number."""

    @property
    def label(self) -> str:
        """The name of the map in messages."""

    @property
    def turn(self) -> int:
        """The order of the rotation symmetry of the table; 0 if points are not angles."""

    def over(self, words: Arithmetic) -> Self:
        """The same map over another kind of number."""

    @property
    def lifted(self) -> Self:
        """The same map over jets of its numbers."""

    def rule(self, near: Sequence[Any], parameter: Any) -> Any:
        """The rule at three successive points; its value is 0 if they belong to an orbit."""

    def slopes(self, near: Sequence[Any], parameter: Any) -> tuple[Any, Any, Any]:
        """The derivatives of the rule by its three points."""

    def linear(self, near: Sequence[Any], parameter: Any) -> tuple[Any, tuple[Any, Any, Any], Any]:
        """The rule, its derivatives by the three points, and its derivative by the parameter."""

    def rule_along(self, near: Sequence[Jet], parameter: Any) -> Jet:
        """The rule with jets in place of the three successive points."""

    def linear_along(self, near: Sequence[Jet], parameter: Any) -> tuple[Jet, tuple[Jet, Jet, Jet], Jet]:
        """The rule at jets, its derivatives by the three points, and its derivative by the parameter."""

    def following(self, previous: Any, here: Any, parameter: Any) -> Any:
        """The map: the point after `previous, here`."""

    def previous(self, here: Any, following: Any, parameter: Any) -> Any:
        """The inverse map: the point before `here, following`."""

    def plane(self, here: Any, following: Any) -> tuple[Any, Any]:
        """The coordinates in which the map is usually drawn: `(theta, phi)` of a pinball map."""

    def advanced(self, x: Array, y: Array, parameter: float, bounces: int) -> tuple[Array, Array]:
        """Points in the coordinates of `plane`, mapped by `bounces` bounces in float64; angles are modulo `2*pi`."""

    def neighbours(self, x: Array, y: Array, parameter: float) -> tuple[Any, Any]:
        """Points given in the coordinates of `plane`, as pairs `here, following`, in float64."""


@dataclass(frozen=True, eq=False)
class _Bound(ABC):
    """A plane map from a recurrence with a single rule, over one kind of number."""

    words: Arithmetic = field(default_factory=lambda: ARRAYS, kw_only=True)
    free: ClassVar = "lam"  # the name of the parameter in the recurrence

    def over(self, words: Arithmetic) -> Self:
        return replace(self, words=words)

    @cached_property
    def lifted(self) -> Self:
        return self.over(jets(self.words))

    @property
    @abstractmethod
    def ring(self) -> Recurrence:
        """The recurrence from which the map is made."""

    def at(self, parameter: Any) -> dict[str, Any]:
        """All parameters of the recurrence, by name."""
        return {"lam": parameter}

    @cached_property
    def _rule(self) -> Rule:
        return self.ring.over(self.words)

    def rule(self, near: Sequence[Any], parameter: Any) -> Any:
        return self._rule(0, near, self.at(parameter), 0).value

    def slopes(self, near: Sequence[Any], parameter: Any) -> tuple[Any, Any, Any]:
        return self._rule(0, near, self.at(parameter)).slope

    def linear(self, near: Sequence[Any], parameter: Any) -> tuple[Any, tuple[Any, Any, Any], Any]:
        terms = self._rule(0, near, self.at(parameter))
        return terms.value, terms.slope, terms.by[self.free]

    def rule_along(self, near: Sequence[Jet], parameter: Any) -> Jet:
        if type(near[0].c[0]) not in SERIES:
            return cast(Jet, self.lifted.rule(near, parameter))
        return along(near, lambda series: [self._in_series.rule(series, parameter)])[0]

    def linear_along(self, near: Sequence[Jet], parameter: Any) -> tuple[Jet, tuple[Jet, Jet, Jet], Jet]:
        if type(near[0].c[0]) not in SERIES:
            return self.lifted.linear(near, parameter)

        def listed(series: list[Any]) -> list[Any]:
            value, slopes, moving = self._in_series.linear(series, parameter)
            return [value, *slopes, moving]

        value, before, here, after, moving = along(near, listed)
        return value, (before, here, after), moving

    @cached_property
    def _in_series(self) -> Self:
        return self.over(in_series(self.words, SERIES[type(self.words.pi)]))


@dataclass(frozen=True, eq=False)
class Henon(_Bound):
    """The Henon map `x' = 1 - a*x**2 + y`, `y' = b*x`, or `x[n+1] = 1 - a*x[n]**2 + b*x[n-1]`, with parameter `a`.

    >>> from sympy import Rational
    >>> Henon(Rational(3, 10)).following(0.5, 1.0, 1.5)
    -0.35
    """

    b: Expr
    label: str = "Henon"
    turn: int = 0

    free: ClassVar = "a"

    @property
    def ring(self) -> Recurrence:
        return henon(1)

    def at(self, parameter: Any) -> dict[str, Any]:
        return {"a": parameter, "b": self._b}

    def following(self, previous: Any, here: Any, parameter: Any) -> Any:
        return 1 - parameter * here * here + self._b * previous

    def previous(self, here: Any, following: Any, parameter: Any) -> Any:
        return (following - 1 + parameter * here * here) / self._b

    def plane(self, here: Any, following: Any) -> tuple[Any, Any]:
        return following, self._b * here

    def advanced(self, x: Array, y: Array, parameter: float, bounces: int) -> tuple[Array, Array]:
        with np.errstate(all="ignore"):  # points that escape overflow
            for _ in range(bounces):
                x, y = 1 - parameter * x * x + y, float(self.b) * x
        return x, y

    def neighbours(self, x: Array, y: Array, parameter: float) -> tuple[Any, Any]:
        return y / float(self.b), x

    @cached_property
    def _b(self) -> Any:
        return self.words.q(int(self.b.p), int(self.b.q))


@dataclass(frozen=True, eq=False)
class Pinball(_Bound):
    """The pinball map of a table of one component, with parameter `lam`; its points are angles, not reduced modulo
    `2*pi`.

    Forwards, a particle lands where the chord makes the exit angle of the law with the normal; in a table that is not
    convex it is the first such place, computed in float64 only. Backwards, the chord makes the angle that the law maps
    to `phi`: `-phi/lam` for the paper's law; for another law, which must decrease, it is found by bisection (float64
    only). Where this angle exceeds `pi/2`, the result is NaN.

    >>> from symbolic.tables import circle
    >>> round(float(Pinball(circle).following(0.0, 3.0, 1.0)), 12)
    6.0
    """

    table: Table
    label: str = "pinball"
    turn: int = 1
    law: Law = PAPERS_LAW

    @property
    def ring(self) -> Recurrence:
        return Chords(self.table, (0,), law=self.law)

    @cached_property
    def exit(self) -> Callable[..., Any]:
        """The exit angle of a law other than the paper's, as a function of incidence angle, parameter and landing."""
        made = load(law_kernel(self.law, 0), self.words)
        return lambda *at: made(*at)[0]

    def following(self, previous: Any, here: Any, parameter: Any) -> Any:
        eta = self.angle(here, previous)[0]
        phi = -parameter * eta if self.law.uniform else self.exit(eta, parameter, here)
        return self._other_end(here, phi, 0)

    def previous(self, here: Any, following: Any, parameter: Any) -> Any:
        phi = self.angle(here, following)[0]
        if self.law.uniform:
            return self._other_end(here, -phi / parameter, -1)
        if self.words is not ARRAYS:
            raise ValueError(f"{self.label}: law = {self.law} is solved for the angle of incidence in float64 alone")
        low, high = np.full_like(phi, -np.pi / 2), np.full_like(phi, np.pi / 2)
        beyond = ~((self.exit(low, parameter, here) > phi) & (phi > self.exit(high, parameter, here)))
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            over = self.exit(middle, parameter, here) > phi
            low, high = np.where(over, middle, low), np.where(over, high, middle)
        return self._other_end(here, np.where(beyond, np.nan, low), -1)

    def plane(self, here: Any, following: Any) -> tuple[Any, Any]:
        return here, self.angle(here, following)[0]

    def advanced(self, x: Array, y: Array, parameter: float, bounces: int) -> tuple[Array, Array]:
        made = advanced(_kernel(self.table, self.law, parameter), phase_points(x, y), bounces)
        lost = made.code != 0
        return np.where(lost, np.nan, made.points.theta), np.where(lost, np.nan, made.points.phi)

    def neighbours(self, x: Array, y: Array, parameter: float) -> tuple[Any, Any]:
        hit = _kernel(self.table, self.law, parameter).step(x, y)
        return x, np.where(hit.code == 0, hit.theta, np.nan)

    @cached_property
    def angle(self) -> Callable[..., Any]:
        """The angle of a chord with the normal at its start, and its derivatives by both ends."""
        return chord_angles(self.table, self.words)(0, 0, 1)

    def _other_end(self, here: Any, phi: Any, turns: int) -> Any:
        """The other end of the chord from `here` at the angle `phi`, in the turn that begins at `here + 2*pi*turns`."""
        arrive = landing if convex(self.table) else first_landing
        start = arrive(self.table, floating(here), floating(phi), turns)
        if self.words is ARRAYS:
            return start

        reached: Any = None

        def correction(x: Vector) -> Vector:
            nonlocal reached
            (reached,) = x
            value, _, slope, *_ = self.angle(here, reached)
            return [(value - phi) / slope]

        def size(parts: Sequence[Any]) -> float:
            return largest([share(parts[0], reached)])

        return iterated(correction, [here * 0 + (start if np.ndim(start) else float(start))], NEWTON, size).x[0]


def pinball(table: Table, law: Law = PAPERS_LAW) -> Pinball:
    """The map of a table under a law, with the rotations that are symmetries of both.

    >>> from symbolic.tables import egg
    >>> pinball(egg(5).at(alpha="1/40")).turn
    5
    """
    return Pinball(table, turn=1 if law.placed else rotations(table), law=law)


@lru_cache(maxsize=4)
def _kernel(table: Table, law: Law, lam: float) -> PinballMap:
    return PinballMap(table, lam=lam, law=law)


@cache
def _elastic(table: Table) -> PinballMap:
    return PinballMap(table, lam=1)


def first_landing(table: Table, here: Any, phi: Any, turns: int = 0) -> Any:
    """The first hit from `here` at the exit angle `phi`, on any table of one component, in float64; NaN if none.

    >>> from symbolic.tables import circle
    >>> round(first_landing(circle, 0.0, 0.5), 12)
    2.14159265359
    """
    low, angle = np.broadcast_arrays(np.asarray(here) + 2 * np.pi * turns, phi)
    flies = np.isfinite(low) & (np.abs(angle) < np.pi / 2)
    start = np.where(flies, np.remainder(low + np.pi, 2 * np.pi) - np.pi, 0.0)
    hit = _elastic(table).step(np.atleast_1d(start), np.atleast_1d(np.where(flies, angle, 0.0)))
    landed = np.where(hit.code == 0, hit.theta, np.nan).reshape(low.shape)
    found = np.where(flies, low + np.remainder(landed - low, 2 * np.pi), np.nan)
    return found if found.ndim else float(found)


def share(step: Any, x: Any) -> Any:
    """A Newton correction `step` divided by `1 + abs(x)`; for jets, coefficient by coefficient.

    Along an unstable manifold derivatives grow from bounce to bounce, and so does the rounding of their corrections.
    """
    if not isinstance(step, Jet):
        return step / (1 + abs(x))
    return Jet(*(a / (1 + abs(b)) for a, b in zip(step.c, x.c, strict=True))) if isinstance(x, Jet) else step


def floating(x: Any) -> Any:
    """A number, or the constant term of a jet, in float64."""
    middle = x.c[0] if isinstance(x, Jet) else x
    return np.asarray(middle, dtype=float) if np.ndim(middle) else float(middle)
