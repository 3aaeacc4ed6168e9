"""A dominated splitting for the cardioid and the cuspless cardioid, at every contraction below 1.

Paper: sections 4.1 and 5, where it is only suggested by Lyapunov exponents. A beam that leaves the arc with curvature
`u` (see `defocusing`) has `y = -u*D`, `D = cos(phi)/|K|`; the cone is `1 <= y <= 1 + lam`. It arrives at the next
bounce on the arc with curvature `1/(f + t1)`, and leaves with

    y1 = 1 + lam - lam*d1/(f + t1),    d1 = cos(eta1)/|K1|,

where `f = -D0/y` and `t1 = t` for a chord from arc to arc, and `f = (cos(phi)/(lam*cos(eta)))*(t - D0/y)` when the
particle has bounced off the wall in between (by a chord `t` to the wall, a landing at `eta`, an exit at `phi`, and a
chord `t1` to the arc).

*Chords of the arc.* `t - D0 >= gain*d1`, with a gain above 1 (`defocusing`), and `2*t >= 3*D0`, since

    t*(2*t - 3*D0) = 8*sin(delta)**2*c1**2.

*Chords between arc and wall.* Let `tau` be three halves of the polar angle, `c = cos(tau/3)`, and `eta` the angle at
the wall. Then

    (t - D)*cos(eta) = (2*c - 1)**2*(4*c**2 + 4*c + 3)/12 + (2*c/3)*(1 - cos(tau + 2*eta)) >= 0:

the circle of diameter `1/|K|` that touches the arc from inside does not cross the wall. The angle of a particle at the
arc is `tau + eta`, less than `pi/2`; one of the two angles is an exit angle, at most `lam*pi/2`, so
`tau < (1 + lam)*pi/2` and `t - D >= clearance(lam) > 0` for `lam < 1`.

*So* `1 < y1 < 1 + lam`, strictly and uniformly: in the projective (Hilbert) metric of the cone the image has a diameter
of at most `diameters(lam)`. Hence every return to the arc, which takes at most two bounces, contracts this metric by
`tanh(diameter/4) < 1` (Birkhoff). Directions of the cone pushed forward along a backward orbit converge to `F`,
directions outside it pulled back along a forward orbit to `E`, and the ratio `|DT^n e|/|DT^n f|` for vectors `e` of `E`
and `f` of `F` falls at the same rate: this is the dominated splitting. The angle between the two is bounded below: a
direction that is outside the cone at the next arc has `0 < y < 1/gain` or, before the wall, `0 < y < D/t`, and `F` has
`y > 1`, all bounded away from 1. On the cuspless cardioid curvature is bounded, and the constants `C` and `nu` of the
splitting are the same for all orbits. On the cardioid this holds if vectors are measured by `|K|*ds` and `dphi`, and so
on every compact set off the cusp. At `lam = 0` the cone is the horizontal direction `F`, `E` is the kernel, and `F` is
not in it because `t > D0`.

*Widths.* By way of the wall the width of a beam of the cone, in units of `D`, grows at least by

    1 + ((cos(phi)/cos(eta))**2*Q0 + Q1 - (1 - lam)*X1)/(cos(phi)*d1),    Q = (t - D)*cos(eta) at either end,

where `X1 = t1*cos(phi)` is the distance from the wall at which the particle lands. `Q1 >= 11/27*X1`, since the first
term of `Q` is `X/3 + 2*X/(3*(2*c + 1)**2)` and `c <= 1`; and `t1 >= d1`. So the width grows at least by the factor
`lam + 11/27`. For `lam > 16/27` every orbit of the cuspless cardioid stretches at a rate of at least `least_rate()` for
each bounce, and no cycle attracts.

Left out are orbits through a join, where the derivative does not exist, and the elastic case: at `lam = 1` near-grazing
orbits follow the parabolic matrix of `grazing`, whose powers grow like `n`, so that no `C*nu^n` bounds anything.
"""

