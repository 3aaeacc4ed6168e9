"""The branches of the slap map in balls and in series, and norms of matrices."""

import pytest
from flint import arb, arb_series

from verification.arithmetic.balls import working
from verification.arithmetic.series import taylor
from verification.proofs.slap_map.transfer import Branches


@pytest.mark.parametrize("landing", [-1.5, -0.5, -0.1, -0.05, 0.0, 0.5])
def test_branches_of_balls_and_of_series_are_the_same(landing):
    with working(96):
        at = Branches(96)
        launch, rate = at(arb(landing))
        h = arb(2) ** -30
        slope = (at(arb(landing) + h)[0] - at(arb(landing) - h)[0]) / (2 * h)
        assert abs(slope - rate) < 1e-15
        assert launch.rad() < 1e-24
        with taylor(2):
            first, second = at(arb_series([arb(landing), 1]))
            assert first[0].overlaps(launch)
            assert first[1].overlaps(rate)
            assert second[0].overlaps(rate)


def test_launching_points_are_sharp_up_to_the_ends():
    """Next to the cusp and to `pi/4`, in balls and in series, by a form without cancellation."""
    with working(96), taylor(2):
        at, near = Branches(96), arb(10) ** -9
        for landing in (-arb.pi() / 2 + near, arb.pi() / 4 - near):
            for launch, rate in (at(landing), [x[0] for x in at(arb_series([landing, 1]))]):
                assert launch.rad() < (1e-40 if landing < 0 else 1e-25)  # it is near 0 at the cusp
                assert rate.rad() < 1e-15
                assert 0 <= rate < 1
        for launch in (at(arb.pi() / 4)[0], at(arb_series([arb.pi() / 4, 1]))[0][0]):  # from the cusp
            assert launch.overlaps(arb.pi() / 2)
            assert launch.rad() < 1e-13
