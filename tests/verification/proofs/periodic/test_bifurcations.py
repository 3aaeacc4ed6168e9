"""Multipliers and normal forms: stability, islands, and twists worked out by hand."""

import math
from operator import gt, lt

import pytest
from flint import arb
from sympy import S, cos, pi, sin

from symbolic.cycles.normal_forms import composed
from symbolic.tables import ellipse
from symbolic.tables.table import Component, Table, theta
from verification.arithmetic.balls import working
from verification.proofs.periodic.bifurcation import (
    Stability,
    Twist,
    birkhoff_normal_form,
    stability,
    twist,
)


@pytest.mark.parametrize("trace", [1.5, -1.5, 1, -0.5, 0.5, -1.25])
def test_an_island_has_a_twist_and_a_multiplier_of_which_no_power_up_to_the_fourth_is_1(trace):
    drift, beside = arb(0), arb(trace)
    for number in (0.5, -0.5, 2, -2, 2.0**-99, arb(0.5, 0.25)):
        assert Twist(beside, arb(number), drift).islands is True
        for power in (2, -2, -1, 0, 3, -3, "2 +/- 0.1", "-1 +/- 0.1", "0 +/- 0.1", "-2 +/- 0.1", "nan"):
            assert Twist(arb(power), arb(number), drift).islands is None
    for number in (0, "0 +/- 0.1", "nan"):
        assert Twist(beside, arb(number), drift).islands is None


REAL = [(0.5, -0.25), (-0.5, -0.5), (0.875, -0.875), (0.75, 0.875), (0, 0), (2, 0.5), (-2, 0.5), (-1.25, -0.75), (3, 0),
        (2, 3), (-2, 3), (-2, -3), (1, 0.5), (-1, 0.5), (1, 1), (1, -1), (-1, -1), (1, 2), (-1, -2)]  # fmt: skip


CIRCLES = [(0, 0.25), (1, 0.75), (-1.5, 0.875), (0, 1), (1, 1), (-1.5, 1), (0, 1.5), (1, 1.25), (-2, 4)]


def test_a_cycle_attracts_or_is_a_saddle_by_where_its_multipliers_lie():
    """Two real multipliers, or two conjugate ones, whose squared modulus is the determinant."""
    for one, other in REAL:
        inner, outer = (sum(compare(abs(m), 1) for m in (one, other)) for compare in (lt, gt))
        wanted = {(2, 0): Stability.ATTRACTING, (1, 1): Stability.SADDLE}.get((inner, outer), Stability.UNKNOWN)
        assert stability(arb(one + other), arb(one * other)) is wanted
        assert stability(arb(one + other, 9), arb(one * other)) is Stability.UNKNOWN
        assert stability(arb(one + other), arb(one * other, 9)) is Stability.UNKNOWN
    for trace, determinant in CIRCLES:
        assert trace**2 < 4 * determinant
        wanted = Stability.ATTRACTING if determinant < 1 else Stability.UNKNOWN
        assert stability(arb(trace), arb(determinant)) is wanted


@pytest.mark.parametrize("angle", [0.75, -0.75, 1.25, 2.5, -2.75])
@pytest.mark.parametrize("linear", [None, (2.0, 0.5, 0.0), (0.5, -1.5, 0.25)])
@pytest.mark.parametrize("k", [1.0, -2.0])
def test_the_twist_of_a_turned_power_is_known_in_any_coordinates(angle, linear, k):
    """By hand: for a cubic term `3*k/8`, and for a square `-(3*cot(w/2) + cot(3*w/2))*k**2/16`.

    In coordinates turned by a right angle the power is added to `x` instead of `p`.
    """
    c, s = math.cos(angle), math.sin(angle)
    real = lambda *rows: tuple({(1, 0): arb(a), (0, 1): arb(b)} for a, b in rows)  # noqa: E731
    turn, quadratic = real((c, s), (-s, c)), -(k**2) / 16 * (3 / math.tan(angle / 2) + 1 / math.tan(3 * angle / 2))
    with working(80):
        for power, wanted in ((3, 3 * k / 8), (2, quadratic)):
            kicked = {(1, 0): arb(1)}, {(0, 1): arb(1), (power, 0): arb(-k)}
            other = {(1, 0): arb(1), (0, power): arb(k * (-1) ** (power + 1))}, {(0, 1): arb(1)}
            sheared, straight = (({(1, 0): arb(1)}, {(1, 0): arb(k), (0, 1): arb(1)}) for k in (0.5, -0.5))
            ways = [[turn, kicked], [kicked, turn], [turn, other], [straight, turn, kicked, sheared]]
            if linear:
                scale, shear, back = linear
                there = [real((scale, 0), (0, 1 / scale)), real((1, 0), (shear, 1)), real((1, back), (0, 1))]
                again = [real((1, -back), (0, 1)), real((1, 0), (-shear, 1)), real((1 / scale, 0), (0, scale))]
                ways = [[*again, kicked, turn, *there]]
            for way in ways:
                found = birkhoff_normal_form(composed(way))
                assert abs(found.trace - 2 * c) < 1e-12
                assert float(found.twist) == pytest.approx(wanted, rel=1e-12)
                assert abs(found.drift) < 1e-12


def test_the_twist_of_a_cycle_is_the_same_along_any_parameters_and_wherever_the_table_lies():
    """The minor axis of an ellipse, and of its turned and moved copy with other parameters, 0 at either end.

    It has trace `4*(1 - 2/a**2)**2 - 2`, and is the same begun at either end; the drift is 0, since areas are kept.
    """

    def moved(t):
        x, y = 3 * sin(t), cos(t)
        return (4 * y - 3 * x) / 5 + 7, (4 * x + 3 * y) / 5 - 2

    formulas = [theta / 2 + theta**2 / 3, pi + 2 * theta - theta**2 / 4]  # from the upper end
    table = Table("turned", tuple(Component(f"end {k}", moved(t), S(-1), S(1)) for k, t in enumerate(formulas)))
    with working(100):
        ends = [-arb.pi() / 2, arb.pi() / 2]
        known, other = (twist(ellipse.at(a=3), (0, 0), way, 100) for way in (ends, ends[::-1]))
        found = twist(table, (0, 1), [arb(0), arb(0)], 100)
        assert all((81 * each.trace).contains(34) for each in (known, other))
        assert all(each.drift.contains(0) and each.drift.rad() < 1e-20 for each in (known, other))
        assert abs(known.twist - other.twist) < 1e-20
        assert not known.twist.contains(0)
        assert abs(found.trace - known.trace) < 1e-24
        assert abs(found.twist - known.twist) < 1e-22
        assert abs(found.drift) < 1e-22
