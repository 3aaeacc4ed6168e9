"""Enclosed local manifolds: remainders bound what more orders add, false coefficients are refused, derivatives hold."""

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from flint import acb, arb
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Rational

from verification.arithmetic.balls import multiprecision, working
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds import enclosed as enclosing
from verification.proofs.manifolds.enclosed import (
    TooWideError,
    bounds,
    complex_balls,
    enclosed,
    enclosed_saddle,
    remainder,
    round_outwards,
    vanishing,
)
from verification.proofs.manifolds.known import CONTACTS, MIRRORED, SHAPE, SYMMETRIC, TRIANGLE, table
from verification.proofs.manifolds.plane_map import Henon
from verification.proofs.manifolds.saddle import Orbit, horner, local, saddle
from verification.proofs.manifolds.tangency import Precision, one_cycle, pair, scale, smaller

EGG = table(SHAPE)
OUTER = 1000


def at(orbit, parameter, width=0.0):
    """The saddle in balls, for letters around one."""
    return enclosed_saddle(orbit, EGG.over(complex_balls(300)), acb(arb(parameter, width), arb(0, width)))


CASES = [(TRIANGLE, 2 / 3), (SYMMETRIC, 0.41), (MIRRORED, 0.4434)]


@cache
def few_and_many(case, unstable):
    """The series to two orders, and the bound for what the shorter one leaves out."""
    orbit, parameter = CASES[case]
    with working(300):
        unit = scale(orbit, EGG, parameter, unstable, OUTER)
        few, many = (enclosed(at(orbit, parameter), unstable, order, unit.unit, unit.chief) for order in (5, 20))
        return few, many, remainder(few, OUTER), remainder(many, OUTER)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from([-1.0, 1.0]) | st.floats(-1, 1), st.sampled_from(range(len(CASES))), st.booleans())
def test_a_remainder_bounds_what_many_more_orders_add(z, case, unstable):
    few, many, error, least = few_and_many(case, unstable)
    with working(300):
        assert error > 1e20 * least
        for short, long in zip(few.coefficients, many.coefficients, strict=True):
            assert abs(horner(short, acb(z)) - horner(long, acb(z))) <= error + least


def remainder_of(case, unstable, order, outer):
    """The bound with a working disc as large as `outer` leaves it."""
    orbit, parameter = CASES[case]
    with working(300):
        unit = scale(orbit, EGG, parameter, unstable, outer)
        return float(remainder(enclosed(at(orbit, parameter), unstable, order, unit.unit, unit.chief), outer))


@pytest.mark.parametrize("case", range(len(CASES)))
@pytest.mark.parametrize("unstable", [True, False])
def test_a_disc_of_half_the_size_leaves_a_remainder_smaller_by_one_factor_of_two_for_each_order(case, unstable):
    large, small = (remainder_of(case, unstable, 9, outer) for outer in (500, 1000))

    assert large / small == pytest.approx(2**10, rel=1e-3)
    assert small < 100 * 1000.0**-10


def test_a_multiplier_near_the_circle_needs_more_orders():
    """One round makes the third order smaller by 1.676**3 only, which is too little; ten orders are enough."""
    with pytest.raises(TooWideError, match="not bounded"):
        remainder_of(1, True, 2, OUTER)

    assert remainder_of(1, True, 9, OUTER) < 1e-28


@pytest.mark.parametrize("case", range(len(CASES)))
@pytest.mark.parametrize("unstable", [True, False])
def test_the_outermost_point_is_off_by_as_much_as_the_slopes_say(case, unstable):
    """Each inner point of a rule is moved alone, in a complex direction, and the rule solved for the outermost."""
    made, inside = few_and_many(case, unstable)[0], -1 if unstable else 1
    off = acb(1e-9) * acb(0.6, 0.8)
    with working(300):
        map, parameter = made.saddle.map, made.saddle.parameter
        for i, _, *slopes in round_outwards(made, OUTER):
            for moved, slope in zip((i + inside, i + 2 * inside), slopes, strict=True):
                three = sorted((i, i + inside, i + 2 * inside))
                near = [made.over(j, arb(0)) + (off if j == moved else 0) for j in three]
                start, k = near[three.index(i)], three.index(i)
                for _ in range(8):
                    near[k] = (near[k] - map.rule(near, parameter) / map.slopes(near, parameter)[k]).mid()
                share = float(abs(near[k] - start) / (slope * abs(off)))

                assert 0.98 < share <= 1


