"""Truncated series against SymPy's own derivatives and substitutions; the twist of maps whose twist is known."""

from itertools import product

import pytest
from sympy import Rational, S, diff, expand, simplify, sqrt, symbols

from symbolic.cycles.cycle import egg_diameter as diameter
from symbolic.cycles.cycle import monodromy, trace_and_determinant
from symbolic.cycles.normal_forms import bounce, chord, composed, egg_diameter, plus, powers, put, times, twist_of_odd
from symbolic.tables.table import alpha, lam

x, p, y = symbols("x p y")
H = {
    (2, 0): Rational(1, 3), (1, 1): Rational(-5, 2), (0, 2): Rational(3, 4), (3, 0): 2, (2, 1): Rational(1, 7),
    (1, 2): -3, (0, 3): Rational(2, 5), (4, 0): -1, (3, 1): 5, (2, 2): Rational(7, 3),
    (1, 3): -2, (0, 4): Rational(1, 6),
}  # fmt: skip
ROTATION = {(1, 0): Rational(3, 5), (0, 1): Rational(-4, 5)}, {(1, 0): Rational(4, 5), (0, 1): Rational(3, 5)}
QUARTICS = [(4, 0), (3, 1), (2, 2), (1, 3), (0, 4)]


def polynomial(f, first=x, second=p):
    return sum((c * first**i * second**j for (i, j), c in f.items()), S.Zero)


def truncated(expression, order):
    """The terms of degree up to `order` in `x` and `p`."""
    scale = symbols("scale")
    scaled = expand(expression.subs({x: scale * x, p: scale * p}, simultaneous=True))
    return expand(sum(scaled.coeff(scale, k) for k in range(order + 1)))


def series(expression):
    """A polynomial in `x` and `p` as a table of coefficients."""
    found = expand(expression).as_poly(x, p).terms()
    return {at: c for at, c in found if c != 0}


def shear(quartic, sign=1):
    """`v + sign*J grad S`, to third order."""
    S4 = polynomial(quartic)
    return series(x + sign * diff(S4, p)), series(p - sign * diff(S4, x))


def test_series_are_multiplied_and_added_as_polynomials_cut_off():
    f, g = {(0, 0): 2, (1, 0): -3, (0, 2): 5}, {(0, 0): 7, (1, 1): 4, (0, 1): -1}

    for order in (0, 1, 2, 3, 4):
        assert expand(polynomial(times(f, g, order)) - truncated(polynomial(f) * polynomial(g), order)) == 0
    assert expand(polynomial(plus(f, g, -3)) - polynomial(f) + 3 * polynomial(g)) == 0
    assert expand(polynomial(plus(f, g)) - polynomial(f) - polynomial(g)) == 0
    assert [expand(polynomial(n) - truncated(polynomial(f) ** k, 3)) for k, n in enumerate(powers(f, 3))] == [0] * 4
    assert plus({}, {(1, 2): 3}) == {(1, 2): 3}


def test_a_series_is_put_into_another_up_to_third_order():
    inner, other = {(1, 0): 2, (0, 2): -1, (2, 1): 3}, {(0, 1): 5, (1, 1): 4, (3, 0): -7}
    outer = {(0, 0): 1, (1, 0): 3, (1, 1): -2, (0, 2): 4, (2, 1): 5, (0, 3): -6, (3, 0): 8, (2, 2): 9}

    exact = polynomial(outer, polynomial(inner), polynomial(other))
    assert expand(polynomial(put(outer, inner, other)) - truncated(exact, 3)) == 0


