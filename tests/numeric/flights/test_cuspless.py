"""The cuspless table's step: arc and wall, from and to each, and what rounding does near the joins."""

import numpy as np
import pytest
from attacks.joins import past_joins

from numeric import PinballMap, Status
from numeric.backends.scalars import ArrayBackend
from numeric.flights.cuspless import Cuspless
from numeric.pinball.sampling import phase_starts

SIGN = np.where(np.arange(24) % 2 == 0, 1, -1)
LAWS = [0, 0.3, 1]
JOIN = 2 * np.pi / 3
TOP = np.sqrt(3) / 4


def cuspless(lam):
    return PinballMap("cuspless", lam=lam, kernels=False)


@pytest.mark.parametrize("lam", LAWS)
@pytest.mark.parametrize("wall", [0, 1])
def test_anywhere(lam, wall, rounding):
    rng = np.random.default_rng(5)
    theta = rng.uniform(-0.999, 0.999, 24) * (TOP if wall else JOIN)
    place, direction = rounding(cuspless(lam), np.full(24, wall), theta, rng.uniform(-1.4, 1.4, 24) * (lam > 0))

    assert place <= 3
    assert direction <= 8


@pytest.mark.parametrize("lam", [0.95, 1])
def test_the_steps_of_halleys_method_leave_hardly_a_flight_to_be_bracketed(lam, monkeypatch):
    """Blocks of 32 lanes need not go there: of 16,000 flights from everywhere at most one in a thousand does."""
    bracketed, whole = [], ArrayBackend.repeat

    def counted(self, condition, body, state, limit, steady=False):
        bracketed.append(np.sum(condition(state)))
        return whole(self, condition, body, state, limit, steady)

    monkeypatch.setattr(ArrayBackend, "repeat", counted)
    map = cuspless(lam)
    starts = phase_starts(map, 4000, seed=11)
    map.orbit(starts.theta, starts.phi, 4, starts.component)

    assert np.sum(bracketed) <= 16


@pytest.mark.parametrize("near", [False, True])
def test_no_flight_past_a_join_lands_on_the_wrong_side_and_only_those_near_one_stop(near):
    """Missed by up to thirty units; `benchmarks/torture.py joins` does the same with millions."""
    found = past_joins(20_000, 30, near, kernels=False, seed=7)

    assert not np.any(found.wrong)
    assert 0.05 < np.mean(found.stopped) < 0.5
    assert np.max(found.miss[found.stopped]) < 10


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-9])
@pytest.mark.parametrize("wall", [0, 1])
def test_starting_near_a_join(gap, wall, rounding):
    theta = SIGN * ((TOP if wall else JOIN) - gap)
    place, direction = rounding(cuspless(0.9), np.full(24, wall), theta, np.linspace(-1.2, 1.2, 24))

    assert place <= 4
    assert direction <= 8


@pytest.mark.parametrize("miss", [1e-1, 1e-2, 1e-5, 1e-9])
def test_from_the_wall_along_it_to_the_join_next_to_it(miss, rounding):
    """From farther away such a flight is sensitive: the landing moves by the inverse of the miss."""
    theta = SIGN * (TOP - np.linspace(1e-4, 0.05, 24))
    place, direction = rounding(cuspless(0.9), np.ones(24, dtype=int), theta, SIGN * (np.pi / 2 - miss))

    assert place <= 4
    assert direction <= 8


@pytest.mark.parametrize("lam", LAWS)
def test_flights_are_straight_and_inside_from_every_place_to_every_other(lam, bounced):
    theta = np.concatenate([np.repeat(np.linspace(-2.09, 2.09, 40), 40), np.repeat(np.linspace(-0.43, 0.43, 40), 40)])
    where = np.repeat([0, 1], 1600)
    phi = np.tile(np.linspace(-1.56, 1.56, 40), 80) * (lam > 0)
    found = bounced(cuspless(lam), where, theta, phi)

    assert np.max(found.off_the_line) <= 64 * 2.0**-52
    assert np.min(found.length) > 0
    assert np.min(found.depth) > -64 * 2.0**-52
    assert np.max(found.turned * np.cos(found.eta)) <= 1e-13
    assert {(a, b) for a, b in zip(where.tolist(), found.where.tolist(), strict=True)} >= {(0, 0), (0, 1), (1, 0)}
    assert (1, 1) not in set(zip(where.tolist(), found.where.tolist(), strict=True))


@pytest.mark.parametrize("at", [0.0, 1.0, -1.2])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_landing_within_rounding_of_a_join_is_one_and_no_other_is(at, sign):
    """From the arc to a join, and past it by 1e-9 to either side, on the arc or on the wall."""
    map = cuspless(0.9)
    x, y = map.states.point(np.array(0), np.array(at))
    aim = np.arctan2(sign * TOP - y, -0.25 - x)
    phi = map.states.angle_to_normal(np.array(0), np.array(at), np.cos(aim), np.sin(aim))
    codes = [int(map.step(at, float(phi) + miss).code) for miss in (0.0, 1e-9, -1e-9)]

    assert codes[1:] == [0, 0]
    assert {int(map.step(at, float(phi) + k * 2.0**-53).code) for k in range(-12, 13)} >= {1}
    assert {int(map.step(at, float(phi) + miss).component) for miss in (1e-9, -1e-9)} == {0, 1}


