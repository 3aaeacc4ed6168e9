"""What leaves the upper join below `lambda*`, and what is refused."""

from dataclasses import replace
from math import pi, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from verification.arithmetic.balls import working
from verification.paper.judges.cuspless_chaos import below
from verification.proofs.corner.corner import ARC, BITS, WALL, enclosed
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.fates import Cluster
from verification.proofs.starts import below_star
from verification.proofs.starts.below_star import ANGLE, NEXT, BelowStar, begins, first_hull, hulls, inner

FOUND = below()
STAR = float(enclosed()[1].mid())


def failing(found: BelowStar) -> set[str]:
    """The checks that are not proved."""
    return {name for name, held in found.checks.items() if held is not True}


def test_all_that_leaves_the_join_at_small_angles_is_proved_to_converge() -> None:
    assert FOUND.proved


@pytest.mark.parametrize(
    ("changes", "items"),
    [
        ({"fates": FOUND.fates[:2]}, {"boxes"}),  # nothing is said from 0.06 on
        ({"fates": FOUND.fates[1:]}, {"boxes"}),
        ({"core": replace(FOUND.core, cubic=0.2)}, {"core", "exits"}),
        ({"core": replace(FOUND.core, gates=())}, {"exits"}),
    ],
)
def test_each_step_fails_alone(changes: dict, items: set[str]) -> None:
    assert items <= failing(replace(FOUND, **changes))


@pytest.mark.parametrize(
    ("name", "value", "items"),
    [
        ("V_HIGH", 0.02, {"exits"}),  # nearer to the join than the core comes
        ("K", 0.1, {"starts"}),
        ("K", 9.0, {"inner"}),
        ("BESIDE", 0.03, {"starts"}),
        ("BESIDE", 1e-3, {"carried"}),  # next to the join sets do not come to the core in time, or lie on both sides
    ],
)
def test_other_inequalities_do_not_hold(monkeypatch, name: str, value: float, items: set[str]) -> None:
    monkeypatch.setattr(below_star, name, value)
    assert items <= failing(replace(FOUND, fates=()))


def test_boxes_come_to_the_cycle_that_lie_in_a_sink_and_meet_no_other_part() -> None:
    """On the same component; a rectangle that has one point of another part is none."""

    def part(chart: int, sink: bool, *ends: float) -> Cluster:
        left, right, low, high = (np.array([end]) for end in ends)
        return Cluster(Boxes(np.array([chart]), (left, right), (low, high)), sink, None)

    def inside(chart: int, *ends: float) -> bool:
        return below_star._within(part(chart, True, *ends).boxes, parts)

    parts = [
        part(1, True, 0, 4, 0, 4),
        part(0, False, 1, 2, 1, 2),
        part(1, False, 5, 6, 0, 4),
        part(1, False, 1, 2, 1, 2),
    ]
    for ends in ((2.5, 4, 0, 4), (0, 0.5, 0, 4), (0, 4, 2.5, 4), (0, 4, 0, 0.5)):  # on each side of the other part
        assert inside(1, *ends)
        assert not inside(0, *ends)
    for ends in ((2, 4, 0, 4), (0, 1, 0, 4), (0, 4, 2, 4), (0, 4, 0, 1), (1.2, 1.5, 1.2, 1.5)):  # that it touches
        assert not inside(1, *ends)
    for ends in ((2.5, 4.1, 0, 4), (-0.1, 0.5, 0, 4), (0, 4, 2.5, 4.1), (0, 4, -0.1, 0.5)):  # and beyond the sink
        assert not inside(1, *ends)
    boxes = Boxes(np.array([1, 1]), (np.array([2.5, 1.5]), np.array([4.0, 2.0])), (np.zeros(2), np.full(2, 4.0)))
    assert not below_star._within(boxes, parts)  # all of them must


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
    """Derivatives by `U`, `V` and `-e`, in numbers; a growth below 1 is asked of the wall alone."""

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


def test_a_core_that_holds_no_cells_and_a_graph_that_returns_elsewhere_prove_nothing(monkeypatch) -> None:
    fate, core = FOUND.fates[1]
    assert below_star.unreturning(fate, core)
    assert not below_star.unreturning(fate, replace(core, outer=0.06))
    assert not below_star.unreturning(fate, None)  # these boxes do not contract
    monkeypatch.setattr(below_star, "MIDDLE", 0.01)  # boxes return farther from the middle of the arc
    assert not below_star.unreturning(fate, core)


@pytest.mark.parametrize(
    ("parts", "sinks", "core"), [(None, True, None), ([], None, None), ([], False, None), (None, True, FOUND.core)]
)
def test_without_parts_or_without_a_contraction_of_all_boxes_nothing_is_said(parts, sinks, core) -> None:
    assert not below_star.unreturning(SimpleNamespace(parts=parts, checks={"sinks": sinks}), core)


def test_above_lambda_star_the_fixed_points_are_there_and_nothing_is_moved_on() -> None:
    """With the sign of `lam - lambda*` turned the inequalities fail."""
    with working(BITS):
        depth = enclosed()[1] - arb(NEXT.numerator) / NEXT.denominator
        whole, first = hulls(depth), first_hull(depth)
        assert inner(whole, depth)
        assert begins(first, depth)
        turned = {side: [[a, b, -c] for a, b, c in rows] for side, rows in whole.items()}
        assert not inner(turned, depth)
        assert not inner({ARC: whole[WALL], WALL: whole[ARC]}, depth)
        assert not begins([first[0], -first[1]], depth)


def test_in_float64_such_starts_converge_and_a_little_above_lambda_star_some_do_not() -> None:
    phi = np.random.default_rng(2).uniform(-ANGLE, ANGLE, 200)
    for lam, good in ((0.03, True), (0.0687, True), (STAR - 1e-4, True), (STAR - 1e-6, True), (STAR + 1e-3, False)):
        end = PinballMap("cuspless", lam=lam).orbit(np.full(200, 2 * pi / 3), phi, 6000, np.zeros(200, dtype=int))
        assert np.all(np.abs(end.phi[-1]) < 1e-6) == good


def test_next_to_the_corners_the_landing_moves_along_the_wall() -> None:
    """Of successive bounces in float64: `V1 > V` from `V > 0`, and `U1`, `V1` in their bounds."""
    theta1, count = float(enclosed()[0].mid()), 0
    for lam in (0.0688, 0.0705, STAR - 1e-5):
        phi = np.linspace(-0.04, -0.017, 200)
        orbit = PinballMap("cuspless", lam=lam).orbit(np.full(200, 2 * pi / 3), phi, 40, np.zeros(200, dtype=int))
        edge = np.where(orbit.component == 0, 2 * pi / 3, -sqrt(3) / 4)
        for k in range(2, 38):
            for sign in (1, -1):  # mirrored, half the return leads from a state to one of the same form
                u, v = sign * orbit.theta[k - 1] + theta1, sign * orbit.theta[k] - edge[k]
                u1, v1 = -sign * orbit.theta[k + 1] + theta1, -sign * orbit.theta[k + 2] - edge[k + 2]
                held = (orbit.component[k - 1] == 0) & (np.abs(u) < 0.045) & (v > -0.03) & (v < 0.0285)
                count += held.sum()
                assert np.all((u1[held] > 0) & (v1[held] > 0) & (v1[held] < 0.1))
                assert np.all(v1[held & (v > 0) & (u >= 0)] > v[held & (v > 0) & (u >= 0)])
                assert np.all(u1[held] < 0.8 * v1[held] + 0.004)
    assert count > 1000
