"""The geometry of a component, derived from its parametrisation. Paper: section 2 and appendix.

Signs: the boundary runs counterclockwise, the normal points inwards, and the curvature of a
focusing component is negative (the paper's convention; textbooks use the opposite sign).
"""

from sympy import Expr, Matrix, expand, simplify, sqrt
from sympy.simplify.fu import TR8

from symbolic.tables.symbols import theta
from symbolic.tables.table import Component


def velocity(component: Component) -> Matrix:
    """`d(x, y)/d theta`, a 2-vector along the tangent.

    >>> from symbolic.tables import circle
    >>> velocity(circle.components[0]).T
    Matrix([[-sin(theta), cos(theta)]])
    """
    return Matrix(component.point).diff(theta)


def speed(component: Component) -> Expr:
    """`|d(x, y)/d theta|`, in length per radian of `theta`.

    >>> from symbolic.tables import cardioid
    >>> speed(cardioid.components[0])
    sqrt(2*cos(theta) + 2)
    """
    return sqrt(trigonometric(velocity(component).dot(velocity(component))))


def tangent(component: Component) -> Matrix:
    """The unit tangent, counterclockwise."""
    return velocity(component) / speed(component)


def normal(component: Component) -> Matrix:
    """The unit normal that points into the table: the tangent turned left.

    >>> from symbolic.tables import circle
    >>> normal(circle.components[0]).T
    Matrix([[-cos(theta), -sin(theta)]])
    """
    x, y = velocity(component)
    return Matrix([-y, x]) / speed(component)


def turning(component: Component) -> Expr:
    """`x' y'' - y' x''`: positive where the boundary focuses, and free of roots."""
    first = velocity(component)
    second = first.diff(theta)
    return trigonometric(first[0] * second[1] - first[1] * second[0])


def curvature(component: Component) -> Expr:
    """Signed curvature `kappa(theta)`, in 1/length; negative where the boundary focuses.

    Paper: section 2 (sign convention), eq. (curvature-polar). Textbooks use the opposite sign.

    >>> from symbolic.tables import cardioid
    >>> curvature(cardioid.components[0]).subs(theta, 0)
    -3/4
    """
    return -turning(component) / speed(component) ** 3


def evolute(component: Component) -> Matrix:
    """The centres of curvature, the envelope of the inward normals. Paper: section 2.2.

    >>> from symbolic.tables import circle
    >>> evolute(circle.components[0]).T
    Matrix([[0, 0]])
    """
    x, y = velocity(component)
    ratio = trigonometric(x**2 + y**2) / turning(component)
    return Matrix([simplify(p + ratio * n) for p, n in zip(component.point, (-y, x), strict=True)])


def trigonometric(expression: Expr) -> Expr:
    """A trigonometric polynomial as a sum of sines and cosines of multiples; others merely expanded.

    >>> from sympy import cos, sin
    >>> trigonometric(sin(theta) ** 2 + 3 * cos(theta) ** 2)
    cos(2*theta) + 2
    """
    while True:
        summed = expand(TR8(expand(expression)))
        if summed == expression:
            return summed
        expression = summed
