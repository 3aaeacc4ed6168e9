"""The mean stay above a homoclinic crisis, in passages of the saddle."""

import math

import numpy as np
import pytest

from verification.proofs.manifolds.known import exponent, homoclinic_exponent, log_stay, unit

SADDLES = [(0.20493, 3.65592), (0.00431, 9.31356), (-0.02, -5.0)]


@pytest.mark.parametrize(("stable", "unstable"), SADDLES)
def test_far_down_the_law_is_the_power_of_grebogi_ott_and_yorke(stable, unstable):
    periods = abs(stable) ** np.array([40.0, 60.0])
    slope = (log_stay(periods[1], stable, unstable) - log_stay(periods[0], stable, unstable)) / (
        20 * -math.log(abs(stable))
    )

    assert slope == pytest.approx(homoclinic_exponent(stable, unstable), rel=0.05)


@pytest.mark.parametrize(("stable", "unstable"), SADDLES)
def test_between_two_passages_the_slope_is_one_half(stable, unstable):
    """The steps of the stay lie at the powers of the stable multiplier."""
    for n in (1, 2, 3):
        edge = abs(stable) ** n
        above, below, lower = (log_stay(edge * x, stable, unstable) for x in (1.001, 0.999, 0.999 * abs(stable) * 1.01))

        assert below - above > math.log(abs(unstable)) / 2
        assert lower - below == pytest.approx(-math.log(abs(stable) * 1.01) / 2)


def test_the_unit_of_made_up_stays_is_found_again():
    stable, unstable = SADDLES[0]
    distances = np.geomspace(4e-3, 1e-4, 38)
    noise = np.random.default_rng(1).normal(0, 0.05, 38)
    points = [
        (d, 40 * math.exp(log_stay(d / 0.08, stable, unstable) + e)) for d, e in zip(distances, noise, strict=True)
    ]
    found, left = unit(points, stable, unstable)

    assert found == pytest.approx(0.08, rel=0.1)
    assert left < 0.08
    assert 1.5 < exponent(distances, found, stable, unstable) < homoclinic_exponent(stable, unstable)
