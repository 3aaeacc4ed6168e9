"""The egg's polynomials in `C = cos(K*theta)` are what the definitions and plain complex numbers give."""

from cmath import exp
from itertools import pairwise
from math import acos, cos, isclose, pi, ulp

import pytest
from sympy import Rational, S, symbols
from sympy import cos as cosine

from symbolic.cycles.polygons import (
    COSINE,
    centre_beyond_boundary,
    centre_far_inside,
    curvature_slope_polynomial,
    in_cosine,
    slap_critical_cosines,
    slap_critical_points,
    squared_speed_polynomial,
    turning_polynomial,
)
from symbolic.tables import egg
from symbolic.tables.geometry import curvature
from symbolic.tables.table import alpha, theta


def beyond_the_boundary(shape, at):
    """`|e|**4 - |e|**3 - alpha*Re(e**3)` of the centre of curvature, from `rho` and its derivatives in float64."""
    rho, first, second = 1 + shape * cos(3 * at), -3 * shape * (1 - cos(3 * at) ** 2) ** 0.5, -9 * shape * cos(3 * at)
    ray = exp(1j * at)
    velocity, acceleration = (first + 1j * rho) * ray, (second - rho + 2j * first) * ray
    centre = rho * ray + 1j * velocity * abs(velocity) ** 2 / (velocity.conjugate() * acceleration).imag
    return abs(centre) ** 4 - abs(centre) ** 3 - shape * (centre**3).real


@pytest.mark.parametrize("K", [2, 3])
def test_the_curvature_is_the_quotient_of_the_polynomials(K):
    C = cosine(K * theta)
    N, Q = (polynomial(K).subs(COSINE, C) for polynomial in (turning_polynomial, squared_speed_polynomial))
    found = curvature(egg(K).components[0])

    for at in (S.Zero, Rational(1, 5), Rational(7, 8)):
        values = {theta: at, alpha: Rational(1, 30)}
        assert isclose(found.evalf(30, subs=values), -(N / Q ** Rational(3, 2)).evalf(30, subs=values), rel_tol=1e-14)


@pytest.mark.parametrize("K", [(), (2,)])
def test_the_slope_is_the_derivative_of_the_curvature_up_to_a_positive_factor(K):
    N, Q = turning_polynomial(*K), squared_speed_polynomial(*K)
    derivative = (N / Q ** Rational(3, 2)).diff(COSINE) * 2 * Q ** Rational(5, 2)

    for cosine_here in (Rational(1, 3), -Rational(4, 5), S.One):
        values = {COSINE: cosine_here, alpha: Rational(1, 30)}
        assert isclose(derivative.evalf(30, subs=values), curvature_slope_polynomial(*K).subs(values), rel_tol=1e-14)


def test_a_multiple_angle_becomes_a_chebyshev_polynomial_of_a_real_cosine():
    assert in_cosine(cosine(8 * theta) + alpha, K=4) == 2 * COSINE**2 - 1 + alpha
    assert COSINE.is_real
    assert symbols("C", real=True) == COSINE


@pytest.mark.parametrize("shape", ["11/200", "111/2000", "14/250", "2/25"])
def test_critical_points_of_the_slap_map_are_where_the_centre_of_curvature_crosses_the_boundary(shape):
    """On `0 < theta < pi/3`, where `sin(3*theta) > 0`; the first appears at `alpha = 0.0553854`."""
    shape, count = Rational(shape), 300
    signs = [beyond_the_boundary(float(shape), (k + 0.5) * pi / 3 / count) > 0 for k in range(count)]
    crossed = sum(before != after for before, after in pairwise(signs))
    found = [float(root.eval_rational(n=30)) for root in slap_critical_cosines(shape)]

    assert len(found) == crossed == (1 if shape > Rational(553854, 10**7) else 0)
    assert slap_critical_points(shape) == 6 * crossed
    for root in found:
        at = acos(root) / 3
        assert beyond_the_boundary(float(shape), at - 1e-9) * beyond_the_boundary(float(shape), at + 1e-9) < 0
        assert abs(beyond_the_boundary(float(shape), at)) < 64 * ulp(1.0)


@pytest.mark.parametrize("shape", ["1/50", "111/2000", "2/25"])
def test_the_centre_of_curvature_lies_beyond_the_boundary_where_the_definition_says(shape):
    """`|e| - rho` times `N`, and `|e|**4 - |e|**3 - alpha*Re(e**3)`, which is `|e|**3` times that distance."""
    values = {alpha: Rational(shape)}
    far, beyond = (f().subs(values) for f in (centre_far_inside, centre_beyond_boundary))
    for k in range(1, 12):
        at = k * pi / 36
        here = {COSINE: cos(3 * at)}
        expected = beyond_the_boundary(float(Rational(shape)), at)
        assert far.subs(here) > 0 or (beyond.subs(here) > 0) == (expected > 0)
        assert not (far.subs(here) > 0 and expected > 0)
