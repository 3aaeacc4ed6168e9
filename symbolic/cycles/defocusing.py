"""Every orbit of the cardioid stretches exponentially, at every contraction below 1: a proof. Paper: section 4.1.

A tangent vector is an infinitesimal beam of width `q = cos(phi)*ds`, in which the direction changes by
`omega = K*ds + dphi`; its curvature is `u = omega/q`. A flight takes `u` to `u' = u/(1 + t*u)`, and a reflection at a
focusing wall takes `u'` to

    u1 = (cos(eta1)/cos(phi1))*(lam*u' - (1 + lam)/d1),    d1 = cos(eta1)/|K1|.

*The cone.* Beams that leave with a focus at a distance of at most `D0 = cos(phi0)/|K0|`, more precisely with
`-(1 + lam)/D0 <= u <= -1/D0`, arrive with `0 < u' <= 1/d1` when `t >= D0 + d1`, and so leave in the same cone:
`cos(eta1)/(cos(phi1)*d1) = 1/D1`. Their width in units of `D`, which is `|K|*|ds|`, grows at each bounce at least by
the factor `(t - D0)/d1 >= 1`, the gain. This is the defocusing of [Bunimovich1979] and [Wojtkowski1986]; it does not
need the elastic law, since `t >= D0 + d1` is a property of the chord alone.

*The cardioid.* With `c = cos(theta/2) > 0` at either end, `2*delta = theta1 - theta0` and `C = cos(delta)`,

    t*(t - D0 - d1) = (4/3)*sin(delta)**2*(c0**2 + c1**2 - 2*c0*c1*C) = (4/3)*sin(delta)**4 >= 0.

The gain is at least `1 + tan(delta/2)**2/2` for `C >= 0` and `3/2` for `C < 0`. With `w = 1 + exp(i*theta)` the
boundary is `w**2/2`, and a chord is `sin(delta)*exp(i*delta)*(w0 + w1)/w0` times the velocity where it leaves. As
`w1/w0` is `(c1/c0)*exp(i*delta)`, the chord makes an angle between `|delta|` and `2*|delta|` with the tangent in the
direction of motion. An exit within `lam*pi/2` of the normal makes an angle of at least `(1 - lam)*pi/2` with the
tangent, so `|delta| >= (1 - lam)*pi/4` on every flight but the first. And `C > -1/2` on every flight:
`cos(phi0) + cos(eta1)` has the sign of `(c0 + c1)*(1 + 2*C)`.

*So*, with `g = 1 + tan((1 - lam)*pi/8)**2/2`, for every `0 <= lam < 1`, every start off the cusp with `|phi| < pi/2`
and every `n >= 2` for which the orbit has not met the cusp, the vector `(ds, dphi) = (1, 0)`, which lies in the cone,
is stretched to

    |D(T**n) (1, 0)| >= |ds_n| >= (1/4)*sin((1 - lam)*pi/4)**4 * g**(n - 2).

The reason is that `|ds_n| >= |K|*|ds|*(t - D0)`, where `|K|*|ds|` is that of the bounce before, which is at least
`3/4*g**(n - 2)`. Moreover `t*(t - D0)` is at least `(4/3)*sin(delta)**4`, and `t <= 4`. So the lower limit of
`log|D(T**n) (1, 0)|/n` is at least `log(g)` on every orbit off the cusp, whether or not it has exponents; the bound
tends to 0 as `lam` tends to 1.

*Away from the cusp*: `max(c0, c1)**2 >= sin(delta)**2/3`, so of any two successive bounces one has a distance from the
cusp above a bound that depends only on `lam < 1`: no orbit converges to the cusp.

*At `lam = 1`* the gain exceeds 1 on every chord, so by Birkhoff's theorem its mean logarithm is positive for almost
every start; `log(c)` and `log(cos(phi))` have finite means (`symbolic.motion.collision`), so by Oseledets' theorem the
exponents exist for almost every start, and `nu_plus = -nu_minus > 0`. No bound for all starts follows.

*Near the cusp again and again.* For `lam < 1` let a curve have all its tangents in the cone. It is monotone in `s`, so
its length in `|K|*ds` is at most `3*pi`, that of the whole boundary. As long as no point of the curve meets the cusp,
this length grows by the factor `g` at each bounce but the first. So after finitely many bounces some point meets the
cusp, and its neighbours on one side land arbitrarily near the cusp. Every open set contains horizontal segments, which
are such curves, and the image of the neighbours on this side is such a curve again. So the starts that come as near the
cusp as wanted, as late as wanted, are open and dense among those whose orbit misses the cusp; their intersection is
dense (Baire), and no compact set off the cusp attracts an open set of starts.

From `cusp` it follows that almost every start does so, and not only a dense set; also that there are finitely many
natural measures, and that almost every start has exponents. For `0 < lam < 1` it is not shown that there is only one
natural measure.
"""

