"""Laws on the blown-up doubling of the cuspless cardioid: it proves the branch, and fails where there is none."""

import pytest
from flint import arb
from sympy import Rational

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import cuspless
from verification.arithmetic.balls import real_ball, working
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.named.locate import locate
from verification.proofs.corner import corner_orbit as blown


def test_the_unstable_orbits_of_period_4_are_there_up_to_the_doubling_itself():
    """The last contraction overlaps with what is proved interval by interval, up to 0.0933."""
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


def test_nothing_is_proved_with_a_box_off_the_branch_or_too_wide_a_range(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(blown, "MOST", 0.3)
    assert blown.doubled_branch() is None
    monkeypatch.undo()
    monkeypatch.setattr(blown, "lambda_c", lambda: Rational(1, 5))
    assert blown.doubled_branch() is None
