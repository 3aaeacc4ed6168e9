"""The collision rule in boundary parameters: exact on the paper's cycles, and the same map."""

import random

import mpmath
import pytest
from flint import arb
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Function, Matrix, Rational, S, atan, diff, pi, simplify, symbols

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
    monodromy,
)
from symbolic.expressions.signs import vanishes
from symbolic.expressions.text import load
from symbolic.motion.chords import (
    chord_angle,
    chord_kernel,
    collision_kernel,
    collision_rule,
    polar_polygon_kernel,
    polygon_kernel,
)
from symbolic.motion.chords import theta0 as t0
from symbolic.motion.chords import theta1 as t1
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.table import Table, alpha, lam
from verification.arithmetic.balls import FLOAT64, balls, multiprecision, working

DOUBLE_NORMALS = [
    diameter, major_axis, minor_axis, cardioid_vertical, cuspless_vertical, cuspless_horizontal, egg_diameter
]  # fmt: skip
SHAPES = {"ellipse": {"a": Rational(3, 2)}, "egg": {"alpha": Rational(1, 20)}}


def residuals(cycle: Cycle, contraction: object) -> list:
    """The collision rule at each bounce of an exact cycle."""
    n = len(cycle.bounces)
    found = []
    for i in range(n):
        three = [cycle.bounces[(i + k) % n] for k in (-1, 0, 1)]
        staged = collision_rule(cycle.table, tuple(c for c, _ in three), order=0)
        values = dict(zip(staged.arguments, [value for _, value in three], strict=False))
        found.append(staged.whole("residual").subs(values).subs(lam, contraction))
    return found


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


CYCLES = [
    cardioid_vertical(), cuspless_horizontal(), minor_axis(), egg_diameter(), egg_triangle(True), egg_triangle(False)
]  # fmt: skip


@pytest.mark.parametrize("cycle", CYCLES, ids=lambda c: f"{c.table.name}-{c.name}")
def test_determinant_of_the_cyclic_system_is_that_of_monodromy_minus_one(cycle):
    contraction = S.One if cycle.name == "triangle" else Rational(2, 5)
    shape = SHAPES.get(cycle.table.name, {})
    context = mpmath.MPContext()
    context.dps = 40
    n = len(cycle.bounces)
    J, product = context.zeros(n), context.mpf(1)
    for i in range(n):
        three = [cycle.bounces[(i + k) % n] for k in (-1, 0, 1)]
        rule = collision_kernel(cycle.table, tuple(c for c, _ in three))
        given = [value for _, value in three] + [contraction] + [shape[p.symbol.name] for p in cycle.table.shapes]
        values = load(rule, multiprecision(context))(*(context.mpf(S(value).evalf(50)) for value in given))
        named = dict(zip(rule.results, values, strict=True))
        for k, entry in ((-1, "d_previous"), (0, "d_here"), (1, "d_next")):
            J[i, (i + k) % n] += named[entry]
        product *= named["d_next"]
    M = monodromy(cycle, 0, contraction)
    known = (M - Matrix.eye(2)).det().subs({symbol: shape[symbol.name] for symbol in M.free_symbols})
    expected = (-1) ** (n + 1) * product * context.mpf(S(known).evalf(50))

    assert abs(context.det(J) - expected) < context.mpf(10) ** -30


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
    """In the order that is promised: to the next corner, then to the one before; in balls that wider ones contain."""
    with working(100):
        one, at = load(chord_kernel(table, 0, 0, order), balls(100)), [arb(x) for x in ("0.3", "1.9", "2.8", "5.1")]
        polygon = load(polygon_kernel(table, 4, order), balls(100))
        wide = polygon(*(x + arb(0, 1e-9) for x in at))
        expected = [x for step in (1, -1) for i in range(4) for x in one(at[i], at[(i + step) % 4])]

        for found, around, value in zip(polygon(*at), wide, expected, strict=True):
            assert (found - value).contains(0)
            assert abs(found - value) < 1e-25
            assert around.contains(value)


