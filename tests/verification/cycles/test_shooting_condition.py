"""What Newton's solutions say of themselves: against the inverted matrix, and against a hundred digits."""

import json
from functools import partial

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from sympy import Rational

from symbolic.tables import egg
from verification.app.commands.orbit import cycles_command as cycles
from verification.arithmetic.balls import FLOAT64
from verification.cycles.critical import corner
from verification.cycles.newton import (
    Conditioning,
    Solution,
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
    """There the solution found is off by 1e-8, and its condition number is about one over that: half of the digits."""
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


def test_a_singular_matrix_has_an_infinite_condition_number_and_no_digits():
    class Singular:
        def solved(self, arithmetic, z, r):
            raise ZeroDivisionError

    found = Solution(Singular(), [1.0], 15, ())

    assert found.condition == float("inf")
    assert found.digits_sure == 0
    assert found.conditioning is Conditioning.SENSITIVE


def test_a_small_system_is_inverted():
    found = refined(corner(), [0.25, 0.07], 40)
    matrix = mpmath.matrix(2)
    for j in range(2):
        for i, x in enumerate(corner().solved(FLOAT64, [float(x) for x in found.z], [float(i == j) for i in range(2)])):
            matrix[i, j] = x

    assert found.condition == pytest.approx(float(mpmath.mnorm(matrix, mpmath.inf)), rel=1e-12)


def test_the_condition_costs_nothing_unless_it_is_asked_for():
    asked = []

    class Watched:
        label = "watched"

        def newton(self, arithmetic, z):
            return [(x * x - 2) / (2 * x) for x in z]

        def solved(self, arithmetic, z, r):
            asked.append(len(z))
            return [y / (2 * x) for x, y in zip(z, r, strict=True)]

    found = refined(Watched(), [1.4], 30)
    before = list(asked)

    assert (before, found.digits_sure, len(asked)) == ([], 30, 1)


def test_the_command_that_lists_cycles_says_what_their_digits_are_worth(tmp_path):
    words = ["egg", "--alpha", "0.08", "--lam", "0.3782", "--period", "3", "--json", str(tmp_path / "cycles.json")]
    result = CliRunner().invoke(cycles, words, standalone_mode=False)
    document = json.loads((tmp_path / "cycles.json").read_text())
    worst = max(document["cycles"], key=lambda cycle: cycle["condition"])

    assert {cycle["conditioning"] for cycle in document["cycles"]} == {"SOUND"}
    assert worst["period"] == 3  # the two pairs of triangles are born at 0.37812..., paper, section 6.4
    assert f"the worst conditioned cycle has period 3: condition number {worst['condition']:.2g}, " in result.output
    assert f"{worst['digits_sure']} of 15 digits sure" in result.output
