"""Formulas in the paper's letters."""

import pytest
from sympy import Matrix, Rational, cos

from symbolic.motion.chords import collision_rule
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import cuspless, egg
from symbolic.tables.formula import equation, latex, letter
from symbolic.tables.table import alpha, eta, lam, phi, theta


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        (lam * eta, r"\eta \lambda"),
        (phi, r"\varphi"),
        (1 + alpha * cos(3 * theta), r"\alpha \cos{\left(3 \theta \right)} + 1"),
        (Rational(1, 3), r"\frac{1}{3}"),
    ],
)
def test_letters_are_those_of_the_paper(expression, text):
    assert latex(expression) == text


def test_no_name_of_the_code_is_left_in_a_formula():
    shown = latex(derivative_matrix()) + "".join(latex(e) for e in collision_rule(egg(3)).values.values())

    assert "lam" not in shown.replace(r"\lambda", "")
    assert "cos_" not in shown


def test_a_table_shows_each_component_with_its_range():
    assert latex(cuspless).count(r"\leq \theta \leq") == 2


def test_an_equation_is_ready_for_a_notebook_cell():
    assert equation("M", Matrix([[lam]])) == r"$\displaystyle M = \left[\begin{matrix}\lambda\end{matrix}\right]$"


def test_a_subscript_follows_its_letter():
    assert letter("theta_previous") == r"\theta_{\mathrm{previous}}"
