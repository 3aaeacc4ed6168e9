"""Each legitimate end of an orbit has a name, and the particle stays where it last was valid."""

import numpy as np
import pytest
from sympy import cos, sin, tanh

from numeric import PinballMap, Status
from symbolic import tables
from symbolic.tables.table import theta


@pytest.mark.parametrize("kernels", [True, False])
@pytest.mark.parametrize("theta", [0.0, 0.3, -1.0, 2.5])
def test_a_ball_aimed_at_the_cusp(kernels, theta):
    """Along the axis, and beside it, where the ball passes the tip on one side or lands on it from the other."""
    map = PinballMap("cardioid", lam=0.9, kernels=kernels)
    step = map.step(theta, theta / 2)

    assert step.status == Status.CUSP
    assert (step.theta, step.phi) == (theta, theta / 2)


@pytest.mark.parametrize("kernels", [True, False])
def test_a_ball_aimed_at_a_join(kernels):
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    x, y = -0.25 - 2.0, np.sqrt(3) / 4  # from theta = 0, at (2, 0), to the upper join
    phi = np.arctan2(y, -x)
    steps = [map.step(0.0, sign * phi) for sign in (1, -1)]

    assert {step.status for step in steps} == {Status.JOIN}


def test_a_tangent_ball():
    map = PinballMap("ellipse", lam=1, a=2)
    step = map.step(0.3, np.nextafter(np.pi / 2, 0))

    assert step.status == Status.GRAZING


@pytest.mark.parametrize("kernels", [True, False])
def test_neighbours_of_a_stopped_ball_go_on(kernels):
    map = PinballMap("cardioid", lam=0.9, kernels=kernels)
    theta, phi = np.array([0.3, 0.0, -0.4]), np.array([0.1, 0.0, 0.2])
    orbit = map.orbit(theta, phi, 6)

    assert [status.name for status in orbit.status[-1]] == ["REGULAR", "CUSP", "REGULAR"]
    assert np.all(orbit.theta[:, 1] == 0.0)
    assert np.all(np.isnan(orbit.eta[1:, 1]))
    assert np.array_equal(orbit.theta[:, 0], map.orbit(0.3, 0.1, 6).theta)


def test_exponents_say_how_far_a_ball_came():
    found = PinballMap("cardioid", lam=0.9).exponents(np.array([0.3, 0.0]), np.array([0.1, 0.0]), 50)

    assert found.bounces.tolist() == [50, 0]
    assert [status.name for status in found.status] == ["REGULAR", "CUSP"]


CIRCULAR = 1 + cos(3 * theta) / 20  # convex, by its chord polynomial
TABLES = {
    **{name: (name, {}) for name in ("circle", "cardioid", "cuspless", "stadium", "sinai", "mushroom")},
    "elliptical_stadium": ("elliptical_stadium", {}),
    "ellipse": ("ellipse", {"a": 3}),
    "egg": ("egg", {"alpha": "2/25"}),
    "sum": (tables.parametric(CIRCULAR * cos(theta), CIRCULAR * sin(theta), name="sum"), {}),
    "flower": (tables.polar(1 + cos(5 * theta) / 4, name="flower"), {}),
    "conic": (tables.polar(1 / (1 + 9 * cos(theta) / 10), name="conic"), {}),
    "step": (tables.parametric(2 * cos(theta), sin(theta) + tanh(20 * cos(theta)) / 3, name="step"), {}),
}


@pytest.mark.slow
@pytest.mark.parametrize("lam", [0, 0.5, 1])
@pytest.mark.parametrize("name", TABLES)
def test_a_regular_landing_is_ahead_and_from_within(name, lam):
    """Also within 1e-14 of the tangent: lengths are positive, ways straight, and incidence is below 90 degrees."""
    table, shape = TABLES[name]
    map = PinballMap(table, lam=lam, **shape)
    rng = np.random.default_rng(3)
    component = rng.integers(0, len(map.states.ends), 600)
    low, high = np.array(map.states.ends)[component].T
    at = low + (high - low) * rng.uniform(0.001, 0.999, 600)
    phi = rng.uniform(-1.5, 1.5, 600)
    phi[:200] = rng.choice([-1, 1], 200) * (np.pi / 2 - 10.0 ** rng.uniform(-14, -1, 200))
    landed = map.step(at, phi, component)
    regular = landed.code == 0
    frame = map.states.frame(component, at)
    vx, vy = map.states.direction(component, at, phi)
    x, y = landed.x - frame.x, landed.y - frame.y
    size = 2.0**-48 * np.max(np.abs([landed.x, landed.y]))

    assert np.count_nonzero(regular) > 350
    assert np.all(np.abs(landed.eta[regular]) <= np.pi / 2)
    assert np.all(np.abs(landed.phi[regular]) <= np.pi / 2)
    assert np.all((vx * x + vy * y)[regular] > -size)
    assert np.all(np.abs(vx * y - vy * x)[regular] < 64 * size)
    own = regular & (landed.component == component)
    assert np.all((np.hypot(x, y) > 0)[own & (np.cos(phi) > 1e-3)])
