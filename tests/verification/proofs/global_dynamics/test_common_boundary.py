"""Two basins on both sides of a stable manifold, and discs that a contraction maps into themselves."""

from dataclasses import replace
from fractions import Fraction
from math import pi, tau
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.cycles.recurrence import Closure
from verification.paper.egg.basins import MIDDLE, beyond_the_crisis
from verification.proofs.global_dynamics import common_boundary
from verification.proofs.global_dynamics.branch import ManifoldSeries
from verification.proofs.global_dynamics.common_boundary import Disc, attracts, disc, entered_around
from verification.proofs.global_dynamics.flights import Slopes
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.rigorous.boxes import Boxes

FOUND = beyond_the_crisis()


def test_a_stable_manifold_bounds_both_basins():
    assert FOUND.proved
    assert all(entered_around(FOUND, k, *point) for k, point in enumerate(MIDDLE))


@pytest.mark.slow
def test_the_orbits_go_to_the_one_triangle_and_not_to_the_other():
    assert {*replace(FOUND, sinks=FOUND.sinks[::-1], turn=FOUND.turn[::-1]).open} == {"first", "second"}
    assert {*replace(FOUND, starts=FOUND.starts[::-1]).open} == {"first", "second"}
    assert not any(entered_around(FOUND, 1 - k, *point) for k, point in enumerate(MIDDLE))


def test_one_cycle_twice_is_no_pair_of_cycles():
    twice = {"sinks": (FOUND.sinks[0],) * 2, "turn": (FOUND.turn[0],) * 2}
    assert {*replace(FOUND, **twice, starts=(0.9, 0.9)).open} == {"apart"}


@pytest.mark.parametrize(
    "change",
    [
        {"radius": 0.04},  # the derivative is no contraction over so wide a disc
        {"radius": 1e-9},  # the centre is no closer to the cycle than that
        {"turn": (Fraction(2, 3), Fraction(1, 3))},  # each triangle goes the other way round
    ],
)
def test_a_disc_that_is_not_taken_into_itself_proves_nothing(change):
    assert "discs" in replace(FOUND, **change).open


def test_below_the_crisis_the_branch_goes_to_no_triangle():
    below = SaddleCycle("triangle of the vertices", (-0.207952,), FOUND.saddle.closure)
    sink = 1.22591248, 0.39269908
    changed = replace(FOUND, lam=Fraction(3, 5), saddle=below, sinks=(sink, (-sink[0], -sink[1])))
    assert {*changed.open} == {"first", "second"}


def test_points_of_a_disc_approach_one_another():
    (one, _), map = FOUND.discs, PinballMap("egg", lam=0.7, alpha="0.08")
    angle = np.linspace(-pi, pi, 50, endpoint=False)
    edge = np.array(one.inverse) @ (one.radius * np.stack([np.cos(angle), np.sin(angle)]))
    next = map.step(one.centre[0] + edge[0], one.centre[1] + edge[1])
    back = np.remainder(next.theta - one.centre[0] - tau / 3 + pi, tau) - pi
    inside = np.linalg.solve(np.array(one.inverse), np.stack([back, next.phi - one.centre[1]]))
    assert np.all(np.hypot(*inside) < one.radius)


def test_a_saddle_is_no_disc():
    assert not attracts(FOUND.map, disc(FOUND.map, (-0.14235898, 0.43119899), 1e-3), tau / 3)


def stub(matrix, image, lost=False):
    """A map with the constant derivative `[[a, b], [c, d]]`, whose image of the centre is `image` up to 1e-9."""
    (a, b, c, d), count = map(float, np.ravel(matrix)), common_boundary.CUT**2
    each = lambda x: BallArray(np.full(count, x))  # noqa: E731
    slopes = Slopes(each(a), each(b), each(-c / d), each(0.0), each(-d), each(0.0))
    boxes = Boxes(np.zeros(1, dtype=int), *(tuple(np.array([x + side * 1e-9]) for side in (-1, 1)) for x in image))
    found = SimpleNamespace(lost=np.zeros(int(lost)), boxes=boxes)
    piece = SimpleNamespace(on=np.arange(count))
    return SimpleNamespace(derivatives=lambda _: ((piece, slopes),), images=lambda _: found)


