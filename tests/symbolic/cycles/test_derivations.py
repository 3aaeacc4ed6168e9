"""The derivations offered by `symbolic`: the paper's formulas from one call each, and the code generated from them."""

import re
from fractions import Fraction
from functools import cache
from time import process_time

import flint
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Integral, Rational, Symbol, latex, pi, simplify, sqrt

import symbolic
from numeric import PinballMap
from symbolic import (
    a,
    alpha,
    curvature,
    derivative_matrix,
    double_normals,
    generate,
    lam,
    monodromy,
    multipliers,
    tables,
    theta,
    theta0,
    theta1,
    thresholds,
)
from symbolic.cycles.thresholds import alpha_tilde, flip_contraction, focus_contraction, lambda_c, lambda_minus

PEA = tables.polar("1 + b*cos(2*theta)", b="0:1/5")
B = PEA.shapes[0].symbol


def test_the_axes_of_the_ellipse_have_the_paper_s_threshold():
    long, short = double_normals("ellipse")

    assert thresholds(long) == {"flip": None, "focus": None}
    assert thresholds(short)["flip"] is None
    assert simplify((thresholds(short)["focus"] - lambda_minus()).subs(a, Rational(7, 3))) == 0


def test_the_egg_s_diameter_flips_on_the_paper_s_curve():
    (diameter,) = double_normals("egg")
    there = thresholds(diameter)["flip"].subs(alpha, alpha_tilde().subs(lam, Rational(1, 3)))

    assert abs(there.evalf(30) - Rational(1, 3)) < Rational(1, 10**25)


@pytest.mark.parametrize("b", [Rational(4, 11), Rational(1, 10), Rational(0), Rational(1, 2)])
def test_a_threshold_over_a_range_of_shapes_is_that_of_each_shape(b):
    """At 4/11 the stability number is 0, and a form with a rational denominator would be 0/0."""
    family = tables.polar("1 + b*cos(4*theta)/12", b="0:1/2")
    of_all = thresholds(double_normals(family)[1])["focus"].subs(family.shapes[0].symbol, b)
    own = [thresholds(cycle)["focus"] for cycle in double_normals(family.at(b=str(b)))]

    assert any(one is not None and simplify(of_all - one) == 0 for one in own)


def test_a_chord_ends_at_the_near_side_of_a_hole():
    table = tables.piecewise(*tables.polygon((2, 0), (-1, 2), (-1, -2)).components, tables.disc("d", (0, 0), "1/4"))
    assert [cycle.length(0) for cycle in double_normals(table)] == [Rational(3, 4)]


def test_the_cuspless_threshold_is_a_number():
    assert thresholds(double_normals("cuspless")[0]) == {"flip": lambda_c(), "focus": None}


@pytest.mark.parametrize("P", [Rational(361, 121), Rational(0), Rational(1, 2), Rational(-5)])
def test_there_is_no_flip_but_for_numbers_from_minus_one_to_zero(P):
    assert flip_contraction(P) is None


@pytest.mark.parametrize("P", [Rational(25), Rational(-1, 4), Rational(-5)])
def test_there_is_no_focus_but_for_numbers_from_zero_to_one(P):
    assert focus_contraction(P) is None


def test_multipliers_are_those_of_the_monodromy_matrix():
    for cycle in double_normals(PEA):
        M = monodromy(cycle)
        for mu in multipliers(cycle):
            point = {B: Rational(1, 7), lam: Rational(1, 2)}
            assert abs((mu**2 - M.trace() * mu + M.det()).subs(point).evalf(30)) < Rational(1, 10**20)


def test_letters_are_greek_from_whatever_function_they_come():
    shown = latex(monodromy(double_normals("egg")[0]) * 2)

    assert r"\lambda" in shown
    assert r"\alpha" in shown
    assert "lam" not in shown.replace(r"\lambda", "")


@pytest.mark.parametrize("text", ["1/5", "1:0", "x:1", "0..1"])
def test_a_range_is_two_numbers_in_order(text):
    with pytest.raises(ValueError, match="b"):
        tables.polar("1 + b*cos(2*theta)", b=text)


def test_a_family_is_a_table_over_all_of_its_range():
    with pytest.raises(ValueError, match="is not positive at"):
        tables.polar("1 + b*cos(2*theta)", b="0:3/2")


