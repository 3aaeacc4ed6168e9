"""The image of a short curve near the cusp of the cardioid under a bounce: at most two pieces, and their stretching.

Paper: section 4.1. The notation is that of `defocusing` and `almost_every`. The ends of a flight have the half angles
`a` and `b`; `c0 = cos(a)`, `c1 = cos(b)`, `x = c0/c1` and `C = cos(b - a)`. Lengths along the wall are measured by
`u = 3*a`, in which the wall is `3*pi` long. A curve along the cone has `dphi = (1 - y)*du` with `1 <= y <= 1 + lam`,
and a bounce stretches it by the factor `r(y) = (t*y - D0)/d1`.

*Flights have `C > 0`.* No point of the table lies on the ray `theta = pi`. So along a flight the polar angle changes
from `theta0` to `theta1` without a jump, by less than `pi` since the flight is straight, and `2*abs(b - a) < pi`.

*The curve S* of the exits at the cusp is the line `phi = theta/2`, and the flight there is `2*c0**2` long. Along it
`y = 2/3`, so `dphi > 0`, and a curve along the cone, with `dphi <= 0`, meets S at most once. From one side of S flights
land next to the cusp, with `c1` near 0; from the other they pass the cusp, in the limit by chords of length 2 with
`C = 0`. In the strip `abs(phi) <= lam*pi/2` there is `c0 >= cos(lam*pi/2) >= 1 - lam` on S, since the sine is concave.

*Distance.* With `phi` for the exit angle, `t*sin(phi - a) = 2*c1**2*sin(2*delta)`, where `2*delta = 2*(b - a)`: a
flight lands near the cusp only if it begins near S.

*Stretching.* For all `y` of the cone `least() <= r <= most()`, with

    least = (x**2 + 3 + 2*x*C)/(2*(1 + 2*x*C)),    most = (3/2)*(1 + lam)*(x**2 + 1 + 2*x*C)/(1 + 2*x*C).

At S, on the side where flights pass the cusp, `least = (x**2 + 3)/2 = 1 + 1/(2*sin(a)**2)`, which is at least 3/2.
Where flights land near the cusp, `least > x/4` is unbounded.

*How fast pieces leave S.* As `db = (r/3)*du` and `most <= (3/2)*(1 + lam)*(1 + x**2)`, `c1**2*db <= (1 + lam)*du`. Over
an arc of the wall along which `b` changes by `v` the integral of `cos(b)**2` is least next to the cusp, and more than
that of `sin**2*cos` from 0 to `v`, which is `sin(v)**3/3`. So along a piece that begins at S, after a length `u`,

    sin(v)**3 <= 3*(1 + lam)*u,

where `v` is `pi/2 - abs(b)`, with `sin(v) = c1`, if the piece lands at the cusp. If it passes the cusp, `v` is at least
`pi/2 - abs(b - a)`, with `sin(v) >= C`, since `a` and `b` grow together along a curve and `b` grows faster.
"""

from functools import cache

from sympy import Expr, Interval, Matrix, Rational, cos, expand_trig, oo, pi, sin, tan

from symbolic.cycles.almost_every import D0, LENGTHENED, bounce, two_rates, y
from symbolic.cycles.defocusing import BOUNDARY, C, delta, ends, gain, half, x
from symbolic.expressions.signs import SignFinding, all_vanish, conjunction, defect, positive
from symbolic.tables.table import lam, t, theta


def least() -> Expr:
    """Lower bound of the factor by which a bounce stretches a curve along the cone.

    >>> least().subs({C: 0, x: 0}), least().subs({C: 1, x: 1})
    (3/2, 1)
    """
    return (x**2 + 3 + 2 * x * C) / (2 * (1 + 2 * x * C))


def most() -> Expr:
    """Strict upper bound of the factor by which a bounce stretches a curve along the cone.

    >>> most().subs({C: 0, lam: 0})
    3*x**2/2 + 3/2
    """
    return Rational(3, 2) * (1 + lam) * (x**2 + 1 + 2 * x * C) / (1 + 2 * x * C)


