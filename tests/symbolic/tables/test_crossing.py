"""Where a curve meets itself is named: by the chord of length zero, or by the polygon inscribed in the boundary."""

import pytest
from sympy import I, Rational, S, conjugate

from symbolic.tables import curves as crossing
from symbolic.tables.curves import chord_of_length_zero, polygon_crossing
from symbolic.tables.table import Component, Table, theta

LEFT, RIGHT = (3 + 4 * I) / 5, (3 - 4 * I) / 5  # exp(i*beta), beta = 53.13 and -53.13 degrees


def limacon(swing, turn):
    """The `c_k` of `r = 1 + 2*swing*cos(theta - beta)`, `turn = exp(i*beta)`: a loop where `|2*swing| > 1`."""
    return {0: swing * turn, 1: S.One, 2: swing * conjugate(turn)}


def chain(*corners, start=0):
    """Straight sides between the corners, each for `start <= theta <= start + 1`."""
    sides = []
    for n, (p, q) in enumerate(zip(corners, (*corners[1:], corners[0]), strict=True)):
        x, y = (u + (v - u) * (theta - start) for u, v in zip(p, q, strict=True))
        sides.append(Component(f"side {n}", (S(x), S(y)), S(start), S(start + 1)))
    return Table("chain", tuple(sides))


@pytest.mark.parametrize(
    ("swing", "turn", "ends"),
    [(1, LEFT, (-67, 173)), (1, RIGHT, (-173, 67)), (-1, LEFT, (-7, 113)), (-1, RIGHT, (-113, 7))],
)
def test_the_loop_of_a_limacon_meets_itself_where_its_radius_vanishes(swing, turn, ends):
    """`1 + 2*cos(theta - beta) = 0` at `beta -+ 120`; with the other sign at `beta -+ 60` degrees."""
    said = chord_of_length_zero(limacon(S(swing), turn))
    found = [int(word) for word in said.split() if word.strip("-").isdigit()]

    assert said.startswith("the boundary meets itself, or stops, near theta = ")
    assert [abs(angle - end) <= 1 for angle, end in zip(found, ends, strict=True)] == [True, True]  # a box has a width
    assert chord_of_length_zero(limacon(Rational(9 * swing, 20), turn)) is None


def test_the_crossing_of_two_sides_is_named_by_the_corners_before_it():
    """96 corners, 24 on a side, at `(3*k + 1)/72`; the sides cross in their middles, after 34/72."""
    for start in (0, 1, -2):
        at = start + Rational(17, 36)
        said = f"the boundary crosses itself, near side 0 at theta = {at} and side 2 at theta = {at}"

        assert polygon_crossing(chain((0, 0), (1, 1), (1, 0), (0, 1), start=start)) == said


def test_the_side_that_closes_the_polygon_is_one_of_its_sides():
    """19 corners on a side, at `(3*k + 1)/57`: the diagonal passes through the corner that the last side cuts off."""
    table = chain((0, 0), (57, 0), (20, 20), (-20, -20), (0, 57))

    assert (
        polygon_crossing(table)
        == "the boundary crosses itself, near side 2 at theta = 25/57 and side 4 at theta = 55/57"
    )


def test_the_first_side_is_compared_with_the_others_too():
    table = chain((0, 0), (3, 0), (3, 3), (Rational(1, 3), 3), (Rational(1, 3), -1))

    assert "near side 0 at theta = 4/57 and side 3 at theta = 40/57" in polygon_crossing(table)


def test_polygons_that_do_not_cross_are_left_alone():
    assert polygon_crossing(chain((0, 0), (4, 0), (4, 3), (0, 3))) is None
    assert polygon_crossing(chain((0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4))) is None


def test_touching_is_no_crossing():
    """A parabola touches a straight side at one of the polygon's corners."""
    bottom, bend = Rational(37, 72), (theta - Rational(37, 72)) ** 2
    straight = chain((-1, 0), (2, 0), (1, bottom**2), (0, (1 - bottom) ** 2)).components
    table = Table("touching", (*straight[:2], Component("bend", (1 - theta, bend), S.Zero, S.One), straight[3]))

    assert polygon_crossing(table) is None


@pytest.mark.parametrize("turns", [2, 3])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_polygon_that_runs_round_more_than_once_says_how_often(turns, sense):
    square = [(0, 0), (4, 0), (4, 3), (0, 3)][::sense]

    said = f"the boundary turns round {turns} times before it closes, and should once"
    assert polygon_crossing(chain(*square * turns)) == said


def test_angles_are_those_of_the_curve_whatever_its_parameter_runs_through():
    said, scaled = (chord_of_length_zero(limacon(S.One, LEFT), scale) for scale in (S.One, Rational(1, 2)))
    ends, halves = ([int(word) for word in text.split() if word.strip("-").isdigit()] for text in (said, scaled))

    assert [abs(2 * half - end) <= 1 for half, end in zip(halves, ends, strict=True)] == [True, True]


@pytest.mark.parametrize("first", range(4))
def test_two_sides_with_one_between_them_may_cross(first, monkeypatch):
    """A bow tie of four corners, one on each side of the chain: either pair of opposite sides."""
    monkeypatch.setattr(crossing, "CORNERS", 4)
    corners = [(0, 0), (1, 1), (1, 0), (0, 1)]
    said = polygon_crossing(chain(*corners[first:], *corners[:first]))

    assert said is not None
    assert said.startswith("the boundary crosses itself")


def test_a_segment_that_ends_on_the_line_of_another_does_not_cross_it():
    assert crossing._cross((0, 0), (2, 0), (1, -1), (1, 1))
    assert not crossing._cross((0, 0), (1, 0), (1, -1), (1, 1))
    assert not crossing._cross((0, 0), (2, 0), (1, 0), (1, 1))
