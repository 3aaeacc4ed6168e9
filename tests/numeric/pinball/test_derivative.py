"""Derivatives and exponents from the kernels, compared with the symbolic matrix and the paper."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numeric import PinballMap
from verification import laws

test_the_numeric_derivative_is_the_symbolic_one = laws.jacobian(max_examples=60)


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
