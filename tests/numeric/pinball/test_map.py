"""The results of a map: fields, shapes and starts, against the definitions of the map and its exponents."""

import copy
import pickle

import numpy as np
import pytest
from sympy import Rational, cos, sin

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
LAWS = [0, 0.3, 1]


@pytest.mark.parametrize("lam", LAWS)
def test_an_orbit_tells_every_angle_and_place_of_its_bounces(table, lam, bounced):
    map = table.map(lam, kernels=False)
    where, at, phi = table.starts(map, 30, seed=4, steepest=0.95)
    orbit = map.orbit(at, phi, 3, where)

    assert np.all(np.isnan(orbit.eta[0]))
    assert np.array_equal([orbit.component[0], orbit.theta[0], orbit.phi[0]], [where, at, phi])
    for i in range(3):
        steps = bounced(map.at(lam or 1e-320), orbit.component[i], orbit.theta[i], orbit.phi[i])
        graze = np.cos(steps.eta)
        assert np.array_equal(orbit.component[i + 1], steps.where)
        assert np.max(np.abs(orbit.theta[i + 1] - steps.theta) * graze) <= 1e-12
        assert np.max(np.abs(orbit.eta[i + 1] - steps.eta) * graze) <= 1e-12
        assert np.max(np.abs(orbit.phi[i + 1] + lam * orbit.eta[i + 1])) <= 16 * EPS
        (x, y), *_ = table.boundary(orbit.component[i + 1], orbit.theta[i + 1], map.shape)
        assert np.max(np.hypot(orbit.x[i + 1] - x, orbit.y[i + 1] - y)) <= 4 * EPS
    assert not orbit.code.any()
    if lam == 0:
        assert not orbit.phi[1:].any()


def test_answers_have_the_shape_of_the_starts():
    map = PinballMap("cuspless", lam=0.4, kernels=False)
    at, phi = np.linspace(-1, 1, 3)[:, None], np.array([[0.1, 0.2]])
    orbit, step, wanted = map.orbit(at, phi, 4), map.step(at, phi), map.exponents(at, phi, 5)

    assert {field.shape for field in orbit} == {(5, 3, 2)}
    assert {field.shape for field in step} == {(3, 2)}
    assert {field.shape for field in wanted} == {(3, 2)}
    assert map.derivative(at, phi).shape == (3, 2, 2, 2)
    assert (map.step(0.1).theta.shape, map.derivative(0.1, 0.0).shape) == ((), (2, 2))
    assert {field.shape for field in map.exponents(0.1, 0.2, 5)} == {()}
    assert map.exponents(0.1, 0.2, 5, component=[0, 0]).nu_plus.shape == (2,)


@pytest.mark.parametrize("lam", LAWS)
def test_derivatives_of_many_particles_are_those_of_each(table, lam):
    map = table.map(lam, kernels=False)
    where, at, phi = (x.reshape(2, 2) for x in table.starts(map, 4, seed=6, steepest=0.9))
    together = map.derivative(at, phi, where)

    for i in np.ndindex(2, 2):
        assert np.array_equal(together[i], map.derivative(at[i], phi[i], where[i]))


def by_products(map, where, at, phi, bounces, transient):
    """Both exponents by products of derivative matrices along an orbit, without the transient turn of (0.8, 0.6)."""
    orbit = map.orbit(at, phi, bounces + transient, where)
    vector, sums, volume = np.array([0.8, 0.6]), 0.0, 0.0
    for i in range(transient + bounces):
        matrix = map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i])
        vector = matrix @ vector
        if i >= transient:
            sums += np.log(np.linalg.norm(vector))
            volume += np.log(abs(np.linalg.det(matrix)))
        vector = vector / np.linalg.norm(vector)
    return sums / bounces, (volume - sums) / bounces