from functools import cache

from sympy import (
    Expr,
    Interval,
    Matrix,
    Rational,
    S,
    Symbol,
    cos,
    expand_trig,
    log,
    oo,
    pi,
    sin,
    sqrt,
    symbols,
    tan,
)

from symbolic.expressions.signs import SignFinding, all_vanish, conjunction, defect, nonnegative, positive
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import cardioid
from symbolic.tables.geometry import curvature, velocity
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t, theta

half, delta = symbols("half delta", real=True)  # theta0/2, and half the way from theta0 to theta1
C = Symbol("C", real=True)  # cos(delta)
x = Symbol("x", nonnegative=True)  # c0/c1
cos_phi1 = Symbol("cos_phi1", positive=True)
BOUNDARY = cardioid.components[0]


def beam_defects() -> list[Expr]:
    """Width and curvature of a beam after a bounce, by the derivative matrix, minus the module's formulas; both are 0.

    >>> beam_defects()
    [0, 0]
    """
    q, u = symbols("q u", real=True)
    ds = q / cos_phi0
    ds1, dphi1 = derivative_matrix() * Matrix([ds, u * q - K0 * ds])
    q1, omega1 = cos_phi1 * ds1, K1 * ds1 + dphi1
    arriving, focal = u / (1 + t * u), -cos_eta1 / K1  # K1 < 0: d1 = cos(eta1)/|K1|
    widened = -(cos_phi1 / cos_eta1) * (1 + t * u) * q
    return [
        defect(q1 - widened),
        defect(omega1 / q1 - (cos_eta1 / cos_phi1) * (lam * arriving - (1 + lam) / focal)),
    ]


def cone_defects() -> list[Expr]:
    """Four expressions that are 0, so that the cone is mapped into itself and widths grow by the gain.

    Beams with `u' = 1/d1` and `u' = 0` leave with `u*D1` equal to -1 and `-(1 + lam)`. The beam that grows least is
    `u = -1/D0`, the vector `(ds, dphi) = (1, 0)`: its width in units of `D` grows by the factor `(t - D0)/d1`, and `ds`
    becomes `|K0|*(t - D0)/cos(eta1)`.

    >>> cone_defects()
    [0, 0, 0, 0]
    """
    D0, D1, d1 = symbols("D0 D1 d1", positive=True)
    ratio = d1 / D1  # cos(eta1)/cos(phi1), as both are a distance over the same radius
    leaving = [ratio * (lam * arriving - (1 + lam) / d1) * D1 for arriving in (1 / d1, S.Zero)]
    width = (t / D0 - 1) / ratio * D0 / D1  # |q1/q0| in units of D, from |1 + t*u| and cos(phi1)/cos(eta1)
    stretched = derivative_matrix()[0, 0] + K0 * (t + cos_phi0 / K0) / cos_eta1  # K0 < 0: D0 = -cos(phi0)/K0
    edges = [leaving[0] + 1, leaving[1] + 1 + lam, width - (t - D0) / d1, stretched]
    return [defect(edge) for edge in edges]


def ends() -> tuple[Expr, Expr]:
    """`c0` and `c1` on a chord of the cardioid from `theta0 = 2*half` to `theta0 + 2*delta`."""
    return cos(half), cos(half + delta)