def test_the_chord_is_the_distance_to_fourth_order():
    """Against SymPy's partial derivatives; the ends are 5 apart, so that all coefficients are rational."""
    start = [[0, 1, Rational(1, 2), -2, 3], [0, 2, -1, Rational(1, 3), 5]]
    end = [[3, -1, 2, 1, Rational(1, 5)], [4, 1, 3, -2, 2]]
    legs = [
        sum(c * y**k for k, c in enumerate(there)) - sum(c * x**k for k, c in enumerate(here))
        for here, there in zip(start, end, strict=True)
    ]
    found = chord([list(map(S, c)) for c in start], [list(map(S, c)) for c in end], sqrt)
    expected, factorial = {}, [1, 1, 2, 6, 24]
    distance = sqrt(legs[0] ** 2 + legs[1] ** 2)
    for i, j in product(range(5), repeat=2):
        if 2 <= i + j <= 4:
            taken = diff(diff(distance, x, i) if i else distance, y, j) if j else diff(distance, x, i)
            expected[i, j] = taken.subs({x: 0, y: 0}) / (factorial[i] * factorial[j])

    assert {at: c for at, c in found.items() if c != 0} == {at: c for at, c in expected.items() if c != 0}


def test_a_bounce_obeys_the_law_of_the_generating_function():
    """`p = -dH/dx` at the start and `p' = dH/dy` at the landing, to third order."""
    landing, leaving = (polynomial(f) for f in bounce(H))
    length = polynomial(H, x, y)

    assert truncated(-diff(length, x).subs(y, landing), 3) == p
    assert expand(leaving - truncated(diff(length, y).subs(y, landing), 3)) == 0


def test_maps_are_composed_in_the_order_given():
    first, second = bounce(H), shear({(4, 0): 1, (1, 3): 2})
    whole = composed([first, second, ROTATION])
    X, P = (polynomial(f) for f in first)
    for x_of, p_of in (second, ROTATION):
        X, P = polynomial(x_of, X, P), polynomial(p_of, X, P)

    assert [expand(polynomial(f) - truncated(exact, 3)) for f, exact in zip(whole, (X, P), strict=True)] == [0, 0]
    assert composed([first]) == first


@pytest.mark.parametrize(("at", "mean"), list(zip(QUARTICS, [3, 0, 1, 0, 3], strict=True)))
def test_the_twist_of_a_rotation_is_the_mean_of_the_quartic_over_circles(at, mean):
    """`x^i p^j` has the means 3/8, 0, 1/8, 0, 3/8 over the unit circle; the twist is 8*B^2 times the mean."""
    turned = composed([shear({at: 7}), ROTATION])

    assert twist_of_odd(turned) == 7 * mean * Rational(4, 5) ** 2


@pytest.mark.parametrize("stretch", [S(2), Rational(1, 3)])
def test_the_twist_is_a_mean_over_ellipses_when_the_coordinates_are_stretched(stretch):
    """`x -> k*x`, `p -> p/k` keeps areas: the mean of `x^4` over the image of the circle is `3*k^4/8`."""
    (c, s), (_, _) = (tuple(f.values()) for f in ROTATION)
    stretched = {(1, 0): c, (0, 1): s * stretch**2}, {(1, 0): -s / stretch**2, (0, 1): c}

    for at, mean in zip(QUARTICS, [3, 0, 1, 0, 3], strict=True):
        found = twist_of_odd(composed([shear({at: 1}), stretched]))
        assert found == mean * stretch ** (at[0] - at[1]) * s**2


@pytest.mark.parametrize("at", QUARTICS)
def test_a_change_of_coordinates_does_not_change_the_twist(at):
    map = composed([shear({(4, 0): 1, (3, 1): -2, (2, 2): 5, (0, 4): Rational(1, 2)}), ROTATION])
    changed = composed([shear({at: 3}, -1), map, shear({at: 3})])

    assert twist_of_odd(changed) == twist_of_odd(map)


def test_the_diameter_of_the_egg_has_the_trace_of_its_monodromy_and_that_of_the_circle_no_twist():
    """In the circle a chord takes `phi` to `phi - 2p` to first order, so `B = -4` for two."""
    B, trace, twist = egg_diameter()

    assert expand((trace - trace_and_determinant(diameter(3))[0].subs(lam, 1)).together().as_numer_denom()[0]) == 0
    assert (B.subs(alpha, 0), trace.subs(alpha, 0), twist.subs(alpha, 0)) == (-4, 2, 0)
    assert simplify(B * (1 + alpha) ** 2 - monodromy(diameter(3))[0, 1].subs(lam, 1)) == 0  # s = (1 + alpha)*theta
