"""The slap map of the cardioid in half angles: exact facts and second derivations."""

import cmath
import math
from fractions import Fraction

import mpmath
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from sympy import Rational, simplify, sqrt

from symbolic.cycles.cardioid_slap import (
    RATE,
    SHRINKS,
    branch,
    derived,
    expands,
    flown,
    gentle_elsewhere,
    lands_first,
    q,
    quiet_near_the_cusp,
)
from symbolic.expressions.signs import Outcome
from symbolic.expressions.text import load
from verification.arithmetic.balls import multiprecision

FACTS = (lands_first, derived, expands, quiet_near_the_cusp, gentle_elsewhere)
LANDINGS = st.fractions(Fraction(-156, 100), Fraction(78, 100), max_denominator=1000)


def test_every_fact_that_the_variation_needs_is_proved():
    assert [fact().outcome for fact in FACTS] == [Outcome.PROVED] * len(FACTS)


@pytest.mark.parametrize("launch", [0.3, 1.0, 1.7, 2.4, 3.0])
def test_a_landing_lies_as_far_along_the_normal_as_its_projection(launch):
    z, normal = (1 + math.cos(launch)) * cmath.exp(1j * launch), -cmath.exp(1.5j * launch)

    assert flown(math.cos(launch / 2)) == pytest.approx(((2 - z) * normal.conjugate()).real, abs=1e-14)


@pytest.mark.slow
@given(LANDINGS)
def test_both_forms_of_the_launching_point_are_the_one_whose_cosine_is_proved_and_the_rate_their_derivative(landing):
    mp = mpmath.MPContext()
    mp.dps = 40
    words = multiprecision(mp)
    below, above = (load(branch(form), words) for form in (False, True))
    half = mp.mpf(landing.numerator) / landing.denominator
    slope = mp.diff(lambda x: below(x)[0], half)
    at = mp.sin(half) / mp.sqrt(1 + 7 * mp.cos(half) ** 2)
    cos2 = (1 - 3 * at) ** 2 * (1 - at) / ((1 + 7 * at**2) * (3 - at))

    assert abs(below(half)[0] - above(half)[0]) < mp.mpf(10) ** -35
    assert abs(mp.cos(below(half)[0]) ** 2 - cos2) < mp.mpf(10) ** -35
    assert abs(slope - below(half)[1]) < mp.mpf(10) ** -15


@pytest.mark.slow
@given(st.fractions(Fraction(1, 50), Fraction(3135, 1000), max_denominator=1000))
@example(Fraction(31, 10))  # near the cusp the normal meets the boundary at two points behind
def test_of_all_points_on_the_normal_one_is_ahead_and_it_is_the_landing(angle):
    mp = mpmath.MPContext()
    mp.dps = 40
    start = mp.mpf(angle.numerator) / angle.denominator
    u, inward = mp.expj(start), -mp.expj(3 * start / 2)
    roots = mp.polyroots([1, 2 + u, u * (2 * u + 1), u**2], maxsteps=500, extraprec=400)
    met = [U for U in roots if abs(abs(U) - 1) < mp.mpf(10) ** -25]
    (ahead,) = (U for U in met if mp.re(((1 + U) ** 2 - (1 + u) ** 2) / inward) > 0)
    launch, _ = load(branch(False), multiprecision(mp))(mp.arg(ahead) / 2)

    assert len(met) == 3 or angle < 3
    assert abs(launch - start / 2) < mp.mpf(10) ** -20


def test_the_slope_in_half_angles_is_least_at_a_quadratic_number_and_above_the_bound_there():
    at = 3 - 8 / sqrt(7)

    assert simplify(RATE.diff(q).subs(q, at)) == 0
    assert 1 / SHRINKS < 1 / RATE.subs(q, at) < Rational(12, 10)
