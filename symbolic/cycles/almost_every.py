"""Every orbit of the cardioid is hyperbolic at every contraction below 1, and bounds for almost every one.

Paper: section 4.1. In the notation of `defocusing` and `splitting`, lengths along the wall are measured by `|K|*ds`,
of which the whole boundary has `3*pi`; a beam leaves with curvature `-y/D`, `dphi = (1 - y)*|K|*ds`; the cone is `1
<= y <= 1 + lam`, and horizontal lines, `phi` constant, are curves along it, with `y = 1`. `P` is the strip `|phi| <=
lam*pi/2`.

*Pieces.* From every point of the wall the cusp is in sight, at one exit angle: a curve `S` in phase space, a graph
over the whole wall. A beam focused at the cusp, at a distance `t`, has `y = D0/t < 1`, since `t*(t - D0) =
(4/3)*(c0*sin(delta))**2 > 0` for a chord that ends there. So `dphi > 0` along `S`, when `ds > 0`, and `dphi <= 0` on
a curve along the cone: such a curve meets `S` at most once. Off `S` the map is smooth, and takes the curve to curves
along the cone, at most two. So the image of a horizontal line after `n` bounces has at most `2**n` pieces, each
monotone in `s`, at most `3*pi` long. With `r = (t*y - D0)/d1` the factor by which a bounce lengthens the curve at a
point,

    mean over the line of r_1*r_2*...*r_n  <=  2**n.

By Markov's inequality the points of the line where the product exceeds `exp(n*(log(2) + e))` have at most the share
`exp(-n*e)`; these shares sum up, so by Borel and Cantelli, and Fubini, *for almost every start* the upper limit of
`log(r_1*...*r_n)/n` is at most `log(2)`. As `|K| >= 3/4` and slopes in the cone are bounded, this bounds the growth
of every vector: almost every start has `nu_plus <= log(2)`, as an upper limit.

*Areas.* In `|K|*ds` and `dphi` a bounce multiplies areas by `lam*D0/d1 = lam*r*D0/(t*y - D0)`, and `D0/(t*y - D0) <=
2` in the cone, since `2*t >= 3*D0`. So on every orbit off the cusp, back in `ds` and `dphi`,

    |det D(T**n)| <= (4/3)*|K_0|*(2*lam)**n * r_1*...*r_n,

and for almost every start the upper limit of `log|det D(T**n)|/n` is at most `log(4*lam)`: it tends to minus infinity
with `lam`, and is negative for `lam < 1/4`, where the area of `T**n(P)` is at most `4*pi**2*lam*(4*lam)**n`.

*The other direction.* On an orbit that never meets the cusp the directions that no bounce takes into the cone are one
(`splitting`), `E`. With `y = D0/(t - f)` it has `0 < f < d1`, since the next `y` is `1 + lam - lam*d1/f` and below 1.
So `|K|*ds` of a vector of `E` is multiplied by `(D0/d1)*f/(t - f)`, less than `D0/(t - d1) <= 1`: the reciprocal of
the gain on the chord run backwards, at most `1/g` on every flight but the first. Its `abs(dphi)` is less, as `0 < y <
1`, while a pushed-forward horizontal vector has `y >= 1 + lam*(1 - 1/g)` from the second bounce on. So *every* orbit
off the cusp is hyperbolic for `0 < lam < 1`, and uniformly so in `|K|*ds = (3/2)*d(theta)` and `dphi`: one direction
is stretched by `g` at each bounce, the other shrinks by `g`, and they keep apart by an angle that depends on `lam`
alone. In `ds` and `dphi` too the lower limit of the one rate is at least `log(g)`, by `defocusing`, and the upper
limit of the other at most `-log(g)`, since `|K| >= 3/4`. Areas spanned by the two are the product of their lengths
and the gap of their `y`, so what is said of areas bounds the second rate by `log(2*lam)` as well.

*No cycle.* A curve along the cone that is never cut would outgrow the wall; so two points of a horizontal line whose
orbits are on the same side of `S` at every bounce are one point. An orbit that converges to a cycle is from some
bounce on where the cycle is, which is off `S`; there are countably many sequences of sides that end periodically, so
countably many such points on each line. So *almost every orbit converges to no cycle*; nor does any to the cusp
(`defocusing`). The likely limit set [Milnor1985], the smallest closed set that holds the limit points of almost every
orbit, is therefore not a finite union of cycles.

Not shown: that the limits exist; that the likely limit set is in one piece; a natural measure.
"""

