"""Condition numbers and errors of Newton's solutions, against the inverse matrix and a hundred digits."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from sympy import Rational

from symbolic.tables import egg
from verification.arithmetic.balls import FLOAT64
from verification.cycles.newton import (
    Conditioning,
    UnsettledError,
    in_floats,
    largest_row_sum,
    norm_of_inverse,
    refined,
)
from verification.cycles.problem import Problem
from verification.measure.extremes import near

FINE = partial(near.nearly_round, near.FINE_GAP)
TWICE = partial(near.nearly_flipped, near.FLIP_GAP, twice=True)
ONCE = partial(near.nearly_flipped, near.FLIP_GAP, twice=False)
TOUCHING = partial(near.touching, near.FOLD_GAP)
SOLVED = {
    "a cycle": partial(near.folded, 4),
    "a fold": partial(near.folded, None),
    "nearly round": partial(near.nearly_round, near.COARSE_GAP),
    "in the cascade": partial(near.in_the_cascade, 4),
}
NEAR = {"almost round": FINE, "almost a flip": ONCE, "almost a fold": TOUCHING}


def row_sum(problem: Problem, z: list[float]) -> float:
    units = np.eye(len(z)).tolist()
    return float(np.abs(np.array([problem.solved(FLOAT64, z, unit) for unit in units])).sum(axis=0).max())


@pytest.mark.parametrize("made", SOLVED.values(), ids=SOLVED)
def test_the_estimate_is_a_row_sum_of_the_inverse_and_no_less_than_a_third_of_the_largest(made):
    problem, start = made()
    z = in_floats(problem, start).z
    exact, estimate = row_sum(problem, z), norm_of_inverse(problem, FLOAT64, z)

    assert exact / 3 <= estimate <= exact * (1 + 1e-6)  # Higham, section 15.3; next to a fold inverting loses digits


@given(arrays.arrays(float, (5, 5), elements=st.floats(-1, 1, width=32)))
def test_the_ascent_never_exceeds_the_largest_row_sum(matrix):
    found = largest_row_sum(lambda r: list(matrix @ r), lambda r: list(matrix.T @ r), 5)

    assert found <= np.abs(matrix).sum(axis=1).max() * (1 + 1e-14)


@given(arrays.arrays(float, (5, 5), elements=st.floats(0, 1, width=32)))
def test_the_ascent_finds_the_largest_row_sum_of_a_matrix_without_signs(matrix):
    found = largest_row_sum(lambda r: list(matrix @ r), lambda r: list(matrix.T @ r), 5)

    assert found == pytest.approx(np.abs(matrix).sum(axis=1).max(), rel=1e-14)  # the first step of the ascent is exact


@pytest.mark.parametrize("made", [*SOLVED.values(), *NEAR.values()], ids=[*SOLVED, *NEAR])
def test_the_digits_called_sure_are_right(made):
    problem, start = made()
    found, truth = in_floats(problem, start), near.solution(problem, start)

    assert max(abs(x - y) for x, y in zip(found.z, truth, strict=True)) < 10.0**-found.digits_sure


def test_next_to_a_fold_newtons_method_names_its_condition_and_more_digits_cure_it():
    problem, start = FINE()
    rough, sharp = in_floats(problem, start), refined(problem, start, 50)

    assert rough.conditioning is Conditioning.SENSITIVE
    assert "ask for more digits, or solve for the fold" in rough.words
    assert sharp.conditioning is Conditioning.SOUND
    assert sharp.digits_sure == 50
    assert sharp.condition == pytest.approx(rough.condition, rel=1e-3)


@pytest.mark.parametrize("aside", [0, 1e-8, 1e-6, 1e-4, 1e-2])
def test_at_a_fold_newtons_method_names_it_from_wherever_it_comes(aside):
    """At the fold the solution is off by 1e-8, and its condition number is about 1e8: half of the digits are lost."""
    problem, start = near.touching(near.FOLD_GAP)
    found = in_floats(problem, [x + aside for x in start])

    assert found.conditioning is Conditioning.SENSITIVE
    assert max(abs(x - y) for x, y in zip(found.z, start, strict=True)) < 10.0**-found.digits_sure


def test_the_fold_itself_is_well_conditioned_where_its_cycle_is_singular():
    fold, start = near.folded(None)
    theta = in_floats(fold, start).z
    cycle = Problem(fold.table, fold.components, lam=Rational(theta[-1]))

    assert in_floats(fold, start).conditioning is Conditioning.SOUND
    assert norm_of_inverse(cycle, FLOAT64, theta[:-1]) > 1e6 * norm_of_inverse(fold, FLOAT64, theta)


def test_a_cycle_run_twice_is_named_where_it_settles_and_where_it_does_not():
    diameter = Problem(egg(3).at(alpha="2/25"), (0,) * 4, lam=Rational(1, 3))
    settled = in_floats(diameter, [0.0, 3.14159] * 2)
    problem, start = TWICE()

    assert (settled.conditioning, settled.shorter) == (Conditioning.REPEATED, 2)
    with pytest.raises(UnsettledError, match=r"a shorter cycle run through several times.*after 2 bounces") as caught:
        in_floats(problem, start)
    assert caught.value.last.conditioning is Conditioning.REPEATED


def test_a_true_cycle_of_period_eight_is_not_called_a_repeated_one():
    problem, start = near.in_the_cascade(3)

    assert in_floats(problem, start).shorter == 0
    assert refined(problem, start, 30).conditioning is Conditioning.SOUND