@pytest.mark.parametrize("case", [1, 2])
@pytest.mark.parametrize("unstable", [True, False])
def test_a_round_outwards_takes_points_no_farther_off_than_the_bounds_say(case, unstable):
    """Two points before the round are moved, in 16 relative directions, and each rule is solved in turn."""
    made, inside = few_and_many(case, unstable)[0], -1 if unstable else 1
    with working(300):
        map, parameter, slopes = made.saddle.map, made.saddle.parameter, round_outwards(made, OUTER)
        one_round = abs(made.factor) ** (-inside * (made.order + 1))
        allowed = bounds(made, slopes, [arb(1e-9) * one_round] * len(slopes))
        first = slopes[0][0]
        worst = dict.fromkeys(range(len(slopes)), 0.0)
        for k in range(16):
            off = {first + inside: acb(1e-9), first + 2 * inside: 1e-9 * (acb(0, k) * arb.pi() / 8).exp()}
            for i, *_ in slopes:
                three = sorted((i, i + inside, i + 2 * inside))
                near = [made.over(j, arb(0)) + off.get(j, 0) for j in three]
                place = three.index(i)
                start = near[place]
                for _ in range(8):
                    step = map.rule(near, parameter) / map.slopes(near, parameter)[place]
                    near[place] = (near[place] - step).mid()
                off[i] = near[place] - start
                worst[i] = max(worst[i], float(abs(off[i]) / allowed[i]))

    assert max(worst.values()) <= 1
    assert worst[first] > 0.95


@pytest.mark.parametrize("order", [0, 1, 2, 5])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_a_falsified_coefficient_is_refused(case, order):
    few = few_and_many(case, True)[0]
    with working(300):
        first, *others = few.coefficients
        wrong = (*first[:order], first[order] * (1 + arb(10) ** -60), *first[order + 1 :])
        false = replace(few, coefficients=(wrong, *others))

        assert vanishing(few)
        with pytest.raises(TooWideError, match="no coefficients of a manifold"):
            remainder(false, OUTER)


def test_a_disc_on_which_the_rule_is_not_finite_bounds_nothing():
    few = few_and_many(2, True)[0]
    with working(300), pytest.raises(TooWideError, match="not bounded"):
        remainder(few, 100 * OUTER)


@pytest.mark.parametrize("case", range(len(CASES)))
@pytest.mark.parametrize("unstable", [True, False])
def test_derivatives_of_a_pair_are_those_of_series_in_mpmath(case, unstable):
    """Places on the manifold, and difference quotients by `z` and by the parameter, from the series of `local`."""
    orbit, parameter = CASES[case]
    unit, precision = scale(orbit, EGG, parameter, unstable, OUTER), Precision(20)
    with working(precision.bits):
        made = pair(orbit, EGG, arb(parameter), unit, precision)
        found = made.at(1, (arb(3) / 10).mid(), arb(0))
        with pytest.raises(TooWideError, match="radius 1/2"):
            made.at(1, arb("0.4", "0.2"), arb(0))
    context = mpmath.MPContext()
    context.dps = 60
    map, h, z, lam = (
        EGG.over(multiprecision(context)),
        context.mpf(10) ** -15,
        context.mpf(3) / 10,
        context.mpf(parameter),
    )
    series = [local(saddle(orbit, map, lam + k * h), unstable, 8, 1e-40) for k in (-1, 0, 1)]

    def place(z, k):
        return series[1 + k].points(z * context.mpf(unit.unit) / series[1 + k].unit)[0 if unstable else 1]

    with working(precision.bits):
        assert abs(found.place - arb(str(place(z, 0)))) < 1e-30
    assert float(found.first) == pytest.approx(float((place(z + h, 0) - place(z - h, 0)) / (2 * h)), rel=1e-12)
    twice = (place(z + h, 0) - 2 * place(z, 0) + place(z - h, 0)) / h**2
    assert float(found.second) == pytest.approx(float(twice), rel=1e-8)
    assert float(found.by_parameter) == pytest.approx(float((place(z, 1) - place(z, -1)) / (2 * h)), rel=1e-8)
    mixed = [(place(z + h, k) - place(z - h, k)) / (2 * h) for k in (-1, 1)]
    assert float(found.mixed) == pytest.approx(float((mixed[1] - mixed[0]) / (2 * h)), rel=1e-6)