@pytest.mark.parametrize("table", [circle, egg(3).at(alpha=Rational(1, 12)), egg(2).at(alpha=Rational(1, 8))])
def test_a_polygon_in_a_polar_curve_has_the_same_angles_from_its_gaps_and_closer(table):
    """A corner that is seen backwards from the ray of another has no angle there."""
    chance, ahead = random.Random(3), 0
    with working(100):
        plain, polar = load(polygon_kernel(table, 3, 0), balls(100)), load(polar_polygon_kernel(table, 3), balls(100))
        for _ in range(40):
            first, one, two = (arb(chance.uniform(*range_)) for range_ in ((-3, 3), (0.2, 3), (0.2, 3)))
            at, gaps = [first, first + one, first + one + two], [one, two, 2 * arb.pi() - one - two]
            around = [x + arb(0, 0.01) for x in (first, one, two)]
            wide = [around[0], around[0] + around[1], sum(around[1:], around[0])]
            values, exact = polar(*at, *gaps), plain(*at)
            boxes, others = polar(*wide, *around[1:], 2 * arb.pi() - around[1] - around[2]), plain(*wide)
            for found, side, value, box, there, other in zip(
                values[:6], values[6:], exact, boxes[:6], boxes[6:], others, strict=True
            ):
                if side > 0:
                    ahead += 1
                    assert abs(found - value) < 1e-25
                if there > 0:
                    assert box.contains(value)
                    assert not other.is_finite() or box.rad() < other.rad()
    assert ahead > 200


def test_a_table_that_is_not_one_polar_curve_is_refused():
    with pytest.raises(ValueError, match="cuspless is not one polar curve"):
        polar_polygon_kernel(cuspless, 3)


def test_one_third_goes_in_exactly():
    third = load(chord_kernel(egg(3).at(alpha=Rational(1, 30)), 0, 0, 0), balls(200))
    general = load(chord_kernel(egg(3), 0, 0, 1), balls(200))
    with working(200):
        fixed = third(arb(0), arb(2))[0]

        assert fixed.overlaps(general(arb(0), arb(2), balls(200).q(1, 30))[0])
        assert not fixed.overlaps(general(arb(0), arb(2), arb(1 / 30))[0])  # the double 1/30 is another table


def test_a_chord_leaves_at_the_angle_of_the_ray():
    angle = load(chord_kernel(circle, 0, 0, 0), FLOAT64)

    for phi in (-1.2, -0.3, 0.4, 1.5):  # towards the tangent the chord subtends pi - 2*phi at the centre
        assert abs(angle(1.0, 1.0 + float(pi) - 2 * phi)[0] - phi) < 1e-14


def test_an_order_that_does_not_exist_is_refused_with_those_that_do():
    with pytest.raises(ValueError, match="order = 3 is not available; it must be 0, 1 or 2"):
        chord_angle(cardioid, order=3)


def test_no_letter_of_the_shape_is_lost():
    assert alpha in chord_angle(egg(3), order=1).arguments
    assert symbols("x") not in chord_angle(egg(3), order=1).arguments


def test_components_are_the_first_ones_unless_others_are_named():
    assert chord_angle(cuspless) == chord_angle(cuspless, 0, 0, 1)
    assert chord_kernel(cuspless) == chord_kernel(cuspless, 0, 0, 1)
    assert collision_rule(cuspless) == collision_rule(cuspless, (0, 0, 0), 1)
    assert collision_kernel(cuspless) == collision_kernel(cuspless, (0, 0, 0))


@pytest.mark.parametrize("table", [ellipse, egg(3)], ids=lambda table: table.name)
def test_the_derivatives_of_the_rule_are_those_of_its_residual(table):
    """At rational parameters, in 40 digits, by SymPy's differentiation of the whole residual."""
    staged = collision_rule(table)
    values = dict(
        zip(staged.arguments, [Rational(-3, 2), Rational(1, 5), Rational(7, 4), Rational(2, 3)], strict=False)
    )
    (shape,) = (p.symbol for p in table.shapes)
    values[shape] = SHAPES[table.name][shape.name]
    residual = staged.whole("residual")
    names = ["d_previous", "d_here", "d_next", "d_lam", f"d_{shape}"]

    for name, letter in zip(names, (*staged.arguments[:4], shape), strict=True):
        difference = staged.whole(name).subs(values).evalf(40) - diff(residual, letter).subs(values).evalf(40)
        assert abs(difference) < Rational(1, 10**35)
