"""Every cycle of period 2, in one number: `P = (1 + t*K0)*(1 + t*K1)`.

A cycle of period 2 runs along a chord that is normal to the boundary at both ends (its exit angle
`phi` satisfies `phi = -lam*phi` up to sign, so it vanishes for `lam < 1`; at `lam = 1` a chord
retraced is normal too). Its monodromy has determinant `lam**2` and trace `(1+lam)**2*P - 2*lam`,
whatever the table. All the thresholds of the paper's period-2 orbits follow from `P`:

    |mu| < 1    exactly when  -((1-lam)/(1+lam))**2 < P < 1,
    mu complex  exactly when  0 < P < 4*lam/(1+lam)**2     (then |mu| = lam).
"""

from sympy import Expr, S, factor, simplify, sqrt

from symbolic.cycles.cycle import Cycle
from symbolic.motion.collision import derivative_matrix
from symbolic.proofs.signs import Box, Finding, conjunction, nonnegative, positive
from symbolic.tables.symbols import K0, K1, lam, t


def stability_number(cycle: Cycle) -> Expr:
    """`P = (1 + t*K0)*(1 + t*K1)` of a cycle of period 2, free of units.

    >>> from symbolic.cycles.named import cuspless_horizontal, egg_diameter
    >>> stability_number(cuspless_horizontal())
    -11/16
    >>> stability_number(egg_diameter())
    (alpha**2 - 18*alpha - 1)*(alpha**2 + 18*alpha - 1)/((alpha - 1)**2*(alpha + 1)**2)
    """
    start, end = cycle.frames
    length = cycle.length(0)
    return factor(simplify((1 + length * start.curvature) * (1 + length * end.curvature)))


def general_trace_and_determinant() -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy of any double normal, from the derivative matrix.

    >>> trace, det = general_trace_and_determinant()
    >>> simplify(trace - trace_of((1 + t * K0) * (1 + t * K1))), simplify(det)
    (0, lam**2)
    """
    there = derivative_matrix(K0, K1, t, S.One, S.One)
    back = derivative_matrix(K1, K0, t, S.One, S.One)
    monodromy = back * there
    return monodromy.trace(), monodromy.det()


def trace_of(P: Expr, contraction: Expr = lam) -> Expr:
    """The trace of the monodromy matrix of a double normal with stability number `P`.

    >>> trace_of(S.Zero)
    -2*lam
    """
    return (1 + contraction) ** 2 * P - 2 * contraction


def flip_contraction(P: Expr) -> Expr:
    """The contraction at which a multiplier is -1, for `-1 <= P < 0`; below it the cycle is stable.

    >>> from sympy import Rational
    >>> flip_contraction(Rational(-1, 4))
    1/3
    """
    r = sqrt(-P)
    return (1 - r) / (1 + r)


def focus_contraction(P: Expr) -> Expr:
    """The contraction above which the multipliers are complex, for `0 <= P <= 1`.

    >>> from sympy import Rational
    >>> focus_contraction(Rational(3, 4))
    1/3
    """
    r = sqrt(1 - P)
    return (1 - r) / (1 + r)


def stable_while_nonnegative(P: Expr, box: Box) -> Finding:
    """Are both multipliers inside the unit circle because `0 <= P < 1` and `lam < 1` on the box?

    `1 - trace + det = (1+lam)**2*(1 - P)` and `1 + trace + det = (1+lam)**2*P + (1-lam)**2`.

    >>> from sympy import Interval
    >>> stable_while_nonnegative(S.Zero, {lam: Interval.Ropen(0, 1)}).outcome.name
    'PROVED'
    """
    return conjunction(positive(1 - P, box), nonnegative(P, box), positive(1 - lam, box))
