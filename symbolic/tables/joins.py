"""How the components of a boundary join: which one begins where another ends, and which derivatives agree there.

At a join the one-sided derivatives of the two components are compared exactly, as fractions if both are polynomials
with rational numbers. Free shape parameters stay symbols: derivatives agree only if they do so for all values of these.
A join whose kind depends on the parameters, within their ranges, is called a corner.
"""

from collections.abc import Sequence
from enum import Enum
from fractions import Fraction
from functools import lru_cache
from typing import Any

from sympy import S, expand, pi

from symbolic.expressions.signs import Box, positive, vanishes
from symbolic.tables.curves import LONG, curves, is_periodic, size
from symbolic.tables.polynomial import derived, fraction, rational_coefficients, value_of
from symbolic.tables.table import Component, Table, theta

ORDERS = 3  # largest number of derivatives that are compared
DIGITS = 30  # of the value of a number that is not 0
Vector = tuple[Any, Any]  # of fractions, or of expressions


class JoinKind(Enum):
    """How far two components agree where one ends and the next begins."""

    CORNER = "the tangents differ"
    CUSP = "the tangents are opposite"
    TANGENT = "the tangents agree, and nothing more is proved"
    CURVATURE = "the tangents and the curvatures agree"
    SMOOTH = "one analytic curve runs through"

    @property
    def smooth(self) -> bool:
        """Do the tangents agree, so that the billiard map is continuous at the join?

        >>> JoinKind.TANGENT.smooth, JoinKind.CUSP.smooth
        (True, False)
        """
        return self not in (JoinKind.CORNER, JoinKind.CUSP)


@lru_cache(maxsize=16)
def following(table: Table) -> tuple[int, ...]:
    """For each component, the index of the component that begins where it ends.

    >>> from symbolic.tables import cuspless, square
    >>> following(square(1)), following(cuspless)
    ((1, 2, 3, 0), (1, 0))
    """
    found: list[int] = []
    for curve in curves(table):
        first = len(found)
        found += [*range(first + 1, first + len(curve)), first]
    return tuple(found)


def contacts(table: Table) -> tuple[JoinKind, ...]:
    """For each component, its contact with the following one, which begins where it ends.

    >>> from symbolic.tables import cardioid, cuspless, ellipse
    >>> [contact.name for table in (cardioid, ellipse, cuspless) for contact in contacts(table)]
    ['CUSP', 'SMOOTH', 'TANGENT', 'TANGENT']
    """
    return tuple(contact for contact, _ in _joins(table))


def bends(table: Table) -> tuple[int, ...]:
    """For each component, 1 if the boundary turns left in a corner at its end, -1 if right, else or if undecided 0.

    >>> from symbolic.tables import of_gallery
    >>> bends(of_gallery("mushroom", {}))
    (1, -1, 1, 1, -1, 1)
    """
    return tuple(bend for _, bend in _joins(table))


@lru_cache(maxsize=16)
def _joins(table: Table) -> list[tuple[JoinKind, int]]:
    box = {shape.symbol: shape.range for shape in table.shapes if not shape.range.free_symbols}
    ends = [_Ends(component) for component in table.components]
    return [_join(ends[j], ends[after], box) for j, after in enumerate(following(table))]


class _Ends:
    """The derivatives of a component at its two ends, computed on demand."""

    def __init__(self, component: Component) -> None:
        self.component = component
        self.rational = rational_coefficients(component)
        self.known: dict[bool, list[Vector]] = {}

    def derivatives(self, last: bool, orders: int) -> list[Vector]:
        """The derivatives by `theta` of orders 1 to `orders`, at the component's end if `last`, else at its start."""
        place = self.component.end if last else self.component.start
        if self.rational is not None:
            if last not in self.known:
                both = [_derivatives(row, fraction(place)) for row in self.rational]
                self.known[last] = [_pair(each) for each in zip(*both, strict=True)]
            return self.known[last][:orders]
        return [_pair(x.diff(theta, n).subs(theta, place) for x in self.component.point) for n in range(1, orders + 1)]

    @property
    def order(self) -> int:
        """Order up to which derivatives must agree for two components to be one curve; 0 if there is no such order.

        The order is 3 for polynomials of degree three, and 2 for arcs of ellipses whose parameter is the angle at the
        centre.
        """
        if self.rational is not None:
            return ORDERS if max(map(len, self.rational)) <= ORDERS + 1 else 0
        if sum(map(size, self.component.point)) > LONG:
            return 0
        return 2 if all(expand(x.diff(theta, 3) + x.diff(theta)) == 0 for x in self.component.point) else 0


