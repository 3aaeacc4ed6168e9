"""The derivative and the exponents of the kernels, against the symbolic matrix and the 50-digit map."""

from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import lambdify

from numeric import PinballMap
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, cos_eta1, cos_phi0, lam, t
from verification.maps import strategies
from verification.maps.exact import ExactMap

EPS = 2.0**-52


@cache
def symbolic():
    return lambdify((K0, K1, t, cos_phi0, cos_eta1, lam), derivative_matrix().tolist(), "math")


def by_formula(map, where, theta, phi, step):
    """The paper's matrix, from the two ends of a flight."""
    x, y = map.states.point(where, theta)
    curvature = map.states.curvature
    matrix = symbolic()(
        float(curvature(where, theta)),
        float(curvature(step.component, step.theta)),
        float(np.hypot(step.x - x, step.y - y)),
        float(np.cos(phi)),
        float(np.cos(step.eta)),
        float(map.lam),
    )
    return np.array(matrix, dtype=float)


@settings(max_examples=60)
@given(strategies.particles())
def test_the_numeric_derivative_is_the_symbolic_one(ball):
    map, where, theta, phi = ball.map, np.array(ball.component), np.array(ball.theta), np.array(ball.phi)
    step = map.step(theta, phi, where)
    assume(step.code == 0)  # at a cusp there is no derivative
    found, formula = map.derivative(theta, phi, where), by_formula(map, where, theta, phi, step)
    sensitivity = 1 + (np.abs(formula).max() + 1) / np.cos(step.eta)  # of 1/cos(eta) to the rounded eta

    assert np.all(np.abs(found - formula) <= 64 * EPS * sensitivity * (1 + np.abs(formula).max()))


@pytest.mark.parametrize("lam_", [0.3, 1])
def test_the_derivative_is_the_limit_of_differences(table, lam_):
    map = table.map(lam_)
    where, theta, phi = table.starts(map, 3, seed=11, steepest=0.8)
    exact = ExactMap(map, 50)
    mp = exact.context
    h = mp.mpf(10) ** -20
    for i in range(3):
        speed = mp.mpf(float(map.states.speed(where[i], theta[i])))
        found = map.derivative(theta[i], phi[i], where[i])
        columns = []
        for dtheta, dphi in ((h / speed, 0), (0, h)):
            ends = [
                exact.bounce(exact.start(mp.mpf(theta[i]) + k * dtheta, mp.mpf(phi[i]) + k * dphi, int(where[i])))
                for k in (1, -1)
            ]
            moved = float((ends[0].theta - ends[1].theta) / (2 * h))
            at = float(ends[0].theta)
            columns.append(
                [
                    moved * float(map.states.speed(np.array(ends[0].component), np.array(at))),
                    float((ends[0].phi - ends[1].phi) / (2 * h)),
                ]
            )
        truth = np.array(columns).T

        assert np.allclose(found, truth, rtol=1e-12, atol=1e-12 * np.abs(truth).max() ** 2)


@pytest.mark.parametrize("lam_", [2.0**-40, 2.0**-1000])
def test_the_exit_angle_moves_in_proportion_to_lam_however_small(table, lam_):
    map = table.map(lam_)
    where, theta, phi = table.starts(map, 40, seed=13, steepest=0.9)
    small, whole = map.derivative(theta, phi, where), map.at(lam=0.5).derivative(theta, phi, where)
    rounding = {"rtol": 16 * EPS, "atol": 16 * EPS * np.abs(whole).max()}  # the landing is the same

    assert np.allclose(small[:, 0], whole[:, 0], **rounding)
    assert np.allclose(small[:, 1] / lam_, whole[:, 1] / 0.5, **rounding)
    assert not np.any(map.at(lam=0).derivative(theta, phi, where)[:, 1])


def test_exponents_of_the_short_cycle_are_the_papers_eigenvalues():
    a, lam_ = 1.2, 0.02  # below lambda_-(a): a node, so the exponents are the logarithms of mu+ and mu-
    p = (a**2 - 2) ** 2 * (lam_**2 + 1) - 8 * (a**2 - 1) * lam_
    q = ((1 + lam_) * (a**2 - 2)) ** 2 * ((a**2 - 2) ** 2 * (lam_**2 + 1) - 2 * (a**4 + 4 * a**2 - 4) * lam_)
    mu = [(p + sign * np.sqrt(q)) / (2 * a**4) for sign in (1, -1)]
    found = PinballMap("ellipse", lam=lam_, a="1.2").exponents(np.pi / 2, 0.0, 20000)
    expected = [np.log(abs(m)) / 2 for m in mu]

    assert q > 0
    assert float(found.nu_plus) == pytest.approx(max(expected), abs=1e-4)
    assert float(found.nu_minus) == pytest.approx(min(expected), abs=1e-4)


def test_the_exponents_sum_to_the_mean_contraction(table):
    map = table.map(0.7)
    where, theta, phi = table.starts(map, 20, seed=12, steepest=0.9)
    found = map.exponents(theta, phi, 100, component=where)
    orbit = map.orbit(theta, phi, 100, where)
    logs = np.log(0.7 * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))

    assert np.allclose(found.nu_plus + found.nu_minus, logs.mean(axis=0), rtol=0, atol=1e-12)


def test_exponents_do_not_overflow_on_long_orbits():
    found = PinballMap("cardioid", lam=0.9).exponents(0.3, 0.2, 200_000)

    assert 0.5 < found.nu_plus < 0.8
    assert np.isfinite(found.nu_minus)


@given(st.floats(0.01, 0.99))
@settings(max_examples=10)
def test_the_slap_map_has_the_papers_slope(share):
    map = PinballMap("egg", lam=0.5, alpha="0.08")
    theta = np.array(share * 6 - 3)
    slap = map.slap(theta)
    step = map.at(lam=0).step(theta)
    x, y = map.states.point(np.array(0), theta)
    formula = -(np.hypot(step.x - x, step.y - y) * map.states.curvature(np.array(0), theta) + 1) / np.cos(step.eta)

    assert slap.slope == pytest.approx(float(formula), rel=1e-12, abs=1e-13)
