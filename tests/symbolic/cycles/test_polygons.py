"""Polygons in an egg: the fold in closed form, against the collision law on actual chords."""

import mpmath
import pytest
from sympy import Expr, Matrix, Rational, Symbol, acos, atan, cos, diff, pi, simplify, tan

from symbolic.cycles import polygons
from symbolic.cycles.polygons import (
    characteristic_on_branch,
    contraction_slope,
    elastic_trace,
    fold_margin,
    half_turn,
    largest_tilt,
    near_flat,
    polygon_identities,
    required_tilt,
    saddle_node,
    tilt_tangent,
    turn_trace_and_determinant,
)
from symbolic.expressions.signs import vanishes
from symbolic.tables import egg
from symbolic.tables.geometry import curvature, normal, tangent
from symbolic.tables.table import K0, alpha, lam, t, theta

mp = mpmath.MPContext()
mp.dps = 60
NOTHING = mp.mpf(10) ** -50
POLYGONS = [(3, 1, 3), (6, 1, 3), (4, 1, 4), (8, 1, 4), (5, 1, 5), (5, 2, 5), (7, 2, 7)]
SHAPE = Rational(1, 70)  # convex up to K = 8


def number(expression: Expr, at=None):
    if at is None:
        return mp.mpf(expression.evalf(70))
    return mp.mpf(expression.evalf(70, subs={theta: mp.nstr(at, 75)}))


def tilts(K: int, p: int, q: int, contraction: Expr) -> list:
    """The two parameters where the normal has the tilt that a polygon needs, by bisection."""
    wanted = number(tan(required_tilt(p, q).subs(lam, contraction)))
    expression = tilt_tangent(K).subs(alpha, SHAPE)

    def slope(x):
        return number(expression, x) - wanted

    top = mp.acos(-mp.mpf(SHAPE.p) / SHAPE.q) / K
    return [
        mp.findroot(slope, pair, solver="anderson", tol=mp.mpf(10) ** -100) for pair in ((0, top), (top, mp.pi / K))
    ]


def angle(chord: Matrix, inward: Matrix):
    """From the inward normal to the chord, positive towards the tangent (a quarter turn clockwise of the normal)."""
    x, y = (mp.mpf(entry) for entry in inward)
    dx, dy = (mp.mpf(entry) for entry in chord)
    return mp.atan2(dx * y - dy * x, dx * x + dy * y)


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_at_the_fold_the_needed_tilt_is_the_largest_there_is(K, p, q):
    fold = saddle_node(K, p, q)

    assert simplify(required_tilt(p, q).subs(lam, fold) - atan(largest_tilt(K))) == 0


