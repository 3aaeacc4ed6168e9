"""Shooting to many digits converges quadratically to the requested digits, and leaves the ambient context unchanged."""

from dataclasses import replace
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import arb
from sympy import Rational, pi, sqrt

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables import egg, ellipse
from symbolic.tables.table import lam
from verification.arithmetic.balls import FLOAT64, working
from verification.cycles.cascade import attractor, characteristic, next_critical
from verification.cycles.chain import Chain, by_cramer
from verification.cycles.critical import corner
from verification.cycles.newton import floats, refined
from verification.cycles.problem import LONG, Linearised, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.named.locate import proof_near

EGG = egg(3).at(alpha=Rational(2, 25))


def flip() -> Problem:
    return Problem(egg(3), (0, 0), BifurcationKind.FLIP, "alpha", Rational(1, 3))


def test_corrections_shrink_quadratically():
    steps = refined(corner(), [0.25, 0.07], 300).steps
    tail = [s for s in steps if s.correction < -20]

    assert len(tail) >= 3
    for one, two in pairwise(tail):
        assert two.correction < max(1.9 * one.correction, -0.9 * one.digits)  # or to the rounding


def test_a_flip_found_by_shooting_is_the_closed_form():
    found = refined(flip(), [0.0, 3.14, 0.06], 50).z[-1]
    exact = alpha_tilde().subs(lam, Rational(1, 3)).evalf(60)

    assert mpmath.nstr(found, 50) == str(exact.evalf(50))


def test_the_ambient_precision_is_neither_read_nor_changed():
    before = mpmath.mp.dps
    found = refined(corner(), [0.25, 0.07], 60).z[1]

    assert mpmath.mp.dps == before
    assert mpmath.nstr(found, 60).startswith("0.0712172452489159804115973829093275734858541598")


def test_a_start_out_of_reach_is_a_sentence():
    with pytest.raises(ValueError, match="egg, period 3: Newton's method in float64 did not settle"):
        floats(Problem(EGG, (0, 0, 0), lam=Rational(1, 10)), [0.0, 2.0, 4.0])


def test_an_attractor_of_the_egg_is_a_cycle_of_the_chord_system():
    cycle = attractor(EGG, 0.36, (0.05, 3.1))
    again = floats(Problem(EGG, (0,) * 4, lam=Rational(9, 25)), cycle)

    assert len(cycle) == 4
    assert max(abs(x - y) for x, y in zip(cycle, again, strict=True)) < 1e-6


def test_a_followed_cycle_has_the_multiplier_it_was_followed_to():
    theta = attractor(EGG, 0.36, (0.05, 3.1))
    *cycle, lam_3 = next_critical(EGG, theta, 0.36, 0.005)

    assert abs(lam_3 - 0.371235502528) < 1e-11
    assert abs(characteristic(EGG, cycle, lam_3)) < 1e-9


@pytest.mark.parametrize("lam", ["1/3", "1"])
def test_a_diameter_whose_ends_are_the_centres_of_curvature_of_each_other_is_proved(lam):
    """The ellipse's minor axis at a = sqrt(2): the linear system is regular although its diagonal vanishes."""
    axis = Problem(ellipse.at(a=sqrt(2)), (0, 0), lam=Rational(lam))
    proof = proof_near(axis, [float(pi) / 2, -float(pi) / 2], 20)

    assert all(proof.checks.values())
    with working(100):
        assert abs(proof.enclosure.zero[0] - arb.pi() / 2) < 1e-20


def test_two_rows_with_a_small_pivot_are_solved_from_both_sides():
    """The matrix [[0, 3], [4, 5]] and its transpose, exactly; vectors may come back negated."""
    for sign in (1, -1):
        chain = Chain([Rational(1), Rational(3)], [Rational(0), Rational(5)], [Rational(2), Rational(1)], sign)
        x = [Rational(7), Rational(11)]
        rows = [chain.times(one) for one in ([1, 0], [0, 1])]  # the columns

        assert by_cramer(chain, chain.times(x)) == x
        assert by_cramer(chain, [sum(a * b for a, b in zip(row, x, strict=True)) for row in rows], True) == x


def test_a_long_ring_in_arrays_has_the_equations_of_its_bounces_one_by_one():
    n = LONG
    problem = Problem(EGG, (0,) * n, BifurcationKind.FLIP, "lam")
    z = [*np.sort(np.random.default_rng(1).uniform(-3, 3, n)).tolist(), 0.4]
    long, short = Linearised(problem, FLOAT64, z), Linearised(problem, replace(FLOAT64), z)  # no longer the same object
    one, other = ([long.value, long.row, long.column], [short.value, short.row, short.column])
    for found, expected in zip(one, other, strict=True):
        assert np.allclose(found, expected, rtol=1e-9, atol=0)
        assert all(isinstance(x, float) for x in found)
