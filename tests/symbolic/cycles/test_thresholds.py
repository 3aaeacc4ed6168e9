"""Thresholds satisfy their defining equations, and keep digits that the printed forms lose."""

from collections.abc import Callable
from fractions import Fraction

import pytest
from sympy import Expr, Interval, Rational, S, Symbol, lambdify, simplify, sqrt

from symbolic.cycles.cycle import cuspless_horizontal, discriminant, minor_axis, trace_and_determinant
from symbolic.cycles.thresholds import (
    alpha_hat,
    alpha_tilde,
    even_stability_numbers,
    lambda_c,
    lambda_minus,
    lambda_plus,
    tilt,
    trace_of,
)
from symbolic.expressions.signs import positive, vanishes
from symbolic.tables.table import a, alpha, lam

EPS = Fraction(1, 2**52)
ODD = [3, 5, 7, Symbol("K", integer=True, positive=True, odd=True)]
w = Symbol("w", positive=True)

MINUS_PRINTED = (a**4 + 4 * a**2 - 4 - 4 * a**2 * sqrt(a**2 - 1)) / (a**2 - 2) ** 2
PLUS_PRINTED = (a**4 + 4 * a**2 - 4 + 4 * a**2 * sqrt(a**2 - 1)) / (a**2 - 2) ** 2
TILDE_PRINTED = sqrt((82 + 162 * lam + 82 * lam**2 - 9 * (1 + lam) * sqrt(83 + 162 * lam + 83 * lam**2)) / (1 + lam**2))
HAT_PRINTED = (9 * (1 + lam) - sqrt(82 + 160 * lam + 82 * lam**2)) / (lam - 1)


def by_eccentricity(expression: Expr) -> Expr:
    """The expression with `a = sqrt(1 + w**2)`: at the ellipse's minor axis it is rational in `w`."""
    return simplify(expression.subs(a, sqrt(1 + w**2)))


@pytest.mark.parametrize("threshold", [lambda_minus(), lambda_plus()])
def test_multipliers_of_the_minor_axis_coincide_at_lambda_minus_and_lambda_plus(threshold):
    d = discriminant(*trace_and_determinant(minor_axis()))

    assert by_eccentricity(d.subs(lam, threshold)) == 0


def test_lambda_minus_and_lambda_plus_are_the_printed_ones():
    assert by_eccentricity(lambda_minus() - MINUS_PRINTED) == 0
    assert by_eccentricity(lambda_plus() - PLUS_PRINTED) == 0
    assert simplify(lambda_minus() * lambda_plus()) == 1


def test_the_cuspless_orbit_doubles_its_period_at_the_printed_lambda_c():
    trace, det = trace_and_determinant(cuspless_horizontal())

    assert vanishes(lambda_c() - (27 - 8 * sqrt(11)) / 5)
    assert vanishes((1 + trace + det).subs(lam, lambda_c()))


@pytest.mark.slow
@pytest.mark.parametrize("K", ODD, ids=str)
def test_a_multiplier_is_minus_one_at_alpha_tilde(K):
    difference = tilt(K).subs(alpha, alpha_tilde(K)) - sqrt(2 * (1 + lam**2)) / (1 + lam)
    P = 1 - 2 * (1 + lam**2) / (1 + lam) ** 2

    assert vanishes(difference)
    assert simplify(1 + trace_of(P) + lam**2) == 0


@pytest.mark.slow
@pytest.mark.parametrize("K", ODD, ids=str)
def test_the_multipliers_coincide_at_alpha_hat(K):
    difference = tilt(K).subs(alpha, alpha_hat(K)) - (1 - lam) / (1 + lam)
    P = 1 - ((1 - lam) / (1 + lam)) ** 2

    assert vanishes(difference)
    assert simplify(discriminant(trace_of(P), lam**2)) == 0


@pytest.mark.slow
def test_the_shapes_are_the_printed_ones_for_three_points():
    for contraction in (S.Zero, Rational(1, 7), Rational(2, 3)):
        assert vanishes(alpha_tilde().subs(lam, contraction) ** 2 - TILDE_PRINTED.subs(lam, contraction) ** 2)
        assert vanishes(alpha_hat().subs(lam, contraction) - HAT_PRINTED.subs(lam, contraction))
    assert [round(float(alpha_tilde().subs(lam, end)), 4) for end in (0, 1)] == [0.0781, 0.0554]  # the paper's


@pytest.mark.slow
@pytest.mark.parametrize("K", [3, 5, 7])
def test_the_shapes_lie_in_the_convex_range_and_the_focus_comes_first(K):
    low, high = alpha_hat(K), alpha_tilde(K)
    for k in range(11):
        hat, tilde = (float(shape.subs(lam, Rational(k, 10))) for shape in (low, high))

        assert 0 <= hat < tilde < Rational(1, 1 + K * K)


@pytest.mark.slow
@pytest.mark.parametrize("K", [2, 4, 6])
def test_an_even_egg_is_unstable_along_its_vertices_and_stable_along_its_flats(K):
    vertex, flat = even_stability_numbers(K)
    convex = Interval.Lopen(0, Rational(1, 1 + K * K))

    assert positive(vertex - 1, {alpha: convex})
    assert positive(1 - flat, {alpha: Interval.open(0, Rational(1, 1 + K * K))})
    assert flat.subs(alpha, Rational(1, 1 + 2 * K * K)) == 0
    assert flat.subs(alpha, Rational(1, 1 + K * K)) == 1  # curvature 0 at both flats: neutral


@pytest.mark.parametrize("shape", [tilt, alpha_tilde, alpha_hat])
def test_an_even_egg_has_no_alpha_tilde_and_says_so(shape):
    said = r"^egg: K = 4 is even; a vertex then faces a vertex and alpha-tilde does not exist$"
    with pytest.raises(ValueError, match=said):
        shape(4)


def relative_error(form: Callable[[float], float], exact: Expr, letter: Symbol, x: float) -> float:
    """The relative error of a form at the float `x`, in units of eps, against `exact` at that same number."""
    truth = exact.subs(letter, Rational(Fraction(x).numerator, Fraction(x).denominator))
    return float(abs(Rational(*form(x).as_integer_ratio()) - truth).evalf(20) / abs(truth.evalf(40))) / float(EPS)


NEAR_ONE = [1 - 2.0**-k for k in (10, 30, 50)]
GRID = [k / 7 for k in range(7)]


@pytest.mark.slow
@pytest.mark.parametrize("K", [3, 5, 7])
@pytest.mark.parametrize("shape", [alpha_hat, alpha_tilde])
def test_the_derived_shapes_are_right_to_four_eps_everywhere(K, shape):
    exact = shape(K)
    form = lambdify(lam, exact, "math")

    assert max(relative_error(form, exact, lam, x) for x in GRID + NEAR_ONE) <= 4


@pytest.mark.slow
def test_the_printed_shapes_lose_digits():
    hat, tilde = (lambdify(lam, form, "math") for form in (HAT_PRINTED, TILDE_PRINTED))

    assert max(relative_error(hat, alpha_hat(), lam, x) for x in NEAR_ONE[:2]) > 1e6
    assert max(relative_error(tilde, alpha_tilde(), lam, x) for x in GRID) > 1e3
    with pytest.raises(ZeroDivisionError):
        hat(1.0)
