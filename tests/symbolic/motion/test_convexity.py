"""A dent is found wherever it lies, and a straight side counts as convex, but not as strictly convex."""

import pytest
from sympy import Interval, Rational, S, Symbol, cos, pi, sin

from symbolic.expressions.signs import Outcome
from symbolic.motion.chords import convexity
from symbolic.tables import circle
from symbolic.tables.table import Component, Table, lam, theta

DIRECTIONS = {
    "right, T = 0": (S.One, S.Zero),
    "a little to the left, T = 1/3": (Rational(4, 5), Rational(3, 5)),
    "up, T = 1": (S.Zero, S.One),
    "T = 2": (-Rational(3, 5), Rational(4, 5)),
    "a little to the right, T = -1/3": (Rational(4, 5), -Rational(3, 5)),
    "down, T = -1": (S.Zero, -S.One),
    "T = -2": (-Rational(3, 5), -Rational(4, 5)),
    "behind, where T has no value": (-S.One, S.Zero),
}


def whole_turn(*point):
    return Component("boundary", point, S.Zero, 2 * pi)


def limacon(depth, direction):
    """`r = 1 - depth*cos(theta - beta)`, whose turning, `1 + 2*depth**2 - 3*depth*cos(theta - beta)`, changes sign."""
    across, up = direction
    r = 1 - depth * (across * cos(theta) + up * sin(theta))
    return Table("limacon", (whole_turn(r * cos(theta), r * sin(theta)),))


def square():
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    sides = [((x - y + (-x - y) * theta) / 2, (y + x + (x - y) * theta) / 2) for x, y in corners]
    return Table("square", tuple(Component(f"side {n}", side, -S.One, S.One) for n, side in enumerate(sides)))


@pytest.mark.slow
@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS.keys())
def test_a_limacon_is_convex_up_to_one_half_and_dented_beyond_in_whatever_direction(direction):
    assert convexity(limacon(Rational(9, 20), direction), strictly=True).outcome is Outcome.PROVED
    assert convexity(limacon(Rational(11, 20), direction)).outcome is Outcome.REFUTED


def test_the_dent_may_come_from_the_shape_alone():
    depth = Symbol("depth", nonnegative=True)
    table = limacon(depth, DIRECTIONS["up, T = 1"])

    assert convexity(table, {depth: Interval(0, Rational(1, 2))}).outcome is Outcome.PROVED
    assert convexity(table, {depth: Interval(0, 1)}).outcome is Outcome.REFUTED


def test_straight_sides_are_convex_but_not_strictly():
    assert convexity(square()) == convexity(square(), {lam: Interval(0, 1)})
    assert convexity(square()).outcome is Outcome.PROVED
    assert convexity(square(), strictly=True).outcome is not Outcome.PROVED


def test_a_circle_is_strictly_convex_and_a_circle_run_backwards_is_not_convex():
    back = Table("clockwise", (whole_turn(cos(theta), -sin(theta)),))

    assert convexity(circle, strictly=True).outcome is Outcome.PROVED
    assert convexity(back).outcome is Outcome.REFUTED
    assert convexity(back, strictly=True).outcome is Outcome.REFUTED


def test_a_curve_that_is_no_trigonometric_sum_is_left_open():
    bent = Table("bent", (whole_turn(theta, theta**4),))

    assert convexity(bent).outcome is Outcome.UNKNOWN
    assert "is no trigonometric polynomial" in convexity(bent).reason
