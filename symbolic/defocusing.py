"""Every orbit of the cardioid has a positive exponent, at every contraction: a proof. Paper: section 4.1, conjecture.

A tangent vector is a beam: `q = cos(phi)*ds` wide, turning by `omega = K*ds + dphi` across, with curvature
`u = omega/q`. A flight takes `u` to `u/(1 + t*u)`, a reflection at a focusing wall takes that to

    u1 = (cos(eta1)/cos(phi1))*(lam*u' - (1 + lam)/d1),    d1 = cos(eta1)/|K1|.

*The cone.* Beams that leave with a focus not beyond `D0 = cos(phi0)/|K0|`, that is `-(1 + lam)/D0 <= u <= -1/D0`,
arrive with `0 < u' <= 1/d1` when `t >= D0 + d1`, and so leave in the same cone: `cos(eta1)/(cos(phi1)*d1) = 1/D1`.
Their width in units of `D` grows at each bounce by the gain `(t - D0)/d1 >= 1` at least. This is the defocusing of
[Bunimovich1979] and [Wojtkowski1986]; it needs no elastic law, since `t >= D0 + d1` speaks of a chord alone.

*The cardioid.* With `c = cos(theta/2)` at either end, `2*delta = theta1 - theta0` and `C = cos(delta)`,

    t*(t - D0 - d1) = (4/3)*sin(delta)**2*(c0**2 + c1**2 - 2*c0*c1*C) >= 0.

The gain is at least `1 + tan(delta/2)**2/2` for `C >= 0` and `3/2` for `C < 0`. The chord makes an angle of at most
`2*delta` with the tangent, and at least `(1 - lam)*pi/2` from the first bounce on, so `delta >= (1 - lam)*pi/4`.

*So* `nu_plus >= log(1 + tan((1 - lam)*pi/8)**2/2) > 0` on every orbit that has exponents and misses the cusp, for every
`lam < 1`. The width is measured in units of `D`, which is small only near the cusp, and a ball near the cusp is
away from it one bounce later. The vector `(ds, dphi) = (1, 0)` lies in the cone, so one need not be found.

*And* no compact set off the cusp attracts an open set of starts, for any `lam < 1`. A curve along the cone runs
monotonically in `s`, so its length in the measure `|K|*ds = |q|/D` is at most `3*pi`, the whole boundary's. That length
grows by the gain at each bounce at which no point of the curve hits the cusp; so some point of it does, soon, and
its neighbours on one side land arbitrarily near the cusp. Curves along the cone lie in every open set, and what is
left of one after any number of bounces is curves again: the starts that come as near as wanted, as late as wanted,
are dense.
"""

from functools import cache

from sympy import Expr, Matrix, Rational, S, Symbol, cos, expand_trig, log, pi, simplify, sin, symbols, tan

from symbolic.collision import derivative_matrix
from symbolic.geometry import curvature, velocity
from symbolic.signs import Finding, Outcome
from symbolic.symbols import K0, K1, cos_eta1, cos_phi0, lam, t, theta
from symbolic.tables import cardioid
from symbolic.zero import vanishes

half, delta = symbols("half delta", real=True)  # theta0/2, and half the way from theta0 to theta1
C = Symbol("C", real=True)  # cos(delta)
x = Symbol("x", nonnegative=True)  # c0/c1
cos_phi1 = Symbol("cos_phi1", positive=True)
BOUNDARY = cardioid.components[0]


def beam_defects() -> list[Expr]:
    """Width and curvature of a beam after a bounce, by the derivative matrix, minus what is said above: zeros.

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
        simplify(q1 - widened),
        simplify(omega1 / q1 - (cos_eta1 / cos_phi1) * (lam * arriving - (1 + lam) / focal)),
    ]


def cone_defects() -> list[Expr]:
    """With `u' = 1/d1` and `u' = 0` a beam leaves with `u*D1` equal to -1 and `-(1 + lam)`: zeros.

    The gain in width over `D` of the slowest beam, `u = -1/D0`, is `(t - D0)/d1`: zero.

    >>> cone_defects()
    [0, 0, 0]
    """
    D0, D1, d1 = symbols("D0 D1 d1", positive=True)
    ratio = d1 / D1  # cos(eta1)/cos(phi1), as both are a distance over the same radius
    leaving = [ratio * (lam * arriving - (1 + lam) / d1) * D1 for arriving in (1 / d1, S.Zero)]
    width = (t / D0 - 1) / ratio * D0 / D1  # |q1/q0| in units of D, from |1 + t*u| and cos(phi1)/cos(eta1)
    return [simplify(leaving[0] + 1), simplify(leaving[1] + 1 + lam), simplify(width - (t - D0) / d1)]


def ends() -> tuple[Expr, Expr]:
    """`c0` and `c1` on a chord of the cardioid from `theta0 = 2*half` to `theta0 + 2*delta`."""
    return cos(half), cos(half + delta)


def chord_defects() -> list[Expr]:
    """`t**2`, `t*cos(phi0)` and `t*cos(eta1)` of a chord, minus closed forms in `c0, c1, delta`: zeros.

    >>> all(vanishes(defect) for defect in chord_defects())
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


