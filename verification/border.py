"""What the corner orbit bears at `lambda-star`: the piecewise linear map, and what it predicts.

Half the return (leave a corner, meet the arc, land near the other corner, take the mirror image) is
continuous and piecewise smooth: the curvature is that of the arc on one side of the corner and 0 on
the wall's. Its linear part in `(s, phi)` around the orbit, with the shift that `lam - lambda-star`
causes, is the normal form of a border collision. Both sides expand, so no cycle next to it is
stable; on one side of `lambda-star` an orbit is carried away, on the other it stays, on an attractor
whose size is proportional to `lam - lambda-star`. Estimated in float64, and compared with the map.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from symbolic.chords import chord_kernel
from symbolic.codegen import kernel, load
from symbolic.geometry import curvature
from symbolic.symbols import theta
from symbolic.tables import cuspless
from verification.arithmetic import FLOAT64
from verification.certificates.corner import flight
from verification.shooting.newton import floats
from verification.shooting.small import corner

Point = tuple[float, float]
ARC, WALL = 0, 1
CORNER = 2 * math.pi / 3
ESCAPED = 1e3  # units of lam - lambda-star


@dataclass(frozen=True)
class Attractor:
    """Extent in arc length from the corner (negative on the arc), and the largest exponent per bounce."""

    lowest: float
    highest: float
    exponent: float


class Border:
    """The piecewise linear half return for `lam = lambda-star + e`, in units of `e`."""

    def __init__(self) -> None:
        theta1, self.lam = floats(corner(), [0.2545, 0.0712])
        angle = load(chord_kernel(cuspless, 0, 0, 0), FLOAT64)
        bend = load(kernel("bend", [theta], {"curvature": curvature(cuspless.components[0])}), FLOAT64)
        middle, sharp = bend(theta1)[0], bend(CORNER)[0]
        self.eta1, self.eta2 = angle(theta1, CORNER)[0], angle(-CORNER, theta1)[0]
        self.out = {K: flight(FLOAT64, CORNER, theta1, K, middle, self.lam) for K in (0.0, sharp)}
        self.back = {K: flight(FLOAT64, theta1, -CORNER, middle, K, self.lam) for K in (0.0, sharp)}
        self.sharp = sharp

    def side(self, s: float) -> float:
        """The curvature at a point near the upper corner: the arc comes first."""
        return self.sharp if s < 0 else 0.0

    def step(self, x: Point, shift: float) -> Point:
        """One half return; `shift` is 1 above `lambda-star` and -1 below."""
        first = _times(self.out[self.side(x[0])], x)
        arrived = first[0], first[1] - self.eta1 * shift
        s = _times(self.back[0.0], arrived)[0]
        landed = _times(self.back[self.side(-s)], arrived)  # mirrored: the arc lies beyond the lower corner
        return -landed[0], -(landed[1] - self.eta2 * shift)

    def stretch(self, x: Point, v: Point, shift: float) -> Point:
        """The derivative of `step` along `v`."""
        first = _times(self.out[self.side(x[0])], v)
        a, b = _times(self.back[self.side(self.step(x, shift)[0])], first)
        return -a, -b

    def attractor(self, shift: float, returns: int = 200_000) -> Attractor | None:
        """What a point near the corner settles on, in units of `|e|`; None when it is carried away.

        >>> border = Border()
        >>> border.attractor(-1, 1000) is None, border.attractor(1, 1000) is None
        (True, False)
        """
        x, v = (-0.01, 0.0), (1.0, 0.0)
        low, high, total = math.inf, -math.inf, 0.0
        for i in range(returns):
            v = self.stretch(x, v, shift)
            x = self.step(x, shift)
            if abs(x[0]) > ESCAPED:
                return None
            size = math.hypot(*v)
            v = v[0] / size, v[1] / size
            if i >= returns // 10:
                low, high, total = min(low, x[0]), max(high, x[0]), total + math.log(size)
        return Attractor(low, high, total / (returns - returns // 10) / 2)


def _times(m: tuple[float, float, float, float], x: Point) -> Point:
    return m[0] * x[0] + m[1] * x[1], m[2] * x[0] + m[3] * x[1]


def sampled(e: float, bounces: int = 40_000) -> tuple[float, float]:
    """The extent near the upper corner of the orbit of the map itself at `lambda-star + e`, in units of `e`."""
    reached = [s / e for s in _returns(e, bounces)]
    settled = reached[len(reached) // 10 :]
    return min(settled), max(settled)


def _returns(e: float, bounces: int) -> Iterator[float]:
    """Arc lengths from the upper corner of the bounces near it, negative on the arc."""
    ride = _Ride()
    theta1, lam = floats(corner(), [0.2545, 0.0712])
    before, here = (ARC, -theta1), (ARC, CORNER)
    for _ in range(bounces):
        before, here = here, ride.next(before, here, lam + e)
        if here[0] == ARC and abs(here[1] - CORNER) < 0.3:
            yield 4 * (math.sin(here[1] / 2) - math.sin(CORNER / 2))
        if here[0] == WALL and here[1] < -0.2:
            yield here[1] + math.sqrt(3) / 4


class _Ride:
    """The map of the cuspless cardioid from two successive bounces, by bisection on the chord angle."""

    def __init__(self) -> None:
        pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
        self.angle: dict[tuple[int, int], Callable[..., tuple[float, ...]]] = {
            pair: load(chord_kernel(cuspless, *pair, 0), FLOAT64) for pair in pairs
        }

    def next(self, before: tuple[int, float], here: tuple[int, float], lam: float) -> tuple[int, float]:
        """The bounce after `here`."""
        component, x = here
        phi = -lam * self.angle[component, before[0]](x, before[1])[0]
        half = math.sqrt(3) / 4
        if component == WALL:
            return ARC, self._root((WALL, ARC), x, phi, -CORNER, CORNER)
        near = CORNER - x < 1e-6  # there the chord to the corner has no direction in floats
        if not near and self.angle[ARC, ARC](x, CORNER)[0] < phi:
            return ARC, self._root((ARC, ARC), x, phi, x, CORNER)
        if near or self.angle[ARC, ARC](x, -CORNER)[0] > phi:
            turned = self._root((ARC, ARC), x, phi, 2 * math.pi - CORNER, x + 2 * math.pi)
            return ARC, turned - 2 * math.pi
        return WALL, self._root((ARC, WALL), x, phi, -half, half)

    def _root(self, pair: tuple[int, int], x: float, phi: float, low: float, high: float) -> float:
        angle = self.angle[pair]
        for _ in range(56):  # the angle falls along the boundary
            middle = (low + high) / 2
            low, high = (middle, high) if angle(x, middle)[0] > phi else (low, middle)
        return (low + high) / 2