@given(st.floats(-3, 3), st.fractions("0", "1/5", max_denominator=100))
def test_generated_code_agrees_over_arrays_mpmath_and_balls(at, b):
    kappa = curvature(PEA)
    by = {kind: generate(kappa, kind)(at, b) for kind in ("numpy", "mpmath", "arb")}
    exact = kappa.subs({theta: Rational(at), B: Rational(b.numerator, b.denominator)}).evalf(40)

    assert abs(by["numpy"] - float(exact)) <= 1e-13 * abs(float(exact))
    assert abs(by["mpmath"] - exact) <= abs(exact) * Rational(1, 10**38)
    assert by["arb"].overlaps(flint.arb(str(exact), str(abs(exact) * Rational(1, 10**36))))


TABLES = {"circle": {}, "ellipse": {"a": "3/2"}, "cardioid": {}, "egg": {"alpha": "2/25"}}


@cache
def matrix(name):
    """The generated function of the symbolic matrix; it takes seconds to derive, so no test file loads with it."""
    return generate(derivative_matrix(tables.named(name).at(**TABLES[name])), "mpmath", digits=30)


@given(st.sampled_from(sorted(TABLES)), st.floats(-3, 3), st.floats(-1.4, 1.4), st.sampled_from(["0.3", "0.95"]))
def test_the_numeric_jacobian_is_the_symbolic_matrix_along_the_chord(name, at, phi, contraction):
    map = PinballMap(name, lam=contraction, **TABLES[name])
    step = map.step(at, phi)
    if step.code != 0 or np.cos(step.eta) < 1e-2:
        return
    expected = np.array(matrix(name)(at, float(step.theta), contraction).tolist(), dtype=float)

    assert np.allclose(map.derivative(at, phi), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("kind", ["numpy", "mpmath", "arb"])
@pytest.mark.parametrize("b", ["1/3", Rational(1, 3), Fraction(1, 3), pi / 10, sqrt(2) / 6], ids=str)
def test_generated_code_takes_exact_numbers(kind, b):
    exact = curvature(PEA).subs({theta: 2, B: b}).evalf(40)

    assert abs(Rational(str(generate(curvature(PEA), kind, digits=30)(2, b)).strip("[").split()[0]) / exact - 1) < 1e-14
    assert generate(lam, "arb", digits=30)("0.1") != generate(lam, "arb", digits=30)(0.1)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: monodromy(double_normals(PEA)[0], contraction=0.5), "contraction = 0.5 is a rounded float; write it"),
        (
            lambda: derivative_matrix("egg", lam=0.5),
            "lam = 0.5 is a rounded float; write it exactly, as the text '0.5'",
        ),
        (lambda: thresholds("egg"), "thresholds: 'egg' is no exact cycle; accepted: a Cycle, such as one of double_"),
        (lambda: monodromy(PEA), r"monodromy: polar('b*cos(2*theta) + 1', b='0:1/5') is no exact cycle"),
        (lambda: generate(symbolic.perimeter(PEA), "arb"), "generate: an expression with an integral or an elliptic"),
        (
            lambda: generate(lam + Symbol("lam")),
            "generate: two different symbols are called lam; use one throughout, such as",
        ),
        (lambda: generate(theta * lam)(0), "missing a required argument: 'lam'; its arguments are: theta, lam"),
        (lambda: tables.polar("1 + cos(theta)/9", c="0:1"), "polar: the formula has no letter c; it has: none"),
        (lambda: tables.polar("1 + c*cos(theta)"), "or a letter of your own: c='LOW:HIGH' in Python"),
    ],
)
def test_what_is_no_answer_is_one_sentence(ask, said):
    with pytest.raises((ValueError, TypeError), match=re.escape(said)):
        ask()


def test_the_slap_map_of_the_circle_goes_to_the_other_side():
    slap = symbolic.slap_map("circle")

    assert simplify(slap.residual.subs(theta1, theta0 + pi)) == 0
    assert simplify(slap.derivative.subs(theta1, theta0 + pi)) == 1
    assert repr(slap) == "SlapMap(circle: residual and derivative in theta0, theta1)"


def test_lengths_and_areas_are_the_closed_forms():
    assert symbolic.perimeter("cardioid") == 8
    assert simplify(symbolic.area("cuspless") - (15 * sqrt(3) / 16 + pi)) == 0
    assert symbolic.arc_length("circle").subs(theta, pi) == 2 * pi


@pytest.mark.parametrize(
    "rho", ["1 + cos(3*theta)/20 + cos(2*theta)/40", "1 + cos(5*theta)/40", "1 + exp(cos(theta))/9"]
)
def test_a_length_without_closed_form_is_one_integral_at_once(rho):
    table = tables.polar(rho)
    began, length = process_time(), symbolic.arc_length(table)

    assert process_time() - began < 2
    assert isinstance(length, Integral)
    assert abs(length.subs(theta, pi).evalf(20) - PinballMap(table).arclength.perimeter) < 1e-13
