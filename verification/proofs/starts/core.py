"""The core of an attracting cycle: a tube around one of its phase points, in which all orbits converge to the cycle.

The *core* is the set `|theta| <= outer`, `|phi - p(theta)| <= width` on one component, where the odd cubic `p` is close
to the curve along which orbits approach the cycle; the cycle has two bounces, one of them at `theta = phi = 0`. The
proof has three steps:

- the core is cut into cells by `theta`; the second images of each cell beyond `inner`, and of the cells closer to 0,
  lie in the core and closer to 0 than the inner edge of the cell; so after at most as many rounds as there are cells
  an orbit is within `inner`;
- over a rectangle around the part within `inner` the derivative of two bounces is at most `M`, entry by entry, and `M*v
  <= q*v` with `q < 1` for a vector `v > 0`; so all orbits there converge to the fixed point of two bounces, at 0;
- an *entry tube* is a wider and shorter set of the same kind, whose second image lies in the core.

Table and law are symmetric in the axis through the cycle, so the half `theta >= 0` suffices. The exponents of an orbit
that converges to the cycle are at most those of the cycle. Paper: section 5.3.
"""

from dataclasses import dataclass, replace

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Mask
from verification.proofs.global_dynamics.flights import Matrix, matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.parallelograms import Parallelograms, push_forward
from verification.rigorous.boxes import Boxes
from verification.rigorous.norms import shrinkage, times

ROUND = 2  # bounces of the cycle
NEARLY = 1 - 2.0**-40  # below 1 by more than the rounding of a comparison
CUT = 64, 4  # a rectangle is cut into so many parts to enclose the derivative
THICK, COARSER = 1e-3, 205  # the height of a slab of an entry tube, and its number of cells
UNMOVED = np.zeros(1)