def chord_defects() -> list[Expr]:
    """`t**2`, `t*cos(phi0)` and `t*cos(eta1)` of a chord, minus closed forms in `c0, c1, delta`; all are 0.

    >>> bool(all_vanish({"": chord_defects()}))
    True
    """
    c0, c1 = ends()
    start, end = (Matrix(BOUNDARY.point).subs(theta, 2 * angle) for angle in (half, half + delta))
    chord = end - start
    inward = [Matrix([-cos(3 * angle), -sin(3 * angle)]) for angle in (half, half + delta)]  # left of the tangent
    found = [chord.dot(chord), chord.dot(inward[0]), -chord.dot(inward[1])]
    C, S2 = cos(delta), sin(delta) ** 2
    closed = [
        4 * S2 * (c0**2 + c1**2 + 2 * c0 * c1 * C),
        2 * S2 * (c0 + 2 * c1 * C),
        2 * S2 * (c1 + 2 * c0 * C),
    ]
    return [expand_trig(left - right) for left, right in zip(found, closed, strict=True)]


def direction_defects() -> list[Expr]:
    """Six expressions that are 0, so that a chord makes an angle between `delta` and `2*delta` with the tangent.

    In the frame of tangent and normal it is `2*sin(delta)*(c0*(cos, sin)(delta) + c1*(cos, sin)(2*delta))`; so its
    cross products with these two directions are `2*sin(delta)**2` times `c1` and `c0`, both positive.

    >>> bool(all_vanish({"": direction_defects()}))
    True
    """
    c0, c1 = ends()
    start, end = (Matrix(BOUNDARY.point).subs(theta, 2 * angle) for angle in (half, half + delta))
    tangent = Matrix([-sin(3 * half), cos(3 * half)])
    velocity0 = velocity(BOUNDARY).subs(theta, 2 * half)
    chord = end - start
    frame = Matrix([chord.dot(tangent), chord.dot(Matrix([-tangent[1], tangent[0]]))])
    once, twice = (Matrix([cos(k * delta), sin(k * delta)]) for k in (1, 2))
    found = [
        *(velocity0 - 2 * c0 * tangent),
        *(frame - 2 * sin(delta) * (c0 * once + c1 * twice)),
        once[0] * frame[1] - once[1] * frame[0] - 2 * sin(delta) ** 2 * c1,
        frame[0] * twice[1] - frame[1] * twice[0] - 2 * sin(delta) ** 2 * c0,
    ]
    return [expand_trig(defect) for defect in found]


def apart_defects() -> list[Expr]:
    """Three expressions that are 0, so that the two ends of a chord are not both near the cusp.

    In order: `sin(delta)**2` in `c0`, `c1` and `C`; the sum of `t*cos(phi0)` and `t*cos(eta1)` over `2*sin(delta)**2`,
    a product with `1 + 2*C`, so that `C > -1/2`; and `3*c1**2 - sin(delta)**2`, not negative for `c1 >= c0`.

    >>> bool(all_vanish({"": apart_defects()}))
    True
    """
    (c0, c1), C = ends(), cos(delta)
    squared = c0**2 + c1**2 - 2 * c0 * c1 * C
    return [
        expand_trig(squared - sin(delta) ** 2),
        expand_trig(c0 + 2 * c1 * C + c1 + 2 * c0 * C - (c0 + c1) * (1 + 2 * C)),
        expand_trig(3 * c1**2 - squared - (c1 - c0) * (2 * c1 + c0) - c0 * c1 * (1 + 2 * C)),
    ]


def radius_defect() -> Expr:
    """An expression that is 0, so that the radius of curvature is `4*c/3`.

    >>> radius_defect()
    0
    """
    return defect(curvature(BOUNDARY).subs(theta, 2 * half) ** 2 * (4 * cos(half) / 3) ** 2 - 1)


def turning_defect() -> Expr:
    """An expression that is 0, so that `|K|*ds` is `3/2*d(theta)` and the whole boundary measures `3*pi`.

    >>> turning_defect()
    0
    """
    speed = velocity(BOUNDARY)
    return defect(curvature(BOUNDARY) ** 2 * speed.dot(speed) - Rational(9, 4))


def excess() -> Expr:
    """`t*(t - D0 - d1)/sin(delta)**2` on a chord, in `x = c0/c1` and `C`, for `c1 = 1`; see the module for the symbols.

    >>> excess().factor()
    4*(-2*C*x + x**2 + 1)/3
    """
    squared, leaving, landing = 4 * (x**2 + 1 + 2 * x * C), 2 * (x + 2 * C), 2 * (1 + 2 * x * C)
    return (squared - Rational(4, 3) * (x * leaving + landing)).expand()


