"""Linear systems in balls: the solution of each exact system in them is enclosed, and singular ones are refused."""

from itertools import chain

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat
from hypothesis import given
from hypothesis import strategies as st

from verification.arithmetic.balls import working
from verification.arithmetic.linear import approximated, solved


def system(seed: int, size: int, wide: int) -> tuple[list[list[arb]], list[list[arb]], list[fmpq_mat]]:
    """The matrix and two right sides in balls, and exact augmented matrices with entries at the balls' ends."""
    rng = np.random.default_rng(seed)
    middle = rng.integers(-8, 9, (size, size + 2)) * (rng.random((size, size + 2)) < 0.5)
    middle[:, :size] += 12 * np.eye(size, dtype=int)
    balls = [[arb(int(x), 2.0**-wide) if x else arb(0) for x in row] for row in middle]
    ends = []
    for _ in range(4):
        signs = rng.choice([-1, 1], middle.shape) * (middle != 0)
        entries = [[fmpq(int(x)) + fmpq(int(e), 2**wide) for x, e in zip(*pair)] for pair in zip(middle, signs)]  # noqa: B905
        ends.append(fmpq_mat(entries))
    return [row[:size] for row in balls], [row[size:] for row in balls], ends


@given(st.integers(0, 10**6), st.integers(1, 7), st.sampled_from([12, 30, 52, 80]))
def test_the_solutions_of_all_systems_in_the_balls_are_enclosed(seed, size, wide):
    with working(140):
        rows, right, ends = system(seed, size, wide)
        try:
            found = solved(rows, right)
        except ZeroDivisionError:
            assert wide == 12, "narrow balls around a regular matrix are solved"
            return
        for exact in ends:
            entries = exact.tolist()
            matrix, sides = (fmpq_mat([row[part] for row in entries]) for part in (slice(size), slice(size, None)))
            for ball, value in zip(chain(*found), chain(*matrix.solve(sides).tolist()), strict=True):
                assert ball.contains(arb(value))


@pytest.mark.parametrize("wide", [20, 40, 100])
def test_the_balls_are_no_more_than_a_few_times_as_wide_as_they_must_be(wide):
    with working(160):
        rows, right, _ = system(3, 6, wide)
        found = solved(rows, right)
        assert max(x.rad() for row in found for x in row) < 2.0 ** (5 - min(wide, 90))


def test_a_ball_around_0_is_no_zero():
    (first,), (second,) = solved([[arb(1), arb(0, 0.125)], [arb(0), arb(1)]], [[arb(1)], [arb(1)]])
    assert first.contains(0.875)
    assert first.contains(1.125)
    assert second.rad() < 1e-12


def test_what_may_be_singular_is_not_solved():
    one, none = arb(1), arb(0)
    for rows in (
        [[one, one], [one, one]],
        [[one, none], [none, arb(0, 1e-3)]],  # 0 is in the ball, and so is not left out of the matrix
        [[one, none], [none, arb(1e-3, 1e-3)]],
        [[one, none], [none, arb("nan")]],
        [[arb("inf"), none], [none, one]],
    ):
        with pytest.raises(ZeroDivisionError):
            solved(rows, [[arb(1, 1e-3)], [arb(1, 1e-3)]])
    with pytest.raises(ZeroDivisionError):
        solved([[one]], [[arb("nan")]])


def test_rounding_of_floats_counts():
    """A matrix that float64 cannot tell from a singular one is refused; with a determinant of 2**-30 it is solved."""
    with working(200):
        tiny = arb(2) ** -60
        with pytest.raises(ZeroDivisionError):
            solved([[arb(1), arb(1)], [arb(1), 1 + tiny]], [[arb(1)], [arb(1)]])
        found = solved([[arb(1), arb(1)], [arb(1), 1 + arb(2) ** -30]], [[arb(2)], [2 + arb(2) ** -30]])
        assert all(row[0].contains(1) for row in found)


def test_an_approximate_solution_has_the_digits_of_floats():
    rows, right, _ = system(5, 5, 90)
    found = approximated(rows, right)
    for row, sure in zip(found, solved(rows, right), strict=True):
        assert all(abs(x - y) < 1e-12 for x, y in zip(row, sure, strict=True))
    with pytest.raises(ZeroDivisionError):
        approximated([[arb(0)]], [[arb(1)]])