from functools import cache

from sympy import (
    Expr,
    Matrix,
    Min,
    Rational,
    S,
    Symbol,
    cos,
    log,
    pi,
    simplify,
    sin,
    sqrt,
    symbols,
    tan,
    tanh,
)

from symbolic.cycles.defocusing import BOUNDARY, expands, half
from symbolic.expressions.signs import SignFinding, all_vanish, conjunction, defect
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import cuspless
from symbolic.tables.geometry import curvature
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t, theta

c = Symbol("c", real=True)  # cos(theta/2) on the arc
angle = Symbol("eta", real=True)  # at the wall
DIAMETER = 4  # no chord is longer: t**2 <= 4*(c0 + c1)**2
WALL_X = cuspless.components[1].point[0]


def arc_defect() -> Expr:
    """`t*(2*t - 3*D0) - 8*sin(delta)**2*c1**2` from the closed forms of `t**2` and `t*cos(phi0)`; it is 0.

    >>> arc_defect()
    0
    """
    c0, c1, C, S = symbols("c0 c1 C S", real=True)
    squared, leaving = 4 * S**2 * (c0**2 + c1**2 + 2 * c0 * c1 * C), 2 * S**2 * (c0 + 2 * c1 * C)
    return (2 * squared - 3 * (4 * c0 / 3) * leaving - 8 * S**2 * c1**2).expand()


def wall_defect() -> Expr:
    """`(t - D)*cos(eta)` on a chord between arc and wall, minus its form as a sum of nonnegative terms; it is 0.

    >>> bool(all_vanish({"": [wall_defect()]}))
    True
    """
    point = Matrix(BOUNDARY.point).subs(theta, 2 * half)
    towards = Matrix([-cos(angle), sin(angle)])  # from the arc; on the wall x = -1/4 the normal is horizontal
    inward = Matrix([-cos(3 * half), -sin(3 * half)])
    length, distance = (point[0] - WALL_X) / cos(angle), 4 * cos(half) / 3 * inward.dot(towards)
    closed = clear().subs(c, cos(half)) + 2 * cos(half) / 3 * (1 - cos(3 * half + 2 * angle))
    return defect((length - distance) * cos(angle) - closed)


def angle_defect() -> Expr:
    """The cosine of a chord's angle to the normal at the arc, minus that of `tau + eta`; it is 0.

    >>> angle_defect()
    0
    """
    inward, towards = Matrix([-cos(3 * half), -sin(3 * half)]), Matrix([-cos(angle), sin(angle)])
    return defect(inward.dot(towards) - cos(3 * half + angle))


def clear() -> Expr:
    """The distance from the wall of the circle of diameter `1/|K|` that touches the arc at `c`.

    >>> clear().expand()
    4*c**4/3 - 2*c/3 + 1/4
    """
    return (2 * c - 1) ** 2 * (4 * c**2 + 4 * c + 3) / 12


def clear_defects() -> list[Expr]:
    """The slope of `clear` minus a product that is positive for `c > 1/2`; and `clear` at the join, `c = 1/2`. Both are
    0.

    >>> clear_defects()
    [0, 0]
    """
    slope = Rational(2, 3) * (2 * c - 1) * (4 * c**2 + 2 * c + 1)
    return [(clear().diff(c) - slope).expand(), clear().subs(c, Rational(1, 2))]


def radius_defects() -> list[Expr]:
    """Two expressions that are 0, so that on the arc `rho^2 = (16 - s^2)/9` and `d^2 rho/d s^2 < 0`. [Wojtkowski1986]

    >>> radius_defects()
    [0, 0]
    """
    s = Symbol("s", real=True)
    radius = sqrt(16 - s**2) / 3
    squared = radius**2 - (1 / curvature(BOUNDARY) ** 2).subs(theta, 2 * half)
    return [defect(squared.subs(s, 4 * sin(half))), defect(radius.diff(s, 2) + Rational(16, 27) / radius**3 / 3)]


