"""Every return to the arc of the cuspless cardioid stretches, for `1/10 <= lam < 1`: a proof from inequalities.

Paper: section 5. In the notation of `defocusing` and `splitting` a beam leaves the arc with curvature `-y/D` and
`dphi = (1 - y)*|K|*ds`, and the cone is `1 <= y <= 1 + lam`. A bounce on the wall may narrow beams, but the form

    L = (y - B)*|K|*ds = (1 - B)*|K|*ds - dphi,    B = 11/20,

grows at every return, since beams that have been narrowed leave with a larger `y`. In the cone `L` is positive, with
`(1 - B)*|K|*ds <= L <= (1 + lam - B)*|K|*ds`. Let `A = 1 + lam - B`. A return multiplies `L` by

    (A*(t*y - D0)/d1 - lam*y)/(y - B)                            along the arc,
    (A*(r*(t*y - D0) + lam*y*t1)/d - lam**2*y)/(y - B)           by way of the wall,    r = cos(phi)/cos(eta),

where `eta` and `phi` are the incidence and exit angles at the wall, `t` and `t1` the flights before and after it, and
`d = cos(eta)/|K|` at the final landing. Either factor is a quotient of linear functions of `y` without a pole in the
cone, so it is least at an end of the cone.

*Along the arc*, with `x = c0/c1` and `C = cos(delta)`, the factor exceeds 1 at `y = 1` by `A/(1 - B)` times the gain
minus 1, and at `y = 1 + lam` by `q/(2*A*(1 + 2*x*C))`, where

    q = A*(x**2 + 1 - 2*x*C) + 3*A*lam*(x**2 + 1 + 2*x*C) - 2*lam*(1 + lam)*(1 + 2*x*C).

Since `delta >= (1 - lam)*pi/4`, `C**2 <= (1 + sin(lam*pi/2))/2 <= 1/2 + 4*lam/5`; and `q - 2*A*e*(1 + 2*x*C)` is a
quadratic polynomial in `x`, positive for each such `C`, and `x >= 0` where `C < 0`, if `along_arc` holds with
`e = EXCESS`.

*By way of the wall*, let `Q = (t - D)*cos(eta)`, and let `X` be the distance from the wall, with index 0 at the start
and 1 at the end. The factor exceeds 1 at `y = 1` and at `y = 1 + lam` if and only if

    A*(r**2*Q0 + lam*X1) > (1 - B + lam**2)*(X1 - Q1),
    A*(r**2*(Q0 + lam*X0) + lam*(1 + lam)*X1) > (A + lam**2*(1 + lam))*(X1 - Q1).

The end of the return enters only by `X1 - Q1 <= (2/3 - 2/(3*(2*c1 + 1)**2))*X1` (`splitting.share_defects`). So, where
the terms of this end have to be compensated at all, they become worse as `c1` grows, and the worst case is `c1 = 1`,
where `X1 = 9/4` and `X1 - Q1 <= 4/3`. It remains to show that `margins`, functions of `theta0/2`, of the exit angle at
the arc and of `lam`, are positive for `abs(phi0) <= lam*pi/2` and `abs(eta) < pi/2`
(`verification.proofs.global_dynamics.returns`, in balls, for `lam <= 3/5`).

*So*, for `1/10 <= lam <= 3/5`, each return to the arc, in at most two bounces, multiplies `L` by a number above 1 that
depends on `lam` alone; for `16/27 < lam < 1` widths grow (`splitting.least_rate`). As curvature is bounded on the arc,
*every orbit that misses the joins stretches at an exponential rate, for every `1/10 <= lam < 1`*. So no cycle off the
joins attracts.

*Near the joins again and again.* A curve along the cone that never meets a join would grow beyond all bounds, although
its images lie on one component each. So on every horizontal segment of the arc some point lands on a join after
finitely many bounces, and its neighbours land near this join, on curves along the cone again. So the starts that come
as near to a join as wanted, as late as wanted, are open and dense among those that miss the joins, and their
intersection is dense (Baire).

It is not shown that the limits exist, or that there is a dense orbit; orbits that meet a join are not treated.
"""

from functools import cache

from sympy import Expr, Interval, Matrix, Rational, S, Symbol, cos, symbols

from symbolic.cycles.defocusing import C, expands, half, x
from symbolic.cycles.splitting import c, clear, share_defects, splits
from symbolic.expressions.signs import SignFinding, all_vanish, conjunction, defect, positive
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t

B, EXCESS = Rational(11, 20), Rational(1, 20)
LOWEST, HIGHEST = Rational(1, 10), Rational(3, 5)  # for larger `lam` widths grow
leaves = Symbol("leaves", real=True)  # the exit angle at the arc, with the sign of three halves of theta
A = 1 + lam - B
y, D0, d, t1, cos_phi1, cos_eta2, K2 = symbols("y D0 d t1 cos_phi1 cos_eta2 K2", nonzero=True)


def form(vector: Matrix, bend: Expr) -> Expr:
    """The linear form `L` on a tangent vector `(ds, dphi)`, where `bend` is the curvature, negative on the arc.

    >>> form(Matrix([1, 0]), -1)
    9/20
    """
    return -(1 - B) * bend * vector[0] - vector[1]


