"""The general path works for any table: on tables of its own, and compared with the special paths."""

import numpy as np
import pytest
from hypothesis import given, settings
from one_bounce import bounce_errors
from sympy import cos, sin, sqrt

from numeric import PinballMap
from numeric.flights.general import General
from symbolic import tables
from symbolic.tables.table import theta
from verification.maps import strategies

WAVY = tables.polar(1 + cos(5 * theta) / 10, name="wavy")
MILD = tables.polar(1 + cos(5 * theta) / 40, name="mild")
ROUNDED = tables.parametric(cos(theta) * (1 + sin(theta) ** 2 / 9), sin(theta), name="rounded")
ROOTED = tables.polar(sqrt(1 + cos(theta) / 3), name="rooted")


def generally(map, table=None):
    """The same map, made to use the general path; or the map of a given table that is not one of the paper's."""
    family = General(map.states.boundary)
    kernels = map.engine.kernels
    shape = dict(zip(map.engine.names, map.exact_shape, strict=True))
    other = PinballMap(table or map.ir.table, lam=map.lam, kernels=kernels, **shape)
    other.family = other.states.family = family
    other.engine = type(other.engine)(family, other.engine.identity + family.identity, other.engine.names, kernels)
    return other


@pytest.mark.slow
def test_the_general_way_agrees_with_the_special_ones(table):
    map = table.map(0.8)
    other = generally(map)
    where, theta0, phi = table.starts(map, 300, seed=21, steepest=0.99)
    one, two = map.step(theta0, phi, where), other.step(theta0, phi, where)

    assert np.array_equal(one.component, two.component)
    assert np.max(np.hypot(one.x - two.x, one.y - two.y) * np.cos(phi)) <= 64 * 2.0**-52
    assert np.max(np.abs(one.phi - two.phi) * np.cos(phi)) <= 64 * 2.0**-52


@pytest.mark.slow
@pytest.mark.parametrize("table", [WAVY, ROOTED, tables.stadium(), ROUNDED, MILD], ids=lambda table: table.name)
def test_flights_on_any_table_are_the_exact_ones(table):
    map = PinballMap(table, lam=0.9)
    rng = np.random.default_rng(4)
    where = rng.integers(0, len(map.states.ends), 10)
    ends = np.array(map.states.ends)[where]
    start, phi = ends[:, 0] + np.ptp(ends, axis=1) * rng.uniform(0.05, 0.95, 10), rng.uniform(-1.2, 1.2, 10)
    position, direction = bounce_errors(map, where, start, phi)

    assert max(position) <= 64
    assert max(direction) <= 64


def test_the_first_hit_is_taken_where_a_ray_meets_the_boundary_three_times():
    map = PinballMap(WAVY, lam=1)
    orbit = map.orbit(np.linspace(-3, 3, 200), np.linspace(-1.5, 1.5, 200), 20)
    middles = 0.5 * (orbit.x[1:] + orbit.x[:-1]), 0.5 * (orbit.y[1:] + orbit.y[:-1])
    at = np.arctan2(middles[1], middles[0])

    assert np.all(orbit.code == 0)
    assert np.all(np.hypot(*middles) <= 1 + np.cos(5 * at) / 10 + 1e-12)


@settings(max_examples=30)
@given(strategies.particles(tables=[MILD, "ellipse", "egg"], lams=strategies.contractions(0.1, 1.0), steepest=1.4))
def test_an_angle_never_grows_at_a_reflection(ball):
    step = ball.map.step(ball.theta, ball.phi, ball.component)

    assert abs(step.phi) <= abs(step.eta) + 4 * 2.0**-52
    assert step.phi == pytest.approx(-ball.lam * float(step.eta), abs=8 * 2.0**-52)


WAISTED = tables.polar(1 + cos(2 * theta) / 2, name="waisted")
INSIDE = {
    "wavy": lambda x, y: 1 + np.cos(5 * np.arctan2(y, x)) / 10 - np.hypot(x, y),
    "waisted": lambda x, y: 1 + np.cos(2 * np.arctan2(y, x)) / 2 - np.hypot(x, y),
    "rooted": lambda x, y: np.sqrt(1 + np.cos(np.arctan2(y, x)) / 3) - np.hypot(x, y),
    "stadium": lambda x, y: 1 - np.hypot(np.maximum(abs(x) - 1, 0), y),
}


def particles(map, count, seed=6, steepest=1.4):
    """Random particles on all components of a table."""
    rng = np.random.default_rng(seed)
    where = rng.integers(0, len(map.states.ends), count)
    ends = np.array(map.states.ends)[where]
    at = ends[:, 0] + np.ptp(ends, axis=1) * rng.uniform(0.002, 0.998, count)
    return where, at, rng.uniform(-steepest, steepest, count)


@pytest.mark.parametrize("table", [WAVY, WAISTED, ROOTED, tables.stadium()], ids=lambda table: table.name)
def test_flights_are_straight_inside_and_reflected_by_the_law(table):
    map = PinballMap(table, lam=0.6, kernels=False)
    where, at, phi = particles(map, 150)
    step, (x, y) = map.step(at, phi, where), map.states.point(where, at)
    vx, vy = map.states.direction(where, at, phi)
    dx, dy = step.x - x, step.y - y
    tx, ty = map.states.tangent(step.component, step.theta)
    eta = -np.arctan2(vx * tx + vy * ty, vx * ty - vy * tx)
    share = np.linspace(0.01, 0.99, 99)[:, None]

    assert not step.code.any()
    assert np.max(np.abs(dx * vy - dy * vx)) <= 64 * 2.0**-52
    assert np.min(dx * vx + dy * vy) > 0
    assert np.min(INSIDE[table.name](x + share * dx, y + share * dy)) > 0
    assert np.max(np.abs(INSIDE[table.name](step.x, step.y))) <= 64 * 2.0**-52
    assert np.max(np.abs(step.phi + 0.6 * eta) * np.cos(eta)) <= 1e-13


@pytest.mark.parametrize("where", [0, 1, 2, 3])
def test_the_map_is_continuous_where_a_side_goes_over_into_an_arc(where):
    """Flights from the middle of each side of the stadium to each of its joins, and 1e-9 beside them on either side."""
    map = PinballMap(tables.stadium(), lam=0.5, kernels=False)
    (x, y) = (float(a[0]) for a in map.states.point(np.array([where]), np.array([0.1])))
    for jx, jy in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        if abs(jy - y) < 0.5 and where in (1, 3):
            continue  # along the side
        aim = np.arctan2(jy - y, jx - x)
        phi = float(map.states.angle_to_normal(np.array([where]), np.array([0.1]), np.cos(aim), np.sin(aim))[0])
        near = phi + np.arange(-9, 10) * 2.0**-53
        found = map.step(np.full(2, 0.1), phi + np.array([1e-9, -1e-9]), where)

        at_join = map.step(np.full(19, 0.1), near, where)
        assert not np.any(at_join.code)
        assert max(np.ptp(row) for row in (at_join.x, at_join.y, at_join.eta)) < 1e-13  # of 18 ulps of phi
        assert found.code.tolist() == [0, 0]
        assert found.component[0] != found.component[1]
