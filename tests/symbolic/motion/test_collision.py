"""The collision derivative: the paper's matrix, its determinant, and numerical derivatives of explicit maps."""

from fractions import Fraction

import mpmath
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Expr, Float, Function, Matrix, Rational, S, Symbol, cos, diff, pi, simplify

from symbolic.motion import flight as circle
from symbolic.motion.collision import (
    birkhoff_matrix,
    derivative_matrix,
    determinant,
    exit_angle,
    exit_slope,
    slap_derivative,
)
from symbolic.tables import ellipse
from symbolic.tables.geometry import curvature, speed
from symbolic.tables.table import K0, K1, a, cos_eta1, cos_phi0, eta, lam, phi, s, t, theta

mp = mpmath.MPContext()
mp.dps = 90
STEP = mp.mpf(10) ** -25
cos_phi1 = Symbol("cos_phi1", positive=True)


def test_the_derivative_is_the_matrix_the_paper_prints():
    A, B = (t * K0 + cos_phi0) / cos_eta1, t / cos_eta1
    paper = -Matrix([[A, B], [lam * (K1 * A + K0), lam * (K1 * B + 1)]])

    assert simplify(derivative_matrix() - paper) == Matrix.zeros(2)


def test_area_contracts_by_lambda_times_the_ratio_of_cosines():
    assert simplify(derivative_matrix().det() - lam * cos_phi0 / cos_eta1) == 0
    assert simplify(determinant() - lam * cos_phi0 / cos_eta1) == 0


def test_birkhoff_area_contracts_by_lambda_times_the_cosines_of_the_same_bounce():
    D = birkhoff_matrix(derivative_matrix(), cos_phi0, cos_phi1)

    assert simplify(D.det() - lam * cos_phi1 / cos_eta1) == 0
    assert D[0, 1] == derivative_matrix()[0, 1] / cos_phi0


def test_elastic_collisions_preserve_birkhoff_area():
    assert simplify(birkhoff_matrix(derivative_matrix(lam=S.One), cos_phi0, cos_eta1).det()) == 1


def test_an_elastic_flight_backwards_is_the_inverse():
    back = derivative_matrix(K1, K0, t, cos_eta1, cos_phi0, S.One)
    mirror = Matrix([[1, 0], [0, -1]])

    assert simplify(mirror * back * mirror * derivative_matrix(lam=S.One)) == Matrix.eye(2)


def test_any_reflection_law_enters_through_its_slope_alone():
    f = Function("f")
    slope = exit_slope(f(eta))
    D = derivative_matrix(lam=slope)

    assert slope == 1 - diff(f(eta), eta)
    assert simplify(D.det() - (1 - diff(f(eta), eta)) * cos_phi0 / cos_eta1) == 0
    assert D.row(0) == derivative_matrix().row(0)
    assert simplify(slope + diff(exit_angle(f(eta)), eta)) == 0


def test_the_slap_derivative_is_the_one_the_paper_prints():
    assert simplify(slap_derivative() + (t * K0 + 1) / cos_eta1) == 0
    assert derivative_matrix(lam=S.Zero).row(1) == Matrix([[0, 0]])


def test_exactly_on_the_circle():
    D = Matrix(circle.flight()).jacobian([s, phi])

    assert simplify(D - derivative_matrix(-S.One, -S.One, 2 * cos(phi), cos(phi), cos(phi))) == Matrix.zeros(2)


def test_the_limit_position_on_the_circle_is_an_invariant_up_to_half_turns():
    position, angle = circle.iterate(8)
    moved = circle.limit_position().subs({s: position, phi: angle}) - circle.limit_position()

    assert angle == lam**8 * phi
    assert simplify(moved - 8 * pi) == 0


def bounce(axis, start, out, contraction):
    """One flight and reflection in the ellipse, by the second root of a quadratic; the angle is not reduced."""
    x, y = axis * mp.cos(start), mp.sin(start)
    heading = mp.atan2(mp.cos(start), -axis * mp.sin(start)) + mp.pi / 2 - out
    vx, vy = mp.cos(heading), mp.sin(heading)
    length = -2 * (x * vx / axis**2 + y * vy) / (vx**2 / axis**2 + vy**2)
    x, y = x + length * vx, y + length * vy
    end = mp.atan2(y, x / axis)
    inward = (-mp.cos(end) / axis, -mp.sin(end))  # up to a positive factor
    incidence = mp.atan2(inward[0] * -vy - inward[1] * -vx, inward[0] * -vx + inward[1] * -vy)
    return end, contraction * incidence, length, -incidence


def number(value: Fraction):
    return mp.mpf(value.numerator) / value.denominator


def exactly(expression: Expr, axis: Fraction, at) -> object:
    x = Symbol("x")
    value = expression.subs({a: Rational(axis.numerator, axis.denominator), theta: x})
    return mp.mpf(value.evalf(80, subs={x: Float(mp.nstr(at, 85), 85)}))


def wrapped(angle):
    return angle - 2 * mp.pi * mp.nint(angle / (2 * mp.pi))


@pytest.mark.slow
@settings(max_examples=20)
@given(
    axis=st.fractions(1, 4, max_denominator=9),
    start=st.fractions(-3, 3, max_denominator=99),
    out=st.fractions(Fraction(-7, 5), Fraction(7, 5), max_denominator=99),
    contraction=st.fractions(0, 1, max_denominator=9),
)
@example(Fraction(1), Fraction(0), Fraction(0), Fraction(1))
@example(Fraction(4), Fraction(0), Fraction(7, 5), Fraction(1, 2))
def test_the_map_of_the_ellipse_has_the_derivative_matrix(axis, start, out, contraction):
    given_ = [number(value) for value in (axis, start, out, contraction)]
    end, _, length, incidence = bounce(*given_)
    columns = []
    for i in (1, 2):
        up, down = ([*given_[:i], given_[i] + sign * STEP, *given_[i + 1 :]] for sign in (1, -1))
        (end_up, out_up, *_), (end_down, out_down, *_) = bounce(*up), bounce(*down)
        columns.append((wrapped(end_up - end_down) / (2 * STEP), (out_up - out_down) / (2 * STEP)))
    (component,) = ellipse.components
    v0, v1 = (exactly(speed(component), axis, place) for place in (given_[1], end))
    k0, k1 = (exactly(curvature(component), axis, place) for place in (given_[1], end))
    by_length = [[columns[0][0] * v1 / v0, columns[1][0] * v1], [columns[0][1] / v0, columns[1][1]]]
    values = {K0: k0, K1: k1, t: length, cos_phi0: mp.cos(given_[2]), cos_eta1: mp.cos(incidence), lam: given_[3]}
    D = derivative_matrix()
    numeric = {symbol.name: value for symbol, value in values.items()}
    A = (numeric["t"] * numeric["K0"] + numeric["cos_phi0"]) / numeric["cos_eta1"]
    for i in (0, 1):
        for j in (0, 1):
            entry = mp.mpf(D[i, j].evalf(80, subs={symbol: Float(mp.nstr(v, 85), 85) for symbol, v in values.items()}))

            assert abs(entry - by_length[i][j]) < mp.mpf(10) ** -35 * (1 + abs(A)) / numeric["cos_eta1"] ** 4
