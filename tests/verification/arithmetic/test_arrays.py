"""Balls in arrays: each operation contains the true value, as computed with balls of many bits."""

import numpy as np
import pytest
from flint import arb, fmpq
from hypothesis import example, given
from hypothesis import strategies as st

from numeric.lowering.program import Program
from verification.arithmetic.arrays import (
    HALF_PI,
    LARGEST,
    UNIT_ERROR,
    ArrayOps,
    BallArray,
    common_part,
    direction,
    exactly,
    hull,
    turned,
)
from verification.arithmetic.balls import working

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=True)
RADII = st.floats(0, 10)
SHARES = st.integers(-16, 16)


def holds(found: BallArray, true: arb) -> bool:
    """Whether the true value is proved to lie in the ball."""
    return bool(abs(true - arb(float(found.m))) <= arb(float(found.r)))


@given(a=NUMBERS, ra=RADII, p=SHARES, b=NUMBERS, rb=RADII, q=SHARES)
def test_sums_products_and_quotients_of_points_lie_in_those_of_balls(a, ra, p, b, rb, q):
    x, y = BallArray(np.array(a), np.array(ra)), BallArray(np.array(b), np.array(rb))
    with working(4000):
        s, t = arb(a) + arb(ra) * p / 16, arb(b) + arb(rb) * q / 16

        assert holds(x + y, s + t)
        assert holds(x - y, s - t)
        assert holds(x * y, s * t)
        assert not np.isfinite((x / y).r) or holds(x / y, s / t)


@given(x=st.floats(-LARGEST, LARGEST, exclude_min=True, exclude_max=True))
def test_sine_and_cosine_err_by_less_than_the_bound(x):
    c, s = turned(BallArray(np.array(x)))
    with working(200):
        errors = [abs(arb(x).cos() - arb(float(c.m))), abs(arb(x).sin() - arb(float(s.m)))]

    assert all(error < UNIT_ERROR / 2 for error in errors)  # the proof has room for rounding twice


def test_three_doubles_hold_a_quarter_turn():
    with working(400):
        assert abs(arb.pi() / 2 - sum(map(arb, HALF_PI))) < arb(2) ** -120


@given(angle=st.floats(-3.1, 3.1), size=st.floats(0.1, 10), r=st.floats(0, 0.05), p=SHARES, q=SHARES)
def test_the_direction_of_every_vector_is_enclosed(angle, size, r, p, q):
    c, s = size * np.cos(angle), size * np.sin(angle)
    found = direction(BallArray(np.array(c), np.array(r)), BallArray(np.array(s), np.array(r)))
    with working(200):
        true = arb.atan2(arb(float(s)) + arb(r) * q / 16, arb(float(c)) + arb(r) * p / 16)
        turns = [true + 2 * k * arb.pi() for k in (-1, 0, 1)]

        assert not np.isfinite(found.r) or any(holds(found, turn) for turn in turns)


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_comparison_has_three_answers(sign):
    straddling, unknown = BallArray(np.array(0.1 * sign), 0.2), BallArray(np.array(1.0 * sign), np.inf)

    for x in (straddling, unknown, BallArray(np.array(np.nan), 0.0), BallArray(np.array(1.0), np.nan)):
        assert not x.positive()
        assert not x.negative()


@given(p=st.integers(-(10**30), 10**30), q=st.integers(1, 10**30))
def test_a_rational_lies_in_its_ball(p, q):
    from fractions import Fraction

    with working(400):
        assert holds(exactly(Fraction(p, q)), arb(fmpq(p, q)))


@given(true=st.floats(-10, 10), offs=st.tuples(*[st.floats(-5, 5)] * 2), mores=st.tuples(*[st.floats(0, 5)] * 2))
def test_a_number_in_two_balls_is_in_their_common_part_which_is_no_wider_than_either(true, offs, mores):
    x, y = (BallArray(np.array(true + off), np.array((abs(off) + more) * 1.001 + 1e-12))
            for off, more in zip(offs, mores, strict=True))  # fmt: skip
    unknown = [BallArray(np.array(m), np.array(r)) for m, r in ((3.0, np.inf), (np.nan, np.inf), (np.nan, np.nan))]
    with working(200):
        assert holds(common_part(x, y), arb(true))
        assert common_part(x, y).r <= min(x.r, y.r) + 1e-13
        for nothing in unknown:
            for found in (common_part(x, nothing), common_part(nothing, x)):  # one where the other knows nothing
                assert holds(found, arb(true))
                assert found.r <= x.r + 1e-13
    for one in unknown:
        assert not any(np.isfinite(common_part(one, nothing).r) for nothing in unknown)


FUNCTIONS = {"exp": arb.exp, "log": arb.log, "atan": arb.atan, "sinh": arb.sinh, "cosh": arb.cosh, "tanh": arb.tanh}
FUNCTIONS |= {"Abs": abs, "root3": lambda x: x.root(3), "root5": lambda x: x.root(5)}


def called(word: str, x: BallArray) -> BallArray:
    """The value of a word of formulas at a ball, computed as in the formula of a table or law."""
    return Program(("x",), ((word, 0),), (1,))(ArrayOps(), x)[0]


@pytest.mark.parametrize("word", FUNCTIONS)
@given(x=st.floats(-30, 30), r=st.sampled_from([0.0, 1e-12, 1e-3, 0.1]), p=SHARES)
@example(x=0.2, r=0.1, p=-16)
@example(x=0.2, r=0.1, p=16)
def test_the_functions_of_a_formula_are_enclosed(word, x, r, p):
    x = abs(x) + 0.5 if word in ("log", "root3", "root5") else x
    found = called(word, BallArray(np.array(x), np.array(r)))
    with working(200):
        assert holds(found, FUNCTIONS[word](arb(x) + arb(r) * p / 16))
        assert r or found.r < 2.0**-44 * max(1.0, abs(float(found.m)), np.exp(abs(x)) * (word in ("sinh", "cosh")))


def test_of_a_logarithm_of_no_positive_number_and_of_a_vast_exponential_nothing_is_known():
    for word, x, r in (("log", -1.0, 0.0), ("log", 1.0, 1.0), ("exp", 700.0, 0.0), ("root3", -1.0, 0.0)):
        assert not np.isfinite(called(word, BallArray(np.array(x), np.array(r))).r)


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize(("low", "high"), [(0.9, 1.1), (0.5, 1.5), (0.2, 1.8), (0.02, 1.98), (-0.1, 1.0), (-0.3, 1.0)])
def test_a_root_is_enclosed_and_one_of_what_may_be_negative_is_unbounded(n, low, high):
    found = called("sqrt" if n == 2 else f"root{n}", hull(np.array([low]), np.array([high])))

    if not np.isfinite(found.r).all():
        assert low < 0.6  # of a wide ball nothing need be known
        return
    assert low > 0
    assert all(found.lower()[0] <= x ** (1 / n) <= found.upper()[0] for x in np.linspace(max(low, 0.0), high, 50))
