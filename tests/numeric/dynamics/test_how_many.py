"""The number of attractors, and one estimator of exponents: theorems on polygons, exact values, two methods."""

import json
from math import cos, log, pi

import numpy as np
import pytest

from numeric import PinballMap
from numeric.dynamics.attractors import Kind, find
from numeric.dynamics.estimator import mean_flight, per_time
from numeric.dynamics.exponents import surveyed
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.statistics import estimate
from numeric.pinball.sampling import interior_starts, phase_starts
from symbolic import tables
from symbolic.tables.gallery import regular
from verification.app.cli import main


@pytest.mark.slow
@pytest.mark.parametrize(("n", "lam", "seed"), [(7, "0", 1), (7, "0.001", 2)])
def test_a_regular_polygon_with_an_odd_number_of_sides_has_as_many_attractors(n, lam, seed):
    """A theorem on slap maps of regular polygons, from 7 sides on [DelMagnoLopesDiasDuarteGaivao2014]."""
    found = find(PinballMap(regular(n), lam=lam), 80, seed)

    assert [a.kind for a in found] == [Kind.CHAOTIC] * n
    assert not any(a.doubt for a in found)
    for attractor in found:
        assert attractor.nu_plus == pytest.approx(-log(cos(pi / n)), abs=1e-12 if lam == "0" else 1e-3)
        assert attractor.nu_minus == (-np.inf if lam == "0" else pytest.approx(log(0.001), abs=1e-12))


@pytest.mark.slow
@pytest.mark.parametrize("lam", ["0.3", "0.9", "0.999"])
def test_angles_in_a_polygon_contract_by_lam_at_each_bounce(lam):
    map = PinballMap(tables.polygon((0, 0), (3, 0), (4, 2), (1, 3)), lam=lam)
    for group in surveyed(map, interior_starts(map, 10, seed=1), 200, 300).groups:
        assert group.measured.lower.mean == pytest.approx(log(float(lam)), abs=1e-13)
        assert group.measured.lower.error < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize(("table", "lam"), [("cardioid", "0.5"), ("diamond", "0.5")])
def test_all_ways_to_ask_for_exponents_have_one_answer(table, lam):
    map = PinballMap(table, lam=lam)
    starts = phase_starts(map, 100, seed=2)
    (group,) = surveyed(map, starts, 1000, 1000).groups
    (attractor,) = find(map, 20, 1)
    plainly = map.exponents(starts.theta, starts.phi, 1000, 1000, starts.component)
    means = [(group.measured.upper.mean, group.measured.upper.error), (attractor.nu_plus, attractor.errors[0])]
    means.append((np.mean(plainly.nu_plus), np.std(plainly.nu_plus) / 10))

    for value, error in means[1:]:
        assert abs(value - means[0][0]) < 4 * np.hypot(error, means[0][1])


def test_a_short_run_has_no_bias_of_the_order_of_one_over_its_length():
    """At `lam` 1/1000 the error of 100 bounces is 1e-5; that of a vector with a new start would be 3e-2."""
    map = PinballMap(regular(7), lam="0.001")
    starts = phase_starts(map, 200, seed=1)
    short, long = (map.exponents(*starts[1:3], n, 500, starts.component).nu_plus for n in (100, 10_000))

    assert abs(np.mean(short) - np.mean(long)) < 4 * np.std(short) / np.sqrt(200) < 1e-4


def test_a_sticky_table_is_undecided_and_no_number_of_attractors_is_made_up(capsys):
    arguments = ["stadium", "--shape", "straight=1/1000", "--lam", "1", "--orbits", "4", "--json", "-"]
    assert main(["attractor", *arguments]) == 0
    document = json.loads(capsys.readouterr().out)

    assert document["count"] is None
    assert "still spread" in document["undecided"]
    assert len(document["attractors"]) == 1


@pytest.mark.slow
def test_the_stadium_with_short_sides_has_one_exponent(capsys):
    """The value is that of an independent ray tracer, 0.1209 +- 0.0002."""
    arguments = ["--orbits", "8", "--bounces", "4000", "--start-law", "phase", "--json", "-"]
    assert main(["lyapunov", "stadium", "--shape", "straight=1/100", "--lam", "1", *arguments]) == 0
    document = json.loads(capsys.readouterr().out)

    assert abs(document["nu_plus"] - 0.1209) < 3 * document["nu_plus_stderr"] + 2e-4 < 0.02


def test_mean_flights_in_elastic_tables_are_pi_times_area_over_perimeter():
    """Cardioid: area 3*pi/2, perimeter 8. The ellipse's short axis: flights of length 2 without error."""
    map = PinballMap("cardioid", lam=1)
    flight = mean_flight(map, PhasePoints(*phase_starts(map, 400, seed=3)[:3]), 500)

    assert abs(flight.mean - pi * (3 * pi / 2) / 8) < 4 * flight.error < 0.03


def test_exponents_per_time_of_the_short_axis_are_half_of_those_per_bounce(capsys):
    assert (
        main(["lyapunov", "ellipse", "--a", "3/2", "--lam", "1/2", "--orbits", "8", "--per-time", "--json", "-"]) == 0
    )
    (group,) = json.loads(capsys.readouterr().out)["groups"]

    assert group["mean_flight"] == pytest.approx(2, abs=1e-12)
    assert group["nu_plus_per_time"] == pytest.approx(log(0.5) / 4, abs=1e-12)


def test_the_error_of_a_ratio_has_both_errors():
    rng = np.random.default_rng(1)
    nu, flight = (estimate(rng.normal(mean, 0.1, (64, 40))) for mean in (0.5, 2.0))
    rate, error = per_time(nu, flight)

    assert rate == nu.mean / flight.mean
    assert error == pytest.approx(rate * np.hypot(nu.error / nu.mean, flight.error / flight.mean))


def test_rare_stretches_are_said_to_skew_the_error():
    rng = np.random.default_rng(2)
    plain = rng.normal(size=(40, 256, 40))
    rare = np.where(rng.random(plain.shape) < 2e-4, -200.0, plain)

    assert np.mean([estimate(series).skewed for series in rare]) > 0.7
    assert np.mean([estimate(series).skewed for series in plain]) < 0.1


@pytest.mark.parametrize(("scatter", "student"), [("exponential", 0.91), ("normal", 0.95)])
def test_intervals_reach_farther_where_batches_are_skewed(scatter, student):
    """Means of 16 exponentials, of skewness 2: Student's interval holds in 91 of 100; for normal ones in 95."""
    draw = {"exponential": np.random.default_rng(4).exponential, "normal": np.random.default_rng(4).normal}[scatter]
    ensemble = draw(size=(2000, 1, 16))
    truth = {"exponential": 1.0, "normal": 0.0}[scatter]
    found = [estimate(series) for series in ensemble]
    ends = np.array([each.interval for each in found])
    mean, error = (np.array([getattr(each, name) for each in found]) for name in ("mean", "error"))

    assert np.mean(np.abs(mean - truth) < 2.131 * error) == pytest.approx(student, abs=0.015)  # Student's 15 degrees
    assert 0.93 < np.mean((ends[:, 0] < truth) & (truth < ends[:, 1])) < 0.975
