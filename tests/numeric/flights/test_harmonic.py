"""The steps of ellipses and of convex Fourier sums: what rounding does to them, and a second way to the landing."""

import numpy as np
import pytest
from sympy import Interval as Range
from sympy import Rational, Symbol, cos, sin

from numeric import PinballMap, Status
from numeric.flights.general import General
from numeric.kernels.machine import KernelSpec
from symbolic import Law, tables
from symbolic.tables.table import Shape
from symbolic.tables.table import theta as symbol
from verification.maps.exact import ExactMap, errors

HERE = np.zeros(24, dtype=np.int64)
SIGN = np.where(np.arange(24) % 2 == 0, 1, -1)
TABLES = {
    "ellipse": ("ellipse", {"a": "3/2"}),
    "long ellipse": ("ellipse", {"a": 100}),
    "egg": ("egg", {"alpha": "0.08"}),
    "two-egg": ("egg", {"alpha": "0.15", "K": 2}),
    "five-egg": ("egg", {"alpha": "0.03", "K": 5}),
    "long": (tables.parametric(5 * cos(symbol) + cos(2 * symbol) / 10, sin(symbol), name="long"), {}),
}


@pytest.fixture(params=list(TABLES))
def harmonic(request):
    """A map of the contraction given."""
    name, shape = TABLES[request.param]
    return lambda lam, **more: PinballMap(name, lam=lam, **shape, **more)


@pytest.mark.parametrize("lam", [0, 0.3, 1])
def test_anywhere(harmonic, lam, rounding):
    rng = np.random.default_rng(5)
    theta, phi = rng.uniform(-3.1, 3.1, 24), rng.uniform(-1.4, 1.4, 24) * (lam > 0)
    place, direction = rounding(harmonic(lam, kernels=False), HERE, theta, phi)

    assert place <= 4
    assert direction <= 8


@pytest.mark.parametrize("gap", [1e-3, 1e-7, 1e-12])
def test_grazing(harmonic, gap, rounding):
    place, direction = rounding(harmonic(0.9, kernels=False), HERE, np.linspace(-3, 3, 24), SIGN * (np.pi / 2 - gap))

    assert place <= 4
    assert direction <= 8


def test_landings_are_on_the_line_of_flight(harmonic):
    map = harmonic(0.7, kernels=False)
    theta, phi = np.linspace(-3.1, 3.1, 400), np.tile(np.linspace(-1.5, 1.5, 20), 20)
    here, step = map.states.point(np.zeros(400, dtype=int), theta), map.step(theta, phi)
    vx, vy = map.states.direction(np.zeros(400, dtype=int), theta, phi)
    dx, dy = step.x - here[0], step.y - here[1]

    assert np.max(np.abs(dx * vy - dy * vx)) <= 32 * 2.0**-52 * max([1, *map.shape])
    assert np.min(dx * vx + dy * vy) > 0
    assert not step.code.any()
    (px, py), (tx, ty) = map.states.point(step.component, step.theta), map.states.tangent(step.component, step.theta)
    assert np.max(np.hypot(px - step.x, py - step.y)) == 0
    eta = -np.arctan2(vx * tx + vy * ty, vx * ty - vy * tx)
    assert np.max(np.abs(step.phi + 0.7 * eta) * np.cos(eta)) <= 1e-12


def test_the_slap_map_of_an_ellipse_needs_no_unit_normal_but_exponents_do(harmonic):
    map = harmonic(0, kernels=False)
    theta = np.linspace(-3, 3, 24)
    own = map.states.enter(HERE, theta, 0 * theta, "slap")
    fast = map.engine.run(KernelSpec("slap"), own, np.zeros(24), map.shape, 1).rows
    step = map.at(lam=1).step(theta, 0.0)

    assert np.max(np.abs(np.arctan2(fast["uy"], fast["ux"]) - step.theta)) <= 1e-13
    slope = map.slap(theta).slope
    curvature, length = (
        map.states.curvature(HERE, theta),
        np.hypot(step.x - map.states.point(HERE, theta)[0], step.y - map.states.point(HERE, theta)[1]),
    )
    assert np.allclose(slope, -(1 + length * curvature) / np.cos(step.eta), rtol=1e-11, atol=1e-11)


def test_a_table_without_symmetry_is_as_exact(rounding):
    x = cos(symbol) + Rational(1, 9) * sin(2 * symbol) + Rational(1, 5)
    y = sin(symbol) + Rational(1, 20) * cos(3 * symbol) - Rational(1, 30) * sin(symbol)
    map = PinballMap(tables.parametric(x, y, name="skewed"), lam=0.4, kernels=False)
    place, direction = rounding(map, HERE, np.linspace(-3, 3, 24), np.linspace(1.4, -1.4, 24))

    assert map.path.startswith("chord")
    assert place <= 4
    assert direction <= 8