@pytest.mark.parametrize("transient", [0, 3])
@pytest.mark.parametrize("bounces", [1, 9])
def test_exponents_are_the_growth_of_one_vector_and_of_the_area(table, bounces, transient):
    map = table.map(0.6, kernels=False)
    where, at, phi = table.starts(map, 3, seed=2, steepest=0.8)
    found = map.exponents(at, phi, bounces, transient, where)
    orbit = map.orbit(at, phi, bounces + transient, where)
    for i in range(3):
        pair = sorted(by_products(map, where[i], at[i], phi[i], bounces, transient))
        assert [found.nu_minus[i], found.nu_plus[i]] == pytest.approx(pair, abs=1e-9)

    assert found.bounces.tolist() == [bounces] * 3
    assert np.allclose(found.theta, orbit.theta[-1], rtol=0, atol=1e-9)
    assert np.allclose(found.phi, orbit.phi[-1], rtol=0, atol=1e-9)
    assert np.array_equal(found.component, orbit.component[-1])


def test_a_slap_orbit_is_that_of_lam_0_whatever_lam_is(table):
    map = table.map(0.6, kernels=False)
    where, at, _ = table.starts(map, 4, seed=2)
    slap, orbit = map.slap(at, 3, where), map.at(lam=0).orbit(at, 0.0, 3, where)

    assert np.array_equal(slap.theta, orbit.theta)
    assert np.array_equal(slap.component, orbit.component)
    assert slap.theta.shape == (4, 4)
    assert np.array_equal(slap.slope, map.at(lam=0).derivative(at, 0.0, where)[..., 0, 0])
    assert float(map.lam) == 0.6


def test_a_ball_that_does_not_start_along_the_normal_is_no_ball_of_the_slap_map(table):
    """Its first flight differs; after that it follows the slap map."""
    map = table.map(0, kernels=False)
    where, at, phi = table.starts(map, 5, seed=3, steepest=0.8)
    orbit, after = map.orbit(at, phi, 2, where), map.at(lam=0.5).step(at, phi, where)

    assert np.allclose(orbit.theta[1], after.theta, rtol=0, atol=8 * EPS)
    assert not orbit.phi[1:].any()
    assert np.allclose(map.derivative(at, phi, where)[..., 1, :], 0)


@pytest.mark.parametrize(
    ("table", "path"),
    [
        ("circle", "closed"),
        ("ellipse", "closed"),
        ("cardioid", "cubic"),
        ("cuspless", "the cardioid's"),
        ("egg", "chord"),
    ],
)
def test_paths_of_the_papers_tables(table, path):
    shape = {"ellipse": {"a": 2}, "egg": {"alpha": "1/10"}}.get(table, {})

    assert PinballMap(table, **shape).path.startswith(path)


@pytest.mark.parametrize(("share", "path"), [("1/26", "chord"), ("1/25", "safe march"), ("1/10", "safe march")])
def test_a_dented_fourier_sum_has_its_first_hit_searched(share, path):
    """An egg with five corners is convex only up to alpha = 1/26."""
    made = tables.polar(1 + Rational(share) * cos(5 * theta), name="five")

    assert PinballMap(made).path.startswith(path)


def test_the_dent_may_be_anywhere():
    turned = tables.parametric(cos(theta), sin(theta) + 2 * sin(2 * theta) / 5, name="turned")

    assert PinballMap(turned).path.startswith("every zero")


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda map: pickle.loads(pickle.dumps(map))])
@pytest.mark.parametrize("law", [None, "-eta/2 + s/100"])
def test_a_map_at_work_can_be_copied(copied, law):
    map = PinballMap("ellipse", a=2, lam=0.5, law=law)
    step, matrix, perimeter = map.step(0.1, 0.2), map.derivative(0.1, 0.2), map.arclength.perimeter
    other = copied(map)

    assert np.array_equal(other.step(0.1, 0.2), step)
    assert np.array_equal(other.derivative(0.1, 0.2), matrix)
    assert other.arclength.perimeter == perimeter