def test_a_saddle_of_the_henon_map_has_the_multipliers_of_the_textbook():
    """By hand: `x = (b - 1 + sqrt((1 - b)**2 + 4*a))/(2*a)`, and `m**2 + 2*a*x*m - b = 0`."""
    with working(200):
        a, b = arb("1.4"), arb(3) / 10
        x = (b - 1 + ((1 - b) ** 2 + 4 * a).sqrt()) / (2 * a)
        root = ((a * x) ** 2 + b).sqrt()
        found = enclosed_saddle(
            Orbit("inner fixed point", (0.63,)), Henon(Rational(3, 10)).over(complex_balls(200)), acb(a)
        )

        assert found.points[0].overlaps(acb(x))
        assert found.unstable.overlaps(acb(-a * x - root))
        assert found.stable.overlaps(acb(-a * x + root))


def test_where_the_balls_of_a_long_cycle_grow_a_smaller_unit_bounds_the_remainder():
    """Stable manifold of five bounces, multiplier -0.011: its balls grow by 30 with each order."""
    where, precision = CONTACTS["window-merging-15"], Precision(24)
    large = scale(where.stable, EGG, where.parameter, False, precision.outer)
    with working(precision.bits):
        with pytest.raises(TooWideError, match="not bounded"):
            pair(where.stable, EGG, arb(where.parameter), large, precision)
        found = smaller(where.stable, EGG, arb(where.parameter), large, precision)

    assert found.scale.unit < large.unit
    assert len(found.places[0]) > precision.order + 1
    assert found.error < 1e-40


def test_cycles_at_single_parameters_are_held_against_the_one_over_a_disc():
    """A cycle at another parameter, or another bounce of the same cycle, is not taken for it."""
    with working(300):
        around, here, elsewhere = at(SYMMETRIC, 0.41, 1e-12), at(SYMMETRIC, 0.41), at(SYMMETRIC, 0.4101)
        turned = at(Orbit("its mirror image", tuple(-x for x in SYMMETRIC.start), Closure(-1, (-2, 3))), 0.41)

        assert one_cycle(around, here)
        assert not one_cycle(around, elsewhere)
        assert not one_cycle(around, turned)


def test_what_no_ball_encloses_is_not_proved():
    with working(100):
        sink, flat = Orbit("sink", (1.09,)), Orbit("flat points", (-0.905,), Closure(1, (1, 3)))
        with pytest.raises(TooWideError, match="not separated"):
            enclosed_saddle(sink, Henon(Rational(3, 10)).over(complex_balls(100)), acb(0.2))
        with pytest.raises(TooWideError, match="may be singular"):
            at(TRIANGLE, 0.66, 0.2)
        with pytest.raises(TooWideError, match="did not contract"):
            at(MIRRORED, 0.4434, 0.001)
        with pytest.raises(TooWideError, match="complex"):
            enclosed_saddle(flat, EGG.over(complex_balls(100)), acb(0.66))


@pytest.mark.parametrize(
    ("trace", "determinant", "inside"),
    [
        (0.5, 0.5, True),
        (-1.4, 0.5, True),
        (1.6, 0.5, None),
        (-1.6, 0.5, None),
        (1.5, 0.5, None),
        (0.0, 1.0, None),
        (0.1, 1.2, None),
        (0.2, -0.7, True),
        (0.4, -0.7, None),
        (0.0, -1.1, None),
    ],
)
def test_a_cycle_attracts_when_both_multipliers_lie_inside_the_unit_circle(monkeypatch, trace, determinant, inside):
    monkeypatch.setattr(enclosing, "enclosed_cycle", lambda *_: [])
    monkeypatch.setattr(enclosing, "slopes", lambda *_: [])
    monkeypatch.setattr(enclosing, "trace_and_determinant", lambda *_: (acb(trace), acb(determinant)))
    orbit = Orbit("a cycle", (0.0,))
    roots = [abs(x) for x in np.roots([1, -trace, determinant])]

    assert enclosing.attracting(orbit, None, None) is inside
    assert inside is None or max(roots) < 1

    def too_wide(*_):
        raise enclosing.TooWideError("saddle", "no")

    monkeypatch.setattr(enclosing, "enclosed_cycle", too_wide)
    assert enclosing.attracting(orbit, None, None) is None
