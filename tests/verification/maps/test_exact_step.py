"""One bounce in many digits from the float64 kernel's landing, against a search for every zero, and in balls."""

from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from sympy import Rational

from numeric import PinballMap
from numeric.backends.scalars import ScalarBackend
from numeric.flights.general import General
from symbolic import tables
from verification.arithmetic.balls import as_ball, working
from verification.maps import strategies
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import ExactMap
from verification.maps.flight import Obstacles, curve, precisions
from verification.maps.lengths import ExactArcLength
from verification.maps.orbits import in_balls, in_multiprecision
from verification.measure.work.plain import egg_orbit

DIGITS, BITS = 30, 200
TABLES = {
    "egg": PinballMap("egg", alpha="0.08", lam="1/2"),
    "egg at its end": PinballMap("egg", alpha="1/10", lam="9/10"),
    "circle": PinballMap("circle", lam="1/3"),
    "ellipse": PinballMap("ellipse", a="3/2", lam="1/2"),
    "long ellipse": PinballMap("ellipse", a=9, lam="4/5"),
    "cardioid": PinballMap("cardioid", lam="1/2"),
    "cardioid, elastic": PinballMap("cardioid", lam=1),
    "cuspless": PinballMap("cuspless", lam="2/3"),
    "stadium": PinballMap("stadium", lam="1/2"),
    "square": PinballMap("square", lam="3/4"),
    "triangle": PinballMap("triangle", lam="3/4"),
    "mushroom": PinballMap("mushroom", lam="4/5"),
    "sinai": PinballMap("sinai", lam="4/5"),
    "flower": PinballMap(tables.polar("1 + cos(5*theta)/10"), lam="1/2", kernels=False),
    "flat flower": PinballMap(tables.polar("1 + cos(5*theta)/40"), lam="1/2", kernels=False),
    "limacon": PinballMap(tables.polar("1 + 3*cos(theta)/4"), lam="1/2", kernels=False),
    "steep": PinballMap(tables.polar("2 + tanh(sin(theta))"), lam="1/2", kernels=False),
    "root": PinballMap(tables.polar("(2 + cos(theta))^(1/3)"), lam="1/2", kernels=False),
    "bent law": PinballMap("egg", alpha="0.05", lam="1/2", law="-lam*eta + sin(2*eta)/5", kernels=False),
    "placed law": PinballMap("circle", lam="1/2", law="-lam*eta*(3/4 - sin(theta)/8)", kernels=False),
}


class Searched:
    """The landing by definition: the first of all zeros of the flight function on all pieces."""

    def __init__(self, map, digits):
        self.context = mpmath.MPContext()
        self.context.dps = digits
        self.ops, self.general = ScalarBackend(self.context), General(map.states.boundary)
        self.general.parts = map.ir.parts
        self.shape = [self.context.mpf(Fraction(x).numerator) / Fraction(x).denominator for x in map.exact_shape]
        self.general.ends = [tuple(part.ends(self.ops, *self.shape)) for part in map.ir.parts]

    def landing(self, here):
        state = [self.context.mpf(x) for x in (here.component, here.theta)], [self.context.mpf(x) for x in here.v]
        found = self.general.fly(self.ops, self.shape, "pinball", *state)
        return int(found.position[0]), found.position[1], int(found.code or 0)


def starts(map, count, seed):
    """Random parameters and exit angles, as exact numbers."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        part = int(rng.integers(len(map.states.ends)))
        low, high = map.states.ends[part]
        share, phi = Fraction(float(rng.uniform(0.01, 0.99))), Fraction(float(rng.uniform(-1.5, 1.5)))
        yield Fraction(low) + (Fraction(high) - Fraction(low)) * share, phi, part


def gap(map, mp, one, other):
    """The distance of two parameters, measured round a closed curve."""
    return abs(mp.sin((one - other) / 2)) if len(map.states.ends) == 1 else abs(one - other)


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLES)
def test_a_landing_is_the_first_of_all_zeros_of_the_flight_function(name):
    map = TABLES[name]
    exact, searched = ExactMap(map, DIGITS), Searched(map, DIGITS + 30)
    mp = exact.context
    for theta, phi, part in starts(map, 6, 1):
        here = exact.start(exact.exactly(theta), exact.exactly(phi), part)
        found, (component, at, code) = exact.bounce(here), searched.landing(here)
        if not code:
            assert (found.component, found.code) == (component, 0)
            assert gap(map, mp, found.theta, at) < mp.mpf(10) ** (-DIGITS - 10)


HARD = {  # labelled starts: theta and phi
    "grazing from the start": ("ellipse", "0.3", "1.5707"),
    "through the axis": ("ellipse", 0, 0),
    "into the cusp": ("cardioid", 0, 0),
    "beside the cusp": ("cardioid", "3.14", "0.1"),
    "out of the dent of a flower": ("flower", "0.628318", "1.2"),
    "past the dent of a limacon": ("limacon", "3.0", "1.5"),
    "into a corner": ("square", "1/2", "0.7853981"),
    "almost a corner": ("cuspless", "2.0943951", "0"),
    "along a straight side": ("stadium", "0.5", "1.5"),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_flights_end_as_the_search_for_every_zero_says(name):
    table, theta, phi = HARD[name]
    map = TABLES[table]
    exact, searched = ExactMap(map, DIGITS), Searched(map, DIGITS + 30)
    low, high = map.states.ends[0]
    begin = min(max(Fraction(theta), Fraction(low)), Fraction(high))
    here = exact.start(exact.exactly(begin), exact.exactly(Fraction(phi)))
    found, (component, at, code) = exact.bounce(here), searched.landing(here)
    if found.code:
        assert code or name == "into the cusp"
    else:
        assert (component, code) == (found.component, 0)
        assert gap(map, exact.context, found.theta, at) < exact.context.mpf(10) ** -DIGITS


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(particle=strategies.particles(laws=strategies.reflections()))
def test_the_exact_step_is_the_one_of_the_kernel_in_all_its_digits(particle):
    """On the paper's tables with any shape and several laws, except where rounding decides the landing."""
    map, at = particle.map, (particle.theta, particle.phi, particle.component)
    step, exact = map.step(*at), ExactMap(map, DIGITS, particle.lam)
    found = exact.bounce(exact.start(*at))
    size = float(np.abs(map.derivative(*at)).max()) if not step.code else np.inf
    if step.code or found.code or np.cos(step.eta) < 1e-3:
        return
    bound = 4096 * 2.0**-52 * (1 + size) ** 2 / np.cos(step.eta)
    assert found.component == step.component
    assert abs(float(found.x) - step.x) + abs(float(found.y) - step.y) + abs(float(found.phi) - step.phi) < bound


