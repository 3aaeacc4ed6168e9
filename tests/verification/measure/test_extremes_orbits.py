"""Very long orbits: recorded measurements, and means along the orbits."""

from verification.measure.extremes import orbits, page
from verification.measure.extremes.near import StabilityVerdict

SHORT = {one.name.partition(",")[0]: one for one in orbits.orbits()}


def test_orbits_of_a_thousand_million_collisions_were_measured_and_are_on_the_page():
    long = page.lines(page.LONG)
    commands = {one.command for one in long}

    assert {one.case.partition(",")[0] for one in long} == set(SHORT)
    assert {"1e+09 bounces each" in one.case for one in long} == {True, False}
    assert all(int(float(command.split()[3])) >= 10**9 for command in commands)
    assert [one for one in long if one.verdict is StabilityVerdict.UNSTABLE or one.stopped_by] == []


def test_means_over_an_ergodic_orbit_are_within_four_standard_errors():
    assert all(one.measured.backward < 4 for one in orbits.findings(SHORT["elastic cardioid"]))
