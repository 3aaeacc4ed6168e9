"""The core of an attracting cycle: a set about one of its phase points, all of which is proved to converge to it.

The core is the set `|theta| <= outer`, `|phi - p(theta)| <= width` on one component, with an odd cubic `p` close to the
curve along which orbits approach; the cycle has two bounces, one of them at `theta = phi = 0`. Of it is proved:

- it is cut into cells by `theta`; the second image of each cell beyond `inner` lies in the core, and nearer to 0 than
  the inner edge of the cell, as do those of all cells within; so after one round for each cell an orbit is within
  `inner`;
- over the rectangle about what is within `inner` the derivative of two bounces is at most `M`, entry by entry, and
  `M*v <= q*v` with `q < 1` for a vector `v > 0`; so all orbits there converge to the one that is fixed, at 0;
- a gate is a wider and shorter set of the same kind, whose second image lies in the core.

Table and law are their own mirror images in the axis through the cycle, so that the half `theta >= 0` is enough.
An orbit that converges to a cycle has the exponents of the cycle, or less. Paper: section 5.3.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import Matrix, matrix, times
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.parallelograms import Parallelograms, carried

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
ROUND = 2  # bounces of the cycle
NEARLY = 1 - 2.0**-40  # covers the roundings of a comparison
CUT = 64, 4  # parts of a rectangle over which the derivative is enclosed
THICK, COARSER = 1e-3, 205  # of a slab of a gate; and its cells
UNMOVED = np.zeros(1)


@dataclass(frozen=True)
class Core:
    """The set `|theta| <= outer`, `|phi - p(theta)| <= width` of one component, `p = slope*theta + cubic*theta**3`.

    `gates` are pairs of an `outer` and a `width` of sets that are taken into it.
    """

    chart: int
    slope: float
    cubic: float
    width: float
    inner: float
    outer: float
    cells: int
    gates: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        sizes = self.inner, *(size for pair in (self.bounds, *self.gates) for size in pair)
        if not (self.cells >= 1 and all(0 < size < np.inf for size in sizes)):
            raise ValueError(f"{self}: accepted: at least one cell, and bounds above 0")

    def holds(self, sets: Parallelograms, *gates: tuple[float, float]) -> Mask:
        """Which sets lie within the core, or within a set of its kind with one of other pairs of bounds."""
        theta, phi = sets.middle
        with np.errstate(invalid="ignore"):
            far = sets.reach()
            tilt = self.slope + 3 * self.cubic * theta**2
            bend = 3 * abs(self.cubic) * (np.abs(theta) + far) * far**2  # of p, beside its tangent
            aside = np.abs(phi - (self.slope + self.cubic * theta**2) * theta) + sets.reach(-tilt, 1.0) + bend
            far += np.abs(theta)
            found = [(far <= outer * NEARLY) & (aside <= width * NEARLY) for outer, width in gates or (self.bounds,)]
        return np.asarray((sets.chart == self.chart) & np.logical_or.reduce(found))

    @property
    def bounds(self) -> tuple[float, float]:
        """Of the core itself."""
        return self.outer, self.width

    def enters(self, sets: Parallelograms) -> Mask:
        """Which sets lie within the core or one of its gates."""
        return self.holds(sets, self.bounds, *self.gates)

    def parts(self, aside: Array = UNMOVED) -> Parallelograms:
        """Parallelograms that cover the half `theta >= 0`, from 0 outwards, moved by each `aside` in `phi` in turn."""
        edges = np.linspace(0, self.outer, self.cells + 1)
        middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2 * (1 + 1e-9)
        aside, middle, half = (x.ravel() for x in np.broadcast_arrays(aside[:, None], middle, half))
        sides, rest = np.zeros((2, 2, middle.size)), np.zeros((2, middle.size))
        sides[0, 0], sides[1, 0] = half, (self.slope + 3 * self.cubic * middle**2) * half
        sides[1, 1] = self.width * (1 + 1e-9)
        rest[1] = 3 * abs(self.cubic) * (middle + half) * half**2 * (1 + 1e-9) + 1e-15
        phi = (self.slope + self.cubic * middle**2) * middle + aside
        return Parallelograms(np.full(middle.size, self.chart), np.stack([middle, phi]), sides, rest)


def twice(map: PinballImages, sets: Parallelograms) -> Parallelograms | None:
    """Their images after one round, in their order; None where one lands on both sides of a join, or is lost."""
    for _ in range(ROUND):
        source, images = carried(map, sets)
        order = np.argsort(source, kind="stable")
        if not np.array_equal(source[order], np.arange(sets.chart.size)) or not images.known.all():
            return None
        sets = images[order]
    return sets


def attracts(map: PinballImages, core: Core) -> dict[str, bool]:
    """Is all of the core taken to the cycle, step by step? The items are those of the module's docstring."""
    images = twice(map, core.parts())
    if images is None or not map.mirrored:
        return {"orbits come to the middle": False, "they converge there": False, "gates lead in": False}
    far = np.abs(images.middle[0]) + images.reach()
    edges = np.linspace(0, core.outer, core.cells + 1)
    beyond = edges[1:] > core.inner
    nearer = np.maximum.accumulate(far)[beyond] < edges[:-1][beyond] * NEARLY
    return {  # what begins within the middle stays there, by the first cell beyond; or by the core, if none is beyond
        "orbits come to the middle": bool(np.all(nearer) and np.all(core.holds(images))),
        "they converge there": _converges(map, core),
        "gates lead in": all(_leads(map, core, *gate) for gate in core.gates),
    }


def _leads(map: PinballImages, core: Core, outer: float, width: float) -> bool:
    """Is the second image of a gate within the core?"""
    slabs = int(np.ceil(width / THICK))
    one = replace(core, outer=outer, width=width / slabs, cells=COARSER)
    images = twice(map, one.parts(np.arange(1 - slabs, slabs, 2) * np.float64(width / slabs)))
    return images is not None and bool(core.holds(images).all())


def _converges(map: PinballImages, core: Core) -> bool:
    """Do all orbits of the core within `inner` converge to one?"""
    end = core.inner
    top = (abs(core.slope) * end + abs(core.cubic) * end**3 + core.width) * (1 + 1e-9)
    whole = Boxes(np.array([core.chart]), (np.array([-end]), np.array([end])), (np.array([-top]), np.array([top])))
    entries = derivative(map, whole.parts(*CUT)[0])
    if entries is None:
        return False
    most = np.array([[float(np.max(entry.magnitude())) for entry in row] for row in entries])
    vector = _longest(most)
    return bool(np.all(most @ vector < vector * NEARLY))


def _longest(matrix: Array) -> Array:
    """A vector that a matrix shrinks least, of positive entries, by iteration in float64; of any it is asked."""
    vector = np.array([1.0, 1.0])
    for _ in range(50 if np.isfinite(matrix).all() else 0):
        vector = matrix @ vector / np.max(matrix @ vector)
    return vector


def derivative(map: PinballImages, boxes: Boxes) -> Matrix | None:
    """The derivative of two bounces over boxes; None where one lands on both sides of a join."""
    total = [[BallArray(1.0), BallArray(0.0)], [BallArray(0.0), BallArray(1.0)]]
    sets = Parallelograms.about(boxes)
    for _ in range(ROUND):
        found = [(piece, slopes) for piece, slopes in map.derivatives(sets.boxes()) if piece.on.size]
        source, images = carried(map, sets)
        every = np.arange(sets.chart.size)
        if len(found) != 1 or not all(np.array_equal(on, every) for on in (found[0][0].on, source)):
            return None
        sets, one = images, matrix(found[0][1])
        total = times(one, total)
    return total