def expansion() -> Expr:
    """A lower bound of the factor by which every flight but the first stretches curves along the cone (`defocusing`).

    >>> expansion().subs(lam, 1)
    1
    """
    return 1 + tan((1 - lam) * pi / 8) ** 2 / 2


def curve_defects() -> list[Expr]:
    """Direction to the cusp, length of the flight to it, `dphi/du` and `y` along S, minus their formulas; all are 0.

    The boundary is at `2*c0**2*exp(i*theta)`, the inward normal is `-exp(3*i*theta/2)`, and an exit at `phi` is the
    normal turned by `-phi`.

    >>> curve_defects()
    [0, 0, 0, 0, 0]
    """
    place = Matrix(BOUNDARY.point).subs(theta, 2 * half)
    normal, aside = (Matrix([-cos(angle), -sin(angle)]) for angle in (3 * half, 3 * half - pi / 2))
    length, exit = 2 * cos(half) ** 2, half
    along = cos(exit) * normal + sin(exit) * aside  # turned by -exit
    reached = [expand_trig(each) for each in place + length * along]
    slope = exit.diff(half) / 3
    across = LENGTHENED.subs({D0: Rational(4, 3) * cos(half) * cos(exit), t: length}).subs(y, 1 - slope)
    return [defect(each) for each in (*reached, slope - Rational(1, 3), across, 1 - slope - Rational(2, 3))]


def aim_defect() -> Expr:
    """`t*sin(phi - a) - 2*c1**2*sin(2*delta)`, which is 0, from the components of a chord along tangent and normal.

    >>> aim_defect()
    0
    """
    c0, c1 = ends()
    along, inward = (c0 * turn(delta) + c1 * turn(2 * delta) for turn in (cos, sin))  # over 2*sin(delta) (`defocusing`)
    return defect(2 * sin(delta) * (along * cos(half) - inward * sin(half)) - 2 * c1**2 * sin(2 * delta))


def stretch_defects() -> list[Expr]:
    """`least`, `most`, `least` at S, and the bound of `most` by `1 + x**2`, minus the module's formulas; all are 0.

    >>> stretch_defects()
    [0, 0, 0, 0]
    """
    squared, landing = 4 * (x**2 + 1 + 2 * x * C), Rational(8, 3) * (1 + 2 * x * C)  # t**2 and t*d1, over sin**2
    passing = least().subs({C: 0, x: cos(half) / sin(half)})
    room = Rational(3, 2) * (1 + lam) * (1 + x**2) - most()
    return [
        defect(least() - gain()),
        defect(most() - (1 + lam) * squared / landing),
        defect(passing - 1 - 1 / (2 * sin(half) ** 2)),
        defect(room - 3 * (1 + lam) * x**3 * C / (1 + 2 * x * C)),
    ]


def slope_defects() -> list[Expr]:
    """The slope after a bounce minus `1 + lam - lam*y/r`, and `t*(t - D0)` minus a sum of squares; both are 0.

    Divided by `sin**2`, the second has a positive lower bound because `max(c0, c1)` has one; so `log(r)` has bounded
    derivatives.

    >>> slope_defects()
    [0, 0]
    """
    out = bounce() * Matrix([1, 1 - y])
    square = Rational(4, 3) * (x**2 + 3 + 2 * x * C)
    return [
        defect(1 - out[1] / out[0] - (1 + lam - lam * y / LENGTHENED)),
        defect(4 * (x**2 + 1 + 2 * x * C) - Rational(8, 3) * x * (x + 2 * C) - square),
    ]


@cache
def leaves_the_cusp() -> SignFinding:
    """Is it proved how curves beside `S` are stretched, and how fast their images leave the cusp?"""
    flights = {x: Interval(0, oo), C: Interval(0, 1)}
    steps = {
        "exits at the cusp are the line phi = theta/2, which a curve along the cone meets once": curve_defects(),
        "flights land near the cusp only if they begin near that line": [aim_defect()],
        "by what a bounce stretches, at least and at most": stretch_defects(),
        "slopes and lengths of images": slope_defects(),
    }
    return conjunction(two_rates(), all_vanish(steps), positive(least() - x / 4, flights))