@pytest.mark.parametrize("name", TABLES)
def test_balls_hold_orbits_of_two_hundred_digits_and_no_landing_is_refused(name):
    map, refused = TABLES[name], 0
    lam = map.lam.flat[0]
    truth, balls = ExactMap(map, 200), EnclosedMap(map, lam, BITS)
    for theta, phi, part in starts(map, 5, 2):
        exact, enclosed = truth.start(truth.exactly(theta), truth.exactly(phi), part), balls.start(theta, phi, part)
        for _ in range(3):
            exact, enclosed = truth.bounce(exact), balls.bounce(enclosed)
            if isinstance(enclosed, Refusal):
                refused += 1
                break
            if exact.code or enclosed.code:
                assert exact.code == enclosed.code
                break
            assert exact.component == enclosed.component
            with working(800):
                turn = round(float(enclosed.theta.mid() - as_ball(exact.theta)) / 6.283) * 2 * arb.pi()
                assert (enclosed.theta - turn).overlaps(as_ball(exact.theta))
                for held, value in ((enclosed.phi, exact.phi), (enclosed.x, exact.x), (enclosed.y, exact.y)):
                    assert held.overlaps(as_ball(value))
            assert enclosed.phi.rad() < 1e-35
    assert refused == 0


def test_what_a_flight_meets_on_its_way_is_not_passed():
    """A flight across a dent of the flower, where the chord between two leaves lies outside."""
    flower = TABLES["flower"]
    at = curve(flower.ir.parts[0].curve, ScalarBackend(mpmath.MPContext()), [], 2)
    obstacles = Obstacles(flower)

    def place(theta):
        return (0, theta, *map(float, at(theta)))

    assert not obstacles.convex
    assert not obstacles.passed(place(0.15), place(2 * np.pi / 5 - 0.15))  # over the dent between
    assert obstacles.passed(place(0.0), place(2.5))
    assert not obstacles.passed(place(0.0), place(2.5), radius=1e-3)


@pytest.mark.parametrize("bits", [20, 96, 97, 200, 4000])
def test_each_precision_is_at_most_twice_the_one_before_and_the_first_is_what_a_guess_fills(bits):
    found = precisions(bits)
    assert found[-1] == bits
    assert found[0] <= 96
    assert all(one < other <= 2 * one for one, other in pairwise(found))


@pytest.mark.parametrize("name", ["egg", "ellipse", "long ellipse", "limacon", "root"])
def test_lengths_by_series_are_those_by_quadrature(name):
    """From the twentieth length on, the Taylor series is used."""
    map = TABLES[name]
    balls = EnclosedMap(map, 1, BITS)
    length = ExactArcLength(balls.parts[0], balls.shape, balls.ends[0], BITS)
    places = [arb(x) / 8 for x in range(-25, 26)]
    found = [length(arb(0), at) for at in places]
    once = [
        ExactArcLength(balls.parts[0], balls.shape, balls.ends[0], BITS)(arb(0), at)
        for at in (places[20], places[40], places[-1])
    ]
    with working(BITS):
        for one, other in zip(once, (found[20], found[40], found[-1]), strict=True):
            assert one.overlaps(other)
            assert other.rad() < 1e-55
    exact = ExactMap(map, DIGITS)
    mp, (low, high) = exact.context, map.states.ends[0]
    assert abs(exact.length(0, mp.mpf(1)) - exact.middle(length(arb(0), arb(1)))) < mp.mpf(10) ** -50
    assert low < 0 < high


def test_an_orbit_has_the_digits_of_the_shortest_script():
    """A chaotic orbit of the egg, against a short script with enough extra digits, and against balls of few bits."""
    map, keys = PinballMap("egg", alpha="0.08", lam="0.5"), ("theta", "phi")
    given = map, Rational(1, 2), (Rational(3, 10), Rational(1, 5), 0), 150, 30, lambda done: None, keys
    mp = mpmath.MPContext()
    mp.dps = 60
    script = egg_orbit(("0.3", "0.2"), 150, 90, "0.08", "0.5")
    for entries in (in_multiprecision(*given), in_balls(*given)):
        for entry, (theta, phi) in zip(entries, script, strict=True):
            assert abs(mp.mpf(entry["theta"]) - theta) < 4e-29
            assert abs(mp.mpf(entry["phi"]) - phi) < 2e-29
