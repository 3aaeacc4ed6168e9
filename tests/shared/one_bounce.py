"""Helpers, imported as `one_bounce`: one bounce of particles in the kernels' fields, and its rounding errors."""

import numpy as np

from numeric.kernels.machine import KernelSpec
from verification.maps.exact import ExactMap, errors


def bounce(map, where, theta, phi):
    """The fields before and after one bounce, and the code of each particle, 0 on a table where none stops."""
    own = map.states.enter(where, theta, phi, map.law)
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(theta.size, float(map.lam)), map.shape, 1)
    return own, list(result.record[0]), result.rows.get("code", np.zeros(theta.size, dtype=int))


def bounce_errors(map, where, theta, phi, digits=30):
    """The errors of position and of direction of every particle, in units of 2**-52."""
    return errors(map, ExactMap(map, digits), *bounce(map, where, theta, phi)[:2])


def landing_errors(map, where, theta, phi):
    """Which particles land, their errors of position and of direction, and the cosines of their incidences."""
    own, found, code = bounce(map, where, theta, phi)
    lands = code == 0
    position, direction = errors(map, ExactMap(map, 30), *([row[lands] for row in rows] for rows in (own, found)))
    return lands, position, direction, np.cos(map.step(theta[lands], phi[lands], where[lands]).eta)