def _pair(values: Any) -> Vector:
    x, y = values
    return x, y


def _derivatives(row: Sequence[Fraction], at: Fraction) -> list[Fraction]:
    """The derivatives of a polynomial up to `ORDERS`."""
    found: list[Fraction] = []
    for _ in range(ORDERS):
        row = derived(row)
        found.append(value_of(row, at))
    return found


def _join(before: _Ends, after: _Ends, box: Box) -> tuple[JoinKind, int]:
    """The contact at the end of `before`, where `after` begins; and 1 or -1 for a corner to the left or right, or 0."""
    arriving, sign, regular = _direction(before, True)
    if arriving is not None and _continued(before.component, after.component):
        return (JoinKind.CUSP if sign < 0 else JoinKind.SMOOTH if regular else JoinKind.TANGENT), 0
    leaving, _, also = _direction(after, False)
    if arriving is None or leaving is None:
        return JoinKind.CORNER, 0
    if not _is_zero(turn := sign * _cross(arriving, leaving)):
        return JoinKind.CORNER, _is_positive(turn, box) - _is_positive(-turn, box)
    along = sign * _dot(arriving, leaving)
    if not _is_positive(along, box):
        return (JoinKind.CUSP if _is_positive(-along, box) else JoinKind.CORNER), 0
    return (_contact(before, after, along) if regular and also else JoinKind.TANGENT), 0


def _contact(before: _Ends, after: _Ends, along: Any) -> JoinKind:
    """The contact where the tangents agree; `along` is the scalar product of the two velocities."""
    u, v = before.derivatives(True, 2), after.derivatives(False, 2)
    square = _dot(u[0], u[0])
    if not _is_zero(_cross(*v) * square**3 - along**3 * _cross(*u)):
        return JoinKind.TANGENT
    order = before.order
    if order and order == after.order:
        ratio = along / square if order == ORDERS else 1
        pairs = zip(before.derivatives(True, order), after.derivatives(False, order), strict=True)
        if all(_is_zero(q - ratio**n * p) for n, pair in enumerate(pairs, 1) for p, q in zip(*pair, strict=True)):
            return JoinKind.SMOOTH
    return JoinKind.CURVATURE


def _direction(ends: _Ends, last: bool) -> tuple[Vector | None, int, bool]:
    """The first nonzero derivative at an end, the sign that makes it the tangent, and whether it is the velocity.

    Where the velocity vanishes, a curve arrives along minus its second derivative, and leaves along plus its second
    derivative.
    """
    for n in range(1, ORDERS + 1):
        vector = ends.derivatives(last, n)[-1]
        if not (_is_zero(vector[0]) and _is_zero(vector[1])):
            return vector, -1 if last and n % 2 == 0 else 1, n == 1
    return None, 1, False


def _continued(before: Component, after: Component) -> bool:
    """Does the second component have the formula of the first, and start at the parameter where the first ends?"""
    turns = (before.end - after.start) / (2 * pi)
    return before.point == after.point and (turns == 0 or (turns.is_Integer and all(map(is_periodic, before.point))))


def _cross(v: Vector, w: Vector) -> Any:
    return v[0] * w[1] - v[1] * w[0]


def _dot(v: Vector, w: Vector) -> Any:
    return v[0] * w[0] + v[1] * w[1]


def _is_zero(value: Any) -> bool:
    """Is a number proved to be 0, or an expression to vanish identically?"""
    if isinstance(value, Fraction):
        return not value
    value = S(value)
    return value.is_zero is True or (not value.is_comparable and vanishes(value))  # other comparable numbers are not 0


def _is_positive(value: Any, box: Box) -> bool:
    """Is a number positive, or is an expression proved to be positive for all parameters in `box`?"""
    if isinstance(value, Fraction):
        return value > 0
    value = expand(value)
    if value.is_number:
        return bool(value.evalf(DIGITS) > 0)
    return value.free_symbols <= set(box) and bool(positive(value, box))
