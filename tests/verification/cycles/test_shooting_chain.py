"""Linear algebra along a cycle against exact dense algebra, and the derivatives that enter it."""

from fractions import Fraction

import pytest
from flint import acb, arb
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import Matrix, Rational, cos, diff, log, sin, sqrt, symbols
from sympy import atan as arctan

from symbolic.expressions.text import kernel, load
from symbolic.tables import cuspless, egg, polar
from symbolic.tables.table import theta
from verification.arithmetic.balls import FLOAT64
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import Chain, Elimination
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR, BifurcationKind

fractions = st.fractions(-3, 3, max_denominator=7)


@st.composite
def chains(draw):
    n = draw(st.integers(1, 7))
    three = [draw(st.lists(fractions, min_size=n, max_size=n)) for _ in range(3)]
    return Chain(*three, draw(st.sampled_from([1, -1])))


def dense(chain: Chain) -> Matrix:
    n = len(chain.diagonal)
    columns = [chain.times([Fraction(int(i == j)) for i in range(n)]) for j in range(n)]
    return Matrix(n, n, lambda i, j: Rational(columns[j][i].numerator, columns[j][i].denominator))


def eliminated(chain: Chain) -> Elimination:
    try:
        return Elimination(chain)
    except ZeroDivisionError:
        assume(False)
        raise


def rationals(values: list) -> Matrix:
    return Matrix([Rational(Fraction(v)) for v in values])


@pytest.mark.slow
@given(chains(), st.data())
def test_solving_a_chain_inverts_its_matrix_exactly(chain, data):
    n = len(chain.diagonal)
    right = data.draw(st.lists(fractions, min_size=n, max_size=n))
    one = eliminated(chain)
    assume(one.bordering != 0)

    assert chain.times(one.solve(right)) == right


@pytest.mark.slow
@given(chains())
def test_rest_vanishes_exactly_when_the_matrix_is_singular(chain):
    one = eliminated(chain)
    product = Fraction(1)
    for pivot in one.pivots:
        product *= pivot

    assert dense(chain).det() == Rational(product * one.bordering)
    assert chain.times(one.right) == [0] * (len(one.right) - 1) + [one.bordering]
    assert (rationals(one.left).T * dense(chain)).tolist() == [[0] * (len(one.left) - 1) + [Rational(one.bordering)]]


PROBLEMS = [
    (Problem(egg(3).at(alpha="2/25"), (0,) * 4, BifurcationKind.FLIP, "lam"), [0.3, 3.0, -0.2, 2.5, 0.2]),
    (Problem(egg(3), (0,) * 4, BifurcationKind.FOLD, "alpha", Rational(1, 3)), [0.3, 3.0, -0.2, 2.5, 0.05]),
    (Problem(egg(3).at(alpha="2/25"), (0, 0), BifurcationKind.FLIP, "lam"), [0.3, 3.0, 0.2]),
    (Problem(cuspless, (1, 0, 0), BifurcationKind.FLIP, "lam"), [0.1, -0.4, 1.1, 0.3]),
    (Problem(egg(3).at(alpha="2/25"), (0, 0), BifurcationKind.FLIP, "lam", closure=MIRROR), [0.1, -2.7, 0.2]),
    (Problem(egg(3), (0, 0, 0), BifurcationKind.FOLD, "alpha", Rational(1, 3), MIRROR), [0.1, -2.7, 0.2, 0.05]),
    (Problem(cuspless, (1, 0, 0), lam=Rational(1, 4)), [0.1, -0.4, 1.1]),
]


