"""The elliptical stadium: two half ellipses joined by straight sides."""

from sympy import cos, pi, sin

from symbolic.tables.gallery import Length, arc, free, piecewise, positive
from symbolic.tables.table import Table, theta


def elliptical_stadium(straight: Length = 2, a: Length = "21/20") -> Table:
    """Two half ellipses of half axes `a` and 1 joined by sides of length `straight`; the stadium where `a` is 1.

    A Lyapunov exponent of the elastic billiard is positive if `1 < a < sqrt(4 - 2*sqrt(2))` and the sides exceed
    `4*a*a*sqrt(a*a - 1)` [MarkarianOliffsonKamphorstPintodeCarvalho1996].

    >>> elliptical_stadium().components[0].at(0)
    (41/20, 0)
    """
    half, long = positive("elliptical_stadium: straight", straight) / 2, positive("elliptical_stadium: a", a)
    return piecewise(
        arc("right", half + long * cos(theta), sin(theta), -pi / 2, pi / 2),
        arc("top", -theta, 1, -half, half),
        arc("left", -half - long * cos(theta), -sin(theta), -pi / 2, pi / 2),
        arc("bottom", theta, -1, -half, half),
        name="elliptical_stadium",
        shapes=free(straight, a),
    )
