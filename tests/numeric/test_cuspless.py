"""The cuspless table's step: arc and wall, from and to each, and what rounding does near the joins."""

import numpy as np
import pytest

from numeric import PinballMap, Status

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
    """Of 40,000 random balls 3.9 % do, of those that leave along the normal none."""
    assert unsettled(cuspless(0.5)) <= 0.043
    assert unsettled(cuspless(0.5), slap=True) <= 0.002


def test_tangent_balls_stop_where_they_are():
    steep = np.nextafter(np.pi / 2, 0)
    step = cuspless(0.9).step([0.3, 0.3, 0.1], [steep, -steep, 0.3], [0, 0, 1])

    assert list(step.status) == [Status.GRAZING, Status.GRAZING, Status.REGULAR]


def test_a_bounce_takes_the_operations_of_the_page(as_on_the_page):
    as_on_the_page("cuspless")
