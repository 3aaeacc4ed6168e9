"""Proofs by balls: sound, with three outcomes, and false statements are refused."""

import math
from dataclasses import replace

import flint
import pytest
from flint import arb
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Interval, Rational

from symbolic.tables import cardioid, cuspless, egg, ellipse
from verification.arithmetic.balls import balls, exact_balls, working
from verification.cycles.critical import corner
from verification.cycles.newton import refined
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.named.locate import proof_near
from verification.proofs.periodic.cycle_in_box import cycle_in_box
from verification.proofs.periodic.interval_newton import (
    Enclosure,
    ZeroStatus,
    compared,
    interval_newton,
    stepped,
)

AXIS = Problem(ellipse.at(a=Rational(3, 2)), (0, 0), lam=Rational(1, 3))
EGG = egg(3).at(alpha=Rational(2, 25))


TRIANGLES = Problem(EGG, (0, 0, 0), BifurcationKind.FOLD, "lam")
FOLD = TRIANGLES, exact_balls(refined(TRIANGLES, [-0.55, 1.54, 3.63, 0.378], 40).z)


def half_pi(bits: int) -> arb:
    with working(bits):
        return (arb.pi() / 2).mid()


SCENES = {  # table, the letter that is free, and its range
    "egg": (egg(3), "alpha", 0.001, 0.1),
    "pentagon": (egg(5), "alpha", 0.001, 0.03),
    "ellipse": (ellipse, "a", 1.01, 4.0),
    "cardioid": (cardioid, "lam", 0.01, 0.99),
    "cuspless": (cuspless, "lam", 0.01, 0.99),
}
SHARES = st.floats(0.01, 0.99)


CRITICAL = [BifurcationKind.FOLD, BifurcationKind.FLIP]


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(st.sampled_from(sorted(SCENES)), st.sampled_from(CRITICAL), SHARES, st.lists(SHARES, min_size=3))
@example("egg", BifurcationKind.FLIP, 0.5, [0.5, 0.5, 0.5])
@example("cardioid", BifurcationKind.FOLD, 0.01, [0.99, 0.01, 0.5, 0.5])
def test_the_ball_at_128_bits_contains_the_one_at_1024_bits_and_never_the_other_way(scene, kind, share, gaps):
    table, letter, low, high = SCENES[scene]
    gaps = gaps[:5]
    reach = 2.0 if scene == "cuspless" else math.pi
    theta = [reach * (2 * sum(gaps[:i]) / sum(gaps) - 1) + 1e-3 for i in range(len(gaps))]
    lam = None if letter == "lam" else arb(share)
    problem = Problem(table, (0,) * len(gaps), kind, letter, lam)
    z = [arb(x) for x in (*theta, low + share * (high - low))]
    found = []
    for bits in (128, 1024):
        with working(bits):
            at = Linearised(problem, balls(bits), z)
            found.append([*at.value, *at.solve(at.value), at.corner])
    for wide, narrow in zip(*found, strict=True):
        if wide.is_finite():
            assert wide.contains(narrow)
            assert wide.is_exact() or not narrow.contains(wide)


@settings(max_examples=60)
@given(st.floats(1e-6, 0.4), st.floats(-1, 1), st.floats(-1, 1), st.floats(1e-12, 1e-2))
def test_a_wrong_box_is_never_certified(distance, u, v, radius):
    if max(abs(u), abs(v)) < 0.1:
        u = 1.0
    shift = distance + 2 * radius
    scale = shift / max(abs(u), abs(v))
    x = half_pi(100)
    with working(100):
        centre = [(x + u * scale).mid(), (-x + v * scale).mid()]
        holds = all(abs(c - e) < radius for c, e in zip(centre, (x, -x), strict=True))
    found = interval_newton(AXIS, centre, arb(radius), 100)

    assert not holds
    if found.status is ZeroStatus.UNIQUE:  # there is another zero: the other axis is one
        with working(100):
            assert not all(abs(c - e) < radius for c, e in zip(found.zero, (x, -x), strict=True))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4), st.floats(1e-9, 1e-3), st.floats(1.5, 20))
def test_a_wrong_box_of_a_fold_is_never_certified(way, radius, distance):
    """The fold of the egg's triangles, from 40 digits in mpmath, lies outside by at least half the box's radius."""
    problem, solution = FOLD
    size = max(abs(x) for x in way)
    if size < 0.1:
        way, size = [1.0, 0.0, 0.0, 0.0], 1.0
    with working(160):
        off = [(x + w / size * distance * radius).mid() for x, w in zip(solution, way, strict=True)]
        found = interval_newton(problem, off, arb(radius), 160)

        assert found.status is not ZeroStatus.UNIQUE or not all(
            z.overlaps(x) for z, x in zip(found.zero, solution, strict=True)
        )


