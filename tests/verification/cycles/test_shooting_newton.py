"""Shooting to many digits: quadratic, of the digits asked for, and without a trace in the ambient context."""

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
from verification.cycles.critical import Small, corner
from verification.cycles.newton import ROUNDINGS, floats, levels, refined
from verification.cycles.problem import LONG, Linearised, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.named.locate import certify

EGG = egg(3).at(alpha=Rational(2, 25))


def flip() -> Problem:
    return Problem(egg(3), (0, 0), BifurcationKind.FLIP, "alpha", Rational(1, 3))


def test_corrections_shrink_quadratically():
    steps = refined(corner(), [0.25, 0.07], 300).steps
    tail = [s for s in steps if s.correction < -20]

    assert len(tail) >= 3
    for one, two in pairwise(tail):
        assert two.correction < max(1.9 * one.correction, -0.9 * one.digits)  # or to the rounding


@pytest.mark.parametrize(
    ("system", "start"), [(corner(), [0.25, 0.07]), (flip(), [0.0, 3.14, 0.07])], ids=["corner", "flip"]
)
def test_middles_of_balls_are_mpmaths_numbers_up_to_their_rounding(system, start):
    one, other = (refined(system, start, 50, in_balls) for in_balls in (True, False))

    assert [s.digits for s in one.steps] == [s.digits for s in other.steps]
    for a, b in zip(one.z, other.z, strict=True):
        assert a.context.dps == b.context.dps
        assert abs(a - b) <= ROUNDINGS * one.condition * one.unit
    assert one.steps[-1].correction == pytest.approx(other.steps[-1].correction, abs=3)


def test_balls_that_are_too_wide_give_way_to_mpmath():
    """Corrections whose balls say less than a float64 does, and whose numbers are those of another run bit for bit."""

    class Wide(Small):
        def newton(self, arithmetic, z):
            asked.append(type(z[0]) is arb)
            wide = arb(0, 2.0**-40) if asked[-1] else 0
            return [x + wide for x in super().newton(arithmetic, z)]

    asked, plain = [], corner()
    found = refined(Wide(plain.label, plain.equations), [0.25, 0.07], 50, in_balls=True)

    assert found.z == refined(plain, [0.25, 0.07], 50).z
    assert {True, False} == set(asked)


@pytest.mark.parametrize("digits", [1, 16, 17, 50, 333])
def test_precision_doubles_up_to_the_digits_asked_for(digits):
    found = levels(digits + 15)

    assert found[-1] == digits + 15
    assert all(b <= 2 * a for a, b in pairwise(found))


def test_two_precisions_agree_in_the_digits_of_the_coarser():
    coarse, fine = (refined(flip(), [0.0, 3.14, 0.06], digits).z[-1] for digits in (40, 90))

    assert abs(coarse - fine) < mpmath.mpf(10) ** -40


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
    *cycle, lam_3 = next_critical(EGG, theta, 0.36, 0.005, BifurcationKind.FLIP)

    assert abs(lam_3 - 0.371235502528) < 1e-11
    assert abs(characteristic(EGG, cycle, lam_3, BifurcationKind.FLIP)) < 1e-9


@pytest.mark.parametrize("lam", ["1/3", "1"])
def test_a_diameter_whose_ends_are_the_centres_of_curvature_of_each_other_is_proved(lam):
    """The ellipse's minor axis at a = sqrt(2): its linearised rules are regular, and no bounce moves its own."""
    axis = Problem(ellipse.at(a=sqrt(2)), (0, 0), lam=Rational(lam))
    proof = certify(axis, [float(pi) / 2, -float(pi) / 2], 20)

    assert all(proof.checks.values())
    with working(100):
        assert abs(proof.enclosure.zero[0] - arb.pi() / 2) < 1e-20


def test_two_rows_with_a_small_pivot_are_solved_from_both_sides():
    """Exactly, as the matrix and its transpose say: [[0, 3], [4, 5]], with signs of vectors that come back negated."""
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
