"""Every orbit of the cardioid is hyperbolic at every contraction below 1, with bounds that hold for almost every orbit.

Paper: section 4.1. The notation is that of `defocusing` and `splitting`. A flight of length `t` begins at `theta0` at
the angle `phi0`, and ends at `theta1` at the angle `eta1`; at either end `c = cos(theta/2)`. Let `C = cos(delta)` with
`2*delta = theta1 - theta0`, `D0 = cos(phi0)/|K0|` and `d1 = cos(eta1)/|K1|`. The gain `(t - D0)/d1` is at least
`g = 1 + tan((1 - lam)*pi/8)**2/2` on every flight but the first. Lengths along the wall are measured by `|K|*ds`, in
which the whole boundary is `3*pi` long. A beam leaves with curvature `-y/D`, so that `dphi = (1 - y)*|K|*ds`. The cone
is `1 <= y <= 1 + lam`; horizontal lines, on which `phi` is constant, are curves along the cone, with `y = 1`. `P` is
the strip `|phi| <= lam*pi/2`.

*Pieces.* From every point of the wall the cusp is visible, at one exit angle. These angles form a curve `S` in phase
space, a graph over the whole wall. A beam focused at the cusp, at a distance `t`, has `y = D0/t < 1`, since
`t*(t - D0) = (4/3)*(c0*sin(delta))**2 > 0` for a chord that ends there. So `dphi > 0` along `S`, when `ds > 0`, and
`dphi <= 0` on a curve along the cone: such a curve meets `S` at most once. Off `S` the map is smooth, and the image of
such a curve is at most two curves along the cone. So the image of a horizontal line after `n` bounces has at most
`2**n` pieces, each monotone in `s`, at most `3*pi` long. Let `r = (t*y - D0)/d1` be the factor by which a bounce
lengthens the curve at a point. Then

    mean over the line of r_1*r_2*...*r_n  <=  2**n.

By Markov's inequality the product exceeds `exp(n*(log(2) + e))` on at most the share `exp(-n*e)` of the line. These
shares are summable, so by the Borel-Cantelli lemma and Fubini's theorem *for almost every start* the upper limit of
`log(r_1*...*r_n)/n` is at most `log(2)`. As `|K| >= 3/4` and slopes in the cone are bounded, this bounds the growth of
every vector: almost every start has `nu_plus <= log(2)`, as an upper limit.

*Areas.* In `|K|*ds` and `dphi` a bounce multiplies areas by `lam*D0/d1 = lam*r*D0/(t*y - D0)`. As `C > 0` on every
flight (`cusp`), with `x = c0/c1`

    D0/(t*y - D0)  <=  D0/(t - D0) = 2*x*(x + 2*C)/(x**2 + 3 + 2*x*C)  <=  x**(2/3).

The right side telescopes along an orbit. So on every orbit that misses the cusp, in `ds` and `dphi` again, where
`|K| = 3/(4*c)`,

    |det D(T**n)| <= lam**n * r_1*...*r_n * (c_n/c_0)**(1/3),

and for almost every start the upper limit of `log|det D(T**n)|/n` is at most `log(2*lam)`: it tends to minus infinity
with `lam`, and is negative for `lam < 1/2`, where the area of `T**n(P)` is at most `4*pi**2*lam*(2*lam)**n`.

*The other direction.* On an orbit that never meets the cusp only one direction is never taken into the cone
(`splitting`); call it `E`. Let `f` be the distance from its focus to the landing, so that `y = D0/(t - f)`. Then
`0 < f < d1`, since the next `y` is `1 + lam - lam*d1/f` and below 1. So `|K|*ds` of a vector of `E` is multiplied by
`(D0/d1)*f/(t - f)`, less than `D0/(t - d1) <= 1`: the reciprocal of the gain on the chord run backwards, at most `1/g`
on every flight but the first. Its `abs(dphi)` is less, as `0 < y < 1`, while a pushed-forward horizontal vector has
`y >= 1 + lam*(1 - 1/g)` from the second bounce on. So *every* orbit off the cusp is hyperbolic for `0 < lam < 1`, and
uniformly so in `|K|*ds = (3/2)*d(theta)` and `dphi`: one direction is stretched by `g` at each bounce, the other
shrinks by `g`, and they keep apart by an angle that depends on `lam` alone. In `ds` and `dphi` too the lower limit of
the one rate is at least `log(g)`, by `defocusing`, and the upper limit of the other at most `-log(g)`, since
`|K| >= 3/4`. The area spanned by vectors of both directions is the product of their lengths and of the difference of
their `y`. So the bound on areas bounds the second rate by `log(lam)`, first at times at which `c_n` has a positive
lower bound, which include one of any two successive bounces, and then at all times, since the vector shrinks in
between.

*No cycle.* A curve along the cone that is never cut would outgrow the wall; so two points of a horizontal line whose
orbits are on the same side of `S` at every bounce are one point. An orbit that converges to a cycle is from some bounce
on where the cycle is, which is off `S`; there are countably many sequences of sides that end periodically, so countably
many such points on each line. So *almost every orbit converges to no cycle*, and no orbit converges to the cusp
(`defocusing`). The likely limit set [Milnor1985], the smallest closed set that holds the limit points of almost every
orbit, is therefore not a finite union of cycles.

For the existence of the limits and of finitely many natural measures see `docs/exponents.md`. It is not shown that
there is only one natural measure.
"""

