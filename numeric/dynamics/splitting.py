"""The angle between the two directions of an orbit: the one its past expands, the one its future contracts.

Dominated splitting [PujalsSambarino2009] keeps the two apart: on a compact set their angle has a positive lower
bound. Where orbits come near a tangency of a stable with an unstable manifold the angle has no such bound, and the
share of points with an angle below `x` falls like `x`. Paper: section 1.
"""

import numpy as np

from numeric import PinballMap
from numeric.dynamics.phase_points import Array, Places, advanced
from numeric.pinball.sampling import interior_starts

ALIGNED = 60  # bounces in which a vector turns to its direction


def angles(map: PinballMap, balls: Places, bounces: int, transient: int = 1000) -> Array:
    """The angle in `(s, phi)`, in radians from 0 to pi/2, at `bounces` points of every ball's orbit.

    >>> from numeric.dynamics.phase_points import places
    >>> measured = angles(PinballMap("cuspless", lam="0.5"), places(0, [0.5, 0.7], 0.1), 50)
    >>> measured.size, bool(np.min(measured) > 0.3)
    (100, True)
    """
    begin = advanced(map, balls, transient).places
    steps = bounces + 2 * ALIGNED
    orbit = map.orbit(begin.theta, begin.phi, steps, begin.component)
    slopes = [map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i]) for i in range(steps)]
    expanded = _carried(slopes, np.array([0.6, 0.8]))
    contracted = _carried(
        [np.asarray(np.linalg.inv(slope), dtype=float) for slope in reversed(slopes)], np.array([0.8, -0.6])
    )[::-1]
    e, f = expanded[ALIGNED : ALIGNED + bounces], contracted[ALIGNED : ALIGNED + bounces]
    sine = np.abs(e[..., 0] * f[..., 1] - e[..., 1] * f[..., 0])
    return np.asarray(np.arcsin(np.minimum(sine, 1.0))).ravel()


def _carried(slopes: list[Array], vector: Array) -> Array:
    """The unit vector before each step."""
    here = np.broadcast_to(vector, (slopes[0].shape[0], 2))
    rows = [here]
    for slope in slopes:
        here = np.einsum("nij,nj->ni", slope, here)
        here = here / np.linalg.norm(here, axis=1, keepdims=True)
        rows.append(here)
    return np.array(rows)


def slopes(map: PinballMap, count: int, seed: int, bounces: int = 600) -> tuple[Array, Array, Array]:
    """Arc length, exit angle and the slope `dphi/ds` of the expanded direction, at points of random orbits."""
    starts = interior_starts(map, count, seed)
    begin = advanced(map, Places(*starts[:3]), 1000).places
    orbit = map.orbit(begin.theta, begin.phi, bounces, begin.component)
    along = _carried(
        [map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i]) for i in range(bounces)], np.array([0.6, 0.8])
    )[ALIGNED:]
    half = map.arclength.perimeter / 2
    s = np.remainder(map.arclength.s(orbit.theta[ALIGNED:], orbit.component[ALIGNED:]) + half, 2 * half) - half
    return s.ravel(), orbit.phi[ALIGNED:].ravel(), (along[..., 1] / along[..., 0]).ravel()


def jump(s: Array, phi: Array, slope: Array, place: float, width: float = 0.01, near: float = 0.003) -> float:
    """The median difference of slopes right and left of a place of the boundary, at nearly equal exit angles.

    >>> s, phi = np.array([-0.001, 0.001]), np.zeros(2)
    >>> jump(s, phi, np.array([1.0, 3.0]), 0.0)
    2.0
    """
    left, right = (s > place - width) & (s < place), (s > place) & (s < place + width)
    if not np.any(left) or not np.any(right):
        return float("nan")
    order = np.argsort(phi[right])
    at = np.clip(np.searchsorted(phi[right][order], phi[left]), 0, order.size - 1)
    close = np.abs(phi[right][order][at] - phi[left]) < near
    return float(np.median((slope[right][order][at] - slope[left])[close])) if np.any(close) else float("nan")