def test_a_tangent_ball_stops_where_it_is(harmonic):
    map = harmonic(0.9, kernels=False)
    step = map.step([0.3, 0.3], [np.nextafter(np.pi / 2, 0), 1.5])

    assert list(step.status) == [Status.GRAZING, Status.REGULAR]
    assert step.theta[0] == 0.3


@pytest.mark.parametrize("lam", [0, 0.3, 1])
def test_the_derivative_is_the_papers_matrix(harmonic, lam):
    map = harmonic(lam, kernels=False)
    theta, phi = np.linspace(-3, 3, 24), np.linspace(-1, 1, 24) * (lam > 0)
    step, (x, y) = map.at(lam=1).step(theta, phi), map.states.point(HERE, theta)
    k0, k1 = map.states.curvature(HERE, theta), map.states.curvature(HERE, step.theta)
    t, c0, c1 = np.hypot(step.x - x, step.y - y), np.cos(phi), np.cos(step.eta)
    a = t * k0 + c0
    formula = (
        -np.moveaxis(np.array([[a, t], [lam * (k1 * a + k0 * c1), lam * (k1 * t + c1)]]), -1, 0) / c1[:, None, None]
    )
    size = np.max(np.abs(formula)) ** 2

    assert np.allclose(map.derivative(theta, phi), formula, rtol=1e-10, atol=1e-12 * size)


@pytest.mark.parametrize(("alpha", "share"), [("0.02", 0.02), ("0.08", 0.105), ("0.1", 0.125)])
def test_few_flights_need_the_bracket(alpha, share, unsettled):
    """Of 40,000 random particles 9.3 % do at 8/100 and 11.3 % at 1/10, of those that leave along the normal none."""
    map = PinballMap("egg", lam=0.5, alpha=alpha, kernels=False)

    assert unsettled(map) <= share
    assert unsettled(map, slap=True) == 0


def test_a_bounce_takes_the_operations_of_the_page(as_on_the_page):
    as_on_the_page("ellipse", a="3/2")
    as_on_the_page("egg", alpha="0.08")


@pytest.mark.parametrize("lam", [0.3, 1])
def test_areas_change_by_lam_and_the_ratios_of_cosines(harmonic, lam):
    map = harmonic(lam, kernels=False)
    theta, phi = np.linspace(-3, 3, 24), np.linspace(-1, 1, 24)
    found, orbit = map.exponents(theta, phi, 3), map.orbit(theta, phi, 3)
    logs = np.log(lam * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))

    assert np.allclose(found.nu_plus + found.nu_minus, logs.mean(axis=0), rtol=0, atol=1e-10)


def test_chords_may_lie_far_from_those_of_the_circle():
    """Twenty times longer than wide, the middle of a chord is off by more than an eighth of a turn."""
    made = tables.parametric(20 * cos(symbol) + cos(2 * symbol) / 10, sin(symbol), name="thin")
    map = PinballMap(made, lam=0.7, kernels=False)
    theta, phi = np.repeat(np.linspace(-3.1, 3.1, 40), 40), np.tile(np.linspace(-1.5, 1.5, 40), 40)
    step, (x, y) = map.step(theta, phi), map.states.point(np.zeros(1600, dtype=int), theta)
    vx, vy = map.states.direction(np.zeros(1600, dtype=int), theta, phi)

    assert map.path.startswith("chord")
    assert np.max(np.abs((step.x - x) * vy - (step.y - y) * vx)) <= 1e-12
    assert np.min((step.x - x) * vx + (step.y - y) * vy) > 0


CONICS = {  # about the origin: eccentricity 1/4; 999/1000, with the far tip to the left; the same turned
    "round": "1/(2 + cos(theta)/2)",
    "comet": "1/(1 + 999*cos(theta)/1000)",
    "turned": "2/(1 - 999*cos(theta - pi/3)/1000)",
}


@pytest.fixture(params=list(CONICS))
def conic(request):
    """A map on arrays, of the contraction given."""
    table = tables.polar(CONICS[request.param])
    return lambda lam="0.9", **more: PinballMap(table, lam=lam, kernels=False, **more)


def by_definition(map):
    """The same map with every zero of the flight function bracketed on the radius."""
    general = General(map.states.boundary)
    general.formula = map.family.formula
    map.family = map.states.family = general
    map.engine = type(map.engine)(map.family, "", map.engine.names, False)
    return map


