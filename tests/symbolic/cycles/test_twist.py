"""The generating function of a flight against SymPy's derivatives, and twists of maps with a known twist."""

from itertools import product

import pytest
from sympy import Rational, S, diff, expand, simplify, sqrt, symbols

from symbolic.cycles.cycle import egg_diameter as diameter
from symbolic.cycles.cycle import monodromy, trace_and_determinant
from symbolic.cycles.normal_forms import bounce, chord, composed, egg_diameter, twist_of_odd
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
    """The terms of degree up to `order` in `x` and `p` together."""
    scale = symbols("scale")
    scaled = expand(expression.subs({x: scale * x, p: scale * p}, simultaneous=True))
    return expand(sum(scaled.coeff(scale, k) for k in range(order + 1)))


def series(expression):
    """The coefficients of a polynomial in `x` and `p`, as a table."""
    found = expand(expression).as_poly(x, p).terms()
    return {at: c for at, c in found if c != 0}


def shear(quartic, sign=1):
    """The map `v + sign*J grad S`, to third order."""
    S4 = polynomial(quartic)
    return series(x + sign * diff(S4, p)), series(p - sign * diff(S4, x))


@pytest.mark.slow
def test_the_chord_is_the_distance_to_fourth_order():
    """Against SymPy's partial derivatives, for ends 5 apart, which makes all coefficients rational."""
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


@pytest.mark.parametrize(("at", "mean"), list(zip(QUARTICS, [3, 0, 1, 0, 3], strict=True)))
def test_the_twist_of_a_rotation_is_the_mean_of_the_quartic_over_circles(at, mean):
    """The means of `x^i p^j` over the unit circle are 3/8, 0, 1/8, 0, 3/8; the twist is 8*B^2 times the mean."""
    turned = composed([shear({at: 7}), ROTATION])

    assert twist_of_odd(turned) == 7 * mean * Rational(4, 5) ** 2


@pytest.mark.parametrize("stretch", [S(2), Rational(1, 3)])
def test_the_twist_is_a_mean_over_ellipses_when_the_coordinates_are_stretched(stretch):
    """`x -> k*x`, `p -> p/k` keeps areas, and the mean of `x^4` over the image of the circle is `3*k^4/8`."""
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


@pytest.mark.slow
def test_the_diameter_of_the_egg_has_the_trace_of_its_monodromy_and_that_of_the_circle_no_twist():
    """In the circle one chord takes `phi` to `phi - 2p` to first order, and two chords have `B = -4`."""
    B, trace, twist = egg_diameter()

    assert expand((trace - trace_and_determinant(diameter(3))[0].subs(lam, 1)).together().as_numer_denom()[0]) == 0
    assert (B.subs(alpha, 0), trace.subs(alpha, 0), twist.subs(alpha, 0)) == (-4, 2, 0)
    assert simplify(B * (1 + alpha) ** 2 - monodromy(diameter(3))[0, 1].subs(lam, 1)) == 0  # s = (1 + alpha)*theta
