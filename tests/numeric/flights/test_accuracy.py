"""Positions within 4 and directions within 8 rounding units of the exact map (`benchmarks/adversarial.py`: more)."""

import numpy as np
import pytest
from one_bounce import bounce_errors

from numeric import PinballMap
from symbolic import tables
from verification.maps.exact import ExactMap


def assert_exact(map, where, theta, phi, place=4, turn=8):
    """One bounce: positions and directions are within so many rounding units of the exact map's."""
    position, direction = bounce_errors(map, where, theta, phi, 40)

    assert max(position) <= place
    assert max(direction) <= turn


@pytest.mark.slow
@pytest.mark.parametrize("lam", [0, 1e-300, 0.3, 0.95, 1])
def test_one_bounce_is_right_to_the_last_bits(table, lam):
    map = table.map(lam)
    assert_exact(map, *table.starts(map, 5, seed=int(1e3 * lam)))


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_grazing_flights_are_as_exact_as_others(table, gap):
    map = table.map(0.9)
    where, theta, _ = table.starts(map, 4, seed=8)
    phi = np.where(np.arange(4) % 2 == 0, 1, -1) * (np.pi / 2 - gap)
    assert_exact(map, where, theta, phi)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("kernels", [True, False])
def test_flights_that_leave_the_wall_along_it(gap, kernels):
    """From any place on the wall; they land on the arc next to a join."""
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    y = np.linspace(-0.43, 0.43, 4)
    for side in (1, -1):
        assert_exact(map, np.ones(4, dtype=int), y, np.full(4, side * (np.pi / 2 - gap)))


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8, 1e-11])
def test_flights_that_start_near_the_cusp(gap):
    map = PinballMap("cardioid", lam=0.9)
    phi = np.linspace(-1.5, 1.5, 6)
    theta = np.where(np.arange(6) % 2 == 0, 1, -1) * (np.pi - gap)
    assert_exact(map, np.zeros(6, dtype=int), theta, phi)


@pytest.mark.slow
@pytest.mark.parametrize("miss", [1e-3, 1e-6, 1e-9, 1e-12])
def test_flights_aimed_at_the_cusp(miss):
    map = PinballMap("cardioid", lam=0.9)
    theta = np.linspace(-2.9, 2.9, 6)
    phi = theta / 2 + np.where(np.arange(6) % 2 == 0, 1, -1) * miss
    assert_exact(map, np.zeros(6, dtype=int), theta, phi)


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
    assert_exact(map, np.zeros(theta.size, dtype=int), theta, phi)


@pytest.mark.parametrize("a", ["100", "10000"])
def test_long_ellipses_near_the_tip(a):
    map = PinballMap("ellipse", lam=0.9, a=a)
    theta = np.linspace(-1, 1, 24) * 10 / float(a)
    assert_exact(map, np.zeros(24, dtype=int), theta, np.linspace(-1.5, 1.5, 24))


@pytest.mark.slow
@pytest.mark.parametrize("K", [2, 4, 6])
def test_eggs_of_any_number_of_points(K):
    map = PinballMap("egg", lam=0.9, K=K, alpha=f"{9 / 10 / (K * K + 1):.6f}")
    rng = np.random.default_rng(K)
    assert_exact(map, np.zeros(8, dtype=int), rng.uniform(-3, 3, 8), rng.uniform(-1.4, 1.4, 8))


def test_the_step_itself_is_the_exact_map(table):
    """The same step on 50-digit numbers, with its closed forms, agrees with the definition to 45 digits."""
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
    """A particle as the fields of its table's state, written independently by hand."""
    position, direction = map.family.position, map.family.direction
    half = {"p": mp.cos(ball.theta / 2), "q": mp.sin(ball.theta / 2), "wall": mp.mpf(0)}
    if ball.component:
        half = {"wall": mp.mpf(1), "p": -ball.theta, "q": mp.mpf(0)}
    known = half | {"theta": ball.theta, "phi": ball.phi, "vx": ball.v[0], "vy": ball.v[1]}
    known |= {"ux": mp.cos(ball.theta), "uy": mp.sin(ball.theta)}
    known |= {"cos_phi": mp.cos(ball.phi), "sin_phi": mp.sin(ball.phi)}
    return [known[name] for name in (*position, *direction)]


BENT = tables.parametric("cos(theta) + cos(2*theta)/5", "sin(theta)*exp(cos(theta)/3)")
PEBBLE = tables.from_points(
    [("1.5", "0"), ("0.7", "0.9"), ("-0.7", "0.9"), ("-1.4", "0"), ("-0.7", "-0.9"), ("0.7", "-1")]
)


@pytest.mark.parametrize("table", [BENT, PEBBLE], ids=["formula", "spline"])
@pytest.mark.parametrize("lam", ["0", "0.9"])
def test_flat_landings_are_right_to_the_last_bits(table, lam):
    """Landings 0.01 from tangency, where rounding a residual to double is magnified many times."""
    map = PinballMap(table, lam=lam, kernels=False)
    low, high = map.states.ends[0]
    theta = low + (high - low) * np.array([0.93, 0.71, 0.3, 0.11])
    phi = np.array([1, -1, 1, -1]) * (np.pi / 2 - 0.01) * (lam != "0")
    assert_exact(map, np.zeros(4, dtype=np.int64), theta, phi, place=1)


@pytest.mark.parametrize(
    "table",
    [tables.stadium(), tables.diamond(), tables.sinai(), pytest.param(tables.regular(40), marks=pytest.mark.slow)],
    ids=lambda table: table.name,
)
@pytest.mark.parametrize("lam", ["0", "0.9"])
def test_landings_on_sides_and_arcs_are_right_to_the_last_bits(table, lam):
    """Random flights; in doubles some on the diamond are off by several roundings, those on 40 sides by more."""
    random, count = np.random.default_rng(5), 4 if len(table.components) > 10 else 30
    map = PinballMap(table, lam=lam, kernels=False)
    low, high = np.array(map.states.ends).T
    where = random.integers(0, low.size, count)
    theta = low[where] + (high - low)[where] * random.random(count)
    phi = np.arcsin(random.uniform(-1, 1, count)) * (lam != "0")
    assert_exact(map, where, theta, phi, place=1, turn=4)
