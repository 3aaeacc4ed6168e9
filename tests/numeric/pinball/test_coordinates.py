"""Parameter, arc length and Cartesian point, both ways, to full accuracy."""

import mpmath
import numpy as np
import pytest

from numeric import PinballMap
from numeric.pinball import coordinates
from symbolic import tables

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 40


def grid(map, component, count=41):
    low, high = map.states.ends[component]
    return np.linspace(low, high, count + 2)[1:-1]


EVERY = {
    "circle": ("circle", {}),
    "ellipse": ("ellipse", {"a": "3/2"}),
    "egg": ("egg", {"alpha": "0.08"}),
    "cardioid": ("cardioid", {}),
    "cuspless": ("cuspless", {}),
    "sides": (tables.stadium(), {}),
    "conic": (tables.polar("1/(2 + cos(theta)/2)"), {}),
    "star": (tables.polar("1 + cos(5*theta)/4"), {}),
}


@pytest.mark.parametrize("table", EVERY)
def test_points_by_themselves_are_those_of_the_frames_bit_for_bit(table):
    """For each family of tables; a shorter program computes each number by the same operations."""
    map = PinballMap(EVERY[table][0], lam="1/2", **EVERY[table][1])
    for component in range(len(map.states.ends)):
        theta = grid(map, component)
        where = np.full(theta.shape, component)
        frame, family = map.states.frame(where, theta), map.states.family

        assert np.array_equal(map.states.point(where, theta), frame[:2])
        assert np.array_equal(family.boundary.curve(where, theta)[:4], family.boundary.curve(where, theta, 4))


@pytest.mark.parametrize("a", ["1", "3/2", "10", "1000"])
def test_arc_length_of_the_ellipse_is_the_elliptic_integral(a):
    map = PinballMap("ellipse", lam=1, a=a)
    theta = grid(map, 0)
    exact = [MP.ellipe(MP.mpf(t), 1 - MP.mpf(map.shape[0]) ** 2) for t in theta]
    found = map.arclength.s(theta)

    assert max(abs(s - e) for s, e in zip(found, exact, strict=True)) <= 4 * EPS * map.arclength.perimeter


@pytest.mark.parametrize("alpha", ["0.02", "0.08", "0.1"])
def test_arc_length_of_the_egg_is_the_integral_of_the_speed(alpha):
    map = PinballMap("egg", lam=1, alpha=alpha)
    a = MP.mpf(map.shape[0])
    theta = grid(map, 0, 7)

    def speed(t):
        return MP.hypot(1 + a * MP.cos(3 * t), 3 * a * MP.sin(3 * t))

    for t, s in zip(theta, map.arclength.s(theta), strict=True):
        exact = MP.quad(speed, [MP.mpf(t) * k / 8 for k in range(9)])
        assert abs(s - exact) <= 8 * EPS * max(abs(exact), 1)


def test_inverse_arc_length_gives_the_parameter_back(table):
    map = table.map(1)
    for component in range(len(map.states.ends)):
        theta = grid(map, component)
        s = map.arclength.s(theta, component)
        back = map.arclength.theta(s, component)
        speed = map.states.speed(np.full(theta.shape, component), theta)
        allowed = EPS * (4 * np.abs(theta) + 8 * np.maximum(np.abs(s), 1) / speed)  # s itself is rounded

        assert np.all(np.abs(back - theta) <= allowed)


def test_arc_length_is_continuous_around_the_table():
    map = PinballMap("cuspless", lam=1)
    (low, high), (first, last) = map.states.ends

    assert map.arclength.s(low, 0) == pytest.approx(map.arclength.s(last, 1), abs=1e-15)
    assert map.arclength.s(high, 0) - map.arclength.s(first, 1) == pytest.approx(map.arclength.perimeter, abs=4e-15)
    assert map.arclength.perimeter == pytest.approx(9 * np.sqrt(3) / 2, abs=4e-15)


def test_a_point_of_the_boundary_is_found_again(table):
    map = table.map(1)
    for component in range(len(map.states.ends)):
        theta = grid(map, component)
        x, y = map.states.point(np.full(theta.shape, component), theta)
        where, at = map.locate(x, y)

        assert np.array_equal(where, np.full(theta.shape, component))
        speed = map.states.speed(where, theta)
        assert np.all(np.abs(at - theta) <= 32 * EPS * np.maximum(1, 1 / speed))