@pytest.mark.parametrize("lam", ["0", "0.9", "1"])
def test_a_conic_about_the_origin_is_met_in_closed_form_as_exactly_as_the_papers_tables(conic, lam):
    """From both tips and anywhere; a difference in the radius would cost three digits at the far one.

    And the rounding of a landing, which turns the tips by 22 times as much, would be seen in the direction.
    """
    map = conic(lam)
    theta, phi = np.array([-3.1415, 3.14, 1.047, -2.0945]), np.array([0.3, -1.2, 1.5, 0.01]) * (lam != "0")
    own = map.states.enter(HERE[:4], theta, phi, map.law)
    found = map.engine.run(KernelSpec(map.law, record=True), own, np.full(4, float(lam)), map.shape, 1).record[0]
    place, direction = errors(map, ExactMap(map, 30), own, list(found))

    assert map.family.name == "conic"
    assert np.max(place) <= 4
    assert np.max(direction) <= 8


def test_the_parameter_of_a_conic_is_the_polar_angle_about_its_focus(conic):
    map, theta = conic(), np.concatenate([np.linspace(-np.pi, np.pi, 400), np.pi - 10.0 ** np.arange(-14, 0)])
    here, exact = np.zeros(theta.size, dtype=np.int64), ExactMap(map, 30)
    back = map.states.place(map.states.enter(here, theta, 0 * theta, map.law))[1]
    gap = np.remainder(back - theta + np.pi, 2 * np.pi) - np.pi
    frame, speed = map.states.frame(here, theta), map.states.speed(here, theta)
    curvature = map.states.curvature(here, theta)

    assert np.max(np.abs(gap)) <= 4 * 2.0**-52 * np.pi
    assert np.max(np.abs(np.arctan2(frame.y, frame.x) - np.arctan2(np.sin(theta), np.cos(theta)))) <= 2.0**-50
    for i in (0, 57, 200, 333, 402, 411):
        x, y, dx, dy, ax, ay = map.ir.parts[0].curve(exact.ops, exact.context.mpf(theta[i]))
        size = exact.context.hypot(dx, dy)
        condition = 1 + abs((x * dx + y * dy) / (x * x + y * y))  # of the radius, in the angle
        assert exact.context.hypot(frame.x[i] - x, frame.y[i] - y) <= 2.0**-49 * condition * exact.context.hypot(x, y)
        assert abs(speed[i] / size - 1) <= 2.0**-48 * condition
        assert abs(curvature[i] * size**3 / (dy * ax - dx * ay) - 1) <= 2.0**-47 * condition


@pytest.mark.parametrize("name", ["round", "turned"])
def test_derivatives_and_exponents_of_a_conic_are_those_of_the_general_flight(name):
    """With a law that depends on the place as well, where the two parameters must not be mixed up."""
    theta, phi = np.array([0.3, -2.0, 1.1]), np.array([0.2, -0.5, 0.9])
    for law in (Law(), Law("-eta/2 + sin(theta)*cos(eta)/8")):
        table = tables.polar(CONICS[name])
        one, other = (PinballMap(table, lam="0.9", law=law, kernels=False) for _ in range(2))
        other = by_definition(other)
        a, b = (each.exponents(theta, phi, 4) for each in (one, other))

        assert np.allclose(one.derivative(theta, phi), other.derivative(theta, phi), rtol=1e-9, atol=1e-12)
        assert np.allclose(a.nu_plus, b.nu_plus, rtol=0, atol=1e-9)
        assert np.allclose(a.nu_minus, b.nu_minus, rtol=0, atol=1e-9)


def test_a_conics_eccentricity_may_be_a_parameter_and_may_vanish():
    b = Symbol("b", real=True)
    table = tables.polar(
        1 / (1 + b * cos(symbol)), "focal", [Shape(b, Range(Rational(-3, 4), Rational(3, 4)), "opens")]
    )
    theta, phi = np.array([0.3, -2.0, 3.1]), np.array([0.2, -0.5, 0.9])
    maps = [PinballMap(table, lam="0.9", kernels=False, b=value) for value in ("-1/2", 0, "1/2")]
    fixed = PinballMap(tables.polar("1/(1 + cos(theta)/2)"), lam="0.9", kernels=False).step(theta, phi)

    assert len({map.engine.identity for map in maps}) == 1
    assert not maps[0].family.tells
    assert maps[0].step(theta + np.pi, phi).theta == pytest.approx(
        fixed.theta - np.pi * np.sign(fixed.theta), abs=1e-14
    )
    assert maps[2].step(theta, phi).theta == pytest.approx(fixed.theta, abs=1e-14)
    assert maps[1].step(0.3, 0.0).theta == pytest.approx(0.3 - np.pi, abs=1e-15)