def radius_defect() -> Expr:
    """The radius of curvature is `4*c/3`: zero.

    >>> radius_defect()
    0
    """
    return simplify(curvature(BOUNDARY).subs(theta, 2 * half) ** 2 * (4 * cos(half) / 3) ** 2 - 1)


def turning_defect() -> Expr:
    """`|K|*ds` is `3/2*d(theta)`, so the whole boundary measures `3*pi`: zero.

    >>> turning_defect()
    0
    """
    speed = velocity(BOUNDARY)
    return simplify(curvature(BOUNDARY) ** 2 * speed.dot(speed) - Rational(9, 4))


def excess() -> Expr:
    """`t*(t - D0 - d1)/sin(delta)**2` in `x = c0/c1` and `C`, for `c1 = 1`.

    >>> excess().factor()
    4*(-2*C*x + x**2 + 1)/3
    """
    squared, leaving, landing = 4 * (x**2 + 1 + 2 * x * C), 2 * (x + 2 * C), 2 * (1 + 2 * x * C)
    return (squared - Rational(4, 3) * (x * leaving + landing)).expand()


def gain() -> Expr:
    """`(t - D0)/d1`, by which a beam's width grows at a bounce at least.

    >>> gain().subs({x: 1, C: 0})
    2
    """
    return 1 + excess() / (Rational(8, 3) * (1 + 2 * x * C))


def square_defects() -> list[Expr]:
    """The excess and what the gain has beyond its bounds, minus forms that are plainly not negative: zeros.

    In turn `-1 <= C <= 1`; `0 <= C <= 1`, beyond `1 + tan(delta/2)**2/2`; `-1 < C < 0`, beyond `3/2`. The two last are
    multiplied by `1 + 2*x*C`, which has the sign of `cos(eta1)`: positive.

    >>> square_defects()
    [0, 0, 0]
    """
    landing, half_tangent = 1 + 2 * x * C, (1 - C) / (1 + C)
    found = [
        excess() * 3 / 4,
        (gain() - 1 - half_tangent / 2) * 2 * landing * (1 + C) ** 2,
        (gain() - Rational(3, 2)) * 2 * landing,
    ]
    plain = [
        (x - 1) ** 2 + 2 * x * (1 - C),
        ((1 + C) * x - 2 * C) ** 2 + 2 * C * (1 - C),
        x**2 + 4 * x * (-C),
    ]
    return [simplify(left - right) for left, right in zip(found, plain, strict=True)]


@cache
def expands() -> Finding:
    """Every beam of the cone stays in it, and widens by the gain: each step of the proof is an identity."""
    steps = {
        "a beam's width and curvature after a bounce": beam_defects(),
        "the cone goes into itself": cone_defects(),
        "the chord and the curvature of a cardioid": [*chord_defects(), radius_defect(), turning_defect()],
        "t - D0 - d1 and the gain as sums of squares": square_defects(),
    }
    failed = [name for name, defects in steps.items() if not all(vanishes(defect) for defect in defects)]
    if failed:
        return Finding(Outcome.UNKNOWN, f"not reduced to 0: {', '.join(failed)}")
    return Finding(Outcome.PROVED, "; ".join(steps))


def least_exponent() -> Expr:
    """What `nu_plus` is at least, on every orbit of the cardioid off its cusp that has one.

    >>> least_exponent().subs(lam, 0).n(4), least_exponent().subs(lam, 1)
    (0.08230, 0)
    """
    return log(1 + tan((1 - lam) * pi / 8) ** 2 / 2)
