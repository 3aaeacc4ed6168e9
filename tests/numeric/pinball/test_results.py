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
    with pytest.raises(ValueError, match=r"xarray is missing; install it with: pip install '\.\[sweep\]'"):
        EGG.orbit(0.3, 0.1, 2).to_xarray()


def test_time_is_the_length_of_the_flights_so_far_and_nan_after_the_last():
    orbit = PinballMap("cardioid", lam="0.5").orbit([0.3, 0.0], [0.1, 0.0], 5)  # one regular, one into the cusp

    assert np.array_equal(orbit.time[0], [0, 0])
    assert np.allclose(np.diff(orbit.time, axis=0)[:, 0], orbit.flight[1:, 0])
    assert np.allclose(orbit.flight[1:, 0], np.hypot(np.diff(orbit.x[:, 0]), np.diff(orbit.y[:, 0])))
    assert np.isnan(orbit.flight[:, 1]).all()
    with pytest.raises(ValueError, match="one step does not contain its start"):
        _ = EGG.step(0.3, 0.1).flight


def test_a_picture_is_saved_as_the_command_saves_it_and_a_path_is_no_pair_of_axes(tmp_path):
    EGG.orbit(0.3, 0.1, 6).plot().savefig(tmp_path / "orbit.png")
    width = int.from_bytes((tmp_path / "orbit.png").read_bytes()[16:20], "big")

    assert width == 1400
    with pytest.raises(ValueError, match=r"plot\(\).savefig\('orbit.png'\)"):
        EGG.orbit(0.3, 0.1, 6).plot("orbit.png")
