"""Polygons inscribed in an egg: the closed form of the fold against the collision law on actual chords."""

import mpmath
import pytest
from sympy import Expr, Matrix, Rational, Symbol, acos, atan, pi, simplify, tan

from symbolic.cycles.polygons import (
    contraction_slope,
    elastic_trace,
    half_turn,
    largest_tilt,
    near_flat,
    required_tilt,
    saddle_node,
    tilt_tangent,
    turn_trace_and_determinant,
)
from symbolic.tables import egg
from symbolic.tables.geometry import curvature, normal
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
    """The two parameters at which the normal has the tilt that a polygon needs, by bisection."""
    wanted = number(tan(required_tilt(p, q).subs(lam, contraction)))
    expression = tilt_tangent(K).subs(alpha, SHAPE)

    def slope(x):
        return number(expression, x) - wanted

    top = mp.acos(-mp.mpf(SHAPE.p) / SHAPE.q) / K
    return [
        mp.findroot(slope, pair, solver="anderson", tol=mp.mpf(10) ** -100) for pair in ((0, top), (top, mp.pi / K))
    ]


def angle(chord: Matrix, inward: Matrix):
    """The angle from the inward normal to the chord, positive towards the tangent (clockwise of the normal)."""
    x, y = (mp.mpf(entry) for entry in inward)
    dx, dy = (mp.mpf(entry) for entry in chord)
    return mp.atan2(dx * y - dy * x, dx * x + dy * y)


@pytest.mark.parametrize(("K", "p", "q"), POLYGONS)
def test_at_the_fold_the_needed_tilt_is_the_largest_there_is(K, p, q):
    fold = saddle_node(K, p, q)

    assert simplify(required_tilt(p, q).subs(lam, fold) - atan(largest_tilt(K))) == 0


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_the_fold_at_the_shape_of_the_paper_is_a_little_below_what_it_reads_from_a_plot():
    fold = number(saddle_node(3, 1, 3).subs(alpha, Rational(2, 25)))
    delta = mp.atan(mp.mpf(24) / 100 / mp.sqrt(1 - mp.mpf(64) / 10000))

    assert abs(fold - (mp.pi / 6 - delta) / (mp.pi / 6 + delta)) < NOTHING
    assert mp.mpf("0.37") < fold < mp.mpf("0.39")


def test_an_elastic_triangle_turns_by_less_than_a_half_at_the_flat_points_and_stretches_at_the_vertices():
    flat, vertex = (elastic_trace(at_flat) for at_flat in (True, False))

    assert simplify(flat - (2 - 38 * alpha) / (1 - alpha)) == 0
    assert simplify(vertex - (2 + 38 * alpha) / (1 + alpha)) == 0


@pytest.mark.slow
@pytest.mark.parametrize(("p", "q"), [(1, 3), (1, 4), (2, 5)])
def test_weak_dissipation_contracts_a_polygon_at_the_rate_that_differences_give(p, q):
    gamma, step = number(half_turn(p, q)), mp.mpf(10) ** -25

    def log_det(contraction):
        delta = gamma * (1 - contraction) / (1 + contraction)
        return mp.log(contraction * mp.cos(gamma - delta) / mp.cos(gamma + delta))

    difference = (log_det(1 + step) - log_det(1 - step)) / (2 * step)
    assert abs(number(contraction_slope(p, q)) - difference) < mp.mpf(10) ** -30
