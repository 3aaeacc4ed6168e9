"""The birth of a branch of cycles at a doubling: where the branch turns, and from which cycle it is born.

The blown-up equations of the cuspless cardioid's doubling prove the branch, and fail where there is none.
"""

from math import pi

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import cuspless, polar
from verification.arithmetic.balls import real_ball, working
from verification.cycles.branch import branch
from verification.cycles.chords import Chords
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.cycles.switching import switched
from verification.cycles.systems import repeats
from verification.named.locate import locate
from verification.proofs.corner import corner_orbit as blown


def test_the_unstable_orbits_of_period_4_are_there_up_to_the_doubling_itself():
    """Up to 0.0933 they are proved interval by interval, and the branch from the doubling overlaps with that."""
    found = blown.doubled_branch()

    assert found is not None
    assert found.unstable is True
    assert found.bend < 0
    assert found.end < 0.0933
    assert found.lam.contains(real_ball(lambda_c(), 20))


def test_the_end_is_the_orbit_that_newtons_method_finds():
    found = blown.doubled_branch()
    assert found is not None
    z = floats(Problem(cuspless, (1, 0, 1, 0), lam=Rational(float(found.end.mid()))), [0.039, -0.024, -0.039, 0.024])

    assert z[0] == pytest.approx(blown.MOST, abs=1e-7)
    assert float(found.m.lower()) < z[1] / z[0] < float(found.m.upper())
    assert z[2:] == pytest.approx([-x for x in z[:2]], abs=1e-12)


def test_the_side_of_the_branch_is_that_of_the_flips_normal_form():
    proof = locate("lambda-c", 10).proof
    found = blown.doubled_branch()

    assert proof.supercritical is False
    assert found is not None
    assert found.bend < 0


def test_at_the_doubling_half_the_orbit_has_the_multiplier_1_once_mirrored():
    with working(blown.BITS):
        trace, determinant = blown.half(arb(0), blown.slope_at_zero(), real_ball(lambda_c(), 30))

        assert (1 - trace + determinant).contains(0)
        assert abs(1 - trace + determinant) < 1e-20


def test_the_quotient_and_the_mean_value_form_meet():
    with working(blown.BITS):
        m, lam = blown.slope_at_zero(), arb(real_ball(lambda_c(), 30).mid())
        exact, wide = blown.divided(arb("0.01"), m, lam), blown.divided(arb("0.005", "0.005"), m, lam)

        assert all(x.overlaps(y) for x, y in zip(exact, wide, strict=True))


def test_the_rate_along_the_branch_is_that_of_a_difference_quotient():
    with working(blown.BITS):
        m, lam = blown.slope_at_zero(), arb(real_ball(lambda_c(), 30).mid())
        small, big = (blown.divided(arb(e), m, lam) for e in ("0.001", "0.002"))
        rates = blown.third_order(arb(0), m, lam)

        for a, b, rate in zip(small, big, rates, strict=True):
            quotient = 2 * (b - a) / (arb("0.002") ** 2 - arb("0.001") ** 2)
            assert abs(quotient - rate) < 1e-4


FLOWER = polar("1 + cos(5*theta)/40")
DOUBLED = np.array([-0.03616626, 2.99116645, 0.03616626, -2.99116645])  # attracts at lam = 0.3
APART = np.array([-0.01148174, 2.90844845, -0.00118988, -2.93650100])  # attracts at lam = 0.9, and is not its mirror


def test_a_doubled_branch_turns_where_the_shorter_cycle_flips_and_says_so():
    one = branch(Chords(FLOWER, (0,) * 4), DOUBLED, "lam", 0.3, (0.1, 0.5))
    shorter = branch(Chords(FLOWER, (0, 0)), np.array([0.0, pi]), "lam", 0.3, (0.1, 0.5))
    (birth,) = one.births
    (flip,) = shorter.events
    (mother,) = switched(one, birth, (0.1, 0.5))

    assert one.events == shorter.births == ()
    assert birth.kind is BifurcationKind.FLIP
    assert birth.value == pytest.approx(flip.value, abs=1e-12)
    assert birth.value <= min(one.values)
    assert mother.at(0.4)[0][:2] == pytest.approx(shorter.at(0.4)[0][:2], abs=1e-9)


def test_a_branch_of_broken_symmetry_turns_at_the_pitchfork_and_never_comes_down_on_the_symmetric_cycle():
    one = branch(Chords(FLOWER, (0,) * 4), APART, "lam", 0.9, (0.5, 1.0))
    (birth,) = one.births

    assert one.events == ()
    assert birth.kind is BifurcationKind.PITCHFORK
    assert birth.value <= min(one.values)
    assert one.values[0] == one.values[-1] == 1.0
    assert not any(repeats(one.system.recurrence, point.z[:-1]) for point in one.points)
