"""Very long orbits: their truths, and that each of them would notice a fault."""

import numpy as np
import pytest

from numeric import PinballMap
from verification.measure.extremes import orbits, page
from verification.measure.extremes.near import SMALL, Stability

SHORT = {one.name.partition(",")[0]: one for one in orbits.orbits()}


def of(name):
    return next(one for one in orbits.orbits(256_000) if one.name.startswith(name))


def test_orbits_of_a_thousand_million_collisions_were_measured_and_are_on_the_page():
    long = page.lines(page.LONG)
    commands = {one.command for one in long}

    assert {one.case.partition(",")[0] for one in long} == set(SHORT)
    assert {"1e+09 bounces each" in one.case for one in long} == {True, False}
    assert all(int(float(command.split()[3])) >= 10**9 for command in commands)
    assert [one for one in long if one.verdict is Stability.UNSTABLE or one.stopped_by] == []


def test_means_over_an_ergodic_orbit_are_within_four_standard_errors():
    assert all(one.measured.backward < 4 for one in orbits.findings(SHORT["elastic cardioid"]))


def test_the_mirrored_orbits_are_chaotic_so_that_one_lost_bit_would_have_grown_to_the_size_of_the_table():
    map = PinballMap("cardioid", lam="4/5")
    theta, phi = orbits.starts(8)
    grown = map.exponents(theta, phi, 1000, 100).nu_plus
    (found,) = orbits.findings(of("cardioid at lam = 4/5"))

    assert np.min(grown) * 1000 > 36 * np.log(10)  # 2^-52 becomes 1 within a tenth of the shortest orbit
    assert found.measured.forward == 0


@pytest.mark.parametrize(
    "name", ["elastic circle", "egg at lam = 7/10", "cardioid at lam = 4/5", "elastic ellipse a = 3"]
)
def test_a_fault_of_a_thousand_units_on_the_way_is_noticed(name, monkeypatch):
    asked, advanced = of(name), orbits.advanced

    def faulty(map, rows, bounces):
        own, said = advanced(map, rows, bounces)
        own[0] = own[0] + 2.0**-52 * 1e4 * np.sqrt(asked.bounces) * (1 + (np.arange(own[0].size) < own[0].size // 2))
        return own, said

    monkeypatch.setattr(orbits, "advanced", faulty)
    (found,) = orbits.findings(asked)

    assert found.measured.backward > SMALL
    assert found.stability is Stability.UNSTABLE


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_number_that_is_none_is_named(wrong):
    map = PinballMap("ellipse", lam=1, a="3/2")
    rows = orbits.entered(map, *orbits.starts(4))
    rows[2] = rows[2] * wrong

    assert orbits.advanced(map, rows, 1)[1] == "not a number"


def test_orbits_in_parts_are_orbits_in_one():
    map = PinballMap("cardioid", lam="4/5")
    rows = orbits.entered(map, *orbits.starts(4))
    whole, _ = orbits.advanced(map, rows, 300)
    half, _ = orbits.advanced(map, orbits.advanced(map, rows, 100)[0], 200)

    assert all(np.array_equal(one, two) for one, two in zip(whole, half, strict=True))
