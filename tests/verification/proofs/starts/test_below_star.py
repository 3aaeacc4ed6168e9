"""Orbits that leave the upper join below `lambda*`, and refused statements."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from verification.arithmetic.balls import working
from verification.paper.judges.cuspless_chaos import below
from verification.proofs.corner.corner import ARC, BITS, WALL, enclosed
from verification.proofs.starts.below_star import (
    ANGLE,
    NEXT,
    begins,
    first_hull,
    hulls,
    inner,
    join_orbits_end_on_axis,
)

FOUND = below()
STAR = float(enclosed()[1].mid())


def test_all_that_leaves_the_join_at_small_angles_is_proved_to_converge() -> None:
    assert FOUND.proved


@pytest.mark.parametrize(
    ("changes", "items"),
    [
        ({"ranges": FOUND.ranges[:2]}, {"boxes"}),  # nothing is said from 0.06 on
        ({"ranges": FOUND.ranges[1:]}, {"boxes"}),
        ({"tube": replace(FOUND.tube, cubic=0.2)}, {"core", "exits"}),
        ({"tube": replace(FOUND.tube, entry_tubes=())}, {"exits"}),
    ],
)
def test_each_step_fails_alone(changes: dict, items: set[str]) -> None:
    assert items <= replace(FOUND, **changes).open.keys()


GOOD = {"a": 0.05, "b": 0.5, "c": 0.5, "f": 0.1, "g": 1.5, "h": 2.0}  # inner states stay so, by hand


@pytest.mark.parametrize("side", [ARC, WALL])
@pytest.mark.parametrize(
    "changed",
    [
        {"b": 0.09},  # below K*a: U1 may be negative, where U is
        {"c": 0.09},
        {"b": 1.5, "g": 2.2},  # 0.05*U_END + 1.5*0.03 is more than U_END
        {"g": 3.2},  # V1 may be beyond FAR
        {"b": 1.1},  # 0.8*(g - K*f) is 1.04: U1 may be beyond LEAN*V1
        {"c": 1.5},
        {"a": 0.1},  # a*U_END is more than THICK
        {"g": 0.9},  # V does not grow; of the wall alone
        {"a": -0.05},
        {"f": -0.1},
    ],
)
def test_each_inequality_of_inner_states_fails_alone(side: int, changed: dict[str, float]) -> None:
    """Derivatives by `U`, `V` and `-e` as numbers; the bound 1 for growth is required on the wall only."""

    def rows(of: int, numbers: dict[str, float]) -> list[list[arb]]:
        a, b, c, f, g, h = (arb(numbers[name]) for name in "abcfgh")
        sign = 1 if of == WALL else -1
        return [[a, sign * b, -c], [f, sign * g, -h]]

    depth = arb("0.0024")
    whole = {ARC: rows(ARC, GOOD), WALL: rows(WALL, GOOD)}
    assert inner(whole, depth)
    assert inner(whole | {side: rows(side, GOOD | changed)}, depth) == (changed == {"g": 0.9} and side == ARC)


@pytest.mark.parametrize(
    ("changed", "depth"),
    [
        ((1.8, -0.1), "0.0024"),
        ((1.8, 4.0), "0.0024"),  # K*r is less than c: where U is negative V1 need not be
        ((1.0, 0.9), "0.0024"),  # U may be more than LEAN*V1
        ((1.9, 0.9), "0.0024"),  # V1 may lie before V_LOW
        ((1.8, 0.9), "0.04"),  # beyond V_HIGH with a negative U
    ],
)
def test_each_inequality_of_the_first_landing_fails_alone(changed: tuple[float, float], depth: str) -> None:
    assert begins([arb(1.8), arb(-0.9)], arb("0.0024"))
    assert not begins([arb(changed[0]), arb(-changed[1])], arb(depth))


def test_a_core_that_does_not_hold_the_boxes_that_return_proves_nothing() -> None:
    fate, core = FOUND.ranges[1]
    assert join_orbits_end_on_axis(fate, core)
    assert not join_orbits_end_on_axis(fate, replace(core, outer=0.06))
    assert not join_orbits_end_on_axis(fate, None)  # these boxes do not contract


def test_above_lambda_star_the_inequalities_fail() -> None:
    """The sign of `lam - lambda*` is reversed."""
    with working(BITS):
        depth = enclosed()[1] - arb(NEXT.numerator) / NEXT.denominator
        whole, first = hulls(depth), first_hull(depth)
        assert inner(whole, depth)
        assert begins(first, depth)
        turned = {side: [[a, b, -c] for a, b, c in rows] for side, rows in whole.items()}
        assert not inner(turned, depth)
        assert not inner({ARC: whole[WALL], WALL: whole[ARC]}, depth)
        assert not begins([first[0], -first[1]], depth)


def test_in_float64_such_starts_converge() -> None:
    phi = np.random.default_rng(2).uniform(-ANGLE, ANGLE, 200)
    for lam, good in ((0.03, True), (0.0687, True), (STAR - 1e-4, True), (STAR - 1e-6, True), (STAR + 1e-3, False)):
        end = PinballMap("cuspless", lam=lam).orbit(np.full(200, 2 * pi / 3), phi, 6000, np.zeros(200, dtype=int))
        assert np.all(np.abs(end.phi[-1]) < 1e-6) == good
