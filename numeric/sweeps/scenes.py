"""A scene as a line of text, which labels results and travels to other machines; its map, and random balls in it.

The sign of a finite-time Lyapunov exponent, when its error decides it.

A run is cut into blocks, and the scatter of the growth over them gives the mean a standard error. Two things besides
can make a regular orbit look chaotic. On an elliptic or a neutral orbit vectors grow like the number of bounces, so
`B` bounces show `log(B)/B`; a sign counts beyond twice that. And an orbit may be on its way through a chaotic
transient: then late blocks fall, and the scatter says so, unless the whole run was too short to see the end of it.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.growth import Growth
from numeric.pinball.sampling import Starts, interior_starts
from symbolic.tables.scene import Scene

KEPT = 16  # maps
Array = NDArray[np.float64]


def text_of(scene: Scene) -> str:
    """The scene as a sweep labels it: at `lam = 1`, since the contraction is an axis of the sweep.

    >>> text_of(Scene("egg", alpha="2/25", lam="1/2"))
    'scene = { table = "egg", shape = { alpha = "2/25" }, lam = "1" }'
    """
    return scene.at(lam=1).text


def map_of(text: str, lam: Any) -> PinballMap:
    """The map of a scene written by `text_of`, with a contraction, or one for each ball.

    >>> map_of(text_of(Scene("ellipse", a=2)), 0.5).law
    'pinball'
    """
    return _elastic(text).at(lam)


def spread(text: str, lams: Array, each: int, seed: int) -> tuple[PinballMap, Starts]:
    """Balls of one scene at several contractions: `each` random starts for each `lam`, one `lam` after the other.

    >>> map, starts = spread(text_of(Scene("circle")), np.array([0.0, 0.5]), 3, seed=1)
    >>> map.lam.tolist(), starts.theta.size
    ([0.0, 0.0, 0.0, 0.5, 0.5, 0.5], 6)
    """
    return map_of(text, np.repeat(lams, each)), interior_starts(_elastic(text), len(lams) * each, seed)


@lru_cache(KEPT)
def _elastic(text: str) -> PinballMap:
    return PinballMap(Scene.parse(text))


BLOCKS = 4  # too few for a fine error, and enough to see a transient end
SIGMAS = 2.0  # standard errors by which an exponent is beyond the floor


class Measured(NamedTuple):
    """Exponents of orbits: means over their blocks with standard errors, where they end, and how they ended."""

    nu_plus: Array
    nu_minus: Array
    nu_plus_error: Array
    nu_minus_error: Array
    floor: float
    end: Starts
    code: NDArray[np.int64]

    @property
    def chaotic(self) -> NDArray[np.bool_]:
        """Surely positive: beyond the floor by `SIGMAS` standard errors."""
        return np.asarray((self.code == 0) & (self.nu_plus - SIGMAS * self.nu_plus_error > self.floor))

    @property
    def regular(self) -> NDArray[np.bool_]:
        """Not above the floor. An orbit that is neither chaotic nor regular is undecided."""
        return np.asarray((self.code == 0) & (self.nu_plus <= self.floor))

    def ended(self, which: NDArray[np.int64]) -> Starts:
        """Where some of the orbits end, to go on from there."""
        component, theta, phi, x, y = self.end
        return Starts(component[which], theta[which], phi[which], x[which], y[which])


def floor_of(bounces: int) -> float:
    """The exponent up to which so many bounces cannot tell growth from shear.

    >>> round(floor_of(1000), 4)
    0.0138
    """
    return float(2 * np.log(bounces) / bounces)


def measured(map: PinballMap, starts: Starts, bounces: int, transient: int, threads: int | None = None) -> Measured:
    """The exponents of balls over `bounces` bounces in `BLOCKS` blocks, after `transient` that do not count.

    >>> circle = PinballMap("circle", lam=1)
    >>> from numeric.pinball.sampling import phase_starts
    >>> found = measured(circle, phase_starts(circle, 8, seed=0), 2000, 0)
    >>> bool(found.chaotic.any()), bool(found.regular.all())
    (False, True)
    """
    block = bounces // BLOCKS
    if block < 2:
        raise ValueError(f"bounces = {bounces} is too few for {BLOCKS} blocks; give at least {2 * BLOCKS}")
    growth = Growth(map, starts.component, starts.theta, starts.phi)
    growth.skip(transient, threads)
    reached = np.zeros((2, BLOCKS + 1, starts.theta.size))
    for i in range(1, BLOCKS + 1):
        growth.advance(block, threads)
        reached[:, i] = growth.stretch, growth.volume
    with np.errstate(divide="ignore", invalid="ignore"):  # at lam = 0 areas vanish
        plus, volume = np.diff(reached, axis=1) / block
        minus = volume + np.log(growth.lam) - plus
        means = [(x.mean(axis=0), x.std(axis=0, ddof=1) / BLOCKS**0.5) for x in (plus, minus)]
    end = Starts(growth.component, growth.theta, growth.phi, *map.states.point(growth.component, growth.theta))
    (nu_plus, nu_plus_error), (nu_minus, nu_minus_error) = means
    return Measured(nu_plus, nu_minus, nu_plus_error, nu_minus_error, floor_of(block * BLOCKS), end, growth.code)
