"""Long formulas are judged without multiplying them out, and say the same as short ones where both ways are open."""

import time
from fractions import Fraction

import pytest
from sympy import I, Rational, cos, expand, sin

from symbolic import tables
from symbolic.tables import geometry, validity
from symbolic.tables.curves import is_periodic, waves
from symbolic.tables.formula import parse
from symbolic.tables.table import theta
from symbolic.tables.validity import enclosed_area, radius_sign

LONG = {
    "forty harmonics": "1+" + "+".join(f"cos({k}*theta)/{1000 * k * k}" for k in range(1, 41)),
    "thirty factors": "1+" + "*".join(f"(1+cos({k}*theta)/50)" for k in range(1, 31)) + "/100",
    "a sixty-fourth power": "1+(1+cos(theta))**64/10**22",
    "forty sines and cosines": "2+" + "+".join(f"sin({k}*theta)*cos({k + 1}*theta)/{50 * k * k}" for k in range(1, 41)),
    "fifty levels": "1+" + "cos(" * 50 + "theta" + ")" * 50 + "/40",
    "four quotients": "1/(2+cos(theta))+1/(3+cos(2*theta))+1/(5+sin(theta)+cos(3*theta))+1/(7+cos(4*theta))",
    "twelve quotients": "+".join(f"1/({k + 2}+cos({k}*theta))" for k in range(1, 13)),
    "roots of sums": "sqrt(" * 8 + "3+cos(theta)" + "+sin(2*theta)/9)" * 8,
}
SECONDS = 60  # of the processor; a second where nothing else runs, and what is multiplied out takes hours


@pytest.mark.parametrize("name", LONG)
def test_long_formulas_are_tables_within_seconds(name):
    started = time.process_time()
    table = tables.polar(parse(LONG[name]), "own")

    assert time.process_time() - started < SECONDS
    assert is_periodic(table.components[0].point[0])


def test_a_long_radius_that_is_not_positive_is_refused():
    text = "1/50+" + "+".join(f"cos({k}*theta)/{10 * k * k}" for k in range(1, 41))
    with pytest.raises(ValueError, match="is not positive for every theta"):
        tables.polar(parse(text), "own")


def test_a_long_formula_with_a_pole_is_refused():
    text = "5+" + "+".join(f"cos({k}*theta)/{100 * k}" for k in range(1, 41)) + "+1/(cos(theta)+1/3)"
    with pytest.raises(ValueError, match="has a pole, where"):
        tables.polar(parse(text), "own")


SHORT = [
    cos(theta) ** 3 * sin(2 * theta) - Rational(1, 3),
    (1 + cos(theta)) ** 5 * (2 - sin(3 * theta)),
    (cos(theta) + I * sin(theta)) ** 4 / 7,
    cos(theta) ** 2 + sin(theta) ** 2 - 1,
]


@pytest.mark.parametrize("expression", SHORT, ids=str)
def test_coefficients_are_those_that_sympy_finds(expression, monkeypatch):
    found = geometry.coefficients(expression)
    monkeypatch.setattr(geometry, "waves", lambda _: None)

    assert geometry.coefficients(expand(expression)) == found


@pytest.mark.parametrize(
    "expression", [theta, cos(theta / 2), 1 / (2 + cos(theta)), cos(cos(theta)), cos(1) * cos(theta)]
)
def test_what_is_no_finite_sum_of_fractions_has_no_coefficients(expression):
    assert waves(expression) is None


def test_what_takes_too_many_products_has_none():
    assert waves((1 + cos(theta) + sin(30 * theta)) ** 60) is None
    assert waves((1 + cos(theta)) ** 64)[64] == (Fraction(1, 2**64), 0)


def test_areas_agree_with_the_integral(monkeypatch):
    table = tables.polar("2+cos(3*theta)/5+sin(theta)/7")
    quick = enclosed_area(table)
    monkeypatch.setattr(validity, "waves", lambda _: None)

    assert enclosed_area(table) == quick


@pytest.mark.parametrize("rho", ["1+cos(3*theta)*99/100", "1+cos(3*theta)*101/100", "2+cos(theta)+sin(2*theta)*9/8"])
def test_enclosures_and_sturm_agree_on_the_radius(rho, monkeypatch):
    by_sturm = radius_sign(parse(rho))
    monkeypatch.setattr(validity, "HIGHEST_HARMONIC", 0)

    assert radius_sign(parse(rho)) is by_sturm
