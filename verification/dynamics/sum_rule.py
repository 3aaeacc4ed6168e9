"""`nu_plus + nu_minus` along an orbit, from its angles alone: the check on what the tangent kernels multiply up.

`det DT = lam*cos(phi0)/cos(eta1)` in `(s, phi)`; along an orbit cosines of successive bounces pair up, and

    log|det D(T^n)| = n*log(lam) + sum of log(cos(lam*eta_k)/cos(eta_k)) + log(cos(phi_0)/cos(phi_n)).

See `symbolic.contraction` for the derivation and for what follows from it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.growth import Growth
from verification.dynamics.places import Places

Array = NDArray[np.float64]


class Check(NamedTuple):
    """The largest difference of `log|det D(T^n)|` between kernel and angles over `balls` orbits of `bounces`."""

    difference: float
    bounces: int
    balls: int


def volume(map: PinballMap, balls: Places, bounces: int) -> Array:
    """`log|det D(T^n)|` of each orbit by the rule above, without the `n*log(lam)`; nan for a ball that stops.

    >>> circle = PinballMap("circle", lam="0.5")
    >>> balls = Places(np.array([0]), np.array([0.3]), np.array([0.4]))
    >>> bool(abs(volume(circle, balls, 5)[0]) < 1e-15)  # eta_{k+1} = -phi_k, so the sum telescopes to 0
    True
    """
    orbit = map.orbit(balls.theta, balls.phi, bounces, balls.component)
    lam = np.broadcast_to(map.lam, balls.theta.shape)
    inner = np.sum(np.log(np.cos(lam * orbit.eta[1:]) / np.cos(orbit.eta[1:])), axis=0)
    return np.asarray(inner + np.log(np.cos(orbit.phi[0]) / np.cos(orbit.phi[-1])))


def checked(map: PinballMap, balls: Places, bounces: int) -> Check:
    """The rule against the kernel, on the same orbits: both come bit for bit along the same bounces.

    >>> from numeric.pinball.sampling import phase_starts
    >>> table = PinballMap("cuspless", lam="0.5")
    >>> bool(checked(table, Places(*phase_starts(table, 8, seed=1)[:3]), 200).difference < 1e-11)
    True
    """
    growth = Growth(map, balls.component, balls.theta, balls.phi)
    growth.advance(bounces)
    difference = np.abs(volume(map, balls, bounces) - growth.volume)[growth.code == 0]
    return Check(float(np.max(difference, initial=0.0)), bounces, int(difference.size))