def clearance(contraction: Expr = lam) -> Expr:
    """A lower bound of `t - D` on a chord `t` between arc and wall (module docstring), for exits within `lam*pi/2`.

    >>> clearance(0), clearance(1)
    (1 - sqrt(3)/3, 0)
    """
    return clear().subs(c, cos((1 + contraction) * pi / 6)).expand()


def passage_defects() -> list[Expr]:
    """`y1` from the derivative matrices minus its formula, for a chord of the arc and for one by the wall; both are 0.

    >>> passage_defects()
    [0, 0]
    """
    y, D0, t1, cos_phi1, cos_eta2, cos_phi2, K2 = symbols("y D0 t1 cos_phi1 cos_eta2 cos_phi2 K2", nonzero=True)
    vector = Matrix([1, -y * cos_phi0 / D0 - K0])  # ds = 1, dphi = u*cos(phi)*ds - K*ds
    first = derivative_matrix()

    def leaving(out: Matrix, bend: Expr, exit: Expr) -> Expr:
        return -(bend * out[0] + out[1]) / (exit * out[0]) * exit / -bend

    straight = leaving(first * vector, K1, cos_phi1)
    second = first.subs({t: t1, cos_phi0: cos_phi1, cos_eta1: cos_eta2, K0: 0, K1: K2}, simultaneous=True)
    bent = leaving(second * first.subs(K1, 0) * vector, K2, cos_phi2)
    beyond = cos_phi1 / (lam * cos_eta1) * (t - D0 / y)
    return [
        defect(straight - (1 + lam - lam * (-cos_eta1 / K1) / (t - D0 / y))),
        defect(bent - (1 + lam - lam * (-cos_eta2 / K2) / (beyond + t1))),
    ]


def width_defects() -> list[Expr]:
    """Growth of width by way of the wall minus its formula, from the derivative matrices, at any `y` and at 1; both are
    0.

    >>> width_defects()
    [0, 0]
    """
    y, D0, t1, cos_phi1, cos_eta2, K2, Q0, Q1 = symbols("y D0 t1 cos_phi1 cos_eta2 K2 Q0 Q1", nonzero=True)
    first = derivative_matrix()
    second = first.subs({t: t1, cos_phi0: cos_phi1, cos_eta1: cos_eta2, K0: 0, K1: K2}, simultaneous=True)
    out = (second * first.subs(K1, 0) * Matrix([1, -y * cos_phi0 / D0 - K0]))[0]
    d, width = -cos_eta2 / K2, out * K2 / (cos_phi0 / D0)  # q/D = ds*|K|, and D0 = cos(phi0)/|K0|
    grown = y * (cos_phi1 / cos_eta1 * (t - D0 / y) + lam * t1) / d
    sides = {t: D0 + Q0 / cos_eta1, t1: d + Q1 / cos_phi1}
    closed = 1 + ((cos_phi1 / cos_eta1) ** 2 * Q0 + Q1 - (1 - lam) * t1 * cos_phi1) / (cos_phi1 * d)
    return [defect(width - grown), defect((grown.subs(y, 1) - closed).subs(sides))]


def share_defects() -> list[Expr]:
    """Two distances from the wall minus their formulas in `c`; both are 0.

    The first distance is that of a point of the arc, `X = x + 1/4`; the second is that of its circle, `clear`.

    >>> share_defects()
    [0, 0]
    """
    X = BOUNDARY.point[0].subs(theta, 2 * half) - WALL_X
    share = Rational(1, 3) + 2 / (3 * (2 * c + 1) ** 2)
    across = (2 * c - 1) ** 2 * (2 * c + 1) ** 2 / 4
    return [
        defect(X - across.subs(c, cos(half))),
        defect(clear() - share * across) + share.subs(c, 1) - Rational(11, 27),
    ]


