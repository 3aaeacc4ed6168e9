"""The egg's polynomials in `C = cos(K*theta)` agree with the definitions and with plain complex numbers."""

from cmath import exp
from itertools import pairwise
from math import acos, cos, isclose, pi, ulp

import pytest
from sympy import Rational, S
from sympy import cos as cosine

from symbolic.cycles.polygons import (
    COSINE,
    slap_critical_cosines,
    slap_critical_points,
    squared_speed_polynomial,
    turning_polynomial,
)
from symbolic.tables import egg
from symbolic.tables.geometry import curvature
from symbolic.tables.table import alpha, theta


def beyond_the_boundary(shape, at):
    """`|e|**4 - |e|**3 - alpha*Re(e**3)` at the centre of curvature `e`, from the radius and its derivatives."""
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


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["11/200", "111/2000", "14/250", "2/25"])
def test_critical_points_of_the_slap_map_are_where_the_centre_of_curvature_crosses_the_boundary(shape):
    """On `0 < theta < pi/3`, where `sin(3*theta) > 0`; the first critical point appears at `alpha = 0.0553854`."""
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
