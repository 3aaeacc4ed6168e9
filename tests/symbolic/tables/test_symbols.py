"""SymPy knows what the letters stand for."""

import pytest
from sympy import Abs, Symbol, conjugate, sqrt

from symbolic.tables import table as letters

LETTERS = {name: letter for name, letter in vars(letters).items() if isinstance(letter, Symbol)}
POSITIVE = {"t", "a", "cos_phi0", "cos_eta1"}  # lengths, and cosines of angles inside a quarter turn
NONNEGATIVE = {"lam", "alpha"}
REAL = {"theta", "s", "phi", "eta", "K0", "K1"}


def test_every_letter_is_one_of_these_and_carries_its_own_name():
    assert set(LETTERS) == POSITIVE | NONNEGATIVE | REAL
    assert all(letter.name == name for name, letter in LETTERS.items())


@pytest.mark.parametrize("name", sorted(POSITIVE | NONNEGATIVE))
def test_a_length_or_a_cosine_is_its_own_absolute_value(name):
    letter = LETTERS[name]

    assert Abs(letter) == sqrt(letter**2) == letter
    assert letter.is_positive is (True if name in POSITIVE else None)


@pytest.mark.parametrize("name", sorted(REAL))
def test_an_angle_a_curvature_or_an_arc_length_is_real_of_either_sign(name):
    letter = LETTERS[name]

    assert conjugate(letter) == letter
    assert Abs(letter) != letter