def test_a_disc_is_taken_into_itself_where_there_is_room():
    """Random matrices in frames of any shape, against singular values, with angles up to whole turns."""
    rng, seen = np.random.default_rng(4), []
    for _ in range(400):
        inverse, centre, radius = rng.uniform(-1, 1, (2, 2)), rng.uniform(-1, 1, 2), rng.uniform(0.05, 1)
        if abs(np.linalg.det(inverse)) < 0.2:
            continue
        m = rng.uniform(-0.6, 0.6, (2, 2))
        norm = np.linalg.svd(np.linalg.solve(inverse, m @ inverse))[1][0]
        off = rng.uniform(-0.1, 0.1, 2) * radius
        spare = radius - norm * radius - np.hypot(*np.linalg.solve(inverse, off))
        turn, whole = rng.uniform(-2, 2), 2 * pi * rng.integers(-2, 3)
        one = Disc(tuple(centre), tuple(map(tuple, inverse)), radius)
        some = stub(m, (centre[0] + turn + whole + off[0], centre[1] + off[1]))
        if abs(spare) > 1e-6 and abs(norm - 1) > 1e-6:
            assert attracts(some, one, turn) is bool(spare > 0)
            seen.append(spare > 0)
            assert not attracts(some, one, turn + 1.0 * np.linalg.norm(inverse) * radius + 0.5)
    assert min(sum(seen), len(seen) - sum(seen)) > 10


def series(*coefficients):
    return SimpleNamespace(c=[acb(x) for x in coefficients])


@pytest.mark.parametrize("side", [1, -1])
def test_points_of_a_branch_are_those_of_its_series(side):
    """Series `1 + 3*z` and `2 - z + z**2` with the factor 4, from `z = 4**(low - 1)` on; phi is the difference."""
    made = SimpleNamespace(factor=acb(4), pair=lambda: (series(1, 3), series(2, -1, 1)))
    map = SimpleNamespace(over=lambda _: SimpleNamespace(angle=lambda before, here: (here - before, None)))
    lows, highs = [0.0, 0.5, 0.25], [0.0, 0.75, 1.0]
    points = ManifoldSeries(made, arb(2) ** -20, 100, map).points(side, lows, highs)
    assert len(points) == 3
    for (theta, phi), low, high in zip(points, lows, highs, strict=True):
        wanted = []
        for share in np.linspace(low, high, 9):
            z = side * 4 ** (share - 1)
            wanted.append((1 + 3 * z, 2 - z + z * z - (1 + 3 * z)))
        for ball, some, slack in zip((theta, phi), np.transpose(wanted), (2.0**-20, 2.0**-19), strict=True):
            least, most = float(ball.lower()), float(ball.upper())
            assert least < some.min() - 0.9 * slack
            assert some.max() + 0.9 * slack < most
            assert most - least < 3 * np.ptp(some) + 2.2 * slack


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"side": 0}, "side = 0"), ({"side": 2}, "side = 2"), ({"lam": Fraction(0)}, "lam = 0"),
        ({"lam": Fraction(1)}, "lam = 1"), ({"turn": (Fraction(1, 3), Fraction(1, 4))}, "must be a symmetry"),
        ({"turn": (Fraction(1, 2), Fraction(2, 3))}, "must be a symmetry"),
        ({"scene": Scene("egg", alpha="0.08", law="-lam*sin(eta)")}, "one smooth closed curve"),
        ({"scene": Scene("cuspless")}, "one smooth closed curve"),
        ({"saddle": replace(FOUND.saddle, start=FOUND.saddle.start * 2)}, "must be a symmetry"),
        ({"saddle": replace(FOUND.saddle, closure=Closure(-1, FOUND.saddle.closure.shift))}, "must be a symmetry"),
        ({"saddle": replace(FOUND.saddle, closure=Closure(1, (1, 4)))}, "must be a symmetry"),
    ],
)  # fmt: skip
def test_each_hypothesis_of_a_common_boundary_is_asked_when_it_is_stated(changes, said):
    with pytest.raises(ValueError, match=said):
        replace(FOUND, **changes)
    again = replace(FOUND, side=-FOUND.side, turn=(Fraction(4, 3), Fraction(-1, 3)))
    assert again.turns == (0, Fraction(1, 3), Fraction(2, 3))
