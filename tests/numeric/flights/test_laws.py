"""Other reflection laws in the kernels: their bits, their derivatives, their exponents, against the formulas."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numeric import PinballMap
from symbolic import Law, Scene, tables
from symbolic.expressions.text import load
from symbolic.motion.chords import law_kernel
from verification import ExactMap
from verification.arithmetic.balls import ARRAYS

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
EPS = 2.0**-52


def made(name, law, lam="1/2", **more):
    table, shape = TABLES[name]
    return PinballMap(table, lam=lam, law=law, **shape, **more)


def phase(count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-0.9, 0.9, count), rng.uniform(-1.2, 1.2, count)


@pytest.mark.parametrize("name", TABLES)
def test_half_of_the_incidence_is_the_papers_law_at_one_half(name):
    theta, phi = phase(20, 1)
    one, other = (made(name, law, lam, kernels=False) for law, lam in (("-eta/2", 1), ("-lam*eta", "1/2")))
    assert one.law == "formula"
    assert other.law == "pinball"

    a, b = one.orbit(theta, phi, 5), other.orbit(theta, phi, 5)

    assert np.max(np.abs(a.theta - b.theta)) < 1e-11
    assert np.max(np.abs(one.derivative(theta, phi) - other.derivative(theta, phi))) < 1e-11


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("law", FORMULAS)
def test_the_exit_angle_is_the_formula_at_the_incidence_that_landed(name, law):
    theta, phi = phase(50, 2)
    map = made(name, law, kernels=False)
    step = map.step(theta, phi)
    expected = load(law_kernel(Law(law), 0), ARRAYS)(step.eta, 0.5, step.theta)[0]
    good = step.code == 0

    assert np.max(np.abs(step.phi - expected)[good]) < 64 * EPS


@pytest.mark.parametrize("name", ["circle", "egg", "cuspless", "stadium"])
def test_a_bounce_is_that_of_the_exact_map(name):
    theta, phi = phase(6, 3)
    map = made(name, PLACED, kernels=name == "cuspless")
    exact, step = ExactMap(map, 30), map.step(theta, phi)
    for i in range(theta.size):
        truth = exact.bounce(exact.ball(0, theta[i], phi[i]))
        assert abs(float(truth.phi) - step.phi[i]) < 64 * EPS
        assert truth.component == step.component[i]


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


@pytest.mark.parametrize("law", FORMULAS)
def test_both_exponents_add_up_to_the_logarithms_of_the_determinants(law):
    map = made("egg", law, kernels=False)
    theta, phi = phase(5, 4)
    found = map.exponents(theta, phi, 40)
    orbit = map.orbit(theta, phi, 40)
    steps = [map.derivative(orbit.theta[i], orbit.phi[i]) for i in range(40)]
    total = np.mean([np.log(np.abs(np.linalg.det(step))) for step in steps], axis=0)

    assert np.max(np.abs(found.nu_plus + found.nu_minus - total)) < 1e-12


def test_arrays_and_kernels_agree_on_a_law():
    theta, phi = phase(40, 5)
    for name, law in (("egg", FORMULAS[1]), ("stadium", PLACED)):
        one, other = (made(name, law, kernels=kernels).step(theta, phi) for kernels in (True, False))
        assert np.max(np.abs(one.phi - other.phi)) < 16 * EPS
        assert np.max(np.abs(one.theta - other.theta)) < 1e-14


def test_a_law_that_is_not_used_leaves_the_kernels_identity_alone():
    scene = Scene("egg", alpha="2/25", lam="1/2")

    assert PinballMap(scene).engine.identity == PinballMap("egg", alpha="2/25", lam="1/2", law=Law()).engine.identity
    assert PinballMap(scene.at(law="-eta/3")).engine.identity != PinballMap(scene).engine.identity


def test_another_contraction_is_refused_where_the_law_leads_out():
    map = made("circle", "-lam*eta - eta/4")
    with pytest.raises(ValueError, match="does not lie between"):
        map.at(lam=[0.5, 0.9])


def test_the_slap_map_is_the_tables_own():
    bent, plain = (made("egg", law, kernels=False) for law in (FORMULAS[0], "-lam*eta"))

    assert np.array_equal(bent.slap([0.3, 0.7], 3).theta, plain.slap([0.3, 0.7], 3).theta)
