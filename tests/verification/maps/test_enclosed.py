"""The map in balls and in mpmath: what is printed of an orbit, where it begins and ends, lengths of boundaries."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from sympy import Rational, pi, sqrt

from numeric import PinballMap
from symbolic import tables
from verification.arithmetic.balls import working
from verification.maps.enclosed import EnclosedMap, _text, _turns, in_balls, in_multiprecision, number, perimeter

SCENES = {
    "egg": {"alpha": "0.08", "lam": "1/2"},
    "cuspless": {"lam": "1/3"},
    "cardioid": {"lam": "1/2"},
}


@pytest.mark.parametrize("name", SCENES)
def test_an_orbit_is_the_same_in_balls_in_mpmath_and_in_doubles_as_far_as_each_goes(name):
    map, told = PinballMap(name, **SCENES[name]), []
    lam, start = Rational(SCENES[name]["lam"]), (Rational(3, 10), Rational(1, 5), 0)
    enclosed = in_balls(map, lam, start, 4, 25, told.append)
    computed = in_multiprecision(map, lam, start, 4, 25, told.append)
    orbit = map.orbit(0.3, 0.2, 4)

    assert told == ["1", "2", "3", "4"] * 2
    assert len(enclosed) == len(computed) == 5
    assert enclosed[0]["eta"] is computed[0]["eta"] is None
    for i, (one, other) in enumerate(zip(enclosed, computed, strict=True)):
        assert one["component"] == other["component"]
        assert one["status"] == other["status"] == "regular"
        for word in ("theta", "s", "x", "y", "phi", *(("eta",) if i else ())):
            assert abs(Fraction(one[word]) - Fraction(other[word])) <= Fraction(3, 10**24) * max(
                1, abs(Fraction(one[word]))
            )
        for word, value in (("theta", orbit.theta[i]), ("phi", orbit.phi[i])):
            assert abs(float(one[word]) - value) < 1e-12


@pytest.mark.parametrize("orbit", [in_balls, in_multiprecision])
def test_a_start_beyond_a_whole_turn_is_the_one_on_the_boundary(orbit):
    map, lam = PinballMap("circle"), Rational(1, 2)
    plain, turned = (
        orbit(map, lam, (Rational(3, 10) + 2 * k * pi, Rational(1, 5), 0), 2, 20, lambda said: None) for k in (0, -3)
    )

    assert turned == plain
    assert _turns(map, (Rational(3, 10) - 6 * pi, 0, 0)) == -3
    assert _turns(PinballMap("cuspless"), (20.0, 0, 0)) == 0


@pytest.mark.parametrize("orbit", [in_balls, in_multiprecision])
def test_an_orbit_ends_where_the_map_is_not_defined_and_says_why(orbit):
    """Along the axis of the cardioid into its cusp."""
    entries = orbit(PinballMap("cardioid"), Rational(1, 2), (Rational(0), Rational(0), 0), 5, 20, lambda said: None)

    assert [entry["status"] for entry in entries] == ["regular", "cusp"]
    assert entries[1]["eta"] is None
    assert entries[1]["theta"] == entries[0]["theta"]


@pytest.mark.parametrize("value", ["1/3", "-12345.678", "1e-30", "-0.000123456789", "0", "99999.99999"])
def test_the_digits_printed_are_those_of_the_ball_but_for_one_in_the_last(value):
    with working(300):
        exact = Fraction(value)
        middle = arb(exact.numerator) / exact.denominator
        for digits in (5, 20):
            shown = _text(middle + arb(0, 10.0 ** (-digits - 3)), digits)
            before = len(str(abs(int(exact)))) if abs(exact) >= 1 else 0  # digits before the point
            assert abs(Fraction(shown) - exact) <= Fraction(10) ** (before - digits)
            assert _text(middle + arb(0, 2 * 10.0**-digits * max(1.0, abs(float(exact)))), digits) == ""
            assert len(shown.lstrip("-").replace(".", "").lstrip("0").split("e")[0]) <= digits


def test_numbers_of_every_kind_become_balls_that_hold_them_with_the_bits_asked_for():
    with working(250):
        for value, truth in (
            (Fraction(1, 3), arb(1) / 3),
            (0.1, arb(0.1)),
            (7, arb(7)),
            (sqrt(Rational(2)), arb(2).sqrt()),
        ):
            found = number(value, 200)
            assert found.overlaps(truth)
            assert found.rad() < 1e-59
        ball = arb(1, 2)
        assert number(ball, 200) is ball


@pytest.mark.parametrize(
    "formula",
    ["2 + atan(cos(theta))", "(2 + cos(theta))^(1/3)", "2 + log(2 + sin(theta))", "2 + tanh(sin(theta))"],
)
def test_the_length_of_a_boundary_is_that_of_a_fine_polygon(formula):
    """The rule of equal steps converges faster than any power for a smooth closed curve."""
    map = PinballMap(tables.polar(formula))
    enclosed = EnclosedMap(map, 1, bits=100)
    found = perimeter(enclosed, 20)
    at = 2 * np.pi * np.arange(256) / 256
    slopes = np.array([[float(v) for v in enclosed.curve(0, arb(float(x)))[2:4]] for x in at])

    assert found.rad() < 1e-15
    assert float(found) == pytest.approx(np.mean(np.hypot(*slopes.T)) * 2 * math.pi, rel=1e-12)
    half = enclosed.length(0, arb(1)) - enclosed.length(0, arb("0.5"))
    some = np.polynomial.legendre.leggauss(40)
    speeds = [float((sum(v * v for v in enclosed.curve(0, arb(0.75 + x / 4))[2:4])) ** 0.5) for x in some[0]]
    assert float(half) == pytest.approx(np.dot(some[1], speeds) / 4, rel=1e-12)
