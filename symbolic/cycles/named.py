"""The cycles that the paper names or implies, each by its boundary points."""

from dataclasses import replace

from sympy import Expr, Integer, Interval, Rational, S, Symbol, acos, expand, pi, solve, together

from symbolic.cycles.cycle import Cycle
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.symbols import alpha, theta

c = Symbol("c", real=True)  # cos(theta) of a bounce of the egg's orbit between parallel tangents


def diameter() -> Cycle:
    """A diameter of the circle. Paper: section 3.1."""
    return Cycle("diameter", circle, ((0, S.Zero), (0, pi)))


def major_axis() -> Cycle:
    """The long axis of the ellipse. Paper: section 3.2."""
    return Cycle("major axis", ellipse, ((0, S.Zero), (0, pi)))


def minor_axis() -> Cycle:
    """The short axis of the ellipse. Paper: section 3.2."""
    return Cycle("minor axis", ellipse, ((0, pi / 2), (0, -pi / 2)))


def cardioid_vertical() -> Cycle:
    """The chord from `s = 2` to `s = -2`. Paper: section 4, caption of the slap map."""
    return Cycle("vertical", cardioid, ((0, pi / 3), (0, -pi / 3)))


def cuspless_vertical() -> Cycle:
    """The same chord in the cuspless cardioid. Paper: section 5."""
    return Cycle("vertical", cuspless, ((0, pi / 3), (0, -pi / 3)))


def cuspless_horizontal() -> Cycle:
    """The orbit along `y = 0`, from the wall's centre to the rightmost point. Paper: section 5.1."""
    return Cycle("horizontal", cuspless, ((1, S.Zero), (0, S.Zero)))


def egg_diameter(K: int | Expr = 3, angle: Expr = S.Zero) -> Cycle:
    """The chord of the egg from `angle` through the centre: vertex to flat for odd K. Paper: section 6.3.

    For even K a vertex faces a vertex (`angle = 0`) and a flat point a flat point (`pi/K`).
    """
    return Cycle("diameter", egg(K), ((0, angle), (0, angle + pi)))


def egg_parallel() -> Cycle:
    """The egg's period-2 orbit between parallel tangents that is not a diameter. Paper: section 6.2.

    Its bounces lie at `theta` and `-theta`, where the tangent is horizontal; `alpha` is then a
    rational function of `c = cos(theta)`, which runs from 0 at `alpha = 0` down to the root of
    `16*c**4 - 18*c**2 + 10*c + 3` at `alpha = 1/10`, above -2/9.
    """
    shape = parallel_shape()
    table = egg(3)
    given = table.components[0]
    point = tuple(coordinate.subs(alpha, shape) for coordinate in given.point)
    return Cycle(
        "parallel tangents",
        replace(table, components=(replace(given, point=point),), shapes=()),
        ((0, acos(c)), (0, -acos(c))),
        ((c, Interval(Rational(-2, 9), 0)),),
    )


def parallel_shape() -> Expr:
    """`alpha` as a function of `c` on `egg_parallel`: where the height `rho*sin(theta)` is stationary.

    >>> parallel_shape()
    -c/(16*c**4 - 18*c**2 + 3)
    """
    _, y = egg(3).components[0].point
    slope = y.diff(theta).subs(theta, acos(c))
    (shape,) = solve(expand(slope.expand(trig=True)), alpha)
    return together(shape)


def egg_triangle(at_flat: bool = True) -> Cycle:
    """The equilateral period-3 orbit of the elastic egg, at the flat points or at the vertices.

    Paper: section 6.4 (`lambda = 1`). Counterclockwise; the mirror image runs clockwise.
    """
    first = pi / 3 if at_flat else Integer(0)
    third = 2 * pi / 3
    return Cycle("triangle", egg(3), tuple((0, first + k * third) for k in range(3)))
