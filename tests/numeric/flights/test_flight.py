"""The deflated flight equation is the flight equation, exactly."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Rational, cos, expand, pi, sin, symbols

from symbolic import tables
from symbolic.motion.flight import ONE, chord_polynomial, flight_residual, harmonics, point_at, seen_ahead, support
from symbolic.tables.table import Component, alpha, theta


@pytest.mark.parametrize("table", [tables.circle, tables.ellipse, tables.cardioid], ids=lambda table: table.name)
def test_the_known_root_divides_out_exactly(table):
    assert flight_residual(table.components[0]) == 0


@pytest.mark.parametrize("K", [2, 3, 4])
def test_the_known_root_divides_out_of_every_egg(K):
    component = tables.egg(K).components[0]

    assert flight_residual(component) == 0
    assert len(chord_polynomial(harmonics(component), (1, 0), (1, 0))) == 2 * K + 2


small = st.integers(-9, 9).map(lambda n: Rational(n, 10))


@settings(max_examples=8)
@given(st.lists(small, min_size=8, max_size=8))
def test_the_known_root_divides_out_of_any_fourier_sum(c):
    x = cos(theta) + c[0] * cos(2 * theta) + c[1] * sin(2 * theta) + c[2] * sin(theta) + c[3]
    y = sin(theta) + c[4] * cos(2 * theta) + c[5] * sin(2 * theta) + c[6] * cos(theta) + c[7]

    assert flight_residual(Component("any", (x, y), -pi, pi)) == 0


def test_harmonics_give_the_point_back():
    component = tables.egg(3).components[0]
    x, y = point_at(harmonics(component), (cos(theta), sin(theta)))
    difference = [(a - b).subs(alpha, Rational(1, 13)) for a, b in zip((x, y), component.point, strict=True)]

    assert [expand(e, trig=True).simplify() for e in difference] == [0, 0]


def test_the_chords_of_an_ellipse_have_their_middle_along_the_support():
    ex, ey, a = symbols("ex ey a")

    assert support({1: ((a, 0), (0, 1))}, 1, (ex, ey)) == (a * ex, ey)


def test_coefficients_of_the_cardioid_are_the_papers():
    found = harmonics(tables.cardioid.components[0])

    assert found == {
        0: ((Rational(1, 2), 0), (0, 0)),
        1: ((1, 0), (0, 1)),
        2: ((Rational(1, 2), 0), (0, Rational(1, 2))),
    }
    assert all(low < high for low, high in pairwise(found))


@pytest.mark.parametrize("K", [2, 3, 5])
def test_in_the_frame_of_the_flight_the_chord_polynomial_is_the_same(K):
    E, B = (((1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)) for t in (Rational(1, 3), Rational(-9, 4)))
    h = harmonics(tables.named("egg", K).components[0])
    ahead = {k: seen_ahead(k, *vectors, E) for k, vectors in h.items()}
    differences = zip(chord_polynomial(ahead, ONE, B), chord_polynomial(h, E, B), strict=True)

    assert [expand(p - q) for p, q in differences] == [0] * (2 * K + 2)
