"""A cycle in float64, polished from points near it: multiple shooting, its multipliers, its least period.

All bounces are unknowns at once, so errors do not multiply along the cycle, and one of period 256 next
to the accumulation of period doublings is told from one of 128. For digits and proofs there is the
chord system (`verification.cycles`, `verification.proofs`).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.phase_points import Places, places

STEPS = 30
ROUNDING = 1e-11  # of Newton's last correction
SAME = 1e-7  # between points of one cycle and their images: a shorter cycle, run through several times
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cycle:
    """A cycle's bounces in order, from the one that comes first in `(component, theta)`, and both multipliers."""

    points: Places
    multipliers: tuple[complex, complex]
    volume: float  # the mean of log |det DT| along it

    @property
    def period(self) -> int:
        """The number of bounces."""
        return self.points.size

    @property
    def exponents(self) -> tuple[float, float]:
        """Both Lyapunov exponents, per bounce; their sum is exactly the mean of `log |det DT|`."""
        with np.errstate(divide="ignore"):
            plus = float(np.log(abs(self.multipliers[0])) / self.period)
        return plus, self.volume - plus


def polished(map: PinballMap, near: Places) -> Cycle | None:
    """The cycle whose bounces lie near the given ones, in order; None when Newton's method does not settle there.

    >>> axis = polished(PinballMap("ellipse", a=2, lam="0.5"), places(0, [1.5, -1.6], [0.01, 0.0]))
    >>> axis.period, axis.points.theta.round(12).tolist()
    (2, [-1.570796326795, 1.570796326795])
    """
    n, here = near.size, near
    for _ in range(STEPS):
        image = map.step(here.theta, here.phi, here.component)
        after = here.turned(1)
        if np.any(image.code) or np.any(image.component != after.component):
            return None
        miss = np.stack([gap(map, image.theta, after.theta), image.phi - after.phi], axis=1)
        slope = by_parameter(map, here, after)
        matrix = np.zeros((2 * n, 2 * n))
        for i in range(n):
            j = (i + 1) % n
            matrix[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] += slope[i]
            matrix[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] -= np.eye(2)
        try:
            step = np.asarray(np.linalg.solve(matrix, miss.ravel()).reshape(n, 2), dtype=float)
        except np.linalg.LinAlgError:
            return None
        size = float(np.max(np.abs(step)))
        if not size < 0.5:
            return None
        moved = _moved(map, here, step)
        if moved is None or size < ROUNDING:
            return None if moved is None else shortest(map, moved)
        here = moved
    return None


def shortest(map: PinballMap, cycle: Places) -> Cycle:
    """The cycle run through once, from its first point, with its multipliers."""
    n = cycle.size
    for period in (d for d in range(1, n + 1) if n % d == 0):
        turned = cycle.turned(period)
        apart = np.abs(gap(map, cycle.theta, turned.theta)) + np.abs(cycle.phi - turned.phi)
        if np.all(cycle.component == turned.component) and np.max(apart) < SAME:
            break
    once = cycle.only(slice(0, period))
    order = np.lexsort((np.round(once.phi, 6), np.round(once.theta, 6), once.component))
    once = once.turned(int(order[0]))
    slopes = map.derivative(once.theta, once.phi, once.component)
    with np.errstate(divide="ignore"):
        volume = float(np.mean(np.log(np.abs(np.linalg.det(slopes))))) if map.law != "slap" else -np.inf
    return Cycle(once, eigenvalues(slopes), volume)


def multipliers(map: PinballMap, cycle: Places) -> tuple[complex, complex]:
    """The eigenvalues of the derivative along a cycle, the larger one first. Paper: section 2.1."""
    return eigenvalues(map.derivative(cycle.theta, cycle.phi, cycle.component))


def eigenvalues(slopes: Array) -> tuple[complex, complex]:
    """Those of the product of the matrices; the smaller one from the product of the determinants.

    >>> [mu.real for mu in eigenvalues(np.array([[[2.0, 0.0], [0.0, 1.0]], [[4.0, 0.0], [0.0, 0.5]]]))]
    [8.0, 0.5]
    """
    product = np.eye(2)
    for matrix in slopes:
        product = matrix @ product
    first, second = sorted((complex(x) for x in np.linalg.eigvals(product)), key=lambda mu: -abs(mu))
    if first.imag == 0 and first != 0:
        second = complex(np.prod(np.linalg.det(slopes)) / first.real)
    return first, second


def by_parameter(map: PinballMap, here: Places, after: Places) -> Array:
    """The derivative of the map in `(theta, phi)`, a matrix for each ball; `after` is where they land."""
    slope = map.derivative(here.theta, here.phi, here.component)
    slope[:, :, 0] *= map.states.speed(here.component, here.theta)[:, None]
    slope[:, 0, :] /= map.states.speed(after.component, after.theta)[:, None]
    return np.asarray(slope)


def gap(map: PinballMap, left: Array, right: Array) -> Array:
    """The difference of parameters; the short way round on a table of one closed component."""
    if len(map.states.ends) > 1:
        return left - right
    return np.asarray(np.remainder(left - right + np.pi, 2 * np.pi) - np.pi)


def _moved(map: PinballMap, here: Places, step: NDArray[Any]) -> Places | None:
    theta, phi = here.theta - step[:, 0], here.phi - step[:, 1]
    ends = np.array(map.states.ends)[here.component]
    if len(map.states.ends) > 1 and np.any((theta <= ends[:, 0]) | (theta >= ends[:, 1])):
        return None
    if np.any(np.abs(phi) >= np.pi / 2):
        return None
    return places(here.component, theta - 2 * np.pi * np.rint(theta / (2 * np.pi)), phi)
