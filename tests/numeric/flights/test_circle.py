"""The circle's bounce in closed form: half a turn minus twice the exit angle."""

import mpmath
import numpy as np
import pytest

from numeric import PinballMap

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 40


@pytest.mark.parametrize("kernels", [True, False])
@pytest.mark.parametrize("lam", [0, 0.5, 1])
def test_landings_are_exact_up_to_one_rounding_of_the_angle(lam, kernels):
    theta = np.array([np.pi, -np.pi, 3.1415926, -3.1415926, 3.0, -0.25, 0.0, 1.0])
    phi = np.array([0.0, 0.0, 0.0, 1e-9, 0.125, -1.5, 0.5, 0.25]) * (lam > 0)
    step = PinballMap("circle", lam=lam, kernels=kernels).step(theta, phi)
    for i in range(8):
        turned = MP.mpf(theta[i]) - 2 * MP.mpf(phi[i])
        truth = turned - MP.pi if turned > 0 or (turned == 0 and not np.signbit(theta[i])) else turned + MP.pi
        rounded = EPS * abs(turned) if phi[i] else 0  # the difference is, the half turn is not
        assert abs(float(step.theta[i]) - truth) <= EPS * abs(truth) + rounded
    assert step.phi.tolist() == (lam * phi).tolist()
