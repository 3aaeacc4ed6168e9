"""Promises of all kernels: the same bits, however they are run."""

import numpy as np
import pytest

from numeric.flights.family import SLAP
from numeric.kernels.engine import Engine
from numeric.kernels.machine import KernelSpec, starting
from numeric.kernels.text import kernel_text

LAMS = (0, 0.3, 1)


def record(map, count=200, bounces=30, seed=1, threads=1, engine=None, exponents=False):
    where, theta, phi = (np.asarray(x) for x in map_starts(map, count, seed))
    own = map.states.enter(where, theta, phi, map.law)
    lam = np.full(count, float(map.lam))
    tangent = starting(np.ones(count), np.zeros(count), np.ones(count)) if exponents else ()
    question = KernelSpec(map.law, record=not exponents, exponents=exponents)
    return (engine or map.engine).run(question, own, lam, map.shape, bounces, tangent, threads)


def map_starts(map, count, seed):
    rng = np.random.default_rng(seed)
    component = rng.integers(0, len(map.states.ends), count)
    ends = np.array(map.states.ends)[component]
    return component, ends[:, 0] + np.ptp(ends, axis=1) * rng.uniform(0.01, 0.99, count), rng.uniform(-1.5, 1.5, count)


@pytest.mark.parametrize("lam", LAMS)
def test_the_number_of_threads_does_not_change_a_bit(table, lam):
    map = table.map(lam)

    assert np.array_equal(record(map, threads=1).record, record(map, threads=3).record)


@pytest.mark.parametrize("lam", LAMS)
def test_the_number_of_lanes_does_not_change_a_bit(table, lam):
    map = table.map(lam)
    narrow = Engine(map.family, map.engine.identity, map.engine.names, lanes=8)

    assert np.array_equal(record(map).record, record(map, engine=narrow).record)


@pytest.mark.slow
def test_neighbours_do_not_change_a_bit(table):
    map = table.map(0.7)
    where, theta, phi = map_starts(map, 70, 5)
    together = map.orbit(theta, phi, 20, where)
    alone = map.orbit(theta[33], phi[33], 20, where[33])

    assert np.array_equal(together.theta[:, 33], alone.theta)


@pytest.mark.parametrize("lam", LAMS)
def test_asking_for_exponents_does_not_change_the_orbit(table, lam):
    map = table.map(lam)
    plain, rows = record(map, bounces=25).record[-1], record(map, bounces=25, exponents=True).rows

    if map.law == SLAP:  # the direction is made a unit vector only when its length matters
        assert np.allclose(plain, [rows[name] for name in map.family.fields(map.law)], rtol=0, atol=1e-9)
    else:
        assert np.array_equal(plain, [rows[name] for name in map.family.fields(map.law)])


@pytest.mark.parametrize("lam", LAMS)
def test_arrays_and_lanes_agree_to_a_few_units(table, lam):
    lanes, arrays = table.map(lam), table.map(lam, kernels=False)
    where, theta, phi = map_starts(lanes, 500, 7)
    one, other = lanes.step(theta, phi, where), arrays.step(theta, phi, where)

    assert np.max(np.hypot(one.x - other.x, one.y - other.y)) <= 20 * 2.0**-52
    assert np.max(np.abs(one.phi - other.phi)) <= 20 * 2.0**-52


def test_the_text_of_a_kernel_is_always_the_same(table):
    map = table.map(0.5)
    text = kernel_text(map.family, map.engine.names, KernelSpec(map.law))

    assert text == kernel_text(map.family, map.engine.names, KernelSpec(map.law))
    assert "fast" not in text
    assert "contract" not in text


@pytest.mark.slow
def test_one_contraction_for_each_ball_is_as_good_as_one_for_all(table):
    lam = np.linspace(0.1, 0.9, 40)
    where, theta, phi = map_starts(table.map(0.5), 40, 2)
    together = table.map(lam).step(theta, phi, where)
    for i in (0, 17, 39):
        assert table.map(lam[i]).step(theta[i], phi[i], where[i]).phi == together.phi[i]


@pytest.mark.slow
def test_steps_make_orbits(table):
    map = table.map(0.6)
    where, theta, phi = map_starts(map, 30, 3)
    orbit = map.orbit(theta, phi, 4, where)
    step = map.step(theta, phi, where)

    assert np.array_equal(orbit.theta[1], step.theta)
    assert np.array_equal(orbit.theta[0], theta)
    assert np.all(np.isnan(orbit.eta[0]))
    assert np.nanmax(np.abs(orbit.phi[1:] + 0.6 * orbit.eta[1:])) <= 8 * 2.0**-52
