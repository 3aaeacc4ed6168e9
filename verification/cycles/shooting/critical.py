"""Cycles that bifurcate, of any recurrence and in any way, in as many free parameters as there are conditions.

A fold or a flip of a long cycle is a `Problem`, solved in linear time. What is here takes every bifurcation that
`verification.cycles.recurrence.bifurcations` defines, and several at once (points of codimension two), for cycles of a
few dozen bounces.
"""

from collections.abc import Mapping, Sequence

from sympy import Expr

from symbolic.generation.text import constant, load
from symbolic.tables import egg
from verification.arithmetic.words import Arithmetic
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.chain import Vector
from verification.cycles.recurrence.chords import Chords
from verification.cycles.recurrence.closure import Closure
from verification.cycles.recurrence.recurrence import Recurrence
from verification.cycles.shooting.small import Small


def critical(
    recurrence: Recurrence,
    kinds: Sequence[BifurcationKind],
    parameters: Sequence[str],
    fixed: Mapping[str, Expr] | None = None,
) -> Small:
    """The cycle that bifurcates in all these `kinds`: unknowns are its bounces, then the free `parameters`.

    >>> from verification.cycles.recurrence.explicit import delayed
    >>> from verification.cycles.shooting.newton import floats
    >>> torus = critical(delayed(1), [BifurcationKind.TORUS], ["r"])  # at r = 2 [MaynardSmith1968]
    >>> [round(x, 12) for x in floats(torus, [0.4, 1.9])]
    [0.5, 2.0]
    """
    n, closure = recurrence.period, recurrence.closure
    if len(kinds) != len(parameters):
        raise ValueError(f"{recurrence.label}: {len(kinds)} conditions for {len(parameters)} free parameters")

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        rule = recurrence.over(arithmetic)
        at = {name: load(constant(value), arithmetic)()[0] for name, value in (fixed or {}).items()}
        at |= zip(parameters, z[n:], strict=True)
        ring = closure.padded(z[:n], closure.angle(arithmetic))
        found = [rule(i, ring[i : i + 3], at) for i in range(n)]
        rows = [slopes for _, slopes in found]
        return [*(value for value, _ in found), *(kind.bordering(rows, closure.turn) for kind in kinds)]

    return Small(f"{' and '.join(kind.value for kind in kinds)} of {recurrence.label}", equations)


def polygon_fold(K: int, alpha: Expr, p: int = 1, q: int = 3) -> Small:
    """Unknowns `theta` and `lam` at the fold of the egg's cycle that turns by `2*pi*p/q` at each bounce.

    Where that turn maps the table to itself, one bounce with its neighbours a turn away is the whole system.

    >>> from sympy import Rational
    >>> import mpmath
    >>> from verification.cycles.shooting.newton import refined
    >>> found = refined(polygon_fold(3, Rational(2, 25)), [-0.55, 0.378], 20)
    >>> mpmath.nstr(found.z[1], 15)
    '0.37812125259009'
    """
    if K * p % q:
        raise ValueError(f"polygon: a turn by {p}/{q} does not map the egg with K = {K} to itself")
    one = Chords(egg(K).at(alpha=alpha), (0,), Closure(1, (p, q)))
    return critical(one, [BifurcationKind.FOLD], ["lam"])