def smaller(left: Expr, right: Expr) -> Expr:
    """The smaller of two numbers; for formulas in `lam` an unevaluated `Min`."""
    if left.free_symbols | right.free_symbols:
        return Min(left, right, evaluate=False)
    return left if left.n(20) < right.n(20) else right


def least_rate(contraction: Expr = lam) -> Expr:
    """A lower bound of the rate per bounce at which every orbit of the cuspless cardioid stretches, for `lam > 16/27`.

    >>> least_rate(Rational(4, 5)).n(3)
    0.00155
    """
    arc = 1 + tan((1 - S(contraction)) * pi / 8) ** 2 / 2
    wall = S(contraction) + Rational(11, 27)
    return log(smaller(arc, wall)) / 2


def spread_defect() -> Expr:
    """The exponential of the projective diameter of the cone's image, minus its formula as a product; it is 0.

    >>> spread_defect()
    0
    """
    far, near, d = symbols("far near d", positive=True)  # f + t at y = 1 + lam and at y = 1
    low, high = (1 + lam - lam * d / length for length in (near, far))
    ratio = (1 + lam - low) / (1 + lam - high) * (high - 1) / (low - 1)
    return defect(ratio - far / near * (1 - d / far) / (1 - d / near))


def diameters(contraction: Expr = lam) -> tuple[Expr, Expr]:
    """Bounds for the projective diameter of the cone's image: along a chord of the arc, and by way of the wall.

    Let `near` and `far` be the module's `f + t1` at `y = 1` and at `y = 1 + lam`, and `d = d1`. The exponential of the
    diameter is the product of `far/near` and `(1 - d/far)/(1 - d/near)` (see `spread_defect`). `far/near` is at most
    `1 + 2*lam/(1 + lam)` for the arc, since `t - D0 >= D0/2`, and at most `1 + 4*lam/(3*(1 + lam)*clearance)` by the
    wall, since `D0 <= 4/3`. Moreover `1 - d/far` is at most 1, `d/near` is at most `1/gain` for the arc, and
    `1 - d/near >= clearance/DIAMETER` by the wall.

    >>> [bound.n(3) for bound in diameters(Rational(1, 2))]
    [4.45, 5.18]
    """
    share = S(contraction) / (1 + S(contraction))
    gain = 1 + tan((1 - S(contraction)) * pi / 8) ** 2 / 2
    free = clearance(contraction)
    return log(1 + 2 * share) + log(gain / (gain - 1)), log(1 + share * Rational(4, 3) / free) + log(DIAMETER / free)


def rate(contraction: Expr = lam, wall: bool = True) -> Expr:
    """A bound of the factor by which a return to the arc shrinks the cone: `tanh` of a quarter of the larger diameter.

    >>> rate(Rational(1, 2)).n(3), rate(Rational(1, 2), wall=False).n(3)
    (0.860, 0.805)
    """
    along, bounced = diameters(contraction)
    return tanh((-smaller(-along, -bounced) if wall else along) / 4)


def grazing() -> Matrix:
    """The limit of the elastic derivative along the arc as the exit angle goes to `pi/2`: `t = 2*cos(phi)/|K|`.

    >>> grazing()
    Matrix([
    [1, 2/K0],
    [0,    1]])
    """
    chord = derivative_matrix().subs({lam: 1, K1: K0, t: -2 * cos_phi0 / K0, cos_eta1: cos_phi0})
    return chord.applyfunc(simplify)


@cache
def splits() -> SignFinding:
    """Is it proved that bounces of the cardioid and of the cuspless cardioid map the cone strictly into itself?"""
    steps = {
        "the cone's image on either way": [*passage_defects(), spread_defect()],
        "2*t >= 3*D0 on chords of the arc": [arc_defect()],
        "t >= D on chords to the wall": [wall_defect(), angle_defect(), *clear_defects()],
        "widths by way of the wall": [*width_defects(), *share_defects()],
    }
    return conjunction(expands(), all_vanish(steps))
