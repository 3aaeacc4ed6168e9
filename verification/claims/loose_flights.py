"""The egg's map with a Newton-Raphson iteration that stops early: how far values in section 6.6 depend on it."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MOST = 30  # steps of Newton's method


def bounced(theta: Array, phi: Array, lam: Array, alpha: float, tolerance: float) -> tuple[Array, Array]:
    """The next bounce; Newton's method on `cross(z1 - z0, v) = 0` ends with the first step below `tolerance`.

    >>> quarter = np.array([0.3])
    >>> [float(x.round(6)[0]) for x in bounced(quarter, quarter, np.array([0.5]), 0.0, 1e-9)]  # the circle
    [2.841593, 0.15]
    """
    z, tangent = _boundary(theta, alpha)
    v = 1j * tangent / np.abs(tangent) * np.exp(-1j * phi)  # the inward normal, turned by phi towards the tangent
    landing = theta + np.pi - 2 * phi  # as in the circle; then Newton's method
    for _ in range(MOST):
        there, along = _boundary(landing, alpha)
        step = _cross(there - z, v) / _cross(along, v)
        landing = landing - step
        if np.max(np.abs(step)) < tolerance:
            break
    _, along = _boundary(landing, alpha)
    sliding = np.clip((np.conj(along) * v).real / np.abs(along), -1, 1)  # minus the sine of eta
    return np.remainder(landing + np.pi, 2 * np.pi) - np.pi, lam * np.arcsin(sliding)


def ends_of_period(
    period: int, lams: Array, alpha: float, tolerance: float, start: tuple[float, float], bounces: int, apart: float
) -> Array:
    """The contractions at which an orbit is not back after a period, to `apart`, once the transient is over."""
    theta, phi = np.full(lams.size, start[0]), np.full(lams.size, start[1])
    for _ in range(bounces):
        theta, phi = bounced(theta, phi, lams, alpha, tolerance)
    then = theta
    for _ in range(period):
        theta, phi = bounced(theta, phi, lams, alpha, tolerance)
    return np.asarray(lams[np.abs(theta - then) > apart])


def _boundary(theta: Array, alpha: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    turn, rho = np.exp(1j * theta), 1 + alpha * np.cos(3 * theta)
    return rho * turn, (-3 * alpha * np.sin(3 * theta) + 1j * rho) * turn


def _cross(a: NDArray[np.complex128], b: NDArray[np.complex128]) -> Array:
    return np.asarray((np.conj(a) * b).imag)