@pytest.mark.parametrize("K", [3, 4, 5, 8])
def test_the_largest_tilt_is_the_maximum_over_the_boundary(K):
    top = acos(-alpha) / K
    slope = tilt_tangent(K)

    assert simplify(diff(slope, theta).subs(theta, top)) == 0
    assert simplify(slope.subs(theta, top) - largest_tilt(K)) == 0
    assert all(
        slope.subs({alpha: SHAPE, theta: Rational(j, 7)}) < largest_tilt(K).subs(alpha, SHAPE) for j in range(22)
    )


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_a_bounce_has_the_multiplier_one_at_the_fold_for_no_other_curvature(K, p, q):
    table = egg(K).at(alpha=SHAPE)
    top = acos(-SHAPE) / K
    gamma, delta = half_turn(p, q), atan(largest_tilt(K).subs(alpha, SHAPE))
    leaves, lands = Symbol("leaves"), Symbol("lands")
    trace, det = turn_trace_and_determinant(K0, t, leaves, lands)
    length = 2 * (1 - SHAPE**2) * cos(gamma)
    kappa = curvature(table.components[0]).subs(theta, top)

    fold = saddle_node(K, p, q).subs(alpha, SHAPE)
    residual = (1 - trace + det).subs({t: length, lam: fold, leaves: gamma - delta, lands: gamma + delta})

    assert abs(number(residual.subs(K0, kappa))) < NOTHING
    assert abs(number(residual.subs(K0, kappa + Rational(1, 100)))) > mp.mpf(10) ** -3


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_both_branches_obey_the_collision_law_on_their_chords_and_fold_from_either_side(K, p, q):
    table = egg(K).at(alpha=SHAPE)
    (component,) = table.components
    contraction = (1 + 2 * Rational(str(mp.nstr(number(saddle_node(K, p, q).subs(alpha, SHAPE)), 5)))) / 3
    signs = []
    for value in tilts(K, p, q, contraction):
        stops = [value + 2 * mp.pi * p * i / q for i in (-1, 0, 1)]
        before, here, after = (
            Matrix([number(coordinate, stop) for coordinate in component.point]) for stop in stops
        )  # fmt: skip
        inward = Matrix([number(entry, stops[1]) for entry in normal(component)])
        exits = angle(after - here, inward), angle(before - here, inward)
        ways = [abs(out + number(contraction) * back) for out, back in (exits, exits[::-1])]

        assert min(ways) < NOTHING  # one sense of rotation obeys the law, its mirror image does not
        assert max(ways) > mp.mpf(10) ** -3

        out, back = exits if ways[0] < ways[1] else exits[::-1]
        trace, det = turn_trace_and_determinant(K0, t, Symbol("leaves"), Symbol("lands"))
        chord = after - here
        values = {K0: curvature(component).subs(theta, value), t: mp.sqrt(mp.mpf(chord.dot(chord))), lam: contraction}
        values |= {Symbol("leaves"): out, Symbol("lands"): back}
        signs.append(mp.sign(number((1 - trace + det).subs(values))))

    assert sorted(signs) == [-1, 1]  # a saddle and a node


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_the_polygon_near_the_flat_points_has_the_tilt_it_needs_and_ends_at_the_fold(K, p, q):
    fold = saddle_node(K, p, q).subs(alpha, SHAPE)
    for share in (Rational(1, 3), Rational(9, 10)):
        at = {alpha: SHAPE, lam: fold + (1 - fold) * share}
        bounce = number(near_flat(K, p, q).subs(at))

        assert abs(number(tilt_tangent(K).subs(at), bounce) + number(tan(required_tilt(p, q).subs(at)))) < NOTHING
        assert number(pi / K) < bounce < number((2 * pi - acos(-SHAPE)) / K)
    end = near_flat(K, p, q).subs(alpha, SHAPE).subs(lam, fold)

    assert abs(mp.cos(K * number(end)) + number(SHAPE)) < mp.mpf(10) ** -25  # asin is steep at 1


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_elastic_polygons_need_no_tilt_and_the_circle_has_them_at_lambda_one_alone(K, p, q):
    assert required_tilt(p, q).subs(lam, 1) == 0
    assert saddle_node(K, p, q).subs(alpha, 0) == 1
    assert tilt_tangent(K).subs(theta, 0) == tilt_tangent(K).subs(theta, pi / K) == 0


def test_the_determinant_of_a_bounce_is_lambda_times_the_ratio_of_cosines():
    x, y = Symbol("x"), Symbol("y")

    assert simplify(turn_trace_and_determinant(K0, t, x, y)[1] - lam * cos(x) / cos(y)) == 0


def test_the_fold_at_the_shape_of_the_paper_is_a_little_below_what_it_reads_from_a_plot():
    fold = number(saddle_node(3, 1, 3).subs(alpha, Rational(2, 25)))
    delta = mp.atan(mp.mpf(24) / 100 / mp.sqrt(1 - mp.mpf(64) / 10000))

    assert abs(fold - (mp.pi / 6 - delta) / (mp.pi / 6 + delta)) < NOTHING
    assert mp.mpf("0.37") < fold < mp.mpf("0.39")


@pytest.mark.parametrize(("p", "q"), [(0, 3), (1, 2), (2, 3), (3, 6), (1, 1), (-1, 5)])
def test_a_rotation_number_out_of_range_is_refused(p, q):
    with pytest.raises(ValueError, match=f"^polygon: the rotation number {p}/{q} must lie strictly between 0 and 1/2$"):
        half_turn(p, q)


def test_the_default_polygon_is_the_triangle_of_the_three_pointed_egg():
    x, at = Symbol("x"), Symbol("at")

    assert half_turn() == half_turn(1, 3)
    assert required_tilt() == required_tilt(1, 3)
    assert (tilt_tangent(), largest_tilt()) == (tilt_tangent(3), largest_tilt(3))
    assert (saddle_node(), near_flat()) == (saddle_node(3, 1, 3), near_flat(3, 1, 3))
    assert characteristic_on_branch(x, at) == characteristic_on_branch(x, at, 3, 1, 3)


