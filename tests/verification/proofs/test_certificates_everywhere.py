"""The paper's attracting and unstable cycles, proved for every contraction of an interval."""

import math

import pytest
from flint import arb
from sympy import Rational

from symbolic.tables import cuspless, egg
from verification.cycles.cascade import attractor, cycle_at, doubled
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.proofs.periodic import triangles
from verification.proofs.periodic.bifurcation import Stability, over_interval
from verification.proofs.periodic.interval_newton import ZeroStatus, krawczyk

EGG = egg(3).at(alpha=Rational(2, 25))
FLAT = [math.pi / 3, math.pi, 5 * math.pi / 3]
VERTEX = [0.0, 2 * math.pi / 3, 4 * math.pi / 3]


@pytest.mark.slow
@pytest.mark.parametrize(("start", "wanted"), [(FLAT, Stability.ATTRACTING), (VERTEX, Stability.SADDLE)])
def test_the_two_triangles_exist_from_the_elastic_end_to_the_fold(start, wanted):
    assert over_interval(EGG, (0, 0, 0), start, (0.999, 0.379), wanted).proved


def test_the_triangles_meet_at_the_fold():
    lam, third = Rational(3781213, 10**7), 2 * math.pi / 3
    starts = ([x + k * third for k in range(3)] for x in (1.54, 1.55))
    near = [floats(Problem(EGG, (0, 0, 0), lam=lam), start) for start in starts]
    gaps = [abs(a - b) for a, b in zip(*near, strict=True)]

    assert 0 < max(gaps) < 2e-3  # like the root of lam - lambda_c = 5e-8


def test_an_attracting_cycle_of_period_4_exists_for_every_small_contraction():
    start = attractor(EGG, 0.2, (0.05, 3.1))

    assert over_interval(EGG, (0,) * 4, start, (0.2, 0.0), Stability.ATTRACTING).proved
    assert over_interval(EGG, (0,) * 4, start, (0.2, 0.28), Stability.ATTRACTING).proved


@pytest.mark.slow
def test_the_unstable_cycle_born_at_lambda_c_lives_down_to_the_corners():
    flip = Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam")
    start, lam = doubled(flip, floats(flip, [0.0, 0.0, 0.0934]), 0.002)

    assert lam < 0.0934  # subcritical: on the side where the period-2 orbit is stable
    assert over_interval(cuspless, (1, 0, 1, 0), start, (lam, 0.0933), Stability.SADDLE).proved
    assert over_interval(cuspless, (1, 0, 1, 0), start, (lam, 0.07122), Stability.SADDLE).proved


@pytest.mark.slow
def test_its_partner_on_the_arc_is_a_saddle_from_the_corners_on():
    corner = [2.0943943, 0.2545256, -2.0943943, -0.2545256]  # lam = 0.07122, from `border.saddles`
    problem = Problem(cuspless, (0,) * 4, lam=Rational(7122, 10**5))
    start = floats(problem, corner)

    assert over_interval(cuspless, (0,) * 4, start, (0.07122, 0.1), Stability.SADDLE).proved


def test_what_is_not_so_is_not_proved():
    start = attractor(EGG, 0.36, (0.05, 3.1))
    found = over_interval(EGG, (0,) * 4, start, (0.36, 0.38), Stability.ATTRACTING, budget=300)

    assert not found.proved
    assert 0.371 < found.reached < 0.3712356  # lambda_3


def test_krawczyk_has_three_answers_too():
    problem = Problem(EGG, (0, 0), lam=Rational(1, 2))
    answers = [
        krawczyk(problem, [arb(0), arb(x)], [r, r], 80).status for x, r in ((3.1415, 0.001), (3.1, 0.001), (3.1, 3))
    ]

    assert answers == [ZeroStatus.UNIQUE, ZeroStatus.EMPTY, ZeroStatus.UNKNOWN]


def test_at_039_the_attractor_has_period_16_and_not_8_as_the_papers_figure_says():
    sixteen = attractor(EGG, 0.39, (0.05, 3.1))
    eight = attractor(EGG, 0.38, (0.05, 3.1))
    for lam in (0.382, 0.384, 0.386, 0.388, 0.389, 0.39):
        eight = cycle_at(EGG, eight, lam)

    assert len(sixteen) == 16
    assert over_interval(EGG, (0,) * 16, sixteen, (0.39, 0.39001), Stability.ATTRACTING).proved
    assert over_interval(EGG, (0,) * 8, eight, (0.39, 0.39001), Stability.SADDLE).proved


def test_the_largest_tilt_is_an_arc_cosine():
    for x in (Rational(0), Rational(2, 25), Rational(1, 2), Rational(-9, 10)):
        assert float(triangles.acos_of(x)) == pytest.approx(math.acos(x))
