"""Systems for cycles at a bifurcation of any kind, in as many free parameters as there are conditions.

A fold or a flip of a long cycle of a billiard is a `Problem`, solved in linear time. This module takes every
bifurcation that `verification.cycles.recurrence` defines, and several at once (points of codimension two),
for cycles of a few dozen bounces. Equations are written once, and their derivatives come from evaluating them on
jets.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from sympy import Expr, pi

from symbolic.expressions.text import constant, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import cuspless, egg
from verification.arithmetic.balls import Arithmetic
from verification.arithmetic.iteration import Vector
from verification.arithmetic.series import Jet, jets
from verification.cycles.chords import Chords
from verification.cycles.recurrence import BifurcationKind, Closure, Recurrence, Terms


@dataclass(frozen=True)
class Small:
    """A small system: as many `equations(arithmetic, z)` as unknowns, 0 at a solution."""

    label: str
    equations: Callable[[Arithmetic, Vector], Vector]

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The equations `F(z)`."""
        return self.equations(arithmetic, z)

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The solution `x` of `F'(z) x = r`."""
        rows: list[Vector] = [[] for _ in r]
        words = jets(arithmetic)
        for j in range(len(z)):
            moved = [Jet(x, 1 if i == j else 0) for i, x in enumerate(z)]
            for row, e in zip(rows, self.equations(words, moved), strict=True):
                row.append(e.c[1])
        return solved([[*row, x] for row, x in zip(rows, r, strict=True)])

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction `F'(z)^-1 F(z)`."""
        return self.solved(arithmetic, z, self.value(arithmetic, z))


def solved(rows: list[Vector]) -> Vector:
    """The solution of a small linear system given as augmented rows, with pivoting.

    >>> solved([[0.0, 2.0, 2.0], [1.0, 1.0, 3.0]])
    [2.0, 1.0]
    """
    n = len(rows)
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(_middle(rows[i][k])))
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    x: Vector = [0] * n
    for k in reversed(range(n)):
        total = rows[k][n]
        for j in range(k + 1, n):
            total = total - rows[k][j] * x[j]
        x[k] = total / rows[k][k]
    return x


def _middle(x: Any) -> Any:
    return x.mid() if hasattr(x, "mid") else x


def corner() -> Small:
    """System for the period-4 orbit through both corners of the cuspless cardioid; its unknowns are `theta1` and `lam`.

    It leaves the upper corner (`theta = 2*pi/3`), meets the arc at `theta1`, the lower corner, the arc at `-theta1`,
    and returns. By the mirror symmetry two collision rules are enough: at the corner, where the normal exists because
    the joins are C1, and at `theta1`. Paper: section 5.2.
    """

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        theta1, lam = z
        angle = load(chord_kernel(cuspless, 0, 0, 0), arithmetic)
        edge = corner_parameter(arithmetic)
        return [
            angle(edge, theta1)[0] + lam * angle(edge, -theta1)[0],
            angle(theta1, -edge)[0] + lam * angle(theta1, edge)[0],
        ]

    return Small("cuspless, the orbit through both corners", equations)


def corner_parameter(arithmetic: Arithmetic) -> Any:
    """The parameter `2*pi/3` of the upper corner on the arc."""
    return load(constant(2 * pi / 3), arithmetic)()[0]


def corner_angle(arithmetic: Arithmetic, theta1: Any) -> Any:
    """The exit angle at the upper corner; at the solution of `corner` it is the paper's `phi-star`."""
    return load(chord_kernel(cuspless, 0, 0, 0), arithmetic)(corner_parameter(arithmetic), theta1)[0]


def focus(lam: Expr) -> Small:
    """System for the `alpha` at which the multipliers of the egg's diameter become complex.

    The unknowns are two bounces and `alpha`; the third equation is `trace**2 = 4*determinant` of the monodromy, from
    the chord system.
    """
    table = egg(3)  # made once: its formulas are simplified, which takes 77 ms

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        first, second, alpha = z
        contraction = load(constant(lam), arithmetic)()[0]
        angle = load(chord_kernel(table, 0, 0, 1), arithmetic)
        forth, back = angle(first, second, alpha), angle(second, first, alpha)
        rules = [(1 + contraction) * f[0] for f in (forth, back)]
        # x[i+1] = -(d/u)*x[i] - lam*x[i-1]: both neighbours are the same point, so lower = lam*upper
        a, b = ((1 + contraction) * f[1] / f[2] for f in (forth, back))
        trace, determinant = a * b - 2 * contraction, contraction * contraction
        return [*rules, trace * trace - 4 * determinant]

    return Small("egg, where the diameter's multipliers become complex", equations)


def critical(
    recurrence: Recurrence,
    kinds: Sequence[BifurcationKind],
    parameters: Sequence[str],
    fixed: Mapping[str, Expr] | None = None,
) -> Small:
    """System for a cycle that has all the bifurcations `kinds` at once: unknowns are its bounces, then the
    `parameters`.

    >>> from verification.cycles.recurrence import delayed
    >>> from verification.cycles.newton import floats
    >>> torus = critical(delayed(1), [BifurcationKind.TORUS], ["r"])  # at r = 2 [MaynardSmith1968]
    >>> [round(x, 12) for x in floats(torus, [0.4, 1.9])]
    [0.5, 2.0]
    """
    n, closure = recurrence.period, recurrence.closure
    if len(kinds) != len(parameters):
        raise ValueError(
            f"{recurrence.label}: {len(kinds)} conditions, {len(parameters)} free parameters; accepted: as many"
        )

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        rule = recurrence.over(arithmetic)
        at = {name: load(constant(value), arithmetic)()[0] for name, value in (fixed or {}).items()}
        at |= zip(parameters, z[n:], strict=True)
        ring = closure.padded(z[:n], closure.angle(arithmetic))
        terms = Terms.along([rule(i, ring[i : i + 3], at) for i in range(n)])
        return [*terms.value, *(kind.bordering(terms.rows, closure.turn) for kind in kinds)]

    return Small(f"{' and '.join(kind.value for kind in kinds)} of {recurrence.label}", equations)


def polygon_fold(K: int, alpha: Expr, p: int = 1, q: int = 3) -> Small:
    """System for the fold of the egg's cycle that turns by `2*pi*p/q` at each bounce: unknowns `theta` and `lam`.

    If this rotation maps the table to itself, a single bounce, whose neighbours are its rotated images, is enough.

    >>> from sympy import Rational
    >>> import mpmath
    >>> from verification.cycles.newton import refined
    >>> found = refined(polygon_fold(3, Rational(2, 25)), [-0.55, 0.378], 20)
    >>> mpmath.nstr(found.z[1], 15)
    '0.37812125259009'
    """
    ring = polygon(K, p, q)
    return critical(replace(ring, table=ring.table.at(alpha=alpha)), [BifurcationKind.FOLD], ["lam"])


def polygon(K: int, p: int, q: int) -> Chords:
    """Chord system of the egg's cycle that turns by `2*pi*p/q` at each bounce, reduced to one bounce."""
    if K * p % q:
        raise ValueError(f"polygon: a turn by {p}/{q} does not map the egg with K = {K} to itself")
    return Chords(egg(K), (0,), Closure(1, (p, q)))
