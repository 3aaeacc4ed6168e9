"""A straight-line program can be rebuilt from its data, and unknown words are refused."""

from fractions import Fraction

import mpmath
import pytest

from numeric.lowering.program import Builder, Program

MP = mpmath.MPContext()
MP.dps = 40


def built(formula):
    """The program of a formula in two variables."""
    builder = Builder("x", "y")
    return builder.program(formula(*builder.nodes))


def test_a_program_comes_back_from_its_data():
    program = built(lambda x, y: (x + y) * x / 3 - Fraction(2, 7))
    data = program.as_data()

    assert Program.from_data(data) == program
    assert all(isinstance(part, list) for part in [data, *data, *data[1]])


@pytest.mark.parametrize("word", ["gamma", "", "__import__"])
def test_a_word_outside_the_vocabulary_does_not_come_back(word):
    with pytest.raises(ValueError, match=f"program: {word!r} is no word of the vocabulary"):
        Program.from_data([["x"], [["+", 0, 0], [word, 0]], [1]])
