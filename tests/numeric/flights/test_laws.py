"""Other reflection laws in the kernels: bits, derivatives and exponents, compared with the formulas."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numeric import PinballMap
from symbolic import Law, Scene, tables
from symbolic.expressions.text import load
from symbolic.motion.chords import law_kernel
from verification import EnclosedMap, ExactMap
from verification.arithmetic.balls import ARRAYS, as_ball

TABLES = {
    "circle": ("circle", {}),
    "ellipse": ("ellipse", {"a": "3/2"}),
    "egg": ("egg", {"alpha": "2/25"}),
    "cardioid": ("cardioid", {}),
    "cuspless": ("cuspless", {}),
    "stadium": (tables.stadium(), {}),
}
PLACED = "-lam*eta*(1 + cos(theta)/10) + eta**2/20"
FORMULAS = ["-lam*eta*(1 - eta**2/8)", "-lam*eta - sin(2*eta)/10", PLACED]
MEASURED = "-lam*eta*(1 + cos(2*s)/10) + sin(s)/9 + eta**2*cos(theta)/40"  # of the arc length and of the place
CURVES = TABLES | {
    "square": (tables.square(), {}),
    "sinai": (tables.sinai(), {}),
    "exponential": (tables.polar("exp(cos(2*theta)/4)"), {}),
    "limacon": (tables.polar("1 + 3*cos(theta)/5"), {}),
    "conic": (tables.polar("1/(2 + cos(theta)/2)"), {}),
}
EPS = 2.0**-52


def made(name, law, lam="1/2", **more):
    table, shape = CURVES[name]
    return PinballMap(table, lam=lam, law=law, **shape, **more)


def phase(count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-0.9, 0.9, count), rng.uniform(-1.2, 1.2, count)


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("law", FORMULAS)
def test_the_exit_angle_is_the_formula_at_the_incidence_that_landed(name, law):
    theta, phi = phase(50, 2)
    map = made(name, law, kernels=False)
    step = map.step(theta, phi)
    expected = load(law_kernel(Law(law), 0), ARRAYS)(step.eta, 0.5, step.theta)[0]
    good = step.code == 0

    assert np.max(np.abs(step.phi - expected)[good]) < 64 * EPS


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(sorted(TABLES)),
    cubic=st.integers(-3, 3),
    wave=st.integers(-3, 3),
    place=st.integers(-2, 2),
    theta=st.floats(-0.9, 0.9),
    phi=st.floats(-1.0, 1.0),
)
def test_the_derivative_of_the_map_is_that_of_its_difference_quotients(name, cubic, wave, place, theta, phi):
    law = f"-eta/2 - {cubic}*eta**3/40 - {wave}*sin(2*eta)/20 + {place}*cos(theta)/30"
    map = made(name, law, kernels=False)
    h = 1e-5

    def at(t, p):
        step = map.step(t, p)
        return np.array([map.arclength.s(step.theta, step.component), step.phi]), int(step.component)

    speed = float(map.states.speed(np.array([0]), np.array([theta]))[0])
    moved = [at(theta + h / speed, phi), at(theta - h / speed, phi), at(theta, phi + h), at(theta, phi - h)]
    if len({component for _, component in moved}) > 1 or map.step(theta, phi).code:
        return
    difference = np.array([moved[0][0] - moved[1][0], moved[2][0] - moved[3][0]]).T / (2 * h)
    if np.max(np.abs(difference)) > 1e3:  # a jump of arc length at the origin, or next to a cusp
        return
    matrix = map.derivative(theta, phi)

    assert np.max(np.abs(matrix - difference)) < 1e-6 * max(1, float(np.max(np.abs(matrix))) ** 3)


# ---- laws of the arc length


def sides(name, count, seed):
    rng = np.random.default_rng(seed)
    low, high = (0.05, 0.95) if name in ("square", "sinai") else (-0.9, 0.9)
    return rng.uniform(low, high, count), rng.uniform(-1.2, 1.2, count)


@pytest.mark.slow
@pytest.mark.parametrize("name", CURVES)
def test_a_law_of_arc_length_reads_the_arc_length_of_its_landing(name):
    theta, phi = sides(name, 50, 6)
    map = made(name, MEASURED, kernels=False)
    step = map.step(theta, phi)
    s, eta = map.arclength.s(step.theta, step.component), step.eta
    expected = -eta / 2 * (1 + np.cos(2 * s) / 10) + np.sin(s) / 9 + eta**2 * np.cos(step.theta) / 40

    assert np.max(np.abs(step.phi - expected)[step.code == 0]) < 16 * EPS


@pytest.mark.parametrize("name", CURVES)
def test_the_derivative_under_a_law_of_arc_length_is_that_of_difference_quotients(name):
    theta, phi = sides(name, 12, 7)
    map, h = made(name, MEASURED, kernels=False), 1e-6

    def at(t, p):
        step = map.step(t, p)
        return np.array([map.arclength.s(step.theta, step.component), step.phi])

    aside = h / map.states.speed(np.zeros(theta.size, dtype=int), theta)
    by_place, by_angle = at(theta + aside, phi) - at(theta - aside, phi), at(theta, phi + h) - at(theta, phi - h)
    difference = np.moveaxis(np.stack([by_place, by_angle], axis=-1) / (2 * h), 1, 0)
    matrix = map.derivative(theta, phi)
    gap = np.max(np.abs(matrix - difference), axis=(1, 2)) / np.maximum(1, np.max(np.abs(matrix), axis=(1, 2))) ** 3

    assert np.sum(gap < 1e-7) >= 10  # a quotient may straddle a corner


def test_each_particle_of_a_grid_has_the_derivative_at_its_own_contraction():
    theta, phi, lam = np.array([[0.3, 1.0], [2.0, -1.0]]), np.full((2, 2), 0.2), np.array([[0.2, 0.4], [0.6, 0.8]])
    scene = Scene("egg", alpha="2/25", law="-lam*eta*(1 - eta**2/40)")
    found = PinballMap(scene, lam=lam).derivative(theta, phi)

    for at in np.ndindex(2, 2):
        own = PinballMap(scene, lam=lam[at]).derivative(theta[at], phi[at])
        assert np.allclose(found[at], own, rtol=1e-12)


@pytest.mark.parametrize("name", ["circle", "cuspless", "conic", "sinai"])
def test_the_sum_rule_holds_for_a_law_of_arc_length(name):
    theta, phi = sides(name, 5, 8)
    map = made(name, MEASURED, kernels=False)
    found, orbit = map.exponents(theta, phi, 9), map.orbit(theta, phi, 9)
    good = orbit.code[-1] == 0
    rows = [map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i]) for i in range(9)]
    total = np.mean([np.log(np.abs(np.linalg.det(row))) for row in rows], axis=0)

    assert np.max(np.abs(found.nu_plus + found.nu_minus - total)[good]) < 1e-12


@pytest.mark.parametrize("name", ["circle", "cardioid", "cuspless", "stadium", "sinai", "egg"])
def test_the_exact_map_and_the_map_in_balls_know_the_same_arc_length(name):
    theta, phi = sides(name, 6, 9)
    map = made(name, MEASURED, kernels=name in ("cuspless", "sinai"))
    exact, enclosed, step = ExactMap(map, 30), EnclosedMap(map, Fraction(1, 2), 100), map.step(theta, phi)
    for i in range(theta.size):
        truth = exact.bounce(exact.start(theta[i], phi[i]))
        ball = enclosed.bounce(enclosed.start(float(theta[i]), float(phi[i])))

        assert truth.component == step.component[i]
        assert abs(float(truth.phi) - step.phi[i]) < 16 * EPS
        assert ball.phi.rad() < 1e-24
        assert abs(float(ball.phi.mid() - as_ball(truth.phi))) < 1e-24
