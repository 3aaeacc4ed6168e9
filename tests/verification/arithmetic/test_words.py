"""Every word of the formulas says the same in doubles, arrays, mpmath, balls and series of balls."""

import math

import mpmath
import numpy as np
import pytest
from flint import arb, arb_series
from sympy import Rational, Symbol, atan, cos, cosh, exp, log, sin, sinh, sqrt, tan, tanh

from symbolic.expressions.text import kernel, load
from verification.arithmetic.balls import ARRAYS, FLOAT64, balls, enclose, multiprecision, working
from verification.arithmetic.series import series, taylor

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
        constant, slope, *_ = list(load(made, series(200))(arb_series([balls(200).q(7, 5), 1]))[0])
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


@pytest.mark.parametrize("formula", ["exp(cos(2*theta)/4)", "(2 + cos(theta))^(1/3)", "2 + tanh(sin(theta))"])
def test_a_table_of_any_analytic_formula_flies_to_the_digits_of_its_balls(formula):
    from fractions import Fraction

    from numeric import PinballMap
    from symbolic import tables
    from verification.maps.enclosed import EnclosedMap

    map = PinballMap(tables.polar(formula), lam="9/10")
    enclosed = EnclosedMap(map, Fraction(9, 10), bits=120)
    ball = enclosed.bounce(enclosed.ball(0, Fraction(3, 10), Fraction(1, 5)))
    step = map.step(0.3, 0.2)

    assert ball.x.rad() < 1e-25
    assert abs(float(ball.x) - step.x) <= 8 * 2.0**-52
    assert abs(float(ball.phi) - step.phi) <= 8 * 2.0**-52
