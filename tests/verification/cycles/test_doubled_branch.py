"""The birth of a branch of cycles at a doubling: where the branch turns, and from which cycle it is born.

The blown-up equations of the cuspless cardioid's doubling prove the branch, and fail where there is none.
"""

from math import pi

import numpy as np
import pytest
from sympy import Rational

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import cuspless, polar
from verification.arithmetic.balls import real_ball
from verification.cycles.branch import branch
from verification.cycles.chords import Chords
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.cycles.switching import switched
from verification.cycles.systems import repeats
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
