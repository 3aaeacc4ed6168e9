"""Long formulas give tables, or are refused when they bound none."""

import pytest

from symbolic import tables
from symbolic.tables.curves import is_periodic
from symbolic.tables.formula import parse

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


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_long_formulas_are_tables(name):
    assert is_periodic(tables.polar(parse(LONG[name]), "own").components[0].point[0])


def test_a_long_radius_that_is_not_positive_is_refused():
    text = "1/50+" + "+".join(f"cos({k}*theta)/{10 * k * k}" for k in range(1, 41))
    with pytest.raises(ValueError, match="is not positive for every theta"):
        tables.polar(parse(text), "own")


def test_a_long_formula_with_a_pole_is_refused():
    text = "5+" + "+".join(f"cos({k}*theta)/{100 * k}" for k in range(1, 41)) + "+1/(cos(theta)+1/3)"
    with pytest.raises(ValueError, match="has a pole, where"):
        tables.polar(parse(text), "own")
