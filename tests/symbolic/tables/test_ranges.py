"""Signs and roots on ranges, whose ends may depend on an integer."""

from sympy import Abs, Interval, S, Symbol, sqrt

from symbolic.tables.validity import is_positive, modulus, root

x, y = Symbol("x", real=True), Symbol("y", real=True)
K = Symbol("K", integer=True, positive=True)


def test_the_integer_of_an_end_starts_at_one():
    shrinking = {x: Interval(0, 1 / K)}

    assert is_positive(K, shrinking)
    assert is_positive(2 - K * x, shrinking)
    assert not is_positive(K - 1, shrinking)
    assert not is_positive(1 - K * x, shrinking)
    assert is_positive(S(3) / 2 - x, shrinking)
    assert not is_positive(S(1) - x, shrinking)  # at K = 1, x = 1


def test_nothing_is_proved_about_a_letter_without_a_range():
    assert not is_positive(y, {x: Interval(1, 2)})
    assert is_positive(x, {x: Interval(1, 2)})


def test_a_modulus_is_resolved_where_its_sign_is_proved():
    assert [modulus(x, {x: Interval(*ends)}) for ends in ((1, 2), (-2, -1), (-1, 1))] == [x, -x, Abs(x)]
    assert root(x**3 * (x - 3) ** 2 / (x + 1) ** 2, {x: Interval(1, 2)}) == x * (3 - x) * sqrt(x) / (x + 1)