@pytest.mark.parametrize(("problem", "z"), PROBLEMS)
def test_newtons_correction_inverts_the_matrix_of_difference_quotients(problem, z):
    h = 1e-6
    correction = problem.newton(FLOAT64, z)
    up, down = ([x + s * h * d for x, d in zip(z, correction, strict=True)] for s in (1, -1))
    slope = [
        (a - b) / (2 * h)
        for a, b in zip(
            Linearised(problem, FLOAT64, up, slope=False).value,
            Linearised(problem, FLOAT64, down, slope=False).value,
            strict=True,
        )
    ]
    value = Linearised(problem, FLOAT64, z).value

    size = max(abs(d) for d in correction) ** 3 + 1  # the third derivative along the correction
    assert max(abs(a - b) for a, b in zip(slope, value, strict=True)) < 1e-7 * size


@pytest.mark.slow
@settings(max_examples=15)
@given(st.floats(0.2, 3), st.floats(-2, 2), st.floats(-2, 2))
def test_jets_are_the_taylor_coefficients(a, b, c):
    x, e = symbols("x e")
    expression = arctan(x) * sqrt(x + 1) / (cos(x) + 2) + log(x) * sin(x) / x
    function = load(kernel("f", [x], {"value": expression}), jets(FLOAT64))
    found = function(Jet(a, b, c, 0.0))[0].c
    path = expression.subs(x, Rational(a) + Rational(b) * e + Rational(c) * e**2)
    for k, factorial in ((0, 1), (1, 1), (2, 2)):
        expected = float(diff(path, e, k).subs(e, 0)) / factorial

        assert abs(found[k] - expected) < 1e-11 * (1 + abs(expected))  # a few roundings of numbers below 1e3


def test_a_problem_that_is_not_square_is_refused():
    with pytest.raises(ValueError, match="CYCLE with lam free has not as many equations as unknowns"):
        Problem(cuspless, (1, 0), None, "lam")
    with pytest.raises(ValueError, match="accepted: fold, flip"):
        Problem(cuspless, (1, 0), BifurcationKind.TORUS, "lam")
    with pytest.raises(ValueError, match="without a number are alpha, and lam = None; accepted: just lam"):
        Problem(egg(3), (0, 0), BifurcationKind.FLIP, "lam")
    with pytest.raises(ValueError, match="theta -> -theta is no reflection"):
        Problem(polar(2 + sin(theta) / 9), (0, 0), lam=Rational(1, 2), closure=MIRROR)
    with pytest.raises(ValueError, match="no row"):
        Chain([], [], [])


@pytest.mark.slow
@given(chains(), st.sampled_from([acb(3, 4) / 5, acb(-5, 12) / 13]), st.data())
def test_a_chain_whose_vectors_come_back_turned_is_solved_too(real, unit, data):
    n = len(real.diagonal)
    three = [[arb(x.numerator) / x.denominator for x in row] for row in (real.lower, real.diagonal, real.upper)]
    right = [arb(data.draw(st.integers(-9, 9))) for _ in range(n)]
    turned = Chain(*three, unit)
    x = Elimination(turned).solve(right)
    assume(all(value.is_finite() for value in x))

    assert all(value.overlaps(acb(r)) for value, r in zip(turned.times(x), right, strict=True))
    assert (unit * turned.back).overlaps(acb(1))


@pytest.mark.slow
@given(chains(), st.data())
def test_a_bordered_chain_and_its_transpose_are_solved_exactly(chain, data):
    n = len(chain.diagonal)
    column, row = (data.draw(st.lists(fractions, min_size=n, max_size=n)) for _ in range(2))
    corner = data.draw(fractions)
    right = data.draw(st.lists(fractions, min_size=n + 1, max_size=n + 1))
    plain = dense(chain)
    whole = plain.row_join(rationals(column)).col_join(rationals([*row, corner]).T)
    one = eliminated(chain)
    assume(whole.det() != 0 and plain.det() != 0)

    assert whole * rationals(one.bordered(column, row, [corner], right)) == rationals(right)
    assert whole.T * rationals(one.transposed(column, row, [corner], right)) == rationals(right)
    assert plain.T * rationals(one.transposed([], [], [], right[:n])) == rationals(right[:n])
