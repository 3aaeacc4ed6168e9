"""Lyapunov exponents: exact cases, a second method, and error bars that hold their confidence."""

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.account import account, checked
from numeric.dynamics.estimator import Count
from numeric.dynamics.exponents import CHANGED, surveyed
from numeric.dynamics.phase_points import PhasePoints, phase_points
from numeric.dynamics.recognition import Kind
from numeric.dynamics.statistics import autocorrelation_time, estimate
from numeric.pinball.sampling import Growth, Starts, interior_starts, phase_starts
from symbolic import tables
from verification.named.attractors import certified_exponents

SCENES = {"circle": {}, "ellipse": {"a": 1.5}, "cardioid": {}, "cuspless": {}, "egg": {"alpha": "0.08"}}


def remembering(rng, memory, blocks, orbits):
    """A stationary series of mean 0 with correlation `memory` between neighbours."""
    noise = rng.normal(size=(blocks, orbits))
    series = np.empty_like(noise)
    series[0] = noise[0] / np.sqrt(1 - memory**2)
    for i in range(1, blocks):
        series[i] = memory * series[i - 1] + noise[i]
    return series


@pytest.mark.slow
@pytest.mark.parametrize(("memory", "orbits"), [(0.0, 1), (0.9, 1), (0.9, 4), (-0.5, 3), (-0.95, 3), (0.97, 40)])
def test_an_error_bar_of_a_series_with_memory_is_that_of_its_mean(memory, orbits):
    rng = np.random.default_rng(3)
    found = [estimate(remembering(rng, memory, 1024, orbits)) for _ in range(60)]
    exact = 1 / (1 - memory) / np.sqrt(1024 * orbits)
    held = np.mean([x.interval[0] < 0 < x.interval[1] for x in found])

    assert np.mean([x.error for x in found]) == pytest.approx(exact, rel=0.1)
    assert held > 0.88  # 95 per cent of 60, and 2.5 of its standard deviations below


def test_the_memory_of_an_exponential_series_is_found():
    series = remembering(np.random.default_rng(4), 0.8, 4096, 16)

    assert autocorrelation_time(series) == pytest.approx(0.5 * 1.8 / 0.2, rel=0.1)


def test_a_run_shorter_than_its_memory_is_not_trusted():
    found = estimate(remembering(np.random.default_rng(5), 0.99, 512, 1))

    assert not found.trusted


@pytest.mark.slow
@pytest.mark.parametrize(("name", "lam"), [("cardioid", "0"), ("cuspless", "0.5"), ("cardioid", "0.5")])
def test_intervals_of_exponents_hold_a_long_runs_result(name, lam):
    map = PinballMap(name, lam=lam)
    start = interior_starts(map, 1200, seed=2)
    growth = Growth(map, start.theta, start.phi if lam != "0" else 0 * start.phi, start.component)
    growth.skip(300)
    growth.advance(100)
    count = Count(growth)
    for _ in count.until(1024):
        pass
    truth = np.mean(count.up)  # of 300 repeats, so 17 times as sharp as one
    found = [estimate(part) for part in np.split(count.up, 300, axis=1)]
    held = np.mean([x.interval[0] < truth < x.interval[1] for x in found])

    assert 0.9 < held < 0.995
    assert np.mean([x.error for x in found]) == pytest.approx(np.std([x.mean for x in found]), rel=0.15)


@pytest.mark.slow
def test_the_slap_exponent_of_the_cardioid_is_the_mean_over_ulams_invariant_density():
    map, cells, points = PinballMap("cardioid", lam=0), 1500, 40
    s = -4 + 8 * (np.arange(cells * points) + 0.5) / (cells * points)
    image = map.slap(map.arclength.theta(s))
    to = np.minimum(((map.arclength.s(image.theta[1]) + 4) / 8 * cells).astype(int), cells - 1).reshape(cells, points)
    density = np.full(cells, 1 / cells)
    for _ in range(200):
        density = np.bincount(to.ravel(), np.repeat(density / points, points), minlength=cells)
    ulam = np.sum(density * np.mean(np.log(np.abs(image.slope)).reshape(cells, points), axis=1))
    found = surveyed(map, interior_starts(map, 100, seed=1), 4000, 500).groups[0].measured.upper

    assert abs(found.mean - ulam) < 4 * found.error + 2e-3  # the second is Ulam's own error


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("lam", ["0", "0.3", "0.9", "1"])
def test_kernel_and_angles_agree_on_the_determinant_along_an_orbit(name, lam):
    map = PinballMap(name, lam=lam, **SCENES[name])
    start = phase_starts(map, 16, seed=9)
    check = checked(map, PhasePoints(start.component, start.theta, start.phi), 300)

    assert check.particles == 16
    assert check.difference < 300 * 16 * 2.0**-52 * 40  # one rounding a bounce, magnified by grazing angles


def test_in_an_ellipse_areas_grow_by_positions_alone():
    map = PinballMap("ellipse", lam="0.7", a=1.5)
    start = interior_starts(map, 30, seed=3)
    growth = Growth(map, start.theta, start.phi, start.component)
    growth.advance(25)
    gradients = [np.hypot(np.cos(t) / 1.5, np.sin(t)) for t in (start.theta, growth.theta)]

    assert np.allclose(growth.volume, np.log(gradients[1] / gradients[0]), rtol=0, atol=1e-12)


def test_all_orbits_of_an_ellipse_have_exponents_that_add_up_to_log_lam():
    map = PinballMap("ellipse", lam="0.25", a=3)
    found = surveyed(map, interior_starts(map, 10, seed=1), 500, 500)

    assert len(found.groups) == 1
    assert found.groups[0].measured.total.mean == pytest.approx(np.log(0.25), abs=1e-12)