def test_the_three_answers_all_occur_and_a_proved_zero_is_the_exact_one():
    x = half_pi(200)
    with working(200):
        centre, off, exact = [x, (-x).mid()], [(x + 0.01).mid(), (-x).mid()], arb.pi() / 2
        found = interval_newton(AXIS, centre, arb("1e-9"), 200)
        assert found.status is ZeroStatus.UNIQUE
        assert found.zero[0].overlaps(exact)
        assert found.zero[1].overlaps(-exact)
    assert interval_newton(AXIS, centre, arb("1e-3"), 200).status is ZeroStatus.UNIQUE
    assert interval_newton(AXIS, off, arb("1e-3"), 200).status is ZeroStatus.EMPTY
    assert interval_newton(AXIS, centre, arb(2), 200).status is ZeroStatus.UNKNOWN


def test_no_precision_is_left_behind():
    before = flint.ctx.prec
    proof_near(Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam"), [0.0, 0.0, 0.0934], 40)

    assert flint.ctx.prec == before


def test_the_cuspless_orbit_doubles_subcritically():
    proof = proof_near(Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam"), [0.0, 0.0, 0.0934], 30)

    assert proof.proved
    assert proof.supercritical is False


@pytest.mark.slow
def test_a_value_outside_the_range_of_its_parameter_is_not_admissible():
    """The equations have a solution there, but there is no table."""
    doubling = Problem(egg(3), (0, 0), BifurcationKind.FLIP, "alpha", Rational(1, 2))
    found = proof_near(doubling, [0.0, math.pi, 0.05], 20)
    narrow = Interval(0, Rational(1, 100))
    beyond = replace(doubling, table=replace(egg(3), shapes=(replace(egg(3).shapes[0], range=narrow),)))

    assert found.proved
    assert found.value > 0.02
    assert replace(found, problem=beyond).checks["admissible"] is None


def test_a_fold_is_no_flip():
    fold = proof_near(Problem(EGG, (0, 0, 0), BifurcationKind.FOLD, "lam"), [-0.55, 1.54, 3.63, 0.378], 30)
    as_flip = replace(fold, problem=replace(fold.problem, kind=BifurcationKind.FLIP))

    assert fold.proved
    assert as_flip.checks["unique"] is not True


def test_a_claim_with_too_few_bits_is_unknown_and_not_refuted():
    solution = refined(corner(), [0.25, 0.07], 30)
    centre = exact_balls(solution.z)
    proof = interval_newton(corner(), centre, arb("1e-28"), 60)

    assert proof.status is ZeroStatus.UNKNOWN


def test_a_proof_needs_every_item():
    x = half_pi(120)
    with working(120):
        proof = cycle_in_box(AXIS, (x, (-x).mid()), arb("1e-6"), 120, 200)

    assert proof.checks["unique"] is True
    assert proof.checks["precise"] is not True
    assert not proof.proved


@pytest.mark.parametrize(
    ("image", "status"),
    [
        (["0.1", "0.9 +/- 0.05"], ZeroStatus.UNIQUE),
        (["0.1", "0.9 +/- 0.1001"], ZeroStatus.UNKNOWN),  # reaches an end
        (["0.1", "1.5 +/- 0.4"], ZeroStatus.EMPTY),
        (["5", "nan"], ZeroStatus.UNKNOWN),
        (["0", "1 +/- 0.5"], ZeroStatus.UNKNOWN),
        (["-1.01", "0"], ZeroStatus.EMPTY),
    ],
)
def test_a_box_holds_one_zero_when_the_image_lies_inside_and_none_when_they_are_apart(image, status):
    box = [arb(0, 1), arb(0, 1)]
    balls_of = [arb(x) for x in image]

    assert compared(balls_of, box) is status
    centre = [arb("0.25"), arb("-0.5")]
    step = stepped(centre, box, lambda: [c - y for c, y in zip(centre, balls_of, strict=True)])
    assert step.status in (status, ZeroStatus.UNKNOWN)
    assert all(x.overlaps(y) for x, y in zip(step.zero, balls_of, strict=True) if y.is_finite())

    def singular():
        raise ZeroDivisionError

    assert stepped(centre, box, singular) == Enclosure(ZeroStatus.UNKNOWN, box)