def gain() -> Expr:
    """The gain `(t - D0)/d1`, the least factor by which a beam's width grows at a bounce.

    >>> gain().subs({x: 1, C: 0})
    2
    """
    return 1 + excess() / (Rational(8, 3) * (1 + 2 * x * C))


def square_parts() -> list[tuple[Interval, tuple[Expr, ...]]]:
    """The excess, and the gain minus two bounds, as sums: for each, a range of `C` and terms that are nonnegative
    there.

    They are the excess, the gain minus `1 + tan(delta/2)**2/2`, and the gain minus `3/2`. The last two are multiplied
    by `1 + 2*x*C`, which has the sign of `cos(eta1)`, and by positive constants and powers of `1 + C`.
    """
    return [
        (Interval(-1, 1), ((x - 1) ** 2, 2 * x * (1 - C))),
        (Interval(0, 1), (((1 + C) * x - 2 * C) ** 2, 2 * C * (1 - C))),
        (Interval(-1, 0), (x**2, 4 * x * (-C))),
    ]


def square_defects() -> list[Expr]:
    """The excess, and the gain minus its bounds, minus the sums of `square_parts`; all are 0.

    >>> square_defects()
    [0, 0, 0]
    """
    landing, half_tangent = 1 + 2 * x * C, (1 - C) / (1 + C)
    found = [
        excess() * 3 / 4,
        (gain() - 1 - half_tangent / 2) * 2 * landing * (1 + C) ** 2,
        (gain() - Rational(3, 2)) * 2 * landing,
    ]
    return [defect(left - sum(parts)) for left, (_, parts) in zip(found, square_parts(), strict=True)]


def signs() -> SignFinding:
    """Are the inequalities of the proof true?

    They say that no term of the sums of `square_parts` is negative, and that the bound `g` of the module is below 3/2,
    since `(1 - lam)*pi/8 <= pi/8` and `tan(pi/8) < 1`.

    >>> signs().outcome.name
    'PROVED'
    """
    ranges = [nonnegative(part, {x: Interval(0, oo), C: box}) for box, parts in square_parts() for part in parts]
    return conjunction(*ranges, positive(1 - tan(pi / 8) ** 2, {}))


@cache
def expands() -> SignFinding:
    """Is it proved that every beam of the cone stays in the cone and widens by the gain, which has a bound above 1?"""
    steps = {
        "a beam's width and curvature after a bounce": beam_defects(),
        "the cone goes into itself": cone_defects(),
        "the chord and the curvature of a cardioid": [*chord_defects(), radius_defect(), turning_defect()],
        "a chord makes an angle between delta and 2*delta with the tangent": direction_defects(),
        "one of two successive bounces is away from the cusp": apart_defects(),
        "t - D0 - d1 and the gain as sums of squares": square_defects(),
    }
    found = all_vanish(steps)
    return found and signs() and found


def away() -> Expr:
    """A lower bound of `max(c0, c1)` on every flight but the first: one end of the flight is away from the cusp.

    >>> away().subs(lam, 0)
    sqrt(6)/6
    """
    return sin((1 - lam) * pi / 4) / sqrt(3)


def least_stretch(bounces: int) -> Expr:
    """A lower bound of `|D(T**n) (1, 0)|` after `n >= 2` bounces, on every orbit of the cardioid off its cusp.

    >>> least_stretch(2).subs(lam, 0), least_stretch(2).subs(lam, 1)
    (1/16, 0)
    """
    if bounces < 2:
        raise ValueError(f"least_stretch: bounces = {bounces}; the bound holds from 2 bounces on")
    return sin((1 - lam) * pi / 4) ** 4 / 4 * (1 + tan((1 - lam) * pi / 8) ** 2 / 2) ** (bounces - 2)


def least_exponent() -> Expr:
    """A lower bound of the lower limit of `log|D(T**n) (1, 0)|/n`, on every orbit of the cardioid off its cusp.

    >>> least_exponent().subs(lam, 0).n(4), least_exponent().subs(lam, 1)
    (0.08230, 0)
    """
    return log(1 + tan((1 - lam) * pi / 8) ** 2 / 2)