@pytest.mark.parametrize(("K", "p", "q"), [(3, 1, 3), (4, 1, 4), (5, 2, 5)])
@pytest.mark.parametrize("at", [1, -1, Rational(1, 3)])
def test_the_characteristic_polynomial_on_the_branch_is_that_of_the_bounce_it_has(K, p, q, at):
    x, bounce = Rational(2, 5), (pi - Rational(2, 5)) / K
    table = egg(K).at(alpha=SHAPE)
    gamma, delta = half_turn(p, q), atan(tilt_tangent(K).subs({theta: bounce, alpha: SHAPE}))
    trace, det = turn_trace_and_determinant(K0, t, Symbol("leaves"), Symbol("lands"))
    values = {Symbol("leaves"): gamma - delta, Symbol("lands"): gamma + delta, lam: (gamma - delta) / (gamma + delta)}
    values |= {K0: curvature(table.components[0]).subs(theta, bounce), t: 2 * (1 - SHAPE * cos(x)) * cos(gamma)}
    expected = cos(gamma + delta) * (at**2 - at * trace.subs(values) + det.subs(values))

    assert abs(number(characteristic_on_branch(x, at, K, p, q).subs(alpha, SHAPE) - expected)) < NOTHING


def test_the_identities_of_a_polygon_hold_and_a_wrong_sign_of_a_curvature_or_a_tangent_breaks_them(monkeypatch):
    def holding() -> list[bool]:
        return [vanishes(difference) for difference in polygon_identities().values()]

    assert holding() == [True] * 4
    monkeypatch.setattr(polygons, "curvature", lambda component: -curvature(component))
    assert holding() == [True, True, True, False]
    monkeypatch.setattr(polygons, "tangent", lambda component: -tangent(component))
    assert holding() == [True, False, False, False]


@pytest.mark.parametrize("K", [3, 4, 5])
def test_the_margin_of_the_fold_is_positive_towards_the_flat_points_and_negative_towards_the_vertices(K):
    margin = fold_margin(K)

    assert simplify(margin + K**2 * alpha * (cos(K * theta) + alpha)) == 0
    assert margin.subs({theta: pi / K, alpha: SHAPE}) > 0 > margin.subs({theta: 0, alpha: SHAPE})


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_a_bounce_towards_the_flat_points_has_both_multipliers_on_one_side_of_one(K, p, q):
    """`1 - trace + det` from the derivative matrix on chords of the table has the sign of the margin."""
    gamma = half_turn(p, q)
    for bounce in (pi / K - Rational(1, 50), Rational(1, 50)):
        here = {theta: bounce, alpha: SHAPE}
        delta = atan(-tilt_tangent(K).subs(here)).evalf(70)
        leaves, lands = Symbol("leaves"), Symbol("lands")
        trace, det = turn_trace_and_determinant(K0, t, leaves, lands)
        values = {K0: curvature(egg(K).at(alpha=SHAPE).components[0]).subs(theta, bounce).evalf(70)}
        values |= {t: (2 * (1 + SHAPE * cos(K * bounce)) * cos(gamma)).evalf(70)}
        values |= {leaves: gamma.evalf(70) - delta, lands: gamma.evalf(70) + delta}
        values |= {lam: values[leaves] / values[lands]}

        assert mp.sign((1 - trace + det).evalf(70, subs=values)) == mp.sign(number(fold_margin(K).subs(here)))


def test_an_elastic_triangle_turns_by_less_than_a_half_at_the_flat_points_and_stretches_at_the_vertices():
    flat, vertex = (elastic_trace(at_flat) for at_flat in (True, False))

    assert simplify(flat - (2 - 38 * alpha) / (1 - alpha)) == 0
    assert simplify(vertex - (2 + 38 * alpha) / (1 + alpha)) == 0


@pytest.mark.parametrize(("p", "q"), [(1, 3), (1, 4), (2, 5)])
def test_weak_dissipation_contracts_a_polygon_at_the_rate_that_differences_give(p, q):
    gamma, step = number(half_turn(p, q)), mp.mpf(10) ** -25

    def log_det(contraction):
        delta = gamma * (1 - contraction) / (1 + contraction)
        return mp.log(contraction * mp.cos(gamma - delta) / mp.cos(gamma + delta))

    difference = (log_det(1 + step) - log_det(1 - step)) / (2 * step)
    assert abs(number(contraction_slope(p, q)) - difference) < mp.mpf(10) ** -30