def test_a_point_off_the_boundary_is_refused():
    with pytest.raises(ValueError, match=r"the point \(0.3, 0.2\) is not on the boundary"):
        PinballMap("egg", lam=1, alpha="0.08").locate(0.3, 0.2)


def test_a_place_outside_the_component_is_refused():
    with pytest.raises(ValueError, match=r"s = 9\.0 is not on the arc"):
        PinballMap("cuspless", lam=1).arclength.theta(9.0, 0)


def boundary_of(table, count=61):
    """A map, points on all its components, and what the table's definition says there."""
    map = table.map(0.4)
    component = np.repeat(np.arange(len(map.states.ends)), count)
    theta = np.concatenate([grid(map, index, count) for index in range(len(map.states.ends))])
    return map.states, component, theta, table.boundary(component, theta, map.shape)


def test_the_frame_of_the_boundary_is_that_of_its_definition(table):
    states, component, theta, (z, tangent, curvature, speed) = boundary_of(table)
    away = speed > 0.1  # from the cusp, where the definition cancels

    assert np.allclose(states.point(component, theta), z, rtol=0, atol=4 * EPS)
    assert np.allclose(np.array(states.tangent(component, theta))[:, away], np.array(tangent)[:, away], atol=64 * EPS)
    assert np.allclose(states.speed(component, theta), speed, rtol=0, atol=16 * EPS)
    assert np.allclose(states.curvature(component, theta)[away], curvature[away], rtol=1e-11, atol=0)
    x, y, *_ = states.boundary.curve(component, theta)
    assert np.allclose([x, y], z, rtol=0, atol=4 * EPS)
    ds, _ = states.bending(component, theta)
    assert np.allclose(ds, 1.0 if table.name in ("cardioid", "cuspless") else speed, rtol=0, atol=16 * EPS)


def test_velocity_and_acceleration_are_the_derivatives_of_the_point(table):
    states, component, theta, _ = boundary_of(table, 9)
    h = 1e-5
    before, here, after = (np.array(states.boundary.curve(component, theta + k * h)) for k in (-1, 0, 1))

    assert np.allclose((after - before)[:4] / (2 * h), here[2:], rtol=0, atol=1e-8)


@pytest.mark.parametrize("law", ["slap", "elastic", "pinball"])
def test_a_ball_comes_back_from_the_fields_of_its_kernel(table, law):
    map = table.map(0.4)
    component, theta, phi = table.starts(map, 60, seed=9, steepest=1.0 if law != "slap" else 0.0)
    fields = map.states.enter(component, theta, phi, law)
    where, at = map.states.place(fields)

    assert len(fields) == len(map.family.fields(law))
    assert all(field.dtype == float for field in fields)
    assert np.array_equal(where, component)
    assert np.max(np.abs(at - theta)) <= 4 * EPS
    assert np.max(np.abs(map.states.exit(where, at, fields, law) - phi)) <= 16 * EPS


def test_directions_and_exit_angles_are_each_others_inverse(table):
    states, component, theta, (_, (tx, ty), *_) = boundary_of(table)
    phi = np.linspace(-1.5, 1.5, theta.size)
    vx, vy = states.direction(component, theta, phi)

    assert np.allclose(vx * tx + vy * ty, np.sin(phi), rtol=0, atol=1e-12)  # the tangent, to the right of a particle
    assert np.allclose(tx * vy - ty * vx, np.cos(phi), rtol=0, atol=1e-12)
    assert np.allclose(states.angle_to_normal(component, theta, vx, vy), phi, rtol=0, atol=8 * EPS)


def test_a_ball_on_the_wall_is_told_as_a_landing_there_leaves_it():
    states = PinballMap("cuspless", lam=0.4).states
    fields = states.enter(np.array([1, 0]), np.array([0.25, 0.0]), np.zeros(2), "slap")

    assert [field.tolist() for field in fields] == [[1, 0], [-0.25, 1], [0, 0]]


@pytest.mark.parametrize("lam", [0, 0.4, 1])
@pytest.mark.parametrize("tile", [1, 7, 30, 64])
def test_tiles_of_an_orbit_that_is_translated_have_no_seam(table, lam, tile, monkeypatch):
    map = PinballMap(table.name, lam=lam, kernels=False, **table.shape)
    component, theta, phi = table.starts(map, 10, seed=10, steepest=0.9 * (lam != 0))
    whole = map.orbit(theta, phi, 12, component)
    monkeypatch.setattr(coordinates, "TILE", tile)
    again = map.orbit(theta, phi, 12, component)

    assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(whole, again, strict=True))