def test_the_diameters_of_the_circle_have_exponents_0_and_log_lam():
    map = PinballMap("circle", lam="0.5")
    group = surveyed(map, interior_starts(map, 20, seed=1), 500, 500).groups[0]

    assert group.attractor.kind is Kind.NEUTRAL
    assert group.measured.upper.mean == pytest.approx(0, abs=1e-12)
    assert group.measured.lower.mean == pytest.approx(np.log(0.5), abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("scene", [{"table": "circle"}, {"table": "ellipse", "a": 2}], ids=["circle", "ellipse"])
@pytest.mark.parametrize("bounces", [64, 256, 1024])
def test_where_vectors_grow_like_a_power_of_the_time_the_error_holds_the_exponent_0(scene, bounces):
    """The elastic circle and ellipse: the estimate after `n` bounces is `log(n)/n`, whatever the scatter of orbits."""
    map = PinballMap(**scene, lam=1)
    for seed in range(5):
        found = account(map, surveyed(map, interior_starts(map, 4, seed=seed), bounces, 500))
        for group in found["groups"]:
            assert group["kind"] == "neutral"
            for name in ("nu_plus", "nu_minus"):
                assert 0 < abs(group[name]) <= 2 * group[f"{name}_stderr"] + 1e-12
            for step in group["trace"]:
                assert 0 < abs(step["nu_plus"]) <= step["nu_plus_stderr"]
        assert found["nu_plus"] <= found["nu_plus_stderr"]


@pytest.mark.slow
def test_two_attractors_are_never_averaged():
    map = PinballMap("cuspless", lam="0.09")
    found = surveyed(map, interior_starts(map, 60, seed=1), 500, 1000)
    document = account(map, found)
    kinds = {group.attractor.kind for group in found.groups}

    assert kinds == {Kind.CYCLE, Kind.CHAOTIC}
    assert document["nu_plus"] is None
    assert sum(group["orbits"] for group in document["groups"]) == 60
    assert {np.sign(group["nu_plus"]) for group in document["groups"]} == {1, -1}


@pytest.mark.slow
def test_particles_that_leave_for_a_cycle_while_counted_are_set_apart():
    """Just above the boundary crisis chaos is a long transient, which ends for some particles during the count."""
    map = PinballMap("egg", lam="0.663", alpha="0.08")
    found = surveyed(map, interior_starts(map, 60, seed=1), 6000, 100)
    described = {group["kind"]: group for group in account(map, found)["groups"]}
    cycles = [group for group in found.groups if group.attractor is not None and group.attractor.kind is Kind.CYCLE]

    assert described[CHANGED]["nu_plus"] is None
    assert len(cycles) == 2
    assert all(abs(group.measured.upper.mean - group.attractor.nu_plus) < 1e-3 for group in cycles)


def test_particles_that_all_stop_are_an_answer():
    map = PinballMap("cardioid", lam="0.5")
    starts = Starts(np.zeros(4, dtype=int), np.zeros(4), np.zeros(4), np.full(4, 2.0), np.zeros(4))  # into the cusp
    document = account(map, surveyed(map, starts, 100, 100))

    assert document["nu_plus"] is None
    assert [group["kind"] for group in document["groups"]] == ["stopped: the map is undefined there"]


def test_an_interrupted_count_keeps_what_it_has():
    map = PinballMap("cardioid", lam="0.5")

    def impatient(part):
        if part > 0.3:
            raise KeyboardInterrupt

    found = surveyed(map, interior_starts(map, 10, seed=1), 1000, 100, say=impatient)

    assert found.ended == "interrupted"
    assert 300 <= found.count.bounces < 400
    assert 0.3 < found.groups[0].measured.upper.mean < 0.8


def test_certified_exponents_of_the_eggs_triangles_are_their_closed_form():
    found = certified_exponents(
        tables.egg(3).at(alpha="0.08"), Rational(9, 20), phase_points([-2.8335, -0.739, 1.355], 0.0)
    )
    eta = np.pi / (3 * 1.45)

    assert float(found["nu_plus"]) == pytest.approx(np.log(0.45 * np.cos(0.45 * eta) / np.cos(eta)) / 2, abs=1e-14)
    assert found["nu_plus"] == found["nu_minus"]
    assert float(found["radius"]) < 1e-28


@pytest.mark.parametrize("lam", ["0", "0.4", "0.9", "0.99"])
def test_beams_in_the_cardioid_widen_at_every_bounce_by_no_less_than_the_proof_says(lam):
    map = PinballMap("cardioid", lam=lam)
    start = interior_starts(map, 300, seed=6)
    orbit = map.orbit(start.theta, start.phi, 200, start.component)
    radius = 4 * np.cos(orbit.theta[1:] / 2) / 3
    t = np.hypot(np.diff(orbit.x[1:], axis=0), np.diff(orbit.y[1:], axis=0))
    leaving, landing = radius[:-1] * np.cos(orbit.phi[1:-1]), radius[1:] * np.cos(orbit.eta[2:])
    gain = (t - leaving) / landing
    growth = map.exponents(orbit.theta[1], orbit.phi[1] if lam != "0" else 0 * start.phi, 2000)

    assert np.min(gain) >= 1 + np.tan((1 - float(lam)) * np.pi / 8) ** 2 / 2
    assert np.min(growth.nu_plus) > np.mean(np.log(gain)) / 2 > 0