def test_few_flights_need_the_bracket(unsettled):
    """Of 40,000 random particles 3.9 % do, of those that leave along the normal none."""
    assert unsettled(cuspless(0.5)) <= 0.043
    assert unsettled(cuspless(0.5), slap=True) <= 0.002


def test_few_flights_from_the_wall_are_near_grazing(unsettled):
    """At the wall or, next to a join, at the arc: of random particles 0.04 %."""
    assert 0 < unsettled(cuspless(0.5), branch=1) <= 0.001
    assert unsettled(cuspless(0.5), slap=True, branch=1) == 0


def test_few_flights_are_sharpened(unsettled):
    """Of 40,000 random particles 0.17 %; the branch before it is the bracket of what is near-grazing."""
    assert 0.001 <= unsettled(cuspless(0.5), branch=3) <= 0.0025
    assert unsettled(cuspless(0.5), slap=True, branch=2) == 0


def test_tangent_particles_stop_where_they_are():
    steep = np.nextafter(np.pi / 2, 0)
    step = cuspless(0.9).step([0.3, 0.3, 0.1], [steep, -steep, 0.3], [0, 0, 1])

    assert list(step.status) == [Status.GRAZING, Status.GRAZING, Status.REGULAR]


def test_a_bounce_takes_the_operations_of_the_page(as_on_the_page):
    as_on_the_page("cuspless")


NEAR_GRAZING = np.array([  # theta and phi of the worst of a million random particles, as in test_accuracy
    (-1.95277363, -1.37612652), (-0.670208058, -0.25451718), (1.25956245, 0.694918384), (2.0943, 1.5705),
    (1.6162036187902906, 1.0014056098562036), (-1.6335621826646394, -1.0183761112721677), (2.01866398, 1.45999368),
    (-1.9531, -1.3763), (1.9172456314571602, 1.3024506414317365), (-1.6527902530959695, -1.0372593151405034),
]).T  # fmt: skip


def test_flights_along_the_wall_keep_their_digits(rounding):
    theta, phi = NEAR_GRAZING
    place, direction = rounding(cuspless(0.95), np.zeros(theta.size, dtype=int), theta, phi)

    assert place <= 4
    assert direction <= 8


@pytest.mark.parametrize("lam", LAWS)
def test_the_derivative_is_the_papers_matrix(lam, bounced):
    theta = np.concatenate([np.linspace(-2.0, 2.0, 60), np.linspace(-0.42, 0.42, 60)])
    where, phi = np.repeat([0, 1], 60), np.tile(np.linspace(-1.2, 1.2, 12), 10) * (lam > 0)
    map = cuspless(lam)
    formula = bounced(map, where, theta, phi).matrix(lam, phi)
    size = 1 + np.max(np.abs(formula), axis=(1, 2))[:, None, None] ** 2

    assert np.max(np.abs(map.derivative(theta, phi, where) - formula) / size) <= 1e-12


@pytest.mark.parametrize("sign", [1, -1])
def test_joins_are_joins_from_either_side(sign):
    """Flights from many places to a join and past it are stopped within 2^-50 of the way, up to rounding."""
    at = np.repeat(np.linspace(-1.0, 1.0, 41), 81)
    radius = 2 * np.cos(at / 2) ** 2
    x, y = radius * np.cos(at), radius * np.sin(at)
    phi = 1.5 * at + np.pi - np.arctan2(sign * TOP - y, -0.25 - x) + np.tile(np.arange(-40, 41), 41) * 2.0**-53
    phi = np.remainder(phi + np.pi, 2 * np.pi) - np.pi
    zero = 0 * at
    with np.errstate(all="ignore"):
        landing = Cuspless().fly(
            ArrayBackend(), [], "pinball", [zero, np.cos(at / 2), np.sin(at / 2)], [np.cos(phi), np.sin(phi)]
        )
    wall, p, q = landing.position
    off = np.where(wall == 1, np.abs(np.abs(p) - TOP), np.abs(np.abs(q) - np.sqrt(3.0) * p))
    way = 2 * np.sin(JOIN / 2 - sign * at / 2)
    aside = off * landing.along / way * 2.0**50

    assert set(landing.code) == {0.0, 1.0}
    assert np.max(aside[landing.code == 1]) <= 1.6
    assert np.min(aside[landing.code == 0]) >= 0.4
    for side in (0, 1):
        assert 20 < np.sum((landing.code == 1) & (wall == side)) < 1600
