"""The distribution of random starts, compared with its formula and with traced rays."""

import numpy as np
import pytest
from scipy.stats import chi2, chi2_contingency, kstest
from sympy import cos

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts, longest, phase_grid, phase_starts
from symbolic import tables
from symbolic.tables.table import theta

MANY = 40_000
WAISTED = tables.polar(1 + cos(3 * theta) / 4)  # not convex
SCENES = {"circle": {}, "ellipse": {"a": 1.5}, "cardioid": {}, "cuspless": {}, "egg": {"alpha": "0.08"}}
RADII = {
    "cardioid": lambda angle: 1 + np.cos(angle),
    "egg": lambda angle: 1 + 0.08 * np.cos(3 * angle),
    "waisted": lambda angle: 1 + 0.25 * np.cos(3 * angle),
}
UNLIKELY = 1e-4  # a seed is fixed, so this is no rate of failures


def area_before(name, angle):
    """The share of the area at polar angles below `angle`, from the integral of rho^2/2."""
    if name == "cardioid":
        return 0.5 + (1.5 * angle + 2 * np.sin(angle) + np.sin(2 * angle) / 4) / (3 * np.pi)
    a = {"egg": 0.08, "waisted": 0.25}[name]
    whole = np.pi * (2 + a**2)
    return 0.5 + (angle * (1 + a**2 / 2) + 2 * a * np.sin(3 * angle) / 3 + a**2 * np.sin(6 * angle) / 12) / whole


def directions(map, starts):
    """The directions of the flights from the interior points to their landings."""
    x, y = map.states.point(starts.component, starts.theta)
    return np.arctan2(y - starts.y, x - starts.x)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cardioid", "egg", "waisted"])
def test_interior_points_are_uniform_in_the_area_and_their_directions_independent_and_uniform(name):
    map = PinballMap(WAISTED, lam=0.5) if name == "waisted" else PinballMap(name, lam=0.5, **SCENES[name])
    starts = interior_starts(map, MANY, seed=4)
    angle, radius = np.arctan2(starts.y, starts.x), np.hypot(starts.x, starts.y)
    uniform = np.array(
        [(radius / RADII[name](angle)) ** 2, area_before(name, angle), directions(map, starts) / (2 * np.pi) + 0.5]
    )
    counts, _ = np.histogramdd(uniform.T, bins=5, range=[(0, 1)] * 3)
    expected = MANY / 125

    for marginal in uniform:
        assert kstest(marginal, "uniform").pvalue > UNLIKELY
    assert chi2.sf(np.sum((counts - expected) ** 2) / expected, 124) > UNLIKELY


def test_landings_in_an_ellipse_have_the_law_of_rays_traced_from_random_points():
    a, rng = 1.5, np.random.default_rng(8)
    radius, turn, omega = np.sqrt(rng.uniform(0, 1, MANY)), *rng.uniform(-np.pi, np.pi, (2, MANY))
    x, y, vx, vy = radius * np.cos(turn), radius * np.sin(turn), np.cos(omega) / a, np.sin(omega)  # a disc
    b, square = x * vx + y * vy, vx**2 + vy**2
    t = (-b + np.sqrt(b**2 + square * (1 - x**2 - y**2))) / square
    theta = np.arctan2(y + t * vy, x + t * vx)
    tangent = np.arctan2(np.cos(theta), -a * np.sin(theta))
    traced = theta, np.cos(omega - tangent)  # an elastic bounce keeps v.tangent = sin(phi)
    starts = interior_starts(PinballMap("ellipse", lam=0.3, a=a), MANY, seed=5)
    bins = {"bins": [12, 12], "range": [(-np.pi, np.pi), (-1, 1)]}
    one, two = (np.histogram2d(*pair, **bins)[0].ravel() for pair in (traced, (starts.theta, np.sin(starts.phi))))

    assert chi2_contingency([one, two]).pvalue > UNLIKELY


def test_in_the_circle_the_sine_of_the_first_exit_has_the_semicircle_law():
    starts = interior_starts(PinballMap("circle", lam=0), MANY, seed=2)

    def law(p):
        return 0.5 + (p * np.sqrt(1 - p**2) + np.arcsin(p)) / np.pi

    assert kstest(np.sin(starts.phi), law).pvalue > UNLIKELY


@pytest.mark.parametrize("name", SCENES)
def test_the_first_collision_is_elastic_at_any_contraction(name):
    map = PinballMap(name, lam=0, **SCENES[name])
    starts = interior_starts(map, 500, seed=1)
    omega = directions(map, starts)
    tx, ty = map.states.tangent(starts.component, starts.theta)

    assert np.max(np.abs(np.sin(starts.phi) - (np.cos(omega) * tx + np.sin(omega) * ty))) < 1e-9
    assert np.max(np.abs(starts.phi)) > 1


@pytest.mark.parametrize("name", SCENES)
def test_no_chord_is_longer_than_the_bound_that_thins_them(name):
    map = PinballMap(name, lam=1, **SCENES[name])
    starts = phase_starts(map, MANY, seed=3)
    landing = map.step(starts.theta, starts.phi, starts.component)
    t = np.hypot(landing.x - starts.x, landing.y - starts.y)

    assert 0.9 * longest(map) < np.max(t) <= longest(map)


def test_the_first_starts_of_a_longer_list_are_those_of_a_shorter_one():
    map = PinballMap("cuspless", lam=0.4)
    few, many = interior_starts(map, 300, seed=6), interior_starts(map, 30_000, seed=6)

    assert all(np.array_equal(one, two[:300]) for one, two in zip(few, many, strict=True))
    assert not np.array_equal(few.theta, interior_starts(map, 300, seed=7).theta)


@pytest.mark.parametrize("name", SCENES)
def test_a_grid_covers_the_boundary_in_arc_length(name):
    map = PinballMap(name, lam=0.5, **SCENES[name])
    grid = phase_grid(map, 40, 6)
    starts = grid.starts
    s = map.arclength.s(starts.theta, starts.component).reshape(6, 40)
    turns = (s - grid.s) / map.arclength.perimeter

    assert np.max(np.abs(turns - np.round(turns))) < 1e-12
    assert np.allclose(np.sin(starts.phi).reshape(6, 40), grid.sin_phi[:, None], rtol=0, atol=1e-15)
    assert np.allclose(np.diff(grid.s), map.arclength.perimeter / 40, rtol=0, atol=1e-12)
    assert repr((grid, starts)) == "(PhaseGrid(40 x 6 cells), Starts(240 particles))"
