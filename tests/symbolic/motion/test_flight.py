"""The arithmetic of harmonics, on boundaries whose points and chords a hand can calculate."""

import pytest
from sympy import I, Rational, S, cos, expand, im, sin, sqrt

from symbolic.motion.flight import (
    chord_polynomial,
    differentiated,
    flight_residual,
    harmonics,
    point_at,
    powers,
    support,
    times,
)
from symbolic.tables import circle, cuspless, egg, ellipse
from symbolic.tables.table import Component, theta

UNIT = (Rational(3, 5), Rational(4, 5))  # exp(i*theta) with cos = 3/5
E, B = (Rational(5, 13), Rational(12, 13)), (Rational(-7, 25), Rational(24, 25))
LOOSE = Component(
    "loose",
    (
        7 + 2 * cos(theta) - 3 * sin(theta) + 5 * cos(3 * theta) + 11 * sin(3 * theta),
        -4 + 13 * cos(theta) + 17 * sin(theta) - 19 * cos(3 * theta) + 23 * sin(3 * theta),
    ),
    -S.Pi,
    S.Pi,
)
VECTORS = {0: ((7, -4), (0, 0)), 1: ((2, 13), (-3, 17)), 3: ((5, -19), (11, 23))}


def complex_of(pair):
    return pair[0] + I * pair[1]


def at_unit(expression):
    """A trigonometric polynomial at `cos = 3/5`, `sin = 4/5`."""
    return expand(expand(expression, trig=True).subs({cos(theta): UNIT[0], sin(theta): UNIT[1]}))


def test_harmonics_are_the_vectors_of_cosines_and_sines():
    assert harmonics(LOOSE) == VECTORS
    assert harmonics(cuspless.component("wall")) is None


def test_powers_are_those_of_complex_numbers():
    z, w = (2, -3), (5, 7)

    assert complex_of(times(z, w)) == expand(complex_of(z) * complex_of(w))
    assert [complex_of(power) for power in powers(z, 9)] == [expand(complex_of(z) ** k) for k in range(10)]


def test_points_and_velocities_are_those_of_the_component():
    for h, coordinates in (
        (VECTORS, LOOSE.point),
        (differentiated(VECTORS), [coordinate.diff(theta) for coordinate in LOOSE.point]),
        (differentiated(differentiated(VECTORS)), [coordinate.diff(theta, 2) for coordinate in LOOSE.point]),
    ):
        assert point_at(h, UNIT) == tuple(at_unit(coordinate) for coordinate in coordinates)
    assert 0 not in differentiated(VECTORS)


def test_the_support_is_the_pair_of_scalar_products():
    assert support({2: ((3, 5), (7, 11))}, 2, (13, 17)) == (3 * 13 + 5 * 17, 7 * 13 + 11 * 17)


@pytest.mark.parametrize(
    "component", [circle.components[0], ellipse.components[0], LOOSE, egg(2).components[0], egg(3).components[0]]
)
def test_the_polynomial_is_the_deflated_sum_of_the_module_s_own_formula(component):
    """`sum U_(k-1)(cos B) * Im(conj(M_k)*exp(i*k*m))`, by SymPy's complex numbers at `T = 1/2` and `T = -3`."""
    h = harmonics(component)
    n = max(h)
    found = chord_polynomial(h, E, B)
    assert len(found) == 2 * n
    for T in (Rational(1, 2), Rational(-3)):
        secant = sqrt(1 + T**2)
        turn = (1 + I * T) / secant
        m, cos_B = complex_of(E) * turn, expand(B[0] - B[1] * T) / secant  # cos(B + delta)
        total = S.Zero
        for k, (C, sine) in h.items():
            if k:
                M = C[0] * E[0] + C[1] * E[1] - I * (sine[0] * E[0] + sine[1] * E[1])  # the conjugate
                chebyshev = {1: 1, 2: 2 * cos_B, 3: 4 * cos_B**2 - 1, 4: 8 * cos_B**3 - 4 * cos_B}[k]
                total += chebyshev * im(expand(M * m**k))
        value = sum(c * T**j for j, c in enumerate(found))

        assert expand(total * secant ** (2 * n - 1) - value).simplify() == 0


@pytest.mark.parametrize("component", [circle.components[0], ellipse.components[0], LOOSE])
def test_the_factored_flight_equation_is_proved(component):
    assert flight_residual(component) == 0


def test_a_boundary_that_is_no_finite_sum_is_refused():
    with pytest.raises(ValueError, match=r"^wall: the boundary is no finite Fourier sum, it has no chord polynomial$"):
        flight_residual(cuspless.component("wall"))
