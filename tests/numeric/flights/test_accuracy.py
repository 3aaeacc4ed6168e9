"""Positions within 4 units of rounding and directions within 8, against the exact map of the rounded state.

A handful of particles each; `benchmarks/adversarial.py` takes a million.
"""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec
from verification.maps.exact import ExactMap, errors

EPS = 2.0**-52


def measured(map, where, theta, phi):
    own = map.states.enter(where, theta, phi, map.law)
    lam = np.full(theta.size, float(map.lam))
    result = map.engine.run(KernelSpec(map.law, record=True), own, lam, map.shape, 1)
    return errors(map, ExactMap(map, 40), own, list(result.record[0]))


@pytest.mark.parametrize("lam", [0, 1e-300, 0.3, 0.95, 1])
def test_one_bounce_is_right_to_the_last_bits(table, lam):
    map = table.map(lam)
    position, direction = measured(map, *table.starts(map, 10, seed=int(1e3 * lam)))

    assert max(position) <= 4
    assert max(direction) <= 8


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_grazing_flights_are_as_exact_as_others(table, gap):
    map = table.map(0.9)
    where, theta, _ = table.starts(map, 8, seed=8)
    phi = np.where(np.arange(8) % 2 == 0, 1, -1) * (np.pi / 2 - gap)
    position, direction = measured(map, where, theta, phi)

    assert max(position) <= 4
    assert max(direction) <= 8


@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("kernels", [True, False])
def test_flights_that_leave_the_wall_along_it(gap, kernels):
    """From wherever on the wall; they land on the arc next to a join."""
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    y = np.linspace(-0.43, 0.43, 6)
    for side in (1, -1):
        position, direction = measured(map, np.ones(6, dtype=int), y, np.full(6, side * (np.pi / 2 - gap)))

        assert max(position) <= 4
        assert max(direction) <= 8


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8, 1e-11])
def test_flights_that_start_near_the_cusp(gap):
    map = PinballMap("cardioid", lam=0.9)
    phi = np.linspace(-1.5, 1.5, 10)
    theta = np.where(np.arange(10) % 2 == 0, 1, -1) * (np.pi - gap)
    position, direction = measured(map, np.zeros(10, dtype=int), theta, phi)

    assert max(position) <= 4
    assert max(direction) <= 8


@pytest.mark.parametrize("miss", [1e-3, 1e-6, 1e-9, 1e-12])
def test_flights_aimed_at_the_cusp(miss):
    map = PinballMap("cardioid", lam=0.9)
    theta = np.linspace(-2.9, 2.9, 10)
    phi = theta / 2 + np.where(np.arange(10) % 2 == 0, 1, -1) * miss
    position, direction = measured(map, np.zeros(10, dtype=int), theta, phi)

    assert max(position) <= 4
    assert max(direction) <= 8


NEAR_GRAZING = [  # theta and phi: the worst of a million random particles, of those aimed at a join, and past the other
    (-1.95277363, -1.37612652), (-0.670208058, -0.25451718), (1.25956245, 0.694918384), (-1.9531, -1.3763),
    (1.6162036187902906, 1.0014056098562036), (-1.6335621826646394, -1.0183761112721677), (2.0943, 1.5705),
    (1.9172456314571602, 1.3024506414317365), (-1.6527902530959695, -1.0372593151405034), (2.01866398, 1.45999368),
]  # fmt: skip


@pytest.mark.parametrize("lam", [0.95, 1])
@pytest.mark.parametrize("kernels", [True, False])
def test_flights_along_the_wall_of_the_cuspless_table(lam, kernels):
    map = PinballMap("cuspless", lam=lam, kernels=kernels)
    theta, phi = np.array(NEAR_GRAZING).T
    position, direction = measured(map, np.zeros(theta.size, dtype=int), theta, phi)

    assert max(position) <= 4
    assert max(direction) <= 8


@pytest.mark.parametrize("a", ["100", "10000"])
def test_long_ellipses_near_the_tip(a):
    map = PinballMap("ellipse", lam=0.9, a=a)
    theta = np.linspace(-1, 1, 24) * 10 / float(a)
    position, direction = measured(map, np.zeros(24, dtype=int), theta, np.linspace(-1.5, 1.5, 24))

    assert max(position) <= 4
    assert max(direction) <= 8


@pytest.mark.parametrize("K", [2, 4, 6])
def test_eggs_of_any_number_of_points(K):
    map = PinballMap("egg", lam=0.9, K=K, alpha=f"{9 / 10 / (K * K + 1):.6f}")
    rng = np.random.default_rng(K)
    position, direction = measured(map, np.zeros(16, dtype=int), rng.uniform(-3, 3, 16), rng.uniform(-1.4, 1.4, 16))

    assert max(position) <= 4
    assert max(direction) <= 8


def test_the_step_itself_is_the_exact_map(table):
    """The same step on 50-digit numbers agrees with the definition to 45 digits: closed forms and all."""
    map = table.map(0.7)
    exact = ExactMap(map, 50)
    mp = exact.context
    where, theta, phi = table.starts(map, 4, seed=31)
    for i in range(4):
        ball = exact.start(theta[i], phi[i], int(where[i]))
        state = in_digits(map, mp, ball)
        found, code = map.family.bounce(exact.ops, map.law, exact.shape, mp.mpf(0.7), state)
        truth = in_digits(map, mp, exact.bounce(ball))

        assert not code
        assert max(abs(a - b) for a, b in zip(found, truth, strict=True)) < mp.mpf(10) ** -45


def in_digits(map, mp, ball):
    """A particle as the fields of its table's state, written down once more by hand."""
    position, direction = map.family.position, map.family.direction
    half = {"p": mp.cos(ball.theta / 2), "q": mp.sin(ball.theta / 2), "wall": mp.mpf(0)}
    if ball.component:
        half = {"wall": mp.mpf(1), "p": -ball.theta, "q": mp.mpf(0)}
    known = half | {"theta": ball.theta, "phi": ball.phi, "vx": ball.v[0], "vy": ball.v[1]}
    known |= {"ux": mp.cos(ball.theta), "uy": mp.sin(ball.theta)}
    known |= {"cos_phi": mp.cos(ball.phi), "sin_phi": mp.sin(ball.phi)}
    return [known[name] for name in (*position, *direction)]
