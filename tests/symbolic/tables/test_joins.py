"""How components join: `following` and `contacts` on curves that are cut, turned or written in another way."""

from itertools import pairwise

import pytest
from sympy import Interval, Rational, S, Symbol, cos, pi, sin

from symbolic import tables
from symbolic.tables.joins import JoinKind, contacts, following
from symbolic.tables.table import Component, Shape, Table, theta

b = Symbol("b", positive=True)


def table(*pieces, shapes=()):
    parts = [Component(str(i), (S(x), S(y)), S(low), S(high)) for i, (x, y, low, high) in enumerate(pieces)]
    return Table("pieces", tuple(parts), shapes=shapes)


def names(*pieces, shapes=()):
    return [contact.name for contact in contacts(table(*pieces, shapes=shapes))]


@pytest.mark.parametrize("count", [2, 3, 12])
@pytest.mark.parametrize(("x", "y"), [(cos(theta), sin(theta)), (3 * cos(theta), 2 * sin(theta) - 5)])
def test_a_conic_cut_into_arcs_is_smooth(x, y, count):
    cuts = [2 * pi * k / count for k in range(count + 1)]
    assert names(*((x, y, low, high) for low, high in pairwise(cuts))) == ["SMOOTH"] * count
    own = [(x.subs(theta, theta + cut), y.subs(theta, theta + cut), 0, 2 * pi / count) for cut in cuts[:-1]]
    assert names(*own) == ["SMOOTH"] * count


def test_a_cubic_cut_in_two_is_smooth():
    side = (1 - 2 * theta, 1, 0, 1)
    one, two = (theta, theta**2, -1, 0), (2 * theta, 4 * theta**2, 0, Rational(1, 2))
    assert names(one, two, side) == ["SMOOTH", "CORNER", "CORNER"]


def test_what_agrees():
    arc, side = (cos(theta), sin(theta), 0, pi), (2 * theta - 1, 0, 0, 1)
    assert names(arc, side) == ["CORNER", "CORNER"]
    assert [c.name for c in contacts(tables.of_gallery("stadium", {}))] == ["TANGENT"] * 4
    assert [c.name for c in contacts(tables.of_gallery("diamond", {}))] == ["CUSP"] * 4
    assert contacts(tables.cardioid) == (JoinKind.CUSP,)
    # y = x**3 and the tangent at its inflection share tangent and curvature, and are no one curve
    flat = names((theta, 0, -1, 0), (theta, theta**3, 0, 1), (1 - 2 * theta, 1, 0, 1), (-1, 1 - theta, 0, 1))
    assert flat == ["CURVATURE", "CORNER", "CORNER", "CORNER"]


def test_a_spline_keeps_its_smoothness():
    points = [(0, 0), (3, 0), (4, 2), (2, 3), (0, 2)]
    found = [set(contacts(tables.from_points(points, smoothness=k))) for k in (0, 1, 2)]
    assert found == [{JoinKind.CORNER}, {JoinKind.TANGENT}, {JoinKind.CURVATURE}]


def test_shape_letters_stay_letters():
    shape = (Shape(b, Interval(1, 2), "is no length"),)
    stadium = [
        (cos(theta) + b, sin(theta), -pi / 2, pi / 2),
        (-theta, 1, -b, b),
        (cos(theta) - b, sin(theta), pi / 2, 3 * pi / 2),
        (theta, -1, -b, b),
    ]
    assert names(*stadium, shapes=shape) == ["TANGENT"] * 4
    half = [(theta, 0, -b, 0), (theta, 0, 0, b), (b * cos(theta), b * sin(theta), 0, pi)]
    assert names(*half, shapes=shape) == ["SMOOTH", "CORNER", "CORNER"]


def test_every_curve_closes():
    hole = (cos(theta) / 5, Rational(1, 2) - sin(theta) / 5, -pi, pi)
    pieces = table((cos(theta), sin(theta), 0, pi), (theta, 0, -1, 1), hole)
    assert following(pieces) == (1, 0, 2)
    assert [contact.smooth for contact in contacts(pieces)] == [False, False, True]


@pytest.mark.parametrize(("scale", "shift"), [(Rational(1, 10**10), 0), (1, 10**9)])
def test_size_and_place_decide_nothing(scale, shift):
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    placed = tables.polygon(*((scale * x + shift, scale * y + shift) for x, y in corners))
    assert following(placed) == (1, 2, 3, 4, 5, 0)
    assert set(contacts(placed)) == {JoinKind.CORNER}
