"""Answers as labelled arrays: the same numbers, under their names and with units."""

import numpy as np
import pytest

from numeric import PinballMap

EGG = PinballMap("egg", lam="0.4", alpha="0.08")


@pytest.mark.parametrize("theta", [0.3, [0.3], [0.1, 0.2, 0.3]], ids=["a ball", "a list of one", "three"])
def test_an_orbit_is_labelled_by_bounce_and_ball(theta):
    orbit = EGG.orbit(theta, 0.1, 6)
    found = orbit.to_xarray()

    assert found.sizes == {"bounce": 7, "ball": np.size(theta)}
    assert np.array_equal(found.x.values.ravel(), orbit.x.ravel())
    assert found.phi.attrs == {"long_name": "exit angle", "units": "rad"}


def test_exponents_are_labelled_by_ball():
    exponents = EGG.exponents([0.1, 0.2], 0.1, 50)
    found = exponents.to_xarray()

    assert found.sizes == {"ball": 2}
    assert np.array_equal(found.nu_plus.values, exponents.nu_plus)


def test_the_slope_of_a_slap_map_has_a_value_for_each_start():
    found = EGG.slap([0.1, 0.2, 0.3], iterates=2).to_xarray()

    assert found.theta.dims == ("iterate", "start")
    assert found.slope.dims == ("start",)
