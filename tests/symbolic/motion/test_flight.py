"""The flight equation, divided by its known root, against the original equation and complex numbers."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import I, Rational, S, cos, expand, im, sin, sqrt

from symbolic.motion.flight import chord_polynomial, flight_residual, harmonics
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.table import Component, theta

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


def complex_of(pair):
    return pair[0] + I * pair[1]


@pytest.mark.parametrize(
    "component", [circle.components[0], ellipse.components[0], LOOSE, egg(2).components[0], egg(3).components[0]]
)
def test_the_polynomial_is_the_deflated_sum_of_the_module_s_own_formula(component):
    """`sum U_(k-1)(cos B) * Im(conj(M_k)*exp(i*k*m))`, in SymPy's complex numbers at `T = 1/2` and `T = -3`."""
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


@pytest.mark.slow
@pytest.mark.parametrize("component", [*(table.components[0] for table in (circle, ellipse, cardioid, egg(2))), LOOSE])
def test_the_factored_flight_equation_is_proved(component):
    assert flight_residual(component) == 0


@pytest.mark.slow
@settings(max_examples=8)
@given(st.lists(st.integers(-9, 9).map(lambda n: Rational(n, 10)), min_size=8, max_size=8))
def test_the_known_root_divides_out_of_any_fourier_sum(c):
    x = cos(theta) + c[0] * cos(2 * theta) + c[1] * sin(2 * theta) + c[2] * sin(theta) + c[3]
    y = sin(theta) + c[4] * cos(2 * theta) + c[5] * sin(2 * theta) + c[6] * cos(theta) + c[7]

    assert flight_residual(Component("any", (x, y), -S.Pi, S.Pi)) == 0


def test_a_boundary_that_is_no_finite_sum_is_refused():
    with pytest.raises(
        ValueError, match=r"^wall: the boundary is no finite Fourier sum, so it has no chord polynomial$"
    ):
        flight_residual(cuspless.component("wall"))
