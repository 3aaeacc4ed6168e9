"""The collision rule in boundary parameters: it holds on the paper's cycles, and defines the same map."""

import mpmath
import pytest
from flint import arb
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Function, Matrix, Rational, S, atan, diff, pi, simplify

from symbolic.cycles.cycle import (
    Cycle,
    cardioid_vertical,
    cuspless_horizontal,
    cuspless_vertical,
    diameter,
    egg_diameter,
    egg_triangle,
    major_axis,
    minor_axis,
)
from symbolic.expressions.signs import vanishes
from symbolic.expressions.text import load
from symbolic.motion.chords import chord_angle, chord_kernel, polygon_kernel
from symbolic.motion.chords import theta0 as t0
from symbolic.motion.chords import theta1 as t1
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.table import Table, lam
from verification.arithmetic.balls import FLOAT64, balls, multiprecision, working

DOUBLE_NORMALS = [
    diameter, major_axis, minor_axis, cardioid_vertical, cuspless_vertical, cuspless_horizontal, egg_diameter
]  # fmt: skip
SHAPES = {"ellipse": {"a": Rational(3, 2)}, "egg": {"alpha": Rational(1, 20)}}


def residuals(cycle: Cycle, contraction: object) -> list:
    """The residual of the collision rule at each bounce of an exact cycle."""
    n = len(cycle.bounces)
    found = []
    for i in range(n):
        part, here = cycle.bounces[i]
        into, out = (
            chord_angle(cycle.table, part, other, 0).whole("angle").subs({t0: here, t1: there})
            for other, there in (cycle.bounces[i - 1], cycle.bounces[(i + 1) % n])
        )
        found.append(out + contraction * into)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("cycle", DOUBLE_NORMALS)
def test_double_normals_obey_the_rule_for_every_contraction(cycle):
    assert all(simplify(r) == 0 for r in residuals(cycle(), lam))


@pytest.mark.parametrize("at_flat", [True, False])
def test_triangles_of_the_egg_obey_the_elastic_rule_for_every_alpha(at_flat):
    for r in residuals(egg_triangle(at_flat), S.One):
        assert vanishes(r.replace(atan, lambda ratio: ratio))  # atan(u) + atan(v) = 0 exactly when u + v = 0


def test_derivatives_are_those_of_the_angle():
    x, y, p, q = (Function(name)(t) for name, t in (("x", t0), ("y", t0), ("p", t1), ("q", t1)))
    velocity, chord = Matrix([x, y]).diff(t0), Matrix([p - x, q - y])
    inward = Matrix([-velocity[1], velocity[0]])
    angle = atan(chord.dot(velocity) / chord.dot(inward))

    def bend(w: Matrix, parameter: object) -> object:
        return (w[0] * w[1].diff(parameter) - w[1] * w[0].diff(parameter)) / w.dot(w)

    assert simplify(diff(angle, t0) - bend(velocity, t0) + bend(chord, t0)) == 0
    assert simplify(diff(angle, t1) + bend(chord, t1)) == 0


CHORDS = [(egg(3), (0, 0)), (cuspless, (0, 1)), (cuspless, (1, 0)), (ellipse, (0, 0))]


@pytest.mark.parametrize(("table", "pair"), CHORDS)
def test_each_derivative_agrees_with_a_difference_quotient(table: Table, pair: tuple[int, int]):
    context = mpmath.MPContext()
    context.dps = 60
    angle = load(chord_kernel(table, *pair, 2), multiprecision(context))
    names = chord_kernel(table, *pair, 2).results
    at = [context.mpf("0.3"), context.mpf("0.41") if pair[1] else context.mpf("2.9")]
    at += [context.mpf(SHAPES[table.name][p.symbol.name].p) / 7 for p in table.shapes]
    h = context.mpf(10) ** -15
    index = {"0": 0, "1": 1, "_alpha": 2, "_a": 2}
    for first, key in (("angle", "angle_"), ("angle_0", "angle_0"), ("angle_1", "angle_1")):
        for tail, i in index.items():
            derivative = (key + tail).replace("__", "_")
            if derivative in names:
                up, down = ([*at[:i], at[i] + s * h, *at[i + 1 :]] for s in (1, -1))
                k = names.index(first)
                quotient = (angle(*up)[k] - angle(*down)[k]) / (2 * h)

                assert abs(angle(*at)[names.index(derivative)] - quotient) < 1e-25  # h**2 times a third derivative


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.fractions(0, Rational(1, 10), max_denominator=50))
@example(0.0, 3.0, Rational(1, 10))
def test_balls_contain_the_values_of_mpmath_and_the_wider_contain_the_finer(here, there, shape):
    if abs(here - there) < 1e-3:
        return
    rule = chord_kernel(egg(3), 0, 0, 2)
    context = mpmath.MPContext()
    context.dps = 80
    p, n = int(shape.numerator), int(shape.denominator)
    precise = load(rule, multiprecision(context))(context.mpf(here), context.mpf(there), context.mpf(p) / n)
    with working(100):
        coarse = load(rule, balls(100))(arb(here), arb(there), balls(100).q(p, n))
    with working(1000):
        fine = load(rule, balls(1000))(arb(here), arb(there), balls(1000).q(p, n))
        for wide, narrow, value in zip(coarse, fine, precise, strict=True):
            assert wide.contains(narrow)
            assert not narrow.contains(wide)
            assert wide.contains(arb(context.nstr(value, 75)))


@pytest.mark.parametrize("table", [egg(3).at(alpha=Rational(2, 25)), cardioid], ids=lambda table: table.name)
@pytest.mark.parametrize("order", [0, 1])
def test_the_sides_of_a_polygon_have_the_angles_of_their_chords(table, order):
    """First to the next corner, then to the one before, as documented; wider balls contain these angles."""
    with working(100):
        one, at = load(chord_kernel(table, 0, 0, order), balls(100)), [arb(x) for x in ("0.3", "1.9", "2.8", "5.1")]
        polygon = load(polygon_kernel(table, 4, order), balls(100))
        wide = polygon(*(x + arb(0, 1e-9) for x in at))
        expected = [x for step in (1, -1) for i in range(4) for x in one(at[i], at[(i + step) % 4])]

        for found, around, value in zip(polygon(*at), wide, expected, strict=True):
            assert (found - value).contains(0)
            assert abs(found - value) < 1e-25
            assert around.contains(value)


def test_a_chord_leaves_at_the_angle_of_the_ray():
    angle = load(chord_kernel(circle, 0, 0, 0), FLOAT64)

    for phi in (-1.2, -0.3, 0.4, 1.5):  # towards the tangent the chord subtends pi - 2*phi at the centre
        assert abs(angle(1.0, 1.0 + float(pi) - 2 * phi)[0] - phi) < 1e-14
