"""The border collision at the corner orbit: the prediction beside the map."""

import pytest

from verification.arithmetic import FLOAT64
from verification.border import Border, sampled
from verification.certificates.corner import at_corner
from verification.locate import locate
from verification.shooting.newton import floats
from verification.shooting.small import corner

BORDER = Border()


def test_both_sides_expand_so_no_cycle_there_is_stable():
    for out, back in zip(BORDER.out.values(), BORDER.back.values(), strict=True):
        half = [[sum(-back[2 * i + k] * out[2 * k + j] for k in (0, 1)) for j in (0, 1)] for i in (0, 1)]
        trace, determinant = half[0][0] + half[1][1], half[0][0] * half[1][1] - half[0][1] * half[1][0]

        assert abs(trace) > 1 + determinant  # a real multiplier outside the unit circle


def test_the_kink_of_s4_moves_as_the_one_sided_derivatives_say():
    theta1, lam = floats(corner(), [0.2545, 0.0712])
    exact = at_corner(FLOAT64, theta1, lam)
    balls_of_it = locate("lambda-star", 15)

    assert exact.minimum_at_kink
    assert abs(exact.descent + 1.68078633425) < 1e-9
    assert balls_of_it.checks["s4_dips_below"]
    assert balls_of_it.checks["unstable"]


def test_an_orbit_is_carried_away_below_and_kept_above():
    assert BORDER.attractor(-1, 5000) is None
    assert BORDER.attractor(1, 5000) is not None


def test_the_exponent_is_positive_as_soon_as_the_attractor_exists():
    assert abs(BORDER.attractor(1, 100_000).exponent - 0.2525) < 2e-3  # the scatter of 1e5 returns


@pytest.mark.parametrize("e", [1e-4, 1e-6])
def test_the_size_of_the_attractor_is_the_predicted_multiple_of_the_distance(e):
    low, high = sampled(e, 20_000)
    predicted = BORDER.attractor(1, 50_000)

    assert abs(low - predicted.lowest) < 0.02  # an end of the attractor is met in 1e4 returns to about 1 %
    assert abs(high - predicted.highest) < 0.02
