"""The slap map of the cardioid in the half angle: it expands at once, with a rational slope.

In `b = Theta/2` of the landing point and `theta/2` of the launching point the slope of the slap map is

    2*(3 - q)/((1 + q)*(5 - 7*q)),     q = sin(b)/sqrt(1 + 7*cos(b)**2),

at least 1.197 everywhere, though `T0'(s)` itself falls below 1. What follows bounds how the transfer
operator acts on functions of bounded variation: `rate` is one over the slope, the upper half of the
table lands at `-pi/2 < b < pi/4`, and `launch` is where it left. Not in the paper.
"""

from sympy import Expr, Interval, Rational, Symbol, atan, cancel, cos, expand, pi, sin, sqrt, together

from symbolic.codegen import Kernel, kernel
from symbolic.signs import Finding, Outcome, conjunction, nonnegative, positive
from symbolic.slap_cardioid import COS2, LAUNCH_COS2, UPPER, q, slope_squared

b = Symbol("b", real=True)  # half the landing angle, negative on the lower half
RATE = (1 + q) * (5 - 7 * q) / (2 * (3 - q))  # one over the slope
LAUNCH_TAN2 = 2 * (1 + q) ** 3 / ((1 - 3 * q) ** 2 * (1 - q))  # tan(theta/2)**2 where the ball left
SPEED2 = (1 + 7 * q**2) ** 2 * (1 - q**2) / 8  # (dq/db)**2
CUSP = Rational(-69, 100)  # landings below it are near the cusp
SHRINKS = Rational(835, 1000)
STEEP = Rational(31, 10)


def derived() -> Finding:
    """`RATE`, `LAUNCH_TAN2`, `SPEED2` follow from what `symbolic.slap_cardioid` proves.

    Arc length is `s = 4*sin(theta/2)`, so the slope in half angles is `T0'(s)*cos(theta/2)/cos(b)`.

    >>> derived().outcome.name
    'PROVED'
    """
    sin2 = 1 - COS2
    facts = {
        "the slope squared": RATE**2 * slope_squared() * LAUNCH_COS2 / COS2 - 1,
        "the launching point": LAUNCH_TAN2 * LAUNCH_COS2 - (1 - LAUNCH_COS2),
        "q^2 of the half angle": q**2 * (1 + 7 * COS2) - sin2,
        "its speed: d(sin(b)^2)/dq = 2*sin(b)*cos(b)*db/dq": sin2.diff(q) ** 2 * SPEED2 - 4 * sin2 * COS2,
    }
    zero = {fact: Outcome.PROVED if cancel(together(e)) == 0 else Outcome.UNKNOWN for fact, e in facts.items()}
    return conjunction(*(Finding(outcome, fact) for fact, outcome in zero.items()))


def lands_first() -> Finding:
    """Of all points where the normal of an upper launch meets the boundary, the landing at `q < 1/3` alone is ahead.

    The flight equation is quadratic in `u`, so the launches to a landing are `u(q)` and, mirrored, that of `-q`; and
    `u(q)` is continuous for `-1 < q < 1`, in the upper half below 1/3 and in the lower above. Along `-exp(3*I*theta/2)`
    the flight from `u(q)` has a length that is 0 nowhere: it would end where it began, which only the cusp solves, and
    no `q` between -1 and 1 lands there. It is positive at `q = 0`, so it is everywhere. That direction points inward in
    the upper half, and outward in the lower one: a launch there meets the boundary at such a `q` behind it.

    >>> lands_first().outcome.name
    'PROVED'
    """
    u, cosine = Symbol("u"), sqrt(LAUNCH_COS2.subs(q, 0))
    cubic = u**3 + (2 + u) * u**2 + u * (2 * u + 1) * u + u**2  # the flight equation where it ends as it began
    facts = {
        "only the cusp lands on itself": expand(cubic - 4 * u**2 * (u + 1)) == 0,
        "the landing at q = 0 is theta = 0": COS2.subs(q, 0) == 1,
        "ahead there": bool(flown(cosine) > 0),
    }
    found = [Finding(Outcome.PROVED if true else Outcome.UNKNOWN, fact) for fact, true in facts.items()]
    return conjunction(positive(COS2, {q: Interval.open(-1, 1)}), *found)


def flown(cosine: Expr) -> Expr:
    """How far `z = 2` lies along the normal `-exp(3*I*theta/2)` from the launch with this `cos(theta/2)`.

    >>> flown(Rational(1, 2))  # from theta = 2*pi/3, at x = -1/4, where the normal is the x axis
    9/4
    """
    return 2 * cosine**3 - 2 * (4 * cosine**3 - 3 * cosine)


def expands() -> Finding:
    """`RATE < SHRINKS` at every landing, so that one bounce expands half angles by more than 1.197.

    >>> expands().outcome.name
    'PROVED'
    """
    return conjunction(positive(RATE, {q: UPPER}), positive(SHRINKS - RATE, {q: Interval(-1, UPPER.end)}))


def quiet_near_the_cusp() -> Finding:
    """Below `CUSP` the rate grows from 0 at the cusp to less than `SHRINKS/2`.

    >>> quiet_near_the_cusp().outcome.name
    'PROVED'
    """
    near = {q: Interval(-1, CUSP)}
    grows = positive(RATE.diff(q), near)
    return conjunction(grows, nonnegative(SHRINKS / 2 - RATE, near), Finding(_zero_at_cusp(), "0 at the cusp"))


def _zero_at_cusp() -> Outcome:
    return Outcome.PROVED if RATE.subs(q, -1) == 0 else Outcome.UNKNOWN


def gentle_elsewhere() -> Finding:
    """`abs(d log(RATE)/db) < STEEP` from `CUSP` on.

    >>> gentle_elsewhere().outcome.name
    'PROVED'
    """
    return positive(STEEP**2 - (RATE.diff(q) / RATE) ** 2 * SPEED2, {q: Interval(CUSP, UPPER.end)})


def branch(above: bool) -> Kernel:
    """`(launch, rate)` of the landing half angle `b`, without cancellation at the cusp.

    `launch` is the arc tangent of `sqrt(LAUNCH_TAN2)`, for `b < pi/4`, or `above` the right angle less that of its
    inverse, for `b > -pi/2`; `rate` is its derivative.

    >>> branch(False).results
    ('launch', 'rate')
    """
    r, landing = sqrt(1 + 7 * cos(b) ** 2), _landing()
    tangent = 32 * cos(b) ** 3 / (r**3 * (1 - landing) ** 2 * (1 - 3 * landing))  # 1 + q is 8*cos(b)**2/(r**2*(1 - q))
    rate = 4 * cos(b) ** 2 * (5 - 7 * landing) / (r**2 * (1 - landing) * (3 - landing))
    values = {"launch": pi / 2 - atan(1 / tangent) if above else atan(tangent), "rate": rate}
    return kernel("branch", [b], values, about="Where a ball that lands at half angle b left, and db0/db.")


def near_launch() -> Expr:
    """The launching half angle of `q = CUSP`.

    >>> near_launch().n(6)
    0.0610851
    """
    return atan(sqrt(LAUNCH_TAN2.subs(q, CUSP)))


def _landing() -> Expr:
    return sin(b) / sqrt(1 + 7 * cos(b) ** 2)
