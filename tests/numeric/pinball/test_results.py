"""Answers as labelled arrays: the same numbers, under their names and with units."""

import sys

import numpy as np
import pytest

from numeric import PinballMap, Status

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


def test_the_outcomes_of_particles_stand_beside_their_exponents():
    assert list(EGG.exponents([0.1, 0.2], 0.1, 50).status) == [Status.REGULAR] * 2


def test_the_slope_of_a_slap_map_has_a_value_for_each_start():
    found = EGG.slap([0.1, 0.2, 0.3], iterates=2).to_xarray()

    assert found.theta.dims == ("iterate", "start")
    assert found.slope.dims == ("start",)


def test_particles_in_rows_and_columns_are_put_in_a_row():
    theta = np.linspace(-1, 1, 6).reshape(2, 3)
    orbit, exponents, slap = EGG.orbit(theta, 0.1, 4), EGG.exponents(theta, 0.1, 5), EGG.slap(theta, 2)

    assert orbit.to_xarray().sizes == {"bounce": 5, "particle": 6}
    assert np.array_equal(orbit.to_xarray().theta.values, orbit.theta.reshape(5, 6))
    assert exponents.to_xarray().sizes == {"particle": 6}
    assert slap.to_xarray().sizes == {"iterate": 3, "start": 6}
    assert np.array_equal(slap.to_xarray().slope.values, slap.slope.ravel())


def test_every_field_has_its_meaning_and_units_only_where_it_has_any():
    found = EGG.orbit(0.3, 0.1, 2).to_xarray()

    assert list(found.data_vars) == ["component", "theta", "phi", "eta", "x", "y", "code"]
    assert found.component.attrs == {"long_name": "component of the boundary"}
    assert found.x.attrs == {"long_name": "x", "units": "1"}
    assert found.eta.attrs["units"] == "rad"
    assert EGG.exponents(0.3, 0.1, 5).to_xarray().nu_plus.attrs["units"] == "1/bounce"


def test_outcomes_are_named_at_every_bounce():
    orbit = PinballMap("cardioid", lam=0.5).orbit([0.3, 0.0], [0.1, 0.0], 1)

    assert orbit.status.tolist() == [[Status.REGULAR] * 2, [Status.REGULAR, Status.CUSP]]
    assert [Status(status).code for status in Status] == [0, 1, 2, 3, 4]


def test_without_xarray_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(
        ValueError, match=r"xarray is missing; install it with: pip install 'pinball-billiards\[sweep\]'"
    ):
        EGG.orbit(0.3, 0.1, 2).to_xarray()
