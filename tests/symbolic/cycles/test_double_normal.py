"""Every cycle of period 2 depends on one number `P`: the trace formula and its consequences for stability."""

from fractions import Fraction

import mpmath
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Rational, S, Symbol, simplify

from symbolic.cycles.cycle import (
    cardioid_vertical,
    cuspless_horizontal,
    diameter,
    discriminant,
    egg_diameter,
    egg_parallel,
    major_axis,
    minor_axis,
    trace_and_determinant,
)
from symbolic.cycles.thresholds import (
    flip_contraction,
    focus_contraction,
    general_trace_and_determinant,
    stability_number,
    trace_of,
)
from symbolic.tables.table import K0, K1, a, alpha, lam, t

mp = mpmath.MPContext()
mp.dps = 60
NOTHING = mp.mpf(10) ** -40
CONTRACTIONS = st.fractions(0, 1, max_denominator=40).filter(lambda value: value < 1)
P_OF = {
    "circle": (diameter(), S.One),
    "major": (major_axis(), (1 - 2 * a**2) ** 2),
    "minor": (minor_axis(), (1 - 2 / a**2) ** 2),
    "cardioid": (cardioid_vertical(), Rational(25, 16)),  # t = 3*sqrt(3)/2, K = -sqrt(3)/2
    "cuspless": (cuspless_horizontal(), Rational(-11, 16)),  # t = 9/4, K = 0 and -3/4
    "egg": (
        egg_diameter(),
        (1 - 2 * (1 + 10 * alpha) / (1 + alpha) ** 2) * (1 - 2 * (1 - 10 * alpha) / (1 - alpha) ** 2),
    ),
}


def exact(value: Fraction) -> Rational:
    return Rational(value.numerator, value.denominator)


def eigenvalues(P: Rational, contraction: Rational) -> list:
    matrix_trace, det = trace_of(P, contraction), contraction**2
    return mp.polyroots(
        [1, -mp.mpf(matrix_trace.p) / matrix_trace.q, mp.mpf(det.p) / det.q], maxsteps=500, extraprec=400
    )


def test_the_trace_of_any_double_normal_depends_on_its_stability_number_alone():
    trace, det = general_trace_and_determinant()

    assert simplify(trace - (1 + lam) ** 2 * (1 + t * K0) * (1 + t * K1) + 2 * lam) == 0
    assert simplify(trace - trace_of((1 + t * K0) * (1 + t * K1))) == 0
    assert simplify(det - lam**2) == 0


@pytest.mark.parametrize("name", P_OF)
def test_stability_numbers_are_those_of_a_hand_calculation(name):
    cycle, P = P_OF[name]

    assert simplify(stability_number(cycle) - P) == 0


@pytest.mark.slow
@pytest.mark.parametrize("cycle", [P_OF[name][0] for name in P_OF] + [egg_parallel()], ids=lambda c: c.name)
def test_the_trace_formula_agrees_with_the_monodromy(cycle):
    trace, _ = trace_and_determinant(cycle)

    assert simplify(trace - trace_of(stability_number(cycle))) == 0


@pytest.mark.slow
@settings(max_examples=60)
@given(st.fractions(-3, 3, max_denominator=30), CONTRACTIONS)
@example(Fraction(1), Fraction(1, 2))
@example(Fraction(-1, 9), Fraction(1, 2))
@example(Fraction(-1), Fraction(0))
@example(Fraction(0), Fraction(0))
def test_both_multipliers_are_inside_the_unit_circle_exactly_for_P_in_the_window(P, contraction):
    stable = -(((1 - contraction) / (1 + contraction)) ** 2) < P < 1
    largest = max(abs(mu) for mu in eigenvalues(exact(P), exact(contraction)))

    assert (largest < 1 - NOTHING) == stable


def test_a_multiplier_is_minus_one_at_the_flip_contraction():
    r = Symbol("r", positive=True)
    contraction = flip_contraction(-(r**2))

    assert simplify(1 + trace_of(-(r**2), contraction) + contraction**2) == 0
    assert simplify(r**2 - ((1 - contraction) / (1 + contraction)) ** 2) == 0


def test_the_multipliers_coincide_at_the_focus_contraction():
    w = Symbol("w", positive=True)
    contraction = focus_contraction(1 - w**2)

    assert simplify(discriminant(trace_of(1 - w**2, contraction), contraction**2)) == 0
    assert simplify(1 - w**2 - 4 * contraction / (1 + contraction) ** 2) == 0
