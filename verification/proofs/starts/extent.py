"""How far in exit angle the set reaches that a barrier and its mirror image keep, within two bounds.

Between a barrier and its mirror image lies a closed annulus `R`, which the map takes into its interior (`Barrier`).
What all its images have in common is a compact set `A`, taken onto itself; it attracts every orbit of `R`, and holds
each attractor there. `A` lies below the barrier: its largest `abs(phi)` is at most the greatest height of a step.

`A` meets each curve that goes from below `R` to above: if it did not, some image of `R` would not, by compactness; but
each image holds a closed curve around phase space, which parts below from above. And the orbit of a point of `A` stays
in `A`. So the largest `abs(phi)` on `A` is at least the least, over the points of such a curve in `R`, of the greatest
`abs(phi)` within so many bounces. The curve is a polygon along the direction that these bounces contract most, so that
all of its points go nearly the same way; its sides are carried along as parallelograms.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.starts.parallelograms import Parallelograms, carried

Array = NDArray[np.float64]
STEPS, SIDES = 100, 12_000  # of the direction's curve, each way, and of the polygon
STEEPEST = 6.0  # of dtheta/dphi along the curve
STEP = 1e-6  # of a difference quotient
WIDEST = 0.3  # a parallelogram that is wider is given up
REST = 1e-12  # more than the rounding of a vertex


@dataclass(frozen=True)
class Extent:
    """The largest `abs(phi)` of what is kept: at least `low`, at most `high`; 0 and infinity where nothing is proved.

    The curve goes through the phase point `start`, along the direction that so many `bounces` contract most, and up
    and down in `phi` by `height`.
    """

    barrier: Barrier
    start: tuple[float, float]
    bounces: int
    height: float

    @cached_property
    def high(self) -> float:
        """No kept point has a larger exit angle."""
        heights = self.barrier.heights
        return np.inf if heights is None or not self.barrier.mirrored else float(np.max(heights))

    @cached_property
    def curve(self) -> tuple[Array, Array]:
        """The vertices of the polygon, from below; a guess, of which only its ends have to be proved."""
        theta, phi = (np.full(2, value) for value in self.start)
        step, path = np.array([-self.height, self.height]) / STEPS, [(theta, phi)]
        for _ in range(STEPS):
            half = self._lean(theta, phi) * step / 2
            theta, phi = theta + step * self._lean(theta + half, phi + step / 2), phi + step
            path.append((theta, phi))
        (down, up) = np.array(path).transpose(2, 1, 0)
        theta, phi = np.concatenate([down[:, :0:-1], up], axis=1)
        fine = np.linspace(phi[0], phi[-1], SIDES + 1)
        return np.interp(fine, phi, theta), fine

    def _lean(self, theta: Array, phi: Array) -> Array:
        """`d theta/d phi` of the direction that is contracted most."""
        map, place = self.barrier.map.map, np.zeros(theta.size, dtype=np.int64)
        product, at = np.tile(np.eye(2), (theta.size, 1, 1)), (theta, phi)
        for _ in range(self.bounces):
            product = map.derivative(*at) @ product
            step = map.step(*at)
            at = step.theta, step.phi
        square = np.einsum("nji,njk->nik", product, product)
        y, x = 2 * square[:, 0, 1], square[:, 0, 0] - square[:, 1, 1]
        ahead, behind = (np.array(map.states.point(place, theta + side * STEP)) for side in (1, -1))
        speed = np.hypot(*(ahead - behind)) / (2 * STEP)
        with np.errstate(divide="ignore", invalid="ignore"):  # the tangent of half the angle of (x, y)
            half = np.where(x > 0, y / (np.hypot(x, y) + x), (np.hypot(x, y) - x) / y)
            return np.asarray(np.clip(-half / speed, -STEEPEST, STEEPEST))

    @cached_property
    def low(self) -> float:
        """Some kept point has an exit angle as large as this."""
        if not np.isfinite(self.high):
            return 0.0
        theta, phi = self.curve
        (a, b), (c, d) = ((x[:-1], x[1:]) for x in (theta, phi))
        zero = np.zeros(SIDES, dtype=np.int64)
        x, y = (np.minimum(a, b) - REST, np.maximum(a, b) + REST), (c - REST, d + REST)
        boxes = Boxes(zero, x, y)
        above, below = self.barrier.above(boxes), self.barrier.above(boxes.mirrored())
        if not (above[-1] and below[0]):
            return 0.0  # the curve does not cross all that is kept
        left = np.flatnonzero(~(above | below))
        middle, sides = np.stack([a + b, c + d])[:, left] / 2, np.zeros((2, 2, left.size))
        sides[:, 0] = np.stack([b - a, d - c])[:, left] / 2
        sets = Parallelograms(zero[left], middle, sides, np.full((2, left.size), REST))
        found, own = np.zeros(left.size), np.arange(left.size)
        for _ in range(self.bounces):
            source, sets = carried(self.barrier.map, sets)
            own = own[source]
            good = sets.known & (sets.reach() < WIDEST)
            sets, own = sets[good], own[good]
            if not own.size:
                break
            np.maximum.at(found, own, np.abs(sets.middle[1]) - sets.reach(0.0, 1.0))
        return float(np.min(found, initial=np.inf)) if left.size else 0.0
