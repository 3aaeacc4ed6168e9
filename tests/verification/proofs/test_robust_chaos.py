"""Border collisions with robust chaos: the hypotheses in balls, against orbits and eigenvectors."""

from dataclasses import replace

import numpy as np
import pytest
from flint import arb

from verification.named.locate import locate
from verification.proofs.corner.border_collision import (
    AffinePiece,
    FixedPointChange,
    Pieces,
    homoclinic,
    hypotheses,
    kind,
    robust,
)
from verification.proofs.corner.corner import ARC, WALL
from verification.proofs.corner.half_return import limit


def normal_form(left: tuple[float, float], right: tuple[float, float], spread: float = 0.0) -> Pieces:
    """The border collision normal form with these traces and determinants; `v` is its first coordinate."""
    balls = arb(left[0]), arb(right[0], spread)
    made = [
        AffinePiece(((arb(0), -arb(d)), (arb(1), t)), (arb(0), arb(1)))
        for t, (_, d) in zip(balls, (left, right), strict=True)
    ]
    return {ARC: made[0], WALL: made[1]}


def fold_beyond_the_stable_line(left: tuple[float, float], right: tuple[float, float]) -> float:
    """How far beyond the stable line of `Y` the unstable line is folded; affine in the right trace."""
    step = np.array([[left[0], 1], [-left[1], 0]])
    y = np.linalg.solve(np.eye(2) - step, [1, 0])
    values, vectors = np.linalg.eig(step)
    stable, unstable = vectors[:, np.argmin(values)], vectors[:, np.argmax(values)]
    corner = y - unstable * y[0] / unstable[0]
    tip = np.array([corner[1] + 1, 0])
    fold = np.array([right[0] * tip[0] + 1, -right[1] * tip[0]]) - y
    side = fold[0] * stable[1] - fold[1] * stable[0]
    return float(-side / stable[1])


def followed(left: tuple[float, float], right: tuple[float, float], steps: int) -> tuple[float, float]:
    """The share of 100 orbits that stay bounded, and the least exponent of those."""
    x, y = np.random.default_rng(1).uniform(0, 1, 100), np.zeros(100)
    p, q, rate = np.ones(100), np.zeros(100), np.zeros(100)
    for _ in range(steps):
        t, d = (np.where(x < 0, a, b) for a, b in zip(left, right, strict=True))
        x, y = np.clip(t * x + y + 1, -1e6, 1e6), -d * x
        p, q = t * p + q, -d * p
        size = np.hypot(p, q)
        p, q, rate = p / size, q / size, rate + np.log(size)
    return float(np.mean(np.abs(x) < 1e5)), float(rate.min()) / steps


@pytest.mark.slow
@pytest.mark.parametrize(("left", "d"), [((1.1718, 0.00588), 0.00588), ((1.6, 0.3), 0.3), ((1.3, 0.05), 0.8)])
def test_robust_chaos_ends_where_the_manifolds_meet(left, d):
    """Just inside the boundary from eigenvectors orbits stay and stretch, and just outside all of them leave."""
    at = [fold_beyond_the_stable_line(left, (t, d)) for t in (-1.0, -2.0)]
    edge = -1 - at[0] / (at[0] - at[1])
    least = min(np.log(max(np.roots([1, -left[0], left[1]]))), np.log(-min(np.roots([1, -edge, d]))))

    assert robust(normal_form(left, (edge + 1e-9, d))) is True
    assert robust(normal_form(left, (edge - 1e-9, d))) is False
    assert robust(normal_form(left, (edge, d), 1e-6)) is None
    stay, rate = followed(left, (edge + 0.005, d), 6000)
    assert stay == 1
    assert rate > least - 1e-3
    assert followed(left, (edge - 0.1, d), 12_000)[0] == 0


def test_traces_beyond_one_plus_det_are_not_enough_for_robust_chaos():
    left, right = (1.1718, 0.00588), (-9.0, 0.00588)

    assert robust(normal_form(left, right)) is False
    assert hypotheses(normal_form(left, right))["unstable_manifold_short_of_the_stable_one"] is False
    assert followed(left, right, 2000)[0] == 0


@pytest.mark.parametrize(
    ("left", "right", "broken"),
    [
        ((1.5 - 1e-9, 0.5), (-1.8, 0.5), "left_trace_above_1_plus_det"),
        ((1.7, 0.5), (-1.5 + 1e-9, 0.5), "right_trace_below_minus_1_minus_det"),
        ((2.3, 1.1), (-1.6, 0.5), "determinants_between_0_and_1"),
        ((1.7, 0.5), (-1.6, -0.1), "determinants_between_0_and_1"),
    ],
)
def test_every_hypothesis_of_robust_chaos_is_asked_for(left, right, broken):
    found = hypotheses(normal_form(left, right))

    assert found[broken] is False
    assert robust(normal_form(left, right)) is False


def test_robust_chaos_is_on_the_side_of_the_fixed_points():
    forwards = normal_form((1.6, 0.3), (-2.0, 0.3))
    backwards = {side: replace(piece, shift=(arb(0), arb(-1))) for side, piece in forwards.items()}
    mirrored = {
        WALL: replace(forwards[ARC], shift=(arb(0), arb(-1))),
        ARC: replace(forwards[WALL], shift=(arb(0), arb(-1))),
    }

    assert kind(forwards) is kind(backwards) is FixedPointChange.FOLD
    assert [robust(found) for found in (forwards, backwards, mirrored)] == [True, False, True]


def test_the_corner_orbit_meets_the_hypotheses_with_room():
    found = hypotheses(limit())

    assert len(found) == 5
    assert set(found.values()) == {True}
    assert abs(homoclinic(limit()[WALL], limit()[ARC]) - 0.934) < 1e-3
    assert locate("lambda-star", 15).certified
