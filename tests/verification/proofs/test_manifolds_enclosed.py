"""Enclosed local manifolds: remainders bound the effect of more orders, false coefficients are refused."""

from dataclasses import replace
from functools import cache

import mpmath
import pytest
from flint import acb, arb
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Rational

from verification.arithmetic.balls import multiprecision, working
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds.enclosed import (
    TUBE,
    TooWideError,
    bounds,
    complex_balls,
    enclosed,
    enclosed_saddle,
    remainder,
    round_outwards,
    vanishing,
)
from verification.proofs.manifolds.known import CONTACTS, SHAPE, TRIANGLE, table
from verification.proofs.manifolds.plane_map import Henon
from verification.proofs.manifolds.saddle import SaddleCycle, horner, local, saddle
from verification.proofs.manifolds.tangency import Precision, pair, scale

EGG = table(SHAPE)
OUTER = 1000


def at(orbit, parameter, width=0.0):
    """The saddle in balls, for complex parameters within `width` of one number."""
    return enclosed_saddle(orbit, EGG.over(complex_balls(300)), acb(arb(parameter, width), arb(0, width)))


MIRRORED, SYMMETRIC = (CONTACTS[name].unstable for name in ("merging", "symmetry-restoring"))
CASES = [(TRIANGLE, 2 / 3), (SYMMETRIC, 0.41), (MIRRORED, 0.4434)]


@cache
def few_and_many(case, unstable):
    """The series to orders 5 and 20, and the remainder bound of each."""
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


@pytest.mark.parametrize("case", [1, 2])
@pytest.mark.parametrize("unstable", [True, False])
def test_a_round_takes_points_no_farther_off_than_the_bounds(case, unstable):
    """Two points before the round are displaced in 16 relative directions, and each rule is solved in turn."""
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
        with pytest.raises(TooWideError, match="belong to no manifold"):
            remainder(false, OUTER)


def test_a_disc_on_which_the_rule_is_not_finite_bounds_nothing():
    few = few_and_many(2, True)[0]
    with working(300), pytest.raises(TooWideError, match="not bounded"):
        remainder(few, 100 * OUTER)


@pytest.mark.parametrize(
    ("order", "unit", "held"),
    [(1, 1e-6, False), (3, 1e-6, False), (10, 1e-6, True), (10, 0.08, True), (10, 0.2, False)],
)
def test_a_remainder_that_a_round_does_not_halve_or_that_leaves_the_tube_is_refused(order, unit, held):
    """Near the Henon map's fold a round hardly shrinks a remainder of few orders; a large disc has a large one."""
    with working(300):
        henon = Henon(Rational(3, 10)).over(complex_balls(300))
        weak = enclosed_saddle(SaddleCycle("left fixed point", (3.3,)), henon, acb(arb("-0.12")))
        made = enclosed(weak, True, order, unit, 0)
        if held:
            assert remainder(made, 10) < 1e-6
        else:
            with pytest.raises(TooWideError, match="not bounded"):
                remainder(made, 10)


@pytest.mark.parametrize("unstable", [True, False])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_slopes_are_bounded_for_all_points_that_a_remainder_may_reach(case, unstable):
    """Points of a small disc, each displaced by `TUBE` in one of 16 directions."""
    orbit, parameter = CASES[case]
    with working(300):
        saddle = at(orbit, parameter)
        made, inside = enclosed(saddle, unstable, 5, 1e-12, 0), -1 if unstable else 1
        for i, _, here, far in round_outwards(made, 1):
            centre = [made.over(j, arb(0)) for j in sorted((i, i + inside, i + 2 * inside))]
            for k in range(64):
                off = [arb(TUBE) * (acb(0, m) * arb.pi() / 2).exp() for m in (k % 4, k // 4 % 4, k // 16)]
                rows = saddle.map.slopes([x + d for x, d in zip(centre, off, strict=True)], saddle.parameter)
                first, second, outermost = rows if unstable else rows[::-1]
                assert abs(second / outermost) <= here
                assert abs(first / outermost) <= far


@pytest.mark.parametrize("case", range(len(CASES)))
@pytest.mark.parametrize("unstable", [True, False])
def test_derivatives_of_a_pair_are_those_of_series_in_mpmath(case, unstable):
    """Points of the manifold, and difference quotients by `z` and by the parameter, from the series of `local`."""
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
            SaddleCycle("inner fixed point", (0.63,)), Henon(Rational(3, 10)).over(complex_balls(200)), acb(a)
        )

        assert found.points[0].overlaps(acb(x))
        assert found.unstable.overlaps(acb(-a * x - root))
        assert found.stable.overlaps(acb(-a * x + root))


def test_what_no_ball_encloses_is_not_proved():
    with working(100):
        sink, flat = SaddleCycle("sink", (1.09,)), SaddleCycle("flat points", (-0.905,), Closure(1, (1, 3)))
        with pytest.raises(TooWideError, match="not proved that one multiplier"):
            enclosed_saddle(sink, Henon(Rational(3, 10)).over(complex_balls(100)), acb(0.2))
        with pytest.raises(TooWideError, match="may be singular"):
            at(TRIANGLE, 0.66, 0.2)
        with pytest.raises(TooWideError, match="did not contract"):
            at(MIRRORED, 0.4434, 0.001)
        with pytest.raises(TooWideError, match="complex"):
            enclosed_saddle(flat, EGG.over(complex_balls(100)), acb(0.66))
