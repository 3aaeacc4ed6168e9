"""The crises by sampling: nothing leaves below, more and more above, and a finer search stays within the error."""

import math

import pytest

from verification.crises import KINDS, crisis, spread, stay


@pytest.mark.parametrize(("kind", "below", "above"), [("merging", 0.443, 0.4445), ("boundary", 0.655, 0.666)])
def test_balls_stay_below_a_crisis_and_leave_sooner_the_farther_above(kind, below, above):
    left, (_, high) = KINDS[kind]

    assert math.isinf(stay(left, "0.08", below, 10**6))
    assert stay(left, "0.08", high, 10**7) < math.inf
    assert stay(left, "0.08", above, 10**7) < math.inf


def test_a_finer_search_stays_within_the_error_of_a_coarser_one():
    coarse, fine = (crisis("merging", "0.08", tolerance, 10**7) for tolerance in (2e-4, 2e-5))

    assert abs(coarse.lam - fine.lam) <= coarse.error
    assert fine.error < coarse.error


def test_the_error_reaches_up_to_where_ten_balls_left():
    assert spread([(0.5, 10.0), (0.45, 1e9)], 0.44, 0.45, 10**7) == pytest.approx(0.055)


def test_a_shape_without_the_crisis_is_one_sentence():
    with pytest.raises(ValueError, match=r"known at 0\.08"):
        crisis("boundary", "0.03", budget=10**6)
