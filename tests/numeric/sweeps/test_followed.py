"""Particles set aside once on an attracting cycle have the fate that a long run gives them."""

import numpy as np

from numeric import PinballMap
from numeric.pinball.sampling import Starts, interior_starts
from numeric.sweeps.space import attracting, followed, periods


def beside(theta, distance, n):
    """Particles displaced along the normal by small distances from a point of the boundary."""
    return Starts(np.zeros(n, dtype=np.int64), theta + distance * np.arange(1, n + 1), *np.zeros((3, n)))


def test_who_is_left_on_a_cycle_early_is_on_one_of_that_period_in_the_end():
    map = PinballMap("egg", lam="0.375", alpha="0.08")  # chaos beside cycles that lost their stability a little below
    starts = interior_starts(map, 1000, 1)
    early, late = followed(map, starts, (250, 1000)), followed(map, starts, (20_000,))

    assert np.any(early.period)
    assert early.going.size
    assert np.array_equal(early.period[early.period > 0], late.period[early.period > 0])


def test_a_particle_that_passes_by_a_saddle_is_back_and_goes_on():
    """The long axis of the ellipse is a repelling cycle, which particles pass, and the short axis attracts them."""
    map = PinballMap("ellipse", a=2, lam="0.5")
    long, short = beside(0.0, 1e-13, 3), beside(np.pi / 2, 1e-13, 3)

    assert periods(map, long).tolist() == periods(map, short).tolist() == [2, 2, 2]
    assert followed(map, long, (2,)).going.tolist() == [0, 1, 2]
    assert followed(map, short, (2,)).period.tolist() == [2, 2, 2]


def test_at_lam_1_nobody_is_left_as_nothing_attracts():
    map = PinballMap("ellipse", a=2, lam=1)

    assert followed(map, beside(np.pi / 2, 0.0, 2), (10, 20)).going.tolist() == [0, 1]


def test_those_that_go_on_do_so_to_the_last_bit():
    map = PinballMap("egg", lam="0.45", alpha="0.08")
    starts = interior_starts(map, 300, 1)
    found = followed(map, starts, (100, 400, 500))
    alone = followed(map, starts.only(found.going), (500,))

    assert 0 < found.going.size < 300
    assert np.array_equal(found.growth.theta, alone.growth.theta)
    assert np.array_equal(found.starts.theta[found.going], found.growth.theta)


def test_a_cycle_attracts_where_its_multipliers_say_so():
    """The egg's diameters double their period at alpha-tilde(0.3) = 0.06285 (paper, section 6.3)."""
    diameter = Starts(np.zeros(1, dtype=np.int64), *np.zeros((4, 1)))
    at = [PinballMap("egg", lam="0.3", alpha=alpha) for alpha in ("0.0628", "0.0629")]

    assert [attracting(map, diameter, np.array([2])).tolist() for map in at] == [[True], [False]]
    assert not attracting(at[0], diameter, np.array([0]))[0]
