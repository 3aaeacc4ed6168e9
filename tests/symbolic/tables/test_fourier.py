"""Fourier coefficients rebuild the curve that they came from, and a curve without finitely many is refused."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Abs, Expr, I, Rational, S, Symbol, conjugate, cos, exp, expand, pi, simplify, sin, sqrt, tan

from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.geometry import boundary_coefficients, coefficients, in_half_tangent
from symbolic.tables.table import a, alpha, theta

TABLES = [circle, ellipse, cardioid, egg(2), egg(3), egg(5)]
SMALL = st.integers(-3, 3)


@st.composite
def trigonometric_polynomials(draw) -> Expr:
    total = S(draw(SMALL))
    for _ in range(draw(st.integers(1, 3))):
        first, second = draw(st.sampled_from([cos, sin])), draw(st.sampled_from([cos, sin]))
        k, power = draw(st.integers(1, 4)), draw(st.integers(0, 3))
        total += draw(SMALL) * first(k * theta) * second(theta) ** power
    return total


def rebuilt(c: dict[int, Expr]) -> Expr:
    return sum((value * (cos(k * theta) + I * sin(k * theta)) for k, value in c.items()), S.Zero)


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.name)
def test_coefficients_rebuild_the_boundary(table):
    (component,) = table.components
    x, y = component.point
    difference = rebuilt(boundary_coefficients(component)) - x - I * y

    assert expand(expand(difference.rewrite(exp))) == 0


def test_boundaries_have_the_coefficients_of_a_hand_calculation():
    assert boundary_coefficients(circle.components[0]) == {1: 1}
    assert boundary_coefficients(cardioid.components[0]) == {0: Rational(1, 2), 1: 1, 2: Rational(1, 2)}
    assert boundary_coefficients(egg(3).components[0]) == {-2: alpha / 2, 1: 1, 4: alpha / 2}
    found = boundary_coefficients(ellipse.components[0])
    assert {k: simplify(v - (a + k) / 2) for k, v in found.items()} == {-1: 0, 1: 0}
    assert boundary_coefficients(cuspless.component("wall")) is None
    deltoid = 2 * cos(theta) + cos(2 * theta) + I * (2 * sin(theta) - sin(2 * theta))
    assert coefficients(deltoid) == {-2: 1, 1: 2}


@settings(max_examples=60)
@given(trigonometric_polynomials())
@example(sin(theta) ** 2 + cos(theta) ** 2 - 1)
@example(cos(2 * theta) ** 3 * sin(theta))
def test_coefficients_rebuild_any_real_sum_and_are_conjugate_in_pairs(expression):
    c = coefficients(expression)

    assert expand(expand((rebuilt(c) - expression).rewrite(exp))) == 0
    assert all(c[k] == conjugate(c[-k]) for k in c)
    assert 0 not in c.values()


@settings(max_examples=30)
@given(trigonometric_polynomials(), st.fractions(-3, 3, max_denominator=7))
@example(1 + cos(theta), 0)
def test_the_half_tangent_polynomial_has_the_sign_of_the_sum(expression, at):
    p, T, at_pi = in_half_tangent(expression)
    c = coefficients(expression)
    step = S(S.Zero).gcd(0)
    for k in c:
        step = S(step).gcd(abs(k))
    step = step or S.One
    at = Rational(at.numerator, at.denominator)
    value = expression.subs(theta, at / step).evalf(30)
    image = p.subs(T, tan(at / 2)).evalf(30)

    assert abs(value) < 1e-20 or (value > 0) == (image > 0)
    assert simplify(at_pi - expression.subs(theta, pi / step)) == 0


@pytest.mark.parametrize(
    "expression",
    [
        theta, theta * cos(theta), 1 / cos(theta), sqrt(cos(theta)), tan(theta), Abs(cos(theta)), cos(theta / 2),
        cos(sqrt(2) * theta), exp(theta), exp(-(theta**2)), cos(cos(theta)), sin(theta) ** a,
        cos(Symbol("K", integer=True) * theta), exp(I * Symbol("K", integer=True) * theta),
    ],
)  # fmt: skip
def test_what_is_no_finite_sum_has_no_coefficients(expression):
    assert coefficients(expression) is None
