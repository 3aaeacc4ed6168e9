"""Results as labelled arrays: the same numbers, with names and units."""

import sys

import numpy as np
import pytest

from numeric import PinballMap

EGG = PinballMap("egg", lam="0.4", alpha="0.08")


@pytest.mark.parametrize("theta", [0.3, [0.3], [0.1, 0.2, 0.3]], ids=["a particle", "a list of one", "three"])
def test_an_orbit_is_labelled_by_bounce_and_ball(theta):
    orbit = EGG.orbit(theta, 0.1, 6)
    found = orbit.to_xarray()

    assert found.sizes == {"bounce": 7, "particle": np.size(theta)}
    assert np.array_equal(found.x.values.ravel(), orbit.x.ravel())
    assert found.phi.attrs == {"long_name": "exit angle", "units": "rad"}


def test_exponents_are_labelled_by_ball():
    exponents = EGG.exponents([0.1, 0.2], 0.1, 50)
    found = exponents.to_xarray()

    assert found.sizes == {"particle": 2}
    assert np.array_equal(found.nu_plus.values, exponents.nu_plus)


def test_without_xarray_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(
        ValueError, match=r"xarray is missing; install it with: pip install 'pinball-billiards\[sweep\]'"
    ):
        EGG.orbit(0.3, 0.1, 2).to_xarray()
