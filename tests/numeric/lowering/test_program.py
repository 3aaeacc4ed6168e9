"""Straight-line programs: every word, exact folding, no line that nothing needs, and the way to disk and back."""

from fractions import Fraction

import mpmath
import pytest

from numeric.backends.scalars import ScalarBackend
from numeric.lowering.program import Builder, Program

MP = mpmath.MPContext()
MP.dps = 40
OPS = ScalarBackend(MP)
X, Y = Fraction(7, 3), Fraction(-5, 2)


def built(formula):
    """The program of a formula in two variables."""
    builder = Builder("x", "y")
    return builder.program(formula(*builder.nodes))


FORMULAS = [  # with the number of lines each takes
    (lambda x, y: x + y, 1), (lambda x, y: x - y, 1), (lambda x, y: y - x, 1), (lambda x, y: x * y, 1),
    (lambda x, y: x / y, 1), (lambda x, y: y / x, 1), (lambda x, y: -x, 1), (lambda x, y: y + x + x * y * x, 4),
    (lambda x, y: 3 - x, 2), (lambda x, y: x - 3, 2), (lambda x, y: 3 + x, 2), (lambda x, y: x + 3, 2),
    (lambda x, y: 3 / x, 2), (lambda x, y: x / 3, 2), (lambda x, y: 3 * x, 2), (lambda x, y: x * 3, 2),
    (lambda x, y: (x + y) * (y + x) - (x * y) / (y * x), 5),
    # folded: nothing is left to do, or only a sign
    (lambda x, y: x + 0, 0), (lambda x, y: 0 + x, 0), (lambda x, y: x - 0, 0), (lambda x, y: 0 - x, 1),
    (lambda x, y: 1 * x, 0), (lambda x, y: x * 1, 0), (lambda x, y: x / 1, 0), (lambda x, y: 1 / x, 2),
    (lambda x, y: -1 * x, 1), (lambda x, y: x * -1, 1), (lambda x, y: x / -1, 1), (lambda x, y: 1 - x, 2),
    (lambda x, y: x - 1, 2), (lambda x, y: 1 + x, 2), (lambda x, y: x + -1, 2), (lambda x, y: -1 - x, 2),
    (lambda x, y: x - -1, 2), (lambda x, y: -1 / x, 2), (lambda x, y: 0 * x, 1), (lambda x, y: x * 0 + y, 0),
    (lambda x, y: 0 / x, 2), (lambda x, y: (0 * x + 2) * (0 * y + 3) - x, 2), (lambda x, y: -(0 * x + 2) - y, 2),
]  # fmt: skip


@pytest.mark.parametrize(("formula", "lines"), FORMULAS)
def test_a_program_computes_its_formula_in_as_few_lines_as_can_be(formula, lines):
    program = built(formula)
    (found,) = program(OPS, MP.mpf(7) / 3, MP.mpf(-5) / 2)
    truth = formula(X, Y)

    assert abs(found - MP.mpf(truth.numerator) / truth.denominator) <= 16 * MP.eps
    assert len(program.lines) == lines


def test_functions_are_words():
    builder = Builder("x")
    x = builder.nodes[0].number()
    names = ("sqrt", "sin", "cos", "neg")
    program = builder.program(*(builder.node(name, x) for name in names), builder.node("pi"))
    found = program(OPS, MP.mpf(2))

    assert found == [MP.sqrt(2), MP.sin(2), MP.cos(2), -2, +MP.pi]


def test_lines_that_no_output_needs_are_left_out():
    builder = Builder("x", "y")
    x, y = builder.nodes
    _unused, kept = (x * y) / 7, y * y + 2
    program = builder.program(kept, x, builder.exact(5))

    assert program.lines == (("*", 1, 1), ("q", 2, 1), ("+", 2, 3), ("q", 5, 1))
    assert program(OPS, 3, 4) == [18, 3, 5]


def test_a_rational_is_never_rounded_on_the_way():
    program = built(lambda x, y: Fraction(1, 3) * x)

    assert program.lines[0] == ("q", 1, 3)
    assert abs(program(OPS, MP.mpf(3), 0)[0] - 1) <= MP.eps


def test_a_program_comes_back_from_its_data():
    program = built(lambda x, y: (x + y) * x / 3 - Fraction(2, 7))
    data = program.as_data()

    assert Program.from_data(data) == program
    assert all(isinstance(part, list) for part in [data, *data, *data[1]])


@pytest.mark.parametrize("word", ["gamma", "", "__import__"])
def test_a_word_outside_the_vocabulary_does_not_come_back(word):
    with pytest.raises(ValueError, match=f"program: {word!r} is no word of the vocabulary"):
        Program.from_data([["x"], [["+", 0, 0], [word, 0]], [1]])