def return_defects() -> list[Expr]:
    """The form `L = (1 - B)*|K|*ds - dphi` after a return, from the derivative matrices, minus its formula; both are 0.

    The first is for a return along the arc, the second for one by way of the wall.

    >>> return_defects()
    [0, 0]
    """
    first, start = derivative_matrix(), Matrix([1, -y * cos_phi0 / D0 - K0])
    focal = {K0: -cos_phi0 / D0}
    along = form(first * start, K1).subs({**focal, K1: -cos_eta1 / d})
    second = first.subs({t: t1, cos_phi0: cos_phi1, cos_eta1: cos_eta2, K0: 0, K1: K2}, simultaneous=True)
    by_wall = -form(second * first.subs(K1, 0) * start, K2).subs({**focal, K2: -cos_eta2 / d})
    size = cos_phi0 / D0  # |K|*ds
    return [defect(along / size - along_arc_form()), defect(by_wall / size - by_wall_form())]


def along_arc_form() -> Expr:
    """The value of `L` (see the module) after a return along the arc, if it was `y - B` before."""
    return A * (t * y - D0) / d - lam * y


def by_wall_form() -> Expr:
    """The value of `L` (see the module) after a return by way of the wall, if it was `y - B` before."""
    return A * (cos_phi1 / cos_eta1 * (t * y - D0) + lam * y * t1) / d - lam**2 * y


def end_defects() -> list[Expr]:
    """The growth of `L` minus 1, at both ends of the cone for both returns, minus the module's formulas; all are 0.

    >>> end_defects()
    [0, 0, 0, 0]
    """
    Q0, Q1, X0, X1 = symbols("Q0 Q1 X0 X1", positive=True)
    arc, wall = along_arc_form() - (y - B), by_wall_form() - (y - B)
    gain, squared = 1 + (x**2 + 1 - 2 * x * C) / (2 * (1 + 2 * x * C)), x**2 + 1 + 2 * x * C
    chord = {
        t: Rational(3, 2) * squared / (1 + 2 * x * C) * d,
        D0: Rational(3, 2) * squared / (1 + 2 * x * C) * d - gain * d,
    }
    sides = {t: X0 / cos_eta1, D0: (X0 - Q0) / cos_eta1, t1: X1 / cos_phi1, d: (X1 - Q1) / cos_phi1}
    rest, squeezed = X1 - Q1, (cos_phi1 / cos_eta1) ** 2
    return [
        defect(arc.subs(y, 1).subs(chord) - A * (gain - 1)),
        defect(arc.subs(y, 1 + lam).subs(chord) - quadratic() / (2 * (1 + 2 * x * C))),
        defect(wall.subs(y, 1).subs(sides) * rest - A * (squeezed * Q0 + lam * X1) + (1 - B + lam**2) * rest),
        defect(
            wall.subs(y, 1 + lam).subs(sides) * rest
            - A * (squeezed * (Q0 + lam * X0) + lam * (1 + lam) * X1)
            + (A + lam**2 * (1 + lam)) * rest
        ),
    ]


def quadratic() -> Expr:
    """The polynomial `q` of the module's text, in `x`, `C` and `lam`."""
    return A * (x**2 + 1 - 2 * x * C) + 3 * A * lam * (x**2 + 1 + 2 * x * C) - 2 * lam * (1 + lam) * (1 + 2 * x * C)


def along_arc() -> SignFinding:
    """Is `q - 2*A*EXCESS*(1 + 2*x*C) = a*x**2 - 2*b*C*x + e` positive?

    This is to hold for `C**2 <= 1/2 + 4*lam/5`, and for `x >= 0` if `C < 0`. It does if `a`, `b` and `e` are positive
    and `a*e > b**2*(1/2 + 4*lam/5)`.

    >>> along_arc().outcome.name
    'PROVED'
    """
    polynomial = (quadratic() - 2 * A * EXCESS * (1 + 2 * x * C)).expand()
    a, b, e = polynomial.coeff(x, 2), (-polynomial.coeff(x, 1) / (2 * C)).expand(), polynomial.coeff(x, 0)
    box = {lam: Interval(LOWEST, HIGHEST)}
    return conjunction(*(positive(part, box) for part in (a, b, e, a * e - b**2 * (S.Half + 4 * lam / 5))))


def margins() -> tuple[Expr, Expr]:
    """Two functions of `half`, `leaves` and `lam` that must be positive for returns by way of the wall.

    They are the conditions of the module, multiplied by `cos(eta)**2`.

    >>> [margin.subs({half: 0, leaves: 0, lam: Rational(1, 10)}) for margin in margins()]
    [7/480, 77/4800]
    """
    eta = leaves - 3 * half
    Q0 = clear().subs(c, cos(half)) + 2 * cos(half) / 3 * (1 - cos(2 * leaves - 3 * half))
    X0 = (4 * cos(half) ** 2 - 1) ** 2 / 4
    asked = Rational(4, 3) * (1 - B + lam**2) - Rational(9, 4) * A * lam
    asked_last = Rational(4, 3) * (A + lam**2 * (1 + lam)) - Rational(9, 4) * A * lam * (1 + lam)
    return (
        A * cos(lam * eta) ** 2 * Q0 - asked * cos(eta) ** 2,
        A * cos(lam * eta) ** 2 * (Q0 + lam * X0) - asked_last * cos(eta) ** 2,
    )


@cache
def returns() -> SignFinding:
    """Are the identities and the inequality along the arc proved? The `margins` are left to ball arithmetic."""
    steps = {
        "a form of beams after a return": return_defects(),
        "its growth at both ends of the cone": end_defects(),
        "the second end of a way by the wall": share_defects(),
    }
    return conjunction(expands(), splits(), along_arc(), all_vanish(steps))
