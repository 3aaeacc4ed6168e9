"""The flip of a cycle on a bent wall: its linear part is the package's, and its sign that of simulated orbits."""

import math

import pytest
from sympy import Rational, sqrt

from symbolic.cycles.cycle import cuspless_horizontal, monodromy
from symbolic.cycles.normal_forms import a, arc_jets, coefficient, least_bend, return_map


def test_a_straight_wall_has_the_monodromy_of_the_horizontal_orbit():
    assert (return_map()[0].subs(a, 0) - monodromy(cuspless_horizontal())).expand().is_zero_matrix


def test_a_bend_of_the_wall_beyond_the_least_makes_the_flip_supercritical():
    free, bent = coefficient()

    assert free < 0 < bent
    assert free + bent * least_bend() == 0
    assert free == -541 * sqrt(11) / 4356
    assert arc_jets() == (Rational(3, 8), Rational(7, 128))


def bounce(y, phi, contraction, bend):
    """The next `(y, phi)` after a flight from the wall `x = -1/4 + bend*y^4` to the arc and back, by bisection."""
    x, slope = -0.25 + bend * y**4, 4 * bend * y**3
    direction = phi - math.atan(slope)
    across = root(lambda h: aside((arc(h)[0] - x, arc(h)[1] - y), direction), -0.9, 0.9)
    landed = arc(across)
    normal = 3 * across / 2  # of the outward normal at theta = across
    back = math.pi + normal + contraction * (normal - direction)
    y1 = root(lambda u: aside((-0.25 + bend * u**4 - landed[0], u - landed[1]), back), -0.43, 0.43)
    inward = -math.atan(4 * bend * y1**3)
    incidence = back - math.pi - inward
    return y1, -contraction * incidence


def arc(theta):
    radius = 1 + math.cos(theta)
    return radius * math.cos(theta), radius * math.sin(theta)


def aside(vector, direction):
    return vector[1] * math.cos(direction) - vector[0] * math.sin(direction)


def root(function, low, high):
    rising = function(high) > 0
    for _ in range(80):
        middle = (low + high) / 2
        if (function(middle) > 0) == rising:
            high = middle
        else:
            low = middle
    return (low + high) / 2


@pytest.mark.parametrize(("bend", "factor"), [(0.0, 1.0), (0.2, 1.0), (0.2, 0.5)])
def test_orbits_beside_the_flip_approach_a_period_4_orbit_only_when_it_is_supercritical(bend, factor):
    """At `lam = 0.0944`, 0.001 beyond the flip, the orbit's height is `xi = sqrt((|mu| - 1)/c)`."""
    contraction = 0.0944
    free, bent = (float(part) for part in coefficient())
    c = free + bent * bend
    y, phi = 0.01 * factor, 0.0
    for _ in range(4000):
        y, phi = bounce(y, phi, contraction, bend)
        if abs(y) > 0.3:
            break
    if bend == 0:
        assert abs(y) > 0.3
    else:
        trace, det = -27 / 8 * contraction - 11 / 16 * (1 + contraction**2), contraction**2
        mu = (trace - math.sqrt(trace**2 - 4 * det)) / 2
        assert abs(y) == pytest.approx(math.sqrt((-mu - 1) / c), rel=0.05)