@dataclass(frozen=True)
class AbsorbingTube:
    """The set `|theta| <= outer`, `|phi - p(theta)| <= width` on a component; `p = slope*theta + cubic*theta**3`.

    `inner` and `cells` are those of the module docstring; `entry_tubes` are pairs `(outer, width)` of entry tubes.
    """

    chart: int
    slope: float
    cubic: float
    width: float
    inner: float
    outer: float
    cells: int
    entry_tubes: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        sizes = self.inner, *(size for pair in (self.bounds, *self.entry_tubes) for size in pair)
        if not (self.cells >= 1 and all(0 < size < np.inf for size in sizes)):
            raise ValueError(f"{self} is out of range; accepted: at least one cell, and bounds above 0")

    def holds(self, sets: Parallelograms, *sizes: tuple[float, float]) -> Mask:
        """A mask of the sets in a tube with one of the bounds `(outer, width)` in `sizes`; by default, in this tube."""
        theta, phi = sets.middle
        with np.errstate(invalid="ignore"):
            far = sets.reach()
            tilt = self.slope + 3 * self.cubic * theta**2
            bend = 3 * abs(self.cubic) * (np.abs(theta) + far) * far**2  # the distance of p from its tangent
            aside = np.abs(phi - (self.slope + self.cubic * theta**2) * theta) + sets.reach(-tilt, 1.0) + bend
            far += np.abs(theta)
            found = [(far <= outer * NEARLY) & (aside <= width * NEARLY) for outer, width in sizes or (self.bounds,)]
        return np.asarray((sets.chart == self.chart) & np.logical_or.reduce(found))

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds `(outer, width)` of the tube itself."""
        return self.outer, self.width

    def enters(self, sets: Parallelograms) -> Mask:
        """A mask of the sets that lie within the tube or one of its entry tubes."""
        return self.holds(sets, self.bounds, *self.entry_tubes)

    def parts(self, aside: Array = UNMOVED) -> Parallelograms:
        """Parallelograms that cover the half `theta >= 0` of the tube, from 0 outwards, shifted in `phi` by `aside`."""
        edges = np.linspace(0, self.outer, self.cells + 1)
        middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2 * (1 + 1e-9)
        aside, middle, half = (x.ravel() for x in np.broadcast_arrays(aside[:, None], middle, half))
        sides, rest = np.zeros((2, 2, middle.size)), np.zeros((2, middle.size))
        sides[0, 0], sides[1, 0] = half, (self.slope + 3 * self.cubic * middle**2) * half
        sides[1, 1] = self.width * (1 + 1e-9)
        rest[1] = 3 * abs(self.cubic) * (middle + half) * half**2 * (1 + 1e-9) + 1e-15
        phi = (self.slope + self.cubic * middle**2) * middle + aside
        return Parallelograms(np.full(middle.size, self.chart), np.stack([middle, phi]), sides, rest)


def after_one_round(map: PinballImages, sets: Parallelograms) -> Parallelograms | None:
    """The images of sets after two bounces, in order; None if one lands on both sides of a join or is not enclosed."""
    for _ in range(ROUND):
        source, images = push_forward(map, sets)
        order = np.argsort(source, kind="stable")
        if not np.array_equal(source[order], np.arange(sets.chart.size)) or not images.known.all():
            return None
        sets = images[order]
    return sets


def attracts(map: PinballImages, core: AbsorbingTube) -> dict[str, bool]:
    """The three steps of the proof in the module docstring, by name, with True for each that is proved."""
    images = after_one_round(map, core.parts())
    if images is None or not map.mirrored:
        return {"orbits come to the middle": False, "they converge there": False, "gates lead in": False}
    far = np.abs(images.middle[0]) + images.reach()
    edges = np.linspace(0, core.outer, core.cells + 1)
    beyond = edges[1:] > core.inner
    nearer = np.maximum.accumulate(far)[beyond] < edges[:-1][beyond] * NEARLY
    return {  # the part within `inner` is invariant by the first cell beyond it, or by the core
        "orbits come to the middle": bool(np.all(nearer) and np.all(core.holds(images))),
        "they converge there": _converges(map, core),
        "gates lead in": all(_leads(map, core, *each) for each in core.entry_tubes),
    }


def _leads(map: PinballImages, core: AbsorbingTube, outer: float, width: float) -> bool:
    """True if the second image of an entry tube is proved to lie within the core."""
    slabs = int(np.ceil(width / THICK))
    one = replace(core, outer=outer, width=width / slabs, cells=COARSER)
    images = after_one_round(map, one.parts(np.arange(1 - slabs, slabs, 2) * np.float64(width / slabs)))
    return images is not None and bool(core.holds(images).all())


def _converges(map: PinballImages, core: AbsorbingTube) -> bool:
    """True if all orbits of the core within `inner` are proved to converge to one orbit."""
    end = core.inner
    top = (abs(core.slope) * end + abs(core.cubic) * end**3 + core.width) * (1 + 1e-9)
    whole = Boxes.one((-end, end), (-top, top), chart=core.chart)
    entries = derivative(map, whole.parts(*CUT)[0])
    if entries is None:
        return False
    most = np.array([[float(np.max(entry.magnitude())) for entry in row] for row in entries])
    return shrinkage(most[..., None], np.zeros(1, dtype=np.int64)) < 1


def derivative(map: PinballImages, boxes: Boxes) -> Matrix | None:
    """The derivative matrix of two bounces over boxes; None if a box lands on both sides of a join."""
    total = [[BallArray(1.0), BallArray(0.0)], [BallArray(0.0), BallArray(1.0)]]
    sets = Parallelograms.about(boxes)
    for _ in range(ROUND):
        found = [(piece, slopes) for piece, slopes in map.derivatives(sets.boxes()) if piece.on.size]
        source, images = push_forward(map, sets)
        every = np.arange(sets.chart.size)
        if len(found) != 1 or not all(np.array_equal(on, every) for on in (found[0][0].on, source)):
            return None
        sets, one = images, matrix(found[0][1])
        total = times(one, total)
    return total