from functools import cache

from sympy import Expr, Matrix, Min, Rational, S, limit, log, oo, symbols

from symbolic.cycles.defocusing import C, excess, gain, least_exponent, x
from symbolic.cycles.splitting import arc_defect, splits
from symbolic.expressions.signs import Finding, all_vanish, conjunction, defect
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t

y, D0, d1 = symbols("y D0 d1", positive=True)
LENGTHENED = (t * y - D0) / d1


def bounce() -> Matrix:
    """The derivative matrix in `(|K|*ds, dphi)`, with `cos(phi0) = |K0|*D0` and `cos(eta1) = |K1|*d1`.

    >>> bounce()[0, :]
    Matrix([[(-D0 + t)/d1, -t/d1]])
    """
    matrix = derivative_matrix()
    rows = [[matrix[0, 0] * K1 / K0, -matrix[0, 1] * K1], [-matrix[1, 0] / K0, matrix[1, 1]]]  # |K| is -K
    return Matrix(rows).subs({cos_phi0: -K0 * D0, cos_eta1: -K1 * d1}).applyfunc(lambda entry: entry.cancel())


def growth_defects() -> list[Expr]:
    """By what a vector of the cone grows, and by what areas, minus what is said above: zeros.

    >>> growth_defects()
    [0, 0]
    """
    along = (bounce() * Matrix([1, 1 - y]))[0]
    return [defect(along - LENGTHENED), defect(bounce().det() - lam * LENGTHENED * D0 / (t * y - D0))]


def cusp_defects() -> list[Expr]:
    """A beam with `y = D0/t` has no width where it lands, and a chord to the cusp is longer than `D0`: zeros.

    The second is `t*(t - D0 - d1)` for `c1 = 0`, hence `d1 = 0`, in units of `(c0*sin(delta))**2`, minus 4/3.

    >>> cusp_defects()
    [0, 0]
    """
    focused = LENGTHENED.subs(y, D0 / t)
    return [defect(focused), limit(excess() / x**2, x, oo) - Rational(4, 3)]


def shrinking_defects() -> list[Expr]:
    """`1 - y` and `|K|*ds` after a bounce of a vector with `y = D0/(t - f)`, minus what is said above: zeros.

    >>> shrinking_defects()
    [0, 0]
    """
    f = symbols("f", positive=True)
    out = bounce() * Matrix([1, 1 - D0 / (t - f)])
    return [defect(out[1] / out[0] + lam - lam * d1 / f), defect(out[0] - D0 / d1 * f / (t - f))]


def backward_defect() -> Expr:
    """`(t - d1)/D0` is the gain with the ends of the chord exchanged, `x` for `1/x`: zero.

    In units in which `c1 = 1`, and divided by `sin(delta)**2/t` above and below.

    >>> backward_defect()
    0
    """
    focal = Rational(8, 3) * x * (x + 2 * C)  # t*D0/sin(delta)**2
    return defect(1 + excess() / focal - gain().subs(x, 1 / x))


def largest_exponent() -> Expr:
    """What the upper limit of `log|D(T**n)|/n` is at most, for almost every start."""
    return log(S(2))


def largest_sum() -> Expr:
    """What the upper limit of `log|det D(T**n)|/n` is at most, for almost every start.

    >>> largest_sum().subs(lam, Rational(1, 10)).n(3), largest_sum().subs(lam, 0)
    (-0.916, zoo)
    """
    return log(4 * lam)


def smaller_exponent(contraction: Expr = lam) -> Expr:
    """What the upper limit of the rate in `E` is at most, on every orbit off the cusp, for `0 < lam < 1`.

    >>> smaller_exponent(Rational(1, 10)).n(3), smaller_exponent(Rational(9, 10)).n(3)
    (-1.61, -0.000772)
    """
    return Min(-least_exponent().subs(lam, contraction), log(2 * S(contraction)))


@cache
def two_rates() -> Finding:
    """Growth, areas, the curve of the cusp and what shrinks, on the grounds of `defocusing` and `splitting`."""
    steps = {
        "what a bounce makes of lengths and areas": growth_defects(),
        "2*t >= 3*D0, so areas grow by 2*lam*r at most": [arc_defect()],
        "a curve along the cone meets the curve of the cusp once": cusp_defects(),
        "directions that no bounce takes into the cone": [*shrinking_defects(), backward_defect()],
    }
    return conjunction(splits(), all_vanish(steps))
