"""The steps on ellipses and convex Fourier sums: their rounding errors, and a second way to find the landing."""

import numpy as np
import pytest
from one_bounce import bounce_errors
from sympy import cos, pi, sin

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import theta as symbol
from verification.maps.exact import ExactMap

HERE = np.zeros(24, dtype=np.int64)
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
    """The map of a table with a contraction."""
    name, shape = TABLES[request.param]
    return lambda lam, **more: PinballMap(name, lam=lam, **shape, **more)


@pytest.mark.parametrize("lam", [0, 0.3, 1])
def test_anywhere(harmonic, lam, rounding):
    rng = np.random.default_rng(5)
    theta, phi = rng.uniform(-3.1, 3.1, 24), rng.uniform(-1.4, 1.4, 24) * (lam > 0)
    place, direction = rounding(harmonic(lam, kernels=False), HERE, theta, phi)

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


def test_chords_may_lie_far_from_those_of_the_circle():
    """In an ellipse 20 times longer than wide, chords are displaced by more than an eighth of a turn."""
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
    """A function from a contraction to the map of the conic, on arrays, without kernels."""
    table = tables.polar(CONICS[request.param])
    return lambda lam="0.9", **more: PinballMap(table, lam=lam, kernels=False, **more)


@pytest.mark.slow
@pytest.mark.parametrize("lam", ["0", "0.9", "1"])
def test_a_conic_about_the_origin_is_met_in_closed_form_as_exactly_as_the_papers_tables(conic, lam):
    """From both tips and from random points; forming a difference of radii would lose three digits at the far tip.

    The rounding of a landing, magnified 22 times by the curvature at the tips, would show in the direction.
    """
    map = conic(lam)
    theta, phi = np.array([-3.1415, 3.14, 1.047, -2.0945]), np.array([0.3, -1.2, 1.5, 0.01]) * (lam != "0")
    place, direction = bounce_errors(map, HERE[:4], theta, phi)

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


@pytest.mark.parametrize("low", [-pi, 0, -pi / 2, 2 * pi])
@pytest.mark.parametrize("wave", [0, cos(3 * symbol) / 40])
def test_a_parameter_lies_in_its_range_and_a_law_takes_it_there(low, wave):
    x, y = (1 + wave) * 11 * cos(symbol) / 10, (1 + wave) * sin(symbol)
    map = PinballMap(
        tables.piecewise(tables.arc("c", x, y, low, low + 2 * pi)), lam=0.25, law="-lam*eta + sin(theta/2)/10"
    )
    told = map.step(float(low) + np.linspace(0.1, 6.1, 12), 0.2)

    assert np.all((float(low) <= told.theta) & (told.theta <= float(low + 2 * pi)))
    assert told.phi == pytest.approx(-told.eta / 4 + np.sin(told.theta / 2) / 10, abs=1e-14)