from functools import cache

from sympy import Expr, Interval, Matrix, Rational, S, Symbol, limit, log, oo, symbols

from symbolic.cycles.defocusing import C, excess, gain, x
from symbolic.cycles.splitting import splits
from symbolic.expressions.signs import SignFinding, all_vanish, conjunction, defect, nonnegative
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t

y, D0, d1 = symbols("y D0 d1", positive=True)
LENGTHENED = (t * y - D0) / d1
POWER = Rational(2, 3)


def bounce() -> Matrix:
    """The derivative matrix of a bounce in `(|K|*ds, dphi)`, where `cos(phi0) = |K0|*D0` and `cos(eta1) = |K1|*d1`.

    >>> bounce()[0, :]
    Matrix([[(-D0 + t)/d1, -t/d1]])
    """
    matrix = derivative_matrix()
    rows = [[matrix[0, 0] * K1 / K0, -matrix[0, 1] * K1], [-matrix[1, 0] / K0, matrix[1, 1]]]  # |K| is -K
    return Matrix(rows).subs({cos_phi0: -K0 * D0, cos_eta1: -K1 * d1}).applyfunc(lambda entry: entry.cancel())


def growth_defects() -> list[Expr]:
    """Growth of a vector of the cone, and of areas, at a bounce, minus the formulas of this module; both are 0.

    >>> growth_defects()
    [0, 0]
    """
    along = (bounce() * Matrix([1, 1 - y]))[0]
    return [defect(along - LENGTHENED), defect(bounce().det() - lam * LENGTHENED * D0 / (t * y - D0))]


def cusp_defects() -> list[Expr]:
    """The landing width of a beam with `y = D0/t`, and minus 4/3 the excess of a chord that ends at the cusp; both are
    0.

    The excess is `t*(t - D0 - d1)` for `c1 = 0`, hence `d1 = 0`, in units of `(c0*sin(delta))**2`; so `t > D0`.

    >>> cusp_defects()
    [0, 0]
    """
    focused = LENGTHENED.subs(y, D0 / t)
    return [defect(focused), limit(excess() / x**2, x, oo) - Rational(4, 3)]


def shrinking_defects() -> list[Expr]:
    """`1 - y` and `|K|*ds` after a bounce of a vector with `y = D0/(t - f)`, minus the module's formulas; both are 0.

    >>> shrinking_defects()
    [0, 0]
    """
    f = symbols("f", positive=True)
    out = bounce() * Matrix([1, 1 - D0 / (t - f)])
    return [defect(out[1] / out[0] + lam - lam * d1 / f), defect(out[0] - D0 / d1 * f / (t - f))]


def backward_defect() -> Expr:
    """`(t - d1)/D0` minus the gain with the ends of the chord exchanged (`1/x` in the place of `x`); it is 0.

    Units are such that `c1 = 1`; numerator and denominator are divided by `sin(delta)**2/t`.

    >>> backward_defect()
    0
    """
    focal = Rational(8, 3) * x * (x + 2 * C)  # t*D0/sin(delta)**2
    return defect(1 + excess() / focal - gain().subs(x, 1 / x))


def largest_exponent() -> Expr:
    """An upper bound of the upper limit of `log|D(T**n)|/n`, for almost every start."""
    return log(S(2))


def largest_sum() -> Expr:
    """An upper bound of the upper limit of `log|det D(T**n)|/n`, for almost every start.

    >>> largest_sum().subs(lam, Rational(1, 10)).n(3), largest_sum().subs(lam, 0)
    (-1.61, zoo)
    """
    return log(2 * lam)


def area_bound(power: Rational = POWER) -> SignFinding:
    """Is `D0/(t - D0) <= x**power` on every flight, with `x = c0/c1`?

    For `x = z**q`, with the denominator `q` of `power`, this is a polynomial inequality.

    >>> area_bound().outcome.name
    'PROVED'
    """
    z = Symbol("z", nonnegative=True)
    focal = 2 * x * (x + 2 * C)  # t*D0, over (4/3)*(c1*sin(delta))**2
    beyond = Rational(3, 4) * excess() + 2 * (1 + 2 * x * C)  # t*(t - D0), over the same
    room = (x**power * beyond - focal).subs(x, z**power.q).expand()
    return nonnegative(room, {z: Interval(0, oo), C: Interval(0, 1)})


@cache
def two_rates() -> SignFinding:
    """Is everything proved: the identities for lengths, areas, the curve `S` and the direction `E`, and `splitting`?"""
    steps = {
        "what a bounce makes of lengths and areas": growth_defects(),
        "a curve along the cone meets the curve of the cusp once": cusp_defects(),
        "directions that no bounce takes into the cone": [*shrinking_defects(), backward_defect()],
    }
    return conjunction(splits(), all_vanish(steps), area_bound())
