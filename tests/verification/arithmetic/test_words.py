"""Each word of the formulas has the same value in doubles, arrays, mpmath, balls and series of balls."""

import math

import mpmath
import numpy as np
import pytest
from flint import acb, acb_series, arb, arb_series, fmpq
from sympy import (
    Abs,
    CRootOf,
    I,
    Integer,
    Rational,
    Symbol,
    acos,
    asin,
    atan,
    cos,
    cosh,
    exp,
    log,
    pi,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from symbolic.expressions.text import kernel, load
from verification.arithmetic.balls import ARRAYS, FLOAT64, as_ball, balls, decimal, enclose, multiprecision, working
from verification.arithmetic.series import Jet, TaylorModel, along, coefficients, in_series, jets, taylor
from verification.proofs.manifolds.enclosed import complex_balls

x = Symbol("x", positive=True)
WORDS = [exp(x), log(x), sqrt(x), sin(x), cos(x), tan(x), atan(x), sinh(x), cosh(x), tanh(x)]
WORDS += [x ** Rational(p, q) for p, q in ((1, 3), (2, 3), (-5, 3), (7, 12))]
HERE = Rational(7, 5)


@pytest.mark.parametrize("expression", WORDS, ids=str)
def test_a_word_has_one_value_in_every_kind_of_number(expression):
    made = kernel("f", [x], {"value": expression})
    context = mpmath.MPContext()
    context.dps = 50
    truth = context.mpf(str(expression.subs(x, HERE).evalf(50)))
    with working(200):
        ball = load(made, balls(200))(balls(200).q(7, 5))[0]
    with working(200), taylor(3):
        words = in_series(balls(200), arb_series)
        constant, slope, *_ = list(load(made, words)(arb_series([balls(200).q(7, 5), 1]))[0])
    with working(200):
        wanted = enclose(expression, {x: HERE}, 50).real
        derivative = enclose(expression.diff(x), {x: HERE}, 50).real

    assert abs(load(made, FLOAT64)(1.4)[0] - truth) <= 8 * math.ulp(float(abs(truth)))
    assert abs(load(made, ARRAYS)(np.array([1.4]))[0][0] - truth) <= 8 * math.ulp(float(abs(truth)))
    assert abs(load(made, multiprecision(context))(context.mpf(7) / 5)[0] - truth) <= abs(truth) * 1e-48
    assert ball.overlaps(wanted)
    assert ball.rad() < 1e-50
    assert constant.overlaps(wanted)
    assert slope.overlaps(derivative)
    assert slope.rad() < arb(1e-40)


@pytest.mark.slow
@pytest.mark.parametrize("formula", ["exp(cos(2*theta)/4)", "(2 + cos(theta))^(1/3)", "2 + tanh(sin(theta))"])
def test_a_table_of_any_analytic_formula_flies_to_the_digits_of_its_balls(formula):
    from fractions import Fraction

    from numeric import PinballMap
    from symbolic import tables
    from verification.maps.enclosed import EnclosedMap

    map = PinballMap(tables.polar(formula), lam="9/10")
    enclosed = EnclosedMap(map, Fraction(9, 10), bits=120)
    ball = enclosed.bounce(enclosed.start(Fraction(3, 10), Fraction(1, 5)))
    step = map.step(0.3, 0.2)

    assert ball.x.rad() < 1e-25
    assert abs(float(ball.x) - step.x) <= 8 * 2.0**-52
    assert abs(float(ball.phi) - step.phi) <= 8 * 2.0**-52


@pytest.mark.parametrize("expression", [*WORDS, x**2 / (1 + x) - 3 / x, (x - 2) * (1 - x) / 7], ids=str)
def test_a_jet_has_the_taylor_coefficients_that_differentiation_gives(expression):
    """Five coefficients of `f(g(e))`, for `g(e) = 7/5 + e/2 - e**2/3 + 2*e**3 - e**4`, from SymPy's derivatives."""
    e = Symbol("e")
    inner = [Rational(7, 5), Rational(1, 2), Rational(-1, 3), Rational(2), Rational(-1)]
    outer = [expression.diff(x, k).subs(x, inner[0]) / math.factorial(k) for k in range(5)]
    away = sum(c * e**k for k, c in enumerate(inner) if k)
    whole = sum(c * away**k for k, c in enumerate(outer)).expand()
    with working(160):
        ball = balls(160)
        made = load(kernel("f", [x], {"value": expression}), jets(ball))
        found = made(Jet(*(ball.q(int(c.p), int(c.q)) for c in inner)))[0]

        at = Jet(*(ball.q(int(c.p), int(c.q)) for c in inner))
        again_made = load(kernel("f", [x], {"value": expression}), in_series(ball, arb_series))
        (again,) = along([at], lambda near: again_made(*near))
        assert len(found.c) == len(again.c) == 5
        for k, (c, d) in enumerate(zip(found.c, again.c, strict=True)):
            true = enclose(whole.coeff(e, k), digits=40).real
            assert c.overlaps(true)
            assert d.overlaps(true)
            assert max(c.rad(), d.rad()) < 1e-35


@pytest.mark.parametrize("word", ["sqrt", "log", "atan"])
def test_a_series_over_complex_balls_has_no_coefficient_where_a_cut_may_pass_through(word):
    """A ball that meets the cut, and one beyond it, on another sheet of the function; off the cut there are values."""
    words, one = in_series(complex_balls(100), acb_series), acb(arb(0, 1), arb(0, 1))
    beyond = acb(0, 2) if word == "atan" else acb(-1, 0)

    def expanded(at):
        (found,) = along([Jet(at, acb(1), acb(0))], lambda near: [getattr(words, word)(near[0])])
        return found.c

    for at in (beyond + one, beyond * 3 + acb(1, 1) / 4):
        assert not any(c.is_finite() for c in expanded(at))
    first, *rest = expanded(acb(arb(2), arb(1) / 4))
    assert first.overlaps(getattr(acb(arb(2), arb(1) / 4), word)())
    assert all(c.is_finite() for c in rest)


def test_coefficients_end_where_a_series_is_known_no_farther():
    with taylor(4):
        quotient = arb_series([0, 6, 4, 2]) / arb_series([0, 2])
        assert quotient.prec == 3
        known, lost = coefficients(quotient, 3), coefficients(quotient, 5)
    assert [float(x) for x in known] == [3, 2, 1]
    assert [float(x) for x in lost[:3]] == [3, 2, 1]
    assert not any(x.is_finite() for x in lost[3:])
    assert len(lost) == 5


def test_a_coefficient_that_a_division_lost_is_none_and_not_zero():
    """The third coefficient of `(e + e**2 + ...)/e` needs the fourth of the dividend, which is unknown."""
    zero, one = arb(0), arb(1)
    (found,) = along([Jet(zero, one, one), Jet(zero, one, zero)], lambda near: [near[0] / near[1]])
    assert found.c[:2] == (1, 1)
    assert not found.c[2].is_finite()


def test_an_expansion_bounds_the_function_its_slope_and_its_integral():
    """For polynomials with known coefficients, of which the last may be any number of a ball."""
    random = np.random.default_rng(1)
    for _ in range(20):
        c, low, high = random.uniform(-1, 1, 5), -random.uniform(0.1, 2), random.uniform(0.1, 2)
        spread = 0.01
        held = TaylorModel(arb(low), arb(high), (*map(arb, c[:4]), arb(c[4], spread)))
        at = np.linspace(low, high, 201)
        for last in (c[4] - spread, c[4], c[4] + spread):
            f = np.polynomial.Polynomial([*c[:4], last])
            assert max(abs(f(at))) <= held.size() * (1 + 1e-12)
            assert max(abs(f.deriv()(at))) <= held.slope() * (1 + 1e-12)
            assert abs(float(held.integral().mid()) - (f.integ()(high) - f.integ()(low))) <= held.integral().rad()
        farthest = max(-low, high)
        assert float(held.size()) == pytest.approx(sum((abs(c) + np.eye(5)[4] * spread) * farthest ** np.arange(5)))
        known = sum(c[k] * (high ** (k + 1) - low ** (k + 1)) / (k + 1) for k in range(4))
        rest = (abs(c[4]) + spread) * (high**5 - low**5) / 5
        assert float(abs(held.integral() - known).upper()) == pytest.approx(rest)


EXACT = {  # a closed form, and the same number by another way
    Abs(Integer(-3)) + I: (3, 1),
    (1 + 2 * I) * (3 - I): (5, 5),
    cos(pi / 3, evaluate=False) * 2: (1, 0),
    tan(pi / 4, evaluate=False) ** -3: (1, 0),
    acos(Rational(1, 2), evaluate=False) / pi - asin(Rational(1, 2), evaluate=False) / pi: ("1/6", 0),
    sqrt(Rational(9, 4), evaluate=False) ** 3: ("27/8", 0),
    Integer(8) ** Rational(1, 3): (2, 0),
    CRootOf(x**3 - 2, 0) ** 3: (2, 0),
    exp(log(Integer(5), evaluate=False), evaluate=False): (5, 0),
}


@pytest.mark.parametrize("number", EXACT, ids=str)
def test_an_exact_expression_is_enclosed_with_the_digits_asked_for(number):
    real, imaginary = (fmpq(*map(int, f"{part}/1".split("/")[:2])) for part in EXACT[number])
    for digits in (10, 60):
        found = enclose(number, digits=digits)
        assert found.overlaps(acb(arb(real), arb(imaginary)))
        assert found.real.rad() < arb(10) ** -digits
    assert enclose(x + 1, {x: number}).overlaps(enclose(number) + 1)


def test_what_has_no_enclosure_is_refused_by_name():
    with pytest.raises(ValueError, match="no enclosure is known for Symbol in x"):
        enclose(x)


@pytest.mark.parametrize("number", ["0.1", "-12345.678", "2e-30", "-1e20", "0"])
def test_decimals_hold_the_ball_that_they_say(number):
    for radius in ("0", "1e-3", "1e-25"):
        with working(300):
            value = arb(number, radius)
            shown, bound = decimal(value, 20)
            again = arb(shown, bound)
            assert again.contains(value)
            assert again.rad() <= arb("1.25") * arb(radius) + abs(arb(number)) * arb("2e-19")


def test_an_mpmath_number_becomes_the_ball_of_the_same_bits():
    context = mpmath.MPContext()
    context.prec = 120
    with working(200):
        for value in (context.mpf(1) / 3, -(context.mpf(10) ** 30) / 7, context.mpf(0), context.mpf(-5) / 1024):
            ball = as_ball(value)
            assert ball.is_exact()
            assert context.mpf(ball.str(60, radius=False)) == pytest.approx(value, rel=1e-35)
