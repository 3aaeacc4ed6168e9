"""The map in balls and in mpmath: printed orbits, their starts and ends, and lengths of boundaries."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from numeric import PinballMap
from symbolic import Scene, tables
from verification.arithmetic.balls import working
from verification.maps.enclosed import EnclosedMap, Refusal, perimeter
from verification.maps.exact import ExactMap
from verification.maps.orbits import in_balls, in_multiprecision

BITS = 120

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
def test_an_orbit_ends_where_the_map_is_not_defined_and_says_why(orbit):
    """Along the axis of the cardioid into its cusp."""
    entries = orbit(PinballMap("cardioid"), Rational(1, 2), (Rational(0), Rational(0), 0), 5, 20, lambda said: None)

    assert [entry["status"] for entry in entries] == ["regular", "cusp"]
    assert entries[1]["eta"] is None
    assert entries[1]["theta"] == entries[0]["theta"]


@pytest.mark.parametrize(
    "formula",
    ["2 + atan(cos(theta))", "(2 + cos(theta))^(1/3)", "2 + log(2 + sin(theta))", "2 + tanh(sin(theta))"],
)
def test_the_length_of_a_boundary_is_that_of_a_fine_polygon(formula):
    """For a smooth closed curve the trapezoidal rule converges faster than any power."""
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


@pytest.fixture(scope="module")
def ellipse():
    return EnclosedMap(PinballMap("ellipse", a=2, lam="1/2"), Fraction(1, 2), BITS)


@pytest.mark.parametrize(("theta", "phi"), [(0.0, 0.0), (1.0, 0.3), (2.5, -1.2), (-2.0, 0.9)])
def test_a_start_flies_off_at_its_angle_from_the_inward_normal_towards_the_tangent(ellipse, theta, phi):
    """On an ellipse with half axes 2 and 1, with tangent and normal worked out by hand."""
    found = ellipse.start(theta, phi)
    dx, dy = -2 * math.sin(theta), math.cos(theta)
    size = math.hypot(dx, dy)
    tangent, normal = (dx / size, dy / size), (-dy / size, dx / size)
    wanted = [math.sin(phi) * t + math.cos(phi) * n for t, n in zip(tangent, normal, strict=True)]
    assert [float(v) for v in found.v] == pytest.approx(wanted, abs=1e-15)
    assert (float(found.x), float(found.y)) == pytest.approx((2 * math.cos(theta), math.sin(theta)), abs=1e-15)
    assert (found.component, found.theta, found.phi) == (0, theta, phi)
    assert max(x.rad() for x in (*found.v, found.x, found.y)) < 1e-34


def test_a_start_of_a_set_holds_all_its_flights(ellipse):
    wide = ellipse.start(arb(1, 0.01), arb(0.3, 0.02))
    for theta, phi in ((0.99, 0.28), (1.01, 0.32), (0.99, 0.32), (1, 0.3)):
        one = ellipse.start(theta, phi)
        for held, value in zip((*wide.v, wide.x, wide.y), (*one.v, one.x, one.y), strict=True):
            assert held.overlaps(value)
    assert all(x.rad() < 0.06 for x in (*wide.v, wide.x, wide.y))


def test_the_length_up_to_a_set_of_places_holds_that_of_each_and_is_as_wide_as_the_curve_is_fast(ellipse):
    """On an ellipse by the trapezoidal rule, on a circle by its parameter."""
    speed = lambda t: np.hypot(2 * np.sin(t), np.cos(t))  # noqa: E731
    wide = ellipse.length(0, arb(1, 0.01), 25)
    for end in (0.99, 1.0, 1.01):
        at = np.linspace(0, end, 20001)
        true = np.trapezoid(speed(at), at)
        assert wide.overlaps(arb(true, 1e-8))
        assert float(ellipse.length(0, arb(end), 25)) == pytest.approx(true, rel=1e-8)
    assert float(wide.rad()) == pytest.approx(0.01 * speed(1.0), rel=0.05)
    with working(BITS):
        assert ellipse.length(0, arb(1), 25).rad() < 1e-25
        assert ellipse.length(0, arb(1)).rad() < 1e-30  # of all its bits
        backward = ellipse.length(0, arb(-1), 25)
        assert (backward + ellipse.length(0, arb(1), 25)).contains(0)


@pytest.mark.parametrize(("start", "turns"), [(10, 2), (-4, -1), (3, 0)])
def test_an_orbit_begins_where_whole_turns_lead_a_start(start, turns):
    (found,) = in_balls(PinballMap("circle"), 1, (Rational(start), 0, 0), 0, 12, lambda done: None)
    assert float(found["theta"]) == pytest.approx(start - 2 * math.pi * turns, abs=1e-11)


def test_a_contraction_that_is_text_means_the_decimal_that_it_shows():
    egg = PinballMap("egg", alpha="2/25")
    for text in ("9/10", "0.9"):
        exact, own = ExactMap(egg, 50, text), EnclosedMap(egg, text, 400)
        assert abs(exact.lam - exact.context.mpf(9) / 10) < 1e-60
        with working(400):
            assert (own.lam * 10 - 9).contains(0)
            assert own.lam.rad() < 1e-100


def test_a_map_is_made_of_a_table_a_name_a_scene_or_a_map():
    scene = Scene("egg", alpha="2/25", lam="1/3")
    given = [(scene, {}), ("egg", {"alpha": "0.08", "lam": "1/3"}), (tables.egg(3), {"alpha": "2/25", "lam": "1/3"})]
    for table, numbers in (*given, (PinballMap(scene), {"lam": "1/3"})):
        exact, balls = ExactMap(table, digits=30, **numbers), EnclosedMap(table, digits=30, **numbers)
        landed, held = exact.bounce(exact.start("0.1", "0.2")), balls.bounce(balls.start("1/10", "0.2"))
        assert held.phi.rad() < 1e-30
        assert abs(exact.middle(held.phi) - landed.phi) < 1e-30
    with pytest.raises(ValueError, match="give one of them"):
        EnclosedMap(scene, bits=100, digits=30)


@pytest.mark.parametrize("digits", [3, 10, 13, 14, 15, 17, 30])
def test_beyond_a_corner_at_the_ends_of_its_parameter_a_curve_of_one_formula_is_not_followed(digits):
    """A start beside theta = 0 lands beside the corner at pi, on its own side, or is said to be in doubt there."""
    scene, away = Scene(tables.polar("1 + cos(theta/2)/12"), lam="1/2"), Fraction(1, 10**digits)
    map, step = EnclosedMap(scene, digits=60), PinballMap(scene).step(float(away), 0.0)
    landed = map.bounce(map.start(away, 0))

    assert step.code or (-np.pi <= step.theta < -3.14 and step.phi > 0.02)
    assert landed is Refusal.WIDE or landed.code or (-arb.pi() < landed.theta and landed.phi > 0.02)


def test_at_a_jump_of_the_law_on_a_closed_curve_both_sides_are_held_or_nothing_is_proved():
    map = EnclosedMap(Scene("circle", lam="1/2", law="-lam*eta + theta/10"), digits=30)
    landed, beside = map.bounce(map.start(0, 0)), map.bounce(map.start(Fraction(1, 10**14), 0))

    assert landed is Refusal.WIDE or (landed.phi.contains(arb.pi() / 10) and landed.phi.contains(-arb.pi() / 10))
    assert beside.phi < -0.3


def test_beyond_a_smooth_end_the_formula_of_the_next_component_holds_though_it_is_the_same_component():
    """A landing 1e-20 beyond the end; its place by bisection on the boundary in 70 digits."""
    map = EnclosedMap(Scene(tables.polar("1 + theta*(theta^2-pi^2)^2/2000"), lam="1/2"), digits=55)
    phi = "0.1206364594594235067110971724244524366570184742739348342009671605880649"
    landed = map.bounce(map.start("1/3", phi))

    with working(250):
        assert landed.theta.overlaps(arb("-3.14159265358979323845264338327950288419716939937510582097494 +/- 1e-58"))


def test_an_orbit_that_starts_beyond_a_corner_is_not_proved():
    map = EnclosedMap(Scene(tables.polar("1 + cos(theta/2)/12"), lam="1/2"), digits=30)
    starts = ["3.3", "-3.2", "3.14159265358979323847", arb(3.14159, "1e-3")]

    assert all(isinstance(map.bounce(map.start(at, "0.2")), Refusal) for at in starts)
