"""Conversion between parameter and Cartesian point, both ways, to full accuracy."""

import numpy as np
import pytest

from numeric import PinballMap

EPS = 2.0**-52


def grid(map, component, count=41):
    low, high = map.states.ends[component]
    return np.linspace(low, high, count + 2)[1:-1]


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


def boundary_of(table, count=61):
    """A map, points on all components of its table, and the coordinates that the table's definition gives there."""
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
